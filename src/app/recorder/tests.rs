//! Tests of recorders with known samples.

use super::*;
use crate::analysis::history::Flags;
use crate::app::Text;

const MILLISECOND: i64 = 1_000_000;

fn at(milliseconds: i64) -> SampleTime {
    SampleTime::from_nanoseconds(milliseconds * MILLISECOND)
}

/// Creates a recorder with a line of counts, displayable in steps and in degrees (360° are 4096 steps), and a line of
/// voltages.
fn recorder(span: i64) -> (Recorder, GroupId, [SeriesId; 2]) {
    let mut recorder = Recorder::new(span);
    let group = recorder.add_group(&[Kind::Whole, Kind::Real], 100_000, Some(500 * MILLISECOND));
    let degrees = Scale::new("unit.degrees", 360.0 / 4096.0, 3);
    let scales = vec![Scale::new("unit.steps", 1.0, 0), degrees];
    let name = || Text::new("recorder.position");
    let counts = recorder.add_line(Series::new(group, 0, name(), "position", scales));
    let volts = recorder.add_line(Series::new(group, 1, name(), "sine", vec![Scale::new("unit.steps", 1.0, 4)]));
    (recorder, group, [counts, volts])
}

fn add(recorder: &mut Recorder, group: GroupId, time: i64, count: i64, volts: f64, flags: Flags) {
    let (count, volts, flags) = ([count], [volts], [flags]);
    let parts =
        [ColumnPart::from_integers(&count).with_flags(&flags), ColumnPart::from_reals(&volts).with_flags(&flags)];
    recorder.append(group, &[at(time)], &parts).unwrap();
}

/// Adds one sample per millisecond. The value of each sample equals its time.
fn ramp(recorder: &mut Recorder, group: GroupId, from: i64, to: i64) {
    (from..to).for_each(|time| add(recorder, group, time, time, time as f64 / 1000.0, Flags::NONE));
}

#[test]
fn view_follows_newest_sample_until_held() {
    let (mut recorder, group, _) = recorder(100 * MILLISECOND);
    assert_eq!(recorder.window_bounds(), (at(0), at(100)));
    ramp(&mut recorder, group, 0, 50);
    assert_eq!(recorder.window_bounds(), (at(0), at(100)), "filled from the left");
    ramp(&mut recorder, group, 50, 301);
    assert_eq!(recorder.window_bounds(), (at(200), at(300)));
    recorder.handle_action(RecorderAction::Pause);
    ramp(&mut recorder, group, 301, 400);
    assert_eq!(recorder.window_bounds(), (at(200), at(300)), "recorded on");
    assert!(!recorder.follows_newest());
    recorder.handle_action(RecorderAction::Follow);
    assert_eq!(recorder.window_bounds(), (at(299), at(399)));
    recorder.handle_action(RecorderAction::Zoom(at(350), 0.5));
    assert_eq!(recorder.window_bounds(), (at(349), at(399)), "the newest stays at the edge");
    recorder.handle_action(RecorderAction::Fit);
    let (from, to) = recorder.window_bounds();
    assert!(from == at(0) && to > at(399) && to < at(402));
}

#[test]
fn zoom_keeps_pointer_position() {
    let (mut recorder, group, _) = recorder(100 * MILLISECOND);
    ramp(&mut recorder, group, 0, 1000);
    recorder.handle_action(RecorderAction::Look(at(400), at(200)));
    assert_eq!(recorder.window_bounds(), (at(200), at(400)), "whichever end was first");
    recorder.handle_action(RecorderAction::Zoom(at(250), 0.5));
    assert_eq!(recorder.window_bounds(), (at(225), at(325)));
    for factor in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        recorder.handle_action(RecorderAction::Zoom(at(250), factor));
        assert_eq!(recorder.window_bounds(), (at(225), at(325)));
    }
    recorder.handle_action(RecorderAction::SetSpan(10 * MILLISECOND));
    assert_eq!(recorder.window_bounds(), (at(315), at(325)));
    (0..100).for_each(|_| recorder.handle_action(RecorderAction::Zoom(at(320), 0.1)));
    assert_eq!(recorder.window_length(), 100);
    (0..100).for_each(|_| recorder.handle_action(RecorderAction::Zoom(at(320), 1e9)));
    assert_eq!(recorder.window_length(), 8_640_000 * 1_000 * MILLISECOND, "a hundred days");
    recorder.finish();
    recorder.handle_action(RecorderAction::Zoom(at(320), 1e9));
    assert_eq!(recorder.window_length(), 4 * 999 * MILLISECOND, "a complete recording of 1000 samples");
    recorder.handle_action(RecorderAction::Look(at(5), at(5)));
    assert_eq!(recorder.window_length(), 100);
    recorder.handle_action(RecorderAction::Look(
        SampleTime::from_nanoseconds(i64::MIN),
        SampleTime::from_nanoseconds(i64::MAX),
    ));
    assert!(recorder.window_length() > 0);
}

