//! Tests of frames, requests and replies with the golden vectors in `tests/vectors/hiperface.txt`, and with damaged
//! frames and noise.
//!
//! [`table`] contains the same vectors as Rust values.

use std::collections::BTreeSet;

use proptest::prelude::*;

use super::*;
use crate::bits::hex;

mod table;

const FILE: &str = include_str!("../../../../tests/vectors/hiperface.txt");

/// Kind of line in the vector file, as given by its first character.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Request,
    Reply,
    ErrorFrame,
    NotAReply,
    NotAFrame,
    LabelContent,
    SingleByte,
}

/// A line of the vector file, with its meaning from the `=` line below it and the request above it.
#[derive(Debug)]
struct Line {
    number: usize,
    kind: Kind,
    bytes: Vec<u8>,
    meaning: &'static str,
    request: Option<Vec<u8>>,
}

/// Parses bytes written in hexadecimal digits. The notation `0*30` means thirty zero bytes.
fn bytes(text: &str) -> Vec<u8> {
    text.split(' ')
        .flat_map(|word| match word.strip_prefix("0*") {
            Some(count) => vec![0; count.parse().unwrap()],
            None => vec![u8::from_str_radix(word, 16).unwrap()],
        })
        .collect()
}

fn vector_lines() -> Vec<Line> {
    let mut lines: Vec<Line> = Vec::new();
    let mut request = None;
    for (number, text) in (1..).zip(FILE.lines()) {
        if text.is_empty() || text.starts_with('#') {
            continue;
        }
        if text.starts_with('[') {
            assert!(text.split_once("] ").is_some_and(|(_, source)| !source.is_empty()), "line {number}: no source");
            request = None;
            continue;
        }
        let (mark, rest) = text.split_once(' ').unwrap();
        let kind = match mark {
            ">" => Kind::Request,
            "<" => Kind::Reply,
            "!" => Kind::ErrorFrame,
            "-" => Kind::NotAReply,
            "x" => Kind::NotAFrame,
            "*" => Kind::LabelContent,
            "?" => Kind::SingleByte,
            "=" => {
                lines.last_mut().unwrap().meaning = rest;
                continue;
            }
            _ => panic!("line {number}: {text}"),
        };
        let bytes = bytes(rest);
        if kind == Kind::Request {
            request = Some(bytes.clone());
        }
        lines.push(Line { number, kind, bytes, meaning: "", request: request.clone() });
    }
    lines
}

fn lines_by_kind(kind: Kind) -> impl Iterator<Item = Line> {
    vector_lines().into_iter().filter(move |line| line.kind == kind)
}

impl Line {
    /// Returns the request above the line, and the address in that request.
    fn requested_frame(&self) -> (Request, u8) {
        let bytes = self.request.as_deref().unwrap();
        (Request::parse(&Frame::parse(bytes).unwrap()).unwrap(), bytes[0])
    }
}

/// Returns whether the XOR of a frame is zero, independently of the function under test.
fn has_zero_xor(bytes: &[u8]) -> bool {
    let mut sum = 0;
    for byte in bytes {
        sum ^= byte;
    }
    sum == 0
}

#[test]
fn vector_frames_have_valid_checksums() {
    for line in vector_lines() {
        match line.kind {
            Kind::SingleByte => {}
            Kind::NotAFrame => {
                assert!(line.bytes.len() < 3 || !has_zero_xor(&line.bytes), "line {}", line.number);
                assert!(Frame::parse(&line.bytes).is_err(), "line {}", line.number);
            }
            Kind::LabelContent => assert!(has_zero_xor(&line.bytes), "line {}", line.number),
            _ => {
                assert!(has_zero_xor(&line.bytes), "line {}", line.number);
                let frame = Frame::parse(&line.bytes).unwrap();
                assert_eq!(frame.emit(), line.bytes, "line {}", line.number);
            }
        }
    }
}

#[test]
fn vector_requests_round_trip() {
    for line in lines_by_kind(Kind::Request) {
        let (request, address) = line.requested_frame();
        assert_eq!(request.emit(address).bytes(), line.bytes, "line {}", line.number);
    }
}

#[test]
fn vector_replies_match_requests() {
    for line in lines_by_kind(Kind::Reply) {
        let (request, address) = line.requested_frame();
        let answer = request.parse_reply(address, &line.bytes);
        assert!(matches!(answer, Ok(Answer::Reply { .. })), "line {}: {answer:?}", line.number);
        let length = request.reply_length(&line.bytes).unwrap();
        assert!((length.min..=length.max).contains(&line.bytes.len()), "line {}: {length:?}", line.number);
    }
}

#[test]
fn error_frames_parse_as_rejection_and_status() {
    for line in lines_by_kind(Kind::ErrorFrame) {
        let pending = line.bytes[1] == 0xD0;
        let codes = vec![StatusCode::new(line.bytes[2])];
        let refused = Request::FreeMemory.parse_reply(0x40, &line.bytes);
        assert_eq!(refused, Ok(Answer::Rejected { pending, codes: codes.clone() }), "line {}", line.number);
        let told = Request::ReadStatus.parse_reply(0x40, &line.bytes);
        assert_eq!(told, Ok(Answer::Reply { pending, reply: Reply::Status(codes) }), "line {}", line.number);
    }
}

#[test]
fn rejects_non_reply_frames() {
    for line in lines_by_kind(Kind::NotAReply) {
        let (request, address) = line.requested_frame();
        let answer = request.parse_reply(address, &line.bytes);
        assert!(!matches!(answer, Ok(_) | Err(ReplyError::Frame(_))), "line {}: {answer:?}", line.number);
    }
}

