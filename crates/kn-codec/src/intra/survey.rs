//! The encoder's side of the conquest: finds the symbols of a known mesh.

use super::conquest::{Conquest, NONE, Symbol, next, prev};
use super::topology::ClosedMesh;

/// Follows the conquest on the encoder's own mesh.
pub(super) struct Survey<'a> {
    mesh: &'a ClosedMesh,
    /// `3#T` own half-edge of each of the conquest's.
    own: Vec<u32>,
    /// `3#T` the conquest's half-edge of each own one; [`NONE`] where not conquered.
    conquered: Vec<u32>,
    /// `#M` own vertex of each of the conquest's.
    pub(super) vertices: Vec<u32>,
    /// `#M` whether each own vertex has been met.
    met: Vec<bool>,
    /// `#M` triangles of each own vertex.
    valence: Vec<u32>,
}

impl<'a> Survey<'a> {
    pub(super) fn new(mesh: &'a ClosedMesh) -> Self {
        let mut valence = vec![0; mesh.source.len()];
        for &vertex in &mesh.origin {
            valence[vertex as usize] += 1;
        }
        Self {
            mesh,
            own: Vec::with_capacity(mesh.origin.len()),
            conquered: vec![NONE; mesh.origin.len()],
            vertices: Vec::with_capacity(mesh.source.len()),
            met: vec![false; mesh.source.len()],
            valence,
        }
    }

    /// Whether the triangle of own half-edge `h` is conquered.
    pub(super) fn is_conquered(&self, h: u32) -> bool {
        self.conquered[h as usize] != NONE
    }

    /// Notes that the conquest's next triangle is the one of own half-edge `first`, from there on.
    pub(super) fn record(&mut self, first: u32) {
        for h in [first, next(first), prev(first)] {
            self.conquered[h as usize] = self.own.len() as u32;
            self.own.push(h);
            let vertex = self.mesh.origin[h as usize];
            if !std::mem::replace(&mut self.met[vertex as usize], true) {
                self.vertices.push(vertex);
            }
        }
    }

    /// Valences of the corners of the own triangle that starts with half-edge `first`.
    pub(super) fn valences(&self, first: u32) -> [u32; 3] {
        [first, first + 1, first + 2].map(|h| self.valence[self.mesh.origin[h as usize] as usize])
    }

    /// Own half-edge b → a of the triangle behind the gate.
    pub(super) fn behind(&self, gate: u32) -> u32 {
        self.mesh.mate[self.own[gate as usize] as usize]
    }

    /// The symbol of the triangle behind the gate.
    pub(super) fn symbol(&self, conquest: &Conquest, gate: u32) -> Symbol {
        let base = self.behind(gate);
        let (to_tip, from_tip) = (next(base), prev(base));
        let left = self.is_conquered(self.mesh.mate[to_tip as usize]);
        let right = self.is_conquered(self.mesh.mate[from_tip as usize]);
        let tip = self.mesh.origin[from_tip as usize];
        match (left, right) {
            (true, true) => Symbol::Close,
            (true, false) => Symbol::Left,
            (false, true) => Symbol::Right,
            (false, false) if self.met[tip as usize] => self.jump(conquest, gate, to_tip),
            (false, false) => {
                Symbol::New { dummy: self.mesh.is_dummy(tip), valence: self.valence[tip as usize] }
            }
        }
    }

    /// The symbol for the open half-edge that leaves the tip: its distance along the loop, or,
    /// where it lies on another loop or too far, its number.
    fn jump(&self, conquest: &Conquest, gate: u32, to_tip: u32) -> Symbol {
        let edge = self.target(to_tip);
        match distance(conquest, gate, edge) {
            Some(steps) => Symbol::Split { steps },
            None => Symbol::Merge { edge },
        }
    }

    /// Turns around the end of own half-edge `to_tip` through unknown triangles, to the open
    /// half-edge that leaves it. (A vertex that several loops touch has one for each of them.)
    fn target(&self, to_tip: u32) -> u32 {
        let mut arriving = to_tip;
        loop {
            arriving = prev(self.mesh.mate[arriving as usize]);
            let leaving = self.mesh.mate[arriving as usize];
            if self.is_conquered(leaving) {
                return self.conquered[leaving as usize];
            }
        }
    }
}

/// Steps along the loop from the gate to `target`, the shorter way round.
fn distance(conquest: &Conquest, gate: u32, target: u32) -> Option<i32> {
    let limit = conquest.walk_left().min(i32::MAX as u64) as i32;
    let (mut ahead, mut back) = (gate, gate);
    for steps in 1..=limit {
        ahead = conquest.after(ahead);
        back = conquest.before(back);
        if ahead == target {
            return Some(steps);
        }
        if back == target {
            return Some(-steps);
        }
        if ahead == gate {
            break;
        }
    }
    None
}
