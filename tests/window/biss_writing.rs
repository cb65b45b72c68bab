//! Tests of writing to a BiSS encoder from the window: reviewed edits, and procedures in which the user turns the
//! motor.

use crate::biss_support::command;
use crate::tabs::Tabs as _;
use encoder_studio::app::DeviceCommand;
use std::time::{Duration, Instant};

use encoder_studio::analysis::check::Verdict;
use encoder_studio::app::{Action, ReviewAction, Severity, Studio};
use encoder_studio::devices::biss::jobs::Change;
use encoder_studio::devices::biss::procedures::procedure::{OperatorAnswer, OperatorTask, Outcome};
use encoder_studio::devices::biss::profile::{MotorSource, MountingSteps, Op, PresetParts};
use encoder_studio::devices::biss::protocol::{DeviceMode, PositionFilter, PresetValue};
use encoder_studio::devices::biss::state::{BissAction as Biss, Encoder, ProcedureEnd, ReviewState, StepStatus};

use crate::biss_support::{ask, at, encoder, is_read, open};
use crate::screen::Screen;
use crate::support::{Desk, Outside, log};

#[track_caller]
fn until_planned(desk: &mut Desk) {
    let planned =
        |own: &Encoder| own.session.review.as_ref().is_some_and(|review| matches!(review.state, ReviewState::Ready(_)));
    desk.until("the plan is there", |studio| is_read(studio) && studio.biss().is_some_and(planned));
}

/// Consents to the plan in the review, which starts the write.
fn write(desk: &mut Desk) {
    let own = encoder(desk);
    let plan =
        own.session.review.as_ref().and_then(|review| review.prepared_plan()).expect("a plan is shown").plan.id();
    let id = own.session.id;
    desk.act(Action::Review(id, ReviewAction::Write(plan)));
}

fn plan(desk: &mut Desk, change: Change) {
    ask(desk, Biss::Plan(Box::new(change)));
    until_planned(desk);
}

/// Polls until the procedure prompts for `task` and the prompt is ready, or not yet ready if `ready` is false.
#[track_caller]
fn wait_for_operator_prompt(desk: &mut Desk, task: OperatorTask, ready: bool) {
    desk.until("it is asked", |studio| {
        let guide = studio.biss().and_then(|own| own.guide.as_ref());
        let demand = guide.and_then(|guide| guide.operator_prompt());
        demand.is_some_and(|own| own.task == task && own.is_ready() == ready)
    });
}

#[test]
fn three_bytes_take_one_save() {
    for link in ["sim:?bridge=on", "sim:"] {
        let mut desk = open(link);
        ask(&mut desk, Biss::ReadBank(Some(0x24)));
        desk.until("the bank is read", |studio| {
            is_read(studio) && studio.biss().unwrap().memory.read(at("0x24:0x3F")).is_some()
        });
        for (place, byte) in [("0x24:0x00", 0x11), ("0x24:0x10", 0x22), ("0x24:0x3F", 0x33)] {
            ask(&mut desk, Biss::Put { start: at(place), bytes: vec![byte] });
        }
        command(&mut desk, DeviceCommand::Review);
        until_planned(&mut desk);
        let prepared = encoder(&desk).session.review.as_ref().unwrap().prepared_plan().unwrap();
        let [Op::StoreData { registers, .. }] = prepared.plan.ops.as_slice() else { panic!("{:?}", prepared.plan.ops) };
        assert_eq!((registers.len(), prepared.plan.write_cycles()), (3, 1), "{link}");
        write(&mut desk);
        desk.until("it is written and read again", |studio| is_read(studio) && !studio.biss().unwrap().is_dirty());
        assert_eq!(encoder(&desk).memory.read(at("0x24:0x10")), Some(0x22), "{link}");
        let status = encoder(&desk).status.as_ref().unwrap();
        assert_eq!((status.mode, status.protection), (Some(DeviceMode::OPERATION), Some(0)), "{link}");
        desk.until(
            "the logbook is read",
            |studio| matches!(&studio.biss().unwrap().session.writes, Some(Ok(writes)) if writes.len() == 1),
        );
        let writes = encoder(&desk).session.writes.as_ref().unwrap().as_ref().unwrap();
        assert_eq!(writes[0].conclusion.as_ref().unwrap().cycles_spent, 1, "{link}");
        // The log and the list of writes agree on the register, the memory area, the old value and the new value.
        let told = log(&desk.studio);
        for words in [&format!("The device at {link} replied."), "Started: Write 3 edited bytes", "read back: 3."] {
            assert!(told.contains(words), "{words}: {told}");
        }
        for change in ["0x24:0x00 OEM data: 00 → 11", "0x24:0x3F OEM data: 00 → 33"] {
            assert!(told.contains(change) && writes[0].description.contains(change), "{told}");
        }
        ask(&mut desk, Biss::Check);
        desk.until("it is checked", |studio| studio.biss().unwrap().check.is_some());
        let lines = encoder(&desk).check.as_ref().unwrap();
        // No Wiegand test is saved in this encoder, so there is no verdict about the sensor (issue 22.19).
        let verdict = |step: &str| if step == "check.wiegand" { Verdict::Skipped } else { Verdict::Good };
        let as_expected = lines.iter().all(|line| line.verdict == verdict(line.step.id()));
        assert!(lines.len() == 8 && as_expected, "{lines:?}");
    }
}

