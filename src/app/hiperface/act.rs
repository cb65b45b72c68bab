//! What the user asks of an encoder, carried out: edits at once, everything else as a job on its line or a task.

use std::path::{Path, PathBuf};
use std::time::Duration;

use jiff::Timestamp;

use super::action::Action;
use super::encoder::Encoder;
use super::review::{Review, ReviewState};
use super::rules;
use crate::app::action::{FileQuestion, ReadError};
use crate::app::review::Permit;
use crate::app::services::{JobEnd, Services};
use crate::app::session::{Phase, Source};
use crate::app::{Severity, Text, explain};
use crate::bits::hex;
use crate::device::hiperface::{SaveOptions, Watch};
use crate::profile::hiperface::{FieldRange, HiperfaceProfile, Item, RestoreOptions, check_device};
use crate::profile::{Body, Consent, Document, PlanId};
use crate::protocol::hiperface::LineSettings;
use crate::worker::hiperface::{Change, Commit, HiperfaceJob};

/// How often a watched value is read: what is watched changes slowly, and the position has to wait for it.
const WATCHED_EVERY: Duration = Duration::from_millis(500);

impl Encoder {
    /// Does what is asked.
    pub(in crate::app) fn act(&mut self, action: Action, services: &mut Services) {
        match action {
            // The studio opens links, and knows other sessions.
            Action::Reconnect | Action::WriteInto(_) => {}
            Action::Read => self.read_again(services),
            Action::ReadStatus => self.submit(HiperfaceJob::Status, services),
            Action::ReadPosition => {
                let geometry = self.identity.as_ref().and_then(|identity| identity.geometry);
                self.submit(HiperfaceJob::Position(geometry), services);
            }
            Action::Poll(interval) => {
                if let Some(line) = &mut self.session.line {
                    let begins = line.polling().is_none();
                    line.poll(interval);
                    self.record.poll(interval, begins);
                }
            }
            Action::Watch(what, on) => self.watch(what, on),
            Action::ReadAnalogue(channel) => self.submit(HiperfaceJob::Read(Item::Analogue(channel)), services),
            Action::ReadRest => self.read_rest(services),
            Action::ReadCounter => self.submit(HiperfaceJob::Read(Item::Counter), services),
            Action::Check { restart } => {
                let then = self.stored_settings().filter(|_| restart);
                self.submit_to_settings(HiperfaceJob::Check { restart }, then, services);
            }
            Action::Reset => self.submit_to_settings(HiperfaceJob::Reset, self.stored_settings(), services),
            Action::ConfigureForNow(settings) => {
                self.submit_to_settings(HiperfaceJob::ConfigureForNow(settings), Some(settings), services);
            }
            Action::UseCode { number, code } => {
                if self.try_submit(HiperfaceJob::UseCode { number, code }, services) {
                    self.tried_code = Some(number);
                    self.know_code(number, code);
                }
            }
            Action::Put { field, address, bytes } => self.put(field, address, &bytes, services),
            Action::Undo => {
                self.staged.undo();
            }
            Action::Redo => {
                self.staged.redo();
            }
            Action::RevertAll => self.staged.revert(),
            Action::Revert(range) => self.staged.revert_range(range),
            Action::Review => self.review_edits(services),
            Action::Plan(change) => self.plan(change, services),
            Action::PlanAgain(options) => {
                if let Some(review) = &self.review {
                    self.plan_again(with_options(&review.change, options), services);
                }
            }
            Action::ForceWear(force) => self.force_wear(force),
            Action::Write(plan) => self.write(plan, services),
            Action::CloseReview => self.close_review(),
            Action::AskSave => {
                services.file_question =
                    Some(FileQuestion::Save { session: self.session.id, suggested: self.session.suggested_file() })
            }
            Action::Save(path) => self.save(path, services),
            Action::Commutation(action) => self.act_commutation(action, services),
            Action::Restore(path) => self.read_backup(path, services),
        }
    }

    /// Watches a value beside the position, or no more.
    fn watch(&mut self, what: Watch, on: bool) {
        let mut watched = self.record.watched();
        watched.retain(|own| *own != what);
        if on {
            watched.push(what);
        }
        self.record.watch(&watched);
        self.wish_watched();
    }

    /// Tells the session what is watched.
    pub(super) fn wish_watched(&mut self) {
        if let Some(line) = &self.session.line {
            line.watch(self.record.watched().into_iter().map(|what| (what, WATCHED_EVERY)).collect());
        }
    }

