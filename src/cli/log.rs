//! `log`: the logbook, with the entries of all computers that share it.

use std::path::{Path, PathBuf};

use jiff::civil::DateTime;
use jiff::tz::TimeZone;
use jiff::{Timestamp, Zoned};
use serde_json::{Value as Json, json};

use super::args::{CommonArgs, LogArgs};
use super::output::{Output, count};
use super::runner::to_failure;
use super::user_store::{exchange_entries, user_store};
use super::{Failure, Result, Success};
use crate::app::{Text, explain};
use crate::store::{Entry, EntryFilter, EntryId, EntryKind, LinkedEntry, Logbook, Outcome};

/// Parses a time with its UTC offset or time zone. Without one, the time is in the system's time zone. A date means
/// midnight.
pub(super) fn parse_date(text: &str) -> std::result::Result<Timestamp, String> {
    let zoned = || text.parse::<Zoned>().ok();
    let local = || text.parse::<DateTime>().ok()?.to_zoned(TimeZone::system()).ok();
    let time = || zoned().or_else(local).map(|time| time.timestamp());
    text.parse().ok().or_else(time).ok_or_else(|| "enter a date such as 2026-11-27".to_owned())
}

pub(super) fn parse_entry(text: &str) -> std::result::Result<EntryId, String> {
    EntryId::parse(text).ok_or_else(|| "enter the number of an entry, as log prints it".to_owned())
}

/// Returns the entry with this number.
pub(super) fn entry_with_number(common: &CommonArgs, id: EntryId) -> Result<Entry> {
    let entry = match existing_logbook(common)? {
        None => None,
        Some(logbook) => logbook.entry(id).map_err(|error| to_failure(&explain::logbook_unreadable_text(&error)))?,
    };
    entry.ok_or_else(|| Failure::Failed(vec![format!("The logbook has no entry {id}. log prints the numbers.")]))
}

/// Returns the path of the profile that belongs to an entry: the backup before a write, or the saved profile.
pub(super) fn linked_profile_path(entry: &Entry) -> Result<PathBuf> {
    let path = entry.backup.as_deref().ok_or_else(|| no_backup(entry))?;
    check_bench(entry, path)?;
    Ok(path.to_owned())
}

/// Returns an error if the backup of an entry is on another computer. A local file with the same path is not that
/// backup.
pub(super) fn check_bench(entry: &Entry, backup: &Path) -> Result<()> {
    let Some(bench) = entry.origin.other_bench() else { return Ok(()) };
    Err(Failure::Failed(vec![
        format!("The backup of entry {} is on {bench}, where it was written: {}", entry.id, backup.display()),
        "Run the command there, or copy the file to this computer and name the copy instead of the entry.".to_owned(),
    ]))
}

pub(super) fn no_backup(entry: &Entry) -> Failure {
    let (id, what) = (entry.id, entry.kind.keyword());
    Failure::Failed(vec![format!("Entry {id} ({what}) has no backup. Only writes and saved profiles have one.")])
}

/// Resolves the path of a profile, where `log:ENTRY` means the backup of an entry.
pub(super) fn profile_path(common: &CommonArgs, argument: &Path) -> Result<PathBuf> {
    let Some(number) = argument.to_str().and_then(|text| text.strip_prefix("log:")) else {
        return Ok(argument.to_owned());
    };
    let id = parse_entry(number).map_err(|why| Failure::Usage(format!("log:{number}: {why}")))?;
    linked_profile_path(&entry_with_number(common, id)?)
}

pub(super) fn log(common: &CommonArgs, output: &Output, arguments: &LogArgs) -> Result {
    let LogArgs { device, serial_number, asset, since, search, limit } = arguments;
    let filter = EntryFilter {
        device: None,
        what: None,
        kind: device.clone(),
        serial_number: serial_number.clone(),
        asset: asset.as_ref().map(ToString::to_string),
        since: *since,
        search: search.clone().unwrap_or_default(),
    };
    let entries = match existing_logbook(common)? {
        None => Vec::new(),
        Some(logbook) => {
            let unreadable = |error| to_failure(&explain::logbook_unreadable_text(&error));
            if let Some(kept) = logbook.damaged_file().map_err(unreadable)? {
                output.print_message(&Text::new("logbook.lacks_damaged").with("kept", kept.display()).terminal_text());
            }
            logbook.entries(&filter, *limit).map_err(unreadable)?
        }
    };
    if entries.is_empty() && !output.is_json() {
        output.write_stdout("no entries\n")?;
    }
    for entry in &entries {
        output.show(&entry_json(entry), &entry_text(entry))?;
    }
    Ok(Success::Completed)
}

