//! The scans of a GoF. P-frames are fitted to them and measured against them.

use crate::encode::choices::DistortionMeasure;
use crate::encode::fault::InputFault;
use crate::encode::tuning::SurrogateTuning;
use crate::error::EncodeError;
use kn_fit::FitTarget;
use kn_mesh::vec3::{cross, norm, sub};
use kn_mesh::{Grid, Mesh};
use kn_metrics::{DEFAULT_LEVELS, Interpolation, Msdm2Surface, msdm2};
use std::sync::Arc;

/// A scan in grid steps.
pub(crate) struct Scan {
    pub(crate) target: FitTarget,
    /// The scan as MSDM2's original, where D is measured by that.
    original: Option<Msdm2Surface>,
    tuning: SurrogateTuning,
}

/// Options of the preparation of scans.
#[derive(Clone, Copy)]
pub(crate) struct ScanOptions {
    pub(crate) grid: Grid,
    /// The measure of D; `None` where nothing is chosen by cost.
    pub(crate) measure: Option<DistortionMeasure>,
    pub(crate) tuning: SurrogateTuning,
}

impl Scan {
    fn new(mesh: &Mesh, options: ScanOptions, frame: u64) -> Result<Self, EncodeError> {
        let ScanOptions { grid, measure, tuning } = options;
        let input = |fault: InputFault| EncodeError::Input { frame, fault };
        let positions = to_grid_steps(&mesh.positions, grid);
        let (target, original) = rayon::join(
            || FitTarget::new(&positions, &mesh.faces),
            || match measure {
                Some(DistortionMeasure::Msdm2) => {
                    Msdm2Surface::new(&positions, &mesh.faces, DEFAULT_LEVELS).map(Some)
                }
                Some(DistortionMeasure::Surrogate) | None => Ok(None),
            },
        );
        let target = target.map_err(|error| input(error.into()))?;
        let original = original.map_err(|error| input(error.into()))?;
        if mesh.labels.is_empty() {
            return Ok(Self { target, original, tuning });
        }
        let labelled = target.with_labels(&mesh.labels);
        Ok(Self { target: labelled.map_err(|error| input(error.into()))?, original, tuning })
    }

    /// D of a decoded frame: `positions` `#V × 3` in reference units, of which `unit` make a grid
    /// step.
    pub(crate) fn distortion(&self, positions: &[[i32; 3]], unit: f64, faces: &[[u32; 3]]) -> f64 {
        let Some(original) = &self.original else {
            return self.surrogate(positions, unit, faces);
        };
        let positions: Vec<[f64; 3]> =
            positions.iter().map(|p| p.map(|c| f64::from(c) / unit)).collect();
        let decoded = Msdm2Surface::new(&positions, faces, DEFAULT_LEVELS);
        decoded.map_or(self.tuning.worst, |decoded| {
            msdm2(original, &decoded, Interpolation::default()).symmetric
        })
    }

    /// The surrogate of MSDM2, which differs from it by a constant for all candidates of a frame.
    fn surrogate(&self, positions: &[[i32; 3]], unit: f64, faces: &[[u32; 3]]) -> f64 {
        let stride = (faces.len() / self.tuning.samples).max(1);
        let sample = |face: &[u32; 3]| -> ([f64; 3], [f64; 3]) {
            let [a, b, c] = face.map(|v| positions[v as usize].map(|c| f64::from(c) / unit));
            let side = |to: [f64; 3]| -> [f64; 3] { std::array::from_fn(|k| to[k] - a[k]) };
            (std::array::from_fn(|k| (a[k] + b[k] + c[k]) / 3.0), cross(side(b), side(c)))
        };
        let (centres, normals): (Vec<_>, Vec<_>) = faces.iter().step_by(stride).map(sample).unzip();
        let deviation = self.target.deviation(&centres, &normals);
        self.tuning.per_distance * deviation.distance + self.tuning.per_bend * deviation.bend
    }
}

/// Frames that are to be coded, in display order.
#[derive(Clone, Copy)]
pub(crate) struct Frames<'a> {
    pub(crate) meshes: &'a [Mesh],
    /// The name that each carries; empty for none.
    pub(crate) names: &'a [String],
    /// Place of the first in display order.
    pub(crate) first: u64,
}

impl<'a> Frames<'a> {
    /// The first frame with its name, and the others.
    pub(crate) fn split_first(self) -> Option<((&'a Mesh, &'a str), Self)> {
        let ((mesh, meshes), (name, names)) =
            self.meshes.split_first().zip(self.names.split_first())?;
        Some(((mesh, name.as_str()), Self { meshes, names, first: self.first + 1 }))
    }
}

/// Whether a mesh has an area, which a fit needs: `corner` gives the position of a vertex.
pub(crate) fn has_area(faces: &[[u32; 3]], corner: impl Fn(u32) -> [f64; 3]) -> bool {
    faces.iter().any(|face| {
        let [a, b, c] = face.map(&corner);
        norm(cross(sub(b, a), sub(c, a))) > 0.0
    })
}

/// The scans of a GoF's P-frames. Each is prepared when its turn comes.
pub(crate) struct Scans<'a> {
    frames: Frames<'a>,
    options: ScanOptions,
    /// The key frame, which is needed before its turn.
    key: Option<(usize, Arc<Scan>)>,
}

impl<'a> Scans<'a> {
    /// The scans up to the first that no fit can use, since it has no area.
    pub(crate) fn new(frames: Frames<'a>, options: ScanOptions) -> Self {
        let usable = |mesh: &&Mesh| {
            has_area(&mesh.faces, |v| grid_steps(mesh.positions[v as usize], options.grid))
        };
        let count = frames.meshes.iter().take_while(usable).count();
        let frames = Frames { meshes: &frames.meshes[..count], ..frames };
        Self { frames, options, key: None }
    }

    pub(crate) fn len(&self) -> usize {
        self.frames.meshes.len()
    }

    /// Index in the sequence and number of faces.
    pub(crate) fn frame(&self, offset: usize) -> (u64, u32) {
        (self.frames.first + offset as u64, self.frames.meshes[offset].faces.len() as u32)
    }

    /// The name that a frame carries; empty for none.
    pub(crate) fn name(&self, offset: usize) -> &'a str {
        &self.frames.names[offset]
    }

    /// # Errors
    /// A mesh that no fit can use.
    pub(crate) fn get(&self, offset: usize) -> Result<Arc<Scan>, EncodeError> {
        match &self.key {
            Some((key, scan)) if *key == offset => Ok(scan.clone()),
            _ => {
                let (mesh, frame) = (&self.frames.meshes[offset], self.frame(offset).0);
                EncodeError::of_frame(frame, || Scan::new(mesh, self.options, frame).map(Arc::new))
            }
        }
    }

    /// The same, and keeps it.
    ///
    /// # Errors
    /// A mesh that no fit can use.
    pub(crate) fn keep(&mut self, offset: usize) -> Result<Arc<Scan>, EncodeError> {
        let scan = self.get(offset)?;
        self.key = Some((offset, scan.clone()));
        Ok(scan)
    }
}

/// Converts world positions to grid steps.
pub(crate) fn to_grid_steps(positions: &[[f64; 3]], grid: Grid) -> Vec<[f64; 3]> {
    positions.iter().map(|&position| grid_steps(position, grid)).collect()
}

fn grid_steps(position: [f64; 3], grid: Grid) -> [f64; 3] {
    std::array::from_fn(|axis| (position[axis] - grid.origin[axis]) / grid.step)
}
