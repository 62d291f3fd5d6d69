//! Streams whose roundings hang on a last bit of binary64. Their vertices are found by
//! `spec/reference/search_last_bits.py`, which says why there are any: with a reading of chapter 8 that
//! differs in one operation, one of them is rounded to another integer.

use anyhow::Result;

use kn_codec::intra::{IntraDecoder, IntraLimits, decode_intra, encode_intra};
use kn_mesh::GridMesh;

use super::Draft;
use super::shapes::{Faces, mesh, sphere};
use super::texts::{HEADER, INDEX, Text, intra_unit, payload_of};

pub(crate) fn drafts() -> Result<Vec<Draft>> {
    Ok(vec![last_bits()?, last_bits_of_weights()?, last_bits_of_smoothing()?])
}

/// One node moves all vertices; A·x is 2^35 where a position is 2^28.
#[derive(Clone, Copy)]
struct Scene {
    translation: [i32; 3],
    rotation: [i32; 3],
    scale: [i32; 3],
    shear: [i32; 3],
    vertices: &'static [[i32; 3]],
}

const A_LITTLE: [i32; 3] = [5, -7, 11];

const NODE: [i32; 3] = [900_003, -899_983, 900_033];

const SCENES: [Scene; 7] = [
    Scene {
        translation: A_LITTLE,
        rotation: [-11598, 2651, 11768],
        scale: [1616, 1665, 1630],
        shear: [2015, 1997, -1924],
        vertices: &[
            [899_694, -899_748, 899_761],
            [899_779, -899_736, 900_355],
            [899_925, -899_745, 899_805],
            [900_101, -900_153, 900_211],
            [900_208, -900_268, 900_350],
            [900_332, -900_146, 899_663],
        ],
    },
    Scene {
        translation: A_LITTLE,
        rotation: [-14, -15072, 13272],
        scale: [1699, 1710, 1755],
        shear: [-2014, 1958, -1981],
        vertices: &[
            [899_821, -899_896, 899_751],
            [899_924, -900_117, 899_816],
            [900_254, -900_244, 899_824],
        ],
    },
    Scene {
        translation: A_LITTLE,
        rotation: [-14998, -15269, -15167],
        scale: [1766, 1738, 1602],
        shear: [1955, 1907, -2012],
        vertices: &[[899_746, -900_270, 900_361]],
    },
    Scene {
        translation: A_LITTLE,
        rotation: [14774, 246, 2116],
        scale: [1659, 1688, 1659],
        shear: [-2017, 1905, 1925],
        vertices: &[[900_258, -899_935, 900_085]],
    },
    Scene {
        translation: A_LITTLE,
        rotation: [-9909, 4622, 7712],
        scale: [1675, 1630, 1790],
        shear: [2028, 2029, -1977],
        vertices: &[
            [899_725, -900_145, 899_748],
            [899_765, -899_852, 899_700],
            [899_894, -900_016, 899_811],
        ],
    },
    Scene {
        translation: A_LITTLE,
        rotation: [14834, 7538, 10178],
        scale: [1698, 1649, 1677],
        shear: [1995, -1907, -1971],
        vertices: &[[900_128, -899_718, 899_816], [900_356, -899_956, 899_748]],
    },
    // b is on the other side of a power of two than n − A·n.
    Scene {
        translation: [909_247, 913_516, -943_933],
        rotation: [-6763, -4597, 4],
        scale: [1754, 1672, 1672],
        shear: [1996, 1964, 1905],
        vertices: &[[900_042, -899_863, 899_963]],
    },
];

fn last_bits() -> Result<Draft> {
    let mut text = header(1, 0);
    for scene in &SCENES {
        text += &intra_unit(&payload_of(&cloud(scene.vertices))?);
        text += &group(&[NODE], None, scene);
    }
    Ok(Draft {
        name: "last_bits".into(),
        text: text + INDEX,
        danger: "Roundings that hang on a last bit: the sine, the products of R and A, b, the order of sums, fusing."
            .into(),
        rule: None,
        covers: &[
            "conventions.binary64",
            "deform.sincos",
            "deform.rotation",
            "deform.matrix",
            "deform.node",
            "deform.blend",
        ],
    })
}

/// Two pairs of nodes in opposite places move all vertices: products of 2^34 with the weights cancel.
fn last_bits_of_weights() -> Result<Draft> {
    let [p, q] = [[400_003, -399_961, 300_007], [-500_029, -450_001, 410_009]];
    let nodes = [p, p.map(|c: i32| -c), q, q.map(|c: i32| -c)];
    let scene = Scene {
        translation: A_LITTLE,
        rotation: [9001, -5003, 12007],
        scale: [1699, 1777, 1788],
        shear: [2011, -1999, 2003],
        vertices: &[
            [209, -158, -37],
            [-129, -9, -160],
            [-172, 110, -104],
            [284, -192, -9],
            [-122, -261, -278],
            [27, -60, 139],
            [-193, 33, -143],
            [-284, 192, 9],
            [-270, -142, -13],
            [-168, -162, -132],
            [-275, 90, 244],
        ],
    };
    // With this σ the exponent of the farther pair is 3 ln 2, and three times a rounded ln 2 is off by 2^(−52).
    let narrow = Scene { vertices: &[[294, 210, 85], [120, -242, -285]], ..scene };
    let mut text = header(4, 2);
    for (sigma, scene) in [(500_000, scene), (225_000, narrow)] {
        text += &intra_unit(&payload_of(&cloud(scene.vertices))?);
        text += &group(&nodes, Some(sigma), &scene);
    }
    Ok(Draft {
        name: "last_bits_weights".into(),
        text: text + INDEX,
        danger: "Roundings that hang on a last bit: the exponential, the sum of the weights and the division by it, \
                 the weighted sum."
            .into(),
        rule: None,
        covers: &[
            "conventions.binary64",
            "deform.exp",
            "deform.weights.gaussian",
            "deform.weights.normalise",
            "deform.blend",
        ],
    })
}

