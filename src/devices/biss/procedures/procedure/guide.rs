//! What all procedures share: device modes, commands, statuses, the operator at the motor, restarts, and the return to
//! operation mode. The state that the encoder may be in is tracked, so that it can be reported if the link is lost.

use std::sync::Arc;
use std::time::Duration;

use super::operator::ShaftReading;
use super::speed_monitor::SpeedMonitor;
use super::{
    Activity, Failure, LeftState, MotorRun, Operator, OperatorAnswer, OperatorPrompt, OperatorTask, ProcedureProgress,
    ProcedureStep, ShaftMotion, StepDetail,
};
use crate::devices::biss::procedures::{Error, Master};
use crate::devices::biss::protocol::{
    Description, DeviceMode, Lock, Procedure, ProcedureKind, RegisterAddress, Role, Temperature,
};

/// How long the encoder takes to restart (data sheet, 02:0Eh). Nothing is sent during this time.
const RESTART: Duration = Duration::from_millis(500);
/// Time limit for a restart.
const RESTART_TIMEOUT: Duration = Duration::from_secs(5);
/// How long an encoder may be silent during a calibration run, which takes about five seconds (manual 6.4).
pub(super) const SILENCE_LIMIT: Duration = Duration::from_secs(10);
/// Interval at which a status register is polled.
const STATUS_POLL_INTERVAL: Duration = Duration::from_millis(100);
/// Interval between position readings. At 2000 rpm, half a turn takes 15 ms. With longer intervals, the turns of a
/// singleturn encoder could not be counted.
const SAMPLE_INTERVAL: Duration = Duration::from_millis(10);
/// Interval at which the operator is asked for an answer.
const QUESTION_INTERVAL: Duration = Duration::from_millis(200);
/// Duration of a motor speed measurement.
const SPEED_MEASUREMENT_TIME: Duration = Duration::from_secs(1);
const STANDSTILL_MEASUREMENT_TIME: Duration = Duration::from_millis(250);
/// Time limit for the encoder to accept a device mode.
const MODE_TIMEOUT: Duration = Duration::from_millis(500);
/// Time limit for an expected status.
const STATUS_TIMEOUT: Duration = Duration::from_secs(5);
/// Silence after which the encoder is assumed to have started the calibration. The time is not documented (`U`). The
/// silence after a damaged reply is shorter.
const START_SILENCE: Duration = Duration::from_secs(1);

pub(in crate::devices::biss::procedures) struct ProcedureContext<'g, 'm> {
    pub(super) master: &'g mut Master<'m>,
    pub(super) description: Arc<Description>,
    operator: &'g mut dyn Operator,
    tell: &'g mut dyn FnMut(ProcedureProgress),
    standing: LeftState,
    op: usize,
    step: ProcedureStep,
    cycles: u64,
}

pub(super) struct RunProgress {
    pub(super) run: MotorRun,
    pub(super) command: u8,
    pub(super) was: u8,
    pub(super) before: u8,
    pub(super) active: u8,
    pub(super) done: u8,
    pub(super) every: Duration,
    pub(super) expected: Duration,
    pub(super) limit: Duration,
}

/// The operator's decision about a task, with the motion of the shaft measured at that time.
pub(super) enum OperatorDecision {
    Go(Option<ShaftMotion>),
    Skip,
}

impl<'g, 'm> ProcedureContext<'g, 'm> {
    pub(in crate::devices::biss::procedures) fn new(
        master: &'g mut Master<'m>,
        description: Arc<Description>,
        operator: &'g mut dyn Operator,
        tell: &'g mut dyn FnMut(ProcedureProgress),
    ) -> Self {
        let standing = LeftState::in_operation(false);
        ProcedureContext {
            master,
            description,
            operator,
            tell,
            standing,
            op: 0,
            step: ProcedureStep::ReturnToOperation,
            cycles: 0,
        }
    }

