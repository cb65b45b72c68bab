//! Tests of the set-up of an axis in one run, from a drive whose parameter 152 (Requested) is 0 to limits in
//! millimetres that have survived a power cycle. The tests also cover the motion locks and the state after a
//! cancellation.

mod bench;
mod foreign;

use crate::tabs::Tabs as _;
use encoder_studio::app::DeviceCommand;
use encoder_studio::app::review::Stage;
use encoder_studio::app::{Action, Language, ReviewAction, Settings, Severity};
use encoder_studio::devices::hiperdrive::jobs::Change;
use encoder_studio::devices::hiperdrive::procedures::dead_man::SpeedTorque;
use encoder_studio::devices::hiperdrive::profile::Service;
use encoder_studio::devices::hiperdrive::protocol::{
    Direction, DriveNumber, ErrorCode, Length, ParameterNumber, Percent, State, Value,
};
use encoder_studio::devices::hiperdrive::state::axis::{
    AxisAction as Run, AxisButton, AxisStep, Power, RestartEvidence, SetupEnd, StepStatus, TestTarget, labels,
};
use encoder_studio::devices::hiperdrive::state::{HiperdriveAction as Hiperdrive, HiperdriveDevice, MotorCommand};
use encoder_studio::sim::SimulatedFaults;
use encoder_studio::units::Moment;

use crate::hiperdrive_acts::act_until;
use crate::support::Desk;

use bench::*;

#[test]
fn millimetre_setup_survives_power_cycle() {
    let mut desk = setup_at_power_cycle(FRESH, 1);
    assert_eq!(unit(&desk).session.cycles, Some(encoder_studio::worker::commit::CycleCount::complete(1)));
    let limits = unit(&desk).limits(DriveNumber::FIRST).unwrap();
    run(&mut desk, Run::Press(AxisButton::Give));
    desk.until("without control", |studio| {
        studio.hiperdrive().is_some_and(|own| !own.moves.is_open() && own.session.is_ready())
    });
    run(&mut desk, Run::Press(AxisButton::PowerCycle));
    desk.until("it is back", |studio| {
        let own = studio.hiperdrive().unwrap();
        own.axis().unwrap().has_survived() && own.session.is_ready()
    });
    run(&mut desk, Run::Next);
    assert_eq!(axis(&desk).setup_end(), Some(SetupEnd::Done));
    assert!(AxisStep::ALL.into_iter().all(|step| axis(&desk).step_status(step) == StepStatus::Done));
    let (lower, upper) = limits;
    assert_eq!([152, 154, 156, 158, 160].map(|own| number(&desk, own)), [1, 400, 256, lower.into(), upper.into()]);
}

#[test]
fn prevents_motion_until_limits_are_confirmed() {
    let mut desk = at_jog_step();
    run(&mut desk, Run::Next);
    assert_eq!(axis(&desk).step(), AxisStep::Confirm);
    control(&mut desk);
    assert!(axis(&desk).may_move(&seen(&desk)).is_err());
    let before = position(&mut desk);
    act(&mut desk, Hiperdrive::Drive(MotorCommand::JogPress { direction: Direction::Clockwise, repeated: false }));
    for _ in 0..50 {
        act(&mut desk, Hiperdrive::Drive(MotorCommand::JogHold));
        desk.settle();
    }
    assert_eq!(position(&mut desk), before);
}

