#![doc = include_str!("../README.md")]

mod assemble;
mod bits;
mod environment;
mod huffman;
mod interpret;
mod parse;
mod product;
mod second;
mod spec;
mod syntax;
pub mod tables;
mod value;

pub use interpret::{CountAffine, GroupPayloads};
pub use product::{example_trace, example_written, stream_trace};
pub use spec::{Example, Expected, Rule, Spec, SpecError, no_labels};
pub use syntax::{Syntax, SyntaxError};
pub use value::{Failure, TraceLine, Value};
