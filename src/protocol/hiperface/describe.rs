//! Frames in words, for `decode` and the trace. It never shows an access code.

use super::{
    BROADCAST, CodeNumber, Command, DataFieldStatus, DeviceAddress, EncoderTypes, Frame, FrameError, LineSettings,
    Reply, Request, StatusCode,
};
use crate::bits::hex;

/// What a captured frame says, one sentence a line. `request` is the request before it, when the frame may be its reply.
///
/// # Errors
/// When the bytes are no frame.
pub fn describe(bytes: &[u8], request: Option<&Request>) -> Result<Vec<String>, FrameError> {
    let frame = Frame::parse(bytes)?;
    let mut lines = vec![heading(&frame)];
    if let Some(answer) = request.and_then(|request| request.parse_reply(frame.address, bytes).ok()) {
        lines.extend(describe_answer(&answer));
        return Ok(lines);
    }
    match Request::parse(&frame) {
        Ok(request) => lines.push(describe_request(&request)),
        Err(error) => match guess_reply(&frame, bytes) {
            Some(answer) => lines.extend(describe_answer(&answer)),
            None => lines.push(format!("as a request: {error}")),
        },
    }
    Ok(lines)
}

fn heading(frame: &Frame<'_>) -> String {
    let who = match frame.address {
        BROADCAST => "broadcast".to_owned(),
        address => format!("address {address:02X}h"),
    };
    let what = Command::from_byte(frame.command).map_or("unknown command", |command| command.row().name);
    let flag = if frame.command & Frame::ERROR_BIT != 0 { ", error bit set" } else { "" };
    format!("{who}: {what} ({:02X}h{flag})", frame.command & 0x7F)
}

/// A reply is recognised without its request wherever its length tells it from one.
fn guess_reply(frame: &Frame<'_>, bytes: &[u8]) -> Option<super::Answer> {
    let code = super::AccessCode::FACTORY;
    let candidate = match (Command::from_byte(frame.command)?, frame.payload) {
        (Command::ReadPosition, _) => Request::ReadPosition,
        (Command::SetPosition, _) => Request::SetPosition { position: 0, code0: code },
        (Command::ReadAnalogue, [channel, ..]) => Request::ReadAnalogue { channel: *channel },
        (Command::ReadCounter, _) => Request::ReadCounter,
        (Command::ClearCounter, _) => Request::ClearCounter { code0: code },
        (Command::ReadData, [field, address, count, ..]) => {
            Request::ReadData { field: *field, address: *address, count: *count, code }
        }
        (Command::StoreData, [field, address, count]) => {
            Request::StoreData { field: *field, address: *address, code, data: vec![0; usize::from(*count)] }
        }
        (Command::FieldStatus, [field, ..]) => Request::FieldStatus { field: *field },
        (Command::DefineField, [field, status]) => {
            Request::DefineField { field: *field, status: DataFieldStatus::from_byte(*status), code }
        }
        (Command::FreeMemory, _) => Request::FreeMemory,
        (Command::ChangeCode, [number]) => {
            Request::ChangeCode { number: CodeNumber::new(*number)?, old: code, new: code }
        }
        (Command::ReadStatus, _) => Request::ReadStatus,
        (Command::ReadTypeLabel, _) => Request::ReadTypeLabel,
        (Command::SetAddress, [new]) => Request::SetAddress { new: DeviceAddress::new(*new)?, code0: code },
        (Command::ReadSerial, _) => Request::ReadSerial,
        (Command::ConfigureLine, [settings]) => {
            Request::ConfigureLine { settings: LineSettings::from_byte(*settings), code0: code }
        }
        (Command::Synchronise, _) => Request::Synchronise { position: 0, code0: code },
        _ => return None,
    };
    candidate.parse_reply(frame.address, bytes).ok()
}

fn describe_request(request: &Request) -> String {
    match request {
        Request::SetPosition { position, .. } | Request::Synchronise { position, .. } => {
            format!("request: position {position} ({position:08X}h)")
        }
        Request::ReadAnalogue { channel } => format!("request: channel {channel:02X}h"),
        Request::ReadData { field, address, count, .. } => {
            format!("request: field {field:02X}h, {count} bytes from address {address}")
        }
        Request::StoreData { field, address, data, .. } => {
            format!("request: field {field:02X}h, from address {address}: {}", hex(data))
        }
        Request::FieldStatus { field } => format!("request: field {field:02X}h"),
        Request::DefineField { field, status, .. } => format!("request: field {field:02X}h becomes {status:?}"),
        Request::ChangeCode { number, .. } => format!("request: access code {number}"),
        Request::SetAddress { new, .. } => format!("request: new address {new}"),
        Request::ConfigureLine { settings, .. } | Request::ConfigureLineTemporarily { settings } => {
            format!("request: {settings:?}")
        }
        _ => "request".to_owned(),
    }
}

