//! Levels: limits that a stream keeps (chapter 9).

use crate::tables::levels::LEVELS;

/// Positions on the output grid and node positions are smaller than this in magnitude.
pub const COORDINATE_LIMIT: i32 = 1 << 20;

/// The limits of one level.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Level {
    /// Largest number of vertices of a frame.
    pub max_vertices: u32,
    /// Largest number of faces of a frame.
    pub max_faces: u32,
    /// Largest number of key nodes of a GoF.
    pub max_nodes: u32,
    /// Largest number of frames of a GoF.
    pub max_group_frames: u32,
    /// Largest value of `unit_size`.
    pub max_unit_bytes: u32,
}

impl Level {
    /// The level with this number, `None` where there is none.
    pub fn numbered(level: u8) -> Option<Self> {
        LEVELS.get(usize::from(level)).copied()
    }

    /// All levels, the lowest first.
    pub fn all() -> impl Iterator<Item = (u8, Self)> {
        (0_u8..).zip(LEVELS)
    }
}
