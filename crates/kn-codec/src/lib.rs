//! See the crate README.
pub mod intra;
