//! The history of a device according to the logbook: writes, reported status codes, and the backups made before writes.

use std::path::Path;

use super::content::{NONE, ReportContent};
use super::sections::time;
use super::{ReportContext, ReportSource, file_name};
use crate::analysis::check::CycleCount;
use crate::app::explain;
use crate::app::{KindRegistry, Text, entry_kind_text, outcome_text};
use crate::report::{Block, CellStyle, Mark, Section, Table, sha256_hex};
use crate::store::{
    DeviceKey, Entry, EntryFilter, EntryKind, LinkedEntry, Logbook, LogbookError, Outcome, Store, read_file,
};
use crate::worker::commit::known_cycles;

/// Maximum number of entries in a report.
const LIMIT: u32 = 500;

/// Logbook entries about one device, newest first.
#[derive(Debug, Default)]
pub(super) struct History {
    entries: Vec<Entry>,
    /// Whether there are older entries, which are not listed.
    has_more: bool,
    /// Write cycles of the device, or `None` if they are unknown.
    write_cycles: Option<CycleCount>,
    /// Whether virtual devices are marked as such, because the entries may belong to real devices too.
    names_virtual: bool,
    backups: Vec<BackupFile>,
}

/// The backup of an entry.
#[derive(Debug)]
struct BackupFile {
    entry: String,
    name: String,
    /// SHA-256 of the file, or the reason why it cannot be determined.
    checksum: Result<String, Text>,
}

/// Reads the history of a device. For a profile, it includes both real and virtual devices with its serial number.
pub(super) fn read(content: &ReportContent, source: &ReportSource, store: &Store) -> Result<History, Text> {
    let path = store.logbook_path();
    let Some(key) = content.key.as_ref().filter(|key| !key.serial_number.is_empty()) else {
        return Ok(History::default());
    };
    if matches!(path.try_exists(), Ok(false)) {
        return Ok(History::default());
    }
    let filter = EntryFilter {
        kind: Some(key.kind.clone()),
        serial_number: Some(key.serial_number.clone()),
        ..EntryFilter::default()
    };
    let entries = entries(&path, &filter).map_err(|error| explain::logbook_unreadable_text(&error))?;
    let is_own = |entry: &Entry| {
        let is_source = match source {
            ReportSource::Profile(_) => true,
            ReportSource::Device { is_virtual, .. } => entry.device.is_virtual == *is_virtual,
        };
        is_source && entry.device.device_type == key.device_type
    };
    let mut entries: Vec<Entry> = entries.into_iter().filter(is_own).collect();
    // A virtual device does not wear out a real one with the same serial number.
    let is_virtual = match source {
        ReportSource::Profile(_) => entries.iter().all(|entry| entry.device.is_virtual),
        ReportSource::Device { is_virtual, .. } => *is_virtual,
    };
    let write_cycles = known_cycles(store, &DeviceKey { is_virtual, ..key.clone() });
    entries.retain(|entry| entry.kind != EntryKind::Connected);
    let has_more = entries.len() > LIMIT as usize;
    entries.truncate(LIMIT as usize);
    let backups = entries.iter().filter_map(BackupFile::from_logbook_entry).collect();
    let names_virtual = matches!(source, ReportSource::Profile(_));
    Ok(History { entries, has_more, write_cycles, names_virtual, backups })
}

fn entries(path: &Path, filter: &EntryFilter) -> Result<Vec<Entry>, LogbookError> {
    Logbook::open(path)?.entries(filter, u32::MAX)
}

impl History {
    /// Returns the asset to which the device is assigned.
    pub(super) fn asset(&self) -> Option<&str> {
        self.entries.first()?.asset.as_deref()
    }

    /// Returns the sections of the history, or none if there are no entries.
    pub(super) fn sections(&self, context: &ReportContext<'_>, kinds: KindRegistry) -> Vec<Section> {
        if self.entries.is_empty() {
            return Vec::new();
        }
        let count = self.write_cycles.map_or_else(|| Text::new("wear.unknown"), explain::cycle_count_text);
        let cycles = Text::new("report.cycles").with_text("cycles", count);
        let mut history =
            Section::new(context.localize("report.history")).with(Block::Paragraph(context.localize(cycles)));
        if self.has_more {
            history =
                history.with(Block::Paragraph(context.localize(Text::new("logbook.newest").with("count", LIMIT))));
        }
        let history = history.with(Block::Table(self.table(context, kinds)));
        let backups = (!self.backups.is_empty()).then(|| self.backup_section(context));
        std::iter::once(history).chain(backups).collect()
    }

