//! The replies of an adapter, and everything else it sends (reference 2 and 3).

use super::VERSION;
use super::data::Data;
use super::fields::{BodyError, Fields, push_text};
use super::packet::Packet;
use super::request::Operation;

/// A message from an adapter.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Message {
    /// The answer to the request with the same sequence number.
    Reply(Reply),
    /// The refusal of the request with the same sequence number.
    Error {
        /// The request's operation.
        op: u8,
        /// The error code.
        code: ErrorCode,
        /// The message as text.
        text: String,
    },
    /// Data of a stream.
    Data(Data),
}

/// A reply.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Reply {
    /// The identity of the adapter.
    Hello(Hello),
    /// The encoder's supply.
    Supply {
        /// On or off.
        on: bool,
        /// Measured.
        millivolt: u16,
        /// Measured.
        milliampere: u16,
    },
    /// The actual clock of SSI.
    SsiConfig {
        /// Clock in hertz.
        clock_hz: u32,
    },
    /// One SSI word.
    SsiRead {
        /// Microseconds of the adapter's clock.
        t_us: u64,
        /// Right-justified, the bit received last in bit 0.
        raw: u64,
    },
    /// SSI words will come.
    SsiStream {
        /// Microseconds from one to the next in fact.
        period_us: u32,
    },
    /// The actual clock of BiSS.
    BissConfig {
        /// Clock in hertz.
        clock_hz: u32,
    },
    /// One BiSS frame.
    BissRead {
        /// Microseconds of the adapter's clock.
        t_us: u64,
        /// Status of the frame.
        status: BissStatus,
        /// Data and CRC, right-justified; the CRC is not checked.
        raw: u64,
    },
    /// A register's value.
    BissRegisterRead {
        /// The value.
        value: u8,
    },
    /// A register was written.
    BissRegisterWrite {
        /// Its value as returned by the encoder.
        value: u8,
    },
    /// BiSS frames will come.
    BissStream {
        /// Microseconds from one to the next in fact.
        period_us: u32,
    },
    /// The actual sampling of analogue signals.
    AnalogConfig {
        /// Samples per second.
        sample_hz: u32,
        /// Full scale: the voltage of a value of 32 767.
        full_scale_microvolt: u32,
        /// Bits of the converter.
        bits: u8,
    },
    /// Analogue samples will come, or no more.
    AnalogStream {
        /// On or off.
        on: bool,
    },
    /// The actual setting of the serial line.
    UartConfig {
        /// Bits per second.
        baud: u32,
    },
    /// Bytes received on the serial line.
    UartTransfer {
        /// Start of the reply's first start bit, by the clock of the analogue samples.
        t_us: u64,
        /// Bytes received.
        rx: Vec<u8>,
    },
}

/// The identity and the capabilities of an adapter.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Hello {
    /// The capabilities.
    pub capabilities: Capabilities,
    /// Fastest clock in hertz.
    pub max_clock_hz: u32,
    /// Most samples per second.
    pub max_sample_hz: u32,
    /// The name.
    pub name: String,
    /// Its serial number.
    pub serial: String,
    /// Its firmware.
    pub firmware: String,
}

/// Capabilities of an adapter; unknown bits are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Capabilities(u32);

/// Status of reading a BiSS frame; an unknown status is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct BissStatus(u8);

/// Why an adapter refuses; an unknown code is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ErrorCode(u8);

impl Capabilities {
    /// SSI.
    pub const SSI: Capabilities = Capabilities(1 << 0);
    /// Position data of BiSS.
    pub const BISS: Capabilities = Capabilities(1 << 1);
    /// Registers over BiSS.
    pub const BISS_REGISTERS: Capabilities = Capabilities(1 << 2);
    /// Analogue signals.
    pub const ANALOG: Capabilities = Capabilities(1 << 3);
    /// A serial line, RS-485.
    pub const UART: Capabilities = Capabilities(1 << 4);
    /// A supply that can be switched.
    pub const SUPPLY: Capabilities = Capabilities(1 << 5);
    /// A state, not a capability: the encoder's supply is on. An adapter that does not report it has this bit clear.
    pub const SUPPLIED: Capabilities = Capabilities(1 << 6);

    /// Creates it: any word is a set of capabilities.
    pub const fn new(word: u32) -> Self {
        Capabilities(word)
    }

