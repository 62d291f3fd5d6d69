//! Coordinates that lay on a coarser grid before use only some values of the sequence's grid. The
//! lattice lists these values for each axis, and positions are coded as ranks in the lists
//! (`spec/05-intra.md`).

use kn_bitstream::range::{BinaryCoder, BitModel, GammaModels, RAW_LIMIT, code_gamma};
use kn_bitstream::rule::{self, Rule};
use kn_mesh::Grid;

/// Largest gap that has models of its own.
const GAPS: usize = 8;

/// For each axis the values that occur, ascending.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Lattice {
    pub(super) values: [Vec<i32>; 3],
}

/// Models of the gaps between values. Each decision says whether a gap is longer than a length; its
/// context is the two gaps before.
struct GapModels {
    longer: [[[BitModel; GAPS]; GAPS + 1]; GAPS + 1],
    escaped: GammaModels,
}

impl GapModels {
    fn new() -> Self {
        let model = BitModel::default();
        let longer = [[[model; GAPS]; GAPS + 1]; GAPS + 1];
        Self { longer, escaped: GammaModels::default() }
    }

    /// Codes a gap ≥ 1 that follows gaps `before` (the nearer first).
    fn code<C: BinaryCoder>(&mut self, coder: &mut C, before: [u32; 2], gap: u32) -> u32 {
        let [near, far] = before.map(|gap| (gap as usize).min(GAPS));
        let models = &mut self.longer[near][far];
        let mut at = 1;
        while at <= GAPS && coder.bit(&mut models[at - 1], gap > at as u32) {
            at += 1;
        }
        if at <= GAPS {
            return at as u32;
        }
        at as u32 + code_gamma(coder, &mut self.escaped, gap.wrapping_sub(at as u32))
    }
}

impl Lattice {
    /// Codes the lists. An encoder brings them; a decoder brings empty ones. None is longer than
    /// `vertices`.
    pub(super) fn code<C: BinaryCoder>(
        &mut self,
        coder: &mut C,
        vertices: u32,
    ) -> Result<(), Rule> {
        let mut models = GapModels::new();
        let mut counts = GammaModels::default();
        for values in &mut self.values {
            let count = code_gamma(coder, &mut counts, values.len() as u32);
            if count == 0 || count > vertices {
                return Err(rule::INTRA_GEOMETRY_LATTICE);
            }
            let least = values.first().map_or(0, |&least| (least + Grid::LIMIT) as u32);
            let high = coder.raw(least >> RAW_LIMIT, 5) << RAW_LIMIT;
            let least = (high | coder.raw(least, RAW_LIMIT)) as i32 - Grid::LIMIT;
            if least.abs() >= Grid::LIMIT {
                return Err(rule::INTRA_GEOMETRY_LATTICE);
            }
            let known = std::mem::replace(values, vec![least]);
            let mut before = [0; 2];
            for rank in 1..count as usize {
                let own = known.get(rank).map_or(0, |&value| value - known[rank - 1]);
                let gap = models.code(coder, before, own as u32);
                let value = i64::from(values[rank - 1]) + i64::from(gap);
                if value >= i64::from(Grid::LIMIT) {
                    return Err(rule::INTRA_GEOMETRY_LATTICE);
                }
                values.push(value as i32);
                before = [gap, before[0]];
            }
        }
        Ok(())
    }

    /// The grid point of a triple of ranks.
    pub(super) fn point(&self, ranks: [i32; 3]) -> Result<[i32; 3], Rule> {
        let mut point = [0; 3];
        for axis in 0..3 {
            let rank = usize::try_from(ranks[axis]).map_err(|_| rule::INTRA_GEOMETRY_LATTICE)?;
            point[axis] = *self.values[axis].get(rank).ok_or(rule::INTRA_GEOMETRY_LATTICE)?;
        }
        Ok(point)
    }
}

