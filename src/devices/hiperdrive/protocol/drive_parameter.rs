//! The numbers of drive 1's parameters that are more than a row of the table: rules and the virtual drive ask for them.

use std::ops::RangeInclusive;

/// The bus asks for the drive.
pub const REQUESTED: u16 = 152;
/// The position's scale.
pub const NUMERATOR: u16 = 154;
/// What it is divided by.
pub const DENOMINATOR: u16 = 156;
/// The lower limit.
pub const LOWER: u16 = 158;
/// The upper limit.
pub const UPPER: u16 = 160;
/// The speed's scale.
pub const SPEED_NUMERATOR: u16 = 162;
/// What it is divided by.
pub const SPEED_DENOMINATOR: u16 = 164;
/// The greatest speed.
pub const MAXIMUM_SPEED: u16 = 166;
/// What the greatest speed may be, in tenths of rpm.
pub const MAXIMUM_SPEEDS: RangeInclusive<u16> = 5..=350;
/// The place where the drive stands gets this position.
pub const REFERENCE: u16 = 198;
/// The drive is reset.
pub const RESET: u16 = 199;
