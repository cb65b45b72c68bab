//! Saves parameter and cam edits so that they survive a crash.

use super::encoder::Encoder;
use super::staged::SavedEdit;
use crate::app::PendingEdits;
use crate::app::session::{HasDraft, HasSession, ProfileFile, Session};
use crate::devices::interbus::jobs::Interbus;
use crate::devices::interbus::jobs::device_key;
use crate::devices::interbus::profile::InterbusProfile;
use crate::profile::ProfileDocument;
use crate::store::DeviceKey;

pub(crate) type Edits = Vec<SavedEdit>;

impl HasSession for Encoder {
    type Device = Interbus;

    fn session(&self) -> &Session<Interbus> {
        &self.session
    }

    fn session_mut(&mut self) -> &mut Session<Interbus> {
        &mut self.session
    }
}

impl HasDraft for Encoder {
    fn device_key(&self) -> Option<DeviceKey> {
        self.identity().map(|identity| device_key(identity, self.session.is_virtual()))
    }

    fn current_edits(&self) -> Edits {
        self.staged.draft_edits()
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
        let Some(profile) = document.body.get::<InterbusProfile>() else { return };
        self.staged.adopt_saved(profile.image.clone(), profile.names.clone());
        self.session.apply_document(file, document);
    }
}
