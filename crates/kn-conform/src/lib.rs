#![doc = include_str!("../README.md")]

mod assemble;
mod bits;
mod corpus;
mod coverage;
mod environment;
mod huffman;
mod interpret;
mod labels;
mod oracle;
mod parse;
mod product;
mod second;
mod spec;
mod syntax;
pub mod tables;
mod value;

pub use corpus::{
    CorpusError, Description, FOLDERS, Outcome, Report, Stream, Verdict, judge, load_corpus,
    run_foreign, run_ours,
};
pub use coverage::{Covered, coverage, coverage_page};
pub use interpret::{GroupPayloads, NodeLabels};
pub use labels::node_labels;
pub use product::{example_trace, example_written, stream_trace};
pub use spec::{Example, Expected, Rule, Spec, SpecError, no_labels};
pub use syntax::{Syntax, SyntaxError};
pub use value::{Failure, TraceLine, Value};
