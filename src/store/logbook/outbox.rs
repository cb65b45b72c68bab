//! The local state of a shared logbook: the rows that have yet to be sent to the server, and the last rows received
//! from it.

use std::collections::HashSet;

use jiff::Timestamp;
use rusqlite::{Connection, OptionalExtension, TransactionBehavior, named_params};

use super::entry::EntryKind;
use crate::profile::ChangedItem;

/// A row of the `event` table, with the values as stored.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct EventRow {
    pub uid: String,
    pub at: String,
    pub what: String,
    pub kind: String,
    pub device_type: String,
    pub serial_number: String,
    pub is_virtual: i32,
    pub description: String,
    pub items: String,
    pub planned_cycles: i64,
    pub backup: Option<String>,
    pub bench: String,
    pub user: Option<String>,
    pub version: String,
    pub asset: Option<String>,
    pub undoes: Option<String>,
}

/// A row of the `result` table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct ResultRow {
    pub event: String,
    pub at: String,
    pub outcome: String,
    pub failure: Option<String>,
    pub cycles_spent: i64,
}

#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Rows {
    pub events: Vec<EventRow>,
    pub results: Vec<ResultRow>,
}

/// The last event and the last result received from the server.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Marks {
    pub event: Mark,
    pub result: Mark,
}

/// A row on the server. The default is the position before the first row.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Mark {
    /// Number of the row on the server.
    pub number: i64,
    /// Uid of the event. It tells rows apart if a server was restored from a backup and reuses the numbers of lost
    /// rows.
    pub uid: String,
}

impl Rows {
    pub(super) fn is_empty(&self) -> bool {
        self.events.is_empty() && self.results.is_empty()
    }

    /// Returns the number of events or the number of results, whichever is greater.
    pub(super) fn largest_count(&self) -> usize {
        self.events.len().max(self.results.len())
    }
}

/// Returns the last rows received from a server, or `None` if the local file was used with another server.
pub(super) fn marks(database: &Connection, identity: &str) -> rusqlite::Result<Option<Marks>> {
    let sql = "SELECT event, event_uid, result, result_uid FROM server WHERE identity = ?1";
    let read = |row: &rusqlite::Row<'_>| {
        let event = Mark { number: row.get(0)?, uid: row.get(1)? };
        Ok(Marks { event, result: Mark { number: row.get(2)?, uid: row.get(3)? } })
    };
    database.query_row(sql, [identity], read).optional()
}

/// Prepares the local file for another server, or for one that has lost rows. All local rows are sent, and the server
/// ignores those that it already has.
pub(super) fn begin(database: &mut Connection, identity: &str) -> rusqlite::Result<()> {
    let transaction = database.transaction_with_behavior(TransactionBehavior::Immediate)?;
    let sql = "INSERT OR REPLACE INTO server (id, identity, event, result) VALUES (1, ?1, 0, 0)";
    transaction.execute(sql, [identity])?;
    transaction.execute_batch(
        "DELETE FROM outbox;
         INSERT INTO outbox (uid, is_result) SELECT uid, 0 FROM event ORDER BY id;
         INSERT INTO outbox (uid, is_result) SELECT event, 1 FROM result ORDER BY rowid;",
    )?;
    transaction.commit()
}

/// Returns the number of entries that have yet to be sent. Before the first contact with a server, these are all
/// entries.
pub(super) fn count_waiting(database: &Connection) -> rusqlite::Result<u64> {
    let sql = "SELECT CASE WHEN EXISTS (SELECT 1 FROM server) THEN (SELECT count(DISTINCT uid) FROM outbox)
               ELSE (SELECT count(*) FROM event) END";
    database.query_row(sql, [], |row| row.get(0).and_then(super::schema::parse_cycles))
}

/// Returns the first rows to send. A result is sent with its event, because the server may have lost the event.
pub(super) fn rows_to_send(database: &Connection, limit: usize) -> rusqlite::Result<Rows> {
    let mut waiting = Rows::default();
    let mut outbox = database.prepare_cached("SELECT uid, is_result FROM outbox ORDER BY id LIMIT ?1")?;
    let mut event = database.prepare_cached(
        "SELECT uid, at, what, kind, device_type, serial_number, is_virtual, description, items, planned_cycles, backup,
                bench, user, version, asset, undoes FROM event WHERE uid = ?1",
    )?;
    let mut result =
        database.prepare_cached("SELECT event, at, outcome, failure, cycles_spent FROM result WHERE event = ?1")?;
    let rows = outbox.query_map([limit as i64], |row| Ok((row.get::<_, String>(0)?, row.get(1)?)))?;
    let mut included = HashSet::new();
    for row in rows {
        let (uid, is_result) = row?;
        if included.insert(uid.clone()) {
            waiting.events.push(event.query_row([&uid], read_event)?);
        }
        if is_result {
            waiting.results.push(result.query_row([&uid], read_result)?);
        }
    }
    Ok(waiting)
}

