//! Tests of recordings with known times and values.

use std::time::Duration;

use super::*;
use crate::analysis::history::Flags;
use crate::units::Moment;

/// Geometry with 32 steps per period, 4096 steps per turn, and 4096 turns.
const SKM36: Geometry = Geometry::Rotary { periods: 128, turns: 4096 };
const RANGE: i64 = 4096 * 4096;

fn moment(microseconds: u64) -> Moment {
    Moment::from_elapsed(Duration::from_micros(microseconds))
}

fn position(microseconds: u64, steps: i64) -> PolledSample {
    let raw = u32::try_from(steps.rem_euclid(RANGE)).unwrap();
    let position = Some(SKM36.position(raw));
    PolledSample::Position(PositionReading { at: moment(microseconds), raw, position, valid: true, codes: Vec::new() })
}

fn watched(microseconds: u64, value: i64) -> PolledSample {
    let (at, what) = (moment(microseconds), WatchedQuantity::TEMPERATURE);
    PolledSample::Watched(WatchedReading { at, watch: what, value: Ok(value), codes: Vec::new() })
}

fn line<'a>(record: &'a Record, heading: &str) -> &'a Series {
    record.track.recorder.series().iter().find(|line| line.heading == heading).unwrap()
}

/// Returns the time in nanoseconds, the value in the recorded unit and the flags of each sample.
fn samples(record: &Record, heading: &str) -> Vec<(i64, f64, Flags)> {
    let line = line(record, heading);
    let history = record.track.recorder.history(line).unwrap();
    let sample = |index| history.sample(line.column(), index).unwrap();
    history.indices().map(sample).map(|own| (own.time.as_nanoseconds(), own.value.to_f64(), own.flags)).collect()
}

#[test]
fn single_read_keeps_polled_samples() {
    let mut record = Record::default();
    record.add_samples((0..=10).map(|at| position(at * 100_000, at as i64 * 100)).collect(), 0, Some(SKM36));
    // This position was read between polled samples but is reported after them.
    record.add_samples(vec![position(550_000, 550)], 0, Some(SKM36));
    record.add_samples((11..=20).map(|at| position(at * 100_000, at as i64 * 100)).collect(), 0, Some(SKM36));
    let positions = samples(&record, "position");
    assert_eq!(positions.len(), 21);
    assert!(
        positions.iter().enumerate().all(|(at, own)| *own == (at as i64 * 100_000_000, at as f64 * 100.0, Flags::NONE))
    );
    // The speed is 100 steps in 100 ms, and is available after a quarter of a second.
    assert!(samples(&record, "speed").iter().skip(3).all(|own| own.1 == 1000.0));
    assert_eq!(record.last().unwrap().raw, 2000);
}

#[test]
fn lines_break_at_missing_samples() {
    let mut record = Record::default();
    record.set_watched(&[WatchedQuantity::TEMPERATURE]);
    record.add_samples(
        vec![position(0, 0), watched(0, 40), position(100_000, 1), watched(500_000, 41)],
        0,
        Some(SKM36),
    );
    record.add_samples(vec![position(600_000, 2), watched(1_000_000, 42)], 7, Some(SKM36));
    let breaks =
        |heading| -> Vec<bool> { samples(&record, heading).iter().map(|own| own.2.contains(Flags::BREAK)).collect() };
    assert_eq!(breaks("position"), [false, false, true]);
    assert_eq!(breaks("temperature"), [false, false, true]);
    assert_eq!(record.track.dropped_count(), 7);
    // The cable was disconnected for an hour.
    let began: Zoned = "2026-03-01T10:00:00[UTC]".parse().unwrap();
    let mut record = Record::default();
    record.set_watched(&[WatchedQuantity::TEMPERATURE]);
    record.begin_session(&began);
    record.add_samples(vec![position(0, 5), watched(0, 40)], 0, Some(SKM36));
    record.begin_session(&"2026-03-01T11:00:00[UTC]".parse().unwrap());
    record.add_samples(vec![position(0, 6), watched(0, 30)], 0, Some(SKM36));
    let hour = 3_600_000_000_000;
    assert_eq!(samples(&record, "position"), [(0, 5.0, Flags::NONE), (hour, 6.0, Flags::BREAK)]);
    assert_eq!(samples(&record, "temperature"), [(0, 40.0, Flags::NONE), (hour, 30.0, Flags::BREAK)]);
    // Recorded times never decrease, even if the system clock has been set back.
    record.begin_session(&"2026-03-01T09:00:00[UTC]".parse().unwrap());
    record.add_samples(vec![position(0, 7)], 0, Some(SKM36));
    assert_eq!(samples(&record, "position").last().unwrap().0, hour + 1);
}

