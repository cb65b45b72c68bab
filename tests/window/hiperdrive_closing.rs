//! Tests of a window that is closed, or ended by the system, while a drive moves. First, the drive stops and is
//! switched off, and its connection is closed. Questions come after that (issue 21.1). The tests read the state from
//! the drive itself.

use crate::tabs::Tabs as _;
use std::time::{Duration, Instant};

use encoder_studio::app::Action;
use encoder_studio::devices::hiperdrive::procedures::dead_man::TargetState;
use encoder_studio::devices::hiperdrive::protocol::{Direction, RunEnd, State, StatusBit};
use encoder_studio::devices::hiperdrive::state::{Edit, HiperdriveAction as Hiperdrive, MotorCommand};
use encoder_studio::units::Moment;

use crate::hiperdrive::{ONE, act, drive, edit, number, unit};
use crate::hiperdrive_acts::{drive_until, start_long_move};
use crate::hiperdrive_motion::in_control;
use crate::support::{Desk, LONG};

/// Returns the state of the drive, whether it is at standstill, and whether a host holds the cyclic connection.
fn drive_state(desk: &Desk) -> (State, bool, bool) {
    let target = unit(desk).target.clone().unwrap();
    target.with_station(|station| {
        let status = station.drive(ONE).unwrap().actual_values(Moment::default()).status;
        (status.state(), status.is_set(StatusBit::Standstill), station.is_open(Moment::default()))
    })
}

fn moving() -> Desk {
    let mut desk = in_control("sim:");
    start_long_move(&mut desk);
    desk
}

#[track_caller]
fn wait_for_drive_release(desk: &Desk) {
    let began = Instant::now();
    while drive_state(desk).2 {
        assert!(began.elapsed() < LONG, "the connection is open");
        std::thread::sleep(Duration::from_millis(1));
    }
    // A fault of the watchdog would be visible here.
    assert_eq!((drive_state(desk).0, drive_state(desk).1), (State::NotReady, true));
}

/// Without edits, closing the window asks no question. It waits for the drive to stop, and nothing moves afterwards
/// (issue 21.1).
#[test]
fn closing_window_releases_drives_first() {
    for (closes, action) in [("closed", Action::Close), ("ended by the system", Action::Quit)] {
        let mut desk = moving();
        desk.act(action);
        assert!(desk.studio.question.is_none() && desk.studio.is_closing(), "{closes}");
        assert!(!desk.studio.can_close(), "{closes}: the drive is in hand");
        drive(&mut desk, MotorCommand::Move { target: 1 });
        desk.until("it may close", |studio| studio.can_close());
        wait_for_drive_release(&desk);
        assert!(!unit(&desk).moves.motion().unwrap().is_connected(), "{closes}");
        drive(&mut desk, MotorCommand::Lead(TargetState::Enabled));
        desk.settle();
        assert_eq!(drive_state(&desk).0, State::NotReady, "{closes}");
    }
}

/// The question about unsaved edits appears after the stop, and nothing resumes if the answer is no (issue 21.1).
#[test]
fn stops_drives_before_close_question() {
    let mut desk = moving();
    edit(&mut desk, Edit::Set(number(24), 7));
    desk.act(Action::Close);
    assert!(desk.studio.question.is_some() && !desk.studio.hiperdrive().unwrap().moves.is_motion_active());
    // The stop was requested before the question, so no frame needs to be drawn.
    let began = Instant::now();
    while !drive_state(&desk).1 {
        assert!(began.elapsed() < LONG, "it moves under the question");
        std::thread::sleep(Duration::from_millis(1));
    }
    desk.until("the window knows it", |studio| !studio.is_requested_motion_running());
    desk.act(Action::Escape);
    assert!(desk.studio.question.is_none());
    for _ in 0..300 {
        desk.studio.poll();
        std::thread::sleep(Duration::from_millis(1));
    }
    let (state, stands, open) = drive_state(&desk);
    assert_eq!((state, stands, open), (State::Enabled, true, true), "as it was stopped");
    desk.act(Action::Close);
    desk.act(Action::Confirm);
    desk.until("it may close", |studio| studio.can_close());
    wait_for_drive_release(&desk);
}

/// A termination signal closes the window without a question (issue 21.1).
#[test]
fn signal_closes_without_asking() {
    let mut desk = moving();
    edit(&mut desk, Edit::Set(number(24), 7));
    desk.act(Action::Close);
    assert!(desk.studio.question.is_some());
    desk.act(Action::Quit);
    assert!(desk.studio.question.is_none());
    desk.until("it may close", |studio| studio.can_close());
    wait_for_drive_release(&desk);
}

/// Drives are released even if the window is not updated, such as when the display hangs (issue 21.1).
#[test]
fn releases_drives_without_window() {
    let desk = moving();
    let brakes = desk.studio.drive_stop_handles();
    assert!(!brakes.is_done() && !brakes.has_begun());
    brakes.begin_stop();
    assert!(brakes.wait_for_disconnect(LONG) && brakes.has_begun());
    wait_for_drive_release(&desk);
    assert!(!brakes.wait_for_window(Duration::ZERO));
}

/// Closing a session stops its own drive and does not affect motion in other sessions. Closing the window waits for the
/// closed session (issue 21.1).
#[test]
fn closing_session_stops_motion() {
    let mut desk = in_control("sim:");
    let run = MotorCommand::Run { direction: Direction::Clockwise, end: RunEnd::RangeEnd };
    drive_until(
        &mut desk,
        |_| run,
        "it moves",
        |studio| studio.hiperdrive().unwrap().state(ONE) == Some(State::Moving),
    );
    let (target, id) = (unit(&desk).target.clone().unwrap(), unit(&desk).session.id);
    let other = desk.studio.devices().iter().find(|own| own.id() != id).map(|own| own.id());
    if let Some(other) = other {
        desk.act(Action::CloseSession(other));
        assert!(desk.studio.settings.tab == crate::tabs::HIPERDRIVE && unit(&desk).moves.is_motion_active());
    }
    desk.act(Action::CloseSession(id));
    desk.act(Action::Close);
    desk.until("it may close", |studio| studio.can_close());
    let (status, open) = target.with_station(|station| {
        (station.drive(ONE).unwrap().actual_values(Moment::default()).status, station.is_open(Moment::default()))
    });
    assert_eq!((status.state(), open), (State::NotReady, false));
}

/// Once control has been given up, closing the window does not have to wait (issue 21.1).
#[test]
fn window_without_control_closes_immediately() {
    let mut desk = in_control("sim:");
    act(&mut desk, Hiperdrive::Give);
    desk.until("it is given", |studio| {
        let own = studio.hiperdrive().unwrap();
        !own.moves.is_open() && own.session.is_ready()
    });
    desk.act(Action::Close);
    assert!(desk.studio.drive_stop_handles().is_done());
    desk.until("it may close", |studio| studio.can_close());
}
