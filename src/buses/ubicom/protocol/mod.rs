//! UBICOM: the serial protocol on the configuration pin of POSITAL kit encoders (manual IXARC kit encoders with BiSS C
//! v4.6, chapter 5; the project's reference where a section is named so). What the manual leaves open is marked `U`.
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
pub use message::{Command, Reply, ReplyError, Request, RequestError, Written, order_told_by};
pub use position::PositionWord;
pub use receiver::Receiver;

use crate::units::{Baud, CharacterFormat, Parity};

/// 115200 bit/s.
const BAUD: Baud = Baud::B115200;

/// The format of the line: 115200 8N1.
pub const FORMAT: CharacterFormat = CharacterFormat { baud: BAUD, parity: Parity::None };
/// Returns the bits of a character: start, eight of data, a parity if there is one, stop.
pub const fn character_bits(format: CharacterFormat) -> u64 {
    match format.parity {
        Parity::None => 10,
        Parity::Even | Parity::Odd => 11,
    }
}

/// The longest time of a reply (`U`).
pub const REPLY_TIME_OUT: Duration = Duration::from_millis(100);
/// The longest silence of an encoder while it calibrates (`U`).
pub const CALIBRATION_TIME_OUT: Duration = Duration::from_secs(10);
/// Time after which a paused frame is over (`U`).
pub const BYTE_TIME_OUT: Duration = Duration::from_millis(20);
