//! The profile library: ready-made profiles, recent ones and those in the same folders, with a search and a preview.
//! Files are read in a task. A file that is not a valid profile is listed with the reason.

mod listing;

use std::path::{Path, PathBuf};

pub(super) use listing::LibraryListing;
pub use listing::{LibraryEntry, LibraryProblem, LibrarySection, ListedProfile};

use self::listing::LibrarySource;
use super::action::{Action, TaskResult};
use super::comparison::compare_documents;
use super::file_question::FileQuestion;
use super::palette::match_score;
use super::studio::Studio;
use super::{AnyDevice, ComparedRows, ComparisonAction, ComparisonSource, Text, explain};

/// An action of the library.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum LibraryAction {
    Open,
    Close,
    /// List the profiles that contain all of these words.
    Search(String),
    /// List the profiles of one kind of device, or of all kinds.
    ShowKind(Option<&'static str>),
    Select(PathBuf),
    /// Move the selection down by a number of profiles, or up if it is negative.
    Step(isize),
    /// Open the selected profile in a session.
    OpenSelected,
    /// Compare the selected profile, on the left side, with the selected device if it is of the same kind.
    CompareSelected,
    /// Ask for a file that is not in the list.
    AskFile,
}

/// State of the library. The search and the selection remain when it is closed. The profiles are then released.
#[derive(Debug, Default)]
pub struct ProfileLibrary {
    is_open: bool,
    is_reading: bool,
    /// Number of the latest reading. Results of earlier ones are ignored.
    reading: u64,
    search: String,
    kind: Option<&'static str>,
    listing: LibraryListing,
    /// Indices of the listed entries that match the search.
    matches: Vec<usize>,
    selected: Option<PathBuf>,
    /// Content of the selected profile, or the reason why it cannot be shown.
    preview: Option<Result<ComparedRows, Text>>,
}

impl ProfileLibrary {
    pub fn is_reading(&self) -> bool {
        self.is_reading
    }

    pub fn search(&self) -> &str {
        &self.search
    }

    /// Returns the keyword for the kind of device to which the list is limited, if any.
    pub fn kind(&self) -> Option<&'static str> {
        self.kind
    }

    /// Returns the entries that match the search, by section.
    pub fn entries(&self) -> impl Iterator<Item = &LibraryEntry> {
        self.matches.iter().filter_map(|at| self.listing.entries.get(*at))
    }

    /// Returns whether nothing is listed, whatever the search.
    pub fn is_empty(&self) -> bool {
        self.listing.entries.is_empty()
    }

    /// Returns whether there are more files than the library reads.
    pub fn is_truncated(&self) -> bool {
        self.listing.is_truncated
    }

    pub fn selected(&self) -> Option<&LibraryEntry> {
        let path = self.selected.as_deref()?;
        self.entries().find(|entry| entry.path() == path)
    }

    /// Returns the items of the selected profile with readable names and values, or the reason why they cannot be
    /// shown. Returns `None` if no valid profile is selected.
    pub fn preview(&self) -> Option<&Result<ComparedRows, Text>> {
        self.preview.as_ref()
    }

    fn filter(&mut self) {
        let is_match = |entry: &LibraryEntry| {
            let is_of_kind = self.kind.is_none_or(|kind| entry.profile().is_some_and(|own| own.kind() == kind));
            is_of_kind && match_score(&self.search, entry.search_text()).is_some()
        };
        let entries = self.listing.entries.iter().enumerate();
        self.matches = entries.filter(|(_, entry)| is_match(entry)).map(|(at, _)| at).collect();
    }

    /// Returns the path of the first profile that can be opened, or of the first entry.
    fn first(&self) -> Option<PathBuf> {
        let first = self.entries().find(|entry| entry.profile().is_some()).or_else(|| self.entries().next());
        first.map(|entry| entry.path().to_owned())
    }

    /// Returns the path of the profile `step` rows below the selected one, within the list.
    fn neighbour(&self, step: isize) -> Option<PathBuf> {
        let paths: Vec<&Path> = self.entries().map(LibraryEntry::path).collect();
        let selected = self.selected.as_deref().and_then(|own| paths.iter().position(|path| *path == own));
        let last = paths.len().checked_sub(1)?;
        let row = selected.map_or(0, |row| row.saturating_add_signed(step).min(last));
        paths.get(row).map(|path| (*path).to_owned())
    }
}

