//! Reads the logbook.

use std::path::PathBuf;

use jiff::Timestamp;
use rusqlite::types::Type;
use rusqlite::{Connection, OptionalExtension, Params, Row, named_params};

use super::entry::{
    DeviceKey, Entry, EntryFilter, EntryId, EntryKind, EntryUid, LinkedEntry, Origin, Outcome, WriteResult,
};
use super::schema;
use crate::profile::ChangedItem;

const COLUMNS: &str =
    "id, uid, undoes, event.at AS at, what, kind, device_type, serial_number, is_virtual, description, items,
    planned_cycles, backup, bench, user, version, result.at AS concluded_at, outcome, failure, cycles_spent";
const TABLES: &str = "event LEFT JOIN result ON result.event = event.uid";

/// Order of entries: by time, because entries from other computers arrive later than they were made. Without the Z,
/// times with and without a fraction can be compared as text.
const NEWEST_FIRST: &str = "rtrim(event.at, 'Z') DESC, event.id DESC";

/// Asset of an entry: the most recent assignment of its device at the time of the entry.
const ASSET: &str = "(SELECT assigned.asset FROM event AS assigned
    WHERE assigned.asset IS NOT NULL AND assigned.kind = event.kind AND assigned.serial_number = event.serial_number
        AND assigned.device_type = event.device_type AND assigned.is_virtual = event.is_virtual
        AND (rtrim(assigned.at, 'Z'), assigned.id) <= (rtrim(event.at, 'Z'), event.id)
    ORDER BY rtrim(assigned.at, 'Z') DESC, assigned.id DESC LIMIT 1)";

/// Returns the last `limit` entries that match the filter, newest first.
pub(super) fn entries(database: &Connection, filter: &EntryFilter, limit: u32) -> rusqlite::Result<Vec<Entry>> {
    // The index `event_search` alone selects the rows, so its expressions are repeated here. Unlike LIKE, `instr` takes
    // any character literally. Searching only devices that ever had the asset avoids a lookup for every entry.
    let condition = format!(
        "(:kind IS NULL OR kind = :kind)
        AND (:serial_number IS NULL OR serial_number = :serial_number)
        AND (:what IS NULL OR what = :what)
        AND (:device IS NULL OR (kind, device_type, serial_number, is_virtual)
            = (:device, :device_type, :device_number, :is_virtual))
        AND (:since IS NULL OR rtrim(event.at, 'Z') >= rtrim(:since, 'Z'))
        AND (:search = ''
            OR instr(lower(description || char(10) || kind || char(10) || device_type || char(10) || serial_number
                || char(10) || coalesce(user, '') || char(10) || bench), lower(:search))
            OR (kind, serial_number, device_type, is_virtual) IN (
                SELECT named.kind, named.serial_number, named.device_type, named.is_virtual FROM event AS named
                WHERE named.asset IS NOT NULL AND instr(lower(named.asset), lower(:search)))
            AND instr(lower(coalesce({ASSET}, '')), lower(:search)))
        AND (:asset IS NULL OR (kind, serial_number, device_type, is_virtual) IN (
                SELECT named.kind, named.serial_number, named.device_type, named.is_virtual
                FROM event AS named WHERE named.asset = :asset)
            AND {ASSET} = :asset)"
    );
    let device = filter.device.as_ref();
    let parameters = named_params! {
        ":device": device.map(|device| &device.kind),
        ":device_type": device.map(|device| &device.device_type),
        ":device_number": device.map(|device| &device.serial_number),
        ":is_virtual": device.map(|device| device.is_virtual),
        ":what": filter.what.map(EntryKind::keyword),
        ":kind": filter.kind,
        ":serial_number": filter.serial_number,
        ":since": filter.since.map(|since| since.to_string()),
        ":search": filter.search.trim(),
        ":asset": filter.asset,
        ":limit": limit,
    };
    let found = format!("id IN (SELECT id FROM event WHERE {condition} ORDER BY {NEWEST_FIRST} LIMIT :limit)");
    select(database, &found, ":limit", parameters)
}

/// Returns all devices that have entries, sorted by kind and serial number.
pub(super) fn devices(database: &Connection) -> rusqlite::Result<Vec<DeviceKey>> {
    let sql = "SELECT DISTINCT kind, serial_number, device_type, is_virtual FROM event
        ORDER BY kind, serial_number, device_type, is_virtual";
    database.prepare(sql)?.query_map([], read_device)?.collect()
}

/// Returns the names of all assets, sorted by name.
pub(super) fn assets(database: &Connection) -> rusqlite::Result<Vec<String>> {
    let sql = "SELECT DISTINCT asset FROM event WHERE asset IS NOT NULL ORDER BY asset";
    database.prepare(sql)?.query_map([], |row| row.get(0))?.collect()
}

