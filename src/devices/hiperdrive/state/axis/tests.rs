//! Tests of the set-up, step by step, with data from a simulated drive.

mod facts;
mod standstill;
mod supply;

use std::collections::BTreeMap;
use std::time::Duration;

use super::*;
use crate::app::{Language, Text};
use crate::devices::hiperdrive::procedures::dead_man::{ActionEnd, MotionLock};
use crate::devices::hiperdrive::protocol::{ActualValues, Direction, Family, StatusWord};

/// Returns the data of a drive with factory settings that is not requested.
fn fresh() -> DriveFacts {
    DriveFacts {
        connected: true,
        actual: Some(ActualValues { status: StatusWord::new(0x2A30), speed: 0, position: 0 }),
        position: Some(0),
        // The factory setting is 1000 for parameter 182, and 0 for parameter 198.
        values: BTreeMap::from([(152, 0), (182, 1000), (198, 0)]),
        requested: Some(false),
        scale: Some(PositionScale::FACTORY),
        // 511 · 65536.
        limits: Some((-33_488_896, 33_488_896)),
        family: Some(Family::Short),
        ..DriveFacts::default()
    }
}

fn run() -> Axis {
    Axis::new(DriveNumber::FIRST, None)
}

fn at(seen: &mut DriveFacts, position: i32) {
    if let Some(actual) = &mut seen.actual {
        actual.position = position;
    }
    seen.position = Some(position);
}

/// Lets the simulated drive execute a request.
#[track_caller]
fn apply_command(axis: &mut Axis, seen: &mut DriveFacts, ask: DriveRequest) {
    axis.begin_request(ask.clone(), seen);
    match ask {
        DriveRequest::Try(values) | DriveRequest::Restore(values) => {
            seen.values.extend(values.iter().copied());
            let number = |own: u16| values.iter().find(|(number, _)| *number == own).map(|(_, value)| *value);
            if let Some(value) = number(152) {
                seen.requested = Some(value == 1);
            }
            if let (Some(numerator), Some(denominator)) = (number(154), number(156)) {
                let part = |value: i64| u16::try_from(value).unwrap();
                seen.scale = Some(PositionScale::new(part(numerator), part(denominator)).unwrap());
                seen.locks = vec![MotionLock::LimitsUnconfirmed];
            }
            if let (Some(low), Some(high)) = (number(158), number(160)) {
                seen.limits = Some((low.try_into().unwrap(), high.try_into().unwrap()));
            }
            axis.mark_written();
        }
        DriveRequest::SetPosition(position) => {
            at(seen, position);
            seen.values.insert(198, position.into());
            seen.times_set += 1;
            axis.mark_written();
        }
        DriveRequest::ConfirmLimits => seen.locks.clear(),
        DriveRequest::Take => seen.controlled = true,
        DriveRequest::Give => seen.controlled = false,
        DriveRequest::Save => axis.mark_written(),
        DriveRequest::Move(_) | DriveRequest::PowerCycle | DriveRequest::Acknowledge | DriveRequest::BelieveRestart => {
        }
    }
    axis.update(seen);
}

#[track_caller]
fn press(axis: &mut Axis, seen: &mut DriveFacts, button: AxisButton) -> DriveRequest {
    let ask = axis.request(button, seen).unwrap();
    apply_command(axis, seen, ask.clone());
    ask
}

#[track_caller]
fn next(axis: &mut Axis, seen: &DriveFacts, step: AxisStep) {
    assert_eq!(axis.check_can_continue(seen), Ok(()));
    go_on(axis, seen);
    assert_eq!(axis.step(), step);
}

fn go_on(axis: &mut Axis, seen: &DriveFacts) {
    // This also confirms the entered pitch.
    let pitch = axis.entries().parse_pitch().ok().filter(|_| axis.step() >= AxisStep::Scale);
    axis.next_step(&DriveFacts { pitch: pitch.or(seen.pitch), ..seen.clone() }, "2026-11-23 06:00");
}

