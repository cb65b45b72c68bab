//! Reasons why a file could not be read or written. System errors are grouped by what the user can do about them.

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("cannot {task} {}: {problem}", path.display())]
pub struct FileError {
    pub path: PathBuf,
    pub task: FileOperation,
    pub problem: FileErrorKind,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileOperation {
    Read,
    Write,
    List,
    CreateFolder,
    Remove,
}

impl fmt::Display for FileOperation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            FileOperation::Read => "read",
            FileOperation::Write => "write",
            FileOperation::List => "list",
            FileOperation::CreateFolder => "create",
            FileOperation::Remove => "remove",
        })
    }
}

#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FileErrorKind {
    #[error("it does not exist")]
    NotFound,
    /// The folder of the new file does not exist.
    #[error("its folder does not exist")]
    NoFolder,
    /// A component of the path is a file rather than a folder.
    #[error("a part of the path is a file, not a folder")]
    NotFolder,
    #[error("it is a folder")]
    IsFolder,
    /// The path refers to a pipe or a device.
    #[error("it is a pipe or a device, not a file")]
    NotAFile,
    /// The file already exists and must not be replaced.
    #[error("it already exists")]
    Exists,
    #[error("permission denied")]
    PermissionDenied,
    /// The file or its disk is marked as read-only.
    #[error("it is write-protected")]
    WriteProtected,
    /// The disk is full, or the user's quota is exhausted.
    #[error("the disk is full")]
    DiskFull,
    /// Another program has kept the file locked for several seconds.
    #[error("it is locked by another program")]
    InUse,
    /// The file is larger than any file that the program writes.
    #[error("it is larger than {limit} bytes")]
    TooLarge {
        /// Maximum size in bytes.
        limit: u64,
    },
    /// The file is not text, or uses another encoding.
    #[error("it is not UTF-8 text: byte {offset} is not valid")]
    NotUtf8 {
        /// Offset of the first invalid byte, counted from 0.
        offset: usize,
    },
    #[error("{what}")]
    Other { kind: io::ErrorKind, what: String },
}

impl From<io::Error> for FileErrorKind {
    fn from(error: io::Error) -> Self {
        use io::ErrorKind as Kind;
        match error.kind() {
            Kind::NotFound => FileErrorKind::NotFound,
            Kind::NotADirectory => FileErrorKind::NotFolder,
            Kind::IsADirectory => FileErrorKind::IsFolder,
            Kind::AlreadyExists => FileErrorKind::Exists,
            Kind::PermissionDenied => FileErrorKind::PermissionDenied,
            Kind::ReadOnlyFilesystem => FileErrorKind::WriteProtected,
            Kind::StorageFull | Kind::QuotaExceeded => FileErrorKind::DiskFull,
            kind => FileErrorKind::Other { kind, what: error.to_string() },
        }
    }
}

impl FileErrorKind {
    pub(super) fn into_error(self, task: FileOperation, path: &Path) -> FileError {
        FileError { path: path.to_owned(), task, problem: self }
    }

    /// Converts an error from creating a file. Only the folder can be missing, because the file is new.
    pub(super) fn from_create_error(error: io::Error) -> Self {
        match error.into() {
            FileErrorKind::NotFound => FileErrorKind::NoFolder,
            problem => problem,
        }
    }
}
