//! The tables of the logbook, and migration from older versions. `user_version` contains the schema number.

use std::fs::{self, Metadata};
use std::io;
use std::path::Path;
use std::time::Duration;

use jiff::Timestamp;
use rusqlite::config::DbConfig;
use rusqlite::types::Type;
use rusqlite::{Connection, ErrorCode, OpenFlags, TransactionBehavior};

use super::{LogbookErrorKind, aside};
use crate::store::files::create_folder;

/// Migrations from each schema to the next. Existing migrations must never change, because logbooks created by them
/// exist.
pub(super) const STEPS: [&str; 7] = [
    "
    CREATE TABLE entry (
        id             INTEGER PRIMARY KEY,
        at             TEXT    NOT NULL, -- RFC 3339, UTC
        kind           TEXT    NOT NULL,
        device_type    TEXT    NOT NULL,
        serial_number  TEXT    NOT NULL,
        is_virtual     INTEGER NOT NULL CHECK (is_virtual IN (0, 1)),
        what           TEXT    NOT NULL,
        planned_cycles INTEGER NOT NULL CHECK (planned_cycles >= 0),
        backup         TEXT,
        concluded_at   TEXT,             -- this and the rest: NULL until concluded
        outcome        TEXT             CHECK (outcome IN ('done', 'failed', 'cancelled')),
        failure        TEXT,             -- the reason, of 'failed' only
        cycles_spent   INTEGER          CHECK (cycles_spent >= 0),
        CHECK ((concluded_at IS NULL) = (outcome IS NULL)),
        CHECK ((concluded_at IS NULL) = (cycles_spent IS NULL)),
        CHECK ((outcome IS 'failed') = (failure IS NOT NULL))
    ) STRICT;
    CREATE INDEX entry_of_device ON entry (kind, device_type, serial_number, is_virtual);
",
    "
    CREATE TABLE status (
        id             INTEGER PRIMARY KEY,
        at             TEXT    NOT NULL, -- RFC 3339, UTC
        kind           TEXT    NOT NULL,
        device_type    TEXT    NOT NULL,
        serial_number  TEXT    NOT NULL,
        is_virtual     INTEGER NOT NULL CHECK (is_virtual IN (0, 1)),
        codes          TEXT    NOT NULL
    ) STRICT;
    CREATE INDEX status_of_device ON status (kind, device_type, serial_number, is_virtual);
",
    // Rows of these tables are only added, never changed: a result is a separate row, and `uid` identifies an event on
    // every computer.
    "
    CREATE TABLE event (
        id             INTEGER PRIMARY KEY,
        uid            TEXT    NOT NULL UNIQUE,
        at             TEXT    NOT NULL, -- RFC 3339, UTC
        what           TEXT    NOT NULL,
        kind           TEXT    NOT NULL,
        device_type    TEXT    NOT NULL,
        serial_number  TEXT    NOT NULL,
        is_virtual     INTEGER NOT NULL CHECK (is_virtual IN (0, 1)),
        description    TEXT    NOT NULL,
        items          TEXT    NOT NULL DEFAULT '[]', -- JSON: a list of item, name, old, new
        planned_cycles INTEGER NOT NULL DEFAULT 0 CHECK (planned_cycles >= 0),
        backup         TEXT,
        bench          TEXT    NOT NULL,
        user           TEXT,
        version        TEXT    NOT NULL
    ) STRICT;
    CREATE INDEX event_of_device ON event (kind, serial_number, device_type, is_virtual);
    CREATE TABLE result (
        event          TEXT    PRIMARY KEY REFERENCES event (uid),
        at             TEXT    NOT NULL, -- RFC 3339, UTC
        outcome        TEXT    NOT NULL CHECK (outcome IN ('done', 'failed', 'cancelled')),
        failure        TEXT,             -- the reason, of 'failed' only
        cycles_spent   INTEGER NOT NULL CHECK (cycles_spent >= 0),
        CHECK ((outcome = 'failed') = (failure IS NOT NULL))
    ) STRICT;
    CREATE TEMP TABLE moved AS
        SELECT lower(hex(randomblob(16))) AS uid, at, 'write' AS what, kind, device_type, serial_number, is_virtual,
               what AS description, planned_cycles, backup, concluded_at, outcome, failure, cycles_spent
        FROM entry
        UNION ALL
        SELECT lower(hex(randomblob(16))), at, 'status', kind, device_type, serial_number, is_virtual, codes,
               0, NULL, NULL, NULL, NULL, NULL
        FROM status;
    INSERT INTO event (uid, at, what, kind, device_type, serial_number, is_virtual, description, planned_cycles, backup,
                       bench, version)
        SELECT uid, at, what, kind, device_type, serial_number, is_virtual, description, planned_cycles, backup, '', ''
        FROM temp.moved ORDER BY at, rowid;
    INSERT INTO result SELECT uid, concluded_at, outcome, failure, cycles_spent
        FROM temp.moved WHERE concluded_at IS NOT NULL;
    DROP TABLE temp.moved;
    DROP TABLE entry;
    DROP TABLE status;
",
    // New words in `what`: connected, assigned, backup, check. A program that knows only schema 3 would treat them as
    // damage.
    "
    ALTER TABLE event ADD COLUMN asset TEXT; -- the asset to which the device is assigned from now on, of 'assigned' only
    CREATE INDEX event_assigned ON event (kind, serial_number, device_type, is_virtual) WHERE asset IS NOT NULL;
    CREATE INDEX event_of_asset ON event (asset) WHERE asset IS NOT NULL;
",
    // A server may share the logbook. Entries of other benches arrive later than they were made, so entries are ordered
    // by their time. Without the Z, times with and without a fraction can be compared as text. The index contains all
    // that a search looks at, so the wide rows themselves are read only for the entries that are found.
    "
    CREATE INDEX event_search ON event (
        rtrim(at, 'Z'), id, what, kind, device_type, serial_number, is_virtual,
        lower(description || char(10) || kind || char(10) || device_type || char(10) || serial_number || char(10)
            || coalesce(user, '') || char(10) || bench)
    );
    CREATE TABLE server (
        id             INTEGER PRIMARY KEY CHECK (id = 1),
        identity       TEXT    NOT NULL,
        event          INTEGER NOT NULL, -- numbers of the last event and result of the server that are in this file
        result         INTEGER NOT NULL
    ) STRICT;
    CREATE TABLE outbox (                -- rows that the server does not have yet, in the order of their numbers
        id             INTEGER PRIMARY KEY,
        uid            TEXT    NOT NULL, -- of the event
        is_result      INTEGER NOT NULL CHECK (is_result IN (0, 1)),
        UNIQUE (uid, is_result)
    ) STRICT;
    CREATE TABLE damage (                -- earlier files, which were damaged and whose entries are missing here
        at             TEXT    NOT NULL, -- RFC 3339, UTC
        kept           TEXT    NOT NULL
    ) STRICT;
    CREATE TRIGGER event_waits AFTER INSERT ON event WHEN EXISTS (SELECT 1 FROM server) BEGIN
        INSERT INTO outbox (uid, is_result) VALUES (new.uid, 0);
    END;
    CREATE TRIGGER result_waits AFTER INSERT ON result WHEN EXISTS (SELECT 1 FROM server) BEGIN
        INSERT INTO outbox (uid, is_result) VALUES (new.event, 1);
    END;
",
    // The undone event may be missing: another bench may have it, and this file may lack it.
    "
    ALTER TABLE event ADD COLUMN undoes TEXT; -- uid of the event that this one undoes
    CREATE INDEX event_undoes ON event (undoes) WHERE undoes IS NOT NULL;
",
    // Uids of the events of the last rows of the server. Without them, all rows are sent once more.
    "
    ALTER TABLE server ADD COLUMN event_uid TEXT NOT NULL DEFAULT '';
    ALTER TABLE server ADD COLUMN result_uid TEXT NOT NULL DEFAULT '';
",
];