/// Enters a spindle with a pitch of 4 mm and a step of 0.01 mm.
fn enter_spindle(axis: &mut Axis) {
    axis.set_entries(LengthEntries { pitch: "4".to_owned(), ..axis.entries().clone() });
}

/// Completes the spindle step. The confirmed pitch applies from then on.
#[track_caller]
fn confirm_spindle(axis: &mut Axis, seen: &mut DriveFacts) {
    next(axis, seen, AxisStep::Confirm);
    seen.pitch = axis.entries().parse_pitch().ok();
    axis.update(seen);
}

#[test]
fn shows_step_for_minimum_time() {
    let ms = Duration::from_millis;
    assert_eq!([0, 599, 600].map(|age| Axis::check_step_settled(ms(age))), [Err(ms(600)), Err(ms(1)), Ok(())]);
    let (mut axis, mut seen) = at_jog_step();
    assert!(axis.can_go_back(&seen));
    seen.moves = true;
    assert!(!axis.can_go_back(&seen), "it moves");
    seen.moves = false;
    axis = run();
    assert!(!axis.can_go_back(&seen), "nothing is before the first step");
}

/// A proposed value has the decimal separator of the language, but both separators are accepted.
#[test]
fn proposed_values_use_local_decimal_sign() {
    for (language, step) in [(Language::English, "0.01"), (Language::German, "0,01")] {
        let shown = run().entries().localized(language);
        assert_eq!(shown.resolution, step);
        let preview = LengthEntries { pitch: "4".to_owned(), ..shown }.preview(&fresh()).unwrap();
        assert_eq!((preview.scale.numerator(), preview.scale.denominator()), (400, 256));
    }
}

/// A parameter that was written twice is reported once, with its last value.
#[test]
fn reports_rewritten_parameters_once() {
    let mut axis = run();
    axis.changes =
        vec![AxisChange::Parameter(158, 9), AxisChange::Parameter(160, 10_050), AxisChange::Parameter(160, 250)];
    let said = labels::changes_text(&axis).to_string_in(Language::English);
    assert_eq!(said, "Written: 158 = 9, 160 = 250.");
}

/// Runs the set-up until the slow jog, with a pitch of 4 mm and a step of 0.01 mm.
fn at_jog_step() -> (Axis, DriveFacts) {
    let (mut axis, mut seen) = (run(), fresh());
    assert_eq!(press(&mut axis, &mut seen, AxisButton::Do), DriveRequest::Try(vec![(152, 1)]));
    next(&mut axis, &seen, AxisStep::Scale);
    enter_spindle(&mut axis);
    // The scale is 400/256 (reference, section 5), and the limits are 511 · 400 = 204400.
    let values = vec![(154, 400), (156, 256), (158, -204_400), (160, 204_400)];
    assert_eq!(press(&mut axis, &mut seen, AxisButton::Do), DriveRequest::Try(values));
    confirm_spindle(&mut axis, &mut seen);
    assert_eq!(axis.check_can_continue(&seen).unwrap_err().id(), "hd_axis.needs_confirm");
    press(&mut axis, &mut seen, AxisButton::Confirm);
    next(&mut axis, &seen, AxisStep::Jog);
    (axis, seen)
}

fn jog(axis: &mut Axis, seen: &mut DriveFacts, to: i32, turns: Direction) {
    let from = seen.position.unwrap();
    (seen.moves, seen.held) = (true, Some((from.unsigned_abs().into(), turns)));
    for part in 0..=4 {
        at(seen, from + (to - from) * part / 4);
        axis.update(seen);
    }
    (seen.moves, seen.held) = (false, None);
    axis.update(seen);
}

