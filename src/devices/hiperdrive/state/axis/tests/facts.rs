//! Tests with changed drive data: the change is detected and reported, and the results that depend on this data become
//! void.

use super::*;
use crate::devices::hiperdrive::protocol::{ErrorCode, Length};

/// Goes back to the step that has lost its result. Only the button changes the page.
#[track_caller]
fn go_back_to(axis: &mut Axis, seen: &DriveFacts, step: AxisStep) {
    let shown = axis.step();
    axis.update(seen);
    assert_eq!((axis.step(), axis.invalidated_step()), (shown, Some(step)), "the page is left by a press alone");
    assert_eq!(axis.step_status(step), StepStatus::Failed);
    assert_eq!(axis.check_can_continue(seen).unwrap_err().id(), "hd_axis.fallen");
    assert_eq!(axis.may_move(seen).unwrap_err().id(), "hd_axis.fallen");
    axis.go_back(seen);
    assert_eq!((axis.step(), axis.invalidated_step()), (step, None));
}

#[test]
fn confirms_limits_in_drive_scale() {
    let (mut axis, mut seen) = at_jog_step();
    press(&mut axis, &mut seen, AxisButton::Take);
    assert_eq!(axis.may_move(&seen), Ok(()));
    // Another master has changed the scale.
    seen.scale = Some(PositionScale::FACTORY);
    go_back_to(&mut axis, &seen, AxisStep::Scale);
    assert_eq!(axis.check_can_continue(&seen).unwrap_err().id(), "hd_axis.needs_scale");
    press(&mut axis, &mut seen, AxisButton::Do);
    next(&mut axis, &seen, AxisStep::Confirm);
    assert!(axis.check_can_continue(&seen).is_err(), "what was confirmed before was for another scale");
    // The step stays locked although it was confirmed once.
    press(&mut axis, &mut seen, AxisButton::Confirm);
    next(&mut axis, &seen, AxisStep::Jog);
    seen.locks = vec![MotionLock::LimitsUnconfirmed];
    go_back_to(&mut axis, &seen, AxisStep::Confirm);
}

/// If an earlier result becomes void, the page stays the same until the user goes back (issue 21.6 i).
#[test]
fn setup_returns_to_first_lost_step() {
    let (mut axis, mut seen) = at_test_step();
    // Discard all drive data.
    seen = DriveFacts { controlled: true, pitch: seen.pitch, ..fresh() };
    go_back_to(&mut axis, &seen, AxisStep::Request);
    assert!(AxisStep::ALL[1..].iter().all(|step| axis.step_status(*step) == StepStatus::Ahead));
    // A drive that does not answer does not make any result void.
    let (mut axis, mut seen) = at_test_step();
    seen.connected = false;
    seen.scale = None;
    axis.update(&seen);
    assert_eq!((axis.step(), axis.invalidated_step()), (AxisStep::Test, None));
}

