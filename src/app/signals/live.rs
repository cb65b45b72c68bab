//! The virtual encoder as a source: its settings, its newest samples, and the measurement of them, which is made again a
//! few times a second. Samples come from `worker::stream`; whoever draws never waits for them.

use std::sync::Arc;

use super::{Done, Measurement, Origin, Scope, Signals};
use crate::app::action::{Action as StudioAction, Done as StudioDone};
use crate::app::services::Services;
use crate::app::{Severity, Text, explain};
use crate::link::{Clock, RealClock};
use crate::signal::Time;
use crate::signal::capture::Capture;
use crate::signal::wires::{Wire, Wires};
use crate::sim::sine_cosine::{Quantity, References, Settings};
use crate::worker::stream::{Analogue, Batch, Stream};

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

/// The newest samples without a gap.
#[derive(Default)]
struct Recent {
    wires: Wires,
    /// When the last of them was taken.
    newest: Option<Time>,
    period_ns: i64,
}

/// Samples that wait for the window, at most: two seconds at 100 kHz.
const WAITING: usize = 200_000;
/// Most samples that are measured at once.
const MOST: usize = 500_000;
/// From one measurement to the next, in nanoseconds.
const EVERY_NS: i64 = 250_000_000;
/// Windows that can be measured, in milliseconds.
const WINDOWS: std::ops::RangeInclusive<u32> = 10..=10_000;

impl Default for Source {
    fn default() -> Self {
        Source { settings: Settings::default(), problem: None, window_ms: 200, runs: 0, live: None }
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

    /// Samples that were lost since it began, because nobody read them in time.
    pub fn lost(&self) -> u64 {
        self.live.as_ref().map_or(0, |live| live.stream.lost())
    }

    pub(super) fn stop(&mut self) {
        self.live = None;
    }

    fn change(&mut self, settings: Settings) {
        match settings.checked() {
            Ok(checked) => {
                self.settings = checked.settings().clone();
                self.problem = None;
                if let Some(live) = &self.live {
                    live.stream.change(checked);
                }
            }
            Err(error) => self.problem = Some(explain::signal::setting(&error)),
        }
    }

    fn start(&mut self, services: &mut Services) {
        let clock: Arc<dyn Clock> = Arc::new(RealClock::start());
        let checked = match self.settings.clone().checked() {
            Ok(checked) => checked,
            Err(error) => {
                self.problem = Some(explain::signal::setting(&error));
                return;
            }
        };
        let producer = Analogue::new(checked, clock.now());
        match Stream::spawn(producer, WAITING, clock, services.tasks.wake()) {
            Ok(stream) => {
                self.runs = self.runs.wrapping_add(1);
                let recent = Recent::default();
                self.live = Some(Live { stream, recent, held: false, measuring: false, measured: None });
            }
            Err(error) => {
                let text = Text::new("session.no_thread").with("why", error);
                services.tell(Severity::Error, vec![text], None);
            }
        }
    }
}

impl Signals {
    pub(super) fn act_source(&mut self, action: SourceAction, services: &mut Services) {
        let settings = self.source.settings().clone();
        match action {
            SourceAction::Start => {
                self.periods = settings.periods as u32;
                self.replace_scope(Scope::live());
                self.source.start(services);
            }
            SourceAction::Stop => self.source.stop(),
            SourceAction::Hold(held) => {
                if let Some(live) = &mut self.source.live {
                    live.held = held;
                }
            }
            SourceAction::Set(quantity, value) => {
                self.source.change(settings.with(quantity, value));
                if quantity == Quantity::Periods {
                    self.periods = self.source.settings().periods as u32;
                }
            }
            SourceAction::SetOpenWire(open_wire) => self.source.change(Settings { open_wire, ..settings }),
            SourceAction::SetTerminated(terminated) => self.source.change(Settings { terminated, ..settings }),
            SourceAction::SetReferences(references) => self.source.change(Settings { references, ..settings }),
            SourceAction::SetWindow(milliseconds) => {
                self.source.window_ms = milliseconds.clamp(*WINDOWS.start(), *WINDOWS.end());
            }
            SourceAction::Reset => self.source.change(Settings::default()),
        }
    }

    /// Takes what has come, and has it measured when it is time.
    pub(in crate::app) fn pump(&mut self, services: &mut Services) {
        let (number, window_ms) = (self.source.runs, self.source.window_ms);
        let judge = self.judge();
        let Some(live) = &mut self.source.live else { return };
        for batch in live.stream.take() {
            if !live.held {
                self.scope.add(&batch);
            }
            live.recent.add(batch);
        }
        if live.held || live.measuring || !live.recent.is_due(live.measured) {
            return;
        }
        let Some(capture) = live.recent.window(window_ms) else { return };
        live.measuring = true;
        live.measured = live.recent.newest;
        services.tasks.run("measure", move || {
            let measurement = Box::new(Measurement::of(Origin::Virtual, Arc::new(capture), judge));
            StudioAction::Done(StudioDone::Signals(Done::Measured { number, measurement }))
        });
    }

