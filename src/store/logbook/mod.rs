//! The logbook, which records this program's writes to each device and the write cycles they took. An intent is
//! recorded before the first byte is sent, and its outcome afterwards. If the program dies in between, the intent
//! remains. The format is SQLite: two windows can share the logbook, and any tool can read it.
//!
//! The logbook never contains access codes, because descriptions and failure messages are made from the plan instead of
//! frames. It does not decide whether a device may be written to. If it fails, the caller refuses writes that are not
//! forced.

mod error;
mod schema;

use std::fmt;
use std::path::{Path, PathBuf};
use std::time::Duration;

use jiff::Timestamp;
use rusqlite::{Connection, Row, named_params};

pub use error::{LogbookError, LogbookErrorKind};

/// Maximum time to wait for another window that is writing.
const PATIENCE: Duration = Duration::from_secs(2);

/// An open logbook. Opening and reading may wait for another window, so they must not run on the UI thread.
#[derive(Debug)]
pub struct Logbook {
    path: PathBuf,
    database: Connection,
}

/// The device to which an entry belongs.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct DeviceKey {
    /// Kind of device, such as `hiperface`.
    pub kind: String,
    /// Type of the device as written in its manual, such as `37h`. Serial numbers are unique only within a type.
    pub device_type: String,
    pub serial_number: String,
    /// Whether the device is simulated. Simulated and real devices are counted separately.
    pub is_virtual: bool,
}

impl DeviceKey {
    pub fn of(kind: &str, device_type: &str, serial_number: &str, is_virtual: bool) -> Self {
        let [kind, device_type, serial_number] = [kind, device_type, serial_number].map(str::to_owned);
        DeviceKey { kind, device_type, serial_number, is_virtual }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct EntryId(i64);

impl fmt::Display for EntryId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Outcome {
    Done,
    Failed(String),
    Cancelled,
}

/// A recorded write with its plan and its outcome.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Entry {
    /// Identifier of the entry. Later entries have greater identifiers.
    pub id: EntryId,
    /// Time directly before the write.
    pub at: Timestamp,
    pub description: String,
    pub planned_cycles: u64,
    /// Path of the backup taken before the write. Invalid Unicode in the path is replaced.
    pub backup: Option<PathBuf>,
    /// Result of the write. `None` means that the write is still running or that the program died during the write.
    pub conclusion: Option<WriteResult>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WriteResult {
    pub at: Timestamp,
    pub outcome: Outcome,
    /// Number of write cycles spent. A write that failed half-way counts as well.
    pub cycles_spent: u64,
}

/// Status codes that were read from a device and cleared by reading.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StatusEntry {
    pub at: Timestamp,
    /// Formatted codes, in the order of the device.
    pub codes: String,
}

impl Logbook {
    /// Opens the logbook, creating it and its folder if missing.
    ///
    /// # Errors
    /// Returns an error if the file is damaged, not a database, in use for longer than two seconds, not writable, or
    /// created by a newer version of the program. The file is then left unchanged.
    pub fn open(path: &Path) -> Result<Self, LogbookError> {
        Self::open_with_timeout(path, PATIENCE)
    }

    fn open_with_timeout(path: &Path, patience: Duration) -> Result<Self, LogbookError> {
        let database = schema::open(path, patience).map_err(|problem| problem.of(path))?;
        Ok(Logbook { path: path.to_owned(), database })
    }

    /// Records that a device is about to be written. The record is on disk when this function returns.
    ///
    /// # Errors
    /// Returns an error if the logbook cannot be written.
    pub fn intend(
        &mut self,
        at: Timestamp,
        device: &DeviceKey,
        what: &str,
        planned_cycles: u64,
        backup: Option<&Path>,
    ) -> Result<EntryId, LogbookError> {
        let sql = "INSERT INTO entry (at, kind, device_type, serial_number, is_virtual, what, planned_cycles, backup)
                   VALUES (:at, :kind, :device_type, :serial_number, :is_virtual, :what, :planned_cycles, :backup)";
        let parameters = named_params! {
            ":at": at.to_string(),
            ":kind": device.kind,
            ":device_type": device.device_type,
            ":serial_number": device.serial_number,
            ":is_virtual": device.is_virtual,
            ":what": what,
            ":planned_cycles": saturating_cycle_count(planned_cycles),
            ":backup": backup.map(Path::to_string_lossy),
        };
        self.database.execute(sql, parameters).map_err(|error| self.failed(error))?;
        Ok(EntryId(self.database.last_insert_rowid()))
    }

