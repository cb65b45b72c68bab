//! Tests of control over HIPERDRIVE drives through actions: loss of control, messages about it, and parameters that
//! another master changes meanwhile.

use crate::hiperdrive::command;
use crate::tabs::Tabs as _;
use encoder_studio::app::DeviceCommand;
use std::time::Duration;

use encoder_studio::app::{Action, ReviewAction, Severity, Studio, Text, connect};
use encoder_studio::devices::hiperdrive::procedures::dead_man::MotionLock;
use encoder_studio::devices::hiperdrive::protocol::{ErrorCode, State, Value};
use encoder_studio::devices::hiperdrive::state::axis::{AxisAction as Run, AxisButton};
use encoder_studio::devices::hiperdrive::state::{
    Edit, HiperdriveAction as Hiperdrive, HiperdriveDevice, MotorCommand,
};
use encoder_studio::units::Moment;

use crate::hiperdrive::{ONE, act, drive, edit, number, read, unit};
use crate::hiperdrive_acts::{drive_until, start_long_move};
use crate::hiperdrive_motion::in_control;
use crate::support::Desk;

/// Writes a value as another master would.
fn set(desk: &Desk, of: u16, value: i64) {
    let target = unit(desk).target.clone().unwrap();
    target.with_station(|station| station.write(Moment::default(), number(of), &Value::Number(value)).unwrap());
}

/// Stops the device's cyclic packets, while it still answers messages.
fn fall_silent(desk: &Desk) {
    unit(desk).target.clone().unwrap().with_station(|station| station.close(Moment::default()));
}

fn is_open(studio: &Studio) -> bool {
    studio.hiperdrive().unwrap().moves.is_open()
}

#[test]
fn lost_control_shows_reason() {
    let mut desk = in_control("sim:");
    // Nothing is requested from the device, and the loss is still reported.
    command(&mut desk, DeviceCommand::Poll(None));
    desk.settle();
    assert_eq!(unit(&desk).loss_reason(), None);
    fall_silent(&desk);
    desk.until("the loss is told", |studio| {
        let told = |text: &Text| text.id() == "hd_lost.silent";
        !is_open(studio) && studio.services.log.notices().any(|notice| notice.texts.iter().any(told))
    });
    desk.settle();
    assert_eq!(desk.notice_count("hd_lost.silent"), 1);
    assert_eq!(unit(&desk).loss_reason().unwrap().id(), "hd_lost.silent");
    drive(&mut desk, MotorCommand::Step { by: 64 });
    assert_eq!(desk.notice_ids(Severity::Warning), ["hd_lost.silent", "hd_refused.not_taken"]);
    desk.until("everything is read anew", |studio| {
        let own = studio.hiperdrive().unwrap();
        own.actual_values(ONE).is_some() && own.session.is_ready()
    });
    desk.settle();
    act(&mut desk, Hiperdrive::Take);
    desk.until("it is taken again", |studio| is_open(studio) && studio.hiperdrive().unwrap().session.is_ready());
    assert_eq!(unit(&desk).loss_reason(), None);
    act(&mut desk, Hiperdrive::Give);
    desk.until("it is given back", |studio| !is_open(studio));
    assert_eq!(unit(&desk).loss_reason(), None, "control is not lost");
}

#[test]
fn applies_limits_set_by_another_master() {
    let mut desk = in_control("sim:");
    set(&desk, 160, 65_536);
    desk.until("they are read", |studio| {
        let own = studio.hiperdrive().unwrap();
        own.limits(ONE) == Some((-33_488_896, 65_536)) && own.session.is_ready()
    });
    assert!(unit(&desk).moves.motion_locks(ONE).is_empty());
    drive(&mut desk, MotorCommand::Move { target: 65_537 });
    assert_eq!(desk.notice_ids(Severity::Warning), ["hd_refused.outside"]);
}

/// A reference set by another master must be read, because everything based on the old reference becomes invalid (issue
/// 21.6).
#[test]
fn reads_reference_set_by_another_master() {
    let mut desk = in_control("sim:");
    set(&desk, 198, 6400);
    desk.until("it is read", |studio| {
        let own = studio.hiperdrive().unwrap();
        own.parameter_value(ONE, 198) == Some(6400) && own.session.is_ready() && own.may_move(ONE).is_ok()
    });
    drive(&mut desk, MotorCommand::Move { target: 6400 });
    assert_eq!(desk.notice_ids(Severity::Warning), Vec::<String>::new());
}

