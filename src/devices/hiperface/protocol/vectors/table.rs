//! The golden vectors as Rust values: each request with its bytes, and each reply with its bytes and meaning.

use super::bytes;
use crate::devices::hiperface::protocol::*;

pub(super) struct Vector {
    pub(super) address: u8,
    pub(super) request: Request,
    pub(super) bytes: &'static str,
    /// Bytes and decoded meaning of each reply.
    pub(super) replies: Vec<(&'static str, Answer)>,
}

const CODE: AccessCode = AccessCode::FACTORY;
const CODE_66: AccessCode = AccessCode::new(0x66);

fn vector(address: u8, request: Request, bytes: &'static str) -> Vector {
    Vector { address, request, bytes, replies: Vec::new() }
}

fn standard_vector(request: Request, bytes: &'static str) -> Vector {
    vector(0x40, request, bytes)
}

impl Vector {
    /// Adds a reply without the error bit.
    fn with_reply(mut self, bytes: &'static str, reply: Reply) -> Self {
        self.replies.push((bytes, Answer::Reply { pending: false, reply }));
        self
    }

    /// Adds a reply with the error bit.
    fn with_warning_reply(mut self, bytes: &'static str, reply: Reply) -> Self {
        self.replies.push((bytes, Answer::Reply { pending: true, reply }));
        self
    }

