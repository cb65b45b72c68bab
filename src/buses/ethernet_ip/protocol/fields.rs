//! Parsing and emitting packets field by field.

/// An EtherNet/IP structure, as named in error messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[allow(missing_docs, reason = "each has its English name")]
pub enum Structure {
    #[error("the configuration control")]
    ConfigurationControl,
    #[error("the interface configuration")]
    InterfaceConfiguration,
    #[error("the CIP request")]
    CipRequest,
    #[error("the CIP reply")]
    CipReply,
    #[error("RegisterSession")]
    RegisterSession,
    #[error("SendRRData")]
    SendRRData,
    #[error("the identity object")]
    IdentityObject,
    #[error("the identity item")]
    IdentityItem,
    #[error("ForwardOpen")]
    ForwardOpen,
    #[error("the reply to ForwardOpen")]
    ForwardOpenReply,
    #[error("the rejection of ForwardOpen")]
    Refusal,
    #[error("ForwardClose")]
    ForwardClose,
    #[error("the reply to ForwardClose")]
    ForwardCloseReply,
    #[error("the list of items")]
    Items,
    #[error("the null address item")]
    NullAddress,
    #[error("the connected address item")]
    ConnectedAddress,
    #[error("the sequenced address item")]
    SequencedAddress,
    #[error("the socket address item")]
    SocketAddress,
    #[error("the encapsulation frame")]
    Encapsulation,
    #[error("the cyclic packet")]
    CyclicPacket,
    #[error("the path")]
    Path,
}

/// A field that allows only certain values, as named in error messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[allow(missing_docs, reason = "each has its English name")]
pub enum PacketField {
    #[error("service")]
    Service,
    #[error("length")]
    Length,
    #[error("list of items")]
    Items,
    #[error("pad byte before a 16-bit number")]
    WidePrefix,
    #[error("connection time-out multiplier")]
    TimeoutMultiplier,
}

/// The reason why bytes cannot be parsed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PacketError {
    /// The data is truncated.
    #[error("{what} is incomplete (bytes received: {got})")]
    Short {
        /// The structure being parsed.
        what: Structure,
        /// Number of bytes available.
        got: usize,
    },
    /// Extra bytes remain after the structure.
    #[error("{what} is too long (extra bytes: {left})")]
    Long {
        /// The structure being parsed.
        what: Structure,
        /// Number of remaining bytes.
        left: usize,
    },
    /// The value of a field is invalid.
    #[error("{what} contains an invalid value ({field}: 0x{got:X})")]
    Value {
        /// The structure being parsed.
        what: Structure,
        /// Name of the field.
        field: PacketField,
        /// Received value.
        got: u32,
    },
}

/// A cursor over the bytes that remain to be parsed.
#[derive(Clone)]
pub(super) struct FieldReader<'a> {
    what: Structure,
    whole: usize,
    rest: &'a [u8],
}

impl<'a> FieldReader<'a> {
    pub(super) fn new(what: Structure, bytes: &'a [u8]) -> Self {
        FieldReader { what, whole: bytes.len(), rest: bytes }
    }

    pub(super) fn u8(&mut self) -> Result<u8, PacketError> {
        self.take_array().map(|[byte]| byte)
    }

    pub(super) fn u16(&mut self) -> Result<u16, PacketError> {
        self.take_array().map(u16::from_le_bytes)
    }

    pub(super) fn u32(&mut self) -> Result<u32, PacketError> {
        self.take_array().map(u32::from_le_bytes)
    }

    pub(super) fn take_array<const N: usize>(&mut self) -> Result<[u8; N], PacketError> {
        let (array, rest) = self.rest.split_first_chunk::<N>().ok_or(self.truncated())?;
        self.rest = rest;
        Ok(*array)
    }

    pub(super) fn bytes(&mut self, count: usize) -> Result<&'a [u8], PacketError> {
        let (bytes, rest) = self.rest.split_at_checked(count).ok_or(self.truncated())?;
        self.rest = rest;
        Ok(bytes)
    }

    pub(super) fn take_rest(&mut self) -> &'a [u8] {
        std::mem::take(&mut self.rest)
    }

    pub(super) const fn is_empty(&self) -> bool {
        self.rest.is_empty()
    }

    /// Returns `value` if no bytes remain, or an error otherwise.
    pub(super) fn finish<T>(self, value: T) -> Result<T, PacketError> {
        match self.rest.len() {
            0 => Ok(value),
            left => Err(PacketError::Long { what: self.what, left }),
        }
    }

    pub(super) fn value(&self, field: PacketField, got: impl Into<u32>) -> PacketError {
        PacketError::Value { what: self.what, field, got: got.into() }
    }

    const fn truncated(&self) -> PacketError {
        PacketError::Short { what: self.what, got: self.whole }
    }
}

/// Appends a SHORT_STRING, whose length fits into one byte. Longer strings are truncated to 255 bytes. Non-ASCII
/// characters become question marks.
pub(super) fn push_short_text(bytes: &mut Vec<u8>, text: &str) {
    let ascii: Vec<u8> = ascii(text).take(0xFF).collect();
    // There are at most 255 bytes.
    bytes.push(ascii.len() as u8);
    bytes.extend(ascii);
}

/// Converts a string to ASCII bytes. Other characters become question marks.
pub(super) fn ascii(text: &str) -> impl Iterator<Item = u8> {
    text.chars().map(|c| if c.is_ascii() { c as u8 } else { b'?' })
}

/// Converts received ASCII bytes to a string. Other bytes become question marks.
pub(super) fn text(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| if byte.is_ascii() { char::from(*byte) } else { '?' }).collect()
}
