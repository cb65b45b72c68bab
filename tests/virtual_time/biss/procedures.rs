//! The five procedures and the mounting run on the virtual encoder: steps, measurements, rejections and failures.
//! However a procedure ends, the encoder returns to operation with the password cleared.

use std::time::Duration;

use encoder_studio::app::Text;
use encoder_studio::devices::biss::jobs::{Change, JobError};
use encoder_studio::devices::biss::procedures::Error;
use encoder_studio::devices::biss::procedures::procedure::{
    Failure, MotorRun, OperatorAdvice, OperatorAnswer, OperatorTask, Outcome, ProcedureStep, StartBlocker, StepDetail,
    WiegandReport, operation_steps,
};
use encoder_studio::devices::biss::profile::{MotorSource, MountingSteps, PlanError, PresetParts};
use encoder_studio::devices::biss::protocol::{
    CalibrationStatus, DeviceMode, PositionFilter, PresetValue, ProcedureKind, WiegandResult, WiegandStatus,
};
use encoder_studio::devices::biss::state::explain::job_error_texts;

use super::hands::{OPERATION_MODE_STATE, TestOperator, calibration, data, filter, interrupted, preset, wiegand_test};
use super::support::{Bench, Transport, at};

const WAYS: [Transport; 2] = [Transport::ConfigPin, Transport::Adapter];

/// Checks that the reported steps match the listed ones in order, including the return to operation if listed.
#[track_caller]
fn assert_steps(bench: &mut Bench, change: Change) -> TestOperator {
    let prepared = bench.prepare(change).unwrap();
    let mut hands = TestOperator::on(bench);
    bench.commit(&prepared, &mut hands).unwrap();
    let listed: Vec<(usize, ProcedureStep)> = prepared
        .plan
        .ops
        .iter()
        .enumerate()
        .flat_map(|(number, op)| operation_steps(op).into_iter().map(move |step| (number, step)))
        .collect();
    assert_eq!(hands.steps, listed);
    assert_eq!(bench.mode_and_password(), OPERATION_MODE_STATE);
    hands
}

/// The counterclockwise run comes first. Each run takes about 5 s, and the result is saved automatically (manual 6.4).
#[test]
fn calibration_costs_one_flash_cycle() {
    for way in WAYS {
        for silent in ["on", "off"] {
            let mut bench = Bench::new(way, &format!("calibration-silent={silent}&temperature=30"));
            let before = bench.flash_cycles();
            let prepared = bench.prepare(calibration()).unwrap();
            assert_eq!(prepared.plan.write_cycles(), 1);
            let mut hands = TestOperator::on(&bench);
            let committed = bench.commit(&prepared, &mut hands).unwrap();
            let written = committed.written;
            assert_eq!((written.ops, written.write_cycles, written.written), (1, 1, 1));
            assert_eq!(bench.flash_cycles() - before, 1);
            let [Outcome::Calibrated(report)] = written.outcomes.as_slice() else { panic!("{:?}", written.outcomes) };
            assert_eq!(report.celsius, Some(30));
            let (first, second) = (report.counterclockwise.unwrap(), report.clockwise.unwrap());
            assert!((first.rpm + 500.0).abs() < 0.5 && (second.rpm - 500.0).abs() < 0.5, "{report:?}");
            let tasks: Vec<OperatorTask> = hands.demands.iter().map(|demand| demand.task).collect();
            assert_eq!(
                tasks,
                [
                    OperatorTask::Turn(MotorRun::CalibrationCounterclockwise),
                    OperatorTask::Turn(MotorRun::CalibrationClockwise)
                ]
            );
            assert!(hands.demands[1].advice.contains(&OperatorAdvice::TableAtRisk));
            assert!(!hands.demands[0].advice.contains(&OperatorAdvice::TableAtRisk));
            assert_eq!(bench.mode_and_password(), OPERATION_MODE_STATE, "{way:?} {silent}");
        }
    }
    assert_steps(&mut Bench::new(Transport::ConfigPin, ""), calibration());
}

