//! Drives outside their limits: how far they are outside, and which directions lead back in and further out. The user
//! can allow the outward direction for one press, because with a wrong reference it may be the only way back.

use super::unit::HiperdriveDevice;
use crate::app::services::Services;
use crate::app::{Severity, Text};
use crate::devices::hiperdrive::jobs::Change;
use crate::devices::hiperdrive::procedures::dead_man::{LimitViolation, MotionRequest, Permit, SpeedTorque};
use crate::devices::hiperdrive::protocol::{Direction, DriveNumber, nearest_reference};
use crate::devices::hiperdrive::state::TEXTS;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OutOfRangePosition {
    pub outside: LimitViolation,
    /// Position in scaled steps.
    pub position: i32,
    /// Lower and upper limit in scaled steps, parameters 158 and 160.
    pub limits: (i32, i32),
    /// Whether the drive is outside its limits by more than its repeatability. If not, it is merely at the end of its
    /// range.
    pub is_far: bool,
}

impl HiperdriveDevice {
    /// Returns how the drive is outside its limits, according to its position or status bit 15. Returns `None` if it is
    /// inside, or if position or limits are unknown.
    pub fn out_of_range_position(&self, drive: DriveNumber) -> Option<OutOfRangePosition> {
        let (actual, limits) = (self.actual_values(drive)?, self.limits(drive)?);
        let degree = self.drive_limits(drive).map_or(1, |own| own.steps_per_degree());
        let permit = Permit { limits: Some(limits), degree, ..Permit::default() };
        let outside = permit.outside_limits(actual)?;
        let is_far = match outside {
            LimitViolation::At(side) => {
                side.overshoot_steps(actual.position, limits).unsigned_abs() > u64::from(degree)
            }
            LimitViolation::Unclear => true,
        };
        Some(OutOfRangePosition { outside, position: actual.position, limits, is_far })
    }

    /// Returns a message if the drive is outside its limits, and not merely at the end of its range.
    pub fn outside_limits_text(&self, drive: DriveNumber) -> Option<Text> {
        let own = self.out_of_range_position(drive).filter(|own| own.is_far)?;
        let id = if own.outside == LimitViolation::Unclear { "hd_outside.unclear" } else { "hd_outside.words" };
        let text = TEXTS.text(id).with_text("position", self.position_text(drive, own.position));
        Some(text.with_text("range", self.range_text(drive, own.limits)))
    }

    /// Checks whether the drive may be jogged in this direction now.
    ///
    /// # Errors
    /// Returns an error with the reason if the drive may not be jogged.
    pub fn check_can_jog(&self, drive: DriveNumber, direction: Direction) -> Result<(), Text> {
        let outward = self.moves.is_outward_jog_enabled(drive, direction);
        self.check_motion_allowed(drive, MotionRequest::Jog { direction, effort: SpeedTorque::DEFAULT_JOG, outward })
    }

    /// Returns whether jogging in this direction is blocked, because it may move the drive further outside its limits
    /// and the user has not allowed this.
    pub fn is_blocked(&self, drive: DriveNumber, direction: Direction) -> bool {
        let is_outward = self.out_of_range_position(drive).is_some_and(|own| own.outside.is_outward(direction));
        is_outward && !self.moves.is_outward_jog_enabled(drive, direction)
    }

    /// Returns whether jogging in this direction is blocked, but the user can allow it for a single press.
    pub fn can_enable_outward_jog(&self, drive: DriveNumber, direction: Direction) -> bool {
        self.check_can_move_until_stopped(drive).is_ok() && self.is_blocked(drive, direction)
    }

    pub(super) fn enable_outward_jog(&mut self, drive: DriveNumber, direction: Direction, services: &mut Services) {
        if self.can_enable_outward_jog(drive, direction) {
            return self.moves.start_endless_run(drive, direction);
        }
        let why = self.check_can_move_until_stopped(drive).err().unwrap_or_else(|| TEXTS.text("hd_outside.inside"));
        self.report_drive_message(drive, Severity::Warning, vec![why], services);
    }

    /// Returns the change that assigns a position in scaled steps to the current location of the drive, and saves it.
    ///
    /// # Errors
    /// Returns an error with the reason if the position is outside the limits, so that the drive would reject it.
    pub fn reference_change(&self, drive: DriveNumber, position: i32) -> Result<Change, Text> {
        let (low, high) = self.limits(drive).ok_or_else(|| TEXTS.text("hd_axis.unread"))?;
        let becomes = nearest_reference(position).filter(|own| (low..=high).contains(own));
        let position = becomes.ok_or_else(|| {
            TEXTS
                .text("hd_refused.outside")
                .with_text("target", self.position_text(drive, position))
                .with_text("low", self.position_text(drive, low))
                .with_text("high", self.position_text(drive, high))
        })?;
        Ok(Change::SetPosition { drive, position, save: true })
    }
}