pub(super) fn write_entries(database: &Connection, device: &DeviceKey, limit: u32) -> rusqlite::Result<Vec<Entry>> {
    query_device(database, device, "what IN ('write', 'restore', 'preset', 'procedure')", limit)
}

pub(super) fn status_entries(database: &Connection, device: &DeviceKey, limit: u32) -> rusqlite::Result<Vec<Entry>> {
    query_device(database, device, "what = 'status'", limit)
}

pub(super) fn entry(database: &Connection, id: EntryId) -> rusqlite::Result<Option<Entry>> {
    Ok(select(database, "id = ?1", "1", [id.0])?.pop())
}

/// Returns the asset to which a device is currently assigned.
pub(super) fn current_asset(database: &Connection, device: &DeviceKey) -> rusqlite::Result<Option<String>> {
    let sql = "SELECT asset FROM event WHERE asset IS NOT NULL AND kind = ?1 AND serial_number = ?2
        AND device_type = ?3 AND is_virtual = ?4 ORDER BY rtrim(at, 'Z') DESC, id DESC LIMIT 1";
    let key = (&device.kind, &device.serial_number, &device.device_type, device.is_virtual);
    database.query_row(sql, key, |row| row.get(0)).optional()
}

fn query_device(database: &Connection, device: &DeviceKey, which: &str, limit: u32) -> rusqlite::Result<Vec<Entry>> {
    let condition = format!("kind = ?1 AND serial_number = ?2 AND device_type = ?3 AND is_virtual = ?4 AND {which}");
    let key = (&device.kind, &device.serial_number, &device.device_type, device.is_virtual, limit);
    select(database, &condition, "?5", key)
}

fn select(
    database: &Connection,
    condition: &str,
    limit: &str,
    parameters: impl Params,
) -> rusqlite::Result<Vec<Entry>> {
    let sql = format!(
        "SELECT {COLUMNS}, {ASSET} AS asset_then FROM {TABLES} WHERE {condition}
         ORDER BY {NEWEST_FIRST} LIMIT {limit}"
    );
    database.prepare(&sql)?.query_map(parameters, |row| read_entry(database, row))?.collect()
}

/// Maximum number of successive undos to follow.
const LONGEST_CHAIN: usize = 100;

/// Returns the last complete undo of an entry, unless it was itself undone.
fn latest_valid_undo(database: &Connection, undone: &EntryUid) -> rusqlite::Result<Option<LinkedEntry>> {
    let sql = format!(
        "SELECT event.uid, event.id, event.at FROM event JOIN result ON result.event = event.uid
         WHERE undoes = ?1 AND outcome = 'done' ORDER BY {NEWEST_FIRST} LIMIT 1"
    );
    let mut statement = database.prepare_cached(&sql)?;
    let mut last_undo = |of: &EntryUid| {
        let read = |row: &Row<'_>| Ok((EntryUid(row.get("uid")?), read_link(row)?));
        statement.query_row([&of.0], read).optional()
    };
    let Some((mut uid, undo)) = last_undo(undone)? else { return Ok(None) };
    let mut is_effective = true;
    for _ in 0..LONGEST_CHAIN {
        let Some((next, _)) = last_undo(&uid)? else { break };
        (uid, is_effective) = (next, !is_effective);
    }
    Ok(is_effective.then_some(undo))
}

fn linked_entry(database: &Connection, uid: &str) -> rusqlite::Result<Option<LinkedEntry>> {
    database.prepare_cached("SELECT id, at FROM event WHERE uid = ?1")?.query_row([uid], read_link).optional()
}

fn read_link(row: &Row<'_>) -> rusqlite::Result<LinkedEntry> {
    let at = row.get("at").and_then(|text: String| schema::parse_time(&text))?;
    Ok(LinkedEntry { id: EntryId(row.get("id")?), at })
}

pub(super) fn items_json(items: &[ChangedItem]) -> String {
    // Strings and options always have a JSON form.
    serde_json::to_string(items).unwrap_or_else(|_| "[]".to_owned())
}

/// Returns the entry in a row. An entry that this version cannot read contains the reason, so that it does not hide the
/// others.
fn read_entry(database: &Connection, row: &Row<'_>) -> rusqlite::Result<Entry> {
    read_valid_entry(database, row).or_else(|error| {
        let why = match error {
            rusqlite::Error::FromSqlConversionFailure(_, _, why) => why.to_string(),
            rusqlite::Error::IntegralValueOutOfRange(..) => error.to_string(),
            error => return Err(error),
        };
        Ok(Entry {
            id: EntryId(row.get("id")?),
            uid: EntryUid(row.get("uid")?),
            undoes: None,
            undone_by: None,
            kind: EntryKind::parse(&row.get::<_, String>("what")?).unwrap_or(EntryKind::Note),
            at: schema::parse_time(&row.get::<_, String>("at")?).unwrap_or(Timestamp::UNIX_EPOCH),
            device: read_device(row)?,
            asset: row.get("asset_then")?,
            description: format!("unreadable entry ({why}): {}", row.get::<_, String>("description")?),
            items: Vec::new(),
            planned_cycles: row.get("planned_cycles").and_then(schema::parse_cycles)?,
            backup: None,
            origin: read_origin(row)?,
            conclusion: None,
        })
    })
}

