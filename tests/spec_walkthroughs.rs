//! The walkthroughs of chapters 4, 5 and 8: every number in them is computed again, by a literal
//! reading here, and what they arrive at is compared with the decoder's.

use kn_bitstream::params::{InfluenceMode, Weights};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

use kn_bitstream::range::{BinaryCoder, BitModel, RangeDecoder};
use kn_codec::intra::{IntraDecoder, IntraEncoding, IntraLimits, decode_intra, encode_intra};
use kn_deform::{BindOptions, Deformer, Influence, NodeTransform, bind, sin_cos};
use kn_mesh::GridMesh;

/// The lines of the one block of this kind in a chapter.
fn walkthrough(chapter: &str, kind: &str) -> Vec<String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("spec").join(chapter);
    let text = std::fs::read_to_string(path).expect("the chapter");
    let block = text.split_once(&format!("```{kind}\n")).expect("the block").1;
    block.lines().take_while(|line| *line != "```").map(str::to_owned).collect()
}

/// The payload of a tetrahedron, in which every symbol but the first is forced.
fn tetrahedron() -> IntraEncoding {
    let positions = vec![[0, 0, 0], [4, 0, 0], [0, 4, 0], [0, 0, 4]];
    let faces = vec![[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]];
    encode_intra(&GridMesh::new(positions, faces)).expect("a mesh")
}

/// Chapter 4 as it is written, with a model of its own.
#[derive(Clone, Copy)]
struct LiteralModel {
    fast: i64,
    slow: i64,
    seen: i64,
}

impl LiteralModel {
    const NEW: Self = Self { fast: 32768, slow: 32768, seen: 0 };

    fn probability(self) -> u64 {
        ((self.fast + self.slow) >> 1).clamp(160, 65376) as u64
    }

    fn adapt(&mut self, bit: bool) {
        let mean = 131_072 / (2 * self.seen + 3);
        let moved = |estimate: i64, rate: i64| {
            let way = if bit { 65535 } else { 0 } - estimate;
            estimate + ((way * (rate >> 1)) >> 15)
        };
        self.fast = moved(self.fast, mean.max(4096));
        self.slow = moved(self.slow, mean.max(512));
        self.seen += 1;
    }
}

#[test]
fn the_decisions_of_chapter_4_are_those_of_a_tetrahedron() {
    let lines = walkthrough("04-entropy-range.md", "decisions");
    let names: Vec<&str> = lines[1..].iter().filter_map(|l| l.split_whitespace().next()).collect();
    let encoding = tetrahedron();
    let section = &encoding.connectivity[..];
    let mut decoder = RangeDecoder::new(section);
    let mut models: BTreeMap<&str, (BitModel, LiteralModel)> = BTreeMap::new();
    let byte = |at: usize| u64::from(section.get(at).copied().unwrap_or(0));
    let mut taken = 8;
    let mut range = u64::MAX;
    let mut offset = (0..8).fold(0, |number, at| number << 8 | byte(at));
    let digits: String = section.iter().map(|byte| format!("{byte:02x}")).collect();
    let mut written = vec![format!("section {digits}")];
    for name in names {
        let (model, literal) =
            models.entry(name).or_insert((BitModel::default(), LiteralModel::NEW));
        let p = literal.probability();
        let bound = (range >> 16) * p;
        let bit = offset < bound;
        (range, offset) = if bit { (bound, offset) } else { (range - bound, offset - bound) };
        literal.adapt(bit);
        if range < 1 << 32 {
            range <<= 32;
            offset = (taken..taken + 4).fold(offset, |number, at| number << 8 | byte(at));
            taken += 4;
        }
        assert_eq!(decoder.bit(model, false), bit, "{name}");
        let bit = u8::from(bit);
        written.push(format!("{name:22} {p:5}  {bit}  {range:016x}  {offset:016x}"));
    }
    assert!(decoder.is_finished());
    assert_eq!(lines, written, "\n{}", written.join("\n"));
}

#[test]
fn the_conquest_of_chapter_5_is_that_of_a_tetrahedron() {
    let limits = IntraLimits { max_vertices: 4, max_faces: 4 };
    let mut mesh = GridMesh::default();
    let encoding = tetrahedron();
    decode_intra(&encoding.payload(), &limits, &mut IntraDecoder::default(), &mut mesh)
        .expect("sound");
    let lines = walkthrough("05-intra.md", "conquest");
    // The triangle is in the last brackets but one, what its corners lack in the last.
    let triples = |line: &String| -> Vec<[u32; 3]> {
        let groups = line.split('(').skip(1).filter_map(|group| group.split(')').next());
        groups
            .map(|group| {
                let numbers: Vec<u32> = group.split(' ').map(|n| n.parse().expect("n")).collect();
                numbers.try_into().expect("three")
            })
            .collect()
    };
    let found: Vec<[u32; 3]> = lines.iter().map(|line| triples(line)[0]).collect();
    assert_eq!(found, mesh.faces);
    for (at, line) in lines.iter().enumerate() {
        let so_far = &mesh.faces[..=at];
        let lacks =
            mesh.faces[at].map(|v| 3 - so_far.iter().flatten().filter(|&&w| w == v).count());
        assert_eq!(triples(line)[1], lacks.map(|lack| lack as u32), "{line}");
    }
}

