//! The hardware-independent part of the adapter. It replies to a host's requests, runs BiSS control frames and packs
//! stream samples. Clocks, pins and time are behind the [`Bus`] trait. The firmware implements it for the RP2040, and
//! the tests implement it with a model.

#![no_std]
#![forbid(unsafe_code)]
#![warn(missing_docs)]

extern crate alloc;

mod adapter;
mod analog;
mod biss;
mod bus;
mod control;
mod line;
mod outbox;
mod ssi;
mod stream;
mod supply;
mod uart;

pub use adapter::{Adapter, Identity};
pub use analog::{AnalogSetting, Correction};
pub use biss::BissSetting;
pub use bus::{Bus, Clocking, Frame};
pub use control::{ControlError, RegisterAccess, access_register};
pub use line::{FrameWords, MAX_WORDS};
pub use outbox::Outbox;
pub use ssi::SsiSetting;
pub use stream::ClockedStream;
pub use uart::UartSetting;

/// Error code and message for a rejected request.
pub(crate) type Refusal = (bridge_codec::ErrorCode, &'static str);
