//! Reads and writes whole files. New content is written to a temporary file in the same folder, flushed, and renamed. A
//! file therefore contains either all of the old content or all of the new content.

use std::fs::{self, File, OpenOptions, Permissions};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::mpsc;
use std::thread;
use std::time::Duration;

use tempfile::NamedTempFile;

use super::file_error::{FileError, FileErrorKind, FileOperation};
use super::leftovers;

/// Maximum number of bytes that [`read_text`] accepts: 16 MiB. The largest profile is a hundred times smaller.
pub const MAX_TEXT_BYTES: u64 = 16 << 20;

/// Byte order mark that some editors write at the beginning of a file.
const BYTE_ORDER_MARK: &str = "\u{FEFF}";

/// Writes a file so that a crash or a full disk leaves either the old content or the new content.
///
/// An existing file keeps its permissions. A symbolic link is preserved, and its target is replaced. A device or pipe
/// such as `/dev/stdout` has no content to protect and is written to directly.
///
/// # Errors
/// Returns an error if the folder is missing, the target is a folder or write-protected, or the disk is full. In this
/// case, the old content stays unchanged.
pub fn write_atomically(path: &Path, content: &[u8]) -> Result<(), FileError> {
    if fs::metadata(path).is_ok_and(|target| !target.is_dir() && !target.is_file()) {
        return write_directly(path, content)
            .map_err(|error| FileErrorKind::from(error).into_error(FileOperation::Write, path));
    }
    write_atomically_with(path, |file| file.write_all(content))
}

/// Writes a text like [`write_atomically`], but keeps an existing byte order mark.
///
/// # Errors
/// Returns an error from [`write_atomically`].
pub fn overwrite_text(path: &Path, text: &str) -> Result<(), FileError> {
    let is_file = fs::metadata(path).is_ok_and(|target| target.is_file());
    let has_mark = is_file && read_at_most(path, 3).is_ok_and(|head| head == BYTE_ORDER_MARK.as_bytes());
    let mark = if has_mark && !text.starts_with(BYTE_ORDER_MARK) { BYTE_ORDER_MARK } else { "" };
    write_atomically(path, [mark, text].concat().as_bytes())
}

/// Writes a file like [`write_atomically`], with content that `write` produces piece by piece. If `write` fails, the
/// old file stays unchanged.
///
/// # Errors
/// Returns an error from [`write_atomically`] or `write`, or an error if the path refers to a device or a pipe.
pub fn write_atomically_with(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), FileError> {
    let failed = |problem: FileErrorKind| problem.into_error(FileOperation::Write, path);
    let permissions = match fs::metadata(path) {
        Ok(target) if target.is_dir() => return Err(failed(FileErrorKind::IsFolder)),
        Ok(target) if !target.is_file() => return Err(failed(FileErrorKind::NotAFile)),
        // Renaming would bypass the write protection of the file.
        Ok(target) if target.permissions().readonly() => return Err(failed(FileErrorKind::WriteProtected)),
        Ok(target) => Some(target.permissions()),
        Err(_) => None,
    };
    let target = resolve_links(path).map_err(|e| failed(e.into()))?;
    let failed = |problem: FileErrorKind| problem.into_error(FileOperation::Write, &target);
    let folder = parent_folder(&target).map_err(failed)?;
    let staged =
        write_temp_file(folder, write, permissions).map_err(|e| failed(FileErrorKind::from_create_error(e)))?;
    staged.persist(&target).map_err(|e| failed(e.error.into()))?;
    platform::flush_folder(folder).map_err(|e| failed(e.into()))
}

/// Writes a new file like [`write_atomically`], but never replaces an existing file, even if another program creates it
/// at the same time.
///
/// # Errors
/// Returns [`FileErrorKind::Exists`] if the file exists.
pub(super) fn write_new(path: &Path, content: &[u8]) -> Result<(), FileError> {
    let failed = |problem: FileErrorKind| problem.into_error(FileOperation::Write, path);
    let folder = parent_folder(path).map_err(failed)?;
    let staged = write_temp_file(folder, |file| file.write_all(content), None)
        .map_err(|e| failed(FileErrorKind::from_create_error(e)))?;
    staged.persist_noclobber(path).map_err(|e| failed(e.error.into()))?;
    platform::flush_folder(folder).map_err(|e| failed(e.into()))
}

