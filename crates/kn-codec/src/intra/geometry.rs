//! Coding of positions: every vertex is predicted from the surface around it, and the residual is
//! coded (`spec/05-intra.md`). One function is encoder and decoder.

use super::predict::{FRACTION, Point, Prediction, predict};
use super::residual::ErrorModels;
use super::spread::{Expected, MAGNITUDES, Spread};
use super::surface::Surface;
use super::traversal::Traversal;
use kn_bitstream::range::BinaryCoder;
use kn_bitstream::rule::{self, Rule};
use kn_mesh::Grid;

/// Models and state of one mesh's positions.
pub(super) struct GeometryModels {
    spread: Spread,
    /// By place in the axes' order, and by expected magnitude.
    errors: [Vec<ErrorModels>; 3],
    /// Of vertices without a parallelogram.
    unsupported: ErrorModels,
}

impl Default for GeometryModels {
    fn default() -> Self {
        Self {
            spread: Spread::default(),
            errors: [(); 3].map(|()| vec![ErrorModels::default(); MAGNITUDES]),
            unsupported: ErrorModels::default(),
        }
    }
}

/// Codes the `points` (`#M`) of all vertices of `surface` except dummies. An encoder passes their
/// positions in `points`; a decoder gets them there. Returns the last position.
pub(super) fn code_positions<C: BinaryCoder>(
    coder: &mut C,
    models: &mut GeometryModels,
    surface: &Surface,
    traversal: &mut Traversal,
    points: &mut [Point],
) -> Result<[i32; 3], Rule> {
    let mut last = [0; 3];
    traversal.restart(surface);
    while let Some(vertex) = traversal.next_vertex() {
        let prediction = predict(surface, &traversal.known, points, vertex);
        let own = points[vertex as usize].position;
        let (position, error) = if prediction.support == 0 {
            (models.code_unsupported(coder, &prediction, last, own)?, 0)
        } else {
            let expected = models.spread.expect(&prediction, surface.valence(vertex));
            models.code_supported(coder, &prediction, &expected, own)?
        };
        last = position;
        let mut twin = vertex;
        loop {
            points[twin as usize] = Point { position, error };
            traversal.settle(surface, twin);
            twin = surface.twin[twin as usize];
            if twin == vertex {
                break;
            }
        }
    }
    Ok(last)
}

impl GeometryModels {
    /// Codes a position that no parallelogram predicts: from its known neighbours, or `last`.
    pub(super) fn code_unsupported<C: BinaryCoder>(
        &mut self,
        coder: &mut C,
        prediction: &Prediction,
        last: [i32; 3],
        own: [i32; 3],
    ) -> Result<[i32; 3], Rule> {
        let mut position = [0; 3];
        for k in 0..3 {
            let center = match prediction.neighbours {
                0 => last[k],
                _ => prediction.base[k] + ((prediction.offset[k] + 32) >> FRACTION) as i32,
            };
            position[k] = code_coordinate(coder, &mut self.unsupported, center, own[k], 1)?;
        }
        Ok(position)
    }

    /// Codes a position axis by axis; returns it and the length of its error along the normal.
    #[inline]
    fn code_supported<C: BinaryCoder>(
        &mut self,
        coder: &mut C,
        prediction: &Prediction,
        expected: &Expected,
        own: [i32; 3],
    ) -> Result<([i32; 3], i32), Rule> {
        let mut position = [0; 3];
        let mut error = [0; 3];
        for place in 0..3 {
            let axis = expected.axes[place];
            let (mean, magnitude) = expected.conditional(place, error);
            let exact = prediction.offset[axis] + mean;
            let near = (exact + 32) >> FRACTION;
            // What rounding left, −32 ..= 31, in thirds.
            let lean = (((exact - (near << FRACTION) + 32) * 3) >> FRACTION) as usize;
            let center = prediction.base[axis] + near as i32;
            let models = &mut self.errors[place][magnitude];
            position[axis] = code_coordinate(coder, models, center, own[axis], lean)?;
            let step = i64::from(position[axis]) - i64::from(prediction.base[axis]);
            error[axis] = (step << FRACTION) - prediction.offset[axis];
        }
        Ok((position, self.spread.observe(expected, error)))
    }
}

/// Codes coordinate `own` as the distance from its prediction.
#[inline]
fn code_coordinate<C: BinaryCoder>(
    coder: &mut C,
    models: &mut ErrorModels,
    expected: i32,
    own: i32,
    lean: usize,
) -> Result<i32, Rule> {
    let expected = expected.clamp(-Grid::LIMIT, Grid::LIMIT);
    let coordinate = expected + models.code(coder, own - expected, lean);
    if coordinate.abs() < Grid::LIMIT { Ok(coordinate) } else { Err(rule::INTRA_GEOMETRY_RANGE) }
}
