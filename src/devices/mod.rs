//! The devices: one folder each, with all of its code.

pub mod biss;
pub mod hiperdrive;
pub mod hiperface;
pub mod interbus;
pub mod ssi;
