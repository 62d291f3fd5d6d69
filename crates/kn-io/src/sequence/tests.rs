use super::*;

/// A folder with these files; a name with `/` brings its folders.
fn folder_with(names: &[&str]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for name in names {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().expect("it has a folder")).expect("made");
        fs::write(path, "x").expect("written");
    }
    folder
}

/// What `spec` finds in a folder with these files, or the message.
fn found(names: &[&str], spec: &str, kind: Kind, missing: Missing) -> Result<Found, String> {
    let folder = folder_with(names);
    let found = find_files(&folder.path().join(spec), kind, missing).map_err(|e| e.to_string())?;
    let relative = |path: &PathBuf| path.strip_prefix(folder.path()).unwrap_or(path).to_owned();
    let frame = |frame: &FrameFile| FrameFile {
        path: relative(&frame.path),
        named: relative(&frame.named),
    };
    Ok(Found { frames: found.frames.iter().map(frame).collect(), notes: found.notes })
}

/// The files that `spec` finds, or the message.
fn find(names: &[&str], spec: &str, kind: Kind) -> Result<Vec<String>, String> {
    let found = found(names, spec, kind, Missing::Fail)?;
    Ok(found.frames.iter().map(|frame| frame.path.display().to_string()).collect())
}

#[test]
fn a_folder_is_its_meshes_in_natural_order() {
    let names = ["f10.obj", "f9.obj", "f8.obj", "f8.labels", "notes.txt", "f.mtl", "._f8.obj"];
    assert_eq!(find(&names, "", Kind::Meshes).expect("found"), ["f8.obj", "f9.obj", "f10.obj"]);
    assert_eq!(find(&names, "", Kind::Labels).expect("found"), ["f8.labels"]);
    assert_eq!(find(&names, "f?.obj", Kind::Meshes).expect("found"), ["f8.obj", "f9.obj"]);
    assert_eq!(find(&names, "f8.*", Kind::Meshes).expect("found"), ["f8.obj"]);
    assert_eq!(find(&names, "*8.obj", Kind::Meshes).expect("found"), ["f8.obj"]);
}

#[test]
fn printf_patterns_find_start_and_end() {
    let names = ["f_0099.obj", "f_0100.obj", "f_12.obj", "f_-1.obj", "g_0098.obj"];
    let found = find(&names, "f_%04d.obj", Kind::Meshes).expect("found");
    assert_eq!(found, ["f_0099.obj", "f_0100.obj"]);
    let names = ["f_-1.obj", "f_0.obj", "f_01.obj", "f_1.obj"];
    let found = find(&names, "f_%d.obj", Kind::Meshes).expect("found");
    assert_eq!(found, ["f_-1.obj", "f_0.obj", "f_1.obj"]);
    let names = ["take [1]/f_9/m.obj", "take [1]/f_10/m.obj", "take [1]/f_a/m.obj"];
    let found = find(&names, "take [1]/f_%d/m.obj", Kind::Meshes).expect("found");
    assert_eq!(found, ["take [1]/f_9/m.obj", "take [1]/f_10/m.obj"]);
    let names = ["100%done/f_0.obj", "100%done/f_1.obj"];
    assert_eq!(find(&names, "100%done/f_%d.obj", Kind::Meshes).expect("found"), names);
}