    fn with_empty_reply(self, bytes: &'static str) -> Self {
        self.with_reply(bytes, Reply::Done)
    }
}

fn set_position(position: u32) -> Request {
    Request::SetPosition { position, code0: CODE }
}

fn synchronise_reply(position: u32) -> Request {
    Request::Synchronise { position, code0: CODE }
}

fn read(field: u8, address: u8, count: u8, code: AccessCode) -> Request {
    Request::ReadData { field, address, count, code }
}

fn store_request(field: u8, address: u8, code: AccessCode, data: &[u8]) -> Request {
    Request::StoreData { field, address, code, data: data.to_vec() }
}

fn define_request(field: u8, status: u8, code: AccessCode) -> Request {
    Request::DefineField { field, status: DataFieldStatus::from_byte(status), code }
}

fn change_code(number: u8, old: AccessCode, new: AccessCode) -> Request {
    Request::ChangeCode { number: AccessCodeNumber::new(number).unwrap(), old, new }
}

fn set_address(new: u8) -> Request {
    Request::SetAddress { new: DeviceAddress::new(new).unwrap(), code0: CODE }
}

fn configure_request(settings: u8) -> Request {
    Request::ConfigureLine { settings: LineSettings::from_byte(settings), code0: CODE }
}

fn configure_temporarily(settings: u8) -> Request {
    Request::ConfigureLineTemporarily { settings: LineSettings::from_byte(settings) }
}

fn field_status(byte: u8) -> Reply {
    Reply::FieldStatus(DataFieldStatus::from_byte(byte))
}

fn free_memory_reply(blocks: u8, fields: u8) -> Reply {
    Reply::FreeMemory(FreeMemory { blocks, fields })
}

fn status(codes: &[u8]) -> Reply {
    Reply::Status(codes.iter().copied().map(StatusCode::new).collect())
}

fn type_label(encoder_type: u8) -> Reply {
    let settings = LineSettings::FACTORY;
    Reply::TypeLabel(TypeLabel { settings, encoder_type, eeprom_units: 0x80, options: 0x01 })
}

/// Returns all requests of the vector file, with their replies.
#[rustfmt::skip]
pub(super) fn all_vectors() -> Vec<Vector> {
    let serial = SerialLabel {
        serial_number: "GB0450179".to_owned(),
        firmware_version: "V1.23".to_owned(),
        firmware_date: "01.02.16".to_owned(),
    };
    vec![
        // Example of a data field definition in the manual.
        standard_vector(Request::FreeMemory, "40 4E 0E")
            .with_reply("40 4E 08 00 06", free_memory_reply(8, 0))
            .with_reply("40 4E 06 01 09", free_memory_reply(6, 1))
            .with_reply("40 4E 05 02 09", free_memory_reply(5, 2))
            .with_reply("40 4E 70 00 7E", free_memory_reply(112, 0)),
        standard_vector(define_request(0, 0xC9, CODE), "40 4D 00 C9 55 91").with_empty_reply("40 4D 00 C9 C4"),
        standard_vector(define_request(1, 0xE0, CODE), "40 4D 01 E0 55 B9").with_empty_reply("40 4D 01 E0 EC"),
        standard_vector(define_request(1, 0xE8, CODE), "40 4D 01 E8 55 B1").with_empty_reply("40 4D 01 E8 E4"),
        standard_vector(change_code(2, CODE, CODE_66), "40 4F 02 55 66 3E").with_empty_reply("40 4F 02 0D"),
        standard_vector(store_request(1, 5, CODE_66, &[0x08, 0x15]), "40 4B 01 05 02 66 08 15 76").with_empty_reply("40 4B 01 05 02 0D"),
        // Position.
        standard_vector(Request::ReadPosition, "40 42 02")
            .with_reply("40 42 00 0E 05 31 38", Reply::Position(918_833))
            .with_reply("40 42 00 00 A5 A5 02", Reply::Position(42_405))
            .with_warning_reply("40 C2 00 01 23 45 E5", Reply::Position(74_565))
            .with_reply("40 42 07 FF FF FF FA", Reply::Position(134_217_727)),
        vector(BROADCAST, Request::ReadPosition, "FF 42 BD"),
        vector(0x41, Request::ReadPosition, "41 42 03"),
        vector(0x5F, Request::ReadPosition, "5F 42 1D"),
        standard_vector(set_position(0), "40 43 00 00 00 00 55 56").with_empty_reply("40 43 03"),
        standard_vector(set_position(4660), "40 43 00 00 12 34 55 70"),
        standard_vector(set_position(111), "40 43 00 00 00 6F 55 39"),
        standard_vector(synchronise_reply(0), "40 63 00 00 00 00 55 76").with_empty_reply("40 63 23"),
        standard_vector(synchronise_reply(4660), "40 63 00 00 12 34 55 50"),
        // Analogue values and counter.
        standard_vector(Request::ReadAnalogue { channel: 0x48 }, "40 44 48 4C")
            .with_reply("40 44 48 00 2A 66", Reply::Analogue(42))
            .with_reply("40 44 48 FF F6 45", Reply::Analogue(-10)),
        standard_vector(Request::ReadAnalogue { channel: 0 }, "40 44 00 04").with_reply("40 44 00 01 FF FA", Reply::Analogue(511)),
        standard_vector(Request::ReadAnalogue { channel: 1 }, "40 44 01 05"),
        standard_vector(Request::ReadCounter, "40 46 06")
            .with_reply("40 46 01 23 45 61", Reply::Counter(74_565))
            .with_reply("40 46 00 00 00 06", Reply::Counter(0))
            .with_reply("40 46 FF FF FF F9", Reply::Counter(16_777_215)),
        standard_vector(Request::IncrementCounter, "40 47 07").with_empty_reply("40 47 07"),
        standard_vector(Request::ClearCounter { code0: CODE }, "40 49 55 5C").with_empty_reply("40 49 09"),
        // Data fields.
        standard_vector(read(1, 5, 2, CODE_66), "40 4A 01 05 02 66 6A")
            .with_reply("40 4A 01 05 02 08 15 11", Reply::Data(vec![0x08, 0x15])),
        standard_vector(store_request(0, 0, CODE, &[0xDE, 0xAD, 0xBE, 0xEF]), "40 4B 00 00 04 55 DE AD BE EF 78").with_empty_reply("40 4B 00 00 04 0F"),
        standard_vector(read(0, 0, 4, CODE), "40 4A 00 00 04 55 5B")
            .with_reply("40 4A 00 00 04 DE AD BE EF 2C", Reply::Data(vec![0xDE, 0xAD, 0xBE, 0xEF])),
        standard_vector(Request::FieldStatus { field: 1 }, "40 4C 01 0D").with_reply("40 4C 01 E0 ED", field_status(0xE0)),
        standard_vector(Request::FieldStatus { field: EXTENDED_LABEL_FIELD }, "40 4C FF F3")
            .with_reply("40 4C FF 83 70", field_status(0x83))
            .with_reply("40 4C FF 8B 78", field_status(0x8B)),
        standard_vector(define_request(0, 0xCF, CODE), "40 4D 00 CF 55 97"),
        standard_vector(define_request(1, 0xA8, CODE_66), "40 4D 01 A8 66 C2").with_empty_reply("40 4D 01 A8 A4"),
        standard_vector(define_request(1, 0x68, CODE_66), "40 4D 01 68 66 02").with_empty_reply("40 4D 01 68 64"),
        standard_vector(define_request(1, 0x60, CODE_66), "40 4D 01 60 66 0A"),
        standard_vector(change_code(2, AccessCode::new(0x00), CODE_66), "40 4F 02 00 66 6B"),
        // Status, labels, reset.
        standard_vector(Request::ReadStatus, "40 50 10")
            .with_reply("40 50 00 10", status(&[0x00]))
            .with_reply("40 50 08 1E 06", status(&[0x08, 0x1E])),
        vector(BROADCAST, Request::ReadStatus, "FF 50 AF"),
        standard_vector(Request::ReadTypeLabel, "40 52 12")
            .with_reply("40 52 E4 22 80 01 55", type_label(0x22))
            .with_reply("40 52 E4 37 80 01 40", type_label(0x37))
            .with_reply("40 52 E4 47 80 01 30", type_label(0x47))
            .with_reply("40 52 E4 FF 80 01 88", type_label(TypeLabel::EXTENDED)),
        standard_vector(Request::Reset, "40 53 13"),
        vector(BROADCAST, Request::Reset, "FF 53 AC"),
        standard_vector(Request::ReadSerial, "40 56 16").with_reply(
            "40 56 47 42 30 34 35 30 31 37 39 56 31 2E 32 33 30 31 2E 30 32 2E 31 36 61",
            Reply::Serial(serial),
        ),
        // Address and interface. The replies exist with and without the repeated argument.
        standard_vector(set_address(0x41), "40 55 41 55 01")
            .with_empty_reply("40 55 41 54").with_empty_reply("40 55 15").with_empty_reply("41 55 41 55").with_empty_reply("41 55 14"),
        standard_vector(set_address(0x45), "40 55 45 55 05"),
        standard_vector(configure_request(0xE5), "40 57 E5 55 A7").with_empty_reply("40 57 E5 F2").with_empty_reply("40 57 17"),
        standard_vector(configure_request(0xE4), "40 57 E4 55 A6"),
        standard_vector(configure_request(0x85), "40 57 85 55 C7"),
        standard_vector(configure_temporarily(0xE6), "40 67 E6 C1").with_empty_reply("40 67 E6 C1").with_empty_reply("40 67 27"),
        standard_vector(configure_temporarily(0xE4), "40 67 E4 C3"),
        standard_vector(configure_temporarily(0xF4), "40 67 F4 D3"),
        // Extended label.
        standard_vector(read(EXTENDED_LABEL_FIELD, 0, 10, CODE), "40 4A FF 00 0A 55 AA").with_reply(
            "40 4A FF 00 0A 53 00 00 00 00 10 00 00 10 00 AC",
            Reply::Data(vec![0x53, 0, 0, 0, 0, 0x10, 0, 0, 0x10, 0]),
        ),
        standard_vector(read(EXTENDED_LABEL_FIELD, 0, 64, CODE), "40 4A FF 00 40 55 E0"),
    ]
}

#[test]
fn type_37_position_has_turns() {
    let geometry = EncoderTypes::built_in().find(0x37).unwrap().geometry.unwrap();
    let position = geometry.position(0x000E_0531);
    assert_eq!((position.turns(), position.steps()), (Some(224), Some(1329)));
    assert!((position.degrees().unwrap() - 116.806_640_625).abs() < 1e-9);
}

#[test]
fn requests_and_replies_match_table() {
    for vector in all_vectors() {
        let line = bytes(vector.bytes);
        assert_eq!(vector.request.emit(vector.address).bytes(), line, "{}", vector.bytes);
        assert_eq!(Request::parse(&Frame::parse(&line).unwrap()), Ok(vector.request.clone()), "{}", vector.bytes);
        for (reply, expected) in vector.replies {
            assert_eq!(vector.request.parse_reply(vector.address, &bytes(reply)), Ok(expected), "{reply}");
        }
    }
}

/// Requests with different access codes are not equal, even though both are displayed without their code.
#[test]
fn requests_with_different_codes_differ() {
    assert_ne!(read(1, 5, 2, CODE), read(1, 5, 2, CODE_66));
    assert_ne!(change_code(2, CODE, CODE_66), change_code(2, CODE_66, CODE));
}

#[test]
fn error_replies_reject_request() {
    let wrong_old = change_code(2, AccessCode::new(0x00), CODE_66);
    let cases = [
        ("40 50 01 11", false, 1),
        ("40 50 07 17", false, 7),
        ("40 50 08 18", false, 8),
        ("40 50 09 19", false, 9),
        ("40 50 0A 1A", false, 10),
        ("40 50 0B 1B", false, 11),
        ("40 50 0C 1C", false, 12),
        ("40 50 0D 1D", false, 13),
        ("40 50 0E 1E", false, 14),
        ("40 50 0F 1F", false, 15),
        ("40 D0 0F 9F", true, 15),
        ("40 50 10 00", false, 16),
        ("40 D0 11 81", true, 17),
        ("40 50 12 02", false, 18),
        ("40 50 1D 0D", false, 29),
        ("40 50 1E 0E", false, 30),
        ("40 D0 1E 8E", true, 30),
        ("40 50 1F 0F", false, 31),
        ("40 50 20 30", false, 32),
    ];
    for (line, pending, code) in cases {
        let codes = vec![StatusCode::new(code)];
        let rejected = Ok(Answer::Rejected { pending, codes: codes.clone() });
        assert_eq!(wrong_old.parse_reply(0x40, &bytes(line)), rejected, "{line}");
        assert_eq!(Request::ReadPosition.parse_reply(BROADCAST, &bytes(line)), rejected, "{line}");
        let told = Ok(Answer::Reply { pending, reply: Reply::Status(codes) });
        assert_eq!(Request::ReadStatus.parse_reply(0x40, &bytes(line)), told, "{line}");
    }
    assert_eq!(StatusCode::new(15), StatusCode::WRONG_CODE);
}

#[test]
fn reports_wrong_checksums() {
    let misprint = Frame::parse(&bytes("40 4D 01 E0 55 69")).unwrap_err();
    assert_eq!(misprint, FrameError::Checksum { expected: 0xB9, got: 0x69 });
    let other = Frame::parse(&bytes("40 42 03")).unwrap_err();
    assert_eq!(other, FrameError::Checksum { expected: 0x02, got: 0x03 });
}

#[test]
fn silence_within_request_yields_no_frame() {
    for vector in all_vectors() {
        let line = bytes(vector.bytes);
        for gap in 1..line.len() {
            let (head, tail) = line.split_at(gap);
            // An XOR checksum may match by chance, as in the first half of 40 43 00 …. In this case, the command or its
            // length is wrong.
            for half in [head, tail] {
                let request = Frame::parse(half).map(|frame| Request::parse(&frame));
                assert!(!matches!(request, Ok(Ok(_))), "{} cut at {gap}", vector.bytes);
            }
        }
    }
}

#[test]
fn rejects_unexpected_sender() {
    let from_41 = bytes("41 42 00 0E 05 31 39");
    let mismatch = Err(ReplyError::Address { expected: 0x40, got: 0x41 });
    assert_eq!(Request::ReadPosition.parse_reply(0x40, &from_41), mismatch);
    let position = Answer::Reply { pending: false, reply: Reply::Position(918_833) };
    assert_eq!(Request::ReadPosition.parse_reply(BROADCAST, &from_41), Ok(position));
    let done = Answer::Reply { pending: false, reply: Reply::Done };
    assert_eq!(set_address(0x41).parse_reply(0x40, &bytes("41 55 41 55")), Ok(done));
    let mismatch = Err(ReplyError::Address { expected: 0x40, got: 0x42 });
    assert_eq!(set_address(0x41).parse_reply(0x40, &bytes("42 55 41 56")), mismatch);
    let echo = Err(ReplyError::Address { expected: BROADCAST, got: BROADCAST });
    assert_eq!(Request::IncrementCounter.parse_reply(BROADCAST, &bytes("FF 47 B8")), echo);
}

#[test]
fn rejects_wrong_lengths_and_arguments() {
    let length = |command, got| ReplyError::Length { command, got };
    let other = |expected, got| ReplyError::Command { expected, got };
    let cases = [
        (Request::ReadPosition, "40 42 0E 05 31 38", length(0x42, 3)),
        (Request::ReadPosition, "40 46 01 23 45 61", other(0x42, 0x46)),
        (Request::ReadPosition, "40 53 13", other(0x42, 0x53)),
        (Request::Reset, "40 53 13", length(0x53, 0)),
        (Request::ReadAnalogue { channel: 0x48 }, "40 44 49 00 2A 67", ReplyError::Argument),
        (read(1, 5, 2, CODE_66), "40 4A 02 05 02 08 15 12", ReplyError::Argument),
        (read(1, 5, 2, CODE_66), "40 4A 01 06 02 08 15 12", ReplyError::Argument),
        (read(1, 5, 2, CODE_66), "40 4A 01 05 03 08 15 10", ReplyError::Argument),
        (read(1, 5, 2, CODE_66), "40 4A 01 05 02 08 04", length(0x4A, 4)),
        (read(1, 5, 2, CODE_66), "40 4A 01 05 02 08 15 00 11", length(0x4A, 6)),
        (store_request(1, 5, CODE_66, &[8, 21]), "40 4B 00 05 02 0C", ReplyError::Argument),
        (store_request(1, 5, CODE_66, &[8, 21]), "40 4B 01 04 02 0C", ReplyError::Argument),
        (store_request(1, 5, CODE_66, &[8, 21]), "40 4B 01 05 01 0E", ReplyError::Argument),
        (Request::FieldStatus { field: 1 }, "40 4C 00 E0 EC", ReplyError::Argument),
        (define_request(0, 0xC9, CODE), "40 4D 01 C9 C5", ReplyError::Argument),
        (define_request(0, 0xC9, CODE), "40 4D 00 C8 C5", ReplyError::Argument),
        (change_code(2, CODE, CODE_66), "40 4F 03 0C", ReplyError::Argument),
        (set_address(0x41), "40 55 42 57", ReplyError::Argument),
        (configure_request(0xE5), "40 57 E4 F3", ReplyError::Argument),
        (configure_temporarily(0xE6), "40 67 E4 C3", ReplyError::Argument),
        (Request::ReadStatus, "40 50 10", length(0x50, 0)),
        (Request::ReadStatus, "40 50 01 02 03 04 05 11", length(0x50, 5)),
    ];
    for (request, line, error) in cases {
        assert_eq!(request.parse_reply(0x40, &bytes(line)), Err(error), "{line}");
    }
}
