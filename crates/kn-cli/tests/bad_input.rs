//! Broken scans and impossible output: a message that names file, frame and reason, exit code 2,
//! and nothing left behind.

mod common;

use common::{Scans, command, fails, kn, stderr, succeeds};
use std::fs;
use std::process::Stdio;

/// Replaces the third scan (frame 2) by `content` and expects an error with all of `parts`.
#[track_caller]
fn rejects(content: &[u8], extension: &str, parts: &[&str]) {
    let scans = Scans::new();
    for index in 0..common::FRAMES {
        let mesh = kn_io::read_mesh(&scans.file(index), &Default::default()).expect("sound");
        fs::remove_file(scans.file(index)).expect("removed");
        let path = scans.file(index).with_extension(extension);
        kn_io::write_mesh(&path, &mesh.mesh).expect("written");
    }
    fs::write(scans.file(2).with_extension(extension), content).expect("written");
    let message = fails(scans.encode(&format!("scan/*.{extension}"), &[]));
    for part in parts.iter().chain(&[&*format!("f_10.{extension}"), "frame 2"]) {
        assert!(message.contains(part), "{message:?} does not say {part:?}");
    }
    scans.assert_untouched();
}

#[test]
fn no_file_matches() {
    let scans = Scans::new();
    for pattern in ["scan/*.ply", "scan/g_%02d.obj", "."] {
        let message = fails(scans.encode(pattern, &[]));
        assert!(message.contains("no mesh file matches"), "{message}");
    }
    let message = fails(scans.encode("absent.obj", &[]));
    assert!(message.contains("absent.obj") && message.contains("No such file"), "{message}");
    scans.assert_untouched();
}

#[test]
fn a_frame_is_missing_in_the_middle() {
    let scans = Scans::new();
    fs::remove_file(scans.file(2)).expect("removed");
    for pattern in ["scan/*.obj", "scan", "scan/f_%02d.obj"] {
        let message = fails(scans.encode(pattern, &[]));
        let expected = "f_10.obj: this frame is missing: \
                        the sequence runs from f_08.obj to f_12.obj";
        assert!(message.contains(expected) && message.contains("--missing skip"), "{message}");
    }
    scans.assert_untouched();
}

#[test]
fn empty_files() {
    for extension in ["obj", "ply", "glb"] {
        rejects(b"", extension, &["empty"]);
    }
}

#[test]
fn unreadable_files() {
    rejects(b"\x00\xff\xfe", "obj", &["not an OBJ statement"]);
    rejects(b"\x00\xff\xfe", "ply", &[]);
    rejects(b"\x00\xff\xfe", "glb", &[]);
}

#[test]
fn truncated_files() {
    rejects(b"v 0 0 0\nv 1 0 0\nv 0 1", "obj", &["line 3"]);
    let ply = b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
                property float z\nelement face 1\nproperty list uchar int vertex_indices\n\
                end_header\n0 0 0\n1 0 0\n";
    rejects(ply, "ply", &["ends early"]);
    let scans = Scans::new();
    let whole = scans.path("scan/whole.glb");
    let mesh = kn_io::read_mesh(&scans.file(0), &Default::default()).expect("sound").mesh;
    kn_io::write_mesh(&whole, &mesh).expect("written");
    let bytes = fs::read(&whole).expect("written");
    rejects(&bytes[..bytes.len() / 2], "glb", &[]);
}

#[test]
fn coordinates_that_are_no_numbers() {
    for bad in ["nan", "inf", "-inf", "1e99"] {
        let obj = format!("v 0 0 0\nv 1 {bad} 0\nv 0 1 0\nf 1 2 3\n");
        rejects(obj.as_bytes(), "obj", &["line 2", "NaN or infinite"]);
    }
}

#[test]
fn faces_that_cannot_be() {
    let obj = |face: &str| format!("v 0 0 0\nv 1 0 0\nv 0 1 0\n{face}\n").into_bytes();
    rejects(&obj("f 1 2 4"), "obj", &["line 4", "face index 4 is out of range"]);
    rejects(&obj("f 0 1 2"), "obj", &["line 4", "face index 0 is out of range"]);
}

