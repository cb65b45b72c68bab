//! Errors that a drive keeps (parameters 108 to 115, the newest first; reference 4). Names are the manual's; causes and
//! remedies are derived where it has none (`D`).

use std::fmt;

/// An error. Codes that are not known are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ErrorCode(u16);

/// A row of the table.
#[derive(Clone, Copy, Debug)]
pub struct ErrorCodeRow {
    /// Which one.
    pub code: ErrorCode,
    /// As the manual calls it.
    pub name: &'static str,
    /// What brings it about.
    pub cause: &'static str,
    /// What to do before it is acknowledged.
    pub remedy: &'static str,
}

const fn row(code: ErrorCode, name: &'static str, cause: &'static str, remedy: &'static str) -> ErrorCodeRow {
    ErrorCodeRow { code, name, cause, remedy }
}

/// All of them. Numbers are written as the manual does: 8200 to 8603, hexadecimal digits (`U`).
pub const ERROR_CODES: [ErrorCodeRow; 16] = [
    row(
        ErrorCode::OVER_CURRENT,
        "over-current",
        "the motor drew more current than allowed",
        "check the spindle for stiffness, raise the torque or lower the speed",
    ),
    row(
        ErrorCode::UNDER_VOLTAGE,
        "under-voltage",
        "the supply of the motor is too low",
        "measure the supply at the drive while it moves; shorter or thicker cable, stronger supply",
    ),
    row(
        ErrorCode::OVER_TEMPERATURE,
        "over-temperature",
        "the drive is too hot",
        "let the drive cool down. Use longer pauses, a lower load or better ventilation",
    ),
    row(
        ErrorCode::FOLLOWING,
        "following error",
        "the drive could not keep to its set speed",
        "less speed or more torque; look for what makes the spindle heavy",
    ),
    row(
        ErrorCode::BLOCK_REVERSE,
        "blocked in reverse",
        "the spindle is blocked while turning in reverse",
        "remove the obstacle, then move away from it at low torque",
    ),
    row(
        ErrorCode::BLOCK_FORWARD,
        "blocked forward",
        "the spindle is blocked while turning forward",
        "remove the obstacle, then move away from it at low torque",
    ),
    row(
        ErrorCode::LOWER_LIMIT,
        "lower limit",
        "the position is below parameter 158",
        "move up into the range, or change the limit",
    ),
    row(
        ErrorCode::UPPER_LIMIT,
        "upper limit",
        "the position is above parameter 160",
        "move down into the range, or change the limit",
    ),
    row(
        ErrorCode::CONTROL_LOOP,
        "control loop",
        "the control loop of the drive has failed",
        "switch the drive off and on. If the error returns, have the drive repaired",
    ),
    row(
        ErrorCode::EEPROM,
        "EEPROM",
        "the EEPROM of the drive cannot be read or written",
        "restore a profile and save it. If the error returns, have the drive repaired",
    ),
    row(
        ErrorCode::START_IMPOSSIBLE,
        "start impossible",
        "a motion was requested that cannot start in the present state",
        "acknowledge, enable, set speed and torque above 0, then start",
    ),
    row(
        ErrorCode::INVALID_VALUE,
        "value invalid",
        "a parameter received a value that is not allowed",
        "set a value within its range, with the upper limit above the lower one and the position between them",
    ),
    row(
        ErrorCode::SINCOS,
        "SINCOS",
        "the signal of the drive's position sensor is not valid",
        "keep magnets away, then switch the drive off and on. If the error returns, have the drive repaired",
    ),
    row(
        ErrorCode::INVALID_TARGET,
        "target invalid",
        "the target is outside the limits (parameters 158 and 160)",
        "enter a target within the limits",
    ),
    row(
        ErrorCode::CONNECTION_TIMEOUT,
        "communication time-out",
        "the drive has not been asked for longer than parameter 186 allows",
        "check the cable between hub and drive, then acknowledge",
    ),
    row(
        ErrorCode::RS485,
        "RS-485 without a valid answer",
        "the drive does not answer, or its reply is damaged",
        "check the drive's cable, address 1 and baud rate, then write 0 to parameter 197",
    ),
];

impl ErrorCode {
    /// Nothing.
    pub const NONE: ErrorCode = ErrorCode(0);
    /// Of the current.
    pub const OVER_CURRENT: ErrorCode = ErrorCode(0x8200);
    /// Of the supply.
    pub const UNDER_VOLTAGE: ErrorCode = ErrorCode(0x8201);
    /// Of the temperature.
    pub const OVER_TEMPERATURE: ErrorCode = ErrorCode(0x8202);
    /// Too slow.
    pub const FOLLOWING: ErrorCode = ErrorCode(0x8203);
    /// Held while it turns back.
    pub const BLOCK_REVERSE: ErrorCode = ErrorCode(0x8300);
    /// Held while it turns forward.
    pub const BLOCK_FORWARD: ErrorCode = ErrorCode(0x8301);
    /// Below the range.
    pub const LOWER_LIMIT: ErrorCode = ErrorCode(0x8304);
    /// Above the range.
    pub const UPPER_LIMIT: ErrorCode = ErrorCode(0x8305);
    /// Of the control.
    pub const CONTROL_LOOP: ErrorCode = ErrorCode(0x8401);
    /// Of what is stored.
    pub const EEPROM: ErrorCode = ErrorCode(0x8410);
    /// A motion that cannot begin.
    pub const START_IMPOSSIBLE: ErrorCode = ErrorCode(0x8500);
    /// Of a parameter.
    pub const INVALID_VALUE: ErrorCode = ErrorCode(0x8501);
    /// Of the sensor.
    pub const SINCOS: ErrorCode = ErrorCode(0x8502);
    /// Of a target.
    pub const INVALID_TARGET: ErrorCode = ErrorCode(0x8503);
    /// The drive has heard nothing.
    pub const CONNECTION_TIMEOUT: ErrorCode = ErrorCode(0x8601);
    /// The drive was not heard.
    pub const RS485: ErrorCode = ErrorCode(0x8603);

    /// Any number is a code.
    pub const fn new(code: u16) -> Self {
        ErrorCode(code)
    }

    /// Its number.
    pub const fn code(self) -> u16 {
        self.0
    }

    /// Its row; `None` for what is not known, and for no error.
    pub fn row(self) -> Option<&'static ErrorCodeRow> {
        ERROR_CODES.iter().find(|row| row.code == self)
    }
}

impl fmt::Display for ErrorCode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:04X} {}", self.0, self.row().map_or("unknown error", |row| row.name))
    }
}
