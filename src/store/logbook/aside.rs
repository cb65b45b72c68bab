//! Damaged logbook files. Such a file is renamed, and the new file that replaces it records this, because the write
//! cycles in the damaged file are no longer counted.

use std::ffi::OsString;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::time::Duration;

use jiff::Timestamp;
use rusqlite::config::DbConfig;
use rusqlite::{Connection, ErrorCode, OpenFlags, OptionalExtension};

use super::error::LogbookErrorKind;
use super::schema;
use crate::store::file_lock::wait_for;

/// Suffixes of the additional files that SQLite creates.
const SQLITE_FILE_SUFFIXES: [&str; 2] = ["-wal", "-shm"];
/// Suffix of the new file before it replaces the damaged one.
const NEW: &str = "-new";

/// Renames a damaged file and creates a new one. Returns the new name of the damaged file, or `None` if another program
/// has already replaced it.
pub(super) fn set_aside(path: &Path, patience: Duration) -> Result<Option<PathBuf>, LogbookErrorKind> {
    let _lock = wait_for(path).map_err(LogbookErrorKind::Folder)?;
    if !is_damaged(path) {
        return Ok(None);
    }
    let kept = unused_name(path);
    // A file must exist at all times, because without one the number of write cycles would be taken as zero.
    let copied = fs::hard_link(path, &kept).or_else(|_| fs::copy(path, &kept).map(drop));
    copied.map_err(|_| LogbookErrorKind::NoAccess)?;
    let new = with_name_suffix(path, NEW);
    let begun = create_replacement(&new, &kept, patience);
    begun.inspect_err(|_| drop(fs::remove_file(&kept)))?;
    for ending in SQLITE_FILE_SUFFIXES {
        match fs::rename(with_name_suffix(path, ending), with_name_suffix(&kept, ending)) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => tracing::warn!("{}: {error}", path.display()),
            _ => {}
        }
    }
    fs::rename(&new, path).map_err(|_| LogbookErrorKind::NoAccess)?;
    Ok(Some(kept))
}

fn create_replacement(new: &Path, kept: &Path, patience: Duration) -> Result<(), LogbookErrorKind> {
    // A program that was killed at this point may have left a file behind.
    let _ = fs::remove_file(new);
    let database = schema::open(new, patience)?;
    let row = (Timestamp::now().to_string(), kept.to_string_lossy());
    database.execute("INSERT INTO damage (at, kept) VALUES (?1, ?2)", row)?;
    // Closing the database moves everything into the file itself.
    database.close().map_err(|(_, error)| error)?;
    Ok(())
}

/// Returns the most recent damaged file, whose entries are missing from this logbook.
pub(super) fn latest_damaged_file(database: &Connection) -> rusqlite::Result<Option<PathBuf>> {
    let sql = "SELECT kept FROM damage ORDER BY rowid DESC LIMIT 1";
    let kept = database.query_row(sql, [], |row| row.get::<_, String>(0)).optional()?;
    Ok(kept.map(PathBuf::from))
}

/// Returns whether an error means that the file itself is damaged, rather than a value in it.
pub(super) fn is_corruption_error(error: &rusqlite::Error) -> bool {
    let code = error.sqlite_error_code();
    matches!(code, Some(ErrorCode::NotADatabase | ErrorCode::DatabaseCorrupt))
}

fn is_damaged(path: &Path) -> bool {
    let flags = OpenFlags::SQLITE_OPEN_READ_WRITE | OpenFlags::SQLITE_OPEN_NO_MUTEX;
    let Ok(database) = Connection::open_with_flags(path, flags) else { return false };
    // The damaged file must stay unchanged.
    let _ = database.set_db_config(DbConfig::SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, true);
    match database.query_row("PRAGMA quick_check(1)", [], |row| row.get::<_, String>(0)) {
        Ok(found) => found != "ok",
        Err(error) => is_corruption_error(&error),
    }
}

fn unused_name(path: &Path) -> PathBuf {
    let time = Timestamp::now().strftime("%Y%m%dT%H%M%SZ");
    let names = (1..).map(|number: u32| match number {
        1 => path.with_file_name(format!("logbook-damaged-{time}.sqlite")),
        _ => path.with_file_name(format!("logbook-damaged-{time}-{number}.sqlite")),
    });
    let mut free = names.filter(|name| !matches!(name.try_exists(), Ok(true)));
    free.next().unwrap_or_else(|| path.to_owned())
}

fn with_name_suffix(path: &Path, ending: &str) -> PathBuf {
    let mut name = OsString::from(path);
    name.push(ending);
    PathBuf::from(name)
}