#[test]
fn selects_filter_after_review() {
    let mut desk = open("sim:?bridge=on");
    plan(&mut desk, Change::SelectFilter(PositionFilter::Dynamic));
    write(&mut desk);
    desk.until("it is in force", |studio| {
        let status = studio.biss().and_then(|own| own.status.as_ref());
        is_read(studio) && status.is_some_and(|status| status.filter == Some(PositionFilter::Dynamic))
    });
}

fn calibration() -> Change {
    let run = MountingSteps { calibrate: true, ..MountingSteps::default() };
    Change::Guided { run, motor: MotorSource::Other }
}

fn current_operator_task(studio: &Studio) -> Option<OperatorTask> {
    Some(studio.biss()?.guide.as_ref()?.operator_prompt()?.task)
}

#[test]
fn guides_calibration_step_by_step() {
    let mut desk = open("sim:?bridge=on&calibration=0.2");
    plan(&mut desk, calibration());
    write(&mut desk);
    desk.until("it waits", |studio| current_operator_task(studio).is_some());
    let first = current_operator_task(&desk.studio).unwrap();
    wait_for_operator_prompt(&mut desk, first, false);
    // The motor has not been turned yet, so nothing starts.
    ask(&mut desk, Biss::Answer(first, OperatorAnswer::Go));
    ask(&mut desk, Biss::Turn(-500.0));
    wait_for_operator_prompt(&mut desk, first, true);
    ask(&mut desk, Biss::Answer(first, OperatorAnswer::Go));
    desk.until("the second run is asked for", |studio| current_operator_task(studio).is_some_and(|task| task != first));
    let second = current_operator_task(&desk.studio).unwrap();
    ask(&mut desk, Biss::Turn(500.0));
    wait_for_operator_prompt(&mut desk, second, true);
    ask(&mut desk, Biss::Answer(second, OperatorAnswer::Go));
    desk.until("it is over", |studio| is_read(studio) && !studio.biss().unwrap().guide.as_ref().unwrap().is_running());
    let ProcedureEnd::Done(outcomes) = encoder(&desk).guide.as_ref().unwrap().end.clone().unwrap() else { panic!() };
    assert!(matches!(outcomes.as_slice(), [Outcome::Calibrated(_)]), "{outcomes:?}");
    desk.until("it is read", is_read);
    let status = encoder(&desk).status.as_ref().unwrap();
    assert_eq!((status.mode, status.protection), (Some(DeviceMode::OPERATION), Some(0)));
    ask(&mut desk, Biss::CloseGuide);
    assert!(encoder(&desk).guide.is_none());
}