/// Statistics of 100…200 in steps of 1 match those calculated in Python: mean 150, stdev 29.300170647967224, times
/// 360/4096.
#[test]
fn cursors_read_raw_samples() {
    let (mut recorder, group, [counts, volts]) = recorder(1_000 * MILLISECOND);
    ramp(&mut recorder, group, 0, 150);
    add(&mut recorder, group, 150, 1 << 50, 9.0, Flags::BAD);
    ramp(&mut recorder, group, 151, 1000);
    assert_eq!(recorder.readings_at_cursors(recorder.series_by_id(counts).unwrap()), None);
    recorder.handle_action(RecorderAction::SetCursor(Cursor::A, Some(at(200))));
    recorder.handle_action(RecorderAction::SetCursor(Cursor::B, Some(SampleTime::from_nanoseconds(99_800_000))));
    assert_eq!(recorder.cursor_distance(), Some(-100 * MILLISECOND), "on the samples that are read");
    recorder.handle_action(RecorderAction::SetScale(counts, 1));
    let measured = recorder.readings_at_cursors(recorder.series_by_id(counts).unwrap()).unwrap();
    let degrees = 360.0 / 4096.0;
    assert_eq!((measured.a, measured.b), (Some(200.0 * degrees), Some(100.0 * degrees)), "the nearest raw samples");
    assert_eq!(measured.difference, Some(-100.0 * degrees));
    let between = measured.between.unwrap();
    assert_eq!((between.count, between.bad), (100, 1));
    assert_eq!((between.min, between.max), (100.0 * degrees, 200.0 * degrees));
    assert!((between.mean - 150.0 * degrees).abs() < 1e-12);
    // Calculated without the invalid sample in the middle: sqrt(sum((k-150)^2 for k in 100..=200 if k != 150) / 99).
    assert!((between.deviation - 29.447_779_494_755_07 * degrees).abs() < 1e-9, "{}", between.deviation / degrees);
    recorder.handle_action(RecorderAction::SetCursor(Cursor::A, Some(at(150))));
    let measured = recorder.readings_at_cursors(recorder.series_by_id(volts).unwrap()).unwrap();
    assert_eq!((measured.a, measured.difference), (None, None), "what is bad is not read");
    recorder.handle_action(RecorderAction::ShowCursors(false));
    assert_eq!(recorder.readings_at_cursors(recorder.series_by_id(volts).unwrap()), None);
}

#[test]
fn cursor_outside_recording_reads_nothing() {
    let (mut recorder, group, [counts, _]) = recorder(1_000 * MILLISECOND);
    let slow = recorder.add_group(&[Kind::Whole], 100, None);
    let scales = vec![Scale::new("unit.steps", 1.0, 0)];
    let late = recorder.add_line(Series::new(slow, 0, Text::new("recorder.speed"), "counter", scales));
    ramp(&mut recorder, group, 0, 1000);
    recorder.append(slow, &[at(700), at(900)], &[ColumnPart::from_integers(&[7, 9])]).unwrap();
    recorder.handle_action(RecorderAction::SetCursor(Cursor::A, Some(at(500))));
    recorder.handle_action(RecorderAction::SetCursor(Cursor::B, Some(at(5_000))));
    assert_eq!(recorder.cursor(Cursor::B), Some(at(5_000)), "it stands where it was put");
    let measure = |id| recorder.readings_at_cursors(recorder.series_by_id(id).unwrap()).unwrap();
    assert_eq!((measure(counts).a, measure(counts).b, measure(counts).difference), (Some(500.0), None, None));
    assert_eq!((measure(late).a, measure(late).b), (None, None), "it was not recorded yet");
    assert_eq!(measure(late).between.unwrap().count, 2);
    recorder.handle_action(RecorderAction::Fit);
    recorder.handle_action(RecorderAction::ShowCursors(true));
    assert_eq!(Cursor::BOTH.map(|cursor| recorder.cursor(cursor)), [Some(at(333)), Some(at(666))]);
}

