//! Chunks of vertices: processed on rayon's current pool with the feature `parallel`, else one
//! after the other on the caller's thread. The results are the same bits, since no sum runs over
//! chunks.

#[cfg(feature = "parallel")]
pub(crate) use rayon::prelude::*;

#[cfg(not(feature = "parallel"))]
pub(crate) use serial::Chunks;

#[cfg(not(feature = "parallel"))]
mod serial {
    /// rayon's names on one thread.
    pub(crate) trait Chunks<T> {
        fn par_chunks(&self, size: usize) -> std::slice::Chunks<'_, T>;
        fn par_chunks_mut(&mut self, size: usize) -> std::slice::ChunksMut<'_, T>;
    }

    impl<T> Chunks<T> for [T] {
        fn par_chunks(&self, size: usize) -> std::slice::Chunks<'_, T> {
            self.chunks(size)
        }

        fn par_chunks_mut(&mut self, size: usize) -> std::slice::ChunksMut<'_, T> {
            self.chunks_mut(size)
        }
    }
}
