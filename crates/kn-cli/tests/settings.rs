//! Settings that contradict each other are refused before any file is read, naming both flags.

mod common;

use common::{kn, stderr};

/// Asserts that the message names all of `named` and not the input, which does not exist.
#[track_caller]
fn is_refused(flags: &[&str], named: &[&str]) {
    let output = kn(["encode", "absent/*.obj", "-o", "absent/a.knm"].iter().chain(flags));
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{message}");
    for flag in named {
        assert!(message.contains(flag), "{message:?} does not name {flag}");
    }
    assert!(!message.contains("absent"), "files before settings: {message:?}");
}

#[test]
fn flags_out_of_their_range_are_refused_before_files_are_read() {
    let cases = [
        ("--bits", "3"),
        ("--bits", "21"),
        ("--step", "0"),
        ("--gof", "0"),
        ("--iframe-faces", "0"),
        ("--iframe-faces", "101%"),
        ("--iframe-error", "0"),
        ("--nodes", "0"),
        ("--nodes", "4097"),
        ("--nodes-per-vertex", "0"),
        ("--nodes-per-vertex", "200"),
        ("--weights", "gaussian:1048576"),
        ("--smoothing", "6"),
        ("--lambda", "-1"),
        ("--lambda", "nan"),
        ("--motion-step", "0"),
        ("--rotation-step", "0"),
        ("--scale-step", "0"),
        ("--shear-step", "0"),
        ("--fps", "0"),
    ];
    for (flag, value) in cases {
        is_refused(&[flag, value], &[flag]);
    }
}

#[test]
fn contradictions_are_refused_before_files_are_read() {
    let msdm2 = ["--distortion", "msdm2", "--motion-step", "2", "--combination", "RT"];
    let cases: [(&[&str], &[&str]); 16] = [
        (&["--lossless", "--bits", "9"], &["--lossless", "--bits"]),
        (&["--lossless", "--step", "1"], &["--lossless", "--step"]),
        (&["--lossless", "--gof", "2"], &["--lossless", "--gof"]),
        (&["--lossless", "--iframe-faces", "9"], &["--lossless", "--iframe-faces"]),
        (&["--lossless", "--iframe-error", "9"], &["--lossless", "--iframe-error"]),
        (&["--lossless", "--smoothing", "2"], &["--lossless", "--smoothing"]),
        (&["--bits", "9", "--step", "1"], &["--bits", "--step"]),
        (&["--iframe-faces", "9", "--iframe-error", "1"], &["--iframe-faces", "--iframe-error"]),
        (&["--choice", "first-p", "--combination", "RT"], &["--choice", "--combination"]),
        (&["--affine", "none", "--scale-step", "1"], &["--affine", "--scale-step"]),
        (&["--affine", "none", "--shear-step", "1"], &["--affine", "--shear-step"]),
        (&["--combination", "RT", "--scale-step", "1"], &["--combination", "--scale-step"]),
        (&["--combination", "RT", "--shear-step", "1"], &["--combination", "--shear-step"]),
        (&["--combination", "RT", "--affine", "cost"], &["--combination", "--affine"]),
        (&["--labels", "none", "--affine", "labels"], &["--labels", "--affine"]),
        (&msdm2, &["--distortion", "--motion-step", "--combination"]),
    ];
    for (flags, named) in cases {
        is_refused(flags, named);
    }
    let all = ["--affine", "all", "--combination", "TS", "--rotation-step", "1"];
    is_refused(&all, &["--affine", "--combination", "--rotation-step"]);
    is_refused(&["--labels", "none", "--part-start", "on"], &["--labels", "--part-start"]);
}
