//! The program's own folders: backups, drafts, the logbook and the log (data), settings and device tables of the user's own
//! (configuration).
//! No folder is made before something is written into it, and no access code is ever written.

mod backups;
mod captures;
mod descriptions;
mod drafts;
mod file_error;
mod file_lock;
mod file_names;
mod files;
mod folders;
mod log_file;
mod logbook;

use std::path::{Path, PathBuf};

use directories::ProjectDirs;

pub use backups::{Backup, Backups};
pub use captures::{OnProgress, ReadCaptureError, capture_head, read_capture};
pub use drafts::{Claim, Drafts};
pub use file_error::{FileError, FileProblem, FileTask};
pub use file_lock::update_text;
pub use files::{MAX_TEXT, read_file, read_text, write_atomically, write_by, write_in_folder, write_text_over};
pub use folders::Folders;
pub use log_file::LogFile;
pub use logbook::{Conclusion, DeviceKey, Entry, EntryId, Logbook, LogbookError, LogbookProblem, Outcome, StatusEntry};

use crate::devices::biss::protocol::{DescriptionError, Descriptions};
use crate::devices::hiperface::protocol::{EncoderTypes, TypeTableError};
use crate::devices::ssi::protocol::{Families, FamilyError};

/// Where the program keeps what outlives it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Store {
    data: PathBuf,
    config: PathBuf,
}

