//! Stop and release of motion in all sessions, for every kind of device.

use super::devices::MotionControl;
use super::studio::Studio;

impl Studio {
    fn motion_controls(&self) -> impl Iterator<Item = &dyn MotionControl> {
        self.devices.iter().filter_map(|device| device.motion())
    }

    fn motions_mut(&mut self) -> impl Iterator<Item = &mut dyn MotionControl> {
        self.devices.iter_mut().filter_map(|device| device.motion_mut())
    }

    /// Returns whether drives are connected in any session, in which case STOP must be reachable.
    pub fn has_drives(&self) -> bool {
        self.devices.iter().any(|device| device.motion().is_some() && device.is_connected())
    }

    /// Returns whether a drive is known to be moving or is going to move.
    pub fn moves(&self) -> bool {
        self.motion_controls().any(MotionControl::is_moving)
    }

    /// Returns whether a motion requested in this window is running. Such a motion is the first to be stopped by
    /// Escape.
    pub fn is_turned_by_hand(&self) -> bool {
        self.motion_controls().any(MotionControl::is_turned_by_hand)
    }

    /// Returns whether a motion requested in this window has not ended yet.
    pub fn is_motion_active(&self) -> bool {
        self.motion_controls().any(MotionControl::is_motion_active)
    }

    /// Returns whether drives are under control, in which case their values arrive without being requested.
    pub fn has_control(&self) -> bool {
        self.motion_controls().any(MotionControl::has_control)
    }

    /// Returns whether STOP has an effect on drives: this window controls some, or a motion requested here has not
    /// ended. It cannot stop the motion of another controller.
    pub fn can_stop_motion(&self) -> bool {
        self.has_control() || self.is_turned_by_hand()
    }

    pub(super) fn stop_motion(&mut self) {
        self.motions_mut().for_each(MotionControl::stop);
    }

    /// Ends all held motions and endless runs, because the window has lost the keyboard or is covered by a
    /// dialog.
    pub(super) fn release_jogs(&mut self) {
        self.motions_mut().for_each(MotionControl::let_go);
    }

    /// Ends a jog or run whose panel is no longer visible because of another tab or device, a dialog, or a question.
    pub(super) fn end_invisible_motion(&mut self) {
        let asks = self.question.is_some() || self.services.file_question.is_some();
        let is_covered = self.connect.is_some() || asks;
        let tab = self.settings.tab;
        let seen = self.shown.of(tab).filter(|_| !is_covered);
        for device in &mut self.devices {
            let is_seen = seen == Some(device.id()) && !device.is_reviewing();
            if let Some(motion) = device.motion_mut().filter(|_| !is_seen) {
                // A run in speed mode does not end by itself either.
                motion.let_go();
            }
        }
    }
}
