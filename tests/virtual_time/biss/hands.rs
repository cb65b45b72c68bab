//! A simulated user at the motor of a virtual encoder, who follows the prompts and presses Start when possible, and the
//! changes for the tests of procedures.

use std::time::Duration;

use encoder_studio::devices::biss::jobs::{
    BissJob, BissOutput, Change, Commit, Committed, JobError, OperatorPresence, Prepared,
};
use encoder_studio::devices::biss::procedures::procedure::{
    OperatorAnswer, OperatorChannel, OperatorPrompt, OperatorTask, ProcedureProgress, ProcedureStep, StepDetail,
    UnattendedOperator,
};
use encoder_studio::devices::biss::procedures::write::{EndState, InterruptedWrite};
use encoder_studio::devices::biss::profile::{BissProfile, MotorSource, MountingSteps, PresetParts, RestoreOptions};
use encoder_studio::devices::biss::protocol::{DeviceMode, PositionFilter, PresetValue};
use encoder_studio::profile::Consent;
use encoder_studio::sim::Motor;
use encoder_studio::worker::commit::ApprovedPlan;

use super::support::{Bench, at};

/// A simulated user who follows the prompts and records them.
pub(crate) struct TestOperator {
    motor: Motor,
    pub(crate) seat: OperatorChannel,
    /// Speeds of the motor in the calibration and in the Wiegand test, in revolutions per minute.
    pub(crate) rpm: (f64, f64),
    /// Operations and steps in the order in which they started.
    pub(crate) steps: Vec<(usize, ProcedureStep)>,
    /// Last prompt for each task, in chronological order.
    pub(crate) demands: Vec<OperatorPrompt>,
    /// Answers other than Start, by task.
    pub(crate) instead: Vec<(OperatorTask, OperatorAnswer)>,
}

impl TestOperator {
    pub(crate) fn on(bench: &Bench) -> Self {
        TestOperator {
            motor: bench.motor(),
            seat: OperatorChannel::default(),
            rpm: (500.0, 1000.0),
            steps: Vec::new(),
            demands: Vec::new(),
            instead: Vec::new(),
        }
    }

    pub(crate) fn hear(&mut self, news: &ProcedureProgress) {
        match &news.detail {
            StepDetail::Begins => self.steps.push((news.op, news.step)),
            StepDetail::Demand(demand) => self.follow(demand),
            StepDetail::Count { .. } | StepDetail::Lasts { .. } => {}
        }
    }

    /// Returns the job that executes a plan with this user operating the motor.
    pub(crate) fn attended_commit_job(&self, prepared: &Prepared) -> BissJob {
        let attendance = OperatorPresence::Attended(self.seat.clone());
        let consent = Consent::to(prepared.plan.id());
        BissJob::Commit(Box::new(Commit {
            agreed: ApprovedPlan { prepared: prepared.clone(), consent, force_wear: false, undoes: None },
            attendance,
        }))
    }

    fn follow(&mut self, demand: &OperatorPrompt) {
        let rpm = match demand.task {
            OperatorTask::Turn(run) => {
                let (calibration, wiegand) = self.rpm;
                let speed = if run.is_calibration() { calibration } else { wiegand };
                if run.is_clockwise() { speed } else { -speed }
            }
            OperatorTask::HoldStill | OperatorTask::HoldAtPresetAngle => 0.0,
        };
        self.motor.set_rpm(rpm);
        if demand.is_ready() {
            let instead = self.instead.iter().find(|(task, _)| *task == demand.task);
            self.seat.answer_task(demand.task, instead.map_or(OperatorAnswer::Go, |(_, answer)| *answer));
        }
        self.demands.retain(|other| other.task != demand.task);
        self.demands.push(demand.clone());
    }
}

pub(crate) fn calibration() -> Change {
    let run = MountingSteps { calibrate: true, ..MountingSteps::default() };
    Change::Guided { run, motor: MotorSource::Other }
}

pub(crate) fn wiegand_test(save: bool) -> Change {
    let run = MountingSteps { wiegand: Some(save), ..MountingSteps::default() };
    Change::Guided { run, motor: MotorSource::Other }
}

pub(crate) fn preset(singleturn: u32, multiturn: u32) -> Change {
    let value = PresetValue::new(singleturn, multiturn);
    Change::Preset { value, parts: Some(PresetParts::Both) }
}

pub(crate) fn filter() -> Change {
    Change::SelectFilter(PositionFilter::Dynamic)
}

/// Returns a change that writes three bytes of OEM data to two banks.
pub(crate) fn data() -> Change {
    let edit = |place: &str, bytes: &[u8]| (place.parse().unwrap(), bytes.to_vec());
    Change::Write(vec![
        edit("0x24:0x10", &[0xA1, 0xA2].as_slice()[..1]),
        edit("0x24:0x3F", &[0xA3]),
        edit("0x25:0x00", &[0xA4]),
    ])
}

pub(crate) fn restore_of(profile: &BissProfile) -> Change {
    Change::Restore { profile: Box::new(profile.clone()), options: RestoreOptions::default() }
}