/// The test takes 515 revolutions, which is 30.9 s at 1000 rpm (manual 6.3).
#[test]
fn wiegand_test_saves_results_on_request() {
    for way in WAYS {
        for save in [false, true] {
            let mut bench = Bench::new(way, "pulses=6.3,5.8");
            let (before, from) = (bench.flash_cycles(), bench.now());
            let prepared = bench.prepare(wiegand_test(save)).unwrap();
            assert_eq!(prepared.plan.write_cycles(), u64::from(save));
            let mut hands = TestOperator::on(&bench);
            let written = bench.commit(&prepared, &mut hands).unwrap().written;
            assert_eq!(bench.flash_cycles() - before, u32::from(save));
            assert_eq!((written.write_cycles, written.written), (u64::from(save), u64::from(save)));
            let [Outcome::Tested(report)] = written.outcomes.as_slice() else { panic!("{:?}", written.outcomes) };
            let WiegandReport { result, saved, .. } = report;
            assert_eq!((*result, *saved), (WiegandResult::parse([63, 58, 63, 58]), save));
            assert!(result.is_passed());
            let took = bench.now() - from;
            assert!((2.0 * 30.9..75.0).contains(&took.as_secs_f64()), "{took:?}");
            assert_eq!(bench.mode_and_password(), OPERATION_MODE_STATE);
            // The value takes effect after a restart.
            bench.encoder(|encoder, now| encoder.power_cycle(now));
            bench.run(encoder_studio::devices::biss::jobs::BissJob::ReturnToOperation).unwrap();
            assert_eq!(bench.encoder_reads(at("0x00:0x12")), Some(if save { 58 } else { 0 }));
        }
    }
    assert_steps(&mut Bench::new(Transport::ConfigPin, ""), wiegand_test(true));
    assert_steps(&mut Bench::new(Transport::ConfigPin, ""), wiegand_test(false));
    let weak = Bench::new(Transport::ConfigPin, "pulses=6.3,5.3").change(wiegand_test(false)).unwrap().written;
    let [Outcome::Tested(report)] = weak.outcomes.as_slice() else { panic!() };
    assert!(!report.result.is_passed(), "5.3 V is not above 5.3 V");
}

/// Data are written register by register and saved once (manual 6.5).
#[test]
fn writes_data_by_register_and_saves_once() {
    for way in WAYS {
        let mut bench = Bench::new(way, "");
        let before = bench.flash_cycles();
        let written = bench.change(data()).unwrap().written;
        assert_eq!((written.ops, written.written, written.verified, written.write_cycles), (1, 3, 3, 1));
        assert_eq!(bench.flash_cycles() - before, 1);
        assert_eq!(
            (bench.flash_bank(0x24)[0x10], bench.flash_bank(0x24)[0x3F], bench.flash_bank(0x25)[0]),
            (0xA1, 0xA3, 0xA4)
        );
        assert_eq!(bench.mode_and_password(), OPERATION_MODE_STATE);
        assert!(bench.prepare(data()).unwrap().plan.is_empty(), "{way:?}");
    }
    assert_steps(&mut Bench::new(Transport::ConfigPin, ""), data());
}

/// Selecting a filter restarts the encoder (manual 6.6).
#[test]
fn selects_filter_with_restart() {
    for way in WAYS {
        let mut bench = Bench::new(way, "");
        let (before, from) = (bench.flash_cycles(), bench.now());
        let written = bench.change(filter()).unwrap().written;
        assert_eq!(written.outcomes, [Outcome::FilterSelected(PositionFilter::Dynamic)]);
        assert_eq!((bench.flash_cycles() - before, written.write_cycles, written.verified), (1, 1, 1));
        assert_eq!(bench.encoder(|encoder, _| encoder.flash().filter()), PositionFilter::Dynamic);
        assert!(bench.now() - from >= Duration::from_millis(500));
        assert_eq!(bench.mode_and_password(), OPERATION_MODE_STATE);
    }
    assert_steps(&mut Bench::new(Transport::ConfigPin, ""), filter());
}

