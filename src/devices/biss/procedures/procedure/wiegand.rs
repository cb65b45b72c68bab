//! The Wiegand sensor test, which collects pulses during 515 clockwise and then 515 counterclockwise revolutions. See
//! manual 6.3.

use std::time::Duration;

use super::guide::{OperatorDecision, ProcedureContext, RunProgress};
use super::{Activity, Failure, MotorRun, OperatorTask, Outcome, ProcedureStep, ShaftMotion};
use crate::devices::biss::procedures::Error;
use crate::devices::biss::protocol::{Procedure, ProcedureKind, WiegandCommand, WiegandResult, WiegandStatus};

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WiegandReport {
    pub result: WiegandResult,
    /// Whether the result was saved in the encoder. The saved result becomes readable after a restart.
    pub saved: bool,
    pub clockwise: Option<ShaftMotion>,
    pub counterclockwise: Option<ShaftMotion>,
}

impl ProcedureContext<'_, '_> {
    pub(super) fn test_wiegand(&mut self, save: bool) -> Result<Outcome, Failure> {
        let procedure = self.find_procedure(ProcedureKind::WiegandTest)?;
        let (first, second) = (MotorRun::WiegandClockwise, MotorRun::WiegandCounterclockwise);
        let OperatorDecision::Go(clockwise) = self.run_operator_task(OperatorTask::Turn(first))? else {
            return Ok(Outcome::Skipped { after: None });
        };
        self.enter(&procedure)?;
        self.collect_pulses(first, &procedure, clockwise)?;
        let OperatorDecision::Go(counterclockwise) = self.run_operator_task(OperatorTask::Turn(second))? else {
            return Ok(Outcome::Skipped { after: Some(first) });
        };
        self.collect_pulses(second, &procedure, counterclockwise)?;
        self.begin_step(ProcedureStep::Results);
        let results = procedure.data.and_then(|error| error.offset_by(1));
        let results = results.ok_or(Failure::NotDescribed { kind: procedure.kind })?;
        let bytes = self.master.read_consecutive(results, 4)?;
        let Ok(bytes) = <[u8; 4]>::try_from(bytes) else {
            return Err(Failure::NotDescribed { kind: procedure.kind });
        };
        if save {
            self.save_result(&procedure)?;
        }
        let result = WiegandResult::parse(bytes);
        Ok(Outcome::Tested(WiegandReport { result, saved: save, clockwise, counterclockwise }))
    }

    fn collect_pulses(
        &mut self,
        run: MotorRun,
        procedure: &Procedure,
        motion: Option<ShaftMotion>,
    ) -> Result<(), Failure> {
        self.begin_step(ProcedureStep::Run(run));
        let was = self.master.read(procedure.status)?;
        let (command, [before, active, done]) = if run.is_clockwise() {
            let statuses = [WiegandStatus::Stopped, WiegandStatus::Clockwise, WiegandStatus::WaitForDirection];
            (WiegandCommand::StartClockwise, statuses)
        } else {
            let statuses = [WiegandStatus::WaitForDirection, WiegandStatus::Counterclockwise, WiegandStatus::Complete];
            (WiegandCommand::StartCounterclockwise, statuses)
        };
        // At the lowest permitted speed, this takes 62 s.
        let rpm =
            motion.map_or(run.allowed_speeds().least, |motion| motion.rpm.abs()).max(run.allowed_speeds().least / 2.0);
        let expected = Duration::from_secs_f64(f64::from(WiegandResult::REVOLUTIONS) / rpm * 60.0);
        let course = RunProgress {
            run,
            command: command.byte(),
            was,
            before: before.byte(),
            active: active.byte(),
            done: done.byte(),
            every: Duration::from_millis(500),
            expected,
            limit: expected * 2 + Duration::from_secs(10),
        };
        self.run(&course, procedure, |guide, status| {
            let status = WiegandStatus::from_byte(status);
            let code = match procedure.data {
                Some(error) if status == WiegandStatus::Failed => guide.master.read(error)?,
                _ => 0,
            };
            Ok(Failure::Wiegand { run, status, code })
        })
    }

    /// Saves the result. Until the encoder restarts, the result cannot be read back, so only the status confirms the
    /// save.
    fn save_result(&mut self, procedure: &Procedure) -> Result<(), Failure> {
        self.begin_step(ProcedureStep::Save);
        self.set_activity(Activity::Saving);
        let ended = self.master.write(procedure.command, WiegandCommand::Save.byte());
        if !matches!(ended, Err(Error::Cancelled | Error::Refused { .. })) {
            self.count_write_cycle();
        }
        if ended.as_ref().err().is_none_or(|error| !error.is_lost()) {
            self.set_activity(Activity::Nothing);
        }
        Ok(ended?)
    }
}
