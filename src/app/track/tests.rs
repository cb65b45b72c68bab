//! Tests of streamed positions, which arrive in batches. Lines must break at gaps.

use super::*;
use crate::app::recorder::{Scale, Series};

#[derive(Clone, Debug, PartialEq)]
struct Nothing;

impl Watchable for Nothing {
    fn is_whole(&self) -> bool {
        true
    }

    fn create_series(&self, group: GroupId) -> Series {
        Series::new(group, 0, Text::new("recorder.position"), "nothing", vec![Scale::new("unit.steps", 1.0, 0)])
    }
}

/// Returns samples of a shaft with 1000 steps per revolution that turns by 50 steps per sample, at 20 000 samples per
/// second. The shaft makes 1000 revolutions per second.
fn stream(from: u64, count: u64) -> Vec<PositionSample> {
    (from..from + count)
        .map(|number| PositionSample {
            at: Moment::from_elapsed(Duration::from_micros(50 * number)),
            position: Some((number * 50 % 1000) as i64),
            is_bad: false,
            is_warned: false,
        })
        .collect()
}

fn samples(track: &DeviceRecorder<Nothing>, line: usize) -> Vec<(i64, f64, Flags)> {
    let line = &track.recorder.series()[line];
    let history = track.recorder.history(line).unwrap();
    let sample = |at| history.sample(line.column(), at).unwrap();
    history.indices().map(sample).map(|own| (own.time.as_nanoseconds(), own.value.to_f64(), own.flags)).collect()
}

#[test]
fn records_stream_completely() {
    let meaning = PositionScales::for_steps_per_turn(Some(1000), 1000.0);
    let mut track = DeviceRecorder::<Nothing>::default();
    // In batches of odd sizes.
    let all = stream(0, 40_000);
    all.chunks(173).for_each(|portion| track.add_positions(portion, &meaning));
    assert_eq!((track.position_count(), track.dropped_count()), (40_000, 0));
    for (number, (time, steps, flags)) in samples(&track, 0).into_iter().enumerate() {
        assert_eq!((time, steps), (number as i64 * 50_000, number as f64 * 50.0), "the wrap is none");
        assert_eq!(flags, Flags::NONE);
    }
    let speeds = samples(&track, 1);
    // The speed is averaged over a quarter of a second.
    assert!(speeds[..5_000].iter().all(|(_, speed, _)| speed.is_nan()));
    assert!(speeds[5_001..].iter().all(|(_, speed, _)| (speed - 1e6).abs() < 1e-3));
}

#[test]
fn flagged_samples_break_line() {
    let meaning = PositionScales::for_steps_per_turn(Some(1000), 1000.0);
    let mut track = DeviceRecorder::<Nothing>::default();
    let mut own = stream(0, 6);
    own[2].position = None;
    own[4].is_bad = true;
    own[5].is_warned = true;
    track.add_positions(&own, &meaning);
    track.record_dropped(3);
    track.add_positions(&stream(9, 2), &meaning);
    track.mark_gap();
    track.add_positions(&stream(11, 1), &meaning);
    // A position that was already read individually is not recorded again.
    track.add_positions(&stream(5, 1), &meaning);
    let (none, bad, broken) = (Flags::NONE, Flags::BAD | Flags::BREAK, Flags::BREAK);
    // A damaged position between two others does not separate them, but one that the device marks as invalid does.
    let expected = [
        (0, 0.0, none),
        (50_000, 50.0, none),
        (100_000, 50.0, bad),
        (150_000, 150.0, none),
        (200_000, 200.0, bad),
        (250_000, 250.0, broken | Flags::WARNING),
        (450_000, 450.0, broken),
        (500_000, 500.0, none),
        (550_000, 550.0, broken),
    ];
    assert_eq!(samples(&track, 0), expected);
    assert_eq!((track.position_count(), track.dropped_count()), (9, 3));
}

