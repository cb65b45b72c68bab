//! Replies of an encoder. A reply repeats the address and the command of the request before its data (manual,
//! "Fehlerbehandlung").
//!
//! The manual does not specify the layouts of the replies to 55h, 57h and 67h (`U`). These replies are accepted with
//! and without the repeated argument.

use super::{
    Command, DataFieldStatus, DeviceAddress, Frame, FrameError, FreeMemory, LineSettings, Request, SerialLabel,
    StatusCode, TypeLabel,
};

/// Data of a reply.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Reply {
    /// The command was executed and returns no data.
    Done,
    /// Position in steps (1/32 period), in reply to 42h.
    Position(u32),
    /// Signed analogue value, in reply to 44h. It usually has 10 bits for 5 V. For other channels, see the data sheet.
    Analogue(i16),
    /// Counter value 0…FFFFFFh, in reply to 46h.
    Counter(u32),
    /// Requested bytes, in reply to 4Ah.
    Data(Vec<u8>),
    /// Status byte of a data field, in reply to 4Ch.
    FieldStatus(DataFieldStatus),
    /// Free memory, in reply to 4Eh.
    FreeMemory(FreeMemory),
    /// Status codes, in reply to 50h. Most encoders send one code, but some send up to four.
    Status(Vec<StatusCode>),
    /// Type label, in reply to 52h.
    TypeLabel(TypeLabel),
    /// Serial number and firmware, in reply to 56h.
    Serial(SerialLabel),
}

/// Reply that matches its request.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Answer {
    /// The command was executed.
    Reply {
        /// Whether the error bit is set. If it is, command 50h can read more codes from the status queue.
        pending: bool,
        /// Reply data.
        reply: Reply,
    },
    /// The command was rejected with at least one status code.
    Rejected {
        /// Whether more codes are waiting in the status queue.
        pending: bool,
        /// The status codes.
        codes: Vec<StatusCode>,
    },
}

/// Reason why bytes are not the reply to a request.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ReplyError {
    /// The bytes are not a frame.
    #[error(transparent)]
    Frame(#[from] FrameError),
    /// The reply comes from another address.
    #[error("reply from address {got:02X}h instead of {expected:02X}h")]
    Address {
        /// Address in the request.
        expected: u8,
        /// Address in the reply.
        got: u8,
    },
    /// The reply belongs to another command.
    #[error("reply to command {got:02X}h instead of {expected:02X}h")]
    Command {
        /// Command in the request.
        expected: u8,
        /// Command in the reply.
        got: u8,
    },
    /// The number of data bytes is wrong.
    #[error("the reply to {command:02X}h has the wrong length ({got} data bytes)")]
    Length {
        /// Command byte.
        command: u8,
        /// Number of data bytes received.
        got: usize,
    },
    /// The repeated arguments differ from the arguments of the request.
    #[error("the arguments in the reply differ from those sent")]
    Argument,
}

/// Possible lengths of a reply in bytes, including the checksum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReplyLength {
    /// Minimum length.
    pub min: usize,
    /// Maximum length, after which no more bytes follow.
    pub max: usize,
}

impl Request {
    /// Returns the possible lengths of the reply, or `None` for a request without a reply. The bytes `received` so far
    /// determine whether the reply is a rejection.
    pub fn reply_length(&self, received: &[u8]) -> Option<ReplyLength> {
        let rejected = received.get(1).is_some_and(|command| command & 0x7F == Command::ReadStatus.byte());
        let payload = |min, max| Some(ReplyLength { min: min + 3, max: max + 3 });
        match self {
            Request::Reset => None,
            _ if rejected => payload(1, 4),
            Request::ReadStatus => payload(1, 4),
            Request::SetPosition { .. }
            | Request::Synchronise { .. }
            | Request::IncrementCounter
            | Request::ClearCounter { .. } => payload(0, 0),
            Request::ReadPosition | Request::ReadTypeLabel => payload(4, 4),
            Request::ReadAnalogue { .. } | Request::ReadCounter | Request::StoreData { .. } => payload(3, 3),
            Request::ReadData { count, .. } => payload(3 + usize::from(*count), 3 + usize::from(*count)),
            Request::FieldStatus { .. } | Request::DefineField { .. } | Request::FreeMemory => payload(2, 2),
            Request::ChangeCode { .. } => payload(1, 1),
            Request::SetAddress { .. } | Request::ConfigureLine { .. } | Request::ConfigureLineTemporarily { .. } => {
                payload(0, 1)
            }
            Request::ReadSerial => payload(SerialLabel::MIN_PAYLOAD, SerialLabel::MAX_PAYLOAD),
        }
    }