/// If the pitch, the reference or a limit changes, all later results become void, including taught limits (issue 21.6
/// c).
#[test]
fn changed_value_undoes_later_steps() {
    let tested = || {
        let (mut axis, mut seen) = at_test_step();
        go(&mut axis, &mut seen, TestTarget::Middle, 500);
        assert!(axis.test_outcome(TestTarget::Middle).is_some());
        (axis, seen)
    };
    let done =
        |axis: &Axis| AxisStep::ALL.into_iter().filter(|step| axis.step_status(*step) == StepStatus::Done).count();
    // A change on another page or by another master has the same effect, because only the values in the drive matter.
    type Case<'c> = (&'c str, fn(&mut DriveFacts), AxisStep);
    let cases: [Case<'_>; 5] = [
        ("a limit", |seen| seen.limits = Some((-1000, 2001)), AxisStep::Confirm),
        ("the reference to another number", |seen| _ = seen.values.insert(198, 34_800), AxisStep::Reference),
        // A reference set by another master at a different position is tested in `standstill`.
        ("the reference from this window, to the same number", |seen| seen.times_set += 1, AxisStep::Reference),
        ("the pitch", |seen| seen.pitch = Some(Length { nanometres: 5_000_000 }), AxisStep::Scale),
        ("the request", |seen| seen.requested = Some(false), AxisStep::Request),
    ];
    for (label, change, falls) in cases {
        let (mut axis, mut seen) = tested();
        change(&mut seen);
        axis.update(&seen);
        assert_eq!((axis.invalidated_step(), done(&axis)), (Some(falls), falls.index()), "{label}");
        assert!(axis.test_outcome(TestTarget::Middle).is_none(), "{label}");
        assert_eq!((axis.entries().lower.as_str(), axis.entries().upper.as_str()), ("", ""), "{label}");
        assert!(axis.request(AxisButton::Go(TestTarget::Upper), &seen).is_err(), "{label}");
    }
    // The set-up itself makes later results void when the user goes back and sets a reference 13.44 mm from the
    // previous one. 1500 steps become 1472.
    let (mut axis, mut seen) = tested();
    (0..3).for_each(|_| axis.go_back(&seen));
    assert_eq!((axis.step(), done(&axis)), (AxisStep::Reference, 6));
    axis.set_entries(LengthEntries { reference: "15".to_owned(), ..axis.entries().clone() });
    assert_eq!(press(&mut axis, &mut seen, AxisButton::Do), DriveRequest::SetPosition(1472));
    next(&mut axis, &seen, AxisStep::Lower);
    assert_eq!(done(&axis), 5);
    assert_eq!((axis.entries().lower.as_str(), axis.entries().upper.as_str()), ("", ""));
    assert_eq!(axis.check_can_continue(&seen).unwrap_err().id(), "entry.missing");
    // A changed lower limit makes the test moves void, because they were made between the previous limits.
    let (mut axis, mut seen) = tested();
    (0..2).for_each(|_| axis.go_back(&seen));
    axis.set_entries(LengthEntries { lower: "-9".to_owned(), ..axis.entries().clone() });
    next(&mut axis, &seen, AxisStep::Upper);
    assert!(axis.test_outcome(TestTarget::Middle).is_none() && axis.check_can_continue(&seen).is_err());
    assert_eq!(press(&mut axis, &mut seen, AxisButton::Do), DriveRequest::Try(vec![(158, -900), (160, 2000)]));
    next(&mut axis, &seen, AxisStep::Test);
    assert_eq!(axis.invalidated_step(), None, "the review of their plan confirms them");
    // Going back to look at a step and then forward again keeps all results.
    let (mut axis, seen) = tested();
    (0..4).for_each(|_| axis.go_back(&seen));
    for step in [AxisStep::Reference, AxisStep::Lower, AxisStep::Upper, AxisStep::Test] {
        next(&mut axis, &seen, step);
    }
    assert!(axis.test_outcome(TestTarget::Middle).is_some());
}

/// Motion counts as a jog only while a button is held, and a jump of the position never does (issue 21.6 b).
#[test]
fn counts_only_held_motion_as_jog() {
    let (mut axis, mut seen) = at_jog_step();
    press(&mut axis, &mut seen, AxisButton::Take);
    for position in [0, 5000, -5000, 0] {
        at(&mut seen, position);
        axis.update(&seen);
    }
    assert_eq!(
        (axis.travel(), axis.check_can_continue(&seen).unwrap_err().id()),
        (JogTravel::default(), "hd_axis.needs_up")
    );
    // The first packets while a button is held do not contain a position yet.
    seen.held = Some((7, Direction::Clockwise));
    seen.position = None;
    axis.update(&seen);
    at(&mut seen, 5000);
    axis.update(&seen);
    assert_eq!(axis.travel().up, 0, "it is where the motion begins");
    at(&mut seen, 5100);
    axis.update(&seen);
    assert_eq!((axis.travel().up, axis.travel().clockwise_is_up), (100, Some(true)));
    // The button is released, the axis is moved by other means, and the button is pressed again.
    seen.held = None;
    at(&mut seen, -9000);
    axis.update(&seen);
    seen.held = Some((8, Direction::Counterclockwise));
    axis.update(&seen);
    assert_eq!((axis.travel().up, axis.travel().down), (100, 0));
}

