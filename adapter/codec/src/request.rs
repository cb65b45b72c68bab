//! Requests from a host to an adapter (`protocol/bridge.md`, section 2).

use alloc::vec::Vec;

use super::fields::{BodyError, FieldReader};
use super::packet::Packet;

/// An operation of the protocol. Its value is the operation code of a request.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum Operation {
    /// Reads the identity of the adapter.
    Hello = 0x01,
    /// Switches the encoder supply and reads its state.
    Supply = 0x02,
    /// Reads the status of the adapter.
    Status = 0x03,
    /// Configures the reading of SSI words.
    SsiConfig = 0x10,
    /// Reads an SSI word.
    SsiRead = 0x11,
    /// Starts or ends a stream of SSI words.
    SsiStream = 0x12,
    /// Configures the reading of BiSS frames.
    BissConfig = 0x20,
    /// Reads a BiSS frame.
    BissRead = 0x21,
    /// Reads a BiSS register.
    BissRegisterRead = 0x22,
    /// Writes a BiSS register.
    BissRegisterWrite = 0x23,
    /// Starts or ends a stream of BiSS frames.
    BissStream = 0x24,
    /// Configures analogue sampling.
    AnalogConfig = 0x30,
    /// Starts or ends a stream of analogue samples.
    AnalogStream = 0x31,
    /// Reads the time between the sine and the cosine of a sample.
    AnalogSkew = 0x33,
    /// Configures the serial line.
    UartConfig = 0x40,
    /// Sends and receives bytes on the serial line.
    UartTransfer = 0x41,
}

/// A request to an adapter.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Request {
    /// Reads the identity of the adapter.
    Hello,
    /// Switches the encoder supply. [`Request::Hello`] does not change it.
    Supply {
        /// Whether to switch the supply on.
        on: bool,
        /// Voltage in millivolts, which the encoder's data sheet must permit.
        millivolt: u16,
    },
    /// Reads the status of the adapter. Only adapters with the capability [`STATUS`] support it.
    ///
    /// [`STATUS`]: crate::Capabilities::STATUS
    Status,
    /// Configures the reading of SSI words.
    SsiConfig {
        /// Number of bits in a word, 1 to 64.
        clocks: u8,
        /// Clock frequency in hertz.
        clock_hz: u32,
        /// Pause between two words in microseconds.
        pause_us: u16,
        /// Flags that select the clock edge for sampling the data line.
        flags: SsiFlags,
    },
    /// Reads an SSI word.
    SsiRead,
    /// Starts or ends a stream of SSI words.
    SsiStream {
        /// Interval in microseconds. 0 ends the stream.
        period_us: u32,
    },
    /// Configures the reading of BiSS frames.
    BissConfig {
        /// Clock frequency in hertz.
        clock_hz: u32,
        /// Number of bits for position, error and warning. The CRC is not included.
        data_bits: u8,
        /// Width of the CRC in bits.
        crc_bits: u8,
        /// BiSS time-out in microseconds, after which the frame has ended.
        timeout_us: u16,
    },
    /// Reads a BiSS frame.
    BissRead,
    /// Reads a BiSS register.
    BissRegisterRead {
        /// Number of the encoder on the line.
        slave: u8,
        /// Register address, 00h to 7Fh.
        address: u8,
    },
    /// Writes a BiSS register.
    BissRegisterWrite {
        /// Number of the encoder on the line.
        slave: u8,
        /// Register address, 00h to 7Fh.
        address: u8,
        /// New value of the register.
        value: u8,
    },
    /// Starts or ends a stream of BiSS frames.
    BissStream {
        /// Interval in microseconds. 0 ends the stream.
        period_us: u32,
    },
    /// Configures analogue sampling.
    AnalogConfig {
        /// Sample rate in hertz.
        sample_hz: u32,
    },
    /// Starts or ends a stream of analogue samples.
    AnalogStream {
        /// Whether to start the stream.
        on: bool,
    },
    /// Reads the time between the sine and the cosine of a sample. Only adapters with the capability [`ANALOG_SKEW`]
    /// support it.
    ///
    /// [`ANALOG_SKEW`]: crate::Capabilities::ANALOG_SKEW
    AnalogSkew,
    /// Configures the serial line.
    UartConfig {
        /// Baud rate.
        baud: u32,
        /// Parity: 0 for none, 1 for odd, 2 for even. Other values are preserved.
        parity: u8,
        /// Minimum time in microseconds before the line changes direction.
        turnaround_us: u16,
    },
    /// Sends and receives bytes on the serial line.
    UartTransfer {
        /// Maximum time in microseconds to wait for the first byte of the reply.
        timeout_us: u32,
        /// Duration of the silence that ends the reply, in microseconds.
        idle_us: u32,
        /// Bytes to send.
        tx: Vec<u8>,
    },
}

