//! Use of an adapter for a single stream, without register access.

use std::time::Duration;

use super::flow::{Chunk, SampleStream, StreamKind};
use super::skew::SkewCorrection;
use super::{Adapter, AdapterError, AdapterState, BISS_TIME_OUT_US, Failure};
use crate::buses::bridge::protocol::{Capabilities, Hello, Reply, Request, StreamData};
use crate::link::line::{LineError, LineState, SerialLine};
use crate::link::{Ctx, LinkError};
use crate::units::{Moment, SupplyVoltage};

/// The stream to start and the parameters of its sampling.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StreamRequest {
    Biss {
        clock_hz: u32,
        /// Number of bits for position, error and warning. The CRC is not included.
        data_bits: u8,
        crc_bits: u8,
        /// Sampling interval in microseconds.
        period_us: u32,
    },
    Analog {
        sample_hz: u32,
    },
}

/// Time from power-on until the signals of an encoder are valid. HIPERFACE encoders need up to 900 ms. See HIPERFACE,
/// figure 38.
const POWER_UP: Duration = Duration::from_secs(1);

/// A streaming adapter and its actual settings.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StreamingAdapter {
    pub hello: Hello,
    pub period_ns: i64,
    /// Full scale of sine and cosine: the voltage in microvolts that a sample of 32767 represents. The value is 0 for
    /// other streams.
    pub full_scale_microvolt: u32,
    /// Delay in nanoseconds between sampling the sine and the cosine. The samples are corrected for this delay.
    pub skew_ns: u16,
    /// Measured supply in millivolts and milliamperes, or `None` if the adapter does not supply the encoder.
    pub supplied: Option<(u16, u16)>,
}

