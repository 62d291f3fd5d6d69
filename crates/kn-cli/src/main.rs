//! The `kn` command.
fn main() {}
