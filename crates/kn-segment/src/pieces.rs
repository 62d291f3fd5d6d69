//! Connected pieces of equal label.

use super::LABELS;
use super::surface::Surface;

/// A connected piece of one label.
pub(super) struct Piece {
    pub(super) label: u8,
    pub(super) vertices: Vec<u32>,
    /// In the surface's units, squared.
    pub(super) area: f64,
}

/// All pieces, by their first vertex.
pub(super) fn pieces(surface: &Surface, labels: &[u8]) -> Vec<Piece> {
    let mut seen = vec![false; labels.len()];
    let mut pieces = Vec::new();
    for seed in 0..labels.len() {
        if !seen[seed] {
            seen[seed] = true;
            pieces.push(flood(surface, labels, seed, &mut seen));
        }
    }
    pieces
}

fn flood(surface: &Surface, labels: &[u8], seed: usize, seen: &mut [bool]) -> Piece {
    let mut piece = Piece { label: labels[seed], vertices: vec![seed as u32], area: 0.0 };
    let mut next = 0;
    while next < piece.vertices.len() {
        let v = piece.vertices[next] as usize;
        next += 1;
        piece.area += surface.areas[v];
        for &u in surface.around(v) {
            if !seen[u as usize] && labels[u as usize] == piece.label {
                seen[u as usize] = true;
                piece.vertices.push(u);
            }
        }
    }
    piece
}

/// Gives every piece of a part but its largest to the neighbour that it touches most; pieces that
/// touch nothing (dirt beside the body) keep the label of what is closest.
pub(super) fn unite(surface: &Surface, labels: &mut [u8]) {
    /// Joining can make two pieces one, so a few rounds settle it.
    const ROUNDS: usize = 3;
    for _ in 0..ROUNDS {
        let pieces = pieces(surface, labels);
        let main = largest(&pieces);
        let mut changed = false;
        for (i, piece) in pieces.iter().enumerate() {
            if main[usize::from(piece.label)] == Some(i) {
                continue;
            }
            if let Some(label) = strongest_neighbour(surface, labels, piece) {
                piece.vertices.iter().for_each(|&v| labels[v as usize] = label);
                changed = true;
            }
        }
        if !changed {
            break;
        }
    }
}

/// Index of the largest piece of every label.
fn largest(pieces: &[Piece]) -> [Option<usize>; LABELS] {
    let mut main: [Option<usize>; LABELS] = [None; LABELS];
    for (i, piece) in pieces.iter().enumerate() {
        let slot = &mut main[usize::from(piece.label)];
        if slot.is_none_or(|best| pieces[best].area < piece.area) {
            *slot = Some(i);
        }
    }
    main
}

fn strongest_neighbour(surface: &Surface, labels: &[u8], piece: &Piece) -> Option<u8> {
    let mut votes = [0usize; LABELS];
    for &v in &piece.vertices {
        for &u in surface.around(v as usize) {
            let label = labels[u as usize];
            if label != piece.label {
                votes[usize::from(label)] += 1;
            }
        }
    }
    let best = (0..LABELS).max_by_key(|&l| (votes[l], LABELS - l))?;
    (votes[best] > 0).then_some(best as u8)
}