/// 270° is 18000h, which the registers store as 00 80 01 (manual 6.7).
#[test]
fn preset_takes_two_restarts() {
    for way in WAYS {
        let mut bench = Bench::new(way, "position=0x20007");
        let before = bench.flash_cycles();
        let written = bench.change(preset(98_304, 2)).unwrap().written;
        assert_eq!((bench.flash_cycles() - before, written.write_cycles, written.verified), (2, 2, 2));
        let [Outcome::PresetStored { value, singleturn_bits }, Outcome::PresetFired { parts, from, to }] =
            written.outcomes.as_slice()
        else {
            panic!("{:?}", written.outcomes)
        };
        assert_eq!((*value, *singleturn_bits, *parts), (PresetValue::new(98_304, 2).unwrap(), 17, PresetParts::Both));
        assert_eq!(((from.turns, from.steps), (to.turns, to.steps)), ((1, 7), (2, 98_304)));
        let stored: Vec<u8> = (2..8).map(|at_| bench.encoder_reads(at(&format!("0x01:0x0{at_}"))).unwrap()).collect();
        assert_eq!(stored, [0x00, 0x80, 0x01, 0x02, 0x00, 0x00]);
        assert_eq!(bench.mode_and_password(), OPERATION_MODE_STATE);
        for (parts, place) in [(PresetParts::Singleturn, (2, 98_304)), (PresetParts::Multiturn, (2, 98_304))] {
            let only = Change::Preset { value: None, parts: Some(parts) };
            let written = bench.change(only).unwrap().written;
            let [Outcome::PresetFired { to, .. }] = written.outcomes.as_slice() else { panic!() };
            assert_eq!(((to.turns, to.steps), written.write_cycles), (place, 1), "{parts:?}");
        }
    }
    assert_steps(&mut Bench::new(Transport::ConfigPin, ""), preset(1, 1));
}

/// The run covers temperature, calibration, Wiegand test, preset and OEM data. The motor turns and stops in between.
#[test]
fn mounting_is_one_run_with_report() {
    let mut bench = Bench::new(Transport::ConfigPin, "temperature=33");
    let mut wanted = bench.save();
    let listed = encoder_studio::devices::biss::profile::Bank { number: 0x24, bytes: [7; 64] };
    wanted.data[1].listed.push(listed.into());
    let run = MountingSteps {
        calibrate: true,
        wiegand: Some(true),
        preset: PresetValue::new(0, 0).map(|value| (value, PresetParts::Both)),
        data: Some(Box::new(wanted)),
    };
    let before = bench.flash_cycles();
    let prepared = bench.prepare(Change::Guided { run, motor: MotorSource::Other }).unwrap();
    let cost = prepared.plan.write_cycles();
    assert_eq!(cost, 4, "the preset value is stored already");
    let mut hands = TestOperator::on(&bench);
    let written = bench.commit(&prepared, &mut hands).unwrap().written;
    assert_eq!((written.ops, written.write_cycles, written.written), (4, 4, 1 + 1 + 1 + 64));
    assert_eq!(u64::from(bench.flash_cycles() - before), cost);
    assert!(matches!(
        written.outcomes.as_slice(),
        [
            Outcome::Calibrated(_),
            Outcome::Tested(WiegandReport { saved: true, .. }),
            Outcome::PresetFired { .. },
            Outcome::Stored { registers: 64 },
        ]
    ));
    assert_eq!(bench.flash_bank(0x24), [7; 64]);
    assert_eq!(bench.encoder(|encoder, now| encoder.position_at(now).unwrap().singleturn), 0);
    assert_eq!(bench.mode_and_password(), OPERATION_MODE_STATE);
    let tasks: Vec<OperatorTask> = hands.demands.iter().map(|demand| demand.task).collect();
    let expected = [
        OperatorTask::Turn(MotorRun::CalibrationCounterclockwise),
        OperatorTask::Turn(MotorRun::CalibrationClockwise),
        OperatorTask::Turn(MotorRun::WiegandClockwise),
        OperatorTask::Turn(MotorRun::WiegandCounterclockwise),
        OperatorTask::HoldAtPresetAngle,
        OperatorTask::HoldStill,
    ];
    assert_eq!(tasks, expected);
}