#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum AdapterStreamError {
    #[error("cancelled")]
    Cancelled,
    #[error(transparent)]
    Link(#[from] LinkError),
    #[error(transparent)]
    Adapter(#[from] AdapterError),
}

/// Host side of an adapter that is only used for a stream.
#[derive(Clone, Debug)]
pub struct StreamTap {
    line: LineState,
    adapter: AdapterState,
    flow: Option<SampleStream>,
    skew: Option<SkewCorrection>,
}

impl From<Failure> for AdapterStreamError {
    fn from(failure: Failure) -> Self {
        match failure {
            Failure::Adapter(error) => AdapterStreamError::Adapter(error),
            Failure::Line(LineError::Cancelled) => AdapterStreamError::Cancelled,
            Failure::Line(LineError::Link(error)) => AdapterStreamError::Link(error),
            // This does not occur, since packets require no silence between them.
            Failure::Line(LineError::NeverSilent) => AdapterStreamError::Adapter(AdapterError::Silent),
        }
    }
}

impl StreamTap {
    /// Creates a tap for an adapter that has not been identified. Its replies may be late by `margin`.
    pub fn new(margin: Duration) -> Self {
        StreamTap { line: LineState::new(margin), adapter: AdapterState::default(), flow: None, skew: None }
    }

    /// Identifies and configures the adapter and starts the stream. The encoder supply is switched on if `supply` is
    /// given.
    ///
    /// # Errors
    /// Returns [`AdapterError::Version`], [`NoBiss`](AdapterError::NoBiss), [`NoAnalog`](AdapterError::NoAnalog) or
    /// [`NoSupply`](AdapterError::NoSupply) if the adapter is not suitable. Returns another error if the adapter
    /// rejects a request or the connection fails.
    pub fn start(
        &mut self,
        ctx: Ctx<'_>,
        wanted: StreamRequest,
        supply: Option<SupplyVoltage>,
    ) -> Result<StreamingAdapter, AdapterStreamError> {
        let mut line = SerialLine::new(ctx);
        let mut adapter = Adapter { line: &mut line, state: &mut self.line, adapter: &mut self.adapter };
        adapter.read_identity()?;
        let Some(hello) = adapter.adapter.identity().cloned() else { return Err(AdapterError::Silent.into()) };
        let name = || hello.name.clone();
        let (capability, lacks): (_, fn(String) -> AdapterError) = match wanted {
            StreamRequest::Biss { .. } => (Capabilities::BISS, |name| AdapterError::NoBiss { name }),
            StreamRequest::Analog { .. } => (Capabilities::ANALOG, |name| AdapterError::NoAnalog { name }),
        };
        if !hello.capabilities.contains(capability) {
            return Err(lacks(name()).into());
        }
        let supplied = match supply {
            Some(voltage) => {
                let supplied = adapter.switch_supply_on(voltage)?;
                adapter.line.wait(POWER_UP).map_err(Failure::Line)?;
                Some(supplied)
            }
            None => None,
        };
        let request = wanted.configuration_request(&hello);
        let answered = adapter.send_request(&request)?;
        let (streamed, full_scale_microvolt) = match (wanted, &answered.reply) {
            (StreamRequest::Biss { period_us, .. }, Reply::BissConfig { .. }) => (StreamKind::Biss { period_us }, 0),
            (StreamRequest::Analog { .. }, Reply::AnalogConfig { sample_hz, full_scale_microvolt, .. }) => {
                (StreamKind::Analog { period_ns: period_ns(*sample_hz) }, *full_scale_microvolt)
            }
            _ => {
                return Err(AdapterStreamError::from(Failure::from(AdapterError::unexpected_reply(
                    request.operation(),
                    &answered.reply,
                ))));
            }
        };
        let skew_ns = match streamed {
            StreamKind::Analog { .. } => adapter.skew_ns(&hello)?,
            _ => 0,
        };
        let flow = SampleStream::start(&mut adapter, streamed, None)?;
        let period_ns = flow.period_ns();
        self.flow = Some(flow);
        self.skew = SkewCorrection::new(skew_ns, period_ns);
        Ok(StreamingAdapter { hello, period_ns, full_scale_microvolt, skew_ns, supplied })
    }

    /// Returns the next samples, or `None` if no samples have arrived by `until` or no stream is running.
    ///
    /// # Errors
    /// Returns an error with the reason if the stream has ended.
    pub fn next(&mut self, ctx: Ctx<'_>, until: Moment) -> Result<Option<Chunk>, AdapterStreamError> {
        let Some(flow) = &mut self.flow else { return Ok(None) };
        let mut line = SerialLine::new(ctx);
        let mut adapter = Adapter { line: &mut line, state: &mut self.line, adapter: &mut self.adapter };
        let mut chunk = flow.next(&mut adapter, until)?;
        if let (Some(Chunk { lost, data: StreamData::Analog(data), .. }), Some(skew)) = (&mut chunk, &mut self.skew) {
            if *lost > 0 {
                skew.reset();
            }
            skew.apply(&mut data.samples);
        }
        Ok(chunk)
    }

    /// Ends the stream and returns the encoder supply to its previous state. Cancellation is ignored.
    ///
    /// # Errors
    /// Returns an error if the adapter or the connection fails.
    pub fn stop(&mut self, ctx: Ctx<'_>) -> Result<(), AdapterStreamError> {
        let mut line = SerialLine::new(ctx);
        line.ignore_cancellation(true);
        let mut adapter = Adapter { line: &mut line, state: &mut self.line, adapter: &mut self.adapter };
        let ended = self.flow.take().map_or(Ok(()), |flow| flow.stop(&mut adapter));
        let left = adapter.switch_off_after_session();
        Ok(ended.and(left)?)
    }
}

impl Adapter<'_, '_> {
    /// Reads how much later than the sine the adapter samples the cosine, in nanoseconds. Returns 0 for adapters that
    /// sample both signals at the same time.
    fn skew_ns(&mut self, hello: &Hello) -> Result<u16, Failure> {
        if !hello.capabilities.contains(Capabilities::ANALOG_SKEW) {
            return Ok(0);
        }
        match self.send_request(&Request::AnalogSkew)?.reply {
            Reply::AnalogSkew { skew_ns } => Ok(skew_ns),
            other => Err(AdapterError::unexpected_reply(Request::AnalogSkew.operation(), &other).into()),
        }
    }
}

impl StreamRequest {
    /// Returns the request that configures the adapter. Its speed is limited to what the adapter supports.
    fn configuration_request(self, hello: &Hello) -> Request {
        match self {
            StreamRequest::Biss { clock_hz, data_bits, crc_bits, .. } => Request::BissConfig {
                clock_hz: clock_hz.min(hello.max_clock_hz),
                data_bits,
                crc_bits,
                timeout_us: BISS_TIME_OUT_US,
            },
            StreamRequest::Analog { sample_hz } => {
                Request::AnalogConfig { sample_hz: sample_hz.min(hello.max_sample_hz) }
            }
        }
    }
}

/// Returns the interval of a sample rate, rounded to whole nanoseconds.
fn period_ns(sample_hz: u32) -> i64 {
    let hz = i64::from(sample_hz.max(1));
    (1_000_000_000 + hz / 2) / hz
}
