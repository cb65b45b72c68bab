//! The bridge protocol, version 1, through which a small open adapter gives a PC access to the clocked buses SSI and
//! BiSS, to analogue signals and to a serial line (the project's own reference, `protocol/bridge.md`). Integers are
//! little-endian.
//!
//! ```text
//! COBS( seq  op  body…  crc16 ) 00
//! ```

#![warn(missing_docs)]

mod cobs;
mod continuity;
mod data;
mod fields;
mod packet;
mod receiver;
mod reply;
mod request;
#[cfg(test)]
mod vectors;

use std::time::Duration;

pub use cobs::{CobsError, decode as cobs_decode, encode as cobs_encode};
pub use continuity::{Continuity, PacketGap};
pub use data::{AnalogData, BissData, SsiData, StreamData};
pub use fields::BodyError;
pub use packet::{MAX_BODY, Packet, PacketError, crc16};
pub use receiver::Receiver;
pub use reply::{BissStatus, Capabilities, ErrorCode, Hello, Message, Reply};
pub use request::{Operation, Request, SsiFlags};

/// Version of the protocol used by this program.
pub const VERSION: u8 = 1;
/// Time after which an unanswered request is repeated once. The request is given up after the same time again.
pub const REPEAT_AFTER: Duration = Duration::from_millis(200);
