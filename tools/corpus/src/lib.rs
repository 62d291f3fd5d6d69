//! Pages and tables that are generated from the specification; tests compare them with the files of
//! the checkout.

pub mod coverage;
pub mod examples;
pub mod rust_tables;
