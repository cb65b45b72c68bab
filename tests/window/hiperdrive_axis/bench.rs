//! Test support for the axis set-up: its steps, successful and failed writes, and jogs.

use crate::tabs::Tabs as _;
use encoder_studio::app::DeviceCommand;
use encoder_studio::app::review::Stage;
use encoder_studio::app::{Action, ReviewAction};
use encoder_studio::devices::hiperdrive::protocol::{Direction, DriveNumber, ParameterNumber, Value};
use encoder_studio::devices::hiperdrive::sim::WriteFault;
use encoder_studio::devices::hiperdrive::state::axis::{
    Axis, AxisAction as Run, AxisButton, AxisStep, DriveFacts, LengthEntries, TestTarget,
};
use encoder_studio::devices::hiperdrive::state::{HiperdriveAction as Hiperdrive, HiperdriveDevice, MotorCommand};

use crate::hiperdrive_acts::{ATTEMPTS, has_lapsed, hold_pad_until, last_end, wait_until_motion_allowed};
use crate::support::Desk;

/// A link to an adapter with parameter 152 (Requested) at 0, so its drive cannot be moved yet.
pub(super) const FRESH: &str = "sim:?requested=0";

pub(super) fn unit(desk: &Desk) -> &HiperdriveDevice {
    desk.studio.hiperdrive().unwrap()
}

pub(super) fn axis(desk: &Desk) -> &Axis {
    unit(desk).axis().unwrap()
}

pub(super) fn command(desk: &mut Desk, command: DeviceCommand) {
    let id = unit(desk).session.id;
    desk.act(Action::Command(id, command));
}

pub(super) fn act(desk: &mut Desk, action: Hiperdrive) {
    let id = unit(desk).session.id;
    desk.act(Action::device(id, action));
}

pub(super) fn run(desk: &mut Desk, action: Run) {
    act(desk, Hiperdrive::Axis(action));
}

pub(super) fn seen(desk: &Desk) -> DriveFacts {
    unit(desk).drive_facts(unit(desk).drive())
}

/// Returns the value of a parameter by its absolute number.
pub(super) fn read(desk: &Desk, number: u16) -> i64 {
    match unit(desk).value(ParameterNumber::new(number).unwrap()) {
        Some(Value::Number(value)) => *value,
        other => panic!("{number}: {other:?}"),
    }
}

/// Presses a jog pad as soon as the drive may move, and holds it until a condition holds.
#[track_caller]
pub(super) fn hold_jog_until(
    desk: &mut Desk,
    press: MotorCommand,
    what: &str,
    condition: impl Fn(&HiperdriveDevice) -> bool,
) {
    let drive = unit(desk).drive();
    hold_pad_until(desk, press, what, |desk| wait_until_motion_allowed(desk, drive), |desk| condition(unit(desk)));
}

#[track_caller]
pub(super) fn until_ready(desk: &mut Desk) {
    desk.until("it is ready", |studio| {
        studio.hiperdrive().is_some_and(|own| own.survey.is_some() && own.session.is_ready())
    });
}

pub(super) fn new_form(link: &str) -> Desk {
    let mut desk = Desk::fresh("");
    desk.act(Action::ShowTab(crate::tabs::HIPERDRIVE));
    desk.open(link);
    until_ready(&mut desk);
    desk.settle();
    run(&mut desk, Run::Begin);
    assert_eq!(axis(&desk).step(), AxisStep::Request);
    desk
}

/// Consents to the plan of the current step.
#[track_caller]
pub(super) fn consent(desk: &mut Desk) {
    desk.until("the plan is there", |studio| {
        studio.selected_device().unwrap().review_sheet().is_some_and(|sheet| matches!(sheet.stage, Stage::Ready(_)))
    });
    until_ready(desk);
    let Stage::Ready(plan) = desk.studio.selected_device().unwrap().review_sheet().unwrap().stage else {
        panic!("no plan")
    };
    let id = unit(desk).session.id;
    desk.act(Action::Review(id, ReviewAction::Write(plan)));
}

/// Consents to the plan of the current step and closes the review after the write.
#[track_caller]
pub(super) fn write(desk: &mut Desk) {
    consent(desk);
    desk.until("it is written", |studio| {
        studio.selected_device().unwrap().review_sheet().is_some_and(|sheet| matches!(sheet.stage, Stage::Done { .. }))
    });
    let id = unit(desk).session.id;
    desk.act(Action::Review(id, ReviewAction::Close));
    desk.settle();
    until_ready(desk);
}

#[track_caller]
pub(super) fn press_and_commit_write(desk: &mut Desk) {
    run(desk, Run::Press(AxisButton::Do));
    write(desk);
}

/// Checks that the current step is complete and goes to the next one, which must be `step`.
#[track_caller]
pub(super) fn next(desk: &mut Desk, step: AxisStep) {
    let (axis, seen) = (axis(desk), seen(desk));
    assert_eq!(axis.check_can_continue(&seen), Ok(()), "{:?}", axis.step());
    run(desk, Run::Next);
    assert_eq!(self::axis(desk).step(), step);
}

