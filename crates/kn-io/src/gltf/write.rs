//! Meshes and whole sequences as one GLB file that any viewer plays.
//!
//! Frames that share their faces become one mesh with a morph target per further frame, switched
//! by weights that jump from frame to frame; where the faces change, another mesh takes over,
//! and its node is scaled from nothing to full size while it is on. In an empty frame none is on.

use super::super::atomic::temporary_beside;
use super::super::{MeshError, MeshErrorKind, write_atomically};
use kn_mesh::vec3::sub;
use kn_mesh::{Mesh, Precision};
use serde_json::{Value, json};
use std::fs::File;
use std::io::{self, BufWriter, Read, Seek, Write};
use std::path::{Path, PathBuf};
use tempfile::TempPath;

/// Most morph targets of one mesh: the weights of a mesh grow with the square of its frames.
const MAX_TARGETS: usize = 255;

/// Largest binary chunk: the file's length must fit 32 bits, with room for the JSON.
const MAX_BINARY_BYTES: u64 = u32::MAX as u64 - (1 << 28);

const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;
const UNSIGNED_INT: u32 = 5125;
const FLOAT: u32 = 5126;

/// Writes a sequence of meshes into one GLB file.
///
/// Frames go to a temporary file beside the output as they come, so that memory holds one mesh
/// however long the sequence is; nothing is at the output's path before [`GlbWriter::finish`].
/// Coordinates are binary32. Where the first frame lies so far out that it needs more
/// ([`Mesh::precision`]), they are relative to the middle of its box, and nodes there move them back.
/// The first frame of a run with the same faces is stored in these coordinates, the others as
/// differences from it. Labels are not carried.
#[derive(Debug)]
pub struct GlbWriter {
    path: PathBuf,
    frame_rate: f64,
    binary: BufWriter<File>,
    /// Removes the temporary file when dropped.
    _spool: TempPath,
    length: u64,
    views: Vec<Value>,
    accessors: Vec<Value>,
    runs: Vec<Run>,
    /// The place of all nodes.
    origin: [f64; 3],
    /// The first frame of the last run; empty behind an empty frame.
    base: Mesh,
    /// Number of frames so far.
    frames: usize,
}

/// Frames with the same faces.
#[derive(Debug)]
struct Run {
    frames: std::ops::Range<usize>,
    positions: usize,
    indices: usize,
    targets: Vec<usize>,
}

impl GlbWriter {
    /// Starts a file with this number of frames per second.
    ///
    /// # Errors
    /// The folder is missing or not writable, or the frame rate is not positive.
    pub fn create(path: &Path, frame_rate: f64) -> Result<Self, MeshError> {
        if !(frame_rate.is_finite() && frame_rate > 0.0) {
            let what = format!("a frame rate of {frame_rate}");
            return Err(MeshError::new(path, MeshErrorKind::Unsupported(what)));
        }
        let temporary = temporary_beside(path).map_err(|error| MeshError::new(path, error))?;
        let (file, spool) = temporary.into_parts();
        Ok(Self {
            path: path.to_owned(),
            frame_rate,
            binary: BufWriter::with_capacity(1 << 16, file),
            _spool: spool,
            length: 0,
            views: Vec::new(),
            accessors: Vec::new(),
            runs: Vec::new(),
            origin: [0.0; 3],
            base: Mesh::default(),
            frames: 0,
        })
    }

    /// Adds the next frame. A mesh without vertices is an empty frame.
    ///
    /// # Errors
    /// The mesh is not valid or has vertices and no faces, the disk is full, or the file gets longer
    /// than GLB allows (4 GiB).
    pub fn push(&mut self, mesh: &Mesh) -> Result<(), MeshError> {
        let frame = self.frames;
        let failed = |kind| MeshError::new(&self.path, kind).in_frame(frame);
        mesh.check().map_err(|fault| failed(MeshErrorKind::Malformed(fault.to_string())))?;
        if mesh.is_empty() {
            self.frames += 1;
            self.base.clear();
            return Ok(());
        }
        if mesh.faces.is_empty() {
            return Err(failed(MeshErrorKind::NoFaces));
        }
        let added = 12 * (mesh.positions.len() + mesh.faces.len()) as u64;
        if self.length + added > MAX_BINARY_BYTES {
            let what = "bytes in a GLB file";
            let asked = self.length + added;
            return Err(failed(MeshErrorKind::TooLarge { what, asked, allowed: MAX_BINARY_BYTES }));
        }
        let appended = self.append(frame, mesh);
        appended.map_err(|error| MeshError::new(&self.path, error).in_frame(frame))?;
        self.frames += 1;
        Ok(())
    }