/// Adds the server's rows between two marks to the local file, and removes the rows that the server has from the
/// outbox. Records the new marks, unless another program has reset them meanwhile. Returns the number of new events and
/// results. If another program has switched this file to another server, changes nothing and returns `None`.
pub(super) fn adopt(
    database: &mut Connection,
    identity: &str,
    received: &Rows,
    sent: &Rows,
    [before, after]: [&Marks; 2],
) -> rusqlite::Result<Option<usize>> {
    let transaction = database.transaction_with_behavior(TransactionBehavior::Immediate)?;
    let is_own = transaction.query_row("SELECT identity = ?1 FROM server", [identity], |row| row.get(0)).optional()?;
    if is_own != Some(true) {
        return Ok(None);
    }
    let mut new = 0;
    {
        let mut remove = transaction.prepare_cached("DELETE FROM outbox WHERE uid = ?1 AND is_result = ?2")?;
        for row in &received.events {
            if is_valid(row) {
                new += add_event(&transaction, row)?;
                remove.execute((&row.uid, false))?;
            } else {
                tracing::warn!("entry {} of the logbook server is not valid and is left out", row.uid);
            }
        }
        for row in &received.results {
            if row.at.parse::<Timestamp>().is_ok() {
                new += add_result(&transaction, row)?;
                remove.execute((&row.event, true))?;
            } else {
                tracing::warn!("the result of entry {} of the logbook server is not valid and is left out", row.event);
            }
        }
        for row in &sent.events {
            remove.execute((&row.uid, false))?;
        }
        for row in &sent.results {
            remove.execute((&row.event, true))?;
        }
        let sql = "UPDATE server SET event = ?1, event_uid = ?2 WHERE event BETWEEN ?3 AND ?1";
        transaction.execute(sql, (after.event.number, &after.event.uid, before.event.number))?;
        let sql = "UPDATE server SET result = ?1, result_uid = ?2 WHERE result BETWEEN ?3 AND ?1";
        transaction.execute(sql, (after.result.number, &after.result.uid, before.result.number))?;
    }
    transaction.commit()?;
    Ok(Some(new))
}

/// Returns whether the local logbook can display a row.
fn is_valid(row: &EventRow) -> bool {
    EntryKind::parse(&row.what).is_some()
        && row.at.parse::<Timestamp>().is_ok()
        && serde_json::from_str::<Vec<ChangedItem>>(&row.items).is_ok()
}

fn add_event(database: &Connection, row: &EventRow) -> rusqlite::Result<usize> {
    let mut statement = database.prepare_cached(
        "INSERT OR IGNORE INTO event (uid, at, what, kind, device_type, serial_number, is_virtual, description, items,
                                      planned_cycles, backup, bench, user, version, asset, undoes)
         VALUES (:uid, :at, :what, :kind, :device_type, :serial_number, :is_virtual, :description, :items,
                 :planned_cycles, :backup, :bench, :user, :version, :asset, :undoes)",
    )?;
    statement.execute(named_params! {
        ":uid": row.uid,
        ":at": row.at,
        ":what": row.what,
        ":kind": row.kind,
        ":device_type": row.device_type,
        ":serial_number": row.serial_number,
        ":is_virtual": row.is_virtual,
        ":description": row.description,
        ":items": row.items,
        ":planned_cycles": row.planned_cycles,
        ":backup": row.backup,
        ":bench": row.bench,
        ":user": row.user,
        ":version": row.version,
        ":asset": row.asset,
        ":undoes": row.undoes,
    })
}

fn add_result(database: &Connection, row: &ResultRow) -> rusqlite::Result<usize> {
    // The event is missing if it was left out.
    let mut statement = database.prepare_cached(
        "INSERT OR IGNORE INTO result (event, at, outcome, failure, cycles_spent)
         SELECT uid, ?2, ?3, ?4, ?5 FROM event WHERE uid = ?1",
    )?;
    statement.execute((&row.event, &row.at, &row.outcome, &row.failure, row.cycles_spent))
}

fn read_event(row: &rusqlite::Row<'_>) -> rusqlite::Result<EventRow> {
    Ok(EventRow {
        uid: row.get(0)?,
        at: row.get(1)?,
        what: row.get(2)?,
        kind: row.get(3)?,
        device_type: row.get(4)?,
        serial_number: row.get(5)?,
        is_virtual: row.get(6)?,
        description: row.get(7)?,
        items: row.get(8)?,
        planned_cycles: row.get(9)?,
        backup: row.get(10)?,
        bench: row.get(11)?,
        user: row.get(12)?,
        version: row.get(13)?,
        asset: row.get(14)?,
        undoes: row.get(15)?,
    })
}

