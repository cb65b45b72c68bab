//! User-defined device descriptions, one per file. An unreadable file does not affect the others.

use std::fs;
use std::path::{Path, PathBuf};

use super::file_error::{FileError, FileErrorKind, FileOperation};
use super::files::read_file;

/// Reads all files in a folder with the given extension. Returns their paths and contents, sorted by name, and the
/// errors of unreadable files. A missing folder counts as empty.
pub fn read_folder(folder: &Path, ending: &str) -> (Vec<(String, String)>, Vec<FileError>) {
    let (mut texts, mut errors) = (Vec::new(), Vec::new());
    match list_files(folder, ending) {
        Ok(paths) => {
            for path in paths {
                match read_file(&path) {
                    Ok(text) => texts.push((path.display().to_string(), text)),
                    Err(error) => errors.push(error),
                }
            }
        }
        Err(FileErrorKind::NotFound) => {}
        Err(problem) => errors.push(problem.into_error(FileOperation::List, folder)),
    }
    (texts, errors)
}

fn list_files(folder: &Path, ending: &str) -> Result<Vec<PathBuf>, FileErrorKind> {
    let mut paths = Vec::new();
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.extension().is_some_and(|own| own.eq_ignore_ascii_case(ending)) {
            paths.push(path);
        }
    }
    paths.sort();
    Ok(paths)
}
