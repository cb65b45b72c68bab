//! Words of an SSI encoder behind an adapter with the bridge protocol. The encoder has no memory and no commands: there
//! is nothing to identify or write, and no waiting time. The layout (`protocol/ssi`) gives the words their meaning;
//! here they are only read, individually or as a stream.

pub mod check;
mod error;
mod master;
mod station;
mod words;

pub use error::Error;
pub use master::Master;
pub use station::{ClockSettings, Identity, LinkParameters, Station, Supply};
pub use words::Words;
