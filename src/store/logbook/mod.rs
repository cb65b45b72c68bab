//! The logbook, which records the history of each device: connections, writes with old and new values and the number of
//! write cycles, status codes, saved profiles, checks, and the assignment to an asset. The intent to write is recorded
//! before the first byte is sent, and the result afterwards. If the program ends in between, the intent remains.
//! Entries are never changed or deleted. The format is SQLite, so that two windows can share the logbook and any tool
//! can read it.
//!
//! The logbook never contains access codes, because descriptions and failure messages are made from the plan instead of
//! frames. The logbook does not decide whether a device may be written to. If the logbook fails, the caller rejects
//! writes that are not forced.

mod aside;
mod asset;
mod entry;
mod error;
mod insert;
mod outbox;
mod query;
mod schema;
mod server;
mod user_name;

use std::path::{Path, PathBuf};
use std::time::Duration;

use jiff::Timestamp;
use rusqlite::{Connection, named_params};

pub use asset::{AssetName, AssetNameError};
pub use entry::{
    DeviceKey, Entry, EntryFilter, EntryId, EntryKind, EntryUid, Event, Intent, LinkedEntry, Origin, Outcome,
    UndoObstacle, WriteResult,
};
pub use error::{LogbookError, LogbookErrorKind};
pub use server::{
    DeviceHold, KeyringError, LogbookServer, OtherHolder, Password, ServerAddress, ServerAddressError, ServerContact,
    ServerError, ServerErrorKind, Transferred, UnreachableCause,
};
pub use user_name::UserName;

use insert::Further;

/// Maximum time to wait for another window that is writing.
const LOCK_TIMEOUT: Duration = Duration::from_secs(2);

/// An open logbook. Opening and reading may wait for another window, so they must not run on the UI thread.
#[derive(Debug)]
pub struct Logbook {
    path: PathBuf,
    database: Connection,
    origin: Origin,
}

impl Logbook {
    /// Opens the logbook, creating it and its folder if missing. A damaged file is renamed and replaced with a new one.
    ///
    /// # Errors
    /// Returns an error if the file is in use for longer than two seconds, not writable, or created by a newer version
    /// of the program. In this case, the file is left unchanged.
    pub fn open(path: &Path) -> Result<Self, LogbookError> {
        Self::open_with_timeout(path, LOCK_TIMEOUT)
    }

    /// Opens the logbook like [`open`](Self::open), but waits for other windows no longer than the given time.
    ///
    /// # Errors
    /// Returns the errors of [`open`](Self::open).
    pub(crate) fn open_with_timeout(path: &Path, patience: Duration) -> Result<Self, LogbookError> {
        let opened = match schema::open(path, patience) {
            Err(LogbookErrorKind::Damaged { what }) => {
                if let Some(kept) = aside::set_aside(path, patience).map_err(|problem| problem.into_error(path))? {
                    tracing::warn!("{} ({what})", LogbookErrorKind::SetAside { kept }.into_error(path));
                }
                schema::open(path, patience)
            }
            opened => opened,
        };
        let database = opened.map_err(|problem| problem.into_error(path))?;
        Ok(Logbook { path: path.to_owned(), database, origin: Origin::of_this_process() })
    }

    /// Records that a device is about to be written. The record is on disk when this function returns.
    ///
    /// # Errors
    /// Returns an error if the logbook cannot be written.
    pub fn record_intent(
        &mut self,
        at: Timestamp,
        device: &DeviceKey,
        intent: &Intent,
    ) -> Result<EntryId, LogbookError> {
        let description = intent.items.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ");
        let Intent { kind, items, planned_cycles, backup, undoes } = intent.clone();
        let added = insert::event(
            &self.database,
            &self.origin,
            at,
            device,
            &Event { kind, description, items, backup },
            Further { planned_cycles, asset: None, undoes: undoes.as_ref() },
        );
        added.map_err(|error| self.database_error(error))
    }

    /// Records an event that writes nothing to the device. The record is on disk when this function returns.
    ///
    /// # Errors
    /// Returns an error if the logbook cannot be written.
    pub fn record(&mut self, at: Timestamp, device: &DeviceKey, event: &Event) -> Result<EntryId, LogbookError> {
        let added = insert::event(&self.database, &self.origin, at, device, event, Further::default());
        added.map_err(|error| self.database_error(error))
    }

    /// Assigns a device to an asset, starting at the given time. Nothing is recorded if the device is already assigned
    /// to this asset.
    ///
    /// # Errors
    /// Returns an error if the logbook cannot be read or written.
    pub fn assign(&mut self, at: Timestamp, device: &DeviceKey, asset: &AssetName) -> Result<(), LogbookError> {
        insert::assignment(&mut self.database, &self.origin, at, device, asset)
            .map_err(|error| self.database_error(error))
    }

