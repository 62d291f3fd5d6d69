//! The normative tables, generated from `spec/tables/*.csv`.

pub(crate) mod cauchy;
pub(crate) mod levels;
