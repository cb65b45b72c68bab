//! The control frame, which accesses registers by sending one bit per cycle in each direction. See manual 3.1.2,
//! figures 3 and 4. Details missing in the manual are from iC-Haus, *BiSS protocol description (C-mode)*.
//!
//! ```text
//! cycle  0  1    2..4  5..11  12..15  16  17  18  19..26  27..30  31
//! CDM    S  CTS  ID    ADR    CRC4    R   W   S   DATA    CRC4    P        host → encoder, at the end of a cycle
//! CDS    0  IDL0 … IDL7 0…            0   R   W   S       DATA    CRC4 P   encoder → host, at the start of a cycle
//! ```
//! A CDS bit is the reply to the CDM bit of the previous cycle. P = 1 continues with the next address, whose S is sent
//! in the same cycle. From any state, fourteen cycles with CDM = 0 return both sides to the idle state.
//!
//! The available sources leave two details open (`U`). In this implementation, a host that waits for the encoder's S
//! repeats its own S, because fourteen zeros would abort the request. An encoder echoes written data with its checksum.

mod encoder;
mod host;
#[cfg(test)]
mod tests;

pub use encoder::{Encoder, Event};
pub use host::{Host, Step};

/// Number of consecutive cycles with CDM = 0 after which host and encoder are idle again.
pub const REST_CYCLES: u8 = 14;
/// Maximum number of cycles by which an encoder may delay its start bit S. The limit is not documented (`U`).
pub const MAX_WAIT_CYCLES: u8 = 50;
/// Number of registers that a control frame can address.
const REGISTERS: u8 = 0x80;

/// A request from the host to one of the encoders on the line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Request {
    slave: u8,
    address: u8,
    kind: RequestKind,
}

#[derive(Clone, Debug, PartialEq, Eq)]
enum RequestKind {
    Read { count: u8 },
    Write { values: Vec<u8> },
}

/// Reason why a request is invalid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RequestError {
    /// The slave number is outside the range 0 to 7.
    #[error("the slave number must be from 0 to 7, not {0}")]
    Slave(u8),
    /// The range contains no register, or extends beyond 7Fh.
    #[error("{count} registers from 0x{address:02X} extend past 0x7F")]
    Range {
        /// Address of the first register.
        address: u8,
        /// Number of registers requested.
        count: usize,
    },
}

/// Reason why a request failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ControlError {
    /// No encoder with the given number is on the line.
    #[error("no slave {0} answers")]
    NoSlave(u8),
    /// The encoder did not echo the access type, because it did not understand the request or rejected it.
    #[error("the encoder refuses register 0x{0:02X}")]
    Rejected(u8),
    /// The encoder did not start its reply in time.
    #[error("the encoder did not return register 0x{0:02X} within {MAX_WAIT_CYCLES} cycles")]
    TimeOut(u8),
    /// The encoder's reply is damaged. A write may or may not have taken effect.
    #[error("register 0x{address:02X}: CRC {got:X} instead of {expected:X}")]
    Crc {
        /// Address of the register.
        address: u8,
        /// Checksum calculated from the value.
        expected: u8,
        /// Received checksum.
        got: u8,
    },
}

impl Request {
    /// Creates a request to read `count` consecutive registers.
    ///
    /// # Errors
    /// Returns a [`RequestError`] if the slave or a register does not exist.
    pub fn read(slave: u8, address: u8, count: u8) -> Result<Self, RequestError> {
        Self::new_checked(slave, address, RequestKind::Read { count })
    }

    /// Creates a request to write consecutive registers.
    ///
    /// # Errors
    /// Returns a [`RequestError`] if the slave or a register does not exist.
    pub fn write(slave: u8, address: u8, values: &[u8]) -> Result<Self, RequestError> {
        Self::new_checked(slave, address, RequestKind::Write { values: values.to_vec() })
    }

    fn new_checked(slave: u8, address: u8, what: RequestKind) -> Result<Self, RequestError> {
        let request = Request { slave, address, kind: what };
        let count = request.count();
        if slave > 7 {
            return Err(RequestError::Slave(slave));
        }
        if count == 0 || usize::from(address) + count > usize::from(REGISTERS) {
            return Err(RequestError::Range { address, count });
        }
        Ok(request)
    }

    fn count(&self) -> usize {
        match &self.kind {
            RequestKind::Read { count } => usize::from(*count),
            RequestKind::Write { values } => values.len(),
        }
    }

    fn is_read(&self) -> bool {
        matches!(self.kind, RequestKind::Read { .. })
    }

    /// Returns the DATA and CRC4 bits that the host sends for the register at `index`. For a read, all bits are 0.
    fn data(&self, index: usize) -> u16 {
        match &self.kind {
            RequestKind::Read { .. } => 0,
            RequestKind::Write { values } => values.get(index).map_or(0, |value| append_crc4(*value)),
        }
    }
}

/// Appends the CRC4 to a value, which gives twelve bits.
fn append_crc4(value: u8) -> u16 {
    let value = u16::from(value);
    value << 4 | u16::from(super::crc::crc4(value, 8))
}
