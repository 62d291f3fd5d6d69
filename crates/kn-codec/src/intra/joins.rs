//! Joins of cut vertices, faces that no surface can hold, and the numbers of decoded vertices
//! (`spec/05-intra.md`). Each function is encoder and decoder.

use super::conquest::{Conquest, NONE};
use kn_bitstream::range::{BinaryCoder, GammaModels, RAW_LIMIT, code_gamma};
use kn_bitstream::rule::{self, Rule};

/// Codes which vertices of the conquest repeat an earlier one: `(copy, earlier)`, copies ascending.
/// `joins` has the right length; an encoder brings its content. Ties them in `twin` (`#M`) and
/// marks the copies in `number` (`#M`) with what they repeat; everything else stays [`NONE`].
pub(super) fn code_joins<C: BinaryCoder>(
    coder: &mut C,
    conquest: &Conquest,
    joins: &mut [(u32, u32)],
    twin: &mut [u32],
    number: &mut [u32],
) -> Result<(), Rule> {
    let mut gaps = GammaModels::default();
    let mut depths = GammaModels::default();
    let mut first_free = 0u32;
    for join in joins {
        let gap = code_gamma(coder, &mut gaps, join.0.wrapping_sub(first_free));
        let copy = first_free.checked_add(gap).ok_or(rule::INTRA_JOIN_ORDER)?;
        let own_depth = join.0.wrapping_sub(join.1).wrapping_sub(1);
        let depth = code_gamma(coder, &mut depths, own_depth);
        let earlier =
            copy.checked_sub(depth).and_then(|e| e.checked_sub(1)).ok_or(rule::INTRA_JOIN_ORDER)?;
        let is_dummy =
            |vertex: u32| conquest.vertices.get(vertex as usize).is_none_or(|vertex| vertex.dummy);
        if is_dummy(copy) || is_dummy(earlier) {
            return Err(rule::INTRA_JOIN_ORDER);
        }
        number[copy as usize] = earlier;
        twin[copy as usize] = twin[earlier as usize];
        twin[earlier as usize] = copy;
        *join = (copy, earlier);
        first_free = copy + 1;
    }
    Ok(())
}

/// Numbers the vertices in the conquest's order: copies share, dummies get none. Returns how many
/// numbers there are.
pub(super) fn number_vertices(conquest: &Conquest, number: &mut [u32]) -> u32 {
    let mut count = 0;
    for vertex in 0..number.len() {
        if conquest.vertices[vertex].dummy {
            continue;
        }
        number[vertex] = match number[vertex] {
            NONE => {
                count += 1;
                count - 1
            }
            earlier => number[earlier as usize],
        };
    }
    count
}

/// Codes `faces` as they are, in decoded vertex numbers.
pub(super) fn code_raw_faces<C: BinaryCoder>(
    coder: &mut C,
    faces: &mut [[u32; 3]],
    vertices: u32,
) -> Result<(), Rule> {
    for corner in faces.iter_mut().flatten() {
        let high = coder.raw(*corner >> RAW_LIMIT, RAW_LIMIT);
        *corner = high << RAW_LIMIT | coder.raw(*corner, RAW_LIMIT);
        if *corner >= vertices {
            return Err(rule::INTRA_FACES_RAW);
        }
    }
    Ok(())
}
