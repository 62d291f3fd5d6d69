#![doc = include_str!("../README.md")]

mod error;
mod frame;
mod huffman;
mod index;
mod intra;
mod level;
mod motion;
mod nodes;
pub mod params;
pub mod range;
mod reader;
pub mod rule;
mod sequence;
mod symbol;
mod tables;
mod trace;
pub mod unit;
mod writer;

pub use error::{Error, ErrorKind};
pub use frame::{FrameHeader, IntraFrame, MAX_SMOOTHING};
pub use huffman::{CauchyTable, TABLE_COUNT, cauchy_table};
pub use index::{Index, IndexGroup, TAIL_BYTES, index_size};
pub use intra::{IntraHeader, IntraPayload};
pub use level::{COORDINATE_LIMIT, Level};
pub use motion::{MotionContext, MotionFrame, parameter_step, translation_step};
pub use nodes::{AffineNodes, KeyNodes, KeyNodesContext, NodeSites};
pub use reader::{BitReader, HUFFMAN_VALUE_LIMIT, RICE_UNARY_LIMIT, UE_UNARY_LIMIT};
pub use rule::Rule;
pub use sequence::{PROFILE_MAIN, SequenceHeader, VERSION};
pub use symbol::{EntropyMode, Symbol, SymbolCoder, ValueList};
pub use trace::{Element, Name, Trace, Value};
pub use writer::{BitWriter, best_rice};