/// Damaged frames leave gaps in the speed, but do not change its value of 50 steps in 50 µs (issue 22.21).
#[test]
fn damaged_frames_do_not_interrupt_speed() {
    let meaning = PositionScales::for_steps_per_turn(Some(1000), 1000.0);
    for damaged in [10, 3] {
        let mut track = DeviceRecorder::<Nothing>::default();
        let mut all = stream(0, 20_000);
        all.iter_mut().skip(1).step_by(damaged).for_each(|own| (own.position, own.is_bad) = (None, true));
        all.chunks(173).for_each(|portion| track.add_positions(portion, &meaning));
        let speeds = samples(&track, 1);
        let is_damaged = |number: usize| number % damaged == 1;
        for (number, (_, speed, flags)) in speeds.iter().enumerate().skip(5_010) {
            assert_eq!(flags.contains(Flags::BAD), is_damaged(number));
            assert!(is_damaged(number) == speed.is_nan(), "{number}");
            assert!(speed.is_nan() || (speed - 1e6).abs() < 1e-3, "{number}: {speed}");
        }
        let places = samples(&track, 0);
        assert!(
            (3..20_000).filter(|at| !is_damaged(*at)).all(|at| places[at].1 == places[3].1 + 50.0 * (at - 3) as f64)
        );
    }
}

/// A shaft with 1000 steps that moves 50 steps per sample completes a turn in 20 samples. A gap of a few damaged
/// samples is bridged, but a gap this long is not (issue 22.21).
#[test]
fn possible_wrap_in_gap_stops_tracking() {
    let meaning = PositionScales::for_steps_per_turn(Some(1000), 1000.0);
    for (missing, is_broken) in [(1, false), (3, false), (5, true), (30, true)] {
        let mut track = DeviceRecorder::<Nothing>::default();
        let mut all = stream(0, 50);
        all.iter_mut().skip(10).take(missing).for_each(|own| (own.position, own.is_bad) = (None, true));
        track.add_positions(&all, &meaning);
        let (_, _, flags) = samples(&track, 0)[10 + missing];
        assert_eq!(flags == Flags::BREAK, is_broken, "{missing}: {flags:?}");
    }
}

/// Returns `count` positions at intervals of one second, the first one at second `from`.
fn seconds(from: u64, count: u64) -> Vec<PositionSample> {
    (from..from + count)
        .map(|second| PositionSample {
            at: Moment::from_elapsed(Duration::from_secs(second)),
            position: Some(second as i64 * 10),
            is_bad: false,
            is_warned: false,
        })
        .collect()
}

fn names(track: &DeviceRecorder<Nothing>) -> Vec<(String, bool)> {
    track.recorder.series().iter().map(|line| (line.heading.clone(), line.ended)).collect()
}

/// Returns the positions of the line with the given heading.
fn steps(track: &DeviceRecorder<Nothing>, heading: &str) -> Vec<f64> {
    let at = track.recorder.series().iter().position(|line| line.heading == heading).unwrap();
    samples(track, at).into_iter().map(|(_, steps, _)| steps).collect()
}

/// After a change of scale, earlier recordings keep the old scale and the selected unit, and can be exported (issue
/// 21.12).
#[test]
fn recorded_samples_keep_old_scale() {
    let mut track = DeviceRecorder::<Nothing>::default();
    track.begin_session(&"2026-03-01T09:00:00[UTC]".parse().unwrap());
    track.add_positions(&seconds(0, 3), &PositionScales::for_steps_per_turn(None, 1000.0));
    let [position, ..] = track.lines;
    track.recorder.handle_action(recorder::RecorderAction::SetScale(position, 1));
    track.add_positions(&seconds(3, 2), &PositionScales::for_steps_per_turn(None, 400.0));
    let current = [("position", false), ("speed", false), ("acceleration", false)];
    let ended = ["position", "speed", "acceleration"].map(|name| (format!("{name} until 09:00:02"), true));
    let expected: Vec<(String, bool)> =
        current.iter().map(|(name, own)| ((*name).to_owned(), *own)).chain(ended).collect();
    assert_eq!(names(&track), expected);
    assert_eq!(steps(&track, "position until 09:00:02"), [0.0, 10.0, 20.0]);
    assert_eq!(steps(&track, "position"), [30.0, 40.0]);
    // A step was 0.36° before the change and is 0.9° after it.
    let factor = |at: usize| track.recorder.series()[at].factor();
    assert_eq!((factor(3), factor(0)), (360.0 / 1000.0, 360.0 / 400.0));
    assert_eq!(
        track.recorder.recorded_span().map(|(from, to)| (from.as_nanoseconds(), to.as_nanoseconds())),
        Some((0, 4_000_000_000))
    );
    // They are drawn only at their original times.
    let drawn = |track: &DeviceRecorder<Nothing>| track.recorder.visible_series().filter(|line| line.ended).count();
    assert_eq!(drawn(&track), 2, "not the acceleration, which was hidden");
    track.recorder.handle_action(recorder::RecorderAction::Look(
        SampleTime::from(Moment::from_elapsed(Duration::from_secs(3))),
        SampleTime::from_nanoseconds(9_000_000_000),
    ));
    assert_eq!(drawn(&track), 0);
    track.recorder.handle_action(recorder::RecorderAction::Clear);
    assert_eq!(names(&track).len(), 3, "whoever clears it wants them gone");
}

