//! Messages of an adapter: replies and unsolicited packets (`protocol/bridge.md`, sections 2 and 3).

use alloc::string::String;
use alloc::vec;
use alloc::vec::Vec;

use super::VERSION;
use super::codes::{BissStatus, Capabilities, ErrorCode, RestartReason, SupplyFaults};
use super::data::StreamData;
use super::fields::{BodyError, FieldReader, push_text};
use super::packet::Packet;
use super::request::Operation;

/// A message from an adapter.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Message {
    /// The reply to the request with the same sequence number.
    Reply(Reply),
    /// The rejection of the request with the same sequence number.
    Error {
        /// Operation code of the request.
        op: u8,
        /// Error code.
        code: ErrorCode,
        /// Error message.
        text: String,
    },
    /// Stream data.
    Data(StreamData),
}

/// A reply to a request.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Reply {
    /// Identity of the adapter.
    Hello(Hello),
    /// State of the encoder supply.
    Supply {
        /// Whether the supply is on.
        on: bool,
        /// Measured voltage in millivolts.
        millivolt: u16,
        /// Measured current in milliamperes.
        milliampere: u16,
    },
    /// Status of the adapter.
    Status(AdapterStatus),
    /// The SSI clock has been configured.
    SsiConfig {
        /// Actual clock frequency in hertz.
        clock_hz: u32,
    },
    /// An SSI word.
    SsiRead {
        /// Time of the word in microseconds, on the adapter's clock.
        t_us: u64,
        /// Right-justified word, in which bit 0 was received last.
        raw: u64,
    },
    /// The stream of SSI words has started or ended.
    SsiStream {
        /// Actual interval in microseconds.
        period_us: u32,
    },
    /// The BiSS clock has been configured.
    BissConfig {
        /// Actual clock frequency in hertz.
        clock_hz: u32,
    },
    /// A BiSS frame.
    BissRead {
        /// Time of the frame in microseconds, on the adapter's clock.
        t_us: u64,
        /// Status of the frame.
        status: BissStatus,
        /// Right-justified data and CRC. The adapter does not check the CRC.
        raw: u64,
    },
    /// Value of a BiSS register.
    BissRegisterRead {
        /// Register value.
        value: u8,
    },
    /// A BiSS register has been written.
    BissRegisterWrite {
        /// Value returned by the encoder.
        value: u8,
    },
    /// The stream of BiSS frames has started or ended.
    BissStream {
        /// Actual interval in microseconds.
        period_us: u32,
    },
    /// Analogue sampling has been configured.
    AnalogConfig {
        /// Actual sample rate in hertz.
        sample_hz: u32,
        /// Full-scale voltage in microvolts, which corresponds to the value 32 767.
        full_scale_microvolt: u32,
        /// Resolution of the converter in bits.
        bits: u8,
    },
    /// The analogue stream has started or stopped.
    AnalogStream {
        /// Whether the stream is running.
        on: bool,
    },
    /// Time between the sine and the cosine of a sample.
    AnalogSkew {
        /// Delay of the cosine after the sine of the same sample, in nanoseconds.
        skew_ns: u16,
    },
    /// The serial line has been configured.
    UartConfig {
        /// Actual baud rate.
        baud: u32,
    },
    /// Bytes have been received on the serial line.
    UartTransfer {
        /// Time of the first start bit in microseconds, on the same adapter clock as the analogue samples.
        t_us: u64,
        /// Received bytes.
        rx: Vec<u8>,
    },
}

/// Identity and capabilities of an adapter.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Hello {
    /// Capabilities of the adapter.
    pub capabilities: Capabilities,
    /// Maximum clock of the buses in hertz.
    pub max_clock_hz: u32,
    /// Maximum sample rate of analogue signals in hertz.
    pub max_sample_hz: u32,
    /// Name of the adapter.
    pub name: String,
    /// Serial number of the adapter.
    pub serial: String,
    /// Firmware version of the adapter.
    pub firmware: String,
}

/// Status of an adapter since its last start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AdapterStatus {
    /// Time since the start of the adapter in microseconds.
    pub t_us: u64,
    /// Reason for the last start.
    pub restart: RestartReason,
    /// Faults that are present.
    pub faults: SupplyFaults,
    /// Voltage at the input of the supply switch in millivolts, or 0 for an adapter without a supply.
    pub input_millivolt: u16,
    /// Number of damaged packets that the adapter has received.
    pub damaged: u32,
    /// Number of packets with invalid content.
    pub malformed: u32,
    /// Number of samples lost because the host did not fetch them in time.
    pub lost: u32,
}

impl Message {
    /// Operation code of a rejected request.
    const ERROR: u8 = 0xFF;

    /// Parses a packet from an adapter.
    ///
    /// # Errors
    /// Returns [`BodyError::Version`] for a HELLO of another protocol version, regardless of its other content.
    /// Otherwise, returns a [`BodyError`] if the operation is unknown or its body is invalid.
    pub fn parse(packet: &Packet) -> Result<Self, BodyError> {
        if packet.op == Self::ERROR {
            let mut fields = FieldReader::new(packet.op, &packet.body);
            let error = Message::Error { op: fields.u8()?, code: ErrorCode::new(fields.u8()?), text: fields.text()? };
            return fields.finish(error);
        }
        if let Some(data) = StreamData::parse(packet)? {
            return Ok(Message::Data(data));
        }
        Reply::parse(packet).map(Message::Reply)
    }