#[test]
fn can_skip_part_of_run() {
    let first = MotorRun::CalibrationCounterclockwise;
    for (task, after) in [(first, None), (MotorRun::CalibrationClockwise, Some(first))] {
        let task = OperatorTask::Turn(task);
        let mut bench = Bench::new(Transport::ConfigPin, "");
        let run = MountingSteps { calibrate: true, wiegand: Some(false), ..MountingSteps::default() };
        let prepared = bench.prepare(Change::Guided { run, motor: MotorSource::Other }).unwrap();
        let before = bench.flash_cycles();
        let mut hands = TestOperator::on(&bench);
        hands.instead.push((task, OperatorAnswer::Skip));
        let written = bench.commit(&prepared, &mut hands).unwrap().written;
        assert_eq!(written.outcomes.first(), Some(&Outcome::Skipped { after }));
        assert!(matches!(written.outcomes.as_slice(), [_, Outcome::Tested(_)]), "{task:?}");
        assert_eq!((written.ops, written.write_cycles), (1, 0));
        assert_eq!(bench.flash_cycles(), before);
        assert!(bench.encoder(|encoder, _| encoder.flash().is_calibrated()));
        assert_eq!(bench.mode_and_password(), OPERATION_MODE_STATE);
    }
}

#[test]
fn cancelling_at_motor_leaves_encoder_in_operation() {
    for (change, task) in [
        (calibration(), OperatorTask::Turn(MotorRun::CalibrationCounterclockwise)),
        (calibration(), OperatorTask::Turn(MotorRun::CalibrationClockwise)),
        (wiegand_test(true), OperatorTask::Turn(MotorRun::WiegandCounterclockwise)),
        (preset(1, 1), OperatorTask::HoldAtPresetAngle),
        (data(), OperatorTask::HoldStill),
    ] {
        let mut bench = Bench::new(Transport::ConfigPin, "");
        let prepared = bench.prepare(change).unwrap();
        let mut hands = TestOperator::on(&bench);
        hands.instead.push((task, OperatorAnswer::Cancel));
        let told = interrupted(*bench.commit(&prepared, &mut hands).unwrap_err());
        assert_eq!(
            (told.cause, told.end_state.at, told.end_state.standing),
            (Failure::Device(Error::Cancelled), ProcedureStep::Await(task), None)
        );
        assert_eq!(bench.mode_and_password(), OPERATION_MODE_STATE, "{task:?}");
        assert!(bench.encoder(|encoder, _| encoder.flash().is_calibrated()));
    }
}

