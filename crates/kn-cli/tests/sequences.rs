//! Sequences as people have them: empty frames, gaps, names, several series in a folder.

mod common;

use common::{Scans, fails, kn, names_in, stderr, succeeds};
use std::fs;
use std::path::Path;

const NOBODY: &str = "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\n\
                      property float z\nelement face 0\nproperty list uchar int vertex_indices\n\
                      end_header\n";

/// Renames the scans, in their order.
fn renamed(names: &[&str]) -> Scans {
    let scans = Scans::new();
    for (index, name) in names.iter().enumerate() {
        let target = scans.path("scan").join(format!("{name}.obj"));
        fs::create_dir_all(target.parent().expect("a folder")).expect("made");
        fs::rename(scans.file(index), target).expect("renamed");
    }
    for index in 0..common::FRAMES {
        let _ = fs::remove_file(scans.file(index));
        fs::remove_file(scans.file(index).with_extension("labels")).expect("removed");
    }
    scans
}

/// The stems of the files in a folder.
fn stems(folder: &Path) -> Vec<String> {
    let stem = |name: String| name.rsplit_once('.').map_or(name.clone(), |(stem, _)| stem.into());
    names_in(folder).into_iter().map(stem).collect()
}

#[test]
fn names_come_back_as_they_went_in() {
    for names in [
        &["tänzer 1 é", "tänzer 2 é", "tänzer 3 é"][..],
        &["動 tänzer_09", "動 tänzer_10", "動 tänzer_11"],
        &["f_0_a2", "f_1_a2", "f_2_a2"],
        &["f-1", "f0", "f1"],
        &["t 0000000967", "t 0000001000", "t 0000001034"],
        &["f_0", "f_2", "f_4"],
        &["frame_8/model", "frame_9/model", "frame_10/model"],
    ] {
        let scans = renamed(names);
        succeeds(scans.encode("scan", &[]));
        succeeds(["decode", &scans.text("a.knm"), "-o", &scans.text("out")]);
        let mut expected: Vec<&str> =
            names.iter().map(|name| name.split('/').next().unwrap_or(name)).collect();
        expected.sort_unstable();
        assert_eq!(stems(&scans.path("out")), expected);
    }
}

#[test]
fn a_gap_is_named_skipped_or_held() {
    let scans = renamed(&["f_1", "f_2", "f_4", "f_5", "f_6"]);
    let message = fails(scans.encode("scan", &[]));
    assert!(message.contains("f_3.obj: this frame is missing"), "{message}");
    assert!(message.contains("--missing skip") && message.contains("--missing hold"), "{message}");
    for (missing, frames) in [("skip", 5), ("hold", 6)] {
        let output = kn(scans.encode("scan", &["--missing", missing]));
        let said = stderr(&output);
        assert_eq!(output.status.code(), Some(0), "{said}");
        assert_eq!(said.matches("1 frame is missing").count(), 1, "{said}");
        let stream = scans.text("a.knm");
        assert!(succeeds(["info", &stream]).contains(&format!("{frames} frames")));
        let compare = ["compare", &scans.text("scan"), &stream, "--fast", "--missing", missing];
        succeeds(compare);
    }
    let stream = scans.text("a.knm");
    succeeds(["decode", &stream, "-o", &scans.text("out")]);
    assert_eq!(stems(&scans.path("out")), ["f_1", "f_2", "f_3", "f_4", "f_5", "f_6"]);
    fails(["segment", &scans.text("scan"), "-o", &scans.text("labels")]);
    succeeds(scans.encode("scan", &["--missing", "skip", "--every", "2"]));
    assert!(succeeds(["info", &stream]).contains("3 frames"));
}

#[test]
fn several_series_in_a_folder_are_refused_with_a_pattern_that_works() {
    for (names, pattern) in [
        (&["f0_L0", "f0_L1", "f1_L0", "f1_L1"][..], "f%d_L0.obj"),
        (&["f_00", "f_01", "preview"], "f_%02d.obj"),
    ] {
        let scans = renamed(names);
        let message = fails(scans.encode("scan", &[]));
        assert!(message.contains(&format!("{pattern}'")), "{message}");
        succeeds(scans.encode(&format!("scan/{pattern}"), &[]));
        assert!(succeeds(["info", &scans.text("a.knm")]).contains("2 frames"));
    }
}

