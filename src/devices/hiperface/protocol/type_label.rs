//! Type label (52h) and serial number with firmware (56h).

use super::LineSettings;

/// Type label, as sent in reply to 52h.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TypeLabel {
    /// Stored interface settings, which take effect after the next reset.
    pub settings: LineSettings,
    /// Type code. FFh means that field FFh contains an extended label.
    pub encoder_type: u8,
    /// Size of the EEPROM in units of 16 bytes.
    pub eeprom_units: u8,
    /// Hardware options, software options and HIPERFACE version in one byte. The layout is not public.
    pub options: u8,
}

impl TypeLabel {
    /// Type code of encoders that have an extended label.
    pub const EXTENDED: u8 = 0xFF;

    /// Returns the EEPROM size in bytes, including the part used by the encoder itself.
    pub fn eeprom_bytes(self) -> usize {
        usize::from(self.eeprom_units) * 16
    }
}

/// Serial number and firmware, as sent in reply to 56h. The serial number has nine characters, the firmware version up
/// to twenty, and the date eight.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SerialLabel {
    /// Serial number as sent by the encoder, without leading and trailing blanks and NUL characters.
    pub serial_number: String,
    /// Firmware version, without leading and trailing blanks and NUL characters.
    pub firmware_version: String,
    /// Firmware date in the format `DD.MM.YY`.
    pub firmware_date: String,
}

impl SerialLabel {
    /// Minimum payload length, for serial number and date without a version.
    pub const MIN_PAYLOAD: usize = 9 + 8;
    /// Maximum payload length, with a version of 20 characters.
    pub const MAX_PAYLOAD: usize = 9 + 20 + 8;

    /// Parses a payload of [17](Self::MIN_PAYLOAD) to [37](Self::MAX_PAYLOAD) bytes, or returns `None` for any other
    /// length. The firmware version lies between the first nine and the last eight bytes. Bytes that are not printable
    /// ASCII are written as `\xNN`.
    pub fn parse(payload: &[u8]) -> Option<Self> {
        if payload.len() > Self::MAX_PAYLOAD {
            return None;
        }
        let (serial, rest) = payload.split_first_chunk::<9>()?;
        let (version, date) = rest.split_last_chunk::<8>()?;
        Some(SerialLabel { serial_number: text(serial), firmware_version: text(version), firmware_date: text(date) })
    }
}

/// Decodes a string of fixed length. Blanks and NUL characters at both ends are removed, and unprintable bytes are
/// escaped.
pub(super) fn text(bytes: &[u8]) -> String {
    let start = bytes.iter().position(|b| !matches!(b, 0 | b' ')).unwrap_or(bytes.len());
    let end = bytes.iter().rposition(|b| !matches!(b, 0 | b' ')).map_or(start, |last| last + 1);
    bytes.get(start..end).unwrap_or_default().escape_ascii().to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parses_reference_serial_label() {
        let label = SerialLabel::parse(b"GB0450179V1.2301.02.16").unwrap();
        assert_eq!(label.serial_number, "GB0450179");
        assert_eq!(label.firmware_version, "V1.23");
        assert_eq!(label.firmware_date, "01.02.16");
    }

    #[test]
    fn trims_padding_and_checks_length() {
        let label = SerialLabel::parse(b"123456   \0V2 \0       01.01.99").unwrap();
        assert_eq!(label.serial_number, "123456");
        assert_eq!(label.firmware_version, "V2");
        assert_eq!(SerialLabel::parse(&[b'1'; 16]), None);
        assert!(SerialLabel::parse(&[b'1'; 17]).is_some_and(|label| label.firmware_version.is_empty()));
        assert!(SerialLabel::parse(&[b'1'; 37]).is_some());
        assert_eq!(SerialLabel::parse(&[b'1'; 38]), None);
    }

    #[test]
    fn escapes_unprintable_characters() {
        let label = SerialLabel::parse(b"12345\xFF\n89V01.02.16").unwrap();
        assert_eq!(label.serial_number, "12345\\xff\\n89");
    }
}