    pub(in crate::devices::biss::procedures) fn master_mut(&mut self) -> &mut Master<'m> {
        self.master
    }

    /// Records that the encoder starts in operation mode, and whether its password is set.
    pub(in crate::devices::biss::procedures) fn set_initial_state(&mut self, password: bool) {
        self.standing = LeftState::in_operation(password);
    }

    pub(in crate::devices::biss::procedures) fn left_state(&self) -> &LeftState {
        &self.standing
    }

    /// Returns the number of persistent writes that were made or may have been made.
    pub(in crate::devices::biss::procedures) fn write_cycles(&self) -> u64 {
        self.cycles
    }

    pub(in crate::devices::biss::procedures) fn current_step(&self) -> ProcedureStep {
        self.step
    }

    pub(in crate::devices::biss::procedures) fn begin_operation(&mut self, op: usize) {
        self.op = op;
    }

    pub(super) fn begin_step(&mut self, step: ProcedureStep) {
        self.step = step;
        self.report_detail(StepDetail::Begins);
    }

    pub(super) fn report_detail(&mut self, detail: StepDetail) {
        (self.tell)(ProcedureProgress { op: self.op, step: self.step, detail });
    }

    pub(super) fn find_procedure(&self, kind: ProcedureKind) -> Result<Procedure, Failure> {
        self.description.procedure(kind).copied().ok_or(Failure::NotDescribed { kind })
    }

    pub(super) fn role_address(&self, role: Role) -> Option<RegisterAddress> {
        self.description.register_with_role(role).map(|register| register.address)
    }

    pub(super) fn count_write_cycle(&mut self) {
        self.cycles += 1;
    }

    pub(super) fn set_activity(&mut self, activity: Activity) {
        self.standing.activity = activity;
    }

    /// Returns the encoder to operation mode and clears the password. Sends nothing if the encoder is already in this
    /// state.
    pub(in crate::devices::biss::procedures) fn return_to_operation(&mut self) -> Result<(), Error> {
        let Some(lock) = self.description.lock().filter(|_| !self.standing.is_in_operation()) else { return Ok(()) };
        self.begin_step(ProcedureStep::ReturnToOperation);
        let description = self.description.clone();
        let (master, standing) = (&mut *self.master, &mut self.standing);
        let ended = master.run_uncancellable(|master| {
            if matches!(standing.activity, Activity::Running(run) if run.is_calibration()) {
                return master.with_reply_timeout(SILENCE_LIMIT, |master| {
                    return_to_operation(master, &description, lock, standing)
                });
            }
            return_to_operation(master, &description, lock, standing)
        });
        ended.map(drop)
    }

    pub(super) fn enter(&mut self, procedure: &Procedure) -> Result<(), Failure> {
        let mode = DeviceMode::new(procedure.mode);
        self.begin_step(ProcedureStep::Enter(mode));
        let Some(lock) = self.description.lock() else { return Err(Failure::NotDescribed { kind: procedure.kind }) };
        unlock(self.master, lock, &mut self.standing)?;
        set_mode(self.master, lock, mode, &mut self.standing)?;
        let end = self.master.now() + MODE_TIMEOUT;
        loop {
            let found = DeviceMode::new(self.master.read(lock.mode_at)?);
            if found == mode {
                return Ok(());
            }
            if self.master.now() >= end {
                return Err(Failure::Mode { wanted: mode, found });
            }
            self.master.wait(STATUS_POLL_INTERVAL)?;
        }
    }

    /// Sends a command. An unconfirmed command is not an error, so the next exchange must check the status or the
    /// written values.
    pub(super) fn command(&mut self, procedure: &Procedure, command: u8) -> Result<(), Error> {
        match self.master.write(procedure.command, command) {
            Err(Error::Unclear { cause, .. }) if !matches!(*cause, Error::Link(_)) => Ok(()),
            result => result,
        }
    }

    /// Sends the command that writes the flash. From then on, the flash is regarded as written, unless a reply proves
    /// otherwise.
    pub(super) fn save(&mut self, procedure: &Procedure, command: u8) -> Result<(), Error> {
        let before = self.standing.activity;
        self.set_activity(Activity::Saving);
        let ended = self.command(procedure, command);
        if let Err(Error::Cancelled | Error::Refused { .. }) = ended {
            self.set_activity(before);
        } else {
            self.count_write_cycle();
        }
        ended
    }

    pub(super) fn read_back(&mut self, address: RegisterAddress, expected: u8) -> Result<(), Failure> {
        let got = self.master.read(address)?;
        if got == expected {
            return Ok(());
        }
        let hex = |byte: u8| format!("{byte:02X}");
        Err(Failure::NotVerified { item: address.to_string(), expected: hex(expected), got: hex(got) })
    }

    pub(super) fn await_status(&mut self, procedure: &Procedure, expected: u8) -> Result<(), Failure> {
        let end = self.master.now() + STATUS_TIMEOUT;
        loop {
            let found = self.master.read(procedure.status)?;
            if found == expected {
                return Ok(());
            }
            if self.master.now() >= end {
                return Err(Failure::Status { kind: procedure.kind, expected, found });
            }
            self.master.wait(STATUS_POLL_INTERVAL)?;
        }
    }

    /// Runs `work` without reacting to cancellation.
    pub(super) fn run_uncancellable<T>(&mut self, work: impl FnOnce(&mut Self) -> T) -> T {
        let before = self.master.ignore_cancellation(true);
        let result = work(self);
        self.master.ignore_cancellation(before);
        result
    }

    /// Starts a run, reports its progress, and polls the status until the run is complete. A status left over from
    /// before the command is ignored until it changes. `explain` converts an unexpected status to a failure.
    pub(super) fn run(
        &mut self,
        course: &RunProgress,
        procedure: &Procedure,
        explain: impl Fn(&mut Self, u8) -> Result<Failure, Error>,
    ) -> Result<(), Failure> {
        self.set_activity(Activity::Running(course.run));
        let ended = self.command(procedure, course.command);
        if let Err(Error::Cancelled | Error::Refused { .. }) = ended {
            self.set_activity(Activity::Nothing);
        }
        ended?;
        let started = self.master.now();
        let mut begun = false;
        loop {
            let requested = self.master.now();
            let status = self.master.with_reply_timeout(SILENCE_LIMIT, |master| master.read(procedure.status))?;
            let elapsed = self.master.now().duration_since(started);
            begun |= status == course.active || status != course.was;
            begun |= course.run.is_calibration() && self.master.now().duration_since(requested) >= START_SILENCE;
            let waits = status == course.before || !begun;
            if waits && elapsed < STATUS_TIMEOUT {
                // The run has not started yet.
            } else if status == course.before || (waits && status == course.done) {
                // The start command was not received.
                let expected = course.active;
                return Err(Failure::Status { kind: procedure.kind, expected, found: status });
            } else if status == course.done {
                break;
            } else if status != course.active {
                self.set_activity(Activity::Nothing);
                return Err(explain(self, status)?);
            } else if elapsed >= course.limit {
                return Err(Failure::TooLong { run: course.run, seconds: elapsed.as_secs() });
            }
            self.report_detail(StepDetail::Lasts { elapsed, expected: Some(course.expected) });
            self.master.wait(course.every)?;
        }
        self.set_activity(Activity::Nothing);
        Ok(())
    }

    /// Waits for a reply from an encoder that may be restarting, and reads its state.
    pub(super) fn wait_for_restart(&mut self) -> Result<(), Error> {
        self.begin_step(ProcedureStep::Restart);
        self.standing.record_possible_restart();
        let Some(lock) = self.description.lock() else { return Ok(()) };
        let standing = &mut self.standing;
        // A restart resets the selected bank.
        self.master.station().bank = None;
        // The written value is read back, even after cancellation.
        self.master.run_uncancellable(|master| {
            master.wait(RESTART)?;
            master.with_reply_timeout(RESTART_TIMEOUT, |master| read_mode(master, lock, standing))
        })?;
        Ok(())
    }

    /// Gives the operator a task at the motor, and measures the shaft until the conditions are met and the operator
    /// confirms.
    pub(super) fn run_operator_task(&mut self, task: OperatorTask) -> Result<OperatorDecision, Failure> {
        self.begin_step(ProcedureStep::Await(task));
        let begun = self.master.now();
        let mut monitor = SpeedMonitor::with_window(if matches!(task, OperatorTask::Turn(_)) {
            SPEED_MEASUREMENT_TIME
        } else {
            STANDSTILL_MEASUREMENT_TIME
        });
        let mut is_told = false;
        loop {
            let measured = self.measure_shaft(task, &mut monitor)?;
            if !is_told {
                // Answers given before the prompt was displayed are ignored.
                self.operator.on_task_start();
                is_told = true;
            }
            let demand = OperatorPrompt::new(task, measured, self.master.now().duration_since(begun));
            self.report_detail(StepDetail::Demand(demand.clone()));
            match self.operator.ask(&demand) {
                OperatorAnswer::Go if demand.is_ready() => return Ok(OperatorDecision::Go(demand.motion)),
                OperatorAnswer::Go | OperatorAnswer::Wait => {}
                OperatorAnswer::Skip => return Ok(OperatorDecision::Skip),
                OperatorAnswer::Cancel => return Err(Error::Cancelled.into()),
                OperatorAnswer::GiveUp => return Err(Failure::NotReady { task, blockers: demand.blockers }),
            }
        }
    }

    /// Reads positions until the next prompt to the operator. The temperature is also read if the task depends on it.
    fn measure_shaft(&mut self, task: OperatorTask, monitor: &mut SpeedMonitor) -> Result<ShaftReading, Failure> {
        let mut measured = ShaftReading::default();
        let end = self.master.now() + QUESTION_INTERVAL;
        loop {
            // Between the two calibration runs, the encoder may still be silent.
            let reading = match task {
                OperatorTask::Turn(MotorRun::CalibrationClockwise) => {
                    self.master.with_reply_timeout(SILENCE_LIMIT, Master::position)
                }
                _ => self.master.position(),
            };
            match reading {
                Ok(reading) => {
                    measured.marked |= !reading.is_valid();
                    monitor.next(&reading);
                }
                Err(error) if error == Error::Cancelled || error.is_lost() => return Err(error.into()),
                Err(_) => measured.unreadable = true,
            }
            if self.master.now() >= end {
                break;
            }
            self.master.wait(SAMPLE_INTERVAL)?;
        }
        if let (OperatorTask::Turn(run), Some(temperature)) = (task, self.role_address(Role::Temperature))
            && run.is_calibration()
        {
            measured.celsius = Some(Temperature::new(self.master.read(temperature)?).to_celsius());
        }
        measured.motion = monitor.motion();
        Ok(measured)
    }
}