pub(super) fn edit(desk: &mut Desk, change: impl FnOnce(&mut LengthEntries)) {
    let mut entries = axis(desk).entries().clone();
    change(&mut entries);
    run(desk, Run::Edit(Box::new(entries)));
}

/// Waits for cyclic data and returns the position of the axis in steps.
#[track_caller]
pub(super) fn position(desk: &mut Desk) -> i32 {
    let drive = unit(desk).drive();
    desk.until("the position is known", move |studio| {
        studio.hiperdrive().is_some_and(|own| own.drive_facts(drive).position.is_some())
    });
    seen(desk).position.unwrap()
}

pub(super) fn number(desk: &Desk, number: u16) -> i64 {
    unit(desk).parameter_value(unit(desk).drive(), number).unwrap()
}

/// Jogs until the axis has moved by at least this number of steps and then releases the pad.
#[track_caller]
pub(super) fn jog(desk: &mut Desk, direction: Direction, steps: i32) {
    let from = position(desk);
    hold_jog_until(desk, MotorCommand::SlowJogPress { direction, repeated: false }, "it moves", |own| {
        own.drive_facts(own.drive()).position.is_some_and(|position| (position - from).abs() >= steps)
    });
    act(desk, Hiperdrive::Drive(MotorCommand::JogRelease));
    until_stopped(desk);
}

#[track_caller]
pub(super) fn until_stopped(desk: &mut Desk) {
    desk.until("it stands", |studio| {
        studio.hiperdrive().is_some_and(|own| !own.is_moving() && !own.drive_facts(own.drive()).moves)
    });
}

/// Runs the write of the current step. `number` is the parameter number for drive 1. If `rough` is set, the write is
/// first rejected and then cut off halfway.
#[track_caller]
pub(super) fn run_step_with_write_faults(desk: &mut Desk, number: u16, rough: bool) {
    for hindrance in [WriteFault::Refused, WriteFault::CutOff].into_iter().filter(|_| rough) {
        let own = match number {
            47 => ParameterNumber::SAVE,
            number => ParameterNumber::for_drive(number, unit(desk).drive()).unwrap(),
        };
        let target = unit(desk).target.clone().unwrap();
        target.with_station(|station| station.set_write_fault(Some((own, hindrance))));
        let step = axis(desk).step();
        run(desk, Run::Press(AxisButton::Do));
        consent(desk);
        desk.until("it has failed", |studio| {
            studio
                .selected_device()
                .unwrap()
                .review_sheet()
                .is_some_and(|sheet| matches!(sheet.stage, Stage::Failed { .. }))
        });
        target.with_station(|station| station.set_write_fault(None));
        let id = unit(desk).session.id;
        desk.act(Action::Review(id, ReviewAction::Close));
        desk.until("it can be asked", |studio| studio.hiperdrive().is_some_and(|own| !own.session.is_busy()));
        command(desk, DeviceCommand::Read);
        desk.until("it is read again", |studio| {
            let own = studio.hiperdrive().unwrap();
            let seen = own.drive_facts(own.drive());
            seen.connected && !seen.busy && !seen.stale && seen.actual.is_some()
        });
        let own = axis(desk);
        assert_eq!((own.step(), own.is_writing()), (step, false), "{hindrance:?} of {number}");
        // The write of the last step needs no saving, so the axis stays saved.
        assert_eq!(own.is_saved(), step == AxisStep::PowerCycle, "{hindrance:?} of {number}");
        assert_eq!(own.invalidated_step(), None, "{hindrance:?} of {number}");
        if hindrance == WriteFault::CutOff && matches!(step, AxisStep::Reference | AxisStep::Upper) {
            control(desk);
        }
    }
    // The interrupted write may have arrived, in which case nothing is left to write.
    if axis(desk).request(AxisButton::Do, &seen(desk)).is_ok() {
        press_and_commit_write(desk);
    } else {
        assert!(rough, "{number}");
    }
}

#[track_caller]
pub(super) fn control(desk: &mut Desk) {
    run(desk, Run::Press(AxisButton::Take));
    desk.until("control", |studio| {
        let own = studio.hiperdrive().unwrap();
        own.moves.is_open() && own.session.is_ready() && own.drive_facts(own.drive()).position.is_some()
    });
}

/// Starts the application and advances the axis set-up to the confirmation of the limits. The drive has 400 steps per
/// turn and a pitch of 4 mm.
pub(super) fn setup_at_limits_confirmation(link: &str, drive: u8, rough: bool) -> Desk {
    let mut desk = Desk::fresh("");
    desk.act(Action::ShowTab(crate::tabs::HIPERDRIVE));
    desk.open(link);
    until_ready(&mut desk);
    desk.settle();
    act(&mut desk, Hiperdrive::SelectDrive(DriveNumber::new(drive).unwrap()));
    until_ready(&mut desk);
    run(&mut desk, Run::Begin);
    run_step_with_write_faults(&mut desk, 152, rough);
    desk.until("the drive is there", |studio| {
        let own = studio.hiperdrive().unwrap();
        own.axis().unwrap().check_can_continue(&own.drive_facts(own.drive())).is_ok()
    });
    next(&mut desk, AxisStep::Scale);
    edit(&mut desk, |own| (own.pitch, own.resolution) = ("4".to_owned(), "0,01".to_owned()));
    run_step_with_write_faults(&mut desk, 156, rough);
    // The scale is 400/256, and 511 turns of 400 steps are 204 400 steps (reference, section 5).
    assert_eq!([154, 156, 158, 160].map(|own| number(&desk, own)), [400, 256, -204_400, 204_400]);
    next(&mut desk, AxisStep::Confirm);
    desk
}

