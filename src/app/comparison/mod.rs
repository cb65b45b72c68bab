//! Comparison of any two sources: an open device, an open profile, a file, a backup or a logbook entry. Values of the
//! left side can be copied to the right side as edits. Devices are not accessed: the last values read are compared.

mod rows;
mod side;

pub(in crate::app) use rows::compare_documents;
pub use rows::{ComparedGroup, ComparedRow, ComparedRows, ItemValue, ItemValues};
pub use side::{ComparedSide, ComparisonSource, Side};

use std::path::Path;

use super::action::{Action, ReadError, TaskResult};
use super::documents::{read_error, read_profile};
use super::file_question::FileQuestion;
use super::studio::{SessionId, Studio};
use super::{AnyDevice, Text, explain};
use crate::profile::ProfileDocument;
use crate::store::{Backup, DeviceKey, Entry, EntryFilter, Logbook, LogbookError, Store};

/// An action of the comparison page.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ComparisonAction {
    /// Open the comparison. A missing side can be chosen there.
    Open {
        left: Option<ComparisonSource>,
        right: Option<ComparisonSource>,
    },
    Choose(Side, ComparisonSource),
    AskFile(Side),
    Swap,
    /// Show all items, or only those that differ.
    ShowAll(bool),
    /// Copy the value of an item from the left side to the device on the right side, as an edit.
    Take(String),
    Close,
}

/// The open comparison.
#[derive(Debug, Default)]
pub struct ComparisonView {
    left: ComparedSide,
    right: ComparedSide,
    shows_all: bool,
    rows: Option<Result<ComparedRows, Text>>,
    refusal: Option<Text>,
    candidates: ComparisonCandidates,
}

/// Backups, and logbook entries with a backup, for one kind of device.
#[derive(Debug, Default)]
pub struct ComparisonCandidates {
    /// Kind of device, or `None` before it is known.
    kind: Option<&'static str>,
    /// Backups of the open devices that belong to no listed entry, newest first.
    backups: Vec<Backup>,
    /// Entries with a backup, newest first.
    entries: Vec<Entry>,
}

impl ComparisonView {
    pub fn side(&self, side: Side) -> &ComparedSide {
        match side {
            Side::Left => &self.left,
            Side::Right => &self.right,
        }
    }

    fn side_mut(&mut self, side: Side) -> &mut ComparedSide {
        match side {
            Side::Left => &mut self.left,
            Side::Right => &mut self.right,
        }
    }

    pub fn shows_all(&self) -> bool {
        self.shows_all
    }

    /// Returns the compared items, or the reason why the sides cannot be compared. Returns `None` until both sides have
    /// been read.
    pub fn rows(&self) -> Option<&Result<ComparedRows, Text>> {
        self.rows.as_ref()
    }

    /// Returns the reason why the last value could not be copied.
    pub fn refusal(&self) -> Option<&Text> {
        self.refusal.as_ref()
    }

    /// Returns the kind of device being compared. The right side takes precedence.
    pub fn kind(&self) -> Option<&'static str> {
        [&self.right, &self.left].into_iter().find_map(|side| Some(side.document()?.body.kind()))
    }

    fn sessions(&self) -> impl Iterator<Item = SessionId> {
        [&self.left, &self.right].into_iter().filter_map(ComparedSide::session)
    }
}

impl Studio {
    /// Returns the open comparison. It closes when one of its sessions is closed.
    pub fn comparison(&self) -> Option<&ComparisonView> {
        self.comparison.as_deref().filter(|view| view.sessions().all(|id| self.device(id).is_some()))
    }

    /// Returns the sources that can be chosen for a side: the open devices and profiles of the same kind, backups, and
    /// logbook entries with a backup.
    pub fn comparison_choices(&self) -> Vec<ComparisonSource> {
        let Some(view) = self.comparison() else { return Vec::new() };
        let kind = view.kind();
        let is_of_kind = |device: &&AnyDevice| kind.is_none() || self.kind_of(*device) == kind;
        let sessions = self.devices.iter().map(Box::as_ref).filter(is_of_kind);
        let sessions = sessions.map(|device| ComparisonSource::Session(device.id()));
        let ComparisonCandidates { backups, entries, .. } = &view.candidates;
        let backups = backups.iter().cloned().map(ComparisonSource::Backup);
        sessions
            .chain(backups)
            .chain(entries.iter().cloned().map(|own| ComparisonSource::Entry(Box::new(own))))
            .collect()
    }