/// After the waiting time, the program reports the values that are still unsuitable and starts nothing.
#[test]
fn unattended_run_starts_only_when_ready() {
    let cases = [
        ("rpm=0", calibration(), StartBlocker::NotTurning),
        ("rpm=500", calibration(), StartBlocker::WrongDirection),
        ("rpm=-1000", wiegand_test(false), StartBlocker::WrongDirection),
        ("rpm=-500&temperature=20", calibration(), StartBlocker::Temperature { celsius: 20 }),
        ("rpm=-500&temperature=41", calibration(), StartBlocker::Temperature { celsius: 41 }),
    ];
    for (query, change, blocker) in cases {
        let mut bench = Bench::new(Transport::ConfigPin, query);
        let prepared = bench.prepare(change).unwrap();
        let (before, from) = (bench.flash_cycles(), bench.now());
        let told = interrupted(bench.commit_unattended(&prepared, Duration::from_secs(5)).unwrap_err());
        let Failure::NotReady { blockers, .. } = &told.cause else { panic!("{query}: {told}") };
        assert_eq!((blockers.contains(&blocker), told.end_state.standing), (true, None), "{query}: {blockers:?}");
        assert_eq!((bench.flash_cycles(), bench.mode_and_password()), (before, OPERATION_MODE_STATE));
        assert!(bench.now() - from < Duration::from_secs(7), "{query}");
    }
    // The motor reverses its direction when the encoder waits for it.
    let mut bench = Bench::new(Transport::ConfigPin, "rpm=-500&motor=reverse");
    let prepared = bench.prepare(calibration()).unwrap();
    let written = bench.commit_unattended(&prepared, Duration::from_secs(5)).unwrap().written;
    assert!(matches!(written.outcomes.as_slice(), [Outcome::Calibrated(_)]));
    // This motor does not reverse, so the second direction never begins.
    let mut bench = Bench::new(Transport::ConfigPin, "rpm=1000");
    let prepared = bench.prepare(wiegand_test(true)).unwrap();
    let told = interrupted(bench.commit_unattended(&prepared, Duration::from_secs(5)).unwrap_err());
    assert_eq!(told.end_state.at, ProcedureStep::Await(OperatorTask::Turn(MotorRun::WiegandCounterclockwise)));
    assert_eq!((told.end_state.standing, bench.mode_and_password()), (None, OPERATION_MODE_STATE));
    // These speeds are outside the limits: too slow for the test, and too fast for the calibration.
    for (query, change) in [("rpm=400", wiegand_test(false)), ("rpm=-900", calibration())] {
        let mut bench = Bench::new(Transport::ConfigPin, query);
        let prepared = bench.prepare(change).unwrap();
        let told = interrupted(bench.commit_unattended(&prepared, Duration::from_secs(3)).unwrap_err());
        assert!(
            matches!(&told.cause, Failure::NotReady { blockers, .. }
            if matches!(blockers.as_slice(), [StartBlocker::Speed { .. }])),
            "{told}"
        );
    }
}

/// These are the possible errors in the calibration status (manual 6.4). An error in the second run loses the table.
#[test]
fn failed_calibration_reports_reason() {
    // Speed and direction change after the start of the run. Variation and temperature are set from the beginning.
    let cases = [
        (MotorRun::CalibrationCounterclockwise, "waver=5", None, CalibrationStatus::Failed),
        (MotorRun::CalibrationCounterclockwise, "", Some(-600.0), CalibrationStatus::Failed),
        (MotorRun::CalibrationClockwise, "", Some(600.0), CalibrationStatus::Failed),
    ];
    for (run, query, disturbed, status) in cases {
        let mut bench = Bench::new(Transport::ConfigPin, &format!("{query}&calibration-silent=off"));
        let prepared = bench.prepare(calibration()).unwrap();
        let before = bench.flash_cycles();
        let (mut hands, motor) = (TestOperator::on(&bench), bench.motor());
        let (told, seat) = (&mut hands, &motor);
        let commit = told.attended_commit_job(&prepared);
        let error = bench
            .run_watched(commit, &mut |news| {
                told.hear(news);
                let lasts = matches!(
                    news.detail,
                    encoder_studio::devices::biss::procedures::procedure::StepDetail::Lasts { .. }
                );
                if let (Some(rpm), true) = (disturbed, lasts && news.step == ProcedureStep::Run(run)) {
                    seat.set_rpm(rpm);
                }
            })
            .unwrap_err();
        let words: Vec<&str> = job_error_texts(&error).iter().map(Text::id).collect();
        let told = interrupted(*error);
        assert_eq!(told.cause, Failure::Calibration { run, status });
        assert_eq!((told.end_state.at, told.end_state.standing), (ProcedureStep::Run(run), None));
        assert_eq!(bench.mode_and_password(), OPERATION_MODE_STATE);
        // The state of the encoder's flash is unknown, so a lost table counts as a write.
        let lost = run == MotorRun::CalibrationClockwise;
        assert_eq!((bench.flash_cycles(), told.done.write_cycles), (before, u64::from(lost)));
        assert_eq!(bench.encoder(|encoder, _| encoder.flash().is_calibrated()), !lost);
        // No backup contains the calibration table.
        assert_eq!(words, ["write.interrupted", "biss_left.at", "biss_left.operation", "write.backup_calibration"]);
        let again = bench.prepare(calibration()).unwrap();
        assert_eq!(
            again.cycles_seen,
            Some(encoder_studio::worker::commit::CycleCount::complete(u64::from(lost))),
            "as the logbook has it"
        );
    }
}

