//! Frames that the motion does not explain: they begin a new GoF. The fit is judged here; what is decoded
//! afterwards keeps the bound of `frame_error`.

use kn_fit::{FitMeasures, FitReport, MeasureOptions};
use std::fmt;

/// Thresholds that decide whether the motion explains a fitted frame. The values come from
/// sequences in which limbs, balls and hems leave the body (`docs/notes/fit.md`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FailureTuning {
    /// Options of the fit's measures: which points are far, and which edges are torn.
    pub measures: MeasureOptions,
    /// A frame is not explained when one region of far points has this share of its mesh's area ...
    pub unexplained: f64,
    /// ... and the area of this number of vertices: the scanner's holes are that large on a coarse
    /// mesh.
    pub unexplained_vertices: f64,
    /// A frame is not explained when torn edges span this share of the diagonal's square. A hem
    /// that leaves the thighs had 0.005 and was not worth an I-frame, a ball that is let go 0.018.
    pub torn: f64,
    /// A frame is not explained when this share of the area of either mesh found no partner ...
    pub unmatched: f64,
    /// ... and the area of this number of vertices: more of a coarse mesh's surface lies near a
    /// border.
    pub unmatched_vertices: f64,
    /// A frame is not explained either when this part of that share found no partner ...
    pub unmatched_anew: f64,
    /// ... and the share is this many times that of any earlier frame of the GoF.
    pub more_unmatched: f64,
    /// A frame is not explained when the 95th percentile of its distances is this many times that
    /// of any earlier frame of the GoF ...
    pub worse: f64,
    /// ... and this share of the diagonal.
    pub notable: f64,
}

impl Default for FailureTuning {
    fn default() -> Self {
        Self {
            measures: MeasureOptions { far: 0.025, stretched: 3.0, grown: 0.01, gaping: 0.25 },
            unexplained: 0.004,
            unexplained_vertices: 16.0,
            torn: 0.01,
            unmatched: 0.05,
            unmatched_vertices: 150.0,
            unmatched_anew: 0.7,
            more_unmatched: 1.75,
            worse: 3.0,
            notable: 0.005,
        }
    }
}

/// The reason why the motion does not explain a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FitFailure {
    /// A part of the reference has no scan near it: a lost limb, a ball let go.
    ReferenceUnexplained {
        /// Its share of the reference's area.
        share: f64,
        /// The reference's vertex that is farthest from the scan.
        vertex: u32,
    },
    /// A part of the scan has no reference near it: something new, or a limb that the reference did
    /// not follow.
    FrameUnexplained {
        /// Its share of the scan's area.
        share: f64,
        /// The scan's vertex that is farthest from the reference.
        vertex: u32,
    },
    /// Edges of the reference had to stretch: what was one surface comes apart, a ball leaves its
    /// hand or two people part.
    Torn {
        /// The length of the tear as a share of the diagonal of the scan's box.
        length: f64,
        /// The area that gapes as a share of the diagonal's square; this decides.
        area: f64,
        /// A vertex of the reference at its longest edge.
        vertex: u32,
    },
    /// Much of a surface faces the other way or a border than what is nearest to it.
    Unmatched {
        /// The share of the area, of the mesh where it is larger.
        share: f64,
    },
    /// The distances are far beyond those of the frames before.
    Worse {
        /// 95th percentile relative to the largest of the earlier frames of the GoF.
        ratio: f64,
    },
    /// The decoded P-frame would be farther from the scan than [`crate::MotionConfig::max_error`]
    /// allows.
    Distant {
        /// Its RMS distance, as in [`crate::FrameError::rms`].
        rms: f64,
        /// The bound for it.
        bound: f64,
    },
    /// A region of the decoded P-frame or of the scan would be farther from the other than
    /// [`crate::MotionConfig::max_error`] allows.
    DistantRegion {
        /// Its share of its mesh's area.
        share: f64,
        /// Its RMS distance, as a share of the scan's size.
        distance: f64,
        /// The bound for its part, as in [`crate::FrameError::region`].
        bound: f64,
    },
    /// The frame has no area, or nothing is left on the grid of the I-frame before it: there is
    /// nothing that a motion could lead to or start from.
    NoArea,
}

