//! The part of a file that makes up the mesh: the primitives of the default scene, their skins and
//! morph targets, and the animations.

use super::super::{Fault, MeshErrorKind, Place, ReadNotes};
use super::accessor::{Accessor, Budget, Document};
use super::animation::Animation;
use super::json::{self, Mesh as JsonMesh, Primitive, Root};
use super::nodes::Nodes;
use super::{bad, container, instances, requirements, views};
use glam::DMat4;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::path::Path;

/// A loaded file, ready to be posed.
pub(in super::super) struct Scene {
    pub(super) document: Document,
    pub(super) nodes: Nodes,
    pub(super) skins: Vec<Skin>,
    /// In depth-first order of their nodes, then in the order of the mesh's primitives.
    pub(super) parts: Vec<Part>,
    /// Those that move nodes.
    pub(super) animations: Vec<Animation>,
    pub(super) notes: ReadNotes,
}

/// The joints that move a skinned mesh.
pub(super) struct Skin {
    pub(super) joints: Vec<usize>,
    /// From the mesh's space to each joint's.
    pub(super) inverse_bind: Vec<DMat4>,
}

/// Primitives of one node that share their vertices.
pub(super) struct Part {
    pub(super) node: usize,
    pub(super) skin: Option<usize>,
    /// Places of the copies, relative to the node.
    pub(super) instances: Vec<DMat4>,
    pub(super) positions: Vec<[f64; 3]>,
    /// Displacements, read when a frame needs them.
    pub(super) targets: Vec<Option<Accessor>>,
    /// One per target, where no animation says otherwise.
    pub(super) rest_weights: Vec<f64>,
    /// `#V × influences` joints of the skin and their weights; empty without a skin.
    pub(super) joints: Vec<u32>,
    pub(super) joint_weights: Vec<f64>,
    pub(super) faces: Vec<[u32; 3]>,
    /// `#V × 3`, 0 to 255, or empty.
    pub(super) colours: Vec<[f32; 3]>,
}

impl Scene {
    /// Loads a GLB or glTF file; its buffers lie in it or in `folder`.
    pub(in super::super) fn load(bytes: Vec<u8>, folder: &Path) -> Result<Self, Fault> {
        let (root, mut buffers) = container::open(bytes, folder)?;
        let nodes = Nodes::load(&root)?;
        let mut budget = Budget::default();
        let views = views::load(&root, &mut buffers, &mut budget)?;
        let document = Document { root, buffers, views };
        let mut loader = Loader { document: &document, budget, notes: ReadNotes::default() };
        let mut parts = Vec::new();
        for node in nodes.of_default_scene(&document.root)? {
            loader.load_node(node, &mut parts)?;
        }
        let Loader { mut notes, mut budget, .. } = loader;
        note_assets(&document.root, &mut notes);
        let skins = load_skins(&document, &nodes, &mut budget)?;
        check_skins(&parts, &skins)?;
        let mut animations = Vec::new();
        for json in &document.root.animations {
            let (animation, others) = Animation::load(&document, &nodes, json, &mut budget)?;
            animations.extend(animation);
            notes.ignore("animated properties that move nothing", others);
        }
        Ok(Self { document, nodes, skins, parts, animations, notes })
    }

    /// The number of animations in the file.
    pub(in super::super) fn animation_count(&self) -> usize {
        self.document.root.animations.len()
    }
}

fn note_assets(root: &Root, notes: &mut ReadNotes) {
    notes.ignore("materials", json::count(&root.materials));
    notes.ignore("textures", json::count(&root.textures));
    notes.ignore("cameras", json::count(&root.cameras));
}

fn load_skins(document: &Document, nodes: &Nodes, budget: &mut Budget) -> Result<Vec<Skin>, Fault> {
    let mut skins = Vec::new();
    for json in &document.root.skins {
        let joints = json.joints.clone();
        if joints.iter().any(|&joint| joint >= nodes.nodes.len()) {
            return Err(bad("a skin has a joint that does not exist"));
        }
        let inverse_bind = match json.inverse_bind_matrices {
            Some(index) => {
                let values = Accessor::open_wide(document, index, 16, budget)?.read(document);
                values.chunks_exact(16).map(matrix).collect()
            }
            None => vec![DMat4::IDENTITY; joints.len()],
        };
        if inverse_bind.len() < joints.len() {
            return Err(bad("a skin has not one matrix per joint"));
        }
        skins.push(Skin { joints, inverse_bind });
    }
    Ok(skins)
}

fn matrix(columns: &[f64]) -> DMat4 {
    DMat4::from_cols_array(&std::array::from_fn(|at| columns[at]))
}