/// A confirmation applies to the limits shown when the user pressed the button, even if the window learns at that
/// moment that they are outdated.
#[test]
fn does_not_confirm_outdated_limits() {
    let mut desk = at_jog_step();
    run(&mut desk, Run::Press(AxisButton::Confirm));
    // The run starts again from the beginning, so that no lock blocks the confirmation.
    run(&mut desk, Run::Begin);
    next(&mut desk, AxisStep::Scale);
    edit(&mut desk, |own| (own.pitch, own.resolution) = ("4".to_owned(), "0,01".to_owned()));
    next(&mut desk, AxisStep::Confirm);
    run(&mut desk, Run::Press(AxisButton::Take));
    desk.until("control", |studio| {
        let own = studio.hiperdrive().unwrap();
        own.moves.is_open() && own.session.is_ready() && own.may_move(DriveNumber::FIRST).is_ok()
    });
    // Another master changes a limit while the window is not updated.
    let upper = ParameterNumber::for_drive(160, DriveNumber::FIRST).unwrap();
    let target = unit(&desk).target.clone().unwrap();
    target.with_station(|station| station.write(Moment::default(), upper, &Value::Number(1000)).unwrap());
    let motion = unit(&desk).moves.motion().unwrap().clone();
    let began = std::time::Instant::now();
    while motion.motion_permit(DriveNumber::FIRST).limits != Some((-204_400, 1000)) {
        assert!(began.elapsed() < crate::support::LONG, "the limits are not read");
        std::thread::sleep(std::time::Duration::from_millis(1));
    }
    run(&mut desk, Run::Press(AxisButton::Confirm));
    desk.until("they are read", |studio| {
        let own = studio.hiperdrive().unwrap();
        own.session.is_ready() && own.limits(DriveNumber::FIRST) == Some((-204_400, 1000))
    });
    let axis = axis(&desk);
    assert_eq!(axis.check_can_continue(&seen(&desk)).unwrap_err().id(), "hd_axis.needs_confirm");
    run(&mut desk, Run::Press(AxisButton::Confirm));
    next(&mut desk, AxisStep::Jog);
}

#[test]
fn cancelling_stops_drive_without_saving() {
    let mut desk = confirmed();
    let press = MotorCommand::JogPress { direction: Direction::Clockwise, repeated: false };
    hold_jog_until(&mut desk, press, "it moves", HiperdriveDevice::is_moving);
    run(&mut desk, Run::Cancel);
    until_stopped(&mut desk);
    let own = axis(&desk);
    assert_eq!((own.setup_end(), own.is_saved(), own.changes().len()), (Some(SetupEnd::Cancelled), false, 5));
    // All values are written back and read. The drive's parameter 152 (Requested) is then 0 again.
    run(&mut desk, Run::Press(AxisButton::Recall));
    write(&mut desk);
    assert!(axis(&desk).changes().is_empty());
    let turned = 33_488_896;
    assert_eq!([152, 154, 156, 158, 160].map(|own| number(&desk, own)), [0, 256, 1, -turned, turned]);
    assert_eq!(unit(&desk).session.cycles, Some(encoder_studio::worker::commit::CycleCount::complete(0)));
    let told = labels::write_back_text(axis(&desk), &seen(&desk)).unwrap().to_string_in(Language::English);
    assert!(
        told.contains("restored to their previous values: 5 of 5") && labels::differences(&seen(&desk)).is_none(),
        "{told}"
    );
    let report = unit(&desk).axis_report(Language::English).unwrap();
    assert!(report.contains("The set-up was cancelled") && !report.contains("Nothing was written"), "{report}");
}

/// A recall (parameter 47 = −2) affects only the adapter. The drive keeps its scale and limits, and no text claims
/// otherwise (issue 21.6 d).
#[test]
fn recall_preserves_drive_parameters() {
    let mut desk = confirmed();
    act(&mut desk, Hiperdrive::Plan(Box::new(Change::Do(Service::Recall))));
    write(&mut desk);
    assert_eq!([152, 154, 156, 158, 160].map(|own| number(&desk, own)), [0, 400, 256, -204_400, 204_400]);
    let told = labels::differences(&seen(&desk)).unwrap().to_string_in(Language::English);
    assert!(told.contains("parameter 154 is 400 instead of 256") && !told.contains("152"), "{told}");
    // The request is lost, so the run stays at the shown step and names the step that must be repeated.
    assert_eq!((axis(&desk).step(), axis(&desk).invalidated_step()), (AxisStep::Jog, Some(AxisStep::Request)));
}

