//! Intra coding of scans: bytes and time of every sequence at 10, 11 and 12 bits. Without them
//! (`docs/data.md`) it takes the synthetic performer. Where Draco's library is installed a table beside Draco comes
//! first; `cargo bench --bench intra -- NOTHING` prints only that.

#[cfg(unix)]
mod draco;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use kn_bitstream::{BitReader, BitWriter, IntraPayload, Level};
use kn_codec::intra::{IntraDecoder, IntraLimits, decode_intra, encode_intra};
use kn_mesh::{Grid, GridMesh, Mesh};
use kn_performer::{Performer, PerformerConfig};
use kn_testdata::data;
use std::path::{Path, PathBuf};

const BITS: [u32; 3] = [10, 11, 12];
const LIMITS: IntraLimits = IntraLimits { max_vertices: 1 << 20, max_faces: 1 << 21 };

fn scans() -> Vec<PathBuf> {
    let first = [("dancer", 4), ("mitch", 0), ("liam", 0), ("tshirt_turn", 0)];
    let file = |(name, frame)| Some(data(name)?.join(format!("frame_{frame:04}.obj")));
    first.into_iter().filter_map(file).collect()
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
    let positions = triples(&text, "v");
    let faces = triples(&text, "f").into_iter().map(|f| f.map(|i| i as u32 - 1)).collect();
    Mesh::new(positions, faces)
}

/// The mesh on Draco's grid: the box's longest side has 2^bits − 1 steps.
fn on_grid(mesh: &Mesh, bits: u32) -> GridMesh {
    let bounds = mesh.bounding_box().expect("a mesh with vertices");
    let step = bounds.longest_side() / f64::from((1u32 << bits) - 1);
    let grid = Grid { origin: bounds.min, step };
    let positions = grid.quantise(&mesh.positions).expect("inside its own box");
    GridMesh::new(positions, mesh.faces.clone())
}

/// Least bytes and seconds of one coder.
#[derive(Clone, Copy)]
#[cfg(unix)]
struct Laps {
    bytes: usize,
    encode: f64,
    decode: f64,
}

#[cfg(unix)]
fn thread_seconds() -> f64 {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}

#[cfg(unix)]
fn seconds_of(work: impl FnOnce()) -> f64 {
    let start = thread_seconds();
    work();
    thread_seconds() - start
}

/// The payload of a mesh.
fn encoded(mesh: &GridMesh) -> Vec<u8> {
    let mut bits = BitWriter::new();
    encode_intra(mesh).expect("a sound mesh").payload().write(&mut bits);
    bits.into_bytes()
}

fn decode(bytes: &[u8], level: &Level, decoder: &mut IntraDecoder, mesh: &mut GridMesh) {
    let payload = IntraPayload::read(&mut BitReader::new(bytes), bytes.len() as u32, level);
    decode_intra(&payload.expect("its own payload"), &LIMITS, decoder, mesh).expect("its own mesh");
}

fn highest_level() -> Level {
    Level::all().last().expect("there are levels").1
}

/// Ours and Draco's, by turns, least of many runs: whatever else the machine does hits both.
#[cfg(unix)]
fn by_turns(mesh: &GridMesh, theirs: &mut draco::DracoMesh) -> Option<[Laps; 2]> {
    const RUNS: usize = 60;
    let mut laps = [Laps { bytes: 0, encode: f64::MAX, decode: f64::MAX }; 2];
    let (mut decoder, mut decoded) = (IntraDecoder::default(), GridMesh::default());
    let level = highest_level();
    for _ in 0..RUNS {
        let mut bytes = Vec::new();
        let encode = seconds_of(|| bytes = encoded(mesh));
        let decode = seconds_of(|| decode(&bytes, &level, &mut decoder, &mut decoded));
        let (draco_bytes, draco_encode) = theirs.step("encode")?;
        let (_, draco_decode) = theirs.step("decode")?;
        let run = [(bytes.len(), encode, decode), (draco_bytes, draco_encode, draco_decode)];
        for (least, (bytes, encode, decode)) in laps.iter_mut().zip(run) {
            least.bytes = bytes;
            least.encode = least.encode.min(encode);
            least.decode = least.decode.min(decode);
        }
    }
    Some(laps)
}

/// Prints the table beside Draco, level 10, and the geometric means of its ratios.
#[cfg(unix)]
fn print_table(scans: &[(String, PathBuf, Mesh)]) {
    let Some(draco) = draco::Draco::build() else {
        return eprintln!("no table beside Draco: no C++ compiler or no library");
    };
    println!(
        "| | bits | bytes: ours | Draco | ratio | encode, ms: ours | Draco | ratio | decode, ms: ours | Draco | ratio |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|");
    let (mut logarithms, mut rows) = ([0.0; 3], 0);
    for (name, path, mesh) in scans {
        for bits in BITS {
            let theirs = draco.open(path, bits);
            let laps = theirs.and_then(|mut theirs| by_turns(&on_grid(mesh, bits), &mut theirs));
            let Some([ours, theirs]) = laps else {
                return eprintln!("{name}, {bits} bits: Draco ended early");
            };
            let ratios = [
                ours.bytes as f64 / theirs.bytes as f64,
                ours.encode / theirs.encode,
                ours.decode / theirs.decode,
            ];
            println!(
                "| {name} | {bits} | {} | {} | {:.3} | {:.1} | {:.1} | {:.2} | {:.1} | {:.1} | {:.2} |",
                ours.bytes,
                theirs.bytes,
                ratios[0],
                1e3 * ours.encode,
                1e3 * theirs.encode,
                ratios[1],
                1e3 * ours.decode,
                1e3 * theirs.decode,
                ratios[2],
            );
            for (sum, ratio) in logarithms.iter_mut().zip(ratios) {
                *sum += ratio.ln();
            }
            rows += 1;
        }
    }
    let [bytes, encode, decode] = logarithms.map(|sum| (sum / f64::from(rows.max(1))).exp());
    println!("geometric means: bytes {bytes:.3}, encode {encode:.2}, decode {decode:.2}");
}

fn intra(criterion: &mut Criterion) {
    let scans: Vec<(String, PathBuf, Mesh)> = scans()
        .into_iter()
        .map(|path| {
            let sequence = path.parent().and_then(Path::file_name).unwrap_or_default();
            (sequence.to_string_lossy().into(), path.clone(), read_mesh(&path))
        })
        .collect();
    #[cfg(unix)]
    print_table(&scans);
    let mut meshes: Vec<_> = scans.into_iter().map(|(name, _, mesh)| (name, mesh)).collect();
    if meshes.is_empty() {
        let config = PerformerConfig { vertices: 20_000, ..PerformerConfig::default() };
        let performer = Performer::new(config).expect("sound settings");
        meshes.push(("performer".into(), performer.frame(0)));
    }
    let mut group = criterion.benchmark_group("intra");
    for (name, mesh) in &meshes {
        for bits in BITS {
            let mesh = on_grid(mesh, bits);
            let (bytes, level) = (encoded(&mesh), highest_level());
            group.throughput(Throughput::Elements(mesh.faces.len() as u64));
            group.bench_function(format!("encode/{name}/{bits}"), |bencher| {
                bencher.iter(|| encoded(&mesh));
            });
            let (mut decoder, mut decoded) = (IntraDecoder::default(), GridMesh::default());
            group.bench_function(format!("decode/{name}/{bits}"), |bencher| {
                bencher.iter(|| decode(&bytes, &level, &mut decoder, &mut decoded));
            });
        }
    }
    group.finish();
}

criterion_group!(benches, intra);
criterion_main!(benches);
