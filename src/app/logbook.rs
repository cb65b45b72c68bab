//! The logbook page: the filter, the matching entries and the user's notes. The file is read and written in tasks.

use std::collections::HashMap;
use std::path::PathBuf;

use jiff::Timestamp;

use super::action::{Action, TaskResult};
use super::logbook_server::ServerExchange;
use super::services::Services;
use super::studio::Studio;
use super::tab::Tab;
use super::{AnyDevice, Severity, Text, explain};
use crate::store::{DeviceKey, Entry, EntryFilter, EntryKind, Logbook, LogbookError, Outcome, Store};

/// Tab that shows the logbook.
pub const LOGBOOK_TAB: Tab = Tab::named("Logbook");

/// Maximum number of characters of a note.
pub const MAX_NOTE_CHARS: usize = 1_000;

/// State of the logbook page.
#[derive(Debug, Default)]
pub struct LogbookPage {
    filter: EntryFilter,
    matches: Option<Result<LogbookMatches, Text>>,
    /// Number of the latest search. Results of earlier searches are ignored.
    search: u64,
    is_searching: bool,
    /// Whether entries may have been added since the last search.
    is_stale: bool,
    /// Unfinished notes by device.
    notes: HashMap<DeviceKey, String>,
    /// Note being added, as it was typed.
    added_note: Option<(DeviceKey, String)>,
    exchange: ServerExchange,
}

/// Entries that match a filter, and all devices in the logbook.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct LogbookMatches {
    /// Entries, newest first.
    pub entries: Vec<Entry>,
    /// Whether there are older matching entries that are not listed.
    pub has_more: bool,
    /// Devices with entries, ordered by kind and serial number.
    pub devices: Vec<DeviceKey>,
    /// Assets to which a device was ever assigned, sorted by name.
    pub assets: Vec<String>,
    /// Damaged file that was replaced. Its entries are missing.
    pub damaged: Option<PathBuf>,
}

impl LogbookPage {
    /// Maximum number of entries shown.
    pub const LIMIT: u32 = 2_000;

    pub fn filter(&self) -> &EntryFilter {
        &self.filter
    }

    /// Returns the result of the last search: the matches, or the reason why the logbook cannot be read. Returns `None`
    /// until the first search has ended.
    pub fn matches(&self) -> Option<&Result<LogbookMatches, Text>> {
        self.matches.as_ref()
    }

    /// Returns whether the entries are missing or out of date and no search is running.
    pub fn needs_search(&self) -> bool {
        !self.is_searching && (self.is_stale || self.matches.is_none())
    }

    pub fn is_saving_note(&self) -> bool {
        self.added_note.is_some()
    }

    /// Returns the text of the unfinished note about a device.
    pub fn note(&self, device: &DeviceKey) -> &str {
        self.notes.get(device).map_or("", String::as_str)
    }

    pub(super) fn edit_note(&mut self, device: DeviceKey, note: String) {
        self.notes.insert(device, note);
    }

    pub(super) fn exchange(&self) -> &ServerExchange {
        &self.exchange
    }

    pub(super) fn exchange_mut(&mut self) -> &mut ServerExchange {
        &mut self.exchange
    }

    pub(super) fn mark_stale(&mut self) {
        self.is_stale = true;
    }
}

impl LogbookMatches {
    fn read(store: &Store, filter: &EntryFilter) -> Result<Self, LogbookError> {
        let path = store.logbook_path();
        if matches!(path.try_exists(), Ok(false)) {
            return Ok(LogbookMatches::default());
        }
        let logbook = Logbook::open(&path)?;
        let mut entries = logbook.entries(filter, LogbookPage::LIMIT + 1)?;
        let has_more = entries.len() > LogbookPage::LIMIT as usize;
        entries.truncate(LogbookPage::LIMIT as usize);
        let (devices, assets, damaged) = (logbook.devices()?, logbook.assets()?, logbook.damaged_file()?);
        Ok(LogbookMatches { entries, has_more, devices, assets, damaged })
    }
}

/// Returns the text id of the name of an entry kind.
pub const fn entry_kind_text(kind: EntryKind) -> &'static str {
    match kind {
        EntryKind::Connected => "logbook.kind_connected",
        EntryKind::Assigned => "logbook.kind_assigned",
        EntryKind::Status => "logbook.kind_status",
        EntryKind::Write => "logbook.kind_write",
        EntryKind::Restore => "logbook.kind_restore",
        EntryKind::Preset => "logbook.kind_preset",
        EntryKind::Procedure => "logbook.kind_procedure",
        EntryKind::Backup => "logbook.kind_backup",
        EntryKind::Check => "logbook.kind_check",
        EntryKind::Note => "logbook.kind_note",
    }
}