/// The set-up and the Motion page have separate speed and torque settings for their jog pads (issue 21.6 a).
#[test]
fn setup_jog_has_separate_speed_and_torque() {
    let mut desk = new_form("sim:");
    let percent = |value| Percent::new(value).unwrap();
    let chosen = SpeedTorque { speed: percent(80), torque: percent(100) };
    act(&mut desk, Hiperdrive::Drive(MotorCommand::JogEffort(chosen)));
    run(&mut desk, Run::Begin);
    run(&mut desk, Run::Press(AxisButton::Take));
    desk.until("control", |studio| {
        let own = studio.hiperdrive().unwrap();
        own.moves.is_open() && own.session.is_ready() && own.may_move(own.drive()).is_ok()
    });
    for (press, speed, torque) in [
        (MotorCommand::SlowJogPress { direction: Direction::Clockwise, repeated: false }, 10, 25),
        (MotorCommand::JogPress { direction: Direction::Clockwise, repeated: false }, 80, 100),
    ] {
        hold_jog_until(&mut desk, press, "it turns", |own| own.moves.held_jog(own.drive()).is_some());
        let sent = unit(&desk).moves.last_setpoint(unit(&desk).drive()).unwrap();
        assert_eq!((sent.speed.get(), sent.torque.get()), (speed, torque));
        act(&mut desk, Hiperdrive::Drive(MotorCommand::JogRelease));
        until_stopped(&mut desk);
        assert_eq!(unit(&desk).moves.jog_speed_torque(unit(&desk).drive()), chosen);
    }
}

/// A typed spindle pitch is not used until the user completes the step. Text that is not confirmed is not remembered
/// (issue 21.6 f).
#[test]
fn pitch_applies_after_confirmation() {
    let mut desk = new_form("sim:");
    assert_eq!((axis(&desk).entries().pitch.as_str(), unit(&desk).spindle_pitch(unit(&desk).drive())), ("", None));
    next(&mut desk, AxisStep::Scale);
    edit(&mut desk, |own| own.pitch = "4".to_owned());
    assert_eq!(unit(&desk).spindle_pitch(unit(&desk).drive()), None);
    press_and_commit_write(&mut desk);
    assert_eq!(unit(&desk).spindle_pitch(unit(&desk).drive()), None);
    next(&mut desk, AxisStep::Confirm);
    assert_eq!(unit(&desk).spindle_pitch(unit(&desk).drive()).map(|own| own.nanometres), Some(4_000_000));
    // The pitch is changed on another page.
    let drive = unit(&desk).drive();
    act(&mut desk, Hiperdrive::SetPitch(drive, Some(Length { nanometres: 5_000_000 })));
    desk.settle();
    assert_eq!((axis(&desk).step(), axis(&desk).invalidated_step()), (AxisStep::Confirm, Some(AxisStep::Scale)));
}

/// A new run reports the changes left by an interrupted one, even after a restart of the program (issue 21.6 h).
#[test]
fn new_run_lists_aborted_changes() {
    let mut desk = at_jog_step();
    let differences = |desk: &Desk| labels::differences(&seen(desk)).map(|own| own.to_string_in(Language::English));
    let told = differences(&desk).unwrap();
    assert!(
        told.contains("parameter 154 is 400 instead of 256") && told.contains("parameter 152 is 1 instead of 0"),
        "{told}"
    );
    run(&mut desk, Run::Begin);
    assert_eq!(differences(&desk), Some(told.clone()));
    // A restarted program finds the same values in the settings.
    desk.until("it is remembered", |studio| studio.settings.emit().contains("154: 256"));
    let kept = Settings::parse(&desk.studio.settings.emit()).unwrap();
    assert_eq!(kept, desk.studio.settings);
    // A power cycle discards the changes, so there is nothing to report.
    unit(&desk).target.clone().unwrap().power_cycle();
    command(&mut desk, DeviceCommand::Read);
    desk.until("it is read again", |studio| {
        let own = studio.hiperdrive().unwrap();
        own.session.is_ready() && own.parameter_value(own.drive(), 154) == Some(256)
    });
    assert_eq!(differences(&desk), None);
}

