//! Errors that a drive stores in parameters 108 to 115, newest first (reference, section 4). Their names are those of
//! the manual. Causes and remedies are derived where the manual gives none (`D`).

use std::fmt;

/// Error code of a drive. Unknown codes are preserved.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ErrorCode(u16);

/// Row of the error table.
#[derive(Clone, Copy, Debug)]
pub struct ErrorCodeRow {
    /// Code of the error.
    pub code: ErrorCode,
    /// Name in the manual.
    pub name: &'static str,
    /// Cause of the error.
    pub cause: &'static str,
    /// What to do before acknowledging the error.
    pub remedy: &'static str,
}

const fn row(code: ErrorCode, name: &'static str, cause: &'static str, remedy: &'static str) -> ErrorCodeRow {
    ErrorCodeRow { code, name, cause, remedy }
}

/// All known errors, with the numbers given in the manual. The manual does not say whether 8200 to 8603 are
/// hexadecimal, as assumed here (`U`).
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
        ErrorCode::FOLLOWING_ERROR,
        "following error",
        "the drive could not maintain its set speed",
        "less speed or more torque; look for what makes the spindle heavy",
    ),
    row(
        ErrorCode::BLOCK_REVERSE,
        "blocked in reverse",
        "the spindle is blocked in the reverse direction",
        "remove the obstacle, then move away from it at low torque",
    ),
    row(
        ErrorCode::BLOCK_FORWARD,
        "blocked forward",
        "the spindle is blocked in the forward direction",
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
        "RS-485: no valid reply",
        "the drive does not answer, or its reply is damaged",
        "check the drive's cable, address 1 and baud rate, then write 0 to parameter 197",
    ),
];

impl ErrorCode {
    /// No error.
    pub const NONE: ErrorCode = ErrorCode(0);
    /// Overcurrent.
    pub const OVER_CURRENT: ErrorCode = ErrorCode(0x8200);
    /// Supply voltage too low.
    pub const UNDER_VOLTAGE: ErrorCode = ErrorCode(0x8201);
    /// Temperature too high.
    pub const OVER_TEMPERATURE: ErrorCode = ErrorCode(0x8202);
    /// Following error: the drive cannot keep up.
    pub const FOLLOWING_ERROR: ErrorCode = ErrorCode(0x8203);
    /// Blocked while turning backward.
    pub const BLOCK_REVERSE: ErrorCode = ErrorCode(0x8300);
    /// Blocked while turning forward.
    pub const BLOCK_FORWARD: ErrorCode = ErrorCode(0x8301);
    /// Position below the range.
    pub const LOWER_LIMIT: ErrorCode = ErrorCode(0x8304);
    /// Position above the range.
    pub const UPPER_LIMIT: ErrorCode = ErrorCode(0x8305);
    /// Control loop error.
    pub const CONTROL_LOOP: ErrorCode = ErrorCode(0x8401);
    /// Error in the stored data.
    pub const EEPROM: ErrorCode = ErrorCode(0x8410);
    /// Motion cannot start.
    pub const START_IMPOSSIBLE: ErrorCode = ErrorCode(0x8500);
    /// Invalid parameter value.
    pub const INVALID_VALUE: ErrorCode = ErrorCode(0x8501);
    /// Sensor error.
    pub const SINCOS: ErrorCode = ErrorCode(0x8502);
    /// Invalid target.
    pub const INVALID_TARGET: ErrorCode = ErrorCode(0x8503);
    /// Time-out: the drive has received no data.
    pub const CONNECTION_TIMEOUT: ErrorCode = ErrorCode(0x8601);
    /// The drive does not reply over RS-485.
    pub const RS485: ErrorCode = ErrorCode(0x8603);

    /// Creates an error code from any number.
    pub const fn new(code: u16) -> Self {
        ErrorCode(code)
    }

    /// Returns the number.
    pub const fn code(self) -> u16 {
        self.0
    }

    /// Returns the table row, or `None` for an unknown code or for no error.
    pub fn row(self) -> Option<&'static ErrorCodeRow> {
        ERROR_CODES.iter().find(|row| row.code == self)
    }
}

impl fmt::Display for ErrorCode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:04X} {}", self.0, self.row().map_or("unknown error", |row| row.name))
    }
}
