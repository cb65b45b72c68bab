//! The sides of a comparison.

use std::path::{Path, PathBuf};

use crate::app::documents::new_document;
use crate::app::studio::SessionId;
use crate::app::{AnyDevice, Text};
use crate::profile::ProfileDocument;
use crate::store::{Backup, Entry};

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Side {
    Left,
    Right,
}

impl Side {
    pub const BOTH: [Side; 2] = [Side::Left, Side::Right];
}

/// The source of the values on one side.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ComparisonSource {
    /// An open device or profile, with its edits.
    Session(SessionId),
    File(PathBuf),
    Backup(Backup),
    /// A logbook entry with a backup, which contains the values before a write or a saved profile.
    Entry(Box<Entry>),
}

impl ComparisonSource {
    /// Returns the path of the file, or `None` for an open device or profile.
    pub fn path(&self) -> Option<&Path> {
        match self {
            ComparisonSource::Session(_) => None,
            ComparisonSource::File(path) => Some(path),
            ComparisonSource::Backup(backup) => Some(&backup.path),
            ComparisonSource::Entry(entry) => entry.backup.as_deref(),
        }
    }
}

/// One side of a comparison: its source and, once read, its values.
#[derive(Debug, Default)]
pub struct ComparedSide {
    source: Option<ComparisonSource>,
    /// Profile to compare, or the reasons why there is none. `None` while a file is being read.
    content: Option<Result<Box<ProfileDocument>, Vec<Text>>>,
    edits: usize,
    /// Number of the task that reads the file. It stays with the side when the sides are swapped.
    reading: u32,
}

impl ComparedSide {
    pub(super) fn new(source: ComparisonSource, reading: u32) -> Self {
        ComparedSide { source: Some(source), content: None, edits: 0, reading }
    }

    /// Returns the chosen source, if any.
    pub fn source(&self) -> Option<&ComparisonSource> {
        self.source.as_ref()
    }

    pub fn session(&self) -> Option<SessionId> {
        match self.source {
            Some(ComparisonSource::Session(id)) => Some(id),
            _ => None,
        }
    }

    /// Returns the path of the file, or `None` for an open device or profile.
    pub fn path(&self) -> Option<&Path> {
        self.source.as_ref()?.path()
    }

    pub fn document(&self) -> Option<&ProfileDocument> {
        self.content.as_ref()?.as_deref().ok()
    }

    /// Returns the reasons why the side cannot be compared.
    pub fn problem(&self) -> &[Text] {
        self.content.as_ref().and_then(|content| content.as_ref().err()).map(Vec::as_slice).unwrap_or_default()
    }

    /// Returns the number of unwritten edits that are included in the comparison.
    pub fn edit_count(&self) -> usize {
        self.edits
    }

    pub(super) fn reading(&self) -> u32 {
        self.reading
    }

    pub(super) fn set_content(&mut self, content: Result<Box<ProfileDocument>, Vec<Text>>) {
        self.content = Some(content);
    }

    /// Updates the values from the device, including its edits. Returns whether they have changed.
    pub(super) fn update(&mut self, device: &AnyDevice) -> bool {
        self.edits = device.edit_count();
        let body = match device.edited_values() {
            None => Err(vec![Text::new("comparison.nothing_read")]),
            Some(Err(missing)) => Err(vec![Text::new("comparison.not_all_read").with_list("missing", missing)]),
            Some(Ok(body)) => Ok(body),
        };
        let is_same = match (&self.content, &body) {
            (Some(Ok(before)), Ok(body)) => before.body == *body,
            (Some(Err(before)), Err(why)) => before == why,
            _ => false,
        };
        if !is_same {
            self.content = Some(body.map(|body| Box::new(new_document(body))));
        }
        !is_same
    }
}
