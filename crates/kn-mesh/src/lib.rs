//! Triangle meshes in world units and on the sequence's integer grid, the cleaning that a scan needs
//! before it can be coded, and adjacency.
//!
//! Public data are plain arrays: positions `[f64; 3]` in world units or `[i32; 3]` in grid steps,
//! faces `[u32; 3]`, one label byte per vertex.

pub mod adjacency;
mod bounds;
mod clean;
mod exact;
mod grid;
mod mesh;
mod panic;
mod select;
pub mod vec3;

pub use bounds::BoundingBox;
pub use clean::{CleanReport, Cleaned, clean};
pub use exact::{Coordinate, ExactGrid, ExactGridError};
pub use grid::{Grid, GridError, GridToWorld, Precision};
pub use mesh::{GridMesh, MAX_COORDINATE, Mesh, MeshFault, TriangleMesh};
pub use panic::caught;
pub use select::{DROPPED, VertexMap, compose};
