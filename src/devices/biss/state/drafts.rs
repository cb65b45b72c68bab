//! Drafts of edits in an encoder's data areas, which survive a crash. Each edit is stored as a global address and a
//! byte.

use super::encoder::Encoder;
use crate::app::PendingEdits;
use crate::app::session::{HasDraft, HasSession, ProfileFile, Session};
use crate::devices::biss::jobs::Biss;
use crate::devices::biss::jobs::device_key;
use crate::devices::biss::profile::BissProfile;
use crate::profile::ProfileDocument;
use crate::store::DeviceKey;

/// Edited bytes, each with its global address.
pub(crate) type Edits = Vec<(u16, u8)>;

impl HasSession for Encoder {
    type Device = Biss;

    fn session(&self) -> &Session<Biss> {
        &self.session
    }

    fn session_mut(&mut self) -> &mut Session<Biss> {
        &mut self.session
    }
}

impl HasDraft for Encoder {
    fn device_key(&self) -> Option<DeviceKey> {
        self.identity().map(|identity| device_key(identity, self.session.is_virtual()))
    }

    fn current_edits(&self) -> Edits {
        self.memory.draft_edits()
    }

    fn take_edits(&mut self, edits: Edits) {
        self.memory.take_draft(edits);
    }

    fn pending_edits(&self) -> &dyn PendingEdits {
        &self.memory
    }

    fn pending_mut(&mut self) -> &mut dyn PendingEdits {
        &mut self.memory
    }

    fn apply_document(&mut self, file: ProfileFile, document: ProfileDocument) {
        let Some(profile) = document.body.get::<BissProfile>() else { return };
        self.load_profile(profile);
        self.session.apply_document(file, document);
    }
}
