//! UBICOM, the serial protocol on the configuration pin of POSITAL kit encoders. The manual is chapter 5 of *IXARC kit
//! encoders with BiSS C* v4.6, and "reference" refers to the project's reference. Anything that the manual leaves open
//! is marked `U`.
//!
//! ```text
//! 80 ADDRESS COMMAND LEN-low LEN-high payload… CHK        CHK = NOT(sum of all bytes before it)
//! ```

#![warn(missing_docs)]

mod frame;
mod message;
mod position;
mod receiver;

use std::time::Duration;

pub use frame::{Frame, FrameError, MAX_PAYLOAD, NODE, SYNC};
pub use message::{Command, Reply, ReplyError, Request, RequestError, WriteReply, byte_order_from_reply};
pub use position::PositionWord;
pub use receiver::Receiver;

use crate::units::{Baud, CharacterFormat, Parity};

const BAUD: Baud = Baud::B115200;

/// Character format of the line: 115200 8N1.
pub const FORMAT: CharacterFormat = CharacterFormat { baud: BAUD, parity: Parity::None };
/// Returns the number of bits in a character: the start bit, eight data bits, the parity bit if enabled, and the stop
/// bit.
pub const fn character_bits(format: CharacterFormat) -> u64 {
    match format.parity {
        Parity::None => 10,
        Parity::Even | Parity::Odd => 11,
    }
}

/// Time-out for a reply. The manual does not specify it (`U`).
pub const REPLY_TIME_OUT: Duration = Duration::from_millis(100);
/// Duration of silence after which an incomplete frame is abandoned. The manual does not specify it (`U`).
pub const BYTE_TIME_OUT: Duration = Duration::from_millis(20);
