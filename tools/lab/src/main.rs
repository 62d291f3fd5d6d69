//! Measuring programs: each prints the figures of a page in `docs/`.
//!
//! `cargo run --release -p kn-lab` lists them, `cargo run --release -p kn-lab -- NAME ARGUMENTS` runs
//! one of them.

mod clock;
mod coding;
mod compare_anywhere;
mod generator_table;
mod io_speed;
mod large_motion;
mod metrics_growth;
mod metrics_stages;
mod motion_table;
mod mutations;
mod performer_frames;
mod registration_table;
mod segment_report;
mod surrogate_table;
mod ties;
mod to_glb;

use anyhow::{Result, bail};

/// A measuring program.
struct Program {
    name: &'static str,
    arguments: &'static str,
    about: &'static str,
    run: fn(&[String]) -> Result<()>,
}

const PROGRAMS: &[Program] = &[
    Program {
        name: "compare-anywhere",
        arguments: "[VERTICES]",
        about: "CPU time of all metrics, wherever two meshes are relative to each other",
        run: compare_anywhere::run,
    },
    Program {
        name: "generator-table",
        arguments: "[NODES [FOLDER..]]",
        about: "gain of the key-node generator over farthest points",
        run: generator_table::run,
    },
    Program {
        name: "io-speed",
        arguments: "FILE.obj",
        about: "time of the readers, the writers and the cleaning beside other crates",
        run: io_speed::run,
    },
    Program {
        name: "large-motion",
        arguments: "[SEEDS [FIRST]]",
        about: "limbs that the fit loses when they swing far",
        run: large_motion::run,
    },
    Program {
        name: "metrics-growth",
        arguments: "[PLOT.svg [VERTICES..]]",
        about: "growth of the metrics' CPU time with the size of the meshes",
        run: metrics_growth::run,
    },
    Program {
        name: "metrics-stages",
        arguments: "[REFERENCE OTHER]",
        about: "CPU time of each stage of MSDM2 and of the closest points",
        run: metrics_stages::run,
    },
    Program {
        name: "motion-table",
        arguments: "[FOLDER FIRST COUNT]",
        about: "distortion of P-frames with rigid and with affine key nodes",
        run: motion_table::run,
    },
    Program {
        name: "mutations",
        arguments: "KN [COUNT [FIRST]]",
        about: "how `kn encode` ends on odd and broken mesh files",
        run: mutations::run,
    },
    Program {
        name: "performer-frames",
        arguments: "FOLDER ACTION FRAMES [SEED [VERTICES]]",
        about: "frames of the synthetic performer as OBJ files with labels",
        run: performer_frames::run,
    },
    Program {
        name: "registration-table",
        arguments: "[RUNS]",
        about: "kn register beside its peers: distances, CPU time, growth",
        run: registration_table::run,
    },
    Program {
        name: "segment-report",
        arguments: "[FRAMES [VERTICES [NAME]]]",
        about: "accuracy, flicker and time of the segmentation",
        run: segment_report::run,
    },
    Program {
        name: "surrogate-table",
        arguments: "FOLDER FIRST STREAM..",
        about: "the surrogate distortion beside MSDM2",
        run: surrogate_table::run,
    },
    Program {
        name: "ties",
        arguments: "",
        about: "change of MSDM2 with the order of faces, on the oracle's pairs",
        run: ties::run,
    },
    Program {
        name: "to-glb",
        arguments: "OUTPUT.glb INPUT..",
        about: "a sequence of scans as one animated GLB file",
        run: to_glb::run,
    },
];

fn main() -> Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let Some((name, rest)) = arguments.split_first() else {
        print_programs();
        return Ok(());
    };
    match PROGRAMS.iter().find(|program| program.name == name) {
        Some(program) => (program.run)(rest),
        None => bail!("there is no program '{name}': run kn-lab without arguments for a list"),
    }
}

fn print_programs() {
    for Program { name, arguments, about, .. } in PROGRAMS {
        println!("{name} {arguments}\n    {about}");
    }
}
