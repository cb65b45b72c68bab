//! Handshake steps as reported to the user, and the state in which a failed job leaves the encoder.

use std::fmt;

use crate::devices::interbus::protocol::{Command, ErrorWord, Reply, StartupMode, Value};
use crate::units::Moment;

/// A step of the handshake: the OUT word that was sent and the IN word received.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Handshake {
    pub at: Moment,
    pub out: u32,
    pub command: Command,
    pub input: u32,
    pub reply: WordReply,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WordReply {
    /// A word from a running encoder: a position, a speed or cam outputs.
    Runs,
    Busy,
    Echoed,
    /// Late echo of an earlier word, unless it persists.
    OldEcho,
    Value(Value),
    Error(ErrorWord),
    Unknown,
}

/// Returns whether `input` is the exact echo of the command. The manufacturer's bit is ignored in the echo of a
/// parameter, but not in the echo of a cam, where it selects the edge (reference 2).
pub(super) fn is_echo(command: Command, input: u32) -> bool {
    const MANUFACTURER: u32 = 1 << 29;
    let echo = Reply::echo_for(command).emit();
    input == echo || matches!(command, Command::Set(..)) && input == echo | MANUFACTURER
}

impl WordReply {
    pub fn from_words(command: Command, input: u32) -> Self {
        if is_echo(command, input) && !matches!(command, Command::Normal | Command::Run) {
            return WordReply::Echoed;
        }
        match Reply::parse(input) {
            Reply::Run { .. } => WordReply::Runs,
            Reply::Busy { .. } => WordReply::Busy,
            Reply::Echo { .. } => WordReply::OldEcho,
            Reply::ReadOut(value) => WordReply::Value(value),
            Reply::Error(error) => WordReply::Error(error),
            Reply::UnknownReadOut(_) | Reply::Unknown { .. } => WordReply::Unknown,
        }
    }
}

/// Last known state of an encoder that could not be returned to its mode.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LeftState {
    /// Last OUT word, which the gateway keeps until another word is written.
    pub out: u32,
    /// Whether parameters or cams were being set. If so, the encoder sends no position until it receives 80000000h.
    pub parameterising: bool,
    /// Mode before the job, or `None` if it has not been read.
    pub found: Option<StartupMode>,
    /// Current mode, or `None` if it has not been read.
    pub is: Option<StartupMode>,
}

impl fmt::Display for LeftState {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "OUT may still be {:08X}", self.out)?;
        if self.parameterising {
            f.write_str(", and it may be in parameterisation")?;
        }
        match (self.found, self.is) {
            (Some(found), Some(is)) if found != is => {
                write!(f, "; its previous mode was {}, it is now in mode {}", found.emit(), is.emit())
            }
            (Some(found), _) => write!(f, "; its previous mode was {}", found.emit()),
            _ => Ok(()),
        }
    }
}