pub(super) fn create_folder(path: &Path) -> Result<(), FileError> {
    fs::create_dir_all(path).map_err(|error| match error.into() {
        // An existing folder does not cause an error, so this is a file or a broken link.
        FileErrorKind::Exists => FileErrorKind::NotFolder.into_error(FileOperation::CreateFolder, path),
        problem => problem.into_error(FileOperation::CreateFolder, path),
    })
}

/// Writes one of the program's own files like [`write_atomically`], creating the folder if it is missing.
///
/// # Errors
/// Returns an error if the folder cannot be created, or an error from [`write_atomically`].
pub fn create_folder_and_write(path: &Path, content: &[u8]) -> Result<(), FileError> {
    if let Some(folder) = path.parent() {
        create_folder(folder)?;
    }
    write_atomically(path, content)
}

/// Reads a text like [`read_text`], but only from a regular file. Reading from a pipe could block forever.
///
/// # Errors
/// Returns the same errors as [`read_text`], or an error if the path refers to a pipe or a device.
pub fn read_file(path: &Path) -> Result<String, FileError> {
    match fs::metadata(path) {
        Ok(found) if !found.is_file() && !found.is_dir() => {
            Err(FileErrorKind::NotAFile.into_error(FileOperation::Read, path))
        }
        _ => read_text(path),
    }
}

/// Reads a text of at most [`MAX_TEXT_BYTES`] bytes and removes a leading byte order mark.
///
/// # Errors
/// Returns an error if the file is missing, is a folder, is too large or is not UTF-8.
pub fn read_text(path: &Path) -> Result<String, FileError> {
    let bytes = read_bytes(path)?;
    let text = String::from_utf8(bytes).map_err(|error| {
        let offset = error.utf8_error().valid_up_to();
        FileErrorKind::NotUtf8 { offset }.into_error(FileOperation::Read, path)
    })?;
    Ok(text.strip_prefix(BYTE_ORDER_MARK).map(str::to_owned).unwrap_or(text))
}

/// Reads a file of at most [`MAX_TEXT_BYTES`] bytes.
///
/// # Errors
/// Returns an error if the file is missing, is a folder or is too large.
pub fn read_bytes(path: &Path) -> Result<Vec<u8>, FileError> {
    let failed = |problem: FileErrorKind| problem.into_error(FileOperation::Read, path);
    let bytes = match read_at_most(path, MAX_TEXT_BYTES + 1) {
        Ok(bytes) => bytes,
        // Windows reports a folder as "permission denied".
        Err(_) if path.is_dir() => return Err(failed(FileErrorKind::IsFolder)),
        Err(error) => return Err(failed(error.into())),
    };
    if u64::try_from(bytes.len()).is_ok_and(|length| length > MAX_TEXT_BYTES) {
        return Err(failed(FileErrorKind::TooLarge { limit: MAX_TEXT_BYTES }));
    }
    Ok(bytes)
}

