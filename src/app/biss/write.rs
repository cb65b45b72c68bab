//! The way to a write: from a wish to a plan, from the plan and the consent to it to the job that carries it out, with a
//! person at the motor where the plan needs one.

use std::time::Duration;

use super::encoder::Encoder;
use super::guide::{End, Guide};
use super::review::{Review, ReviewState, is_guided};
use crate::app::review::{Permit, told};
use crate::app::services::Services;
use crate::app::{Severity, Text};
use crate::device::biss::Error;
use crate::device::biss::procedure::{Answer, Failure, Task, Unattended};
use crate::device::biss::write::Left;
use crate::profile::biss::{BissProfile, Op, RegisterRange, RestoreOptions, check_device};
use crate::profile::{Consent, PlanId};
use crate::worker::biss::{Attendance, Biss, BissJob, Change, Commit, Committed, JobError, Prepared};

/// How long a shaft that has to stand, with nobody asked to stop it, is waited for.
const UNATTENDED: Unattended = Unattended { patience: Duration::from_secs(3) };

impl Encoder {
    pub(super) fn review_edits(&mut self, services: &mut Services) {
        if !self.memory.is_dirty() {
            let text = Text::new("session.nothing_edited");
            services.tell(Severity::Note, vec![text], Some(&self.session.name()));
            return;
        }
        let runs = self.memory.changes();
        let edit = |(start, _, bytes): (_, _, Vec<u8>)| {
            let range = RegisterRange::new(start, u8::try_from(bytes.len()).ok()?)?;
            Some((range, bytes))
        };
        let edits = runs.into_iter().filter_map(edit).collect();
        self.plan(Change::Write(edits), services);
    }

    pub(in crate::app) fn plan_restore(&mut self, profile: BissProfile, services: &mut Services) {
        let options = RestoreOptions::default();
        self.plan(Change::Restore { profile: Box::new(profile), options }, services);
    }

    /// Makes the plan of a change, to be looked at.
    pub(super) fn plan(&mut self, change: Change, services: &mut Services) {
        if let Some(why) = self.session.why_not_ready() {
            services.tell(Severity::Warning, vec![why], Some(&self.session.name()));
            return;
        }
        let is_for_another = self.is_for_another(&change);
        self.review = Some(Review::new(change.clone(), is_for_another));
        if !self.try_submit(BissJob::Prepare(change), services) {
            self.review = None;
        }
    }

    /// It is a profile of another encoder than this one.
    fn is_for_another(&self, change: &Change) -> bool {
        let (Change::Restore { profile, .. }, Some(own)) = (change, self.identity()) else { return false };
        check_device(profile, &own.profile()).is_err()
    }

    /// Makes the plan again with one of the review's toggles the other way round.
    pub(in crate::app) fn plan_with(&mut self, permit: Permit, services: &mut Services) {
        if self.session.is_busy() {
            return;
        }
        if let Some(change) = self.review.as_ref().and_then(|review| review.toggled(permit)) {
            self.plan(change, services);
        }
    }

    pub(in crate::app) fn force_wear(&mut self, force: bool) {
        if let Some(review) = &mut self.review {
            review.force_wear = force;
        }
    }

    /// The consent: to the plan that was drawn, which has to be the one that stands in the review.
    pub(in crate::app) fn write(&mut self, shown: PlanId, services: &mut Services) {
        if !self.session.is_ready() {
            return;
        }
        let Some(review) = &mut self.review else { return };
        let ReviewState::Ready(prepared) = &review.state else { return };
        if prepared.plan.id() != shown {
            return;
        }
        let prepared = prepared.clone();
        let guide = prepared.plan.ops.iter().any(is_guided).then(|| Guide::new(prepared.plan.ops.clone()));
        let attendance =
            guide.as_ref().map_or(Attendance::Nobody(UNATTENDED), |guide| Attendance::Seat(guide.seat.clone()));
        let (consent, force_wear, what) = (Consent::to(shown), review.force_wear, review.what.clone());
        let commit = Commit { prepared: (*prepared).clone(), consent, force_wear, attendance };
        review.state = ReviewState::Writing(prepared.clone());
        if !self.try_submit(BissJob::Commit(Box::new(commit)), services) {
            if let Some(review) = &mut self.review {
                review.state = ReviewState::Ready(prepared);
            }
            return;
        }
        self.log_begin(&what, &prepared, services);
        if guide.is_some() {
            // From here on it is followed step by step.
            (self.guide, self.review) = (guide, None);
        }
    }