/// A reconnection is not mistaken for a power cycle. Only a changed value that was never saved proves a restart
/// (issue 21.6 e).
#[test]
fn reconnection_does_not_count_as_power_cycle() {
    let mut desk = setup_at_power_cycle("sim:?requested=0&timeout=250", 1);
    press_and_commit_write(&mut desk);
    assert_eq!(number(&desk, 182), 1001);
    run(&mut desk, Run::Press(AxisButton::Give));
    desk.until("without control", |studio| {
        studio.hiperdrive().is_some_and(|own| !own.moves.is_open() && own.session.is_ready())
    });
    let target = unit(&desk).target.clone().unwrap();
    // The cable is pulled and plugged in again.
    target.set_faults(&"silent-after:0".parse().unwrap());
    desk.until("it is silent", |studio| {
        matches!(studio.hiperdrive().unwrap().axis().unwrap().power(), Some(Power::Gone(_)))
    });
    target.set_faults(&SimulatedFaults::default());
    desk.until("it can be asked", |studio| !studio.hiperdrive().unwrap().session.is_busy());
    command(&mut desk, DeviceCommand::Read);
    desk.until("it is back", |studio| {
        let own = studio.hiperdrive().unwrap();
        own.session.is_ready() && matches!(own.axis().unwrap().power(), Some(Power::Back { .. }))
    });
    assert!(!axis(&desk).has_survived());
    assert_eq!(axis(&desk).check_can_continue(&seen(&desk)).unwrap_err().id(), "hd_axis.not_restarted");
    // No request is made during the power cycle, so the program does not notice it, as with a real drive.
    target.power_cycle();
    command(&mut desk, DeviceCommand::Read);
    until_ready(&mut desk);
    desk.until("it is read", |studio| studio.hiperdrive().unwrap().axis().unwrap().has_survived());
    assert!(axis(&desk).has_survived(), "{:?}", axis(&desk).power());
    let Some(Power::Back { restart, .. }) = axis(&desk).power() else { panic!() };
    assert_eq!(restart, RestartEvidence::Read);
    run(&mut desk, Run::Next);
    assert_eq!(axis(&desk).setup_end(), Some(SetupEnd::Done));
}

/// A fault during the test step is reported with its code, prevents motion, and can be acknowledged in that step (issue
/// 21.6 g).
#[test]
fn can_acknowledge_test_fault() {
    let mut desk = at_test_step(FRESH, 1, false);
    go(&mut desk, TestTarget::Lower, |own| own.state(own.drive()) == Some(State::Moving));
    let drive = unit(&desk).drive();
    let clock = Moment::default();
    unit(&desk)
        .target
        .clone()
        .unwrap()
        .with_station(|own| own.drive(drive).unwrap().inject_error(clock, ErrorCode::BLOCK_FORWARD));
    desk.until("its code is there", |studio| {
        let own = studio.hiperdrive().unwrap();
        labels::fault_text(&own.drive_facts(own.drive()))
            .is_some_and(|text| text.to_string_in(Language::English).starts_with("Fault 8301"))
    });
    assert_eq!(
        axis(&desk).request(AxisButton::Go(TestTarget::Lower), &seen(&desk)).unwrap_err().id(),
        "hd_refused.fault"
    );
    assert!(axis(&desk).test_outcome(TestTarget::Lower).is_some_and(|own| !own.is_good()));
    desk.until("it can be acknowledged", |studio| {
        let own = studio.hiperdrive().unwrap();
        own.axis().unwrap().request(AxisButton::Acknowledge, &own.drive_facts(own.drive())).is_ok()
    });
    act_until(
        &mut desk,
        |_| Hiperdrive::Axis(Run::Press(AxisButton::Acknowledge)),
        "it is over",
        |studio| {
            let own = studio.hiperdrive().unwrap();
            let seen = own.drive_facts(own.drive());
            !seen.has_failed() && own.axis().unwrap().request(AxisButton::Go(TestTarget::Lower), &seen).is_ok()
        },
    );
    assert!(labels::fault_text(&seen(&desk)).is_none());
}

/// The result is saved as text, in millimetres, in a file that the user chooses (issue 21.6 j).
#[test]
fn saves_result_as_report() {
    let mut desk = confirmed();
    run(&mut desk, Run::Cancel);
    run(&mut desk, Run::AskReport);
    // If the folder does not exist, the error is reported and nothing is lost.
    let question = desk.studio.take_file_question().unwrap();
    let nowhere = desk.outside.path("nowhere").join("axis.txt");
    desk.act(Action::Chosen(question, nowhere));
    desk.until("it is refused", |studio| studio.services.log.notices().any(|own| own.severity == Severity::Error));
    run(&mut desk, Run::AskReport);
    let question = desk.studio.take_file_question().unwrap();
    assert_eq!(question.file_extensions(), ["txt"]);
    let path = desk.outside.path("axis.txt");
    desk.act(Action::Chosen(question, path.clone()));
    desk.until("it is saved", |studio| {
        studio.services.log.notices().any(|own| own.texts.iter().any(|text| text.id() == "report.saved"))
    });
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(text.contains("The drive's limits are -2044.00 mm to 2044.00 mm."), "{text}");
    assert_eq!(desk.notice_ids(Severity::Good).last(), Some(&"report.saved"));
}

