//! Tests of constant-speed runs: their speed and torque settings, and the condition for an endless run.

use egui_kittest::kittest::Queryable;
use encoder_studio::app::DeviceCommand;
use encoder_studio::devices::hiperdrive::procedures::dead_man::SpeedTorque;
use encoder_studio::devices::hiperdrive::protocol::{Direction, Percent, RunEnd, Value};
use encoder_studio::devices::hiperdrive::state::MotorCommand;
use encoder_studio::units::Moment;

use crate::hiperdrive::{ONE, command, drive, number, unit};
use crate::hiperdrive_acts::drive_until;
use crate::hiperdrive_jog::screen_in_control;
use crate::hiperdrive_motion::in_control;
use crate::screen::Screen;
use crate::tabs::Tabs as _;

const RUN: MotorCommand = MotorCommand::Run { direction: Direction::Clockwise, end: RunEnd::RangeEnd };

fn effort(speed: u8, torque: u8) -> SpeedTorque {
    SpeedTorque { speed: Percent::new(speed).unwrap(), torque: Percent::new(torque).unwrap() }
}

/// A run has its own speed and torque, which start as low as those of a jog. Previously, it used those of a move, which
/// start at 25 % speed and 100 % torque (issue 26).
#[test]
fn endless_run_has_separate_speed_and_torque() {
    let mut desk = in_control("sim:");
    drive(&mut desk, MotorCommand::MoveEffort(effort(90, 80)));
    assert_eq!(unit(&desk).moves.run_speed_torque(ONE), effort(10, 25), "slow, as a jog");
    drive(&mut desk, MotorCommand::RunEffort(effort(15, 60)));
    drive_until(
        &mut desk,
        |_| RUN,
        "it runs",
        |studio| studio.hiperdrive().unwrap().moves.running_run_speed_torque(ONE).is_some(),
    );
    let moves = &unit(&desk).moves;
    assert_eq!(moves.running_run_speed_torque(ONE), Some(effort(15, 60)));
    assert_eq!(moves.last_setpoint(ONE).map(|sent| (sent.speed.get(), sent.torque.get())), Some((15, 60)));
    assert_eq!((moves.running_move_speed_torque(ONE), moves.running_jog_speed_torque(ONE)), (None, None));
    assert_eq!((moves.move_speed_torque(ONE), moves.jog_speed_torque(ONE)), (effort(90, 80), effort(10, 25)));
    drive(&mut desk, MotorCommand::Stop);
    desk.until("it stands", |studio| !studio.is_moving());
    command(&mut desk, DeviceCommand::Reconnect);
    desk.until("it is connected again", |studio| {
        studio.hiperdrive().is_some_and(|own| own.session.is_ready() && !own.moves.is_open())
    });
    assert_eq!(unit(&desk).moves.run_speed_torque(ONE), effort(10, 25), "every connection begins slowly");
}

fn shows(screen: &Screen, words: &str) -> bool {
    screen.harness.query_all_by_label(words).next().is_some()
}

/// The endless run card always shows the condition and names the parameters that do not meet it (issue 26).
#[test]
fn card_shows_endless_run_condition() {
    let mut screen = screen_in_control("sim:", [1280.0, 1400.0]);
    let condition = screen.say("hd_run.condition");
    assert!(shows(&screen, &condition));
    // 511 turns of 65,536 steps are 33,488,896 steps.
    let differs = "Parameter 158 is -65536 instead of -33488896.";
    assert!(!shows(&screen, differs));
    let target = screen.studio().hiperdrive().unwrap().target.clone().unwrap();
    target.with_station(|station| station.write(Moment::default(), number(158), &Value::Number(-65_536)).unwrap());
    screen.until("the other limit is read", |studio| {
        studio.hiperdrive().unwrap().check_can_allow_endless_run(ONE).is_err()
    });
    assert!(shows(&screen, &condition) && shows(&screen, differs));
    assert_eq!(screen.studio().hiperdrive().unwrap().endless_run_obstacles(ONE).len(), 1, "the others are unchanged");
}
