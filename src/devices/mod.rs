//! The devices. Each one has a folder that contains all of its code.

pub mod biss;
pub mod hiperdrive;
pub mod hiperface;
pub mod interbus;
pub mod ssi;
