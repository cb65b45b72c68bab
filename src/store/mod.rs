//! The files of the program. Backups, drafts, the logbook and the log file are data. Settings and user-defined device
//! tables are configuration. A folder is created when its first file is written. Access codes are never stored.

mod backups;
mod captures;
mod device_files;
mod drafts;
mod file_error;
mod file_lock;
mod file_names;
mod file_search;
mod files;
mod folders;
mod leftovers;
mod log_file;
mod logbook;

use std::path::{Path, PathBuf};

use directories::ProjectDirs;

pub use backups::{Backup, Backups};
pub use captures::{OnProgress, ReadCaptureError, capture_head, read_capture};
pub use device_files::read_folder;
pub use drafts::{Claim, Drafts};
pub use file_error::{FileError, FileErrorKind, FileOperation};
pub use file_lock::update_text;
pub use file_search::FileSearch;
pub use files::{
    MAX_TEXT_BYTES, create_folder_and_write, overwrite_text, read_bytes, read_file, read_text, write_atomically,
    write_atomically_with,
};
pub use folders::BaseFolders;
pub use log_file::LogFile;
pub use logbook::{
    AssetName, AssetNameError, DeviceHold, DeviceKey, Entry, EntryFilter, EntryId, EntryKind, EntryUid, Event, Intent,
    KeyringError, LinkedEntry, Logbook, LogbookError, LogbookErrorKind, LogbookServer, Origin, OtherHolder, Outcome,
    Password, ServerAddress, ServerAddressError, ServerContact, ServerError, ServerErrorKind, Transferred,
    UndoObstacle, UnreachableCause, UserName, WriteResult,
};

use crate::profile::Cause;

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Store {
    data: PathBuf,
    config: PathBuf,
    server: LogbookServer,
}

#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum StoreError {
    /// The system does not report a home folder for the user.
    #[error("this user has no home folder")]
    NoHome,
    #[error(transparent)]
    File(#[from] FileError),
    /// A user-defined device file is invalid. The cause is specific to the kind of device.
    #[error("{0}")]
    Refused(Cause),
}

impl Store {
    /// Returns the store in the system's data and configuration folders for this user.
    ///
    /// # Errors
    /// Returns [`StoreError::NoHome`] if the system does not report such folders.
    pub fn for_user() -> Result<Self, StoreError> {
        let folders = ProjectDirs::from("", "", "encoder-studio")
            // If the home folder were a relative path, the location of backups would depend on the working directory.
            .filter(|folders| folders.data_dir().is_absolute() && folders.config_dir().is_absolute())
            .ok_or(StoreError::NoHome)?;
        let [data, config] = [folders.data_dir(), folders.config_dir()].map(Path::to_owned);
        Ok(Store { data, config, server: LogbookServer::default() })
    }

    /// Returns a store in the folders `data` and `config` under `root`, for tests or a portable copy.
    pub fn at_root(root: &Path) -> Self {
        Store { data: root.join("data"), config: root.join("config"), server: LogbookServer::default() }
    }

    /// Removes temporary files that a killed program has left in the program's folders.
    pub fn remove_leftovers(&self) {
        leftovers::remove_recursively(&self.data);
        leftovers::remove_recursively(&self.config);
    }

    pub fn backups(&self) -> Backups {
        Backups::in_folder(self.data.join("backups"))
    }

    /// Returns the drafts: edits that have not been written to a device.
    pub fn drafts(&self) -> Drafts {
        Drafts::in_folder(self.data.join("drafts"))
    }

    /// Returns the stored device modes that must be restored after a job, one per device.
    pub fn pending_mode_restores(&self) -> Drafts {
        Drafts::in_folder(self.data.join("excursions"))
    }

    /// Returns the path of the settings file. The file need not exist.
    pub fn settings_path(&self) -> PathBuf {
        self.config.join("settings.ron")
    }

    /// Returns the path of the log file. The file need not exist.
    pub fn log_path(&self) -> PathBuf {
        self.data.join("encoder-studio.log")
    }

    /// Returns the path of the logbook, for use with [`Logbook::open`].
    pub fn logbook_path(&self) -> PathBuf {
        self.data.join("logbook.sqlite")
    }

    /// Returns this store with a different logbook server.
    #[must_use]
    pub fn with_server(self, server: LogbookServer) -> Self {
        Store { server, ..self }
    }

    /// Returns the logbook server. All copies of this store use the same server.
    pub fn logbook_server(&self) -> &LogbookServer {
        &self.server
    }

    /// Returns whether a file or folder is in one of the program's folders.
    pub fn contains(&self, path: &Path) -> bool {
        path.starts_with(&self.data) || path.starts_with(&self.config)
    }

    /// Returns the path of the file with user-defined devices of a kind. The file need not exist.
    pub fn device_file(&self, kind: &str) -> PathBuf {
        self.config.join("devices").join(kind).with_extension("ron")
    }

    /// Returns the path of the folder with user-defined devices of a kind, one per `*.ron` file. The folder need not
    /// exist.
    pub fn device_folder(&self, kind: &str) -> PathBuf {
        self.config.join("devices").join(kind)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn reading_creates_no_folder() {
        let root = tempfile::tempdir().unwrap();
        let store = Store::at_root(root.path());
        assert_eq!(read_folder(&store.device_folder("biss"), "ron"), (Vec::new(), Vec::new()));
        assert_eq!(store.backups().list_for_device("hiperface", "1"), Ok(Vec::new()));
        assert_eq!(store.drafts().load("hiperface", "1"), Ok(None));
        let paths = [
            store.logbook_path(),
            store.log_path(),
            store.settings_path(),
            store.device_file("hiperface"),
            store.device_folder("biss"),
        ];
        let expected = [
            "data/logbook.sqlite",
            "data/encoder-studio.log",
            "config/settings.ron",
            "config/devices/hiperface.ron",
            "config/devices/biss",
        ];
        assert!(paths.iter().all(|path| store.contains(path)) && !store.contains(root.path()));
        assert_eq!(paths, expected.map(|path| root.path().join(path)));
        assert_eq!(fs::read_dir(root.path()).unwrap().count(), 0);
    }
}