/// Two nodes and a vertex of chapter 8, in reference units of 1/256 step.
const NODES: [[i32; 3]; 2] = [[0, 0, 0], [40, 8, 0]];
const VERTEX: [i32; 3] = [10, 3, -2];

fn motions() -> [NodeTransform; 2] {
    let turned = NodeTransform {
        rotation: [0.25, -1.5, 3.0],
        translation: [300.0, -70.0, 5.0],
        ..NodeTransform::IDENTITY
    };
    let bent = NodeTransform {
        scale: [1.25, 0.5, 1.0],
        shear: [0.125, -0.0625, 0.375],
        translation: [-512.0, 256.0, 40.0],
        ..turned
    };
    [turned, bent]
}

#[test]
fn the_vertex_of_chapter_8_moves_as_written() {
    let lines = walkthrough("08-deformation.md", "deformation");
    let written = literal_deformation();
    assert_eq!(lines, written, "\n{}", written.join("\n"));
    let options = BindOptions {
        nodes_per_vertex: 2,
        weights: Weights::gaussian(20),
        mode: InfluenceMode::Strict,
    };
    let mut influence = Influence::default();
    bind(&[VERTEX], &[0], &NODES, &[0, 0], &options, &mut influence).expect("nodes");
    let units = |p: [i32; 3]| p.map(|x| 256 * x);
    let mut moved = Vec::new();
    Deformer::default()
        .deform(&[units(VERTEX)], &influence, &NODES.map(units), &motions(), 1 << 28, &mut moved)
        .expect("inside");
    let [x, y, z] = moved[0];
    assert!(lines.contains(&format!("reference              {x} {y} {z}")));
}

/// Chapter 8 for one vertex, as it is written.
fn literal_deformation() -> Vec<String> {
    let mut lines = Vec::new();
    let mut show = |name: &str, values: &[f64]| {
        let mut line = format!("{name:21}");
        for value in values {
            let _ = write!(line, "  {:016x}", value.to_bits());
        }
        lines.push(line);
    };
    let squared = NODES.map(|n| (0..3).map(|k| (n[k] - VERTEX[k]).pow(2)).sum::<i32>());
    let d = squared.map(|d| f64::from(d.max(1)));
    let u = d.map(|d_j| kn_deform::exp_neg((d_j - d[0]) / (2.0 * (20.0 * 20.0))));
    show("u_0 u_1", &u);
    let sum = (0.0 + u[0]) + u[1];
    let w = u.map(|u| u / sum);
    show("w_0 w_1", &w);
    let x = VERTEX.map(|x| f64::from(256 * x));
    let mut total = [0.0; 3];
    for (j, motion) in motions().iter().enumerate() {
        for (angle, axis) in motion.rotation.iter().zip(["x", "y", "z"]) {
            let (sine, cosine) = sin_cos(*angle);
            if j == 0 {
                show(&format!("s_{axis} c_{axis}"), &[sine, cosine]);
            }
        }
        let a = motion.matrix();
        let n = NODES[j].map(|n| f64::from(256 * n));
        for (i, row) in a.iter().enumerate() {
            show(&format!("node {j}, row {i} of A"), row);
            let about = (row[0] * n[0] + row[1] * n[1]) + row[2] * n[2];
            let b = (n[i] + motion.translation[i]) - about;
            let term = w[j] * (((row[0] * x[0] + row[1] * x[1]) + row[2] * x[2]) + b);
            total[i] += term;
            show(&format!("node {j}, b and term {i}"), &[b, term]);
        }
    }
    show("sum", &total);
    let rounded = total.map(|t| t.round_ties_even());
    let origin = [0.5, -1.25, 100.0];
    let world = [0, 1, 2].map(|i| origin[i] + 0.001 * (rounded[i] / 256.0));
    let [i, j, k] = rounded.map(|t| t as i64);
    lines.push(format!("reference              {i} {j} {k}"));
    let mut line = format!("{:21}", "world");
    for value in world {
        let _ = write!(line, "  {:016x}", value.to_bits());
    }
    lines.push(line);
    lines
}

/// L of chapter 5: eighths of an octave.
fn eighths(x: i64) -> i64 {
    if x <= 1 {
        return 0;
    }
    let place = i64::from(x.ilog2());
    8 * place + ((x << 3 >> place) & 7)
}

#[test]
fn the_vertex_of_chapter_5_is_predicted_as_written() {
    let encoding = tetrahedron();
    let limits = IntraLimits { max_vertices: 4, max_faces: 4 };
    let mut mesh = GridMesh::default();
    decode_intra(&encoding.payload(), &limits, &mut IntraDecoder::default(), &mut mesh)
        .expect("sound");
    let written = literal_prediction(&mesh.positions);
    let lines = walkthrough("05-intra.md", "prediction");
    assert_eq!(lines, written, "\n{}", written.join("\n"));
}

