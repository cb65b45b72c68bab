//! HIPERDRIVE devices among those of the studio: which one is shown, what stops all of them, what is remembered of them.

use std::time::Duration;

use super::action::Action;
use super::remembered::Marks;
use super::unit::Unit;
use crate::app::services::Services;
use crate::app::studio::{SessionId, Studio};
use crate::app::tab::Tab;
use crate::app::{AnyDevice, Settings};
use crate::store::FileError;

/// How often the settings are read while drives are in hand.
const PACE: Duration = Duration::from_secs(1);
/// How long what they said counts: as long as what was read of the drives themselves.
const STALE: Duration = Duration::from_secs(4);

impl Studio {
    /// The device or profile that the HIPERDRIVE tab shows.
    pub fn hiperdrive(&self) -> Option<&Unit> {
        self.device(self.shown.of(Tab::Hiperdrive)?)?.hiperdrive()
    }

    fn hiperdrives(&self) -> impl Iterator<Item = &Unit> {
        self.devices.iter().filter_map(AnyDevice::hiperdrive)
    }

    /// Drives are connected, in whichever session: STOP has to be in reach.
    pub fn has_drives(&self) -> bool {
        self.hiperdrives().any(|unit| unit.session.line().is_some())
    }

    /// Some drive moves, as far as is known here, or is about to.
    pub fn moves(&self) -> bool {
        self.hiperdrives().any(Unit::is_moving)
    }

    /// Something is under way that was asked for here: whoever presses Esc in a fright means that.
    pub fn moves_by_hand(&self) -> bool {
        self.hiperdrives().any(|unit| unit.moves.is_moving() || unit.moves.is_under_way())
    }

    /// A motion that was asked for here has not ended.
    pub fn is_under_way(&self) -> bool {
        self.hiperdrives().any(|unit| unit.moves.is_under_way())
    }

    /// Somebody has control of some drives: what they say comes by itself.
    pub fn is_in_control(&self) -> bool {
        self.hiperdrives().any(|unit| unit.moves.is_open())
    }

    /// Stops all drives of all sessions, whatever moves them.
    pub(crate) fn stop_motion(&mut self) {
        self.devices.iter_mut().filter_map(AnyDevice::hiperdrive_mut).for_each(|unit| unit.moves.stop());
    }

    /// Whatever a person holds is let go, and what turns without an end: the window has lost the keyboard, or has put
    /// something over itself.
    pub(crate) fn let_go_of_jogs(&mut self) {
        self.devices.iter_mut().filter_map(AnyDevice::hiperdrive_mut).for_each(|unit| unit.moves.let_go());
    }

    /// A jog and a run live only as long as their panel can be seen: another tab or device, a dialog, a question for a file or
    /// any other end them.
    pub(crate) fn hold_in_sight(&mut self) {
        let asks = self.question.is_some() || self.services.file_question.is_some();
        let is_covered = self.connect.is_some() || asks;
        let seen = self.shown.of(Tab::Hiperdrive).filter(|_| self.settings.tab == Tab::Hiperdrive && !is_covered);
        for unit in self.devices.iter_mut().filter_map(AnyDevice::hiperdrive_mut) {
            if seen != Some(unit.session.id) || unit.review.is_some() {
                // A run in speed mode has no end of its own either.
                unit.moves.let_go();
            }
        }
    }

    /// What is remembered of drives from one start to the next goes to them, and what is new of it into the settings.
    pub(crate) fn remember_drives(&mut self) {
        for unit in self.devices.iter_mut().filter_map(AnyDevice::hiperdrive_mut) {
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
            for unit in self.devices.iter_mut().filter_map(AnyDevice::hiperdrive_mut) {
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
        let all = self.devices.iter_mut().filter_map(AnyDevice::hiperdrive_mut);
        all.filter(|unit| unit.moves.is_open())
    }

    pub(crate) fn act_hiperdrive(&mut self, id: SessionId, action: Action) {
        match action {
            Action::Reconnect => self.reconnect(id),
            Action::WriteInto(_) if self.is_only_looked_at(id) => {}
            Action::WriteInto(target) => {
                let profile = self.device(id).and_then(AnyDevice::hiperdrive).and_then(Unit::wanted_profile);
                let Some(profile) = profile else { return };
                self.show(Tab::Hiperdrive, target);
                self.with_hiperdrive(target, |unit, services| unit.plan_restore(profile, services));
            }
            action => self.with_hiperdrive(id, |unit, services| unit.act(action, services)),
        }
    }

    pub(crate) fn with_hiperdrive(&mut self, id: SessionId, act: impl FnOnce(&mut Unit, &mut Services)) {
        self.with_device(id, |device, services| {
            if let Some(unit) = device.hiperdrive_mut() {
                act(unit, services);
            }
        });
    }
}