#[test]
fn held_view_is_not_evicted() {
    let mut recorder = Recorder::new(100 * MILLISECOND);
    let group = recorder.add_group(&[Kind::Whole], 10_000, None);
    let scales = vec![Scale::new("unit.steps", 1.0, 0)];
    let line = recorder.add_line(Series::new(group, 0, Text::new("recorder.position"), "position", scales));
    let feed = |recorder: &mut Recorder, from: i64, to: i64| {
        let times: Vec<SampleTime> = (from..to).map(at).collect();
        let values: Vec<i64> = (from..to).collect();
        recorder.append(group, &times, &[ColumnPart::from_integers(&values)]).unwrap();
    };
    arm(&mut recorder, line, TriggerCondition::Rising, 5_000.0, false);
    (0..100).for_each(|portion| feed(&mut recorder, portion * 1000, (portion + 1) * 1000));
    let (from, to) = recorder.window_bounds();
    assert_eq!((from, to), (at(4_975), at(5_075)));
    let own = recorder.series_by_id(line).unwrap();
    let seen = |time| recorder.nearest_sample(own, at(time)).unwrap().value.to_f64() as i64;
    assert_eq!((seen(4_975), seen(5_075)), (4_975, 5_075), "still there");
    recorder.handle_action(RecorderAction::Disarm);
    feed(&mut recorder, 100_000, 101_000);
    assert_eq!(recorder.recorded_span().unwrap().1, at(100_999), "and goes on");
}

#[test]
fn trigger_searches_finished_recording() {
    let (mut recorder, group, [counts, _]) = recorder(100 * MILLISECOND);
    ramp(&mut recorder, group, 0, 1000);
    recorder.finish();
    arm(&mut recorder, counts, TriggerCondition::Rising, 600.0, false);
    assert_eq!((state(&recorder), recorder.window_bounds()), (TriggerState::Held(at(600)), (at(575), at(675))));
    arm(&mut recorder, counts, TriggerCondition::Falling, 600.0, false);
    assert_eq!(state(&recorder), TriggerState::Missed);
}

fn arm(recorder: &mut Recorder, line: SeriesId, when: TriggerCondition, level: f64, repeat: bool) {
    recorder.handle_action(RecorderAction::Arm(Trigger { line, when, level, before: 0.25, repeat }));
}

fn state(recorder: &Recorder) -> TriggerState {
    recorder.trigger().unwrap().1
}

#[test]
fn trigger_shows_preceding_samples() {
    let (mut recorder, group, [counts, _]) = recorder(100 * MILLISECOND);
    ramp(&mut recorder, group, 0, 500);
    recorder.handle_action(RecorderAction::SetScale(counts, 1));
    // 600 steps in degrees, because a level is in the displayed unit.
    arm(&mut recorder, counts, TriggerCondition::Rising, 600.0 * 360.0 / 4096.0, false);
    assert_eq!(state(&recorder), TriggerState::Armed);
    ramp(&mut recorder, group, 500, 601);
    assert_eq!(state(&recorder), TriggerState::Fired(at(600)));
    assert_eq!(recorder.window_bounds(), (at(575), at(675)));
    ramp(&mut recorder, group, 601, 674);
    assert_eq!(state(&recorder), TriggerState::Fired(at(600)));
    ramp(&mut recorder, group, 674, 2000);
    assert_eq!(state(&recorder), TriggerState::Held(at(600)));
    assert_eq!(recorder.window_bounds(), (at(575), at(675)), "held");
    recorder.handle_action(RecorderAction::SetScale(counts, 0));
    assert_eq!(recorder.trigger(), None, "the level was in another unit");
}

#[test]
fn triggers_fire_on_condition() {
    let values = [5.0, 1.0, 9.0, 3.0];
    for (when, level, fires) in [
        (TriggerCondition::Rising, 4.0, Some(3)),
        (TriggerCondition::Falling, 4.0, Some(2)),
        (TriggerCondition::Above, 8.0, Some(3)),
        (TriggerCondition::Above, 5.0, Some(1)),
        (TriggerCondition::Below, 1.0, Some(2)),
        (TriggerCondition::Rising, 9.5, None),
        (TriggerCondition::Error, 0.0, Some(4)),
    ] {
        let (mut recorder, group, [_, volts]) = recorder(100 * MILLISECOND);
        arm(&mut recorder, volts, when, level, false);
        for (number, value) in (1..).zip(values) {
            let flags = if number == 4 { Flags::WARNING } else { Flags::NONE };
            add(&mut recorder, group, number, 0, value, flags);
        }
        let expected = fires.map_or(TriggerState::Armed, |number| TriggerState::Fired(at(number)));
        assert_eq!(state(&recorder), expected, "{when:?} {level}");
    }
}