#[test]
fn polygons_are_cut_and_that_is_said() {
    let scans = Scans::new();
    let square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0.5\nvn 0 0 1\nf 1//1 2//1 3//1 4//1\n";
    fs::write(scans.path("square.obj"), square).expect("written");
    let output = kn(scans.encode("square.obj", &[]));
    let said = stderr(&output);
    assert_eq!(output.status.code(), Some(0), "{said}");
    assert!(said.contains("1 polygon cut into 2 triangles"), "{said}");
    assert!(said.contains("not carried: normals (1)"), "{said}");
    assert!(succeeds(["info".into(), scans.text("a.knm")]).contains("1 frame (1 I, 0 P)"));
}

#[test]
fn labels_that_do_not_fit() {
    let scans = Scans::new();
    let labels = ["--labels", &scans.text("scan/*.labels")].map(String::from);
    let labels = labels.each_ref().map(String::as_str);
    let file = scans.file(3).with_extension("labels");
    let good = fs::read_to_string(&file).expect("written");

    let mut lines: Vec<&str> = good.lines().collect();
    lines.pop();
    fs::write(&file, lines.join("\n")).expect("written");
    let message = fails(scans.encode("scan/*.obj", &labels));
    let counts = format!("{} labels for {} vertices", lines.len(), lines.len() + 1);
    assert!(message.contains("f_11.labels") && message.contains(&counts), "{message}");
    assert!(message.contains("frame 3"), "{message}");

    fs::write(&file, good.replacen('\n', "\n15\n", 1)).expect("written");
    let message = fails(scans.encode("scan/*.obj", &labels));
    assert!(message.contains("line 2: label 15 is out of range"), "{message}");

    fs::remove_file(&file).expect("removed");
    let message = fails(scans.encode("scan/*.obj", &labels));
    assert!(message.contains("f_11.labels: this frame is missing"), "{message}");
    scans.assert_untouched();
}

#[test]
fn a_part_without_nodes_in_strict_mode() {
    let scans = Scans::new();
    // Two nodes cannot serve six regions.
    let labels = scans.text("scan/*.labels");
    let flags = ["--labels", &labels, "--influence", "strict", "--nodes", "2"];
    let mut arguments = scans.encode("scan/*.obj", &[]);
    arguments.retain(|argument| argument != "--nodes" && argument != "24");
    arguments.extend(flags.map(String::from));
    let message = fails(&arguments);
    assert!(message.contains("f_09.obj: frame 1: "), "{message}");
    assert!(message.contains("strict") && message.contains("region"), "{message}");
    scans.assert_untouched();
}

#[test]
fn a_step_too_short_for_the_frames() {
    let scans = Scans::new();
    let message = fails(scans.encode("scan/*.obj", &["--step", "1e-7"]));
    assert!(message.starts_with("--step is 0.0000001; "), "{message}");
    assert!(message.contains("the longest side of the box of all frames is 1."), "{message}");
    let output = kn(scans.encode("scan/*.obj", &["--step=-1"]));
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("give a positive number"), "{}", stderr(&output));
    scans.assert_untouched();
}

#[test]
fn a_grid_too_coarse_for_a_mesh() {
    let scans = Scans::new();
    let message = fails(scans.encode("scan/*.obj", &["--step", "50"]));
    assert!(message.contains("f_08.obj: frame 0: the mesh is "), "{message}");
    assert!(message.ends_with("which is less than a step of the grid, 5.000e1"), "{message}");
    // A corner far away, of a face: every other frame is smaller than a step.
    for far in ["1e30", "30000"] {
        let obj = fs::read_to_string(scans.file(3)).expect("a scan");
        let stretched = obj.replacen("\nf ", &format!("\nv {far} 0 0\nf 1 2 -1\nf "), 1);
        fs::write(scans.file(3), &stretched).expect("written");
        let message = fails(scans.encode("scan/*.obj", &[]));
        assert!(message.contains("f_08.obj: frame 0: the mesh is "), "{message}");
        assert!(
            message.contains("and that of ") && message.contains("f_11.obj: frame 3"),
            "{message}"
        );
        fs::write(scans.file(3), obj).expect("written");
        // In every frame, so that none is smaller than the others.
        let all = ["one.obj", "two.obj"].map(|name| scans.path(name));
        all.iter().for_each(|path| fs::write(path, &stretched).expect("written"));
        let [one, two] = all.each_ref().map(|path| path.to_string_lossy());
        let message = fails(["encode", &one, &two, "-o", &scans.text("a.knm"), "--nodes", "9"]);
        let said = "one.obj: frame 0: no face is left on the grid, whose step is ";
        assert!(message.contains(said), "{message}");
        all.iter().for_each(|path| fs::remove_file(path).expect("removed"));
    }
    scans.assert_untouched();
}

