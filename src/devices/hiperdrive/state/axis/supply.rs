//! Power-cycle check: the state before and after, and the evidence that the supply was off. Losing and regaining the
//! connection is no proof.

use super::DriveFacts;
use crate::devices::hiperdrive::protocol::drive_parameter::HAND_DRIVE_WAIT;
use crate::devices::hiperdrive::protocol::{FactoryValue, PARAMETERS, PositionScale};

/// Parameter that shows whether a drive has restarted. It is never saved, so only a restart restores its factory
/// setting (manual, 182). It has no effect on motion.
pub(super) const RESTART_MARKER: u16 = HAND_DRIVE_WAIT;

/// Angle in degrees by which a drive may readjust its position at power-up or after a stop (manual, 8.3).
pub(super) const READJUSTMENT_DEG: f64 = 5.0;

/// State of the drive before the power cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StateBeforePowerOff {
    scale: Option<PositionScale>,
    limits: Option<(i32, i32)>,
    position: Option<i32>,
    /// Whether [`RESTART_MARKER`] had a value other than its factory setting.
    marked: bool,
}

/// Evidence that the supply was off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RestartEvidence {
    /// Proven: when read, parameter 182 had its factory setting again.
    Read,
    Switched,
    /// Claimed by the user, and not proven by a reading.
    ClaimedByUser,
    /// Not proven. The connection was lost, but that can have other causes.
    Unproven,
    /// Disproved: parameter 182 still has a value that a restart would have reset.
    Disproved,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Power {
    /// The device still replies.
    On(StateBeforePowerOff),
    /// The drive has stopped replying, and its parameters have not been read since.
    Gone(StateBeforePowerOff),
    Back {
        before: StateBeforePowerOff,
        kept: bool,
        /// Number of steps between the positions before and after the restart, or `None` if either position is unknown.
        moved: Option<i64>,
        /// Allowed deviation in steps.
        allowed: i64,
        restart: RestartEvidence,
    },
}

impl Power {
    pub(super) fn from_facts(seen: &DriveFacts) -> Self {
        Power::On(StateBeforePowerOff::default()).with_latest_values(seen)
    }

    /// Stores the latest values while the supply is on. If the marker is still set, the drive has not restarted since
    /// it was set.
    pub(super) fn with_latest_values(self, seen: &DriveFacts) -> Self {
        match self {
            Power::Back { before, kept, moved, allowed, restart: RestartEvidence::Unproven }
                if seen.is_settled() && is_marked(seen) == Some(true) =>
            {
                let before = StateBeforePowerOff { marked: true, ..before };
                Power::Back { before, kept, moved, allowed, restart: RestartEvidence::Disproved }
            }
            Power::On(_) if seen.is_settled() => Power::On(StateBeforePowerOff {
                scale: seen.scale,
                limits: seen.limits,
                position: seen.position,
                marked: is_marked(seen) == Some(true),
            }),
            own => own,
        }
    }

    pub(super) const fn after_power_off(self) -> Self {
        match self {
            Power::On(before) | Power::Gone(before) | Power::Back { before, .. } => Power::Gone(before),
        }
    }

    /// Records that the parameters were read again, possibly for the first time after the power cycle. Once the restart
    /// is proven, later readings have no effect.
    pub(super) fn after_survey(self, seen: &DriveFacts, switched: bool) -> Self {
        let mut before = match self {
            Power::Gone(before)
            | Power::Back { before, restart: RestartEvidence::Unproven | RestartEvidence::Disproved, .. } => before,
            own => return own,
        };
        let Some(scale) = seen.scale else { return self };
        let restart = match (switched, before.marked, is_marked(seen)) {
            (true, ..) => RestartEvidence::Switched,
            // This also applies if the connection was lost before it was known whether the marker was set.
            (_, _, Some(true)) => RestartEvidence::Disproved,
            (_, true, Some(false)) => RestartEvidence::Read,
            _ => RestartEvidence::Unproven,
        };
        before.marked |= restart == RestartEvidence::Disproved;
        let position = seen.actual.filter(|actual| actual.status.is_present()).map(|actual| actual.position);
        Power::Back {
            before,
            kept: before.scale == seen.scale && before.limits == seen.limits && seen.requested == Some(true),
            moved: position.zip(before.position).map(|(now, own)| i64::from(now) - i64::from(own)),
            allowed: scale.degrees_to_steps(READJUSTMENT_DEG).into(),
            restart,
        }
    }

    /// Records the user's claim that the supply was off, unless a reading has already proven or disproved it.
    pub(super) const fn confirmed_by_user(self) -> Self {
        match self {
            Power::Back { before, kept, moved, allowed, restart: RestartEvidence::Unproven } => {
                Power::Back { before, kept, moved, allowed, restart: RestartEvidence::ClaimedByUser }
            }
            own => own,
        }
    }

    /// Returns whether the supply was off, the saved values are still present, and the axis has not moved.
    pub(super) fn has_survived_power_cycle(self) -> bool {
        matches!(self, Power::Back { kept: true, moved: Some(moved), allowed, restart, .. }
            if moved.abs() <= allowed && matches!(restart, RestartEvidence::Read | RestartEvidence::Switched | RestartEvidence::ClaimedByUser))
    }
}

/// Returns whether [`RESTART_MARKER`] has a value other than its factory setting. Returns `None` if it was not read.
pub(super) fn is_marked(seen: &DriveFacts) -> Option<bool> {
    Some(*seen.values.get(&RESTART_MARKER)? != marker_factory_value()?)
}

/// Returns the value that marks a drive: the factory setting plus 1.
pub(super) fn marker_test_value() -> Option<i64> {
    marker_factory_value().map(|value| value + 1)
}

fn marker_factory_value() -> Option<i64> {
    let row = PARAMETERS.iter().find(|row| row.number == RESTART_MARKER)?;
    match row.factory {
        FactoryValue::Number(value) => Some(value),
        FactoryValue::None | FactoryValue::Topology { .. } | FactoryValue::Turns(_) | FactoryValue::Automatic => None,
    }
}