#[test]
fn rejects_corrupt_replies() {
    for line in vector_lines() {
        let asked = match line.kind {
            Kind::Reply => vec![line.requested_frame()],
            Kind::ErrorFrame => vec![(Request::ReadStatus, 0x40), (Request::ReadPosition, 0x40)],
            _ => continue,
        };
        for (request, address) in asked {
            for cut in 0..line.bytes.len() {
                let answer = request.parse_reply(address, &line.bytes[..cut]);
                assert!(answer.is_err(), "line {} cut at {cut}: {answer:?}", line.number);
            }
            for bit in 0..line.bytes.len() * 8 {
                let mut damaged = line.bytes.clone();
                damaged[bit / 8] ^= 1 << (bit % 8);
                let answer = request.parse_reply(address, &damaged);
                assert!(matches!(answer, Err(ReplyError::Frame(_))), "line {} bit {bit}: {answer:?}", line.number);
            }
        }
    }
}

#[test]
fn decodes_single_byte_vectors() {
    for line in lines_by_kind(Kind::SingleByte) {
        let (what, text) = line.meaning.split_once(": ").unwrap();
        let words: Vec<&str> = text.split(", ").collect();
        match what {
            "field" => {
                let status = DataFieldStatus::from_byte(line.bytes[0]);
                let shown = [
                    if status.exists() { "exists" } else { "does not exist" }.to_owned(),
                    if status.is_writable() { "writable" } else { "protected" }.to_owned(),
                    format!("code {}", status.code()),
                    if status.code_required() { "required" } else { "not required" }.to_owned(),
                    status.size().bytes().to_string(),
                ];
                assert_eq!(shown.as_slice(), words, "line {}", line.number);
            }
            "settings" => {
                let settings = LineSettings::from_byte(line.bytes[0]);
                let format = settings.character_format().unwrap();
                let shown = [
                    if settings.is_bus() { "bus" } else { "standard" }.to_owned(),
                    if settings.has_long_timeout() { "44" } else { "11" }.to_owned(),
                    format!("{:?}", format.parity).to_lowercase(),
                    format.baud.to_string(),
                ];
                assert_eq!(shown.as_slice(), words, "line {}", line.number);
            }
            _ => panic!("line {}", line.number),
        }
    }
}

#[test]
fn parses_label_vector() {
    let content = lines_by_kind(Kind::LabelContent).next().unwrap().bytes;
    assert_eq!(content.len(), 64);
    let label = ExtendedLabel::parse(&content).unwrap();
    let expected = ExtendedLabel {
        checksum_fits: true,
        flags: 0,
        geometry: Some(Geometry::Rotary { periods: 16, turns: 4096 }),
        designation: "SEL37-HFB0-K02".to_owned(),
        parameters: vec![LabelParameter { number: 0, value: 0x48 }, LabelParameter { number: 1, value: 115 }],
    };
    assert_eq!(label, expected);
}

/// Each vector must be in both lists.
#[test]
fn vector_file_matches_table() {
    let mut file = BTreeSet::new();
    for line in vector_lines() {
        match line.kind {
            Kind::Request => file.insert(format!("> {}", hex(&line.bytes))),
            Kind::Reply => file.insert(format!("< {}", hex(&line.bytes))),
            _ => false,
        };
    }
    let mut table = BTreeSet::new();
    for vector in table::all_vectors() {
        table.insert(format!("> {}", vector.bytes));
        table.extend(vector.replies.iter().map(|(reply, _)| format!("< {reply}")));
    }
    assert_eq!(file.difference(&table).collect::<Vec<_>>(), Vec::<&String>::new(), "only in the file");
    assert_eq!(table.difference(&file).collect::<Vec<_>>(), Vec::<&String>::new(), "only in the table");
}

/// Returns random bytes, of which half are frames with a valid checksum.
fn noise_bytes() -> impl Strategy<Value = Vec<u8>> {
    let payload = proptest::collection::vec(any::<u8>(), 0..160);
    let command = prop_oneof![any::<u8>(), (0..COMMANDS.len()).prop_map(|at| COMMANDS[at].command.byte())];
    (any::<bool>(), prop_oneof![Just(0x40), any::<u8>()], command, payload).prop_map(
        |(framed, address, command, rest)| {
            let mut bytes = [vec![address, command], rest].concat();
            if framed {
                bytes.push(checksum(&bytes));
            }
            bytes
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1024))]

    #[test]
    fn noise_never_panics(bytes in noise_bytes(), address: u8) {
        let _ = describe_frame(&bytes, None);
        for vector in table::all_vectors() {
            let _ = vector.request.parse_reply(address, &bytes);
            let _ = vector.request.parse_reply(0x40, &bytes);
            let _ = vector.request.reply_length(&bytes);
            let _ = describe_frame(&bytes, Some(&vector.request));
        }
        if let Ok(request) = Frame::parse(&bytes).map_err(|_| ()).and_then(|f| Request::parse(&f).map_err(|_| ())) {
            let emitted = request.emit(bytes[0]);
            prop_assert_eq!(emitted.bytes(), bytes);
        }
    }

    #[test]
    fn noise_label_does_not_panic(bytes in proptest::collection::vec(any::<u8>(), 0..160)) {
        if let Ok(label) = ExtendedLabel::parse(&bytes) {
            prop_assert!(label.geometry.is_none_or(|geometry| geometry.position_count().is_some_and(|range| range <= 1 << 32)));
        }
        if let Some(label) = SerialLabel::parse(&bytes) {
            prop_assert!(label.serial_number.is_ascii() && label.firmware_version.is_ascii());
        }
    }
}
