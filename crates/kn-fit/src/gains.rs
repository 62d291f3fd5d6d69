//! The gain of scale and shear at each node.

use crate::error::FitError;
use crate::fitter::Fitter;
use crate::group::influence_of;
use crate::options::FitOptions;
use crate::source::FitSource;
use crate::surface::vertex_areas;
use crate::target::FitTarget;
use kn_bitstream::params::Combination;
use kn_mesh::vec3::Vec3;

/// Squared distances of a fit with rigid nodes, and by how much they fall with affine ones.
#[derive(Clone, Debug, PartialEq)]
pub struct AffineGains {
    /// Mean squared distance of the rigid fit, relative to the squared diagonal of the target's
    /// box.
    pub rigid: f64,
    /// `#N`, each node's share of the fall, by its weight on the vertices; negative where the
    /// surface ends farther away.
    pub nodes: Vec<f64>,
}

/// Fits `source`, all of whose nodes are affine, once with all components and once with rotation
/// and translation alone, with the same matches.
///
/// # Errors
/// The errors of [`Fitter::new`].
pub fn affine_gains(
    source: &FitSource,
    target: &FitTarget,
    options: &FitOptions,
) -> Result<AffineGains, FitError> {
    let mut fitter = Fitter::new(source)?;
    let candidates = [Combination::RT, options.combination];
    let fits = fitter.fit_combinations(source, target, options, &candidates)?;
    let areas = vertex_areas(source.positions, source.faces);
    let unit = areas.iter().sum::<f64>() * target.diagonal * target.diagonal;
    let [rigid, affine] = [0, 1].map(|fit: usize| {
        let deformed: &[Vec3] = fitter.deform(source, &fits[fit].transforms);
        let closest = target.tree.closest_all(deformed);
        closest.iter().map(|closest| closest.distance_squared).collect::<Vec<_>>()
    });
    let mut gains = AffineGains { rigid: 0.0, nodes: vec![0.0; source.nodes.len()] };
    for (vertex, area) in areas.iter().enumerate() {
        gains.rigid += area * rigid[vertex] / unit;
        let (nodes, weights) = influence_of(source, vertex as u32);
        for (&node, &weight) in nodes.iter().zip(weights) {
            let fall = weight * area * (rigid[vertex] - affine[vertex]) / unit;
            gains.nodes[usize::from(node)] += fall;
        }
    }
    Ok(gains)
}