/// The encoder detects these errors itself, although the measured values were suitable just before.
#[test]
fn encoder_checks_direction_speed_and_temperature() {
    type DisturbFn = fn(&mut encoder_studio::devices::biss::sim::Encoder, encoder_studio::units::Moment);
    let cases: [(DisturbFn, CalibrationStatus); 3] = [
        (|encoder, now| encoder.set_rpm(now, 500.0), CalibrationStatus::WrongDirection),
        (|encoder, now| encoder.set_rpm(now, -900.0), CalibrationStatus::Speed),
        (|encoder, _| encoder.set_temperature(60), CalibrationStatus::Temperature),
    ];
    for (spoil, status) in cases {
        let mut bench = Bench::new(Transport::ConfigPin, "calibration-silent=off");
        let prepared = bench.prepare(calibration()).unwrap();
        let mut hands = TestOperator::on(&bench);
        let commit = hands.attended_commit_job(&prepared);
        let encoder = bench.handle();
        let error = bench
            .run_watched(commit, &mut |news| {
                hands.hear(news);
                if hands.steps.last() == Some(&(0, ProcedureStep::Run(MotorRun::CalibrationCounterclockwise)))
                    && matches!(news.detail, encoder_studio::devices::biss::procedures::procedure::StepDetail::Begins)
                {
                    encoder.with(spoil);
                }
            })
            .unwrap_err();
        let run = MotorRun::CalibrationCounterclockwise;
        assert_eq!(interrupted(*error).cause, Failure::Calibration { run, status });
        assert_eq!(bench.mode_and_password(), OPERATION_MODE_STATE);
    }
    // One case has a Wiegand sensor without pulses, the other a motor that continues to turn.
    let mut dead = Bench::new(Transport::ConfigPin, "pulses=0,0");
    let told = interrupted(dead.change(wiegand_test(true)).unwrap_err());
    let (run, status) = (MotorRun::WiegandClockwise, WiegandStatus::Failed);
    assert_eq!(told.cause, Failure::Wiegand { run, status, code: 1 });
    assert_eq!(dead.mode_and_password(), OPERATION_MODE_STATE);
    let mut bench = Bench::new(Transport::ConfigPin, "");
    let prepared = bench.prepare(wiegand_test(true)).unwrap();
    let mut hands = TestOperator::on(&bench);
    let (commit, motor) = (hands.attended_commit_job(&prepared), bench.motor());
    let error = bench
        .run_watched(commit, &mut |news| {
            hands.hear(news);
            if news.step == ProcedureStep::Run(MotorRun::WiegandCounterclockwise) {
                motor.set_rpm(1000.0);
            }
        })
        .unwrap_err();
    let (run, status) = (MotorRun::WiegandCounterclockwise, WiegandStatus::WrongDirection);
    assert_eq!(interrupted(*error).cause, Failure::Wiegand { run, status, code: 0 });
    assert_eq!(bench.mode_and_password(), OPERATION_MODE_STATE);
}

#[test]
fn endless_run_times_out() {
    // The motor stops, so the number of revolutions is never reached.
    let mut bench = Bench::new(Transport::ConfigPin, "");
    let prepared = bench.prepare(wiegand_test(false)).unwrap();
    let mut hands = TestOperator::on(&bench);
    let (commit, motor) = (hands.attended_commit_job(&prepared), bench.motor());
    let error = bench
        .run_watched(commit, &mut |news| {
            hands.hear(news);
            if news.step == ProcedureStep::Run(MotorRun::WiegandClockwise) {
                motor.set_rpm(0.0);
            }
        })
        .unwrap_err();
    let told = interrupted(*error);
    assert!(matches!(told.cause, Failure::TooLong { run: MotorRun::WiegandClockwise, seconds: 71..=73 }), "{told}");
    assert_eq!((told.end_state.standing, bench.mode_and_password()), (None, OPERATION_MODE_STATE));
}

