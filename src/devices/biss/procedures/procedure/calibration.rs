//! The singleturn calibration, which consists of a counterclockwise and a clockwise run of about five seconds each.
//! During a run, the encoder may not reply. See manual 6.4.

use std::time::Duration;

use super::guide::{OperatorDecision, ProcedureContext, RunProgress};
use super::{Failure, MotorRun, OperatorTask, Outcome, ProcedureStep, ShaftMotion};
use crate::devices::biss::procedures::Error;
use crate::devices::biss::protocol::{
    CalibrationCommand, CalibrationStatus, PositionFilter, Procedure, ProcedureKind, Role, Temperature,
};

/// Expected duration of a calibration run ("about 5 seconds", manual 6.4).
const EXPECTED_DURATION: Duration = Duration::from_secs(5);
/// Time limit for a run.
const MAX_DURATION: Duration = Duration::from_secs(20);

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CalibrationReport {
    /// Temperature of the encoder before the calibration, if known.
    pub celsius: Option<i16>,
    pub counterclockwise: Option<ShaftMotion>,
    pub clockwise: Option<ShaftMotion>,
}

impl ProcedureContext<'_, '_> {
    pub(super) fn calibrate(&mut self) -> Result<Outcome, Failure> {
        let procedure = self.find_procedure(ProcedureKind::Calibration)?;
        self.begin_step(ProcedureStep::Conditions);
        if let Some(filter) = self
            .role_address(Role::Filter)
            .filter(|_| self.description.procedure(ProcedureKind::FilterSelection).is_some())
        {
            let code = self.master.read(filter)?;
            // An old firmware has only one filter and reports 0.
            if code == PositionFilter::Dynamic.byte() {
                return Err(Failure::NotBalanced { code });
            }
        }
        let celsius = match self.role_address(Role::Temperature) {
            Some(temperature) => Some(Temperature::new(self.master.read(temperature)?).to_celsius()),
            None => None,
        };
        let first = MotorRun::CalibrationCounterclockwise;
        let OperatorDecision::Go(counterclockwise) = self.run_operator_task(OperatorTask::Turn(first))? else {
            return Ok(Outcome::Skipped { after: None });
        };
        self.enter(&procedure)?;
        self.run_calibration(first, &procedure)?;
        let second = MotorRun::CalibrationClockwise;
        let OperatorDecision::Go(clockwise) = self.run_operator_task(OperatorTask::Turn(second))? else {
            return Ok(Outcome::Skipped { after: Some(first) });
        };
        self.run_calibration(second, &procedure)?;
        Ok(Outcome::Calibrated(CalibrationReport { celsius, counterclockwise, clockwise }))
    }

    /// Performs one calibration run. The second run cannot be cancelled, because the calibration table would be lost.
    fn run_calibration(&mut self, run: MotorRun, procedure: &Procedure) -> Result<(), Failure> {
        self.begin_step(ProcedureStep::Run(run));
        let was = self.master.read(procedure.status)?;
        let (command, before, done) = if run.is_clockwise() {
            let (before, done) = (CalibrationStatus::CounterclockwiseDone, CalibrationStatus::ClockwiseDone);
            (CalibrationCommand::StartClockwise, before, done)
        } else {
            let (before, done) = (CalibrationStatus::Idle, CalibrationStatus::CounterclockwiseDone);
            (CalibrationCommand::StartCounterclockwise, before, done)
        };
        let course = RunProgress {
            run,
            command: command.byte(),
            was,
            before: before.byte(),
            active: CalibrationStatus::Running.byte(),
            done: done.byte(),
            every: Duration::from_millis(100),
            expected: EXPECTED_DURATION,
            limit: MAX_DURATION,
        };
        let explain =
            |_: &mut Self, status| Ok(Failure::Calibration { run, status: CalibrationStatus::from_byte(status) });
        if !run.is_clockwise() {
            return self.run(&course, procedure, explain);
        }
        let ended = self.run_uncancellable(|guide| guide.run(&course, procedure, explain));
        // If the run succeeds, the table is saved. If it fails, the table is lost. The table remains unchanged only if
        // the run was never started.
        if !matches!(ended, Err(Failure::Device(Error::Cancelled | Error::Refused { .. }))) {
            self.count_write_cycle();
        }
        ended
    }
}
