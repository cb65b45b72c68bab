//! Newtypes for quantities that could be confused, have a limited range, or support arithmetic. This module never reads
//! a clock: the caller supplies each [`Moment`].

use std::fmt;
use std::ops::{Add, Sub};
use std::time::Duration;

use crate::parameter::Keywords;

/// A point in time since the start of a clock. Moments of different clocks cannot be compared.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Moment(Duration);

impl Moment {
    pub const START: Moment = Moment(Duration::ZERO);

    pub const fn from_elapsed(elapsed: Duration) -> Self {
        Moment(elapsed)
    }

    pub const fn since_start(self) -> Duration {
        self.0
    }

    /// Returns the time elapsed since `earlier`. Returns zero if `earlier` is later.
    pub fn duration_since(self, earlier: Moment) -> Duration {
        self.0.saturating_sub(earlier.0)
    }
}

impl Add<Duration> for Moment {
    type Output = Moment;
    fn add(self, duration: Duration) -> Moment {
        Moment(self.0.saturating_add(duration))
    }
}

impl Sub<Duration> for Moment {
    type Output = Moment;
    fn sub(self, duration: Duration) -> Moment {
        Moment(self.0.saturating_sub(duration))
    }
}

/// Serial line speed in bit/s. It is never zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Baud(u32);

impl Baud {
    /// Creates a speed from a number of bit/s. Returns `None` for zero.
    pub const fn new(bits_per_second: u32) -> Option<Self> {
        if bits_per_second == 0 { None } else { Some(Baud(bits_per_second)) }
    }

    /// 9600 bit/s, the factory setting of HIPERFACE encoders.
    pub const B9600: Baud = Baud(9_600);
    pub const B115200: Baud = Baud(115_200);

    pub const fn bits_per_second(self) -> u32 {
        self.0
    }

    /// Returns the time it takes to send the given number of bits.
    pub fn duration_of_bits(self, bits: u64) -> Duration {
        Duration::from_nanos(bits.saturating_mul(1_000_000_000) / u64::from(self.0))
    }
}

impl fmt::Display for Baud {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Parity {
    None,
    /// Even parity. The number of ones, including the parity bit, is even.
    Even,
    /// Odd parity. The number of ones, including the parity bit, is odd.
    Odd,
}

impl Parity {
    pub const ALL: [Parity; 3] = [Parity::Even, Parity::None, Parity::Odd];

    /// Parity names used in link URLs and JSON.
    pub const KEYWORDS: Keywords<Parity> =
        Keywords(&[("none", Parity::None), ("even", Parity::Even), ("odd", Parity::Odd)]);

    /// Returns the name used in link URLs and JSON.
    pub const fn keyword(self) -> &'static str {
        match self {
            Parity::None => "none",
            Parity::Even => "even",
            Parity::Odd => "odd",
        }
    }

    /// Returns the letter between the numbers of data bits and stop bits, such as the E in `8E1`.
    pub const fn parity_letter(self) -> char {
        match self {
            Parity::None => 'N',
            Parity::Even => 'E',
            Parity::Odd => 'O',
        }
    }
}

impl fmt::Display for Parity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.keyword())
    }
}

/// Character format of a serial line. Both ends must use the same format. A character has one start bit, eight data
/// bits and one stop bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct CharacterFormat {
    pub baud: Baud,
    pub parity: Parity,
}

impl CharacterFormat {
    /// The factory setting of HIPERFACE encoders: 9600 bit/s with even parity.
    pub const FACTORY: CharacterFormat = CharacterFormat { baud: Baud::B9600, parity: Parity::Even };

    /// Returns the duration of one character on the line. A character has 11 bits regardless of the parity, as in the
    /// manuals.
    pub fn character_time(self) -> Duration {
        self.baud.duration_of_bits(11)
    }
}

impl fmt::Display for CharacterFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} 8{}1", self.baud, self.parity.parity_letter())
    }
}

/// Supply voltage of an encoder, in millivolts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SupplyVoltage {
    /// Minimum voltage at which the encoder works.
    pub least: u16,
    pub nominal: u16,
    pub greatest: u16,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn computes_bit_durations() {
        assert_eq!(Baud::B9600.duration_of_bits(44), Duration::from_nanos(4_583_333));
        assert_eq!(Baud::new(600).unwrap().duration_of_bits(11), Duration::from_nanos(18_333_333));
        assert_eq!(Baud::new(0), None);
    }

    #[test]
    fn moments_saturate() {
        let start = Moment::START;
        assert_eq!(start - Duration::from_secs(1), start);
        assert_eq!(start.duration_since(start + Duration::from_secs(1)), Duration::ZERO);
    }
}
