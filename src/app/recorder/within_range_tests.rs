//! Tests of the readings, statistics and triggers of positions displayed within a range.

use super::*;

const RANGE: i64 = 1000;

/// Returns a recorder with one position per microsecond, displayed in turns of 100 steps within a range of 1000 steps.
fn recorder(steps: &[i64]) -> (Recorder, SeriesId) {
    let mut recorder = Recorder::new(1_000_000);
    let group = recorder.add_group(&[Kind::Whole], 10_000, None);
    let scales = vec![Scale::new("unit.turns_in_range", 0.01, 2).within(RANGE), Scale::new("unit.turns", 0.01, 2)];
    let line = recorder.add_line(Series::new(group, 0, Text::new("recorder.position"), "position", scales));
    append(&mut recorder, group, 0, steps);
    (recorder, line)
}

fn append(recorder: &mut Recorder, group: GroupId, first: i64, steps: &[i64]) {
    let times: Vec<SampleTime> = (first..).take(steps.len()).map(at).collect();
    recorder.append(group, &times, &[ColumnPart::from_integers(steps)]).unwrap();
}

fn at(sample: i64) -> SampleTime {
    SampleTime::from_nanoseconds(sample * 1000)
}

#[test]
fn readings_wrap_and_differences_unwrap() {
    let (mut recorder, line) = recorder(&[-10, 990, 1010, 2010]);
    recorder.handle_action(RecorderAction::SetCursor(Cursor::A, Some(at(1))));
    recorder.handle_action(RecorderAction::SetCursor(Cursor::B, Some(at(2))));
    let measured = |recorder: &Recorder| recorder.readings_at_cursors(recorder.series_by_id(line).unwrap()).unwrap();
    let own = measured(&recorder);
    // 990 steps are 9.90 turns, and 1010 are 0.10 turns after the wrap. The shaft has turned by 0.20 turns.
    assert_eq!((own.a, own.b), (Some(9.9), Some(0.1)));
    assert!((own.difference.unwrap() - 0.2).abs() < 1e-12);
    assert_eq!(own.between, None, "a mean across the end of the range is of no use");
    recorder.handle_action(RecorderAction::SetCursor(Cursor::A, Some(at(0))));
    recorder.handle_action(RecorderAction::SetCursor(Cursor::B, Some(at(0))));
    let own = measured(&recorder);
    assert_eq!((own.a, own.between.map(|own| (own.min, own.mean, own.max))), (Some(9.9), Some((9.9, 9.9, 9.9))));
    recorder.handle_action(RecorderAction::SetScale(line, 1));
    assert_eq!(measured(&recorder).a, Some(-0.1), "continuous");
}

#[test]
fn trigger_ignores_wrap() {
    let trigger = |line, when, level| Trigger { line, when, level, before: 0.0, repeat: false };
    // Backwards across 0, there is no rising edge at 5 turns, but a falling one when the position passes 9.5 turns.
    let steps = [20, 10, -10, -40, -60];
    for (when, level, found) in [
        (TriggerCondition::Rising, 5.0, None),
        (TriggerCondition::Falling, 9.5, Some(at(4))),
        (TriggerCondition::Above, 9.0, Some(at(2))),
        (TriggerCondition::Below, 0.1, Some(at(1))),
    ] {
        let (mut recorder, line) = recorder(&steps);
        recorder.finish();
        recorder.handle_action(RecorderAction::Arm(trigger(line, when, level)));
        let state = recorder.trigger().map(|(_, state)| state);
        assert_eq!(state, Some(found.map_or(TriggerState::Missed, TriggerState::Held)), "{when:?}");
    }
    // Forwards in the third range, 2,490 to 2,510 steps pass 5 turns, which are 500 steps.
    let (mut recorder, line) = recorder(&[2480, 2490, 2510]);
    recorder.finish();
    recorder.handle_action(RecorderAction::Arm(trigger(line, TriggerCondition::Rising, 5.0)));
    assert_eq!(recorder.trigger().map(|(_, state)| state), Some(TriggerState::Held(at(2))));
}