/// Obstacles known in advance are reported before anything is written.
#[test]
fn rejects_impossible_procedures_beforehand() {
    let run = |calibrate, wiegand| MountingSteps { calibrate, wiegand, ..MountingSteps::default() };
    for run in [run(true, None), run(false, Some(true))] {
        let change = Change::Guided { run, motor: MotorSource::ThisEncoder };
        let error = Bench::new(Transport::ConfigPin, "").prepare(change).unwrap_err();
        assert!(matches!(error, JobError::Plan(PlanError::DrivenByThisEncoder)), "{error}");
    }
    let error = Bench::new(Transport::ConfigPin, "filter=dynamic").prepare(calibration()).unwrap_err();
    assert!(matches!(error, JobError::Plan(PlanError::NotBalanced { code: 4 })), "{error}");
    let error = Bench::new(Transport::ConfigPin, "firmware=1.0.0").prepare(filter()).unwrap_err();
    let kind = ProcedureKind::FilterSelection;
    assert!(matches!(error, JobError::Plan(PlanError::FirmwareTooOld { kind: own, .. }) if own == kind), "{error}");
    let error = Bench::new(Transport::ConfigPin, "firmware=1.1.0").prepare(preset(0, 0)).unwrap_err();
    assert!(matches!(error, JobError::Plan(PlanError::FirmwareTooOld { .. })), "{error}");
    for query in ["rpm=30", "rpm=-500"] {
        let error = Bench::new(Transport::ConfigPin, query).prepare(data()).unwrap_err();
        assert!(matches!(error, JobError::Device(Error::Moving { .. })), "{error}");
    }
    // The shaft begins to turn after the plan was made and before it is executed.
    let mut bench = Bench::new(Transport::ConfigPin, "");
    let prepared = bench.prepare(data()).unwrap();
    bench.motor().set_rpm(100.0);
    let error = bench.commit_unattended(&prepared, Duration::ZERO).unwrap_err();
    assert!(matches!(error, JobError::Device(Error::Moving { .. })), "{error}");
    assert_eq!(bench.flash_bank(0x24), [0; 64]);
}

/// With old firmware, the filter register has no meaning because there is only one filter. Calibration still works.
#[test]
fn calibrates_encoder_without_filter_choice() {
    let mut bench = Bench::new(Transport::ConfigPin, "firmware=1.0.0");
    let written = bench.change(calibration()).unwrap().written;
    assert!(matches!(written.outcomes.as_slice(), [Outcome::Calibrated(_)]));
}

/// Another host has left the encoder in a device mode with the password set.
#[test]
fn returns_to_operation_first() {
    for mode in [1, 2, 4, 5, 7] {
        for way in WAYS {
            let mut bench = Bench::new(way, "");
            bench.encoder(|encoder, now| {
                assert!(encoder.write(now, at("0x6B"), 0x2A) && encoder.write(now, at("0x6A"), mode));
            });
            let error = bench.prepare(data()).unwrap_err();
            let found = DeviceMode::new(mode);
            assert!(matches!(error, JobError::Device(Error::NotInOperation { mode }) if mode == found), "{error}");
            assert_eq!(bench.mode_and_password(), (found, 0x2A), "nothing was written");
            assert_eq!(bench.return_to_operation().unwrap(), found);
            assert_eq!(bench.mode_and_password(), OPERATION_MODE_STATE);
            bench.change(data()).unwrap();
        }
    }
    // Only the password is set, and the next write clears it.
    let mut bench = Bench::new(Transport::ConfigPin, "");
    bench.encoder(|encoder, now| assert!(encoder.write(now, at("0x6B"), 0x2A)));
    bench.change(data()).unwrap();
    assert_eq!(bench.mode_and_password(), OPERATION_MODE_STATE);
    assert_eq!(bench.return_to_operation().unwrap(), DeviceMode::OPERATION);
}

