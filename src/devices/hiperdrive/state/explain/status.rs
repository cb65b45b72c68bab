//! Names of EtherNet/IP status codes, and messages about invalid packets and values.

use crate::app::Text;
use crate::app::explain::literal_text;
use crate::buses::ethernet_ip::protocol::{EncapsulationStatus, GeneralStatus, PacketError, PacketField, Structure};
use crate::devices::hiperdrive::procedures::ErrorReply;
use crate::devices::hiperdrive::protocol::ValueError;
use crate::devices::hiperdrive::state::TEXTS;

const UNKNOWN: &str = "hd_status_name.unknown";

/// Returns the code and the name of an encapsulation status.
pub(super) fn encapsulation_status_text(status: EncapsulationStatus) -> Text {
    let name = match status.code() {
        0x00 => "hd_status_name.frame_00",
        0x01 => "hd_status_name.frame_01",
        0x02 => "hd_status_name.frame_02",
        0x03 => "hd_status_name.frame_03",
        0x64 => "hd_status_name.frame_64",
        0x65 => "hd_status_name.frame_65",
        0x69 => "hd_status_name.frame_69",
        _ => UNKNOWN,
    };
    code_and_name_text(format!("0x{:08X}", status.code()), name)
}

/// Returns the codes and names of a CIP status and its extended status.
pub(super) fn refusal_text(refusal: &ErrorReply) -> Text {
    let status = general_status_text(refusal.status);
    let words: Vec<Text> = match (refusal.extended.as_slice(), refusal.row()) {
        ([], _) => return status,
        ([first, ..], Some(row)) => vec![code_and_name_text(format!("0x{first:04X}"), connection_failure_id(row.code))],
        (words, None) => words.iter().map(|word| literal_text(format!("0x{word:04X}"))).collect(),
    };
    let words = Text::new("plain.words").with_list("words", words);
    TEXTS.text("hd_status_name.followed").with_text("status", status).with_text("words", words)
}

fn general_status_text(status: GeneralStatus) -> Text {
    let name = match status.code() {
        0x00 => "hd_status_name.cip_00",
        0x01 => "hd_status_name.cip_01",
        0x02 => "hd_status_name.cip_02",
        0x03 => "hd_status_name.cip_03",
        0x04 => "hd_status_name.cip_04",
        0x05 => "hd_status_name.cip_05",
        0x06 => "hd_status_name.cip_06",
        0x07 => "hd_status_name.cip_07",
        0x08 => "hd_status_name.cip_08",
        0x09 => "hd_status_name.cip_09",
        0x0A => "hd_status_name.cip_0a",
        0x0B => "hd_status_name.cip_0b",
        0x0C => "hd_status_name.cip_0c",
        0x0D => "hd_status_name.cip_0d",
        0x0E => "hd_status_name.cip_0e",
        0x0F => "hd_status_name.cip_0f",
        0x10 => "hd_status_name.cip_10",
        0x11 => "hd_status_name.cip_11",
        0x12 => "hd_status_name.cip_12",
        0x13 => "hd_status_name.cip_13",
        0x14 => "hd_status_name.cip_14",
        0x15 => "hd_status_name.cip_15",
        0x16 => "hd_status_name.cip_16",
        0x18 => "hd_status_name.cip_18",
        0x19 => "hd_status_name.cip_19",
        0x1C => "hd_status_name.cip_1c",
        0x1E => "hd_status_name.cip_1e",
        0x1F => "hd_status_name.cip_1f",
        0x20 => "hd_status_name.cip_20",
        0x26 => "hd_status_name.cip_26",
        0x2C => "hd_status_name.cip_2c",
        _ => UNKNOWN,
    };
    code_and_name_text(format!("0x{:02X}", status.code()), name)
}

/// Returns the message ID for the extended status of a connection failure.
fn connection_failure_id(code: u16) -> &'static str {
    match code {
        0x0100 => "hd_status_name.connection_0100",
        0x0103 => "hd_status_name.connection_0103",
        0x0106 => "hd_status_name.connection_0106",
        0x0107 => "hd_status_name.connection_0107",
        0x0108 => "hd_status_name.connection_0108",
        0x0109 => "hd_status_name.connection_0109",
        0x0111 => "hd_status_name.connection_0111",
        0x0113 => "hd_status_name.connection_0113",
        0x0114 => "hd_status_name.connection_0114",
        0x0115 => "hd_status_name.connection_0115",
        0x0116 => "hd_status_name.connection_0116",
        0x0117 => "hd_status_name.connection_0117",
        0x0127 => "hd_status_name.connection_0127",
        0x0128 => "hd_status_name.connection_0128",
        0x0203 => "hd_status_name.connection_0203",
        0x0204 => "hd_status_name.connection_0204",
        0x0312 => "hd_status_name.connection_0312",
        0x0315 => "hd_status_name.connection_0315",
        _ => UNKNOWN,
    }
}

fn code_and_name_text(code: String, name: &'static str) -> Text {
    TEXTS.text("hd_status_name.coded").with("code", code).with_text("name", TEXTS.text(name))
}

