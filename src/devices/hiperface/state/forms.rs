//! Parses access codes, addresses and channels that the user has entered. The error messages state the valid values.

use crate::app::Text;
use crate::devices::hiperface::protocol::{
    AccessCode, AccessCodeNumber, DataFieldStatus, DeviceAddress, FieldSize, LineSettings,
};
use crate::devices::hiperface::state::TEXTS;
use crate::units::CharacterFormat;

/// Parses an access code of one hexadecimal byte.
///
/// # Errors
/// Returns an error if the entry is invalid. The message does not repeat the entry.
pub fn access_code(text: &str) -> Result<AccessCode, Text> {
    byte(text).map(AccessCode::new).ok_or_else(|| TEXTS.text("entry.code"))
}

/// Parses a new access code, which the user types twice because it cannot be read back.
///
/// # Errors
/// Returns an error if an entry is invalid or the entries differ. The message does not repeat the entries.
pub fn new_access_code(text: &str, again: &str) -> Result<AccessCode, Text> {
    let code = access_code(text)?;
    if access_code(again)?.byte() == code.byte() { Ok(code) } else { Err(TEXTS.text("entry.codes_differ")) }
}

/// Parses an encoder address in hexadecimal, 40h to 5Fh.
///
/// # Errors
/// Returns an error if the entry is invalid.
pub fn address(text: &str) -> Result<DeviceAddress, Text> {
    byte(text)
        .and_then(DeviceAddress::new)
        .ok_or_else(|| with_address_range(TEXTS.text("entry.address")).with("entry", text))
}

/// Adds the valid range of encoder addresses to a message.
pub(super) fn with_address_range(text: Text) -> Text {
    let [first, last] = [DeviceAddress::FIRST, DeviceAddress::LAST].map(|own| format!("{:02X}", own.byte()));
    text.with("first", first).with("last", last)
}

/// Parses the number of an analogue channel in hexadecimal.
///
/// # Errors
/// Returns an error if the entry is invalid.
pub fn parse_channel(text: &str) -> Result<u8, Text> {
    byte(text).ok_or_else(|| TEXTS.text("entry.channel").with("entry", text))
}

/// Returns line settings with the given format, time-out and wiring. Bits of unknown meaning are preserved.
///
/// # Errors
/// Returns an error if the encoder does not support the baud rate or parity.
pub fn settings(
    from: LineSettings,
    format: CharacterFormat,
    long_timeout: bool,
    bus: bool,
) -> Result<LineSettings, Text> {
    let refused = || TEXTS.text("entry.settings").with("format", format);
    Ok(from.with_format(format).ok_or_else(refused)?.with_long_timeout(long_timeout).with_bus(bus))
}

pub fn new_field(size: FieldSize, code: AccessCodeNumber, code_required: bool) -> DataFieldStatus {
    DataFieldStatus::new(size, code, code_required)
}

fn byte(text: &str) -> Option<u8> {
    let text = text.trim();
    let digits = text.strip_prefix("0x").or_else(|| text.strip_suffix(['h', 'H'])).unwrap_or(text);
    // The number parser would also accept a sign.
    u8::from_str_radix(digits, 16).ok().filter(|_| digits.bytes().all(|c| c.is_ascii_hexdigit()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parses_common_hex_notations() {
        assert_eq!(address("41").unwrap().byte(), 0x41);
        assert_eq!(address("0x5F").unwrap().byte(), 0x5F);
        assert_eq!(parse_channel("48h"), Ok(0x48));
        assert_eq!(access_code(" ff ").unwrap().byte(), 0xFF);
        for text in ["", "100", "+5", "zz", "0x"] {
            assert!(parse_channel(text).is_err(), "{text}");
        }
        assert!(address("3F").is_err() && address("60").is_err());
        assert_eq!(new_access_code("1A", "0x1a").map(AccessCode::byte), Ok(0x1A));
        assert!(new_access_code("1A", "1B").is_err() && new_access_code("1A", "").is_err());
        let text = access_code("secret").unwrap_err().to_string_in(crate::app::Language::English);
        assert!(!text.contains("secret"));
    }
}
