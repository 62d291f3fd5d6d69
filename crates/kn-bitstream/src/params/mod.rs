//! The vocabulary of a sequence: every parameter that the header, the encoder's settings and the
//! command line share. Each type exists once, here, with its names (`FromStr`, `Display`) and the
//! documentation that help texts are made of.

mod body;
mod combination;
mod enumerations;
mod file_names;
mod frame_rate;
mod labels;
mod named;
mod weights;

pub use body::{BodyPart, Region};
pub use combination::Combination;
pub use enumerations::{InfluenceMode, TranslationMode, UnitOfLength, UpAxis, WeightScheme};
pub use file_names::{FileNames, FileNamesError, MAX_DIGITS, is_frame_name, name_text};
pub use frame_rate::{FrameRate, FrameRateError};
pub use labels::LabelSet;
pub use named::{NameError, Named};
pub use weights::{Weights, WeightsError};
