//! The bridge protocol, version 1. It connects a PC to a small open adapter for the clocked buses SSI and BiSS,
//! analogue signals and a serial line. Integers are little-endian. See the project's reference `protocol/bridge.md`.
//! Host and adapter share this crate, which needs an allocator and no operating system.
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

/// Version of the protocol that this program uses.
pub const VERSION: u8 = 1;
/// Time without a reply after which a request is repeated once. If there is still no reply after the same time again,
/// the request has failed.
pub const REPEAT_AFTER: Duration = Duration::from_millis(200);