/// The complete run works on a hub drive even if each write is first rejected and then interrupted by a lost connection
/// (issue 21.6).
#[test]
fn sets_up_hub_drive_despite_failures() {
    let desk = setup_at_power_cycle_with_faults("sim:?hub=4&drives=1,0,1&requested=0&timeout=250", 3, true);
    let three = DriveNumber::new(3).unwrap();
    assert_eq!(unit(&desk).drive(), three);
    assert_eq!([352, 354, 356].map(|own| read(&desk, own)), [1, 400, 256]);
    // The other drive is unchanged.
    assert_eq!([152, 154, 156, 160].map(|own| read(&desk, own)), [0, 256, 1, 33_488_896]);
}

/// The last step on a hub drive reports its end correctly even if its write is rejected and then interrupted before the
/// supply is switched off (issue 21.6).
#[test]
fn checks_hub_power_cycle_despite_failures() {
    let mut desk = setup_at_power_cycle("sim:?hub=4&drives=1,0,1&requested=0&timeout=250", 3);
    assert_eq!(unit(&desk).axis_report(Language::English), None, "it goes on");
    run_step_with_write_faults(&mut desk, 182, true);
    // The connection was lost after the write had arrived. The value is read back, and no restart can be claimed.
    assert_eq!((read(&desk, 382), read(&desk, 182)), (1001, 1000));
    assert_eq!(axis(&desk).check_can_continue(&seen(&desk)).unwrap_err().id(), "hd_axis.not_restarted");
    assert_eq!(axis(&desk).request(AxisButton::Restarted, &seen(&desk)).unwrap_err().id(), "hd_axis.not_restarted");
    unit(&desk).target.clone().unwrap().power_cycle();
    command(&mut desk, DeviceCommand::Read);
    until_ready(&mut desk);
    desk.until("it is read", |studio| studio.hiperdrive().unwrap().axis().unwrap().has_survived());
    let Some(Power::Back { restart, .. }) = axis(&desk).power() else { panic!() };
    assert_eq!(restart, RestartEvidence::Read);
    until_ready(&mut desk);
    run(&mut desk, Run::Next);
    assert_eq!(axis(&desk).setup_end(), Some(SetupEnd::Done));
    let report = unit(&desk).axis_report(Language::English).unwrap();
    let has = |part: &str| report.split_whitespace().collect::<Vec<_>>().join(" ").contains(part);
    for part in [
        "drive 3 (",
        "10. Power-cycle check: done",
        "The drive has restarted",
        "All values that the device can save have been saved",
    ] {
        assert!(has(part), "{part}: {report}");
    }
    assert!(
        !has("did not complete") && !has("differ from the saved values") && !has("while the drive was not being read"),
        "{report}"
    );
    assert_eq!([352, 354, 356, 382].map(|own| read(&desk, own)), [1, 400, 256, 1000]);
    assert_eq!([152, 154, 156, 160].map(|own| read(&desk, own)), [0, 256, 1, 33_488_896]);
}

#[test]
fn write_without_consent_keeps_step() {
    let mut desk = new_form(FRESH);
    run(&mut desk, Run::Press(AxisButton::Do));
    desk.until("the plan is there", |studio| {
        studio.selected_device().unwrap().review_sheet().is_some_and(|sheet| matches!(sheet.stage, Stage::Ready(_)))
    });
    assert!(axis(&desk).is_writing());
    until_ready(&mut desk);
    let id = unit(&desk).session.id;
    desk.act(Action::Review(id, ReviewAction::Close));
    desk.settle();
    let own = axis(&desk);
    assert!(!own.is_writing() && own.changes().is_empty() && own.step() == AxisStep::Request);
    assert_eq!(number(&desk, 152), 0);
    let number = ParameterNumber::for_drive(152, DriveNumber::FIRST).unwrap();
    assert!(unit(&desk).value(number).is_some());
}
