//! Saving a profile to a file. Changes made by others since it was opened are not overwritten without asking, and
//! comments of the user between the entries are preserved.

use std::path::{Path, PathBuf};

use super::{Source, file_key};
use crate::app::action::{Action, Done, ReadError};
use crate::app::diverged::ProfileConflict;
use crate::app::studio::SessionId;
use crate::app::{KindRegistry, Text};
use crate::profile::{ProfileDocument, ProfileFormats};
use crate::store::{FileError, FileErrorKind, overwrite_text, read_file};

/// A profile file as last read or written.
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

/// Expected state of a file, checked before the file is overwritten.
#[derive(Clone, Debug, PartialEq)]
pub struct FileSnapshot {
    /// Key of the file, which does not depend on the path leading to it.
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
    /// The open file and its expected state. Any other file is replaced unconditionally.
    pub opened: Option<FileSnapshot>,
    /// Whether the user has agreed that comments will be lost.
    pub may_lose: bool,
    /// Whether the edits have been merged with the edits of other users and so no longer count as edits.
    pub is_merged: bool,
}

impl SaveRequest {
    /// Writes the file in a task, or returns the reason why it has not been written yet.
    pub(in crate::app) fn run(mut self, kinds: KindRegistry) -> Action {
        let formats = kinds.formats;
        let key = file_key(&self.path);
        if let Some(guard) = self.opened.clone().filter(|guard| guard.key == key) {
            match changed(&self.path, &guard.text, &self.document, formats) {
                Ok(text) => self.opened = Some(FileSnapshot { key: key.clone(), text }),
                Err(found) => return Action::Done(Done::Diverged(Box::new(ProfileConflict::new(self, *found, kinds)))),
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
            return Action::Done(Done::WouldLose(Box::new(self), lost));
        }
        let result: Result<(), FileError> = overwrite_text(&self.path, &text);
        // A link may lead elsewhere by now, and a new file has a name only now.
        let file = ProfileFile { key: file_key(&self.path), path: self.path.clone(), text };
        Action::Done(Done::Written { saving: Box::new(self), file, result })
    }
}

/// The content of a file that differs from what was opened.
#[derive(Debug)]
pub(in crate::app) struct DivergedFile {
    /// File content, or an empty string if the file cannot be read.
    pub(in crate::app) text: String,
    /// File content parsed as a profile.
    pub(in crate::app) document: Result<Box<ProfileDocument>, ReadError>,
}

/// Returns the content to be replaced, or the file content if it differs both from what was opened and from what is to
/// be written. A missing file does not count as different.
fn changed(
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
    // A change of comments only: they are kept like any others.
    if text == opened || found.is_some() && (found == normalized(opened) || found == Some(wanted.emit())) {
        return Ok(text);
    }
    let document = ProfileDocument::parse(&text, formats).map(Box::new).map_err(ReadError::Profile);
    Err(Box::new(DivergedFile { text, document }))
}