/// The largest values of the frames of a GoF so far, which the next is compared with.
#[derive(Clone, Copy, Debug, Default)]
pub struct EarlierFrames {
    frames: usize,
    /// 95th percentile of the distances.
    p95: f64,
    /// Share of the area without a partner.
    unmatched: f64,
}

impl EarlierFrames {
    /// Remembers a frame, so that later ones are compared with it.
    pub fn remember(&mut self, report: &FitReport) {
        self.frames += 1;
        self.p95 = self.p95.max(p95(report));
        self.unmatched = self.unmatched.max(unmatched(report));
    }
}

impl FailureTuning {
    /// Judges the report of a fit. Returns the first reason why the motion does not explain the
    /// frame, or `None` where it does. `earlier` has the GoF's earlier P-frames. The fit must have
    /// been asked for [`Self::measures`].
    pub fn judge(&self, report: &FitReport, earlier: &EarlierFrames) -> Option<FitFailure> {
        let measures = report.measures.as_ref()?;
        self.missing(measures)
            .or_else(|| self.torn(measures))
            .or_else(|| self.unusual(report, measures, earlier))
    }

    /// The larger of the largest far regions of both meshes, where it is large enough.
    fn missing(&self, measures: &FitMeasures) -> Option<FitFailure> {
        let FitMeasures { lost, new, .. } = measures;
        let notable =
            |vertices: usize| self.unexplained.max(self.unexplained_vertices / vertices as f64);
        let is_lost = lost.share >= notable(measures.source_vertices);
        let is_new = new.share >= notable(measures.target_vertices);
        if is_lost && (!is_new || lost.share >= new.share) {
            Some(FitFailure::ReferenceUnexplained { share: lost.share, vertex: lost.vertex })
        } else if is_new {
            Some(FitFailure::FrameUnexplained { share: new.share, vertex: new.vertex })
        } else {
            None
        }
    }

    fn torn(&self, measures: &FitMeasures) -> Option<FitFailure> {
        let kn_fit::Tear { length, area, vertex } = measures.tear;
        (area > self.torn).then_some(FitFailure::Torn { length, area, vertex })
    }

    fn unusual(
        &self,
        report: &FitReport,
        measures: &FitMeasures,
        earlier: &EarlierFrames,
    ) -> Option<FitFailure> {
        let share = unmatched(report);
        let vertices = measures.source_vertices.min(measures.target_vertices);
        let limit = self.unmatched.max(self.unmatched_vertices / vertices as f64);
        let compared = earlier.frames > 0;
        let anew = (self.more_unmatched * earlier.unmatched).max(self.unmatched_anew * limit);
        if share > limit || (compared && share > anew) {
            return Some(FitFailure::Unmatched { share });
        }
        let (now, worst) = (p95(report), earlier.p95);
        let worse = compared && now > self.worse * worst && now > self.notable * measures.diagonal;
        worse.then(|| FitFailure::Worse { ratio: now / worst })
    }
}

/// The larger 95th percentile of both directions.
fn p95(report: &FitReport) -> f64 {
    report.source_to_target.p95.max(report.target_to_source.p95)
}

/// The larger share without a partner of both directions.
fn unmatched(report: &FitReport) -> f64 {
    report.source_to_target.unmatched.max(report.target_to_source.unmatched)
}

