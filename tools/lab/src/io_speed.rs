//! Times our readers against tobj and ply-rs-bw on one OBJ file and its PLY copy, then our writers
//! and the cleaning: `cargo run --release -p kn-lab -- io-speed FILE.obj`.

use anyhow::{Result, bail};
use kn_io::{ReadOptions, read_mesh, write_mesh};
use ply_rs_bw::parser::Parser;
use ply_rs_bw::ply::{BeginList, DefaultElement, PropertyAccess, PropertyAccessResult};
use std::path::Path;
use std::time::Instant;

/// The fastest of 20 runs, in milliseconds, and the last result.
fn fastest<T>(mut run: impl FnMut() -> T) -> (f64, T) {
    let mut timed = || {
        let start = Instant::now();
        let result = run();
        (start.elapsed().as_secs_f64() * 1e3, result)
    };
    let best = (0..19).map(|_| timed().0).fold(f64::INFINITY, f64::min);
    let (time, last) = timed();
    (best.min(time), last)
}

/// A vertex or a face, filled by ply-rs-bw without a hash map.
#[derive(Default)]
struct Element {
    position: [f32; 3],
    corners: Vec<i32>,
}

impl PropertyAccess for Element {
    fn new() -> Self {
        Self::default()
    }

    fn set_float(&mut self, name: &str, value: f32) -> PropertyAccessResult {
        match name {
            "x" => self.position[0] = value,
            "y" => self.position[1] = value,
            _ => self.position[2] = value,
        }
        PropertyAccessResult::Set
    }

    fn begin_list_int(&mut self, _name: &str, _length: usize) -> BeginList<'_, i32> {
        BeginList::Fill(&mut self.corners)
    }
}

pub(crate) fn run(arguments: &[String]) -> Result<()> {
    let [obj] = arguments else { bail!("usage: io-speed FILE.obj") };
    let obj = Path::new(obj);
    let options = ReadOptions::default();
    let (ours, scan) = fastest(|| read_mesh(obj, &options));
    let mesh = scan?.mesh;
    let (theirs, models) = fastest(|| tobj::load_obj(obj, &tobj::LoadOptions::default()));
    let vertices = |models: &[tobj::Model]| -> usize {
        models.iter().map(|model| model.mesh.positions.len() / 3).sum()
    };
    println!("OBJ  ours {ours:.2} ms, {} vertices", mesh.positions.len());
    println!("OBJ  tobj {theirs:.2} ms, {} vertices", vertices(&models?.0));

    let folder = tempfile::tempdir()?;
    let ply = folder.path().join("copy.ply");
    write_mesh(&ply, &mesh)?;
    let (ours, _) = fastest(|| read_mesh(&ply, &options));
    let (theirs, _) = fastest(|| {
        let bytes = std::fs::read(&ply).unwrap_or_default();
        Parser::<DefaultElement>::new().read_ply(&mut &bytes[..])
    });
    println!("PLY  ours {ours:.2} ms\nPLY  ply-rs-bw {theirs:.2} ms, hash map per element");
    let (theirs, _) = fastest(|| {
        let bytes = std::fs::read(&ply).unwrap_or_default();
        Parser::<Element>::new().read_ply(&mut &bytes[..])
    });
    println!("PLY  ply-rs-bw {theirs:.2} ms, own struct per element");
    for extension in ["obj", "ply", "glb"] {
        let copy = folder.path().join("written").with_extension(extension);
        let (time, written) = fastest(|| write_mesh(&copy, &mesh));
        written?;
        println!("write {extension} {time:.2} ms");
    }
    let (clean, _) = fastest(|| kn_mesh::clean(&mesh));
    println!("clean {clean:.2} ms");
    Ok(())
}
