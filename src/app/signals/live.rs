//! The virtual encoder as a source: its settings, its newest samples, and the measurement of them, which is made again a
//! few times a second. Samples come from `worker::stream`; whoever draws never waits for them.

use std::sync::Arc;

use super::recent::{MOST, Recent};
use super::{Done, Failed, Measurement, Origin, Scope, Signals, promise};
use crate::app::services::Services;
use crate::app::{Severity, Text, explain};
use crate::link::{Clock, RealClock};
use crate::signal::Time;
use crate::signal::wires::Wire;
use crate::sim::sine_cosine::{Quantity, References, Settings};
use crate::worker::stream::{Analogue, Stream};

/// What a person asks of the virtual encoder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SourceAction {
    /// Let it turn.
    Start,
    /// Stand still; what was measured last stays.
    Stop,
    /// Keep what is shown while it turns on, or go on.
    Hold(bool),
    /// Another value of a setting; one outside of its range is refused in words.
    Set(Quantity, f64),
    /// Break a wire, or mend it.
    SetOpenWire(Option<Wire>),
    /// With a resistor between the wires of a pair, or without.
    SetTerminated(bool),
    /// What the references carry.
    SetReferences(References),
    /// Measure the newest samples of so many milliseconds, 10 to 10 000.
    SetWindow(u32),
    /// All settings as they were to begin with.
    Reset,
}

/// The virtual encoder, running or not.
pub struct Source {
    /// What was set last and could be.
    settings: Settings,
    problem: Option<Text>,
    window_ms: u32,
    runs: u32,
    /// Samples that were lost, but for those that the stream counts while it runs.
    lost: u64,
    live: Option<Live>,
}

/// A running source.
struct Live {
    stream: Stream<Analogue>,
    recent: Recent,
    held: bool,
    /// A task measures.
    measuring: bool,
    /// The last sample of the latest measurement.
    measured: Option<Time>,
}

/// Samples that wait for the window, at most: two seconds at 100 kHz.
const WAITING: usize = 200_000;
/// Windows that can be measured, in milliseconds.
const WINDOWS: std::ops::RangeInclusive<u32> = 10..=10_000;

impl Default for Source {
    fn default() -> Self {
        Source { settings: Settings::default(), problem: None, window_ms: 200, runs: 0, lost: 0, live: None }
    }
}

impl Source {
    /// What is set.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Why the last setting was refused.
    pub fn problem(&self) -> Option<&Text> {
        self.problem.as_ref()
    }

    /// How many milliseconds of the newest samples are measured.
    pub fn window_ms(&self) -> u32 {
        self.window_ms
    }

    /// It turns.
    pub fn is_running(&self) -> bool {
        self.live.is_some()
    }

    /// What is shown is kept while it turns on.
    pub fn is_held(&self) -> bool {
        self.live.as_ref().is_some_and(|live| live.held)
    }

    /// The milliseconds that are measured where the samples that can be measured at once last shorter than what is set.
    pub fn shortened_ms(&self) -> Option<f64> {
        let longest_ms = MOST as f64 * self.settings.period_ns() as f64 / 1e6;
        (longest_ms < f64::from(self.window_ms)).then_some(longest_ms)
    }

    /// Samples that were lost since it was started last, because nobody read them in time or nobody could show them.
    pub fn lost(&self) -> u64 {
        self.lost + self.live.as_ref().map_or(0, |live| live.stream.lost())
    }

    pub(super) fn stop(&mut self) {
        self.lost = self.lost();
        self.live = None;
    }

    /// Whether it could be.
    fn change(&mut self, settings: Settings) -> bool {
        match settings.checked() {
            Ok(checked) => {
                self.settings = checked.settings().clone();
                self.problem = None;
                if let Some(live) = &self.live {
                    live.stream.change(checked);
                }
                true
            }
            Err(error) => {
                self.problem = Some(explain::signal::setting(&error));
                false
            }
        }
    }