fn read_mode(master: &mut Master<'_>, lock: Lock, standing: &mut LeftState) -> Result<DeviceMode, Error> {
    let mode = DeviceMode::new(master.read(lock.mode_at)?);
    let password = master.read(lock.password_at)? != 0;
    *standing = LeftState {
        mode: super::PossibleValues::new(mode),
        password: super::PossibleValues::new(password),
        activity: standing.activity,
    };
    if standing.is_in_operation() {
        standing.activity = Activity::Nothing;
    }
    Ok(mode)
}

fn unlock(master: &mut Master<'_>, lock: Lock, standing: &mut LeftState) -> Result<(), Error> {
    let ended = master.write(lock.password_at, lock.password);
    standing.password.update_after_write(true, &ended);
    ended
}

fn set_mode(master: &mut Master<'_>, lock: Lock, mode: DeviceMode, standing: &mut LeftState) -> Result<(), Error> {
    let ended = master.write(lock.mode_at, mode.byte());
    standing.mode.update_after_write(mode, &ended);
    ended
}

/// Returns the encoder from any mode to operation mode, clears the password, and returns the previous mode. A running
/// calibration is allowed to finish, because aborting it would lose the table.
pub(super) fn return_to_operation(
    master: &mut Master<'_>,
    description: &Description,
    lock: Lock,
    standing: &mut LeftState,
) -> Result<DeviceMode, Error> {
    let mode = read_mode(master, lock, standing)?;
    if mode != DeviceMode::OPERATION {
        end_procedure(master, description, mode)?;
        let ended = set_mode(master, lock, DeviceMode::OPERATION, standing);
        if !matches!(ended, Err(Error::Refused { .. })) {
            ended?;
        }
        if DeviceMode::new(master.read(lock.mode_at)?) != DeviceMode::OPERATION {
            // Leaving the mode requires the password as well.
            unlock(master, lock, standing)?;
            set_mode(master, lock, DeviceMode::OPERATION, standing)?;
        }
    }
    if standing.password.may_equal(true) {
        let ended = master.write(lock.password_at, 0);
        standing.password.update_after_write(false, &ended);
        ended?;
    }
    let stays = read_mode(master, lock, standing)?;
    if standing.is_in_operation() {
        return Ok(mode);
    }
    Err(Error::StaysUnlocked { mode: stays })
}