/// Flags for sampling the SSI data line. Unknown bits are preserved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SsiFlags(u8);

impl SsiFlags {
    /// Bit 0: the data line is sampled at the falling clock edge, as usual.
    pub const FALLING_EDGE: SsiFlags = SsiFlags(0x01);

    /// Creates flags from a byte. Every value is valid.
    pub const fn new(byte: u8) -> Self {
        SsiFlags(byte)
    }

    /// Returns the flags as a byte.
    pub const fn byte(self) -> u8 {
        self.0
    }

    /// Returns whether the data line is sampled at the falling clock edge.
    pub const fn falling_edge(self) -> bool {
        self.0 & Self::FALLING_EDGE.0 != 0
    }
}

impl Operation {
    /// All operations.
    pub const ALL: [Operation; 16] = [
        Operation::Hello,
        Operation::Supply,
        Operation::Status,
        Operation::SsiConfig,
        Operation::SsiRead,
        Operation::SsiStream,
        Operation::BissConfig,
        Operation::BissRead,
        Operation::BissRegisterRead,
        Operation::BissRegisterWrite,
        Operation::BissStream,
        Operation::AnalogConfig,
        Operation::AnalogStream,
        Operation::AnalogSkew,
        Operation::UartConfig,
        Operation::UartTransfer,
    ];

    /// Bit that is set in a reply's operation code.
    pub const REPLY_BIT: u8 = 0x80;

    /// Returns the operation code of a request.
    pub const fn byte(self) -> u8 {
        self as u8
    }

    /// Returns the operation with this operation code, or `None` if the code is unknown.
    pub fn from_byte(byte: u8) -> Option<Self> {
        Self::ALL.into_iter().find(|operation| operation.byte() == byte)
    }
}

impl Request {
    /// Returns the operation of the request.
    pub const fn operation(&self) -> Operation {
        match self {
            Request::Hello => Operation::Hello,
            Request::Supply { .. } => Operation::Supply,
            Request::Status => Operation::Status,
            Request::SsiConfig { .. } => Operation::SsiConfig,
            Request::SsiRead => Operation::SsiRead,
            Request::SsiStream { .. } => Operation::SsiStream,
            Request::BissConfig { .. } => Operation::BissConfig,
            Request::BissRead => Operation::BissRead,
            Request::BissRegisterRead { .. } => Operation::BissRegisterRead,
            Request::BissRegisterWrite { .. } => Operation::BissRegisterWrite,
            Request::BissStream { .. } => Operation::BissStream,
            Request::AnalogConfig { .. } => Operation::AnalogConfig,
            Request::AnalogStream { .. } => Operation::AnalogStream,
            Request::AnalogSkew => Operation::AnalogSkew,
            Request::UartConfig { .. } => Operation::UartConfig,
            Request::UartTransfer { .. } => Operation::UartTransfer,
        }
    }

