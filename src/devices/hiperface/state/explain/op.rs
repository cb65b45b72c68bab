//! Descriptions of planned operations for the review before a write.

use super::format::{field_access, field_code_required, field_status, line_settings};
use crate::app::Text;
use crate::app::explain::literal_text;
use crate::app::review::OperationDescription;
use crate::bits::hex;
use crate::devices::hiperface::profile::Op;
use crate::devices::hiperface::protocol::{DataFieldStatus, Geometry};
use crate::devices::hiperface::state::{TEXTS, position_text};

/// Describes an operation without revealing access codes.
pub fn operation_texts(op: &Op, geometry: Option<Geometry>) -> OperationDescription {
    match op {
        Op::Define { field, from, to } => describe_definition(*field, *from, *to),
        Op::Store { field, address, old, new, .. } => OperationDescription::single(
            byte_range_text(*field, usize::from(*address), new.len()),
            old.as_ref().map_or_else(|| TEXTS.text("op.new_field"), |old| literal_text(hex(old))),
            literal_text(hex(new)),
        ),
        Op::ChangeCode { number, .. } => OperationDescription::single(
            TEXTS.text("op.access_code").with("number", number),
            TEXTS.text("op.present_code"),
            TEXTS.text("op.changed_code"),
        ),
        Op::SetPosition { from, to, synchronise } => {
            let item = if *synchronise { "op.synchronise" } else { "op.position" };
            OperationDescription::single(TEXTS.text(item), position_text(*from, geometry), position_text(*to, geometry))
        }
        Op::SetAddress { from, to } => OperationDescription::single(
            TEXTS.text("op.address"),
            literal_text(format!("{from:02X}h")),
            literal_text(to),
        ),
        Op::Configure { from, to } => {
            OperationDescription::single(TEXTS.text("op.settings"), line_settings(*from), line_settings(*to))
        }
        Op::ClearCounter { from } => {
            OperationDescription::single(TEXTS.text("op.counter"), literal_text(from), literal_text(0))
        }
        Op::IncrementCounter { from } => OperationDescription::single(
            TEXTS.text("op.counter"),
            literal_text(from),
            literal_text((from + 1) & 0x00FF_FFFF),
        ),
    }
}

fn byte_range_text(field: u8, first: usize, count: usize) -> Text {
    match count {
        1 => TEXTS.text("op.byte").with("field", field).with("first", first),
        _ => TEXTS
            .text("op.bytes")
            .with("field", field)
            .with("first", first)
            .with("last", (first + count).saturating_sub(1)),
    }
}

fn describe_definition(field: u8, from: Option<DataFieldStatus>, to: DataFieldStatus) -> OperationDescription {
    let item = TEXTS.text("op.field").with("field", field);
    match from {
        Some(from) if from.exists() && !to.exists() => {
            OperationDescription::single(item, field_status(from), TEXTS.text("op.deleted"))
        }
        Some(from) if from.exists() => {
            let (old, new) = changed_status_properties(from, to).into_iter().unzip::<_, _, Vec<_>, Vec<_>>();
            let parts = |texts: Vec<Text>| TEXTS.text("op.parts").with_list("parts", texts);
            OperationDescription::single(item, parts(old), parts(new))
        }
        _ => OperationDescription::single(item, TEXTS.text("op.not_there"), field_status(to)),
    }
}

/// Describes each property that differs between two field statuses, with its old and new value.
fn changed_status_properties(from: DataFieldStatus, to: DataFieldStatus) -> Vec<(Text, Text)> {
    let size = |status: DataFieldStatus| TEXTS.text("op.size").with("size", status.size().bytes());
    let code = |status: DataFieldStatus| TEXTS.text("op.code").with("code", status.code());
    let parts: [&dyn Fn(DataFieldStatus) -> Text; 4] = [&size, &field_access, &code, &field_code_required];
    parts.into_iter().map(|part| (part(from), part(to))).filter(|(old, new)| old != new).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::Language::{English, German};
    use crate::devices::hiperface::protocol::{AccessCode, AccessCodeNumber, DeviceAddress, LineSettings};

    #[test]
    fn describes_operations_in_plain_words() {
        let status = DataFieldStatus::from_byte;
        let define = |from: Option<u8>, to| Op::Define { field: 1, from: from.map(status), to: status(to) };
        let store = |old, new| Op::Store { field: 1, address: 3, status: status(0xC9), old, new };
        let (old, new) = (AccessCode::FACTORY, AccessCode::new(0x1A));
        let settings = LineSettings::from_byte;
        let cases = [
            (define(Some(0xE8), 0xA8), "data field 1: writable → write protected"),
            (define(Some(0xE8), 0xE9), "data field 1: 16 bytes → 32 bytes"),
            (define(Some(0xE8), 0xF0), "data field 1: access code 2, code required → access code 3, code not required"),
            (define(None, 0xE9), "data field 1: not defined → 32 bytes, writable, code 2, code required"),
            (define(Some(0xE9), 0x69), "data field 1: 32 bytes, writable, code 2, code required → deleted"),
            (store(Some(vec![0, 1]), vec![8, 0x1F]), "data field 1, bytes 3 to 4: 00 01 → 08 1F"),
            (store(None, vec![8]), "data field 1, byte 3: new field → 08"),
            (
                Op::ChangeCode { number: AccessCodeNumber::ZERO, old, new },
                "access code 0: current code, not shown → new code, not shown",
            ),
            (Op::SetPosition { from: 123, to: 456, synchronise: false }, "position: 123 steps → 456 steps"),
            (Op::SetAddress { from: 0x40, to: DeviceAddress::new(0x41).unwrap() }, "address: 40h → 41h"),
            (
                Op::Configure { from: settings(0xE4), to: settings(0x65) },
                "interface settings: 9600 8E1, time-out 44 bits, standard → 19200 8E1, time-out 44 bits, bus",
            ),
            (Op::ClearCounter { from: 7 }, "counter: 7 → 0"),
            (Op::IncrementCounter { from: 0x00FF_FFFF }, "counter: 16777215 → 0"),
        ];
        for (operation, english) in cases {
            let words: Vec<String> =
                operation_texts(&operation, None).texts().map(|text| text.to_string_in(English)).collect();
            let [item, old, new] = words.as_slice() else { panic!("{words:?}") };
            assert_eq!(format!("{item}: {old} → {new}"), english);
        }
        let words: Vec<String> =
            operation_texts(&define(Some(0xE8), 0xA9), None).texts().map(|text| text.to_string_in(German)).collect();
        assert_eq!(words, ["Datenfeld 1", "16 Bytes, beschreibbar", "32 Bytes, schreibgeschützt"]);
        // With 4096 steps per turn, 10,240 steps are two and a half turns.
        let turns = Some(Geometry::Rotary { periods: 128, turns: 4096 });
        let set = operation_texts(&Op::SetPosition { from: 0, to: 10_240, synchronise: false }, turns);
        let words: Vec<String> = set.texts().map(|text| text.to_string_in(German)).collect();
        assert_eq!(words, ["Position", "0 Schritte · Umdrehung 0, 0,000°", "10240 Schritte · Umdrehung 2, 180,000°"]);
    }
}
