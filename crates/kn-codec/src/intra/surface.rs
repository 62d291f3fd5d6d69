//! What geometry and labels walk over: the conquered connectivity with cut vertices tied together.

use super::conquest::{Conquest, NONE, prev};

/// Connectivity as the vertex passes see it, borrowed from the conquest.
pub(super) struct Surface<'a> {
    pub(super) conquest: &'a Conquest,
    /// `#M` the next vertex that is the same point; itself where none is.
    pub(super) twin: &'a [u32],
}

impl Surface<'_> {
    /// Half-edges that start from `vertex`, once around it.
    #[inline]
    pub(super) fn fan(&self, vertex: u32) -> Fan<'_> {
        let first = self.conquest.corner[vertex as usize];
        Fan { mate: &self.conquest.mate, first, at: first }
    }

    /// The tip of the triangle across half-edge `h`.
    #[inline]
    pub(super) fn across(&self, h: u32) -> u32 {
        self.conquest.origin[prev(self.conquest.mate[h as usize]) as usize]
    }
}

/// Iterates over the half-edges around a vertex of a closed surface.
pub(super) struct Fan<'a> {
    mate: &'a [u32],
    first: u32,
    at: u32,
}

impl Iterator for Fan<'_> {
    type Item = u32;

    #[inline]
    fn next(&mut self) -> Option<u32> {
        if self.at == NONE {
            return None;
        }
        let h = self.at;
        let turned = self.mate[prev(h) as usize];
        self.at = if turned == self.first { NONE } else { turned };
        Some(h)
    }
}
