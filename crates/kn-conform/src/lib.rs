#![doc = include_str!("../README.md")]

mod assemble;
mod bits;
mod bounds;
mod corpus;
mod environment;
mod expression;
mod foreign;
mod huffman;
mod interpret;
mod labels;
mod oracle;
mod parse;
mod product;
mod ranges;
mod second;
mod spec;
mod stream;
mod syntax;
pub mod tables;
mod value;

pub use bounds::Probe;
pub use corpus::{
    CorpusError, Description, FOLDERS, Outcome, Report, Stream, Verdict, judge, load_corpus,
    run_ours, run_ours_on,
};
pub use foreign::run_foreign;
pub use interpret::NodeLabels;
pub use labels::node_labels;
pub use oracle::Literal;
pub use product::{example_trace, example_written, stream_trace};
pub use spec::{Clause, Example, Expected, Spec, SpecError, no_labels};
pub use stream::{Finding, StreamReport};
pub use syntax::{Syntax, SyntaxError};
pub use value::{Failure, TraceLine, Value};