    /// Parses the reply to this request. `address` is the address in the request, 40h to 5Fh or broadcast.
    ///
    /// # Errors
    /// Returns an error if the frame is damaged, or if its sender, command, length or arguments do not match the
    /// request. No value from such a reply may be displayed.
    pub fn parse_reply(&self, address: u8, bytes: &[u8]) -> Result<Answer, ReplyError> {
        let frame = Frame::parse(bytes)?;
        self.check_sender(address, frame.address)?;
        let pending = frame.command & Frame::ERROR_BIT != 0;
        let expected = self.command();
        let length_error = || ReplyError::Length { command: expected.byte(), got: frame.payload.len() };
        match Command::from_byte(frame.command) {
            Some(got) if got == expected => {
                let reply = self.parse_payload(frame.payload)?.ok_or_else(length_error)?;
                Ok(Answer::Reply { pending, reply })
            }
            Some(Command::ReadStatus) if (1..=4).contains(&frame.payload.len()) => {
                Ok(Answer::Rejected { pending, codes: parse_codes(frame.payload) })
            }
            _ => Err(ReplyError::Command { expected: expected.byte(), got: frame.command }),
        }
    }

    fn check_sender(&self, address: u8, sender: u8) -> Result<(), ReplyError> {
        let moved = matches!(self, Request::SetAddress { new, .. } if new.byte() == sender);
        // An encoder replies with its own address even to a broadcast, so FFh is never a sender.
        let device = DeviceAddress::new(sender).is_some();
        if device && (sender == address || moved || address == super::BROADCAST) {
            Ok(())
        } else {
            Err(ReplyError::Address { expected: address, got: sender })
        }
    }

    /// Parses the payload, or returns `None` if its length is wrong.
    fn parse_payload(&self, payload: &[u8]) -> Result<Option<Reply>, ReplyError> {
        let echoed = |same: bool, reply: Reply| if same { Ok(Some(reply)) } else { Err(ReplyError::Argument) };
        match (self, payload) {
            (Request::ReadPosition, [hh, hl, lh, ll]) => {
                Ok(Some(Reply::Position(u32::from_be_bytes([*hh, *hl, *lh, *ll]))))
            }
            (
                Request::SetPosition { .. }
                | Request::Synchronise { .. }
                | Request::IncrementCounter
                | Request::ClearCounter { .. }
                | Request::SetAddress { .. }
                | Request::ConfigureLine { .. }
                | Request::ConfigureLineTemporarily { .. },
                [],
            ) => Ok(Some(Reply::Done)),
            (Request::SetAddress { new, .. }, [echo]) => echoed(new.byte() == *echo, Reply::Done),
            (Request::ConfigureLine { settings, .. } | Request::ConfigureLineTemporarily { settings }, [echo]) => {
                echoed(settings.byte() == *echo, Reply::Done)
            }
            (Request::ReadAnalogue { channel }, [echo, high, low]) => {
                echoed(channel == echo, Reply::Analogue(i16::from_be_bytes([*high, *low])))
            }
            (Request::ReadCounter, [c2, c1, c0]) => Ok(Some(Reply::Counter(u32::from_be_bytes([0, *c2, *c1, *c0])))),
            (Request::ReadData { field, address, count, .. }, [f, a, n, data @ ..]) => {
                if data.len() != usize::from(*count) {
                    return Ok(None);
                }
                echoed((field, address, count) == (f, a, n), Reply::Data(data.to_vec()))
            }
            (Request::StoreData { field, address, data, .. }, [f, a, n]) => {
                echoed(field == f && address == a && data.len() == usize::from(*n), Reply::Done)
            }
            (Request::FieldStatus { field }, [f, status]) => {
                echoed(field == f, Reply::FieldStatus(DataFieldStatus::from_byte(*status)))
            }
            (Request::DefineField { field, status, .. }, [f, s]) => {
                echoed(field == f && status.byte() == *s, Reply::Done)
            }
            (Request::FreeMemory, [blocks, fields]) => {
                Ok(Some(Reply::FreeMemory(FreeMemory { blocks: *blocks, fields: *fields })))
            }
            (Request::ChangeCode { number, .. }, [echo]) => echoed(number.get() == *echo, Reply::Done),
            (Request::ReadStatus, [_, ..]) if payload.len() <= 4 => Ok(Some(Reply::Status(parse_codes(payload)))),
            (Request::ReadTypeLabel, [settings, encoder_type, eeprom_units, options]) => {
                Ok(Some(Reply::TypeLabel(TypeLabel {
                    settings: LineSettings::from_byte(*settings),
                    encoder_type: *encoder_type,
                    eeprom_units: *eeprom_units,
                    options: *options,
                })))
            }
            (Request::ReadSerial, _) => Ok(SerialLabel::parse(payload).map(Reply::Serial)),
            _ => Ok(None),
        }
    }
}

fn parse_codes(payload: &[u8]) -> Vec<StatusCode> {
    payload.iter().copied().map(StatusCode::new).collect()
}
