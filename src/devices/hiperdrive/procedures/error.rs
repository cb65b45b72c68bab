//! Errors of drives that are connected over EtherNet/IP. Each error contains the data for its message.

use std::fmt;
use std::time::Duration;

use crate::buses::ethernet_ip::protocol::{
    EncapsulationStatus, ExtendedStatusTableRow, GeneralStatus, PacketError, Service, find_extended_status,
};
use crate::devices::hiperdrive::protocol::{DriveNumber, OutOfRange, ParameterNumber, Topology, ValueError};
use crate::link::LinkError;
use crate::link::line::LineError;
use crate::profile::DeviceError;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RequestedItem {
    Session,
    Parameter(ParameterNumber),
    Set(ParameterNumber),
    Identity,
    Network { attribute: u16 },
    SetNetwork { attribute: u16 },
    Mac,
    Open,
    Close,
}

impl fmt::Display for RequestedItem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let named = |number: ParameterNumber| number.row().map_or("unknown", |row| row.name);
        match *self {
            RequestedItem::Session => f.write_str("opening a session"),
            RequestedItem::Parameter(number) => write!(f, "reading parameter {number} ({})", named(number)),
            RequestedItem::Set(number) => write!(f, "writing parameter {number} ({})", named(number)),
            RequestedItem::Identity => f.write_str("reading the identity object"),
            RequestedItem::Network { attribute } => write!(f, "reading attribute {attribute} of the TCP/IP object"),
            RequestedItem::SetNetwork { attribute } => write!(f, "writing attribute {attribute} of the TCP/IP object"),
            RequestedItem::Mac => f.write_str("reading the MAC address"),
            RequestedItem::Open => f.write_str("opening the cyclic connection"),
            RequestedItem::Close => f.write_str("closing the cyclic connection"),
        }
    }
}

#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ReplyDamage {
    #[error(transparent)]
    Packet(#[from] PacketError),
    #[error(transparent)]
    Value(#[from] ValueError),
    /// The frame contains no message.
    #[error("the frame contains no message")]
    Empty,
    #[error("a reply to service {got:02X}h instead of {requested:02X}h")]
    Service { requested: u8, got: u8 },
    #[error("the frame is incomplete ({bytes} bytes received)")]
    Cut { bytes: usize },
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LateReplyError {
    pub took: Duration,
    /// Time limit for a reply, not including the margin for the line.
    pub waited: Duration,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ErrorReply {
    pub service: Service,
    pub status: GeneralStatus,
    pub extended: Vec<u16>,
}

impl ErrorReply {
    /// Returns the table row for the first extended status word, if there is one and it is known.
    pub fn row(&self) -> Option<&'static ExtendedStatusTableRow> {
        find_extended_status(self.service, self.status, *self.extended.first()?)
    }

    /// Returns the remedy for the extended status if known, or else the remedy for the status.
    pub fn remedy(&self) -> Option<&'static str> {
        self.row().map(|row| row.remedy).or_else(|| self.status.row().map(|row| row.remedy))
    }
}

impl fmt::Display for ErrorReply {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.status)?;
        match (self.extended.as_slice(), self.row()) {
            ([], _) => Ok(()),
            ([first, ..], Some(row)) => write!(f, ", 0x{first:04X} {}", row.meaning),
            (words, None) => words.iter().try_for_each(|word| write!(f, ", 0x{word:04X}")),
        }
    }
}

/// Error for a number whose length does not match the type of its parameter. The number itself is not shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("parameter {number} ({name}) has the wrong length (bytes received: {got}, expected: {expected})")]
pub struct WrongLength {
    pub number: ParameterNumber,
    pub name: &'static str,
    pub expected: usize,
    pub got: usize,
}

