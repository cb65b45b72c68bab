//! Writing edits or a profile to an encoder: the request, the jobs, the operator at the motor if one is required, and
//! the registers to read back.

use std::time::Duration;

use super::encoder::Encoder;
use super::guide::{ProcedureEnd, ProcedureRun};
use super::review::{ReviewState, is_guided};
use crate::app::services::Services;
use crate::app::session::{
    ApprovedReviewPlan, HasMemory, HasProfile, Interruption, KnownProfile, unsaved_edits_remark,
};
use crate::app::{PendingEdits, Text};
use crate::devices::biss::jobs::{Biss, BissJob, Change, Commit, Committed, JobError, OperatorPresence, Prepared};
use crate::devices::biss::procedures::procedure::{Failure, OperatorAnswer, OperatorTask, UnattendedOperator};
use crate::devices::biss::procedures::{Error, create_profile};
use crate::devices::biss::profile::{
    Bank, BissProfile, DataImage, Op, RegisterRange, RestoreOptions, check_device, other_type,
};
use crate::devices::biss::protocol::RegisterAddress;
use crate::devices::biss::state::explain;
use crate::profile::{Body, PlanId, ProfileError};
use crate::worker::JobInterruption;

/// The substitute for an operator in writes without a task at the motor. It waits three seconds for the shaft to stop.
const UNATTENDED: UnattendedOperator = UnattendedOperator { patience: Duration::from_secs(3) };

impl Encoder {
    pub(super) fn answer_task(&mut self, task: OperatorTask, answer: OperatorAnswer) {
        if let Some(guide) = &mut self.guide {
            guide.answer_task(task, answer);
        }
    }

    pub(super) fn close_procedure(&mut self) {
        if self.guide.as_ref().is_some_and(|guide| !guide.is_running()) {
            self.guide = None;
        }
    }

    /// Records that the encoder is in operation mode again, so that the user is no longer asked to return it.
    pub(super) fn mark_returned_to_operation(&mut self) {
        if let Some(ProcedureRun { end: Some(ProcedureEnd::Failed { may_return_to_operation, .. }), .. }) =
            &mut self.guide
        {
            *may_return_to_operation = false;
        }
    }

    /// Ends the display of an interrupted guided procedure. Returns whether one was running.
    pub(super) fn end_interrupted_procedure(&mut self, how: &Interruption<JobError>, texts: &[Text]) -> bool {
        let error = match how {
            Interruption::Failed(error) | Interruption::Cancelled(error) => Some(*error),
            Interruption::Lost => None,
        };
        if !self.guide.as_ref().is_some_and(ProcedureRun::is_running) {
            return false;
        }
        if error.is_some_and(JobInterruption::has_begun) {
            self.schedule_rereads();
        }
        let Some(guide) = &mut self.guide else { return false };
        let (before, may_return_to_operation) = match error {
            None => (Vec::new(), true),
            Some(JobError::Interrupted { interrupted, .. }) => {
                guide.cut = Some(interrupted.end_state.at);
                (interrupted.done.outcomes.clone(), interrupted.end_state.standing.is_some())
            }
            Some(JobError::Device(Error::NotInOperation { .. })) => (Vec::new(), true),
            Some(_) => (Vec::new(), false),
        };
        let cancelled = matches!(error, Some(JobError::Interrupted { interrupted, .. })
            if matches!(interrupted.cause, Failure::Device(Error::Cancelled)));
        guide.end = Some(ProcedureEnd::Failed { texts: texts.to_vec(), before, may_return_to_operation, cancelled });
        true
    }
}

impl HasMemory for Encoder {
    fn edited_change(&self) -> Option<Change> {
        let edit = |(start, _, bytes): (_, _, Vec<u8>)| {
            let range = RegisterRange::new(start, u8::try_from(bytes.len()).ok()?)?;
            Some((range, bytes))
        };
        self.memory.is_dirty().then(|| Change::Write(self.memory.edited_runs().into_iter().filter_map(edit).collect()))
    }

    fn is_for_other_device(&self, change: &Change) -> bool {
        let (Change::Restore { profile, .. }, Some(own)) = (change, self.identity()) else { return false };
        check_device(profile, &own.profile()).is_err()
    }

