//! Names for the parameter numbers used in the code. All except [`SERVICE`] are parameters of drive 1.

use std::ops::RangeInclusive;

/// Device parameter that saves, recalls and resets.
pub const SERVICE: u16 = 47;
/// Control word. This parameter and the next three can move a drive.
pub const CONTROL: u16 = 101;
/// Speed in percent of the maximum speed.
pub const SPEED_SHARE: u16 = 102;
/// Torque in percent of the nominal torque.
pub const TORQUE_SHARE: u16 = 103;
/// Target position in steps.
pub const TARGET: u16 = 104;
/// Status word.
pub const STATUS: u16 = 105;
/// Actual speed.
pub const SPEED: u16 = 106;
/// Actual position in steps.
pub const POSITION: u16 = 107;
/// Newest of the eight errors that a drive stores.
pub const NEWEST_ERROR: u16 = 108;
/// Oldest of the stored errors.
pub const OLDEST_ERROR: u16 = 115;
/// Variant of the drive, or 0 if no drive is connected.
pub const VARIANT: u16 = 120;
/// Whether the bus requests the drive. Only a requested drive can move.
pub const DRIVE_REQUESTED: u16 = 152;
/// Numerator of the position scale.
pub const NUMERATOR: u16 = 154;
/// Denominator of the position scale.
pub const DENOMINATOR: u16 = 156;
/// Lower limit.
pub const LOWER_LIMIT: u16 = 158;
/// Upper limit.
pub const UPPER_LIMIT: u16 = 160;
/// Numerator of the speed scale.
pub const SPEED_NUMERATOR: u16 = 162;
/// Denominator of the speed scale.
pub const SPEED_DENOMINATOR: u16 = 164;
/// Maximum speed.
pub const MAXIMUM_SPEED: u16 = 166;
/// Allowed maximum speeds in tenths of rpm.
pub const MAXIMUM_SPEEDS: RangeInclusive<u16> = 5..=350;
/// Waiting time before operation by hand. It is never saved.
pub const HAND_DRIVE_WAIT: u16 = 182;
/// RS-485 time-out.
pub const TIMEOUT: u16 = 186;
/// Value of [`TIMEOUT`] for no time-out: the drive continues to move without communication.
pub const NO_TIMEOUT: i64 = 255;
/// RS-485 address.
pub const RS485_ADDRESS: u16 = 188;
/// RS-485 baud rate.
pub const RS485_BAUD: u16 = 190;
/// RS-485 complete time, as the manual calls it.
pub const RS485_COMPLETE: u16 = 192;
/// Number of faults since the last acknowledgement. Writing 0 acknowledges the fault.
pub const ACKNOWLEDGE: u16 = 197;
/// Position assigned to the current location of the axis.
pub const REFERENCE: u16 = 198;
/// Parameter that resets the drive.
pub const RESET: u16 = 199;
