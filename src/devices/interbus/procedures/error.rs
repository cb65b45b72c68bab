//! Errors of an encoder behind a gateway.

use std::fmt;

use super::LeftState;
use crate::devices::interbus::protocol::{Command, ErrorWord, ForbiddenCommandError, GearError, Reply, StartupMode};
use crate::link::LinkError;
use crate::link::line::LineError;
use crate::profile::DeviceError;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RequestedItem {
    /// Read the IN word from two input registers (Modbus function 4).
    Input { register: u16 },
    /// Read the OUT word from two holding registers (Modbus function 3).
    Output { register: u16 },
    /// Write an OUT word to two holding registers (Modbus function 16).
    Write { register: u16, word: u32 },
}

impl RequestedItem {
    pub const fn function_code(self) -> u8 {
        match self {
            RequestedItem::Input { .. } => 4,
            RequestedItem::Output { .. } => 3,
            RequestedItem::Write { .. } => 16,
        }
    }

    pub const fn register(self) -> u16 {
        match self {
            RequestedItem::Input { register }
            | RequestedItem::Output { register }
            | RequestedItem::Write { register, .. } => register,
        }
    }
}

impl fmt::Display for RequestedItem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            RequestedItem::Input { register } => write!(f, "reading the IN word from input register {register}"),
            RequestedItem::Output { register } => write!(f, "reading the OUT word from holding register {register}"),
            RequestedItem::Write { register, word } => {
                write!(f, "writing OUT {word:08X} to holding register {register}")
            }
        }
    }
}

/// The exception code in a gateway's rejection of a request. See *MODBUS application protocol* 1.1b3, chapter 7.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Exception(u8);

impl Exception {
    pub const fn new(code: u8) -> Self {
        Exception(code)
    }

    pub const fn code(self) -> u8 {
        self.0
    }

