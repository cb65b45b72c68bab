//! Writes to device memory, which the user reviews first. A change leads to a plan, and a job executes the approved
//! plan. Each kind of device defines its own changes, plans and jobs, and the further effects of a write.

#![warn(missing_docs)]

use super::{HasDraft, HasSession, Interruption, Kind, SessionEvents};
use crate::app::review::{
    self, OperationDescription, Permit, Review, ReviewSheet, ReviewState, Reviewable, UndoneEntry,
    write_result_messages,
};
use crate::app::services::Services;
use crate::app::{Severity, Text};
use crate::profile::{Consent, PlanId};
use crate::worker::commit::PlannedWrite as _;
use crate::worker::{self, Device, JobInterruption as _};

type Job<T> = <<T as HasSession>::Device as Device>::Job;
type Error<T> = <<T as HasSession>::Device as Device>::Error;
type Change<T> = <<T as HasSession>::Device as Reviewable>::Change;
type Op<T> = review::Op<<T as HasSession>::Device>;
type Prepared<T> = <<T as HasSession>::Device as Reviewable>::Prepared;
type Committed<T> = worker::CommitResult<<<T as HasSession>::Device as Reviewable>::Written>;

/// A plan that the user has approved.
pub type ApprovedReviewPlan<K> = worker::commit::ApprovedPlan<<K as Reviewable>::Prepared>;

/// A device with writable memory.
pub trait HasMemory: SessionEvents + HasDraft + HasSession<Device: Reviewable> {
    /// Returns the open review, if any.
    fn open_review(&self) -> Option<&Review<Self::Device>> {
        self.session().review.as_ref()
    }

    /// Returns the open review, mutably.
    fn review_mut(&mut self) -> &mut Option<Review<Self::Device>> {
        &mut self.session_mut().review
    }

    /// Describes an operation of a plan.
    fn operation_texts(&self, prepared: &Prepared<Self>, op: &Op<Self>) -> OperationDescription {
        Self::Device::operation_texts(prepared, op)
    }

    /// Returns the review in displayable form, after `done` completed operations.
    fn review_sheet(&self, done: usize) -> Option<ReviewSheet> {
        self.open_review().map(|review| review.review_sheet(done, |prepared, op| self.operation_texts(prepared, op)))
    }

    /// Returns the change that writes the edits, if any.
    fn edited_change(&self) -> Option<Change<Self>>;

    /// Returns whether a change was made for a device other than the connected one.
    fn is_for_other_device(&self, change: &Change<Self>) -> bool;

    /// Returns whether a change was made for another type of device. The default is for kinds of devices that need no
    /// separate permission in this case.
    fn is_for_other_type(&self, _change: &Change<Self>) -> bool {
        false
    }

    /// Returns whether a plan was made for a device other than the one last read.
    fn targets_other_device(&self, prepared: &Prepared<Self>) -> bool {
        self.device_key().is_some_and(|own| own != prepared.device(own.is_virtual))
    }

    /// Creates the job that makes the plan for a change.
    fn prepare_job(change: Change<Self>) -> Job<Self>;

    /// Creates the job that executes an approved plan.
    fn commit_job(&mut self, agreed: ApprovedReviewPlan<Self::Device>) -> Job<Self>;

    /// Discards all data about the previous device after a different device has replied.
    fn discard_device_data(&mut self);

    /// Prepares data that are needed to display a review.
    fn prepare_review(&mut self) {}

    /// Returns the reason why a change is impossible, if this is known without asking the device.
    fn change_rejection(&self, _change: &Change<Self>) -> Option<Text> {
        None
    }

    /// Returns the reason why a plan cannot be executed, if any.
    fn rejection_reason(&self, _prepared: &Prepared<Self>) -> Option<Text> {
        None
    }

    /// Marks the values changed by the plan as unread, so that they are read again. Called however the plan ends.
    fn schedule_rereads(&mut self) {}

    /// Handles the result of an executed plan.
    fn handle_executed_plan(&mut self, _committed: &Committed<Self>, _services: &mut Services) {}

