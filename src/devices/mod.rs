//! The devices: one folder each, with everything that the program knows about it.

pub mod biss;
pub mod hiperdrive;
pub mod hiperface;
pub mod interbus;
pub mod ssi;