fn at_test_step() -> (Axis, DriveFacts) {
    let (mut axis, mut seen) = at_jog_step();
    press(&mut axis, &mut seen, AxisButton::Take);
    jog(&mut axis, &mut seen, 500, Direction::Clockwise);
    assert_eq!(axis.check_can_continue(&seen).unwrap_err().id(), "hd_axis.needs_down");
    jog(&mut axis, &mut seen, 100, Direction::Counterclockwise);
    assert_eq!((axis.travel().up, axis.travel().down), (500, 400));
    assert_eq!(axis.travel().clockwise_is_up, Some(true));
    next(&mut axis, &seen, AxisStep::Reference);
    axis.set_entries(LengthEntries { reference: "1,00".to_owned(), ..axis.entries().clone() });
    // 100 steps become 128, the nearest multiple of 64.
    assert_eq!(press(&mut axis, &mut seen, AxisButton::Do), DriveRequest::SetPosition(128));
    next(&mut axis, &seen, AxisStep::Lower);
    assert_eq!(axis.check_can_continue(&seen).unwrap_err().id(), "entry.missing");
    at(&mut seen, -1000);
    axis.adopt_limit(&seen);
    assert_eq!(axis.entries().lower, "-10.00");
    next(&mut axis, &seen, AxisStep::Upper);
    at(&mut seen, 2000);
    axis.adopt_limit(&seen);
    assert_eq!(axis.check_can_continue(&seen).unwrap_err().id(), "hd_axis.needs_limits");
    assert_eq!(press(&mut axis, &mut seen, AxisButton::Do), DriveRequest::Try(vec![(158, -1000), (160, 2000)]));
    next(&mut axis, &seen, AxisStep::Test);
    (axis, seen)
}

fn go(axis: &mut Axis, seen: &mut DriveFacts, place: TestTarget, ends: i32) {
    let DriveRequest::Move(target) = axis.request(AxisButton::Go(place), seen).unwrap() else { panic!("no move") };
    let act = seen.ended.map_or(1, |(act, _)| act + 1);
    axis.record_test_move_start(place, target, act);
    seen.moves = true;
    axis.update(seen);
    assert_eq!(axis.running_test_target(), Some(place));
    (seen.moves, seen.ended) = (false, Some((act, ActionEnd::Arrived)));
    at(seen, ends);
    axis.update(seen);
}

fn at_power_cycle_step() -> (Axis, DriveFacts) {
    let (mut axis, mut seen) = at_test_step();
    for (place, ends) in [(TestTarget::Middle, 500), (TestTarget::Lower, -1001), (TestTarget::Upper, 2002)] {
        assert_eq!(axis.check_can_continue(&seen).unwrap_err().id(), "hd_axis.needs_test");
        go(&mut axis, &mut seen, place, ends);
    }
    next(&mut axis, &seen, AxisStep::Save);
    press(&mut axis, &mut seen, AxisButton::Do);
    assert!(axis.is_saved());
    next(&mut axis, &seen, AxisStep::PowerCycle);
    press(&mut axis, &mut seen, AxisButton::Give);
    (axis, seen)
}

#[test]
fn new_drive_setup_survives_power_cycle() {
    let (mut axis, mut seen) = at_power_cycle_step();
    assert_eq!(axis.check_can_continue(&seen).unwrap_err().id(), "hd_axis.needs_power");
    // A reading without a power cycle proves nothing.
    axis.on_survey(&seen, false);
    assert!(matches!(axis.power(), Some(Power::On(_))));
    // Worked out by hand: the factory setting of 182 is 1000.
    assert_eq!(press(&mut axis, &mut seen, AxisButton::Do), DriveRequest::Try(vec![(182, 1001)]));
    axis.handle_connection_loss();
    seen.connected = false;
    axis.update(&seen);
    seen.connected = true;
    seen.values.insert(182, 1000);
    // 5° at 400 steps per turn is 5.6 steps, rounded up to six.
    at(&mut seen, 2002 - 6);
    axis.on_survey(&seen, false);
    let Some(Power::Back { kept, moved, allowed, restart, .. }) = axis.power() else { panic!("{:?}", axis.power()) };
    assert_eq!((kept, moved, allowed, restart), (true, Some(-6), 6, RestartEvidence::Read));
    go_on(&mut axis, &seen);
    assert_eq!(axis.setup_end(), Some(SetupEnd::Done));
    assert!(AxisStep::ALL.into_iter().all(|step| axis.step_status(step) == StepStatus::Done));
    // Worked out by hand, in the order in which they were written.
    let numbers = [(152, 1), (154, 400), (156, 256), (158, -204_400), (160, 204_400)];
    let mut changes: Vec<AxisChange> = numbers.map(|(number, value)| AxisChange::Parameter(number, value)).to_vec();
    changes.push(AxisChange::Position(128));
    let more = [(158, -1000), (160, 2000), (182, 1001)];
    changes.extend(more.map(|(number, value)| AxisChange::Parameter(number, value)));
    assert_eq!((axis.changes(), axis.is_saved()), (&changes[..], true));
}