    /// Returns the device on the right side, if values can be copied to it.
    pub fn editable_device(&self) -> Option<&AnyDevice> {
        let device = self.device(self.comparison()?.right.session()?)?;
        (!device.is_writing() && !device.is_reviewing()).then_some(device)
    }

    /// Returns the keyword for the kind of a device.
    pub(super) fn kind_of(&self, device: &AnyDevice) -> Option<&'static str> {
        self.services.world.kinds.kind_for_tab(device.tab()).map(|kind| kind.keyword())
    }

    pub(super) fn close_comparison(&mut self) -> bool {
        self.comparison.take().is_some()
    }

    pub(super) fn apply_comparison_action(&mut self, action: ComparisonAction) {
        match action {
            ComparisonAction::Open { left, right } => {
                self.comparison = Some(Box::default());
                for (side, source) in [(Side::Left, left), (Side::Right, right)] {
                    source.into_iter().for_each(|source| self.choose_side(side, source));
                }
            }
            ComparisonAction::Choose(side, source) => self.choose_side(side, source),
            ComparisonAction::AskFile(side) => self.services.file_question = Some(FileQuestion::Compare(side)),
            ComparisonAction::Swap => {
                if let Some(view) = &mut self.comparison {
                    std::mem::swap(&mut view.left, &mut view.right);
                    view.rows = None;
                }
            }
            ComparisonAction::ShowAll(all) => {
                if let Some(view) = &mut self.comparison {
                    view.shows_all = all;
                }
            }
            ComparisonAction::Take(item) => self.copy_to_right(&item),
            ComparisonAction::Close => self.comparison = None,
        }
        self.refresh_comparison();
    }

    /// Opens the comparison with a device or profile on the right side, and `left` on the other, if given.
    pub(super) fn compare_session(&mut self, id: SessionId, left: Option<ComparisonSource>) {
        if let Some(tab) = self.device(id).map(AnyDevice::tab) {
            self.show(tab, id);
            let right = Some(ComparisonSource::Session(id));
            self.apply_comparison_action(ComparisonAction::Open { left, right });
        }
    }

    fn choose_side(&mut self, side: Side, source: ComparisonSource) {
        let reading = self.next_number();
        let Some(view) = &mut self.comparison else { return };
        let path = source.path().map(ToOwned::to_owned);
        *view.side_mut(side) = ComparedSide::new(source, reading);
        (view.rows, view.refusal) = (None, None);
        let Some(path) = path else { return };
        let formats = self.services.world.kinds.formats;
        self.services.tasks.run("compare", move || {
            let result = read_profile(&path, formats).map(Box::new);
            Action::Done(TaskResult::Compare { reading, path, result })
        });
    }

    /// Shows the profile that was read for a side. If another file has been chosen since, the result is ignored.
    pub(super) fn show_compared_profile(
        &mut self,
        reading: u32,
        path: &Path,
        result: Result<Box<ProfileDocument>, ReadError>,
    ) {
        let kinds = self.services.world.kinds;
        let Some(view) = &mut self.comparison else { return };
        if let Some(side) = Side::BOTH.into_iter().find(|side| view.side(*side).reading() == reading) {
            let content = result.map_err(|error| vec![read_error(path, &error, kinds)]);
            view.side_mut(side).set_content(content);
            view.rows = None;
            self.refresh_comparison();
        }
    }

    /// Updates the compared sessions, and compares again if one of them has changed.
    pub(super) fn refresh_comparison(&mut self) {
        let Some(mut view) = self.comparison.take() else { return };
        for side in Side::BOTH {
            let Some(device) = view.side(side).session().and_then(|id| self.device(id)) else { continue };
            if view.side_mut(side).update(device) {
                view.rows = None;
            }
        }
        if view.rows.is_none() {
            view.rows = self.compare_sides(&view);
        }
        let kind = view.kind().filter(|kind| view.candidates.kind != Some(kind));
        self.comparison = Some(view);
        if let Some(kind) = kind {
            self.list_candidates(kind);
        }
    }

    fn compare_sides(&self, view: &ComparisonView) -> Option<Result<ComparedRows, Text>> {
        let (left, right) = view.left.document().zip(view.right.document())?;
        let kinds = self.services.world.kinds;
        if left.device() != right.device() {
            let [left, right] = [left, right].map(|own| self.bus(own.device()).unwrap_or(own.device()));
            return Some(Err(Text::new("comparison.other_kind").with("left", left).with("right", right)));
        }
        Some(compare_documents(kinds, left, right).map_err(|error| explain::profile_error_text(&error, kinds)))
    }

    /// Copies the value of an item from the left side to the right side, as an edit.
    fn copy_to_right(&mut self, item: &str) {
        let target = self.editable_device().map(|device| device.id());
        let Some(view) = &mut self.comparison else { return };
        let Some((target, left)) = target.zip(view.left.document().cloned()) else { return };
        let mut taken = Ok(());
        self.with_device(target, |device, _| taken = device.take_item(item, &left.body));
        let Some(mut view) = self.comparison.take() else { return };
        if let (Ok(()), Some(device)) = (&taken, self.device(target)) {
            view.right.update(device);
            if let (Some(Ok(now)), Some(Ok(rows))) = (self.compare_sides(&view), &mut view.rows) {
                rows.mark_copied(item, &now);
            }
        }
        view.refusal = taken.err();
        self.comparison = Some(view);
    }

    /// Starts a task that lists the backups and logbook entries that can be compared with a kind of device.
    fn list_candidates(&mut self, kind: &'static str) {
        let Some(view) = &mut self.comparison else { return };
        view.candidates = ComparisonCandidates { kind: Some(kind), ..ComparisonCandidates::default() };
        let of_kind = self.devices.iter().filter_map(|device| device.logbook_key()).filter(|key| key.kind == kind);
        let (devices, store): (Vec<DeviceKey>, _) = (of_kind.collect(), self.services.world.store.clone());
        self.services.tasks.run("candidates", move || {
            let entries = entries_with_backup(&store, kind).unwrap_or_default();
            let is_listed = |backup: &Backup| entries.iter().any(|own| own.backup.as_deref() == Some(&backup.path));
            let of_device =
                |key: &DeviceKey| store.backups().list_for_device(&key.kind, &key.serial_number).unwrap_or_default();
            let backups = devices.iter().flat_map(of_device).filter(|backup| !is_listed(backup)).collect();
            Action::Done(TaskResult::ComparisonCandidates(Box::new(ComparisonCandidates {
                kind: Some(kind),
                backups,
                entries,
            })))
        });
    }

    pub(super) fn show_candidates(&mut self, candidates: ComparisonCandidates) {
        if let Some(view) = self.comparison.as_mut().filter(|view| view.candidates.kind == candidates.kind) {
            view.candidates = candidates;
        }
    }
}

/// Returns the newest logbook entries about a kind of device that have a backup on this computer.
fn entries_with_backup(store: &Store, kind: &str) -> Result<Vec<Entry>, LogbookError> {
    const READ: u32 = 2_000;
    const MAX_LISTED_ENTRIES: usize = 100;
    let path = store.logbook_path();
    if matches!(path.try_exists(), Ok(false)) {
        return Ok(Vec::new());
    }
    let filter = EntryFilter { kind: Some(kind.to_owned()), ..EntryFilter::default() };
    let entries = Logbook::open(&path)?.entries(&filter, READ)?;
    let is_own = |entry: &Entry| entry.backup.is_some() && entry.origin.other_bench().is_none();
    Ok(entries.into_iter().filter(is_own).take(MAX_LISTED_ENTRIES).collect())
}