#[test]
fn scale_by_another_master_locks_motion() {
    let mut desk = in_control("sim:");
    // 400 steps per turn instead of 65536.
    set(&desk, 154, 400);
    set(&desk, 156, 256);
    desk.until("it is locked", |studio| {
        studio.hiperdrive().unwrap().moves.motion_locks(ONE) == [MotionLock::LimitsUnconfirmed]
    });
    // Limits that were read before the change cannot be confirmed.
    drive(&mut desk, MotorCommand::ConfirmLimits(ONE));
    assert_eq!(desk.notice_ids(Severity::Warning), ["hd_lock.unread"], "the user is told why the button has no effect");
    desk.until("it is read", |studio| {
        let own = studio.hiperdrive().unwrap();
        own.session.is_ready()
            && (own.parameter_value(ONE, 154), own.parameter_value(ONE, 156)) == (Some(400), Some(256))
    });
    assert_eq!(unit(&desk).moves.motion_locks(ONE), [MotionLock::LimitsUnconfirmed]);
    drive(&mut desk, MotorCommand::Step { by: 4 });
    assert_eq!(desk.notice_ids(Severity::Warning), ["hd_lock.unread", "hd_lock.limits"]);
    // Another change before the confirmation keeps the numbers of the limits and moves them to other places again.
    set(&desk, 154, 100);
    desk.until("it is read again", |studio| {
        let own = studio.hiperdrive().unwrap();
        own.session.is_ready() && own.parameter_value(ONE, 154) == Some(100)
    });
    assert_eq!(unit(&desk).moves.motion_locks(ONE), [MotionLock::LimitsUnconfirmed]);
    desk.settle();
    drive(&mut desk, MotorCommand::ConfirmLimits(ONE));
    assert!(unit(&desk).moves.motion_locks(ONE).is_empty());
    drive_until(
        &mut desk,
        |_| MotorCommand::Step { by: 4 },
        "it moves",
        |studio| studio.hiperdrive().unwrap().moves.snapshot().drives.iter().any(|own| own.act > 0),
    );
}

#[test]
fn scale_change_found_by_save_locks_motion() {
    let mut desk = read("sim:");
    set(&desk, 154, 100);
    assert!(unit(&desk).moves.unconfirmed_drives().is_empty());
    let path = desk.outside.path("drive.ron");
    act(&mut desk, Hiperdrive::Save(path.clone()));
    desk.until("it is saved", |_| path.exists());
    assert!(unit(&desk).moves.unconfirmed_drives().contains(&ONE));
}

#[test]
fn prevents_motion_until_parameters_are_read() {
    let mut desk = read("sim:");
    act(&mut desk, Hiperdrive::Take);
    desk.until("the connection is open", |studio| is_open(studio) && studio.hiperdrive().unwrap().session.is_busy());
    drive(&mut desk, MotorCommand::Step { by: 64 });
    assert_eq!(desk.notice_ids(Severity::Warning), ["hd_lock.unread"]);
    desk.until("it is read", |studio| studio.hiperdrive().unwrap().session.is_ready());
    desk.until("it may move", |studio| studio.hiperdrive().unwrap().may_move(ONE).is_ok());
}

/// 4096 steps are a sixteenth of a turn (reference, section 4). Such a move ends with status 3E37h, or the same with
/// the acknowledge bit inverted (section 9).
#[test]
fn table_shows_live_values() {
    let mut desk = in_control("sim:");
    let shown = |desk: &Desk, of: u16| {
        let rows = unit(desk).rows(Some(ONE));
        rows.into_iter().find(|row| row.number == number(of)).unwrap().value.unwrap()
    };
    assert_eq!((shown(&desk, 107), shown(&desk, 104)), (Value::Number(0), Value::Number(0)));
    let to_4096 = |own: &HiperdriveDevice| MotorCommand::Step { by: 4096 - own.actual_values(ONE).unwrap().position };
    drive_until(&mut desk, to_4096, "it arrives", |studio| {
        let own = studio.hiperdrive().unwrap();
        !studio.is_moving() && own.actual_values(ONE).is_some_and(|own| own.position == 4096)
    });
    assert_eq!((shown(&desk, 107), shown(&desk, 104)), (Value::Number(4096), Value::Number(4096)));
    assert_eq!(unit(&desk).value(number(107)), Some(&Value::Number(0)), "as it was read");
    let target = unit(&desk).target.clone().unwrap();
    target
        .with_station(|station| station.drive(ONE).unwrap().inject_error(Moment::default(), ErrorCode::BLOCK_FORWARD));
    // A block in the forward direction is error 8301h, which is 33537 (reference, section 4).
    desk.until("its error is read", |studio| {
        let own = studio.hiperdrive().unwrap().drive_status(ONE);
        own.is_some_and(|own| own.buffer.first() == Some(&ErrorCode::BLOCK_FORWARD))
    });
    assert_eq!(shown(&desk, 108), Value::Number(33_537));
}

#[test]
fn discards_reports_received_before_loss() {
    let mut desk = in_control("sim:");
    start_long_move(&mut desk);
    fall_silent(&desk);
    desk.until("the loss is known", |studio| !is_open(studio));
    desk.until("nothing moves as far as is known", |studio| !studio.is_moving());
    desk.until("it is read anew", |studio| studio.hiperdrive().unwrap().actual_values(ONE).is_some());
    assert_ne!(unit(&desk).state(ONE), Some(State::Moving));
    desk.until("why it was lost is told", |studio| {
        studio.hiperdrive().unwrap().session.is_ready() && studio.services.log.current().is_some()
    });
    act(&mut desk, Hiperdrive::Take);
    desk.until("it is taken again", |studio| is_open(studio) && studio.hiperdrive().unwrap().session.is_ready());
    let standing = desk.studio.services.log.current().map(|own| own.texts.clone()).unwrap_or_default();
    assert!(standing.iter().all(|text| text.id() != "hd_lost.silent"), "{standing:?}");
}

