//! Tests of drives that the user moves from the window: the start of a motion, its refresh, and every way in which it
//! ends. Standstill is read from the drive itself.

use crate::hiperdrive::command;
use crate::tabs::Tabs as _;
use encoder_studio::app::DeviceCommand;
use std::time::{Duration, Instant};

use encoder_studio::app::{Action, Language, LibraryAction, Severity, Studio, connect};
use encoder_studio::devices::hiperdrive::procedures::dead_man::{MotionLock, SpeedTorque, TargetState};
use encoder_studio::devices::hiperdrive::protocol::{
    Direction, ErrorCode, Percent, RunEnd, State, StatusBit, StatusWord, Value,
};
use encoder_studio::devices::hiperdrive::state::{
    Edit, EditFinding, HiperdriveAction as Hiperdrive, HiperdriveDevice, MotorCommand,
};
use encoder_studio::units::Moment;

use crate::hiperdrive::{ONE, act, drive, edit, number, read, unit, write};
use crate::hiperdrive_acts::{drive_until, hold_pad_until, hold_until, observe_while_moving, start_long_move, warned};
use crate::support::{Desk, LONG};

/// Returns the status word of the drive itself, independent of the window.
fn status(desk: &Desk) -> StatusWord {
    let target = unit(desk).target.clone().unwrap();
    // Only sent packets advance the time of the virtual drive.
    target.with_station(|station| station.drive(ONE).unwrap().actual_values(Moment::default()).status)
}

fn is_at_standstill(desk: &Desk) -> bool {
    status(desk).is_set(StatusBit::Standstill)
}

/// Connects to a virtual device and takes control of its drives.
pub(crate) fn in_control(link: &str) -> Desk {
    let mut desk = read(link);
    act(&mut desk, Hiperdrive::Take);
    desk.until("the connection is open", |studio| {
        let own = studio.hiperdrive().unwrap();
        own.moves.is_open()
            && own.session.is_ready()
            && own.moves.drive(ONE).is_some_and(|own| own.actual.status.is_present())
            // The settings are read on a thread.
            && !matches!(own.may_move(ONE), Err(why) if why.id() == "hd_lock.settings")
    });
    desk
}

fn moves(desk: &Desk) -> bool {
    unit(desk).state(ONE) == Some(State::Moving)
}

/// Holds a jog pad until the drive moves.
#[track_caller]
fn jog(desk: &mut Desk) {
    let press = MotorCommand::JogPress { direction: Direction::Clockwise, repeated: false };
    hold_pad_until(desk, press, "it moves", |_| {}, moves);
}

/// Waits for standstill without polling the window, because the stop has already been requested.
#[track_caller]
fn wait_for_standstill(desk: &Desk) {
    let began = Instant::now();
    while !is_at_standstill(desk) {
        assert!(began.elapsed() < LONG, "it still moves");
        std::thread::sleep(Duration::from_millis(1));
    }
}

#[test]
fn held_jog_turns_drive() {
    let mut desk = in_control("sim:");
    assert!(!desk.studio.is_moving() && unit(&desk).may_move(ONE).is_ok());
    assert_eq!(unit(&desk).moves.jog_speed_torque(ONE), SpeedTorque::DEFAULT_JOG);
    jog(&mut desk);
    assert!(desk.studio.is_moving() && !is_at_standstill(&desk));
    let sent = unit(&desk).moves.last_setpoint(ONE).unwrap();
    assert_eq!((sent.speed.get(), sent.torque.get()), (10, 25));
    drive(&mut desk, MotorCommand::JogRelease);
    assert!(!unit(&desk).moves.is_held(), "at once");
    wait_for_standstill(&desk);
    desk.until("the window knows it", |studio| !studio.is_moving());
    let where_it_stands = unit(&desk).actual_values(ONE).unwrap().position;
    assert!(where_it_stands != 0);
    // A late refresh and a key repeat start nothing.
    drive(&mut desk, MotorCommand::JogHold);
    drive(&mut desk, MotorCommand::JogPress { direction: Direction::Clockwise, repeated: true });
    desk.settle();
    assert!(is_at_standstill(&desk) && !unit(&desk).moves.is_held());
    assert!(warned(&desk).is_empty());
}

