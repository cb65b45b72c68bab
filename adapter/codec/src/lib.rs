//! The bridge protocol, version 1. It connects a PC to a small open adapter for the clocked buses SSI and BiSS,
//! analogue signals and a serial line. Integers are little-endian. See `protocol/bridge.md` in the project's reference.
//! The host and the adapter share this crate, which needs an allocator but no operating system.
//!
//! ```text
//! COBS( seq  op  body…  crc16 ) 00
//! ```

#![no_std]
#![forbid(unsafe_code)]
#![warn(missing_docs)]

extern crate alloc;
#[cfg(test)]
extern crate std;

mod cobs;
mod codes;
mod continuity;
mod data;
mod fields;
mod packet;
mod receiver;
mod reply;
mod request;
#[cfg(test)]
mod vectors;

use core::time::Duration;

pub use cobs::{CobsError, decode as cobs_decode, encode as cobs_encode};
pub use codes::{BissStatus, Capabilities, ErrorCode, RestartReason, SupplyFaults};
pub use continuity::{Continuity, PacketGap};
pub use data::{AnalogData, BissData, SsiData, StreamData};
pub use fields::BodyError;
pub use packet::{MAX_BODY, Packet, PacketError, crc16};
pub use receiver::Receiver;
pub use reply::{AdapterStatus, Hello, Message, Reply};
pub use request::{Operation, Request, SsiFlags};

/// Version of the protocol that this program supports.
pub const VERSION: u8 = 1;
/// Time without a reply after which a request is sent a second time. If there is again no reply for this time, the
/// request has failed.
pub const REQUEST_RETRY_TIMEOUT: Duration = Duration::from_millis(200);
