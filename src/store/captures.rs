//! Reads captures from files in chunks, with progress and cancellation.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use super::file_error::{FileError, FileErrorKind, FileOperation};
use crate::analysis::capture::{Capture, CaptureError, HEAD_BYTES, Layout, TableHints, TableImport};

#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ReadCaptureError {
    #[error(transparent)]
    File(#[from] FileError),
    /// The file is not a valid capture.
    #[error(transparent)]
    Capture(#[from] CaptureError),
    #[error("cancelled")]
    Cancelled,
}

/// Callback that receives the number of bytes read and the total. The total is 0 for a pipe, which has no length.
pub type OnProgress<'a> = &'a mut dyn FnMut(u64, u64);

/// Number of bytes read at a time. Progress is reported and cancellation is checked after each read.
const CHUNK_BYTES: usize = 1 << 20;

/// Reads a capture and the layout of the table in its file.
///
/// # Errors
/// Returns a [`ReadCaptureError`] if the file is missing or is not a capture, or if `cancel` was set.
pub fn read_capture(
    path: &Path,
    hints: &TableHints,
    cancel: &AtomicBool,
    progress: OnProgress<'_>,
) -> Result<(Layout, Capture), ReadCaptureError> {
    let failed = |error: io::Error| {
        // Windows reports a folder as "permission denied".
        let problem = if path.is_dir() { FileErrorKind::IsFolder } else { error.into() };
        problem.into_error(FileOperation::Read, path)
    };
    let mut file = File::open(path).map_err(failed)?;
    let total = file.metadata().map(|data| if data.is_file() { data.len() } else { 0 }).unwrap_or(0);
    let mut piece = Vec::with_capacity(CHUNK_BYTES);
    let mut import: Option<TableImport> = None;
    let mut done = 0;
    loop {
        if cancel.load(Ordering::Relaxed) {
            return Err(ReadCaptureError::Cancelled);
        }
        piece.clear();
        // A single read from a pipe may return only a few bytes, but the first chunk must contain the whole head.
        let read = (&mut file).take(CHUNK_BYTES.max(HEAD_BYTES) as u64).read_to_end(&mut piece).map_err(failed)?;
        let importing = match &mut import {
            Some(importing) => importing,
            none => none.insert(TableImport::from_head(&piece, hints)?),
        };
        importing.process(&piece)?;
        done += read as u64;
        progress(done, total);
        if read == 0 {
            break;
        }
    }
    match import {
        Some(import) => Ok(import.finish()?),
        None => Err(CaptureError::Empty.into()),
    }
}

/// Returns the first [`HEAD_BYTES`] bytes of a file, or all bytes of a shorter file. A pipe yields no bytes, because its data
/// can be read only once.
///
/// # Errors
/// Returns a [`FileError`] if the file cannot be read.
pub fn capture_head(path: &Path) -> Result<Vec<u8>, FileError> {
    let failed = |error: io::Error| FileErrorKind::from(error).into_error(FileOperation::Read, path);
    let mut head = Vec::new();
    if std::fs::metadata(path).map_err(failed)?.is_file() {
        File::open(path).and_then(|file| file.take(HEAD_BYTES as u64).read_to_end(&mut head)).map_err(failed)?;
    }
    Ok(head)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn read(path: &Path, cancel: bool) -> (Result<usize, ReadCaptureError>, Vec<(u64, u64)>) {
        let mut told = Vec::new();
        let cancel = AtomicBool::new(cancel);
        let read = read_capture(path, &TableHints::default(), &cancel, &mut |done, total| told.push((done, total)));
        (read.map(|(_, capture)| capture.sine_v.len()), told)
    }

    #[test]
    fn reads_large_file_with_progress() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("c.csv");
        let text: String = (0..100_000).map(|at| format!("{at}e-6,0.{at},-0.{at}\n")).collect();
        fs::write(&path, &text).unwrap();
        let (rows, told) = read(&path, false);
        assert_eq!(rows, Ok(100_000));
        let length = text.len() as u64;
        assert!(told.len() >= 3 && told.windows(2).all(|pair| pair[0].0 <= pair[1].0), "{told:?}");
        assert_eq!(told.last(), Some(&(length, length)));
        assert_eq!(read(&path, true), (Err(ReadCaptureError::Cancelled), Vec::new()));
    }

    #[test]
    fn capture_head_is_start_of_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("c.csv");
        assert_eq!(capture_head(&path).unwrap_err().problem, FileErrorKind::NotFound);
        assert_eq!(capture_head(folder.path()), Ok(Vec::new()), "a folder is told by who reads it");
        fs::write(&path, "0,1,2\n".repeat(20_000)).unwrap();
        let head = capture_head(&path).unwrap();
        assert_eq!((head.len(), &head[..12]), (65_536, &b"0,1,2\n0,1,2\n"[..]));
    }

    #[test]
    fn unreadable_path_reports_system_error() {
        let folder = tempfile::tempdir().unwrap();
        let problem = |path: &Path| match read(path, false).0 {
            Err(ReadCaptureError::File(error)) => error.problem,
            other => panic!("{other:?}"),
        };
        assert_eq!(problem(folder.path()), FileErrorKind::IsFolder);
        assert_eq!(problem(&folder.path().join("none.csv")), FileErrorKind::NotFound);
        let empty = folder.path().join("empty.csv");
        fs::write(&empty, "").unwrap();
        assert_eq!(read(&empty, false).0, Err(ReadCaptureError::Capture(CaptureError::Empty)));
    }
}
