//! Search for files in folders and their subfolders. It is limited, so that it ends soon even in a large folder. Hidden
//! folders and links to folders are skipped, and a folder that cannot be read counts as empty.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// A search for files with one extension in several folders.
#[derive(Debug)]
pub struct FileSearch {
    extension: &'static str,
    /// Number of files that may still be found.
    files_left: usize,
    /// Total size in bytes of the files that may still be found.
    bytes_left: u64,
    /// Number of entries of folders that may still be examined.
    entries_left: usize,
    searched: BTreeSet<PathBuf>,
    is_truncated: bool,
}

impl FileSearch {
    /// Maximum number of entries examined in all folders.
    const ENTRIES: usize = 50_000;

    /// Creates a search that finds at most `files` files with a total size of at most `bytes`.
    pub fn new(extension: &'static str, files: usize, bytes: u64) -> Self {
        FileSearch {
            extension,
            files_left: files,
            bytes_left: bytes,
            entries_left: Self::ENTRIES,
            searched: BTreeSet::new(),
            is_truncated: false,
        }
    }

    /// Returns the files in a folder and its subfolders, sorted by path. `levels` is the number of levels of folders,
    /// including the folder itself. Folders that were searched before, and those for which `skips` returns `true`, are
    /// left out.
    pub fn find(&mut self, folder: &Path, levels: usize, skips: &dyn Fn(&Path) -> bool) -> Vec<PathBuf> {
        let mut found = Vec::new();
        let mut waiting = vec![(folder.to_owned(), levels)];
        'search: while let Some((folder, levels)) = waiting.pop() {
            if levels == 0 || skips(&folder) || !self.searched.insert(folder.clone()) {
                continue;
            }
            let Ok(entries) = fs::read_dir(&folder) else { continue };
            for entry in entries.flatten() {
                if self.files_left == 0 || self.entries_left == 0 {
                    self.is_truncated = true;
                    break 'search;
                }
                self.entries_left -= 1;
                let (path, is_hidden) = (entry.path(), entry.file_name().as_encoded_bytes().starts_with(b"."));
                if is_hidden {
                    continue;
                }
                if entry.file_type().is_ok_and(|kind| kind.is_dir()) {
                    waiting.push((path, levels - 1));
                } else if self.has_extension(&path)
                    && let Ok(file) = fs::metadata(&path)
                    && file.is_file()
                {
                    let Some(bytes_left) = self.bytes_left.checked_sub(file.len()) else {
                        self.is_truncated = true;
                        continue;
                    };
                    (self.files_left, self.bytes_left) = (self.files_left - 1, bytes_left);
                    found.push(path);
                }
            }
        }
        found.sort();
        found
    }

    /// Returns whether a limit has ended the search.
    pub fn is_truncated(&self) -> bool {
        self.is_truncated
    }

    fn has_extension(&self, path: &Path) -> bool {
        path.extension().is_some_and(|own| own.eq_ignore_ascii_case(self.extension))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder_with(files: &[&str]) -> tempfile::TempDir {
        let root = tempfile::tempdir().unwrap();
        for file in files {
            let path = root.path().join(file);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, "").unwrap();
        }
        root
    }

    fn names(root: &tempfile::TempDir, found: Vec<PathBuf>) -> Vec<String> {
        let name = |path: PathBuf| path.strip_prefix(root.path()).unwrap().to_str().unwrap().replace('\\', "/");
        found.into_iter().map(name).collect()
    }

    #[test]
    fn finds_files_down_to_maximum_depth() {
        let root =
            folder_with(&["b.ron", "a/c.RON", "a/b/d.ron", "a/b/c/e.ron", "a/b.txt", ".hidden/f.ron", "own/g.ron"]);
        let mut search = FileSearch::new("ron", 100, 100);
        let found = search.find(root.path(), 3, &|path| path.ends_with("own"));
        assert_eq!(names(&root, found), ["a/b/d.ron", "a/c.RON", "b.ron"]);
        assert!(search.find(&root.path().join("a"), 3, &|_| false).is_empty(), "it was searched before");
        assert!(search.find(&root.path().join("none"), 3, &|_| false).is_empty());
        assert!(!search.is_truncated());
        let found = FileSearch::new("ron", 100, 100).find(root.path(), 1, &|_| false);
        assert_eq!(names(&root, found), ["b.ron"]);
    }

    #[test]
    fn search_stops_at_file_limit() {
        let root = folder_with(&["a.ron", "b.ron", "c.ron"]);
        for (limit, is_truncated) in [(3, false), (2, true)] {
            let mut search = FileSearch::new("ron", limit, 100);
            assert_eq!(search.find(root.path(), 1, &|_| false).len(), limit);
            assert_eq!(search.is_truncated(), is_truncated);
        }
    }

    #[test]
    fn search_ends_in_all_folders() {
        let root = folder_with(&["a/b.ron", "c/d.ron", "e/f.ron", "g/h.ron"]);
        let mut search = FileSearch::new("ron", 1, 100);
        assert_eq!(search.find(root.path(), 2, &|_| false).len(), 1);
        assert_eq!((search.searched.len(), search.is_truncated()), (3, true), "the folder itself and two more");
        let mut search = FileSearch { entries_left: 5, ..FileSearch::new("ron", 100, 100) };
        assert_eq!(search.find(root.path(), 2, &|_| false).len(), 1, "the folder itself has four entries");
        assert!(search.is_truncated());
    }

    #[test]
    fn size_of_all_files_is_limited() {
        let root = folder_with(&["a.ron", "b.ron", "c.ron"]);
        fs::write(root.path().join("b.ron"), "x".repeat(101)).unwrap();
        for name in ["a.ron", "c.ron"] {
            fs::write(root.path().join(name), "x".repeat(50)).unwrap();
        }
        let mut search = FileSearch::new("ron", 100, 100);
        let found = search.find(root.path(), 1, &|_| false);
        assert_eq!((names(&root, found), search.is_truncated()), (vec!["a.ron".to_owned(), "c.ron".to_owned()], true));
    }

    #[cfg(unix)]
    #[test]
    fn does_not_follow_folder_links() {
        let root = folder_with(&["a/b.ron"]);
        std::os::unix::fs::symlink(root.path(), root.path().join("a/again")).unwrap();
        std::os::unix::fs::symlink(root.path().join("a/b.ron"), root.path().join("c.ron")).unwrap();
        let found = FileSearch::new("ron", 100, 100).find(root.path(), 9, &|_| false);
        assert_eq!(names(&root, found), ["a/b.ron", "c.ron"]);
    }
}