/// Each is a sequence whatever the numbers are.
#[test]
fn numbers_that_rise_evenly_are_a_sequence() {
    for names in [
        &["f_0.obj", "f_2.obj", "f_4.obj", "f_6.obj"][..],
        &["f_10.obj", "f_15.obj", "f_20.obj"],
        // Times.
        &["c_999999967.obj", "c_1000000000.obj", "c_1000000034.obj", "c_1000000067.obj"],
        &["c_0.obj", "c_33333.obj", "c_66667.obj", "c_100000.obj"],
        &["c_0.5.obj", "c_0.75.obj", "c_1.0.obj", "c_1.25.obj"],
        &["c_12.933.obj", "c_12.967.obj", "c_13.000.obj", "c_13.033.obj"],
        &["c_10-59-58.obj", "c_10-59-59.obj", "c_11-00-00.obj", "c_11-00-01.obj"],
        &["c_20261130T105959.obj", "c_20261130T110000.obj"],
        // A number and a time.
        &["f_1_t33.obj", "f_2_t67.obj", "f_3_t100.obj"],
        &["f_1_t33.obj", "f_2_t90.obj", "f_3_t100.obj"],
        // Numbers below 0.
        &["f-2.obj", "f-1.obj", "f0.obj", "f1.obj"],
        &["f_-010.obj", "f_-009.obj", "f_-008.obj"],
        &["-1.obj", "0.obj", "1.obj"],
        // A folder for each frame.
        &["f_8/m.obj", "f_9/m.obj", "f_10/m.obj"],
        &["f_8/m_8.obj", "f_9/m_9.obj", "f_10/m_10.obj"],
        // No numbers.
        &["a.obj", "c.obj"],
        &["s1_f1.obj", "s3_f4.obj"],
        &["x1.obj", "y4.obj"],
    ] {
        let mut shuffled = names.to_vec();
        shuffled.rotate_left(1);
        match find(&shuffled, "", Kind::Meshes) {
            Ok(found) => assert_eq!(found, names),
            // Two files of different names far apart.
            Err(message) => assert!(names[0].contains("T105959"), "{names:?}: {message}"),
        }
    }
}

#[test]
fn a_missing_frame_is_named_however_the_frames_are_given() {
    let names = ["f_0008.obj", "f_0009.obj", "f_0011.obj"];
    for spec in ["", "*.obj", "f_%04d.obj", "f_00*"] {
        let message = find(&names, spec, Kind::Meshes).expect_err("a gap");
        assert!(
            message.ends_with(
                "f_0010.obj: this frame is missing: the sequence runs from f_0008.obj to \
                 f_0011.obj; --missing skip goes on without such frames, --missing hold repeats \
                 the frame before"
            ),
            "{spec}: {message}"
        );
    }
    for (names, missing) in [
        (&["7.ply", "10.ply"][..], "/8.ply: this frame is missing"),
        (&["f0.ply", "f2.ply", "f4.ply", "f8.ply"], "/f6.ply: this frame is missing"),
        (&["f-2.ply", "f0.ply", "f1.ply"], "/f-1.ply: this frame is missing"),
        (&["f1.ply", "f2.ply", "f4.ply", "f5.ply", "f7.ply"], "/f3.ply: this frame is missing"),
        (&["t0.ply", "t33.ply", "t67.ply", "t134.ply"], "/t134.ply: frames are missing between"),
        (&["1.ply", "5.ply", "7.ply", "12.ply", "30.ply"], "/30.ply: frames are missing between"),
    ] {
        let message = find(names, "", Kind::Meshes).expect_err("a gap");
        assert!(message.contains(missing) && message.contains("--missing skip"), "{message}");
    }
}

#[test]
fn missing_frames_are_left_out_or_held() {
    let names = ["f_08.obj", "f_09.obj", "f_12.obj", "f_13.obj"];
    let skipped = found(&names, "", Kind::Meshes, Missing::Skip).expect("found");
    let paths: Vec<_> = skipped.frames.iter().map(|frame| frame.path.clone()).collect();
    assert_eq!(paths, names.map(PathBuf::from));
    assert_eq!(
        skipped.notes,
        ["2 frames are missing, the first between f_09.obj and f_12.obj: left out"]
    );
    let held = found(&names, "", Kind::Meshes, Missing::Hold).expect("found");
    let of = |frame: &FrameFile| frame.path.display().to_string();
    let paths: Vec<String> = held.frames.iter().map(of).collect();
    assert_eq!(paths, ["f_08.obj", "f_09.obj", "f_09.obj", "f_09.obj", "f_12.obj", "f_13.obj"]);
    assert_eq!(held.names(), ["f_08", "f_09", "f_10", "f_11", "f_12", "f_13"]);
    let far = found(&["1.obj", "2.obj", "4000000000.obj"], "", Kind::Meshes, Missing::Hold);
    assert!(far.expect_err("too many").contains("more than 10000"));
}

#[test]
fn every_nth_frame_is_taken() {
    let folder = folder_with(&["f0.obj", "f1.obj", "f2.obj", "f3.obj", "f4.obj"]);
    let every = std::num::NonZeroUsize::new(2).expect("not 0");
    let options = ReadOptions { every, ..ReadOptions::default() };
    let found = find_frames(&[folder.path().to_owned()], &options).expect("found");
    assert_eq!(found.names(), ["f0", "f2", "f4"]);
}