fn read_result(row: &rusqlite::Row<'_>) -> rusqlite::Result<ResultRow> {
    Ok(ResultRow {
        event: row.get(0)?,
        at: row.get(1)?,
        outcome: row.get(2)?,
        failure: row.get(3)?,
        cycles_spent: row.get(4)?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::{DeviceKey, EntryId, Event, Intent, Logbook, Outcome};

    const SERVER: &str = "server";

    /// Two programs that use the same local file.
    struct TwoPrograms {
        _root: tempfile::TempDir,
        logbook: Logbook,
        one: Connection,
        two: Connection,
    }

    fn two_programs() -> TwoPrograms {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("logbook.sqlite");
        let logbook = Logbook::open(&path).unwrap();
        let [mut one, two] = [(); 2].map(|()| Connection::open(&path).unwrap());
        begin(&mut one, SERVER).unwrap();
        TwoPrograms { _root: root, logbook, one, two }
    }

    fn device() -> DeviceKey {
        DeviceKey::new("hiperface", "37h", "GB1", false)
    }

    fn intend(logbook: &mut Logbook) -> EntryId {
        let intent =
            Intent { kind: EntryKind::Write, items: Vec::new(), planned_cycles: 1, backup: None, undoes: None };
        logbook.record_intent(Timestamp::UNIX_EPOCH, &device(), &intent).unwrap()
    }

    fn acknowledge(database: &mut Connection, sent: &Rows) -> Option<usize> {
        adopt(database, SERVER, &Rows::default(), sent, [&Marks::default(); 2]).unwrap()
    }

    #[test]
    fn entry_with_reused_number_is_sent() {
        let TwoPrograms { _root, mut logbook, mut one, mut two } = two_programs();
        logbook.record(Timestamp::UNIX_EPOCH, &device(), &Event::new(EntryKind::Note, "first")).unwrap();
        let by_both = [&one, &two].map(|database| rows_to_send(database, 9).unwrap());
        assert_eq!(acknowledge(&mut two, &by_both[1]), Some(0));
        // The outbox is empty, so SQLite gives the number of the first entry to the second.
        logbook.record(Timestamp::UNIX_EPOCH, &device(), &Event::new(EntryKind::Note, "second")).unwrap();
        assert_eq!(acknowledge(&mut one, &by_both[0]), Some(0));
        let waiting = rows_to_send(&one, 9).unwrap().events;
        assert_eq!(waiting.iter().map(|row| row.description.as_str()).collect::<Vec<_>>(), ["second"]);
    }

    #[test]
    fn servers_acknowledge_separately() {
        let TwoPrograms { _root, mut logbook, mut one, mut two } = two_programs();
        intend(&mut logbook);
        let sent = rows_to_send(&one, 9).unwrap();
        begin(&mut two, "another server").unwrap();
        assert_eq!(acknowledge(&mut one, &sent), None);
        assert_eq!(count_waiting(&two), Ok(1));
    }

    /// One program resets the marks because the server has lost rows, while another one is still receiving.
    #[test]
    fn reset_receives_from_first_row() {
        let TwoPrograms { _root, mut one, mut two, .. } = two_programs();
        let at = |number: i64| {
            let mark = || Mark { number, uid: number.to_string() };
            Marks { event: mark(), result: mark() }
        };
        let mut receive = |from: &Marks, to: &Marks| {
            adopt(&mut one, SERVER, &Rows::default(), &Rows::default(), [from, to]).unwrap();
            marks(&one, SERVER).unwrap()
        };
        assert_eq!(receive(&Marks::default(), &at(5)), Some(at(5)));
        begin(&mut two, SERVER).unwrap();
        assert_eq!(receive(&at(5), &at(8)), Some(Marks::default()));
        assert_eq!(receive(&Marks::default(), &at(8)), Some(at(8)));
        assert_eq!(receive(&at(5), &at(7)), Some(at(8)), "a slower program");
        assert_eq!(marks(&one, "another server").unwrap(), None);
    }

    /// The entry stays readable, and its planned write cycles are counted.
    #[test]
    fn skips_invalid_server_result() {
        let TwoPrograms { _root, mut logbook, mut one, .. } = two_programs();
        intend(&mut logbook);
        let event = rows_to_send(&one, 9).unwrap().events.remove(0).uid;
        let result = |at: &str| ResultRow {
            event: event.clone(),
            at: at.to_owned(),
            outcome: "done".to_owned(),
            failure: None,
            cycles_spent: 7,
        };
        for (at, cycles) in [("yesterday", 1), ("2026-11-01T08:00:00Z", 7)] {
            let received = Rows { events: Vec::new(), results: vec![result(at)] };
            adopt(&mut one, SERVER, &received, &Rows::default(), [&Marks::default(); 2]).unwrap();
            assert_eq!(logbook.write_cycles(&device()), Ok(cycles), "{at}");
            assert_eq!(logbook.history(&device(), 9).unwrap()[0].conclusion.is_some(), cycles == 7, "{at}");
        }
    }

    #[test]
    fn sends_result_with_event() {
        let TwoPrograms { _root, mut logbook, mut one, .. } = two_programs();
        let entry = intend(&mut logbook);
        let sent = rows_to_send(&one, 9).unwrap();
        acknowledge(&mut one, &sent);
        logbook.record_outcome(entry, Timestamp::UNIX_EPOCH, Outcome::Done, 1).unwrap();
        let waiting = rows_to_send(&one, 9).unwrap();
        assert_eq!((waiting.events, waiting.results.len()), (sent.events, 1));
    }
}
