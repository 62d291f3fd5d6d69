//! A held object: surface far beyond the hands belongs to no body part.

use super::V3;
use super::fit::Posed;
use super::label::Draft;
use super::surface::Surface;
use kn_bitstream::params::BodyPart;
use nalgebra::{Matrix4, Vector4};

/// Parts that hold things: lower arms and hands.
const HOLDING: [u8; 4] = [
    BodyPart::LeftLowerArm.label(),
    BodyPart::LeftHand.label(),
    BodyPart::RightLowerArm.label(),
    BodyPart::RightHand.label(),
];
/// A surface this far from a hand is not its own, metres.
const BEYOND: f64 = 0.05;
/// Smallest area of such surface, square metres: more than spread fingers or a cuff have.
const LEAST: f64 = 0.03;

/// A held object.
pub(super) enum Object {
    /// A ball: centre and radius.
    Ball(V3, f64),
    /// Any other shape: all surface that is far from the hands.
    Shapeless,
}

/// Looks for surface beyond the hands.
pub(super) fn find(surface: &Surface, draft: &Draft, capsules: &[Posed]) -> Option<Object> {
    let far = |&v: &usize| {
        let capsule = &capsules[draft.capsule(v)];
        let (_, away) = capsule.project(&surface.points[v]);
        // A flank that a hand hangs beside faces the hand; an object in it faces away.
        HOLDING.contains(&draft.part(v))
            && capsule.outside(&surface.points[v]) > BEYOND
            && surface.normals[v].dot(&away) > 0.5 * away.norm()
    };
    let seeds: Vec<usize> = (0..surface.points.len()).filter(far).collect();
    let area: f64 = seeds.iter().map(|&v| surface.areas[v]).sum();
    if area < LEAST {
        return None;
    }
    Some(ball_through(surface, &seeds).unwrap_or(Object::Shapeless))
}

/// The least-squares sphere, if the seeds lie on one.
fn ball_through(surface: &Surface, seeds: &[usize]) -> Option<Object> {
    let origin = surface.points[*seeds.first()?];
    let (mut matrix, mut right) = (Matrix4::zeros(), Vector4::zeros());
    for &v in seeds {
        let p = surface.points[v] - origin;
        let row = Vector4::new(p.x, p.y, p.z, 1.0);
        matrix += row * row.transpose() * surface.areas[v];
        right += row * (p.norm_squared() * surface.areas[v]);
    }
    let solution = matrix.cholesky()?.solve(&right);
    let centre = V3::new(solution.x, solution.y, solution.z) * 0.5;
    let radius = (solution.w + centre.norm_squared()).max(0.0).sqrt();
    let centre = centre + origin;
    let miss = |&v: &usize| ((surface.points[v] - centre).norm() - radius).abs();
    let mean = seeds.iter().map(miss).sum::<f64>() / seeds.len() as f64;
    let round = (0.04..0.3).contains(&radius) && mean < 0.08 * radius;
    round.then_some(Object::Ball(centre, radius))
}

impl Object {
    /// Distance of a point from the object's surface; `outside` is that from the closest hand's.
    pub(super) fn cost(&self, point: &V3, outside: f64, holding: bool) -> Option<f64> {
        match self {
            Self::Ball(centre, radius) => {
                // Steeper than a part's distance, or the hand on the ball would drown in it.
                let off = ((point - centre).norm() - radius).abs();
                (off < 0.03).then_some(1.5 * off)
            }
            Self::Shapeless => holding.then_some((0.8 * BEYOND - outside).max(0.0)),
        }
    }
}

/// Whether a part can hold something.
pub(super) fn holds(part: u8) -> bool {
    HOLDING.contains(&part)
}
