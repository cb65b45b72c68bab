//! What an encoder says about itself in words of both languages. The English words are those of the protocol's tables.

use crate::app::Text;
use crate::protocol::hiperface::StatusCode;

/// Texts of the status codes.
const STATUS: [(u8, &str); 27] = [
    (0x00, "status.code_00"),
    (0x01, "status.code_01"),
    (0x02, "status.code_02"),
    (0x03, "status.code_03"),
    (0x04, "status.code_04"),
    (0x05, "status.code_05"),
    (0x06, "status.code_06"),
    (0x07, "status.code_07"),
    (0x08, "status.code_08"),
    (0x09, "status.code_09"),
    (0x0A, "status.code_0a"),
    (0x0B, "status.code_0b"),
    (0x0C, "status.code_0c"),
    (0x0D, "status.code_0d"),
    (0x0E, "status.code_0e"),
    (0x0F, "status.code_0f"),
    (0x10, "status.code_10"),
    (0x11, "status.code_11"),
    (0x12, "status.code_12"),
    (0x1C, "status.code_1c"),
    (0x1D, "status.code_1d"),
    (0x1E, "status.code_1e"),
    (0x1F, "status.code_1f"),
    (0x20, "status.code_20"),
    (0x21, "status.code_21"),
    (0x22, "status.code_22"),
    (0x23, "status.code_23"),
];

/// What a status code says.
pub fn status(code: StatusCode) -> Text {
    let id = STATUS.iter().find(|(byte, _)| *byte == code.byte()).map_or("status.unknown", |(_, id)| id);
    Text::new(id)
}

/// A status code with its number: "0Fh wrong access code".
pub fn status_with_number(code: StatusCode) -> Text {
    Text::new("status.named").with("number", format!("{:02X}h", code.byte())).with_text("text", status(code))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::Language;

    #[test]
    fn codes_are_called_as_the_protocol_calls_them() {
        for byte in 0..=0xFF {
            let code = StatusCode::new(byte);
            assert_eq!(status(code).words(Language::English), code.text());
            assert_eq!(status_with_number(code).terminal(), code.to_string());
        }
        let code = status_with_number(StatusCode::TEMPERATURE);
        assert_eq!(code.words(Language::German), "1Eh kritische Gebertemperatur");
    }
}
