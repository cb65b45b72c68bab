//! Conversion between positions and the bits of a frame. [`super::explain`] provides the meaning of each bit.

mod check;
#[cfg(test)]
mod tests;

pub use check::{ClockUse, LayoutError, RepeatableElement, WordOperation};
#[cfg(test)]
pub(crate) use tests::layouts as any_layouts;

use super::code::{PositionCode, gray_to_binary, low_bits_mask, to_gray};
use super::descriptor::{FrameDescriptor, GrayCoverage};

/// A checked [`FrameDescriptor`] with its shifts and masks.
///
/// A *word* is a frame without its repetition, right-justified.
#[derive(Clone, Debug, PartialEq)]
pub struct Layout {
    pub(super) descriptor: FrameDescriptor,
    pub(super) coding: PositionCode,
    /// Upper and lower part of the code word.
    pub(super) parts: [BitSegment; 2],
    /// Whether the shift drops the lowest bit of the code word.
    pub(super) lost: bool,
    /// Number of bits in a word after the position area.
    pub(super) behind_area: u8,
    /// Number of bits that are Gray coded as a whole, and the number of bits after them. The first number is 0 if only
    /// the position is coded.
    pub(super) gray: (u8, u8),
    /// Mask of the bits in a word that are always 0.
    pub(super) zeros: u64,
    /// Mask of each error bit in a word.
    pub(super) errors: Vec<u64>,
    /// Mask of the error bits that are active at 0.
    pub(super) low: u64,
    /// Masks of the parity bit and of the bits before it, both in a word. Both masks are 0 if there is no parity bit.
    pub(super) parity: (u64, u64),
    pub(super) patterns: Vec<u64>,
    pub(super) invalid: Flags,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct BitSegment {
    /// Number of bits in the word that follow this part.
    pub(super) in_word: u8,
    /// Number of bits in the code word that follow this part.
    pub(super) in_code: u8,
    pub(super) mask: u64,
}

/// A decoded frame: its position and flags.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FrameReading {
    /// Position, or 0 if [`Flags::CODE`] is set and there is no position.
    pub position: u64,
    /// Error bits, patterns and inconsistencies in the frame.
    pub flags: Flags,
}

/// Flags of a frame in addition to its position: error bits, patterns and inconsistencies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Flags(pub(super) u32);

impl Flags {
    /// The empty set of flags.
    pub const NONE: Flags = Flags(0);
    /// The code word is invalid: a BCD digit is above 9, or a word is not part of the Gray excess code.
    pub const CODE: Flags = Flags(1 << 16);
    /// A bit that should be 0 is 1. The layout or the number of clocks is wrong, or the line is disturbed.
    pub const PADDING: Flags = Flags(1 << 17);
    /// The parity bit does not match the other bits.
    pub const PARITY: Flags = Flags(1 << 18);
    /// The repetition differs from the first transmission.
    pub const REPEAT: Flags = Flags(1 << 19);
    /// Every bit is 1.
    pub const ALL_ONES: Flags = Flags(1 << 20);
    /// Every bit is 0.
    pub const ALL_ZEROS: Flags = Flags(1 << 21);

    /// Returns the flag for the error bit with this index in the descriptor.
    pub const fn error(index: usize) -> Flags {
        if index < 8 { Flags(1 << index) } else { Flags::NONE }
    }

    /// Returns the flag for the pattern with this index in the descriptor.
    pub const fn pattern_flag(index: usize) -> Flags {
        if index < 4 { Flags(1 << (8 + index)) } else { Flags::NONE }
    }

    /// Returns whether all flags of `other` are set.
    pub const fn contains(self, other: Flags) -> bool {
        other.0 != 0 && self.0 & other.0 == other.0
    }

    /// Returns whether any flag of `other` is set.
    pub const fn intersects(self, other: Flags) -> bool {
        self.0 & other.0 != 0
    }

    /// Returns the union of both sets of flags.
    #[must_use]
    pub const fn union(self, other: Flags) -> Flags {
        Flags(self.0 | other.0)
    }

    #[must_use]
    const fn only_if(self, condition: bool) -> Flags {
        if condition { self } else { Flags::NONE }
    }
}

impl Default for Layout {
    fn default() -> Self {
        Layout {
            descriptor: FrameDescriptor::binary(0, 1),
            coding: PositionCode::BIT,
            parts: [BitSegment::default(), BitSegment { in_word: 0, in_code: 0, mask: 1 }],
            lost: false,
            behind_area: 0,
            gray: (0, 1),
            zeros: 0,
            errors: Vec::new(),
            low: 0,
            parity: (0, 0),
            patterns: Vec::new(),
            invalid: Flags::CODE.union(Flags::PARITY).union(Flags::REPEAT),
        }
    }
}

impl Layout {
    /// Creates the layout of a frame.
    ///
    /// # Errors
    /// Returns a [`LayoutError`] if the frame is invalid.
    pub fn new(descriptor: FrameDescriptor) -> Result<Self, LayoutError> {
        check::build_layout(descriptor)
    }

    /// Returns the description from which the layout was created.
    pub const fn descriptor(&self) -> &FrameDescriptor {
        &self.descriptor
    }

    /// Returns the code of the positions, or binary if a Gray code covers more than the position.
    pub const fn position_code(&self) -> &PositionCode {
        &self.coding
    }

    /// Returns the number of bits in a burst, 1 to 64.
    pub const fn clock_count(&self) -> u8 {
        self.descriptor.clocks
    }

