//! Code that the measuring programs share with the benches.

pub mod ring;