#[test]
fn stale_jog_ends() {
    let mut desk = in_control("sim:");
    jog(&mut desk);
    let before = desk.notice_count("hd_end.stale");
    // The window is still updated, but the jog is no longer refreshed.
    desk.until("it stands", |studio| !studio.is_moving());
    assert!(is_at_standstill(&desk) && !unit(&desk).moves.is_held());
    assert_eq!(desk.notice_count("hd_end.stale"), before + 1);
    drive(&mut desk, MotorCommand::JogHold);
    desk.settle();
    assert!(is_at_standstill(&desk), "an act that has ended does not begin again");
}

#[test]
fn frozen_window_stops_motion() {
    let mut desk = in_control("sim:");
    start_long_move(&mut desk);
    wait_for_standstill(&desk);
    assert!(status(&desk).is_set(StatusBit::Standstill) && !status(&desk).is_set(StatusBit::TargetReached));
}

#[test]
fn hiding_jog_pad_ends_jog() {
    type Cover = fn(&mut Desk);
    let covers: [(&str, Cover); 15] = [
        ("focus", |desk| desk.act(Action::ReleaseMotion)),
        ("tab", |desk| desk.act(Action::ShowTab(crate::tabs::BISS))),
        ("dialog", |desk| desk.connect(connect::ConnectAction::Open)),
        ("profile library", |desk| desk.act(Action::Library(LibraryAction::Open))),
        // The jog ends with the request for the dialog, because the system may take half a second to show it.
        ("file dialog", |desk| desk.act(Action::AskOpen)),
        ("file dialog of the device", |desk| command(desk, DeviceCommand::AskSave)),
        ("question", |desk| {
            edit(desk, Edit::Set(number(24), 7));
            let id = unit(desk).session.id;
            desk.act(Action::CloseSession(id));
        }),
        ("window", |desk| desk.act(Action::Close)),
        ("review", |desk| {
            edit(desk, Edit::Set(number(24), 7));
            command(desk, DeviceCommand::Review);
        }),
        ("stop", |desk| desk.act(Action::StopMotion)),
        ("stop all", |desk| desk.act(Action::Stop)),
        ("escape", |desk| desk.act(Action::Escape)),
        ("its own stop", |desk| drive(desk, MotorCommand::Stop)),
        ("give", |desk| act(desk, Hiperdrive::Give)),
        ("disconnect", |desk| command(desk, DeviceCommand::Reconnect)),
    ];
    for (what, cover) in covers {
        let mut desk = in_control("sim:");
        let target = unit(&desk).target.clone().unwrap();
        jog(&mut desk);
        cover(&mut desk);
        let held = desk
            .studio
            .devices()
            .iter()
            .filter_map(|own| own.get::<encoder_studio::devices::hiperdrive::state::HiperdriveDevice>())
            .any(|own| own.moves.is_held());
        assert!(!held, "{what}");
        let began = Instant::now();
        while !target
            .with_station(|station| station.drive(ONE).unwrap().actual_values(Moment::default()))
            .status
            .is_set(StatusBit::Standstill)
        {
            assert!(began.elapsed() < LONG, "{what}: it still moves");
            std::thread::sleep(Duration::from_millis(1));
        }
    }
}

#[test]
fn move_continues_in_another_tab() {
    let mut desk = in_control("sim:");
    let goes_on = observe_while_moving(&mut desk, |desk| {
        desk.act(Action::ShowTab(crate::tabs::BISS));
        desk.act(Action::ReleaseMotion);
        for _ in 0..400 {
            desk.studio.poll();
            std::thread::sleep(Duration::from_millis(1));
        }
        desk.studio.is_moving() && desk.studio.has_drives()
    });
    assert!(goes_on, "{}", crate::support::log(&desk.studio));
    desk.act(Action::Escape);
    wait_for_standstill(&desk);
    desk.until("the window knows it", |studio| !studio.is_moving());
    assert!(desk.studio.selected_device().is_none() || desk.studio.settings.tab == crate::tabs::BISS);
}

