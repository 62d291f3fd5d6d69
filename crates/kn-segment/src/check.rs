//! Check of labels from other tools against their mesh.

use super::error::SegmentError;
use super::pieces::{Piece, pieces};
use super::surface::Surface;
use super::{LABELS, OTHER, V3};
use kn_bitstream::params::{BodyPart, Named, UpAxis};
use std::fmt;

/// A warning about given labels: something that looks wrong.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LabelWarning {
    /// A part lies in two pieces that are far from each other.
    Split {
        /// The part.
        part: BodyPart,
        /// Gap between the two largest pieces, as a share of the mesh's height.
        gap: f64,
    },
    /// A part is attached to the other side's limb.
    WrongSide {
        /// The part.
        part: BodyPart,
    },
    /// Feet point backwards: left and right are exchanged everywhere.
    SidesSwapped,
    /// A label beyond the known ones.
    Unknown {
        /// The label.
        label: u8,
    },
}

impl LabelWarning {
    /// Whether both warnings are of the same kind and about the same part or label. The gaps of a
    /// part in two pieces may differ.
    pub fn is_like(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Split { part: own, .. }, Self::Split { part, .. }) => own == part,
            _ => self == other,
        }
    }
}

impl fmt::Display for LabelWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Split { part, gap } => {
                write!(f, "{part} lies in two pieces, {:.0} % of the height apart", 1e2 * gap)
            }
            Self::WrongSide { part } => write!(f, "{part} grows from a limb of the other side"),
            Self::SidesSwapped => {
                f.write_str("left and right are swapped: the feet point backwards")
            }
            Self::Unknown { label } => write!(f, "label {label} is not a body part"),
        }
    }
}

/// Parts and the part of the same side that each grows from.
const GROWS_FROM: [(BodyPart, BodyPart); 8] = [
    (BodyPart::LeftLowerArm, BodyPart::LeftUpperArm),
    (BodyPart::LeftHand, BodyPart::LeftLowerArm),
    (BodyPart::RightLowerArm, BodyPart::RightUpperArm),
    (BodyPart::RightHand, BodyPart::RightLowerArm),
    (BodyPart::LeftLeg, BodyPart::LeftThigh),
    (BodyPart::LeftFoot, BodyPart::LeftLeg),
    (BodyPart::RightLeg, BodyPart::RightThigh),
    (BodyPart::RightFoot, BodyPart::RightLeg),
];

/// Thigh, leg and foot of each side.
const LEGS: [[BodyPart; 3]; 2] = [
    [BodyPart::LeftThigh, BodyPart::LeftLeg, BodyPart::LeftFoot],
    [BodyPart::RightThigh, BodyPart::RightLeg, BodyPart::RightFoot],
];

/// Checks `labels` (`#V`) against the mesh (`positions` `#V × 3`, `faces` `#F × 3`).
///
/// # Errors
/// The errors of [`super::Segmenter::segment`], or there is not one label for each vertex.
pub fn check_labels(
    positions: &[[f64; 3]],
    faces: &[[u32; 3]],
    labels: &[u8],
    up_axis: UpAxis,
) -> Result<Vec<LabelWarning>, SegmentError> {
    if labels.len() != positions.len() {
        return Err(SegmentError::LabelCount { labels: labels.len(), vertices: positions.len() });
    }
    let mut warnings = Vec::new();
    if let Some(&label) = labels.iter().find(|l| **l > OTHER) {
        warnings.push(LabelWarning::Unknown { label });
        return Ok(warnings);
    }
    let surface = Surface::new(positions, faces, up_axis)?;
    split_parts(&surface, labels, &mut warnings);
    wrong_sides(&surface, labels, &mut warnings);
    if swapped(&surface, labels) {
        warnings.push(LabelWarning::SidesSwapped);
    }
    Ok(warnings)
}

/// Warns of parts whose second piece is not small and not near.
fn split_parts(surface: &Surface, labels: &[u8], warnings: &mut Vec<LabelWarning>) {
    /// Smallest area of a piece that counts, as a share of its part's largest.
    const LARGE: f64 = 0.1;
    /// Largest gap inside a part, as a share of the height.
    const FAR: f64 = 0.03;
    let height = surface.height();
    let mut pieces = pieces(surface, labels);
    pieces.sort_by(|a, b| b.area.total_cmp(&a.area));
    for part in BodyPart::all().into_iter().filter(|&part| part != BodyPart::Other) {
        let mut own = pieces.iter().filter(|piece| piece.label == part.label());
        let (Some(first), Some(second)) = (own.next(), own.next()) else { continue };
        let gap = gap(surface, first, second) / height;
        if second.area > LARGE * first.area && gap > FAR {
            warnings.push(LabelWarning::Split { part, gap });
        }
    }
}