/// Section 5.5 for vertex 3 of the tetrahedron, as it is written: all valences are 3, so that `along`
/// is 0, and no vertex has a stored error.
fn literal_prediction(positions: &[[i32; 3]]) -> Vec<String> {
    let at = |v: usize| positions[v].map(i64::from);
    let each = |f: &dyn Fn(usize) -> i64| [0, 1, 2].map(f);
    let triples = [[0, 2, 1], [2, 1, 0], [1, 0, 2]];
    let base = at(0);
    let place = |v: usize, k: usize| at(v)[k] - base[k];
    let sum = |f: &dyn Fn(&[usize; 3], usize) -> i64| {
        each(&|k| triples.iter().map(|triple| f(triple, k)).sum())
    };
    let centroid = sum(&|[a, ..], k| place(*a, k));
    let parallel = sum(&|[a, b, c], k| place(*a, k) + place(*b, k) - place(*c, k));
    let onward = sum(&|[a, b, c], k| place(*a, k) + place(*b, k) - 2 * place(*c, k));
    let gates: i64 = sum(&|[a, b, _], k| (place(*b, k) - place(*a, k)).abs()).iter().sum();
    let normal = sum(&|[a, b, c], k| {
        let cross =
            |i: usize, j: usize| (place(*a, i) - place(*b, i)) * (place(*c, j) - place(*b, j));
        let [i, j] = [(k + 1) % 3, (k + 2) % 3];
        cross(i, j) - cross(j, i)
    });
    // n = s = 3, row 3 and column "≤ 4" of table 5-1.
    let ([o, m], r) = ([-5, 44], 65536 / 3);
    let offset = each(&|k| {
        (((64 - m) * parallel[k] + ((o * onward[k]) >> 1)) * r + m * centroid[k] * r) >> 16
    });
    let gate = eighths(64 * gates / 3);
    let tangential = gate - 8;
    let across = (gate - 32) >> 1;
    let flat = ((tangential - across - 6) >> 2).clamp(0, 10);
    let mut lines = vec![
        format!("base {base:?}, centroid {centroid:?}, parallel {parallel:?}, onward {onward:?}"),
        format!("gates {gates}, normal {normal:?}, offset {offset:?}"),
        format!("gate {gate}, tangential {tangential}, across {across}, flat {flat}"),
    ];
    let largest = normal.iter().map(|x| x.abs()).max().unwrap_or(0);
    assert!(largest < 1 << 10, "nothing is shifted");
    let d = (0..3).find(|&k| normal[k].abs() == largest).unwrap_or(0);
    let [p, q] = [(d + 1) % 3, (d + 2) % 3];
    let [np, nq, nd] = [p, q, d].map(|k| normal[k]);
    let s = normal.iter().map(|x| x * x).sum::<i64>().max(1);
    let w = (1 << flat) - 1;
    let (whole, x) = (s << flat, (s << flat) - w * np * np);
    lines.push(format!("d = {d}, p = {p}, q = {q}, S {s}, w {w}, W {whole}, X {x}"));
    let mut e = [0; 3];
    for axis in [p, q, d] {
        let (mean, variance) = if axis == p {
            (0, eighths(x) - eighths(whole))
        } else if axis == q {
            (-w * np * nq * e[p] / x, eighths(x - w * nq * nq) - eighths(x))
        } else {
            let below = s + w * nd * nd;
            (-w * nd * (np * e[p] + nq * e[q]) / below, eighths(s) - eighths(below))
        };
        let context = ((2 * tangential + variance) >> 3).clamp(0, 47);
        let exact = offset[axis] + mean;
        let near = (exact + 32) >> 6;
        let lean = (3 * (exact - 64 * near + 32)) >> 6;
        let coordinate = at(3)[axis];
        e[axis] = 64 * (coordinate - base[axis]) - offset[axis];
        lines.push(format!(
            "axis {axis}: mean {mean}, variance {variance}, context {context}, exact {exact}, near {near}, \
             lean {lean}, error value {}, coordinate {coordinate}, e {}",
            coordinate - base[axis] - near,
            e[axis],
        ));
    }
    let length: i64 = e.iter().map(|x| x.abs()).sum();
    let dot: i64 = (0..3).map(|k| normal[k] * e[k]).sum();
    let spread: i64 = normal.iter().map(|x| x.abs()).sum();
    let error = eighths(dot.abs() + 8 * spread) - eighths(s) / 2;
    let learnt = |mean: i64, found: i64| mean + ((256 * (found - gate) - mean) >> 6);
    let tangential_mean = learnt(-8 * 256, eighths(length + 16));
    let normal_mean = learnt(-32 * 256, error);
    lines.push(format!(
        "length {length}, error {error}, tangential_mean {tangential_mean}, normal_mean {normal_mean}"
    ));
    lines
}
