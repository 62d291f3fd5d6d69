//! Growth of the metrics' CPU seconds with the meshes, as a table and as a picture:
//! `cargo run --release -p kn-lab -- metrics-growth [PLOT.svg [VERTICES…]]`.

use crate::clock::cpu_seconds;
use anyhow::Result;
use kn_lab::ring::{Shape, pair};
use kn_metrics::{
    DEFAULT_LEVELS, IndexedMesh, Interpolation, MeshRef, Msdm2Surface, TriangleTree, msdm2,
    p2s_of_vertices,
};
use std::fmt::Write as _;
use std::hint::black_box;

const SIZES: [usize; 6] = [1_000, 3_000, 10_000, 20_000, 40_000, 100_000];
const RUNS: usize = 5;

/// The metrics that are timed, and the colours of their curves.
const CURVES: [(&str, &str); 3] = [
    ("MSDM2, symmetric, with preparation", "#b5482a"),
    ("tree", "#2a6db5"),
    ("P2S of vertices, both ways", "#3a8a3a"),
];

pub(crate) fn run(arguments: &[String]) -> Result<()> {
    let mut arguments = arguments.iter();
    let path = arguments.next();
    let sizes: Vec<usize> = arguments.map(|size| size.parse()).collect::<Result<_, _>>()?;
    let sizes = if sizes.is_empty() { SIZES.to_vec() } else { sizes };
    println!("| vertices | {} |\n|---|---|---|---|", CURVES.map(|curve| curve.0).join(" | "));
    let mut rows = Vec::new();
    for vertices in sizes {
        let seconds = measure(vertices)?;
        let cells = seconds.map(|seconds| format!("{seconds:.4}"));
        println!("| {vertices} | {} |", cells.join(" | "));
        rows.push((vertices, seconds));
    }
    path.map(|path| std::fs::write(path, plot(&rows))).transpose()?;
    Ok(())
}

/// The least CPU seconds of each of the [`CURVES`].
fn measure(vertices: usize) -> Result<[f64; 3]> {
    let (a, b) = pair(vertices);
    let surface = |shape: &Shape| Msdm2Surface::new(&shape.0, &shape.1, DEFAULT_LEVELS);
    let score = least(|| {
        let (a, b) = rayon::join(|| surface(&a), || surface(&b));
        Ok(msdm2(&a?, &b?, Interpolation::AtVertex).symmetric)
    })?;
    let tree = least(|| Ok(TriangleTree::new(&b.0, &b.1)?))?;
    let trees = (TriangleTree::new(&a.0, &a.1)?, TriangleTree::new(&b.0, &b.1)?);
    let first = IndexedMesh::new(MeshRef::new(&a.0, &a.1), &trees.0);
    let second = IndexedMesh::new(MeshRef::new(&b.0, &b.1), &trees.1);
    let p2s = least(|| Ok(p2s_of_vertices(first, second)))?;
    Ok([score, tree, p2s])
}

fn least<T>(run: impl Fn() -> Result<T>) -> Result<f64> {
    let mut least = f64::INFINITY;
    for _ in 0..RUNS {
        // The scheduler counts in ticks of some milliseconds.
        let (start, mut count, mut used) = (cpu_seconds(), 0, 0.0);
        while used < 0.1 {
            black_box(run()?);
            count += 1;
            used = cpu_seconds() - start;
        }
        least = least.min(used / f64::from(count));
    }
    Ok(least)
}

/// Both axes logarithmic.
fn plot(rows: &[(usize, [f64; 3])]) -> String {
    let (first, last) = (rows[0].0 as f64, rows[rows.len() - 1].0 as f64);
    let x = |vertices: usize| 64.0 + 560.0 * (vertices as f64 / first).ln() / (last / first).ln();
    let y = |seconds: f64| 352.0 - 65.6 * (seconds / 1e-4).log10();
    let mut svg = String::from(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 660 400\" \
         font-family=\"sans-serif\" font-size=\"12\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n",
    );
    for seconds in [1e-4, 1e-3, 1e-2, 0.1, 1.0, 10.0] {
        let y = y(seconds);
        let _ = writeln!(
            svg,
            "<line x1=\"64\" x2=\"624\" y1=\"{y:.1}\" y2=\"{y:.1}\" stroke=\"#ddd\"/>\
             <text x=\"56\" y=\"{:.1}\" text-anchor=\"end\">{seconds} s</text>",
            y + 4.0
        );
    }
    for &(vertices, _) in rows {
        let x = x(vertices);
        let _ = writeln!(
            svg,
            "<line y1=\"24\" y2=\"352\" x1=\"{x:.1}\" x2=\"{x:.1}\" stroke=\"#eee\"/>\
             <text x=\"{x:.1}\" y=\"370\" text-anchor=\"middle\">{} k</text>",
            vertices as f64 / 1e3
        );
    }
    svg += "<text x=\"344\" y=\"390\" text-anchor=\"middle\">vertices of each mesh</text>\n";
    for (index, (name, colour)) in CURVES.into_iter().enumerate() {
        let points = rows.iter().map(|(vertices, seconds)| [x(*vertices), y(seconds[index])]);
        let joined: Vec<String> = points.clone().map(|[x, y]| format!("{x:.1},{y:.1}")).collect();
        let _ = writeln!(
            svg,
            "<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"2\"/>",
            joined.join(" ")
        );
        for [x, y] in points {
            let _ =
                writeln!(svg, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3\" fill=\"{colour}\"/>");
        }
        let _ = writeln!(
            svg,
            "<text x=\"76\" y=\"{}\" fill=\"{colour}\">{name}: CPU seconds</text>",
            42 + 16 * index
        );
    }
    svg + "</svg>\n"
}