#[test]
fn reports_values_lost_in_power_cycle() {
    let survive = |change: fn(&mut DriveFacts)| {
        let (mut axis, mut seen) = at_power_cycle_step();
        press(&mut axis, &mut seen, AxisButton::Do);
        axis.handle_connection_loss();
        seen.values.insert(182, 1000);
        change(&mut seen);
        axis.on_survey(&seen, false);
        assert!(!axis.has_survived() && axis.step_status(AxisStep::PowerCycle) == StepStatus::Failed);
        assert!(axis.check_can_continue(&seen).is_err());
        labels::finding_text(&axis, AxisStep::PowerCycle, &seen).unwrap().id()
    };
    assert_eq!(survive(|seen| at(seen, 2002 + 7)), "hd_axis.power_moved");
    assert_eq!(survive(|seen| seen.limits = Some((-1000, 1000))), "hd_axis.power_lost");
    assert_eq!(survive(|seen| seen.scale = Some(PositionScale::FACTORY)), "hd_axis.power_lost");
    assert_eq!(survive(|seen| seen.requested = Some(false)), "hd_axis.power_lost");
}

#[test]
fn rejects_impossible_steps() {
    let why = |axis: &Axis, seen: &DriveFacts, button| axis.request(button, seen).unwrap_err().id();
    let (axis, seen) = at_jog_step();
    for (label, changed, id) in [
        ("gone", DriveFacts { connected: false, ..seen.clone() }, "hd_axis.not_connected"),
        ("busy", DriveFacts { busy: true, stale: true, ..seen.clone() }, "hd_axis.busy"),
        ("stale", DriveFacts { stale: true, ..seen.clone() }, "hd_axis.unread"),
        ("no control", seen.clone(), "hd_axis.no_control"),
    ] {
        assert_eq!(why(&axis, &changed, AxisButton::Go(TestTarget::Middle)), id, "{label}");
    }
    let (mut axis, mut seen) = at_test_step();
    seen.moves = true;
    for button in
        [AxisButton::Do, AxisButton::Widen, AxisButton::Go(TestTarget::Lower), AxisButton::Give, AxisButton::Recall]
    {
        assert_eq!(why(&axis, &seen, button), "hd_axis.moving", "{button:?}");
    }
    assert_eq!(axis.check_can_continue(&seen).unwrap_err().id(), "hd_axis.moving");
    seen.moves = false;
    assert_eq!(why(&axis, &seen, AxisButton::PowerCycle), "hd_axis.not_virtual");
    seen.is_virtual = true;
    assert_eq!(why(&axis, &seen, AxisButton::PowerCycle), "hd_axis.give_first");
    // During a write, nothing else is possible.
    axis.begin_request(DriveRequest::Save, &seen);
    assert_eq!(why(&axis, &seen, AxisButton::Go(TestTarget::Lower)), "hd_axis.busy");
    go_on(&mut axis, &seen);
    axis.go_back(&seen);
    assert_eq!(axis.step(), AxisStep::Test);
}