    /// Logs the start of a write and the items to be written.
    fn log_write_start(&self, what: &Text, prepared: &Prepared<Self>, services: &mut Services) {
        let ops = &prepared.plan().ops;
        let operations = ops.iter().map(|op| Self::Device::operation_texts(prepared, op).item);
        let text = Text::new("log.begins").with_text("what", what.clone()).with_list("operations", operations);
        services.log_without_display(Severity::Note, vec![text], Some(&self.session().name()));
    }

    /// Opens the review of writing the edits, and requests its plan.
    fn review_edits(&mut self, services: &mut Services) {
        match self.edited_change() {
            Some(change) => self.plan(change, services),
            None => {
                let text = Text::new("session.nothing_edited");
                services.notify(Severity::Note, vec![text], Some(&self.session().name()));
            }
        }
    }

    /// Opens the review of a change, and requests its plan.
    fn plan(&mut self, change: Change<Self>, services: &mut Services) {
        let review = Review::new(change.clone(), self.is_for_other_device(&change), self.is_for_other_type(&change));
        self.request_plan(change, review, services);
    }

    /// Opens the review of undoing a logbook entry, and requests its plan.
    fn plan_undo(&mut self, change: Change<Self>, undone: UndoneEntry, services: &mut Services) {
        let review = Review::new(change.clone(), self.is_for_other_device(&change), self.is_for_other_type(&change));
        self.request_plan(change, review.undoing(undone), services);
    }

    /// Opens a review, and requests its plan.
    fn request_plan(&mut self, change: Change<Self>, review: Review<Self::Device>, services: &mut Services) {
        self.prepare_review();
        if let Some(why) = self.session().plan_obstacle() {
            return services.notify(Severity::Warning, vec![why], Some(&self.session().name()));
        }
        let objection = self.change_rejection(&change);
        let review = self.review_mut().insert(review);
        if let Some(why) = objection {
            return review.abort(vec![why], false, 0);
        }
        if !self.try_submit(Self::prepare_job(change), services) {
            *self.review_mut() = None;
        }
    }

    /// Requests the plan again after the user has granted or withdrawn a permission for the write.
    fn toggle_plan_permit(&mut self, permit: Permit, services: &mut Services) {
        if self.session().is_busy() {
            return;
        }
        if let Some(change) = self.open_review().and_then(|review| review.with_toggled_permit(permit)) {
            self.plan(change, services);
        }
    }

    /// Sets whether to write although the device has reached its limit of write cycles.
    fn set_wear_override(&mut self, force: bool) {
        if let Some(review) = self.review_mut() {
            review.force_wear = force;
        }
    }

    /// Adds a plan to its review. If another device has replied, the plan is discarded, because the change was meant
    /// for the previous device.
    fn adopt_plan(&mut self, prepared: Box<Prepared<Self>>, services: &mut Services) {
        if self.targets_other_device(&prepared) {
            *self.review_mut() = None;
            // If there are edits, the user was told about the new device when it was read.
            if !self.pending_edits().is_dirty() {
                let serial = prepared.device(self.session().is_virtual()).serial_number;
                let text = Text::new("session.plan_of_another").with("serial", serial);
                services.notify(Severity::Warning, vec![text], Some(&self.session().name()));
            }
            return self.submit(Self::Device::survey_job(), services);
        }
        let objection = self.rejection_reason(&prepared);
        let Some(review) = self.review_mut() else { return };
        match objection {
            None => review.adopt_plan(prepared),
            Some(why) => review.abort(vec![why], false, 0),
        }
    }

    /// Handles the replacement of the device by another one. Edits stay on disk if the previous device has a serial
    /// number.
    fn handle_device_replacement(&mut self, serial: &str, services: &mut Services) {
        if self.pending_edits().is_dirty() {
            let is_kept = self.type_and_serial().is_some_and(|(_, serial)| !serial.is_empty());
            let text = if is_kept { "session.other_encoder" } else { "session.edits_gone" };
            let text = Text::new(text).with("serial", serial);
            services.notify(Severity::Warning, vec![text], Some(&self.session().name()));
        }
        self.release_draft(services);
        self.discard_device_data();
        *self.review_mut() = None;
        self.session_mut().discard_device_data();
    }

