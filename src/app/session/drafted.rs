//! Sessions whose edits survive a crash. Each kind of device defines its edits and their key. Loading, storing and
//! discarding drafts is the same for all kinds.

#![warn(missing_docs)]

use super::drafts::DRAFT_RESTORED_ID;
use super::{DraftEdits, DraftKey, DraftOutcome, HasSession, Kind, Phase, ProfileFile, SaveRequest, Source};
use crate::app::services::Services;
use crate::app::{PendingEdits, Severity, Text, explain};
use crate::profile::ProfileDocument;
use crate::store::{DeviceKey, FileError};

const SESSION_NOT_SAVED_ID: &str = "session.not_saved";

type Edits<T> = <<T as HasSession>::Device as Kind>::Edits;

/// A session whose edits are stored as a draft.
pub trait HasDraft: HasSession {
    /// Returns the key of the device in the logbook. Returns `None` until the device has been read, and for a device
    /// without an identity.
    fn device_key(&self) -> Option<DeviceKey>;

    /// Returns the type and serial number that name the device's draft, or `None` if no data has been read.
    ///
    /// The type is included because devices of different types may have the same serial number. The serial number is
    /// empty for a device that has no identity.
    fn type_and_serial(&self) -> Option<(String, String)> {
        self.device_key().map(|key| (key.device_type, key.serial_number))
    }

    /// Returns the current edits.
    fn current_edits(&self) -> Edits<Self>;

    /// Restores the edits of a draft, omitting those that are no longer valid.
    fn take_edits(&mut self, edits: Edits<Self>);

    /// Adopts a profile that was read from its file again. Edits are kept.
    fn apply_document(&mut self, file: ProfileFile, document: ProfileDocument);

    /// Returns the edits for counting.
    fn pending_edits(&self) -> &dyn PendingEdits;

    /// Returns the edits for undo and redo.
    fn pending_mut(&mut self) -> &mut dyn PendingEdits;

    /// Discards all edits as one undo step.
    fn revert_edits(&mut self) {
        self.pending_mut().discard_all();
    }

    /// Handles a successful save of a connected device's profile.
    fn handle_profile_saved(&mut self, _document: ProfileDocument) {}

    /// Returns the key of the draft, or `None` for a device without an identity.
    fn draft_key(&self) -> Option<DraftKey> {
        match &self.session().source {
            Source::File { key, .. } => Some(DraftKey::for_file(Self::Device::KIND, key)),
            // Drafts of files are named with 16 hexadecimal digits.
            Source::New { suggested } => Some(DraftKey::for_file(Self::Device::KIND, &suggested.to_string_lossy())),
            Source::Link(_) => {
                let (device_type, serial) = self.type_and_serial()?;
                let name = || format!("{device_type}-{serial}");
                let is_virtual = self.session().is_virtual();
                (!serial.is_empty()).then(|| DraftKey::for_device(Self::Device::KIND, is_virtual, name()))
            }
        }
    }

    /// Starts a task that loads the draft of an earlier session.
    fn load_draft(&mut self, services: &Services) {
        if let Some(key) = self.draft_key() {
            self.session_mut().drafting.load(key, services);
        }
    }

    /// Handles the result of a task that reads or writes the draft.
    fn take_draft(&mut self, done: DraftOutcome, services: &mut Services) {
        let (key, name, dirty) = (self.draft_key(), self.session().name(), !self.current_edits().has_no_edits());
        if let Some(edits) = self.session_mut().drafting.handle_outcome(done, key.as_ref(), dirty, &name, services) {
            self.take_edits(edits);
            let edits = self.current_edits();
            self.session_mut().drafting.restore_edits(edits, &name, services);
        }
    }

    /// Stores the edits if they have changed. Must be called once per frame.
    fn write_draft(&mut self, services: &mut Services) {
        if !self.session().drafting.is_due() {
            return;
        }
        let (key, name, edits) = (self.draft_key(), self.session().name(), self.current_edits());
        let nameless = key.is_none() && self.type_and_serial().is_some();
        if nameless && !edits.has_no_edits() {
            self.session_mut().drafting.report_missing_draft(&name, services);
        }
        if edits.has_no_edits() {
            // The edits were written, saved or discarded.
            services.log.remove_from_window(DRAFT_RESTORED_ID, Some(&name));
        }
        self.session_mut().drafting.save(key, edits, services);
    }

    /// Returns whether the edits can be restored after the device has been closed.
    fn preserves_edits(&self) -> bool {
        self.session().drafting.is_loaded() && self.draft_key().is_some()
    }

    /// Leaves the edits of the previous device on disk, because that device is no longer open.
    fn release_draft(&mut self, services: &mut Services) {
        let (key, edits) = (self.draft_key(), self.current_edits());
        self.session_mut().drafting.leave_on_disk(key, edits, services);
    }

    /// Handles the result of writing a profile. If the profile now has another file, its old draft and any draft of
    /// that file are removed.
    fn handle_profile_written(
        &mut self,
        saving: SaveRequest,
        file: ProfileFile,
        result: Result<(), FileError>,
        services: &mut Services,
    ) {
        let name = self.session().name();
        self.session_mut().is_saving = false;
        if let Err(error) = result {
            let texts = vec![explain::file_error_text(&error), Text::new(SESSION_NOT_SAVED_ID)];
            return services.notify(Severity::Error, texts, Some(&name));
        }
        let severity = if saving.remarks.is_empty() { Severity::Good } else { Severity::Warning };
        let saved = Text::new("session.saved").with("path", saving.path.display());
        if self.session().phase != Phase::Offline {
            self.handle_profile_saved(*saving.document);
        } else {
            if saving.is_merged {
                self.revert_edits();
            }
            self.adopt_written_file(file, *saving.document, services);
        }
        // Earlier notices about this document no longer apply.
        services.log.remove_from_window(SESSION_NOT_SAVED_ID, Some(&name));
        services.log.remove_file_notices(&saving.path);
        if self.current_edits().has_no_edits() {
            services.log.remove_from_window(DRAFT_RESTORED_ID, Some(&name));
        }
        services.notify(severity, std::iter::once(saved).chain(saving.remarks).collect(), Some(&name));
    }

    /// Records that the profile is now stored in the given file.
    fn adopt_written_file(&mut self, file: ProfileFile, document: ProfileDocument, services: &mut Services) {
        let moves = !matches!(&self.session().source, Source::File { key: own, .. } if *own == file.key);
        if moves {
            let before = self.draft_key();
            self.session_mut().drafting.remove_draft(before, services);
        }
        self.apply_document(file, document);
        if moves && let Some(key) = self.draft_key() {
            self.session_mut().drafting.begin_for_profile(key, services);
        }
    }
}
