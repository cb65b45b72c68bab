//! A live source (the virtual encoder or an adapter) with its settings and newest samples. The samples come from
//! `worker::stream` and are measured a few times per second. Drawing never waits for them.

use std::sync::Arc;

use crate::signals::state::TEXTS;

use crossbeam_channel::Receiver;

use super::feed::{AdapterLink, SignalFeed};
use super::recent::{MAX_SAMPLES, RecentSamples};
use super::{FailedTask, Measurement, Origin, Scope, Signals, TaskResult, task_guard};
use crate::analysis::SampleTime;
use crate::analysis::quality::Family;
use crate::analysis::wiring::Wire;
use crate::app::services::Services;
use crate::app::shutdown::is_same_connection;
use crate::app::{Severity, Text, explain};
use crate::buses::bridge::procedures::StreamingAdapter;
use crate::link::LinkUrl;
use crate::sim::sine_cosine::{Quantity, ReferenceLevel, Settings};

#[derive(Clone, Debug, PartialEq)]
pub enum SourceAction {
    Start,
    StartAdapter,
    /// Set the link to the adapter. A running adapter is not affected.
    SetLink(String),
    /// Set the adapter's sample rate. A running adapter is not affected.
    SetSampleRate(u32),
    /// Set the encoder family to which the adapter supplies power, or `None` for no supply. A running adapter is not
    /// affected.
    SetSupply(Option<Family>),
    /// Stop the source. The last measurement remains on display.
    Stop,
    /// Freeze or resume the display. The source continues to run.
    Freeze(bool),
    /// Set a value of the virtual encoder. A value out of range is rejected.
    Set(Quantity, f64),
    SetOpenWire(Option<Wire>),
    /// Set whether each pair of wires is terminated by a resistor.
    SetTerminated(bool),
    SetReferences(ReferenceLevel),
    /// Set the duration of the measured samples, up to the newest one: 10 to 10 000 milliseconds.
    SetWindow(u32),
    Reset,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SourceKind {
    #[default]
    Encoder,
    Adapter,
}

pub struct Source {
    settings: Settings,
    problem: Option<Text>,
    /// Link to the adapter, as entered.
    link: String,
    sample_hz: u32,
    /// Family of the encoder to which the adapter supplies power. It is never stored in the settings, because another
    /// encoder may be connected at the next start.
    supply: Option<Family>,
    adapter_problem: Option<Text>,
    /// Kind of the last started source.
    kind: SourceKind,
    window_ms: u32,
    runs: u32,
    /// Number of lost samples, without those lost by the running stream.
    lost: u64,
    live: Option<LiveSource>,
}

struct LiveSource {
    feed: SignalFeed,
    recent: RecentSamples,
    held: bool,
    measuring: bool,
    /// Time of the newest sample in the latest measurement.
    measured: Option<SampleTime>,
}

/// Range of the measured duration, in milliseconds.
const WINDOWS: std::ops::RangeInclusive<u32> = 10..=10_000;
/// Link to the virtual adapter. Its shaft turns slowly, so that single signal periods are visible.
pub const VIRTUAL_ADAPTER: &str = "sim:?bridge=on&rpm=6";

impl Default for Source {
    fn default() -> Self {
        Source {
            settings: Settings::default(),
            problem: None,
            link: VIRTUAL_ADAPTER.to_owned(),
            sample_hz: 100_000,
            supply: None,
            adapter_problem: None,
            kind: SourceKind::default(),
            window_ms: 200,
            runs: 0,
            lost: 0,
            live: None,
        }
    }
}

impl Source {
    /// Creates the state from the link of the last used adapter.
    pub(super) fn with_link(link: Option<&String>) -> Self {
        let usual = Source::default();
        Source { link: link.cloned().unwrap_or(usual.link), ..Source::default() }
    }

    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Returns the reason why the last setting was rejected.
    pub fn problem(&self) -> Option<&Text> {
        self.problem.as_ref()
    }

    pub fn link(&self) -> &str {
        &self.link
    }

    /// Returns the sample rate requested from the adapter, in samples per second.
    pub fn sample_hz(&self) -> u32 {
        self.sample_hz
    }

    /// Returns the family of the encoder to which the adapter supplies power, or `None` for no supply.
    pub fn supplied_family(&self) -> Option<Family> {
        self.supply
    }

    /// Returns the reason why the adapter could not start or has stopped.
    pub fn adapter_problem(&self) -> Option<&Text> {
        self.adapter_problem.as_ref()
    }

    pub fn kind(&self) -> SourceKind {
        self.kind
    }

    /// Returns the identity and sampling of the running adapter, or `None` until they are known.
    pub fn streaming_adapter(&self) -> Option<&StreamingAdapter> {
        self.live.as_ref().and_then(|live| live.feed.streaming_adapter())
    }