    /// Whether it runs now.
    fn start(&mut self, services: &mut Services) -> bool {
        let clock: Arc<dyn Clock> = Arc::new(RealClock::start());
        let checked = match self.settings.clone().checked() {
            Ok(checked) => checked,
            Err(error) => {
                self.problem = Some(explain::signal::setting(&error));
                return false;
            }
        };
        let producer = Analogue::new(checked, clock.now());
        match Stream::spawn(producer, WAITING, clock, services.tasks.wake()) {
            Ok(stream) => {
                self.runs = self.runs.wrapping_add(1);
                self.lost = 0;
                let recent = Recent::default();
                self.live = Some(Live { stream, recent, held: false, measuring: false, measured: None });
                true
            }
            Err(error) => {
                let text = Text::new("session.no_thread").with("why", error);
                services.tell(Severity::Error, vec![text], None);
                false
            }
        }
    }
}

impl Signals {
    pub(super) fn act_source(&mut self, action: SourceAction, services: &mut Services) {
        let settings = self.source.settings().clone();
        match action {
            SourceAction::Start => {
                if self.source.start(services) {
                    self.forget_reading();
                    self.replace_scope(Scope::live(), services);
                    self.set_periods(settings.periods as u32, services);
                }
            }
            SourceAction::Stop => self.source.stop(),
            SourceAction::Hold(held) => {
                if let Some(live) = &mut self.source.live {
                    live.held = held;
                    // What comes while it is held is not shown: the next samples do not join those before.
                    self.scope.interrupt();
                }
            }
            SourceAction::Set(quantity, value) => {
                self.set_source(settings.with(quantity, value), quantity == Quantity::Periods, services);
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

    /// Other settings of the source; where its periods a revolution were set, they count for what is shown too.
    fn set_source(&mut self, settings: Settings, with_periods: bool, services: &mut Services) {
        if self.source.change(settings) && with_periods {
            self.set_periods(self.source.settings().periods as u32, services);
        }
    }

    /// Takes what has come, and has it measured when it is time.
    pub(in crate::app) fn pump(&mut self, services: &mut Services) {
        let (number, window_ms) = (self.source.runs, self.source.window_ms);
        let judge = self.judge();
        let Some(live) = &mut self.source.live else { return };
        // Asked first: what came before the end is taken.
        let ended = live.stream.is_ended();
        for batch in live.stream.take() {
            if !live.held {
                self.source.lost += self.scope.add(&batch);
            }
            live.recent.add(batch);
        }
        if ended {
            self.ended(services);
            return;
        }
        if live.held || live.measuring || !live.recent.is_due(live.measured) {
            return;
        }
        let Some(window) = live.recent.window(window_ms) else { return };
        live.measuring = true;
        live.measured = live.recent.newest();
        promise::run(&services.tasks, "measure", Done::Failed(Failed::Measure(number)), move || {
            let measurement = Measurement::of(Origin::Virtual, Arc::new(window.capture()), judge);
            Done::Measured { number, measurement: Box::new(measurement) }
        });
    }

    /// The source has ended by itself.
    fn ended(&mut self, services: &mut Services) {
        let error = self.source.live.as_ref().and_then(|live| live.stream.take_error());
        self.source.stop();
        let text = Text::new(if error.is_some() { "virtual.forgotten" } else { "virtual.ended" });
        services.tell(Severity::Error, vec![text], None);
    }

    /// The newest samples were measured.
    pub(super) fn measured(&mut self, number: u32, measurement: Measurement, services: &mut Services) {
        let current = self.source.runs == number;
        let Some(live) = self.source.live.as_mut().filter(|_| current) else { return };
        live.measuring = false;
        if live.held {
            return;
        }
        let judge = measurement.judge;
        self.show_live(measurement, services);
        // It was set differently meanwhile.
        if judge != self.judge() {
            self.judge_again(services);
        }
    }

    /// The newest samples could not be measured: what cannot be done once is not tried four times a second.
    pub(super) fn not_measured(&mut self, number: u32) -> bool {
        let current = self.source.runs == number && self.source.is_running();
        if current {
            self.source.stop();
        }
        current
    }
}

#[cfg(test)]
mod tests;
