//! The requests of a host to an adapter (reference 2).

use super::fields::{BodyError, Fields};
use super::packet::Packet;

/// The operations, by their numbers in a request.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum Operation {
    /// Requests the identity.
    Hello = 0x01,
    /// The encoder's supply.
    Supply = 0x02,
    /// Configures the clock of SSI.
    SsiConfig = 0x10,
    /// One SSI word.
    SsiRead = 0x11,
    /// SSI words without being asked.
    SsiStream = 0x12,
    /// Configures the clock of BiSS.
    BissConfig = 0x20,
    /// One BiSS frame.
    BissRead = 0x21,
    /// A register over BiSS.
    BissRegisterRead = 0x22,
    /// Write a register over BiSS.
    BissRegisterWrite = 0x23,
    /// BiSS frames without being asked.
    BissStream = 0x24,
    /// Configures the sampling of analogue signals.
    AnalogConfig = 0x30,
    /// Analogue samples without being asked.
    AnalogStream = 0x31,
    /// Configures the serial line.
    UartConfig = 0x40,
    /// Bytes out and in on the serial line.
    UartTransfer = 0x41,
}

/// A request.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Request {
    /// Requests the identity.
    Hello,
    /// The encoder's supply. HELLO does not change it.
    Supply {
        /// On or off.
        on: bool,
        /// Its voltage. Only one allowed by the encoder's description may be requested.
        millivolt: u16,
    },
    /// Configures the clock of SSI.
    SsiConfig {
        /// Bits of a word, 1…64.
        clocks: u8,
        /// Clock in hertz.
        clock_hz: u32,
        /// Pause between two words in microseconds.
        pause_us: u16,
        /// When the data line is sampled.
        flags: SsiFlags,
    },
    /// One SSI word.
    SsiRead,
    /// SSI words without being asked.
    SsiStream {
        /// Interval in microseconds; 0 ends the stream.
        period_us: u32,
    },
    /// Configures the clock of BiSS.
    BissConfig {
        /// Clock in hertz.
        clock_hz: u32,
        /// Position, error and warning, without the CRC.
        data_bits: u8,
        /// Bits of the CRC.
        crc_bits: u8,
        /// Time-out in microseconds.
        timeout_us: u16,
    },
    /// One BiSS frame.
    BissRead,
    /// A register over BiSS.
    BissRegisterRead {
        /// The encoder's number on the line.
        slave: u8,
        /// 00h…7Fh.
        address: u8,
    },
    /// Write a register over BiSS.
    BissRegisterWrite {
        /// The encoder's number on the line.
        slave: u8,
        /// 00h…7Fh.
        address: u8,
        /// Its new value.
        value: u8,
    },
    /// BiSS frames without being asked.
    BissStream {
        /// Interval in microseconds; 0 ends the stream.
        period_us: u32,
    },
    /// Configures the sampling of analogue signals.
    AnalogConfig {
        /// Samples per second.
        sample_hz: u32,
    },
    /// Analogue samples without being asked.
    AnalogStream {
        /// On or off.
        on: bool,
    },
    /// Configures the serial line.
    UartConfig {
        /// Bits per second.
        baud: u32,
        /// 0 none, 1 odd, 2 even; others are kept.
        parity: u8,
        /// Microseconds until the line may be driven in the other direction.
        turnaround_us: u16,
    },
    /// Bytes out and in on the serial line.
    UartTransfer {
        /// Microseconds until the first byte has to be there.
        timeout_us: u32,
        /// Microseconds of silence that end the reply.
        idle_us: u32,
        /// Bytes to send.
        tx: Vec<u8>,
    },
}

/// When the data line of SSI is sampled; unknown bits are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SsiFlags(u8);

impl SsiFlags {
    /// Bit 0: at the clock's falling edge, as usual.
    pub const FALLING_EDGE: SsiFlags = SsiFlags(0x01);

    /// Creates it: any byte is a set of flags.
    pub const fn new(byte: u8) -> Self {
        SsiFlags(byte)
    }

    /// Returns all eight bits.
    pub const fn byte(self) -> u8 {
        self.0
    }

    /// Returns whether the data line is sampled at the clock's falling edge.
    pub const fn falling_edge(self) -> bool {
        self.0 & Self::FALLING_EDGE.0 != 0
    }
}

impl Operation {
    /// Every operation.
    pub const ALL: [Operation; 14] = [
        Operation::Hello,
        Operation::Supply,
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
        Operation::UartConfig,
        Operation::UartTransfer,
    ];

    /// Set in the operation of a reply.
    pub const REPLY_BIT: u8 = 0x80;

    /// Returns its number in a request.
    pub const fn byte(self) -> u8 {
        self as u8
    }

    /// Returns the request with this number.
    pub fn from_byte(byte: u8) -> Option<Self> {
        Self::ALL.into_iter().find(|operation| operation.byte() == byte)
    }
}

impl Request {
    /// Returns the operation.
    pub const fn operation(&self) -> Operation {
        match self {
            Request::Hello => Operation::Hello,
            Request::Supply { .. } => Operation::Supply,
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
            Request::UartConfig { .. } => Operation::UartConfig,
            Request::UartTransfer { .. } => Operation::UartTransfer,
        }
    }

    /// Returns the packet for the adapter.
    pub fn emit(&self, seq: u8) -> Packet {
        let mut body = Vec::new();
        match self {
            Request::Hello | Request::SsiRead | Request::BissRead => {}
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

    /// Reads the request in a packet.
    ///
    /// # Errors
    /// [`BodyError`] if the operation is unknown or its body does not fit.
    pub fn parse(packet: &Packet) -> Result<Self, BodyError> {
        let operation = Operation::from_byte(packet.op).ok_or(BodyError::Operation(packet.op))?;
        let mut fields = Fields::new(packet.op, &packet.body);
        let request = match operation {
            Operation::Hello => Request::Hello,
            Operation::Supply => Request::Supply { on: fields.switch("on")?, millivolt: fields.u16()? },
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
            Operation::AnalogStream => Request::AnalogStream { on: fields.switch("on")? },
            Operation::UartConfig => {
                Request::UartConfig { baud: fields.u32()?, parity: fields.u8()?, turnaround_us: fields.u16()? }
            }
            Operation::UartTransfer => {
                Request::UartTransfer { timeout_us: fields.u32()?, idle_us: fields.u32()?, tx: fields.tail().to_vec() }
            }
        };
        fields.end(request)
    }
}
