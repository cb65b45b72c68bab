//! Methods common to all open devices.

use std::any::Any;
use std::path::PathBuf;

use jiff::Timestamp;

use super::AnyDevice;
use super::memory::DeviceMemory;
use crate::app::Text;
use crate::app::action::{BackupReadResult, ReviewAction};
use crate::app::closing::LONG_RECORDING_NS;
use crate::app::review::ReviewSheet;
use crate::app::services::Services;
use crate::app::session::{DeviceHistory, PendingOpen, Phase, Source};
use crate::app::studio::SessionId;
use crate::app::trace::TraceLog;
use crate::store::{Backup, DeviceKey, Entry};

impl AnyDevice {
    /// Returns the device as `M`, or `None` if it is of another kind.
    pub fn get<M: Any>(&self) -> Option<&M> {
        (self as &dyn Any).downcast_ref()
    }

    pub(crate) fn get_mut<M: Any>(&mut self) -> Option<&mut M> {
        (self as &mut dyn Any).downcast_mut()
    }

    pub fn id(&self) -> SessionId {
        self.state().id
    }

    /// Returns the name used in the log and the job list.
    pub fn name(&self) -> String {
        self.state().name()
    }

    /// Returns where the data come from, without secrets.
    pub fn data_source(&self) -> String {
        self.state().data_source()
    }

    pub fn source(&self) -> &Source {
        &self.state().source
    }

    /// Returns the time at which the displayed values were read, if they were.
    pub fn last_read_time(&self) -> Option<Timestamp> {
        self.state().last_read_time
    }

    pub fn phase(&self) -> &Phase {
        &self.state().phase
    }

    pub(in crate::app) fn phase_mut(&mut self) -> &mut Phase {
        &mut self.state_mut().phase
    }

    pub(in crate::app) fn is_opening(&self) -> bool {
        self.state().opening.is_some()
    }

    pub(in crate::app) fn opening_mut(&mut self) -> &mut Option<PendingOpen> {
        &mut self.state_mut().opening
    }

    pub fn trace(&self) -> &TraceLog {
        &self.state().trace
    }

    /// Returns whether this attempt to open the device's link is the latest one.
    pub(in crate::app) fn is_current_attempt(&self, attempt: u32) -> bool {
        self.state().is_current_attempt(attempt)
    }

    /// Returns the backups, or the reason why they cannot be listed. Returns `None` until they have been requested.
    pub fn backups(&self) -> Option<&Result<Vec<Backup>, Text>> {
        self.state().backups.as_ref()
    }

    /// Returns the writes recorded in the logbook, or the reason why they cannot be listed. Returns `None` until they
    /// have been requested.
    pub fn logged_writes(&self) -> Option<&Result<Vec<Entry>, Text>> {
        self.state().writes.as_ref()
    }

    /// Returns the key of the device in the logbook, or `None` until the device has been read.
    pub fn logbook_key(&self) -> Option<DeviceKey> {
        self.memory()?.logbook_key()
    }

    /// Returns the asset to which this device is assigned in the logbook.
    pub fn asset(&self) -> Option<&str> {
        self.state().asset.as_deref()
    }

    /// Returns the status codes recorded for this device in the logbook, newest first.
    pub fn logged_status_codes(&self) -> &[Entry] {
        &self.state().statuses
    }

    /// Returns whether values can be written to the device and restored from a profile.
    pub fn has_memory(&self) -> bool {
        self.memory().is_some()
    }

    pub fn is_comparable(&self) -> bool {
        !matches!(self.phase(), Phase::Opening)
    }

    pub fn is_reviewing(&self) -> bool {
        self.memory().is_some_and(DeviceMemory::is_reviewing)
    }

    pub fn review_sheet(&self) -> Option<ReviewSheet> {
        self.memory()?.review_sheet()
    }

    pub(in crate::app) fn apply_review_action(&mut self, action: ReviewAction, services: &mut Services) {
        if let Some(memory) = self.memory_mut() {
            memory.apply_review_action(action, services);
        }
    }

    pub(in crate::app) fn close_review(&mut self) {
        if let Some(memory) = self.memory_mut() {
            memory.close_review();
        }
    }

    pub(in crate::app) fn set_history(&mut self, of: &DeviceKey, listed: DeviceHistory) {
        if let Some(memory) = self.memory_mut() {
            memory.set_history(of, listed);
        }
    }

    pub(in crate::app) fn apply_backup(&mut self, read: BackupReadResult, services: &mut Services) {
        if let Some(memory) = self.memory_mut() {
            memory.apply_backup(read, services);
        }
    }

    /// Returns whether the recording contains minutes of unexported data.
    pub(in crate::app) fn has_long_unsaved_recording(&self) -> bool {
        self.recorders().into_iter().any(|recorder| recorder.unexported_duration() >= LONG_RECORDING_NS)
    }

    pub(in crate::app) fn suggested_file(&self) -> PathBuf {
        self.state().suggested_file()
    }

    /// Marks a save as waiting for the user's answer, so that another save may begin.
    pub(in crate::app) fn pause_save_for_question(&mut self) {
        self.state_mut().is_saving = false;
    }
}
