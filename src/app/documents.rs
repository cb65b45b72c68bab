//! Opening of profiles, which are read in a task and added to the open devices.

use std::path::{Path, PathBuf};

use jiff::Timestamp;

use super::action::{Action, ReadError, TaskResult};
use super::devices::OpenProfile;
use super::kinds::KindRegistry;
use super::session::{DraftOutcome, ProfileFile, SaveRequest, Source, file_key};
use super::studio::{SessionId, Studio};
use super::{AnyDevice, Severity, Text, explain};
use crate::profile::{Body, ProfileDocument, ProfileError, ProfileFormats};
use crate::store::{FileError, Store, read_file};

impl Studio {
    pub(super) fn read(
        &mut self,
        file: ProfileFile,
        result: Result<Box<ProfileDocument>, ReadError>,
        opens: Option<OpenProfile>,
    ) {
        let opening = &mut self.services.opening_files;
        if let Some(at) = opening.iter().position(|own| *own == file.path) {
            opening.remove(at);
        }
        match result {
            Ok(document) => {
                self.services.log.remove_file_notices(&file.path);
                let remarks = explain::profile_remarks(&file.path, &document);
                if !remarks.is_empty() {
                    self.services.notify(Severity::Warning, remarks, None);
                }
                let own =
                    |device: &&AnyDevice| matches!(device.source(), Source::File { key: own, .. } if *own == file.key);
                let path = file.path.clone();
                let open = self.devices.iter().map(Box::as_ref).find(own).map(|device| device.id());
                let id = open.unwrap_or_else(|| self.new_id());
                if open.is_some() {
                    self.with_device(id, |device, _| device.apply_document(file, *document));
                } else {
                    let found = document.device();
                    let Some(opens) = opens else { return self.report_unsupported_kind(&path, found) };
                    let device = opens(id, file, *document, &mut self.services);
                    self.devices.push(device);
                }
                self.remember_profile(&path);
                if let Some(tab) = self.device(id).map(|device| device.tab()) {
                    self.show(tab, id);
                }
            }
            Err(error) => self.services.notify(
                Severity::Error,
                vec![read_error(&file.path, &error, self.services.world.kinds)],
                None,
            ),
        }
    }

    /// Handles the result of a task that saves a profile.
    pub(super) fn finish_profile_save(
        &mut self,
        saving: SaveRequest,
        file: ProfileFile,
        result: Result<(), FileError>,
    ) {
        if result.is_ok() {
            self.remember_profile(&file.path);
        }
        self.with_device(saving.session, |device, services| {
            device.handle_profile_written(saving, file, result, services);
        });
    }

    /// Reports that the window does not support the profile's kind of device.
    fn report_unsupported_kind(&mut self, path: &Path, found: &str) {
        let error = ProfileError::Device {
            found: found.to_owned(),
            known: self.services.world.kinds.formats.kinds().collect(),
        };
        self.services.notify(
            Severity::Error,
            vec![explain::profile_file_error_text(path, &error, self.services.world.kinds)],
            None,
        );
    }

    /// Handles the result of a task that reads or writes a session's draft.
    pub(super) fn finish_draft(&mut self, id: SessionId, done: DraftOutcome) {
        if let DraftOutcome::Kept { result, .. } = &done {
            self.services.drafts_on_their_way = self.services.drafts_on_their_way.saturating_sub(1);
            if let Err(error) = result
                && self.device(id).is_none()
            {
                let text = Text::new("session.draft_not_kept").with_text("why", explain::file_error_text(error));
                self.services.notify(Severity::Warning, vec![text], None);
            }
        }
        self.with_device(id, |device, services| device.take_draft(done, services));
    }

    /// Refuses to save or write a profile with a newer schema. Returns whether it was refused.
    pub(crate) fn reject_if_read_only(&mut self, id: SessionId) -> bool {
        let refusal = self.device(id).and_then(|device| read_only_reason(device.source()));
        let Some(refusal) = refusal else { return false };
        self.services.notify(Severity::Error, vec![refusal], None);
        true
    }
}

/// Returns the reason why a profile with a newer schema can neither be saved nor written to a device. Returns `None`
/// for any other source.
pub(crate) fn read_only_reason(source: &Source) -> Option<Text> {
    let Source::File { path, document, .. } = source else { return None };
    document.is_newer().then(|| explain::newer_profile(path, document))
}

/// Creates a document for a profile that has just been read.
pub(crate) fn new_document(body: Body) -> ProfileDocument {
    ProfileDocument::new(format_whole_seconds(Timestamp::now()), body)
}

/// Returns a time without fractions of a second, as stored in profiles.
pub(crate) fn format_whole_seconds(at: Timestamp) -> String {
    Timestamp::from_second(at.as_second()).unwrap_or(at).to_string()
}

pub(super) fn read_document(path: PathBuf, store: &Store, kinds: KindRegistry) -> Action {
    let (text, result) = match read_text_and_profile(&path, kinds.formats) {
        Ok((text, document)) => (text, Ok(Box::new(document))),
        Err(error) => (String::new(), Err(error)),
    };
    let file = ProfileFile { key: file_key(&path), path, text };
    // If there is no profile, no tables are needed.
    let kind = result.as_ref().ok().and_then(|document| kinds.for_profile(document.body.kind()));
    let open = kind.map(|kind| kind.read_tables(store));
    Action::Done(TaskResult::Read { file, result, open })
}

pub(super) fn read_profile(path: &Path, formats: ProfileFormats) -> Result<ProfileDocument, ReadError> {
    read_text_and_profile(path, formats).map(|(_, document)| document)
}

fn read_text_and_profile(path: &Path, formats: ProfileFormats) -> Result<(String, ProfileDocument), ReadError> {
    let text = read_file(path).map_err(ReadError::File)?;
    let document = ProfileDocument::parse(&text, formats).map_err(ReadError::Profile)?;
    Ok((text, document))
}

pub(super) fn read_error(path: &Path, error: &ReadError, kinds: KindRegistry) -> Text {
    match error {
        ReadError::File(error) => explain::file_error_text(error),
        ReadError::Profile(error) => explain::profile_file_error_text(path, error, kinds),
    }
}
