//! Procedures for BiSS C encoders, over the configuration pin (UBICOM) or over an adapter on the bus. They use a
//! [`Master`], which sends requests, repeats them where this is safe, and observes the time limits. "Manual" refers to
//! POSITAL's manual for the IXARC kit encoders.
//!
//! ```text
//! read, write, position ── master: repetitions ──┬─▶ master/ubicom: one exchange over the configuration pin
//!                                                └─▶ master/bus: one over an adapter (buses/bridge)
//! ```

pub mod check;
mod error;
mod flags;
mod frames;
mod identify;
mod master;
mod memory;
mod position;
pub mod procedure;
mod registers;
mod station;
mod survey;
mod widths;
pub mod write;

pub use crate::link::line::Echo;
pub use error::{Error, ReplyDamage, RequestedItem};
pub use flags::read_position;
pub use frames::{ConsecutiveFrames, Frame, FrameReadError, parse_frames};
pub use identify::{DataSheet, DataSheetBank, FrameSource, Identity, identify};
pub use master::Master;
pub use memory::{
    ReadStep, UnsavedValues, create_profile, ensure_standstill, read_area, read_area_at_standstill, read_registers,
    save,
};
pub use position::{PolledSample, PositionReading, WatchedReading, read_sample, read_watched_value};
pub use registers::Registers;
pub use station::{BusParameters, FrameParameters, LineParameters, ORDERS, PinParameters, Station, Supply, Transport};
pub use survey::{EncoderStatus, FlagRegister, Survey, read_all_registers, read_status};
