//! A reference set again to the same number: what a position that changes at a standstill proves, and what not.

use std::time::Duration;

use super::*;
use crate::units::Moment;

/// Bit 13, standing still, and without it (reference 3).
const STANDS: u16 = 0x2A37;
const MOVES: u16 = 0x0A37;

/// A reading at that moment of the session.
fn read(seen: &mut DriveFacts, ms: u64, position: i32, word: u16) {
    at(seen, position);
    seen.actual = seen.actual.map(|own| ActualValues { status: StatusWord::new(word), ..own });
    seen.actual_at = Some(Moment::START + Duration::from_millis(ms));
}

/// In the test step, read at 10 s: the axis stands still at 2000, with 400 steps per turn.
fn at_standstill() -> (Axis, DriveFacts) {
    let (mut axis, mut seen) = at_test_step();
    read(&mut seen, 10_000, 2000, STANDS);
    axis.update(&seen);
    (axis, seen)
}

/// Issue 21.6 (c): 198 keeps its number if the reference is set again elsewhere; a shaft turns at most 35 rpm (166),
/// which is 210° per second, readjusts by up to 5°, and reports up to 0.1 s late.
#[test]
fn a_position_jump_at_standstill_means_a_changed_reference() {
    let case = |ms: u64, position: i32, word: u16| {
        let (mut axis, mut seen) = at_standstill();
        read(&mut seen, 10_000 + ms, position, word);
        axis.update(&seen);
        (axis.invalidated_step(), labels::unexplained_change_text(&axis, &seen).is_some())
    };
    let jump = (Some(AxisStep::Reference), false);
    for (label, ms, steps, expected) in [
        // 0.12 s · 210° + 5° are 30.2°, which are 33.6 steps.
        ("as far as it turns at once", 20, 34, (None, false)),
        ("farther", 20, 35, jump),
        // 1.1 s · 210° + 5° are 236°: 262.2 steps.
        ("as far as it turns in a second", 1000, 263, (None, false)),
        ("farther", 1000, -264, jump),
        // 1.101 s · 210° + 5° are 236.21°: 262.5 steps.
        ("unread for so long that it may have moved", 1001, -263, (None, true)),
        ("farther", 1001, 264, jump),
        ("5° are 5.6 steps: it has readjusted", 60_000, 6, (None, false)),
        ("it has not", 60_000, 7, (None, true)),
    ] {
        assert_eq!(case(ms, 2000 + steps, STANDS), expected, "{label}: {steps} steps in {ms} ms");
        assert_eq!(case(ms, 2000 + steps, MOVES), (None, false), "{label}: it moves");
    }
    let (mut axis, mut seen) = at_standstill();
    read(&mut seen, 10_020, 128, STANDS);
    axis.update(&seen);
    let why = labels::invalidated_step(axis.invalidated_step().unwrap()).to_string_in(Language::English);
    assert!(why.contains("changed while the axis was at rest"), "{why}");
    assert_eq!(axis.may_move(&seen).unwrap_err().id(), "hd_axis.fallen");
}

/// Issue 21.6 (c): a known change of the position is no jump.
#[test]
fn a_known_position_change_is_not_a_jump() {
    type Case<'c> = (&'c str, fn(&mut DriveFacts));
    let cases: [Case<'_>; 3] = [
        ("moved by a person, between two looks", |seen| seen.ended = Some((9, ActionEnd::Arrived))),
        ("it moves still", |seen| seen.moves = true),
        ("nothing is concluded while it is busy", |seen| seen.busy = true),
    ];
    for (label, change) in cases {
        let (mut axis, mut seen) = at_standstill();
        change(&mut seen);
        read(&mut seen, 10_020, -900, STANDS);
        axis.update(&seen);
        assert_eq!((axis.invalidated_step(), labels::unexplained_change_text(&axis, &seen)), (None, None), "{label}");
    }
    // Set by this program: the run is at the step after it, and counts by the new numbers.
    let (mut axis, mut seen) = at_standstill();
    (0..3).for_each(|_| axis.go_back(&seen));
    axis.set_entries(LengthEntries { reference: "1".to_owned(), ..axis.entries().clone() });
    press(&mut axis, &mut seen, AxisButton::Do);
    read(&mut seen, 10_020, 128, STANDS);
    axis.update(&seen);
    next(&mut axis, &seen, AxisStep::Lower);
    read(&mut seen, 10_040, 128, STANDS);
    axis.update(&seen);
    assert_eq!((axis.invalidated_step(), axis.reference_position()), (None, Some(128)));
}

/// Issue 21.6 (c): after a lost connection a motion cannot be distinguished from a new reference; this is reported,
/// also in the report, until the user has been at the reference again.
#[test]
fn an_unobserved_position_change_is_reported_as_unexplained() {
    let again = |position: i32| {
        let (mut axis, mut seen) = at_standstill();
        axis.handle_connection_loss();
        // The clock of the next session starts again.
        read(&mut seen, 0, position, STANDS);
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
    // No reference was set or confirmed yet: nothing counts by it.
    let (mut early, mut fresh) = at_jog_step();
    read(&mut fresh, 0, 0, STANDS);
    early.update(&fresh);
    early.handle_connection_loss();
    read(&mut fresh, 0, 348, STANDS);
    early.update(&fresh);
    assert_eq!(told(&early, &fresh), None);
    // At the reference, and from there on.
    (0..3).for_each(|_| axis.go_back(&seen));
    assert!(told(&axis, &seen).is_some());
    next(&mut axis, &seen, AxisStep::Lower);
    assert_eq!(told(&axis, &seen), None);
    axis.handle_connection_loss();
    read(&mut seen, 0, 2000, STANDS);
    axis.update(&seen);
    axis.cancel(&seen, "2026-11-23 06:00");
    let device = Device { name: "HIPERDRIVE HUB-4 · 16".to_owned(), variant: None, serial_number: "77".to_owned() };
    let text = AxisReport::new(&axis, &seen, &device).unwrap().page(Language::English);
    assert!(text.contains("The position changed by 3.48 mm while"), "{text}");
}
