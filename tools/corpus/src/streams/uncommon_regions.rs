//! Influence that is blended across the borders of regions.

use anyhow::Result;

use kn_mesh::GridMesh;

use super::Draft;
use super::shapes::Noise;
use super::texts::{HEADER, Text};
use super::uncommon_motion::{Motion, Scene};

pub(crate) fn drafts() -> Result<Vec<Draft>> {
    let mut drafts = Vec::new();
    for (scheme, name) in [(0, "near_inverse"), (1, "near_sumner"), (2, "near_gaussian")] {
        let danger = "Five regions on a sheet, one without nodes, a fin, vertices in one point, and an island: \
                      the two nearest regions along the surface, and what that adds.";
        drafts.push(sheet(scheme).draft(name, danger, None, NEAR)?);
    }
    let danger = "Ways of 2^21 − 1 and of 2^21 grid steps: the latter is none.";
    drafts.push(far().draft("near_far", danger, None, &["deform.influence.near"])?);
    Ok(drafts)
}

const NEAR: &[&str] = &[
    "header.influence.meaning",
    "header.influence.range",
    "deform.influence.near",
    "deform.influence.blended",
    "deform.influence.nearest",
    "deform.influence.mode",
    "deform.influence.replication",
    "deform.weights.floor",
];

/// Blended influence, and labels with these regions.
fn header(scheme: u8, slots: u8, regions: &[u8]) -> Text {
    let numbers: Vec<String> = regions.iter().map(u8::to_string).collect();
    Text::new(HEADER)
        .set("nodes_per_vertex", 0, &slots.to_string())
        .set("weight_scheme", 0, &scheme.to_string())
        .set("influence_blended", 0, "1")
        .set("label_set", 0, "2")
        .after(
            "grid_step",
            0,
            &[
                &format!("label_count = {}", regions.len()),
                &format!("label_region = {}", numbers.join(" ")),
            ],
        )
}

const COLUMNS: usize = 12;
const ROWS: usize = 6;

/// Labels of the sheet by column, for the upper and the lower rows; their regions are 9, 4, 6, 2, 6, 0.
const LABELS: [[u8; COLUMNS]; 2] =
    [[0, 0, 0, 1, 1, 2, 2, 3, 3, 3, 4, 4], [0, 0, 1, 1, 1, 1, 3, 3, 3, 5, 5, 5]];

/// A bent sheet with edges of many lengths, some of them 0; a fin on it; islands: of two regions, of four, and of a
/// region without nodes alone.
fn sheet(scheme: u8) -> Scene {
    let mut noise = Noise::new(21);
    let mut mesh = GridMesh::default();
    for (column, row) in (0..COLUMNS).flat_map(|column| (0..ROWS).map(move |row| (column, row))) {
        let [x, y, z] = noise.point(9);
        let (column, row) = (column as i32, row as i32);
        mesh.positions.push([20 * column + x, 25 * row + y, z + (column - 5).pow(2)]);
        mesh.labels.push(LABELS[usize::from(row >= 3)][column as usize]);
    }
    let at = |column: usize, row: usize| (column * ROWS + row) as u32;
    for column in 0..COLUMNS - 1 {
        for row in 0..ROWS - 1 {
            let [a, b] = [at(column, row), at(column + 1, row)];
            mesh.faces.extend([[a, b, a + 1], [a + 1, b, b + 1]]);
        }
    }
    // In one point across two borders: edges of length 0, which count as 1.
    for (one, other) in [(at(3, 1), at(2, 1)), (at(5, 1), at(4, 1)), (at(7, 2), at(6, 2))] {
        mesh.positions[one as usize] = mesh.positions[other as usize];
    }
    // A third face on an edge, which is coded raw, to vertices of region 0 that are far along the sheet.
    mesh.faces.extend([[at(1, 0), at(1, 1), at(10, 5)], [at(0, 3), at(0, 4), at(9, 5)]]);
    let own = mesh.positions.len() as u32;
    mesh.positions.extend([[30, 60, 40], [52, 61, 44], [35, 85, 41], [60, 90, 45]]);
    mesh.labels.extend([2, 2, 0, 0]);
    mesh.faces.extend([[own, own + 1, own + 2], [own + 1, own + 3, own + 2]]);
    // Three regions as far from a vertex of a fourth.
    let centre = mesh.positions.len() as u32;
    mesh.positions.extend([[300, 0, 0], [312, 0, 0], [300, 12, 0], [300, 0, 12]]);
    mesh.labels.extend([5, 0, 1, 3]);
    mesh.faces.extend([[centre, centre + 1, centre + 2], [centre, centre + 2, centre + 3]]);
    let alone = mesh.positions.len() as u32;
    mesh.positions.extend([[130, 60, 40], [152, 61, 44], [135, 85, 41]]);
    mesh.labels.extend([2, 2, 2]);
    mesh.faces.push([alone, alone + 1, alone + 2]);
    // Region 6 (labels 2 and 4) has no node.
    let on = |column: usize, row: usize| mesh.positions[at(column, row) as usize];
    let mut nodes = vec![on(0, 0), on(1, 4), on(2, 2), on(3, 1), on(4, 4), on(3, 4), on(7, 1)];
    nodes.extend([on(8, 4), on(9, 2), on(10, 5), on(9, 4), on(7, 4), on(0, 2)]);
    let motion = |step: u8, noise: &mut Noise| Motion {
        translation: nodes.iter().map(|_| noise.point(900)).collect(),
        turn_or_scale: nodes.iter().map(|_| noise.point(20)).collect(),
        steps: [step, 20 + step],
        ..Motion::default()
    };
    let motions = [1, 3].map(|step| motion(step, &mut noise)).into();
    let sigma = (scheme == 2).then_some(25);
    let header = header(scheme, 4, &[9, 4, 6, 2, 6, 0]);
    Scene { header, mesh, nodes, affine: false, sigma, motions }
}

/// Two pairs of regions at the ends of edges that are 2^21 − 1 and 2^21 steps long, each with a node.
fn far() -> Scene {
    let mut mesh = GridMesh::default();
    // 2 000 000 to the side, 630 909 or 630 910 up.
    for (z, reach, labels) in [(0, 315_454, [0, 1]), (50, 315_455, [2, 3])] {
        let at = mesh.positions.len() as u32;
        let ends = [[-1_000_000, -315_455, z], [1_000_000, reach, z], [1_000_003, reach - 9, z]];
        mesh.positions.extend(ends);
        mesh.labels.extend([labels[0], labels[1], labels[1]]);
        mesh.faces.push([at, at + 1, at + 2]);
    }
    let nodes: Vec<[i32; 3]> = [0, 1, 3, 4].map(|v| mesh.positions[v]).into();
    let motion = Motion {
        translation: vec![[90, 5, 7], [-33, 11, 2], [80, -6, 3], [-50, 1, 4]],
        turn_or_scale: vec![[0; 3]; 4],
        steps: [1, 20],
        ..Motion::default()
    };
    let header = header(1, 3, &[0, 1, 2, 3]);
    Scene { header, mesh, nodes, affine: false, sigma: None, motions: vec![motion] }
}
