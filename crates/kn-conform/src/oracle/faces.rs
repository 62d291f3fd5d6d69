//! 5.3 and 5.4: joins, numbers of vertices, faces.

use super::conquest::{Conquest, NONE};
use super::intra::Payload;
use super::range::{Gamma, Section};
use kn_bitstream::rule::{self, Rule};

/// 5.3, and the numbers of 5.4.
pub(super) fn read_joins(
    conquest: &mut Conquest,
    joins: u64,
    section: &mut Section<'_>,
) -> Result<(), Rule> {
    let (mut gaps, mut depths) = (Gamma::default(), Gamma::default());
    let mut earlier_of = vec![NONE; conquest.vertices.len()];
    let mut first = 0;
    for _ in 0..joins {
        let copy = first + section.gamma(&mut gaps);
        let earlier = copy - 1 - section.gamma(&mut depths);
        let is_mesh = |v: i64| conquest.vertices.get(v as usize).is_some_and(|v| !v.dummy);
        if earlier < 0 || !is_mesh(copy) || !is_mesh(earlier) {
            return Err(rule::INTRA_JOIN_ORDER);
        }
        let [copy_at, earlier_at] = [copy as usize, earlier as usize];
        earlier_of[copy_at] = earlier_at;
        conquest.vertices[copy_at].twin = conquest.vertices[earlier_at].twin;
        conquest.vertices[earlier_at].twin = copy_at;
        first = copy + 1;
    }
    let mut number = 0;
    for vertex in 0..conquest.vertices.len() {
        if earlier_of[vertex] != NONE {
            conquest.vertices[vertex].number = conquest.vertices[earlier_of[vertex]].number;
        } else if !conquest.vertices[vertex].dummy {
            conquest.vertices[vertex].number = number;
            number += 1;
        }
    }
    Ok(())
}

/// 5.4
pub(super) fn faces_of(
    conquest: &Conquest,
    payload: &Payload<'_>,
    section: &mut Section<'_>,
) -> Result<Vec<[u32; 3]>, Rule> {
    let numbers = conquest.vertices.iter().filter(|v| !v.dummy).map(|v| v.number as u64 + 1);
    if payload.vertices != payload.isolated + numbers.max().unwrap_or(0) {
        return Err(rule::INTRA_VERTICES_COUNT);
    }
    let dummy = |v: &usize| conquest.vertices[*v].dummy;
    let simple = conquest.corners.iter().filter(|corners| !corners.iter().any(dummy));
    let mut faces: Vec<[u32; 3]> =
        simple.map(|corners| corners.map(|v| conquest.vertices[v].number as u32)).collect();
    for _ in 0..payload.raw_faces {
        let corners = [0; 3].map(|_: i64| (section.raw(16) << 16) + section.raw(16));
        if corners.iter().any(|&corner| corner as u64 >= payload.vertices) {
            return Err(rule::INTRA_FACES_RAW);
        }
        faces.push(corners.map(|corner| corner as u32));
    }
    Ok(faces)
}