    /// Starts a job, or says why not.
    pub(super) fn submit(&mut self, job: HiperfaceJob, services: &mut Services) {
        self.try_submit(job, services);
    }

    fn stored_settings(&self) -> Option<LineSettings> {
        self.identity.as_ref().map(|identity| identity.label.settings)
    }

    /// Starts a job after which the encoder talks with other settings.
    fn submit_to_settings(&mut self, job: HiperfaceJob, then: Option<LineSettings>, services: &mut Services) {
        if self.try_submit(job, services) {
            self.settings_then = then;
        }
    }

    /// Starts a job, or says why not and gives false.
    pub(super) fn try_submit(&mut self, job: HiperfaceJob, services: &mut Services) -> bool {
        let what = what(&job);
        let writes = matches!(job, HiperfaceJob::Commit(_));
        let asked = match &job {
            HiperfaceJob::Read(item) => Some(*item),
            _ => None,
        };
        let begun = self.session.submit(job, what, writes, services);
        if begun {
            self.asked = asked;
            self.settings_then = None;
        }
        begun
    }

    fn read_again(&mut self, services: &mut Services) {
        if !self.session.read_file_again(services) {
            self.read_encoder(services);
        }
    }

    pub(super) fn put(&mut self, field: u8, address: usize, bytes: &[u8], services: &mut Services) {
        let allowed = match (&self.session.phase, self.field(field)) {
            _ if self.session.is_writing() => Err(Text::new("session.busy")),
            // A profile is a text: what it says about protection does not protect it.
            (Phase::Offline, _) | (_, None) => Ok(()),
            (_, Some(image)) => rules::edit(image),
        };
        let allowed = allowed.and_then(|()| {
            let put = self.staged.put(field, address, bytes);
            put.map_err(|error| explain::hiperface::staged(&error, bytes.len(), address))
        });
        if let Err(text) = allowed {
            services.tell(Severity::Error, vec![text], Some(&self.session.name()));
        }
    }

    fn review_edits(&mut self, services: &mut Services) {
        if !self.staged.is_dirty() {
            services.tell(Severity::Note, vec![Text::new("session.nothing_edited")], Some(&self.session.name()));
            return;
        }
        let edits: Vec<(FieldRange, Vec<u8>)> = self.staged.changed_runs();
        self.plan(Change::Store(edits), services);
    }

    pub(super) fn plan(&mut self, change: Change, services: &mut Services) {
        if let Some(why) = self.session.why_not_ready() {
            services.tell(Severity::Warning, vec![why], Some(&self.session.name()));
            return;
        }
        let is_for_another = self.is_for_another(&change);
        let mut review = Review::new(change.clone(), is_for_another);
        if let Err(why) = rules::change(&self.staged, &change) {
            review.fail(vec![why], false);
            self.review = Some(review);
            return;
        }
        self.review = Some(review);
        if !self.try_submit(HiperfaceJob::Prepare(change), services) {
            self.review = None;
        }
    }

    /// It is a profile of another encoder than this one.
    fn is_for_another(&self, change: &Change) -> bool {
        let (Change::Restore { profile, .. }, Some(own)) = (change, &self.identity) else { return false };
        check_device(profile, &own.serial.serial_number, own.label.encoder_type).is_err()
    }

    /// Makes the plan of the review anew; an encoder that did not answer is asked again.
    fn plan_again(&mut self, change: Change, services: &mut Services) {
        if self.session.is_busy() {
            return;
        }
        let Some(review) = &mut self.review else { return };
        *review = Review::new(change.clone(), review.is_for_another);
        if !self.try_submit(HiperfaceJob::Prepare(change), services) {
            self.review = None;
        }
    }

    pub(in crate::app) fn plan_restore(&mut self, profile: HiperfaceProfile, services: &mut Services) {
        let options = RestoreOptions::default();
        self.plan(Change::Restore { profile: Box::new(profile), options }, services);
    }