/// Scans in PLY with an empty frame at each of these places.
fn with_empty_frames(places: &[usize]) -> Scans {
    let scans = Scans::new();
    for index in 0..common::FRAMES {
        let mesh = kn_io::read_mesh(&scans.file(index), &Default::default()).expect("sound").mesh;
        let path = scans.file(index).with_extension("ply");
        if places.contains(&index) {
            fs::write(path, NOBODY).expect("written");
        } else {
            kn_io::write_mesh(&path, &mesh).expect("written");
        }
        fs::remove_file(scans.file(index)).expect("removed");
        fs::remove_file(scans.file(index).with_extension("labels")).expect("removed");
    }
    scans
}

#[test]
fn empty_frames_pass_through_every_command() {
    for places in [&[2][..], &[0], &[4], &[1, 2], &[0, 1, 3, 4]] {
        let scans = with_empty_frames(places);
        let stream = scans.text("a.knm");
        let said = stderr(&kn(scans.encode("scan", &["--report", &scans.text("r.json")])));
        assert!(said.contains(&format!("{} of 5 frames have no faces", places.len())), "{said}");
        succeeds(["verify", &stream]);
        assert!(succeeds(["info", &stream]).contains("5 frames"));
        succeeds(["dump", &stream]);
        let text = succeeds(["compare", &scans.text("scan"), &stream, "--json"]);
        assert!(!text.contains("NaN"), "{text}");
        let rows: serde_json::Value = serde_json::from_str(&text).expect("JSON");
        assert!(rows["mean"]["p2s_psnr"].as_f64().is_some_and(|mean| mean > 30.0), "{text}");
        for format in ["obj", "ply", "glb"] {
            let out = scans.text(format);
            succeeds(["decode", &stream, "-o", &out, "--format", format]);
            succeeds(["compare", &out, &stream, "--fast"]);
        }
        succeeds(["decode", &stream, "-o", &scans.text("all.glb")]);
        succeeds(["compare", &scans.text("all.glb"), &stream, "--fast"]);
        let labels = scans.text("labels");
        let segmented = kn(["segment", &scans.text("scan"), "-o", &labels]);
        assert!(matches!(segmented.status.code(), Some(0 | 1)), "{}", stderr(&segmented));
        succeeds(scans.encode("scan", &["--labels", &format!("{labels}/*.labels")]));
        succeeds(["verify", &stream]);
    }
}

#[test]
fn an_empty_frame_against_a_full_one_has_stated_values() {
    let scans = with_empty_frames(&[2]);
    let others = with_empty_frames(&[3]);
    let text = succeeds(["compare", &scans.text("scan"), &others.text("scan"), "--json"]);
    let rows: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    for frame in [2, 3] {
        let row = &rows["frames"][frame];
        assert_eq!((row["p2s_rms"].as_f64(), row["msdm2"].as_f64()), (Some(1.0), Some(1.0)));
    }
    assert!(rows["frames"][0]["p2s_rms"].as_f64().is_some_and(|rms| rms < 1e-9));
}

#[test]
fn a_scan_of_points_is_an_empty_frame_among_others_and_an_error_alone() {
    let scans = Scans::new();
    fs::write(scans.file(2), "v 0 0 0\nv 1 0 0\nv 0 1 0\n").expect("written");
    let said = stderr(&kn(scans.encode("scan", &["--labels", "none"])));
    assert!(said.contains("f_10.obj: frame 2: coded as empty frames"), "{said}");
    let message = fails(scans.encode("scan/f_10.obj", &[]));
    assert!(message.contains("f_10.obj: frame 0: the mesh has no faces"), "{message}");
    for index in 0..common::FRAMES {
        fs::write(scans.file(index), "# nobody\n").expect("written");
    }
    let message = fails(scans.encode("scan", &[]));
    assert!(message.contains("no frame of the sequence has a face"), "{message}");
}