pub(super) const SCHEMA_VERSION: i64 = STEPS.len() as i64;

/// Opens the file, creating it and its folder if missing.
pub(super) fn open(path: &Path, patience: Duration) -> Result<Connection, LogbookErrorKind> {
    if let Some(folder) = path.parent() {
        create_folder(folder).map_err(LogbookErrorKind::Folder)?;
    }
    match fs::metadata(path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => aside::create_missing(path, patience)?,
        // SQLite would take it as a new database.
        Ok(found) if is_empty_file(&found) => {
            return Err(LogbookErrorKind::Damaged { what: "the file is empty".to_owned() });
        }
        _ => {}
    }
    open_with_flags(path, patience, OpenFlags::empty())
}

pub(super) fn is_empty_file(found: &Metadata) -> bool {
    found.is_file() && found.len() == 0
}

/// Creates a file that no other program opens yet.
pub(super) fn create(path: &Path, patience: Duration) -> Result<Connection, LogbookErrorKind> {
    open_with_flags(path, patience, OpenFlags::SQLITE_OPEN_CREATE)
}

fn open_with_flags(path: &Path, patience: Duration, further: OpenFlags) -> Result<Connection, LogbookErrorKind> {
    // SQLITE_OPEN_URI is not set, because a file may be called "file:x?mode=memory".
    let flags = OpenFlags::SQLITE_OPEN_READ_WRITE | OpenFlags::SQLITE_OPEN_NO_MUTEX | further;
    let mut database = Connection::open_with_flags(path, flags)?;
    database.busy_timeout(patience)?;
    // The version is checked before any change, including that of the journal mode.
    if let Err(problem) = check_version(&database) {
        // Closing would clean up after a newer version that crashed. That must be left to the newer version.
        let _ = database.set_db_config(DbConfig::SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, true);
        return Err(problem);
    }
    use_write_ahead_log(&database)?;
    migrate_schema(&mut database)?;
    Ok(database)
}

