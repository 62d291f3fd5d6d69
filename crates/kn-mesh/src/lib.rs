//! Triangle meshes on floats and on the sequence's integer grid, what scans need before they can
//! be coded, and (behind features) files and the synthetic performer.
//!
//! Public data are plain arrays: positions `[f32; 3]` in world units or `[i32; 3]` in grid steps,
//! faces `[u32; 3]`, one label byte per vertex.

pub mod adjacency;
mod clean;
mod exact;
mod grid;
#[cfg(feature = "io")]
pub mod io;
mod mesh;
pub mod parts;
#[cfg(feature = "performer")]
pub mod performer;

pub use clean::{CleanReport, Cleaned, DROPPED, clean};
pub use exact::{Coordinate, ExactGrid, ExactGridError};
pub use grid::{Grid, GridError};
pub use mesh::{BoundingBox, GridMesh, Mesh, MeshFault};
