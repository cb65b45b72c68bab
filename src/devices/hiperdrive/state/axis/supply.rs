//! Power-cycle check: the state before and after the power cycle, and the evidence that the supply was off. A
//! connection that was lost and restored does not prove anything.

use super::DriveFacts;
use crate::devices::hiperdrive::protocol::drive_parameter::HAND_DRIVE_WAIT;
use crate::devices::hiperdrive::protocol::{FactoryValue, PARAMETERS, PositionScale};

/// Parameter by which a restart of the drive is detected. It is never saved, so only a restart restores its factory
/// setting (manual, 182), and it has no effect on motion.
pub(super) const RESTART_MARKER: u16 = HAND_DRIVE_WAIT;

/// Angle in degrees by which a drive may readjust its position at power-up and after a stop (manual, 8.3).
pub(super) const READJUSTMENT_DEG: f64 = 5.0;

/// State of the drive before the supply is switched off.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StateBeforePowerOff {
    scale: Option<PositionScale>,
    limits: Option<(i32, i32)>,
    position: Option<i32>,
    /// Whether [`RESTART_MARKER`] differed from its factory setting.
    marked: bool,
}

/// Evidence that the supply was off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RestartEvidence {
    /// The restart is proven by a reading in which parameter 182 has its factory setting again.
    Read,
    Switched,
    /// The restart is claimed by the user and not proven by a reading.
    ClaimedByUser,
    /// The restart is not proven. The connection was lost, but this can have other causes.
    Unproven,
    /// The restart is disproved, because parameter 182 still has a value that any restart would remove.
    Disproved,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Power {
    /// The device still replies.
    On(StateBeforePowerOff),
    /// The drive has stopped replying, or its parameters have not been read since.
    Gone(StateBeforePowerOff),
    Back {
        before: StateBeforePowerOff,
        kept: bool,
        /// Number of steps between the positions before and after the restart, or `None` if one of them is unknown.
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

    /// Adopts the latest values while the supply is on. If the marker is still set, the supply has not been off since
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

    /// Records that the parameters were read again. This reading may be the first one after the power cycle, unless an
    /// earlier one has already shown that the supply was off.
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
            allowed: scale.steps_of_degrees(READJUSTMENT_DEG).into(),
            restart,
        }
    }

    /// Adopts the user's statement that the supply was off, unless a reading has proven or disproved this.
    pub(super) const fn confirmed_by_user(self) -> Self {
        match self {
            Power::Back { before, kept, moved, allowed, restart: RestartEvidence::Unproven } => {
                Power::Back { before, kept, moved, allowed, restart: RestartEvidence::ClaimedByUser }
            }
            own => own,
        }
    }

    /// Returns whether the saved values are present, the axis has not moved, and the supply was off.
    pub(super) fn has_survived_power_cycle(self) -> bool {
        matches!(self, Power::Back { kept: true, moved: Some(moved), allowed, restart, .. }
            if moved.abs() <= allowed && matches!(restart, RestartEvidence::Read | RestartEvidence::Switched | RestartEvidence::ClaimedByUser))
    }
}

/// Returns whether [`RESTART_MARKER`] differs from its factory setting, or `None` if it has not been read.
pub(super) fn is_marked(seen: &DriveFacts) -> Option<bool> {
    Some(*seen.values.get(&RESTART_MARKER)? != factory_mark()?)
}

/// Returns a value that marks a drive: the factory setting plus 1.
pub(super) fn mark_value() -> Option<i64> {
    factory_mark().map(|value| value + 1)
}

fn factory_mark() -> Option<i64> {
    let row = PARAMETERS.iter().find(|row| row.number == RESTART_MARKER)?;
    match row.factory {
        FactoryValue::Number(value) => Some(value),
        FactoryValue::None | FactoryValue::Topology { .. } | FactoryValue::Turns(_) | FactoryValue::Automatic => None,
    }
}
