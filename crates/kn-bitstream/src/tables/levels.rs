//! The limits of the levels. Generated from `spec/tables/levels.csv`: do not edit.

use crate::level::Level;

#[rustfmt::skip]
pub(crate) const LEVELS: [Level; 3] = [
    Level { max_vertices: 65536, max_faces: 131072, max_nodes: 512, max_group_frames: 32, max_unit_bytes: 2097152 },
    Level { max_vertices: 262144, max_faces: 524288, max_nodes: 2048, max_group_frames: 255, max_unit_bytes: 8388608 },
    Level { max_vertices: 2097152, max_faces: 4194304, max_nodes: 4096, max_group_frames: 255, max_unit_bytes: 67108864 },
];
