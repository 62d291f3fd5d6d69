//! Normative, bit-exact deformation of meshes by node transforms and influence, and smoothing of
//! I-frames.
//!
//! Everything here follows `spec/08-deformation.md` operation by operation: IEEE 754 binary64, no
//! fused multiply-add, sums in the written order. Two decoders that follow it agree in every bit,
//! whatever the processor, the thread count or the language.

mod deform;
mod elementary;
mod influence;
mod parallel;
mod smoothing;
mod transform;
mod weights;

pub use deform::{DeformError, Deformer};
pub use elementary::{exp_neg, sin_cos};
pub use influence::{BindError, BindOptions, Influence, bind};
pub use smoothing::Smoother;
pub use transform::NodeTransform;
