//! The mesh that a scene shows at rest or in a frame of its animation.

use super::super::Fault;
use super::super::parsed::Parsed;
use super::nodes::Nodes;
use super::scene::{Part, Scene, Skin};
use glam::{DMat3, DMat4, DVec3};

impl Scene {
    /// The mesh of the scene without any animation.
    pub(in super::super) fn at_rest(&self) -> Parsed {
        self.posed(&self.nodes, &vec![None; self.nodes.nodes.len()])
    }

    /// The number of frames of the first animation; `None` where there is none.
    pub(in super::super) fn frame_count(&self, frame_rate: f64) -> Result<Option<usize>, Fault> {
        self.animations.first().map(|animation| animation.frame_count(frame_rate)).transpose()
    }

    /// The mesh in a frame of the first animation.
    pub(in super::super) fn at_frame(&self, frame: usize, frame_rate: f64) -> Parsed {
        let mut nodes = self.nodes.clone();
        let mut weights = vec![None; nodes.nodes.len()];
        if let Some(animation) = self.animations.first() {
            animation.apply(frame, frame_rate, &mut nodes, &mut weights);
        }
        let mut parsed = self.posed(&nodes, &weights);
        parsed.notes.ignore("further animations", self.animations.len().saturating_sub(1) as u64);
        parsed
    }

    /// All visible parts in world space, one after the other.
    fn posed(&self, nodes: &Nodes, weights: &[Option<Vec<f64>>]) -> Parsed {
        let mut parsed = Parsed { notes: self.notes.clone(), ..Parsed::default() };
        let (world, drawn) = (nodes.to_world(), nodes.drawn());
        for part in self.parts.iter().filter(|part| drawn[part.node]) {
            let weights = weights[part.node].as_ref().unwrap_or(&part.rest_weights);
            let morphed = self.morphed(part, weights);
            match part.skin.map(|skin| &self.skins[skin]) {
                Some(skin) => add(part, skinned(part, &morphed, skin, &world), false, &mut parsed),
                None => {
                    for instance in &part.instances {
                        add_placed(part, &morphed, world[part.node] * *instance, &mut parsed);
                    }
                }
            }
        }
        parsed
    }

    /// The positions of a part with its morph targets added by their weights.
    fn morphed(&self, part: &Part, weights: &[f64]) -> Vec<DVec3> {
        let mut positions: Vec<DVec3> =
            part.positions.iter().map(|p| DVec3::from_array(*p)).collect();
        for (target, &weight) in part.targets.iter().zip(weights) {
            let Some(target) = target.as_ref().filter(|_| weight != 0.0) else { continue };
            for (position, offset) in positions.iter_mut().zip(target.read_vectors(&self.document))
            {
                *position += DVec3::from_array(offset) * weight;
            }
        }
        positions
    }
}

/// Adds a part to the mesh where `to_world` moves it.
fn add_placed(part: &Part, positions: &[DVec3], to_world: DMat4, parsed: &mut Parsed) {
    let turn = DMat3::from_mat4(to_world);
    // A node scaled to nothing is how glTF hides an object for a while.
    if turn != DMat3::ZERO {
        let placed = positions.iter().map(|p| to_world.transform_point3(*p).to_array());
        add(part, placed, turn.determinant() < 0.0, parsed);
    }
}

/// Adds a part to the mesh, with its vertices at `positions`.
fn add(
    part: &Part,
    positions: impl Iterator<Item = [f64; 3]>,
    mirrored: bool,
    parsed: &mut Parsed,
) {
    let first = parsed.mesh.positions.len() as u32;
    parsed.mesh.positions.extend(positions);
    let moved = part.faces.iter().map(|face| face.map(|vertex| first + vertex));
    let turned = moved.map(|[a, b, c]| if mirrored { [a, c, b] } else { [a, b, c] });
    parsed.mesh.faces.extend(turned);
    parsed.colours.extend_from_slice(&part.colours);
}

/// The positions that the joints of a skin move to. The node of a skinned mesh does not move it.
fn skinned<'a>(
    part: &'a Part,
    positions: &'a [DVec3],
    skin: &Skin,
    world: &[DMat4],
) -> impl Iterator<Item = [f64; 3]> + 'a {
    let joints: Vec<DMat4> = skin
        .joints
        .iter()
        .zip(&skin.inverse_bind)
        .map(|(&joint, &inverse_bind)| world[joint] * inverse_bind)
        .collect();
    let influences = part.joints.len() / part.positions.len().max(1);
    positions.iter().enumerate().map(move |(vertex, &position)| {
        let mut sum = DVec3::ZERO;
        let mut total = 0.0;
        for at in vertex * influences..(vertex + 1) * influences {
            let weight = part.joint_weights[at];
            if weight != 0.0 {
                sum += joints[part.joints[at] as usize].transform_point3(position) * weight;
                total += weight;
            }
        }
        // Weights stored in few bits do not add up to 1 exactly; those of no joint stay put.
        let placed = if total > 0.0 { sum / total } else { position };
        placed.to_array()
    })
}
