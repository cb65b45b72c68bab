//! Writes edits or a profile to an encoder, and updates the session afterwards.

use super::commutation::Commutation;
use super::encoder::Encoder;
use super::review::Review;
use super::rules;
use crate::app::review::Permit;
use crate::app::services::Services;
use crate::app::session::{
    ApprovedReviewPlan, HasMemory, HasProfile, KnownProfile, SessionEvents, unsaved_edits_remark,
};
use crate::app::{PendingEdits, Text};
use crate::devices::hiperface::jobs::{Change, Committed, Hiperface, HiperfaceJob, Prepared};
use crate::devices::hiperface::procedures::{SaveOptions, create_profile};
use crate::devices::hiperface::profile::{HiperfaceProfile, RecordedValues, RestoreOptions, check_device};
use crate::profile::{Body, ProfileError};

impl Encoder {
    /// Prepares the plan under review again, for example because the encoder did not reply.
    pub(super) fn refresh_plan(&mut self, change: Change, services: &mut Services) {
        if self.session.is_busy() {
            return;
        }
        let Some(review) = &mut self.session.review else { return };
        *review = review.renewed(change.clone());
        if !self.try_submit(HiperfaceJob::Prepare(change), services) {
            self.session.review = None;
        }
    }
}

impl HasMemory for Encoder {
    fn edited_change(&self) -> Option<Change> {
        self.staged.is_dirty().then(|| Change::Store(self.staged.edited_ranges()))
    }

    fn is_for_other_device(&self, change: &Change) -> bool {
        let (Change::Restore { profile, .. }, Some(own)) = (change, &self.identity) else { return false };
        check_device(profile, &own.serial.serial_number, own.label.encoder_type).is_err()
    }

    fn is_for_other_type(&self, change: &Change) -> bool {
        let (Change::Restore { profile, .. }, Some(own)) = (change, &self.identity) else { return false };
        profile.identity.encoder_type != own.label.encoder_type
    }

    fn prepare_job(change: Change) -> HiperfaceJob {
        HiperfaceJob::Prepare(change)
    }

    fn commit_job(&mut self, agreed: ApprovedReviewPlan<Hiperface>) -> HiperfaceJob {
        HiperfaceJob::Commit(Box::new(agreed))
    }

    fn change_rejection(&self, change: &Change) -> Option<Text> {
        rules::check_change(&self.staged, change).err()
    }

    fn rejection_reason(&self, prepared: &Prepared) -> Option<Text> {
        rules::preserves_edits(&self.staged, &prepared.plan).err()
    }

    fn handle_executed_plan(&mut self, _: &Committed, services: &mut Services) {
        let Some(prepared) = self.open_review().and_then(Review::plan_in_progress) else { return };
        let ops = prepared.plan.ops.clone();
        self.apply_operations(&ops, services);
    }

    /// Does nothing, because the list of jobs already shows the start.
    fn log_write_start(&self, _: &Text, _: &Prepared, _: &mut Services) {}

    fn toggle_plan_permit(&mut self, permit: Permit, services: &mut Services) {
        if let Some(change) = self.open_review().and_then(|review| review.with_toggled_permit(permit)) {
            self.refresh_plan(change, services);
        }
    }

    fn discard_device_data(&mut self) {
        self.identity = None;
        self.staged.clear();
        self.check = None;
        self.unreadable.clear();
        self.position_set = None;
        self.analogue.clear();
        self.record.clear();
        self.access_codes.clear();
        self.tried_code = None;
        self.commutation = Commutation::default();
    }
}

impl HasProfile for Encoder {
    fn read_all() -> HiperfaceJob {
        HiperfaceJob::Save(SaveOptions::default())
    }

    fn edited_body(&self) -> Option<Body> {
        Some(Body::new(self.edited_profile()?))
    }

    fn last_read_profile(&self) -> Option<KnownProfile> {
        let identity = self.identity.as_ref()?;
        let fields = self.staged.device().to_vec();
        let locked = fields.iter().filter(|own| own.bytes.is_none() && !self.unreadable.contains_key(&own.number));
        let locked = locked
            .map(|own| Text::new("session.saved_locked").with("field", own.number).with("number", own.status.code()));
        let remarks = unsaved_edits_remark(self.staged.count())
            .into_iter()
            .chain(locked)
            .chain(self.unreadable.values().cloned())
            .collect();
        let recorded = RecordedValues { counter: self.counter, ..RecordedValues::default() };
        Some(Ok((Body::new(create_profile(identity, fields, recorded)), remarks)))
    }

    fn add_edits(&self, body: &mut Body) {
        if let Some(profile) = body.get_mut::<HiperfaceProfile>() {
            profile.fields = self.staged.edited_fields();
        }
    }

    fn restore_change(body: Body) -> Result<Change, ProfileError> {
        let profile = Box::new(body.into_profile()?);
        Ok(Change::Restore { profile, options: RestoreOptions::default() })
    }
}

/// Returns a restore with the given options. Any other change is returned unchanged.
pub(super) fn with_options(change: &Change, options: RestoreOptions) -> Change {
    match change {
        Change::Restore { profile, .. } => Change::Restore { profile: profile.clone(), options },
        other => other.clone(),
    }
}
