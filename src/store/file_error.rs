//! Reasons why a file could not be read or written: system errors grouped by what the user can do about them.

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

/// A file that could not be read or written.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("cannot {task} {}: {problem}", path.display())]
pub struct FileError {
    pub path: PathBuf,
    pub task: FileTask,
    pub problem: FileProblem,
}

/// An operation on a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileTask {
    Read,
    Write,
    List,
    CreateFolder,
    Remove,
}

impl fmt::Display for FileTask {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            FileTask::Read => "read",
            FileTask::Write => "write",
            FileTask::List => "list",
            FileTask::CreateFolder => "create",
            FileTask::Remove => "remove",
        })
    }
}

/// The obstacle to reading or writing a file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FileProblem {
    /// The file does not exist.
    #[error("it does not exist")]
    NotFound,
    /// The folder in which the file is to be written does not exist.
    #[error("its folder does not exist")]
    NoFolder,
    /// A file is in a place where the path needs a folder.
    #[error("a part of the path is a file, not a folder")]
    NotFolder,
    #[error("it is a folder")]
    IsFolder,
    /// The path is that of a pipe or a device.
    #[error("it is no file but a pipe or a device")]
    NotAFile,
    /// The file exists, and replacing it was not allowed.
    #[error("it exists already")]
    Exists,
    /// This user may not do this.
    #[error("permission denied")]
    PermissionDenied,
    /// The file, or its disk, is marked as read-only.
    #[error("it is write-protected")]
    WriteProtected,
    /// The disk is full, or this user's share of it.
    #[error("the disk is full")]
    DiskFull,
    /// Another program has had it locked for seconds.
    #[error("another program keeps it locked")]
    InUse,
    /// The file is larger than any the program writes.
    #[error("it is larger than {limit} bytes")]
    TooLarge {
        /// Most bytes possible.
        limit: u64,
    },
    /// The file is not a text, or a text in another encoding.
    #[error("it is not UTF-8 text: byte {offset} does not fit")]
    NotUtf8 {
        /// The first byte that does not fit, counted from 0.
        offset: usize,
    },
    /// Any other error, as named by the system.
    #[error("{what}")]
    Other {
        /// The system's kind of error.
        kind: io::ErrorKind,
        what: String,
    },
}

impl From<io::Error> for FileProblem {
    fn from(error: io::Error) -> Self {
        use io::ErrorKind as Kind;
        match error.kind() {
            Kind::NotFound => FileProblem::NotFound,
            Kind::NotADirectory => FileProblem::NotFolder,
            Kind::IsADirectory => FileProblem::IsFolder,
            Kind::AlreadyExists => FileProblem::Exists,
            Kind::PermissionDenied => FileProblem::PermissionDenied,
            Kind::ReadOnlyFilesystem => FileProblem::WriteProtected,
            Kind::StorageFull | Kind::QuotaExceeded => FileProblem::DiskFull,
            kind => FileProblem::Other { kind, what: error.to_string() },
        }
    }
}

impl FileProblem {
    pub(super) fn of(self, task: FileTask, path: &Path) -> FileError {
        FileError { path: path.to_owned(), task, problem: self }
    }

    /// Returns the problem of creating a new file, where the file itself cannot be the missing one.
    pub(super) fn while_making(error: io::Error) -> Self {
        match error.into() {
            FileProblem::NotFound => FileProblem::NoFolder,
            problem => problem,
        }
    }
}