/// Losing and regaining the connection does not prove that the supply was off (issue 21.6 e).
#[test]
fn power_cycle_is_detected_or_confirmed() {
    let found = |axis: &Axis, seen: &DriveFacts| {
        labels::finding_text(axis, AxisStep::PowerCycle, seen).unwrap().to_string_in(Language::English)
    };
    let again = |axis: &mut Axis, seen: &DriveFacts| {
        axis.handle_connection_loss();
        axis.on_survey(seen, false);
    };
    // Without a restart marker, the user must confirm the power cycle, and the result states this.
    let (mut axis, mut seen) = at_power_cycle_step();
    assert_eq!(axis.request(AxisButton::Restarted, &seen).unwrap_err().id(), "hd_axis.needs_power");
    again(&mut axis, &seen);
    assert!(!axis.has_survived() && axis.step_status(AxisStep::PowerCycle) == StepStatus::Failed);
    assert_eq!(axis.check_can_continue(&seen).unwrap_err().id(), "hd_axis.needs_proof");
    press(&mut axis, &mut seen, AxisButton::Restarted);
    assert!(
        axis.has_survived()
            && found(&axis, &seen)
                .contains("You confirmed that the supply was switched off, but the program could not verify this"),
        "{}",
        found(&axis, &seen)
    );
    // The restart marker is still present, so the user cannot confirm a power cycle.
    let (mut axis, mut seen) = at_power_cycle_step();
    press(&mut axis, &mut seen, AxisButton::Do);
    again(&mut axis, &seen);
    assert_eq!(axis.check_can_continue(&seen).unwrap_err().id(), "hd_axis.not_restarted");
    assert_eq!(axis.request(AxisButton::Restarted, &seen).unwrap_err().id(), "hd_axis.not_restarted");
    // Now the supply is actually switched off.
    axis.handle_connection_loss();
    seen.values.insert(182, 1000);
    axis.on_survey(&seen, false);
    assert!(axis.has_survived() && found(&axis, &seen).contains("The drive has restarted"));
    // A value that another master had changed before also proves the power cycle.
    let (mut axis, mut seen) = at_power_cycle_step();
    seen.values.insert(182, 500);
    axis.update(&seen);
    assert_eq!(axis.request(AxisButton::Do, &seen).unwrap_err().id(), "hd_axis.already");
    axis.handle_connection_loss();
    seen.values.insert(182, 1000);
    axis.on_survey(&seen, false);
    assert!(axis.has_survived());
}

/// A fault is shown with its code and blocks all motion. It can be acknowledged within the set-up (issue 21.6 g).
#[test]
fn shows_and_acknowledges_fault() {
    let (axis, mut seen) = at_test_step();
    assert_eq!(axis.request(AxisButton::Acknowledge, &seen).unwrap_err().id(), "hd_axis.no_fault");
    // Status word 2AB8h is a fault and 2A70h the lock. Error 8300h is a block in reverse (reference 9).
    for (word, why) in [(0x2AB8, "hd_refused.fault"), (0x2A70, "hd_refused.lock")] {
        seen.actual = seen.actual.map(|actual| ActualValues { status: StatusWord::new(word), ..actual });
        seen.error = None;
        assert_eq!(labels::fault_text(&seen).unwrap().id(), "hd_axis.fault_unread");
        seen.error = Some(ErrorCode::BLOCK_REVERSE);
        assert!(labels::fault_text(&seen).unwrap().to_string_in(Language::English).starts_with("Fault 8300: "));
        assert_eq!(axis.may_move(&seen).unwrap_err().id(), why);
        assert_eq!(axis.request(AxisButton::Go(TestTarget::Middle), &seen).unwrap_err().id(), why);
        assert_eq!(axis.request(AxisButton::Acknowledge, &seen), Ok(DriveRequest::Acknowledge));
    }
}

