//! Writing motor and OEM data (manual 6.5). The bank to write must be selected, which the manual does not mention.
//! Here, the target bank is selected after the area has been opened, and bank 0 before the status is read, as
//! [`Master`] always does.
//!
//! [`Master`]: crate::devices::biss::procedures::Master

use super::guide::{OperatorDecision, ProcedureContext};
use super::{Activity, Failure, OperatorTask, Outcome, ProcedureStep, StepDetail};
use crate::devices::biss::profile::RegisterChange;
use crate::devices::biss::protocol::{Area, DataCommand, DataStatus, Procedure, ProcedureKind};

impl ProcedureContext<'_, '_> {
    pub(super) fn store_data(&mut self, area: &Area, registers: &[RegisterChange]) -> Result<Outcome, Failure> {
        let procedure = self.find_procedure(ProcedureKind::DataWrite)?;
        let open = area.open.ok_or(Failure::NotDescribed { kind: procedure.kind })?;
        // The motor must not run (manual 6.5).
        let OperatorDecision::Go(_) = self.run_operator_task(OperatorTask::HoldStill)? else {
            return Ok(Outcome::Skipped { after: None });
        };
        self.enter(&procedure)?;
        self.begin_step(ProcedureStep::Open);
        self.await_status(&procedure, DataStatus::Closed.byte())?;
        self.command(&procedure, open)?;
        self.await_status(&procedure, DataStatus::Open.byte())?;
        self.set_activity(Activity::Entered);
        self.begin_step(ProcedureStep::Write);
        let total = registers.len() as u64;
        for (done, change) in (0..).zip(registers) {
            self.report_detail(StepDetail::Count { done, total });
            self.master.write(change.address, change.new)?;
        }
        self.await_status(&procedure, DataStatus::Open.byte())?;
        self.begin_step(ProcedureStep::Save);
        self.save(&procedure, DataCommand::Save.byte())?;
        // After this point, the result of the store must be reported even after a cancellation.
        self.run_uncancellable(|guide| guide.save_written_data(&procedure, registers))
    }

    fn save_written_data(&mut self, procedure: &Procedure, registers: &[RegisterChange]) -> Result<Outcome, Failure> {
        self.await_status(procedure, DataStatus::Closed.byte())?;
        self.return_to_operation()?;
        self.begin_step(ProcedureStep::ReadBack);
        let total = registers.len() as u64;
        for (done, change) in (0..).zip(registers) {
            self.report_detail(StepDetail::Count { done, total });
            self.read_back(change.address, change.new)?;
        }
        Ok(Outcome::Stored { registers: total })
    }
}
