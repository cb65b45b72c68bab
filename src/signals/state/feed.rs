//! Live sine and cosine samples from the virtual encoder or an adapter.

use std::sync::{Arc, OnceLock};
use std::time::Duration;

use crate::signals::state::TEXTS;

use crossbeam_channel::Receiver;

use crate::analysis::wiring::Wires;
use crate::app::services::Services;
use crate::app::{Text, explain};
use crate::buses::bridge::jobs::{Bridge, BridgeError, OpenAdapterFn, SineCosine, SineCosineSamples, open_adapter};
use crate::buses::bridge::procedures::{AdapterStreamError, StreamingAdapter};
use crate::buses::bridge::state as bridge;
use crate::kinds::attachable_kinds;
use crate::link::{Clock, LinkScheme, LinkUrl, RealClock};
use crate::sim::sine_cosine::CheckedSettings;
use crate::units::SupplyVoltage;
use crate::worker::OpenError;
use crate::worker::stream::{AnalogueSource, Batch, Producer, Stream, StreamEnd};

/// Sine and cosine in volts, with the same number of samples each.
#[derive(Clone, Debug)]
pub(super) struct ChannelSamples {
    pub(super) sine_v: Vec<f64>,
    pub(super) cosine_v: Vec<f64>,
    /// Voltages of the four signal wires, if known.
    pub(super) wires: Option<Wires>,
}

impl ChannelSamples {
    pub(super) fn len(&self) -> usize {
        self.sine_v.len()
    }

    /// Returns the samples of a wire. The slice is empty if they are unknown.
    pub(super) fn wire_samples(&self, of: fn(&Wires) -> &Vec<f64>) -> &[f64] {
        self.wires.as_ref().map_or(&[], |wires| of(wires))
    }
}

impl From<Wires> for ChannelSamples {
    fn from(wires: Wires) -> Self {
        ChannelSamples { sine_v: wires.sine_v(), cosine_v: wires.cosine_v(), wires: Some(wires) }
    }
}

impl From<SineCosineSamples> for ChannelSamples {
    fn from(pair: SineCosineSamples) -> Self {
        ChannelSamples { sine_v: pair.sine_v, cosine_v: pair.cosine_v, wires: None }
    }
}

pub(super) enum SignalFeed {
    Virtual(Stream<AnalogueSource>),
    Adapter {
        stream: Stream<Bridge<SineCosine>>,
        /// Identity and actual sampling of the adapter, unset until the adapter has replied.
        streaming: Arc<OnceLock<StreamingAdapter>>,
        url: LinkUrl,
    },
}

/// The link to an adapter that has not been connected yet.
pub(super) struct AdapterLink {
    url: LinkUrl,
    clock: Arc<dyn Clock>,
    margin: Duration,
    open: OpenAdapterFn,
}

impl AdapterLink {
    /// Parses a link to an adapter.
    ///
    /// # Errors
    /// Returns the reason why the link does not lead to an adapter.
    pub(super) fn read(text: &str) -> Result<Self, Text> {
        let url: LinkUrl =
            text.parse().map_err(|why| TEXTS.text("adapter.link").with_text("why", explain::url_error_text(&why)))?;
        let clock: Arc<dyn Clock> = Arc::new(RealClock::start());
        let (margin, open) =
            open_adapter(&url, clock.clone(), attachable_kinds()).map_err(|error| open_error_text(&error))?;
        Ok(AdapterLink { url, clock, margin, open })
    }

    /// Starts sampling at the given rate. If a voltage is given, the adapter supplies the encoder. A missing adapter is
    /// reported later by the stream.
    ///
    /// # Errors
    /// Returns an error if no thread can be started.
    pub(super) fn start(
        self,
        sample_hz: u32,
        supply: Option<SupplyVoltage>,
        earlier: Option<Receiver<()>>,
        services: &Services,
    ) -> Result<SignalFeed, Text> {
        let AdapterLink { url, clock, margin, open } = self;
        let (before, patience) = (services.sessions_closing_on_link(&url), services.world.patience.job);
        let open: OpenAdapterFn = Box::new(move || {
            if let Some(earlier) = earlier {
                // This only waits for the sender to be dropped, because the channel carries no messages.
                let _ = earlier.recv_timeout(patience);
            }
            // The connection can only be opened after its previous users have released it.
            for (ending, patience) in before {
                ending.wait_for_end(patience);
            }
            open()
        });
        let bridge = Bridge::new(SineCosine { sample_hz }, supply, margin, open);
        let streaming = bridge.streaming_adapter();
        Ok(SignalFeed::Adapter { stream: spawn_stream(bridge, clock, services)?, streaming, url })
    }
}

