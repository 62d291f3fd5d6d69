//! The synthetic performer: a seeded human figure in a loose tunic that walks, turns or dances and
//! is meshed anew in every frame. It makes sequences of any length without a file or a licence.
//!
//! A frame is made in this order: the choreography gives a stance (`motion`, `gestures`), the
//! skeleton a pose (`skeleton`), solids on the bones and the swinging skirt a signed field
//! (`figure`, `shape`, `cloth`, `field`); the field is sampled on a lattice that lies
//! differently in every frame (`lattice`, `compose`), turned into a closed mesh (`net`),
//! disturbed like a scan (`scan`) and decimated to its vertex count (`simplify`). So vertex
//! order, connectivity and, where limbs touch, genus differ in every frame. `truth` knows where
//! each point of the surface goes.
//!
//! Every frame is a function of configuration and index alone: frames can be made in any order,
//! and the same bits come out on every platform and for every number of threads.

mod cloth;
mod compose;
mod field;
mod figure;
mod gestures;
mod lattice;
mod motion;
mod net;
mod random;
mod rigid;
mod scan;
mod shape;
mod simplify;
mod skeleton;
mod truth;

use cloth::Skirt;
use field::Scene;
use figure::Figure;
use kn_mesh::Mesh;
use lattice::Lattice;
use motion::Motion;
use random::Random;
use rayon::prelude::*;
use skeleton::Pose;
use truth::Flow;

/// Labels of the body parts, in the order of the bi-modal paper.
pub mod part {
    use kn_bitstream::params::BodyPart;

    /// Head and neck.
    pub const HEAD: u8 = BodyPart::Head.label();
    /// Left upper arm, lower arm and hand.
    pub const LEFT_ARM: [u8; 3] =
        labels([BodyPart::LeftUpperArm, BodyPart::LeftLowerArm, BodyPart::LeftHand]);
    /// Right upper arm, lower arm and hand.
    pub const RIGHT_ARM: [u8; 3] =
        labels([BodyPart::RightUpperArm, BodyPart::RightLowerArm, BodyPart::RightHand]);
    /// Torso; with a tunic also its skirt.
    pub const TORSO: u8 = BodyPart::Torso.label();
    /// Left thigh, leg and foot.
    pub const LEFT_LEG: [u8; 3] =
        labels([BodyPart::LeftThigh, BodyPart::LeftLeg, BodyPart::LeftFoot]);
    /// Right thigh, leg and foot.
    pub const RIGHT_LEG: [u8; 3] =
        labels([BodyPart::RightThigh, BodyPart::RightLeg, BodyPart::RightFoot]);
    /// No body part: the ball.
    pub const OTHER: u8 = BodyPart::Other.label();
    const fn labels([a, b, c]: [BodyPart; 3]) -> [u8; 3] {
        [a.label(), b.label(), c.label()]
    }

    /// Number of body parts, [`OTHER`] not counted.
    pub const COUNT: usize = BodyPart::COUNT - 1;
}

/// The action of the figure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// Stands, breathes and sways: slow motion.
    Stand,
    /// Walks on a circle.
    Walk,
    /// Turns on the spot with the arms held out; the tunic flares.
    Turn,
    /// Dances: steps, sways, arm gestures that touch the body, whole turns.
    Dance,
    /// An unrelated pose in every frame, for registration tests: between two frames a wrist moves
    /// by up to 30 % of the height at intensity 1.
    Poses,
}

/// Settings of a [`Performer`].
#[derive(Clone, Debug, PartialEq)]
pub struct PerformerConfig {
    /// Decides proportions, choreography, folds, lattices and noise.
    pub seed: u64,
    /// Vertices of a frame before holes are cut, 1,000 to 200,000; met exactly up to holes.
    pub vertices: usize,
    /// The action of the figure.
    pub action: Action,
    /// Frames per second, 1 to 1000.
    pub fps: f64,
    /// Amplitude of the motion, 0 (still) to 2; 1 is natural.
    pub intensity: f64,
    /// Scanner noise, 0 (none) to 5; 1 is like the scans of the paper.
    pub noise: f64,
    /// Holes in every frame, at most 100; each has a rim of about 8 to 26 edges.
    pub holes: u32,
    /// The right hand holds a ball, labelled [`part::OTHER`].
    pub ball: bool,
    /// A loose tunic with a swinging skirt instead of a close shirt.
    pub tunic: bool,
}

impl Default for PerformerConfig {
    fn default() -> Self {
        Self {
            seed: 1,
            vertices: 20_000,
            action: Action::Dance,
            fps: 30.0,
            intensity: 1.0,
            noise: 1.0,
            holes: 4,
            ball: false,
            tunic: true,
        }
    }
}

/// A setting of [`PerformerConfig`] that is out of its range.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("performer: {setting} is {value}, allowed is {least} to {most}")]
pub struct PerformerError {
    /// The field of [`PerformerConfig`].
    pub setting: &'static str,
    /// The value that was given.
    pub value: f64,
    /// Smallest allowed value.
    pub least: f64,
    /// Largest allowed value.
    pub most: f64,
}

