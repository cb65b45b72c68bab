//! Tests of a window that is operated over a remote desktop. Motion that continues until it is stopped ends, and cannot
//! be started.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use encoder_studio::app::{Action, Studio, StudioEnvironment, connect};
use encoder_studio::devices::hiperdrive::protocol::{Direction, RunEnd, State};
use encoder_studio::devices::hiperdrive::state::{HiperdriveAction as Hiperdrive, MotorCommand};

use crate::hiperdrive::{ONE, act, drive, unit, until_read};
use crate::hiperdrive_acts::{drive_until, hold_pad_until, warned};
use crate::screen::Screen;
use crate::support::{Desk, Outside};
use crate::tabs::Tabs as _;

const PRESS: MotorCommand = MotorCommand::JogPress { direction: Direction::Clockwise, repeated: false };

/// Starts the application with simulated remote operation.
fn studio(outside: &Outside, remote: &Arc<AtomicBool>) -> Studio {
    let remote = remote.clone();
    let is_remote = Arc::new(move || remote.load(Ordering::SeqCst));
    Studio::new(StudioEnvironment { is_remote, ..outside.world() }, Arc::new(|| {}))
}

#[test]
fn remote_session_ends_jog() {
    let remote = Arc::new(AtomicBool::default());
    let outside = Outside::new("");
    let mut desk = Desk { studio: studio(&outside, &remote), outside };
    desk.act(Action::ShowTab(crate::tabs::HIPERDRIVE));
    desk.open("sim:");
    until_read(&mut desk);
    act(&mut desk, Hiperdrive::Take);
    desk.until("it may move", |studio| studio.hiperdrive().unwrap().may_move(ONE).is_ok());
    hold_pad_until(&mut desk, PRESS, "it moves", |_| {}, |desk| unit(desk).state(ONE) == Some(State::Moving));

    remote.store(true, Ordering::SeqCst);
    desk.studio.poll();
    assert!(!unit(&desk).moves.is_held(), "at once");
    drive(&mut desk, MotorCommand::JogHold);
    desk.until("it stands", |studio| !studio.is_moving());

    desk.until("it may move", |studio| studio.hiperdrive().unwrap().may_move(ONE).is_ok());
    for motor in [PRESS, MotorCommand::Run { direction: Direction::Clockwise, end: RunEnd::RangeEnd }] {
        drive(&mut desk, motor);
        assert_eq!(unit(&desk).check_can_move_until_stopped(ONE).unwrap_err().id(), "hd_refused.remote");
        assert!(warned(&desk).contains(&"hd_refused.remote") && !unit(&desk).moves.is_motion_active());
    }
    // A move to a target ends by itself, so it is allowed.
    let moves = |studio: &Studio| studio.hiperdrive().unwrap().state(ONE) == Some(State::Moving);
    drive_until(&mut desk, |_| MotorCommand::Move { target: 30_000_000 }, "it moves", moves);

    remote.store(false, Ordering::SeqCst);
    desk.until("it may be jogged", |studio| studio.hiperdrive().unwrap().check_can_move_until_stopped(ONE).is_ok());
}

#[test]
fn panel_explains_locked_jog() {
    let (outside, remote) = (Outside::new(""), Arc::new(AtomicBool::new(true)));
    let studio = studio(&outside, &remote);
    let mut screen = Screen::of(outside, studio, [1280.0, 800.0]);
    screen.act(Action::ShowTab(crate::tabs::HIPERDRIVE));
    screen.act(Action::Connect(connect::ConnectAction::Open));
    screen.act(Action::Connect(connect::ConnectAction::Use("sim:".to_owned())));
    screen.act(Action::Connect(connect::ConnectAction::Connect));
    screen.until("it is read", |studio| {
        studio.hiperdrive().is_some_and(|own| own.survey.is_some() && own.session.is_ready())
    });
    let id = screen.studio().hiperdrive().unwrap().session.id;
    screen.act(Action::device(id, Hiperdrive::Take));
    screen.until("it may move", |studio| studio.hiperdrive().unwrap().may_move(ONE).is_ok());
    screen.steps();
    assert!(!screen.is_enabled("hd_jog.up") && !screen.is_enabled("hd_jog.down"));
    assert!(screen.shows(&screen.say("hd_refused.remote")));
    remote.store(false, Ordering::SeqCst);
    screen.steps();
    assert!(screen.is_enabled("hd_jog.up") && !screen.shows(&screen.say("hd_refused.remote")));
}
