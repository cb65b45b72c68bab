//! The way to a write: from a wish to a plan, from the plan and the consent to it to the job that carries it out.

use super::review::{Review, ReviewState};
use super::unit::Unit;
use crate::app::review::{Permit, told};
use crate::app::services::Services;
use crate::app::{Severity, Text, explain};
use crate::profile::hiperdrive::{HiperdriveProfile, RestoreOptions, check_device};
use crate::profile::{Consent, PlanId};
use crate::worker::hiperdrive::{Change, Commit, Committed, Hiperdrive, HiperdriveJob, JobError, Prepared};

impl Unit {
    pub(super) fn review_edits(&mut self, services: &mut Services) {
        let edited = self.staged.edited();
        if edited.values.is_empty() {
            services.tell(Severity::Note, vec![Text::new("session.nothing_edited")], Some(&self.session.name()));
            return;
        }
        self.plan(Change::Write(Box::new(edited)), services);
    }

    pub(in crate::app) fn plan_restore(&mut self, profile: HiperdriveProfile, services: &mut Services) {
        let options = RestoreOptions::default();
        self.plan(Change::Restore { profile: Box::new(profile), options }, services);
    }

    /// Makes the plan of a change, to be looked at. What is held is let go: the review stands over it.
    pub(super) fn plan(&mut self, change: Change, services: &mut Services) {
        self.moves.let_go();
        if let Some(why) = self.session.why_not_ready() {
            services.tell(Severity::Warning, vec![why], Some(&self.session.name()));
            return;
        }
        let is_for_another = self.is_for_another(&change);
        self.review = Some(Review::new(change.clone(), is_for_another));
        if !self.submit(HiperdriveJob::Prepare(change), services) {
            self.review = None;
        }
    }

    /// It is a profile of another device than this one.
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

    /// No limit is known from which a device would count as worn.
    pub(in crate::app) fn force_wear(&mut self, force: bool) {
        if let Some(review) = &mut self.review {
            review.force_wear = force;
        }
    }

    /// The consent: to the plan that was drawn, which has to be the one that stands in the review. Nothing moves meanwhile.
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
        let what = review.what.clone();
        let commit = Commit { prepared: (*prepared).clone(), consent: Consent::to(shown) };
        review.state = ReviewState::Writing(prepared.clone());
        self.moves.stop();
        if !self.submit(HiperdriveJob::Commit(Box::new(commit)), services) {
            if let Some(review) = &mut self.review {
                review.state = ReviewState::Ready(prepared);
            }
            return;
        }
        self.log_begin(&what, &prepared, services);
    }

    fn log_begin(&self, what: &Text, prepared: &Prepared, services: &mut Services) {
        let operations = prepared.plan.ops.iter().map(|op| explain::hiperdrive::op(op).item);
        let text = Text::new("log.begins").with_text("what", what.clone()).with_list("operations", operations);
        services.note(Severity::Note, vec![text], Some(&self.session.name()));
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

    /// A plan is there.
    pub(super) fn planned(&mut self, prepared: Box<Prepared>) {
        if let Some(review) = &mut self.review {
            review.state = ReviewState::Ready(prepared);
        }
    }

    /// A plan was carried out: what it changed is read again.
    pub(super) fn committed(&mut self, committed: Committed, services: &mut Services) {
        let (severity, texts) = told::<Hiperdrive>(&committed);
        services.tell(severity, texts, Some(&self.session.name()));
        if let Some(review) = &mut self.review
            && let ReviewState::Writing(prepared) = &review.state
        {
            review.state = ReviewState::Done(prepared.clone(), committed);
        }
        self.staged.forget_steps();
        self.submit(HiperdriveJob::Survey, services);
    }

    /// A job of the review failed; true where it says so itself.
    pub(super) fn write_failed(&mut self, error: &JobError, texts: &[Text]) -> bool {
        let begun = matches!(error, JobError::Interrupted { .. });
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
    }
}
