//! Writing to a device: requests to write edits or a profile, and the jobs that result from them.

use super::format;
use super::record::Record;
use super::review::{Review, operation_texts};
use super::ruler::PositionUnit;
use super::unit::HiperdriveDevice;
use super::unsaved::UnsavedChanges;
use crate::app::review::OperationDescription;
use crate::app::services::Services;
use crate::app::session::{
    ApprovedReviewPlan, HasMemory, HasProfile, KnownProfile, truncated_list, unsaved_edits_remark,
};
use crate::app::{PendingEdits, Text};
use crate::devices::hiperdrive::jobs::{Change, Committed, Hiperdrive, HiperdriveJob, Prepared};
use crate::devices::hiperdrive::profile::{
    HiperdriveProfile, Image, Item, Op, RestoreOptions, check_device, type_differences,
};
use crate::devices::hiperdrive::state::explain as explained;
use crate::profile::{Body, ProfileError};

impl HiperdriveDevice {}

impl HasMemory for HiperdriveDevice {
    fn operation_texts(&self, prepared: &Prepared, op: &Op) -> OperationDescription {
        operation_texts(prepared, op, |drive| self.spindle_pitch(drive))
    }

    fn edited_change(&self) -> Option<Change> {
        let edited = self.staged.changed_values();
        (!edited.values.is_empty()).then(|| Change::Write(Box::new(edited)))
    }

    fn is_for_other_device(&self, change: &Change) -> bool {
        let (Change::Restore { profile, .. }, Some(own)) = (change, self.identity()) else { return false };
        check_device(profile, &own.profile()).is_err()
    }

    fn is_for_other_type(&self, change: &Change) -> bool {
        let (Change::Restore { profile, .. }, Some(own)) = (change, self.identity()) else { return false };
        !type_differences(&profile.identity, &own.profile()).is_empty()
    }

    fn prepare_job(change: Change) -> HiperdriveJob {
        HiperdriveJob::Prepare(change)
    }

    /// Stops all motion and returns the job that executes the approved plan.
    fn commit_job(&mut self, agreed: ApprovedReviewPlan<Hiperdrive>) -> HiperdriveJob {
        self.moves.stop();
        self.unsaved.begin_plan(&agreed.prepared.plan);
        HiperdriveJob::Commit(Box::new(agreed))
    }

    fn handle_executed_plan(&mut self, _: &Committed, _: &mut Services) {
        if let Some(prepared) = self.session.review.as_ref().and_then(Review::plan_in_progress) {
            self.unsaved.finish_plan(&prepared.plan);
        }
    }

    fn prepare_review(&mut self) {
        self.moves.end_held_action();
    }

    fn discard_device_data(&mut self) {
        (self.survey, self.status, self.check, self.refusal) = (None, None, None, None);
        self.staged.clear();
        self.moves.clear();
        self.record.clear();
        self.records.values_mut().for_each(Record::clear);
        self.records.retain(|_, record| !record.track.recorder.is_empty());
        self.readings.clear();
        self.pitches.clear();
        self.axes.clear();
        self.unsaved = UnsavedChanges::default();
        (self.exchanged, self.measure) = (None, PositionUnit::default());
    }
}

impl HasProfile for HiperdriveDevice {
    fn read_all() -> HiperdriveJob {
        HiperdriveJob::Save
    }

    fn edited_body(&self) -> Option<Body> {
        Some(Body::new(self.edited_profile()?))
    }

    fn save_remarks(&self) -> Vec<Text> {
        truncated_list(&self.findings(), format::finding_text)
    }

    fn last_read_profile(&self) -> Option<KnownProfile> {
        let (survey, base) = (self.survey.as_ref()?, self.staged.base()?);
        // Values that the device rejects are never part of a profile. Values of the wrong length should have been part
        // of this one.
        let missing: Vec<Text> =
            survey.wrong_lengths.iter().map(|own| explained::item_text(Item(own.number))).collect();
        if !missing.is_empty() {
            return Some(Err(missing));
        }
        let kept = survey.identity.stored_parameters().filter_map(|number| Some((number, base.get(number)?)));
        let image = Image { values: kept.collect() };
        let profile = HiperdriveProfile::from_image(survey.identity.profile(), image);
        let remarks = unsaved_edits_remark(self.staged.count()).into_iter().collect();
        Some(Ok((Body::new(profile), remarks)))
    }

    fn add_edits(&self, body: &mut Body) {
        if let Some(profile) = body.get_mut::<HiperdriveProfile>() {
            profile.image.values.iter_mut().for_each(|(number, value)| {
                *value = self.staged.value(*number).unwrap_or(*value);
            });
        }
    }

    fn restore_change(body: Body) -> Result<Change, ProfileError> {
        let profile = Box::new(body.into_profile()?);
        Ok(Change::Restore { profile, options: RestoreOptions::default() })
    }
}