pub(super) fn at_jog_step() -> Desk {
    setup_at_limits_confirmation(FRESH, 1, false)
}

/// Confirms the limits, goes to the step with the slow jog, and takes control.
pub(super) fn confirm(mut desk: Desk) -> Desk {
    run(&mut desk, Run::Press(AxisButton::Confirm));
    next(&mut desk, AxisStep::Jog);
    // Until the file contains the confirmation, the mark of these limits may be read back from it and lock them again.
    let path = desk.outside.store().settings_path();
    desk.until("the confirmation is kept", |_| {
        std::fs::read_to_string(&path).is_ok_and(|text| text.contains("unconfirmed: []"))
    });
    control(&mut desk);
    desk
}

pub(super) fn confirmed() -> Desk {
    confirm(at_jog_step())
}

/// Advances the axis set-up until the position has been set to 128 steps, before the limits are taught.
pub(super) fn referenced(link: &str, drive: u8, rough: bool) -> Desk {
    let mut desk = confirm(setup_at_limits_confirmation(link, drive, rough));
    jog(&mut desk, Direction::Clockwise, 20);
    jog(&mut desk, Direction::Counterclockwise, 10);
    next(&mut desk, AxisStep::Reference);
    edit(&mut desk, |own| own.reference = "1".to_owned());
    run_step_with_write_faults(&mut desk, 198, rough);
    // 100 steps are rounded to 128, the nearest multiple of 64.
    desk.until("the position is set", |studio| {
        let own = studio.hiperdrive().unwrap();
        own.drive_facts(own.drive()).position.is_some_and(|position| (position - 128).abs() <= 1)
    });
    next(&mut desk, AxisStep::Lower);
    desk
}

/// Advances the axis set-up to the test step, with taught limits.
pub(super) fn at_test_step(link: &str, drive: u8, rough: bool) -> Desk {
    let mut desk = referenced(link, drive, rough);
    jog(&mut desk, Direction::Counterclockwise, 10);
    run(&mut desk, Run::TakePlace);
    let lower = position(&mut desk);
    next(&mut desk, AxisStep::Upper);
    jog(&mut desk, Direction::Clockwise, 40);
    run(&mut desk, Run::TakePlace);
    let upper = position(&mut desk);
    run_step_with_write_faults(&mut desk, 160, rough);
    assert_eq!([158, 160].map(|own| number(&desk, own)), [i64::from(lower), i64::from(upper)]);
    next(&mut desk, AxisStep::Test);
    desk
}

/// Moves to a target of the test step until a condition holds. If a busy computer delays the refresh for 250 ms, which
/// ends the motion, the move is repeated.
#[track_caller]
pub(super) fn go(desk: &mut Desk, place: TestTarget, condition: impl Fn(&HiperdriveDevice) -> bool) {
    let drive = unit(desk).drive();
    for _ in 0..ATTEMPTS {
        let before = last_end(&desk.studio, drive);
        run(desk, Run::Press(AxisButton::Go(place)));
        desk.until("it goes there", |studio| {
            condition(studio.hiperdrive().unwrap()) || has_lapsed(studio, drive, before)
        });
        if !has_lapsed(&desk.studio, drive, before) {
            return;
        }
        until_stopped(desk);
        desk.until("it may go", |studio| {
            let own = studio.hiperdrive().unwrap();
            own.axis().unwrap().request(AxisButton::Go(place), &own.drive_facts(drive)).is_ok()
        });
    }
    panic!("it has lapsed {ATTEMPTS} times");
}

pub(super) fn tested(mut desk: Desk) -> Desk {
    for place in TestTarget::ALL {
        go(&mut desk, place, |own| own.axis().unwrap().test_outcome(place).is_some());
        let outcome = axis(&desk).test_outcome(place).unwrap();
        assert!(outcome.is_good(), "{place:?}: {outcome:?}");
        until_stopped(&mut desk);
    }
    desk
}

/// Advances the axis set-up until the parameters are saved, before the power-cycle check.
pub(super) fn setup_at_power_cycle_with_faults(link: &str, drive: u8, rough: bool) -> Desk {
    let mut desk = tested(at_test_step(link, drive, rough));
    next(&mut desk, AxisStep::Save);
    assert_eq!(
        unit(&desk).session.cycles,
        Some(encoder_studio::worker::commit::CycleCount::complete(0)),
        "nothing was saved on the way"
    );
    run_step_with_write_faults(&mut desk, 47, rough);
    next(&mut desk, AxisStep::PowerCycle);
    desk
}

pub(super) fn setup_at_power_cycle(link: &str, drive: u8) -> Desk {
    setup_at_power_cycle_with_faults(link, drive, false)
}