    fn table(&self, context: &ReportContext<'_>, kinds: KindRegistry) -> Table {
        let mut table = context.table([
            (Text::new("report.entry"), CellStyle::Short),
            (Text::new("report.time"), CellStyle::Short),
            (Text::new("report.what"), CellStyle::Text),
            (Text::new("report.cycles_column"), CellStyle::Number),
            (Text::new("report.item"), CellStyle::Text),
            (Text::new("report.old"), CellStyle::Code),
            (Text::new("report.new"), CellStyle::Code),
        ]);
        for entry in &self.entries {
            let mark = match entry.conclusion.as_ref().map(|end| &end.outcome) {
                Some(Outcome::Failed(_)) => Mark::Bad,
                Some(Outcome::Cancelled) => Mark::Warning,
                Some(Outcome::Done) | None => Mark::None,
            };
            let cycles = if entry.kind.has_result() { entry.write_cycles().to_string() } else { String::new() };
            let mut first =
                [entry.id.to_string(), time(entry.at), entry_summary(context, entry, self.names_virtual), cycles];
            if entry.items.is_empty() {
                table.add_marked_row(mark, first.into_iter().chain([description(entry), String::new(), String::new()]));
                continue;
            }
            for item in &entry.items {
                let name = context.localize(kinds.item_name(&entry.device.kind, &item.item, item.name.as_deref()));
                let [old, new] = [&item.old, &item.new].map(|value| value.as_deref().unwrap_or(NONE).to_owned());
                let begin = std::mem::take(&mut first);
                table.add_marked_row(mark, begin.into_iter().chain([name, old, new]));
            }
        }
        table
    }

    fn backup_section(&self, context: &ReportContext<'_>) -> Section {
        let mut table = context.table([
            (Text::new("report.entry"), CellStyle::Short),
            (Text::new("report.file"), CellStyle::Text),
            (Text::new("report.checksum"), CellStyle::Code),
        ]);
        for backup in &self.backups {
            let checksum = backup.checksum.clone().unwrap_or_else(|why| context.localize(why));
            table.add_row([backup.entry.clone(), backup.name.clone(), checksum]);
        }
        Section::new(context.localize("report.backups")).with(Block::Table(table))
    }
}

impl BackupFile {
    fn from_logbook_entry(entry: &Entry) -> Option<Self> {
        let path = entry.backup.as_ref()?;
        let checksum = match entry.origin.other_bench() {
            Some(bench) => Err(Text::new("report.on_bench").with("bench", bench)),
            None => {
                read_file(path).map(|text| sha256_hex(text.as_bytes())).map_err(|_| Text::new("report.not_readable"))
            }
        };
        Some(BackupFile { entry: entry.id.to_string(), name: file_name(path), checksum })
    }
}

/// Returns the description of an entry without items. Profiles are named without their folder.
fn description(entry: &Entry) -> String {
    match &entry.backup {
        Some(path) if entry.kind == EntryKind::Backup => file_name(path),
        _ => entry.description.clone(),
    }
}

/// Describes an entry by its kind, its user, the undo that belongs to it and, for an incomplete write, the result.
fn entry_summary(context: &ReportContext<'_>, entry: &Entry, names_virtual: bool) -> String {
    let kind = context.localize(entry_kind_text(entry.kind));
    let kind = if names_virtual && entry.device.is_virtual {
        context.localize(Text::new("logbook.virtual").with("device", kind))
    } else {
        kind
    };
    let is_done = entry.conclusion.as_ref().is_some_and(|end| end.outcome == Outcome::Done);
    let result = outcome_text(entry).filter(|_| !is_done).map(|text| context.localize(text));
    let link = |id, link: LinkedEntry| context.localize(Text::new(id).with("time", time(link.at)));
    let undoes = entry.undoes.map(|own| link("undo.undoes", own));
    let undone_by = entry.undone_by.map(|own| link("undo.undone_by", own));
    let parts = [Some(kind), result, undoes, undone_by, entry.origin.user.clone()];
    parts.into_iter().flatten().collect::<Vec<_>>().join(" · ")
}
