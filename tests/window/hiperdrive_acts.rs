//! Acts that move a drive, repeated as a person would where the computer has held them up. A window that stands still for
//! 250 ms rightly stops what it moves, and so does a test whose thread a busy computer does not let run. Whatever else ends
//! an act ends the test.

use crate::tabs::Tabs as _;
use std::time::{Duration, Instant};

use encoder_studio::app::{Severity, Studio};
use encoder_studio::devices::hiperdrive::procedures::dead_man::Ended;
use encoder_studio::devices::hiperdrive::protocol::{DriveNumber, State};
use encoder_studio::devices::hiperdrive::state::{HiperdriveAction as Hiperdrive, Motor, Unit};

use crate::hiperdrive::{act, drive, unit};
use crate::support::{Desk, LONG};

/// How the last act of a drive ended, with its number.
pub(crate) fn last_end(studio: &Studio, drive: DriveNumber) -> Option<(u64, Ended)> {
    studio.hiperdrive().and_then(|own| own.moves.drive(drive)?.ended)
}

/// An act of a drive has ended since then because nobody said any more that it was wanted.
pub(crate) fn has_lapsed(studio: &Studio, drive: DriveNumber, since: Option<(u64, Ended)>) -> bool {
    let end = last_end(studio, drive);
    end != since && matches!(end, Some((_, Ended::Stale)))
}

/// How often an act is repeated that has lapsed.
pub(crate) const ATTEMPTS: usize = 20;

/// Looks until a drive may move: what rules it is read again and again on threads, and a press before that is refused.
#[track_caller]
pub(crate) fn until_free(desk: &mut Desk, drive: DriveNumber) {
    let began = Instant::now();
    while let Err(why) = unit(desk).may_move(drive) {
        assert!(began.elapsed() < LONG, "it may not move: {}\n{}", why.terminal(), crate::support::log(&desk.studio));
        desk.studio.poll();
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// Asks for something until it is so. A window that stands still for 250 ms stops what it moves, and so does a test that a
/// busy computer holds up: then it is asked for once more, as a person would. Whatever else ends it is no reason to.
#[track_caller]
pub(crate) fn drive_until(
    desk: &mut Desk,
    motor: impl Fn(&Unit) -> Motor,
    what: &str,
    condition: impl Fn(&Studio) -> bool,
) {
    act_until(desk, |own| Hiperdrive::Drive(motor(own)), what, condition);
}

/// The same for whatever is an act of the drive that is shown.
#[track_caller]
pub(crate) fn act_until(
    desk: &mut Desk,
    action: impl Fn(&Unit) -> Hiperdrive,
    what: &str,
    condition: impl Fn(&Studio) -> bool,
) {
    let shown = unit(desk).drive();
    for _ in 0..ATTEMPTS {
        let before = last_end(&desk.studio, shown);
        let action = action(unit(desk));
        act(desk, action);
        desk.until(what, |studio| condition(studio) || has_lapsed(studio, shown, before));
        if !has_lapsed(&desk.studio, shown, before) {
            return;
        }
        desk.until("it stands", |studio| !studio.moves());
    }
    panic!("never: {what}: it has lapsed {ATTEMPTS} times");
}

/// Moves the drive that is shown far away, until it moves.
#[track_caller]
pub(crate) fn set_off(desk: &mut Desk) {
    drive_until(
        desk,
        |_| Motor::Move { target: 30_000_000 },
        "it moves",
        |studio| {
            let own = studio.hiperdrive().unwrap();
            own.state(own.drive()) == Some(State::Moving)
        },
    );
}

/// What is seen while the drive that is shown moves, where it has moved all that time.
#[track_caller]
pub(crate) fn while_it_moves<T>(desk: &mut Desk, mut look: impl FnMut(&mut Desk) -> T) -> T {
    let shown = unit(desk).drive();
    for _ in 0..ATTEMPTS {
        act(desk, Hiperdrive::SelectDrive(shown));
        until_free(desk, shown);
        set_off(desk);
        let before = last_end(&desk.studio, shown);
        let seen = look(desk);
        desk.studio.poll();
        if !has_lapsed(&desk.studio, shown, before) {
            return seen;
        }
        desk.until("it stands", |studio| !studio.moves());
    }
    panic!("it has lapsed {ATTEMPTS} times");
}

/// Warnings besides that of a motion that has lapsed.
pub(crate) fn warned(desk: &Desk) -> Vec<&'static str> {
    desk.told(Severity::Warning).into_iter().filter(|id| *id != "hd_end.stale").collect()
}

/// Says with every look that the jog is held, until it is so.
#[track_caller]
pub(crate) fn hold_until(desk: &mut Desk, what: &str, condition: impl Fn(&Desk) -> bool) {
    let began = Instant::now();
    while !condition(desk) {
        assert!(began.elapsed() < LONG, "never: {what}\n{}", crate::support::log(&desk.studio));
        drive(desk, Motor::JogHold);
        desk.studio.poll();
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// Holds a pad until it is so. Where a busy computer has held the hand up for 250 ms, which ends a jog, it is let go and
/// pressed once more, after `prepare`; whatever else ends it is a failure.
#[track_caller]
pub(crate) fn hold_pad_until(
    desk: &mut Desk,
    press: Motor,
    what: &str,
    mut prepare: impl FnMut(&mut Desk),
    condition: impl Fn(&Desk) -> bool,
) {
    let shown = unit(desk).drive();
    for _ in 0..ATTEMPTS {
        prepare(desk);
        let before = last_end(&desk.studio, shown);
        drive(desk, press);
        hold_until(desk, what, |desk| condition(desk) || !unit(desk).moves.is_held());
        if unit(desk).moves.is_held() {
            return;
        }
        drive(desk, Motor::JogRelease);
        desk.until("it stands", |studio| !studio.moves());
        let end = last_end(&desk.studio, shown);
        assert!(end != before && matches!(end, Some((_, Ended::Stale))), "never: {what}: {before:?}, then {end:?}");
    }
    panic!("never: {what}: it has lapsed {ATTEMPTS} times");
}