    pub const fn name(self) -> &'static str {
        match self.0 {
            0x01 => "illegal function",
            0x02 => "illegal data address",
            0x03 => "illegal data value",
            0x04 => "server device failure",
            0x05 => "acknowledge",
            0x06 => "server device busy",
            0x08 => "memory parity error",
            0x0A => "gateway path unavailable",
            0x0B => "gateway target device failed to respond",
            _ => "unknown exception",
        }
    }

    /// Returns the most likely cause of the exception and a remedy.
    pub const fn cause(self) -> &'static str {
        match self.0 {
            0x01 => "the gateway does not have this function: check that its outputs are holding registers",
            0x02 => "the gateway does not have these registers: compare input= and output= with its process image",
            0x03 => {
                "the gateway does not accept two registers at once: compare input= and output= with its process image"
            }
            0x04 => "the gateway has failed: check its diagnosis, and whether INTERBUS runs",
            0x05 | 0x06 => "the gateway is busy: wait until other programs have finished, and try again",
            0x08 => "the gateway's memory is damaged: switch it off and on",
            0x0A => "the gateway cannot reach its bus: compare unit= with its settings",
            0x0B => "the encoder behind the gateway does not answer: check its LEDs and cable, and compare unit=",
            _ => "look this code up in the gateway's manual",
        }
    }

    /// Returns whether the request may succeed if it is repeated.
    pub(super) const fn is_temporary(self) -> bool {
        !matches!(self.0, 1..=3)
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ReplyDamage {
    /// The received bytes are not a Modbus/TCP frame.
    #[error("the received bytes are not a Modbus/TCP frame (number of bytes: {bytes})")]
    NoFrame { bytes: usize },
    #[error("the reply is from unit {got} instead of {requested}")]
    Unit { requested: u8, got: u8 },
    #[error("the reply is to function {got} instead of {requested}")]
    Function { requested: u8, got: u8 },
    /// The reply contains other registers than requested, or the wrong number of them.
    #[error("the reply does not contain the requested registers")]
    Registers,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExpectedWord {
    Echo,
    Value,
    /// A word from a running encoder: a position, a speed or cam outputs.
    Run,
    /// A position equal to the preset.
    Preset,
}

impl fmt::Display for ExpectedWord {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            ExpectedWord::Echo => "acknowledgement",
            ExpectedWord::Value => "value",
            ExpectedWord::Run => "position",
            ExpectedWord::Preset => "position equal to the preset",
        })
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ImplausibleValue {
    #[error(transparent)]
    Gear(#[from] GearError),
    #[error("{0} is not a valid direction code")]
    Direction(u32),
    /// A preset, a cam edge or a shift is out of range.
    #[error("{value} for OUT {read:08X} is too large")]
    Value { read: u32, value: u32 },
}

#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Error {
    #[error(transparent)]
    Link(#[from] LinkError),
    #[error("the gateway does not answer {requested} (attempts: {tries})")]
    NoReply { requested: RequestedItem, tries: u32 },
    #[error("damaged reply to {requested} (attempts: {tries}): {cause}")]
    Damaged {
        requested: RequestedItem,
        tries: u32,
        /// Damage to the last reply.
        cause: ReplyDamage,
    },
    /// The gateway keeps sending when the line should be silent.
    #[error("the gateway sends data that was not requested")]
    NeverSilent,
    #[error("the gateway refuses {requested}: exception {:02X}, {}; {}", exception.code(), exception.name(), exception.cause())]
    Exception { requested: RequestedItem, exception: Exception },
    #[error("cancelled")]
    Cancelled,
    /// The word was not sent, because the encoder would interpret it as another command in its current mode.
    #[error(transparent)]
    Illegal(#[from] ForbiddenCommandError),
    /// The encoder rejected the command with an error word.
    #[error("the encoder refuses {:08X} ({}): {:08X}, {}; {}", sent.emit(), sent.name(), to_word(*error), error.meaning(), error.remedy())]
    Refused { sent: Command, error: ErrorWord },
    #[error("the encoder has no value for {:08X} ({})", command.emit(), command.name())]
    UnknownReadOut { command: Command },
    /// The encoder did not react to a word within the handshake time limit.
    #[error(
        "no {awaited} within {milliseconds} ms after OUT {sent:08X}; IN is {input:08X}{}",
        unexpected_echo_note(*input)
    )]
    TimeOut {
        awaited: ExpectedWord,
        sent: u32,
        input: u32,
        /// Time limit in milliseconds.
        milliseconds: u64,
    },
    #[error("another master is writing to the encoder: OUT is {output:08X}, but {sent:08X} was written")]
    OtherMaster { sent: u32, output: u32 },
    /// The encoder is being parameterised, but not by this program. A write was interrupted, or another master is
    /// active.
    #[error("the encoder is being parameterised: IN is {input:08X}")]
    NotRunning { input: u32 },
    /// The IN word is plausible only with its halves swapped.
    #[error("IN {input:08X} is plausible only as {swapped:08X}: the word order may be swapped")]
    WordOrder {
        /// The word as received.
        input: u32,
        swapped: u32,
    },
    #[error("the encoder reports implausible data: {0}")]
    Implausible(#[from] ImplausibleValue),
    /// The encoder did not enter the requested mode.
    #[error("the encoder stays in mode {} instead of changing to {}", is.emit(), wanted.emit())]
    NoMode { wanted: StartupMode, is: StartupMode },
    #[error("mode {} cannot be selected", mode.emit())]
    NotSelectable { mode: StartupMode },
    /// The encoder is in a mode that the manual does not define. Only read-outs were sent, since the effect of other
    /// words is unknown.
    #[error("the encoder is in the unknown mode {}, so only values were read", mode.emit())]
    UnknownMode { mode: StartupMode },
    /// The shaft is turning, although it must be at standstill.
    #[error("the shaft is moving: from position {from} to {to}")]
    Moving { from: u32, to: u32 },
    /// The value read back differs from the value written.
    #[error("{item}: {wanted} was written, but {reads} was read back")]
    NotAccepted { item: String, wanted: u32, reads: u32 },
    #[error("{item} has changed since the plan was made")]
    Changed { item: String },
    /// The encoder could not be returned to its mode after the job.
    #[error("{cause}; the encoder could not be returned to operation: {standing}")]
    ModeNotRestored {
        /// The job's error, or if the job succeeded, the error that prevented the return.
        cause: Box<Error>,
        standing: LeftState,
    },
}

fn to_word(error: ErrorWord) -> u32 {
    Reply::Error(error).emit()
}

fn unexpected_echo_note(input: u32) -> &'static str {
    match Reply::parse(input) {
        Reply::Echo { .. } => ", the acknowledgement of another word",
        _ => "",
    }
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

    fn is_cancelled(&self) -> bool {
        Error::is_cancelled(self)
    }
}

impl Error {
    /// Returns whether the gateway is unreachable, so that further attempts are pointless.
    pub fn is_lost(&self) -> bool {
        match self {
            Error::Link(_) | Error::NoReply { .. } | Error::NeverSilent => true,
            Error::ModeNotRestored { cause, .. } => cause.is_lost(),
            _ => false,
        }
    }

    pub fn is_cancelled(&self) -> bool {
        match self {
            Error::Cancelled => true,
            Error::ModeNotRestored { cause, .. } => cause.is_cancelled(),
            _ => false,
        }
    }
}
