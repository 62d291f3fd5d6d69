//! The decoded frames that later frames of a GoF may be deformed from.

/// A decoded frame of a GoF: the positions and the key nodes that a P-frame is deformed from.
#[derive(Clone, Debug, Default)]
pub(crate) struct Reference {
    /// `#V × 3`, in reference units.
    pub(crate) positions: Vec<[i32; 3]>,
    /// `#N × 3`, the key nodes in this frame, in reference units; empty before they are placed.
    pub(crate) nodes: Vec<[i32; 3]>,
}

/// Names a slot of a [`ReferencePool`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Slot(u8);

/// Number of slots: one for each frame that may be referred to, and one for the frame that is being
/// decoded.
/// Streams of this version refer to the last decoded frame alone.
const SLOTS: usize = 2;

/// A few references in slots. A frame is decoded from one slot into a free one, whose buffers are
/// reused; nothing is copied.
#[derive(Clone, Debug, Default)]
pub(crate) struct ReferencePool {
    slots: [Reference; SLOTS],
    /// Whether the frame in a slot may still be referred to.
    kept: [bool; SLOTS],
    last: Slot,
}

impl ReferencePool {
    /// Begins a GoF: every slot is free.
    pub(crate) fn clear(&mut self) {
        self.kept = [false; SLOTS];
    }

    /// A free slot. A caller that keeps a frame releases another before the pool is full.
    pub(crate) fn free(&self) -> Slot {
        let free = self.kept.iter().position(|kept| !kept);
        debug_assert!(free.is_some(), "no slot was released");
        Slot(free.unwrap_or(0) as u8)
    }

    /// Keeps the frame in `slot` as the last decoded one. Frames may refer to it until it is
    /// released.
    pub(crate) fn keep(&mut self, slot: Slot) {
        self.kept[usize::from(slot.0)] = true;
        self.last = slot;
    }

    /// Frees `slot`: no later frame refers to it.
    pub(crate) fn release(&mut self, slot: Slot) {
        self.kept[usize::from(slot.0)] = false;
    }

    /// The slot of the last decoded frame.
    pub(crate) fn last(&self) -> Slot {
        self.last
    }

    /// The frame in a slot.
    pub(crate) fn get(&self, slot: Slot) -> &Reference {
        &self.slots[usize::from(slot.0)]
    }

    /// The same, to be written.
    pub(crate) fn get_mut(&mut self, slot: Slot) -> &mut Reference {
        &mut self.slots[usize::from(slot.0)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frame_is_decoded_beside_its_reference() {
        let mut pool = ReferencePool::default();
        let first = pool.free();
        pool.get_mut(first).positions = vec![[1; 3]];
        pool.keep(first);
        for frame in 2..6 {
            let (from, into) = (pool.last(), pool.free());
            assert_ne!(from, into);
            pool.get_mut(into).positions = vec![[frame; 3]];
            assert_eq!(pool.get(from).positions, [[frame - 1; 3]]);
            pool.keep(into);
            pool.release(from);
            assert_eq!(pool.last(), into);
        }
        pool.clear();
        assert_eq!(pool.free(), first);
    }
}