impl Studio {
    /// Returns the library, or `None` if it is closed.
    pub fn profile_library(&self) -> Option<&ProfileLibrary> {
        Some(&self.library).filter(|library| library.is_open)
    }

    /// Returns the keyword and the bus of each kind of device.
    pub fn profile_kinds(&self) -> impl Iterator<Item = (&'static str, &'static str)> {
        self.services.world.kinds.devices().iter().map(|kind| (kind.keyword(), kind.bus_name()))
    }

    /// Closes the library. Returns whether it was open.
    pub(super) fn close_library(&mut self) -> bool {
        let library = &mut self.library;
        (library.listing, library.preview) = (LibraryListing::default(), None);
        library.matches.clear();
        std::mem::take(&mut library.is_open)
    }

    /// Remembers a profile that was opened or saved. The program's own files, such as backups, are not remembered.
    pub(super) fn remember_profile(&mut self, path: &Path) {
        let own = self.services.world.store.contains(path);
        if let Some(path) = path.to_str().filter(|_| !own) {
            self.settings.use_profile(path);
        }
    }

    pub(super) fn apply_library_action(&mut self, action: LibraryAction) {
        match action {
            LibraryAction::Open => self.open_library(),
            LibraryAction::Close => drop(self.close_library()),
            LibraryAction::Search(words) => {
                self.library.search = words;
                self.library.filter();
                self.select_listed();
            }
            LibraryAction::ShowKind(kind) => {
                self.library.kind = kind;
                self.library.filter();
                self.select_listed();
            }
            LibraryAction::Select(path) => self.select_profile(Some(path)),
            LibraryAction::Step(step) => self.select_profile(self.library.neighbour(step)),
            LibraryAction::OpenSelected => {
                if let Some((path, _)) = self.selected_profile() {
                    self.handle_action(Action::Open(path));
                }
            }
            LibraryAction::CompareSelected => self.compare_selected_profile(),
            LibraryAction::AskFile => self.services.file_question = Some(FileQuestion::Open),
        }
    }

    /// Opens the library and starts a task that reads the profiles.
    fn open_library(&mut self) {
        let (world, library) = (&self.services.world, &mut self.library);
        (library.is_open, library.is_reading) = (true, true);
        library.reading += 1;
        let source = LibrarySource {
            recent: self.settings.recent_profiles().iter().map(PathBuf::from).collect(),
            ready_made: world.folders.ready_made_profiles(),
            home: world.folders.home_folder().map(Path::to_owned),
            store: world.store.clone(),
            kinds: world.kinds,
        };
        let number = library.reading;
        self.services.tasks.run("profiles", move || Action::Done(TaskResult::LibraryRead(number, source.read())));
    }

    pub(super) fn show_library(&mut self, number: u64, listing: LibraryListing) {
        let library = &mut self.library;
        if library.is_open && number == library.reading {
            (library.is_reading, library.listing) = (false, listing);
            library.filter();
            // The selected file may have changed.
            library.preview = None;
            self.select_listed();
        }
    }

    /// Keeps the selection if it is in the list, or else selects the first profile.
    fn select_listed(&mut self) {
        let listed = self.library.selected().map(|entry| entry.path().to_owned());
        self.select_profile(listed.or_else(|| self.library.first()));
    }

    fn select_profile(&mut self, path: Option<PathBuf>) {
        let kinds = self.services.world.kinds;
        let library = &mut self.library;
        if library.selected == path && library.preview.is_some() {
            return;
        }
        library.selected = path;
        let document = library.selected().and_then(LibraryEntry::profile).map(ListedProfile::document);
        library.preview = document.map(|document| {
            compare_documents(kinds, document, document).map_err(|error| explain::profile_error_text(&error, kinds))
        });
    }

    /// Returns the path and the kind of the selected profile. Returns `None` if it is not valid.
    fn selected_profile(&self) -> Option<(PathBuf, &'static str)> {
        let entry = self.profile_library()?.selected()?;
        Some((entry.path().to_owned(), entry.profile()?.kind()))
    }

    fn compare_selected_profile(&mut self) {
        let Some((path, kind)) = self.selected_profile() else { return };
        let is_target = |device: &&AnyDevice| device.is_comparable() && self.kind_of(*device) == Some(kind);
        let target = self.selected_device().filter(is_target).map(|device| device.id());
        self.close_library();
        let (left, right) = (Some(ComparisonSource::File(path)), target.map(ComparisonSource::Session));
        self.apply_comparison_action(ComparisonAction::Open { left, right });
    }
}