#[test]
fn stopped_procedure_returns_to_operation() {
    let mut desk = open("sim:?bridge=on&rpm=-500");
    plan(&mut desk, calibration());
    write(&mut desk);
    desk.until("it waits", |studio| current_operator_task(studio).is_some());
    let first = current_operator_task(&desk.studio).unwrap();
    wait_for_operator_prompt(&mut desk, first, true);
    ask(&mut desk, Biss::Answer(first, OperatorAnswer::Go));
    desk.until("it runs", |studio| current_operator_task(studio).is_none());
    std::thread::sleep(Duration::from_millis(200));
    desk.act(Action::Stop);
    desk.until("it is over", |studio| studio.biss().unwrap().guide.as_ref().is_some_and(|own| !own.is_running()));
    desk.until("it is read", is_read);
    let status = encoder(&desk).status.as_ref().unwrap();
    assert_eq!((status.mode, status.protection), (Some(DeviceMode::OPERATION), Some(0)));
    let guide = encoder(&desk).guide.as_ref().unwrap();
    let ProcedureEnd::Failed { texts, may_return_to_operation, .. } = guide.end.clone().unwrap() else { panic!() };
    let weights: Vec<Severity> = texts.iter().map(encoder_studio::devices::biss::state::explain::severity_of).collect();
    assert_eq!(weights, [Severity::Warning, Severity::Note, Severity::Good, Severity::Note]);
    assert_eq!(texts.last().unwrap().id(), "write.backup_calibration");
    assert!(!may_return_to_operation, "it is in operation");
    let reached: Vec<StepStatus> = guide.steps().iter().map(|own| own.reached).collect();
    let cut = reached.iter().position(|own| *own == StepStatus::Cancelled).unwrap();
    assert!(reached[..cut].iter().all(|own| *own == StepStatus::Done), "{reached:?}");
    let (back, between) = reached[cut + 1..].split_last().unwrap();
    assert_eq!(*back, StepStatus::Done, "it was led back");
    assert!(!between.is_empty() && between.iter().all(|own| *own == StepStatus::Ahead), "{reached:?}");
}

#[test]
fn live_panel_waits_for_job() {
    let outside = Outside::new("");
    let mut studio = outside.studio();
    studio.handle_action(Action::ShowTab(crate::tabs::BISS));
    studio.start_with(Some("sim:?bridge=on".parse().unwrap()), None);
    let mut screen = Screen::of(outside, studio, [1280.0, 800.0]);
    screen.until("the encoder is read", is_read);
    let id = screen.studio().biss().unwrap().session.id;
    screen.act(Action::Command(id, DeviceCommand::Poll(Some(Duration::from_millis(50)))));
    screen.act(Action::device(id, Biss::Plan(Box::new(calibration()))));
    let plan = |studio: &Studio| Some(studio.biss()?.session.review.as_ref()?.prepared_plan()?.plan.id());
    screen.until("the plan is there", |studio| is_read(studio) && plan(studio).is_some());
    let own = plan(screen.studio()).unwrap();
    let words = "Paused while a job is running: ";
    assert!(!screen.shows(words));
    screen.act(Action::Review(id, ReviewAction::Write(own)));
    screen.until("it waits", |studio| current_operator_task(studio).is_some());
    let began = Instant::now();
    screen.until("a second passes", |_| began.elapsed() > Duration::from_secs(1));
    assert!(screen.shows(words));
    screen.act(Action::Stop);
    screen.until("it is over", is_read);
    assert!(!screen.shows(words));
}

#[test]
fn rejects_motor_using_this_encoder() {
    let mut desk = open("sim:?bridge=on");
    let run = MountingSteps { calibrate: true, ..MountingSteps::default() };
    ask(&mut desk, Biss::Plan(Box::new(Change::Guided { run, motor: MotorSource::ThisEncoder })));
    desk.until("it is refused", |studio| {
        let review = studio.biss().and_then(|own| own.session.review.as_ref());
        review.is_some_and(|review| matches!(review.state, ReviewState::Failed { begun: false, .. }))
    });
}

#[test]
fn presets_position_at_standstill() {
    let mut desk = open("sim:?bridge=on");
    let value = PresetValue::new(0x8000, 7);
    plan(&mut desk, Change::Preset { value, parts: Some(PresetParts::Both) });
    write(&mut desk);
    wait_for_operator_prompt(&mut desk, OperatorTask::HoldAtPresetAngle, true);
    ask(&mut desk, Biss::Answer(OperatorTask::HoldAtPresetAngle, OperatorAnswer::Go));
    desk.until("it is over", |studio| is_read(studio) && !studio.biss().unwrap().guide.as_ref().unwrap().is_running());
    command(&mut desk, DeviceCommand::ReadPosition);
    desk.until("it is read", |studio| {
        let last = studio.biss().and_then(|own| own.record.last());
        is_read(studio) && last.is_some_and(|own| (own.turns, own.steps) == (7, 0x8000))
    });
    assert!(desk.notice_ids(Severity::Error).is_empty());
}
