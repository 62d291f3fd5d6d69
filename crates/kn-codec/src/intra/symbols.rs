//! Models of the conquest's symbols: the decisions of each symbol, and their contexts
//! (`spec/05-intra.md`).

use super::conquest::{Conquest, Symbol};
use kn_bitstream::range::{BinaryCoder, BitModel, GammaModels, RAW_LIMIT, code_gamma};

/// Valences from 1 to this minus 1 have models of their own; larger ones are escaped.
const ESCAPED_VALENCE: u32 = 16;
/// Contexts of a valence: the sum of the valences of a and b, from 8 to 16.
const VALENCE_CONTEXTS: usize = 9;

/// Adaptive models of all decisions of the conquest.
#[derive(Clone, Debug)]
pub(super) struct SymbolModels {
    is_new: [[BitModel; 4]; 4],
    is_dummy: BitModel,
    is_close: [BitModel; 2],
    is_jump: BitModel,
    is_right: BitModel,
    is_merge: BitModel,
    is_backward: BitModel,
    split_steps: GammaModels,
    valence: [ValenceModels; VALENCE_CONTEXTS],
    dummy_valence: GammaModels,
}

impl Default for SymbolModels {
    fn default() -> Self {
        let model = BitModel::default();
        Self {
            is_new: [[model; 4]; 4],
            is_dummy: model,
            is_close: [model; 2],
            is_jump: model,
            is_right: model,
            is_merge: model,
            is_backward: model,
            split_steps: GammaModels::default(),
            valence: [ValenceModels::default(); VALENCE_CONTEXTS],
            dummy_valence: GammaModels::default(),
        }
    }
}

impl SymbolModels {
    /// Codes the symbol of the triangle behind the gate. What the valences force is not coded.
    pub(super) fn code<C: BinaryCoder>(
        &mut self,
        coder: &mut C,
        conquest: &Conquest,
        gate: u32,
        symbol: Symbol,
    ) -> Symbol {
        let at_a = conquest.lacking(conquest.start(gate));
        let at_b = conquest.lacking(conquest.end(gate));
        if at_a == 1 || at_b == 1 {
            return self.code_closing(coder, conquest, gate, symbol);
        }
        let class = |lacking: u32| lacking.saturating_sub(2).min(3) as usize;
        let new = matches!(symbol, Symbol::New { .. });
        if coder.bit(&mut self.is_new[class(at_b)][class(at_a)], new) {
            return self.code_new(coder, conquest, gate, symbol);
        }
        let jump = matches!(symbol, Symbol::Split { .. } | Symbol::Merge { .. });
        if coder.bit(&mut self.is_jump, jump) {
            return self.code_jump(coder, symbol);
        }
        if coder.bit(&mut self.is_close[1], symbol == Symbol::Close) {
            return Symbol::Close;
        }
        let right = coder.bit(&mut self.is_right, symbol == Symbol::Right);
        if right { Symbol::Right } else { Symbol::Left }
    }

    /// The triangle is the last at a, or at b: it closes that vertex, and perhaps the whole loop.
    fn code_closing<C: BinaryCoder>(
        &mut self,
        coder: &mut C,
        conquest: &Conquest,
        gate: u32,
        symbol: Symbol,
    ) -> Symbol {
        let [last_at_a, last_at_b, last_at_tip] =
            [conquest.start(gate), conquest.end(gate), conquest.end(conquest.after(gate))]
                .map(|vertex| conquest.lacking(vertex) == 1);
        if conquest.is_short(gate) {
            let closed = u8::from(last_at_a) + u8::from(last_at_b) + u8::from(last_at_tip);
            if closed >= 2 || coder.bit(&mut self.is_close[0], symbol == Symbol::Close) {
                return Symbol::Close;
            }
        }
        if last_at_b { Symbol::Right } else { Symbol::Left }
    }

    fn code_new<C: BinaryCoder>(
        &mut self,
        coder: &mut C,
        conquest: &Conquest,
        gate: u32,
        symbol: Symbol,
    ) -> Symbol {
        let (dummy, valence) = match symbol {
            Symbol::New { dummy, valence } => (dummy, valence),
            _ => (false, 0),
        };
        let [a, b] = [conquest.start(gate), conquest.end(gate)]
            .map(|vertex| conquest.vertices[vertex as usize]);
        // Holes do not touch: two dummies are never neighbours.
        let may_be_dummy = !a.dummy && !b.dummy;
        if may_be_dummy && coder.bit(&mut self.is_dummy, dummy) {
            let valence = code_gamma(coder, &mut self.dummy_valence, valence);
            return Symbol::New { dummy: true, valence };
        }
        let sum = a.valence.saturating_add(b.valence);
        let context = sum.clamp(8, 16) as usize - 8;
        Symbol::New { dummy: false, valence: self.valence[context].code(coder, valence) }
    }

    /// Codes the valence of a seed's corner.
    pub(super) fn code_seed<C: BinaryCoder>(&mut self, coder: &mut C, valence: u32) -> u32 {
        self.valence[4].code(coder, valence)
    }

    fn code_jump<C: BinaryCoder>(&mut self, coder: &mut C, symbol: Symbol) -> Symbol {
        let (merge, edge, steps) = match symbol {
            Symbol::Merge { edge } => (true, edge, 0),
            Symbol::Split { steps } => (false, 0, steps),
            _ => (false, 0, 0),
        };
        if coder.bit(&mut self.is_merge, merge) {
            let high = coder.raw(edge >> RAW_LIMIT, RAW_LIMIT);
            return Symbol::Merge { edge: high << RAW_LIMIT | coder.raw(edge, RAW_LIMIT) };
        }
        let length = code_gamma(coder, &mut self.split_steps, steps.unsigned_abs()) as i32;
        let backward = coder.bit(&mut self.is_backward, steps < 0);
        Symbol::Split { steps: if backward { -length } else { length } }
    }
}

/// Models of a valence: whether it is 6, whether it is less, and its distance from 6.
#[derive(Clone, Copy, Debug)]
struct ValenceModels {
    is_six: BitModel,
    is_less: BitModel,
    less_than: [BitModel; 6],
    more_than: [BitModel; ESCAPED_VALENCE as usize],
    escaped: GammaModels,
}

impl Default for ValenceModels {
    fn default() -> Self {
        let model = BitModel::default();
        Self {
            is_six: model,
            is_less: model,
            less_than: [model; 6],
            more_than: [model; ESCAPED_VALENCE as usize],
            escaped: GammaModels::default(),
        }
    }
}

impl ValenceModels {
    fn code<C: BinaryCoder>(&mut self, coder: &mut C, valence: u32) -> u32 {
        if coder.bit(&mut self.is_six, valence == 6) {
            return 6;
        }
        if coder.bit(&mut self.is_less, valence < 6) {
            let mut at = 5;
            while at > 1 && coder.bit(&mut self.less_than[at as usize], valence < at) {
                at -= 1;
            }
            return at;
        }
        let mut at = 7;
        while at < ESCAPED_VALENCE && coder.bit(&mut self.more_than[at as usize], valence > at) {
            at += 1;
        }
        if at < ESCAPED_VALENCE {
            return at;
        }
        at + code_gamma(coder, &mut self.escaped, valence.wrapping_sub(at))
    }
}
