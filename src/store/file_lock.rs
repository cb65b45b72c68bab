//! Locks on files that several programs use. The system releases the locks of a program when it ends for any reason.

use std::fs::{File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::thread;
use std::time::{Duration, Instant};

use super::file_error::{FileError, FileErrorKind, FileOperation};
use super::files::{create_folder, read_text, write_atomically};

/// Maximum time to wait for another program that is using the file.
const LOCK_TIMEOUT: Duration = Duration::from_secs(2);
const RETRY: Duration = Duration::from_millis(5);

/// A lock that excludes all other programs until it is dropped.
#[derive(Debug)]
pub(super) struct FileLock {
    _locked: File,
}

impl FileLock {
    /// Locks a lock file, creating it if missing. Returns `None` if this or another program already holds the lock.
    pub(super) fn try_lock_at(path: &Path) -> Result<Option<Self>, FileError> {
        let failed = |error: io::Error| FileErrorKind::from(error).into_error(FileOperation::Write, path);
        let file = open(path).map_err(failed)?;
        match file.try_lock() {
            Ok(()) => Ok(Some(FileLock { _locked: file })),
            Err(TryLockError::WouldBlock) => Ok(None),
            // The disk does not support locks.
            Err(TryLockError::Error(error)) if error.kind() == io::ErrorKind::Unsupported => {
                Ok(Some(FileLock { _locked: file }))
            }
            Err(TryLockError::Error(error)) => Err(failed(error)),
        }
    }
}

fn open(path: &Path) -> io::Result<File> {
    match File::options().create(true).truncate(false).write(true).open(path) {
        // The file was created by another user. Locking does not require write permission.
        Err(error) if error.kind() == io::ErrorKind::PermissionDenied => File::open(path),
        result => result,
    }
}

/// Replaces the text of a file with the result of `make`, while other callers in any program wait. Creates the folder
/// if it is missing, and writes the text with [`write_atomically`].
///
/// `make` receives the current text, or the error if it cannot be read. It returns `None` to leave the file unchanged.
///
/// # Errors
/// Returns [`FileErrorKind::InUse`] if another program holds the lock for too long, or an error from
/// [`write_atomically`] or `make`.
pub fn update_text<T>(
    path: &Path,
    make: impl FnOnce(Result<String, FileError>) -> Result<(Option<String>, T), FileError>,
) -> Result<T, FileError> {
    if let Some(folder) = path.parent() {
        create_folder(folder)?;
    }
    let _lock = wait_for(path)?;
    let (text, made) = make(read_text(path))?;
    if let Some(text) = text {
        write_atomically(path, text.as_bytes())?;
    }
    Ok(made)
}

/// Waits until a file can be locked.
pub(super) fn wait_for(path: &Path) -> Result<FileLock, FileError> {
    let beside = lock_path(path);
    let began = Instant::now();
    loop {
        // The error names the user's file rather than the lock file.
        let tried = FileLock::try_lock_at(&beside).map_err(|error| FileError { path: path.to_owned(), ..error })?;
        match tried {
            Some(lock) => return Ok(lock),
            None if began.elapsed() > LOCK_TIMEOUT => {
                return Err(FileErrorKind::InUse.into_error(FileOperation::Write, path));
            }
            None => thread::sleep(RETRY),
        }
    }
}

/// Returns the path of the lock file. It is a separate file, because each write replaces the file itself.
fn lock_path(path: &Path) -> PathBuf {
    let mut beside = path.to_owned().into_os_string();
    beside.push(".lock");
    PathBuf::from(beside)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn append_text(text: Result<String, FileError>, more: &str) -> Result<(Option<String>, usize), FileError> {
        let text = text.or_else(|error| match error.problem {
            FileErrorKind::NotFound => Ok(String::new()),
            _ => Err(error),
        })?;
        Ok((Some(text.clone() + more), text.len()))
    }

    #[test]
    fn update_sees_previous_update() {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("config/a.ron");
        let writers: Vec<_> = (0..4)
            .map(|_| {
                let path = path.clone();
                thread::spawn(move || {
                    for _ in 0..25 {
                        update_text(&path, |text| append_text(text, "x")).unwrap();
                    }
                })
            })
            .collect();
        writers.into_iter().for_each(|writer| writer.join().unwrap());
        assert_eq!(fs::read_to_string(&path).unwrap(), "x".repeat(100));
        assert_eq!(update_text(&path, |_| Ok((None, 7))), Ok(7));
        assert_eq!(fs::read_to_string(&path).unwrap().len(), 100, "as it was");
    }

    #[test]
    fn held_lock_times_out() {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("a.ron");
        fs::write(&path, "old").unwrap();
        let lock = FileLock::try_lock_at(&lock_path(&path)).unwrap();
        assert!(lock.is_some() && FileLock::try_lock_at(&lock_path(&path)).unwrap().is_none());
        let error = update_text(&path, |text| append_text(text, "x")).unwrap_err();
        assert_eq!((&error.path, error.problem), (&path, FileErrorKind::InUse));
        assert_eq!(fs::read_to_string(&path).unwrap(), "old");
        drop(lock);
        assert_eq!(update_text(&path, |text| append_text(text, "x")), Ok(3));
    }

    #[test]
    fn blocked_lock_names_file() {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("a.ron");
        fs::create_dir_all(lock_path(&path)).unwrap();
        let error = update_text(&path, |text| append_text(text, "x")).unwrap_err();
        assert_eq!((error.path, error.problem), (path, FileErrorKind::IsFolder));
    }

    #[cfg(unix)]
    #[test]
    fn locks_read_only_file() {
        use std::os::unix::fs::PermissionsExt;
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("a.ron.lock");
        fs::write(&path, "").unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(0o444)).unwrap();
        let lock = FileLock::try_lock_at(&path).unwrap();
        assert!(lock.is_some() && FileLock::try_lock_at(&path).unwrap().is_none());
    }
}