fn describe_answer(answer: &super::Answer) -> Vec<String> {
    let code_line = |code: &StatusCode| {
        let kind = if code.is_warning() { "warning" } else { "error" };
        if *code == StatusCode::OK { code.to_string() } else { format!("{kind} {code}") }
    };
    match answer {
        super::Answer::Rejected { codes, .. } => codes.iter().map(|c| format!("refused: {}", code_line(c))).collect(),
        super::Answer::Reply { reply: Reply::Status(codes), .. } => codes.iter().map(code_line).collect(),
        super::Answer::Reply { reply, .. } => vec![format!("reply: {}", describe_reply(reply))],
    }
}

fn describe_reply(reply: &Reply) -> String {
    match reply {
        Reply::Done => "done".to_owned(),
        Reply::Position(raw) => format!("position {raw} ({raw:08X}h)"),
        Reply::Analogue(value) => format!("value {value}"),
        Reply::Counter(value) => format!("counter {value}"),
        Reply::Data(bytes) => format!("data {}", hex(bytes)),
        Reply::FieldStatus(status) => format!("status {status:?}"),
        Reply::FreeMemory(free) => format!("{} bytes free, {} data fields", free.bytes(), free.fields),
        Reply::Status(codes) => codes.iter().map(ToString::to_string).collect::<Vec<_>>().join(", "),
        Reply::TypeLabel(label) => {
            let types = EncoderTypes::built_in();
            let name = types.find(label.encoder_type).map_or("unknown type", |row| row.name.as_str());
            format!(
                "{:?}; type {:02X}h {name}; EEPROM {} bytes; options {:02X}h",
                label.settings,
                label.encoder_type,
                label.eeprom_bytes(),
                label.options
            )
        }
        Reply::Serial(label) => format!(
            "serial number {}, firmware {} of {}",
            label.serial_number, label.firmware_version, label.firmware_date
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bits::parse_hex;

    #[test]
    fn frames_in_words() {
        let cases = [
            ("40 42 02", "address 40h: read position (42h)|request"),
            ("40 42 00 0E 05 31 38", "address 40h: read position (42h)|reply: position 918833 (000E0531h)"),
            ("40 D0 0F 9F", "address 40h: read encoder status (50h, error bit set)|error 0Fh wrong access code"),
            ("40 4E 08 00 06", "address 40h: read available memory (4Eh)|reply: 128 bytes free, 0 data fields"),
            ("40 4F 02 55 66 3E", "address 40h: change access code (4Fh)|request: access code 2"),
            ("40 4D 00 C9 C4", "address 40h: create, change or delete a data field (4Dh)|reply: done"),
            ("40 4F 02 0D", "address 40h: change access code (4Fh)|reply: done"),
            ("40 4B 01 05 02 0D", "address 40h: store data (4Bh)|reply: done"),
            ("40 43 03", "address 40h: set position (43h)|reply: done"),
            ("40 57 E5 F2", "address 40h: configure serial interface (57h)|reply: done"),
            ("FF 53 AC", "broadcast: reset (53h)|request"),
            ("40 41 01", "address 40h: unknown command (41h)|as a request: 41h is not a command"),
        ];
        for (bytes, expected) in cases {
            let lines = describe(&parse_hex(bytes).unwrap(), None).unwrap();
            assert_eq!(lines.join("|"), expected);
        }
    }

    #[test]
    fn the_wrong_checksum_of_the_manual_is_told() {
        let wrong = parse_hex("40 4D 01 E0 55 69").unwrap();
        assert_eq!(describe(&wrong, None), Err(FrameError::Checksum { expected: 0xB9, got: 0x69 }));
    }

    #[test]
    fn a_refusal_is_told_from_its_request() {
        let request = Request::ReadPosition;
        let lines = describe(&parse_hex("40 50 1F 0F").unwrap(), Some(&request)).unwrap();
        assert_eq!(lines.last().unwrap(), "refused: error 1Fh speed too high, no position possible");
    }
}
