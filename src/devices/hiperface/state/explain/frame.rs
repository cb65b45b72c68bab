//! Descriptions of frames for the trace and for the `decode` command.

use super::{command_text, field_status, line_settings, status_with_number};
use crate::app::Text;
use crate::app::explain::literal_text;
use crate::bits::hex;
use crate::devices::hiperface::protocol::{
    Arguments, BROADCAST, Command, DataFieldStatus, EncoderTypes, Frame, FrameDetail, LineSettings, Reply,
    RequestError, SerialLabel, StatusCode, TypeLabel,
};
use crate::devices::hiperface::state::TEXTS;

pub fn detail_text(fact: &FrameDetail) -> Text {
    match fact {
        FrameDetail::Heading { address, command } => heading_text(*address, *command),
        FrameDetail::Request(arguments) => request_text(arguments),
        FrameDetail::NoRequest(error) => TEXTS.text("frame.no_request").with_text("why", request_error_text(*error)),
        FrameDetail::Refused(code) => TEXTS.text("frame.refused").with_text("code", status_code_text(*code)),
        FrameDetail::Code(code) => status_code_text(*code),
        FrameDetail::Reply(reply) => TEXTS.text("frame.reply").with_text("words", reply_text(reply)),
    }
}

fn heading_text(address: u8, byte: u8) -> Text {
    let who = match address {
        BROADCAST => TEXTS.text("frame.broadcast"),
        address => TEXTS.text("frame.address").with("address", format_byte(address)),
    };
    let what = Command::from_byte(byte).map_or_else(|| TEXTS.text("command.unknown"), command_text);
    let flagged = byte & Frame::ERROR_BIT != 0;
    TEXTS
        .text(if flagged { "frame.heading_error" } else { "frame.heading" })
        .with_text("who", who)
        .with_text("command", what)
        .with("number", format_byte(byte & !Frame::ERROR_BIT))
}

fn request_text(arguments: &Arguments) -> Text {
    match arguments {
        Arguments::None => TEXTS.text("frame.request"),
        Arguments::Position(position) => {
            TEXTS.text("frame.request_position").with("position", position).with("word", format_word(*position))
        }
        Arguments::Channel(channel) => TEXTS.text("frame.request_channel").with("channel", format_byte(*channel)),
        Arguments::Read { field, address, count } => TEXTS
            .text(if *count == 1 { "frame.request_byte" } else { "frame.request_bytes" })
            .with("field", format_byte(*field))
            .with("count", count)
            .with("address", address),
        Arguments::Store { field, address, data } => TEXTS
            .text("frame.request_store")
            .with("field", format_byte(*field))
            .with("address", address)
            .with("bytes", hex(data)),
        Arguments::Field(field) => TEXTS.text("frame.request_field").with("field", format_byte(*field)),
        Arguments::Define { field, status } => TEXTS
            .text("frame.request_define")
            .with("field", format_byte(*field))
            .with_text("status", status_byte_text(*status)),
        Arguments::Code(code) => TEXTS.text("frame.request_code").with("number", code),
        Arguments::Address(address) => TEXTS.text("frame.request_address").with("address", address),
        Arguments::Settings(settings) => {
            TEXTS.text("frame.request_settings").with_text("settings", settings_byte_text(*settings))
        }
    }
}

fn request_error_text(error: RequestError) -> Text {
    match error {
        RequestError::Command(byte) => TEXTS.text("frame.no_command").with("command", format_byte(byte)),
        RequestError::Length { expected, got } => {
            TEXTS.text("frame.wrong_length").with("got", got).with("expected", expected)
        }
        RequestError::Argument(name) => TEXTS.text("frame.wrong_argument").with("name", name),
    }
}

fn status_code_text(code: StatusCode) -> Text {
    let named = status_with_number(code);
    if code == StatusCode::OK {
        return named;
    }
    TEXTS.text(if code.is_warning() { "frame.warning" } else { "frame.error" }).with_text("code", named)
}

fn reply_text(reply: &Reply) -> Text {
    match reply {
        Reply::Done => TEXTS.text("frame.done"),
        Reply::Position(raw) => TEXTS.text("frame.position").with("position", raw).with("word", format_word(*raw)),
        Reply::Analogue(value) => TEXTS.text("frame.value").with("value", value),
        Reply::Counter(value) => TEXTS.text("frame.counter").with("value", value),
        Reply::Data(bytes) => TEXTS.text("frame.data").with("bytes", hex(bytes)),
        Reply::FieldStatus(status) => TEXTS.text("frame.field_status").with_text("status", status_byte_text(*status)),
        Reply::FreeMemory(free) => TEXTS
            .text(if free.fields == 1 { "frame.free_one" } else { "frame.free" })
            .with("bytes", free.bytes())
            .with("fields", free.fields),
        Reply::Status(codes) => {
            TEXTS.text("frame.codes").with_list("codes", codes.iter().copied().map(status_with_number))
        }
        Reply::TypeLabel(label) => type_label(label),
        Reply::Serial(SerialLabel { serial_number, firmware_version, firmware_date, .. }) => TEXTS
            .text("frame.serial")
            .with("serial", serial_number)
            .with("version", firmware_version)
            .with("date", firmware_date),
    }
}

