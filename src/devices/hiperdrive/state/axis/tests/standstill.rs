//! Tests of position changes at standstill. They may show that another master has set the reference again at another
//! location.

use std::time::Duration;

use super::*;
use crate::units::Moment;

/// Status word of a drive at standstill, with bit 13 set. `MOVING_STATUS_WORD` is the same word with bit 13 clear (reference,
/// section 3).
const STANDSTILL_STATUS_WORD: u16 = 0x2A37;
const MOVING_STATUS_WORD: u16 = 0x0A37;

/// Sets the drive data to a reading taken `ms` milliseconds after the session began.
fn read(seen: &mut DriveFacts, ms: u64, position: i32, word: u16) {
    at(seen, position);
    seen.actual = seen.actual.map(|own| ActualValues { status: StatusWord::new(word), ..own });
    seen.actual_at = Some(Moment::START + Duration::from_millis(ms));
}

/// Returns a set-up in the test step. At 10 s, the axis is at standstill at position 2000, with 400 steps per turn.
fn axis_at_standstill() -> (Axis, DriveFacts) {
    let (mut axis, mut seen) = at_test_step();
    read(&mut seen, 10_000, 2000, STANDSTILL_STATUS_WORD);
    axis.update(&seen);
    (axis, seen)
}

/// If the reference is set to the same number at another location, parameter 198 does not change, but the position
/// jumps. At up to 35 rpm (parameter 166), a shaft turns 210° per second. It readjusts by up to 5°, and its reports are
/// up to 0.1 s late (issue 21.6 c).
#[test]
fn jump_at_standstill_means_changed_reference() {
    let case = |ms: u64, position: i32, word: u16| {
        let (mut axis, mut seen) = axis_at_standstill();
        read(&mut seen, 10_000 + ms, position, word);
        axis.update(&seen);
        (axis.invalidated_step(), labels::unexplained_change_text(&axis, &seen).is_some())
    };
    let jump = (Some(AxisStep::Reference), false);
    for (label, ms, steps, expected) in [
        // 0.12 s · 210°/s + 5° is 30.2°, or 33.6 steps.
        ("as far as it turns at once", 20, 34, (None, false)),
        ("farther", 20, 35, jump),
        // 1.1 s · 210°/s + 5° is 236°, or 262.2 steps.
        ("as far as it turns in a second", 1000, 263, (None, false)),
        ("farther", 1000, -264, jump),
        // 1.101 s · 210°/s + 5° is 236.21°, or 262.5 steps.
        ("unread for so long that it may have moved", 1001, -263, (None, true)),
        ("farther", 1001, 264, jump),
        ("5° are 5.6 steps: it has readjusted", 60_000, 6, (None, false)),
        ("it has not", 60_000, 7, (None, true)),
    ] {
        assert_eq!(case(ms, 2000 + steps, STANDSTILL_STATUS_WORD), expected, "{label}: {steps} steps in {ms} ms");
        assert_eq!(case(ms, 2000 + steps, MOVING_STATUS_WORD), (None, false), "{label}: it moves");
    }
    let (mut axis, mut seen) = axis_at_standstill();
    read(&mut seen, 10_020, 128, STANDSTILL_STATUS_WORD);
    axis.update(&seen);
    let why = labels::invalidated_step(axis.invalidated_step().unwrap()).to_string_in(Language::English);
    assert!(why.contains("changed while the axis was at rest"), "{why}");
    assert_eq!(axis.may_move(&seen).unwrap_err().id(), "hd_axis.fallen");
}

/// A position change that has a known cause is not a jump (issue 21.6 c).
#[test]
fn ignores_expected_position_changes() {
    type Case<'c> = (&'c str, fn(&mut DriveFacts));
    let cases: [Case<'_>; 3] = [
        ("moved by a person, between two looks", |seen| seen.ended = Some((9, ActionEnd::Arrived))),
        ("it moves still", |seen| seen.moves = true),
        ("nothing is concluded while it is busy", |seen| seen.busy = true),
    ];
    for (label, change) in cases {
        let (mut axis, mut seen) = axis_at_standstill();
        change(&mut seen);
        read(&mut seen, 10_020, -900, STANDSTILL_STATUS_WORD);
        axis.update(&seen);
        assert_eq!((axis.invalidated_step(), labels::unexplained_change_text(&axis, &seen)), (None, None), "{label}");
    }
    // The position was set by this program. The set-up is at the next step and uses the new numbers.
    let (mut axis, mut seen) = axis_at_standstill();
    (0..3).for_each(|_| axis.go_back(&seen));
    axis.set_entries(LengthEntries { reference: "1".to_owned(), ..axis.entries().clone() });
    press(&mut axis, &mut seen, AxisButton::Do);
    read(&mut seen, 10_020, 128, STANDSTILL_STATUS_WORD);
    axis.update(&seen);
    next(&mut axis, &seen, AxisStep::Lower);
    read(&mut seen, 10_040, 128, STANDSTILL_STATUS_WORD);
    axis.update(&seen);
    assert_eq!((axis.invalidated_step(), axis.reference_position()), (None, Some(128)));
}

/// After the connection was lost, a motion and a new reference look the same. The set-up and its report mention this
/// until the user sets the reference again (issue 21.6 c).
#[test]
fn reports_unobserved_change_as_unexplained() {
    let again = |position: i32| {
        let (mut axis, mut seen) = axis_at_standstill();
        axis.handle_connection_loss();
        // The clock of the next session starts at zero again.
        read(&mut seen, 0, position, STANDSTILL_STATUS_WORD);
        axis.update(&seen);
        (axis, seen)
    };
    let (axis, seen) = again(2000 - 6);
    assert_eq!(
        (axis.invalidated_step(), labels::unexplained_change_text(&axis, &seen)),
        (None, None),
        "5° are 5.6 steps"
    );
    let (mut axis, mut seen) = again(2000 - 348);
    assert_eq!(axis.invalidated_step(), None, "it may have been moved");
    let told = |axis: &Axis, seen: &DriveFacts| {
        labels::unexplained_change_text(axis, seen).map(|text| text.to_string_in(Language::English))
    };
    assert!(told(&axis, &seen).unwrap().starts_with("The position changed by -3.48 mm while"));
    // No reference has been set or confirmed yet, so no result depends on it.
    let (mut early, mut fresh) = at_jog_step();
    read(&mut fresh, 0, 0, STANDSTILL_STATUS_WORD);
    early.update(&fresh);
    early.handle_connection_loss();
    read(&mut fresh, 0, 348, STANDSTILL_STATUS_WORD);
    early.update(&fresh);
    assert_eq!(told(&early, &fresh), None);
    // Go back to the reference, and continue from there.
    (0..3).for_each(|_| axis.go_back(&seen));
    assert!(told(&axis, &seen).is_some());
    next(&mut axis, &seen, AxisStep::Lower);
    assert_eq!(told(&axis, &seen), None);
    axis.handle_connection_loss();
    read(&mut seen, 0, 2000, STANDSTILL_STATUS_WORD);
    axis.update(&seen);
    axis.cancel(&seen, "2026-11-23 06:00");
    let device = Device { name: "HIPERDRIVE HUB-4 · 16".to_owned(), variant: None, serial_number: "77".to_owned() };
    let text = AxisReport::new(&axis, &seen, &device).unwrap().page(Language::English);
    assert!(text.contains("The position changed by 3.48 mm while"), "{text}");
}