/// Why the store cannot give what is asked for.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum StoreError {
    /// The system names no home folder for this user.
    #[error("this user has no home folder")]
    NoHome,
    /// A file cannot be read.
    #[error(transparent)]
    File(#[from] FileError),
    /// The user's own table of encoder types is broken.
    #[error("{}, {cause}", path.display())]
    EncoderTypes {
        /// The file.
        path: PathBuf,
        /// What is wrong, with line and column or with the row's type byte.
        cause: TypeTableError,
    },
    /// A description of a BiSS encoder of the user's own is broken.
    #[error(transparent)]
    Description(#[from] DescriptionError),
    /// A family of SSI encoders of the user's own is broken.
    #[error(transparent)]
    Family(#[from] FamilyError),
}

impl Store {
    /// The folders that the system keeps for this user and this program.
    ///
    /// # Errors
    /// [`StoreError::NoHome`] where there are none.
    pub fn for_user() -> Result<Self, StoreError> {
        let folders = ProjectDirs::from("", "", "encoder-studio")
            // A relative home would scatter backups over wherever the program is started.
            .filter(|folders| folders.data_dir().is_absolute() && folders.config_dir().is_absolute())
            .ok_or(StoreError::NoHome)?;
        Ok(Store { data: folders.data_dir().to_owned(), config: folders.config_dir().to_owned() })
    }

    /// The folders `data` and `config` under `root`: a store of its own for a test or a portable copy.
    pub fn at(root: &Path) -> Self {
        Store { data: root.join("data"), config: root.join("config") }
    }

    /// The backups taken before devices were written.
    pub fn backups(&self) -> Backups {
        Backups::in_folder(self.data.join("backups"))
    }

    /// What users have begun and not yet written.
    pub fn drafts(&self) -> Drafts {
        Drafts::in_folder(self.data.join("drafts"))
    }

    /// Modes in which devices were found that a job has sent into others: a text each, until they are led back.
    pub fn excursions(&self) -> Drafts {
        Drafts::in_folder(self.data.join("excursions"))
    }

    /// The file of the program's settings; it need not exist.
    pub fn settings_path(&self) -> PathBuf {
        self.config.join("settings.ron")
    }

    /// The file for the program's own messages; it need not exist.
    pub fn log_path(&self) -> PathBuf {
        self.data.join("encoder-studio.log")
    }

    /// The file for [`Logbook::open`].
    pub fn logbook_path(&self) -> PathBuf {
        self.data.join("logbook.sqlite")
    }

    /// The file in which a user may add encoder types; it need not exist.
    pub fn encoder_types_path(&self) -> PathBuf {
        self.config.join("devices").join("hiperface.ron")
    }

    /// The built-in table of encoder types; rows in the user's own file go before its rows.
    ///
    /// # Errors
    /// Where the user's file exists but cannot be read or understood. [`EncoderTypes::built_in`] is there to go on with.
    pub fn encoder_types(&self) -> Result<EncoderTypes, StoreError> {
        let built_in = EncoderTypes::built_in();
        let path = self.encoder_types_path();
        let text = match read_text(&path) {
            Ok(text) => text,
            Err(FileError { problem: FileProblem::NotFound, .. }) => return Ok(built_in),
            Err(error) => return Err(error.into()),
        };
        match EncoderTypes::parse(&text) {
            Ok(own) => Ok(built_in.overlaid_with(own)),
            Err(cause) => Err(StoreError::EncoderTypes { path, cause }),
        }
    }

    /// The folder in which a user may add descriptions of BiSS encoders (`*.ron`); it need not exist.
    pub fn biss_descriptions_path(&self) -> PathBuf {
        self.config.join("devices").join("biss")
    }

    /// The built-in descriptions of BiSS encoders, those of the user's own before them, and what is wrong with those that
    /// cannot be used.
    pub fn biss_descriptions(&self) -> (Descriptions, Vec<StoreError>) {
        let (files, unread) = descriptions::read_folder(&self.biss_descriptions_path(), "ron");
        let (own, broken) = Descriptions::read(files.iter().map(|(name, text)| (name.as_str(), text.as_str())));
        (Descriptions::built_in().overlaid_with(own), together(unread, broken))
    }

    /// The folder in which a user may add families of SSI encoders (`*.ron`); it need not exist.
    pub fn ssi_families_path(&self) -> PathBuf {
        self.config.join("devices").join("ssi")
    }

    /// The built-in families of SSI encoders, those of the user's own in the place of those with the same key, and what
    /// is wrong with those that cannot be used.
    pub fn ssi_families(&self) -> (Families, Vec<StoreError>) {
        let (files, unread) = descriptions::read_folder(&self.ssi_families_path(), "ron");
        let (own, broken) = Families::read(files.iter().map(|(name, text)| (name.as_str(), text.as_str())));
        (Families::built_in().overlaid_with(own), together(unread, broken))
    }
}

/// Files that cannot be read, and those that cannot be used.
fn together<E: Into<StoreError>>(unread: Vec<FileError>, broken: Vec<E>) -> Vec<StoreError> {
    unread.into_iter().map(StoreError::from).chain(broken.into_iter().map(Into::into)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn store_with(own: &[u8]) -> (tempfile::TempDir, Store) {
        let root = tempfile::tempdir().unwrap();
        let store = Store::at(root.path());
        fs::create_dir_all(store.encoder_types_path().parent().unwrap()).unwrap();
        fs::write(store.encoder_types_path(), own).unwrap();
        (root, store)
    }

    #[test]
    fn looking_makes_no_folder() {
        let root = tempfile::tempdir().unwrap();
        let store = Store::at(root.path());
        assert_eq!(store.encoder_types(), Ok(EncoderTypes::built_in()));
        assert_eq!(store.backups().list("hiperface", "1"), Ok(Vec::new()));
        assert_eq!(store.drafts().load("hiperface", "1"), Ok(None));
        let paths = [store.logbook_path(), store.log_path(), store.settings_path()];
        let expected = ["data/logbook.sqlite", "data/encoder-studio.log", "config/settings.ron"];
        assert_eq!(paths, expected.map(|path| root.path().join(path)));
        assert_eq!(fs::read_dir(root.path()).unwrap().count(), 0);
    }

    #[test]
    fn a_users_encoder_type_goes_first() {
        let (_root, store) = store_with("\u{FEFF}(types: [(code: 0x37, name: \"own\")])".as_bytes());
        let types = store.encoder_types().unwrap();
        assert_eq!(types.find(0x37).unwrap().name, "own");
        assert_eq!(types.find(0x22), EncoderTypes::built_in().find(0x22));
    }

    #[test]
    fn broken_descriptions_are_named_with_their_place_and_the_rest_counts() {
        let root = tempfile::tempdir().unwrap();
        let store = Store::at(root.path());
        assert_eq!(store.biss_descriptions(), (Descriptions::built_in(), Vec::new()));
        let folder = store.biss_descriptions_path();
        fs::create_dir_all(folder.join("folder.ron")).unwrap();
        fs::write(folder.join("broken.ron"), "(\n  name: \"mine\",\n  register: [],\n)").unwrap();
        fs::write(folder.join("latin.ron"), b"(name: \"\xFC\")").unwrap();
        fs::write(folder.join("notes.txt"), "no description").unwrap();
        let (_, unknown) = Descriptions::BUILT_IN[1];
        fs::write(folder.join("own.RON"), unknown.replace("\"BiSS C encoder\"", "\"own\"")).unwrap();
        let (descriptions, errors) = store.biss_descriptions();
        assert!(descriptions.named("own").is_some() && descriptions.named("POSITAL IXARC kit encoder").is_some());
        let texts: Vec<String> = errors.iter().map(ToString::to_string).collect();
        let [folder, latin, broken] = texts.as_slice() else { panic!("{texts:?}") };
        assert!(folder.contains("folder.ron: it is a folder"), "{folder}");
        assert!(latin.contains("latin.ron: it is not UTF-8 text: byte 8 does not fit"), "{latin}");
        assert!(broken.contains("broken.ron, line 3, column "), "{broken}");
    }

    #[test]
    fn families_of_the_users_own_stand_before_those_that_ship() {
        let root = tempfile::tempdir().unwrap();
        let store = Store::at(root.path());
        assert_eq!(store.ssi_families(), (Families::built_in(), Vec::new()));
        let folder = store.ssi_families_path();
        fs::create_dir_all(&folder).unwrap();
        let (_, ahs36) = Families::BUILT_IN[0];
        fs::write(folder.join("same.ron"), ahs36.replace("\"AHS36 SSI\"", "\"my AHS36\"")).unwrap();
        fs::write(folder.join("other.ron"), ahs36.replace("\"ahs36\"", "\"mine\"")).unwrap();
        fs::write(folder.join("broken.ron"), "(\n  key: \"x\",\n  nam: \"x\",\n)").unwrap();
        let (families, errors) = store.ssi_families();
        assert_eq!(families.named("ahs36").unwrap().name, "my AHS36");
        assert!(families.named("mine").is_some() && families.named("kh53").is_some());
        assert_eq!(families.iter().count(), 12);
        let [error] = errors.as_slice() else { panic!("{errors:?}") };
        assert!(error.to_string().contains("broken.ron, line 3, column "), "{error}");
    }

    #[test]
    fn a_broken_table_is_named_with_its_place() {
        let (_root, store) = store_with(b"(types: [\n  (code: 0x37, nam: \"own\")])");
        let error = store.encoder_types().unwrap_err();
        assert!(matches!(&error, StoreError::EncoderTypes { cause: TypeTableError::Syntax { line: 2, .. }, .. }));
        let text = error.to_string();
        assert!(text.contains("hiperface.ron, line 2, column "), "{text}");

        let (_root, store) = store_with(b"(types: \xFF)");
        let error = store.encoder_types().unwrap_err();
        assert!(
            matches!(&error, StoreError::File(FileError { problem: FileProblem::NotUtf8 { offset: 8 }, .. })),
            "{error}"
        );
    }
}
