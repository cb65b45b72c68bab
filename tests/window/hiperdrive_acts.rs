//! Test support for requests that move a drive. A window that is not updated for 250 ms stops its motion on purpose,
//! and so does a test on a busy computer. Such requests are therefore repeated. Any other end of a motion fails the
//! test.

use crate::tabs::Tabs as _;
use std::time::{Duration, Instant};

use encoder_studio::app::{Severity, Studio};
use encoder_studio::devices::hiperdrive::procedures::dead_man::ActionEnd;
use encoder_studio::devices::hiperdrive::protocol::{DriveNumber, State};
use encoder_studio::devices::hiperdrive::state::{HiperdriveAction as Hiperdrive, HiperdriveDevice, MotorCommand};

use crate::hiperdrive::{act, drive, unit};
use crate::support::{Desk, LONG};

/// Returns the number of a drive's last action and how it ended.
pub(crate) fn last_end(studio: &Studio, drive: DriveNumber) -> Option<(u64, ActionEnd)> {
    studio.hiperdrive().and_then(|own| own.moves.drive(drive)?.ended)
}

/// Returns whether an action has ended after `since` because it was no longer refreshed.
pub(crate) fn has_lapsed(studio: &Studio, drive: DriveNumber, since: Option<(u64, ActionEnd)>) -> bool {
    let end = last_end(studio, drive);
    end != since && matches!(end, Some((_, ActionEnd::Stale)))
}

/// Maximum number of attempts for an action that was not refreshed in time.
pub(crate) const ATTEMPTS: usize = 20;

/// Waits until a drive may move. Threads read the motion rules repeatedly, and a press before that is rejected.
#[track_caller]
pub(crate) fn wait_until_motion_allowed(desk: &mut Desk, drive: DriveNumber) {
    let began = Instant::now();
    while let Err(why) = unit(desk).may_move(drive) {
        assert!(
            began.elapsed() < LONG,
            "it may not move: {}\n{}",
            why.terminal_text(),
            crate::support::log(&desk.studio)
        );
        desk.studio.poll();
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// Makes a motor request and waits for a condition. If a busy computer delays the refresh for 250 ms, which ends the
/// motion, the request is repeated.
#[track_caller]
pub(crate) fn drive_until(
    desk: &mut Desk,
    motor: impl Fn(&HiperdriveDevice) -> MotorCommand,
    what: &str,
    condition: impl Fn(&Studio) -> bool,
) {
    act_until(desk, |own| Hiperdrive::Drive(motor(own)), what, condition);
}

/// Performs an action of the selected drive and waits for a condition, like [`drive_until`].
#[track_caller]
pub(crate) fn act_until(
    desk: &mut Desk,
    action: impl Fn(&HiperdriveDevice) -> Hiperdrive,
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
        desk.until("it stands", |studio| !studio.is_moving());
    }
    panic!("never: {what}: it has lapsed {ATTEMPTS} times");
}

/// Starts a long move of the displayed drive and waits until the drive moves.
#[track_caller]
pub(crate) fn start_long_move(desk: &mut Desk) {
    drive_until(
        desk,
        |_| MotorCommand::Move { target: 30_000_000 },
        "it moves",
        |studio| {
            let own = studio.hiperdrive().unwrap();
            own.state(own.drive()) == Some(State::Moving)
        },
    );
}

/// Returns the value of `look` while the selected drive moves. The motion and the observation are repeated if the
/// motion ends because it was not refreshed.
#[track_caller]
pub(crate) fn observe_while_moving<T>(desk: &mut Desk, mut look: impl FnMut(&mut Desk) -> T) -> T {
    let shown = unit(desk).drive();
    for _ in 0..ATTEMPTS {
        act(desk, Hiperdrive::SelectDrive(shown));
        wait_until_motion_allowed(desk, shown);
        start_long_move(desk);
        let before = last_end(&desk.studio, shown);
        let seen = look(desk);
        desk.studio.poll();
        if !has_lapsed(&desk.studio, shown, before) {
            return seen;
        }
        desk.until("it stands", |studio| !studio.is_moving());
    }
    panic!("it has lapsed {ATTEMPTS} times");
}

/// Returns the text IDs of all warnings except the one about a motion that was not refreshed.
pub(crate) fn warned(desk: &Desk) -> Vec<&'static str> {
    desk.notice_ids(Severity::Warning).into_iter().filter(|id| *id != "hd_end.stale").collect()
}

/// Refreshes the jog at every poll until a condition holds.
#[track_caller]
pub(crate) fn hold_until(desk: &mut Desk, what: &str, condition: impl Fn(&Desk) -> bool) {
    let began = Instant::now();
    while !condition(desk) {
        assert!(began.elapsed() < LONG, "never: {what}\n{}", crate::support::log(&desk.studio));
        drive(desk, MotorCommand::JogHold);
        desk.studio.poll();
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// Holds a jog pad until a condition holds. If a busy computer delays the refresh for 250 ms, the jog ends, and the pad
/// is pressed again after `prepare`. Any other end is a failure.
#[track_caller]
pub(crate) fn hold_pad_until(
    desk: &mut Desk,
    press: MotorCommand,
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
        drive(desk, MotorCommand::JogRelease);
        desk.until("it stands", |studio| !studio.is_moving());
        let end = last_end(&desk.studio, shown);
        assert!(end != before && matches!(end, Some((_, ActionEnd::Stale))), "never: {what}: {before:?}, then {end:?}");
    }
    panic!("never: {what}: it has lapsed {ATTEMPTS} times");
}