#[test]
fn limits_must_enclose_axis_position() {
    let (mut axis, mut seen) = at_test_step();
    axis.go_back(&seen);
    let typed = |lower: &str, upper: &str, axis: &Axis| LengthEntries {
        lower: lower.to_owned(),
        upper: upper.to_owned(),
        ..axis.entries().clone()
    };
    at(&mut seen, 2000);
    for (lower, upper, id) in [
        ("20", "-10", "hd_axis.crossed"),
        ("20", "20", "hd_axis.crossed"),
        ("-10", "19.99", "hd_axis.outside"),
        ("-10", "ten", "entry.number"),
        ("", "20", "entry.missing"),
        ("-10", "1e99", "entry.number"),
    ] {
        axis.set_entries(typed(lower, upper, &axis));
        assert_eq!(axis.request(AxisButton::Do, &seen).unwrap_err().id(), id, "{lower} {upper}");
    }
    axis.set_entries(typed("-10,00", "20.01", &axis));
    assert_eq!(axis.request(AxisButton::Do, &seen), Ok(DriveRequest::Try(vec![(158, -1000), (160, 2001)])));
}

#[test]
fn missed_target_fails_test() {
    let (mut axis, mut seen) = at_test_step();
    // 1° at 400 steps per turn is 1.1 steps, rounded up to two.
    go(&mut axis, &mut seen, TestTarget::Middle, 503);
    assert!(!axis.test_outcome(TestTarget::Middle).unwrap().is_good());
    go(&mut axis, &mut seen, TestTarget::Middle, 498);
    assert!(axis.test_outcome(TestTarget::Middle).unwrap().is_good());
    let DriveRequest::Move(target) = axis.request(AxisButton::Go(TestTarget::Upper), &seen).unwrap() else {
        panic!("no move")
    };
    axis.record_test_move_start(TestTarget::Upper, target, 9);
    // The end of an earlier action does not count for this one.
    axis.update(&seen);
    assert_eq!((axis.running_test_target(), axis.test_outcome(TestTarget::Upper)), (Some(TestTarget::Upper), None));
    seen.ended = Some((9, ActionEnd::Stopped));
    axis.update(&seen);
    assert!(
        axis.test_outcome(TestTarget::Upper).is_some_and(|own| !own.is_good())
            && axis.check_can_continue(&seen).is_err()
    );
}

#[test]
fn cancel_reports_written_and_unsaved_values() {
    let (mut axis, mut seen) = at_test_step();
    axis.cancel(&seen, "");
    assert_eq!((axis.setup_end(), axis.is_saved()), (Some(SetupEnd::Cancelled), false));
    assert!(axis.changes().len() == 8 && axis.step_status(AxisStep::Test) == StepStatus::Ahead);
    assert_eq!(axis.request(AxisButton::Go(TestTarget::Lower), &seen).unwrap_err().id(), "hd_axis.over");
    seen.unsaved = BTreeMap::from([(152, 0)]);
    assert_eq!(press(&mut axis, &mut seen, AxisButton::Recall), DriveRequest::Restore(vec![(152, 0)]));
    // The current location has the position that was set.
    assert_eq!(axis.changes(), [AxisChange::Position(128)]);
    let told = |axis: &Axis| write_outcome_lines(axis, &seen).iter().map(Text::id).collect::<Vec<_>>();
    assert_eq!(told(&axis), ["hd_axis.was_written", "hd_axis.returned", "hd_axis.not_saved", "hd_axis.place_left"]);
    let mut axis = run();
    axis.cancel(&seen, "");
    assert_eq!(told(&axis), ["hd_axis.nothing_written"]);
    assert!(axis.changes().is_empty());
    // A write that did not begin has changed nothing. An interrupted write may have changed values.
    for (begun, changes) in [(false, 0), (true, 1)] {
        let mut axis = run();
        axis.begin_request(DriveRequest::Try(vec![(152, 1)]), &fresh());
        axis.handle_write_failure(begun);
        assert_eq!((axis.changes().len(), axis.is_partly_written()), (changes, begun));
    }
}

