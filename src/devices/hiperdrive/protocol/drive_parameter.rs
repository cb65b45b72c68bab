//! Numbers of those parameters of drive 1 that the rules and the virtual drive use by name.

use std::ops::RangeInclusive;

/// Drive is requested by the bus.
pub const REQUESTED: u16 = 152;
/// Numerator of the position scale.
pub const NUMERATOR: u16 = 154;
/// Denominator of the position scale.
pub const DENOMINATOR: u16 = 156;
/// Lower limit.
pub const LOWER: u16 = 158;
/// Upper limit.
pub const UPPER: u16 = 160;
/// Numerator of the speed scale.
pub const SPEED_NUMERATOR: u16 = 162;
/// Denominator of the speed scale.
pub const SPEED_DENOMINATOR: u16 = 164;
/// Maximum speed.
pub const MAXIMUM_SPEED: u16 = 166;
/// Allowed values of the maximum speed, in tenths of rpm.
pub const MAXIMUM_SPEEDS: RangeInclusive<u16> = 5..=350;
/// Position assigned to the place where the drive stands.
pub const REFERENCE: u16 = 198;
/// Resets the drive.
pub const RESET: u16 = 199;