pub(super) fn parse_time(text: &str) -> rusqlite::Result<Timestamp> {
    text.parse().map_err(|error: jiff::Error| rusqlite::Error::FromSqlConversionFailure(0, Type::Text, Box::new(error)))
}

/// Converts a cycle count to unsigned, because SQLite has no unsigned integers.
pub(super) fn parse_cycles(count: i64) -> rusqlite::Result<u64> {
    u64::try_from(count).map_err(|_| rusqlite::Error::IntegralValueOutOfRange(0, count))
}

/// Selects a journal mode in which readers do not wait for a writer and every commit is flushed. An intent must survive
/// a power failure.
fn use_write_ahead_log(database: &Connection) -> rusqlite::Result<()> {
    // The query returns the resulting mode. A network disk without support for WAL keeps its old mode, which also
    // works.
    match database.query_row("PRAGMA journal_mode = WAL", [], |row| row.get::<_, String>(0)) {
        // Another window is switching or writing at this moment. SQLite does not wait here, because that window may be
        // waiting for this one. Either mode is safe, and the next window that opens the logbook switches.
        Err(error) if error.sqlite_error_code() == Some(ErrorCode::DatabaseBusy) => {}
        result => drop(result?),
    }
    database.pragma_update(None, "synchronous", "FULL")
}

fn migrate_schema(database: &mut Connection) -> Result<(), LogbookErrorKind> {
    // The schema is almost always current, and then no lock is needed.
    if check_version(database)? == STEPS.len() {
        return Ok(());
    }
    let transaction = database.transaction_with_behavior(TransactionBehavior::Immediate)?;
    // Another window may have migrated the database in the meantime.
    let done = check_version(&transaction)?;
    for step in STEPS.iter().skip(done) {
        transaction.execute_batch(step)?;
    }
    transaction.pragma_update(None, "user_version", SCHEMA_VERSION)?;
    Ok(transaction.commit()?)
}

/// Returns the number of migrations that have been applied to the database.
fn check_version(database: &Connection) -> Result<usize, LogbookErrorKind> {
    let found: i64 = database.pragma_query_value(None, "user_version", |row| row.get(0))?;
    match usize::try_from(found) {
        Ok(done) if done <= STEPS.len() => Ok(done),
        _ => Err(LogbookErrorKind::Newer { found, known: SCHEMA_VERSION }),
    }
}