/// Each message says which pattern to give.
#[test]
fn several_series_are_an_error() {
    for (names, parts) in [
        (
            &["f0_L0.obj", "f0_L1.obj", "f1_L0.obj", "f1_L1.obj"][..],
            &["several numbers", "levels", "/f%d_L0.obj'"][..],
        ),
        (
            &["f00_L0.obj", "f00_L1.obj", "f01_L0.obj", "f01_L1.obj", "f02_L0.obj"],
            &["/f%02d_L0.obj'"],
        ),
        (
            &["lod0_f1.obj", "lod0_f2.obj", "lod0_f3.obj", "lod1_f1.obj", "lod1_f2.obj"],
            &["/lod0_f%d.obj'"],
        ),
        (&["f_0.obj", "f_1.obj", "preview.obj"], &["but preview.obj is not one", "/f_%d.obj'"]),
        (
            &["f_00.obj", "f_01.obj", "f_02.obj", "f_mean.obj", "z.obj"],
            &["and 1 more", "/f_%02d.obj'"],
        ),
        (
            &["run_0.obj", "run_1.obj", "walk_0.obj", "walk_1.obj"],
            &["several series", "/run_%d.obj'"],
        ),
        (&["f0/a.obj", "f0/b.obj", "f1/a.obj"], &["f0 has 2: name that folder", "/*/a.obj'"]),
    ] {
        let message = find(names, "", Kind::Meshes).expect_err("several series");
        for part in parts {
            assert!(message.contains(part), "{names:?}: {message}");
        }
    }
}

#[test]
fn what_is_unclear_is_an_error() {
    let message = |names, spec| find(names, spec, Kind::Meshes).expect_err("must fail");
    assert!(message(&["a.obj"], "*.ply").ends_with("(.obj, .ply, .off, .stl, .glb, .gltf)"));
    assert!(message(&["a.txt"], "").contains("no mesh file matches"));
    assert!(message(&["a.obj"], "b.obj").contains("b.obj: No such file"));
    assert!(message(&["a.obj", "a.ply"], "").contains("several formats match"));
    assert!(message(&["f1.obj", "f01.obj"], "").contains("has the frame number of"));
    assert!(message(&["a.obj"], "***/a").contains("bad glob"));
    let labels = find(&["a.obj"], "*.labels", Kind::Labels).expect_err("must fail");
    assert!(labels.ends_with("no label file matches"), "{labels}");
}

#[test]
fn an_existing_name_is_no_pattern() {
    let names = ["a[1].obj", "a1.obj", "b%d.obj", "b1.obj"];
    assert_eq!(find(&names, "a[1].obj", Kind::Meshes).expect("found"), ["a[1].obj"]);
    assert_eq!(find(&names, "b%d.obj", Kind::Meshes).expect("found"), ["b%d.obj"]);
    let names = ["take [1]/f_0.obj", "take [1]/f_1.obj", "take 1/f_2.obj"];
    for spec in ["take [1]/*.obj", "take [1]/f_?.obj", "take [1]/f_%d.obj", "take [1]"] {
        assert_eq!(find(&names, spec, Kind::Meshes).expect("found"), names[..2], "{spec}");
    }
    let names = ["a [b]/f0/m [c].obj", "a [b]/f1/m [c].obj"];
    assert_eq!(find(&names, "a [b]/*/m [c].obj", Kind::Meshes).expect("found"), names);
    assert_eq!(find(&names, "a [b]/**/*.obj", Kind::Meshes).expect("found"), names);
}

#[test]
fn a_list_keeps_its_order_unless_a_shell_sorted_it() {
    let folder = folder_with(&["f9.obj", "f10.obj", "f12.obj"]);
    let list = |names: [&str; 3]| {
        let files = names.map(|name| folder.path().join(name));
        let listed = listed_files(&files).expect("all exist");
        listed == files
    };
    assert!(list(["f12.obj", "f9.obj", "f10.obj"]));
    assert!(!list(["f10.obj", "f12.obj", "f9.obj"]));
    let absent = listed_files(&[folder.path().join("f11.obj")]);
    assert!(absent.expect_err("absent").to_string().contains("f11.obj: No such file"));
}
