//! Device memory as a profile: saving, restoring and backing up.

use std::path::{Path, PathBuf};

use super::{HasMemory, HasSession, Phase, Source};
use crate::app::action::{BackupReadResult, ReadError};
use crate::app::documents::{new_document, read_error, read_only_reason};
use crate::app::review::{Reviewable, UndoneEntry};
use crate::app::services::Services;
use crate::app::{Severity, Text};
use crate::profile::{Body, ProfileError};
use crate::store::Entry;
use crate::worker::Device;

type Job<T> = <<T as HasSession>::Device as Device>::Job;
type Change<T> = <<T as HasSession>::Device as Reviewable>::Change;

/// A profile made from earlier readings, with remarks, or a message for each missing part.
pub type KnownProfile = Result<(Body, Vec<Text>), Vec<Text>>;

/// Returns the remark that some edits are not saved, if there are any.
pub fn unsaved_edits_remark(count: usize) -> Option<Text> {
    (count > 0).then(|| Text::new("session.saved_without").with("count", count))
}

pub trait HasProfile: HasMemory {
    /// Creates the job that reads everything a profile can restore.
    fn read_all() -> Job<Self>;

    /// Returns the edited profile, or `None` if the session is a device.
    fn edited_body(&self) -> Option<Body>;

    /// Returns a profile made from earlier readings, with remarks, or `None` if no data has been read.
    ///
    /// # Errors
    /// Returns a message for each part of a profile that was not read.
    fn last_read_profile(&self) -> Option<KnownProfile>;

    /// Replaces values in a profile of earlier readings with the edited ones.
    fn add_edits(&self, _profile: &mut Body) {}

    /// Returns whether a save uses earlier readings, because the device no longer replies.
    fn saves_last_reading(&self) -> bool {
        matches!(self.session().phase, Phase::Lost(_) | Phase::Silent(_)) && self.last_read_profile().is_some()
    }

    /// Returns the change that restores a profile.
    ///
    /// # Errors
    /// Returns an error if the profile belongs to another kind of device.
    fn restore_change(body: Body) -> Result<Change<Self>, ProfileError>;

    /// Opens the review of restoring a profile, and requests its plan.
    ///
    /// # Errors
    /// Returns an error if the profile belongs to another kind of device.
    fn restore(&mut self, body: Body, services: &mut Services) -> Result<(), ProfileError> {
        self.plan(Self::restore_change(body)?, services);
        Ok(())
    }

    /// Opens the review of undoing a logbook entry, and requests its plan. `backup` is the entry's backup.
    ///
    /// # Errors
    /// Returns an error if the backup belongs to another kind of device.
    fn undo(&mut self, entry: &Entry, mut backup: Body, services: &mut Services) -> Result<(), ProfileError> {
        match UndoneEntry::new(entry, &mut backup, services.world.kinds) {
            Ok(undone) => self.plan_undo(Self::restore_change(backup)?, undone, services),
            Err(texts) => services.notify(Severity::Error, texts, Some(&self.session().name())),
        }
        Ok(())
    }

    /// Returns the remarks shown when the edited profile is saved.
    fn save_remarks(&self) -> Vec<Text> {
        Vec::new()
    }

    /// Saves a profile. An open profile is saved with its edits. A connected device is read again first; if it no
    /// longer replies, earlier readings are saved.
    fn save(&mut self, path: PathBuf, services: &mut Services) {
        if let Some(refusal) = read_only_reason(&self.session().source) {
            self.session().report_rejection(refusal, services);
        } else if let Source::File { document, .. } = &self.session().source {
            let mut document = (**document).clone();
            if let Some(body) = self.edited_body() {
                document.body = body;
            }
            let remarks = self.save_remarks();
            self.session_mut().write_document(path, None, document, remarks, services);
        } else if let Some(known) = self.last_read_profile().filter(|_| self.saves_last_reading()) {
            let (body, remarks) = match known {
                Ok(known) => known,
                Err(missing) => {
                    let text = Text::new("session.not_all_read").with_list("missing", missing);
                    return self.session().report_rejection(text, services);
                }
            };
            let mut document = new_document(body);
            document.note = Some("as it was read last; the device did not answer when this was saved".to_owned());
            let remarks = std::iter::once(Text::new("session.saved_as_read")).chain(remarks).collect();
            let device = self.device_key();
            self.session_mut().write_document(path, device, document, remarks, services);
        } else if self.try_submit(Self::read_all(), services) {
            self.session_mut().save_to = Some(path);
        }
    }

    /// Reads a backup, either to restore it or to undo a logbook entry.
    fn read_backup(&mut self, path: PathBuf, undone: Option<Box<Entry>>, services: &mut Services) {
        let refusal = undone.as_ref().and_then(|entry| remote_backup_text(entry, &path));
        match (refusal, self.device_key()) {
            (Some(refusal), _) => self.session().report_rejection(refusal, services),
            (None, Some(of)) => self.session().read_backup(of, path, undone, services),
            (None, None) => self.session().report_rejection(Text::new("session.not_connected"), services),
        }
    }

    fn apply_backup(&mut self, read: BackupReadResult, services: &mut Services) {
        let BackupReadResult { path, undone, result, .. } = read;
        let restored = result.and_then(|own| {
            let body = own.check_schema().map_err(ReadError::Profile)?.body;
            let planned = match &undone {
                Some(entry) => self.undo(entry, body, services),
                None => self.restore(body, services),
            };
            planned.map_err(ReadError::Profile)
        });
        if let Err(error) = restored {
            let text = read_error(&path, &error, services.world.kinds);
            self.session().report_rejection(text, services);
        }
    }

    /// Starts a task that lists the backups and writes.
    fn list_backups(&self, services: &Services) {
        if let Some(key) = self.device_key().filter(|_| self.session().phase != Phase::Offline) {
            self.session().list_backups(key, services);
        }
    }
}

/// Returns the message that an entry's backup is on another computer. A file with the same path on this computer is not
/// that backup.
fn remote_backup_text(entry: &Entry, path: &Path) -> Option<Text> {
    let bench = entry.origin.other_bench()?;
    Some(Text::new("undo.other_bench").with("bench", bench).with("path", path.display()))
}
