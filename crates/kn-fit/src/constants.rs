//! The numbers of the solver, in one place. Each is free of units: lengths are relative to a
//! diagonal, an edge or the spacing of the nodes. Where nothing else is said they were set by the
//! measurements of `docs/notes/fit.md`. What a caller decides is in [`crate::FitOptions`] and in
//! the options of the generator; the encoder decides by numbers of its own.

/// Sampling of surfaces.
pub(crate) mod sampling {
    /// Points sampled on either mesh for all passes but the last.
    pub(crate) const SAMPLES: usize = 3000;
    /// A surface crosses about this many cells of side h per h² of its area.
    pub(crate) const CELLS_PER_AREA: f64 = 1.5;
    /// The middle of the surface is where it is nearest to its centroid; it goes this many times as
    /// far, so that belly and back both belong to it.
    pub(crate) const MIDDLE: f64 = 1.5;
    /// Grid steps along the source's longest side; influence is bound on this grid.
    pub(crate) const GRID: f64 = 2047.0;
}

/// Starts of a fit (`parts.rs`, `fitter.rs`).
pub(crate) mod starts {
    /// A part is aligned when it has this share of the area on both meshes.
    pub(crate) const LEAST_AREA: f64 = 0.01;
    /// A part has an axis to turn when its longest moment is this many times the next.
    pub(crate) const ELONGATED: f64 = 2.0;
    /// Rotations beyond this cosine are taken for a wrong axis.
    pub(crate) const LEAST_COSINE: f64 = 0.5;
    /// The residual of aligned parts, relative to that of the other starts.
    pub(crate) const CLEARLY: f64 = 0.75;
}

/// Partners of points, and their weights (`coarse.rs`, `matching.rs`, `fitter.rs`).
pub(crate) mod matches {
    /// Opposite normals count as far apart as this many node spacings times two.
    pub(crate) const NORMAL_SCALE: f64 = 1.5;
    /// Weight of a difference in reach in the first matches: it brings a limb that swings to
    /// where it goes. Poses change it a little, so it soon fades.
    pub(crate) const REACH_WEIGHT: f64 = 0.5;
    /// The weight in a step is this share of that in the last.
    pub(crate) const REACH_FADES: f64 = 0.5;
    /// The cosine between the normals of a pair below which it does not count.
    pub(crate) const LEAST_COSINE: f64 = 0.2;
    /// The robust width is this many times the 95th percentile of the distances ...
    pub(crate) const WIDTH: f64 = 2.0;
    /// ... but at least this many node spacings: what is nearer must not be given up, since the
    /// farthest part of a limb is what says where the limb goes.
    pub(crate) const LEAST_WIDTH: f64 = 1.0;
}

/// The schedule of a fit, from stiff and coarse to relaxed and exact (`schedule.rs`).
pub(crate) mod steps {
    /// α_reg of the first steps: the source moves almost like one body.
    pub(crate) const STIFF: f64 = 3.0;
    /// α_reg shrinks to this share when a step gains little.
    pub(crate) const RELAXATION: f64 = 0.4;
    /// A step gains little when the residual stays above this share of the last one.
    pub(crate) const STALL: f64 = 0.8;
    /// ... or when the surface moves by less than this share of an edge.
    pub(crate) const STILL: f64 = 0.05;
    /// Steps before matches are looked for on the surface.
    pub(crate) const COARSE_STEPS: usize = 6;
    /// Steps of a continued fit.
    pub(crate) const CONTINUING_STEPS: usize = 3;
    /// α_reg does not fall below this while matches are coarse: they err by the distance of
    /// samples.
    pub(crate) const COARSE_LEAST: f64 = 0.3;
    /// Steps with every vertex.
    pub(crate) const FULL_STEPS: usize = 2;
}

/// Minimisation of the energy (`energy.rs`, `fitter.rs`, `cholesky.rs`).
pub(crate) mod minimisation {
    /// Pairs of steps and gradient changes that L-BFGS keeps.
    pub(crate) const MEMORY: usize = 6;
    /// A minimisation ends when an iteration lowers the energy by less than this share.
    pub(crate) const TOLERANCE: f64 = 1e-4;
    /// No axis of a node shrinks below this factor.
    pub(crate) const LEAST_SCALE: f64 = 0.05;
    /// Bound on the evaluations of a minimisation, per iteration; one or two is usual.
    pub(crate) const EVALUATIONS_PER_ITERATION: usize = 8;
    /// The addition to the diagonal of the preconditioner, relative to its entries: directions
    /// that neither data nor smoothness see stay where they are.
    pub(crate) const DAMPING: f64 = 1e-6;
    /// Iterations of L-BFGS in one correspondence step.
    pub(crate) const ITERATIONS: u64 = 8;
    /// The first steps move so far that each needs variables of its own ...
    pub(crate) const FIRST_FACTORS: usize = 2;
    /// ... later ones share them until α_reg has shrunk to this share.
    pub(crate) const REFACTOR: f64 = 0.2;
    /// Smallest pivot relative to the entry that it started as: what rounding left below it is
    /// noise.
    pub(crate) const PIVOT: f64 = 1e-12;
}

/// Limits of the work of measuring (`measures.rs`).
pub(crate) mod measures {
    /// More far points than this are one region without a closer look, which is quadratic.
    pub(crate) const MANY: usize = 4000;
}

/// Placement of key nodes by farthest points (`place.rs`).
pub(crate) mod placement {
    /// A loose piece gets a node of its own when its area is at least this share of the area that
    /// one node has on average. Smaller ones follow the nodes nearest to them.
    pub(crate) const OWN_NODE: f64 = 0.5;
    /// Affine nodes stand this many times as close: parts that need them, such as a loose shirt,
    /// are where most of the error is.
    pub(crate) const AFFINE_DENSITY: f64 = 1.5;
}

/// Constants of the key-node generator (`generate.rs`); its rounds and shares are compared in the
/// note.
pub(crate) mod generator {
    /// The dense set has this many nodes for each one that is wanted.
    pub(crate) const DENSITY: f64 = 1.15;
    /// One round removes at most this share of the nodes.
    pub(crate) const REMOVED_SHARE: f64 = 0.3;
    /// The number by cost is found when less than this share goes in a round.
    pub(crate) const FEW: f64 = 0.05;
    /// Two nodes with more than this weight on one vertex are never removed together (the paper's).
    pub(crate) const CONTROL: f64 = 0.01;
    /// A change of a vertex costs at least this many times the mean squared error, so that where
    /// nothing moves in the key frame the nodes stay evenly spread.
    pub(crate) const PRIOR: f64 = 2.0;
    /// Rounds after the number is reached, in which the nodes that matter least move to where the
    /// error is highest.
    pub(crate) const MOVING_ROUNDS: usize = 3;
    /// The share of the nodes that move in such a round.
    pub(crate) const MOVED_SHARE: f64 = 0.1;
    /// Inserted nodes keep this share of the node spacing from all others.
    pub(crate) const DISTANCE: f64 = 0.5;
    /// Distances are averaged so many times over the vertices around each.
    pub(crate) const SMOOTHING: usize = 8;
    /// Bound on all rounds.
    pub(crate) const MAX_ROUNDS: usize = 8;
}