#[test]
fn lines_break_between_stop_and_start() {
    let mut record = Record::default();
    let every = Some(Duration::from_millis(50));
    record.track.poll(every, true);
    record.add_samples(vec![position(0, 0), position(50_000, 1)], 0, Some(SKM36));
    record.track.poll(None, false);
    record.track.poll(every, true);
    record.add_samples(vec![position(150_000, 2), position(200_000, 3)], 0, Some(SKM36));
    // After more than four intervals and 0.4 s, a sample is considered missing, even if the shaft is at standstill.
    record.add_samples(vec![position(790_000, 4), position(1_400_000, 5)], 0, Some(SKM36));
    let breaks: Vec<bool> = samples(&record, "position").iter().map(|own| own.2.contains(Flags::BREAK)).collect();
    assert_eq!(breaks, [false, false, true, false, false, true]);
}

/// Records ten minutes at 1 kHz and 600 rpm across the end of the range. Polling pauses for three seconds every ten
/// thousand samples.
#[test]
fn long_recording_keeps_breaks_and_wraps() {
    let mut record = Record::default();
    record.track.poll(Some(Duration::from_millis(1)), false);
    let (mut microseconds, mut expected) = (0, Vec::new());
    let start = RANGE - 1_000_000;
    let steps = |microseconds: u64| start + microseconds as i64 * 40_960 / 1_000_000;
    let mut batch = Vec::new();
    for number in 0..600_000 {
        let paused = number > 0 && number % 10_000 == 0;
        microseconds += if paused { 3_000_000 } else { 1_000 };
        expected.push((microseconds as i64 * 1_000, steps(microseconds), paused));
        batch.push(position(microseconds, steps(microseconds)));
        if batch.len() == 1_000 {
            record.add_samples(std::mem::take(&mut batch), 0, Some(SKM36));
        }
    }
    let recorder = &record.track.recorder;
    let own = line(&record, "position");
    let history = recorder.history(own).unwrap();
    assert_eq!(history.indices(), 0..600_000);
    for (index, (time, steps, broken)) in expected.into_iter().enumerate() {
        let sample = history.sample(0, index as u64).unwrap();
        assert_eq!((sample.time.as_nanoseconds(), sample.value.to_f64() as i64), (time, steps), "{index}");
        assert_eq!(sample.flags.contains(Flags::BREAK), broken, "{index}");
    }
    let speed = history.statistics(1, history.indices()).unwrap();
    let rpm = 60.0 / 4096.0;
    // The speed is measured over a quarter of a second, with a resolution of 1/4096 turn.
    assert!(
        (speed.min.to_f64() * rpm - 600.0).abs() < 0.1 && (speed.max.to_f64() * rpm - 600.0).abs() < 0.1,
        "{speed:?}"
    );
    // After each pause, no speed is available for a quarter of a second.
    assert_eq!(speed.bad, 60 * 250);
    // The memory holds four columns of eight bytes, plus one third for the pyramid and the incomplete block.
    assert!(recorder.memory() < 600_000 * 32 * 4 / 3, "{}", recorder.memory());
}
