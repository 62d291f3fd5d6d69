//! Conquests (5.2) and joins (5.3) that break one rule: a decoder that does not check it comes to a
//! mesh.
//!
//! Decisions are written as in 4.4, found by a search over those that a decoder without the check
//! takes.

use super::Draft;
use super::decisions::{payload, section};
use super::faulty_meshes::draft;

/// A mesh with all of its vertices in the origin.
struct Conquest {
    name: &'static str,
    rule: &'static str,
    danger: &'static str,
    /// Seeds of these valences first; each is followed by its own words.
    seeds: &'static [([u32; 3], &'static str)],
    /// vertex_count, face_count, join_count.
    counts: [u32; 3],
    /// Number of vertices that are coded with triples that predict them.
    supported: u32,
}

pub(crate) fn drafts() -> Vec<Draft> {
    CONQUESTS.iter().map(Conquest::draft).collect()
}

impl Conquest {
    fn draft(&self) -> Draft {
        let [vertices, faces, joins] = self.counts;
        let seed = |(valences, rest): &([u32; 3], &str)| {
            format!("{}{rest} ", valences.map(|v| valence(4, v)).concat())
        };
        let connectivity: String = self.seeds.iter().map(seed).collect();
        let unsupported = "is_zero=1 ".repeat(3 * (vertices - self.supported) as usize);
        let supported = "is_zero.0=1 is_zero.1=1 is_zero.2=1 ".repeat(self.supported as usize);
        let counts = [vertices, 0, faces, 0, self.seeds.len() as u32, joins];
        let sections = [section(&connectivity), section(&(unsupported + &supported)), vec![]];
        draft(self.name, self.rule, self.danger, &payload(0, counts, sections))
    }
}

/// The decisions of a valence (`intra.connectivity.valence.code`) up to 15.
fn valence(context: u32, valence: u32) -> String {
    let decisions = |model: &str, places: &mut dyn Iterator<Item = u32>| -> String {
        places.map(|v| format!("{model}.{context}.{v}={} ", u8::from(v != valence))).collect()
    };
    match valence {
        6 => format!("is_six.{context}=1 "),
        0..6 => {
            let less = decisions("less_than", &mut (valence.max(2)..6).rev());
            format!("is_six.{context}=0 is_less.{context}=1 {less}")
        }
        _ => {
            let more = decisions("more_than", &mut (7..=valence));
            format!("is_six.{context}=0 is_less.{context}=0 {more}")
        }
    }
}

/// A tetrahedron whose fourth vertex is a dummy of the same valence.
const OPEN: ([u32; 3], &str) = ([3, 3, 3], "is_new.0.0=1 is_dummy=1 dummy_valence~3");

