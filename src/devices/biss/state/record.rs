//! Recording a polled BiSS encoder: its positions and the watched registers.

use std::time::Duration;

use crate::devices::biss::state::TEXTS;

use jiff::Zoned;

use crate::analysis::history::Value;
use crate::app::explain::literal_text;
use crate::app::recorder::{GroupId, Recorder, Scale, Series};
use crate::app::track::{DeviceRecorder, PositionSample, PositionScales, Watchable, WatchedValue};
use crate::app::{Recording, Text};
use crate::devices::biss::procedures::{ConsecutiveFrames, Error, PolledSample, PositionReading, WatchedReading};
use crate::devices::biss::protocol::{DecodedValue, Register, ValueDecoding};
use crate::devices::biss::state::explain as words;

/// A batch of consecutive positions with the same field widths.
#[derive(Default)]
struct Batch {
    widths: Option<Widths>,
    sightings: Vec<PositionSample>,
}

/// Multiturn and singleturn widths in bits, and whether the split between them is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Widths {
    multiturn: u8,
    singleturn: u8,
    is_split_known: bool,
}

impl From<&PositionReading> for Widths {
    fn from(reading: &PositionReading) -> Self {
        let PositionReading { multiturn_bits: multiturn, singleturn_bits: singleturn, is_split_known, .. } = *reading;
        Widths { multiturn, singleturn, is_split_known }
    }
}

/// The recorder of an encoder's positions. It also provides the latest values.
#[derive(Debug, Default)]
pub struct Record {
    track: DeviceRecorder<Register>,
    last: Option<PositionReading>,
    crc_errors: u64,
    lost: u64,
    stream: Option<FrameStream>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FrameStream {
    next: u64,
    period_ns: i64,
    pub clock_hz: u32,
    /// Whether the clock is too slow for the requested frame rate.
    pub is_limited: bool,
}

impl FrameStream {
    pub fn frame_rate_hz(&self) -> f64 {
        1e9 / self.period_ns.max(1) as f64
    }
}

impl Record {
    pub(super) fn begin_session(&mut self, began: &Zoned) {
        (self.last, self.crc_errors, self.stream) = (None, 0, None);
        self.track.begin_session(began);
    }

    pub(super) fn add_samples(&mut self, samples: Vec<PolledSample>, dropped: u64) {
        match self.stream {
            // In a stream, dropped frames are counted by their sequence numbers.
            Some(_) if dropped > 0 => self.track.mark_gap(),
            _ => self.track.record_dropped(dropped),
        }
        // Positions with equal widths are recorded in batches, because there may be thousands of them per second.
        let mut batch = Batch::default();
        for sample in samples {
            match sample {
                PolledSample::Position(reading) => {
                    self.add_reading(&reading, &mut batch);
                }
                PolledSample::Missed { at, crc_errors } => {
                    self.add_crc_errors(crc_errors);
                    batch.sightings.push(PositionSample { at, position: None, is_bad: true, is_warned: false });
                }
                PolledSample::Frames(run) => self.add_frames(&run, &mut batch),
                PolledSample::Watched(reading) => self.add_watched(&reading),
            }
        }
        self.append(&mut batch);
    }

    pub(super) fn add_position(&mut self, reading: PositionReading) {
        let mut batch = Batch::default();
        self.add_reading(&reading, &mut batch);
        self.append(&mut batch);
    }

    fn add_reading(&mut self, reading: &PositionReading, batch: &mut Batch) {
        self.stream = None;
        self.add_crc_errors(reading.crc_errors);
        let widths = Widths::from(reading);
        if batch.widths.is_some_and(|own| own != widths) {
            self.append(batch);
        }
        batch.widths = Some(widths);
        batch.sightings.push(position_sample(reading));
        self.last = Some(*reading);
    }

    /// Records streamed frames. Missing frames are counted, and leave a gap in the recording.
    fn add_frames(&mut self, run: &ConsecutiveFrames, batch: &mut Batch) {
        let before = self.stream.filter(|_| !run.is_stream_start()).map(|stream| run.first.saturating_sub(stream.next));
        let missing = before.unwrap_or(run.lost);
        if run.is_stream_start() || missing > 0 {
            self.append(batch);
            self.track.mark_gap();
        }
        self.lost += missing;
        let ConsecutiveFrames { period_ns, clock_hz, is_limited, .. } = *run;
        self.stream = Some(FrameStream { next: run.first + run.frames.len() as u64, period_ns, clock_hz, is_limited });
        self.add_crc_errors(u32::try_from(run.crc_errors()).unwrap_or(u32::MAX));
        let (multiturn, singleturn) = (run.layout.multiturn_bits(), run.layout.singleturn_bits());
        let widths = Widths { multiturn, singleturn, is_split_known: run.is_split_known };
        if batch.widths.is_some_and(|own| own != widths) {
            self.append(batch);
        }
        batch.widths = Some(widths);
        for (at, frame) in run.iter_with_times() {
            let Ok(reading) = frame else {
                batch.sightings.push(PositionSample { at, position: None, is_bad: true, is_warned: false });
                continue;
            };
            let reading = PositionReading::from_frame(at, reading, &run.layout);
            let reading = PositionReading { is_split_known: run.is_split_known, ..reading };
            batch.sightings.push(position_sample(&reading));
            self.last = Some(reading);
        }
    }

