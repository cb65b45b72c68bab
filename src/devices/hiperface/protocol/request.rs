//! Requests to an encoder, and their conversion to and from bytes (manual, "Die Befehle"). The argument order of 43h,
//! 46h and 56h is taken from public implementations (`P`).

use std::fmt;

use super::{
    AccessCode, AccessCodeNumber, Command, DataFieldStatus, DeviceAddress, Frame, LineSettings, MAX_TRANSFER,
    StatusCode,
};
use crate::bits::MaskedBytes;

/// A request to an encoder, without the address.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Request {
    /// Reads the absolute position (42h).
    ReadPosition,
    /// Sets the position of the shaft (43h). The shaft must be at rest.
    SetPosition {
        /// New position in steps (1/32 period).
        position: u32,
        /// Access code 0.
        code0: AccessCode,
    },
    /// Reads an analogue value (44h).
    ReadAnalogue {
        /// Channel number as given in the data sheet.
        channel: u8,
    },
    /// Reads the 24-bit counter (46h).
    ReadCounter,
    /// Increments the counter (47h). Every increment wears the EEPROM, which withstands about a million writes.
    IncrementCounter,
    /// Clears the counter (49h).
    ClearCounter {
        /// Access code 0.
        code0: AccessCode,
    },
    /// Reads bytes from a data field (4Ah).
    ReadData {
        /// Data field number. FFh is the extended label.
        field: u8,
        /// Index of the first byte within the field.
        address: u8,
        /// Number of bytes, 1 to 128.
        count: u8,
        /// Access code of the field. The encoder ignores it if CE is 0.
        code: AccessCode,
    },
    /// Writes bytes to a data field (4Bh).
    StoreData {
        /// Data field number.
        field: u8,
        /// Index of the first byte within the field.
        address: u8,
        /// Access code of the field.
        code: AccessCode,
        /// Bytes to write, 1 to 128.
        data: Vec<u8>,
    },
    /// Reads the status byte of a data field (4Ch).
    FieldStatus {
        /// Data field number.
        field: u8,
    },
    /// Creates, changes or deletes a data field (4Dh).
    DefineField {
        /// Data field number.
        field: u8,
        /// New status. The field is deleted if E is 0.
        status: DataFieldStatus,
        /// Access code of the field.
        code: AccessCode,
    },
    /// Reads the free memory and the number of data fields (4Eh).
    FreeMemory,
    /// Changes an access code (4Fh).
    ChangeCode {
        /// Number of the access code.
        number: AccessCodeNumber,
        /// Present code.
        old: AccessCode,
        /// New code.
        new: AccessCode,
    },
    /// Reads and removes the oldest code in the status queue (50h).
    ReadStatus,
    /// Reads the type label (52h).
    ReadTypeLabel,
    /// Restarts the encoder (53h). The encoder does not reply.
    Reset,
    /// Changes the address (55h).
    SetAddress {
        /// New address, which takes effect immediately.
        new: DeviceAddress,
        /// Access code 0.
        code0: AccessCode,
    },
    /// Reads serial number and firmware (56h).
    ReadSerial,
    /// Stores interface settings that take effect after the next reset (57h).
    ConfigureLine {
        /// New settings.
        settings: LineSettings,
        /// Access code 0.
        code0: AccessCode,
    },
    /// Sets the position and aligns the code tracks of a kit encoder (63h). The shaft must be at rest.
    Synchronise {
        /// New position in steps (1/32 period).
        position: u32,
        /// Access code 0.
        code0: AccessCode,
    },
    /// Changes the interface settings until the next reset (67h). They take effect immediately.
    ConfigureLineTemporarily {
        /// New settings.
        settings: LineSettings,
    },
}

/// Reason why an encoder rejects a request.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RequestError {
    /// The command is unknown.
    #[error("{0:02X}h is not a command")]
    Command(u8),
    /// The number of argument bytes does not match the command.
    #[error("{got} argument bytes instead of {expected}")]
    Length {
        /// Required number of bytes.
        expected: usize,
        /// Received number of bytes.
        got: usize,
    },
    /// An argument is out of range.
    #[error("argument {0} is out of range")]
    Argument(&'static str),
}