#[test]
fn rejects_target_beyond_limits() {
    let mut desk = in_control("sim:");
    let effort = SpeedTorque { speed: Percent::FULL, torque: Percent::FULL };
    drive(&mut desk, MotorCommand::MoveEffort(effort));
    drive_until(
        &mut desk,
        |_| MotorCommand::Move { target: 4096 },
        "it arrives",
        |studio| {
            let own = studio.hiperdrive().unwrap();
            own.current_or_last_request(ONE).is_some_and(|said| said.words.id() == "hd_end.arrived")
        },
    );
    assert_eq!(unit(&desk).actual_values(ONE).unwrap().position, 4096);
    let back = |own: &HiperdriveDevice| MotorCommand::Step { by: -own.actual_values(ONE).unwrap().position };
    let is_back = |studio: &Studio| studio.hiperdrive().unwrap().actual_values(ONE).unwrap().position == 0;
    drive_until(&mut desk, back, "it is back", is_back);
    desk.until("it stands", |studio| !studio.is_moving());
    // 511 turns are 33 488 896 steps, so this target is outside the limits.
    drive(&mut desk, MotorCommand::Move { target: 33_488_897 });
    assert_eq!(warned(&desk), ["hd_refused.outside"]);
    drive(&mut desk, MotorCommand::Run { direction: Direction::Clockwise, end: RunEnd::Endless });
    assert_eq!(warned(&desk).last(), Some(&"hd_refused.endless"));
    assert!(unit(&desk).check_can_allow_endless_run(ONE).is_ok(), "it can be switched on");
    drive(&mut desk, MotorCommand::Expert(true));
    assert!(unit(&desk).check_can_run_endlessly(ONE).is_ok(), "factory limits and scaling");
    desk.settle();
    assert!(is_at_standstill(&desk));
    // Each endless run must be allowed again.
    let run = |_: &HiperdriveDevice| MotorCommand::Run { direction: Direction::Clockwise, end: RunEnd::Endless };
    drive_until(&mut desk, run, "it runs", |studio| {
        studio.hiperdrive().unwrap().actual_values(ONE).unwrap().position > 0
    });
    assert!(unit(&desk).moves.allows_endless_run(ONE), "while it runs");
    drive(&mut desk, MotorCommand::Stop);
    desk.until("it stands", |studio| !studio.is_moving());
    assert!(!unit(&desk).moves.allows_endless_run(ONE), "the run has ended");
    drive(&mut desk, MotorCommand::Run { direction: Direction::Clockwise, end: RunEnd::Endless });
    assert_eq!(warned(&desk).last(), Some(&"hd_refused.endless"));
}

/// A turn has 65,536 steps by default. At 25 % of 35 rpm (parameter 166), 35 turns take 4 minutes.
#[test]
fn estimates_distance_and_duration() {
    let desk = in_control("sim:");
    assert_eq!(unit(&desk).actual_values(ONE).unwrap().position, 0);
    let estimate = unit(&desk).move_estimate(35 * 65_536).unwrap();
    assert!(estimate.to_string_in(Language::English).ends_with(", about 4 min 0 s"), "{estimate:?}");
    assert_eq!(
        unit(&desk).move_estimate(-35 * 65_536).unwrap().to_string_in(Language::German).split_once(", ").unwrap().1,
        "etwa 4 min 0 s"
    );
}

#[test]
fn requests_states_and_acknowledges_fault() {
    let mut desk = in_control("sim:");
    assert_eq!(unit(&desk).reachable_states(ONE), [State::Ready]);
    drive_until(
        &mut desk,
        |_| MotorCommand::Lead(TargetState::Enabled),
        "it is enabled",
        |studio| studio.hiperdrive().unwrap().state(ONE) == Some(State::Enabled),
    );
    assert!(unit(&desk).reachable_states(ONE).contains(&State::Operational));
    jog(&mut desk);
    let target = unit(&desk).target.clone().unwrap();
    let blocked = ErrorCode::BLOCK_FORWARD;
    target.with_station(|station| station.drive(ONE).unwrap().inject_error(Moment::default(), blocked));
    hold_until(&mut desk, "the fault is seen", |desk| unit(desk).state(ONE) == Some(State::Fault));
    desk.until("its error is read", |studio| {
        let own = studio.hiperdrive().unwrap().drive_status(ONE);
        own.is_some_and(|own| own.buffer.first() == Some(&blocked))
    });
    assert!(!unit(&desk).moves.is_held());
    assert_eq!(unit(&desk).may_move(ONE).unwrap_err().id(), "hd_refused.fault");
    assert_eq!(unit(&desk).reachable_states(ONE), [State::Locked]);
    drive_until(
        &mut desk,
        |_| MotorCommand::Acknowledge,
        "it is ready",
        |studio| studio.hiperdrive().unwrap().state(ONE) == Some(State::Ready),
    );
}