#[test]
fn escape_does_not_end_polling() {
    let mut desk = in_control("sim:");
    assert!(unit(&desk).session.is_polling());
    desk.connect(connect::ConnectAction::Open);
    desk.act(Action::Escape);
    assert!(desk.studio.connect.is_none() && unit(&desk).session.is_polling(), "the dialog is closed");
    desk.act(Action::Escape);
    assert!(unit(&desk).session.is_polling() && is_open(&desk.studio));
    act(&mut desk, Hiperdrive::Give);
    desk.until("it is given back", |studio| !is_open(studio) && studio.hiperdrive().unwrap().session.is_ready());
    desk.act(Action::Escape);
    assert!(unit(&desk).session.is_polling(), "Esc applies to motion; the drives remain visible");
}

#[test]
fn stop_does_not_end_required_readings() {
    let mut desk = read("sim:");
    act(&mut desk, Hiperdrive::Take);
    desk.until("the connection is open", |studio| is_open(studio) && studio.hiperdrive().unwrap().session.is_busy());
    desk.act(Action::Stop);
    assert!(unit(&desk).session.is_polling(), "whoever has control goes on seeing");
    desk.until("it is read", |studio| studio.hiperdrive().unwrap().may_move(ONE).is_ok());
    assert!(unit(&desk).session.is_polling() && is_open(&desk.studio));
    // Cancelling a write does not end the polling either.
    desk.until("nothing runs", |studio| studio.hiperdrive().unwrap().session.is_ready());
    edit(&mut desk, Edit::Set(number(24), 7));
    command(&mut desk, DeviceCommand::Review);
    assert!(unit(&desk).session.review.is_some() && unit(&desk).session.is_busy());
    let id = unit(&desk).session.id;
    desk.act(Action::Review(id, ReviewAction::Close));
    assert!(unit(&desk).session.review.is_none() && unit(&desk).session.is_polling());
    set(&desk, 160, 65_536);
    desk.until("what rules it is still looked at", |studio| {
        studio.hiperdrive().unwrap().limits(ONE) == Some((-33_488_896, 65_536))
    });
}

#[test]
fn stopped_reading_names_missing_values() {
    // The replies are delayed so much that STOP comes before the first of them.
    let mut desk = in_control("sim:?fault=delay:15");
    act(&mut desk, Hiperdrive::Axis(Run::Begin));
    fall_silent(&desk);
    desk.until("everything is read anew", |studio| !is_open(studio) && studio.hiperdrive().unwrap().session.is_busy());
    desk.act(Action::Stop);
    desk.until("it has ended", |studio| studio.hiperdrive().unwrap().session.is_ready());
    desk.settle();
    let own = unit(&desk);
    assert!(own.session.is_ready(), "it does not begin again");
    assert_eq!(own.actual_values(ONE), None, "what was read before the loss");
    let asked = own.axis().unwrap().request(AxisButton::Do, &own.drive_facts(ONE));
    assert_eq!(asked.unwrap_err().id(), "hd_axis.unread", "there is nothing to wait for");
    command(&mut desk, DeviceCommand::Read);
    desk.until("it is read", |studio| studio.hiperdrive().unwrap().actual_values(ONE).is_some());
}

#[test]
fn reads_missing_values_after_releasing_control() {
    let mut desk = read("sim:");
    set(&desk, 160, 65_536);
    act(&mut desk, Hiperdrive::Take);
    desk.until("the connection is open", |studio| is_open(studio) && studio.hiperdrive().unwrap().session.is_busy());
    desk.act(Action::Stop);
    // The reading has ended, but the window has not received its result yet.
    std::thread::sleep(Duration::from_millis(200));
    act(&mut desk, Hiperdrive::Give);
    desk.until("it is given back", |studio| !is_open(studio));
    desk.until("it is read", |studio| {
        let own = studio.hiperdrive().unwrap();
        own.session.is_ready() && own.limits(ONE) == Some((-33_488_896, 65_536))
    });
}

#[test]
fn discards_positions_read_before_reconnect() {
    let mut desk = in_control("sim:");
    command(&mut desk, DeviceCommand::Reconnect);
    desk.until("it is connected", |studio| studio.hiperdrive().unwrap().session.live_session().is_some());
    assert!(unit(&desk).survey.is_some() && unit(&desk).session.is_busy());
    assert_eq!(unit(&desk).actual_values(ONE), None);
    desk.until("it is read", |studio| studio.hiperdrive().unwrap().actual_values(ONE).is_some());
}
