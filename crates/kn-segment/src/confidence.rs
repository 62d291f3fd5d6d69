//! The confidence of a body part: whether its capsules explain its surface, and whether its surface
//! is as large as that of such a part.

use super::body::{BODY, THIGHS};
use super::fit::Fit;
use super::hem::Hem;
use super::label::distance;
use super::surface::Surface;
use super::{LABELS, OTHER, TORSO};
use kn_bitstream::params::BodyPart;

/// Labels of the parts that hanging cloth hides or adds to.
const COVERED: [u8; 3] = [TORSO, BodyPart::LeftThigh.label(), BodyPart::RightThigh.label()];

/// Confidence of every label, 0 to 1; 0 for a part without vertices.
pub(super) fn confidence(surface: &Surface, fit: &Fit, hem: &Hem, labels: &[u8]) -> [f32; LABELS] {
    /// Misfit at which trust is halved, metres.
    const HALF: f64 = 0.03;
    let capsules = fit.capsules();
    // Cloth over the thighs is torso, and hides as much of them as it likes.
    let draped = hem.hangs();
    let (mut trust, mut areas) = ([0.0; LABELS], [0.0; LABELS]);
    for v in 0..labels.len() {
        let part = labels[v];
        let own = BODY.iter().zip(&capsules).enumerate().filter(|(k, (shape, _))| {
            shape.part == part || (draped && part == TORSO && THIGHS.contains(k))
        });
        let off = own.map(|(_, (_, c))| distance(c, &surface.points[v], &surface.normals[v]));
        let off = off.fold(f64::MAX, f64::min).max(0.0);
        let share = if part == OTHER { 1.0 } else { 1.0 / (1.0 + (off / HALF) * (off / HALF)) };
        trust[usize::from(part)] += share * surface.areas[v];
        areas[usize::from(part)] += surface.areas[v];
    }
    let expected = expected_areas(fit);
    std::array::from_fn(|part| {
        let (area, wanted) = (areas[part], expected[part]);
        if area <= 0.0 {
            return 0.0;
        }
        // Less than half of the surface, or more than twice: something else is in the way.
        let hidden = draped && COVERED.contains(&(part as u8));
        let size = if wanted > 0.0 && !hidden {
            (2.0 * area / wanted).min(2.0 * wanted / area).min(1.0)
        } else {
            1.0
        };
        (trust[part] / area * size) as f32
    })
}

/// Area of the mantle of every part's capsules.
fn expected_areas(fit: &Fit) -> [f64; LABELS] {
    let mut areas = [0.0; LABELS];
    for (shape, capsule) in BODY.iter().zip(fit.capsules()) {
        // The two columns of the torso share half of their mantle.
        let seen = if shape.part == TORSO { 0.6 } else { 1.0 };
        let girth = std::f64::consts::PI * (capsule.radii[0] + capsule.radii[1]);
        areas[usize::from(shape.part)] += seen * girth * (capsule.b - capsule.a).norm();
    }
    areas
}