/// A figure and its choreography; makes any frame on its own.
#[derive(Clone, Debug)]
pub struct Performer {
    config: PerformerConfig,
    figure: Figure,
    motion: Motion,
    /// The figure at rest, which all material points refer to.
    rest: Scene,
}

/// The net is this much finer than the mesh that decimation leaves.
const OVERSAMPLING: f64 = 1.8;
/// Pieces of surface with a smaller share of the vertices are dropped.
const LARGE_PIECE: f64 = 0.01;
/// Vertices of a net times the square of its step: the figure's area, in square metres, times the
/// vertices that a cell-sized piece of surface gets.
const NET_AREA: f64 = 3.2;

impl Performer {
    /// # Errors
    /// The first setting that is out of its range.
    pub fn new(config: PerformerConfig) -> Result<Self, PerformerError> {
        let check = |setting, value: f64, least: f64, most: f64| {
            let good = value >= least && value <= most;
            if good { Ok(()) } else { Err(PerformerError { setting, value, least, most }) }
        };
        check("vertices", config.vertices as f64, 1_000.0, 200_000.0)?;
        check("fps", config.fps, 1.0, 1_000.0)?;
        check("intensity", config.intensity, 0.0, 2.0)?;
        check("noise", config.noise, 0.0, 5.0)?;
        check("holes", f64::from(config.holes), 0.0, 100.0)?;
        let (figure, motion) = (Figure::new(&config), Motion::new(&config));
        let pose = Pose::solve(&Motion::rest(&figure.body), &figure.body);
        let rest = Scene::new(&figure, pose, Skirt::default());
        Ok(Self { config, figure, motion, rest })
    }

    /// The settings that it was made with.
    pub fn config(&self) -> &PerformerConfig {
        &self.config
    }

    /// The mesh of frame `index` in metres, y up, with a label per vertex.
    pub fn frame(&self, index: u32) -> Mesh {
        let scene = self.scene(index);
        let random = Random::new(self.config.seed, 3).fork(i64::from(index));
        let step = (NET_AREA / (OVERSAMPLING * self.config.vertices as f64)).sqrt();
        let mut lattice = Lattice::sample(&scene, step, random.fork(0));
        compose::make_well_composed(&mut lattice, &scene);
        let mut surface = net::extract(&scene, &lattice);
        surface.keep_large_pieces(LARGE_PIECE);
        surface.compact();
        scan::add_noise(&mut surface, self.config.noise, random.fork(1));
        simplify::simplify(&mut surface, self.config.vertices);
        scan::cut_holes(&mut surface, self.config.holes, random.fork(2));
        surface.compact();
        let leaf = |i: usize| &lattice.leaves[surface.leaves[i] as usize].candidates;
        let label = |(i, at): (usize, &glam::DVec3)| scene.label(*at, leaf(i));
        let labels = surface.positions.par_iter().enumerate().map(label).collect();
        let positions = surface.positions.iter().map(|p| scan::rounded(*p)).collect();
        Mesh::new(positions, surface.faces).with_labels(labels)
    }

    /// The places in frame `to` of the surface points of a mesh of frame `from`: `#V × 3` true
    /// positions, one for each vertex of `mesh`. Labels tell touching parts apart; a mesh without
    /// labels gets them from the figure.
    ///
    /// A vertex beside the surface (noise) keeps its distance from it. A point that is hidden in
    /// frame `to`, under the tunic or inside a touching limb, is where it really is: inside.
    pub fn transport(&self, mesh: &Mesh, from: u32, to: u32) -> Vec<[f64; 3]> {
        let (source, target) = (self.scene(from), self.scene(to));
        let flow = Flow { rest: &self.rest, from: &source, to: &target };
        let carry = |(i, position): (usize, &[f64; 3])| {
            let at = glam::DVec3::from(*position);
            let label = mesh.labels.get(i).copied();
            let label = label.unwrap_or_else(|| source.label(at, &source.all()));
            scan::rounded(flow.carry(at, label))
        };
        mesh.positions.par_iter().enumerate().map(carry).collect()
    }

    /// The signed distance (metres, negative inside) of `point` from the noiseless surface of
    /// frame `index`; of first order, so exact only near the surface.
    pub fn distance(&self, index: u32, point: [f64; 3]) -> f64 {
        let scene = self.scene(index);
        scene.value(glam::DVec3::from(point), &scene.all())
    }

    fn scene(&self, index: u32) -> Scene {
        let (time, frame) = (f64::from(index) / self.config.fps, i64::from(index));
        let stance = self.motion.stance(time, frame, &self.figure.body);
        let pose = Pose::solve(&stance, &self.figure.body);
        let skirt = if self.config.tunic {
            Skirt::at(&self.motion, time, frame, &pose)
        } else {
            Skirt::default()
        };
        Scene::new(&self.figure, pose, skirt)
    }
}
