//! Rules of `spec/05-intra.md` that a payload can break.

/// The id of a clause of the specification.
pub(super) type Rule = &'static str;

pub(super) const HEADER: Rule = "intra.header";
pub(super) const ATTRIBUTES: Rule = "intra.header.attributes";
pub(super) const DENSITY: Rule = "intra.counts.density";
pub(super) const VERTEX_COUNT: Rule = "intra.vertices.count";
pub(super) const FACE_COUNT: Rule = "intra.faces.count";
pub(super) const RAW_FACE: Rule = "intra.faces.raw";
pub(super) const SECTIONS: Rule = "intra.sections.size";
pub(super) const CONSUMED: Rule = "intra.sections.consumed";
pub(super) const CLOSE: Rule = "intra.connectivity.close";
pub(super) const SPLIT_WALK: Rule = "intra.connectivity.split";
pub(super) const MERGE_EDGE: Rule = "intra.connectivity.merge";
pub(super) const DEGENERATE: Rule = "intra.connectivity.tip";
pub(super) const VALENCE: Rule = "intra.connectivity.valence";
pub(super) const JOIN: Rule = "intra.join.order";
pub(super) const POSITION: Rule = "intra.geometry.range";
pub(super) const LATTICE: Rule = "intra.geometry.lattice";
