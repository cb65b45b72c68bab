//! Single-cycle data, which an encoder sends in every cycle. A frame contains the multiturn and singleturn position, an
//! error bit, a warning bit and a checksum, most significant bit first. The error and warning bits are active low. The
//! field widths depend on the encoder. See manual 3.1.1, figure 2.

use super::crc::{Crc, CrcError};

/// The bits of a frame after the start and control bits.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Layout {
    multiturn_bits: u8,
    singleturn_bits: u8,
    error_bit: bool,
    warning_bit: bool,
    crc: Option<Crc>,
}

/// Reason why a layout is invalid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LayoutError {
    /// The field is wider than 32 bits.
    #[error("{field} must have at most 32 bits, not {bits}")]
    Field {
        /// Name of the field: `multiturn` or `singleturn`.
        field: &'static str,
        /// Requested width in bits.
        bits: u8,
    },
    /// The layout contains no position bits.
    #[error("multiturn and singleturn together must have at least one bit")]
    Empty,
    /// The frame, including the checksum, is longer than 64 bits.
    #[error("the frame including its CRC must have at most 64 bits, not {0}")]
    Long(u32),
    /// The CRC parameters are invalid.
    #[error(transparent)]
    Crc(#[from] CrcError),
}

/// The content of a frame with a valid checksum.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PositionData {
    /// Revolution count, as wide as the layout's multiturn field.
    pub multiturn: u32,
    /// Position within the revolution, in steps. The number of steps per revolution is 2 to the power of the layout's
    /// singleturn bits.
    pub singleturn: u32,
    /// Whether the encoder reports that the position is invalid. If so, the bit on the line is 0.
    pub error: bool,
    /// Whether the encoder reports a warning. If so, the bit on the line is 0, but the position remains valid.
    pub warning: bool,
}

/// Reason why received bits are not a valid frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FrameError {
    /// All bits are 0, which is not a valid frame in this layout. There is no encoder, the line is short-circuited, or
    /// the encoder is not ready.
    #[error("the data line stays low")]
    StuckLow,
    /// All bits are 1, which is not a valid frame in this layout. There is no encoder or a wire is broken.
    #[error("the data line stays high")]
    StuckHigh,
    /// Bits beyond the length of the frame are set.
    #[error("the frame has more than {bits} bits")]
    Long {
        /// Frame length of the layout, in bits.
        bits: u8,
    },
    /// The checksum does not match.
    #[error("CRC {got:02X} instead of {expected:02X}")]
    Crc {
        /// Checksum calculated from the other bits.
        expected: u32,
        /// Checksum received.
        got: u32,
    },
}

impl Layout {
    /// Creates a layout with the given field widths. The position is followed by the error bit and then the
    /// warning bit.
    ///
    /// # Errors
    /// Returns a [`LayoutError`] if a field is wider than 32 bits, the frame is longer than 64 bits, or the layout is
    /// otherwise invalid.
    pub fn new(
        multiturn_bits: u8,
        singleturn_bits: u8,
        error_bit: bool,
        warning_bit: bool,
        crc: Option<Crc>,
    ) -> Result<Self, LayoutError> {
        for (field, bits) in [("multiturn", multiturn_bits), ("singleturn", singleturn_bits)] {
            if bits > 32 {
                return Err(LayoutError::Field { field, bits });
            }
        }
        let layout = Layout { multiturn_bits, singleturn_bits, error_bit, warning_bit, crc };
        if multiturn_bits == 0 && singleturn_bits == 0 {
            return Err(LayoutError::Empty);
        }
        let bits = u32::from(layout.data_bits()) + u32::from(layout.crc_bits());
        if bits > 64 { Err(LayoutError::Long(bits)) } else { Ok(layout) }
    }

    /// Returns the width of the multiturn field, 0 to 32 bits.
    pub const fn multiturn_bits(&self) -> u8 {
        self.multiturn_bits
    }

    /// Returns the width of the singleturn field, 0 to 32 bits.
    pub const fn singleturn_bits(&self) -> u8 {
        self.singleturn_bits
    }

    /// Returns whether frames contain an error bit.
    pub const fn has_error_bit(&self) -> bool {
        self.error_bit
    }

    /// Returns whether frames contain a warning bit.
    pub const fn has_warning_bit(&self) -> bool {
        self.warning_bit
    }

    /// Returns the checksum parameters, or `None` if the encoder sends no checksum.
    pub const fn crc(&self) -> Option<&Crc> {
        self.crc.as_ref()
    }

    /// Returns the combined width of position, error and warning bits, without the checksum.
    pub const fn data_bits(&self) -> u8 {
        self.multiturn_bits + self.singleturn_bits + self.error_bit as u8 + self.warning_bit as u8
    }

    /// Returns the width of the checksum in bits.
    pub fn crc_bits(&self) -> u8 {
        self.crc.as_ref().map_or(0, Crc::width)
    }

