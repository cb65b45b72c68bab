//! What can go wrong with an encoder, with the facts a person needs.

use std::fmt;

use crate::device::line::LineError;
use crate::link::LinkError;
use crate::protocol::biss::RegisterAddress;
use crate::protocol::ubicom::ReplyError;

/// What was asked of an encoder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Asked {
    /// A register.
    Read(RegisterAddress),
    /// To take a value into a register.
    Write(RegisterAddress, u8),
    /// The position.
    Position,
}

impl fmt::Display for Asked {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Asked::Read(address) => write!(f, "reading register {address}"),
            Asked::Write(address, value) => write!(f, "writing {value:02X}h to register {address}"),
            Asked::Position => f.write_str("reading the position"),
        }
    }
}

/// A procedure that ended early.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Error {
    /// The wire.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// Nothing came back.
    #[error("no reply while {asked} ({tries} tries)")]
    NoReply {
        /// What was asked.
        asked: Asked,
        /// How often.
        tries: u32,
        /// Our own bytes came back: the adapter echoes, so the line itself works.
        echo_heard: bool,
    },
    /// Something came back and was broken every time.
    #[error("damaged reply while {asked} ({tries} tries): {cause}")]
    Damaged {
        /// What was asked.
        asked: Asked,
        /// How often.
        tries: u32,
        /// What was wrong with the last one.
        cause: Damage,
    },
    /// Bytes keep arriving where there should be silence.
    #[error("the line is never silent")]
    NeverSilent,
    /// The encoder answers, and not when it is asked for this register: it has none there.
    #[error("the encoder has no register {address}")]
    NoSuchRegister {
        /// Where.
        address: RegisterAddress,
    },
    /// The encoder did not take a value.
    #[error("the encoder refuses {value:02X}h for register {address}")]
    Refused {
        /// Where.
        address: RegisterAddress,
        /// What was written.
        value: u8,
        /// What the register gives back instead, where the way tells that.
        reads: Option<u8>,
    },
    /// Whether a value was taken is not known: reading the register back does not tell, or is not possible.
    #[error("whether {value:02X}h was written to register {address} is not known: {cause}")]
    Unclear {
        /// Where.
        address: RegisterAddress,
        /// What was written.
        value: u8,
        /// Why it is not known.
        cause: Box<Error>,
    },
    /// The user wished an end.
    #[error("cancelled")]
    Cancelled,
    /// Neither order of a register number's two bytes gives an answer that the manual knows.
    #[error("the encoder's answer {answer:02X}h does not tell the byte order of register numbers")]
    OrderUnknown {
        /// What it said to the probe.
        answer: u8,
    },
    /// A position with more bits than the encoder is said to have.
    #[error("the position {word:X}h has more than {multiturn}+{singleturn} bits")]
    TooWide {
        /// As it came.
        word: u64,
        /// Bits of the revolutions.
        multiturn: u8,
        /// Bits within a revolution.
        singleturn: u8,
    },
    /// Registers behind the last that can be named.
    #[error("{count} registers from {start} on are more than there can be")]
    OutOfRange {
        /// The first.
        start: RegisterAddress,
        /// How many.
        count: usize,
    },
    /// The encoder answers, and not as the reference says; with what it did.
    #[error("{0}")]
    Unexpected(String),
}

/// What was wrong with a reply.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Damage {
    /// Bytes that are no frame.
    #[error("{bytes} bytes without a whole frame")]
    NoFrame {
        /// How many.
        bytes: usize,
    },
    /// A frame that is no reply to what was asked.
    #[error(transparent)]
    Reply(#[from] ReplyError),
    /// A reply came before our own bytes, or these came back changed.
    #[error("our own bytes did not come back before the reply")]
    Echo,
    /// Readings of the same thing differ.
    #[error("two readings differ")]
    Inconsistent,
}

impl From<LineError> for Error {
    fn from(error: LineError) -> Self {
        match error {
            LineError::Cancelled => Error::Cancelled,
            LineError::NeverSilent => Error::NeverSilent,
            LineError::Link(error) => Error::Link(error),
        }
    }
}

impl Error {
    /// The encoder can no longer be reached: trying anything else makes no sense.
    pub fn is_lost(&self) -> bool {
        match self {
            Error::Link(_) | Error::NoReply { .. } => true,
            Error::Unclear { cause, .. } => cause.is_lost(),
            _ => false,
        }
    }
}
