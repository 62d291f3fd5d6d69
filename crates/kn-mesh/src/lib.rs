//! Triangle meshes in world units and on the sequence's integer grid, the cleaning that a scan needs
//! before it can be coded, and adjacency.
//!
//! Public data are plain arrays: positions `[f32; 3]` in world units or `[i32; 3]` in grid steps,
//! faces `[u32; 3]`, one label byte per vertex.

pub mod adjacency;
mod clean;
mod exact;
mod grid;
mod mesh;
pub mod parts;

pub use clean::{CleanReport, Cleaned, DROPPED, clean};
pub use exact::{Coordinate, ExactGrid, ExactGridError};
pub use grid::{Grid, GridError};
pub use mesh::{BoundingBox, GridMesh, Mesh, MeshFault};