impl Bench {
    pub(crate) fn prepare(&mut self, change: Change) -> Result<Prepared, JobError> {
        match self.run(BissJob::Prepare(change))? {
            BissOutput::Prepared(prepared) => Ok(*prepared),
            other => panic!("{other:?}"),
        }
    }

    /// Executes a plan with a simulated user operating the motor.
    pub(crate) fn commit(&mut self, prepared: &Prepared, hands: &mut TestOperator) -> Result<Committed, Box<JobError>> {
        match self.run_watched(hands.attended_commit_job(prepared), &mut |news| hands.hear(news))? {
            BissOutput::Committed(committed) => Ok(*committed),
            other => panic!("{other:?}"),
        }
    }

    /// Executes a plan without a user.
    pub(crate) fn commit_unattended(&mut self, prepared: &Prepared, patience: Duration) -> Result<Committed, JobError> {
        let attendance = OperatorPresence::Unattended(UnattendedOperator { patience });
        let consent = Consent::to(prepared.plan.id());
        let commit = Commit {
            agreed: ApprovedPlan { prepared: prepared.clone(), consent, force_wear: false, undoes: None },
            attendance,
        };
        match self.run(BissJob::Commit(Box::new(commit)))? {
            BissOutput::Committed(committed) => Ok(*committed),
            other => panic!("{other:?}"),
        }
    }

    pub(crate) fn change(&mut self, change: Change) -> Result<Committed, JobError> {
        let prepared = self.prepare(change)?;
        let mut hands = TestOperator::on(self);
        self.commit(&prepared, &mut hands).map_err(|error| *error)
    }

    pub(crate) fn save(&mut self) -> BissProfile {
        match self.run(BissJob::Save).unwrap() {
            BissOutput::Saved(profile) => *profile,
            other => panic!("{other:?}"),
        }
    }

    pub(crate) fn return_to_operation(&mut self) -> Result<DeviceMode, JobError> {
        match self.run(BissJob::ReturnToOperation)? {
            BissOutput::ReturnedToOperation(mode) => Ok(mode),
            other => panic!("{other:?}"),
        }
    }

    /// Returns the mode and the password, read directly from the simulated encoder.
    pub(crate) fn mode_and_password(&self) -> (DeviceMode, u8) {
        (self.encoder(|encoder, _| encoder.mode()), self.encoder_reads(at("0x6B")).unwrap())
    }

    /// Returns a bank, read directly from the flash of the simulated encoder.
    pub(crate) fn flash_bank(&self, bank: u8) -> Vec<u8> {
        self.encoder(|encoder, _| {
            let (data, first) = match bank {
                0x04..=0x23 => (encoder.flash().motor_data(), 0x04),
                _ => (encoder.flash().oem_data(), 0x24),
            };
            data[usize::from(bank - first) * 64..][..64].to_vec()
        })
    }
}

/// Returns the indices of the exchanges at which the tests interrupt a run. Readings before the first operation and
/// repeated requests during a wait or a run are included only every eighth time.
pub(crate) fn exchanges(original: &Bench, prepared: &Prepared) -> Vec<usize> {
    let mut bench = original.copied();
    let mut hands = TestOperator::on(&bench);
    hands.rpm = (500.0, 2000.0);
    let sent = bench.counter();
    let mut begun: Vec<(usize, ProcedureStep)> = Vec::new();
    let commit = hands.attended_commit_job(prepared);
    let told = &mut |news: &ProcedureProgress| {
        hands.hear(news);
        if news.detail == StepDetail::Begins {
            begun.push((sent(), news.step));
        }
    };
    bench.run_watched(commit, told).unwrap();
    let asks_again = |at: usize| {
        let now = begun.iter().rfind(|(from, _)| *from <= at);
        let next = begun.iter().any(|(from, _)| *from == at + 1);
        let same = match now {
            None => true,
            Some((from, step)) => matches!(step, ProcedureStep::Await(_) | ProcedureStep::Run(_)) && *from + 1 < at,
        };
        same && !next
    };
    (0..=sent()).filter(|at| !asks_again(*at) || at % 8 == 0).collect()
}

/// Returns the interruption. Panics if the error is not an interruption.
pub(crate) fn interrupted(error: JobError) -> InterruptedWrite {
    match error {
        JobError::Interrupted { interrupted, .. } => *interrupted,
        other => panic!("{other}"),
    }
}

pub(crate) const OPERATION_MODE_STATE: (DeviceMode, u8) = (DeviceMode::OPERATION, 0);

/// Checks that the reported state matches the encoder.
pub(crate) fn assert_reported_state(left: &EndState, bench: &Bench, context: &str) {
    let (mode, password) = bench.mode_and_password();
    match &left.standing {
        None => assert_eq!((mode, password), OPERATION_MODE_STATE, "{context}"),
        Some(standing) => {
            assert!(standing.mode.may_equal(mode), "{context}: {mode} is not in {standing:?}");
            assert!(standing.password.may_equal(password != 0), "{context}: {password:02X}h is not in {standing:?}");
        }
    }
}