#[test]
fn does_not_write_correct_position() {
    let (mut axis, mut seen) = at_jog_step();
    axis.skip_step(&seen, "");
    assert_eq!(axis.step(), AxisStep::Jog, "this one cannot be left out");
    press(&mut axis, &mut seen, AxisButton::Take);
    jog(&mut axis, &mut seen, 500, Direction::Counterclockwise);
    jog(&mut axis, &mut seen, 0, Direction::Clockwise);
    assert_eq!(axis.travel().clockwise_is_up, Some(false));
    next(&mut axis, &seen, AxisStep::Reference);
    axis.skip_step(&seen, "");
    assert_eq!((axis.step(), axis.step_status(AxisStep::Reference)), (AxisStep::Lower, StepStatus::Skipped));
    axis.go_back(&seen);
    assert_eq!(axis.step_status(AxisStep::Reference), StepStatus::Now);
}

#[test]
fn previews_pitch_and_step() {
    let preview = |pitch: &str, resolution: &str, family| {
        let entries =
            LengthEntries { pitch: pitch.to_owned(), resolution: resolution.to_owned(), ..LengthEntries::default() };
        entries.preview(&DriveFacts { family: Some(family), ..fresh() }).map_err(|text| text.id())
    };
    let own = preview("4", "0,01", Family::Short).unwrap();
    assert_eq!((own.scale.numerator(), own.scale.denominator()), (400, 256));
    assert_eq!((own.lower, own.upper, own.ruler.scale.steps_per_turn()), (-204_400, 204_400, 400.0));
    // The limits are 33488896 steps of 0.01 mm.
    let (low, high) = own.unchanged.unwrap();
    assert!((low + 334_888.96).abs() < 1e-6 && (high - 334_888.96).abs() < 1e-6);
    // A pitch of 2 mm in steps of 0.1 mm gives 20 steps per turn, for 16000 turns.
    let own = preview("2", "0.1", Family::Long).unwrap();
    assert_eq!((own.scale.numerator(), own.upper), (20, 320_000));
    for (pitch, resolution, id) in [
        ("0", "0.01", "entry.number"),
        ("", "0.01", "entry.missing"),
        ("4", "0", "entry.number"),
        ("4", "-1", "entry.number"),
        ("3.141593", "0.017", "hd_axis.too_fine"),
    ] {
        assert_eq!(preview(pitch, resolution, Family::Short), Err(id), "{pitch} {resolution}");
    }
}

#[test]
fn steps_have_instructions_and_result() {
    let (axis, seen) = at_power_cycle_step();
    for step in AxisStep::ALL {
        let texts = [labels::title(step), labels::step_instructions(step, &seen), labels::button_label(step)];
        let found = labels::finding_text(&axis, step, &seen).unwrap();
        for text in texts.iter().chain([&found]) {
            for language in [Language::English, Language::German] {
                let said = text.to_string_in(language);
                assert!(said != text.id() && !said.contains('{'), "{said}");
            }
        }
    }
    let found = |step| labels::finding_text(&axis, step, &seen).unwrap().to_string_in(Language::English);
    assert_eq!(found(AxisStep::Scale), "The drive's scaling is 400/256 (400 steps per turn).");
    assert_eq!(found(AxisStep::Confirm), "The drive's limits are -2044.00 mm to 2044.00 mm.");
    assert_eq!(found(AxisStep::Upper), "The drive's limits are -10.00 mm to 20.00 mm.");
    assert_eq!(
        found(AxisStep::Jog),
        "Distance moved: 5.00 mm in the + direction, 4.00 mm in the − direction. Clockwise rotation increases the \
         position."
    );
    assert_eq!(found(AxisStep::Test), "Positions reached: 3 of 3. The largest deviation from the target is 0.02 mm.");
}
