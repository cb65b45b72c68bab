//! Saving of profiles to files. The user is asked before changes made by other programs are overwritten. Comments
//! between entries are preserved.

use std::path::{Path, PathBuf};

use super::{Source, file_key};
use crate::app::action::{Action, ReadError, TaskResult};
use crate::app::diverged::ProfileConflict;
use crate::app::studio::SessionId;
use crate::app::{KindRegistry, Text};
use crate::profile::{ProfileDocument, ProfileFormats};
use crate::store::{DeviceKey, Event, FileError, FileErrorKind, Store, overwrite_text, read_file};
use crate::worker::record_event;

/// A profile file as it was last read or written.
#[derive(Clone, Debug, PartialEq)]
pub struct ProfileFile {
    pub path: PathBuf,
    pub key: String,
    pub text: String,
}

impl ProfileFile {
    pub(in crate::app) fn source(self, document: ProfileDocument) -> Source {
        let ProfileFile { path, key, text } = self;
        Source::File { path, key, document: Box::new(document), text }
    }
}

/// The expected content of a file, checked before the file is overwritten.
#[derive(Clone, Debug, PartialEq)]
pub struct FileSnapshot {
    /// Key of the file, which is the same for every path to it.
    pub key: String,
    /// Content of the file when it was opened.
    pub text: String,
}

#[derive(Clone, Debug, PartialEq)]
pub struct SaveRequest {
    pub session: SessionId,
    pub path: PathBuf,
    pub document: Box<ProfileDocument>,
    pub remarks: Vec<Text>,
    /// Expected content of the open file. Any other file is replaced without this check.
    pub opened: Option<FileSnapshot>,
    /// Device from which the values were read. The logbook records the save.
    pub device: Option<DeviceKey>,
    /// Whether the user has agreed to the loss of comments.
    pub may_lose: bool,
    /// Whether the edits have been merged with changes made by another program. They are then no longer edits of this
    /// session.
    pub is_merged: bool,
}

impl SaveRequest {
    /// Writes the file, or returns the reason why it was not written. Runs in a task.
    pub(in crate::app) fn run(mut self, kinds: KindRegistry, store: &Store) -> Action {
        let formats = kinds.formats;
        let key = file_key(&self.path);
        if let Some(guard) = self.opened.clone().filter(|guard| guard.key == key) {
            match current_file_text(&self.path, &guard.text, &self.document, formats) {
                Ok(text) => self.opened = Some(FileSnapshot { key: key.clone(), text }),
                Err(found) => {
                    return Action::Done(TaskResult::Diverged(Box::new(ProfileConflict::new(self, *found, kinds))));
                }
            }
        }
        let (text, lost) = match &self.opened {
            Some(opened) => {
                let carried = self.document.rewrite_text(&opened.text, formats);
                (carried.text, carried.lost)
            }
            None => (self.document.emit(), Vec::new()),
        };
        if !lost.is_empty() && !self.may_lose {
            return Action::Done(TaskResult::WouldLose(Box::new(self), lost));
        }
        let result: Result<(), FileError> = overwrite_text(&self.path, &text);
        if let (Ok(()), Some(device)) = (&result, &self.device) {
            record_event(store, device, &Event::saved_profile(&self.path));
        }
        // The key is determined after writing, because a symbolic link may now lead to another file, and a new file
        // exists only now.
        let file = ProfileFile { key: file_key(&self.path), path: self.path.clone(), text };
        Action::Done(TaskResult::Written { saving: Box::new(self), file, result })
    }
}

/// The content of a file that has changed since it was opened.
#[derive(Debug)]
pub(in crate::app) struct DivergedFile {
    /// Text of the file, or an empty string if the file cannot be read.
    pub(in crate::app) text: String,
    /// The text parsed as a profile.
    pub(in crate::app) document: Result<Box<ProfileDocument>, ReadError>,
}

/// Returns the text to replace, or the changed content if another program has written the file. A missing file does not
/// count as changed.
fn current_file_text(
    path: &Path,
    opened: &str,
    wanted: &ProfileDocument,
    formats: ProfileFormats,
) -> Result<String, Box<DivergedFile>> {
    let text = match read_file(path) {
        Ok(text) => text,
        Err(FileError { problem: FileErrorKind::NotFound, .. }) => return Ok(opened.to_owned()),
        Err(error) => {
            return Err(Box::new(DivergedFile { text: String::new(), document: Err(ReadError::File(error)) }));
        }
    };
    let normalized = |text: &str| ProfileDocument::parse(text, formats).ok().map(|document| document.emit());
    let found = normalized(&text);
    // Only comments have changed. They are preserved like any others.
    if text == opened || found.is_some() && (found == normalized(opened) || found == Some(wanted.emit())) {
        return Ok(text);
    }
    let document = ProfileDocument::parse(&text, formats).map(Box::new).map_err(ReadError::Profile);
    Err(Box::new(DivergedFile { text, document }))
}
