//! IN words of a K3 encoder (reference 2). Whether a word contains a position or another value depends on the mode. See
//! [`CamOutput`](super::CamOutput) and [`ReadOutNumber::value`](super::ReadOutNumber::value).

use super::command::Command;
use super::mode::EncoderMode;
use super::value::{Code, Value};

/// Meaning of an IN word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Reply {
    /// The encoder is running: bit 31 is clear. Depending on the mode, the value is a position, a speed or a cam output
    /// word.
    Run {
        /// Bits 24..0 of the word.
        value: Value,
        /// Bits 30..25, which should be 0. Other values deserve a warning.
        stray: u8,
    },
    /// The encoder is processing a parameter (prefix 110 or 111, code 0). For cam 0, the word may also be its echo.
    Busy {
        /// Bit 29 of the word.
        manufacturer: bool,
        /// Data of the word.
        data: Value,
    },
    /// The command was received but may not have been accepted yet (prefix 110 or 111).
    Echo {
        /// Bit 29 of the word.
        manufacturer: bool,
        /// Parameter code or cam number, which is never 0.
        code: Code,
        /// Data as the master sent them.
        data: Value,
    },
    /// The value of a read-out (prefix 101, code 0).
    ReadOut(Value),
    /// The read-out does not exist (prefix 101, code 2).
    UnknownReadOut(Value),
    /// A reply that the manual does not define (prefix 101 with another code).
    Unknown {
        /// A code other than 0 and 2.
        code: Code,
        /// Bits 24..0 of the word.
        data: Value,
    },
    /// An error (prefix 100).
    Error(ErrorWord),
}

/// An error word, which has the prefix 100.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ErrorWord {
    /// Error code in bits 28..25.
    pub code: Code,
    /// Bits 24..0 of the word.
    pub data: Value,
}

const ERROR: u32 = 0b100 << 29;
const READ_OUT: u32 = 0b101 << 29;
const ECHO: u32 = 0b110 << 29;
const MANUFACTURER: u32 = 1 << 29;

impl Reply {
    /// Parses an IN word. Every word is valid.
    pub fn parse(word: u32) -> Self {
        let (code, data) = (Code::from_word(word), Value::from_word(word));
        let manufacturer = word & MANUFACTURER != 0;
        match (word >> 29, code.get()) {
            (0b110 | 0b111, 0) => Reply::Busy { manufacturer, data },
            (0b110 | 0b111, _) => Reply::Echo { manufacturer, code, data },
            (0b101, 0) => Reply::ReadOut(data),
            (0b101, 2) => Reply::UnknownReadOut(data),
            (0b101, _) => Reply::Unknown { code, data },
            (0b100, _) => Reply::Error(ErrorWord { code, data }),
            _ => Reply::Run { value: data, stray: (word >> Value::BITS) as u8 },
        }
    }

    /// Returns the word. Stray bits that do not fit into the word are dropped.
    pub fn emit(self) -> u32 {
        let echo = |manufacturer: bool| if manufacturer { ECHO | MANUFACTURER } else { ECHO };
        match self {
            Reply::Run { value, stray } => u32::from(stray & 0x3F) << Value::BITS | value.get(),
            Reply::Busy { manufacturer, data } => echo(manufacturer) | data.get(),
            Reply::Echo { manufacturer, code, data } => echo(manufacturer) | code.to_word_bits() | data.get(),
            Reply::ReadOut(value) => READ_OUT | value.get(),
            Reply::UnknownReadOut(data) => READ_OUT | 2 << Value::BITS | data.get(),
            Reply::Unknown { code, data } => READ_OUT | code.to_word_bits() | data.get(),
            Reply::Error(error) => ERROR | error.code.to_word_bits() | error.data.get(),
        }
    }

    /// Returns the echo of a command, which is its word with bits 31 and 30 set. That cams are echoed unchanged is an
    /// assumption (`U`). Always compare complete words, because an older reply may have the same code (reference 4).
    pub fn echo_for(command: Command) -> Self {
        Reply::parse(command.emit() | ECHO)
    }

    /// Returns the command that this reply echoes, or `None` if nothing can be set in this mode.
    pub fn echoed_command(self, mode: EncoderMode) -> Option<Command> {
        let sets = |command: &Command| {
            use Command::{Activate, CamStart, CamStop, Cams, Set, Shift};
            matches!(command, Set(..) | Cams(_) | Activate(_) | Shift(_) | CamStart(..) | CamStop(..))
        };
        if !matches!(self, Reply::Echo { .. } | Reply::Busy { .. }) {
            return None;
        }
        let plain = self.emit() & !ECHO;
        let sent = [plain, plain | 1 << 30];
        let commands = sent.into_iter().filter_map(|word| Command::in_mode(word, mode).ok());
        commands.into_iter().find(sets)
    }
}

impl ErrorWord {
    /// Data of error code Ch if a cam edge is beyond the measuring range.
    pub const CAM_BEYOND_RANGE: u32 = 4;

    /// Returns the meaning of the error in the words of the manual.
    pub const fn meaning(self) -> &'static str {
        match (self.code.get(), self.data.get()) {
            (1, _) => "wrong parameter data",
            (2, _) => "unknown parameter code",
            (3, _) => "parameters lost",
            (0xC, ErrorWord::CAM_BEYOND_RANGE) => "start or stop of a cam beyond the measuring range",
            (0xC, _) => "manufacturer's error",
            _ => "position or cam value not valid",
        }
    }

    /// Returns a remedy for the error. Most remedies are not from the manual (`U`).
    pub const fn remedy(self) -> &'static str {
        match (self.code.get(), self.data.get()) {
            (1, _) => "send a number within its limits, then run",
            (2, _) => "send a parameter that the encoder has, then run",
            (3, _) => "set all parameters anew, then run",
            (0xC, ErrorWord::CAM_BEYOND_RANGE) => "send an edge below the steps of the measuring range",
            (0xC, _) => "send run, and ask the maker where it comes back",
            _ => "send run, then normal running; take no position or cam output until then",
        }
    }
}