#[test]
fn locks_name_remedy() {
    let mut desk = in_control("sim:?hub=4&drives=1");
    assert_eq!(unit(&desk).moves.motion_locks(ONE), [MotionLock::NotRequested], "as a hub comes from the factory");
    drive(&mut desk, MotorCommand::Step { by: 64 });
    assert_eq!(desk.notice_ids(Severity::Warning), ["hd_lock.not_requested"]);
    let mut desk = read("sim:");
    edit(&mut desk, Edit::Set(number(186), 255));
    assert!(matches!(unit(&desk).findings()[..], [EditFinding::NoTimeout { .. }]));
    write(&mut desk);
    assert_eq!(unit(&desk).moves.motion_locks(ONE), [MotionLock::NoTimeout]);
}

#[test]
fn hiding_panel_ends_run() {
    let mut desk = in_control("sim:");
    let run = MotorCommand::Run { direction: Direction::Clockwise, end: RunEnd::RangeEnd };
    drive_until(&mut desk, |_| run, "it runs", |studio| studio.hiperdrive().unwrap().state(ONE) == Some(State::Moving));
    desk.act(Action::ShowTab(crate::tabs::BISS));
    wait_for_standstill(&desk);
    desk.until("the window knows it", |studio| !studio.is_moving());
}

#[test]
fn reads_limits_before_motion() {
    let mut desk = read("sim:");
    let target = unit(&desk).target.clone().unwrap();
    let set = |number_: u16, value: i64| {
        target
            .with_station(|station| station.write(Moment::default(), number(number_), &Value::Number(value)).unwrap());
    };
    set(158, -65_536);
    set(160, 65_536);
    assert_eq!(unit(&desk).limits(ONE), Some((-33_488_896, 33_488_896)), "as they were read");
    act(&mut desk, Hiperdrive::Take);
    desk.until("they are read", |studio| {
        let own = studio.hiperdrive().unwrap();
        own.moves.is_open() && own.limits(ONE) == Some((-65_536, 65_536)) && own.session.is_ready()
    });
    assert!(unit(&desk).check_can_allow_endless_run(ONE).is_err(), "they are not the factory's");
    drive(&mut desk, MotorCommand::Move { target: 65_537 });
    assert_eq!(desk.notice_ids(Severity::Warning), ["hd_refused.outside"]);
}

/// The pad that leads further out is blocked and shows the reason. The user can permit it for one press at a time, at
/// 10 % speed and 25 % torque (issue 21.4).
#[test]
fn enables_only_inward_pad_outside_limits() {
    let mut desk = in_control("sim:?position=33488896&defect=runs-on");
    let target = unit(&desk).target.clone().unwrap();
    target.with_station(|station| station.drive(ONE).unwrap().turn_by_hand(Moment::default(), 20_000.0));
    desk.until("it is outside", |studio| {
        let own = studio.hiperdrive().unwrap();
        own.out_of_range_position(ONE).is_some() && own.session.is_ready() && own.may_move(ONE).is_ok()
    });
    let (up, down) = (Direction::Clockwise, Direction::Counterclockwise);
    let own = unit(&desk);
    assert_eq!(own.outside_limits_text(ONE).unwrap().id(), "hd_outside.words");
    assert_eq!(own.check_can_jog(ONE, up).unwrap_err().id(), "hd_refused.outward");
    assert!(own.check_can_jog(ONE, down).is_ok());
    drive(&mut desk, MotorCommand::JogPress { direction: up, repeated: false });
    desk.studio.poll();
    assert!(is_at_standstill(&desk) && !unit(&desk).moves.is_held(), "nothing begins");
    for _ in 0..2 {
        let free = |desk: &mut Desk| {
            drive(desk, MotorCommand::AllowOutward(up));
            assert!(unit(desk).check_can_jog(ONE, up).is_ok() && !unit(desk).can_enable_outward_jog(ONE, up));
            drive(desk, MotorCommand::JogEffort(SpeedTorque { speed: Percent::FULL, torque: Percent::FULL }));
        };
        let press = MotorCommand::JogPress { direction: up, repeated: false };
        hold_pad_until(&mut desk, press, "it moves out", free, moves);
        let sent = unit(&desk).moves.last_setpoint(ONE).unwrap();
        assert_eq!((sent.speed.get(), sent.torque.get()), (10, 25));
        assert!(unit(&desk).check_can_jog(ONE, up).is_ok(), "its pad stays enabled while it is held");
        drive(&mut desk, MotorCommand::JogRelease);
        desk.until("it stands", |studio| {
            let own = studio.hiperdrive().unwrap();
            own.state(ONE) != Some(State::Moving) && !own.moves.is_motion_active()
        });
        assert!(unit(&desk).check_can_jog(ONE, up).is_err(), "freed for one press");
    }
    // A permission ends with a stop, and when another page of the window is shown.
    drive(&mut desk, MotorCommand::AllowOutward(up));
    desk.act(Action::StopMotion);
    assert!(unit(&desk).check_can_jog(ONE, up).is_err());
    drive(&mut desk, MotorCommand::AllowOutward(up));
    desk.act(Action::ShowTab(crate::tabs::SSI));
    desk.act(Action::ShowTab(crate::tabs::HIPERDRIVE));
    assert!(unit(&desk).check_can_jog(ONE, up).is_err());
}

