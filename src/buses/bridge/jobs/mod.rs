//! An adapter as a source of samples. It is opened, identified, configured and stopped on the streaming thread, so no
//! other thread has to wait for it. Damaged or lost samples are reported as missing before the next batch.

mod open;

use std::convert::Infallible;
use std::sync::{Arc, OnceLock};
use std::time::Duration;

use crate::buses::bridge::procedures::{AdapterStreamError, Chunk, StreamRequest, StreamTap, StreamingAdapter};
use crate::buses::bridge::protocol::StreamData;
use crate::link::{ByteLink, CancelToken, Clock, Ctx, Trace};
use crate::units::SupplyVoltage;
use crate::worker::OpenError;
use crate::worker::stream::{Batch, Producer, SampleCount};

pub(crate) use open::FORMAT;
pub use open::open_adapter;

/// Configuration of a stream, and conversion of its packets to samples.
pub trait StreamFormat: Send + 'static {
    type Samples: SampleCount;

    fn stream_request(&self) -> StreamRequest;

    /// Returns the samples of a packet, or `None` if the packet does not belong to this stream.
    fn read(&self, data: StreamData, streaming: &StreamingAdapter) -> Option<Self::Samples>;
}

#[derive(Clone, Copy, Debug)]
pub struct SineCosine {
    pub sample_hz: u32,
}

/// Sine and cosine signals in volts. Both have the same number of samples.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SineCosineSamples {
    pub sine_v: Vec<f64>,
    pub cosine_v: Vec<f64>,
}

/// The reason why an adapter does not stream or has stopped streaming.
#[derive(Debug, thiserror::Error)]
pub enum BridgeError {
    #[error(transparent)]
    Open(#[from] OpenError),
    #[error(transparent)]
    Tap(#[from] AdapterStreamError),
}

/// A function that opens the connection to an adapter.
pub type OpenAdapterFn = Box<dyn FnOnce() -> Result<Box<dyn ByteLink>, OpenError> + Send>;

pub struct Bridge<S> {
    format: S,
    supply: Option<SupplyVoltage>,
    open: Option<OpenAdapterFn>,
    wire: Option<Box<dyn ByteLink>>,
    tap: StreamTap,
    streaming: Arc<OnceLock<StreamingAdapter>>,
}

impl<S: StreamFormat> Bridge<S> {
    /// Creates a producer for an adapter. `open` opens its connection. `margin` extends the time limit for replies. The
    /// encoder supply is switched on only if `supply` is `Some`.
    pub fn new(format: S, supply: Option<SupplyVoltage>, margin: Duration, open: OpenAdapterFn) -> Self {
        Bridge { format, supply, open: Some(open), wire: None, tap: StreamTap::new(margin), streaming: Arc::default() }
    }

    /// Returns the adapter and its actual settings, which are set once the adapter streams and are kept afterwards.
    pub fn streaming_adapter(&self) -> Arc<OnceLock<StreamingAdapter>> {
        self.streaming.clone()
    }

    fn begin_stream(&mut self, clock: &dyn Clock) -> Result<(), BridgeError> {
        let Some(open) = self.open.take() else { return Ok(()) };
        let wire = self.wire.insert(open()?);
        let (cancel, mut trace) = (CancelToken::default(), Trace::default());
        let ctx = Ctx { wire: &mut **wire, clock, cancel: &cancel, trace: &mut trace };
        let streaming = self.tap.start(ctx, self.format.stream_request(), self.supply)?;
        // The value is only set once, since the stream begins once.
        let _ = self.streaming.set(streaming);
        Ok(())
    }
}

impl<S: StreamFormat> Producer for Bridge<S> {
    type Request = Infallible;
    type Samples = S::Samples;
    type Error = BridgeError;

    fn apply_change(&mut self, wish: Infallible) {
        match wish {}
    }

    fn next(&mut self, clock: &dyn Clock, patience: Duration) -> Result<Option<Batch<S::Samples>>, BridgeError> {
        self.begin_stream(clock)?;
        let (Some(wire), Some(streaming)) = (&mut self.wire, self.streaming.get()) else { return Ok(None) };
        let (cancel, mut trace) = (CancelToken::default(), Trace::default());
        let ctx = Ctx { wire: &mut **wire, clock, cancel: &cancel, trace: &mut trace };
        let Some(portion) = self.tap.next(ctx, clock.now() + patience)? else { return Ok(None) };
        let Chunk { first, time, period_ns, lost, data } = portion;
        let samples = self.format.read(data, streaming);
        Ok(samples.map(|samples| Batch { first, time, period_ns, lost, samples }))
    }

    fn end(&mut self, clock: &dyn Clock) {
        let Some(wire) = &mut self.wire else { return };
        let (cancel, mut trace) = (CancelToken::default(), Trace::default());
        let ctx = Ctx { wire: &mut **wire, clock, cancel: &cancel, trace: &mut trace };
        if let Err(error) = self.tap.stop(ctx) {
            // The stream ends with the next HELLO.
            tracing::warn!("the adapter's stream could not be ended: {error}");
        }
    }
}

impl StreamFormat for SineCosine {
    type Samples = SineCosineSamples;

    fn stream_request(&self) -> StreamRequest {
        StreamRequest::Analog { sample_hz: self.sample_hz }
    }

    fn read(&self, data: StreamData, streaming: &StreamingAdapter) -> Option<SineCosineSamples> {
        let StreamData::Analog(data) = data else { return None };
        let unit_v = f64::from(streaming.full_scale_microvolt) * 1e-6 / f64::from(i16::MAX);
        let (sine_v, cosine_v) =
            data.samples.iter().map(|(sine, cosine)| (f64::from(*sine) * unit_v, f64::from(*cosine) * unit_v)).unzip();
        Some(SineCosineSamples { sine_v, cosine_v })
    }
}

impl SampleCount for SineCosineSamples {
    fn count(&self) -> usize {
        self.sine_v.len()
    }
}

#[cfg(test)]
pub(crate) mod tests;