#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Error {
    #[error(transparent)]
    Link(LinkError),
    #[error("cancelled")]
    Cancelled,
    /// The device keeps sending bytes that do not form frames.
    #[error("the device keeps sending data that is not EtherNet/IP")]
    NeverSilent,
    #[error("no reply: {requested} (attempts: {tries})")]
    NoReply {
        requested: RequestedItem,
        tries: u32,
        /// Reply that arrived after the time limit, if any.
        late: Option<LateReplyError>,
    },
    #[error("{requested}: {cause} (attempts: {tries})")]
    Damaged { requested: RequestedItem, tries: u32, cause: ReplyDamage },
    #[error("{requested}: {status}")]
    Encapsulation { requested: RequestedItem, status: EncapsulationStatus },
    #[error("{requested}: {refusal}")]
    Refused { requested: RequestedItem, refusal: ErrorReply },
    #[error("another master is connected: 0x{extended:04X}")]
    OtherMaster {
        /// Extended status word, either 0100h or 0106h.
        extended: u16,
    },
    /// The device offers only a longer interval than requested, at which a drive could not be stopped in time.
    #[error("the device offers cyclic data every {got_ms} ms instead of every {asked_ms} ms")]
    TooSlow {
        /// Requested interval in milliseconds.
        asked_ms: u64,
        got_ms: u64,
    },
    /// The timer of this computer is too coarse to send at the requested interval, so a drive could not be stopped in
    /// time.
    #[error("the timer resolution of this computer ({step_ms} ms) is too coarse for an interval of {asked_ms} ms")]
    CoarseTimer { asked_ms: u64, step_ms: u64 },
    #[error("the cyclic connection is still open")]
    InControl,
    /// The link has no cyclic connection, for example because it is a recording.
    #[error("this link does not provide a cyclic connection")]
    NoCyclic,
    /// The manual lists no parameter with this number.
    #[error("parameter {0} does not exist")]
    Unknown(ParameterNumber),
    /// The number is not a valid parameter number.
    #[error("{0} is not a parameter number")]
    NoNumber(u16),
    #[error("there is no drive {}: {} has {}", drive.get(), topology.category(), topology.drives())]
    NoPlace { drive: DriveNumber, topology: Topology },
    #[error("no drive is connected to port {}", drive.get())]
    NoDrive { drive: DriveNumber },
    /// Parameter 152 (Requested) of the drive is 0.
    #[error("drive {} is not requested: parameter 152 is 0", drive.get())]
    NotRequested { drive: DriveNumber },
    /// The value is out of range, so nothing was sent.
    #[error(transparent)]
    OutOfRange(#[from] OutOfRange),
    /// The device rejected the value. The error contains the range that currently applies.
    #[error("{0}")]
    Refuses(OutOfRange),
    /// The length of a number does not match the type of its parameter.
    #[error(transparent)]
    Length(#[from] WrongLength),
    /// The value does not match the type of its parameter, so nothing was sent.
    #[error("parameter {number}: {cause}")]
    Value { number: ParameterNumber, cause: ValueError },
    /// The parameter is read-only, so nothing was sent.
    #[error("parameter {number} ({name}) is read-only")]
    ReadOnly { number: ParameterNumber, name: &'static str },
    /// The parameter is write-only.
    #[error("parameter {number} ({name}) is write-only")]
    WriteOnly { number: ParameterNumber, name: &'static str },
    /// The parameter moves the drive and may be written only over the cyclic connection, so nothing was sent.
    #[error("parameter {number} ({name}) cannot be written as a value: drives move only over the cyclic connection")]
    Motion { number: ParameterNumber, name: &'static str },
    #[error("drive {} is moving", drive.get())]
    Moving { drive: DriveNumber },
    /// The device is not a HIPERDRIVE.
    #[error("the device {product:?} is not a HIPERDRIVE")]
    NotHiperdrive {
        /// Category of the device, or its name from the identity object.
        product: String,
    },
    /// The value read back differs from the value written.
    #[error("parameter {number} ({}): {wanted} was written, but {reads} was read back", parameter_name(*number))]
    NotAccepted { number: ParameterNumber, wanted: i64, reads: i64 },
    /// The network settings read back differ from those written.
    #[error("attribute {attribute} of the TCP/IP object differs from the value that was written")]
    NetworkNotTaken { attribute: u16 },
    /// The device is still busy, because parameter 47 has not become 0.
    #[error("parameter 47 is still {reads} after {milliseconds} ms")]
    Busy { reads: i64, milliseconds: u64 },
    #[error("{item} has changed since the plan was made")]
    Changed { item: String },
}

fn parameter_name(number: ParameterNumber) -> &'static str {
    number.row().map_or("unknown", |row| row.name)
}

impl From<LineError> for Error {
    fn from(error: LineError) -> Self {
        error.into_device_error(Error::Cancelled, Error::NeverSilent, Error::Link)
    }
}

impl From<LinkError> for Error {
    fn from(error: LinkError) -> Self {
        Error::Link(error)
    }
}

impl DeviceError for Error {
    fn is_only_cancelled(&self) -> bool {
        *self == Error::Cancelled
    }
}

impl Error {
    /// Returns whether the device is unreachable, so that further attempts are useless.
    pub const fn is_lost(&self) -> bool {
        matches!(self, Error::Link(_) | Error::NoReply { .. } | Error::NeverSilent)
    }

    pub const fn is_cancelled(&self) -> bool {
        matches!(self, Error::Cancelled)
    }

    /// Returns whether the value is currently unavailable or not provided by this device. Other parameters may still be
    /// available.
    pub const fn is_unavailable(&self) -> bool {
        matches!(self, Error::Refused { .. } | Error::NotRequested { .. } | Error::NoDrive { .. })
    }

    /// Returns the rejection if the device has replied but rejected the request.
    pub const fn as_refusal(&self) -> Option<&ErrorReply> {
        match self {
            Error::Refused { refusal, .. } => Some(refusal),
            _ => None,
        }
    }
}