/// Maximum number of samples waiting for the window: two seconds at 100 kHz.
const MAX_WAITING_SAMPLES: usize = 200_000;

impl SignalFeed {
    /// Starts sampling the virtual encoder.
    ///
    /// # Errors
    /// Returns an error if no thread can be started.
    pub(super) fn start_virtual(checked: CheckedSettings, services: &Services) -> Result<Self, Text> {
        let clock: Arc<dyn Clock> = Arc::new(RealClock::start());
        let producer = AnalogueSource::new(checked, clock.now());
        Ok(SignalFeed::Virtual(spawn_stream(producer, clock, services)?))
    }

    /// Returns the batches received since the last call.
    pub(super) fn take_batches(&self) -> Vec<Batch<ChannelSamples>> {
        match self {
            SignalFeed::Virtual(stream) => stream.take_batches().into_iter().map(to_channels).collect(),
            SignalFeed::Adapter { stream, .. } => stream.take_batches().into_iter().map(to_channels).collect(),
        }
    }

    pub(super) fn lost_samples(&self) -> u64 {
        match self {
            SignalFeed::Virtual(stream) => stream.lost_samples(),
            SignalFeed::Adapter { stream, .. } => stream.lost_samples(),
        }
    }

    pub(super) fn is_finished(&self) -> bool {
        match self {
            SignalFeed::Virtual(stream) => stream.is_finished(),
            SignalFeed::Adapter { stream, .. } => stream.is_finished(),
        }
    }

    pub(super) fn end_reason(&self) -> Text {
        match self {
            SignalFeed::Virtual(stream) if stream.take_error().is_some() => TEXTS.text("virtual.forgotten"),
            SignalFeed::Virtual(_) => TEXTS.text("virtual.ended"),
            SignalFeed::Adapter { stream, .. } => match stream.take_error() {
                Some(error) => bridge_error_text(&error),
                None => TEXTS.text("virtual.ended"),
            },
        }
    }

    /// Returns the identity and actual sampling of the adapter, or `None` for the virtual encoder.
    pub(super) fn streaming_adapter(&self) -> Option<&StreamingAdapter> {
        match self {
            SignalFeed::Virtual(_) => None,
            SignalFeed::Adapter { streaming, .. } => streaming.get(),
        }
    }

    pub(super) fn is_virtual(&self) -> bool {
        match self {
            SignalFeed::Virtual(_) => true,
            SignalFeed::Adapter { url, .. } => url.scheme == LinkScheme::Sim,
        }
    }

    pub(super) fn change_settings(&self, checked: CheckedSettings) {
        if let SignalFeed::Virtual(stream) = self {
            stream.request_change(checked);
        }
    }

    /// Stops the feed if it is running. A stopped feed appears as one that has ended without a request.
    #[cfg(test)]
    pub(super) fn stop(&self) {
        match self {
            SignalFeed::Virtual(stream) => stream.stop(),
            SignalFeed::Adapter { stream, .. } => stream.stop(),
        }
    }

    /// Releases the feed. The adapter's stream ends in the background.
    pub(super) fn release(self, services: &mut Services) {
        if let SignalFeed::Adapter { stream, url, .. } = self {
            let end: StreamEnd = stream.end_signal();
            drop(stream);
            services.close_stream(end, url);
        }
    }
}

fn spawn_stream<P: Producer>(producer: P, clock: Arc<dyn Clock>, services: &Services) -> Result<Stream<P>, Text> {
    let refused = |error| Text::new("session.no_thread").with("why", error);
    Stream::spawn(producer, MAX_WAITING_SAMPLES, clock, services.tasks.wake_callback()).map_err(refused)
}

fn to_channels<S: Into<ChannelSamples>>(batch: Batch<S>) -> Batch<ChannelSamples> {
    let Batch { first, time, period_ns, lost, samples } = batch;
    Batch { first, time, period_ns, lost, samples: samples.into() }
}

pub(crate) fn bridge_error_text(error: &BridgeError) -> Text {
    match error {
        BridgeError::Open(error) => open_error_text(error),
        BridgeError::Tap(AdapterStreamError::Link(error)) => explain::link_error_text(error),
        BridgeError::Tap(AdapterStreamError::Adapter(error)) => bridge::adapter_error_text(error),
        BridgeError::Tap(AdapterStreamError::Cancelled) => TEXTS.text("virtual.ended"),
    }
}

pub(crate) fn open_error_text(error: &OpenError) -> Text {
    match error {
        OpenError::Url(why) => TEXTS.text("adapter.link").with_text("why", explain::url_error_text(why)),
        OpenError::Sim(why) => TEXTS.text("adapter.link").with_text("why", explain::setting_error_text(why)),
        other => explain::open_error_text(other),
    }
}