    fn is_for_other_type(&self, change: &Change) -> bool {
        let (Change::Restore { profile, .. }, Some(own)) = (change, self.identity()) else { return false };
        other_type(&profile.identity, &own.profile()).is_some()
    }

    fn prepare_job(change: Change) -> BissJob {
        BissJob::Prepare(change)
    }

    fn commit_job(&mut self, agreed: ApprovedReviewPlan<Biss>) -> BissJob {
        commit_job(agreed, OperatorPresence::Unattended(UNATTENDED))
    }

    /// Writes the displayed plan. If the plan needs an operator at the motor, its steps are displayed one after
    /// another.
    fn write(&mut self, shown: PlanId, services: &mut Services) {
        let Some(agreed) = self.approve_plan(shown) else { return };
        let ops = &agreed.prepared.plan.ops;
        let guide = ops.iter().any(is_guided).then(|| ProcedureRun::new(ops.clone()));
        let job = match &guide {
            Some(guide) => commit_job(agreed, OperatorPresence::Attended(guide.seat.clone())),
            None => self.commit_job(agreed),
        };
        if self.begin_write(job, services) && guide.is_some() {
            (self.guide, self.session.review) = (guide, None);
        }
    }

    fn schedule_rereads(&mut self) {
        let ops: &[Op] = match (&self.guide, self.session.review.as_ref().map(|review| &review.state)) {
            (Some(guide), _) if guide.is_running() => guide.operations(),
            (_, Some(ReviewState::Writing(prepared))) => &prepared.plan.ops,
            _ => return,
        };
        let banks = ops.iter().flat_map(Op::register_ranges).filter_map(|range| range.start().bank());
        self.read_after.extend(banks);
    }

    fn handle_executed_plan(&mut self, committed: &Committed, _: &mut Services) {
        if let Some(guide) = self.guide.as_mut().filter(|guide| guide.is_running()) {
            guide.end = Some(ProcedureEnd::Done(committed.written.outcomes.clone()));
        }
    }

    fn log_write_start(&self, what: &Text, prepared: &Prepared, services: &mut Services) {
        self.log_operations(what, prepared, services);
    }

    fn discard_device_data(&mut self) {
        (self.survey, self.status, self.check, self.guide, self.refusal) = (None, None, None, None, None);
        self.memory.clear();
        self.record.clear();
        self.seen.clear();
        self.read_after.clear();
    }
}

impl HasProfile for Encoder {
    fn read_all() -> BissJob {
        BissJob::Save
    }

    fn edited_body(&self) -> Option<Body> {
        self.edited_profile().map(Body::new)
    }

    fn last_read_profile(&self) -> Option<KnownProfile> {
        let survey = self.survey.as_ref()?;
        let (mut data, mut missing) = (Vec::new(), Vec::new());
        for area in survey.identity.description.areas().iter().filter(|area| area.access.is_readable()) {
            let bank = |number| {
                let bytes = self.memory.bytes(RegisterAddress::bank_start(number), Bank::SIZE);
                bytes.and_then(|bytes| Some(Bank { number, bytes: bytes.try_into().ok()? }))
            };
            match area.banks().map(bank).collect::<Option<Vec<Bank>>>() {
                Some(banks) => data.push(DataImage::new(area, banks)),
                None => missing.push(explain::name_text(&area.name)),
            }
        }
        if !missing.is_empty() {
            return Some(Err(missing));
        }
        let profile = create_profile(survey, data, survey.status.non_operational_mode());
        let remarks = unsaved_edits_remark(self.memory.count())
            .into_iter()
            .chain(explain::unsaved_profile_warning(&profile))
            .collect();
        Some(Ok((Body::new(profile), remarks)))
    }

    fn add_edits(&self, body: &mut Body) {
        if let Some(profile) = body.get_mut::<BissProfile>() {
            self.add_edits_to_profile(profile);
        }
    }

    fn restore_change(body: Body) -> Result<Change, ProfileError> {
        let profile = Box::new(body.into_profile()?);
        Ok(Change::Restore { profile, options: RestoreOptions::default() })
    }
}

fn commit_job(agreed: ApprovedReviewPlan<Biss>, attendance: OperatorPresence) -> BissJob {
    BissJob::Commit(Box::new(Commit { agreed, attendance }))
}
