//! Errors of procedures on an encoder, with the details for their messages.

use std::fmt;

use crate::buses::bridge::procedures::{AdapterError, Failure};
use crate::buses::ubicom::protocol::{Reply, ReplyError};
use crate::devices::biss::protocol::{DeviceMode, FrameError, Identity, LayoutError, RegisterAddress};
use crate::link::LinkError;
use crate::link::line::LineError;
use crate::profile::DeviceError;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RequestedItem {
    Read(RegisterAddress),
    Write(RegisterAddress, u8),
    Position,
}

impl fmt::Display for RequestedItem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            RequestedItem::Read(address) => write!(f, "reading register {address}"),
            RequestedItem::Write(address, value) => write!(f, "writing 0x{value:02X} to register {address}"),
            RequestedItem::Position => f.write_str("reading the position"),
        }
    }
}

#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Error {
    #[error(transparent)]
    Link(#[from] LinkError),
    #[error("no reply while {requested} (attempts: {tries})")]
    NoReply {
        requested: RequestedItem,
        tries: u32,
        /// Whether the echo of the sent bytes was received, which shows that the line itself works.
        echo_heard: bool,
    },
    #[error("damaged reply while {requested} (attempts: {tries}): {cause}")]
    Damaged { requested: RequestedItem, tries: u32, cause: ReplyDamage },
    /// Bytes keep arriving while the line should be silent.
    #[error("the line is never idle")]
    NeverSilent,
    #[error(transparent)]
    Adapter(#[from] AdapterError),
    #[error("no encoder acknowledges on the bus (attempts: {tries})")]
    NoAcknowledge {
        tries: u32,
        /// Whether the adapter could supply the encoder but was not asked to.
        supply_off: bool,
    },
    #[error("the data line stays low (attempts: {tries})")]
    StuckLow { tries: u32 },
    #[error("the data line stays high (attempts: {tries})")]
    StuckHigh { tries: u32 },
    /// No frame has ever had a correct checksum, so the encoder's frames must have different widths.
    #[error("{frames} frames in a row have a wrong CRC: frames of the encoder do not have {data_bits}+{crc_bits} bits")]
    WrongWidths {
        frames: u32,
        /// Assumed number of position, error and warning bits.
        data_bits: u8,
        /// Assumed width of the checksum in bits.
        crc_bits: u8,
    },
    /// The frame widths are unknown, and the checksum does not match for any frame length.
    #[error("no frame length matches the CRC of the frames")]
    WidthsUnknown { moving: bool },
    #[error("the encoder has no register {address}")]
    NoSuchRegister { address: RegisterAddress },
    /// Registers of a data area cannot be watched, because they can only be read at standstill.
    #[error("register {address} contains data, which cannot be read while the shaft may turn")]
    NotWatched { address: RegisterAddress },
    #[error("the encoder refuses 0x{value:02X} for register {address}")]
    Refused {
        address: RegisterAddress,
        value: u8,
        /// Value that the register still holds, or `None` if the connection cannot read it back.
        reads: Option<u8>,
    },
    /// The value may or may not have been accepted. The register cannot be read back, or reading it back proves
    /// nothing.
    #[error("it is not known whether 0x{value:02X} was written to register {address}: {cause}")]
    Unclear {
        address: RegisterAddress,
        value: u8,
        /// Reason for the uncertainty.
        cause: Box<Error>,
    },
    #[error("cancelled")]
    Cancelled,
    /// The byte order of register numbers is unknown, because the encoder's reply matches neither order.
    #[error("the byte order of register numbers cannot be derived from the encoder's reply 0x{answer:02X}")]
    OrderUnknown { answer: u8 },
    /// The position has more bits than the known frame layout.
    #[error("the position 0x{word:X} has more than {multiturn}+{singleturn} bits")]
    TooWide {
        /// Position word as received.
        word: u64,
        multiturn: u8,
        singleturn: u8,
    },
    /// The registers extend past the last address.
    #[error("{count} registers from {start} extend past the last register")]
    OutOfRange { start: RegisterAddress, count: usize },
    /// No description matches this encoder, and there is no generic one.
    #[error("no description matches the encoder, which reports {0}")]
    NoDescription(Identity),
    #[error("the encoder was not identified")]
    NotIdentified,
    #[error("the shaft is moving")]
    Moving {
        /// Speed in revolutions per minute, positive clockwise, or `None` if the multiturn counter is too narrow to
        /// measure it.
        rpm: Option<f64>,
    },
    /// The encoder is in a device mode in which its registers may show values that were never saved.
    #[error("the encoder is in device mode {mode}")]
    NotInOperation { mode: DeviceMode },
    #[error("{item} has changed since the plan was made")]
    Changed { item: String },
    #[error("unexpected kind of reply while {requested}: {reply}")]
    OtherReply { requested: RequestedItem, reply: String },
    /// The adapter reports a frame status that the bridge protocol does not define.
    #[error("the adapter reports the unknown frame status 0x{status:02X}")]
    FrameStatus {
        /// Status byte from the adapter.
        status: u8,
    },
    #[error(transparent)]
    Layout(#[from] LayoutError),
    /// Fewer registers were read than requested.
    #[error("{got} registers were read from {start} instead of {expected}")]
    TooFewRegisters { start: RegisterAddress, expected: usize, got: usize },
    /// The encoder does not return to operation mode, or its password remains set.
    #[error("the encoder stays in device mode {mode}, or its password stays set")]
    StaysUnlocked { mode: DeviceMode },
}

impl Error {
    /// Returns the error for a reply to a different kind of request.
    pub(super) fn unexpected_reply(requested: RequestedItem, reply: &Reply) -> Self {
        Error::OtherReply { requested, reply: format!("{reply:?}") }
    }
}

/// Returns the register with the given global number, or the bank selection register if the number is too large.
pub(super) fn requested_register(number: u16) -> RegisterAddress {
    RegisterAddress::from_global(number).unwrap_or(RegisterAddress::BANK_SELECT)
}

/// Converts register values to an array of known size.
///
/// # Errors
/// Returns [`Error::TooFewRegisters`] if the number of registers differs.
pub(super) fn to_register_array<const N: usize>(start: RegisterAddress, bytes: Vec<u8>) -> Result<[u8; N], Error> {
    bytes.try_into().map_err(|bytes: Vec<u8>| Error::TooFewRegisters { start, expected: N, got: bytes.len() })
}

#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ReplyDamage {
    #[error("the received bytes contain no complete frame (number of bytes: {bytes})")]
    NoFrame { bytes: usize },
    /// The frame is not a reply to the request.
    #[error(transparent)]
    Reply(#[from] ReplyError),
    /// The reply arrived before the echo, or the echo was altered.
    #[error("the adapter's echo before the reply was missing or wrong")]
    Echo,
    /// The received frame is invalid.
    #[error(transparent)]
    Frame(#[from] FrameError),
    /// The adapter reports a wrong checksum in a control frame.
    #[error("the encoder's reply to the register access has a wrong CRC")]
    ControlFrame,
    #[error("two readings differ")]
    Inconsistent,
}

impl From<LineError> for Error {
    fn from(error: LineError) -> Self {
        error.into_device_error(Error::Cancelled, Error::NeverSilent, Error::Link)
    }
}

impl From<Failure> for Error {
    fn from(failure: Failure) -> Self {
        match failure {
            Failure::Adapter(error) => Error::Adapter(error),
            Failure::Line(error) => error.into(),
        }
    }
}

impl DeviceError for Error {
    fn is_only_cancelled(&self) -> bool {
        *self == Error::Cancelled
    }
}

impl Error {
    /// Returns whether the encoder can no longer be reached, so that further attempts would be useless.
    pub fn is_lost(&self) -> bool {
        match self {
            Error::Link(_)
            | Error::NoReply { .. }
            | Error::NoAcknowledge { .. }
            | Error::StuckLow { .. }
            | Error::StuckHigh { .. }
            | Error::Adapter(AdapterError::Silent) => true,
            Error::Unclear { cause, .. } => cause.is_lost(),
            _ => false,
        }
    }
}