fn check_skins(parts: &[Part], skins: &[Skin]) -> Result<(), Fault> {
    for part in parts {
        let Some(skin) = part.skin else { continue };
        let skin = skins.get(skin).ok_or_else(|| bad(format!("skin {skin} does not exist")))?;
        if part.joints.iter().any(|&joint| joint as usize >= skin.joints.len()) {
            return Err(bad("a vertex follows a joint that its skin does not have"));
        }
    }
    Ok(())
}

struct Loader<'a> {
    document: &'a Document,
    budget: Budget,
    notes: ReadNotes,
}

impl Loader<'_> {
    fn load_node(&mut self, node: usize, parts: &mut Vec<Part>) -> Result<(), Fault> {
        let root = &self.document.root;
        let json = &root.nodes[node];
        let Some(mesh) = json.mesh else { return Ok(()) };
        let mesh = root.meshes.get(mesh);
        let mesh = mesh.ok_or_else(|| bad(format!("the mesh of node {node} does not exist")))?;
        let first = parts.len();
        let mut owners = BTreeMap::new();
        for primitive in &mesh.primitives {
            requirements::check_primitive(root, primitive)?;
            let Some(faces) = self.load_faces(primitive)? else { continue };
            // Primitives that differ in material only use the same vertices.
            let part = match owners.entry(vertices_of(primitive)) {
                Entry::Occupied(owner) => *owner.get(),
                Entry::Vacant(owner) => {
                    parts.push(self.load_vertices(node, mesh, primitive)?);
                    *owner.insert(parts.len() - 1)
                }
            };
            parts[part].faces.extend(faces);
        }
        for part in &parts[first..] {
            check_faces(part)?;
            // A further instance costs the file next to nothing.
            let price = 12 * (part.positions.len() + part.faces.len()) as u64;
            let further = part.instances.len().saturating_sub(1) as u64;
            self.budget.spend(price.saturating_mul(further))?;
        }
        Ok(())
    }

    /// The triangles of a primitive; `None` where it has none (points and lines).
    fn load_faces(&mut self, primitive: &Primitive) -> Result<Option<Vec<[u32; 3]>>, Fault> {
        let mode = match primitive.mode.unwrap_or(4) {
            0..=3 => {
                self.notes.ignore("primitives of points or lines", 1);
                return Ok(None);
            }
            4 => Mode::Triangles,
            5 => Mode::TriangleStrip,
            6 => Mode::TriangleFan,
            _ => return Err(bad("a primitive has an unknown mode")),
        };
        let indices = match primitive.indices {
            Some(index) => {
                let accessor = self.open(index, 1)?;
                if !accessor.is_unsigned() {
                    return Err(bad("face indices are not unsigned integers"));
                }
                accessor.read_integers(self.document)
            }
            None => {
                let count = self.open(attribute(primitive, "POSITION")?, 3)?.count;
                (0..count as u32).collect()
            }
        };
        triangles(mode, &indices).map(Some)
    }

    fn load_vertices(
        &mut self,
        node: usize,
        mesh: &JsonMesh,
        primitive: &Primitive,
    ) -> Result<Part, Fault> {
        let json = &self.document.root.nodes[node];
        let positions = self.open(attribute(primitive, "POSITION")?, 3)?;
        let count = positions.count;
        let mut targets = Vec::new();
        for target in &primitive.targets {
            let accessor = target.get("POSITION").map(|&index| self.open(index, 3)).transpose()?;
            if accessor.as_ref().is_some_and(|accessor| accessor.count != count) {
                return Err(bad("a morph target has not one vector per vertex"));
            }
            targets.push(accessor);
        }
        let weights = json.weights.as_ref().or(mesh.weights.as_ref());
        let (joints, joint_weights) = match json.skin {
            Some(_) => self.load_influences(primitive, count)?,
            None => (Vec::new(), Vec::new()),
        };
        self.note_attributes(primitive, count);
        Ok(Part {
            node,
            skin: json.skin,
            instances: instances::load(self.document, json, &mut self.budget)?,
            positions: positions.read_vectors(self.document),
            targets,
            rest_weights: weights.cloned().unwrap_or_default(),
            joints,
            joint_weights,
            faces: Vec::new(),
            colours: self.load_colours(primitive, count)?,
        })
    }

    /// Joints and weights of all sets, side by side per vertex.
    fn load_influences(
        &mut self,
        primitive: &Primitive,
        count: usize,
    ) -> Result<(Vec<u32>, Vec<f64>), Fault> {
        let mut sets = Vec::new();
        for set in 0.. {
            let Ok(joints) = attribute(primitive, &format!("JOINTS_{set}")) else { break };
            let joints = self.open(joints, 4)?;
            let weights = self.open(attribute(primitive, &format!("WEIGHTS_{set}"))?, 4)?;
            if joints.count != count || weights.count != count || !joints.is_unsigned() {
                return Err(bad("joints and weights are not four per vertex"));
            }
            sets.push((joints.read_integers(self.document), weights.read(self.document)));
        }
        if sets.is_empty() {
            return Err(bad("a skinned mesh has no joints"));
        }
        let (mut joints, mut weights) = (Vec::new(), Vec::new());
        for vertex in 0..count {
            for (set_joints, set_weights) in &sets {
                joints.extend_from_slice(&set_joints[4 * vertex..][..4]);
                weights.extend_from_slice(&set_weights[4 * vertex..][..4]);
            }
        }
        Ok((joints, weights))
    }

    fn load_colours(
        &mut self,
        primitive: &Primitive,
        count: usize,
    ) -> Result<Vec<[f32; 3]>, Fault> {
        let Ok(index) = attribute(primitive, "COLOR_0") else { return Ok(Vec::new()) };
        let accessor = Accessor::open(self.document, index, &mut self.budget)?;
        let width = accessor.width;
        if !(3..=4).contains(&width) || accessor.count != count {
            return Err(bad("colours are not one per vertex"));
        }
        let values = accessor.read(self.document);
        let colour = |c: &[f64]| [c[0], c[1], c[2]].map(|channel| (channel * 255.0) as f32);
        Ok(values.chunks_exact(width).map(colour).collect())
    }

    fn note_attributes(&mut self, primitive: &Primitive, count: usize) {
        for name in primitive.attributes.keys() {
            let what = match name.split('_').next().unwrap_or_default() {
                "NORMAL" => "normals",
                "TANGENT" => "tangents",
                "TEXCOORD" => "texture coordinates",
                "COLOR" if name != "COLOR_0" => "further colours",
                "POSITION" | "COLOR" | "JOINTS" | "WEIGHTS" => continue,
                _ => "custom attributes",
            };
            self.notes.ignore(what, count as u64);
        }
    }

    fn open(&mut self, index: usize, width: usize) -> Result<Accessor, Fault> {
        Accessor::open_wide(self.document, index, width, &mut self.budget)
    }
}

