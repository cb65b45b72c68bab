//! Speed and torque of jogs, moves and runs: those set for each drive, and those of the running motion.

use super::{DriveMotion, Kind};
use crate::devices::hiperdrive::procedures::dead_man::{MotionKind, Phase, SpeedTorque};
use crate::devices::hiperdrive::protocol::DriveNumber;

impl DriveMotion {
    pub(in super::super) fn set_jog_effort(&mut self, drive: DriveNumber, effort: SpeedTorque) {
        self.jogs.insert(drive, effort);
    }

    pub(in super::super) fn set_move_effort(&mut self, drive: DriveNumber, effort: SpeedTorque) {
        self.jobs.insert(drive, effort);
    }

    pub(in super::super) fn set_run_effort(&mut self, drive: DriveNumber, effort: SpeedTorque) {
        self.runs.insert(drive, effort);
    }

    pub fn jog_speed_torque(&self, drive: DriveNumber) -> SpeedTorque {
        self.jogs.get(&drive).copied().unwrap_or(SpeedTorque::DEFAULT_JOG)
    }

    pub fn move_speed_torque(&self, drive: DriveNumber) -> SpeedTorque {
        self.jobs.get(&drive).copied().unwrap_or(SpeedTorque::DEFAULT_MOVE)
    }

    pub fn run_speed_torque(&self, drive: DriveNumber) -> SpeedTorque {
        self.runs.get(&drive).copied().unwrap_or(SpeedTorque::DEFAULT_JOG)
    }

    /// Returns the speed and torque of the running jog, if any.
    pub fn running_jog_speed_torque(&self, drive: DriveNumber) -> Option<SpeedTorque> {
        self.active_speed_torque(drive).filter(|_| self.has_action_of_kind(drive, Kind::Held))
    }

    /// Returns the speed and torque of the running move or step, if any.
    pub fn running_move_speed_torque(&self, drive: DriveNumber) -> Option<SpeedTorque> {
        let is_job =
            |phase| matches!(phase, Phase::Starting(MotionKind::Job { .. }) | Phase::Moving(MotionKind::Job { .. }));
        self.active_speed_torque(drive).filter(|_| self.phase(drive).is_some_and(is_job))
    }

    /// Returns the speed and torque of the current run, if any.
    pub fn running_run_speed_torque(&self, drive: DriveNumber) -> Option<SpeedTorque> {
        self.active_speed_torque(drive).filter(|_| self.has_action_of_kind(drive, Kind::Run))
    }

    fn has_action_of_kind(&self, drive: DriveNumber, kind: Kind) -> bool {
        self.act.is_some_and(|act| act.drive == drive && act.kind == kind)
    }

    fn active_speed_torque(&self, drive: DriveNumber) -> Option<SpeedTorque> {
        let own = self.drive(drive).filter(|own| matches!(own.phase, Phase::Starting(_) | Phase::Moving(_)))?;
        Some(SpeedTorque { speed: own.sent.speed, torque: own.sent.torque })
    }
}
