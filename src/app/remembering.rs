//! What the settings remember of drives goes to them, and what is new of it into the settings; other windows write the same
//! file.

use std::time::Duration;

use super::Settings;
use super::devices::MotionControl;
use super::drives::Marks;
use super::studio::Studio;
use crate::store::FileError;

/// How often the settings are read while drives are in hand.
const PACE: Duration = Duration::from_secs(1);
/// How long what they said counts: as long as what was read of the drives themselves.
const STALE: Duration = Duration::from_secs(4);

impl Studio {
    /// What is remembered of drives from one start to the next goes to them, and what is new of it into the settings.
    pub(super) fn remember_drives(&mut self) {
        for motion in self.devices.iter_mut().filter_map(|device| device.motion_mut()) {
            let Some(key) = motion.remembered_as() else { continue };
            if let Some(changed) = motion.exchange_remembered(&self.settings.drives(&key)) {
                self.settings.remember_drives(key, changed);
            }
        }
    }

    /// As long as drives are in hand the settings are read again and again: another window may have marked limits as
    /// unconfirmed.
    pub(super) fn look_at_settings(&mut self) {
        let now = self.services.now();
        let is_old = self.keeper.is_older(&now, STALE);
        let mut is_due = self.is_in_control() && self.keeper.is_older(&now, PACE);
        for motion in self.motions_in_hand() {
            if is_old && motion.marks() == Marks::Read {
                motion.set_marks(Marks::Unread);
            }
            is_due |= motion.marks() == Marks::Unread;
        }
        if is_due && self.keeper.look(&self.services) {
            self.motions_in_hand().for_each(|motion| motion.set_marks(motion.marks().max(Marks::Reading)));
        }
    }

    /// The settings were read.
    pub(super) fn saw_settings(&mut self, found: Option<Settings>) {
        if let Some(found) = self.keeper.saw(found, &mut self.settings) {
            for motion in self.devices.iter_mut().filter_map(|device| device.motion_mut()) {
                motion.remembered_as().into_iter().for_each(|key| motion.lock_by(&found.drives(&key)));
            }
        }
        self.remember_drives();
        let reading = |motion: &&mut dyn MotionControl| motion.marks() == Marks::Reading;
        self.motions_in_hand().filter(reading).for_each(|motion| motion.set_marks(Marks::Read));
    }

    /// The settings could not be read: no drive in hand moves before they are.
    pub(super) fn could_not_see_settings(&mut self, error: &FileError) {
        tracing::warn!("{error}");
        self.keeper.could_not_look();
        self.motions_in_hand().for_each(|motion| motion.set_marks(Marks::Unread));
    }

    fn motions_in_hand(&mut self) -> impl Iterator<Item = &mut dyn MotionControl> {
        let all = self.devices.iter_mut().filter_map(|device| device.motion_mut());
        all.filter(|motion| motion.is_in_control())
    }
}