    /// Records the result of an intended write.
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
        let sql = "INSERT OR IGNORE INTO result (event, at, outcome, failure, cycles_spent)
                   SELECT uid, :at, :outcome, :failure, :cycles_spent FROM event WHERE id = :id";
        let word = outcome.keyword();
        let failure = match outcome {
            Outcome::Failed(reason) => Some(reason),
            Outcome::Done | Outcome::Cancelled => None,
        };
        let parameters = named_params! {
            ":at": at.to_string(),
            ":outcome": word,
            ":failure": failure,
            ":cycles_spent": insert::saturating_cycle_count(cycles_spent),
            ":id": id.0,
        };
        match self.database.execute(sql, parameters).map_err(|error| self.database_error(error))? {
            0 => Err(LogbookErrorKind::NotOpen { entry: id }.into_error(&self.path)),
            _ => Ok(()),
        }
    }

    /// Returns the number of write cycles of a device in the entries of all computers that share the logbook. An intent
    /// without a result counts with its planned cycles, because the program may have ended after the last byte was sent.
    /// Writes by other software are not included, so the count is a minimum.
    ///
    /// # Errors
    /// Returns an error if the logbook cannot be read.
    pub fn write_cycles(&self, device: &DeviceKey) -> Result<u64, LogbookError> {
        let sql = "SELECT coalesce(sum(coalesce(cycles_spent, planned_cycles)), 0)
                   FROM event LEFT JOIN result ON result.event = event.uid
                   WHERE kind = ?1 AND device_type = ?2 AND serial_number = ?3 AND is_virtual = ?4";
        let key = (&device.kind, &device.device_type, &device.serial_number, device.is_virtual);
        self.database
            .query_row(sql, key, |row| row.get(0).and_then(schema::parse_cycles))
            .map_err(|error| self.database_error(error))
    }

    /// Returns the asset to which a device is assigned, or `None` if the device was never assigned.
    ///
    /// # Errors
    /// Returns an error if the logbook cannot be read.
    pub fn asset(&self, device: &DeviceKey) -> Result<Option<String>, LogbookError> {
        query::current_asset(&self.database, device).map_err(|error| self.database_error(error))
    }

    /// Returns the entry with the given number, or `None` if it does not exist.
    ///
    /// # Errors
    /// Returns an error if the logbook cannot be read.
    pub fn entry(&self, id: EntryId) -> Result<Option<Entry>, LogbookError> {
        query::entry(&self.database, id).map_err(|error| self.database_error(error))
    }

    /// Adds a user's note about a device. The record is on disk when this function returns.
    ///
    /// # Errors
    /// Returns an error if the logbook cannot be written.
    pub fn add_note(&mut self, at: Timestamp, device: &DeviceKey, note: &str) -> Result<(), LogbookError> {
        self.record(at, device, &Event::new(EntryKind::Note, note)).map(drop)
    }

    /// Returns all devices that have entries, sorted by kind and serial number.
    ///
    /// # Errors
    /// Returns an error if the logbook cannot be read.
    pub fn devices(&self) -> Result<Vec<DeviceKey>, LogbookError> {
        query::devices(&self.database).map_err(|error| self.database_error(error))
    }

    /// Returns the names of all assets to which a device was ever assigned, sorted by name.
    ///
    /// # Errors
    /// Returns an error if the logbook cannot be read.
    pub fn assets(&self) -> Result<Vec<String>, LogbookError> {
        query::assets(&self.database).map_err(|error| self.database_error(error))
    }

    /// Returns the last `limit` entries that match the filter, newest first.
    ///
    /// # Errors
    /// Returns an error if the logbook cannot be read.
    pub fn entries(&self, filter: &EntryFilter, limit: u32) -> Result<Vec<Entry>, LogbookError> {
        query::entries(&self.database, filter, limit).map_err(|error| self.database_error(error))
    }

    /// Returns the last `limit` writes to a device, newest first.
    ///
    /// # Errors
    /// Returns an error if the logbook cannot be read.
    pub fn history(&self, device: &DeviceKey, limit: u32) -> Result<Vec<Entry>, LogbookError> {
        query::write_entries(&self.database, device, limit).map_err(|error| self.database_error(error))
    }

    /// Returns the last `limit` status readings from a device, newest first.
    ///
    /// # Errors
    /// Returns an error if the logbook cannot be read.
    pub fn status_entries(&self, device: &DeviceKey, limit: u32) -> Result<Vec<Entry>, LogbookError> {
        query::status_entries(&self.database, device, limit).map_err(|error| self.database_error(error))
    }

    /// Returns the number of entries that have not been sent to the logbook server yet.
    ///
    /// # Errors
    /// Returns an error if the logbook cannot be read.
    pub fn count_waiting(&self) -> Result<u64, LogbookError> {
        outbox::count_waiting(&self.database).map_err(|error| self.database_error(error))
    }

    /// Returns the path of a damaged file that this logbook replaced, if any. Its entries and write cycles are missing
    /// from this logbook. A file that still exists is preferred to one that was removed.
    ///
    /// # Errors
    /// Returns an error if the logbook cannot be read.
    pub fn damaged_file(&self) -> Result<Option<PathBuf>, LogbookError> {
        aside::damaged_file(&self.database, &self.path).map_err(|error| self.database_error(error))
    }

    /// Converts a database error to the one reported. If the file is damaged, a new file is created for the next use.
    fn database_error(&self, error: rusqlite::Error) -> LogbookError {
        let problem = match aside::is_corruption_error(&error).then(|| aside::set_aside(&self.path, LOCK_TIMEOUT)) {
            Some(Ok(Some(kept))) => LogbookErrorKind::SetAside { kept },
            _ => LogbookErrorKind::from(error),
        };
        problem.into_error(&self.path)
    }
}

#[cfg(test)]
mod tests;
