//! Triangulations for the corpus that no scan has: high valences, handles, points of many surfaces.

use kn_mesh::GridMesh;

/// Faces of a surface; vertices are numbered from 0 without gaps.
pub(crate) type Faces = Vec<[u32; 3]>;

/// A stream of numbers, the same in every run.
pub(crate) struct Noise(u64);

impl Noise {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// From 0 to `count` − 1.
    pub(crate) fn below(&mut self, count: usize) -> usize {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % count
    }

    /// From −`reach` to `reach`.
    pub(crate) fn around(&mut self, reach: i32) -> i32 {
        self.below(2 * reach as usize + 1) as i32 - reach
    }

    pub(crate) fn point(&mut self, reach: i32) -> [i32; 3] {
        [(); 3].map(|()| self.around(reach))
    }
}

/// Two tips over a ring of `sides` vertices.
pub(crate) fn bipyramid(sides: u32) -> Faces {
    let ring = (0..sides).map(|i| (i, (i + 1) % sides));
    ring.flat_map(|(a, b)| [[a, b, sides], [b, a, sides + 1]]).collect()
}

/// Two poles, the first two vertices, and `parallels` rings of `meridians`.
pub(crate) fn sphere(meridians: u32, parallels: u32) -> Faces {
    let at = |i: u32, j: u32| 2 + j * meridians + i % meridians;
    let mut faces = Faces::new();
    for i in 0..meridians {
        faces.push([0, at(i, 0), at(i + 1, 0)]);
        faces.push([1, at(i + 1, parallels - 1), at(i, parallels - 1)]);
        for j in 0..parallels - 1 {
            let [a, b, c, d] = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)];
            faces.extend([[a, b, c], [a, c, d]]);
        }
    }
    faces
}

/// Two triangles back to back: three vertices of valence 2.
pub(crate) fn pillow() -> Faces {
    vec![[0, 1, 2], [0, 2, 1]]
}

/// A sphere whose edges are turned wherever that makes valences less equal, so that few edges lead
/// from any vertex to hundreds.
pub(crate) fn hubs(meridians: u32, parallels: u32) -> Faces {
    let faces = sphere(meridians, parallels);
    let mut valences = vec![0; vertex_count(&faces) as usize];
    for &vertex in faces.iter().flatten() {
        valences[vertex as usize] += 1;
    }
    let tries = 8 * faces.len();
    turn_edges(faces, tries, &mut Noise::new(7), |ends, tips| {
        let of = |pair: [u32; 2]| pair.map(|v| valences[v as usize]);
        let [ends_now, tips_now] = [of(ends), of(tips)];
        let turn = ends_now.iter().all(|&v| v > 3)
            && ends_now.iter().sum::<u32>() < tips_now.iter().sum::<u32>() + 3;
        if turn {
            ends.into_iter().for_each(|v| valences[v as usize] -= 1);
            tips.into_iter().for_each(|v| valences[v as usize] += 1);
        }
        turn
    })
}

pub(crate) fn torus(around: u32, across: u32) -> Faces {
    let at = |i: u32, j: u32| i % around * across + j % across;
    let quads = (0..around).flat_map(|i| (0..across).map(move |j| (i, j)));
    quads
        .flat_map(|(i, j)| {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            [[a, b, c], [a, c, d]]
        })
        .collect()
}

/// So many tori, each glued to the one before along a triangle that both lose.
pub(crate) fn handles(count: u32, around: u32, across: u32) -> Faces {
    let mut faces = torus(around, across);
    for _ in 1..count {
        let base = vertex_count(&faces);
        let mut other = shifted(&torus(around, across), base);
        let [a, b] = [faces.swap_remove(faces.len() - 5), other.swap_remove(3)];
        let glued = |v: u32| match b.iter().position(|&own| own == v) {
            Some(corner) => a[(3 - corner) % 3],
            None => v,
        };
        faces.extend(other.iter().map(|face| face.map(glued)));
        close_gaps(&mut faces);
    }
    faces
}

/// Three classes of `size` vertices, each vertex joined with all of the other classes: 2 · `size`
/// triangles around every one, from an orientable embedding of the complete tripartite graph.
pub(crate) fn crowd(size: u32) -> Faces {
    let (b, c) = (|i| size + i, |i| 2 * size + i);
    let pairs = (0..size).flat_map(|i| (0..size).map(move |j| (i, j)));
    pairs
        .flat_map(|(i, j)| [[i, b(j), c((i + j) % size)], [b(j), i, c((i + j + 1) % size)]])
        .collect()
}

