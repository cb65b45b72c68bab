//! IN words of a K3 encoder (reference 2). The meaning of a position or value depends on the mode: see
//! [`CamOutput`](super::CamOutput) and [`ReadOutNumber::value`](super::ReadOutNumber::value).

use super::command::Command;
use super::mode::EncoderMode;
use super::value::{Code, Value};

/// Meaning of an IN word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Reply {
    /// Bit 31 is clear, and the encoder is running. The value is a position, a speed in velocity mode, or the cam
    /// output word in cam mode.
    Run {
        /// Bits 24..0.
        value: Value,
        /// Bits 30..25, which should be 0. Other values justify a warning.
        stray: u8,
    },
    /// Prefix 110 or 111, code 0: the encoder is processing a parameter. For cam 0, the word may be the echo.
    Busy {
        /// Bit 29.
        manufacturer: bool,
        /// Data of the word.
        data: Value,
    },
    /// Prefix 110 or 111: the command was received, but may not have been accepted yet.
    Echo {
        /// Bit 29.
        manufacturer: bool,
        /// Parameter code or cam number, which is never 0.
        code: Code,
        /// Data as sent.
        data: Value,
    },
    /// Prefix 101, code 0: value of a read-out.
    ReadOut(Value),
    /// Prefix 101, code 2: the read-out does not exist.
    UnknownReadOut(Value),
    /// Prefix 101 with a code that the manual does not define.
    Unknown {
        /// A code other than 0 and 2.
        code: Code,
        /// Bits 24..0.
        data: Value,
    },
    /// Prefix 100: error.
    Error(ErrorWord),
}

/// An error word, with prefix 100.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ErrorWord {
    /// Error code, bits 28..25.
    pub code: Code,
    /// Bits 24..0.
    pub data: Value,
}

const ERROR: u32 = 0b100 << 29;
const READ_OUT: u32 = 0b101 << 29;
const ECHO: u32 = 0b110 << 29;
const MANUFACTURER: u32 = 1 << 29;

impl Reply {
    /// Parses an IN word. Every word is valid.
    pub fn parse(word: u32) -> Self {
        let (code, data) = (Code::of_word(word), Value::of_word(word));
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

    /// Returns the word. Stray bits that do not fit are dropped.
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

    /// Returns the echo of a command, which is its word with bits 31 and 30 set and the data as sent (for cams `U`).
    /// Compare the complete word, since an older reply may have the same code (reference 4).
    pub fn echo_of(command: Command) -> Self {
        Reply::parse(command.emit() | ECHO)
    }

    /// Returns the echoed command, if a parameter or cam can be set in this mode.
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
    /// Manufacturer error for a cam edge beyond the measuring range, in `data` of code Ch.
    pub const CAM_BEYOND_RANGE: u32 = 4;

    /// Returns the meaning as worded in the manual.
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

    /// Returns the remedy, which is usually not in the manual (`U`).
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
