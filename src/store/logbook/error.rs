//! Reasons why the logbook cannot be used. SQLite result codes are grouped by what the user can do about them.

use std::path::{Path, PathBuf};

use rusqlite::ErrorCode;

use super::EntryId;
use crate::store::FileError;

#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("logbook {}: {problem}", path.display())]
pub struct LogbookError {
    pub path: PathBuf,
    pub problem: LogbookErrorKind,
}

#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LogbookErrorKind {
    #[error(transparent)]
    Folder(FileError),
    /// The file cannot be opened, because its path is a folder or permission is missing.
    #[error("the file cannot be opened")]
    NoAccess,
    /// The file can be read but not written.
    #[error("the file is write-protected")]
    WriteProtected,
    /// Another program held the lock on the file until the timeout.
    #[error("the file is in use by another program")]
    Locked,
    #[error("the disk is full")]
    DiskFull,
    /// The file is damaged or not a database.
    #[error("the file is damaged: {what}")]
    Damaged { what: String },
    /// The file was damaged. It has been renamed, and a new file has been started.
    #[error("the file was damaged and is kept as {kept}; a new one was begun")]
    SetAside { kept: PathBuf },
    /// The file was created by a newer version of the program and is left unchanged.
    #[error("the file uses schema {found} of a newer version; this version supports schemas up to {known}")]
    Newer {
        found: i64,
        /// Latest schema version that this program supports.
        known: i64,
    },
    /// The entry does not exist or has already been completed.
    #[error("entry {entry} is not open")]
    NotOpen { entry: EntryId },
    #[error("{what}")]
    Database {
        /// Extended SQLite result code, or `None` if the value was rejected before it reached SQLite.
        code: Option<i32>,
        what: String,
    },
}

impl LogbookErrorKind {
    pub(super) fn into_error(self, path: &Path) -> LogbookError {
        LogbookError { path: path.to_owned(), problem: self }
    }
}

impl From<rusqlite::Error> for LogbookErrorKind {
    fn from(error: rusqlite::Error) -> Self {
        use rusqlite::Error as Cause;
        let what = error.to_string();
        match error {
            Cause::SqliteFailure(failure, _) => match failure.code {
                ErrorCode::CannotOpen | ErrorCode::PermissionDenied => LogbookErrorKind::NoAccess,
                ErrorCode::ReadOnly => LogbookErrorKind::WriteProtected,
                ErrorCode::DatabaseBusy | ErrorCode::DatabaseLocked => LogbookErrorKind::Locked,
                ErrorCode::DiskFull => LogbookErrorKind::DiskFull,
                ErrorCode::NotADatabase | ErrorCode::DatabaseCorrupt => LogbookErrorKind::Damaged { what },
                _ => LogbookErrorKind::Database { code: Some(failure.extended_code), what },
            },
            // The table contains a value that the schema does not allow.
            Cause::FromSqlConversionFailure(..)
            | Cause::IntegralValueOutOfRange(..)
            | Cause::InvalidColumnType(..)
            | Cause::Utf8Error(..) => LogbookErrorKind::Damaged { what },
            _ => LogbookErrorKind::Database { code: None, what },
        }
    }
}