#[cfg(feature = "encode")]
impl Lattice {
    /// The lists of `positions`, if it pays to code them.
    pub(super) fn detect(positions: &[[i32; 3]]) -> Option<Self> {
        let mut lattice = Self::default();
        let mut saved = 0.0;
        for axis in 0..3 {
            let values = occurring(positions, axis)?;
            let span = f64::from(values.last()? - values.first()? + 1);
            let spared = libm::log2(span / values.len() as f64);
            saved += positions.len() as f64 * spared - values.len() as f64;
            // A lattice has gaps of two neighbouring sizes; values that are missing because there
            // are few vertices have gaps of any size, and ranks would bend the surface.
            let size = (span / values.len() as f64) as i32;
            let regular =
                values.windows(2).filter(|w| (size..=size + 1).contains(&(w[1] - w[0]))).count();
            if regular * 20 < values.len() * 19 {
                return None;
            }
            lattice.values[axis] = values;
        }
        (saved > 0.0).then_some(lattice)
    }

    /// The ranks of a grid point whose coordinates all occur.
    pub(super) fn ranks(&self, point: [i32; 3]) -> [i32; 3] {
        std::array::from_fn(|axis| {
            self.values[axis].partition_point(|&value| value < point[axis]) as i32
        })
    }
}

/// The values on one axis, ascending; `None` where they are too many for a lattice.
#[cfg(feature = "encode")]
fn occurring(positions: &[[i32; 3]], axis: usize) -> Option<Vec<i32>> {
    let coordinates = || positions.iter().map(move |position| position[axis]);
    let (least, most) = (coordinates().min()?, coordinates().max()?);
    let span = (most - least) as usize + 1;
    if span > 4 * positions.len() {
        return None;
    }
    let mut occurs = vec![false; span];
    coordinates().for_each(|x| occurs[(x - least) as usize] = true);
    Some((least..=most).filter(|x| occurs[(x - least) as usize]).collect())
}

#[cfg(all(test, feature = "encode"))]
mod tests {
    use super::*;
    use kn_bitstream::range::{RangeDecoder, RangeEncoder};

    /// Points whose coordinates went through a grid of `steps` values before a grid of 4096.
    fn points(steps: i32) -> Vec<[i32; 3]> {
        let coarse = |i: i32, k: i32| i.wrapping_mul(k).rem_euclid(steps) * 4095 / (steps - 1);
        (0..20_000).map(|i| [coarse(i, 7919), coarse(i, 6007), coarse(i, 3571)]).collect()
    }

    #[test]
    fn a_coarser_grid_is_found_and_comes_back() {
        let points = points(1771);
        let mut lattice = Lattice::detect(&points).expect("a lattice");
        assert_eq!(lattice.values[0].len(), 1771);
        let mut bytes = Vec::new();
        let mut encoder = RangeEncoder::new(&mut bytes);
        lattice.code(&mut encoder, 20_000).expect("coded");
        encoder.finish();
        assert!(bytes.len() < 1000, "regular gaps cost little: {}", bytes.len());
        let mut read = Lattice::default();
        read.code(&mut RangeDecoder::new(&bytes), 20_000).expect("decoded");
        assert_eq!(read, lattice);
        for &point in &points {
            assert_eq!(read.point(lattice.ranks(point)), Ok(point));
        }
        assert_eq!(read.point([0, -1, 0]), Err(rule::INTRA_GEOMETRY_LATTICE));
        assert_eq!(read.point([1771, 0, 0]), Err(rule::INTRA_GEOMETRY_LATTICE));
    }

    #[test]
    fn a_full_grid_and_values_missing_by_chance_are_none() {
        assert_eq!(Lattice::detect(&points(4096)), None);
        let dropped = |i: i32| i.wrapping_mul(0x9e37_79b9_u32 as i32) >> 28 == 3;
        let few: Vec<_> =
            points(4096).into_iter().filter(|p| p.iter().all(|&x| !dropped(x))).collect();
        assert_eq!(Lattice::detect(&few[..3000]).map(|lattice| lattice.values[0].len()), None);
    }
}
