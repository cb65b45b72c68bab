//! Tests of the individual drives of a hub: text typed for a drive, messages about it, and its motion while another
//! drive is selected.

use crate::tabs::Tabs as _;
use egui::accesskit::Role;
use egui_kittest::Node;
use egui_kittest::kittest::{AccessKitNode, Queryable};
use encoder_studio::app::{Action, Language, Severity, Studio};
use encoder_studio::devices::hiperdrive::procedures::dead_man::{Phase, SpeedTorque, TargetState};
use encoder_studio::devices::hiperdrive::protocol::{Direction, DriveNumber, ErrorCode, Percent, RunEnd, State};
use encoder_studio::devices::hiperdrive::state::explain;
use encoder_studio::devices::hiperdrive::state::{HiperdriveAction as Hiperdrive, HiperdriveDevice, MotorCommand};
use encoder_studio::units::Moment;

use crate::hiperdrive::{ONE, act, drive, unit};
use crate::hiperdrive_acts::{
    drive_until, has_lapsed, last_end, observe_while_moving, start_long_move, wait_until_motion_allowed, warned,
};
use crate::hiperdrive_motion::in_control;
use crate::screen::Screen;

const HUB: &str = "sim:?hub=4&drives=1,1&requested=1";

fn two() -> DriveNumber {
    DriveNumber::new(2).unwrap()
}

fn percent(percent: u8) -> Percent {
    Percent::new(percent).unwrap()
}

fn moves(studio: &Studio, drive: DriveNumber) -> bool {
    studio.hiperdrive().unwrap().state(drive) == Some(State::Moving)
}

/// One drive's speed, torque and *Endless* setting do not apply to another drive (issue 21.7).
#[test]
fn settings_apply_to_one_drive() {
    let mut desk = in_control(HUB);
    let slow = SpeedTorque { speed: percent(7), torque: percent(50) };
    drive(&mut desk, MotorCommand::MoveEffort(slow));
    drive(&mut desk, MotorCommand::JogEffort(slow));
    drive(&mut desk, MotorCommand::Expert(true));
    act(&mut desk, Hiperdrive::SelectDrive(two()));
    wait_until_motion_allowed(&mut desk, two());
    let moves = &unit(&desk).moves;
    assert_eq!(
        (moves.move_speed_torque(two()), moves.jog_speed_torque(two())),
        (SpeedTorque::DEFAULT_MOVE, SpeedTorque::DEFAULT_JOG)
    );
    assert_eq!((moves.allows_endless_run(ONE), moves.allows_endless_run(two())), (true, false));
    drive(&mut desk, MotorCommand::Run { direction: Direction::Clockwise, end: RunEnd::Endless });
    assert_eq!(desk.notice_ids(Severity::Warning), ["hd_refused.endless"]);
    let to_64 =
        |own: &HiperdriveDevice| MotorCommand::Step { by: 64 - own.actual_values(own.drive()).unwrap().position };
    drive_until(&mut desk, to_64, "it has been sent", |studio| {
        studio.hiperdrive().unwrap().moves.last_setpoint(two()).is_some_and(|own| own.target == 64)
    });
    let sent = unit(&desk).moves.last_setpoint(two()).unwrap();
    assert_eq!((sent.speed.get(), sent.torque.get()), (25, 100), "as a step usually is");
    act(&mut desk, Hiperdrive::SelectDrive(ONE));
    assert_eq!((unit(&desk).moves.move_speed_torque(ONE), unit(&desk).moves.jog_speed_torque(ONE)), (slow, slow));
}

