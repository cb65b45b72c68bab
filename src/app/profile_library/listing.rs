//! Reads the profiles for the library. Runs in a task.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use crate::app::action::ReadError;
use crate::app::devices::ProfileSubject;
use crate::app::documents::{read_error, read_profile};
use crate::app::{KindRegistry, Text};
use crate::profile::ProfileDocument;
use crate::store::{FileError, FileErrorKind, FileSearch, Store};

/// Part of the list in which a profile appears. A profile that belongs to several parts is listed in the first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum LibrarySection {
    /// Opened or saved most recently.
    Recent,
    /// Delivered with the program.
    ReadyMade,
    /// In the folder of a recent profile.
    SameFolder,
}

/// The profiles in the library.
#[derive(Debug, Default)]
pub struct LibraryListing {
    /// Entries by section, recent ones newest first and others by path.
    pub(super) entries: Vec<LibraryEntry>,
    pub(super) is_truncated: bool,
}

/// A file in the library.
#[derive(Debug)]
pub struct LibraryEntry {
    path: PathBuf,
    section: LibrarySection,
    content: Result<ListedProfile, LibraryProblem>,
    search_text: String,
}

/// A valid profile in the library.
#[derive(Debug)]
pub struct ListedProfile {
    document: Box<ProfileDocument>,
    bus: &'static str,
    subject: ProfileSubject,
}

/// The reason why a file in the library cannot be opened.
#[derive(Debug)]
pub enum LibraryProblem {
    /// The file no longer exists.
    Missing(Text),
    /// The file cannot be read or is not a valid profile.
    Invalid(Text),
}

impl LibraryProblem {
    pub fn text(&self) -> &Text {
        let (LibraryProblem::Missing(text) | LibraryProblem::Invalid(text)) = self;
        text
    }
}

impl ListedProfile {
    pub fn document(&self) -> &ProfileDocument {
        &self.document
    }

    /// Returns the keyword for the kind of device.
    pub fn kind(&self) -> &'static str {
        self.document.device()
    }

    /// Returns the name of the bus.
    pub fn bus(&self) -> &'static str {
        self.bus
    }

    pub fn subject(&self) -> &ProfileSubject {
        &self.subject
    }

    /// Returns the name of the profile, or else the type and serial number of the device, or else the note.
    pub fn summary(&self) -> String {
        let ProfileSubject { name, device_type, serial_number } = &self.subject;
        if !name.is_empty() {
            return name.clone();
        }
        match (serial_number.is_empty(), &self.document.note) {
            // The type alone would be the same for many profiles.
            (true, Some(note)) => note.clone(),
            (true, None) => device_type.clone(),
            (false, _) => format!("{device_type} · {serial_number}"),
        }
    }
}

impl LibraryEntry {
    pub fn path(&self) -> &Path {
        &self.path
    }

    pub fn section(&self) -> LibrarySection {
        self.section
    }

    /// Returns the name of the file without its folder.
    pub fn file_name(&self) -> String {
        file_name(&self.path)
    }

    /// Returns the profile, or `None` if the file is not a valid one.
    pub fn profile(&self) -> Option<&ListedProfile> {
        self.content.as_ref().ok()
    }

    pub fn problem(&self) -> Option<&LibraryProblem> {
        self.content.as_ref().err()
    }

    /// Returns the words by which the profile can be found: its file, kind, name, type, serial number and note.
    pub(super) fn search_text(&self) -> &str {
        &self.search_text
    }

    fn read(path: PathBuf, section: LibrarySection, kinds: KindRegistry) -> Self {
        let name = file_name(&path);
        let content = match read_profile(&path, kinds.formats) {
            Ok(document) => {
                let kind = kinds.for_profile(document.device());
                Ok(ListedProfile {
                    bus: kind.map_or(document.device(), |kind| kind.bus_name()),
                    subject: kind.map(|kind| kind.profile_subject(&document)).unwrap_or_default(),
                    document: Box::new(document),
                })
            }
            Err(error) => Err(problem(&name, error, kinds)),
        };
        let mut words = vec![name];
        if let Ok(ListedProfile { document, bus, subject }) = &content {
            let ProfileSubject { name, device_type, serial_number } = subject;
            words.extend([document.device(), bus, name, device_type, serial_number].map(ToOwned::to_owned));
            words.extend(document.note.clone());
        }
        LibraryEntry { path, section, content, search_text: words.join(" ") }
    }
}

/// Places of the profiles.
pub(super) struct LibrarySource {
    pub(super) recent: Vec<PathBuf>,
    /// Possible folders of the ready-made profiles, of which the first that exists is used.
    pub(super) ready_made: Vec<PathBuf>,
    pub(super) home: Option<PathBuf>,
    pub(super) store: Store,
    pub(super) kinds: KindRegistry,
}

impl LibrarySource {
    /// Maximum number of files in folders.
    const MAX_FOLDER_FILES: usize = 2_000;
    /// Maximum total size in bytes of these files.
    const MAX_FOLDER_BYTES: u64 = 64 << 20;
    /// Number of levels of folders, including the first one.
    const LEVELS: usize = 3;
    const EXTENSION: &'static str = "ron";

    pub(super) fn read(&self) -> LibraryListing {
        let mut search = FileSearch::new(Self::EXTENSION, Self::MAX_FOLDER_FILES, Self::MAX_FOLDER_BYTES);
        let skips = |folder: &Path| self.store.contains(folder);
        let ready_made = self.ready_made.iter().find(|folder| folder.is_dir());
        let ready_made = ready_made.map(|folder| search.find(folder, Self::LEVELS, &skips)).unwrap_or_default();
        let mut beside = Vec::new();
        for folder in self.recent.iter().filter_map(|path| path.parent()) {
            // All folders of the user or the computer would take too long.
            let is_large = Some(folder) == self.home.as_deref() || folder.parent().is_none();
            beside.extend(search.find(folder, if is_large { 1 } else { Self::LEVELS }, &skips));
        }
        beside.sort();
        let sections = [
            (LibrarySection::Recent, self.recent.clone()),
            (LibrarySection::ReadyMade, ready_made),
            (LibrarySection::SameFolder, beside),
        ];
        let mut known = BTreeSet::new();
        let mut entries = Vec::new();
        for (section, paths) in sections {
            for path in paths {
                if known.insert(path.canonicalize().unwrap_or_else(|_| path.clone())) {
                    entries.push(LibraryEntry::read(path, section, self.kinds));
                }
            }
        }
        LibraryListing { entries, is_truncated: search.is_truncated() }
    }
}

/// Returns the reason why a file cannot be opened. It names the file without its folder, which is shown elsewhere.
fn problem(name: &str, error: ReadError, kinds: KindRegistry) -> LibraryProblem {
    use FileErrorKind::{NoFolder, NotFolder, NotFound};
    let error = match error {
        ReadError::File(error) => ReadError::File(FileError { path: PathBuf::from(name), ..error }),
        error => error,
    };
    let text = read_error(Path::new(name), &error, kinds);
    match error {
        ReadError::File(FileError { problem: NotFound | NoFolder | NotFolder, .. }) => LibraryProblem::Missing(text),
        _ => LibraryProblem::Invalid(text),
    }
}

fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}
