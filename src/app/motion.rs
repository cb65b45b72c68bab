//! Stopping and releasing of motion in all sessions.

use super::devices::MotionControl;
use super::studio::Studio;

impl Studio {
    fn motion_controls(&self) -> impl Iterator<Item = &dyn MotionControl> {
        self.devices.iter().filter_map(|device| device.motion())
    }

    fn motions_mut(&mut self) -> impl Iterator<Item = &mut dyn MotionControl> {
        self.devices.iter_mut().filter_map(|device| device.motion_mut())
    }

    /// Returns whether any session has a connected drive. The STOP button must then be reachable.
    pub fn has_drives(&self) -> bool {
        self.devices.iter().any(|device| device.motion().is_some() && device.is_connected())
    }

    /// Returns whether any drive is known to be moving or about to move.
    pub fn is_moving(&self) -> bool {
        self.motion_controls().any(MotionControl::is_moving)
    }

    /// Returns whether a motion requested in this window is running. The Escape key stops it before closing anything.
    pub fn is_requested_motion_running(&self) -> bool {
        self.motion_controls().any(MotionControl::is_requested_motion_running)
    }

    /// Returns whether a motion requested in this window has not ended yet.
    pub fn is_motion_active(&self) -> bool {
        self.motion_controls().any(MotionControl::is_motion_active)
    }

    /// Returns whether this program controls any drive. A controlled drive sends its values without being polled.
    pub fn has_control(&self) -> bool {
        self.motion_controls().any(MotionControl::has_control)
    }

    /// Returns whether STOP has an effect on drives, because this window controls a drive or has requested a motion
    /// that has not ended. STOP cannot stop the motion of another controller.
    pub fn can_stop_motion(&self) -> bool {
        self.has_control() || self.is_requested_motion_running()
    }

    pub(super) fn stop_motion(&mut self) {
        self.motions_mut().for_each(MotionControl::stop);
    }

    /// Ends all continuous runs and all motions that last while a button is held. Called when the window loses the
    /// keyboard focus or a dialog covers it.
    pub(super) fn release_jogs(&mut self) {
        self.motions_mut().for_each(MotionControl::release_motion);
    }

    /// Ends a jog or run whose panel is hidden by another tab or device, a dialog or a question.
    pub(super) fn stop_hidden_motion(&mut self) {
        let asks = self.question.is_some() || self.services.file_question.is_some();
        let is_covered = self.connect.is_some() || self.has_form() || self.profile_library().is_some() || asks;
        let tab = self.settings.tab;
        let seen = self.shown.session_in_tab(tab).filter(|_| !is_covered);
        for device in &mut self.devices {
            let is_seen = seen == Some(device.id()) && !device.is_reviewing();
            if let Some(motion) = device.motion_mut().filter(|_| !is_seen) {
                // A run in speed mode does not end by itself, so it must be ended as well.
                motion.release_motion();
            }
        }
    }
}
