//! What one does with a BiSS C encoder, over its configuration pin (UBICOM) or over an adapter on the bus. Each procedure
//! takes a [`Master`], which asks, repeats what may be repeated and keeps the times; the manual is POSITAL's for the IXARC
//! kit encoders.
//!
//! ```text
//! read, write, position ── master: what is asked again ──┬─▶ master/ubicom: one exchange over the configuration pin
//!                                                        └─▶ master/bus: one over an adapter (device/bridge)
//! ```

mod error;
mod master;
mod position;
mod station;

pub use super::line::Echo;
pub use error::{Asked, Damage, Error};
pub use master::Master;
pub use position::PositionReading;
pub use station::{PARAMETERS, Station, Supply, Way};