/// Differences from the saved values are reported and written back. The position is not written back, but left to the
/// user (issue 21.6 d and h).
#[test]
fn shows_and_restores_differences() {
    let (mut axis, mut seen) = (run(), fresh());
    assert_eq!(axis.request(AxisButton::Recall, &seen).unwrap_err().id(), "hd_axis.nothing_back");
    seen.values.extend([(154, 400), (156, 256), (158, -1000), (198, 128)]);
    seen.unsaved = BTreeMap::from([(154, 256), (156, 1), (158, -1000), (198, 0)]);
    let told = labels::differences(&seen).unwrap().to_string_in(Language::English);
    assert!(
        told.contains("parameter 154 is 400 instead of 256") && told.contains("parameter 156 is 256 instead of 1"),
        "{told}"
    );
    assert!(
        told.contains("parameter 198 is 128 instead of 0 (set the position again") && !told.contains("158"),
        "{told}"
    );
    let back = vec![(154, 256), (156, 1)];
    assert_eq!(axis.request(AxisButton::Recall, &seen), Ok(DriveRequest::Restore(back.clone())));
    axis.begin_request(DriveRequest::Restore(back), &seen);
    axis.mark_written();
    let returned = |seen: &DriveFacts| labels::write_back_text(&axis, seen).unwrap().to_string_in(Language::English);
    assert!(returned(&seen).contains("0 of 2"), "nothing was read yet");
    seen.values.extend([(154, 256), (156, 1)]);
    assert!(returned(&seen).contains("restored to their previous values: 2 of 2"));
    // The manual describes parameter 198 as "the actual position to be shown at the present position". Writing the old
    // number at a different position would therefore shift the zero point.
    let told = labels::unrestored_position_text(&axis, &seen).unwrap().to_string_in(Language::English);
    assert!(
        told.starts_with(
            "The previous position (parameter 198) is not restored, because it would set a wrong zero point"
        ),
        "{told}"
    );
    assert_eq!(
        axis.request(AxisButton::Recall, &seen).unwrap_err().id(),
        "hd_axis.place_left",
        "and not that nothing differs"
    );
    axis.cancel(&seen, "");
    let device = Device { name: String::new(), variant: None, serial_number: String::new() };
    let text = AxisReport::new(&axis, &seen, &device).unwrap().page(Language::German);
    assert!(text.contains("Die vorherige Position (Parameter 198) wird nicht wiederhergestellt"), "{text}");
    seen.values.insert(198, 0);
    assert_eq!(labels::unrestored_position_text(&axis, &seen), None);
    assert_eq!(axis.request(AxisButton::Recall, &seen).unwrap_err().id(), "hd_axis.nothing_back");
}

/// Without a confirmed pitch, positions are shown in steps, with 65536 per turn (issue 21.6 f).
#[test]
fn millimetres_need_confirmed_pitch() {
    let (mut axis, mut seen) = (run(), fresh());
    let position = |seen: &DriveFacts| labels::millimetres_text(seen.ruler(), 400).to_string_in(Language::English);
    press(&mut axis, &mut seen, AxisButton::Do);
    next(&mut axis, &seen, AxisStep::Scale);
    // The drive has 400 steps per turn and an unknown spindle. A pitch that would fit by coincidence is not proposed.
    seen.scale = PositionScale::new(400, 256).ok();
    assert_eq!(axis.entries().pitch, "");
    assert_eq!(axis.check_can_continue(&seen).unwrap_err().id(), "entry.missing");
    enter_spindle(&mut axis);
    assert_eq!((position(&seen), axis.check_can_continue(&seen)), ("400 steps".to_owned(), Ok(())));
    confirm_spindle(&mut axis, &mut seen);
    assert_eq!(position(&seen), "4.00 mm");
    let pitch = Some(Length { nanometres: 8_000_000 });
    let known = Axis::new(axis.drive(), Some(Ruler { scale: seen.scale.unwrap(), pitch }));
    assert_eq!((known.entries().pitch.as_str(), known.entries().resolution.as_str()), ("8", "0.02"));
}

/// A completed set-up has a report in millimetres, whose lines fit a page (issue 21.6 j).
#[test]
fn run_ends_with_report() {
    let device = Device { name: "HIPERDRIVE HUB-4 · 16".to_owned(), variant: None, serial_number: "77".to_owned() };
    let (mut axis, mut seen) = at_power_cycle_step();
    assert_eq!(AxisReport::new(&axis, &seen, &device), None, "it goes on");
    axis.handle_connection_loss();
    axis.on_survey(&seen, true);
    go_on(&mut axis, &seen);
    // Later changes do not affect the report of this set-up.
    at(&mut seen, 0);
    seen.limits = Some((-5, 5));
    for language in [Language::English, Language::German] {
        let text = AxisReport::new(&axis, &seen, &device).unwrap().page(language);
        assert!(text.lines().all(|line| line.chars().count() < 80) && !text.contains('{'), "{text}");
    }
    let text = AxisReport::new(&axis, &seen, &device).unwrap().page(Language::English);
    for part in [
        "Axis set-up, 2026-11-23 06:00",
        "HIPERDRIVE HUB-4 · 16, drive 1",
        "serial number 77",
        "Spindle pitch: 4.000 mm per turn",
        "7. Upper limit: done\n   The drive's limits are -10.00 mm to 20.00 mm.",
        "The test moves were made at 10 % speed and 25 % torque.",
        "Lower limit: reached -10.01 mm (-0.01 mm off target)",
        "The virtual supply was switched off\n   and on.",
        "All values that the device can save have been saved.",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
}