/// A second motion is rejected with a message and does not end a running one, on any drive (issue 21.7).
#[test]
fn second_motion_waits_for_first() {
    let mut desk = in_control(HUB);
    wait_until_motion_allowed(&mut desk, ONE);
    // The second request comes before the drive itself has reported its motion.
    drive(&mut desk, MotorCommand::Move { target: 30_000_000 });
    drive(&mut desk, MotorCommand::Step { by: 64 });
    assert_eq!(desk.notice_ids(Severity::Warning), ["hd_refused.still_moves"]);
    drive(&mut desk, MotorCommand::Stop);
    desk.until("it stands", |studio| !studio.is_moving());
    let told = observe_while_moving(&mut desk, |desk| {
        let before = warned(desk).len();
        drive(desk, MotorCommand::Step { by: 64 });
        drive(desk, MotorCommand::Move { target: 0 });
        drive(desk, MotorCommand::Run { direction: Direction::Clockwise, end: RunEnd::RangeEnd });
        warned(desk).split_off(before)
    });
    assert_eq!(told, ["hd_refused.still_moves"; 3]);
    drive(&mut desk, MotorCommand::Stop);
    desk.until("it stands", |studio| !studio.is_moving());
    let seen = observe_while_moving(&mut desk, |desk| {
        act(desk, Hiperdrive::SelectDrive(two()));
        desk.until("the other one is read", |studio| {
            studio.hiperdrive().unwrap().moves.limits(two()).is_some_and(|own| own.limits().is_some())
        });
        let before = warned(desk).len();
        for motor in [
            MotorCommand::Step { by: 64 },
            MotorCommand::JogPress { direction: Direction::Clockwise, repeated: false },
            MotorCommand::Lead(TargetState::Ready),
            MotorCommand::Acknowledge,
        ] {
            drive(desk, motor);
        }
        let told = warned(desk).split_off(before);
        desk.settle();
        (told, moves(&desk.studio, ONE), unit(desk).moving_drives())
    });
    assert_eq!(seen, (vec!["hd_refused.other_moves"; 4], true, vec![ONE]), "it goes on");
    act(&mut desk, Hiperdrive::SelectDrive(two()));
    drive(&mut desk, MotorCommand::Stop);
    desk.until("it stands", |studio| !studio.is_moving());
    wait_until_motion_allowed(&mut desk, two());
    let to_64 = |own: &HiperdriveDevice| MotorCommand::Step { by: 64 - own.actual_values(two()).unwrap().position };
    drive_until(&mut desk, to_64, "now it may", |studio| {
        studio.hiperdrive().unwrap().actual_values(two()).is_some_and(|own| own.position == 64)
    });
}

/// A request to another drive does not discard a paused move (issue 21.7).
#[test]
fn paused_move_survives_request_to_second_drive() {
    let mut desk = in_control(HUB);
    wait_until_motion_allowed(&mut desk, ONE);
    let seen = observe_while_moving(&mut desk, |desk| {
        let before = last_end(&desk.studio, ONE);
        let lapsed = |studio: &Studio| has_lapsed(studio, ONE, before);
        drive(desk, MotorCommand::Pause);
        desk.until("it waits", |studio| {
            let phase = studio.hiperdrive().unwrap().moves.phase(ONE);
            matches!(phase, Some(Phase::Paused { .. })) || lapsed(studio)
        });
        act(desk, Hiperdrive::SelectDrive(two()));
        let told = warned(desk).len();
        drive(desk, MotorCommand::Lead(TargetState::Ready));
        let told = warned(desk).split_off(told);
        act(desk, Hiperdrive::SelectDrive(ONE));
        wait_until_motion_allowed(desk, ONE);
        drive(desk, MotorCommand::Resume);
        desk.until("it goes on", |studio| moves(studio, ONE) || lapsed(studio));
        (told, moves(&desk.studio, ONE))
    });
    assert_eq!(seen, (vec!["hd_refused.other_moves"], true));
    drive(&mut desk, MotorCommand::Stop);
    desk.until("it stands", |studio| !studio.is_moving());
}