/// Several surfaces side by side.
pub(crate) fn together(parts: &[Faces]) -> Faces {
    let mut faces = Faces::new();
    for part in parts {
        let base = vertex_count(&faces);
        faces.extend(shifted(part, base));
    }
    faces
}

/// The surface with edges turned here and there, wherever that doubles no edge.
pub(crate) fn turned_edges(faces: Faces, tries: usize, noise: &mut Noise) -> Faces {
    turn_edges(faces, tries, noise, |_, _| true)
}

/// Likewise, where `wanted` says so of an edge's two ends and the two tips that it would join.
fn turn_edges(
    mut faces: Faces,
    tries: usize,
    noise: &mut Noise,
    mut wanted: impl FnMut([u32; 2], [u32; 2]) -> bool,
) -> Faces {
    let tip = |face: &[u32; 3], a: u32, b: u32| {
        (0..3).find(|&k| face[k] == a && face[(k + 1) % 3] == b).map(|k| face[(k + 2) % 3])
    };
    for _ in 0..tries {
        let (at, k) = (noise.below(faces.len()), noise.below(3));
        let (a, b, c) = (faces[at][k], faces[at][(k + 1) % 3], faces[at][(k + 2) % 3]);
        let beyond = faces.iter().enumerate().find_map(|(g, face)| Some((g, tip(face, b, a)?)));
        let Some((other, d)) = beyond else { continue };
        let joined = faces.iter().any(|face| face.contains(&c) && face.contains(&d));
        if !joined && c != d && wanted([a, b], [c, d]) {
            faces[at] = [c, d, b];
            faces[other] = [d, c, a];
        }
    }
    faces
}

/// The surface without the faces at a vertex: a hole with as many sides.
pub(crate) fn without_vertex(faces: &Faces, vertex: u32) -> Faces {
    let mut rest: Faces = faces.iter().copied().filter(|face| !face.contains(&vertex)).collect();
    close_gaps(&mut rest);
    rest
}

/// The surface with groups of vertices made one each: faces may come to repeat a vertex.
pub(crate) fn knotted(mut faces: Faces, groups: &[usize], noise: &mut Noise) -> Faces {
    let mut free: Vec<u32> = (0..vertex_count(&faces)).collect();
    for &size in groups {
        let group: Vec<u32> =
            (0..size).map(|_| free.swap_remove(noise.below(free.len()))).collect();
        for corner in faces.iter_mut().flatten() {
            if group.contains(corner) {
                *corner = group[0];
            }
        }
    }
    close_gaps(&mut faces);
    faces
}

/// The surface with pairs of vertices made one each.
pub(crate) fn knotted_at(mut faces: Faces, pairs: &[(u32, u32)]) -> Faces {
    for corner in faces.iter_mut().flatten() {
        let pair = pairs.iter().find(|(_, other)| other == corner);
        *corner = pair.map_or(*corner, |&(vertex, _)| vertex);
    }
    close_gaps(&mut faces);
    faces
}

/// A mesh of the faces with positions and, where asked for, labels by vertex.
pub(crate) fn mesh(
    faces: Faces,
    position: impl FnMut(u32) -> [i32; 3],
    label: Option<&mut dyn FnMut(u32) -> u8>,
) -> GridMesh {
    let vertices = 0..vertex_count(&faces);
    let labels = label.map(|label| vertices.clone().map(label).collect());
    GridMesh::new(vertices.map(position).collect(), faces).with_labels(labels.unwrap_or_default())
}

/// A curled surface: neighbours by number lie near each other, with some noise.
pub(crate) fn curled(vertex: u32, size: f64, noise: i32) -> [i32; 3] {
    let along = f64::from(vertex) * 0.37;
    let mut noise_of = Noise::new(u64::from(vertex) * 7919 + 13);
    [0.0, 1.0, 2.0].map(|axis| {
        let smooth = libm::sin(along + axis) * libm::cos(0.11 * along * (axis + 1.0));
        libm::round(size * smooth) as i32 + noise_of.around(noise)
    })
}

fn vertex_count(faces: &Faces) -> u32 {
    faces.iter().flatten().max().map_or(0, |most| most + 1)
}

fn shifted(faces: &Faces, by: u32) -> Faces {
    faces.iter().map(|face| face.map(|v| v + by)).collect()
}

/// Numbers the vertices that faces use from 0.
fn close_gaps(faces: &mut Faces) {
    let mut used: Vec<u32> = faces.iter().flatten().copied().collect();
    used.sort_unstable();
    used.dedup();
    for corner in faces.iter_mut().flatten() {
        *corner = used.partition_point(|&v| v < *corner) as u32;
    }
}