/// Entering a spindle pitch adds another unit for the same steps (issue 21.12).
#[test]
fn unit_change_keeps_lines() {
    let on_spindle = |millimetres: f64| {
        let mut meaning = PositionScales::for_steps_per_turn(None, 1000.0);
        meaning.scales[0].insert(0, Scale::new("unit.millimetres", millimetres / 1000.0, 3));
        meaning
    };
    let mut track = DeviceRecorder::<Nothing>::default();
    track.add_positions(&seconds(0, 3), &PositionScales::for_steps_per_turn(None, 1000.0));
    let [position, ..] = track.lines;
    track.recorder.handle_action(recorder::RecorderAction::SetScale(position, 2));
    for pitch in [1.0, 12.0] {
        track.add_positions(&seconds(3, 1), &on_spindle(pitch));
        track.add_positions(&seconds(4, 1), &on_spindle(pitch + 0.5));
    }
    assert_eq!(names(&track).len(), 3);
    assert_eq!(steps(&track, "position"), [0.0, 10.0, 20.0, 30.0, 40.0, 40.0]);
    let line = track.recorder.series_by_id(position).unwrap();
    assert_eq!((line.scales()[0].factor, line.scale().unwrap().unit.id()), (0.0125, "unit.steps"));
}

/// A value that is no longer watched keeps its samples and continues when it is watched again (issue 21.12).
#[test]
fn unwatched_value_keeps_samples() {
    let mut track = DeviceRecorder::<Nothing>::default();
    let watching = |second| WatchedValue {
        at: Moment::from_elapsed(Duration::from_secs(second)),
        value: Some(Value::Whole(second as i64)),
        is_warned: false,
        never: None,
    };
    track.set_watched(&[Nothing]);
    track.set_watched(&[]);
    assert_eq!(names(&track).len(), 3, "there was nothing yet");
    track.set_watched(&[Nothing]);
    track.add_watched(&Nothing, &watching(1));
    track.set_watched(&[]);
    track.add_watched(&Nothing, &watching(2));
    assert_eq!((track.watched_values().len(), names(&track)[3].1), (0, true));
    track.set_watched(&[Nothing]);
    track.add_watched(&Nothing, &watching(3));
    assert_eq!((names(&track)[3].clone(), steps(&track, "nothing")), (("nothing".to_owned(), false), vec![1.0, 3.0]));
    track.set_watched(&[]);
    track.recorder.handle_action(recorder::RecorderAction::Clear);
    track.set_watched(&[Nothing]);
    track.add_watched(&Nothing, &watching(4));
    assert_eq!(steps(&track, "nothing"), [4.0]);
}

/// More than two minutes of data are kept when another device is connected (issue 21.12).
#[test]
fn long_recording_survives_device_change() {
    let meaning = PositionScales::for_steps_per_turn(None, 1000.0);
    for (count, lines) in [(120, 3), (121, 6)] {
        let mut track = DeviceRecorder::<Nothing>::default();
        track.add_positions(&seconds(0, count), &meaning);
        track.set_watched(&[Nothing]);
        track.discard_short_recording();
        assert_eq!((track.position_count(), track.watched_values().len()), (0, 1));
        track.add_positions(&seconds(count, 1), &meaning);
        assert_eq!(track.recorder.series().len(), lines + 1, "{count}");
        assert_eq!(steps(&track, "position").len(), 1);
    }
}

/// If only the newest words are stored, only these are decoded again, and older samples are kept (issue 21.12).
#[test]
fn keeps_samples_without_raw_data() {
    let (before, after) =
        (PositionScales::for_steps_per_turn(None, 1000.0), PositionScales::for_steps_per_turn(None, 400.0));
    for (kept, ended) in [(5, 0), (4, 3)] {
        let mut track = DeviceRecorder::<Nothing>::default();
        track.add_positions(&seconds(0, 5), &before);
        track.prepare_redecoding(kept);
        track.add_positions(&seconds(5 - kept as u64, kept as u64), &after);
        assert_eq!(track.recorder.series().iter().filter(|line| line.ended).count(), ended, "{kept}");
        assert_eq!(steps(&track, "position").len(), kept);
    }
}