fn header(slots: u8, scheme: u8) -> String {
    Text::new(HEADER)
        .set("nodes_per_vertex", 0, &slots.to_string())
        .set("weight_scheme", 0, &scheme.to_string())
        .set("label_set", 0, "0")
        .build()
}

fn cloud(vertices: &[[i32; 3]]) -> GridMesh {
    GridMesh::new(vertices.to_vec(), Vec::new())
}

/// Key nodes that all move alike, and their motion: translations in units, angles in
/// 2^−12, scales and shears in 2^−8.
fn group(nodes: &[[i32; 3]], sigma: Option<u32>, scene: &Scene) -> String {
    let mut last = [0; 3];
    let mut deltas = String::new();
    for &node in nodes {
        for axis in 0..3 {
            deltas += &format!("{} ", node[axis] - last[axis]);
        }
        last = node;
    }
    let each =
        |values: [i32; 3]| values.map(|value| format!("{value} ")).concat().repeat(nodes.len());
    let sigma = sigma.map_or(String::new(), |sigma| format!("weight_sigma = {sigma}\n"));
    format!(
        "\nunit_type = 3\nnode_count = {}\nnode_coding = 1\naffine_mode = 2\n{sigma}\
         node_delta_rice = 18\nnode_delta = {deltas}\n\nunit_type = 4\n\
         digest_present = 0\nname_present = 0\nreference_mode = 0\nentropy_mode = 0\n\
         residual_present = 0\ntranslation_mode = 0\nrotation_enabled = 1\nscale_enabled = 1\n\
         shear_enabled = 1\ntranslation_step = 0\ntranslation_table = 20\nrotation_step = 8\n\
         scale_step = 24\nshear_step = 24\nparameter_table = 40\ntranslation = {}\n\
         rotation = {}\nscale = {}\nshear = {}\n",
        nodes.len(),
        each(scene.translation),
        each(scene.rotation),
        each(scene.scale),
        each(scene.shear),
    )
}

/// A closed mesh near the end of the grid, where a last bit is largest.
struct Smoothed {
    faces: Faces,
    strength: u8,
    /// Of each axis, grid steps below 2^20 by decoded vertex, a digit for each.
    below: [&'static str; 3],
}

fn smoothed() -> [Smoothed; 2] {
    let fields = [
        "1111112221122121122222221112212122111",
        "1112112212112221122222112212121221111",
        "1111221121112222221122222111121212121",
        "1122111121111122212212222211221211221",
        "2112211212212222122211121222112212211",
    ];
    [[0, 1, 2], [3, 4, 0]].map(|axes| Smoothed {
        faces: sphere(7, 5),
        strength: 5,
        below: axes.map(|field: usize| fields[field]),
    })
}

fn last_bits_of_smoothing() -> Result<Draft> {
    let mut text = header(4, 0);
    for Smoothed { faces, strength, below } in smoothed() {
        let order = decoded_order(&faces)?;
        let place = |vertex: u32| {
            let at = order.iter().position(|&other| other == vertex);
            below.map(|digits| {
                let digit =
                    at.and_then(|at| digits.as_bytes().get(at)).map_or(0, |digit| digit - b'0');
                (1 << 20) - i32::from(digit)
            })
        };
        let unit = Text::new(&intra_unit(&payload_of(&mesh(faces.clone(), place, None))?));
        text += &unit.set("smoothing_strength", 0, &strength.to_string()).build();
    }
    Ok(Draft {
        name: "last_bits_smoothing".into(),
        text: text + INDEX,
        danger: "Roundings that hang on a last bit of the smoothing: the order of the neighbours' sum, the division by \
                 their number, fusing."
            .into(),
        rule: None,
        covers: &["conventions.binary64", "smooth.operator", "smooth.pass"],
    })
}

/// For each decoded vertex of a mesh that has these faces, the vertex that it was: the order follows
/// from the faces alone.
fn decoded_order(faces: &Faces) -> Result<Vec<u32>> {
    let probe = mesh(faces.clone(), |v| [v as i32; 3], None);
    let limits = IntraLimits { max_vertices: 1 << 10, max_faces: 1 << 10 };
    let mut decoded = GridMesh::default();
    decode_intra(
        &encode_intra(&probe)?.payload(),
        &limits,
        &mut IntraDecoder::default(),
        &mut decoded,
    )?;
    Ok(decoded.positions.iter().map(|p| p[0] as u32).collect())
}