/// Returns the result of a write, or `None` for an entry that has no result.
pub fn outcome_text(entry: &Entry) -> Option<Text> {
    match entry.conclusion.as_ref().map(|end| &end.outcome) {
        Some(Outcome::Done) => Some(Text::new("writes_card.done")),
        Some(Outcome::Cancelled) => Some(Text::new("writes_card.cancelled")),
        Some(Outcome::Failed(why)) => Some(explain::literal_text(why)),
        None => entry.kind.has_result().then(|| Text::new("writes_card.open")),
    }
}

impl Studio {
    /// Returns the bus name of a kind of device, or `None` if this program does not support that kind.
    pub fn bus(&self, kind: &str) -> Option<&'static str> {
        self.services.world.kinds.for_profile(kind).map(|kind| kind.bus_name())
    }

    /// Returns the display name of an item of a kind of device.
    pub fn item_name(&self, kind: &str, item: &str, manual_name: Option<&str>) -> Text {
        self.services.world.kinds.item_name(kind, item, manual_name)
    }

    /// Returns the changed items of an entry with their old and new values. An entry without items yields its
    /// description.
    pub fn entry_text(&self, entry: &Entry) -> Text {
        if entry.items.is_empty() {
            return explain::literal_text(&entry.description);
        }
        let texts = entry.items.iter().map(|item| {
            let name = self.item_name(&entry.device.kind, &item.item, item.name.as_deref());
            if item.old.is_none() && item.new.is_none() {
                return name;
            }
            let [old, new] = [&item.old, &item.new].map(|value| value.as_deref().unwrap_or("–"));
            Text::new("logbook.changed_item").with_text("item", name).with("old", old).with("new", new)
        });
        Text::new("plain.words").with_list("words", texts)
    }

    pub fn logbook(&self) -> &LogbookPage {
        &self.logbook
    }

    /// Returns the open device to which an entry belongs, if any.
    pub fn device_for_key(&self, key: &DeviceKey) -> Option<&AnyDevice> {
        self.devices.iter().map(Box::as_ref).find(|own| own.logbook_key().as_ref() == Some(key))
    }

    /// Returns the connected device on which an entry can be undone now.
    ///
    /// # Errors
    /// Returns the reason why the entry cannot be undone.
    pub fn undo_target(&self, entry: &Entry) -> Result<&AnyDevice, Text> {
        entry.undo_backup().map_err(explain::undo_obstacle_text)?;
        match self.device_for_key(&entry.device) {
            Some(device) if device.is_ready() => Ok(device),
            Some(device) if device.is_busy() => Err(Text::new("session.busy")),
            Some(_) | None => Err(Text::new("undo.not_connected")),
        }
    }

    /// Starts a task that reads the entries matching the filter.
    pub(super) fn search_logbook(&mut self, filter: EntryFilter) {
        let page = &mut self.logbook;
        page.search += 1;
        page.filter = filter.clone();
        (page.is_searching, page.is_stale) = (true, false);
        let (number, store) = (page.search, self.services.world.store.clone());
        self.services.tasks.run("logbook", move || {
            let matches = LogbookMatches::read(&store, &filter);
            Action::Done(TaskResult::LogbookRead(number, matches))
        });
    }

    pub(super) fn show_logbook_matches(&mut self, number: u64, matches: Result<LogbookMatches, LogbookError>) {
        let page = &mut self.logbook;
        if number == page.search {
            page.is_searching = false;
            page.matches = Some(matches.map_err(|error| explain::logbook_unreadable_text(&error)));
        }
    }

    /// Starts a task that adds the unfinished note about a device. Empty notes are ignored.
    pub(super) fn add_note(&mut self, device: DeviceKey) {
        let typed = self.logbook.note(&device).to_owned();
        let note: String = typed.trim().chars().take(MAX_NOTE_CHARS).collect();
        if note.is_empty() || self.logbook.is_saving_note() {
            return;
        }
        self.logbook.added_note = Some((device.clone(), typed));
        let (at, path) = (self.services.current_time().timestamp(), self.services.world.store.logbook_path());
        let add = move |at: Timestamp| Logbook::open(&path)?.add_note(at, &device, &note);
        self.services.tasks.run("note", move || Action::Done(TaskResult::NoteAdded(add(at))));
    }

    pub(super) fn finish_note(&mut self, result: Result<(), LogbookError>) {
        let page = &mut self.logbook;
        page.mark_stale();
        let Some((device, typed)) = page.added_note.take() else { return };
        match result {
            // Text typed since then belongs to the next note.
            Ok(()) if page.note(&device) == typed => drop(page.notes.remove(&device)),
            Ok(()) => {}
            Err(error) => notify_note_failure(&mut self.services, &error),
        }
    }
}

fn notify_note_failure(services: &mut Services, error: &LogbookError) {
    let text = Text::new("logbook.note_failed").with_text("why", explain::logbook_problem(error));
    services.notify(Severity::Error, vec![text], None);
}
