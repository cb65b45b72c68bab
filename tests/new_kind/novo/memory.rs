//! Edits of a Novo encoder, which can be preserved after a crash, reviewed, written, saved and restored.

use encoder_studio::app::review::{OperationDescription, Permit, Reviewable};
use encoder_studio::app::session::{
    ApprovedReviewPlan, HasDraft, HasMemory, HasProfile, KnownProfile, ProfileFile, unsaved_edits_remark,
};
use encoder_studio::app::{PendingEdits, Text, explain};
use encoder_studio::profile::{Body, ProfileDocument, ProfileError, WrittenChanges};
use encoder_studio::store::DeviceKey;

use super::jobs::{Change, Job, Novo, Prepared, device_key};
use super::profile::{NovoProfile, Op};
use super::state::{Encoder, TEXTS};

impl Reviewable for Novo {
    type Change = Change;
    type Prepared = Prepared;
    type Written = WrittenChanges;

    fn change_title(change: &Change) -> Text {
        match change.restored {
            Some(serial) => TEXTS.text("novo.restore").with("serial", serial),
            None => TEXTS.text("novo.write"),
        }
    }
    fn permit_flag(change: &mut Change, permit: Permit) -> Option<&mut bool> {
        change.restored?;
        permit.restore_option(&mut change.options)
    }
    fn operation_texts(_: &Prepared, op: &Op) -> OperationDescription {
        OperationDescription::single(
            explain::literal_text(op.name()),
            explain::literal_text(op.from),
            explain::literal_text(op.to),
        )
    }
    fn cost_text(prepared: &Prepared) -> Text {
        TEXTS.text("novo.cost").with("cycles", prepared.plan.write_cycles())
    }
    fn written_text(written: &WrittenChanges) -> Text {
        TEXTS.text("novo.written").with("count", written.verified)
    }
}

impl HasDraft for Encoder {
    fn device_key(&self) -> Option<DeviceKey> {
        self.read().map(|own| device_key(own.serial, self.session.is_virtual()))
    }
    fn current_edits(&self) -> Vec<(usize, u16)> {
        self.staged.iter().collect()
    }
    fn take_edits(&mut self, edits: Vec<(usize, u16)>) {
        self.staged.edit_values(edits);
    }
    fn apply_document(&mut self, file: ProfileFile, document: ProfileDocument) {
        let Some(profile) = document.body.get::<NovoProfile>().cloned() else { return };
        self.take(profile);
        self.session.apply_document(file, document);
    }
    fn pending_edits(&self) -> &dyn PendingEdits {
        &self.staged
    }
    fn pending_mut(&mut self) -> &mut dyn PendingEdits {
        &mut self.staged
    }
}

impl HasMemory for Encoder {
    fn edited_change(&self) -> Option<Change> {
        let values = self.wanted().filter(|_| self.staged.is_dirty())?;
        Some(Change { restored: None, values, options: Default::default() })
    }
    fn is_for_other_device(&self, change: &Change) -> bool {
        change.restored.zip(self.read()).is_some_and(|(of, own)| of != own.serial)
    }
    fn prepare_job(change: Change) -> Job {
        Job::Prepare(change)
    }
    fn commit_job(&mut self, agreed: ApprovedReviewPlan<Novo>) -> Job {
        Job::Commit(Box::new(agreed))
    }
    fn discard_device_data(&mut self) {
        self.staged.clear();
        self.track.discard_short_recording();
    }
}

impl HasProfile for Encoder {
    fn read_all() -> Job {
        Job::Survey
    }
    fn edited_body(&self) -> Option<Body> {
        Some(Body::new(NovoProfile { values: self.wanted()?, ..self.read()?.clone() }))
    }
    fn last_read_profile(&self) -> Option<KnownProfile> {
        let remarks = unsaved_edits_remark(self.staged.count()).into_iter().collect();
        Some(Ok((Body::new(self.read()?.clone()), remarks)))
    }
    fn restore_change(body: Body) -> Result<Change, ProfileError> {
        let NovoProfile { serial, values } = body.into_profile()?;
        Ok(Change { restored: Some(serial), values, options: Default::default() })
    }
}
