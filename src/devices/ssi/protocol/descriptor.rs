//! Description of a frame: what each clock transmits. A description may be contradictory until [`super::Layout`] has
//! checked it.

use serde::Deserialize;

use super::code::Code;
use super::range::Range;

/// Description of an SSI frame: the position, the bits around it, and their order.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameDescriptor {
    /// Number of bits that the host clocks in, 1 to 64.
    pub clocks: u8,
    /// Range of positions.
    pub range: Range,
    /// Code of the position.
    pub code: Code,
    /// Bits that a Gray code covers.
    pub coded: GrayCoverage,
    /// Number of clocks at the start of the frame that transmit the position and the zeros around it. A right shift
    /// moves only these bits.
    pub area: u8,
    /// Number of zeros before the position.
    pub lead: u8,
    /// Number of zeros between multiturn and singleturn. The number must be 0 if the range has no separate bits for
    /// turns and steps.
    pub between: u8,
    /// Whether the area is delayed by one clock. A zero is sent before it, and its last bit is lost. See SICK SSI
    /// description 3.4, SSI-SHIFT-RIGHT.
    pub shift_right: bool,
    /// Error and warning bits, at most 8.
    pub errors: Vec<ErrorBit>,
    /// Parity bit, if any.
    pub parity: Option<Parity>,
    /// Repetition of the frame, if any.
    pub repeat: Option<Repeat>,
    /// Whether the data wires are swapped, which inverts every bit.
    pub inverted: bool,
    /// Words with a meaning other than a position, at most 4. They are tested before decoding.
    pub patterns: Vec<Pattern>,
}

/// Bits that a Gray code covers. Binary and BCD codes cover only the position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GrayCoverage {
    /// The position bits only, without zeros and error bits.
    Position,
    /// The whole area including zeros. The manual can also be understood this way. See reference section 2, `U`.
    Area,
    /// The whole area and the error bits after it, for sensors that treat error bits as data.
    AreaAndErrors,
}

/// A bit that is not part of the position.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ErrorBit {
    /// Name of the bit in the manual of the encoder.
    pub name: String,
    /// Clock number, starting at 1.
    pub clock: u8,
    /// Effect of the active bit on the position.
    pub meaning: BitMeaning,
    /// Whether the bit is active at 0.
    #[serde(default)]
    pub active_low: bool,
    /// Whether each transfer clears the bit. Such a bit reports events since the previous transfer.
    #[serde(default)]
    pub cleared_by_transfer: bool,
}

/// Effect of an error bit or a pattern on the position.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BitMeaning {
    /// The position is invalid and must not be used.
    Invalid,
    /// The position is valid, but the device reports a warning.
    Warning,
}

/// A parity bit over all preceding bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Parity {
    /// Clock number of the parity bit, starting at 1.
    pub clock: u8,
    /// Whether the parity is even rather than odd.
    pub even: bool,
}

/// Repetition of the frame within one clock burst.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Repeat {
    /// Number of clocks in the first transmission of the frame.
    pub word: u8,
    /// Number of zeros between the two transmissions, usually one.
    pub gap: u8,
}

/// A word that has a special meaning and is not a position.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Pattern {
    /// Name of the word, such as `overspeed or gap`.
    pub name: String,
    /// Bits of the complete frame as transmitted.
    pub word: Word,
    /// Effect of the word on the position.
    pub meaning: BitMeaning,
}

/// The bits of a complete frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Word {
    /// Every bit is 1.
    Ones,
    /// The bits have exactly these values.
    Bits(u64),
}

impl FrameDescriptor {
    /// Creates a frame that contains only binary multiturn and singleturn bits.
    pub const fn binary(multiturn: u8, singleturn: u8) -> Self {
        let bits = multiturn + singleturn;
        FrameDescriptor {
            clocks: bits,
            range: Range::Bits { multiturn, singleturn },
            code: Code::Binary,
            coded: GrayCoverage::Position,
            area: bits,
            lead: 0,
            between: 0,
            shift_right: false,
            errors: Vec::new(),
            parity: None,
            repeat: None,
            inverted: false,
            patterns: Vec::new(),
        }
    }

    /// Returns the number of clocks in one frame without its repetition.
    pub fn clocks_per_word(&self) -> u8 {
        self.repeat.map_or(self.clocks, |repeat| repeat.word)
    }
}