/// Sends the command that ends a procedure before its mode is left. The encoder may reject it.
fn end_procedure(master: &mut Master<'_>, description: &Description, mode: DeviceMode) -> Result<(), Error> {
    use crate::devices::biss::protocol::{CalibrationStatus, DataCommand, DataStatus, WiegandCommand};
    let Some(procedure) = description.procedures().iter().find(|own| own.mode == mode.byte()) else { return Ok(()) };
    match procedure.kind {
        ProcedureKind::Calibration => {
            let end = master.now() + SILENCE_LIMIT;
            while CalibrationStatus::from_byte(master.read(procedure.status)?) == CalibrationStatus::Running
                && master.now() < end
            {
                master.wait(STATUS_POLL_INTERVAL)?;
            }
            Ok(())
        }
        ProcedureKind::WiegandTest => ignore_rejection(master.write(procedure.command, WiegandCommand::Stop.byte())),
        ProcedureKind::DataWrite if master.read(procedure.status)? == DataStatus::Open.byte() => {
            ignore_rejection(master.write(procedure.command, DataCommand::Cancel.byte()))
        }
        ProcedureKind::DataWrite | ProcedureKind::FilterSelection | ProcedureKind::Preset => Ok(()),
    }
}

fn ignore_rejection(ended: Result<(), Error>) -> Result<(), Error> {
    match ended {
        Err(Error::Refused { .. }) => Ok(()),
        // It is unknown whether the command was received. The next exchange shows whether the encoder still replies.
        Err(Error::Unclear { cause, .. }) if !matches!(*cause, Error::Link(_)) => Ok(()),
        ended => ended,
    }
}
