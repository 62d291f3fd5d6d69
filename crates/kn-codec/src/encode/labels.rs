//! Labels of frames that come without labels.

use crate::encode::choices::LabelChoice;
use crate::encode::config::EncoderConfig;
use kn_mesh::Mesh;
use kn_segment::{SegmentOptions, Segmentation, Segmenter};

/// Finds the labels of the frames of a sequence, in their order.
pub(crate) struct Labeller {
    segmenter: Segmenter,
}

impl Labeller {
    /// `None` where nobody asks for labels, or nothing would use them: I-frames alone need none.
    pub(crate) fn new(config: &EncoderConfig) -> Option<Self> {
        let wanted = config.intra.labels == LabelChoice::Auto && config.sequence.group_length > 1;
        let options = SegmentOptions { up_axis: config.sequence.up_axis };
        wanted.then(|| Self { segmenter: Segmenter::new(options) })
    }

    /// Labels the next frame. Only those of I-frames are coded, but every frame is looked at, so
    /// that parts are followed from one to the next. The labels go to the mesh; the rest of what
    /// was found is returned.
    pub(crate) fn label(&mut self, mesh: &mut Mesh) -> Segmentation {
        let found = self.segmenter.segment(&mesh.positions, &mesh.faces);
        // What cannot even be looked at (it has no area) is no person.
        let mut found = found.unwrap_or_else(|_| Segmentation::nobody(mesh.positions.len()));
        mesh.labels = std::mem::take(&mut found.labels);
        found
    }
}