/// Opens the logbook with the entries of all benches. Returns `None` if nothing has been recorded yet.
fn existing_logbook(common: &CommonArgs) -> Result<Option<Logbook>> {
    let store = user_store(common)?;
    exchange_entries(&store);
    let path = store.logbook_path();
    if matches!(path.try_exists(), Ok(false)) {
        return Ok(None);
    }
    Logbook::open(&path).map(Some).map_err(|error| to_failure(&explain::logbook_unreadable_text(&error)))
}

fn entry_json(entry: &Entry) -> Json {
    let items: Vec<Json> = entry
        .items
        .iter()
        .map(|item| json!({"item": item.item, "name": item.name, "old": item.old, "new": item.new}))
        .collect();
    let outcome = entry.conclusion.as_ref().map(|end| &end.outcome);
    let failure = match outcome {
        Some(Outcome::Failed(why)) => Some(why),
        _ => None,
    };
    json!({
        "entry": entry.id.to_string(),
        "time": entry.at.to_string(),
        "device": entry.device.kind,
        "type": entry.device.device_type,
        "serial_number": entry.device.serial_number,
        "virtual": entry.device.is_virtual,
        "asset": entry.asset,
        "what": entry.kind.keyword(),
        "text": entry.description,
        "items": items,
        "result": outcome.map(Outcome::keyword),
        "failure": failure,
        "write_cycles": entry.write_cycles(),
        "user": entry.origin.user,
        "bench": entry.origin.bench,
        "version": entry.origin.version,
        "backup": entry.backup,
        "undoes": entry.undoes.map(|own| own.id.to_string()),
        "undone_by": entry.undone_by.map(|own| own.id.to_string()),
    })
}

pub(super) fn local_time(at: Timestamp) -> String {
    at.to_zoned(TimeZone::system()).strftime("%Y-%m-%d %H:%M:%S").to_string()
}

fn entry_text(entry: &Entry) -> String {
    let time = local_time(entry.at);
    let device = &entry.device;
    let virtual_mark = if device.is_virtual { " (virtual)" } else { "" };
    let asset = entry.asset.as_ref().map(|asset| format!(" at {asset}")).unwrap_or_default();
    let mut text = format!(
        "{time}  {}  {} {} {}{virtual_mark}{asset}: {}",
        entry.id,
        device.kind,
        device.device_type,
        device.serial_number,
        entry.kind.keyword()
    );
    if entry.planned_cycles > 0 || entry.conclusion.is_some() {
        let result = match entry.conclusion.as_ref().map(|end| &end.outcome) {
            Some(Outcome::Failed(why)) => format!("failed: {why}"),
            Some(outcome) => outcome.keyword().to_owned(),
            None => "without a result".to_owned(),
        };
        let cycles = count(usize::try_from(entry.write_cycles()).unwrap_or(usize::MAX), "write cycle");
        text.push_str(&format!(", {result}, {cycles}"));
    }
    text.push('\n');
    if entry.items.is_empty() {
        text.push_str(&format!("    {}\n", entry.description));
    }
    for item in &entry.items {
        text.push_str(&format!("    {item}\n"));
    }
    for (relation, link) in [("undoes", entry.undoes), ("undone by", entry.undone_by)] {
        if let Some(LinkedEntry { id, at }) = link {
            text.push_str(&format!("    {relation}: entry {id} of {}\n", local_time(at)));
        }
    }
    if let Some(backup) = entry.backup.as_ref().filter(|_| entry.kind != EntryKind::Backup) {
        text.push_str(&format!("    backup: {}\n", backup.display()));
    }
    text
}
