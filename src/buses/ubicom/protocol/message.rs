//! Requests from the host and replies from the encoder (manual 5.2). Registers are identified by global numbers, as
//! returned by `RegisterAddress::global` of BiSS.

use super::frame::{Frame, NODE};
use super::position::PositionWord;
use crate::bits::ByteOrder;

/// The three commands of the protocol.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Command {
    /// Reads a register (01h).
    Read,
    /// Writes a register (02h).
    Write,
    /// Reads the position (03h).
    Position,
}

/// A request without the address of the encoder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Request {
    /// Reads a register (01h).
    Read {
        /// Global register address.
        register: u16,
    },
    /// Writes a register (02h).
    Write {
        /// Global register address.
        register: u16,
        /// New value of the register.
        value: u8,
    },
    /// Reads the position (03h). The manual defines only the argument 01h, but other arguments are preserved.
    Position {
        /// Argument byte after the command.
        argument: u8,
    },
}

/// The reason why an encoder rejects a request.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RequestError {
    /// The command is unknown.
    #[error("0x{0:02X} is not a command")]
    Command(u8),
    /// The payload length does not match the command.
    #[error("{got} payload bytes instead of {expected}")]
    Length {
        /// Required payload length in bytes.
        expected: usize,
        /// Received payload length in bytes.
        got: usize,
    },
}

/// The reply to a write request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WriteReply {
    /// The write was acknowledged (90h).
    Acknowledged,
    /// The write was rejected (A0h).
    Refused,
    /// A value that the manual does not define.
    Unknown(u8),
}

/// A reply from the encoder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reply {
    /// Register value, in reply to a read request.
    Value(u8),
    /// Result of a write request.
    Written(WriteReply),
    /// Position, in reply to command 03h.
    Position(PositionWord),
}

/// The reason why a frame is not the reply to a request.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ReplyError {
    /// The frame belongs to a different node.
    #[error("a frame came from node 0x{got:02X} instead of 0x{expected:02X}")]
    Address {
        /// Address in the request.
        expected: u8,
        /// Received address.
        got: u8,
    },
    /// The frame is the reply to a different command.
    #[error("a frame had command 0x{got:02X} instead of 0x{expected:02X}")]
    Command {
        /// Command in the request.
        expected: u8,
        /// Received command.
        got: u8,
    },
    /// The payload length is wrong. The frame may be an echo if its payload is as long as that of the request.
    #[error("the payload has {got} bytes instead of {expected}")]
    Length {
        /// Expected payload length in bytes.
        expected: usize,
        /// Received payload length in bytes.
        got: usize,
    },
}

impl Command {
    /// Returns the command byte.
    pub const fn byte(self) -> u8 {
        match self {
            Command::Read => 0x01,
            Command::Write => 0x02,
            Command::Position => 0x03,
        }
    }

    /// Returns the command with this code, or `None` if the code is unknown.
    pub const fn from_byte(byte: u8) -> Option<Self> {
        match byte {
            0x01 => Some(Command::Read),
            0x02 => Some(Command::Write),
            0x03 => Some(Command::Position),
            _ => None,
        }
    }

    const fn request_bytes(self) -> usize {
        match self {
            Command::Read => 2,
            Command::Write => 3,
            Command::Position => 1,
        }
    }

    const fn reply_bytes(self) -> usize {
        match self {
            Command::Read | Command::Write => 1,
            Command::Position => PositionWord::BYTES,
        }
    }
}

impl Request {
    /// Position request with the argument that the manual defines.
    pub const POSITION: Request = Request::Position { argument: 0x01 };
    /// Read request whose reply reveals the byte order of register numbers. The request itself sends its register
    /// number low byte first. See [`byte_order_from_reply`].
    pub const PROBE: Request = Request::Read { register: Request::PROBE_REGISTER };
    /// Register that [`PROBE`](Self::PROBE) reads.
    pub const PROBE_REGISTER: u16 = 0x0001;

    /// Returns the command.
    pub const fn command(self) -> Command {
        match self {
            Request::Read { .. } => Command::Read,
            Request::Write { .. } => Command::Write,
            Request::Position { .. } => Command::Position,
        }
    }

    /// Returns the encoded frame. The manual does not define the byte order of the register number (`U`).
    pub fn emit(self, order: ByteOrder) -> Vec<u8> {
        let number = |register: u16| match order {
            ByteOrder::LowFirst => register.to_le_bytes(),
            ByteOrder::HighFirst => register.to_be_bytes(),
        };
        let payload = match self {
            Request::Read { register } => number(register).to_vec(),
            Request::Write { register, value } => {
                let [first, second] = number(register);
                vec![first, second, value]
            }
            Request::Position { argument } => vec![argument],
        };
        Frame { address: NODE, command: self.command().byte(), payload: &payload }.emit()
    }

