//! Limits of what a decoder spends on a stream.

/// Limits of a decoder. They are checked before memory is allocated.
///
/// A stream can make a decoder hold at most about `max_unit_bytes` of input and, at once, (180 +
/// 10·Q) bytes for each of `max_vertices` and 1.6 kB for each of `max_faces`, nearly all of the
/// latter while an I-frame decodes. That is for faces that touch no other; scans, whose faces share
/// their corners, take a sixth of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Largest number of vertices of an I-frame.
    pub max_vertices: u32,
    /// Largest number of faces of an I-frame.
    pub max_faces: u32,
    /// Largest number of key nodes of a GoF.
    pub max_nodes: u32,
    /// Largest number of bytes of a unit.
    pub max_unit_bytes: u32,
}

impl Default for Limits {
    /// Enough for scans of four million vertices.
    fn default() -> Self {
        Self { max_vertices: 1 << 22, max_faces: 1 << 23, max_nodes: 4096, max_unit_bytes: 1 << 28 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kn_bitstream::Level;

    #[test]
    fn the_defaults_allow_every_level() {
        let allowed = Limits::default();
        for (number, level) in Level::all() {
            assert!(level.max_vertices <= allowed.max_vertices, "level {number}");
            assert!(level.max_faces <= allowed.max_faces, "level {number}");
            assert!(level.max_nodes <= allowed.max_nodes, "level {number}");
            assert!(level.max_unit_bytes <= allowed.max_unit_bytes, "level {number}");
        }
    }

    #[test]
    #[cfg(feature = "encode")]
    fn the_fit_takes_as_many_nodes_as_the_highest_level() {
        let most = Level::all().map(|(_, level)| level.max_nodes).max();
        assert_eq!(most, u32::try_from(kn_fit::MAX_NODES).ok());
    }
}
