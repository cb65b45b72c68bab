//! Exchange of stored data between the settings and the drives. Other windows also write to the settings file.

use std::time::Duration;

use super::Settings;
use super::devices::MotionControl;
use super::drives::{SettingsReadState, StoredDriveData};
use super::studio::Studio;
use crate::store::FileError;

/// Interval at which the settings are reread while drives are under control.
const REFRESH_INTERVAL: Duration = Duration::from_secs(1);
/// Time for which the settings remain valid after they were read. Values read from the drives are valid for the same
/// time.
const VALIDITY: Duration = Duration::from_secs(4);

impl Studio {
    pub(super) fn remember_drives(&mut self) {
        for drives in self.devices.iter_mut().filter_map(|device| device.drive_memory()) {
            let Some(key) = drives.storage_name() else { continue };
            if let Some(changed) = drives.sync_remembered_drives(&self.settings.drives(&key)) {
                self.settings.remember_drives(key, changed);
            }
        }
    }

    /// Rereads the settings periodically while drives are under control, because another window may have marked limits
    /// as unconfirmed.
    pub(super) fn refresh_settings(&mut self) {
        let now = self.services.current_time();
        let is_old = self.settings_store.is_last_read_older(&now, VALIDITY);
        let mut is_due = self.has_control() && self.settings_store.is_last_read_older(&now, REFRESH_INTERVAL);
        for drives in self.controlled_drives() {
            if is_old && drives.read_state() == SettingsReadState::Read {
                drives.set_read_state(SettingsReadState::Unread);
            }
            is_due |= drives.read_state() == SettingsReadState::Unread;
        }
        if is_due && self.settings_store.begin_read(&self.services) {
            self.controlled_drives()
                .for_each(|drives| drives.set_read_state(drives.read_state().max(SettingsReadState::Reading)));
        }
    }

    pub(super) fn apply_read_settings(&mut self, found: Option<Settings>) {
        if let Some(found) = self.settings_store.merge_read_settings(found, &mut self.settings) {
            for drives in self.devices.iter_mut().filter_map(|device| device.drive_memory()) {
                drives.storage_name().into_iter().for_each(|key| drives.lock_marked_drives(&found.drives(&key)));
            }
        }
        self.remember_drives();
        let reading = |drives: &&mut dyn StoredDriveData| drives.read_state() == SettingsReadState::Reading;
        self.controlled_drives().filter(reading).for_each(|drives| drives.set_read_state(SettingsReadState::Read));
    }

    /// Handles a failure to read the settings. Drives under control do not move until a read has succeeded.
    pub(super) fn handle_settings_error(&mut self, error: &FileError) {
        tracing::warn!("{error}");
        self.settings_store.handle_read_failure();
        self.controlled_drives().for_each(|drives| drives.set_read_state(SettingsReadState::Unread));
    }

    fn controlled_drives(&mut self) -> impl Iterator<Item = &mut dyn StoredDriveData> {
        let in_hand = self.devices.iter_mut().filter(|own| own.motion().is_some_and(MotionControl::has_control));
        in_hand.filter_map(|device| device.drive_memory())
    }
}
