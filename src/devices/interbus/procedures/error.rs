//! Errors of an encoder behind a gateway, with the facts that a user needs.

use std::fmt;

use super::LeftState;
use crate::devices::interbus::protocol::{Command, ErrorWord, GearError, Refused, Reply, StartupMode};
use crate::link::LinkError;
use crate::link::line::LineError;
use crate::profile::DeviceError;

/// A request to a gateway.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RequestedItem {
    /// The IN word: two input registers, function 4.
    Input {
        /// The first of them.
        register: u16,
    },
    /// The OUT word as the gateway holds it: two holding registers, function 3.
    Output {
        /// The first of them.
        register: u16,
    },
    /// To take an OUT word: two holding registers, function 16.
    Write {
        /// The first of them.
        register: u16,
        word: u32,
    },
}

impl RequestedItem {
    /// The function of Modbus.
    pub const fn function(self) -> u8 {
        match self {
            RequestedItem::Input { .. } => 4,
            RequestedItem::Output { .. } => 3,
            RequestedItem::Write { .. } => 16,
        }
    }

    /// The first register.
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

/// A code with which a gateway refuses a request (Modbus application protocol 1.1b3, chapter 7).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Exception(u8);

impl Exception {
    /// Any code.
    pub const fn new(code: u8) -> Self {
        Exception(code)
    }

    /// Its number.
    pub const fn code(self) -> u8 {
        self.0
    }

    /// Returns the name in the protocol.
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

    /// Returns the most likely cause, and what to do.
    pub const fn cause(self) -> &'static str {
        match self.0 {
            0x01 => "the gateway has no such function: look whether its outputs are holding registers",
            0x02 => "there are no such registers: compare input= and output= with the gateway's process image",
            0x03 => "it does not take two registers at once: compare input= and output= with its process image",
            0x04 => "the gateway has failed: look at its diagnosis, and whether INTERBUS runs",
            0x05 | 0x06 => "the gateway is busy: let other programs end what they do with it, and try again",
            0x08 => "the gateway's memory is damaged: switch it off and on",
            0x0A => "the gateway does not reach its bus: compare unit= with its settings",
            0x0B => "nobody answers behind the gateway: look at the encoder's lamps and cable, and compare unit=",
            _ => "look into the gateway's manual for this code",
        }
    }

    /// Asking again may help.
    pub(super) const fn passes(self) -> bool {
        !matches!(self.0, 1..=3)
    }
}

/// The damage of a gateway's reply.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Damage {
    /// Bytes that are no frame of Modbus/TCP.
    #[error("{bytes} bytes that are not a Modbus/TCP frame")]
    NoFrame {
        /// Number of bytes.
        bytes: usize,
    },
    /// A reply of another unit.
    #[error("a reply of unit {got} instead of {asked}")]
    Unit {
        /// Requested unit.
        asked: u8,
        /// Unit of the reply.
        got: u8,
    },
    /// A reply to another function.
    #[error("a reply to function {got} instead of {asked}")]
    Function {
        /// Requested function.
        asked: u8,
        /// Function of the reply.
        got: u8,
    },
    /// Not as many registers as were asked for, or others.
    #[error("not the registers that were requested")]
    Registers,
}

/// The event that did not occur within the time of the handshake.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Awaited {
    /// The echo of a word, exactly.
    Echo,
    /// A value that was asked for.
    Value,
    /// The encoder runs: a position, a speed, or cam outputs.
    Run,
    /// The preset is shown as position.
    Preset,
}

impl fmt::Display for Awaited {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Awaited::Echo => "acknowledgement",
            Awaited::Value => "value",
            Awaited::Run => "position",
            Awaited::Preset => "preset as position",
        })
    }
}

/// Why the data of an encoder are implausible.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Implausible {
    /// Steps and turns.
    #[error(transparent)]
    Gear(#[from] GearError),
    /// Neither clockwise nor counterclockwise.
    #[error("{0} is no direction")]
    Direction(u32),
    /// A preset, an edge or a shift beyond what there can be.
    #[error("{value} of read-out {read:08X} is more than there can be")]
    Value {
        /// The OUT word that asked.
        read: u32,
        value: u32,
    },
}

