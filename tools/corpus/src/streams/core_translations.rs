//! Streams whose translations are predicted, as the encoder writes them.

use kn_bitstream::params::UpAxis;
use kn_codec::TranslationChoice;
use kn_mesh::Mesh;

use super::meshes::{moved, turned, twins};

/// A stream with predicted translations.
pub(super) struct Predicted {
    pub(super) name: &'static str,
    pub(super) danger: &'static str,
    pub(super) covers: &'static [&'static str],
    pub(super) frames: Vec<Mesh>,
    pub(super) choice: TranslationChoice,
    pub(super) up_axis: UpAxis,
}

pub(super) fn predicted(body: &Mesh) -> Vec<Predicted> {
    let frames = |mesh: &Mesh, count| (0..count).map(|i| moved(mesh, f64::from(i))).collect();
    let upright: Vec<Mesh> = frames(body, 2);
    let headless = body.clone().with_labels(body.labels.iter().map(|&l| headless(l)).collect());
    let plain = twins(body).with_labels(Vec::new());
    let stream = |name, danger, covers, frames| Predicted {
        name,
        danger,
        covers,
        frames,
        choice: TranslationChoice::Paper,
        up_axis: UpAxis::Y,
    };
    vec![
        stream(
            "translation_spatial",
            "The path from head over torso to the thighs: every node is predicted from the one before.",
            PATH,
            upright.clone(),
        ),
        Predicted {
            up_axis: UpAxis::Z,
            frames: upright.iter().map(|mesh| turned(mesh, 1)).collect(),
            ..stream(
                "translation_up_z",
                "The path goes down the up axis of the header, clockwise seen from there.",
                &["path.plane", "path.angle", "path.ring"],
                Vec::new(),
            )
        },
        Predicted {
            up_axis: UpAxis::X,
            frames: upright.iter().map(|mesh| turned(mesh, 2)).collect(),
            ..stream(
                "translation_up_x",
                "The path goes down the up axis of the header, clockwise seen from there.",
                &["path.plane", "path.angle", "path.ring"],
                Vec::new(),
            )
        },
        stream(
            "translation_no_head",
            "An arm without a head and thighs without a torso begin at the nodes visited so far.",
            &["path.references", "path.order", "path.part"],
            frames(&headless, 2),
        ),
        stream(
            "translation_unlabelled",
            "Without labels the largest component is first.",
            &["path.components", "path.order", "path.start.highest"],
            frames(&plain, 2),
        ),
        stream(
            "translation_spatio_temporal",
            "Every part changes by its own vector, in the dictionary of the frame before.",
            &[
                "motion.prediction.temporal",
                "motion.translation.mode",
                "motion.translation.previous",
                "motion.parts",
            ],
            frames(body, 5),
        ),
        Predicted {
            choice: TranslationChoice::Cost,
            ..stream(
                "translation_by_cost",
                "The mode changes from frame to frame, and a new GoF knows no frame before.",
                &["motion.prediction.direct", "motion.translation.mode"],
                frames(body, 9),
            )
        },
    ]
}

/// The head becomes an arm, the torso something held.
fn headless(label: u8) -> u8 {
    match label {
        0 => 4,
        7 => 14,
        label => label,
    }
}

/// Section 7.5 and what uses it.
const PATH: &[&str] = &[
    "motion.prediction.spatial",
    "path.group",
    "path.plane",
    "path.mean",
    "path.graph",
    "path.components",
    "path.part",
    "path.order",
    "path.references",
    "path.start.highest",
    "path.start.nearest",
    "path.layers",
    "path.angle",
    "path.ring",
];
