//! Encodes and decodes the fields of a packet body. Integers are little-endian, and strings are preceded by their
//! length.

use alloc::borrow::ToOwned;
use alloc::string::String;
use alloc::vec::Vec;

/// The reason why a packet body is not valid for its operation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum BodyError {
    /// The length of the body does not match the operation.
    #[error("operation 0x{op:02X}: the message body has the wrong length (bytes received: {got})")]
    Length {
        /// Operation code.
        op: u8,
        /// Received length in bytes.
        got: usize,
    },
    /// The operation code is unknown.
    #[error("0x{0:02X} is not a valid operation code")]
    Operation(u8),
    /// The value of a field is invalid.
    #[error("operation 0x{op:02X}: {got} is not a valid value for {field}")]
    Value {
        /// Operation code.
        op: u8,
        /// Name of the field.
        field: &'static str,
        /// Received value.
        got: u8,
    },
    /// A string is not valid UTF-8.
    #[error("operation 0x{op:02X}: a string is not valid UTF-8")]
    Text {
        /// Operation code.
        op: u8,
    },
    /// The adapter uses another version of the protocol.
    #[error("the adapter uses version {got} of the bridge protocol, but this program uses version {expected}")]
    Version {
        /// Version that this program supports.
        expected: u8,
        /// Version of the adapter.
        got: u8,
    },
}

/// Parser for a packet body, which holds the bytes that have not been parsed yet.
pub(super) struct FieldReader<'a> {
    op: u8,
    whole: usize,
    rest: &'a [u8],
}

impl<'a> FieldReader<'a> {
    pub(super) fn new(op: u8, body: &'a [u8]) -> Self {
        FieldReader { op, whole: body.len(), rest: body }
    }

    pub(super) fn u8(&mut self) -> Result<u8, BodyError> {
        self.take_array().map(|[byte]| byte)
    }

    pub(super) fn u16(&mut self) -> Result<u16, BodyError> {
        self.take_array().map(u16::from_le_bytes)
    }

    pub(super) fn i16(&mut self) -> Result<i16, BodyError> {
        self.take_array().map(i16::from_le_bytes)
    }

    pub(super) fn u32(&mut self) -> Result<u32, BodyError> {
        self.take_array().map(u32::from_le_bytes)
    }

    pub(super) fn u64(&mut self) -> Result<u64, BodyError> {
        self.take_array().map(u64::from_le_bytes)
    }

    /// Parses a byte that must be 0 (off) or 1 (on).
    pub(super) fn take_bool(&mut self, field: &'static str) -> Result<bool, BodyError> {
        match self.u8()? {
            0 => Ok(false),
            1 => Ok(true),
            got => Err(BodyError::Value { op: self.op, field, got }),
        }
    }

    /// Parses an unsigned integer of `width` bytes (at most 8).
    pub(super) fn take_uint(&mut self, width: u8) -> Result<u64, BodyError> {
        let bytes = self.bytes(width.into())?;
        Ok(bytes.iter().rev().fold(0, |number, byte| number << 8 | u64::from(*byte)))
    }

    pub(super) fn text(&mut self) -> Result<String, BodyError> {
        let length = self.u8()?;
        let bytes = self.bytes(length.into())?;
        let text = core::str::from_utf8(bytes).map_err(|_| BodyError::Text { op: self.op })?;
        Ok(text.to_owned())
    }

    pub(super) fn take_rest(&mut self) -> &'a [u8] {
        core::mem::take(&mut self.rest)
    }

    /// Returns `value` if no bytes are left.
    pub(super) fn finish<T>(self, value: T) -> Result<T, BodyError> {
        if self.rest.is_empty() { Ok(value) } else { Err(self.length_error()) }
    }

    fn take_array<const N: usize>(&mut self) -> Result<[u8; N], BodyError> {
        let (array, rest) = self.rest.split_first_chunk::<N>().ok_or_else(|| self.length_error())?;
        self.rest = rest;
        Ok(*array)
    }

    fn bytes(&mut self, count: usize) -> Result<&'a [u8], BodyError> {
        let (bytes, rest) = self.rest.split_at_checked(count).ok_or_else(|| self.length_error())?;
        self.rest = rest;
        Ok(bytes)
    }

    fn length_error(&self) -> BodyError {
        BodyError::Length { op: self.op, got: self.whole }
    }
}

/// Appends a string with its length. Strings of more than 255 bytes are truncated at a character boundary.
pub(super) fn push_text(body: &mut Vec<u8>, text: &str) {
    let end = (0..=text.len().min(255)).rev().find(|end| text.is_char_boundary(*end)).unwrap_or(0);
    // The length is at most 255.
    body.push(end as u8);
    body.extend(text.bytes().take(end));
}