/// Distance between two pieces, from a bounded number of vertices of each.
fn gap(surface: &Surface, a: &Piece, b: &Piece) -> f64 {
    const MOST: usize = 400;
    let some = |piece: &Piece| -> Vec<V3> {
        let step = piece.vertices.len().div_ceil(MOST);
        piece.vertices.iter().step_by(step).map(|&v| surface.points[v as usize]).collect()
    };
    let (a, b) = (some(a), some(b));
    let squared = a.iter().flat_map(|p| b.iter().map(move |q| (p - q).norm_squared()));
    squared.fold(f64::MAX, f64::min).sqrt()
}

fn wrong_sides(surface: &Surface, labels: &[u8], warnings: &mut Vec<LabelWarning>) {
    let mut touching = [[0usize; LABELS]; LABELS];
    for v in 0..labels.len() {
        for &u in surface.around(v) {
            touching[usize::from(labels[v])][usize::from(labels[u as usize])] += 1;
        }
    }
    for (part, root) in GROWS_FROM {
        let row = &touching[part.index()];
        if row[root.mirrored().index()] > 2 * row[root.index()] {
            warnings.push(LabelWarning::WrongSide { part });
        }
    }
}

/// Whether both feet point clearly to the back, as left and right have it.
fn swapped(surface: &Surface, labels: &[u8]) -> bool {
    /// Sum over both feet: standing on them it is about 0.5; hanging down they say little.
    const BACKWARDS: f64 = -0.15;
    let centres = centres(surface, labels);
    let leftwards = |left: BodyPart| {
        let (left, right) = (centres[left.index()]?, centres[left.mirrored().index()]?);
        (left - right).try_normalize(1e-12)
    };
    // Shoulders and hips; what hangs from them also moves forwards and backwards.
    let left = [BodyPart::LeftUpperArm, BodyPart::LeftThigh].into_iter().filter_map(leftwards);
    let Some(front) = left.fold(V3::zeros(), |s, w| s + w).cross(&V3::y()).try_normalize(0.1)
    else {
        return false;
    };
    let feet = LEGS.map(|leg| toes(surface, labels, leg, &front));
    let [Some(one), Some(other)] = feet else { return false };
    one + other < BACKWARDS
}

/// Reach of a foot towards `front` minus its reach away from it, in lengths of its leg.
fn toes(surface: &Surface, labels: &[u8], parts: [BodyPart; 3], front: &V3) -> Option<f64> {
    let [thigh, leg, foot] = parts.map(BodyPart::label);
    let knee = border(surface, labels, thigh, leg)?;
    let ankle = border(surface, labels, leg, foot)?;
    let down = (ankle - knee).try_normalize(1e-12)?;
    let ahead = (front - down * front.dot(&down)).try_normalize(0.3)?;
    let own = (0..labels.len()).filter(|&v| labels[v] == foot);
    let reach = own.map(|v| (surface.points[v] - ankle).dot(&ahead));
    let (back, front) = reach.fold((0.0, 0.0), |(b, f), r| (f64::min(b, r), f64::max(f, r)));
    Some((front + back) / (ankle - knee).norm())
}

/// The middle of the border between two parts: the mean of the first one's vertices at it.
fn border(surface: &Surface, labels: &[u8], a: u8, b: u8) -> Option<V3> {
    let (mut sum, mut count) = (V3::zeros(), 0.0);
    for v in (0..labels.len()).filter(|&v| labels[v] == a) {
        if surface.around(v).iter().any(|&u| labels[u as usize] == b) {
            sum += surface.points[v];
            count += 1.0;
        }
    }
    (count > 0.0).then(|| sum / count)
}

/// Centre of gravity of every label.
fn centres(surface: &Surface, labels: &[u8]) -> [Option<V3>; LABELS] {
    let mut sums = [(V3::zeros(), 0.0); LABELS];
    for v in 0..labels.len() {
        let (sum, area) = &mut sums[usize::from(labels[v])];
        *sum += surface.points[v] * surface.areas[v];
        *area += surface.areas[v];
    }
    sums.map(|(sum, area)| (area > 0.0).then(|| sum / area))
}