impl fmt::Display for FitFailure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let percent = |share: &f64| 100.0 * share;
        match self {
            Self::ReferenceUnexplained { share, vertex } => write!(
                f,
                "{:.1} % of the reference, around its vertex {vertex}, is not in the frame",
                percent(share)
            ),
            Self::FrameUnexplained { share, vertex } => write!(
                f,
                "{:.1} % of the frame, around its vertex {vertex}, is not explained by the reference",
                percent(share)
            ),
            Self::Torn { length, area, vertex } => write!(
                f,
                "the reference comes apart around its vertex {vertex}, along {:.1} % of the diagonal \
                 and by {:.1} % of its square",
                percent(length),
                percent(area)
            ),
            Self::Unmatched { share } => {
                write!(f, "{:.1} % of the surface has no partner", percent(share))
            }
            Self::Worse { ratio } => {
                write!(f, "distances are {ratio:.1} times those of the frames before")
            }
            Self::Distant { rms, bound } => write!(
                f,
                "a P-frame would be {:.1} % of the scan's size away from it (RMS), more than the \
                 bound of {:.1} %",
                percent(rms),
                percent(bound)
            ),
            Self::DistantRegion { share, distance, bound } => write!(
                f,
                "{:.1} % of the surface would be {:.1} % of the scan's size away in a P-frame, which \
                 is more than the bound of {:.1} % for regions",
                percent(share),
                percent(distance),
                percent(bound)
            ),
            Self::NoArea => f.write_str("it has no area, or the I-frame before it has none"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kn_fit::{Region, Residuals, Tear};

    /// A frame of 10,000 vertices on either side that leaves nothing unexplained.
    fn sound() -> (FitReport, FitMeasures) {
        let measures = FitMeasures {
            diagonal: 2.0,
            source_vertices: 10_000,
            target_vertices: 10_000,
            ..FitMeasures::default()
        };
        let near = Residuals { p95: 0.002, unmatched: 0.01, ..Residuals::default() };
        (FitReport { source_to_target: near, ..FitReport::default() }, measures)
    }

    fn judge(
        report: FitReport,
        measures: FitMeasures,
        earlier: &EarlierFrames,
    ) -> Option<FitFailure> {
        let report = FitReport { measures: Some(measures), ..report };
        FailureTuning::default().judge(&report, earlier)
    }

    #[test]
    fn the_larger_region_is_the_reason() {
        let (report, measures) = sound();
        let none = EarlierFrames::default();
        assert_eq!(judge(report.clone(), measures, &none), None);
        let region = |share: f64, vertex: u32| Region { share, vertex };
        let speck = FitMeasures { lost: region(0.003, 7), new: region(0.0039, 8), ..measures };
        assert_eq!(judge(report.clone(), speck, &none), None);
        let limb = FitMeasures { lost: region(0.05, 7), new: region(0.01, 8), ..measures };
        let lost = FitFailure::ReferenceUnexplained { share: 0.05, vertex: 7 };
        assert_eq!(judge(report.clone(), limb, &none), Some(lost));
        let head = FitMeasures { lost: region(0.003, 7), new: region(0.01, 8), ..measures };
        let new = FitFailure::FrameUnexplained { share: 0.01, vertex: 8 };
        assert_eq!(judge(report.clone(), head, &none), Some(new));
        // The holes of a coarse mesh are as large.
        assert_eq!(judge(report, FitMeasures { target_vertices: 1_500, ..head }, &none), None);
    }

    #[test]
    fn a_tear_is_judged_by_its_area() {
        let (report, measures) = sound();
        let torn = |area: f64| {
            let tear = Tear { length: 0.2, area, vertex: 5 };
            judge(report.clone(), FitMeasures { tear, ..measures }, &EarlierFrames::default())
        };
        assert_eq!(torn(0.005), None);
        assert_eq!(torn(0.018), Some(FitFailure::Torn { length: 0.2, area: 0.018, vertex: 5 }));
    }

    #[test]
    fn a_frame_is_compared_with_those_before() {
        let (report, measures) = sound();
        let mut earlier = EarlierFrames::default();
        let far = Residuals { p95: 0.02, unmatched: 0.01, ..Residuals::default() };
        let far = FitReport { target_to_source: far, ..report.clone() };
        assert_eq!(judge(far.clone(), measures, &earlier), None);
        let alone = Residuals { p95: 0.002, unmatched: 0.04, ..Residuals::default() };
        let alone = FitReport { target_to_source: alone, ..report.clone() };
        assert_eq!(judge(alone.clone(), measures, &earlier), None);
        earlier.remember(&report);
        assert_eq!(judge(far, measures, &earlier), Some(FitFailure::Worse { ratio: 10.0 }));
        assert_eq!(judge(alone, measures, &earlier), Some(FitFailure::Unmatched { share: 0.04 }));
    }
}
