//! Descriptions of captured frames for `decode` and the trace. They never contain access codes.

use super::{
    AccessCode, AccessCodeNumber, Answer, Command, DataFieldStatus, DeviceAddress, Frame, FrameError, LineSettings,
    Reply, Request, RequestError, StatusCode,
};

/// One item in the description of a frame.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FrameDetail {
    /// Address and command of the described frame.
    Heading {
        /// Address, 40h to 5Fh, or FFh in a broadcast.
        address: u8,
        /// Command byte as received, including the error bit.
        command: u8,
    },
    /// The frame is a request.
    Request(Arguments),
    /// The frame is not a request. It cannot be recognised as a reply either, because its request is unknown.
    NoRequest(RequestError),
    /// The encoder rejected the request with this status code.
    Refused(StatusCode),
    /// A status code from the encoder's status queue.
    Code(StatusCode),
    /// The frame is a reply. Its status codes are reported as separate items.
    Reply(Reply),
}

/// Arguments of a request, excluding access codes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Arguments {
    /// The command has no arguments.
    None,
    /// Position to set, in steps.
    Position(u32),
    /// Analogue channel.
    Channel(u8),
    /// Bytes to read from a data field.
    Read {
        /// Data field number.
        field: u8,
        /// Index of the first byte.
        address: u8,
        /// Number of bytes.
        count: u8,
    },
    /// Bytes to write to a data field.
    Store {
        /// Data field number.
        field: u8,
        /// Index of the first byte.
        address: u8,
        /// Bytes to write.
        data: Vec<u8>,
    },
    /// Number of a data field.
    Field(u8),
    /// New status for a data field.
    Define {
        /// Data field number.
        field: u8,
        /// New status.
        status: DataFieldStatus,
    },
    /// Number of the access code to change.
    Code(AccessCodeNumber),
    /// New address.
    Address(DeviceAddress),
    /// New interface settings.
    Settings(LineSettings),
}

/// Describes a captured frame, beginning with its address and command. If `request` is given, the frame may be its
/// reply.
///
/// # Errors
/// Returns an error if the bytes are not a frame.
pub fn describe_frame(bytes: &[u8], request: Option<&Request>) -> Result<Vec<FrameDetail>, FrameError> {
    let frame = Frame::parse(bytes)?;
    let mut facts = vec![FrameDetail::Heading { address: frame.address, command: frame.command }];
    if let Some(answer) = request.and_then(|request| request.parse_reply(frame.address, bytes).ok()) {
        facts.extend(describe_reply(answer));
        return Ok(facts);
    }
    match Request::parse(&frame) {
        Ok(request) => facts.push(FrameDetail::Request(request_arguments(request))),
        Err(error) => match guess_reply(&frame, bytes) {
            Some(answer) => facts.extend(describe_reply(answer)),
            None => facts.push(FrameDetail::NoRequest(error)),
        },
    }
    Ok(facts)
}

/// Interprets a frame as the reply to an unknown request, if the frame has a length that a request cannot have.
fn guess_reply(frame: &Frame<'_>, bytes: &[u8]) -> Option<Answer> {
    let code = AccessCode::FACTORY;
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
            Request::ChangeCode { number: AccessCodeNumber::new(*number)?, old: code, new: code }
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

fn request_arguments(request: Request) -> Arguments {
    match request {
        Request::SetPosition { position, .. } | Request::Synchronise { position, .. } => Arguments::Position(position),
        Request::ReadAnalogue { channel } => Arguments::Channel(channel),
        Request::ReadData { field, address, count, .. } => Arguments::Read { field, address, count },
        Request::StoreData { field, address, data, .. } => Arguments::Store { field, address, data },
        Request::FieldStatus { field } => Arguments::Field(field),
        Request::DefineField { field, status, .. } => Arguments::Define { field, status },
        Request::ChangeCode { number, .. } => Arguments::Code(number),
        Request::SetAddress { new, .. } => Arguments::Address(new),
        Request::ConfigureLine { settings, .. } | Request::ConfigureLineTemporarily { settings } => {
            Arguments::Settings(settings)
        }
        Request::ReadPosition
        | Request::ReadCounter
        | Request::IncrementCounter
        | Request::ClearCounter { .. }
        | Request::FreeMemory
        | Request::ReadStatus
        | Request::ReadTypeLabel
        | Request::Reset
        | Request::ReadSerial => Arguments::None,
    }
}

fn describe_reply(answer: Answer) -> Vec<FrameDetail> {
    match answer {
        Answer::Rejected { codes, .. } => codes.into_iter().map(FrameDetail::Refused).collect(),
        Answer::Reply { reply: Reply::Status(codes), .. } => codes.into_iter().map(FrameDetail::Code).collect(),
        Answer::Reply { reply, .. } => vec![FrameDetail::Reply(reply)],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bits::parse_hex;

    #[test]
    fn distinguishes_requests_from_replies() {
        let heading = |command| FrameDetail::Heading { address: 0x40, command };
        let cases = [
            ("40 42 02", 0x42, FrameDetail::Request(Arguments::None)),
            ("40 42 00 0E 05 31 38", 0x42, FrameDetail::Reply(Reply::Position(0x000E_0531))),
            ("40 D0 0F 9F", 0xD0, FrameDetail::Code(StatusCode::WRONG_CODE)),
            ("40 4D 00 C9 C4", 0x4D, FrameDetail::Reply(Reply::Done)),
            ("40 4F 02 0D", 0x4F, FrameDetail::Reply(Reply::Done)),
            ("40 4B 01 05 02 0D", 0x4B, FrameDetail::Reply(Reply::Done)),
            ("40 41 01", 0x41, FrameDetail::NoRequest(RequestError::Command(0x41))),
        ];
        for (bytes, command, expected) in cases {
            let said = describe_frame(&parse_hex(bytes).unwrap(), None).unwrap();
            assert_eq!(said, [heading(command), expected], "{bytes}");
        }
    }

    #[test]
    fn request_descriptions_omit_access_codes() {
        // In the manual's examples, access code 66h opens field 1, and access code 2 is changed to 66h.
        let cases = [
            ("40 4B 01 05 02 66 08 15 76", Arguments::Store { field: 1, address: 5, data: vec![0x08, 0x15] }),
            ("40 4F 02 55 66 3E", Arguments::Code(AccessCodeNumber::new(2).unwrap())),
        ];
        for (bytes, expected) in cases {
            let said = describe_frame(&parse_hex(bytes).unwrap(), None).unwrap();
            assert_eq!(said.last(), Some(&FrameDetail::Request(expected)), "{bytes}");
        }
    }

    #[test]
    fn reports_checksum_error_in_manual() {
        let wrong = parse_hex("40 4D 01 E0 55 69").unwrap();
        assert_eq!(describe_frame(&wrong, None), Err(FrameError::Checksum { expected: 0xB9, got: 0x69 }));
    }

    #[test]
    fn recognizes_rejection_by_request() {
        let request = Request::ReadPosition;
        let said = describe_frame(&parse_hex("40 50 1F 0F").unwrap(), Some(&request)).unwrap();
        assert_eq!(said.last(), Some(&FrameDetail::Refused(StatusCode::new(0x1F))));
    }
}