    /// Encodes the request as a packet with this sequence number.
    pub fn emit(&self, seq: u8) -> Packet {
        let mut body = Vec::new();
        match self {
            Request::Hello | Request::Status | Request::SsiRead | Request::BissRead | Request::AnalogSkew => {}
            Request::Supply { on, millivolt } => {
                body.push(u8::from(*on));
                body.extend(millivolt.to_le_bytes());
            }
            Request::SsiConfig { clocks, clock_hz, pause_us, flags } => {
                body.push(*clocks);
                body.extend(clock_hz.to_le_bytes());
                body.extend(pause_us.to_le_bytes());
                body.push(flags.0);
            }
            Request::SsiStream { period_us } | Request::BissStream { period_us } => {
                body.extend(period_us.to_le_bytes());
            }
            Request::BissConfig { clock_hz, data_bits, crc_bits, timeout_us } => {
                body.extend(clock_hz.to_le_bytes());
                body.extend([*data_bits, *crc_bits]);
                body.extend(timeout_us.to_le_bytes());
            }
            Request::BissRegisterRead { slave, address } => body.extend([*slave, *address]),
            Request::BissRegisterWrite { slave, address, value } => body.extend([*slave, *address, *value]),
            Request::AnalogConfig { sample_hz } => body.extend(sample_hz.to_le_bytes()),
            Request::AnalogStream { on } => body.push(u8::from(*on)),
            Request::UartConfig { baud, parity, turnaround_us } => {
                body.extend(baud.to_le_bytes());
                body.push(*parity);
                body.extend(turnaround_us.to_le_bytes());
            }
            Request::UartTransfer { timeout_us, idle_us, tx } => {
                body.extend(timeout_us.to_le_bytes());
                body.extend(idle_us.to_le_bytes());
                body.extend(tx);
            }
        }
        Packet { seq, op: self.operation().byte(), body }
    }

    /// Parses a request.
    ///
    /// # Errors
    /// Returns a [`BodyError`] if the operation is unknown or its body is invalid.
    pub fn parse(packet: &Packet) -> Result<Self, BodyError> {
        let operation = Operation::from_byte(packet.op).ok_or(BodyError::Operation(packet.op))?;
        let mut fields = FieldReader::new(packet.op, &packet.body);
        let request = match operation {
            Operation::Hello => Request::Hello,
            Operation::Supply => Request::Supply { on: fields.take_bool("on")?, millivolt: fields.u16()? },
            Operation::Status => Request::Status,
            Operation::SsiConfig => Request::SsiConfig {
                clocks: fields.u8()?,
                clock_hz: fields.u32()?,
                pause_us: fields.u16()?,
                flags: SsiFlags(fields.u8()?),
            },
            Operation::SsiRead => Request::SsiRead,
            Operation::SsiStream => Request::SsiStream { period_us: fields.u32()? },
            Operation::BissConfig => Request::BissConfig {
                clock_hz: fields.u32()?,
                data_bits: fields.u8()?,
                crc_bits: fields.u8()?,
                timeout_us: fields.u16()?,
            },
            Operation::BissRead => Request::BissRead,
            Operation::BissRegisterRead => Request::BissRegisterRead { slave: fields.u8()?, address: fields.u8()? },
            Operation::BissRegisterWrite => {
                Request::BissRegisterWrite { slave: fields.u8()?, address: fields.u8()?, value: fields.u8()? }
            }
            Operation::BissStream => Request::BissStream { period_us: fields.u32()? },
            Operation::AnalogConfig => Request::AnalogConfig { sample_hz: fields.u32()? },
            Operation::AnalogStream => Request::AnalogStream { on: fields.take_bool("on")? },
            Operation::AnalogSkew => Request::AnalogSkew,
            Operation::UartConfig => {
                Request::UartConfig { baud: fields.u32()?, parity: fields.u8()?, turnaround_us: fields.u16()? }
            }
            Operation::UartTransfer => Request::UartTransfer {
                timeout_us: fields.u32()?,
                idle_us: fields.u32()?,
                tx: fields.take_rest().to_vec(),
            },
        };
        fields.finish(request)
    }
}