fn read_at_most(path: &Path, limit: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    File::open(path)?.take(limit).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Writes directly to a file. A pipe without a reader would block forever, so the write is aborted after a timeout.
fn write_directly(path: &Path, content: &[u8]) -> io::Result<()> {
    const WRITE_TIMEOUT: Duration = Duration::from_secs(8);
    let (sender, written) = mpsc::channel();
    let (path, content) = (path.to_owned(), content.to_vec());
    thread::spawn(move || {
        let result = OpenOptions::new().write(true).open(path).and_then(|mut file| file.write_all(&content));
        // The receiver may no longer exist.
        let _ = sender.send(result);
    });
    written
        .recv_timeout(WRITE_TIMEOUT)
        .unwrap_or_else(|_| Err(io::Error::new(io::ErrorKind::TimedOut, "no process reads the file")))
}

/// Follows a chain of symbolic links and returns the path at its end, which need not exist.
fn resolve_links(path: &Path) -> io::Result<PathBuf> {
    /// Maximum number of links to follow, the same as in Linux.
    const MAX_LINKS: usize = 40;
    let mut target = path.to_owned();
    for _ in 0..MAX_LINKS {
        // If the target cannot be read as a link, it is not a link. Any other error occurs again during the write.
        let Ok(next) = fs::read_link(&target) else { return Ok(target) };
        target = target.parent().unwrap_or(Path::new("")).join(next);
    }
    // The links form a cycle, for which the system reports an error.
    fs::metadata(path).map(|_| target)
}

fn parent_folder(path: &Path) -> Result<&Path, FileErrorKind> {
    match (path.parent(), path.file_name()) {
        (Some(folder), Some(_)) if folder.as_os_str().is_empty() => Ok(Path::new(".")),
        (Some(folder), Some(_)) => Ok(folder),
        // The path has no file name, as with "/" and "..".
        _ => Err(FileErrorKind::IsFolder),
    }
}

/// Writes a temporary file to the folder of the target and flushes it. Dropping the value removes the file.
fn write_temp_file(
    folder: &Path,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    permissions: Option<Permissions>,
) -> io::Result<NamedTempFile> {
    leftovers::remove_in_folder(folder);
    let mut builder = tempfile::Builder::new();
    builder.prefix(leftovers::PREFIX).suffix(leftovers::SUFFIX);
    if permissions.is_none() {
        platform::set_default_permissions(&mut builder);
    }
    let mut file = builder.tempfile_in(folder)?;
    write(&mut file)?;
    if let Some(permissions) = permissions {
        file.as_file().set_permissions(permissions)?;
    }
    file.as_file().sync_all()?;
    Ok(file)
}

#[cfg(unix)]
mod platform {
    use std::fs::{File, Permissions};
    use std::io;
    use std::os::unix::fs::PermissionsExt;
    use std::path::Path;

    /// Sets the usual permissions of a new file, subject to the umask. By default, a temporary file is accessible only
    /// to its owner.
    pub(super) fn set_default_permissions(builder: &mut tempfile::Builder<'_, '_>) {
        builder.permissions(Permissions::from_mode(0o666));
    }

    pub(super) fn flush_folder(folder: &Path) -> io::Result<()> {
        use io::ErrorKind as Kind;
        match File::open(folder).and_then(|folder| folder.sync_all()) {
            // The file is already in place. Some network drives cannot flush folders, and some folders are not
            // readable.
            Err(error) if matches!(error.kind(), Kind::InvalidInput | Kind::Unsupported | Kind::PermissionDenied) => {
                Ok(())
            }
            result => result,
        }
    }
}

#[cfg(not(unix))]
mod platform {
    use std::io;
    use std::path::Path;

    pub(super) fn set_default_permissions(_: &mut tempfile::Builder<'_, '_>) {}

    pub(super) fn flush_folder(_: &Path) -> io::Result<()> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn problem(result: Result<impl std::fmt::Debug, FileError>) -> FileErrorKind {
        result.unwrap_err().problem
    }

    fn names(folder: &Path) -> Vec<String> {
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
    }

    #[test]
    fn writes_and_replaces_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.ron");
        for content in ["first, and longer", "second", ""] {
            write_atomically(&path, content.as_bytes()).unwrap();
            assert_eq!(read_text(&path).unwrap(), content);
        }
        assert_eq!(names(folder.path()), ["a.ron"]);
    }

    #[test]
    fn failed_write_reports_reason() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("file");
        fs::write(&file, "x").unwrap();
        let cases = [
            ("missing folder", folder.path().join("no/a.ron"), FileErrorKind::NoFolder),
            ("a file for a folder", file.join("a.ron"), FileErrorKind::NotFolder),
            ("a folder", folder.path().to_owned(), FileErrorKind::IsFolder),
            ("the folder above", folder.path().join(".."), FileErrorKind::IsFolder),
            ("no name", PathBuf::new(), FileErrorKind::IsFolder),
        ];
        for (label, path, expected) in cases {
            let error = write_atomically(&path, b"new").unwrap_err();
            assert_eq!((error.task, error.problem), (FileOperation::Write, expected), "{label}");
        }
        assert_eq!(names(folder.path()), ["file"]);
    }

    #[test]
    fn failed_write_keeps_old_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.ron");
        write_new(&path, b"old").unwrap();
        assert_eq!(problem(write_new(&path, b"new")), FileErrorKind::Exists);

        let mut permissions = fs::metadata(&path).unwrap().permissions();
        permissions.set_readonly(true);
        fs::set_permissions(&path, permissions).unwrap();
        assert_eq!(problem(write_atomically(&path, b"new")), FileErrorKind::WriteProtected);

        assert_eq!(read_text(&path).unwrap(), "old");
        assert_eq!(names(folder.path()), ["a.ron"]);
    }

    #[test]
    fn rejects_binary_files() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.ron");
        assert_eq!(problem(read_text(&path)), FileErrorKind::NotFound);
        assert_eq!(problem(read_text(folder.path())), FileErrorKind::IsFolder);
        fs::write(&path, b"\xEF\xBB\xBFab\xFFc").unwrap();
        assert_eq!(problem(read_text(&path)), FileErrorKind::NotUtf8 { offset: 5 });
        fs::write(&path, b"\xEF\xBB\xBFab").unwrap();
        assert_eq!(read_text(&path).unwrap(), "ab");
        File::create(&path).unwrap().set_len(MAX_TEXT_BYTES).unwrap();
        assert_eq!(read_text(&path).unwrap().len() as u64, MAX_TEXT_BYTES);
        File::create(&path).unwrap().set_len(MAX_TEXT_BYTES + 1).unwrap();
        assert_eq!(problem(read_text(&path)), FileErrorKind::TooLarge { limit: MAX_TEXT_BYTES });
    }

    #[test]
    fn creates_folder_once() {
        let folder = tempfile::tempdir().unwrap();
        let deep = folder.path().join("a/b");
        create_folder(&deep).unwrap();
        create_folder(&deep).unwrap();
        fs::write(deep.join("file"), "x").unwrap();
        assert_eq!(problem(create_folder(&deep.join("file"))), FileErrorKind::NotFolder);
        assert_eq!(problem(create_folder(&deep.join("file/c"))), FileErrorKind::NotFolder);
    }

    #[cfg(unix)]
    mod unix {
        use super::*;
        use std::os::unix::fs::{PermissionsExt, symlink};

        fn mode(path: &Path) -> u32 {
            fs::metadata(path).unwrap().permissions().mode() & 0o7777
        }

        #[test]
        fn preserves_permissions() {
            let folder = tempfile::tempdir().unwrap();
            let [ours, usual] = ["ours", "usual"].map(|name| folder.path().join(name));
            fs::write(&usual, "x").unwrap();
            write_atomically(&ours, b"x").unwrap();
            assert_eq!(mode(&ours), mode(&usual));
            for bits in [0o600, 0o664, 0o777] {
                fs::set_permissions(&ours, Permissions::from_mode(bits)).unwrap();
                write_atomically(&ours, b"y").unwrap();
                assert_eq!(mode(&ours), bits, "{bits:o}");
            }
        }

        #[test]
        fn keeps_symlink() {
            let folder = tempfile::tempdir().unwrap();
            let [link, second, target] = ["link", "second", "sub/target"].map(|name| folder.path().join(name));
            fs::create_dir(folder.path().join("sub")).unwrap();
            symlink("second", &link).unwrap();
            symlink(&target, &second).unwrap();
            // In the first round, the link leads to a file that does not exist yet.
            for content in ["made", "replaced"] {
                write_atomically(&link, content.as_bytes()).unwrap();
                assert_eq!(read_text(&target).unwrap(), content);
                assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
            }
            assert_eq!(names(&folder.path().join("sub")), ["target"]);
        }

        #[test]
        fn reports_symlink_loop() {
            let folder = tempfile::tempdir().unwrap();
            let link = folder.path().join("link");
            symlink("link", &link).unwrap();
            assert!(matches!(problem(write_atomically(&link, b"x")), FileErrorKind::Other { .. }));
            assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        }

        #[test]
        #[cfg(target_os = "linux")]
        fn writes_to_device_directly() {
            use std::os::unix::fs::FileTypeExt;
            write_atomically(Path::new("/dev/null"), b"x").unwrap();
            assert!(fs::metadata("/dev/null").unwrap().file_type().is_char_device());
            assert_eq!(problem(write_atomically(Path::new("/dev/full"), b"x")), FileErrorKind::DiskFull);
        }
    }
}
