//! HIPERDRIVE devices among those of the studio: which one is shown, what stops all of them, what is remembered of them.

use std::time::Duration;

use super::remembered::Marks;
use super::unit::Unit;
use crate::app::Settings;
use crate::app::studio::Studio;
use crate::app::tab::Tab;
use crate::store::FileError;

/// How often the settings are read while drives are in hand.
const PACE: Duration = Duration::from_secs(1);
/// How long what they said counts: as long as what was read of the drives themselves.
const STALE: Duration = Duration::from_secs(4);

impl Studio {
    /// The device or profile that the HIPERDRIVE tab shows.
    pub fn hiperdrive(&self) -> Option<&Unit> {
        self.device(self.shown.of(Tab::Hiperdrive)?)?.get()
    }

    /// What is remembered of drives from one start to the next goes to them, and what is new of it into the settings.
    pub(crate) fn remember_drives(&mut self) {
        for unit in self.devices.iter_mut().filter_map(|device| device.get_mut::<Unit>()) {
            let Some(key) = unit.remembered_as() else { continue };
            if let Some(changed) = unit.exchange_remembered(&self.settings.drives(&key)) {
                self.settings.remember_drives(key, changed);
            }
        }
    }

    /// As long as drives are in hand the settings are read again and again: another window may have marked limits as
    /// unconfirmed.
    pub(crate) fn look_at_settings(&mut self) {
        let now = self.services.now();
        let is_old = self.keeper.is_older(&now, STALE);
        let mut is_due = self.is_in_control() && self.keeper.is_older(&now, PACE);
        for unit in self.hiperdrives_in_hand() {
            if is_old && unit.marks == Marks::Read {
                unit.marks = Marks::Unread;
            }
            is_due |= unit.marks == Marks::Unread;
        }
        if is_due && self.keeper.look(&self.services) {
            self.hiperdrives_in_hand().for_each(|unit| unit.marks = unit.marks.max(Marks::Reading));
        }
    }

    /// The settings were read.
    pub(crate) fn saw_settings(&mut self, found: Option<Settings>) {
        if let Some(found) = self.keeper.saw(found, &mut self.settings) {
            for unit in self.devices.iter_mut().filter_map(|device| device.get_mut::<Unit>()) {
                unit.remembered_as().into_iter().for_each(|key| unit.lock_by(&found.drives(&key)));
            }
        }
        self.remember_drives();
        let reading = |unit: &&mut Unit| unit.marks == Marks::Reading;
        self.hiperdrives_in_hand().filter(reading).for_each(|unit| unit.marks = Marks::Read);
    }

    /// The settings could not be read: no drive in hand moves before they are.
    pub(crate) fn could_not_see_settings(&mut self, error: &FileError) {
        tracing::warn!("{error}");
        self.keeper.could_not_look();
        self.hiperdrives_in_hand().for_each(|unit| unit.marks = Marks::Unread);
    }

    fn hiperdrives_in_hand(&mut self) -> impl Iterator<Item = &mut Unit> {
        let all = self.devices.iter_mut().filter_map(|device| device.get_mut::<Unit>());
        all.filter(|unit| unit.moves.is_open())
    }
}
