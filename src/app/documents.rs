//! Profiles that are opened: read as a task, and put on the desk.

use std::path::{Path, PathBuf};

use jiff::Timestamp;

use super::action::{Action, Done, Known, ReadError};
use super::session::{Source, file_key};
use super::studio::Studio;
use super::{AnyDevice, Severity, Text, explain};
use crate::profile::{Body, Document};
use crate::protocol::biss::Descriptions;
use crate::protocol::hiperface::EncoderTypes;
use crate::store::{Store, read_file};

impl Studio {
    /// A profile was read, or not.
    pub(super) fn read(&mut self, path: PathBuf, key: String, result: Result<Box<Document>, ReadError>, known: Known) {
        let opening = &mut self.services.opening_files;
        if let Some(at) = opening.iter().position(|own| *own == path) {
            opening.remove(at);
        }
        match result {
            Ok(document) => {
                let own = |device: &&AnyDevice| matches!(device.source(), Source::File { key: own, .. } if *own == key);
                let open = self.devices.iter().find(own).map(AnyDevice::id);
                let id = open.unwrap_or_else(|| self.new_id());
                if open.is_some() {
                    self.with_device(id, |device, _| device.take_document(path, key, *document));
                } else {
                    let file = (path, key);
                    let device = AnyDevice::in_file(id, file, *document, known, &mut self.services);
                    self.devices.push(device);
                }
                if let Some(tab) = self.device(id).map(AnyDevice::tab) {
                    self.show(tab, id);
                }
            }
            Err(error) => self.services.tell(Severity::Error, vec![read_error(&path, &error)], None),
        }
    }
}

/// A table, and no profile.
pub(super) fn is_capture(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("csv"))
}

/// What was read just now, as a profile.
pub(super) fn document_of(body: Body) -> Document {
    let now = Timestamp::now();
    let seconds = Timestamp::from_second(now.as_second()).unwrap_or(now);
    Document::new(seconds.to_string(), body)
}

/// Reads a profile, as a task.
pub(super) fn read_document(path: PathBuf, store: &Store) -> Action {
    let result = read_profile(&path).map(Box::new);
    let key = file_key(&path);
    // Where there is no profile, nobody waits for the tables.
    let known = if result.is_ok() {
        Known { hiperface: store.encoder_types(), biss: store.biss_descriptions().0 }
    } else {
        Known { hiperface: Ok(EncoderTypes::built_in()), biss: Descriptions::built_in() }
    };
    Action::Done(Done::Read { path, key, result, known })
}

pub(super) fn read_profile(path: &Path) -> Result<Document, ReadError> {
    let text = read_file(path).map_err(ReadError::File)?;
    Document::parse(&text).map_err(ReadError::Profile)
}

pub(super) fn read_error(path: &Path, error: &ReadError) -> Text {
    match error {
        ReadError::File(error) => explain::file(error),
        ReadError::Profile(error) => explain::profile(path, error),
    }
}