fn read_valid_entry(database: &Connection, row: &Row<'_>) -> rusqlite::Result<Entry> {
    let kind = row.get("what").and_then(|word: String| {
        EntryKind::parse(&word).ok_or_else(|| invalid_column(format!("{word:?} is not a kind of entry").into()))
    })?;
    let (uid, undoes) = (EntryUid(row.get("uid")?), row.get::<_, Option<String>>("undoes")?);
    Ok(Entry {
        id: EntryId(row.get("id")?),
        undoes: undoes.map(|uid| linked_entry(database, &uid)).transpose()?.flatten(),
        undone_by: if kind.has_result() { latest_valid_undo(database, &uid)? } else { None },
        uid,
        kind,
        at: row.get("at").and_then(|text: String| schema::parse_time(&text))?,
        device: read_device(row)?,
        asset: row.get("asset_then")?,
        description: row.get("description")?,
        items: row
            .get("items")
            .and_then(|text: String| serde_json::from_str(&text).map_err(|error| invalid_column(Box::new(error))))?,
        planned_cycles: row.get("planned_cycles").and_then(schema::parse_cycles)?,
        backup: row.get::<_, Option<String>>("backup")?.map(PathBuf::from),
        origin: read_origin(row)?,
        conclusion: read_conclusion(row)?,
    })
}

fn read_device(row: &Row<'_>) -> rusqlite::Result<DeviceKey> {
    Ok(DeviceKey {
        kind: row.get("kind")?,
        device_type: row.get("device_type")?,
        serial_number: row.get("serial_number")?,
        is_virtual: row.get("is_virtual")?,
    })
}

fn read_origin(row: &Row<'_>) -> rusqlite::Result<Origin> {
    Ok(Origin { bench: row.get("bench")?, user: row.get("user")?, version: row.get("version")? })
}

fn invalid_column(why: Box<dyn std::error::Error + Send + Sync>) -> rusqlite::Error {
    rusqlite::Error::FromSqlConversionFailure(0, Type::Text, why)
}

fn read_conclusion(row: &Row<'_>) -> rusqlite::Result<Option<WriteResult>> {
    let Some(at) = row.get::<_, Option<String>>("concluded_at")? else { return Ok(None) };
    let outcome = match row.get::<_, String>("outcome")?.as_str() {
        "done" => Outcome::Done,
        "cancelled" => Outcome::Cancelled,
        // The schema allows no other word.
        _ => Outcome::Failed(row.get::<_, Option<String>>("failure")?.unwrap_or_default()),
    };
    Ok(Some(WriteResult {
        at: schema::parse_time(&at)?,
        outcome,
        cycles_spent: row.get("cycles_spent").and_then(schema::parse_cycles)?,
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::{Event, Intent, Logbook};

    /// A row may have been changed by another tool, or received by a version that did not validate it.
    #[test]
    fn unreadable_row_does_not_hide_others() {
        for change in [
            "UPDATE event SET at = 'yesterday' WHERE id = 1",
            "UPDATE event SET what = 'dance' WHERE id = 1",
            "UPDATE event SET items = '[7]' WHERE id = 1",
            "INSERT INTO result SELECT uid, 'yesterday', 'done', NULL, 1 FROM event WHERE id = 1",
        ] {
            let root = tempfile::tempdir().unwrap();
            let path = root.path().join("logbook.sqlite");
            let device = DeviceKey::new("hiperface", "37h", "GB1", false);
            let mut logbook = Logbook::open(&path).unwrap();
            let items = vec![ChangedItem::new("field 0", None, None)];
            let intent = Intent { kind: EntryKind::Write, items, planned_cycles: 3, backup: None, undoes: None };
            logbook.record_intent(Timestamp::UNIX_EPOCH, &device, &intent).unwrap();
            logbook.record(Timestamp::UNIX_EPOCH, &device, &Event::new(EntryKind::Note, "whole")).unwrap();
            Connection::open(&path).unwrap().execute(change, []).unwrap();
            let entries = logbook.entries(&EntryFilter::default(), 9).unwrap();
            let descriptions: Vec<&str> = entries.iter().map(|entry| entry.description.as_str()).collect();
            assert_eq!(descriptions.len(), 2, "{change}");
            assert!(descriptions.contains(&"whole"), "{change}: {descriptions:?}");
            let of_unreadable = |text: &&&str| text.starts_with("unreadable entry (") && text.ends_with("): field 0");
            assert_eq!(descriptions.iter().filter(of_unreadable).count(), 1, "{change}: {descriptions:?}");
            assert!(logbook.write_cycles(&device).is_ok(), "{change}");
        }
    }
}