#[test]
fn faces_that_are_all_degenerate() {
    let obj = b"v 0 0 0\nv 1 0 0\nv 0 0 0\nf 1 2 3\n";
    rejects(obj, "obj", &["all faces are degenerate"]);
    let scans = Scans::new();
    fs::write(scans.file(2), obj).expect("written");
    let [scan, out] = [scans.text("scan"), scans.text("out")];
    for arguments in
        [&["compare", &scan, &scan, "--clean", "--fast"][..], &["segment", &scan, "-o", &out]]
    {
        let message = fails(arguments);
        assert!(message.contains("f_10.obj: frame 2: all faces are degenerate"), "{message}");
    }
}

#[test]
fn a_folder_beside_files() {
    let scans = Scans::new();
    let [scan, file] = [scans.text("scan"), scans.text("scan/f_08.obj")];
    let message = fails(["encode", &scan, &file, "-o", &scans.text("a.knm")]);
    assert!(message.contains("scan: a folder cannot be listed beside files"), "{message}");
}

#[test]
fn output_that_cannot_be_written() {
    let scans = Scans::new();
    let mut arguments = scans.encode("scan/*.obj", &[]);
    for (output, reason) in
        [("absent/a.knm", "No such file"), ("scan", "a folder, but --output is a file")]
    {
        arguments[3] = scans.text(output);
        let message = fails(&arguments);
        assert!(message.contains(output) && message.contains(reason), "{message}");
    }
    scans.assert_untouched();
    let stream = scans.encoded().to_string_lossy().into_owned();
    let file = scans.file(0).join("out").to_string_lossy().into_owned();
    let message = fails(["decode", &stream, "-o", &file]);
    assert!(message.contains("f_08.obj/out: Not a directory"), "{message}");
}

#[cfg(unix)]
#[test]
fn a_folder_without_permission() {
    use std::os::unix::fs::PermissionsExt;
    let scans = Scans::new();
    let locked = scans.path("locked");
    fs::create_dir(&locked).expect("made");
    fs::set_permissions(&locked, fs::Permissions::from_mode(0o555)).expect("set");
    if fs::write(locked.join("probe"), "x").is_ok() {
        eprintln!("skipped: permissions do not bind this user");
        return;
    }
    let mut arguments = scans.encode("scan/*.obj", &[]);
    arguments[3] = scans.text("locked/a.knm");
    let message = fails(&arguments);
    assert!(message.contains("locked/a.knm: Permission denied"), "{message}");
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk() {
    let scans = Scans::new();
    let mut arguments = scans.encode("scan/*.obj", &[]);
    arguments[3] = "/dev/full".into();
    let message = fails(&arguments);
    assert!(message.contains("/dev/full: ") && message.contains("No space left"), "{message}");

    let stream = scans.encoded();
    for (name, more) in [("info", &[][..]), ("info", &["--json"]), ("verify", &[]), ("dump", &[])] {
        let device = fs::OpenOptions::new().write(true).open("/dev/full").expect("a device");
        let mut run = command([name, &stream.to_string_lossy()]);
        let output = run.args(more).stdout(Stdio::from(device)).output().expect("starts");
        assert_eq!(output.status.code(), Some(2));
        let said = stderr(&output);
        assert!(said.starts_with("kn: error: standard output: No space left"), "{said}");
    }

    // A limit of 8 blocks of 512 bytes stands in for a full disk; the signal must not end us.
    let script = "trap '' XFSZ; ulimit -f 8; exec \"$@\"";
    let run = |arguments: &[&str]| {
        let limited = command(arguments);
        let output = std::process::Command::new("sh")
            .args(["-c", script, "sh"])
            .arg(limited.get_program())
            .args(limited.get_args())
            .output()
            .expect("sh starts");
        assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
        stderr(&output)
    };
    let stream = stream.to_string_lossy();
    let said = run(&["decode", &stream, "-o", &scans.text("out")]);
    assert!(said.contains("out/f_08.obj (frame 0): File too large"), "{said}");
    fs::remove_file(&*stream).expect("removed");
    let arguments = scans.encode("scan/*.obj", &[]);
    let said = run(&arguments.iter().map(String::as_str).collect::<Vec<_>>());
    assert!(said.contains("a.knm: ") && said.contains("File too large"), "{said}");
    scans.assert_untouched();
}
