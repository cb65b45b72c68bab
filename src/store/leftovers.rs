//! Temporary files left by a program that was killed during a write.

use std::fs::{self, DirEntry};
use std::path::Path;
use std::time::Duration;

/// Prefix of the names of temporary files.
pub(super) const PREFIX: &str = ".encoder-studio-";
/// Suffix of the names of temporary files.
pub(super) const SUFFIX: &str = ".tmp";

/// Minimum age of a leftover temporary file. A write takes only seconds.
const STALE_AGE: Duration = Duration::from_secs(3600);

/// Depth of nested folders in the program's data, as in `backups/biss/77`.
const DEPTH: usize = 3;

/// Removes leftover temporary files from one folder. Files that cannot be removed are kept.
pub(super) fn remove_in_folder(folder: &Path) {
    entries(folder).filter(is_stale_temporary).for_each(remove);
}

/// Removes leftover temporary files from a folder of the program and its subfolders.
pub(super) fn remove_recursively(folder: &Path) {
    remove_to_depth(folder, DEPTH);
}

fn remove_to_depth(folder: &Path, depth: usize) {
    for entry in entries(folder) {
        match entry.file_type() {
            Ok(kind) if kind.is_dir() && depth > 0 => remove_to_depth(&entry.path(), depth - 1),
            Ok(kind) if kind.is_file() && is_stale_temporary(&entry) => remove(entry),
            _ => {}
        }
    }
}

fn entries(folder: &Path) -> impl Iterator<Item = DirEntry> {
    fs::read_dir(folder).into_iter().flatten().filter_map(Result::ok)
}

fn is_stale_temporary(entry: &DirEntry) -> bool {
    let name = entry.file_name();
    let is_temporary = name.to_str().is_some_and(|name| name.starts_with(PREFIX) && name.ends_with(SUFFIX));
    let modified = || entry.metadata().and_then(|data| data.modified()).ok();
    is_temporary && modified().and_then(|at| at.elapsed().ok()).is_some_and(|age| age >= STALE_AGE)
}

fn remove(entry: DirEntry) {
    if let Err(error) = fs::remove_file(entry.path()) {
        tracing::warn!("{}: {error}", entry.path().display());
    }
}

#[cfg(test)]
mod tests {
    use std::time::SystemTime;

    use super::*;
    use crate::store::{Store, write_atomically};

    fn create(path: &Path, age: Duration) {
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        let file = fs::File::create(path).unwrap();
        file.set_modified(SystemTime::now() - age).unwrap();
    }

    #[test]
    fn removes_only_old_temporary_files() {
        let folder = tempfile::tempdir().unwrap();
        let data = folder.path().join("data");
        let (old, new) = (2 * STALE_AGE, Duration::from_secs(5));
        let left = [data.join(".encoder-studio-a1.tmp"), data.join("backups/biss/77/.encoder-studio-b2.tmp")];
        let kept = [data.join("backups/biss/77/1.ron"), data.join("x.tmp"), data.join(".encoder-studio-c.ron")];
        let fresh = data.join(".encoder-studio-d4.tmp");
        left.iter().chain(&kept).for_each(|path| create(path, old));
        create(&fresh, new);
        Store::at_root(folder.path()).remove_leftovers();
        assert!(left.iter().all(|path| !path.exists()));
        assert!(kept.iter().all(|path| path.exists()) && fresh.exists(), "another program may be writing it");
    }

    #[test]
    fn write_removes_leftovers() {
        let folder = tempfile::tempdir().unwrap();
        let left = folder.path().join(".encoder-studio-a1.tmp");
        create(&left, 2 * STALE_AGE);
        write_atomically(&folder.path().join("a.ron"), b"new").unwrap();
        assert!(!left.exists() && folder.path().join("a.ron").exists());
    }
}