    fn append(&mut self, frame: usize, mesh: &Mesh) -> io::Result<()> {
        if self.runs.is_empty() {
            self.origin = origin_of(mesh);
        }
        let same = self.base.faces == mesh.faces
            && self.base.positions.len() == mesh.positions.len()
            && self.runs.last().is_some_and(|run| run.targets.len() < MAX_TARGETS);
        if !same {
            let indices = self.write_indices(&mesh.faces)?;
            let origin = self.origin;
            let place = |p: &[f64; 3]| sub(*p, origin).map(|x| x as f32);
            let positions = self.write_vectors(mesh.positions.iter().map(place), vertex_view())?;
            self.base.clone_from(mesh);
            self.runs.push(Run { frames: frame..frame + 1, positions, indices, targets: vec![] });
            return Ok(());
        }
        let base = std::mem::take(&mut self.base);
        let offset = |(from, to): (&[f64; 3], &[f64; 3])| sub(*to, *from).map(|x| x as f32);
        let offsets = base.positions.iter().zip(&mesh.positions).map(offset);
        let target = self.write_vectors(offsets, vertex_view());
        self.base = base;
        let target = target?;
        if let Some(run) = self.runs.last_mut() {
            run.targets.push(target);
            run.frames.end += 1;
        }
        Ok(())
    }

    /// Completes the file and puts it in its place.
    ///
    /// # Errors
    /// There are no frames, or the disk is full; then nothing is left behind.
    pub fn finish(mut self) -> Result<(), MeshError> {
        if self.frames == 0 {
            let kind = MeshErrorKind::Empty("there is no frame to write");
            return Err(MeshError::new(&self.path, kind));
        }
        let path = self.path.clone();
        let failed = |error: io::Error| MeshError::new(&path, error);
        let json = self.document().map_err(failed)?.to_string();
        let length = self.length;
        let mut binary = self.binary.into_inner().map_err(|error| failed(error.into_error()))?;
        binary.rewind().map_err(failed)?;
        write_atomically(&path, |out| write_chunks(&json, length, &mut binary, out))
    }

    /// The JSON of all that was written; adds the key frames of the animation to it.
    fn document(&mut self) -> io::Result<Value> {
        let runs = std::mem::take(&mut self.runs);
        if runs.is_empty() {
            // glTF allows no empty list.
            let asset = json!({ "version": "2.0", "generator": "kn" });
            return Ok(json!({ "asset": asset, "scene": 0, "scenes": [{}] }));
        }
        let animation = self.write_animation(&runs)?;
        let meshes: Vec<Value> = runs.iter().map(mesh_of).collect();
        let nodes: Vec<Value> = (0..runs.len()).map(|run| node_of(run, self.origin)).collect();
        let mut document = json!({
            "asset": { "version": "2.0", "generator": "kn" },
            "scene": 0,
            "scenes": [{ "nodes": (0..runs.len()).collect::<Vec<_>>() }],
            "nodes": nodes,
            "meshes": meshes,
            "accessors": std::mem::take(&mut self.accessors),
            "bufferViews": std::mem::take(&mut self.views),
            "buffers": [{ "byteLength": self.length }],
        });
        if let Some(animation) = animation {
            document["animations"] = json!([animation]);
        }
        Ok(document)
    }

    /// The animation of all runs; `None` for a single frame.
    fn write_animation(&mut self, runs: &[Run]) -> io::Result<Option<Value>> {
        let (mut samplers, mut channels) = (Vec::new(), Vec::new());
        let mut add = |node: usize, path: &str, (input, output): (usize, usize)| {
            channels.push(json!({
                "sampler": samplers.len(), "target": { "node": node, "path": path },
            }));
            samplers.push(json!({
                "input": input, "output": output, "interpolation": "STEP",
            }));
        };
        let last = self.frames;
        let changes = runs.iter().any(|run| run.frames != (0..last));
        for (node, run) in runs.iter().enumerate() {
            if !run.targets.is_empty() {
                let weights = one_hot(run.frames.len());
                let times = self.write_times(run.frames.clone())?;
                add(node, "weights", (times, self.write_scalars(&weights)?));
            }
            if changes {
                let (frames, on) = switches(run, last);
                let times = self.write_times(frames.into_iter())?;
                let scales = on.iter().map(|&on| [f32::from(u8::from(on)); 3]);
                add(node, "scale", (times, self.write_vectors(scales, json!({}))?));
            }
        }
        let animated = !channels.is_empty();
        Ok(animated.then(|| json!({ "samplers": samplers, "channels": channels })))
    }

    fn write_times(&mut self, frames: impl Iterator<Item = usize>) -> io::Result<usize> {
        let times: Vec<f32> = frames.map(|frame| (frame as f64 / self.frame_rate) as f32).collect();
        self.write_scalars(&times)
    }

    fn write_scalars(&mut self, values: &[f32]) -> io::Result<usize> {
        for value in values {
            self.binary.write_all(&value.to_le_bytes())?;
        }
        let (min, max) = bounds(values.iter().map(|&value| [value]));
        let view = json!({});
        let accessor = json!({
            "componentType": FLOAT, "count": values.len(), "type": "SCALAR",
            "min": min, "max": max,
        });
        Ok(self.add_accessor(4 * values.len() as u64, view, accessor))
    }