fn type_label(label: &TypeLabel) -> Text {
    let types = EncoderTypes::built_in();
    let name = types.find(label.encoder_type);
    TEXTS
        .text("frame.type_label")
        .with_text("settings", settings_byte_text(label.settings))
        .with("type", format_byte(label.encoder_type))
        .with_text("name", name.map_or_else(|| TEXTS.text("frame.unknown_type"), |row| literal_text(&row.name)))
        .with("bytes", label.eeprom_bytes())
        .with("options", format_byte(label.options))
}

fn status_byte_text(status: DataFieldStatus) -> Text {
    TEXTS.text("frame.byte").with("byte", format_byte(status.byte())).with_text("words", field_status(status))
}

fn settings_byte_text(settings: LineSettings) -> Text {
    TEXTS.text("frame.byte").with("byte", format_byte(settings.byte())).with_text("words", line_settings(settings))
}

fn format_byte(byte: u8) -> String {
    format!("{byte:02X}h")
}

fn format_word(raw: u32) -> String {
    format!("{raw:08X}h")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::Language;
    use crate::bits::parse_hex;
    use crate::devices::hiperface::protocol::describe_frame;

    fn texts(bytes: &str) -> Vec<Text> {
        describe_frame(&parse_hex(bytes).unwrap(), None).unwrap().iter().map(detail_text).collect()
    }

    #[test]
    fn decode_output_is_stable() {
        let cases = [
            ("40 42 02", "address 40h: read position (42h)|request"),
            ("40 42 00 0E 05 31 38", "address 40h: read position (42h)|reply: position 918833 (000E0531h)"),
            ("40 D0 0F 9F", "address 40h: read encoder status (50h, error bit set)|error 0Fh wrong access code"),
            (
                "40 50 1D 0D",
                "address 40h: read encoder status (50h)|warning 1Dh critical transmitter current (dirt or ageing)",
            ),
            ("40 4E 08 00 06", "address 40h: read available memory (4Eh)|reply: 128 bytes free, 0 data fields"),
            ("40 4E 08 01 07", "address 40h: read available memory (4Eh)|reply: 128 bytes free, 1 data fields"),
            ("40 4F 02 55 66 3E", "address 40h: change access code (4Fh)|request: access code 2"),
            (
                "40 4D 00 C9 55 91",
                "address 40h: create, change or delete a data field (4Dh)|request: set field 00h to C9h (32 bytes, \
                 writable, code 0, code required)",
            ),
            ("40 4B 01 05 02 66 08 15 76", "address 40h: store data (4Bh)|request: field 01h, from address 5: 08 15"),
            (
                "40 52 E4 22 80 01 55",
                "address 40h: read type label (52h)|reply: E4h (9600 8E1, time-out 44 bits, standard); type 22h \
                 SRS/SCK/SFS; EEPROM 2048 bytes; options 01h",
            ),
            ("FF 53 AC", "broadcast: reset (53h)|request"),
            ("40 41 01", "address 40h: unknown command (41h)|not a valid request: 41h is not a command"),
        ];
        for (bytes, expected) in cases {
            let words: Vec<String> = texts(bytes).iter().map(Text::terminal_text).collect();
            assert_eq!(words.join("|"), expected);
        }
    }

    #[test]
    fn translates_trace_to_german() {
        let cases = [
            ("40 42 02", "Adresse 40h: Position lesen (42h)|Anfrage"),
            (
                "40 D0 0F 9F",
                "Adresse 40h: Geberstatus lesen (50h, Fehlerbit gesetzt)|Fehler 0Fh falscher Zugriffsschlüssel",
            ),
            ("40 4E 08 01 07", "Adresse 40h: freien Speicher lesen (4Eh)|Antwort: 128 Bytes frei, 1 Datenfeld"),
            ("40 41 01", "Adresse 40h: unbekannter Befehl (41h)|keine gültige Anfrage: 41h ist kein Befehl"),
        ];
        for (bytes, expected) in cases {
            let words: Vec<String> = texts(bytes).iter().map(|text| text.to_string_in(Language::German)).collect();
            assert_eq!(words.join("|"), expected);
        }
    }
}
