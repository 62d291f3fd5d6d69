//! Intra coding of scans: bytes and time of every sequence at 10, 11 and 12 bits, beside Draco's
//! where Debian's `draco` is installed. Without `../shared` it takes the synthetic performer.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use kn_codec::intra::{IntraDecoder, IntraLimits, decode_intra, encode_intra};
use kn_mesh::performer::{Performer, PerformerConfig};
use kn_mesh::{Grid, GridMesh, Mesh};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

const BITS: [u32; 3] = [10, 11, 12];
const LIMITS: IntraLimits = IntraLimits { max_vertices: 1 << 20, max_faces: 1 << 21 };

fn scans() -> Vec<PathBuf> {
    let data = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../shared/data"));
    ["dancer/frame_0004", "mitch/frame_0000", "liam/frame_0000", "tshirt_turn/frame_0000"]
        .map(|name| data.join(name).with_extension("obj"))
        .into_iter()
        .filter(|path| path.exists())
        .collect()
}

/// The first three numbers of every line that starts with `word`.
fn triples(text: &str, word: &str) -> Vec<[f64; 3]> {
    let numbers = |line: &str| {
        let mut words = line.split_whitespace();
        let found = (words.next() == Some(word))
            .then_some(())
            .map(|()| words.filter_map(|w| w.split('/').next()?.parse().ok()));
        let numbers: Vec<f64> = found?.take(3).collect();
        numbers.try_into().ok()
    };
    text.lines().filter_map(numbers).collect()
}

fn read_mesh(path: &Path) -> Mesh {
    let text = std::fs::read_to_string(path).expect("a readable scan");
    let positions = triples(&text, "v").into_iter().map(|v| v.map(|x| x as f32)).collect();
    let faces = triples(&text, "f").into_iter().map(|f| f.map(|i| i as u32 - 1)).collect();
    Mesh { positions, faces, labels: Vec::new() }
}

/// The mesh on Draco's grid: the box's longest side has 2^bits − 1 steps.
fn on_grid(mesh: &Mesh, bits: u32) -> GridMesh {
    let bounds = mesh.bounding_box().expect("a mesh with vertices");
    let step = bounds.longest_side() / f64::from((1u32 << bits) - 1);
    let grid = Grid { origin: bounds.min, step };
    let positions = grid.quantise(&mesh.positions).expect("inside its own box");
    GridMesh { positions, faces: mesh.faces.clone(), labels: Vec::new() }
}

fn draco_bytes(path: &Path, bits: u32) -> Option<u64> {
    let directory = tempfile::tempdir().ok()?;
    let out = directory.path().join("draco");
    let status = Command::new("draco_encoder")
        .args(["-cl", "10", "-qp", &bits.to_string(), "-i"])
        .arg(path)
        .arg("-o")
        .arg(&out)
        .stdout(Stdio::null())
        .status()
        .ok()?;
    status.success().then_some(())?;
    Some(std::fs::metadata(out).ok()?.len())
}

fn intra(criterion: &mut Criterion) {
    let mut meshes: Vec<(String, Option<PathBuf>, Mesh)> = Vec::new();
    for path in scans() {
        let sequence = path.parent().and_then(Path::file_name).unwrap_or_default();
        meshes.push((sequence.to_string_lossy().into(), Some(path.clone()), read_mesh(&path)));
    }
    if meshes.is_empty() {
        let config = PerformerConfig { vertices: 20_000, ..PerformerConfig::default() };
        let performer = Performer::new(config).expect("sound settings");
        meshes.push(("performer".into(), None, performer.frame(0)));
    }
    let mut group = criterion.benchmark_group("intra");
    for (name, path, mesh) in &meshes {
        for bits in BITS {
            let mesh = on_grid(mesh, bits);
            let mut bytes = Vec::new();
            let encoding = encode_intra(&mesh, &mut bytes).expect("a sound mesh");
            let draco = path.as_ref().and_then(|path| draco_bytes(path, bits));
            let ratio = draco.map(|draco| bytes.len() as f64 / draco as f64);
            eprintln!(
                "{name} {bits} bits: {} bytes (connectivity {}, geometry {}), Draco {draco:?}, ratio {ratio:.3?}",
                bytes.len(),
                encoding.connectivity_bytes,
                encoding.geometry_bytes,
            );
            group.throughput(Throughput::Elements(mesh.faces.len() as u64));
            group.bench_function(format!("encode/{name}/{bits}"), |bencher| {
                bencher.iter(|| {
                    bytes.clear();
                    encode_intra(&mesh, &mut bytes)
                });
            });
            let (mut decoder, mut decoded) = (IntraDecoder::default(), GridMesh::default());
            group.bench_function(format!("decode/{name}/{bits}"), |bencher| {
                bencher.iter(|| decode_intra(&bytes, &LIMITS, &mut decoder, &mut decoded));
            });
        }
    }
    group.finish();
}

criterion_group!(benches, intra);
criterion_main!(benches);