    fn write_vectors(
        &mut self,
        vectors: impl Iterator<Item = [f32; 3]> + Clone,
        view: Value,
    ) -> io::Result<usize> {
        let mut count = 0;
        for vector in vectors.clone() {
            for coordinate in vector {
                self.binary.write_all(&coordinate.to_le_bytes())?;
            }
            count += 1;
        }
        let (min, max) = bounds(vectors);
        let accessor = json!({
            "componentType": FLOAT, "count": count, "type": "VEC3", "min": min, "max": max,
        });
        Ok(self.add_accessor(12 * count, view, accessor))
    }

    fn write_indices(&mut self, faces: &[[u32; 3]]) -> io::Result<usize> {
        for index in faces.iter().flatten() {
            self.binary.write_all(&index.to_le_bytes())?;
        }
        let count = 3 * faces.len() as u64;
        let view = json!({ "target": ELEMENT_ARRAY_BUFFER });
        let accessor = json!({ "componentType": UNSIGNED_INT, "count": count, "type": "SCALAR" });
        Ok(self.add_accessor(4 * count, view, accessor))
    }

    /// Registers the bytes just written; returns the number of the accessor to them.
    fn add_accessor(&mut self, bytes: u64, mut view: Value, mut accessor: Value) -> usize {
        view["buffer"] = json!(0);
        view["byteOffset"] = json!(self.length);
        view["byteLength"] = json!(bytes);
        accessor["bufferView"] = json!(self.views.len());
        self.length += bytes;
        self.views.push(view);
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }
}

fn vertex_view() -> Value {
    json!({ "target": ARRAY_BUFFER })
}

fn mesh_of(run: &Run) -> Value {
    let mut primitive =
        json!({ "attributes": { "POSITION": run.positions }, "indices": run.indices });
    if run.targets.is_empty() {
        return json!({ "primitives": [primitive] });
    }
    let targets = run.targets.iter().map(|target| json!({ "POSITION": target }));
    primitive["targets"] = targets.collect();
    json!({ "primitives": [primitive], "weights": vec![0.0; run.targets.len()] })
}

/// The place that coordinates are relative to. It is a binary32 number too, so that every viewer
/// has it exactly.
fn origin_of(mesh: &Mesh) -> [f64; 3] {
    match (mesh.precision(), mesh.bounding_box()) {
        (Precision::Double, Some(bounds)) => bounds.middle().map(|x| f64::from(x as f32)),
        _ => [0.0; 3],
    }
}

/// Without animation a viewer shows the first run alone.
fn node_of(run: usize, origin: [f64; 3]) -> Value {
    let mut node = json!({ "mesh": run });
    if run > 0 {
        node["scale"] = json!([0.0, 0.0, 0.0]);
    }
    if origin != [0.0; 3] {
        node["translation"] = json!(origin);
    }
    node
}

/// The weights of a run's targets in each of its frames: none in the first, then one by one.
fn one_hot(frames: usize) -> Vec<f32> {
    let targets = frames - 1;
    let mut weights = vec![0.0; frames * targets];
    for target in 0..targets {
        weights[(target + 1) * targets + target] = 1.0;
    }
    weights
}

/// The frames at which a run goes on and off, of `last` in all. The last key is at the last frame
/// where empty frames end the sequence, so that the animation is as long.
fn switches(run: &Run, last: usize) -> (Vec<usize>, Vec<bool>) {
    let mut keys = vec![(run.frames.start, true)];
    if run.frames.start > 0 {
        keys.insert(0, (0, false));
    }
    if run.frames.end < last {
        keys.push((run.frames.end, false));
    }
    if run.frames.end + 1 < last {
        keys.push((last - 1, false));
    }
    keys.into_iter().unzip()
}

fn bounds<const N: usize>(vectors: impl Iterator<Item = [f32; N]>) -> (Vec<f32>, Vec<f32>) {
    let (mut min, mut max) = ([f32::INFINITY; N], [f32::NEG_INFINITY; N]);
    for vector in vectors {
        for axis in 0..N {
            min[axis] = min[axis].min(vector[axis]);
            max[axis] = max[axis].max(vector[axis]);
        }
    }
    (min.to_vec(), max.to_vec())
}

/// Header, JSON chunk and, where there are bytes, a binary chunk.
fn write_chunks(
    json: &str,
    binary_length: u64,
    binary: &mut dyn Read,
    out: &mut dyn Write,
) -> io::Result<()> {
    let padding = json.len().next_multiple_of(4) - json.len();
    let json_length = (json.len() + padding) as u64;
    let total = 12 + 8 + json_length + if binary_length > 0 { 8 + binary_length } else { 0 };
    let word = |value: u64| {
        let value = u32::try_from(value);
        value.map(u32::to_le_bytes).map_err(|_| io::Error::other("more than 4 GiB, GLB's limit"))
    };
    out.write_all(b"glTF\x02\0\0\0")?;
    out.write_all(&word(total)?)?;
    out.write_all(&word(json_length)?)?;
    out.write_all(b"JSON")?;
    out.write_all(json.as_bytes())?;
    out.write_all(&b"   "[..padding])?;
    if binary_length == 0 {
        return Ok(());
    }
    out.write_all(&word(binary_length)?)?;
    out.write_all(b"BIN\0")?;
    io::copy(binary, out)?;
    Ok(())
}
