//! HIPERFACE: the memory of an encoder beside what the user has made of it.

mod staged;

pub use staged::{Staged, StagedError};
