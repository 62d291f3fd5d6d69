//! Prints what a stream holds.
fn main() {}