/// Messages include the drive number on a hub. An adapter has only one drive, which needs no number (issue 21.7).
#[test]
fn messages_name_drive() {
    for (link, own, named) in [(HUB, two(), Some("drive 2")), ("sim:", ONE, None)] {
        let mut desk = in_control(link);
        act(&mut desk, Hiperdrive::SelectDrive(own));
        wait_until_motion_allowed(&mut desk, own);
        start_long_move(&mut desk);
        let target = unit(&desk).target.clone().unwrap();
        target.with_station(|station| {
            station.drive(own).unwrap().inject_error(Moment::default(), ErrorCode::BLOCK_FORWARD)
        });
        desk.until("the fault is told", |studio| {
            studio.services.log.notices().any(|one| one.texts[0].id() == "hd_end.fault")
        });
        let notice = desk.studio.services.log.notices().rev().find(|one| one.texts[0].id() == "hd_end.fault").unwrap();
        let whose = notice.device_prefix(|text| text.to_string_in(Language::English));
        assert_eq!(whose.strip_suffix(": ").unwrap().contains("drive 2"), named.is_some(), "{whose}");
        assert_eq!(notice.part.as_ref().map(|part| part.to_string_in(Language::English)).as_deref(), named);
    }
}

/// The speed and torque sent for the running move are shown separately from those set meanwhile (issue 21.7).
#[test]
fn shows_pending_and_sent_speed() {
    let mut desk = in_control("sim:");
    wait_until_motion_allowed(&mut desk, ONE);
    let (before, after) = (
        SpeedTorque { speed: percent(40), ..SpeedTorque::DEFAULT_MOVE },
        SpeedTorque { speed: percent(20), ..SpeedTorque::DEFAULT_MOVE },
    );
    assert_eq!(unit(&desk).moves.running_move_speed_torque(ONE), None);
    drive(&mut desk, MotorCommand::MoveEffort(before));
    let seen = observe_while_moving(&mut desk, |desk| {
        drive(desk, MotorCommand::MoveEffort(after));
        desk.settle();
        let moves = &unit(desk).moves;
        let seen =
            (moves.move_speed_torque(ONE), moves.running_move_speed_torque(ONE), moves.running_jog_speed_torque(ONE));
        // The first values are restored for another attempt.
        drive(desk, MotorCommand::MoveEffort(before));
        seen
    });
    assert_eq!(seen, (after, Some(before), None), "and that is no jog");
    drive(&mut desk, MotorCommand::MoveEffort(after));
    drive(&mut desk, MotorCommand::Stop);
    desk.until("it stands", |studio| !studio.is_moving());
    drive_until(&mut desk, |_| MotorCommand::Step { by: 1_000_000 }, "it moves", |studio| moves(studio, ONE));
    assert_eq!(unit(&desk).moves.running_move_speed_torque(ONE), Some(after));
    drive(&mut desk, MotorCommand::Stop);
    desk.until("it stands", |studio| !studio.is_moving());
}

/// Returns a window with a hub whose drives are under control.
fn hub_screen_in_control() -> Screen {
    let mut screen = Screen::open_in_tab(crate::tabs::HIPERDRIVE, HUB, [1280.0, 900.0]);
    screen.until("it is read", |studio| {
        studio.hiperdrive().is_some_and(|own| own.survey.is_some() && own.session.is_ready() && own.status.is_some())
    });
    let id = screen.studio().hiperdrive().unwrap().session.id;
    screen.act(Action::device(id, Hiperdrive::Take));
    screen.until("it is in hand", |studio| studio.hiperdrive().unwrap().may_move(ONE).is_ok());
    screen
}

fn choose(screen: &mut Screen, of: DriveNumber) {
    let drive = screen.studio().hiperdrive().unwrap();
    let state = screen.words(&explain::state_text(drive.state(of).unwrap()));
    let label = format!("drive {}, {state}", of.get());
    screen.harness.get_by_role_and_label(Role::RadioButton, &label).click();
    screen.steps();
    screen.until("it is shown", |studio| {
        let own = studio.hiperdrive().unwrap();
        own.drive() == of && own.may_move(of).is_ok()
    });
    screen.steps();
}

