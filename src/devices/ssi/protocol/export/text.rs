//! Text of the exports, represented as facts so that the window can use its language. The command line uses the English
//! texts below.

use std::fmt;

use crate::devices::ssi::protocol::code::Code;

/// A piece of text in an export.
#[expect(missing_docs, reason = "its English, below, says what each is")]
#[derive(Clone, Debug, PartialEq)]
pub enum ExportText {
    /// Heading of the settings sheet.
    SheetTitle(String),
    /// Purpose of the settings sheet.
    SheetPurpose,
    FrameLength,
    /// Number of bits.
    Bits(u8),
    Code,
    CodeName(Code),
    LowestBit,
    HighestBit,
    /// Number of a bit.
    BitNumber(u8),
    /// Name of the parity bit.
    ParityBit,
    Parity,
    ParityIs {
        even: bool,
    },
    NoParity,
    Monoflop,
    /// Monoflop times in microseconds.
    MonoflopTimes {
        least: f64,
        most: f64,
    },
    HighestClock,
    ClockLimit {
        kilohertz: u32,
    },
    /// Numbering of bits.
    Counting {
        first: u8,
    },
    /// The reason why no module can decode the frame.
    Obstacle(ModuleObstacle),
    /// Advice to read the frame as binary.
    ReadAsBinary,
    /// Code type of TM PosInput.
    CodeType,
    FrameBits {
        bits: u8,
        fits: bool,
    },
    BitNumberLowest,
    BitNumberHighest,
    HighestNumber {
        bit: u8,
        fits: bool,
    },
    /// Value of a setting with its meaning.
    Setting(u8, SettingMeaning),
    FrameTypeNone {
        bits: u8,
    },
    LastIsError,
    InTheProgram,
    Divide {
        by: u64,
        bits: u8,
    },
    /// Width of a field and its first bit.
    Field {
        bits: u8,
        highest: u8,
    },
    NoField,
    Binary,
    /// Heading of the clock table.
    TableHeading,
    /// Label of the clock line in the timing diagram.
    ClockLine,
    DataLine,
    BurstSpan {
        clocks: u8,
        micros: f64,
    },
    PauseSpan {
        micros: f64,
        monoflop_micros: f64,
    },
}

/// The reason why no module can decode a frame.
#[expect(missing_docs, reason = "its English, below, says what each is")]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ModuleObstacle {
    GrayExcess,
    Bcd,
    /// Gray code over more than the position.
    GrayOver,
    /// Swapped data wires.
    Inverted,
    /// Zeros between the multiturn and the singleturn part.
    Between,
}

/// Meaning of a setting's value.
#[expect(missing_docs, reason = "its English, below, says what each is")]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SettingMeaning {
    Gray,
    Binary,
    Multiturn,
    Singleturn,
    Variable(u8),
    NoParity,
    Even,
    Odd,
}

/// Function that converts a text to a string in the caller's language.
pub type Say<'a> = &'a dyn Fn(&ExportText) -> String;

/// Returns the English string, used by the command line.
pub fn english(text: &ExportText) -> String {
    text.to_string()
}

impl fmt::Display for ExportText {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let fixed = match self {
            Self::SheetTitle(title) => return write!(f, "SSI settings: {title}"),
            Self::Bits(bits) => return write!(f, "{bits} bits"),
            Self::BitNumber(bit) => return write!(f, "bit {bit}"),
            Self::MonoflopTimes { least, most } => return write!(f, "{least} to {most} µs; the pause must be longer"),
            Self::ClockLimit { kilohertz } => return write!(f, "{kilohertz} kHz, less on long cables"),
            Self::Counting { first } => return write!(f, "Bit 0 is the last bit received, bit {first} the first."),
            Self::FrameBits { bits, fits: true } => return write!(f, "{bits} bit"),
            Self::FrameBits { bits, fits: false } => return write!(f, "{bits} bit (the module takes 10 to 40)"),
            Self::HighestNumber { bit, fits: true } => return write!(f, "{bit}"),
            Self::HighestNumber { bit, fits: false } => {
                return write!(f, "{bit} (more than 32 bits apart: the module takes 32)");
            }
            Self::Setting(number, value) => return write!(f, "{number} ({value})"),
            Self::FrameTypeNone { bits } => {
                return write!(f, "none: the terminal reads up to 32 bits, not {bits}");
            }
            Self::Divide { by, bits } => return write!(f, "divide the value by {by} ({bits} bits follow)"),
            Self::Field { bits: 1, highest } => return write!(f, "1 bit at b{highest}"),
            Self::Field { bits, highest } => return write!(f, "{bits} bits from b{highest}"),
            Self::BurstSpan { clocks, micros } => return write!(f, "{clocks} clocks, {micros:.2} µs"),
            Self::PauseSpan { micros, monoflop_micros } => {
                return write!(f, "pause {micros:.1} µs, tm up to {monoflop_micros:.0} µs");
            }
            Self::SheetPurpose => "This sheet is for the control. It does not program the encoder.",
            Self::FrameLength => "Frame length",
            Self::Code => "Code",
            Self::CodeName(Code::Binary) => "binary (dual)",
            Self::CodeName(Code::Gray) => "Gray",
            Self::CodeName(Code::GrayExcess) => "Gray excess",
            Self::CodeName(Code::Bcd) => "BCD",
            Self::LowestBit => "Position, lowest bit (LSB)",
            Self::HighestBit => "Position, highest bit (MSB)",
            Self::ParityBit => "parity",
            Self::Parity => "Parity",
            Self::ParityIs { even: true } => "even",
            Self::ParityIs { even: false } => "odd",
            Self::NoParity => "none",
            Self::Monoflop => "Monoflop time (tm)",
            Self::HighestClock => "Highest clock",
            Self::Obstacle(ModuleObstacle::GrayExcess) => {
                "Gray excess: modules know binary and Gray; as Gray the value is too high by a fixed number."
            }
            Self::Obstacle(ModuleObstacle::Bcd) => "BCD: modules know binary and Gray.",
            Self::Obstacle(ModuleObstacle::GrayOver) => {
                "The Gray code goes over more than the position; modules convert the position alone."
            }
            Self::Obstacle(ModuleObstacle::Inverted) => "The data wires are exchanged: exchange them again.",
            Self::Obstacle(ModuleObstacle::Between) => {
                "Turns and steps are apart; most modules read one position without a gap."
            }
            Self::ReadAsBinary => "Read the whole frame as binary, and decode it in the program.",
            Self::CodeType => "Code type",
            Self::BitNumberLowest => "Bit number LSB of the position",
            Self::BitNumberHighest => "Bit number MSB of the position",
            Self::LastIsError => "1: the last bit is an error bit",
            Self::InTheProgram => "In the program",
            Self::NoField => "0 bits",
            Self::Binary => "binary",
            Self::TableHeading => "clock,frame_bit,meaning",
            Self::ClockLine => "clock",
            Self::DataLine => "data",
        };
        f.write_str(fixed)
    }
}

impl fmt::Display for SettingMeaning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            SettingMeaning::Gray => f.write_str("Gray"),
            SettingMeaning::Binary => f.write_str("binary"),
            SettingMeaning::Multiturn => f.write_str("multiturn, 25 bits"),
            SettingMeaning::Singleturn => f.write_str("singleturn, 13 bits"),
            SettingMeaning::Variable(bits) => write!(f, "variable, {bits} bits"),
            SettingMeaning::NoParity => f.write_str("none"),
            SettingMeaning::Even => f.write_str("even"),
            SettingMeaning::Odd => f.write_str("odd"),
        }
    }
}
