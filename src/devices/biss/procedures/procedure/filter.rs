//! Selecting the position filter, after which the encoder restarts. See manual 6.6.

use super::guide::ProcedureContext;
use super::{Activity, Failure, Outcome, ProcedureStep};
use crate::devices::biss::protocol::{FilterCommand, FilterStatus, PositionFilter, ProcedureKind, Role};

impl ProcedureContext<'_, '_> {
    pub(super) fn select_filter(&mut self, to: PositionFilter) -> Result<Outcome, Failure> {
        let procedure = self.find_procedure(ProcedureKind::FilterSelection)?;
        let in_force = self.role_address(Role::Filter).ok_or(Failure::NotDescribed { kind: procedure.kind })?;
        self.enter(&procedure)?;
        self.begin_step(ProcedureStep::Open);
        self.await_status(&procedure, FilterStatus::Closed.byte())?;
        self.command(&procedure, FilterCommand::Open.byte())?;
        self.await_status(&procedure, FilterStatus::WaitForValue.byte())?;
        self.set_activity(Activity::Entered);
        self.begin_step(ProcedureStep::Write);
        self.command(&procedure, to.byte())?;
        self.await_status(&procedure, FilterStatus::WaitForSave.byte())?;
        self.begin_step(ProcedureStep::Save);
        self.save(&procedure, FilterCommand::Save.byte())?;
        self.run_uncancellable(|guide| {
            guide.wait_for_restart()?;
            guide.begin_step(ProcedureStep::ReadBack);
            guide.read_back(in_force, to.byte())?;
            Ok(Outcome::FilterSelected(to))
        })
    }
}