    fn append(&mut self, batch: &mut Batch) {
        if batch.sightings.is_empty() {
            return;
        }
        let before = self.last.as_ref().map(Widths::from);
        // If nothing has been read in this session yet, the scales from the previous session are kept.
        let unknown = || self.track.scales().cloned().unwrap_or_else(|| PositionScales::for_steps(None));
        let meaning = batch.widths.or(before).map_or_else(unknown, position_scales);
        self.track.add_positions(&batch.sightings, &meaning);
        *batch = Batch::default();
    }

    pub(super) fn add_crc_errors(&mut self, count: u32) {
        self.crc_errors += u64::from(count);
    }

    fn add_watched(&mut self, reading: &WatchedReading) {
        let watched = self.track.watched_values().into_iter().find(|own| own.address == reading.range.start());
        let Some(register) = watched else { return };
        let value = reading.value.as_ref().ok().and_then(|bytes| register_value(&register, bytes));
        let never = match &reading.value {
            Err(Error::NoSuchRegister { .. }) => Some(Text::new("recorder.absent")),
            Err(Error::NotWatched { .. }) => Some(TEXTS.text("recorder.data")),
            _ => None,
        };
        let watching = WatchedValue { at: reading.at, value, is_warned: false, never };
        self.track.add_watched(&register, &watching);
    }

    /// Sets the registers to record along with the position, in place of the previous ones.
    pub(super) fn set_watched(&mut self, watched: &[Register]) {
        self.track.set_watched(watched);
    }

    pub fn watched_registers(&self) -> Vec<Register> {
        self.track.watched_values()
    }

    pub fn last(&self) -> Option<&PositionReading> {
        self.last.as_ref()
    }

    /// Returns the number of frames with a wrong CRC since the link was opened.
    pub fn crc_errors(&self) -> u64 {
        self.crc_errors
    }

    /// Returns the current stream, or `None` if polling has stopped or positions are read one by one.
    pub(super) fn current_stream(&self) -> Option<&FrameStream> {
        self.stream.as_ref()
    }

    pub fn position_count(&self) -> u64 {
        self.track.position_count()
    }

    pub(super) fn clear(&mut self) {
        self.track.discard_short_recording();
        (self.last, self.crc_errors, self.lost, self.stream) = (None, 0, 0, None);
    }
}

impl Recording for Record {
    fn recorder(&self) -> &Recorder {
        &self.track.recorder
    }

    fn recorder_mut(&mut self) -> &mut Recorder {
        &mut self.track.recorder
    }

    // The count includes frames that an adapter could not send.
    fn dropped_count(&self) -> u64 {
        self.track.dropped_count().saturating_add(self.lost)
    }

    fn poll(&mut self, interval: Option<Duration>, begins: bool) {
        self.track.poll(interval, begins);
        if interval.is_none() {
            self.stream = None;
        }
    }
}

fn position_sample(reading: &PositionReading) -> PositionSample {
    PositionSample {
        at: reading.at,
        position: i64::try_from(reading.position()).ok(),
        is_bad: !reading.is_valid(),
        is_warned: reading.warning == Some(true),
    }
}

/// Returns how positions with the given multiturn and singleturn widths are scaled.
fn position_scales(Widths { multiturn, singleturn, is_split_known }: Widths) -> PositionScales {
    let range = 1_i64.checked_shl(u32::from(multiturn) + u32::from(singleturn)).filter(|range| *range > 0);
    if !is_split_known {
        return PositionScales::for_steps(range);
    }
    PositionScales::for_steps_per_turn(range, f64::from(singleturn).exp2())
}

fn register_value(register: &Register, bytes: &[u8]) -> Option<Value> {
    match register.decode(bytes)? {
        DecodedValue::Scaled(value) => Some(Value::Real(value)),
        _ => register.to_number(bytes).and_then(|number| i64::try_from(number).ok()).map(Value::Whole),
    }
}

impl Watchable for Register {
    fn is_whole(&self) -> bool {
        !matches!(self.decoding, ValueDecoding::Scaled { .. })
    }