    /// Returns whether the running source is virtual.
    pub fn is_virtual(&self) -> bool {
        self.live.as_ref().is_some_and(|live| live.feed.is_virtual())
    }

    pub fn window_ms(&self) -> u32 {
        self.window_ms
    }

    pub fn is_running(&self) -> bool {
        self.live.is_some()
    }

    /// Returns whether the display is frozen while the source runs.
    pub fn is_frozen(&self) -> bool {
        self.live.as_ref().is_some_and(|live| live.held)
    }

    /// Returns the maximum duration that can be measured, in milliseconds, if the setting exceeds it.
    pub fn limited_window_ms(&self) -> Option<f64> {
        let period_ns = match self.kind {
            SourceKind::Encoder => self.settings.period_ns(),
            SourceKind::Adapter => self.streaming_adapter()?.period_ns,
        };
        let longest_ms = MAX_SAMPLES as f64 * period_ns as f64 / 1e6;
        (longest_ms < f64::from(self.window_ms)).then_some(longest_ms)
    }

    /// Returns the number of samples lost since the last start: those that did not arrive, were not read in time, or
    /// could not be displayed.
    pub fn lost_samples(&self) -> u64 {
        self.lost + self.live.as_ref().map_or(0, |live| live.feed.lost_samples())
    }

    pub(super) fn stop(&mut self, services: &mut Services) {
        self.lost = self.lost_samples();
        if let Some(live) = self.live.take() {
            live.feed.release(services);
        }
    }

    fn change_settings(&mut self, settings: Settings) -> bool {
        match settings.validate() {
            Ok(checked) => {
                self.settings = checked.settings().clone();
                self.problem = None;
                if let Some(live) = &self.live {
                    live.feed.change_settings(checked);
                }
                true
            }
            Err(error) => {
                self.problem = Some(explain::signal::setting_value_error_text(&error));
                false
            }
        }
    }

    fn start_encoder(&mut self, services: &mut Services) -> bool {
        let checked = match self.settings.clone().validate() {
            Ok(checked) => checked,
            Err(error) => {
                self.problem = Some(explain::signal::setting_value_error_text(&error));
                return false;
            }
        };
        match SignalFeed::start_virtual(checked, services) {
            Ok(feed) => {
                self.run(SourceKind::Encoder, feed, services);
                true
            }
            Err(why) => {
                services.notify(Severity::Error, vec![why], None);
                false
            }
        }
    }

    /// Returns the link to the adapter, or `None` if the entry is not a valid link.
    pub(crate) fn adapter_url(&self) -> Option<LinkUrl> {
        self.link.parse().ok()
    }

    pub(crate) fn show_rejection(&mut self, why: Text) {
        self.adapter_problem = Some(why);
    }

    /// Stops the adapter if it uses the given link's connection, which is needed to search for encoders.
    pub(crate) fn release_connection(&mut self, url: &LinkUrl, services: &mut Services) {
        let holds = |live: &LiveSource| matches!(&live.feed, SignalFeed::Adapter { url: own, .. } if is_same_connection(own, url));
        if self.live.as_ref().is_some_and(holds) {
            self.stop(services);
            self.show_rejection(TEXTS.text("adapter.let_go"));
        }
    }

    /// Starts the adapter and returns whether it has started. An invalid link is reported next to its entry.
    fn start_adapter(&mut self, earlier: Option<Receiver<()>>, services: &mut Services) -> bool {
        let link = match AdapterLink::read(&self.link) {
            Ok(link) => link,
            Err(why) => {
                self.adapter_problem = Some(why);
                return false;
            }
        };
        // A running source must release its connection first.
        self.stop(services);
        match link.start(self.sample_hz, self.supply.map(Family::supply_voltage), earlier, services) {
            Ok(feed) => {
                self.adapter_problem = None;
                self.run(SourceKind::Adapter, feed, services);
                true
            }
            Err(why) => {
                services.notify(Severity::Error, vec![why], None);
                false
            }
        }
    }