    /// Records how an intended write ended.
    ///
    /// # Errors
    /// Returns [`LogbookErrorKind::NotOpen`] if the intent does not exist or is already concluded, or another error if
    /// the logbook cannot be written.
    pub fn record_outcome(
        &mut self,
        id: EntryId,
        at: Timestamp,
        outcome: Outcome,
        cycles_spent: u64,
    ) -> Result<(), LogbookError> {
        let sql = "UPDATE entry
                   SET concluded_at = :at, outcome = :outcome, failure = :failure, cycles_spent = :cycles_spent
                   WHERE id = :id AND concluded_at IS NULL";
        let (outcome, failure) = match outcome {
            Outcome::Done => ("done", None),
            Outcome::Failed(reason) => ("failed", Some(reason)),
            Outcome::Cancelled => ("cancelled", None),
        };
        let parameters = named_params! {
            ":at": at.to_string(),
            ":outcome": outcome,
            ":failure": failure,
            ":cycles_spent": saturating_cycle_count(cycles_spent),
            ":id": id.0,
        };
        match self.database.execute(sql, parameters).map_err(|error| self.failed(error))? {
            0 => Err(LogbookErrorKind::NotOpen { entry: id }.of(&self.path)),
            _ => Ok(()),
        }
    }

    /// Returns the number of write cycles that this program has spent on a device. An intent without an outcome counts
    /// with its planned cycles, because the program may have died after the last byte. Writes by other programs are not
    /// included, so the count is a minimum.
    ///
    /// # Errors
    /// Returns an error if the logbook cannot be read.
    pub fn write_cycles(&self, device: &DeviceKey) -> Result<u64, LogbookError> {
        let sql = "SELECT coalesce(sum(coalesce(cycles_spent, planned_cycles)), 0) FROM entry
                   WHERE kind = ?1 AND device_type = ?2 AND serial_number = ?3 AND is_virtual = ?4";
        let key = (&device.kind, &device.device_type, &device.serial_number, device.is_virtual);
        self.database
            .query_row(sql, key, |row| row.get(0).and_then(schema::parse_cycles))
            .map_err(|error| self.failed(error))
    }

    /// Returns the last `limit` entries about a device, newest first.
    ///
    /// # Errors
    /// Returns an error if the logbook cannot be read.
    pub fn history(&self, device: &DeviceKey, limit: u32) -> Result<Vec<Entry>, LogbookError> {
        self.read_history(device, limit).map_err(|error| self.failed(error))
    }

    fn read_history(&self, device: &DeviceKey, limit: u32) -> rusqlite::Result<Vec<Entry>> {
        let sql = "SELECT * FROM entry
                   WHERE kind = ?1 AND device_type = ?2 AND serial_number = ?3 AND is_virtual = ?4
                   ORDER BY id DESC LIMIT ?5";
        let key = (&device.kind, &device.device_type, &device.serial_number, device.is_virtual, limit);
        self.database.prepare(sql)?.query_map(key, read_entry)?.collect()
    }

    /// Records status codes that were read from a device. The record is on disk when this function returns.
    ///
    /// # Errors
    /// Returns an error if the logbook cannot be written.
    pub fn record_status(&mut self, at: Timestamp, device: &DeviceKey, codes: &str) -> Result<(), LogbookError> {
        let sql = "INSERT INTO status (at, kind, device_type, serial_number, is_virtual, codes)
                   VALUES (?1, ?2, ?3, ?4, ?5, ?6)";
        let (kind, device_type, serial) = (&device.kind, &device.device_type, &device.serial_number);
        let row = (at.to_string(), kind, device_type, serial, device.is_virtual, codes);
        self.database.execute(sql, row).map(drop).map_err(|error| self.failed(error))
    }

    /// Returns the last `limit` status readings from a device, newest first.
    ///
    /// # Errors
    /// Returns an error if the logbook cannot be read.
    pub fn statuses(&self, device: &DeviceKey, limit: u32) -> Result<Vec<StatusEntry>, LogbookError> {
        self.read_statuses(device, limit).map_err(|error| self.failed(error))
    }

    fn read_statuses(&self, device: &DeviceKey, limit: u32) -> rusqlite::Result<Vec<StatusEntry>> {
        let sql = "SELECT at, codes FROM status
                   WHERE kind = ?1 AND device_type = ?2 AND serial_number = ?3 AND is_virtual = ?4
                   ORDER BY id DESC LIMIT ?5";
        let key = (&device.kind, &device.device_type, &device.serial_number, device.is_virtual, limit);
        let read = |row: &Row<'_>| {
            let at = row.get("at").and_then(|text: String| schema::parse_time(&text))?;
            Ok(StatusEntry { at, codes: row.get("codes")? })
        };
        self.database.prepare(sql)?.query_map(key, read)?.collect()
    }

    fn failed(&self, error: rusqlite::Error) -> LogbookError {
        LogbookErrorKind::from(error).of(&self.path)
    }
}

/// Limits the cycles of an entry to 32 bits, which rules out an overflow of the sum. No EEPROM survives a thousandth of
/// that number.
fn saturating_cycle_count(cycles: u64) -> u32 {
    u32::try_from(cycles).unwrap_or(u32::MAX)
}

fn read_entry(row: &Row<'_>) -> rusqlite::Result<Entry> {
    Ok(Entry {
        id: EntryId(row.get("id")?),
        at: row.get("at").and_then(|text: String| schema::parse_time(&text))?,
        description: row.get("what")?,
        planned_cycles: row.get("planned_cycles").and_then(schema::parse_cycles)?,
        backup: row.get::<_, Option<String>>("backup")?.map(PathBuf::from),
        conclusion: read_conclusion(row)?,
    })
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
mod tests;
