//! SSI: the frame of an encoder as it is designed.

pub mod strip;