    /// Returns all bits.
    pub const fn word(self) -> u32 {
        self.0
    }

    /// Returns whether all of these are included.
    pub const fn has(self, others: Capabilities) -> bool {
        self.0 & others.0 == others.0
    }

    /// Returns the union of both.
    #[must_use]
    pub const fn and(self, others: Capabilities) -> Self {
        Capabilities(self.0 | others.0)
    }
}

impl BissStatus {
    /// A frame was read.
    pub const OK: BissStatus = BissStatus(0);
    /// No encoder acknowledged.
    pub const NO_ACKNOWLEDGE: BissStatus = BissStatus(1);
    /// The data line stays at 0.
    pub const STUCK_LOW: BissStatus = BissStatus(2);
    /// The data line stays at 1.
    pub const STUCK_HIGH: BissStatus = BissStatus(3);

    /// Creates it: any byte is a status.
    pub const fn new(byte: u8) -> Self {
        BissStatus(byte)
    }

    /// Returns its byte.
    pub const fn byte(self) -> u8 {
        self.0
    }
}

impl ErrorCode {
    /// The adapter cannot do that.
    pub const NOT_SUPPORTED: ErrorCode = ErrorCode(1);
    /// A value that it does not take.
    pub const BAD_ARGUMENT: ErrorCode = ErrorCode(2);
    /// A stream is running.
    pub const BUSY: ErrorCode = ErrorCode(3);
    /// The encoder does not answer.
    pub const NO_ANSWER: ErrorCode = ErrorCode(4);
    /// The encoder replied wrongly: a CRC of the control frame.
    pub const WRONG_ANSWER: ErrorCode = ErrorCode(5);
    /// The adapter was too slow.
    pub const OVERRUN: ErrorCode = ErrorCode(6);

    /// Creates it: any byte is a code.
    pub const fn new(byte: u8) -> Self {
        ErrorCode(byte)
    }

    /// Returns its byte.
    pub const fn byte(self) -> u8 {
        self.0
    }
}

impl Message {
    /// The operation of a refusal.
    const ERROR: u8 = 0xFF;

    /// Parses a packet from an adapter.
    ///
    /// # Errors
    /// [`BodyError`] if the operation is unknown or its body does not fit; [`BodyError::Version`] for a HELLO of another
    /// version, whatever else it contains.
    pub fn parse(packet: &Packet) -> Result<Self, BodyError> {
        if packet.op == Self::ERROR {
            let mut fields = Fields::new(packet.op, &packet.body);
            let error = Message::Error { op: fields.u8()?, code: ErrorCode(fields.u8()?), text: fields.text()? };
            return fields.end(error);
        }
        if let Some(data) = Data::parse(packet)? {
            return Ok(Message::Data(data));
        }
        Reply::parse(packet).map(Message::Reply)
    }

    /// Returns the packet for the host.
    pub fn emit(&self, seq: u8) -> Packet {
        match self {
            Message::Reply(reply) => reply.emit(seq),
            Message::Data(data) => data.emit(seq),
            Message::Error { op, code, text } => {
                let mut body = vec![*op, code.0];
                push_text(&mut body, text);
                Packet { seq, op: Self::ERROR, body }
            }
        }
    }
}

impl Reply {
    /// Returns the operation that it answers.
    pub const fn operation(&self) -> Operation {
        match self {
            Reply::Hello(_) => Operation::Hello,
            Reply::Supply { .. } => Operation::Supply,
            Reply::SsiConfig { .. } => Operation::SsiConfig,
            Reply::SsiRead { .. } => Operation::SsiRead,
            Reply::SsiStream { .. } => Operation::SsiStream,
            Reply::BissConfig { .. } => Operation::BissConfig,
            Reply::BissRead { .. } => Operation::BissRead,
            Reply::BissRegisterRead { .. } => Operation::BissRegisterRead,
            Reply::BissRegisterWrite { .. } => Operation::BissRegisterWrite,
            Reply::BissStream { .. } => Operation::BissStream,
            Reply::AnalogConfig { .. } => Operation::AnalogConfig,
            Reply::AnalogStream { .. } => Operation::AnalogStream,
            Reply::UartConfig { .. } => Operation::UartConfig,
            Reply::UartTransfer { .. } => Operation::UartTransfer,
        }
    }