fn target(screen: &Screen) -> Node<'_> {
    let label = screen.say("hd_move.target");
    let is_it = move |node: &AccessKitNode<'_>| node.role() == Role::TextInput && node.label().as_ref() == Some(&label);
    screen.harness.query_all_by(is_it).last().unwrap()
}

/// Moves drive 1, runs `then`, and returns what `look` observes while the drive still moves. Several attempts may be
/// needed, because a delayed window stops its motion.
fn act_and_observe_while_moving(
    screen: &mut Screen,
    then: impl Fn() -> Hiperdrive,
    look: impl Fn(&Screen) -> bool,
) -> bool {
    let id = screen.studio().hiperdrive().unwrap().session.id;
    let own = |action| Action::device(id, action);
    for _ in 0..20 {
        screen.act(own(Hiperdrive::SelectDrive(ONE)));
        screen.until("it may move", |studio| studio.hiperdrive().unwrap().may_move(ONE).is_ok() && !studio.is_moving());
        screen.act(own(Hiperdrive::Drive(MotorCommand::MoveEffort(SpeedTorque::DEFAULT_MOVE))));
        screen.act(own(Hiperdrive::Drive(MotorCommand::Move { target: 30_000_000 })));
        screen.until("it moves or stands again", |studio| moves(studio, ONE) || !studio.is_moving());
        screen.act(own(then()));
        screen.steps();
        let seen = look(screen);
        if screen.studio().hiperdrive().unwrap().moving_drives() == [ONE] {
            return seen;
        }
    }
    panic!("it never moved for long enough");
}

/// Text typed for one drive stays with that drive (issue 21.7).
#[test]
fn keeps_typed_values_per_drive() {
    let mut screen = hub_screen_in_control();
    target(&screen).focus();
    screen.steps();
    target(&screen).type_text("12345");
    screen.steps();
    assert!(has_entry(&screen, "12345"));
    choose(&mut screen, two());
    assert!(!has_entry(&screen, "12345"));
    choose(&mut screen, ONE);
    assert!(has_entry(&screen, "12345"));
}

/// Returns whether any entry contains the text.
fn has_entry(screen: &Screen, text: &str) -> bool {
    screen.harness.query_all_by(|node| node.value().is_some_and(|own| own.contains(text))).next().is_some()
}

/// Each button that selects a drive shows that drive's state, whichever drive is selected (issue 21.7).
#[test]
fn drive_buttons_show_states() {
    let mut screen = hub_screen_in_control();
    let says = |screen: &Screen, words: &str| screen.harness.query_by_label(words).is_some();
    let shown = act_and_observe_while_moving(
        &mut screen,
        || Hiperdrive::SelectDrive(two()),
        |screen| says(screen, "drive 1, Moving") && says(screen, "drive 1 moving"),
    );
    assert!(shown, "while another one is shown, at the buttons and in the header");
    screen.act(Action::StopMotion);
    screen.until("it stands", |studio| !studio.is_moving());
    let target = screen.studio().hiperdrive().unwrap().target.clone().unwrap();
    target
        .with_station(|station| station.drive(ONE).unwrap().inject_error(Moment::default(), ErrorCode::BLOCK_FORWARD));
    screen.until("it has failed", |studio| studio.hiperdrive().unwrap().state(ONE) == Some(State::Fault));
    screen.steps();
    assert!(says(&screen, "drive 1, Fault"));
}

/// A speed typed during a motion is marked as not sent (issue 21.7).
#[test]
fn marks_unsent_speed_during_motion() {
    let mut screen = hub_screen_in_control();
    let slower = MotorCommand::MoveEffort(SpeedTorque { speed: percent(20), ..SpeedTorque::DEFAULT_MOVE });
    let waits = "sent: 25 %";
    assert!(!screen.shows(waits));
    assert!(act_and_observe_while_moving(&mut screen, || Hiperdrive::Drive(slower), |screen| screen.shows(waits)));
    screen.act(Action::StopMotion);
    screen.until("it stands", |studio| !studio.is_moving());
    screen.steps();
    assert!(!screen.shows(waits));
}
