//! Parameter edits that survive a crash.

use super::staged::SavedEdit;
use super::unit::HiperdriveDevice;
use crate::app::PendingEdits;
use crate::app::session::{HasDraft, HasSession, ProfileFile, Session};
use crate::devices::hiperdrive::jobs::Hiperdrive;
use crate::devices::hiperdrive::jobs::device_key;
use crate::devices::hiperdrive::profile::HiperdriveProfile;
use crate::profile::ProfileDocument;
use crate::store::DeviceKey;

pub(crate) type Edits = Vec<SavedEdit>;

impl HasSession for HiperdriveDevice {
    type Device = Hiperdrive;

    fn session(&self) -> &Session<Hiperdrive> {
        &self.session
    }

    fn session_mut(&mut self) -> &mut Session<Hiperdrive> {
        &mut self.session
    }
}

impl HasDraft for HiperdriveDevice {
    fn device_key(&self) -> Option<DeviceKey> {
        self.identity().map(|identity| device_key(identity, self.session.is_virtual()))
    }

    fn current_edits(&self) -> Edits {
        self.staged.saved_edits()
    }

    fn take_edits(&mut self, edits: Edits) {
        self.staged.take_draft(edits);
    }

    fn pending_edits(&self) -> &dyn PendingEdits {
        &self.staged
    }

    fn pending_mut(&mut self) -> &mut dyn PendingEdits {
        &mut self.staged
    }

    fn apply_document(&mut self, file: ProfileFile, document: ProfileDocument) {
        let Some(profile) = document.body.get::<HiperdriveProfile>() else { return };
        self.staged.adopt_saved(profile.image.clone());
        self.session.apply_document(file, document);
    }
}
