//! Numbers of those parameters of drive 1 that the rules and the virtual drive use by name.

use std::ops::RangeInclusive;

/// Actual position, in steps.
pub const POSITION: u16 = 107;
/// Variant of the drive; 0 where there is none.
pub const VARIANT: u16 = 120;
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
/// Wait before the hand drive, never saved.
pub const HAND_DRIVE_WAIT: u16 = 182;
/// RS-485 time-out.
pub const TIMEOUT: u16 = 186;
/// The time-out of a drive that continues without commands.
pub const NO_TIMEOUT: i64 = 255;
/// RS-485 address.
pub const RS485_ADDRESS: u16 = 188;
/// RS-485 baud rate.
pub const RS485_BAUD: u16 = 190;
/// RS-485 complete time.
pub const RS485_COMPLETE: u16 = 192;
/// Faults since the acknowledgement; 0 acknowledges.
pub const ACKNOWLEDGE: u16 = 197;
/// Position assigned to the place where the drive stands.
pub const REFERENCE: u16 = 198;
/// Resets the drive.
pub const RESET: u16 = 199;
