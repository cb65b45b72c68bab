//! Stream packets, which an adapter sends without individual requests (`protocol/bridge.md`, section 3).

use alloc::vec::Vec;

use super::codes::BissStatus;
use super::fields::{BodyError, FieldReader};
use super::packet::Packet;

/// Samples of a stream.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum StreamData {
    /// SSI words.
    Ssi(SsiData),
    /// BiSS frames.
    Biss(BissData),
    /// Analogue samples.
    Analog(AnalogData),
}

/// SSI words sampled at equal intervals.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SsiData {
    /// Number of the first word, counted from the start of the stream, modulo 2³².
    pub first_index: u32,
    /// Time of the first word in microseconds, on the adapter's clock.
    pub t0_us: u64,
    /// Interval between two words in microseconds.
    pub period_us: u32,
    /// Number of samples that the adapter has lost since the previous packet.
    pub lost: u16,
    /// Number of bytes per value in the packet, 1 to 8.
    pub width: u8,
    /// Right-justified words, at most 255.
    pub values: Vec<u64>,
}

/// BiSS frames sampled at equal intervals.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BissData {
    /// Number of the first frame, counted from the start of the stream, modulo 2³².
    pub first_index: u32,
    /// Time of the first frame in microseconds, on the adapter's clock.
    pub t0_us: u64,
    /// Interval between two frames in microseconds.
    pub period_us: u32,
    /// Number of samples that the adapter has lost since the previous packet.
    pub lost: u16,
    /// Number of bytes per frame in the packet for data and CRC, 1 to 8.
    pub width: u8,
    /// Status of each frame, and its right-justified data and CRC. There are at most 255 frames.
    pub values: Vec<(BissStatus, u64)>,
}

/// Analogue samples at equal intervals.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AnalogData {
    /// Number of the first sample, counted from the start of the stream, modulo 2³².
    pub first_index: u32,
    /// Time of the first sample in microseconds, on the adapter's clock.
    pub t0_us: u64,
    /// Number of samples that the adapter has lost since the previous packet.
    pub lost: u16,
    /// Sine and cosine of each sample as fractions of full scale, at most 255 samples.
    pub samples: Vec<(i16, i16)>,
}

impl StreamData {
    const SSI: u8 = 0x93;
    const BISS: u8 = 0xA5;
    const ANALOG: u8 = 0xB2;

    /// Returns the number of the first sample, the number of samples, and the number of samples lost before them.
    pub const fn sample_range(&self) -> (u32, usize, u16) {
        match self {
            StreamData::Ssi(data) => (data.first_index, data.values.len(), data.lost),
            StreamData::Biss(data) => (data.first_index, data.values.len(), data.lost),
            StreamData::Analog(data) => (data.first_index, data.samples.len(), data.lost),
        }
    }

    /// Parses a packet, or returns `None` if it is not a stream packet.
    pub(super) fn parse(packet: &Packet) -> Result<Option<Self>, BodyError> {
        let mut fields = FieldReader::new(packet.op, &packet.body);
        let data = match packet.op {
            Self::SSI => {
                let (first_index, t0_us, period_us, lost) =
                    (fields.u32()?, fields.u64()?, fields.u32()?, fields.u16()?);
                let (width, count) = (width(&mut fields, packet.op)?, fields.u8()?);
                let values = (0..count).map(|_| fields.take_uint(width)).collect::<Result<_, _>>()?;
                StreamData::Ssi(SsiData { first_index, t0_us, period_us, lost, width, values })
            }
            Self::BISS => {
                let (first_index, t0_us, period_us, lost) =
                    (fields.u32()?, fields.u64()?, fields.u32()?, fields.u16()?);
                let (width, count) = (width(&mut fields, packet.op)?, fields.u8()?);
                let value =
                    |fields: &mut FieldReader<'_>| Ok((BissStatus::new(fields.u8()?), fields.take_uint(width)?));
                let values = (0..count).map(|_| value(&mut fields)).collect::<Result<_, _>>()?;
                StreamData::Biss(BissData { first_index, t0_us, period_us, lost, width, values })
            }
            Self::ANALOG => {
                let (first_index, t0_us, lost, count) = (fields.u32()?, fields.u64()?, fields.u16()?, fields.u8()?);
                let sample = |fields: &mut FieldReader<'_>| Ok((fields.i16()?, fields.i16()?));
                let samples = (0..count).map(|_| sample(&mut fields)).collect::<Result<_, _>>()?;
                StreamData::Analog(AnalogData { first_index, t0_us, lost, samples })
            }
            _ => return Ok(None),
        };
        fields.finish(Some(data))
    }

    pub(super) fn emit(&self, seq: u8) -> Packet {
        let mut body = Vec::new();
        let op = match self {
            StreamData::Ssi(data) => {
                push_header(&mut body, data.first_index, data.t0_us);
                body.extend(data.period_us.to_le_bytes());
                body.extend(data.lost.to_le_bytes());
                body.extend([data.width, count(data.values.len())]);
                data.values.iter().for_each(|value| push(&mut body, *value, data.width));
                Self::SSI
            }
            StreamData::Biss(data) => {
                push_header(&mut body, data.first_index, data.t0_us);
                body.extend(data.period_us.to_le_bytes());
                body.extend(data.lost.to_le_bytes());
                body.extend([data.width, count(data.values.len())]);
                for (status, value) in &data.values {
                    body.push(status.byte());
                    push(&mut body, *value, data.width);
                }
                Self::BISS
            }
            StreamData::Analog(data) => {
                push_header(&mut body, data.first_index, data.t0_us);
                body.extend(data.lost.to_le_bytes());
                body.push(count(data.samples.len()));
                for (sine, cosine) in &data.samples {
                    body.extend(sine.to_le_bytes());
                    body.extend(cosine.to_le_bytes());
                }
                Self::ANALOG
            }
        };
        Packet { seq, op, body }
    }
}

fn width(fields: &mut FieldReader<'_>, op: u8) -> Result<u8, BodyError> {
    match fields.u8()? {
        width @ 1..=8 => Ok(width),
        got => Err(BodyError::Value { op, field: "width", got }),
    }
}

fn push_header(body: &mut Vec<u8>, first_index: u32, t0_us: u64) {
    body.extend(first_index.to_le_bytes());
    body.extend(t0_us.to_le_bytes());
}

fn count(values: usize) -> u8 {
    u8::try_from(values).unwrap_or(u8::MAX)
}

fn push(body: &mut Vec<u8>, value: u64, width: u8) {
    body.extend(value.to_le_bytes().iter().take(width.into()));
}