    /// Parses a request.
    ///
    /// # Errors
    /// Returns a [`RequestError`]. An unknown command is reported before a wrong length.
    pub fn parse(frame: &Frame<'_>, order: ByteOrder) -> Result<Self, RequestError> {
        let command = Command::from_byte(frame.command).ok_or(RequestError::Command(frame.command))?;
        let number = |bytes: [u8; 2]| match order {
            ByteOrder::LowFirst => u16::from_le_bytes(bytes),
            ByteOrder::HighFirst => u16::from_be_bytes(bytes),
        };
        match (command, frame.payload) {
            (Command::Read, [first, second]) => Ok(Request::Read { register: number([*first, *second]) }),
            (Command::Write, [first, second, value]) => {
                Ok(Request::Write { register: number([*first, *second]), value: *value })
            }
            (Command::Position, [argument]) => Ok(Request::Position { argument: *argument }),
            (_, payload) => Err(RequestError::Length { expected: command.request_bytes(), got: payload.len() }),
        }
    }
}

/// Returns the byte order of register numbers according to the reply to [`Request::PROBE`]. 02h is the content of
/// register 0001h (the data sheet bank), and 01h that of register 0100h (the profile version). Any other value yields
/// `None`.
pub const fn byte_order_from_reply(answer: u8) -> Option<ByteOrder> {
    match answer {
        0x02 => Some(ByteOrder::LowFirst),
        0x01 => Some(ByteOrder::HighFirst),
        _ => None,
    }
}

impl WriteReply {
    /// Decodes the byte of a reply.
    pub const fn from_byte(byte: u8) -> Self {
        match byte {
            0x90 => WriteReply::Acknowledged,
            0xA0 => WriteReply::Refused,
            _ => WriteReply::Unknown(byte),
        }
    }

    /// Returns the byte of the reply.
    pub const fn byte(self) -> u8 {
        match self {
            WriteReply::Acknowledged => 0x90,
            WriteReply::Refused => 0xA0,
            WriteReply::Unknown(byte) => byte,
        }
    }
}

impl Reply {
    /// Returns the command to which this is the reply.
    pub const fn command(self) -> Command {
        match self {
            Reply::Value(_) => Command::Read,
            Reply::Written(_) => Command::Write,
            Reply::Position(_) => Command::Position,
        }
    }

    /// Returns the encoded frame.
    pub fn emit(self) -> Vec<u8> {
        let payload = match self {
            Reply::Value(value) => vec![value],
            Reply::Written(written) => vec![written.byte()],
            Reply::Position(word) => word.emit().to_vec(),
        };
        Frame { address: NODE, command: self.command().byte(), payload: &payload }.emit()
    }

