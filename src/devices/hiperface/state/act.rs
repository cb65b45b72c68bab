//! Handles the user's actions on an encoder. Edits take effect immediately. All other actions start a job or a task.

use std::time::Duration;

use super::action::HiperfaceAction;
use super::encoder::Encoder;
use super::write::with_options;
use crate::app::Text;
use crate::app::services::Services;
use crate::app::session::{HasMemory, HasProfile, Phase, SessionEvents};
use crate::devices::hiperface::jobs::HiperfaceJob;
use crate::devices::hiperface::procedures::WatchedQuantity;
use crate::devices::hiperface::profile::Item;
use crate::devices::hiperface::protocol::LineSettings;
use crate::devices::hiperface::state::explain;

/// Interval at which watched values are read. They change slowly, and reading them delays the next position.
const WATCH_INTERVAL: Duration = Duration::from_millis(500);

impl Encoder {
    pub(crate) fn handle_action(&mut self, action: HiperfaceAction, services: &mut Services) {
        match action {
            HiperfaceAction::ReadStatus => self.submit(HiperfaceJob::Status, services),
            HiperfaceAction::Watch(what, on) => self.watch_value(what, on),
            HiperfaceAction::ReadAnalogue(channel) => {
                self.submit(HiperfaceJob::Read(Item::Analogue(channel)), services)
            }
            HiperfaceAction::ReadRest => self.submit_rest_reading(services),
            HiperfaceAction::ReadCounter => self.submit(HiperfaceJob::Read(Item::Counter), services),
            HiperfaceAction::Check { restart } => {
                let then = self.stored_settings().filter(|_| restart);
                self.submit_settings_job(HiperfaceJob::Check { restart }, then, services);
            }
            HiperfaceAction::Reset => self.submit_settings_job(HiperfaceJob::Reset, self.stored_settings(), services),
            HiperfaceAction::ConfigureForNow(settings) => {
                self.submit_settings_job(HiperfaceJob::ConfigureForNow(settings), Some(settings), services);
            }
            HiperfaceAction::UseCode { number, code } => {
                if self.try_submit(HiperfaceJob::UseCode { number, code }, services) {
                    self.tried_code = Some(number);
                    self.remember_code(number, code);
                }
            }
            HiperfaceAction::Put { field, address, bytes } => self.edit_bytes(field, address, &bytes, services),
            HiperfaceAction::Revert(range) => self.staged.revert_range(range),
            HiperfaceAction::Plan(change) => self.plan(change, services),
            HiperfaceAction::PlanAgain(options) => {
                if let Some(review) = &self.session.review {
                    self.refresh_plan(with_options(&review.change, options), services);
                }
            }
            HiperfaceAction::ForceWear(force) => self.set_wear_override(force),
            HiperfaceAction::Write(plan) => self.write(plan, services),
            HiperfaceAction::CloseReview => self.close_review(),
            HiperfaceAction::Save(path) => self.save(path, services),
            HiperfaceAction::Commutation(action) => self.handle_commutation_action(action, services),
        }
    }

    /// Starts or stops polling a value in addition to the position.
    fn watch_value(&mut self, what: WatchedQuantity, on: bool) {
        let mut watched = self.record.watched_values();
        watched.retain(|own| *own != what);
        if on {
            watched.push(what);
        }
        self.record.set_watched(&watched);
        self.update_watches();
    }

    pub(super) fn update_watches(&mut self) {
        if let Some(line) = &self.session.line {
            line.watch_values(self.record.watched_values().into_iter().map(|what| (what, WATCH_INTERVAL)).collect());
        }
    }

    fn stored_settings(&self) -> Option<LineSettings> {
        self.identity.as_ref().map(|identity| identity.label.settings)
    }

    /// Submits a job that changes the line settings of the encoder.
    fn submit_settings_job(&mut self, job: HiperfaceJob, then: Option<LineSettings>, services: &mut Services) {
        if self.try_submit(job, services) {
            self.settings_after_job = then;
        }
    }

    pub(super) fn edit_bytes(&mut self, field: u8, address: usize, bytes: &[u8], services: &mut Services) {
        let allowed = match (&self.session.phase, self.field(field)) {
            _ if self.session.is_writing() => Err(Text::new("session.busy")),
            // A profile can always be edited, because the recorded write protection applies only to the encoder.
            (Phase::Offline, _) | (_, None) => Ok(()),
            (_, Some(image)) => self.edit_lock_reason(image).map_or(Ok(()), Err),
        };
        let allowed = allowed.and_then(|()| {
            let put = self.staged.edit_bytes(field, address, bytes);
            put.map_err(|error| explain::edit_error_text(&error, bytes.len(), address))
        });
        if let Err(text) = allowed {
            self.session.report_rejection(text, services);
        }
    }
}
