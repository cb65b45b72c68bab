//! Records the position, speed and cam outputs while the IN word is polled.

use crate::devices::interbus::state::TEXTS;

use jiff::Zoned;

use crate::analysis::history::Value;
use crate::app::recorder::{GroupId, Scale, Series};
use crate::app::track::{DeviceRecorder, PositionSample, PositionScales, Watchable, WatchedValue};
use crate::devices::interbus::procedures::WordReading;
use crate::devices::interbus::protocol::{CamNumber, Gear, StartupMode};
use crate::units::Moment;

/// A value that an encoder sends instead of its position, or together with it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum RecordedValue {
    Speed,
    Cam(CamNumber),
}

#[derive(Debug, Default)]
pub struct Record {
    pub(super) track: DeviceRecorder<RecordedValue>,
    last: Option<WordReading>,
}

impl Record {
    pub(super) fn begin_session(&mut self, began: &Zoned) {
        self.last = None;
        self.track.begin_session(began);
    }

    /// Adds new readings. `dropped` is the number of readings lost because they could not be recorded in time.
    pub(super) fn add_readings(&mut self, readings: Vec<WordReading>, dropped: u64) {
        self.track.record_dropped(dropped);
        for reading in readings {
            self.add_reading(&reading);
            self.last = Some(reading);
        }
    }

    /// Sets the latest reading without recording it, because it may not contain a position.
    pub(super) fn set_latest_reading(&mut self, reading: WordReading) {
        self.last = Some(reading);
    }

    fn add_reading(&mut self, reading: &WordReading) {
        let at = reading.at;
        match reading.mode {
            Some(StartupMode::Velocity) => {
                self.track.set_watched(&[RecordedValue::Speed]);
                self.add_value(at, RecordedValue::Speed, reading.rpm().map(i64::from));
            }
            Some(StartupMode::Cams(_)) => {
                let cams: Vec<RecordedValue> = CamNumber::all().map(RecordedValue::Cam).collect();
                self.track.set_watched(&cams);
                let output = reading.cams();
                for cam in CamNumber::all() {
                    let on = output.map(|own| i64::from(own.outputs >> cam.get() & 1));
                    self.add_value(at, RecordedValue::Cam(cam), on);
                }
            }
            _ => self.track.set_watched(&[]),
        }
        // A missing position is recorded only in a mode that sends complete positions.
        let is_sent = reading.mode != Some(StartupMode::Velocity);
        let position = reading.position();
        if is_sent && (position.is_some() || !reading.is_valid()) {
            let is_beyond = reading.gear.zip(position).is_some_and(|(gear, own)| own >= gear.total_steps());
            let sighting = PositionSample {
                at,
                position: position.map(i64::from),
                is_bad: position.is_none(),
                is_warned: reading.unexpected_bits() != 0 || is_beyond,
            };
            self.track.add_positions(&[sighting], &position_scales(reading.gear));
        }
    }

    fn add_value(&mut self, at: Moment, what: RecordedValue, value: Option<i64>) {
        let value = value.map(Value::Whole);
        self.track.add_watched(&what, &WatchedValue { at, value, is_warned: false, never: None });
    }

    pub fn last(&self) -> Option<&WordReading> {
        self.last.as_ref()
    }

    pub(super) fn clear(&mut self) {
        self.track.discard_short_recording();
        self.last = None;
    }
}

fn position_scales(gear: Option<Gear>) -> PositionScales {
    match gear {
        Some(gear) => {
            let per_turn = f64::from(gear.total_steps()) / f64::from(gear.turns());
            // Cams refer to positions within the range.
            PositionScales::for_steps_per_turn(Some(gear.total_steps().into()), per_turn).within_range()
        }
        None => PositionScales::for_steps(None),
    }
}

impl Watchable for RecordedValue {
    fn is_whole(&self) -> bool {
        true
    }

    fn create_series(&self, group: GroupId) -> Series {
        match self {
            RecordedValue::Speed => {
                let scales = vec![Scale::new("unit.revolutions_per_minute", 1.0, 0)];
                Series::new(group, 0, TEXTS.text("ib_live.speed"), "encoder speed".to_owned(), scales)
            }
            RecordedValue::Cam(cam) => {
                let name = TEXTS.text("ib_live.cam").with("cam", cam.get());
                Series::new(group, 0, name, format!("cam {}", cam.get()), vec![Scale::new("unit.counts", 1.0, 0)])
            }
        }
    }
}