    /// Parses the reply to a command.
    ///
    /// # Errors
    /// Returns a [`ReplyError`] if the frame is not the reply.
    pub fn parse(frame: &Frame<'_>, command: Command) -> Result<Self, ReplyError> {
        if frame.address != NODE {
            return Err(ReplyError::Address { expected: NODE, got: frame.address });
        }
        if frame.command != command.byte() {
            return Err(ReplyError::Command { expected: command.byte(), got: frame.command });
        }
        match (command, frame.payload) {
            (Command::Read, [value]) => Ok(Reply::Value(*value)),
            (Command::Write, [status]) => Ok(Reply::Written(WriteReply::from_byte(*status))),
            (Command::Position, [b0, b1, b2, b3, b4]) => {
                Ok(Reply::Position(PositionWord::parse([*b0, *b1, *b2, *b3, *b4])))
            }
            (_, payload) => Err(ReplyError::Length { expected: command.reply_bytes(), got: payload.len() }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bits::{hex, parse_hex};
    use proptest::prelude::*;

    /// Requests match the frames of reference 6 and the probe of reference 2.
    #[test]
    fn published_requests_match() {
        let cases = [
            (Request::Read { register: 0x0000 }, "80 01 01 02 00 00 00 7B"),
            (Request::Read { register: 0x0026 }, "80 01 01 02 00 26 00 55"),
            (Request::Read { register: 0x00C5 }, "80 01 01 02 00 C5 00 B6"),
            (Request::Read { register: 0x0105 }, "80 01 01 02 00 05 01 75"),
            (Request::Read { register: 0x0034 }, "80 01 01 02 00 34 00 47"),
            (Request::Write { register: 0x002B, value: 0x2A }, "80 01 02 03 00 2B 00 2A 24"),
            (Request::Write { register: 0x002A, value: 0x07 }, "80 01 02 03 00 2A 00 07 48"),
            (Request::Write { register: 0x0083, value: 0x80 }, "80 01 02 03 00 83 00 80 76"),
            (Request::POSITION, "80 01 03 01 00 01 79"),
            (Request::PROBE, "80 01 01 02 00 01 00 7A"),
        ];
        for (request, text) in cases {
            assert_eq!(hex(&request.emit(ByteOrder::LowFirst)), text);
            let bytes = parse_hex(text).unwrap();
            let frame = Frame::parse(&bytes).unwrap();
            assert_eq!(Request::parse(&frame, ByteOrder::LowFirst), Ok(request), "{text}");
        }
        let high = Request::Read { register: 0x0105 }.emit(ByteOrder::HighFirst);
        assert_eq!(hex(&high), "80 01 01 02 00 01 05 75");
    }

    /// The replies are from reference 6.
    #[test]
    fn published_replies_match() {
        let word = |word| Reply::Position(PositionWord::new(word).unwrap());
        let cases = [
            (Reply::Value(0x4B), "80 01 01 01 00 4B 31"),
            (Reply::Value(0x1C), "80 01 01 01 00 1C 60"),
            (Reply::Written(WriteReply::Acknowledged), "80 01 02 01 00 90 EB"),
            (Reply::Written(WriteReply::Refused), "80 01 02 01 00 A0 DB"),
            (word(0x2469_8000), "80 01 03 05 00 00 80 69 24 00 69"),
            (word(0), "80 01 03 05 00 00 00 00 00 00 76"),
            (word(0x1_FFFF_FFFF), "80 01 03 05 00 FF FF FF FF 01 79"),
            (word(0x2_0000), "80 01 03 05 00 00 00 02 00 00 74"),
        ];
        for (reply, text) in cases {
            assert_eq!(hex(&reply.emit()), text);
            let bytes = parse_hex(text).unwrap();
            assert_eq!(Reply::parse(&Frame::parse(&bytes).unwrap(), reply.command()), Ok(reply), "{text}");
        }
    }

    /// The reply to the probe reveals the byte order in which the encoder reads register numbers.
    #[test]
    fn reply_reveals_byte_order() {
        let bytes = Request::PROBE.emit(ByteOrder::LowFirst);
        let frame = Frame::parse(&bytes).unwrap();
        assert_eq!(Request::parse(&frame, ByteOrder::LowFirst), Ok(Request::Read { register: 0x0001 }));
        assert_eq!(Request::parse(&frame, ByteOrder::HighFirst), Ok(Request::Read { register: 0x0100 }));
        assert_eq!(byte_order_from_reply(0x02), Some(ByteOrder::LowFirst));
        assert_eq!(byte_order_from_reply(0x01), Some(ByteOrder::HighFirst));
        assert_eq!(byte_order_from_reply(0x00), None);
    }

    #[test]
    fn reports_unknown_requests() {
        let frame = |command, payload| Frame { address: NODE, command, payload };
        let order = ByteOrder::LowFirst;
        assert_eq!(Request::parse(&frame(0x04, &[1]), order), Err(RequestError::Command(0x04)));
        assert_eq!(
            Request::parse(&frame(0x01, &[1]), order),
            Err(RequestError::Length { expected: 2, got: 1 }),
            "as a reply that came back"
        );
        let value = Frame { address: 0x02, command: 0x01, payload: &[1] };
        assert_eq!(Reply::parse(&value, Command::Read), Err(ReplyError::Address { expected: 1, got: 2 }));
        let other = frame(0x02, &[1]);
        assert_eq!(Reply::parse(&other, Command::Read), Err(ReplyError::Command { expected: 1, got: 2 }));
        // The echo of a request is never mistaken for its reply, because their lengths differ.
        for request in [Request::PROBE, Request::Write { register: 0, value: 0 }, Request::POSITION] {
            let bytes = request.emit(order);
            let echo = Frame::parse(&bytes).unwrap();
            assert!(matches!(Reply::parse(&echo, request.command()), Err(ReplyError::Length { .. })));
        }
    }

    proptest! {
        #[test]
        fn requests_and_replies_round_trip(register: u16, value: u8, word in 0u64..1 << 40, high_first: bool) {
            let order = if high_first { ByteOrder::HighFirst } else { ByteOrder::LowFirst };
            let requests =
                [Request::Read { register }, Request::Write { register, value }, Request::Position { argument: value }];
            for request in requests {
                let bytes = request.emit(order);
                prop_assert_eq!(Request::parse(&Frame::parse(&bytes).unwrap(), order), Ok(request));
            }
            let position = Reply::Position(PositionWord::new(word).unwrap());
            for reply in [Reply::Value(value), Reply::Written(WriteReply::from_byte(value)), position] {
                let bytes = reply.emit();
                prop_assert_eq!(Reply::parse(&Frame::parse(&bytes).unwrap(), reply.command()), Ok(reply));
            }
        }
    }
}
