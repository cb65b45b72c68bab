//! New and damaged logbook files. A damaged file is renamed, and the new file that replaces it records this, because
//! the write cycles in the damaged file are no longer counted.

use std::ffi::OsString;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::time::Duration;

use jiff::Timestamp;
use rusqlite::config::DbConfig;
use rusqlite::{Connection, ErrorCode, OpenFlags};

use super::error::LogbookErrorKind;
use super::schema;
use crate::store::file_lock::wait_for;

/// Suffixes of the additional files that SQLite creates.
const SQLITE_FILE_SUFFIXES: [&str; 2] = ["-wal", "-shm"];
/// Beginning and end of the names of damaged files.
const NAME: (&str, &str) = ("logbook-damaged-", ".sqlite");
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

/// Creates the file of a first start. It appears complete: an empty file is a damaged one.
pub(super) fn create_missing(path: &Path, patience: Duration) -> Result<(), LogbookErrorKind> {
    let _lock = wait_for(path).map_err(LogbookErrorKind::Folder)?;
    // Another program may have created it in the meantime.
    if path.exists() {
        return Ok(());
    }
    let new = with_name_suffix(path, NEW);
    close(create_new(&new, patience)?)?;
    // SQLite would apply changes left by a deleted file to the new one.
    for ending in SQLITE_FILE_SUFFIXES {
        let _ = fs::remove_file(with_name_suffix(path, ending));
    }
    fs::rename(&new, path).map_err(|_| LogbookErrorKind::NoAccess)
}

fn create_replacement(new: &Path, kept: &Path, patience: Duration) -> Result<(), LogbookErrorKind> {
    let database = create_new(new, patience)?;
    let row = (Timestamp::now().to_string(), kept.to_string_lossy());
    database.execute("INSERT INTO damage (at, kept) VALUES (?1, ?2)", row)?;
    close(database)
}

fn create_new(new: &Path, patience: Duration) -> Result<Connection, LogbookErrorKind> {
    // A program that was killed at this point may have left a file behind.
    let _ = fs::remove_file(new);
    schema::create(new, patience)
}

/// Closes the database, which moves everything into the file itself.
fn close(database: Connection) -> Result<(), LogbookErrorKind> {
    database.close().map_err(|(_, error)| error.into())
}

/// Returns a damaged file whose entries are missing from this logbook: one that still exists, or else the most recent
/// one. `path` is the path of the logbook.
pub(super) fn damaged_file(database: &Connection, path: &Path) -> rusqlite::Result<Option<PathBuf>> {
    let mut statement = database.prepare("SELECT kept FROM damage ORDER BY rowid DESC")?;
    let kept = statement.query_map([], |row| row.get::<_, String>(0))?.collect::<Result<Vec<_>, _>>()?;
    // The folder may have been moved. Earlier versions recorded the whole path.
    let recorded = kept.iter().filter_map(|kept| Some(path.with_file_name(Path::new(kept).file_name()?)));
    let mut files: Vec<PathBuf> = recorded.collect();
    let Some(latest) = files.first().cloned() else { return Ok(None) };
    // A logbook that was damaged in turn may have replaced another one.
    files.extend(damaged_files_beside(path));
    Ok(files.into_iter().find(|file| may_exist(file)).or(Some(latest)))
}

/// Returns whether a file exists, or may exist because its folder cannot be read.
fn may_exist(file: &Path) -> bool {
    file.try_exists().unwrap_or(true)
}

fn damaged_files_beside(path: &Path) -> Vec<PathBuf> {
    let Some(entries) = path.parent().and_then(|folder| fs::read_dir(folder).ok()) else { return Vec::new() };
    let is_damaged = |name: &str| name.starts_with(NAME.0) && name.ends_with(NAME.1);
    let paths = entries.filter_map(|entry| Some(entry.ok()?.path()));
    paths.filter(|file| file.file_name().and_then(|name| name.to_str()).is_some_and(is_damaged)).collect()
}

/// Returns whether an error means that the file itself is damaged, rather than a value in it.
pub(super) fn is_corruption_error(error: &rusqlite::Error) -> bool {
    let code = error.sqlite_error_code();
    matches!(code, Some(ErrorCode::NotADatabase | ErrorCode::DatabaseCorrupt))
}

fn is_damaged(path: &Path) -> bool {
    if path.metadata().is_ok_and(|found| schema::is_empty_file(&found)) {
        return true;
    }
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
        1 => path.with_file_name(format!("{}{time}{}", NAME.0, NAME.1)),
        _ => path.with_file_name(format!("{}{time}-{number}{}", NAME.0, NAME.1)),
    });
    let mut free = names.filter(|name| !matches!(name.try_exists(), Ok(true)));
    free.next().unwrap_or_else(|| path.to_owned())
}

fn with_name_suffix(path: &Path, ending: &str) -> PathBuf {
    let mut name = OsString::from(path);
    name.push(ending);
    PathBuf::from(name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::Logbook;

    #[test]
    fn remembers_every_damaged_file() {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("before/logbook.sqlite");
        drop(Logbook::open(&path).unwrap());
        let damage = || {
            fs::write(&path, "no database").unwrap();
            Logbook::open(&path).unwrap().damaged_file().unwrap().unwrap()
        };
        let (first, second) = (damage(), damage());
        assert_ne!(first, second);
        fs::remove_file(second).unwrap();
        let moved = root.path().join("after");
        fs::rename(root.path().join("before"), &moved).unwrap();
        let logbook = Logbook::open(&moved.join("logbook.sqlite")).unwrap();
        let first = moved.join(first.file_name().unwrap());
        assert_eq!(logbook.damaged_file().unwrap().as_ref(), Some(&first));
        fs::remove_file(&first).unwrap();
        assert!(logbook.damaged_file().unwrap().is_some_and(|gone| !may_exist(&gone)));
    }
}
