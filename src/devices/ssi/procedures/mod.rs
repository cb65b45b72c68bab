//! Reads words from an SSI encoder behind an adapter with the bridge protocol, one by one or as a stream. The encoder
//! has no memory and no commands. The layout (`protocol/ssi`) defines the meaning of the words.

pub mod check;
mod error;
mod master;
mod station;
mod words;

pub use error::Error;
pub use master::Master;
pub use station::{ClockSettings, Identity, LinkParameters, Station, Supply};
pub use words::Words;