impl RequestError {
    /// Returns the status code that an encoder sends in reply to such a request.
    pub fn status(self) -> StatusCode {
        match self {
            RequestError::Command(_) => StatusCode::UNKNOWN_COMMAND,
            RequestError::Length { .. } => StatusCode::LENGTH,
            RequestError::Argument(_) => StatusCode::ARGUMENT,
        }
    }
}

impl Request {
    /// Returns the command.
    pub fn command(&self) -> Command {
        match self {
            Request::ReadPosition => Command::ReadPosition,
            Request::SetPosition { .. } => Command::SetPosition,
            Request::ReadAnalogue { .. } => Command::ReadAnalogue,
            Request::ReadCounter => Command::ReadCounter,
            Request::IncrementCounter => Command::IncrementCounter,
            Request::ClearCounter { .. } => Command::ClearCounter,
            Request::ReadData { .. } => Command::ReadData,
            Request::StoreData { .. } => Command::StoreData,
            Request::FieldStatus { .. } => Command::FieldStatus,
            Request::DefineField { .. } => Command::DefineField,
            Request::FreeMemory => Command::FreeMemory,
            Request::ChangeCode { .. } => Command::ChangeCode,
            Request::ReadStatus => Command::ReadStatus,
            Request::ReadTypeLabel => Command::ReadTypeLabel,
            Request::Reset => Command::Reset,
            Request::SetAddress { .. } => Command::SetAddress,
            Request::ReadSerial => Command::ReadSerial,
            Request::ConfigureLine { .. } => Command::ConfigureLine,
            Request::Synchronise { .. } => Command::Synchronise,
            Request::ConfigureLineTemporarily { .. } => Command::ConfigureLineTemporarily,
        }
    }

    /// Returns the frame to send. `address` is 40h to 5Fh or [`BROADCAST`](super::BROADCAST).
    pub fn emit(&self, address: u8) -> MaskableFrame {
        let (payload, codes) = self.payload();
        let frame = Frame { address, command: self.command().byte(), payload: &payload };
        let bytes = frame.emit();
        let mut secret: Vec<usize> = codes.iter().map(|at| at + 2).collect();
        if !secret.is_empty() {
            secret.push(bytes.len() - 1); // the XOR checksum would reveal the code
        }
        MaskableFrame { bytes, secret }
    }

    /// Parses a request.
    ///
    /// # Errors
    /// Returns a [`RequestError`] for the first check that fails. The command is checked first, then the number of
    /// arguments, then their ranges. The order in an encoder is not documented (`U`).
    pub fn parse(frame: &Frame<'_>) -> Result<Self, RequestError> {
        let command = Command::from_byte(frame.command)
            .filter(|_| frame.command & Frame::ERROR_BIT == 0)
            .ok_or(RequestError::Command(frame.command))?;
        let expected = match (command, frame.payload) {
            (Command::StoreData, [_, _, count, ..]) => 4 + usize::from(*count).max(1),
            _ => command.row().request_payload,
        };
        let got = frame.payload.len();
        Self::from_payload(command, frame.payload)
            .filter(|_| got == expected)
            .ok_or(RequestError::Length { expected, got })
            .and_then(Self::check_ranges)
    }