const CONQUESTS: &[Conquest] = &[
    Conquest {
        name: "intra_connectivity_close",
        rule: "intra.connectivity.close",
        danger: "A loop of more than three half-edges is closed, and the conquest goes on.",
        seeds: &[(
            [4, 4, 4],
            "is_new.1.1=1 is_dummy=0 is_six.0=0 is_less.0=1 less_than.0.5=1 less_than.0.4=0 \
             is_new.0.1=1 is_dummy=0 is_six.0=0 is_less.0=1 less_than.0.5=0 is_new.0.1=0 is_jump=0 \
             is_close.1=1",
        )],
        counts: [5, 7, 0],
        supported: 2,
    },
    Conquest {
        name: "intra_connectivity_split",
        rule: "intra.connectivity.split",
        danger: "A split that goes round its loop a thousand times.",
        seeds: &[(
            [4, 6, 4],
            "is_new.1.1=0 is_jump=1 is_merge=0 split_steps~3002 is_backward=0 is_new.0.2=1 is_dummy=0 is_six.2=0 is_less.2=1 less_than.2.5=1 less_than.2.4=1 \
             less_than.2.3=1 less_than.2.2=0 is_new.0.0=1 is_dummy=0 is_six.2=0 is_less.2=1 less_than.2.5=1 \
             less_than.2.4=1 less_than.2.3=1 less_than.2.2=0",
        )],
        counts: [5, 6, 0],
        supported: 2,
    },
    Conquest {
        name: "intra_connectivity_merge",
        rule: "intra.connectivity.merge",
        danger: "A jump to half-edge 4 of 3.",
        seeds: &[(
            [4, 6, 4],
            "is_new.1.1=0 is_jump=1 is_merge=1 16:0 16:4 is_new.0.2=1 is_dummy=0 is_six.2=0 is_less.2=1 less_than.2.5=1 less_than.2.4=1 \
             less_than.2.3=1 less_than.2.2=0 is_new.0.0=1 is_dummy=0 is_six.2=0 is_less.2=1 less_than.2.5=1 \
             less_than.2.4=1 less_than.2.3=1 less_than.2.2=0",
        )],
        counts: [5, 6, 0],
        supported: 2,
    },
    Conquest {
        name: "intra_connectivity_tip",
        rule: "intra.connectivity.tip",
        danger: "A jump to where the gate begins, which makes an edge from a vertex to itself.",
        seeds: &[(
            [5, 11, 5],
            "is_new.2.2=0 is_jump=1 is_merge=0 split_steps~2 is_backward=0 is_new.1.3=0 is_jump=1 \
             is_merge=1 16:0 16:1 is_new.0.3=1 is_dummy=0 is_six.8=0 is_less.8=1 less_than.8.5=0 \
             is_new.1.3=0 is_jump=0 is_close.1=0 is_right=0 is_new.0.0=1 is_dummy=0 is_six.2=0 is_less.2=1 \
             less_than.2.5=1 less_than.2.4=0 is_close.0=1",
        )],
        counts: [5, 10, 0],
        supported: 3,
    },
    Conquest {
        name: "intra_connectivity_valence",
        rule: "intra.connectivity.valence",
        danger: "Two triangles back to back at vertices of valence 1.",
        seeds: &[([1, 1, 1], "is_new.0.0=0 is_jump=0 is_close.1=1")],
        counts: [3, 2, 0],
        supported: 0,
    },
    Conquest {
        name: "intra_connectivity_lacking",
        rule: "intra.connectivity.valence",
        danger: "A conquest that ends with a vertex which lacks a triangle.",
        seeds: &[([2, 2, 3], "")],
        counts: [3, 2, 0],
        supported: 0,
    },
    Conquest {
        name: "intra_faces_dummies",
        rule: "intra.faces.count",
        danger: "One face, and more than three triangles of dummies for it.",
        seeds: &[(
            [3, 5, 5],
            "is_new.0.2=1 is_dummy=1 dummy_valence~3 is_close.0=0 is_new.0.0=1 is_dummy=1 \
             dummy_valence~2",
        )],
        counts: [3, 1, 0],
        supported: 0,
    },
    Conquest {
        name: "intra_join_order",
        rule: "intra.join.order",
        danger: "A join with the vertex before the first.",
        seeds: &[(
            [3, 3, 3],
            "is_new.0.0=1 is_dummy=0 is_six.0=0 is_less.0=1 less_than.0.5=1 less_than.0.4=1 \
             less_than.0.3=0 gaps~1 depths~1",
        )],
        counts: [3, 4, 1],
        supported: 0,
    },
    Conquest {
        name: "intra_join_beyond",
        rule: "intra.join.order",
        danger: "A join of a vertex behind the last.",
        seeds: &[([2, 2, 2], "gaps~3 depths~0")],
        counts: [3, 2, 1],
        supported: 0,
    },
    Conquest {
        name: "intra_join_dummy",
        rule: "intra.join.order",
        danger: "A dummy as the copy of a join.",
        seeds: &[OPEN, ([2, 2, 2], "gaps~3 depths~0")],
        counts: [6, 3, 1],
        supported: 0,
    },
    Conquest {
        name: "intra_join_with_dummy",
        rule: "intra.join.order",
        danger: "A dummy as the earlier vertex of a join.",
        seeds: &[OPEN, ([2, 2, 2], "gaps~4 depths~0")],
        counts: [5, 3, 1],
        supported: 0,
    },
];
