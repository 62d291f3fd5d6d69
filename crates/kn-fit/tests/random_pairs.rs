//! Random pairs of small dirty scans: whatever they are, a registration comes back and is finite.
//!
//! `KN_RANDOM_PAIRS=1000 cargo test --release -p kn-fit --test random_pairs` tries so many.

use kn_fit::{FitOptions, RegisterOptions, register};
use kn_mesh::{Mesh, clean};
use kn_performer::{Action, Performer, PerformerConfig};

/// Pairs that are tried by default.
const PAIRS: u64 = 16;

/// A crop that leaves fewer faces, about 300 vertices, is not made.
const LEAST_FACES: usize = 600;

/// A small generator of numbers; the performer has its own for shapes.
struct Dice(u64);

impl Dice {
    /// 0 to `sides` − 1 (splitmix64).
    fn roll(&mut self, sides: u64) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)) % sides
    }

    /// −1 to 1.
    fn signed(&mut self) -> f64 {
        self.roll(2001) as f64 / 1000.0 - 1.0
    }
}

/// A scan with noise, holes, islands, spikes, folded and repeated faces; 300 to 1,500 vertices.
fn dirty(performer: &Performer, frame: u32, dice: &mut Dice) -> Mesh {
    let mut mesh = performer.frame(frame);
    if dice.roll(2) == 0 {
        // What a camera saw of the figure: the part on one side of a plane.
        let (axis, at) = (dice.roll(3) as usize, 0.3 * dice.signed());
        let level = if axis == 1 { 0.9 + at } else { at };
        let seen = |face: &&[u32; 3]| mesh.positions[face[0] as usize][axis] < level;
        let faces: Vec<[u32; 3]> = mesh.faces.iter().filter(seen).copied().collect();
        if faces.len() >= LEAST_FACES {
            mesh.faces = faces;
        }
    }
    for _ in 0..dice.roll(6) {
        add_island(&mut mesh, dice);
    }
    for _ in 0..dice.roll(5) {
        let vertex = dice.roll(mesh.positions.len() as u64) as usize;
        mesh.positions[vertex][dice.roll(3) as usize] += 0.3 * dice.signed();
    }
    for _ in 0..dice.roll(8) {
        let face = mesh.faces[dice.roll(mesh.faces.len() as u64) as usize];
        let [a, b, c] = face;
        mesh.faces.push([[a, b, c], [a, c, b], [a, b, b]][dice.roll(3) as usize]);
    }
    clean(&mesh).expect("indices in range").mesh
}

/// A loose strip of triangles somewhere around the figure, or an isolated vertex.
fn add_island(mesh: &mut Mesh, dice: &mut Dice) {
    let middle = [dice.signed(), 0.9 + dice.signed(), dice.signed()];
    let size = 0.002 + 0.1 * dice.signed().abs();
    let first = mesh.positions.len() as u32;
    let count = 1 + dice.roll(12) as u32;
    for _ in 0..count {
        mesh.positions.push(middle.map(|c| c + size * dice.signed()));
        mesh.labels.push(14);
    }
    mesh.faces.extend((2..count).map(|i| [first + i - 2, first + i - 1, first + i]));
}

#[test]
fn every_pair_is_registered() {
    let asked = std::env::var("KN_RANDOM_PAIRS").ok().and_then(|text| text.parse().ok());
    let pairs = asked.unwrap_or(PAIRS);
    for seed in 0..pairs {
        let mut dice = Dice(seed);
        let actions = [Action::Poses, Action::Dance, Action::Turn, Action::Walk];
        let config = PerformerConfig {
            seed,
            vertices: 1_000 + dice.roll(400) as usize,
            action: actions[dice.roll(4) as usize],
            noise: dice.roll(4) as f64,
            holes: dice.roll(12) as u32,
            ball: dice.roll(3) == 0,
            ..PerformerConfig::default()
        };
        let performer = Performer::new(config).expect("settings in range");
        let source = dirty(&performer, 0, &mut dice);
        let target = dirty(&performer, 1 + dice.roll(5) as u32, &mut dice);
        let nodes = 1 + dice.roll(150) as usize;
        let options = RegisterOptions { nodes, fit: FitOptions::default() };
        let (from, to) = (source.positions, target.positions);
        let result = register(&from, &source.faces, &to, &target.faces, &options)
            .unwrap_or_else(|error| panic!("seed {seed}: {error}"));
        assert_eq!(result.positions.len(), from.len());
        let finite = result.positions.iter().flatten().all(|c| c.is_finite() && c.abs() < 1e3);
        assert!(finite, "seed {seed}: a position is {:?}", result.report);
        for residuals in [result.report.source_to_target, result.report.target_to_source] {
            let numbers = [residuals.rms, residuals.p95, residuals.max, residuals.unmatched];
            assert!(numbers.iter().all(|n| n.is_finite()), "seed {seed}: {residuals:?}");
        }
    }
    eprintln!("{pairs} pairs registered");
}
