//! Profiles and backups of an open device as files. Every file is read or written in a task.

use std::path::PathBuf;

use jiff::Timestamp;

use super::{FileSnapshot, ProfileFile, SaveRequest, SessionState, Source};
use crate::analysis::check::CycleCount;
use crate::app::action::{BackupReadResult, TaskResult};
use crate::app::documents::{new_document, read_document, read_profile};
use crate::app::services::Services;
use crate::app::{Action, FileQuestion, Severity, Text, explain};
use crate::profile::{Body, ProfileDocument};
use crate::store::{AssetName, Backup, DeviceKey, Entry, FileError, Logbook, LogbookError, Store};
use crate::worker::commit::known_cycles;

impl SessionState {
    pub(crate) fn suggested_file(&self) -> PathBuf {
        if let Source::File { path, .. } | Source::New { suggested: path } = &self.source {
            return path.clone();
        }
        let words = self.title.as_ref().map(|title| {
            let name = title.replace(" · ", "-");
            name.chars().map(|c| if c.is_alphanumeric() || "-_.".contains(c) { c } else { '_' }).collect::<String>()
        });
        PathBuf::from(format!("{}.ron", words.as_deref().unwrap_or("encoder")))
    }

    pub(crate) fn ask_where_to_save(&self, services: &mut Services) {
        services.file_question = Some(FileQuestion::Save { session: self.id, suggested: self.suggested_file() });
    }

    /// Saves values that were just read from a device. `edits` is the number of edits not included, and `remarks` name
    /// other missing values.
    pub fn save_read_values(
        &mut self,
        device: Option<DeviceKey>,
        body: Body,
        edits: Option<usize>,
        remarks: Vec<Text>,
        services: &mut Services,
    ) {
        let Some(path) = self.save_to.take() else { return };
        let without = edits.map(|edits| Text::new("session.saved_without").with("count", edits));
        let remarks = without.into_iter().chain(remarks).collect();
        self.write_document(path, device, new_document(body), remarks, services);
    }

    /// Adopts a profile that was read from its file again, or saved to another file.
    pub fn apply_document(&mut self, file: ProfileFile, document: ProfileDocument) {
        self.source = file.source(document);
    }

    /// Starts a task that reads the profile's file again. Returns `false` if the session is not a profile.
    pub(crate) fn reload_file(&self, services: &mut Services) -> bool {
        let Source::File { path, .. } = &self.source else { return false };
        services.opening_files.push(path.clone());
        let (path, store, kinds) = (path.clone(), services.world.store.clone(), services.world.kinds);
        services.tasks.run("read", move || read_document(path, &store, kinds));
        true
    }

    /// Starts a task that saves a profile. `device` is the device from which it was read, if any, and `remarks` name
    /// the missing values.
    pub(crate) fn write_document(
        &mut self,
        path: PathBuf,
        device: Option<DeviceKey>,
        document: ProfileDocument,
        remarks: Vec<Text>,
        services: &mut Services,
    ) {
        if self.is_saving {
            return services.notify(Severity::Warning, vec![Text::new("session.busy")], Some(&self.name()));
        }
        self.is_saving = true;
        let opened = match &self.source {
            Source::File { key, text, .. } => Some(FileSnapshot { key: key.clone(), text: text.clone() }),
            Source::Link(_) | Source::New { .. } => None,
        };
        let (document, may_lose, is_merged) = (Box::new(document), false, false);
        let saving = SaveRequest { session: self.id, path, document, remarks, opened, device, may_lose, is_merged };
        let (kinds, store) = (services.world.kinds, services.world.store.clone());
        services.tasks.run("save", move || saving.run(kinds, &store));
    }

    /// Starts a task that lists the backups and writes of a device.
    pub(in crate::app) fn list_backups(&self, of: DeviceKey, services: &Services) {
        let (store, id) = (services.world.store.clone(), self.id);
        services.tasks.run("backups", move || {
            let listed = Box::new(DeviceHistory::load(&of, &store));
            Action::Done(TaskResult::Listed(id, of, listed))
        });
    }

    /// Starts a task that assigns a device to an asset, and lists its backups and writes again.
    pub(in crate::app) fn assign_asset(&self, of: DeviceKey, asset: AssetName, services: &Services) {
        let (store, id) = (services.world.store.clone(), self.id);
        services.tasks.run("asset", move || {
            let assigned = Logbook::open(&store.logbook_path())
                .and_then(|mut logbook| logbook.assign(Timestamp::now(), &of, &asset));
            let mut listed = Box::new(DeviceHistory::load(&of, &store));
            if let Err(error) = assigned {
                listed.writes = Err(error);
            }
            Action::Done(TaskResult::Listed(id, of, listed))
        });
    }

    pub(in crate::app) fn read_backup(
        &self,
        of: DeviceKey,
        path: PathBuf,
        undone: Option<Box<Entry>>,
        services: &Services,
    ) {
        let (session, formats) = (self.id, services.world.kinds.formats);
        services.tasks.run("backup", move || {
            let result = read_profile(&path, formats).map(Box::new);
            Action::Done(TaskResult::Backup(session, Box::new(BackupReadResult { of, path, undone, result })))
        });
    }

    pub(in crate::app) fn set_backups(&mut self, listed: DeviceHistory) {
        self.backups = Some(listed.backups.map_err(|error| explain::file_error_text(&error)));
        self.cycles = listed.cycles;
        self.asset = listed.asset;
        self.statuses = listed.statuses;
        self.writes = Some(listed.writes.map_err(|error| explain::logbook_unreadable_text(&error)));
    }
}

pub struct DeviceHistory {
    pub backups: Result<Vec<Backup>, FileError>,
    /// Writes recorded in the logbook, newest first, or the reason why they cannot be listed.
    pub writes: Result<Vec<Entry>, LogbookError>,
    /// Total number of write cycles, or `None` if the logbook does not contain it.
    pub cycles: Option<CycleCount>,
    /// Asset to which the device is assigned.
    pub asset: Option<String>,
    /// Status codes that were read, newest first. A logbook error is reported in `writes`.
    pub statuses: Vec<Entry>,
}

impl DeviceHistory {
    const MAX_STATUSES: u32 = 20;
    const WRITES: u32 = 200;

    pub(in crate::app) fn load(key: &DeviceKey, store: &Store) -> Self {
        let backups = store.backups().list_for_device(&key.kind, &key.serial_number);
        let cycles = known_cycles(store, key);
        let (writes, asset, statuses) = match store.logbook_path() {
            path if matches!(path.try_exists(), Ok(false)) => (Ok(Vec::new()), None, Vec::new()),
            path => match Logbook::open(&path) {
                Ok(logbook) => {
                    let statuses = logbook.status_entries(key, Self::MAX_STATUSES).unwrap_or_default();
                    let asset = logbook.asset(key).unwrap_or_default();
                    (logbook.history(key, Self::WRITES), asset, statuses)
                }
                Err(error) => (Err(error), None, Vec::new()),
            },
        };
        DeviceHistory { backups, writes, cycles, asset, statuses }
    }
}
