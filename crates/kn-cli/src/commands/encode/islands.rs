//! The note about islands of noise, which suggests to leave them out.

use crate::arguments::Global;
use kn_mesh::{ComponentAreas, Islands, Mesh};
use serde_json::{Value, json};

/// Pieces with less of a frame's area are islands.
const SHARE: f64 = 0.001;
/// The note is printed where a frame has so many islands, in the mean.
const NOTABLE: f64 = 5.0;

/// The islands of the frames so far.
#[derive(Debug, Default)]
pub(super) struct IslandNote {
    frames: usize,
    /// Number of islands in all frames.
    count: usize,
    /// Sum of their shares of the area of each frame.
    share: f64,
}

impl IslandNote {
    /// Counts the islands of a frame, for the report.
    pub(super) fn add(&mut self, mesh: &Mesh) -> Value {
        let Islands { count, share } =
            ComponentAreas::new(&mesh.positions, &mesh.faces).islands(SHARE);
        self.frames += 1;
        self.count += count;
        self.share += share;
        json!({ "count": count, "share": share })
    }

    /// Tells the user how many islands there are, where they are many.
    pub(super) fn tell(&self, global: &Global) {
        let mean = |sum: f64| sum / self.frames.max(1) as f64;
        let count = mean(self.count as f64);
        if count < NOTABLE {
            return;
        }
        global.note(format_args!(
            "islands: {count:.0} pieces a frame have less than {0}% of the area each, {1:.2}% of it \
             together; --drop-islands {0}% leaves them out",
            100.0 * SHARE,
            100.0 * mean(self.share),
        ));
    }
}