/// Another host has started a clockwise calibration run. Ending it would lose the table, so it may finish.
#[test]
fn return_to_operation_waits_for_calibration() {
    for silent in ["on", "off"] {
        let mut bench = Bench::new(Transport::ConfigPin, &format!("rpm=-500&calibration-silent={silent}"));
        let start =
            |bench: &Bench, place: &str, value| bench.encoder(|own, now| assert!(own.write(now, at(place), value)));
        start(&bench, "0x6B", 0x2A);
        start(&bench, "0x6A", 1);
        start(&bench, "0x00:0x00", 1);
        bench.advance_clock_to(Duration::from_secs(6));
        bench.motor().set_rpm(500.0);
        start(&bench, "0x00:0x00", 2);
        let before = bench.flash_cycles();
        bench.return_to_operation().unwrap();
        assert_eq!(bench.mode_and_password(), OPERATION_MODE_STATE, "{silent}");
        assert_eq!(bench.flash_cycles() - before, 1, "it was saved");
        assert!(bench.encoder(|encoder, _| encoder.flash().is_calibrated()));
    }
}

/// The second confirmation of the motor data does not start the OEM data.
#[test]
fn duplicate_answer_does_not_start_next_operation() {
    let mut bench = Bench::new(Transport::ConfigPin, "");
    let edit = |place: &str| (place.parse().unwrap(), vec![0x5A]);
    let prepared = bench.prepare(Change::Write(vec![edit("0x04:0x10"), edit("0x24:0x10")])).unwrap();
    assert_eq!(prepared.plan.ops.len(), 2);
    let hands = TestOperator::on(&bench);
    let (commit, seat) = (hands.attended_commit_job(&prepared), hands.seat);
    let mut asked = 0;
    let error = bench
        .run_watched(commit, &mut |news| match &news.detail {
            StepDetail::Demand(demand) if news.op == 0 && demand.is_ready() => {
                seat.answer_task(demand.task, OperatorAnswer::Go)
            }
            StepDetail::Begins if (news.op, news.step) == (0, ProcedureStep::Save) => {
                seat.answer_task(OperatorTask::HoldStill, OperatorAnswer::Go)
            }
            StepDetail::Demand(demand) if news.op == 1 && demand.is_ready() => {
                asked += 1;
                if asked == 3 {
                    seat.answer_task(demand.task, OperatorAnswer::Cancel);
                }
            }
            _ => {}
        })
        .unwrap_err();
    let told = interrupted(*error);
    assert_eq!((told.cause, told.done.ops), (Failure::Device(Error::Cancelled), 1));
    assert_eq!((bench.flash_bank(0x04)[0x10], bench.flash_bank(0x24)[0x10]), (0x5A, 0));
}

/// An old status must not be mistaken for the end or failure of the current run.
#[test]
fn ignores_status_of_earlier_run() {
    for silent in ["on", "off"] {
        let mut bench =
            Bench::new(Transport::ConfigPin, &format!("calibration-silent={silent}&calibration-status=kept"));
        let before = bench.flash_cycles();
        // This leaves the status "clockwise done".
        bench.change(calibration()).unwrap();
        // This leaves the status "counterclockwise done", which is also the end of the first run.
        let prepared = bench.prepare(calibration()).unwrap();
        let mut hands = TestOperator::on(&bench);
        hands.instead.push((OperatorTask::Turn(MotorRun::CalibrationClockwise), OperatorAnswer::Skip));
        let skipped = Outcome::Skipped { after: Some(MotorRun::CalibrationCounterclockwise) };
        assert_eq!(bench.commit(&prepared, &mut hands).unwrap().written.outcomes, [skipped]);
        assert_eq!(bench.encoder_reads(at("0x00:0x01")), Some(CalibrationStatus::CounterclockwiseDone.byte()));
        let from = bench.now();
        let written = bench.change(calibration()).unwrap().written;
        assert!(matches!(written.outcomes.as_slice(), [Outcome::Calibrated(_)]), "{silent}");
        assert!(bench.now() - from >= Duration::from_secs(10), "two runs of five seconds");
        assert_eq!(bench.flash_cycles() - before, 2);
    }
}