/// A procedure that ended early.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Error {
    /// The wire to the gateway.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// The gateway does not answer.
    #[error("the gateway does not answer while {asked} ({tries} tries)")]
    NoReply {
        asked: RequestedItem,
        /// Number of attempts.
        tries: u32,
    },
    /// Every reply is damaged.
    #[error("damaged reply while {asked} ({tries} tries): {cause}")]
    Damaged {
        asked: RequestedItem,
        /// Number of attempts.
        tries: u32,
        /// Damage of the last reply.
        cause: Damage,
    },
    /// Bytes keep arriving where there should be silence.
    #[error("the gateway's line is never silent")]
    NeverSilent,
    /// It refuses.
    #[error("the gateway refuses {asked}: exception {:02X}, {}; {}", exception.code(), exception.name(), exception.cause())]
    Exception {
        asked: RequestedItem,
        /// Its code.
        exception: Exception,
    },
    /// The user wished an end.
    #[error("cancelled")]
    Cancelled,
    /// The encoder would take the word for something else in its mode: it was not sent.
    #[error(transparent)]
    Illegal(#[from] Refused),
    /// The encoder answers with an error word.
    #[error("the encoder refuses {:08X} ({}): {:08X}, {}; {}", sent.emit(), sent.name(), word(*error), error.meaning(), error.remedy())]
    Refused { sent: Command, error: ErrorWord },
    /// It has nothing to read out there.
    #[error("the encoder has no value for {:08X} ({})", command.emit(), command.name())]
    UnknownReadOut { command: Command },
    /// Nothing came of a word within the time of the handshake.
    #[error("no {awaited} after OUT {sent:08X} within {milliseconds} ms; IN is {input:08X}{}", other_echo(*input))]
    TimeOut {
        /// The awaited event.
        awaited: Awaited,
        /// The OUT word.
        sent: u32,
        /// The IN word that came last.
        input: u32,
        /// Time waited, in milliseconds.
        milliseconds: u64,
    },
    /// Another master writes to the encoder.
    #[error("another master writes to the encoder: OUT is {output:08X} where {sent:08X} was written")]
    OtherMaster {
        /// The OUT word written last.
        sent: u32,
        /// The OUT word that the gateway holds.
        output: u32,
    },
    /// The encoder is being parameterised, and not by us: a write was cut off, or another master is at work.
    #[error("the encoder is being parameterised: IN is {input:08X}")]
    NotRunning {
        /// The IN word.
        input: u32,
    },
    /// IN words make sense with their halves exchanged only.
    #[error("IN {input:08X} makes sense as {swapped:08X} only: the word order may be swapped")]
    WordOrder {
        /// The word as it was read.
        input: u32,
        /// With its halves exchanged.
        swapped: u32,
    },
    /// The data of the encoder are implausible.
    #[error("what the encoder says of itself cannot be: {0}")]
    Implausible(#[from] Implausible),
    /// It does not go into a mode.
    #[error("the encoder is in mode {} and does not go into {}", is.emit(), wanted.emit())]
    NoMode {
        /// The mode that it was sent to.
        wanted: StartupMode,
        /// The one that it says to be in.
        is: StartupMode,
    },
    /// A mode that cannot be selected.
    #[error("mode {} cannot be selected", mode.emit())]
    NotSelectable { mode: StartupMode },
    /// It is in a mode that the manual does not have: what any word but a read-out does there is not known.
    #[error("the encoder is in mode {}, which is unknown: nothing was sent but read-outs", mode.emit())]
    UnknownMode { mode: StartupMode },
    /// The shaft turns where it must stand still.
    #[error("the shaft moves: from position {from} to {to}")]
    Moving {
        /// The first position.
        from: u32,
        /// The one farthest from it.
        to: u32,
    },
    /// A written value does not read back.
    #[error("{item} reads {reads} after {wanted} was written")]
    NotTaken {
        item: String,
        /// The value written.
        wanted: u32,
        /// The value read.
        reads: u32,
    },
    /// Values changed between the plan and its execution.
    #[error("{item} has changed since the plan was made")]
    Changed {
        /// The item that changed.
        item: String,
    },
    /// Something ended early, and the encoder could not be led back.
    #[error("{cause}; the encoder could not be led back: {standing}")]
    NotLedBack {
        /// Why it ended; if nothing failed before, why it could not be led back.
        cause: Box<Error>,
        /// In which state it may be.
        standing: LeftState,
    },
}

/// The error as it came.
fn word(error: ErrorWord) -> u32 {
    Reply::Error(error).emit()
}

fn other_echo(input: u32) -> &'static str {
    match Reply::parse(input) {
        Reply::Echo { .. } => ", the acknowledgement of another word",
        _ => "",
    }
}

impl From<LineError> for Error {
    fn from(error: LineError) -> Self {
        error.at_device(Error::Cancelled, Error::NeverSilent, Error::Link)
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
    /// The gateway can no longer be reached: trying anything else makes no sense.
    pub fn is_lost(&self) -> bool {
        match self {
            Error::Link(_) | Error::NoReply { .. } | Error::NeverSilent => true,
            Error::NotLedBack { cause, .. } => cause.is_lost(),
            _ => false,
        }
    }

    /// The user wished it.
    pub fn is_cancelled(&self) -> bool {
        match self {
            Error::Cancelled => true,
            Error::NotLedBack { cause, .. } => cause.is_cancelled(),
            _ => false,
        }
    }
}