    /// Executes the plan that the user has reviewed.
    fn write(&mut self, shown: PlanId, services: &mut Services) {
        if let Some(agreed) = self.approve_plan(shown) {
            let job = self.commit_job(agreed);
            self.begin_write(job, services);
        }
    }

    /// Approves the plan shown to the user, if it is still the plan under review.
    fn approve_plan(&self, shown: PlanId) -> Option<ApprovedReviewPlan<Self::Device>> {
        let review = self.open_review().filter(|_| self.session().is_ready())?;
        let ReviewState::Ready(prepared) = &review.state else { return None };
        let is_shown = prepared.plan().id() == shown;
        is_shown.then(|| worker::commit::ApprovedPlan {
            prepared: (**prepared).clone(),
            consent: Consent::to(shown),
            force_wear: review.force_wear,
            undoes: review.undone_entry().cloned(),
        })
    }

    /// Starts the job that executes the plan under review. Returns `false` if the job cannot be started.
    fn begin_write(&mut self, job: Job<Self>, services: &mut Services) -> bool {
        let Some(review) = self.review_mut() else { return false };
        let ReviewState::Ready(prepared) = &review.state else { return false };
        let (prepared, what) = (prepared.clone(), review.title.clone());
        review.state = ReviewState::Writing(prepared.clone());
        let begins = self.try_submit(job, services);
        if begins {
            self.log_write_start(&what, &prepared, services);
        } else if let Some(review) = self.review_mut() {
            review.state = ReviewState::Ready(prepared);
        }
        begins
    }

    /// Closes the review. A write in progress continues and keeps its review.
    fn close_review(&mut self) {
        let Some(review) = self.open_review().filter(|review| !review.is_writing()) else { return };
        let is_planning = review.is_planning();
        if let Some(line) = self.session_mut().line.as_mut().filter(|_| is_planning) {
            line.stop_job();
        }
        *self.review_mut() = None;
    }

    /// Handles the end of an executed plan and reads the device again.
    fn handle_commit_end(&mut self, committed: Committed<Self>, services: &mut Services) {
        let (severity, texts) = write_result_messages::<Self::Device>(&committed);
        let (name, stands) = (self.session().name(), self.open_review().is_some_and(Review::is_writing));
        // A successful result remains in the review until the user closes it.
        if severity == Severity::Good && stands {
            services.log_without_display(severity, texts, Some(&name));
        } else {
            services.notify(severity, texts, Some(&name));
        }
        self.pending_mut().clear_undo_steps();
        self.schedule_rereads();
        self.handle_executed_plan(&committed, services);
        if let Some(review) = self.review_mut()
            && let ReviewState::Writing(prepared) = &review.state
        {
            review.state = ReviewState::Done(prepared.clone(), committed);
        }
        self.submit(Self::Device::survey_job(), services);
    }

    /// Handles the interruption of a plan, and returns whether the review reports it. If the user cancels while the
    /// plan is being made, the review closes.
    fn handle_interrupted_write(&mut self, how: Interruption<Error<Self>>, texts: &[Text]) -> bool {
        let Some(review) = self.open_review() else { return false };
        let (begun, done) = match (how, review.is_planning(), review.is_writing()) {
            (_, false, false) | (Interruption::Lost, _, false) => return false,
            (Interruption::Cancelled(_), true, _) => {
                *self.review_mut() = None;
                return false;
            }
            // The number of completed operations is not known.
            (Interruption::Lost, ..) => (true, 0),
            (Interruption::Failed(error) | Interruption::Cancelled(error), ..) => {
                let done = error.operations_done();
                if done.is_some() {
                    self.schedule_rereads();
                }
                (done.is_some(), done.unwrap_or(0))
            }
        };
        if let Some(review) = self.review_mut() {
            review.abort(texts.to_vec(), begun, done);
        }
        true
    }

    /// Discards a plan that has not been started, with its review.
    fn discard_plan(&mut self) {
        if self.open_review().is_some_and(Review::has_pending_plan) {
            *self.review_mut() = None;
        }
    }
}
