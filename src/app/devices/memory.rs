//! The memory of a device as seen by the studio. Implemented for every kind of device whose memory is saved as a
//! profile.

#![warn(missing_docs)]

use std::path::PathBuf;

use crate::app::Text;
use crate::app::action::{BackupReadResult, ReviewAction};
use crate::app::review::ReviewSheet;
use crate::app::services::Services;
use crate::app::session::{DeviceHistory, HasMemory, HasProfile};
use crate::profile::{Body, ProfileError};
use crate::store::{AssetName, DeviceKey, Entry};

/// A device memory that can be saved as a profile and restored from one. Writes are reviewed by the user first.
pub trait DeviceMemory {
    /// Opens the review in which the user checks the edits before they are written.
    fn review_edits(&mut self, services: &mut Services);

    /// Returns whether a review is open.
    fn is_reviewing(&self) -> bool;

    /// Returns the open review, if any.
    fn review_sheet(&self) -> Option<ReviewSheet>;

    /// Executes an action of the review.
    fn apply_review_action(&mut self, action: ReviewAction, services: &mut Services);

    /// Closes the review. A write in progress continues.
    fn close_review(&mut self);

    /// Returns the edited profile, or `None` if the session is a device.
    fn edited_body(&self) -> Option<Body>;

    /// Returns the profile of the last reading, or `None` if no data has been read.
    ///
    /// # Errors
    /// Returns a message for each value that a profile requires but that has not been read.
    fn last_read_profile(&self) -> Option<Result<Body, Vec<Text>>>;

    /// Returns the profile of the last reading with all edits, or `None` if no data has been read.
    ///
    /// # Errors
    /// Returns a message for each value that a profile requires but that has not been read.
    fn edited_values(&self) -> Option<Result<Body, Vec<Text>>>;

    /// Opens the review of restoring this profile.
    ///
    /// # Errors
    /// Returns an error if the profile belongs to another kind of device.
    fn restore(&mut self, body: Body, services: &mut Services) -> Result<(), ProfileError>;

    /// Saves a profile.
    fn save(&mut self, path: PathBuf, services: &mut Services);

    /// Returns whether a profile can currently be saved.
    fn is_savable(&self) -> bool;

    /// Assigns the device to an asset in the logbook.
    fn assign_asset(&mut self, asset: AssetName, services: &mut Services);

    /// Reads a backup, either to restore it or to undo a logbook entry.
    fn read_backup(&mut self, path: PathBuf, undone: Option<Box<Entry>>, services: &mut Services);

    /// Returns the key of the device in the logbook, or `None` until the device has been read.
    fn logbook_key(&self) -> Option<DeviceKey>;

    /// Stores the lists of backups and writes. Lists that belong to another device are ignored.
    fn set_history(&mut self, of: &DeviceKey, listed: DeviceHistory);

    /// Handles a backup that was read, or the error. A backup that belongs to another device is ignored.
    fn apply_backup(&mut self, read: BackupReadResult, services: &mut Services);
}

impl<T: HasProfile> DeviceMemory for T {
    fn review_edits(&mut self, services: &mut Services) {
        HasMemory::review_edits(self, services);
    }

    fn is_reviewing(&self) -> bool {
        self.open_review().is_some()
    }

    fn review_sheet(&self) -> Option<ReviewSheet> {
        let running = self.session().live_session().and_then(|line| line.running_job());
        let done = running.and_then(|running| running.progress.as_ref()).map_or(0, |progress| progress.done);
        HasMemory::review_sheet(self, usize::try_from(done).unwrap_or(usize::MAX))
    }

    fn apply_review_action(&mut self, action: ReviewAction, services: &mut Services) {
        match action {
            ReviewAction::Write(plan) => self.write(plan, services),
            ReviewAction::Toggle(permit) => self.toggle_plan_permit(permit, services),
            ReviewAction::ForceWear(force) => self.set_wear_override(force),
            ReviewAction::Close => DeviceMemory::close_review(self),
        }
    }

    fn close_review(&mut self) {
        HasMemory::close_review(self);
    }

    fn edited_body(&self) -> Option<Body> {
        HasProfile::edited_body(self)
    }

    fn last_read_profile(&self) -> Option<Result<Body, Vec<Text>>> {
        Some(HasProfile::last_read_profile(self)?.map(|(body, _)| body))
    }

    fn edited_values(&self) -> Option<Result<Body, Vec<Text>>> {
        Some(HasProfile::last_read_profile(self)?.map(|(mut body, _)| {
            self.add_edits(&mut body);
            body
        }))
    }

    fn restore(&mut self, body: Body, services: &mut Services) -> Result<(), ProfileError> {
        HasProfile::restore(self, body, services)
    }

    fn save(&mut self, path: PathBuf, services: &mut Services) {
        HasProfile::save(self, path, services);
    }

    fn is_savable(&self) -> bool {
        self.saves_last_reading() || self.session().is_savable()
    }

    fn assign_asset(&mut self, asset: AssetName, services: &mut Services) {
        if let Some(key) = self.device_key().filter(|key| !key.serial_number.is_empty()) {
            self.session().assign_asset(key, asset, services);
        }
    }

    fn read_backup(&mut self, path: PathBuf, undone: Option<Box<Entry>>, services: &mut Services) {
        HasProfile::read_backup(self, path, undone, services);
    }

    fn logbook_key(&self) -> Option<DeviceKey> {
        self.device_key()
    }

    fn set_history(&mut self, of: &DeviceKey, listed: DeviceHistory) {
        if self.device_key().as_ref() == Some(of) {
            self.session_mut().set_backups(listed);
        }
    }

    fn apply_backup(&mut self, read: BackupReadResult, services: &mut Services) {
        if self.device_key().as_ref() == Some(&read.of) {
            HasProfile::apply_backup(self, read, services);
        }
    }
}