    /// Returns the argument bytes, and the indices of access codes among them.
    fn payload(&self) -> (Vec<u8>, Vec<usize>) {
        match self {
            Request::ReadPosition
            | Request::ReadCounter
            | Request::IncrementCounter
            | Request::FreeMemory
            | Request::ReadStatus
            | Request::ReadTypeLabel
            | Request::Reset
            | Request::ReadSerial => (vec![], vec![]),
            Request::SetPosition { position, code0 } | Request::Synchronise { position, code0 } => {
                let mut payload = position.to_be_bytes().to_vec();
                payload.push(code0.byte());
                (payload, vec![4])
            }
            Request::ReadAnalogue { channel } => (vec![*channel], vec![]),
            Request::ClearCounter { code0 } => (vec![code0.byte()], vec![0]),
            Request::ReadData { field, address, count, code } => (vec![*field, *address, *count, code.byte()], vec![3]),
            Request::StoreData { field, address, code, data } => {
                let count = u8::try_from(data.len()).unwrap_or(u8::MAX);
                let mut payload = vec![*field, *address, count, code.byte()];
                payload.extend(data);
                (payload, vec![3])
            }
            Request::FieldStatus { field } => (vec![*field], vec![]),
            Request::DefineField { field, status, code } => (vec![*field, status.byte(), code.byte()], vec![2]),
            Request::ChangeCode { number, old, new } => (vec![number.get(), old.byte(), new.byte()], vec![1, 2]),
            Request::SetAddress { new, code0 } => (vec![new.byte(), code0.byte()], vec![1]),
            Request::ConfigureLine { settings, code0 } => (vec![settings.byte(), code0.byte()], vec![1]),
            Request::ConfigureLineTemporarily { settings } => (vec![settings.byte()], vec![]),
        }
    }

    /// Parses the arguments, or returns `None` if the payload is too short or contains an invalid address or code
    /// number.
    fn from_payload(command: Command, payload: &[u8]) -> Option<Result<Self, RequestError>> {
        let position = |hh: u8, hl: u8, lh: u8, ll: u8| u32::from_be_bytes([hh, hl, lh, ll]);
        let code = AccessCode::new;
        Some(Ok(match (command, payload) {
            (Command::ReadPosition, []) => Request::ReadPosition,
            (Command::SetPosition, [hh, hl, lh, ll, code0]) => {
                Request::SetPosition { position: position(*hh, *hl, *lh, *ll), code0: code(*code0) }
            }
            (Command::ReadAnalogue, [channel]) => Request::ReadAnalogue { channel: *channel },
            (Command::ReadCounter, []) => Request::ReadCounter,
            (Command::IncrementCounter, []) => Request::IncrementCounter,
            (Command::ClearCounter, [code0]) => Request::ClearCounter { code0: code(*code0) },
            (Command::ReadData, [field, address, count, ac]) => {
                Request::ReadData { field: *field, address: *address, count: *count, code: code(*ac) }
            }
            (Command::StoreData, [field, address, count, ac, data @ ..]) => {
                if usize::from(*count) > MAX_TRANSFER || *count == 0 {
                    return Some(Err(RequestError::Argument("count")));
                }
                Request::StoreData { field: *field, address: *address, code: code(*ac), data: data.to_vec() }
            }
            (Command::FieldStatus, [field]) => Request::FieldStatus { field: *field },
            (Command::DefineField, [field, status, ac]) => {
                Request::DefineField { field: *field, status: DataFieldStatus::from_byte(*status), code: code(*ac) }
            }
            (Command::FreeMemory, []) => Request::FreeMemory,
            (Command::ChangeCode, [number, old, new]) => match AccessCodeNumber::new(*number) {
                Some(number) => Request::ChangeCode { number, old: code(*old), new: code(*new) },
                None => return Some(Err(RequestError::Argument("code number"))),
            },
            (Command::ReadStatus, []) => Request::ReadStatus,
            (Command::ReadTypeLabel, []) => Request::ReadTypeLabel,
            (Command::Reset, []) => Request::Reset,
            (Command::SetAddress, [new, code0]) => match DeviceAddress::new(*new) {
                Some(new) => Request::SetAddress { new, code0: code(*code0) },
                None => return Some(Err(RequestError::Argument("address"))),
            },
            (Command::ReadSerial, []) => Request::ReadSerial,
            (Command::ConfigureLine, [settings, code0]) => {
                Request::ConfigureLine { settings: LineSettings::from_byte(*settings), code0: code(*code0) }
            }
            (Command::Synchronise, [hh, hl, lh, ll, code0]) => {
                Request::Synchronise { position: position(*hh, *hl, *lh, *ll), code0: code(*code0) }
            }
            (Command::ConfigureLineTemporarily, [settings]) => {
                Request::ConfigureLineTemporarily { settings: LineSettings::from_byte(*settings) }
            }
            _ => return None,
        }))
    }

