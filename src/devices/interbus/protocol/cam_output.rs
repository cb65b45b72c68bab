//! IN word of a running cam program: eight outputs, and a window with 17 bits of the position (reference 5).

use super::value::Value;

/// IN word of an encoder in cam mode.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct CamOutput {
    /// Outputs in bits 7..0. Bit i is set while cam i is on.
    pub outputs: u8,
    /// Bits 24..8, the window: 17 bits of the position, starting with bit `shift_iw`.
    pub window: u32,
    /// Bits 30..25, which should be 0.
    pub stray: u8,
}

/// Error for a word that contains no cam outputs because its bit 31 is set.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("cam outputs are not valid in {word:08X}")]
pub struct CamOutputError {
    /// The rejected word. [`Reply`](super::Reply) may be able to parse it.
    pub word: u32,
}

/// Number of low position bits that are shifted out of the window, 0 to 25. The manual calls it `shift_iw`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct WindowShift(u8);

/// Meaning of a bit in the cam output word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum CamBit {
    /// Bit 31. If it is set, all other bits are invalid.
    Invalid,
    /// A bit that should be 0.
    Zero,
    /// The given bit of the position.
    Position(u8),
    /// Output of the given cam.
    Cam(u8),
}

const WINDOW_BITS: u32 = 17;
/// Number of output bits. The window starts above them.
const OUTPUT_BITS: u32 = 8;

impl WindowShift {
    /// Creates a window shift, or returns `None` if the number is above 25.
    pub const fn new(shift: u8) -> Option<Self> {
        if shift as u32 <= Value::BITS { Some(WindowShift(shift)) } else { None }
    }

    /// Returns the shift, 0 to 25.
    pub const fn get(self) -> u8 {
        self.0
    }

    /// Returns the mask of the position bits in the window. It is 0 for a shift of 25.
    pub const fn mask(self) -> u32 {
        (((1_u64 << WINDOW_BITS) - 1) << self.0) as u32 & Value::MAX.get()
    }
}

impl CamOutput {
    /// Returns the word that an encoder sends at a position with the given outputs.
    pub const fn at_position(position: Value, outputs: u8, shift: WindowShift) -> Self {
        let window = (position.get() & shift.mask()) >> shift.0;
        CamOutput { outputs, window, stray: 0 }
    }

    /// Parses a cam output word.
    ///
    /// # Errors
    /// Returns a [`CamOutputError`] if bit 31 is set.
    pub const fn parse(word: u32) -> Result<Self, CamOutputError> {
        if word >> 31 != 0 {
            return Err(CamOutputError { word });
        }
        Ok(CamOutput {
            outputs: word as u8,
            window: word >> OUTPUT_BITS & ((1 << WINDOW_BITS) - 1),
            stray: (word >> Value::BITS) as u8,
        })
    }

    /// Returns the word. Window and stray bits that do not fit into it are dropped.
    pub const fn emit(self) -> u32 {
        let window = self.window & ((1 << WINDOW_BITS) - 1);
        ((self.stray & 0x3F) as u32) << Value::BITS | window << OUTPUT_BITS | self.outputs as u32
    }

    /// Returns the position bits in the window, shifted back to their place in the position. See [`WindowShift::mask`].
    pub const fn position_bits(self, shift: WindowShift) -> u32 {
        ((self.window as u64) << shift.0) as u32 & shift.mask()
    }

    /// Returns the meaning of a bit, or `None` for bits above 31. Bit 0 is the lowest bit.
    pub const fn bit(bit: u8, shift: WindowShift) -> Option<CamBit> {
        Some(match bit {
            0..=7 => CamBit::Cam(bit),
            8..=24 if ((bit - 8 + shift.0) as u32) < Value::BITS => CamBit::Position(bit - 8 + shift.0),
            8..=30 => CamBit::Zero,
            31 => CamBit::Invalid,
            _ => return None,
        })
    }
}
