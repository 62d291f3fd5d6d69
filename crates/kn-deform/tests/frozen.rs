//! Digests of results over inputs that reach every constant of the crate. What is right is settled
//! by the literal decoder of kn-conform; this notices a change within seconds.

use kn_bitstream::params::{InfluenceMode, Weights};
use kn_deform::{
    BindError, BindOptions, Deformer, Influence, NodeTransform, Smoother, bind, exp_neg, sin_cos,
};

/// FNV-1a over 64-bit words.
struct Digest(u64);

impl Digest {
    fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    fn word(&mut self, word: u64) {
        for byte in word.to_le_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3);
        }
    }

    fn float(&mut self, value: f64) {
        self.word(value.to_bits());
    }
}

/// Numbers without a pattern, from −`limit` to `limit`.
struct Numbers(u64);

impl Numbers {
    fn integer(&mut self, limit: i32) -> i32 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) as i32).rem_euclid(2 * limit + 1) - limit
    }

    fn point(&mut self, limit: i32) -> [i32; 3] {
        std::array::from_fn(|_| self.integer(limit))
    }
}

#[test]
fn sine_and_cosine() {
    let mut digest = Digest::new();
    for step in -4096..=4096 {
        let (sine, cosine) = sin_cos(f64::from(step) / 1024.0);
        digest.float(sine);
        digest.float(cosine);
    }
    assert_eq!(digest.0, 0x5611_18fd_f8ef_2078, "{:#x}", digest.0);
}

#[test]
fn exponential() {
    let mut digest = Digest::new();
    for step in 0..=8000 {
        digest.float(exp_neg(f64::from(step) / 10.0));
    }
    digest.float(exp_neg(700.0));
    digest.float(exp_neg(700.000_1));
    assert_eq!(digest.0, 0x2e30_017a_3b10_927f, "{:#x}", digest.0);
}

/// Vertices and nodes close together and far away, in three regions, the last one 255.
fn scene() -> [(Vec<[i32; 3]>, Vec<u8>); 2] {
    let mut numbers = Numbers(1);
    let mut set = |count: usize, regions: &[u8]| {
        let points = (0..count).map(|i| numbers.point(if i % 7 == 0 { (1 << 20) - 1 } else { 30 }));
        let points: Vec<_> = points.collect();
        (points, (0..count).map(|i| regions[i % regions.len()]).collect())
    };
    [set(70, &[0, 3, 255, 9]), set(29, &[0, 3, 0, 255])]
}

fn options(nodes_per_vertex: usize, weights: Weights) -> BindOptions {
    BindOptions { nodes_per_vertex, weights, mode: InfluenceMode::Fallback }
}

#[test]
fn influence_and_deformation() {
    let [(vertices, vertex_regions), (nodes, node_regions)] = scene();
    let mut numbers = Numbers(2);
    let mut component = |scale: f64| -> [f64; 3] {
        std::array::from_fn(|_| f64::from(numbers.integer(1000)) / 1000.0 * scale)
    };
    let transform = |_| NodeTransform {
        rotation: component(4.0),
        scale: component(0.5).map(|s| 1.0 + s),
        shear: component(2.0),
        translation: component(900.0).map(f64::round_ties_even),
    };
    let transforms: Vec<_> = (0..nodes.len()).map(transform).collect();
    let schemes = [
        Weights::INVERSE_SQUARE,
        Weights::SUMNER,
        Weights::gaussian(1),
        Weights::gaussian(300_000),
    ];
    let mut digest = Digest::new();
    let mut influence = Influence::default();
    for (q, scheme) in (1..=8).flat_map(|q| schemes.map(|scheme| (q, scheme))) {
        bind(
            &vertices,
            &vertex_regions,
            &nodes,
            &node_regions,
            &options(q, scheme),
            &mut influence,
        )
        .expect("sound arguments");
        influence.nodes.iter().for_each(|&node| digest.word(u64::from(node)));
        influence.weights.iter().for_each(|&weight| digest.float(weight));
        let mut deformed = Vec::new();
        Deformer::default()
            .deform(&vertices, &influence, &nodes, &transforms, 1 << 28, &mut deformed)
            .expect("inside the range");
        deformed.as_flattened().iter().for_each(|&x| digest.word(x as u64));
    }
    assert_eq!(digest.0, 0xff31_7578_123a_1378, "{:#x}", digest.0);
}

/// A sheet of triangles without a corner and with a fin, bent and rough; all strengths.
#[test]
fn smoothing() {
    const N: u32 = 12;
    let mut numbers = Numbers(3);
    let vertex = |i: u32| {
        let [x, y] = [i % N, i / N].map(|c| 512 * c as i32);
        [x + y / 3, y - x / 5, (x * y) >> 10].map(|c| c + numbers.integer(5000))
    };
    let sheet: Vec<[i32; 3]> = (0..N * N).map(vertex).collect();
    let quads = (0..N - 1).flat_map(|y| (0..N - 1).map(move |x| y * N + x));
    let mut faces: Vec<[u32; 3]> =
        quads.flat_map(|a| [[a, a + 1, a + N + 1], [a, a + N + 1, a + N]]).collect();
    faces.remove(0);
    faces.push([77, 78, 3]);
    let mut digest = Digest::new();
    let mut smoother = Smoother::default();
    for strength in 0..=Smoother::STRENGTHS {
        let mut positions = sheet.clone();
        smoother.smooth(&mut positions, &faces, strength, 1 << 13);
        positions.as_flattened().iter().for_each(|&x| digest.word(x as u64));
    }
    assert_eq!(digest.0, 0xe4aa_1988_0f8e_4c0c, "{:#x}", digest.0);
}

#[test]
fn nodes_are_as_many_as_16_bits_tell_apart() {
    let mut influence = Influence::default();
    let options = options(1, Weights::SUMNER);
    for (count, sound) in [(1, true), (1 << 16, true), ((1 << 16) + 1, false)] {
        let nodes: Vec<[i32; 3]> = (0..count).map(|x| [x, 0, 0]).collect();
        let last = nodes[nodes.len() - 1];
        let result = bind(&[last], &[0], &nodes, &vec![0; nodes.len()], &options, &mut influence);
        assert_eq!(result.is_ok(), sound, "{count}");
        assert!(!sound || usize::from(influence.nodes[0]) == nodes.len() - 1);
    }
}

#[test]
fn q_is_one_to_eight() {
    let mut influence = Influence::default();
    for q in [0, 9] {
        let options = options(q, Weights::SUMNER);
        let result = bind(&[[0; 3]], &[0], &[[1; 3]], &[0], &options, &mut influence);
        assert!(matches!(result, Err(BindError::Arguments(_))), "{q}");
    }
}
