//! Labels of scans in files: where they come from, how they are found, how they are checked.

mod common;

use common::{FRAMES, Files};
use kn_bitstream::params::BodyPart;
use kn_io::{InputFrame, Inputs, ReadOptions};
use kn_segment::{LabelWarning, SegmentOptions};
use kn_sequence::{
    LabelFindings, LabelOrigin, LabelWarnings, LabelledScan, check_scans, segment_scans,
};
use std::fs::File;
use std::path::PathBuf;

fn find(files: &Files, pattern: &str, origin: &LabelOrigin) -> Inputs {
    origin.find_inputs(&[files.path(pattern)], ReadOptions::default()).expect("found")
}

fn read(inputs: &Inputs) -> Vec<InputFrame> {
    inputs.frames().map(|frame| frame.expect("sound")).collect()
}

#[test]
fn origins_are_read_back_from_their_text() {
    let files = LabelOrigin::Files("l_*.txt".into());
    for origin in [
        LabelOrigin::Property,
        LabelOrigin::Auto,
        LabelOrigin::Colours,
        LabelOrigin::None,
        files.clone(),
    ] {
        assert_eq!(origin.to_string().parse(), Ok(origin));
    }
    assert_eq!("colors".parse(), Ok(LabelOrigin::Colours));
    assert_eq!("l_*.txt".parse(), Ok(files));
}

#[test]
fn labels_come_from_where_they_were_asked_for() {
    let files = Files::new();
    let labels_file = LabelOrigin::Files(files.path("f_*.labels"));
    let cases = [
        ("f_*.ply", LabelOrigin::Property, true),
        ("f_*.ply", LabelOrigin::None, false),
        ("f_*.ply", LabelOrigin::Auto, false),
        ("f_*.obj", LabelOrigin::Property, false),
        ("f_*.obj", labels_file, true),
    ];
    for (pattern, origin, labelled) in cases {
        for (frame, mesh) in read(&find(&files, pattern, &origin)).iter().zip(&files.meshes) {
            let wanted: &[u8] = if labelled { &mesh.labels } else { &[] };
            assert_eq!(frame.mesh.labels, wanted, "{pattern}, {origin}");
        }
    }
    let too_few = LabelOrigin::Files(files.path("f_0.labels"));
    let error = too_few.find_inputs(&[files.path("f_*.obj")], ReadOptions::default());
    assert!(error.expect_err("one file").to_string().contains("1 label files for 3 frames"));
}

#[test]
fn parts_are_found_for_every_vertex_of_the_files() {
    let files = Files::new();
    let inputs = find(&files, "f_*.obj", &LabelOrigin::None);
    let scans: Vec<LabelledScan> = segment_scans(&inputs, SegmentOptions::default())
        .map(|scan| scan.expect("sound"))
        .collect();
    assert_eq!(scans.len(), FRAMES);
    for (scan, mesh) in scans.iter().zip(&files.meshes) {
        assert_eq!(scan.file_labels.len(), mesh.positions.len());
        let right = scan.file_labels.iter().zip(&mesh.labels).filter(|(a, b)| a == b).count();
        assert!(10 * right > 8 * mesh.labels.len(), "{}: {right} are right", scan.name);
        assert!(scan.findings.is_good(), "{:?}", scan.findings.warnings());
        let LabelFindings::Found(found) = &scan.findings else { panic!("labels were found") };
        assert_eq!(found.labels, scan.mesh.labels);
        let head = found.parts().find(|(part, _)| *part == BodyPart::Head).expect("a head");
        assert!(head.1 > 0.5, "{head:?}");
    }
}

#[test]
fn given_labels_are_checked() {
    let files = Files::new();
    let origin = LabelOrigin::Files(files.path("f_*.labels"));
    let sound = check_scans(&find(&files, "f_*.obj", &origin), SegmentOptions::default());
    for scan in sound {
        let scan = scan.expect("sound");
        assert_eq!(scan.findings, LabelFindings::Checked(Vec::new()));
        assert_eq!(scan.file_labels, files.meshes[scan.index].labels);
    }
    // The right foot is labelled as the head.
    let (head, foot) = (BodyPart::Head.label(), BodyPart::RightFoot.label());
    let labels: Vec<u8> =
        files.meshes[1].labels.iter().map(|&l| if l == foot { head } else { l }).collect();
    let out = File::create(files.path("f_1.labels")).expect("made");
    kn_io::write_labels(out, &labels).expect("written");
    let mut scans = check_scans(&find(&files, "f_*.obj", &origin), SegmentOptions::default());
    let second = scans.nth(1).expect("three frames").expect("sound");
    assert!(!second.findings.is_good());
    assert!(second.findings.warnings()[0].starts_with("Head lies in two pieces"));
}

#[test]
fn a_scan_without_labels_cannot_be_checked() {
    let files = Files::new();
    let mut scans =
        check_scans(&find(&files, "f_*.obj", &LabelOrigin::None), SegmentOptions::default());
    let error = scans.next().expect("a frame").expect_err("no labels").to_string();
    assert!(error.contains("f_0.obj: frame 0: 0 labels for"), "{error}");
}

#[test]
fn a_warning_that_repeats_is_kept_once() {
    let files = Files::new();
    let hands = [BodyPart::LeftHand, BodyPart::RightHand].map(BodyPart::label);
    let mut warnings = LabelWarnings::default();
    for (index, mesh) in files.meshes.iter().enumerate() {
        let mut mesh = mesh.clone();
        if index > 0 {
            for label in &mut mesh.labels {
                if let Some(side) = hands.iter().position(|hand| hand == label) {
                    *label = hands[1 - side];
                }
            }
        }
        let file = PathBuf::from(format!("{index}.obj"));
        warnings.check(&file, index, &mesh, SegmentOptions::default().up_axis);
    }
    let all: Vec<_> = warnings.iter().collect();
    assert_eq!(all.len(), 2, "{all:?}");
    assert_eq!(all[0].warning, LabelWarning::WrongSide { part: BodyPart::LeftHand });
    assert_eq!((all[0].frame, all[0].more), (1, 1));
    assert_eq!(
        all[0].to_string(),
        "1.obj: frame 1: labels: Left hand grows from a limb of the other side (and in 1 more frame)"
    );
}