pub(super) fn packet_error_text(error: &PacketError) -> Text {
    match *error {
        PacketError::Short { what, got } => {
            TEXTS.text("hd_packet.short").with_text("what", structure_text(what)).with("got", got)
        }
        PacketError::Long { what, left } => {
            TEXTS.text("hd_packet.long").with_text("what", structure_text(what)).with("left", left)
        }
        PacketError::Value { what, field, got } => TEXTS
            .text("hd_packet.value")
            .with_text("what", structure_text(what))
            .with_text("field", self::packet_field_text(field))
            .with("got", format!("0x{got:X}")),
    }
}

fn structure_text(structure: Structure) -> Text {
    TEXTS.text(match structure {
        Structure::ConfigurationControl => "hd_structure.configuration_control",
        Structure::InterfaceConfiguration => "hd_structure.interface_configuration",
        Structure::CipRequest => "hd_structure.cip_request",
        Structure::CipReply => "hd_structure.cip_reply",
        Structure::RegisterSession => "hd_structure.register_session",
        Structure::SendRRData => "hd_structure.send_rr_data",
        Structure::IdentityObject => "hd_structure.identity_object",
        Structure::IdentityItem => "hd_structure.identity_item",
        Structure::ForwardOpen => "hd_structure.forward_open",
        Structure::ForwardOpenReply => "hd_structure.forward_open_reply",
        Structure::Refusal => "hd_structure.refusal",
        Structure::ForwardClose => "hd_structure.forward_close",
        Structure::ForwardCloseReply => "hd_structure.forward_close_reply",
        Structure::Items => "hd_structure.items",
        Structure::NullAddress => "hd_structure.null_address",
        Structure::ConnectedAddress => "hd_structure.connected_address",
        Structure::SequencedAddress => "hd_structure.sequenced_address",
        Structure::SocketAddress => "hd_structure.socket_address",
        Structure::Encapsulation => "hd_structure.encapsulation",
        Structure::CyclicPacket => "hd_structure.cyclic_packet",
        Structure::Path => "hd_structure.path",
    })
}

fn packet_field_text(field: PacketField) -> Text {
    TEXTS.text(match field {
        PacketField::Service => "hd_field.service",
        PacketField::Length => "hd_field.length",
        PacketField::Items => "hd_field.items",
        PacketField::WidePrefix => "hd_field.wide_prefix",
        PacketField::TimeoutMultiplier => "hd_field.timeout_multiplier",
    })
}

/// Explains why a value does not match the type of its parameter.
pub(super) fn value_error_text(error: &ValueError) -> Text {
    match *error {
        ValueError::Length { expected, got } => {
            TEXTS.text("hd_value.length").with("expected", expected).with("got", got)
        }
        ValueError::Number { number, low, high } => {
            TEXTS.text("hd_value.number").with("number", number).with("low", low).with("high", high)
        }
        ValueError::NumberForText => TEXTS.text("hd_value.number_for_text"),
        ValueError::TextForNumber => TEXTS.text("hd_value.text_for_number"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::Language::{English, German};
    use crate::buses::ethernet_ip::protocol::{ENCAPSULATION_STATUS, EXTENDED_STATUS, GENERAL_STATUS, Service};

    #[track_caller]
    fn assert_in_both_languages(text: &Text, error: &dyn std::fmt::Display) {
        assert_eq!(text.to_string_in(English), error.to_string());
        assert_ne!(text.to_string_in(German), text.to_string_in(English));
    }

    fn refused(status: u8, extended: Vec<u16>) -> ErrorReply {
        ErrorReply { service: Service::FORWARD_OPEN, status: GeneralStatus::new(status), extended }
    }

    #[test]
    fn names_every_status() {
        for code in (0..=255).chain([0x1_0000]) {
            let status = EncapsulationStatus::new(code);
            assert_in_both_languages(&encapsulation_status_text(status), &status);
        }
        for code in 0..=255 {
            for extended in [vec![], vec![0x0106], vec![0x7777, 2]] {
                let refused = refused(code, extended);
                assert_in_both_languages(&refusal_text(&refused), &refused);
            }
        }
        for row in EXTENDED_STATUS {
            let refused = refused(0x01, vec![row.code]);
            assert_in_both_languages(&refusal_text(&refused), &refused);
        }
        // One name per row, and none for other rows.
        let unknown = TEXTS.text(UNKNOWN).to_string_in(German);
        let mut names: Vec<String> =
            GENERAL_STATUS.iter().map(|row| general_status_text(row.code).to_string_in(German)).collect();
        names.extend(ENCAPSULATION_STATUS.iter().map(|row| encapsulation_status_text(row.code).to_string_in(German)));
        assert!(names.iter().all(|name| !name.contains(&unknown)), "{names:?}");
    }

    #[test]
    fn explains_corrupt_replies() {
        let packets = [
            PacketError::Short { what: Structure::ForwardOpen, got: 3 },
            PacketError::Long { what: Structure::ForwardOpen, left: 2 },
            PacketError::Value { what: Structure::Path, field: PacketField::Length, got: 0xFFFF },
        ];
        for error in packets {
            assert_in_both_languages(&packet_error_text(&error), &error);
        }
        let values = [
            ValueError::Length { expected: 4, got: 2 },
            ValueError::Number { number: 300, low: 0, high: 255 },
            ValueError::NumberForText,
            ValueError::TextForNumber,
        ];
        for error in values {
            assert_in_both_languages(&value_error_text(&error), &error);
        }
    }
}
