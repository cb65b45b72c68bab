//! Descriptions of encoder data in English and German. The English descriptions match the protocol tables.

use crate::app::Text;
use crate::devices::hiperface::protocol::{DataFieldStatus, Geometry, LineSettings, Position, StatusCode};
use crate::devices::hiperface::state::TEXTS;

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

pub fn status_code_name(code: StatusCode) -> Text {
    let id = STATUS.iter().find(|(byte, _)| *byte == code.byte()).map_or("status.unknown", |(_, id)| id);
    TEXTS.text(id)
}

/// Returns a status code with its number, such as "0Fh wrong access code".
pub fn status_with_number(code: StatusCode) -> Text {
    TEXTS.text("status.named").with("number", format!("{:02X}h", code.byte())).with_text("text", status_code_name(code))
}

/// Describes the status byte of a data field, such as "48 bytes, write protected, code 2, code required".
pub fn field_status(status: DataFieldStatus) -> Text {
    if !status.exists() {
        return TEXTS.text("field.not_defined");
    }
    TEXTS
        .text("field.status")
        .with("size", status.size().bytes())
        .with_text("access", field_access(status))
        .with("code", status.code())
        .with_text("required", field_code_required(status))
}

pub fn field_access(status: DataFieldStatus) -> Text {
    TEXTS.text(if status.is_writable() { "field.writable" } else { "field.write_protected" })
}

pub fn field_code_required(status: DataFieldStatus) -> Text {
    TEXTS.text(if status.code_required() { "field.code_required" } else { "field.code_not_required" })
}

pub fn geometry_text(geometry: Geometry) -> Text {
    match geometry {
        Geometry::Rotary { periods, turns: 1 } => TEXTS.text("geometry.singleturn").with("periods", periods),
        Geometry::Rotary { periods, turns } => {
            TEXTS.text("geometry.multiturn").with("periods", periods).with("turns", turns)
        }
        Geometry::Linear { period_nm, .. } => {
            // There are enough decimals to show whole nanometres.
            let decimals = (0..6u32).find(|decimals| period_nm.is_multiple_of(10u32.pow(6 - decimals))).unwrap_or(6);
            let decimals = usize::try_from(decimals).unwrap_or(6);
            TEXTS.text("geometry.linear").with_number("millimetres", f64::from(period_nm) * 1e-6, decimals)
        }
    }
}

/// Describes a position in turns and degrees, or in millimetres.
pub fn position_text(position: Position) -> Text {
    match (position.turns(), position.degrees(), position.millimetres()) {
        (Some(turn), Some(degrees), _) => {
            TEXTS.text("position.rotary").with("turn", turn).with_number("degrees", degrees, 3)
        }
        (.., Some(millimetres)) => TEXTS.text("position.linear").with_number("millimetres", millimetres, 6),
        _ => raw_position_text(position.raw),
    }
}

/// Describes a position in steps, for an encoder of unknown geometry.
pub fn raw_position_text(raw: u32) -> Text {
    TEXTS.text("position.steps").with("steps", raw)
}

/// Describes the settings byte of the interface, such as "9600 8E1, time-out 44 bits, standard".
pub fn line_settings(settings: LineSettings) -> Text {
    let text = TEXTS
        .text("line.settings")
        .with("bits", if settings.has_long_timeout() { 44 } else { 11 })
        .with_text("wiring", TEXTS.text(if settings.is_bus() { "line.bus" } else { "line.standard" }));
    match settings.character_format() {
        Some(format) => text.with("format", format),
        None => text.with_text("format", TEXTS.text("line.reserved")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::Language;
    use crate::app::explain::parity_text;
    use crate::units::Parity;

    #[test]
    fn codes_use_protocol_names() {
        for byte in 0..=0xFF {
            let code = StatusCode::new(byte);
            assert_eq!(status_code_name(code).to_string_in(Language::English), code.text());
            assert_eq!(status_with_number(code).terminal_text(), code.to_string());
        }
        let code = status_with_number(StatusCode::TEMPERATURE);
        assert_eq!(code.to_string_in(Language::German), "1Eh kritische Gebertemperatur");
    }

    #[test]
    fn properties_use_protocol_names() {
        for byte in 0..=0xFF {
            let (field, line) = (DataFieldStatus::from_byte(byte), LineSettings::from_byte(byte));
            assert_eq!(field_status(field).to_string_in(Language::English), field.to_string());
            assert_eq!(line_settings(line).to_string_in(Language::English), line.to_string());
        }
        let rotary = |periods, turns| Geometry::Rotary { periods, turns };
        let linear = |period_nm| Geometry::Linear { period_nm, periods: 0 };
        for shape in [rotary(128, 1), rotary(128, 4096), linear(4_000_000), linear(1_500_000), linear(820)] {
            assert_eq!(geometry_text(shape).to_string_in(Language::English), shape.to_string());
            assert_eq!(
                position_text(shape.position(919_857)).to_string_in(Language::English),
                shape.position(919_857).to_string()
            );
        }
        for known in Parity::ALL {
            assert_eq!(parity_text(known).to_string_in(Language::English), known.keyword());
        }
    }

    #[test]
    fn german_text_uses_decimal_comma() {
        let cases = [
            (
                field_status(DataFieldStatus::from_byte(0xAA)),
                "48 Bytes, schreibgeschützt, Zugriffsschlüssel 2, Schlüssel erforderlich",
            ),
            (geometry_text(Geometry::Linear { period_nm: 1_500_000, periods: 0 }), "linear, Periode 1,5 mm"),
            (
                position_text(Geometry::Rotary { periods: 128, turns: 4096 }.position(0x000E_0531)),
                "Umdrehung 224, 116,807°",
            ),
            (line_settings(LineSettings::from_byte(0x64)), "9600 8E1, Zeitüberschreitung 44 Bit, Bus"),
            (parity_text(Parity::Odd), "ungerade"),
        ];
        for (text, german) in cases {
            assert_eq!(text.to_string_in(Language::German), german);
        }
    }
}