/// Only status bit 15 reports a position outside the limits, so the way back is unknown. Nothing moves unless the user
/// permits a pad for one press (issue 21.4).
#[test]
fn bit_15_alone_blocks_both_pads() {
    let mut desk = in_control("sim:?defect=says-outside");
    desk.until("what it says is known", |studio| {
        let own = studio.hiperdrive().unwrap();
        own.out_of_range_position(ONE).is_some() && own.session.is_ready() && own.may_move(ONE).is_ok()
    });
    let (up, down) = (Direction::Clockwise, Direction::Counterclockwise);
    assert_eq!(unit(&desk).outside_limits_text(ONE).unwrap().id(), "hd_outside.unclear");
    for (way, other) in [(up, down), (down, up)] {
        for own in [up, down] {
            assert_eq!(unit(&desk).check_can_jog(ONE, own).unwrap_err().id(), "hd_refused.unclear", "{own:?}");
            assert!(unit(&desk).is_blocked(ONE, own), "{own:?}");
        }
        let free = |desk: &mut Desk| {
            drive(desk, MotorCommand::AllowOutward(way));
            assert!(unit(desk).check_can_jog(ONE, way).is_ok() && unit(desk).check_can_jog(ONE, other).is_err());
            drive(desk, MotorCommand::JogEffort(SpeedTorque { speed: Percent::FULL, torque: Percent::FULL }));
        };
        let press = MotorCommand::JogPress { direction: way, repeated: false };
        hold_pad_until(&mut desk, press, "it moves", free, moves);
        let sent = unit(&desk).moves.last_setpoint(ONE).unwrap();
        assert_eq!((sent.speed.get(), sent.torque.get()), (10, 25));
        drive(&mut desk, MotorCommand::JogRelease);
        desk.until("it stands", |studio| {
            let own = studio.hiperdrive().unwrap();
            own.state(ONE) != Some(State::Moving) && !own.moves.is_motion_active()
        });
    }
    desk.studio.poll();
    drive(&mut desk, MotorCommand::Move { target: 65_536 });
    assert!(
        desk.notice_ids(Severity::Warning).contains(&"hd_refused.unclear"),
        "{:?}",
        desk.notice_ids(Severity::Warning)
    );
    assert!(is_at_standstill(&desk));
}

/// Unreadable settings may contain a motion lock, so nothing moves until they have been read (issue 21.11).
#[test]
fn unreadable_settings_lock_motion() {
    let mut desk = in_control("sim:");
    let path = desk.outside.store().settings_path();
    let _ = std::fs::remove_file(&path);
    // A symbolic link to itself cannot be read.
    std::os::unix::fs::symlink(&path, &path).unwrap();
    desk.until("nothing may move", |studio| {
        studio.hiperdrive().unwrap().may_move(ONE).is_err_and(|why| why.id() == "hd_lock.settings")
    });
    std::fs::remove_file(&path).unwrap();
    desk.until("it may move again", |studio| studio.hiperdrive().unwrap().may_move(ONE).is_ok());
}