    /// Makes the plan again with one of the review's toggles the other way round.
    pub(in crate::app) fn plan_with(&mut self, permit: Permit, services: &mut Services) {
        if let Some(change) = self.review.as_ref().and_then(|review| review.toggled(permit)) {
            self.plan_again(change, services);
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
        let commit =
            Commit { prepared: (*prepared).clone(), consent: Consent::to(shown), force_wear: review.force_wear };
        review.state = ReviewState::Writing(prepared.clone());
        if !self.try_submit(HiperfaceJob::Commit(Box::new(commit)), services)
            && let Some(review) = &mut self.review
        {
            review.state = ReviewState::Ready(prepared);
        }
    }

    /// Closes the review; what is being written goes on, and its review stays.
    pub(in crate::app) fn close_review(&mut self) {
        let Some(review) = &self.review else { return };
        if review.is_writing() {
            return;
        }
        if matches!(review.state, ReviewState::Planning)
            && let Some(line) = &mut self.session.line
        {
            line.stop();
        }
        self.review = None;
    }

    /// A connected encoder is read again for it; a profile is written as it is edited.
    pub(in crate::app) fn save(&mut self, path: PathBuf, services: &mut Services) {
        match &self.session.source {
            Source::Link(_) | Source::New { .. } => {
                if self.try_submit(HiperfaceJob::Save(SaveOptions::default()), services) {
                    self.session.save_to = Some(path);
                }
            }
            Source::File { document, .. } => {
                let mut document = (**document).clone();
                let Body::Hiperface(profile) = &mut document.body else { return };
                profile.fields = self.staged.wanted();
                profile.mark_mounting();
                self.session.write_document(path, document, Vec::new(), services);
            }
        }
    }

    fn read_backup(&mut self, path: PathBuf, services: &mut Services) {
        match self.key() {
            Some(of) => self.session.read_backup(of, path, services),
            None => {
                let text = Text::new("session.not_connected");
                services.tell(Severity::Error, vec![text], Some(&self.session.name()));
            }
        }
    }

    /// A backup was read, or not.
    pub(in crate::app) fn take_backup(
        &mut self,
        path: &Path,
        result: Result<Box<Document>, ReadError>,
        services: &mut Services,
    ) {
        match result.and_then(|document| document.body.into_hiperface().map_err(ReadError::Profile)) {
            Ok(profile) => self.plan_restore(profile, services),
            Err(error) => {
                let text = crate::app::documents::read_error(path, &error);
                services.tell(Severity::Error, vec![text], Some(&self.session.name()));
            }
        }
    }

    /// The connection is gone; what is known and edited stays.
    pub(in crate::app) fn lose(&mut self, why: Text, services: &mut Services) {
        // What passed at last says most about why it was the last.
        self.take_samples_and_frames();
        self.forget_asked();
        self.session.lose(why.clone(), services);
        if let Some(review) = self.review.as_mut().filter(|review| review.is_writing()) {
            review.fail(vec![why], true);
        }
    }

    /// Lets its thread go; what runs ends as `end` says, and a plan is none any more.
    pub(in crate::app) fn let_go(&mut self, end: JobEnd, services: &mut Services) {
        self.forget_asked();
        self.session.let_go(end, services);
    }

    /// What was asked for on the line does not come any more.
    fn forget_asked(&mut self) {
        self.asked = None;
        self.give_up_rest();
        if self.review.as_ref().is_some_and(Review::is_plan) {
            self.review = None;
        }
    }
}

/// A restore with other options; any other change as it is.
fn with_options(change: &Change, options: RestoreOptions) -> Change {
    match change {
        Change::Restore { profile, .. } => Change::Restore { profile: profile.clone(), options },
        other => other.clone(),
    }
}

/// A profile of now.
pub(super) fn document_of(profile: HiperfaceProfile) -> Document {
    let now = Timestamp::now();
    let seconds = Timestamp::from_second(now.as_second()).unwrap_or(now);
    Document::new(seconds.to_string(), Body::Hiperface(profile))
}

/// A job in words.
fn what(job: &HiperfaceJob) -> Text {
    match job {
        HiperfaceJob::Identify | HiperfaceJob::Survey => Text::new("job.survey"),
        HiperfaceJob::Status => Text::new("job.status"),
        HiperfaceJob::Position(_) => Text::new("job.position"),
        HiperfaceJob::Rest => Text::new("job.rest"),
        HiperfaceJob::Read(item) => Text::new("job.read").with_text("item", explain::phrase(&item.to_string())),
        HiperfaceJob::Save(_) => Text::new("job.save"),
        HiperfaceJob::Check { .. } => Text::new("job.check"),
        HiperfaceJob::Reset => Text::new("job.reset"),
        HiperfaceJob::Find(_) => Text::new("job.find"),
        HiperfaceJob::ConfigureForNow(settings) => {
            Text::new("job.configure_for_now").with("settings", hex(&[settings.byte()]))
        }
        HiperfaceJob::UseCode { number, .. } => Text::new("job.use_code").with("number", number),
        HiperfaceJob::Prepare(change) => {
            Text::new("job.prepare").with_text("change", explain::hiperface::change(change))
        }
        HiperfaceJob::Commit(_) => Text::new("job.write"),
    }
}