    /// Checks those argument ranges that do not depend on the encoder. The encoder checks all others.
    fn check_ranges(request: Result<Self, RequestError>) -> Result<Self, RequestError> {
        match request? {
            Request::ReadData { count, .. } if count == 0 || usize::from(count) > MAX_TRANSFER => {
                Err(RequestError::Argument("count"))
            }
            Request::ConfigureLine { settings, .. } | Request::ConfigureLineTemporarily { settings }
                if !settings.is_valid() =>
            {
                Err(RequestError::Argument("settings"))
            }
            request => Ok(request),
        }
    }
}

/// The bytes of a request, in which all bytes that would reveal an access code are marked.
#[derive(Clone, PartialEq, Eq)]
pub struct MaskableFrame {
    bytes: Vec<u8>,
    secret: Vec<usize>,
}

impl MaskableFrame {
    /// Returns the bytes to be sent.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Returns whether the frame contains an access code.
    pub fn is_secret(&self) -> bool {
        !self.secret.is_empty()
    }

    /// Returns the bytes for display. Access codes are masked, as is the checksum, which would reveal them.
    pub fn to_masked(&self) -> MaskedBytes {
        MaskedBytes::with_masked(&self.bytes, &self.secret)
    }
}

impl fmt::Debug for MaskableFrame {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "SecretFrame({})", self.to_masked())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(bytes: &[u8]) -> Result<Request, RequestError> {
        Request::parse(&Frame::parse(bytes).unwrap())
    }

    fn frame_with_checksum(bytes: &[u8]) -> Vec<u8> {
        let mut frame = bytes.to_vec();
        frame.push(super::super::checksum(bytes));
        frame
    }

    #[test]
    fn bad_requests_map_to_status_codes() {
        let cases: [(&[u8], StatusCode); 12] = [
            (&[0x40, 0x41], StatusCode::UNKNOWN_COMMAND),
            (&[0x40, 0x54], StatusCode::UNKNOWN_COMMAND),
            (&[0x40, 0xC2], StatusCode::UNKNOWN_COMMAND),
            (&[0x40, 0x42, 0x00], StatusCode::LENGTH),
            (&[0x40, 0x4A, 0x00, 0x00, 0x04], StatusCode::LENGTH),
            (&[0x40, 0x4B, 0x00, 0x00, 0x02, 0x55, 0x01], StatusCode::LENGTH),
            (&[0x40, 0x4A, 0x00, 0x00, 0x00, 0x55], StatusCode::ARGUMENT),
            (&[0x40, 0x4A, 0x00, 0x00, 0x81, 0x55], StatusCode::ARGUMENT),
            (&[0x40, 0x4F, 0x04, 0x55, 0x66], StatusCode::ARGUMENT),
            (&[0x40, 0x55, 0x60, 0x55], StatusCode::ARGUMENT),
            (&[0x40, 0x57, 0xE7, 0x55], StatusCode::ARGUMENT),
            (&[0x40, 0x67, 0xD4], StatusCode::ARGUMENT),
        ];
        for (bytes, status) in cases {
            assert_eq!(parse(&frame_with_checksum(bytes)).unwrap_err().status(), status, "{bytes:02X?}");
        }
    }

    #[test]
    fn masks_codes_and_checksum() {
        let store = Request::StoreData { field: 1, address: 5, code: AccessCode::new(0x66), data: vec![0x08, 0x15] };
        assert_eq!(store.emit(0x40).to_masked().to_string(), "40 4B 01 05 02 ** 08 15 **");
        let change = Request::ChangeCode {
            number: AccessCodeNumber::new(2).unwrap(),
            old: AccessCode::FACTORY,
            new: AccessCode::new(0x66),
        };
        assert_eq!(format!("{:?}", change.emit(0x40)), "SecretFrame(40 4F 02 ** ** **)");
        assert!(!Request::ReadPosition.emit(0x40).is_secret());
    }
}
