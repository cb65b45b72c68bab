//! Texts in exported files, as values that the window can translate. The command line uses the English texts below.

use std::fmt;

use crate::devices::ssi::protocol::code::Code;

/// A text in an exported file.
#[expect(missing_docs, reason = "its English, below, says what each is")]
#[derive(Clone, Debug, PartialEq)]
pub enum ExportText {
    /// Heading of the settings sheet.
    SheetTitle(String),
    /// Sentence on the purpose of the settings sheet.
    SheetPurpose,
    FrameLength,
    Bits(u8),
    Code,
    CodeName(Code),
    LowestBit,
    HighestBit,
    BitNumber(u8),
    ParityBit,
    Parity,
    ParityIs {
        even: bool,
    },
    NoParity,
    Monoflop,
    /// Minimum and maximum monoflop time in microseconds.
    MonoflopTimes {
        least: f64,
        most: f64,
    },
    HighestClock,
    ClockLimit {
        kilohertz: u32,
    },
    /// Remark on how the bits are numbered.
    Counting {
        first: u8,
    },
    /// The reason why no module can decode the frame.
    Obstacle(UnsupportedModuleFeature),
    /// Advice to read the frame as binary.
    ReadAsBinary,
    /// Label of the code type in the module TM PosInput.
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
    /// Width of a field in bits and its highest bit.
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
pub enum UnsupportedModuleFeature {
    GrayExcess,
    Bcd,
    /// Gray code that covers more than the position.
    GrayOver,
    /// Swapped data wires, which invert all bits.
    Inverted,
    /// Zeros between multiturn and singleturn.
    Between,
}

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

/// Function that converts an export text to a string in the language of the caller.
pub type TranslateFn<'a> = &'a dyn Fn(&ExportText) -> String;

/// Returns the English text, which the command line uses.
pub fn english_text(text: &ExportText) -> String {
    text.to_string()
}

impl fmt::Display for ExportText {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let fixed = match self {
            Self::SheetTitle(title) => return write!(f, "SSI settings: {title}"),
            Self::Bits(bits) => return write!(f, "{bits} bits"),
            Self::BitNumber(bit) => return write!(f, "bit {bit}"),
            Self::MonoflopTimes { least, most } => {
                return write!(f, "{least} to {most} µs (the pause must be longer than this)");
            }
            Self::ClockLimit { kilohertz } => return write!(f, "{kilohertz} kHz, less on long cables"),
            Self::Counting { first } => {
                return write!(f, "Bit 0 is the last bit received, and bit {first} is the first bit received.");
            }
            Self::FrameBits { bits, fits: true } => return write!(f, "{bits} bits"),
            Self::FrameBits { bits, fits: false } => return write!(f, "{bits} bits (the module supports 10 to 40)"),
            Self::HighestNumber { bit, fits: true } => return write!(f, "{bit}"),
            Self::HighestNumber { bit, fits: false } => {
                return write!(f, "{bit} (the module supports positions of up to 32 bits)");
            }
            Self::Setting(number, value) => return write!(f, "{number} ({value})"),
            Self::FrameTypeNone { bits } => {
                return write!(f, "none (the terminal reads at most 32 bits, but the frame has {bits})");
            }
            Self::Divide { by, bits } => {
                return write!(f, "divide the value by {by} (number of bits that follow: {bits})");
            }
            Self::Field { bits: 1, highest } => return write!(f, "1 bit at b{highest}"),
            Self::Field { bits, highest } => return write!(f, "{bits} bits from b{highest}"),
            Self::BurstSpan { clocks, micros } => return write!(f, "{clocks} clocks, {micros:.2} µs"),
            Self::PauseSpan { micros, monoflop_micros } => {
                return write!(f, "pause {micros:.1} µs, tm up to {monoflop_micros:.0} µs");
            }
            Self::SheetPurpose => "This sheet lists the settings for the control. It does not program the encoder.",
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
            Self::Obstacle(UnsupportedModuleFeature::GrayExcess) => {
                "The modules support binary and Gray code but not Gray excess. If the value is read as Gray code, it is \
                 too high by a constant amount."
            }
            Self::Obstacle(UnsupportedModuleFeature::Bcd) => "The modules support binary and Gray code but not BCD.",
            Self::Obstacle(UnsupportedModuleFeature::GrayOver) => {
                "The Gray code covers more bits than the position, but the modules convert only the position."
            }
            Self::Obstacle(UnsupportedModuleFeature::Inverted) => {
                "The data wires are swapped. Connect them the other way round."
            }
            Self::Obstacle(UnsupportedModuleFeature::Between) => {
                "There is a gap between the turn bits and the step bits, but most modules can read only a position \
                 without gaps."
            }
            Self::ReadAsBinary => "Read the whole frame as binary, and decode it in the PLC program.",
            Self::CodeType => "Code type",
            Self::BitNumberLowest => "Bit number LSB of the position",
            Self::BitNumberHighest => "Bit number MSB of the position",
            Self::LastIsError => "1 (the last bit is an error bit)",
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
