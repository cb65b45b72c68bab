//! Records the selected drive: position, measured speed and target.

use crate::devices::hiperdrive::state::TEXTS;

use jiff::Zoned;

use super::ruler::{PositionUnit, Ruler};
use crate::analysis::history::Value;
use crate::app::recorder::{GroupId, Scale, Series};
use crate::app::track::{DeviceRecorder, PositionSample, PositionScales, Watchable, WatchedValue};
use crate::devices::hiperdrive::procedures::{DriveReading, Temperature, TemperatureReading};
use crate::devices::hiperdrive::protocol::SpeedScale;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum RecordedValue {
    /// Actual speed of the drive, in rpm.
    Speed,
    /// Target, in steps of this ruler.
    Target(Ruler),
    Temperature(Temperature),
}

#[derive(Debug, Default)]
pub struct Record {
    pub(super) track: DeviceRecorder<RecordedValue>,
    last: Option<DriveReading>,
    temperatures: Vec<Temperature>,
}

impl Record {
    pub(super) fn begin_session(&mut self, began: &Zoned) {
        self.last = None;
        self.track.begin_session(began);
    }

    pub(super) fn record_dropped_samples(&mut self, dropped: u64) {
        self.track.record_dropped(dropped);
    }

    /// Records a reading, together with the target at that time.
    pub(super) fn add_reading(&mut self, reading: DriveReading, ruler: Ruler, speed: SpeedScale, target: Option<i32>) {
        let (at, actual) = (reading.at, reading.actual);
        let status = actual.status;
        let sighting = PositionSample {
            at,
            position: status.is_present().then_some(i64::from(actual.position)),
            is_bad: !status.is_present(),
            is_warned: status.is_set(crate::devices::hiperdrive::protocol::StatusBit::Warning),
        };
        self.track.add_positions(&[sighting], &position_scales(ruler));
        // Without control, a target recorded earlier stays among the watched values.
        let has_target =
            target.is_some() || self.track.watched_values().iter().any(|own| matches!(own, RecordedValue::Target(_)));
        let mut beside = vec![RecordedValue::Speed];
        beside.extend(has_target.then_some(RecordedValue::Target(ruler)));
        beside.extend(self.temperatures.iter().copied().map(RecordedValue::Temperature));
        self.track.set_watched(&beside);
        let watching = |value| WatchedValue { at, value: Some(value), is_warned: false, never: None };
        self.track.add_watched(&RecordedValue::Speed, &watching(Value::Real(speed.rpm(actual.speed))));
        if let Some(target) = target {
            self.track.add_watched(&RecordedValue::Target(ruler), &watching(Value::Whole(i64::from(target))));
        }
        self.last = Some(reading);
    }

    /// Starts recording these temperatures. Existing recordings of other temperatures are kept.
    pub(super) fn watch_temperatures(&mut self, wished: &[Temperature]) {
        self.temperatures = wished.to_vec();
        let others =
            self.track.watched_values().into_iter().filter(|own| !matches!(own, RecordedValue::Temperature(_)));
        let wished = wished.iter().copied().map(RecordedValue::Temperature);
        self.track.set_watched(&others.chain(wished).collect::<Vec<_>>());
    }

    /// Records a temperature if it is being watched. Any other temperature belongs to another drive and is ignored.
    pub(super) fn add_temperature(&mut self, reading: TemperatureReading) {
        let never = reading.celsius.is_none().then(|| TEXTS.text("hd_watch.never"));
        let value = reading.celsius.map(Value::Whole);
        let watching = WatchedValue { at: reading.at, value, is_warned: false, never };
        self.track.add_watched(&RecordedValue::Temperature(reading.what), &watching);
    }

    pub fn last(&self) -> Option<&DriveReading> {
        self.last.as_ref()
    }

    /// Marks a gap before the next sample, because another drive was selected.
    pub(super) fn mark_gap(&mut self) {
        self.last = None;
        self.track.mark_gap();
    }

    pub(super) fn clear(&mut self) {
        self.track.discard_short_recording();
        self.last = None;
    }
}

/// Returns the units for recorded positions. Millimetres come first if the drive turns a spindle.
fn position_scales(ruler: Ruler) -> PositionScales {
    let mut meaning = PositionScales::for_steps_per_turn(None, ruler.scale.steps_per_turn());
    if let Some(millimetres) = ruler.from_steps(1, PositionUnit::Millimetres) {
        let linear = PositionScales::for_millimetres(millimetres).scales;
        for (own, linear) in meaning.scales.iter_mut().zip(linear) {
            let in_millimetres = linear.into_iter().filter(|scale| !scale.unit.id().starts_with("unit.steps"));
            own.splice(0..0, in_millimetres);
        }
    }
    meaning
}

impl Watchable for RecordedValue {
    fn is_whole(&self) -> bool {
        matches!(self, RecordedValue::Target(_) | RecordedValue::Temperature(_))
    }

    /// Returns whether the recording can continue after positions are converted in another way. A new pitch changes
    /// only the display of steps. A new scale changes the length of a step.
    fn can_continue_as(&self, other: &Self) -> bool {
        match (self, other) {
            (RecordedValue::Target(own), RecordedValue::Target(other)) => own.scale == other.scale,
            _ => self == other,
        }
    }

    fn create_series(&self, group: GroupId) -> Series {
        match self {
            RecordedValue::Speed => {
                let scales = vec![Scale::new("unit.revolutions_per_minute", 1.0, 1)];
                Series::new(group, 0, TEXTS.text("hd_live.speed"), "drive speed".to_owned(), scales)
            }
            RecordedValue::Target(ruler) => {
                let [scales, ..] = position_scales(*ruler).scales;
                Series::new(group, 0, TEXTS.text("hd_live.target"), "target".to_owned(), scales)
            }
            RecordedValue::Temperature(what) => {
                let (name, heading) = match what {
                    Temperature::Device => ("hd_parameter.11", "device temperature"),
                    Temperature::Drive(_) => ("hd_parameter.119", "drive temperature"),
                };
                let scales = vec![Scale::new("unit.celsius", 1.0, 0)];
                Series::new(group, 0, TEXTS.text(name), heading.to_owned(), scales)
            }
        }
    }
}