    /// Returns the length of the frame including the checksum, 1 to 64 bits.
    pub fn bits(&self) -> u8 {
        self.data_bits() + self.crc_bits()
    }

    /// Parses a right-justified frame. Bit 0 is the last bit received.
    ///
    /// # Errors
    /// Returns a [`FrameError`] if the bits are not a valid frame. It distinguishes a stuck line from a wrong checksum.
    pub fn parse(&self, raw: u64) -> Result<PositionData, FrameError> {
        let whole = low_bits_mask(self.bits());
        if raw & !whole != 0 {
            return Err(FrameError::Long { bits: self.bits() });
        }
        let data = raw.checked_shr(self.crc_bits().into()).unwrap_or(0);
        let sums = self.crc.as_ref().map(|crc| {
            let got = (raw & low_bits_mask(crc.width())) as u32;
            (crc.compute(data, self.data_bits()), got)
        });
        let moves = raw != 0 && raw != whole;
        match sums {
            Some((expected, got)) if expected == got => Ok(self.fields(data)),
            None if moves => Ok(self.fields(data)),
            _ if raw == 0 => Err(FrameError::StuckLow),
            Some((expected, got)) if moves => Err(FrameError::Crc { expected, got }),
            _ => Err(FrameError::StuckHigh),
        }
    }

    /// Returns the right-justified frame for a reading. Bits that do not fit the layout are dropped.
    pub fn emit(&self, reading: &PositionData) -> u64 {
        let mut data = u64::from(reading.multiturn) & low_bits_mask(self.multiturn_bits);
        data = data << self.singleturn_bits | u64::from(reading.singleturn) & low_bits_mask(self.singleturn_bits);
        if self.error_bit {
            data = data << 1 | u64::from(!reading.error);
        }
        if self.warning_bit {
            data = data << 1 | u64::from(!reading.warning);
        }
        match &self.crc {
            None => data,
            Some(crc) => data << crc.width() | u64::from(crc.compute(data, self.data_bits())),
        }
    }

    /// Returns the angle within the revolution in degrees, at least 0 and less than 360.
    pub fn position_to_degrees(&self, reading: &PositionData) -> f64 {
        f64::from(reading.singleturn) * 360.0 / (1u64 << self.singleturn_bits) as f64
    }

    /// Returns the multiturn and singleturn position as a single number of steps.
    pub fn position_to_steps(&self, reading: &PositionData) -> u64 {
        u64::from(reading.multiturn) << self.singleturn_bits | u64::from(reading.singleturn)
    }

    fn fields(&self, data: u64) -> PositionData {
        let mut rest = data;
        let mut take = |bits: u8| {
            let field = rest & low_bits_mask(bits);
            rest = rest.checked_shr(bits.into()).unwrap_or(0);
            field
        };
        let warning = self.warning_bit && take(1) == 0;
        let error = self.error_bit && take(1) == 0;
        // Fields are at most 32 bits wide.
        let singleturn = take(self.singleturn_bits) as u32;
        let multiturn = take(self.multiturn_bits) as u32;
        PositionData { multiturn, singleturn, error, warning }
    }
}

impl Default for Layout {
    /// Returns the layout of the kit encoder: 16 multiturn bits, 17 singleturn bits, error bit, warning bit and
    /// inverted CRC6 43h.
    fn default() -> Self {
        let crc = Crc::new(Crc::POSITION, 0, true).ok();
        Layout { multiturn_bits: 16, singleturn_bits: 17, error_bit: true, warning_bit: true, crc }
    }
}

