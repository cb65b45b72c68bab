//! A frame as designed: the content of each clock. Any frame can be described here; [`super::Layout`] checks whether it is
//! possible.

use serde::Deserialize;

use super::code::Code;
use super::range::Range;

/// A frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Descriptor {
    /// Bits that the host clocks in, 1…64.
    pub clocks: u8,
    /// The range of positions.
    pub range: Range,
    /// Their code.
    pub code: Code,
    /// The coded bits.
    pub coded: Coded,
    /// Clocks 1…`area` belong to the position and the zeros around it. Shifting right shifts these.
    pub area: u8,
    /// Zeros between multiturn and singleturn, if the range has bits for each.
    pub lead: u8,
    /// Zeros between multiturn and singleturn, where the range has bits for each.
    pub between: u8,
    /// The area begins one clock later: a zero first, its last bit lost (SICK SSI description 3.4, SSI-SHIFT-RIGHT).
    pub shift_right: bool,
    /// Error and warning bits, at most 8.
    pub errors: Vec<ErrorBit>,
    /// A parity bit.
    pub parity: Option<Parity>,
    /// The same bits once more.
    pub repeat: Option<Repeat>,
    /// Whether the data wires are exchanged: every bit is inverted.
    pub inverted: bool,
    /// Words with another meaning than a position, at most 4; tested before anything is decoded.
    pub patterns: Vec<Pattern>,
}

/// The bits that a Gray code covers; binary and BCD cover only the position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coded {
    /// The position's bits; zeros and error bits are outside the code word.
    Position,
    /// The whole area, zeros included (reference section 2: the other reading of the manual, `U`).
    Area,
    /// The whole area and the error bits after it (known from sensors that number them among the data).
    AreaAndErrors,
}

/// A bit that is no position.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ErrorBit {
    /// Name in its manual.
    pub name: String,
    /// The clock, counted from 1.
    pub clock: u8,
    /// Its meaning for the position.
    pub meaning: Meaning,
    /// Whether it is active at 0.
    #[serde(default)]
    pub active_low: bool,
    /// Whether a transfer clears it: it is about the time since the last one.
    #[serde(default)]
    pub cleared_by_transfer: bool,
}

/// The meaning of a bit or word, other than a position, for the position.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Meaning {
    /// The position is invalid.
    Invalid,
    /// The position is valid, with a warning.
    Warning,
}

/// A bit over those before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Parity {
    /// The clock, counted from 1; it covers all clocks before it.
    pub clock: u8,
    /// The ones are even in number, the parity bit among them.
    pub even: bool,
}

/// The frame twice in one burst of clocks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Repeat {
    /// Clocks of the first one.
    pub word: u8,
    /// Zeros between the two, usually one.
    pub gap: u8,
}

/// A word with its own meaning.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Pattern {
    /// Its name.
    pub name: String,
    /// The bits of a whole frame, as sent.
    pub word: Word,
    /// Its meaning for the position.
    pub meaning: Meaning,
}

/// The bits of a whole frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Word {
    /// Ones alone.
    Ones,
    /// Just these.
    Bits(u64),
}

impl Descriptor {
    /// Returns only the position's bits, of this number of turns and steps, in binary.
    pub const fn plain(multiturn: u8, singleturn: u8) -> Self {
        let bits = multiturn + singleturn;
        Descriptor {
            clocks: bits,
            range: Range::Bits { multiturn, singleturn },
            code: Code::Binary,
            coded: Coded::Position,
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

    /// Returns the clocks of one frame, without its repetition.
    pub fn word(&self) -> u8 {
        self.repeat.map_or(self.clocks, |repeat| repeat.word)
    }
}