    /// Encodes the message as a packet. `seq` is the sequence number of the request.
    pub fn emit(&self, seq: u8) -> Packet {
        match self {
            Message::Reply(reply) => reply.emit(seq),
            Message::Data(data) => data.emit(seq),
            Message::Error { op, code, text } => {
                let mut body = vec![*op, code.byte()];
                push_text(&mut body, text);
                Packet { seq, op: Self::ERROR, body }
            }
        }
    }
}

impl Reply {
    /// Returns the operation to which the reply belongs.
    pub const fn operation(&self) -> Operation {
        match self {
            Reply::Hello(_) => Operation::Hello,
            Reply::Supply { .. } => Operation::Supply,
            Reply::Status(_) => Operation::Status,
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
            Reply::AnalogSkew { .. } => Operation::AnalogSkew,
            Reply::UartConfig { .. } => Operation::UartConfig,
            Reply::UartTransfer { .. } => Operation::UartTransfer,
        }
    }

    fn emit(&self, seq: u8) -> Packet {
        let mut body = Vec::new();
        match self {
            Reply::Hello(hello) => {
                body.push(VERSION);
                for word in [hello.capabilities.to_bits(), hello.max_clock_hz, hello.max_sample_hz] {
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
            Reply::Status(status) => {
                body.extend(status.t_us.to_le_bytes());
                body.extend([status.restart.byte(), status.faults.bits()]);
                body.extend(status.input_millivolt.to_le_bytes());
                for count in [status.damaged, status.malformed, status.lost] {
                    body.extend(count.to_le_bytes());
                }
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
                body.push(status.byte());
                body.extend(raw.to_le_bytes());
            }
            Reply::BissRegisterRead { value } | Reply::BissRegisterWrite { value } => body.push(*value),
            Reply::AnalogConfig { sample_hz, full_scale_microvolt, bits } => {
                body.extend(sample_hz.to_le_bytes());
                body.extend(full_scale_microvolt.to_le_bytes());
                body.push(*bits);
            }
            Reply::AnalogStream { on } => body.push(u8::from(*on)),
            Reply::AnalogSkew { skew_ns } => body.extend(skew_ns.to_le_bytes()),
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
        let mut fields = FieldReader::new(packet.op, &packet.body);
        let reply = match operation {
            Operation::Hello => {
                let got = fields.u8()?;
                if got != VERSION {
                    return Err(BodyError::Version { expected: VERSION, got });
                }
                Reply::Hello(Hello {
                    capabilities: Capabilities::new(fields.u32()?),
                    max_clock_hz: fields.u32()?,
                    max_sample_hz: fields.u32()?,
                    name: fields.text()?,
                    serial: fields.text()?,
                    firmware: fields.text()?,
                })
            }
            Operation::Supply => {
                Reply::Supply { on: fields.take_bool("on")?, millivolt: fields.u16()?, milliampere: fields.u16()? }
            }
            Operation::Status => Reply::Status(AdapterStatus {
                t_us: fields.u64()?,
                restart: RestartReason::new(fields.u8()?),
                faults: SupplyFaults::new(fields.u8()?),
                input_millivolt: fields.u16()?,
                damaged: fields.u32()?,
                malformed: fields.u32()?,
                lost: fields.u32()?,
            }),
            Operation::SsiConfig => Reply::SsiConfig { clock_hz: fields.u32()? },
            Operation::SsiRead => Reply::SsiRead { t_us: fields.u64()?, raw: fields.u64()? },
            Operation::SsiStream => Reply::SsiStream { period_us: fields.u32()? },
            Operation::BissConfig => Reply::BissConfig { clock_hz: fields.u32()? },
            Operation::BissRead => {
                Reply::BissRead { t_us: fields.u64()?, status: BissStatus::new(fields.u8()?), raw: fields.u64()? }
            }
            Operation::BissRegisterRead => Reply::BissRegisterRead { value: fields.u8()? },
            Operation::BissRegisterWrite => Reply::BissRegisterWrite { value: fields.u8()? },
            Operation::BissStream => Reply::BissStream { period_us: fields.u32()? },
            Operation::AnalogConfig => Reply::AnalogConfig {
                sample_hz: fields.u32()?,
                full_scale_microvolt: fields.u32()?,
                bits: fields.u8()?,
            },
            Operation::AnalogStream => Reply::AnalogStream { on: fields.take_bool("on")? },
            Operation::AnalogSkew => Reply::AnalogSkew { skew_ns: fields.u16()? },
            Operation::UartConfig => Reply::UartConfig { baud: fields.u32()? },
            Operation::UartTransfer => Reply::UartTransfer { t_us: fields.u64()?, rx: fields.take_rest().to_vec() },
        };
        fields.finish(reply)
    }
}