    /// Returns whether the right shift drops the lowest bit of the position.
    pub const fn loses_lowest_bit(&self) -> bool {
        self.lost
    }

    /// Returns the flags that make a position invalid.
    pub const fn invalid_flags(&self) -> Flags {
        self.invalid
    }

    /// Returns the frame for a position, or `None` beyond the last position. The error bits in `flags` are active.
    ///
    /// The frame is right-justified: the bit of the first clock is the highest.
    pub fn encode(&self, position: u64, flags: Flags) -> Option<u64> {
        let code = self.coding.encode(position)?;
        let mut word =
            self.parts.iter().fold(0, |word, part| word | (code >> part.in_code & part.mask) << part.in_word);
        if self.descriptor.coded == GrayCoverage::Area {
            word = self.apply_to_gray_bits(word, to_gray);
        }
        if self.descriptor.shift_right {
            word = word >> self.behind_area >> 1 << self.behind_area;
        }
        for (index, bit) in self.errors.iter().enumerate() {
            word |= if flags.contains(Flags::error(index)) { *bit } else { 0 };
        }
        word ^= self.low;
        if self.descriptor.coded == GrayCoverage::AreaAndErrors {
            word = self.apply_to_gray_bits(word, to_gray);
        }
        let (bit, before) = self.parity;
        let even = (word & before).count_ones().is_multiple_of(2);
        word |= if even == self.has_even_parity() { 0 } else { bit };
        let frame = self.is_repeated(word);
        Some(if self.descriptor.inverted { !frame & low_bits_mask(self.clock_count()) } else { frame })
    }

    /// Decodes a frame. Bits above the number of clocks are ignored.
    #[inline]
    pub fn decode(&self, frame: u64) -> FrameReading {
        let all = low_bits_mask(self.clock_count());
        let frame = frame & all;
        let mut flags = Flags::ALL_ONES.only_if(frame == all).union(Flags::ALL_ZEROS.only_if(frame == 0));
        for (index, pattern) in self.patterns.iter().enumerate() {
            flags = flags.union(Flags::pattern_flag(index).only_if(*pattern == frame));
        }
        let frame = if self.descriptor.inverted { !frame & all } else { frame };
        let sent = frame >> (self.clock_count() - self.descriptor.clocks_per_word());
        if self.descriptor.repeat.is_some() {
            flags = flags.union(self.repetition_flags(frame, sent));
        }
        let (bit, before) = self.parity;
        let ones_in_all = (sent & (bit | before)).count_ones();
        flags = flags.union(Flags::PARITY.only_if(bit != 0 && ones_in_all.is_multiple_of(2) != self.has_even_parity()));

        let mut word = if self.descriptor.coded == GrayCoverage::AreaAndErrors {
            self.apply_to_gray_bits(sent, gray_to_binary)
        } else {
            sent
        };
        for (index, bit) in self.errors.iter().enumerate() {
            flags = flags.union(Flags::error(index).only_if((word ^ self.low) & bit != 0));
        }
        if self.descriptor.shift_right {
            let area = word >> self.behind_area;
            flags = flags.union(Flags::PADDING.only_if(area >> (self.descriptor.area - 1) != 0));
            let back = area << 1 & low_bits_mask(self.descriptor.area);
            word = word & low_bits_mask(self.behind_area) | back << self.behind_area;
        }
        if self.descriptor.coded == GrayCoverage::Area {
            word = self.apply_to_gray_bits(word, gray_to_binary);
            if self.descriptor.shift_right {
                word &= !(1 << self.behind_area);
            }
        }
        flags = flags.union(Flags::PADDING.only_if(word & self.zeros != 0));
        let code = self.parts.iter().fold(0, |code, part| code | (word >> part.in_word & part.mask) << part.in_code);
        match self.coding.decode(code) {
            Some(position) if self.lost => FrameReading { position: position & !1, flags },
            Some(position) => FrameReading { position, flags },
            None => FrameReading { position: 0, flags: flags.union(Flags::CODE) },
        }
    }

    /// Decodes frames in order until either slice ends.
    pub fn decode_all(&self, frames: &[u64], readings: &mut [FrameReading]) {
        for (frame, reading) in frames.iter().zip(readings) {
            *reading = self.decode(*frame);
        }
    }

    /// Applies `what` to the Gray-coded bits of a word.
    fn apply_to_gray_bits(&self, word: u64, what: impl Fn(u64) -> u64) -> u64 {
        let (bits, behind) = self.gray;
        what(word >> behind & low_bits_mask(bits)) << behind | word & !(low_bits_mask(bits) << behind)
    }

    fn has_even_parity(&self) -> bool {
        self.descriptor.parity.is_none_or(|parity| parity.even)
    }

    fn is_repeated(&self, word: u64) -> u64 {
        let first = word << (self.clock_count() - self.descriptor.clocks_per_word());
        first | self.descriptor.repeat.map_or(0, |repeat| first >> (repeat.word + repeat.gap))
    }

    /// Compares a word with its repetition, and returns the flags for the differences.
    fn repetition_flags(&self, frame: u64, word: u64) -> Flags {
        let differs = frame ^ self.is_repeated(word);
        let again = self.is_repeated(low_bits_mask(self.descriptor.clocks_per_word()));
        Flags::REPEAT.only_if(differs & again != 0).union(Flags::PADDING.only_if(differs & !again != 0))
    }
}