    /// Closes the review; what is being written goes on, and its review stays.
    pub(in crate::app) fn close_review(&mut self) {
        let Some(review) = &self.review else { return };
        if review.is_writing() {
            return;
        }
        if review.is_planning()
            && let Some(line) = &mut self.session.line
        {
            line.stop();
        }
        self.review = None;
    }

    /// Answers what a procedure asks.
    pub(super) fn answer(&mut self, task: Task, answer: Answer) {
        if let Some(guide) = &mut self.guide {
            guide.answer(task, answer);
        }
    }

    /// Puts a procedure that is over away.
    pub(super) fn close_guide(&mut self) {
        if self.guide.as_ref().is_some_and(|guide| !guide.is_running()) {
            self.guide = None;
        }
    }

    /// A plan is there.
    pub(super) fn planned(&mut self, prepared: Box<Prepared>) {
        if let Some(review) = &mut self.review {
            review.state = ReviewState::Ready(prepared);
        }
    }

    /// A plan was carried out.
    pub(super) fn committed(&mut self, committed: Committed, services: &mut Services) {
        self.log_outcomes(&committed.written.outcomes, services);
        let (severity, texts) = told::<Biss>(&committed);
        services.tell(severity, texts, Some(&self.session.name()));
        self.memory.forget_steps();
        self.read_what_was_written();
        if let Some(guide) = self.guide.as_mut().filter(|guide| guide.is_running()) {
            guide.end = Some(End::Done(committed.written.outcomes));
        } else if let Some(review) = &mut self.review
            && let ReviewState::Writing(prepared) = &review.state
        {
            review.state = ReviewState::Done(prepared.clone(), committed);
        }
        self.submit(BissJob::Survey, services);
    }

    /// Whatever the plan that is being carried out changes is read again, however it ends.
    fn read_what_was_written(&mut self) {
        let ops: &[Op] = match (&self.guide, self.review.as_ref().map(|review| &review.state)) {
            (Some(guide), _) if guide.is_running() => guide.ops(),
            (_, Some(ReviewState::Writing(prepared))) => &prepared.plan.ops,
            _ => return,
        };
        let banks = ops.iter().flat_map(Op::ranges).filter_map(|range| range.start().bank());
        self.read_after.extend(banks);
    }

    /// The encoder was led back into operation: nothing is left to be done about it.
    pub(super) fn led_back(&mut self) {
        if let Some(Guide { end: Some(End::Failed { may_lead_back, .. }), .. }) = &mut self.guide {
            *may_lead_back = false;
        }
    }

    /// A plan, or carrying it out, has failed or was ended; true where that stands where it was asked for.
    pub(super) fn write_failed(&mut self, error: &JobError, texts: &[Text]) -> bool {
        let begun = matches!(error, JobError::Interrupted { .. });
        if begun {
            self.read_what_was_written();
        }
        if let Some(guide) = self.guide.as_mut().filter(|guide| guide.is_running()) {
            let (before, may_lead_back) = match error {
                JobError::Interrupted { interrupted, .. } => {
                    guide.cut = Some(interrupted.at);
                    (interrupted.done.outcomes.clone(), interrupted.left != Left::Operation)
                }
                JobError::Device(Error::NotInOperation { .. }) => (Vec::new(), true),
                _ => (Vec::new(), false),
            };
            let cancelled = matches!(error, JobError::Interrupted { interrupted, .. }
                if matches!(interrupted.cause, Failure::Device(Error::Cancelled)));
            guide.end = Some(End::Failed { texts: texts.to_vec(), before, may_lead_back, cancelled });
            return true;
        }
        match &mut self.review {
            Some(review) if review.is_planning() || review.is_writing() => {
                review.fail(texts.to_vec(), begun);
                true
            }
            _ => false,
        }
    }

    /// The link is gone while something was written.
    pub(super) fn write_lost(&mut self, why: &Text) {
        if let Some(review) = self.review.as_mut().filter(|review| review.is_writing()) {
            review.fail(vec![why.clone()], true);
        }
        if let Some(guide) = self.guide.as_mut().filter(|guide| guide.is_running()) {
            let (texts, before) = (vec![why.clone()], Vec::new());
            guide.end = Some(End::Failed { texts, before, may_lead_back: true, cancelled: false });
        }
    }
}
