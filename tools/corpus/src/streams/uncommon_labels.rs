//! I-frames where the fit along a border between labels (5.6) hangs on one of its limits.

use anyhow::Result;

use kn_mesh::GridMesh;

use super::Draft;
use super::shapes::{
    Faces, Noise, bipyramid, curled, hubs, knotted_at, mesh, pillow, sphere, together, torus,
};
use super::uncommon_meshes::{groups, noise_labels};

pub(crate) fn drafts() -> Result<Vec<Draft>> {
    Ok(vec![
        groups(
            "label_hubs",
            "A search that meets more than 256 vertices within four edges.",
            COVERS,
            &[mesh(hubs(24, 22), |v| curled(v, 3000.0, 900), Some(&mut noise_labels(3)))],
        )?,
        groups(
            "label_lattice",
            "The fit is to ranks where there is a lattice, whose axes are spaced differently.",
            COVERS,
            &[on_lattice()],
        )?,
        groups(
            "label_tight",
            "Vertices in one place or a step apart: distances below 1, values of the fit that end in 1/2.",
            COVERS,
            &tight(),
        )?,
        groups(
            "label_no_samples",
            "Two candidates and no sample: labels that meet at a vertex come from twins in another surface; \
             vertices of valence 2.",
            COVERS,
            &[no_samples()],
        )?,
    ])
}

const COVERS: &[&str] = &["intra.labels.order", "intra.labels.vote", "intra.labels.border"];

/// Gaps of 5 and 6 along x, of 17 along y and of 7 along z.
fn on_lattice() -> GridMesh {
    let heights = |i: u32, j: u32| (3 * i + 5 * j + i * j) % 20;
    let at = |v: u32| {
        let rank = [v / 20, heights(v / 20, v % 20), v % 20];
        [rank[0] * 27 / 5, 17 * rank[1], 7 * rank[2]].map(|x| x as i32)
    };
    let quads = (0..19).flat_map(|i| (0..19).map(move |j| 20 * i + j));
    let faces: Faces = quads.flat_map(|a| [[a, a + 20, a + 21], [a, a + 21, a + 1]]).collect();
    mesh(faces, at, Some(&mut noise_labels(4)))
}

fn tight() -> Vec<GridMesh> {
    let surface = torus(14, 15);
    let mut noise = Noise::new(11);
    let step_apart = |_| [(); 3].map(|()| (noise.below(6) / 5) as i32);
    vec![
        mesh(surface.clone(), step_apart, Some(&mut noise_labels(3))),
        mesh(surface.clone(), |v| curled(v, 0.8, 0), Some(&mut noise_labels(2))),
        mesh(torus(21, 20), |_| [5, -7, 9], Some(&mut noise_labels(2))),
    ]
}

/// A sphere, and octahedra that each share their two tips with vertices of it.
fn no_samples() -> GridMesh {
    const OCTAHEDRA: u32 = 12;
    let base = sphere(9, 6);
    let base_count = 2 + 9 * 6;
    let mut parts = vec![base];
    parts.extend((0..OCTAHEDRA).map(|_| bipyramid(4)));
    parts.extend([pillow(), pillow()]);
    let tips = (0..OCTAHEDRA).flat_map(|i| {
        let octahedron = base_count + 6 * i;
        [(2 + i, octahedron + 4), (40 + i, octahedron + 5)]
    });
    let faces = knotted_at(together(&parts), &tips.collect::<Vec<_>>());
    mesh(faces, |v| curled(v, 900.0, 50), Some(&mut noise_labels(3)))
}
