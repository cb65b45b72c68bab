//! Drafts, which preserve the edits in an encoder's memory across a crash.

use super::encoder::Encoder;
use crate::app::PendingEdits;
use crate::app::session::{HasDraft, HasSession, ProfileFile, Session};
use crate::devices::hiperface::jobs::Hiperface;
use crate::devices::hiperface::jobs::device_key;
use crate::devices::hiperface::profile::HiperfaceProfile;
use crate::profile::ProfileDocument;
use crate::store::DeviceKey;

/// Edited bytes, each with its field number, its index in the field and its new value.
pub(crate) type Edits = Vec<(u8, usize, u8)>;

impl HasSession for Encoder {
    type Device = Hiperface;

    fn session(&self) -> &Session<Hiperface> {
        &self.session
    }

    fn session_mut(&mut self) -> &mut Session<Hiperface> {
        &mut self.session
    }
}

impl HasDraft for Encoder {
    fn device_key(&self) -> Option<DeviceKey> {
        self.identity.as_ref().map(|identity| device_key(identity, self.session.is_virtual()))
    }

    fn type_and_serial(&self) -> Option<(String, String)> {
        let identity = self.identity.as_ref()?;
        Some((format!("{:02X}", identity.label.encoder_type), identity.serial.serial_number.clone()))
    }

    fn current_edits(&self) -> Edits {
        self.staged.edited_bytes().collect()
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
        let Some(profile) = document.body.get::<HiperfaceProfile>() else { return };
        self.staged.refresh(profile.fields.clone());
        self.session.apply_document(file, document);
    }
}
