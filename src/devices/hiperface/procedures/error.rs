//! Errors of encoder jobs, with the details for the error messages.

use crate::devices::hiperface::profile::PlanItem;
use crate::devices::hiperface::protocol::{AccessCodeNumber, Command, LineSettings, Reply, ReplyError, StatusCode};
use crate::link::LinkError;
use crate::link::line::LineError;
use crate::profile::DeviceError;

#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Error {
    #[error(transparent)]
    Link(#[from] LinkError),
    #[error("no reply from address {address:02X}h to {} (attempts: {tries})", command.row().name)]
    NoReply {
        address: u8,
        command: Command,
        tries: u32,
        /// Whether the sent bytes came back as an echo, which shows that the line itself works.
        echo_heard: bool,
    },
    #[error("damaged reply to {} (attempts: {tries}): {cause}", command.row().name)]
    Damaged { command: Command, tries: u32, cause: ReplyDamage },
    /// Bytes keep arriving during the required silence.
    #[error("the line is never idle")]
    NeverSilent,
    #[error("{} was refused: {}", command.row().name, code_list(codes))]
    Rejected { command: Command, codes: Vec<StatusCode> },
    /// The connection was lost, so it is unknown whether a change was executed.
    #[error("it is not known whether {} was carried out: {cause}", command.row().name)]
    Unclear {
        command: Command,
        /// Reason why the change cannot be read back.
        cause: Box<Error>,
    },
    #[error("cancelled")]
    Cancelled,
    /// The shaft is turning, but it must be at rest.
    #[error("the shaft is moving: {readings:?}")]
    Moving {
        /// Consecutive position readings.
        readings: Vec<u32>,
    },
    /// Command 63h is only for encoders without a bearing, and this encoder has one.
    #[error("{encoder} is not a kit encoder")]
    NotAKit { encoder: String },
    #[error("address {address:02X}h belongs to another encoder")]
    AddressTaken { address: u8 },
    #[error("position {wanted} is outside 0…{last}")]
    PositionRange { wanted: u64, last: u64 },
    #[error("data field {field} has bytes 0…{}, not {address}…{}", size.saturating_sub(1), (address + count).saturating_sub(1))]
    OutOfField {
        field: u8,
        address: usize,
        count: usize,
        /// Size of the field in bytes.
        size: usize,
    },
    #[error("the access code {number} is not known")]
    CodeUnknown { field: u8, number: AccessCodeNumber },
    #[error("{item} has changed since the plan was made")]
    Changed { item: PlanItem },
    #[error("{item}: {expected} was written, but {got} was read back")]
    NotVerified { item: PlanItem, expected: String, got: ReadBackValue },
    #[error("unexpected kind of reply to {}: {reply}", command.row().name)]
    OtherReply { command: Command, reply: String },
    #[error("the position already had this value, so reading it back does not show whether it was written")]
    PositionUnchanged,
    #[error("no data field requires access code {number}, so it cannot be tested")]
    CodeGuardsNothing { number: AccessCodeNumber },
    #[error("the interface settings 0x{:02X} have a reserved format", settings.byte())]
    ReservedFormat {
        /// Settings that were read from the encoder or requested by the user.
        settings: LineSettings,
    },
}

impl Error {
    pub(super) fn unexpected_reply(command: Command, reply: &Reply) -> Self {
        Error::OtherReply { command, reply: format!("{reply:?}") }
    }
}

#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ReadBackValue {
    #[error("{0}")]
    Value(String),
    /// The data field does not behave as its newly written status specifies.
    #[error("another status")]
    StatusMismatch,
}

#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ReplyDamage {
    #[error(transparent)]
    Reply(#[from] ReplyError),
    /// The reply to a request with an access code is unreadable. Its bytes are not shown, because they may be the echo
    /// of the request.
    #[error("unreadable frame")]
    Unreadable,
    #[error("extra bytes after the reply")]
    Trailing,
    #[error("the reply came too late")]
    Late,
    #[error("the echo differs from what was sent")]
    Echo,
    #[error("the encoder reports: {0}")]
    AtEncoder(StatusCode),
    #[error("two readings differ")]
    Inconsistent,
}

impl From<LineError> for Error {
    fn from(error: LineError) -> Self {
        error.into_device_error(Error::Cancelled, Error::NeverSilent, Error::Link)
    }
}

impl DeviceError for Error {
    fn is_only_cancelled(&self) -> bool {
        *self == Error::Cancelled
    }
}

impl Error {
    /// Returns whether the connection to the encoder is lost, so that further attempts are useless.
    pub fn is_lost(&self) -> bool {
        match self {
            Error::Link(_) | Error::NoReply { .. } => true,
            Error::Unclear { cause, .. } => cause.is_lost(),
            _ => false,
        }
    }

    /// Returns whether the encoder currently has no position to report.
    pub fn is_without_position(&self) -> bool {
        matches!(self, Error::Rejected { codes, .. } if codes.iter().any(|code| code.invalidates_position()))
    }

    pub fn is_rejection(&self, code: StatusCode) -> bool {
        matches!(self, Error::Rejected { codes, .. } if codes.contains(&code))
    }
}

fn code_list(codes: &[StatusCode]) -> String {
    codes.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")
}