#[test]
fn edge_across_gap_does_not_trigger() {
    let (mut recorder, group, [_, volts]) = recorder(100 * MILLISECOND);
    arm(&mut recorder, volts, TriggerCondition::Rising, 5.0, false);
    add(&mut recorder, group, 0, 0, 1.0, Flags::NONE);
    add(&mut recorder, group, 1, 0, 9.0, Flags::BAD);
    add(&mut recorder, group, 2, 0, 9.0, Flags::NONE);
    // This gap is longer than the longest pause of the group.
    add(&mut recorder, group, 10, 0, 1.0, Flags::NONE);
    add(&mut recorder, group, 700, 0, 9.0, Flags::NONE);
    assert_eq!(state(&recorder), TriggerState::Armed);
    recorder.handle_action(RecorderAction::Arm(Trigger {
        line: volts,
        when: TriggerCondition::Rising,
        level: f64::NAN,
        before: 0.0,
        repeat: false,
    }));
    assert_eq!(recorder.trigger().unwrap().0.level, 5.0, "what is no level changes nothing");
}

#[test]
fn repeated_trigger_shows_complete_windows() {
    let (mut recorder, group, [_, volts]) = recorder(100 * MILLISECOND);
    arm(&mut recorder, volts, TriggerCondition::Rising, 0.0, true);
    let wave = |time: i64| if time % 70 < 35 { -1.0 } else { 1.0 };
    (0..400).for_each(|time| add(&mut recorder, group, time, 0, wave(time), Flags::NONE));
    // Edges are at 35, 105, 175, …: after 35 + 75, the next view begins with the edge at 175, the following one with
    // that at 315.
    assert_eq!(recorder.window_bounds(), (at(290), at(390)));
    assert_eq!(state(&recorder), TriggerState::Armed);
}

#[test]
fn removing_last_line_removes_samples() {
    let (mut recorder, group, [counts, volts]) = recorder(100 * MILLISECOND);
    ramp(&mut recorder, group, 0, 10);
    arm(&mut recorder, counts, TriggerCondition::Rising, 0.0, false);
    recorder.remove_line(counts);
    assert!(recorder.trigger().is_none() && !recorder.is_empty());
    recorder.remove_line(volts);
    assert!(recorder.is_empty() && recorder.recorded_span().is_none());
    assert_eq!(recorder.append(group, &[at(20)], &[]), Err(BatchError::Shape));
}

#[test]
fn clearing_removes_only_samples() {
    let (mut recorder, group, [counts, _]) = recorder(100 * MILLISECOND);
    ramp(&mut recorder, group, 0, 1000);
    recorder.handle_action(RecorderAction::SetScale(counts, 1));
    recorder.handle_action(RecorderAction::ShowCursors(true));
    recorder.handle_action(RecorderAction::Clear);
    assert!(recorder.is_empty() && recorder.cursor(Cursor::A).is_none());
    assert_eq!(recorder.series_by_id(counts).unwrap().scale_number(), 1);
    add(&mut recorder, group, 5, 1, 1.0, Flags::NONE);
    assert_eq!(recorder.recorded_span(), Some((at(5), at(5))), "time may begin anew");
}

fn exported(recorder: &mut Recorder, visible: bool) -> Option<String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("samples.csv");
    let writing = recorder.begin_export(&path, visible)?;
    let exported = std::thread::scope(|scope| {
        let written = scope.spawn(|| writing.run(&|| {}));
        while !written.is_finished() {
            recorder.pass_rows_to_export();
            std::thread::yield_now();
        }
        written.join().unwrap()
    });
    assert_eq!(recorder.end_export(exported.number, true), Some(0));
    let text = std::fs::read_to_string(&path).unwrap();
    assert_eq!(exported.rows.unwrap(), Some(text.lines().count() as u64 - 1));
    Some(text)
}

