//! Records a polled HIPERFACE encoder: positions in the units of its geometry, analogue values and the counter.

use crate::devices::hiperface::state::TEXTS;

use jiff::Zoned;

use crate::analysis::history::Value;
use crate::app::Text;
use crate::app::recorder::{GroupId, Scale, Series};
use crate::app::track::{DeviceRecorder, PositionSample, PositionScales, Watchable, WatchedValue};
use crate::devices::hiperface::procedures::{PolledSample, PositionReading, WatchedQuantity, WatchedReading};
use crate::devices::hiperface::protocol::{Geometry, STEPS_PER_PERIOD};

#[derive(Debug, Default)]
pub struct Record {
    pub(super) track: DeviceRecorder<WatchedQuantity>,
    last: Option<PositionReading>,
    refused: bool,
}

impl Record {
    pub(super) fn begin_session(&mut self, began: &Zoned) {
        (self.last, self.refused) = (None, false);
        self.track.begin_session(began);
    }

    pub(super) fn add_samples(&mut self, samples: Vec<PolledSample>, dropped: u64, geometry: Option<Geometry>) {
        self.track.record_dropped(dropped);
        let meaning = position_scales(geometry);
        for sample in samples {
            match sample {
                PolledSample::Position(reading) => {
                    let sighting = PositionSample {
                        at: reading.at,
                        position: Some(reading.raw.into()),
                        is_bad: !reading.valid,
                        is_warned: !reading.codes.is_empty(),
                    };
                    self.track.add_positions(&[sighting], &meaning);
                    (self.last, self.refused) = (Some(reading), false);
                }
                PolledSample::NoPosition { at, .. } => {
                    self.track.add_positions(
                        &[PositionSample { at, position: None, is_bad: true, is_warned: false }],
                        &meaning,
                    );
                    self.refused = true;
                }
                PolledSample::Watched(reading) => self.track.add_watched(&reading.watch, &watched_value(&reading)),
            }
        }
    }

    /// Sets the values to record along with the position.
    pub(super) fn set_watched(&mut self, watched: &[WatchedQuantity]) {
        self.track.set_watched(watched);
    }

    pub fn watched_values(&self) -> Vec<WatchedQuantity> {
        self.track.watched_values()
    }

    /// Returns the last position, or `None` while the encoder does not report one.
    pub fn last(&self) -> Option<&PositionReading> {
        self.last.as_ref().filter(|_| !self.refused)
    }

    /// Returns whether the encoder currently has no position to report.
    pub fn is_position_refused(&self) -> bool {
        self.refused
    }

    pub fn position_count(&self) -> u64 {
        self.track.position_count()
    }

    pub(super) fn clear(&mut self) {
        self.track.discard_short_recording();
        (self.last, self.refused) = (None, false);
    }
}

fn position_scales(geometry: Option<Geometry>) -> PositionScales {
    match geometry {
        Some(Geometry::Linear { period_nm, .. }) => {
            PositionScales::for_millimetres(f64::from(period_nm) / f64::from(STEPS_PER_PERIOD) * 1e-6)
        }
        Some(rotary @ Geometry::Rotary { .. }) => {
            let range = rotary.position_count().and_then(|range| i64::try_from(range).ok());
            PositionScales::for_steps_per_turn(range, rotary.steps_per_turn().unwrap_or(1) as f64)
        }
        // Without a known range, the position wraps at the end of its 32-bit word.
        None => PositionScales::for_steps(Some(1 << 32)),
    }
}

fn watched_value(reading: &WatchedReading) -> WatchedValue {
    WatchedValue {
        at: reading.at,
        value: reading.value.as_ref().ok().map(|value| Value::Whole(*value)),
        is_warned: !reading.codes.is_empty(),
        never: reading.is_refused().then(|| Text::new("recorder.absent")),
    }
}

impl Watchable for WatchedQuantity {
    fn is_whole(&self) -> bool {
        true
    }

    fn create_series(&self, group: GroupId) -> Series {
        let (heading, unit) = match *self {
            WatchedQuantity::TEMPERATURE => ("temperature".to_owned(), "unit.celsius"),
            WatchedQuantity::Analogue(channel) => (format!("analogue {channel:02X}h"), "unit.counts"),
            WatchedQuantity::Counter => ("counter".to_owned(), "unit.counts"),
        };
        Series::new(group, 0, watch_name(*self), heading, vec![Scale::new(unit, 1.0, 0)])
    }
}

pub fn watch_name(what: WatchedQuantity) -> Text {
    match what {
        WatchedQuantity::TEMPERATURE => TEXTS.text("recorder.temperature"),
        WatchedQuantity::Analogue(channel) => TEXTS.text("recorder.channel").with("channel", format!("{channel:02X}h")),
        WatchedQuantity::Counter => TEXTS.text("recorder.counter"),
    }
}

#[cfg(test)]
mod tests;
