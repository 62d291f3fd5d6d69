//! See the crate README.

pub mod range;