#[test]
fn table_leaves_bad_samples_blank() {
    let (mut recorder, group, [counts, volts]) = recorder(1_000 * MILLISECOND);
    let slow = recorder.add_group(&[Kind::Real], 100, None);
    let celsius = vec![Scale::new("unit.degrees", 1.0, 1)];
    recorder.add_line(Series::new(slow, 0, Text::new("recorder.position"), "temperature, \"inside\"", celsius));
    add(&mut recorder, group, -1, 4096, 0.5, Flags::NONE);
    add(&mut recorder, group, 2, 1024, f64::NAN, Flags::NONE);
    add(&mut recorder, group, 3, 7, 0.25, Flags::BAD);
    recorder.append(slow, &[at(2), at(1_000)], &[ColumnPart::from_reals(&[21.5, 22.0])]).unwrap();
    recorder.handle_action(RecorderAction::SetScale(counts, 1));
    let expected = "time [s],position [°],sine [steps],temperature   inside  [°],remark\n\
                    -0.001000000,360,0.5,,\n\
                    0.002000000,90,,21.5,bad\n\
                    0.003000000,,,,bad\n\
                    1.000000000,,,22,\n";
    assert_eq!(recorder.unexported_duration(), 1_001 * MILLISECOND);
    assert_eq!(exported(&mut recorder, false).unwrap(), expected);
    assert_eq!(recorder.unexported_duration(), 0);
    recorder.handle_action(RecorderAction::Look(at(-5), at(1)));
    recorder.handle_action(RecorderAction::Show(volts, false));
    let visible = exported(&mut recorder, true).unwrap();
    assert_eq!(visible.lines().skip(1).collect::<Vec<_>>(), ["-0.001000000,360,,"]);
    recorder.handle_action(RecorderAction::Look(at(10_000), at(20_000)));
    assert_eq!(exported(&mut recorder, true), None, "nothing to write");
}

#[test]
fn counts_untimed_samples() {
    let mut recorder = Recorder::without_timestamps(100);
    let group = recorder.add_group(&[Kind::Real], 100, None);
    recorder.add_line(Series::new(
        group,
        0,
        Text::new("recorder.position"),
        "sine",
        vec![Scale::new("unit.steps", 1.0, 0)],
    ));
    let times: Vec<SampleTime> =
        (0..3).map(|sample| SampleTime::from_nanoseconds(sample * UNTIMED_SAMPLE_INTERVAL_NS)).collect();
    recorder.append(group, &times, &[ColumnPart::from_reals(&[0.5, 1.5, 2.5])]).unwrap();
    assert_eq!(recorder.window_length(), 100 * UNTIMED_SAMPLE_INTERVAL_NS);
    assert_eq!(exported(&mut recorder, false).unwrap(), "sample,sine [steps],remark\n0,0.5,\n1,1.5,\n2,2.5,\n");
}

#[test]
fn long_export_completes_or_cancels() {
    let (mut recorder, group, _) = recorder(1_000 * MILLISECOND);
    ramp(&mut recorder, group, 0, 70_000);
    let text = exported(&mut recorder, false).unwrap();
    for (number, line) in text.lines().skip(1).enumerate() {
        assert!(line.starts_with(&format!("{}.{:03}000000,{number},", number / 1000, number % 1000)), "{line}");
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("samples.csv");
    std::fs::write(&path, "the old one").unwrap();
    let writing = recorder.begin_export(&path, false).unwrap();
    assert!(recorder.begin_export(&path, false).is_none(), "one at a time");
    recorder.handle_action(RecorderAction::CancelExport);
    recorder.pass_rows_to_export();
    let given_up = writing.run(&|| {});
    assert!(given_up.rows.unwrap().is_none());
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "the old one");
    assert_eq!(recorder.end_export(given_up.number, false), Some(0));
    let nowhere = recorder.begin_export(&folder.path().join("no/samples.csv"), false).unwrap();
    assert!(nowhere.run(&|| {}).rows.is_err());
    assert_eq!(recorder.end_export(given_up.number, true), None, "that was another table");
    assert!(recorder.export().is_some());
}

/// A cancelled export creates no file and leaves an existing file unchanged.
#[test]
fn eviction_cancels_export() {
    for clear in [true, false] {
        let (mut recorder, group, _) = recorder(1_000 * MILLISECOND);
        ramp(&mut recorder, group, 0, 70_000);
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("samples.csv");
        std::fs::write(&path, "the old one").unwrap();
        let writing = recorder.begin_export(&path, false).unwrap();
        recorder.pass_rows_to_export();
        if clear {
            recorder.handle_action(RecorderAction::Clear);
        }
        drop(recorder);
        assert!(writing.run(&|| {}).rows.unwrap().is_none());
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "the old one");
    }
}