/// The accessor of an attribute.
fn attribute(primitive: &Primitive, name: &str) -> Result<usize, Fault> {
    let found = primitive.attributes.get(name);
    found.copied().ok_or_else(|| bad(format!("a primitive has no {name}")))
}

/// The accessors that make up the vertices of a primitive.
fn vertices_of(primitive: &Primitive) -> impl Ord {
    let targets: Vec<_> = primitive.targets.iter().map(|target| target.get("POSITION")).collect();
    (&primitive.attributes, targets)
}

fn check_faces(part: &Part) -> Result<(), Fault> {
    let vertices = part.positions.len();
    for (face, corners) in part.faces.iter().enumerate() {
        if let Some(&index) = corners.iter().find(|&&index| index as usize >= vertices) {
            let kind = MeshErrorKind::FaceIndex { index: index.into(), vertices };
            return Err(Place::Face(face).fault(kind));
        }
    }
    Ok(())
}

/// How the indices of a primitive make triangles.
#[derive(Clone, Copy)]
enum Mode {
    Triangles,
    TriangleStrip,
    TriangleFan,
}

/// Cuts lists, strips and fans into triangles of the same turn.
fn triangles(mode: Mode, indices: &[u32]) -> Result<Vec<[u32; 3]>, Fault> {
    Ok(match mode {
        Mode::TriangleStrip => {
            let turned = |(at, w): (usize, &[u32])| {
                if at % 2 == 0 { [w[0], w[1], w[2]] } else { [w[0], w[2], w[1]] }
            };
            indices.windows(3).enumerate().map(turned).collect()
        }
        Mode::TriangleFan => match indices {
            [] => Vec::new(),
            [first, rest @ ..] => rest.windows(2).map(|w| [w[0], w[1], *first]).collect(),
        },
        _ if !indices.len().is_multiple_of(3) => {
            return Err(bad(format!("{} face indices do not make whole triangles", indices.len())));
        }
        _ => indices.chunks_exact(3).map(|w| [w[0], w[1], w[2]]).collect(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_and_fans_keep_their_turn() {
        let faces = |mode, indices: &[u32]| triangles(mode, indices).ok();
        assert_eq!(faces(Mode::Triangles, &[0, 1, 2]), Some(vec![[0, 1, 2]]));
        assert_eq!(faces(Mode::Triangles, &[0, 1]), None);
        assert_eq!(faces(Mode::TriangleStrip, &[0, 1, 2, 3]), Some(vec![[0, 1, 2], [1, 3, 2]]));
        assert_eq!(faces(Mode::TriangleFan, &[0, 1, 2, 3]), Some(vec![[1, 2, 0], [2, 3, 0]]));
        assert_eq!(faces(Mode::TriangleFan, &[]), Some(vec![]));
    }
}
