//! Words of an SSI encoder behind an adapter of the bridge protocol. The encoder has no memory and no commands: there is
//! nothing to identify, nothing to write, and no time in which it has to be let alone. What a word says is its layout's
//! business (`protocol/ssi`); here words are only taken, one by one or as a stream.

pub mod check;
mod error;
mod master;
mod station;
mod words;

pub use error::Error;
pub use master::Master;
pub use station::{Asking, Identity, LinkParameters, Station, Supply};
pub use words::Words;
