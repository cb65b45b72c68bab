//! Status codes that an encoder sends in reply to 50h. The manual leaves the codes to the data sheets. This list is
//! taken from the data sheets of SEK34/SEL34 and DME, and from B&R error 7013 (`P`).

use std::fmt;

/// Code from the status queue of the encoder.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct StatusCode(u8);

/// Class of a status code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StatusClass {
    /// Error found during start-up.
    Initialisation,
    /// A frame was not understood, or the encoder was restarted.
    Protocol,
    /// Access to a data field was rejected.
    Data,
    /// The position is unreliable.
    Position,
    /// Message from monitoring the temperature, the transmitter or the signals.
    Monitoring,
    /// Code that is not listed.
    Unknown,
}

use StatusClass::{Data, Initialisation, Monitoring, Position, Protocol};

#[rustfmt::skip]
const CODES: [(u8, StatusClass, &str); 27] = [
    (0x01, Initialisation, "analogue signals or compensation data faulty"),
    (0x02, Initialisation, "internal angular offset faulty"),
    (0x03, Initialisation, "data field partition table destroyed"),
    (0x04, Initialisation, "analogue limit values not available"),
    (0x05, Initialisation, "internal I²C bus fault"),
    (0x06, Initialisation, "internal checksum error"),
    (0x07, Protocol,       "reset caused by the watchdog"),
    (0x08, Protocol,       "counter overflow"),
    (0x09, Protocol,       "parity error"),
    (0x0A, Protocol,       "checksum error"),
    (0x0B, Protocol,       "unknown command"),
    (0x0C, Protocol,       "wrong number of bytes"),
    (0x0D, Protocol,       "argument not allowed"),
    (0x0E, Data,           "data field is write protected"),
    (0x0F, Data,           "wrong access code"),
    (0x10, Data,           "data field size cannot be changed"),
    (0x11, Data,           "address outside the data field"),
    (0x12, Data,           "data field does not exist"),
    (0x1C, Monitoring,     "analogue signal amplitude out of limits"),
    (0x1D, Monitoring,     "critical transmitter current (dirt or ageing)"),
    (0x1E, Monitoring,     "critical encoder temperature"),
    (0x1F, Position,       "speed too high, no position possible"),
    (0x20, Position,       "singleturn position unreliable"),
    (0x21, Position,       "multiturn position error"),
    (0x22, Position,       "multiturn position error"),
    (0x23, Position,       "multiturn position error"),
    (0x00, Protocol,       "no error"),
];

impl StatusCode {
    /// No error (00h).
    pub const OK: StatusCode = StatusCode(0x00);
    /// Counter overflow from FFFFFFh to 0 (08h).
    pub const COUNTER_OVERFLOW: StatusCode = StatusCode(0x08);
    /// Parity error of a character (09h).
    pub const PARITY: StatusCode = StatusCode(0x09);
    /// Wrong checksum of a frame (0Ah).
    pub const CHECKSUM: StatusCode = StatusCode(0x0A);
    /// Unknown command (0Bh).
    pub const UNKNOWN_COMMAND: StatusCode = StatusCode(0x0B);
    /// Wrong length of a request (0Ch).
    pub const LENGTH: StatusCode = StatusCode(0x0C);
    /// Argument out of range (0Dh).
    pub const ARGUMENT: StatusCode = StatusCode(0x0D);
    /// Write-protected data field (0Eh).
    pub const WRITE_PROTECTED: StatusCode = StatusCode(0x0E);
    /// Wrong access code for the data field (0Fh).
    pub const WRONG_CODE: StatusCode = StatusCode(0x0F);
    /// Rejected change of the size of a field (10h). Only the size of the last field can be changed, and only within
    /// the free memory.
    pub const SIZE_FIXED: StatusCode = StatusCode(0x10);
    /// Access beyond the end of the data field (11h).
    pub const OUT_OF_FIELD: StatusCode = StatusCode(0x11);
    /// Missing data field (12h).
    pub const NO_SUCH_FIELD: StatusCode = StatusCode(0x12);
    /// Temperature of the encoder out of range (1Eh).
    pub const TEMPERATURE: StatusCode = StatusCode(0x1E);
    /// Excessive speed of the shaft (1Fh).
    pub const TOO_FAST: StatusCode = StatusCode(0x1F);

    /// Creates a status code from its byte. Every byte is valid.
    pub const fn new(byte: u8) -> Self {
        StatusCode(byte)
    }

    /// Returns the code as a byte.
    pub const fn byte(self) -> u8 {
        self.0
    }

    /// Returns the class of the code.
    pub fn class(self) -> StatusClass {
        self.entry().map_or(StatusClass::Unknown, |(class, _)| class)
    }

    /// Returns the description of the code.
    pub fn text(self) -> &'static str {
        self.entry().map_or("unknown status code", |(_, text)| text)
    }

    /// Returns whether the code is a warning. Warnings are 08h, 1Ch, 1Dh and 1Eh. All other codes except 00h are
    /// errors.
    pub fn is_warning(self) -> bool {
        matches!(self.0, 0x08 | 0x1C..=0x1E)
    }

    /// Returns whether a position read together with this code is unreliable, which is true for 01h to 06h and 1Fh to
    /// 23h. Codes 09h to 12h concern a frame or a data field and never invalidate a position.
    pub fn invalidates_position(self) -> bool {
        matches!(self.0, 0x01..=0x06 | 0x1F..=0x23)
    }

    fn entry(self) -> Option<(StatusClass, &'static str)> {
        CODES.iter().find(|(code, ..)| *code == self.0).map(|(_, class, text)| (*class, *text))
    }
}

impl fmt::Display for StatusCode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:02X}h {}", self.0, self.text())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_each_code_once() {
        let mut bytes: Vec<u8> = CODES.iter().map(|(byte, ..)| *byte).collect();
        bytes.sort_unstable();
        bytes.dedup();
        assert_eq!(bytes.len(), CODES.len());
    }

    #[test]
    fn unknown_codes_keep_number() {
        assert_eq!(StatusCode::new(0x7E).to_string(), "7Eh unknown status code");
        assert_eq!(StatusCode::new(0x7E).class(), StatusClass::Unknown);
        assert!(!StatusCode::new(0x7E).is_warning());
    }

    #[test]
    fn classifies_warnings_and_invalid_positions() {
        let warnings: Vec<u8> = (0..=255).filter(|b| StatusCode::new(*b).is_warning()).collect();
        assert_eq!(warnings, [0x08, 0x1C, 0x1D, 0x1E]);
        let spoiling: Vec<u8> = (0..=255).filter(|b| StatusCode::new(*b).invalidates_position()).collect();
        assert_eq!(spoiling, [1, 2, 3, 4, 5, 6, 0x1F, 0x20, 0x21, 0x22, 0x23]);
    }
}