/// Returns a mask of the lowest `bits` bits, 0 to 64.
const fn low_bits_mask(bits: u8) -> u64 {
    match bits {
        0 => 0,
        1..=63 => (1 << bits) - 1,
        _ => u64::MAX,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn reading(multiturn: u32, singleturn: u32, error: bool, warning: bool) -> PositionData {
        PositionData { multiturn, singleturn, error, warning }
    }

    /// Frames of 41 bits from the table in section 2 of the reference.
    #[test]
    fn published_frames_match() {
        let cases = [
            (0x0000, 0x00000, false, false, 0x000_0000_00FA),
            (0x0000, 0x00000, true, false, 0x000_0000_007C),
            (0x0000, 0x00000, false, true, 0x000_0000_00B9),
            (0x0000, 0x00001, false, false, 0x000_0000_01F6),
            (0x0001, 0x00000, false, false, 0x000_0200_00D8),
            (0x0000, 0x18000, false, false, 0x000_0180_00C2),
            (0x1234, 0x18000, false, false, 0x024_6980_00CF),
            (0x00FF, 0x0ABCD, false, false, 0x001_FEAB_CDF0),
            (0xA5A5, 0x15555, true, true, 0x14B_4B55_552D),
            (0xFFFF, 0x1FFFF, false, false, 0x1FF_FFFF_FFF5),
        ];
        let layout = Layout::default();
        assert_eq!((layout.data_bits(), layout.bits()), (35, 41));
        for (multiturn, singleturn, error, warning, raw) in cases {
            let reading = reading(multiturn, singleturn, error, warning);
            assert_eq!(layout.parse(raw), Ok(reading), "{raw:011X}");
            assert_eq!(layout.emit(&reading), raw, "{raw:011X}");
        }
    }

    /// Flips each bit of the frame 024698000CF from section 7 of the reference.
    #[test]
    fn detects_every_flipped_bit() {
        let layout = Layout::default();
        for bit in 0..41 {
            let damaged = 0x024_6980_00CF ^ 1 << bit;
            assert!(matches!(layout.parse(damaged), Err(FrameError::Crc { .. })), "bit {bit}");
        }
        // A CRC6 also detects any two flipped bits in frames of up to 63 bits.
        for (one, other) in (0..41).flat_map(|one| (0..one).map(move |other| (one, other))) {
            assert!(layout.parse(0x024_6980_00CF ^ 1 << one ^ 1 << other).is_err(), "bits {one}, {other}");
        }
    }

    #[test]
    fn distinguishes_stuck_line_from_wrong_crc() {
        let layout = Layout::default();
        assert_eq!(layout.parse(0), Err(FrameError::StuckLow));
        assert_eq!(layout.parse((1 << 41) - 1), Err(FrameError::StuckHigh));
        assert_eq!(layout.parse(1 << 41), Err(FrameError::Long { bits: 41 }));
        assert_eq!(layout.parse(0x0FB), Err(FrameError::Crc { expected: 0x3A, got: 0x3B }));
        // With a checksum that is not inverted, all zeros is a valid frame and must be accepted as one.
        let plain = Layout::new(0, 12, false, false, Crc::new(0x43, 0, false).ok()).unwrap();
        assert_eq!(plain.parse(0), Ok(PositionData::default()));
        let bare = Layout::new(0, 12, false, false, None).unwrap();
        assert_eq!(bare.parse(0), Err(FrameError::StuckLow));
        assert_eq!(bare.parse(0xFFF), Err(FrameError::StuckHigh));
        assert_eq!(bare.parse(0x800), Ok(reading(0, 0x800, false, false)));
    }

    #[test]
    fn angle_is_fraction_of_turn() {
        let layout = Layout::default();
        for (singleturn, degrees) in [(0, 0.0), (0x8000, 90.0), (0x10000, 180.0), (0x18000, 270.0)] {
            assert_eq!(layout.position_to_degrees(&reading(7, singleturn, false, false)), degrees);
        }
        assert_eq!(layout.position_to_steps(&reading(1, 2, false, false)), 0x2_0002);
    }

    #[test]
    fn rejects_wrong_widths() {
        let crc = || Crc::new(Crc::POSITION, 0, true).ok();
        assert_eq!(Layout::new(33, 1, true, true, crc()), Err(LayoutError::Field { field: "multiturn", bits: 33 }));
        assert_eq!(Layout::new(1, 255, true, true, crc()), Err(LayoutError::Field { field: "singleturn", bits: 255 }));
        assert_eq!(Layout::new(0, 0, true, true, crc()), Err(LayoutError::Empty));
        assert_eq!(Layout::new(32, 32, false, false, crc()), Err(LayoutError::Long(70)));
        assert_eq!(Layout::new(32, 32, false, false, None).unwrap().bits(), 64);
        assert_eq!(Layout::new(24, 32, true, true, crc()).unwrap().bits(), 64);
    }

    proptest! {
        #[test]
        fn layouts_round_trip(
            multiturn_bits in 0u8..=32, singleturn_bits in 0u8..=32, error_bit: bool, warning_bit: bool,
            start in 0u32..64, inverted: bool, multiturn: u32, singleturn: u32, error: bool, warning: bool, bit in 0u32..64,
        ) {
            let crc = Crc::new(Crc::POSITION, start, inverted).ok();
            let Ok(layout) = Layout::new(multiturn_bits, singleturn_bits, error_bit, warning_bit, crc) else {
                return Ok(());
            };
            let fit = |value: u32, bits: u8| (u64::from(value) & ((1u64 << bits) - 1)) as u32;
            let reading = PositionData {
                multiturn: fit(multiturn, multiturn_bits),
                singleturn: fit(singleturn, singleturn_bits),
                error: error && error_bit,
                warning: warning && warning_bit,
            };
            let raw = layout.emit(&reading);
            prop_assert_eq!(layout.parse(raw), Ok(reading));
            prop_assert!(layout.parse(raw ^ 1 << (bit % u32::from(layout.bits()))).is_err());
        }

        #[test]
        fn arbitrary_bits_never_panic(raw: u64) {
            if let Ok(reading) = Layout::default().parse(raw) {
                prop_assert_eq!(Layout::default().emit(&reading), raw);
            }
        }
    }
}