    fn create_series(&self, group: GroupId) -> Series {
        let name = if self.name.is_empty() { literal_text(self.address) } else { words::name_text(&self.name) };
        let unit = if self.unit.is_empty() { Text::new("unit.counts") } else { literal_text(&self.unit) };
        let decimals = if self.is_whole() { 0 } else { 1 };
        let heading = format!("{} {}", self.address, self.name).trim_end().to_owned();
        Series::new(group, 0, name, heading, vec![Scale { unit, factor: 1.0, decimals, range: None }])
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::devices::biss::profile::RegisterRange;
    use crate::devices::biss::protocol::{Descriptions, Layout, PositionData, Role};
    use crate::units::Moment;

    fn run(first: u64, count: u64, lost: u64) -> ConsecutiveFrames {
        let frame = |at| Ok(PositionData { multiturn: 0, singleturn: at as u32, error: false, warning: false });
        ConsecutiveFrames {
            first,
            at: Moment::from_elapsed(Duration::from_micros(50 * first)),
            period_ns: 50_000,
            lost,
            frames: (first..first + count).map(frame).collect(),
            layout: Arc::default(),
            is_split_known: true,
            clock_hz: 2_000_000,
            is_limited: false,
        }
    }

    /// Turn 1234h at 270° is the position word 024698000, according to section 2 of the reference.
    #[test]
    fn streamed_raw_values_are_position_words() {
        let mut record = Record::default();
        let reading = PositionData { multiturn: 0x1234, singleturn: 0x18000, error: false, warning: true };
        record.add_samples(
            vec![PolledSample::Frames(ConsecutiveFrames { frames: vec![Ok(reading)], ..run(0, 1, 0) })],
            0,
        );
        let last = record.last().unwrap();
        assert_eq!((last.position_word().to_string(), last.position_word().bits), ("024698000".to_owned(), 33));
        assert_eq!((last.error, last.warning), (Some(false), Some(true)));
        let bare = Layout::new(0, 12, false, false, None).unwrap();
        let reading = PositionData { singleturn: 0x00A, ..PositionData::default() };
        record.add_samples(
            vec![PolledSample::Frames(ConsecutiveFrames {
                frames: vec![Ok(reading)],
                layout: Arc::new(bare),
                ..run(1, 1, 0)
            })],
            0,
        );
        let last = record.last().unwrap();
        assert_eq!((last.position_word().to_string(), last.error, last.warning), ("00A".to_owned(), None, None));
    }

    /// A position cannot be split into turns and degrees if the number of steps per turn is unknown (issue 22.20).
    #[test]
    fn records_steps_if_split_is_unknown() {
        let mut record = Record::default();
        let units = |record: &Record| -> Vec<String> {
            let lines = record.recorder().series();
            lines.iter().flat_map(|line| line.scales().iter().map(|scale| scale.unit.id().to_owned())).collect()
        };
        record.add_samples(vec![PolledSample::Frames(ConsecutiveFrames { is_split_known: false, ..run(0, 10, 0) })], 0);
        assert_eq!(record.last().unwrap().angle_degrees(), None);
        assert_eq!(units(&record), ["unit.steps", "unit.steps_per_second", "unit.steps_per_second_squared"]);
        record.add_samples(vec![PolledSample::Frames(run(10, 10, 0))], 0);
        assert!(
            units(&record).contains(&"unit.degrees".to_owned()) && record.last().unwrap().angle_degrees().is_some()
        );
    }

    #[test]
    fn missing_register_value_has_reason() {
        let descriptions = Descriptions::built_in();
        let kit = descriptions.find_by_name("POSITAL IXARC kit encoder").unwrap();
        let register = kit.register_with_role(Role::Temperature).unwrap().clone();
        let address = register.address;
        let mut record = Record::default();
        record.set_watched(std::slice::from_ref(&register));
        let what = RegisterRange::new(address, 1).unwrap();
        for (error, said) in [
            (Error::NoSuchRegister { address }, Some("recorder.absent")),
            (Error::NotWatched { address }, Some("recorder.data")),
            (Error::NeverSilent, None),
        ] {
            let reading = WatchedReading { at: Moment::START, range: what, value: Err(error) };
            record.add_samples(vec![PolledSample::Watched(reading)], 0);
            let line = record.recorder().series().iter().find(|line| line.heading.contains("temperature"));
            assert_eq!(line.unwrap().remark, said.map(|id| TEXTS.text(id)));
        }
    }

    #[test]
    fn counts_missing_frames_at_every_stage() {
        let mut record = Record::default();
        let add = |record: &mut Record, run: ConsecutiveFrames, dropped| {
            record.add_samples(vec![PolledSample::Frames(run)], dropped)
        };
        add(&mut record, run(0, 100, 0), 0);
        assert_eq!(
            (record.position_count(), record.dropped_count(), record.current_stream().map(FrameStream::frame_rate_hz)),
            (100, 0, Some(20_000.0))
        );
        add(&mut record, run(110, 90, 10), 0);
        assert_eq!((record.position_count(), record.dropped_count()), (190, 10), "at the adapter");
        add(&mut record, run(500, 10, 0), 3);
        assert_eq!((record.position_count(), record.dropped_count()), (200, 310), "three batches were not taken");
        // The frame numbers of another stream start at zero.
        let later = ConsecutiveFrames { at: Moment::from_elapsed(Duration::from_secs(1)), ..run(5, 5, 5) };
        add(&mut record, later, 0);
        assert_eq!((record.position_count(), record.dropped_count()), (205, 315));
        record.poll(None, false);
        assert_eq!(record.current_stream(), None);
    }
}