    /// The newest samples were measured.
    pub(super) fn measured(&mut self, number: u32, measurement: Measurement) {
        let current = self.source.runs == number;
        let Some(live) = self.source.live.as_mut().filter(|_| current) else { return };
        live.measuring = false;
        if !live.held {
            self.show_live(measurement);
        }
    }
}

impl Recent {
    fn add(&mut self, batch: Batch<Wires>) {
        if batch.lost > 0 || batch.period_ns != self.period_ns {
            self.wires = Wires::default();
        }
        self.period_ns = batch.period_ns;
        let count = i64::try_from(batch.samples.len()).unwrap_or(0);
        self.newest = Some(batch.time.plus((count - 1).max(0).saturating_mul(batch.period_ns)));
        for (kept, new) in columns(&mut self.wires).into_iter().zip(columns(&mut { batch.samples })) {
            kept.append(new);
            // Cut in large steps, so that what stays is not moved for every batch.
            if kept.len() > 2 * MOST {
                kept.drain(..kept.len() - MOST);
            }
        }
    }

    /// Enough is new since the last measurement.
    fn is_due(&self, measured: Option<Time>) -> bool {
        match (self.newest, measured) {
            (Some(newest), Some(measured)) => newest.nanoseconds_since(measured) >= EVERY_NS,
            (newest, None) => newest.is_some(),
            (None, Some(_)) => false,
        }
    }

    /// The newest samples of so many milliseconds; `None` while there are fewer.
    fn window(&self, milliseconds: u32) -> Option<Capture> {
        let wanted = i64::from(milliseconds) * 1_000_000 / self.period_ns.max(1);
        let count = usize::try_from(wanted).unwrap_or(MOST).clamp(1, MOST);
        let from = self.wires.len().checked_sub(count)?;
        let newest = |column: &[f64]| column.get(from..).unwrap_or_default().to_vec();
        let wires = Wires {
            sin_v: newest(&self.wires.sin_v),
            refsin_v: newest(&self.wires.refsin_v),
            cos_v: newest(&self.wires.cos_v),
            refcos_v: newest(&self.wires.refcos_v),
            reference_deg: Vec::new(),
        };
        let period_s = self.period_ns as f64 * 1e-9;
        Some(Capture {
            time_s: (0..count).map(|at| at as f64 * period_s).collect(),
            sine_v: wires.sine_v(),
            cosine_v: wires.cosine_v(),
            references_v: Some((wires.refsin_v, wires.refcos_v)),
            ..Capture::default()
        })
    }
}

/// The columns that are kept.
fn columns(wires: &mut Wires) -> [&mut Vec<f64>; 4] {
    [&mut wires.sin_v, &mut wires.refsin_v, &mut wires.cos_v, &mut wires.refcos_v]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn batch(first: u64, count: usize, period_ns: i64, lost: u64) -> Batch<Wires> {
        let column = |at: f64| (0..count).map(|own| (first as f64 + own as f64) * at).collect();
        let samples = Wires {
            sin_v: column(2.0),
            refsin_v: column(1.0),
            cos_v: column(4.0),
            refcos_v: column(1.0),
            reference_deg: Vec::new(),
        };
        Batch { first, time: Time::from_nanoseconds(first as i64 * period_ns), period_ns, lost, samples }
    }

    #[test]
    fn a_window_is_the_newest_samples_without_a_gap() {
        let mut recent = Recent::default();
        assert!(recent.window(10).is_none() && !recent.is_due(None));
        recent.add(batch(0, 5, 1_000_000, 0));
        recent.add(batch(5, 6, 1_000_000, 0));
        // Ten milliseconds are ten samples, 1 to 10; sine is 2n − n, cosine 4n − n.
        let window = recent.window(10).unwrap();
        assert_eq!((window.sine_v.len(), window.sine_v[0], window.cosine_v[9]), (10, 1.0, 30.0));
        assert!((window.time_s[9] - 0.009).abs() < 1e-12);
        recent.add(batch(20, 4, 1_000_000, 9));
        assert!(recent.window(10).is_none(), "what is before the gap does not belong to it");
        recent.add(batch(24, 4, 500_000, 0));
        assert_eq!(recent.wires.len(), 4, "another rate is another signal");
    }

    #[test]
    fn it_is_measured_four_times_a_second() {
        let mut recent = Recent::default();
        recent.add(batch(0, 100, 1_000_000, 0));
        assert!(recent.is_due(None));
        let measured = recent.newest;
        recent.add(batch(100, 249, 1_000_000, 0));
        assert!(!recent.is_due(measured));
        recent.add(batch(349, 1, 1_000_000, 0));
        assert!(recent.is_due(measured));
    }
}