    fn emit(&self, seq: u8) -> Packet {
        let mut body = Vec::new();
        match self {
            Reply::Hello(hello) => {
                body.push(VERSION);
                for word in [hello.capabilities.0, hello.max_clock_hz, hello.max_sample_hz] {
                    body.extend(word.to_le_bytes());
                }
                for text in [&hello.name, &hello.serial, &hello.firmware] {
                    push_text(&mut body, text);
                }
            }
            Reply::Supply { on, millivolt, milliampere } => {
                body.push(u8::from(*on));
                body.extend(millivolt.to_le_bytes());
                body.extend(milliampere.to_le_bytes());
            }
            Reply::SsiConfig { clock_hz: word }
            | Reply::BissConfig { clock_hz: word }
            | Reply::SsiStream { period_us: word }
            | Reply::BissStream { period_us: word }
            | Reply::UartConfig { baud: word } => body.extend(word.to_le_bytes()),
            Reply::SsiRead { t_us, raw } => {
                body.extend(t_us.to_le_bytes());
                body.extend(raw.to_le_bytes());
            }
            Reply::BissRead { t_us, status, raw } => {
                body.extend(t_us.to_le_bytes());
                body.push(status.0);
                body.extend(raw.to_le_bytes());
            }
            Reply::BissRegisterRead { value } | Reply::BissRegisterWrite { value } => body.push(*value),
            Reply::AnalogConfig { sample_hz, full_scale_microvolt, bits } => {
                body.extend(sample_hz.to_le_bytes());
                body.extend(full_scale_microvolt.to_le_bytes());
                body.push(*bits);
            }
            Reply::AnalogStream { on } => body.push(u8::from(*on)),
            Reply::UartTransfer { t_us, rx } => {
                body.extend(t_us.to_le_bytes());
                body.extend(rx);
            }
        }
        Packet { seq, op: self.operation().byte() | Operation::REPLY_BIT, body }
    }

    fn parse(packet: &Packet) -> Result<Self, BodyError> {
        let operation = Operation::from_byte(packet.op & !Operation::REPLY_BIT)
            .filter(|_| packet.op & Operation::REPLY_BIT != 0)
            .ok_or(BodyError::Operation(packet.op))?;
        let mut fields = Fields::new(packet.op, &packet.body);
        let reply = match operation {
            Operation::Hello => {
                let got = fields.u8()?;
                if got != VERSION {
                    return Err(BodyError::Version { expected: VERSION, got });
                }
                Reply::Hello(Hello {
                    capabilities: Capabilities(fields.u32()?),
                    max_clock_hz: fields.u32()?,
                    max_sample_hz: fields.u32()?,
                    name: fields.text()?,
                    serial: fields.text()?,
                    firmware: fields.text()?,
                })
            }
            Operation::Supply => {
                Reply::Supply { on: fields.switch("on")?, millivolt: fields.u16()?, milliampere: fields.u16()? }
            }
            Operation::SsiConfig => Reply::SsiConfig { clock_hz: fields.u32()? },
            Operation::SsiRead => Reply::SsiRead { t_us: fields.u64()?, raw: fields.u64()? },
            Operation::SsiStream => Reply::SsiStream { period_us: fields.u32()? },
            Operation::BissConfig => Reply::BissConfig { clock_hz: fields.u32()? },
            Operation::BissRead => {
                Reply::BissRead { t_us: fields.u64()?, status: BissStatus(fields.u8()?), raw: fields.u64()? }
            }
            Operation::BissRegisterRead => Reply::BissRegisterRead { value: fields.u8()? },
            Operation::BissRegisterWrite => Reply::BissRegisterWrite { value: fields.u8()? },
            Operation::BissStream => Reply::BissStream { period_us: fields.u32()? },
            Operation::AnalogConfig => Reply::AnalogConfig {
                sample_hz: fields.u32()?,
                full_scale_microvolt: fields.u32()?,
                bits: fields.u8()?,
            },
            Operation::AnalogStream => Reply::AnalogStream { on: fields.switch("on")? },
            Operation::UartConfig => Reply::UartConfig { baud: fields.u32()? },
            Operation::UartTransfer => Reply::UartTransfer { t_us: fields.u64()?, rx: fields.tail().to_vec() },
        };
        fields.end(reply)
    }
}