    fn run(&mut self, kind: SourceKind, feed: SignalFeed, services: &mut Services) {
        self.stop(services);
        self.kind = kind;
        self.runs = self.runs.wrapping_add(1);
        self.lost = 0;
        self.live =
            Some(LiveSource { feed, recent: RecentSamples::default(), held: false, measuring: false, measured: None });
    }
}

impl LiveSource {
    fn origin(&self) -> Option<Origin> {
        match &self.feed {
            SignalFeed::Virtual(_) => Some(Origin::Virtual),
            SignalFeed::Adapter { .. } => {
                let name = self.feed.streaming_adapter()?.hello.name.clone();
                Some(Origin::Adapter { name, is_virtual: self.feed.is_virtual() })
            }
        }
    }
}

impl Signals {
    pub(super) fn handle_source_action(&mut self, action: SourceAction, services: &mut Services) {
        let settings = self.source.settings().clone();
        match action {
            SourceAction::Start => {
                if self.source.start_encoder(services) {
                    self.abort_reading();
                    self.replace_scope(Scope::live(true), services);
                    self.set_periods(settings.periods as u32, true, services);
                }
            }
            // The application starts the adapter, because it knows which other parts use the connection.
            SourceAction::StartAdapter => {}
            SourceAction::SetLink(link) => {
                self.source.link = link;
                self.source.adapter_problem = None;
            }
            SourceAction::SetSampleRate(sample_hz) => self.source.sample_hz = sample_hz.max(1),
            SourceAction::SetSupply(supply) => {
                self.source.supply = supply;
                self.source.adapter_problem = None;
            }
            SourceAction::Stop => self.source.stop(services),
            SourceAction::Freeze(held) => {
                if let Some(live) = &mut self.source.live {
                    live.held = held;
                    // Samples that arrived while the display was frozen are missing, so the trace has a gap.
                    self.scope.mark_gap();
                }
            }
            SourceAction::Set(quantity, value) => {
                self.set_source(settings.with_value(quantity, value), quantity == Quantity::Periods, services);
            }
            SourceAction::SetOpenWire(open_wire) => {
                self.set_source(Settings { open_wire, ..settings }, false, services)
            }
            SourceAction::SetTerminated(terminated) => {
                self.set_source(Settings { terminated, ..settings }, false, services);
            }
            SourceAction::SetReferences(references) => {
                self.set_source(Settings { references, ..settings }, false, services);
            }
            SourceAction::SetWindow(milliseconds) => {
                self.source.window_ms = milliseconds.clamp(*WINDOWS.start(), *WINDOWS.end());
            }
            SourceAction::Reset => self.set_source(Settings::default(), true, services),
        }
    }

    /// Starts the adapter once its connection is free. `earlier` closes at that moment.
    pub(crate) fn start_adapter(&mut self, earlier: Option<Receiver<()>>, services: &mut Services) {
        if self.source.start_adapter(earlier, services) {
            self.abort_reading();
            self.replace_scope(Scope::live(false), services);
        }
    }

    /// Changes the settings of the virtual encoder. If `with_periods` is set, its periods per revolution also apply to
    /// the displayed capture.
    fn set_source(&mut self, settings: Settings, with_periods: bool, services: &mut Services) {
        let own = self.source.kind == SourceKind::Encoder;
        if self.source.change_settings(settings) && with_periods && own {
            self.set_periods(self.source.settings().periods as u32, true, services);
        }
    }

    /// Takes the received samples, and starts the next measurement when it is due.
    pub(crate) fn process_samples(&mut self, services: &mut Services) {
        let (number, window_ms) = (self.source.runs, self.source.window_ms);
        let judge = self.diagnosis_settings();
        let Some(live) = &mut self.source.live else { return };
        // This is checked first, since the last samples before the end must still be taken.
        let ended = live.feed.is_finished();
        for batch in live.feed.take_batches() {
            if !live.held {
                self.source.lost += self.scope.add_batch(&batch);
            }
            live.recent.add_batch(batch);
        }
        if ended {
            self.handle_source_end(services);
            return;
        }
        if live.held || live.measuring || !live.recent.is_due(live.measured) {
            return;
        }
        let Some((window, origin)) = live.recent.latest_window(window_ms).zip(live.origin()) else { return };
        live.measuring = true;
        live.measured = live.recent.latest_time();
        task_guard::run(&services.tasks, "measure", TaskResult::Failed(FailedTask::Measure(number)), move || {
            let measurement = Measurement::from_capture(origin, Arc::new(window.to_capture()), judge);
            TaskResult::Measured { number, measurement: Box::new(measurement) }
        });
    }

    fn handle_source_end(&mut self, services: &mut Services) {
        let Some(why) = self.source.live.as_ref().map(|live| live.feed.end_reason()) else { return };
        self.source.stop(services);
        if self.source.kind == SourceKind::Adapter {
            self.source.adapter_problem = Some(why.clone());
        }
        services.notify(Severity::Error, vec![why], None);
    }

    pub(super) fn handle_measurement(&mut self, number: u32, measurement: Measurement, services: &mut Services) {
        let current = self.source.runs == number;
        let Some(live) = self.source.live.as_mut().filter(|_| current) else { return };
        live.measuring = false;
        if live.held {
            return;
        }
        let judge = measurement.diagnosis_settings;
        self.show_live_measurement(measurement, services);
        // The settings have changed during the measurement.
        if judge != self.diagnosis_settings() {
            self.update_verdicts(services);
        }
    }

    /// Handles a failed measurement of the newest samples. The source is stopped, because further measurements would
    /// fail too.
    pub(super) fn stop_after_failed_measurement(&mut self, number: u32, services: &mut Services) -> bool {
        let current = self.source.runs == number && self.source.is_running();
        if current {
            self.source.stop(services);
        }
        current
    }
}

#[cfg(test)]
mod tests;
