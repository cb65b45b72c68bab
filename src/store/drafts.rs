//! Drafts, which preserve unwritten edits if the program crashes or a cable is unplugged. Each draft is a file. The
//! caller supplies the text, which must not contain access codes.

use std::fs;
use std::path::PathBuf;

use super::file_error::{FileError, FileErrorKind, FileOperation};
use super::file_lock::FileLock;
use super::file_names::{LetterCase, safe_name};
use super::files::{create_folder, read_text, write_atomically};

const EXTENSION: &str = "ron";

/// The exclusive right to save a draft, held until the value is dropped. The system also releases it when the process
/// ends.
#[derive(Debug)]
pub struct Claim {
    _lock: FileLock,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Drafts(PathBuf);

impl Drafts {
    pub(super) fn in_folder(folder: PathBuf) -> Self {
        Drafts(folder)
    }

    /// Writes a draft to `<device>/<key>.ron`, replacing any earlier draft.
    ///
    /// # Errors
    /// Returns an error if the folder cannot be created or the file cannot be written. In this case, the earlier draft
    /// remains.
    pub fn save(&self, device: &str, key: &str, text: &str) -> Result<(), FileError> {
        create_folder(&self.device_folder(device))?;
        write_atomically(&self.draft_path(device, key), text.as_bytes())
    }

    /// Reads a draft, or returns `None` if the draft does not exist.
    ///
    /// # Errors
    /// Returns an error if a draft exists but cannot be read.
    pub fn load(&self, device: &str, key: &str) -> Result<Option<String>, FileError> {
        match read_text(&self.draft_path(device, key)) {
            Ok(text) => Ok(Some(text)),
            Err(FileError { problem: FileErrorKind::NotFound, .. }) => Ok(None),
            Err(error) => Err(error),
        }
    }

    pub fn has_drafts(&self, device: &str) -> bool {
        fs::read_dir(self.device_folder(device)).is_ok_and(|mut files| files.next().is_some())
    }

    /// Claims a draft. Returns `None` if this or another program has already claimed it.
    ///
    /// # Errors
    /// Returns an error if the lock file cannot be created.
    pub fn claim_draft(&self, device: &str, key: &str) -> Result<Option<Claim>, FileError> {
        // Locks have a separate folder, because every file in the drafts folder is considered a draft.
        let folder = self.0.with_file_name("locks").join(safe_name(device, LetterCase::Kept));
        create_folder(&folder)?;
        let path = folder.join(format!("{}.lock", safe_name(key, LetterCase::Told)));
        Ok(FileLock::try_lock_at(&path)?.map(|lock| Claim { _lock: lock }))
    }

    /// Removes a draft if it exists.
    ///
    /// # Errors
    /// Returns an error if the draft cannot be removed.
    pub fn remove(&self, device: &str, key: &str) -> Result<(), FileError> {
        let path = self.draft_path(device, key);
        match fs::remove_file(&path).map_err(FileErrorKind::from) {
            Ok(()) | Err(FileErrorKind::NotFound) => Ok(()),
            Err(problem) => Err(problem.into_error(FileOperation::Remove, &path)),
        }
    }

    fn device_folder(&self, device: &str) -> PathBuf {
        self.0.join(safe_name(device, LetterCase::Kept))
    }

    fn draft_path(&self, device: &str, key: &str) -> PathBuf {
        self.device_folder(device).join(format!("{}.{EXTENSION}", safe_name(key, LetterCase::Told)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drafts() -> (tempfile::TempDir, Drafts) {
        let root = tempfile::tempdir().unwrap();
        let drafts = Drafts::in_folder(root.path().join("data/drafts"));
        (root, drafts)
    }

    #[test]
    fn saves_replaces_and_removes_draft() {
        let (root, drafts) = drafts();
        assert_eq!(drafts.load("hiperface", "GB0450179"), Ok(None));
        assert_eq!(drafts.remove("hiperface", "GB0450179"), Ok(()));
        assert_eq!(fs::read_dir(root.path()).unwrap().count(), 0, "looking makes no folder");
        for text in ["first, and longer", "second"] {
            drafts.save("hiperface", "GB0450179", text).unwrap();
            assert_eq!(drafts.load("hiperface", "GB0450179"), Ok(Some(text.to_owned())));
        }
        let folder = root.path().join("data/drafts/hiperface");
        assert_eq!(read_text(&folder.join("GB0450179.ron")).unwrap(), "second");
        assert_eq!(fs::read_dir(&folder).unwrap().count(), 1);
        drafts.remove("hiperface", "GB0450179").unwrap();
        assert_eq!(drafts.load("hiperface", "GB0450179"), Ok(None));
        assert_eq!(drafts.remove("hiperface", "GB0450179"), Ok(()));
    }

    #[test]
    fn claims_draft_once() {
        let (_root, drafts) = drafts();
        let claim = drafts.claim_draft("hiperface", "1").unwrap();
        assert!(claim.is_some());
        assert!(drafts.claim_draft("hiperface", "1").unwrap().is_none());
        assert!(drafts.claim_draft("hiperface", "2").unwrap().is_some());
        drop(claim);
        assert!(drafts.claim_draft("hiperface", "1").unwrap().is_some());
    }

    #[test]
    fn keys_have_separate_drafts() {
        let (root, drafts) = drafts();
        let keys = ["", "a", "A", ".", "..", "../x", "a/b", "NUL", "%none", "a.ron"];
        for key in keys {
            drafts.save("hiperface", key, key).unwrap();
        }
        for key in keys {
            assert_eq!(drafts.load("hiperface", key), Ok(Some(key.to_owned())), "{key:?}");
        }
        assert_eq!(fs::read_dir(root.path().join("data/drafts/hiperface")).unwrap().count(), keys.len());
        drafts.save("../..", "x", "x").unwrap();
        assert!(root.path().join("data/drafts/%2E.%2F.%2E/x%l.ron").is_file());
    }

    #[test]
    fn reports_blocked_drafts() {
        let (root, drafts) = drafts();
        let path = root.path().join("data/drafts/hiperface/1.ron");
        fs::create_dir_all(&path).unwrap();
        let task = |result: Result<(), FileError>| result.unwrap_err().task;
        assert_eq!(task(drafts.load("hiperface", "1").map(drop)), FileOperation::Read);
        assert_eq!(task(drafts.save("hiperface", "1", "x")), FileOperation::Write);
        assert_eq!(task(drafts.remove("hiperface", "1")), FileOperation::Remove);
        fs::remove_dir_all(root.path().join("data")).unwrap();
        fs::write(root.path().join("data"), "x").unwrap();
        assert_eq!(task(drafts.save("hiperface", "1", "x")), FileOperation::CreateFolder);
    }
}
