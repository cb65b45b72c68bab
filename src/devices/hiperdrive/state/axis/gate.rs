//! Conditions in the axis set-up: what each button requests and when it is enabled, and when the next step may follow.

use std::time::Duration;

use super::supply::{Power, RESTART_MARKER, RestartEvidence, is_marked, marker_test_value};
use super::{Axis, AxisButton, AxisStep, DriveFacts, DriveRequest, TestTarget, differences, labels};
use crate::app::Text;
use crate::devices::hiperdrive::procedures::dead_man::MotionLock;
use crate::devices::hiperdrive::protocol::State;
use crate::devices::hiperdrive::protocol::drive_parameter::{
    DENOMINATOR, DRIVE_REQUESTED, LOWER_LIMIT, NUMERATOR, UPPER_LIMIT,
};
use crate::devices::hiperdrive::state::TEXTS;
use crate::devices::hiperdrive::state::explain as explained;

/// Minimum time for which a step must be shown before the user can leave it.
const MIN_STEP_TIME: Duration = Duration::from_millis(600);

impl Axis {
    /// Returns the request that a button triggers.
    ///
    /// # Errors
    /// Returns an error with the reason if the button cannot be pressed now.
    pub fn request(&self, button: AxisButton, seen: &DriveFacts) -> Result<DriveRequest, Text> {
        if !seen.connected {
            return Err(TEXTS.text("hd_axis.not_connected"));
        }
        if seen.busy || self.asked.is_some() {
            return Err(TEXTS.text("hd_axis.busy"));
        }
        if seen.stale && button != AxisButton::Give {
            return Err(TEXTS.text("hd_axis.unread"));
        }
        let stands = || if seen.moves { Err(TEXTS.text("hd_axis.moving")) } else { Ok(()) };
        match button {
            AxisButton::Take | AxisButton::Give if seen.controlled == (button == AxisButton::Take) => {
                Err(TEXTS.text("hd_axis.already"))
            }
            AxisButton::Take => Ok(DriveRequest::Take),
            AxisButton::Give => stands().map(|()| DriveRequest::Give),
            AxisButton::Recall => {
                stands()?;
                let back = differences::values_to_restore(seen);
                match (back.is_empty(), differences::is_position_different(seen)) {
                    (false, _) => Ok(DriveRequest::Restore(back)),
                    (true, false) => Err(TEXTS.text("hd_axis.nothing_back")),
                    (true, true) => Err(TEXTS.text("hd_axis.place_left")),
                }
            }
            _ if self.over.is_some() => Err(TEXTS.text("hd_axis.over")),
            AxisButton::Acknowledge if !seen.controlled => Err(TEXTS.text("hd_axis.no_control")),
            AxisButton::Acknowledge if !seen.has_failed() => Err(TEXTS.text("hd_axis.no_fault")),
            AxisButton::Acknowledge => Ok(DriveRequest::Acknowledge),
            _ if let Some(step) = self.invalidated_step() => Err(labels::invalidated_step(step)),
            AxisButton::Do => stands().and_then(|()| self.step_request(seen)),
            AxisButton::Confirm => match (seen.scale, seen.limits) {
                (Some(_), Some(_)) => Ok(DriveRequest::ConfirmLimits),
                _ => Err(TEXTS.text("hd_axis.unread")),
            },
            AxisButton::Widen => {
                let preview = self.entries.preview(seen)?;
                stands().map(|()| {
                    DriveRequest::Try(vec![(LOWER_LIMIT, preview.lower.into()), (UPPER_LIMIT, preview.upper.into())])
                })
            }
            AxisButton::Go(place) => {
                self.may_move(seen)?;
                stands().and_then(|()| self.target(place, seen).map(DriveRequest::Move))
            }
            AxisButton::PowerCycle if !seen.is_virtual => Err(TEXTS.text("hd_axis.not_virtual")),
            AxisButton::PowerCycle if seen.controlled => Err(TEXTS.text("hd_axis.give_first")),
            AxisButton::PowerCycle => Ok(DriveRequest::PowerCycle),
            AxisButton::Restarted => match self.power {
                Some(Power::Back { restart: RestartEvidence::Unproven, .. }) => Ok(DriveRequest::BelieveRestart),
                Some(Power::Back { restart: RestartEvidence::Disproved, .. }) => {
                    Err(TEXTS.text("hd_axis.not_restarted"))
                }
                Some(Power::Back { .. }) => Err(TEXTS.text("hd_axis.already")),
                _ => Err(TEXTS.text("hd_axis.needs_power")),
            },
        }
    }

    fn step_request(&self, seen: &DriveFacts) -> Result<DriveRequest, Text> {
        match self.step {
            AxisStep::Request if seen.requested == Some(true) => Err(TEXTS.text("hd_axis.already")),
            AxisStep::Request => Ok(DriveRequest::Try(vec![(DRIVE_REQUESTED, 1)])),
            AxisStep::Scale => {
                let preview = self.entries.preview(seen)?;
                if seen.scale == Some(preview.scale) {
                    return Err(TEXTS.text("hd_axis.already"));
                }
                let (numerator, denominator) = (preview.scale.numerator(), preview.scale.denominator());
                let (low, high) = (preview.lower, preview.upper);
                let all = [
                    (NUMERATOR, numerator.into()),
                    (DENOMINATOR, denominator.into()),
                    (LOWER_LIMIT, low.into()),
                    (UPPER_LIMIT, high.into()),
                ];
                Ok(DriveRequest::Try(all.to_vec()))
            }
            AxisStep::Reference => {
                let reference = self.entries.parse_reference(seen.ruler(), seen.limits)?;
                Ok(DriveRequest::SetPosition(reference.becomes))
            }
            AxisStep::Upper => {
                let (low, high) = self.teach_in_limits(seen)?;
                if seen.limits == Some((low, high)) {
                    return Err(TEXTS.text("hd_axis.already"));
                }
                Ok(DriveRequest::Try(vec![(LOWER_LIMIT, low.into()), (UPPER_LIMIT, high.into())]))
            }
            AxisStep::Save => Ok(DriveRequest::Save),
            AxisStep::PowerCycle => match (self.power, is_marked(seen), marker_test_value()) {
                (
                    Some(Power::On(_) | Power::Back { restart: RestartEvidence::Unproven, .. }),
                    Some(false),
                    Some(mark),
                ) => Ok(DriveRequest::Try(vec![(RESTART_MARKER, mark)])),
                _ => Err(TEXTS.text("hd_axis.already")),
            },
            AxisStep::Confirm | AxisStep::Jog | AxisStep::Lower | AxisStep::Test => Err(TEXTS.text("hd_axis.already")),
        }
    }

    /// Returns the limits set by teach-in, if the axis is between them.
    fn teach_in_limits(&self, seen: &DriveFacts) -> Result<(i32, i32), Text> {
        let ruler = seen.ruler();
        let (low, high) = (self.entries.lower_limit(ruler)?, self.entries.upper_limit(ruler)?);
        let mm = |steps: i32| labels::millimetres_text(ruler, steps.into());
        if low >= high {
            return Err(TEXTS.text("hd_axis.crossed").with_text("low", mm(low)).with_text("high", mm(high)));
        }
        let position = seen.position.ok_or_else(|| TEXTS.text("hd_axis.no_position"))?;
        if !(low..=high).contains(&position) {
            let outside = TEXTS.text("hd_axis.outside").with_text("position", mm(position));
            return Err(outside.with_text("low", mm(low)).with_text("high", mm(high)));
        }
        Ok((low, high))
    }

    /// Checks whether the axis may be moved.
    ///
    /// # Errors
    /// Returns an error with the reason if the axis may not be moved.
    pub fn may_move(&self, seen: &DriveFacts) -> Result<(), Text> {
        if !seen.connected {
            return Err(TEXTS.text("hd_axis.not_connected"));
        }
        if !seen.controlled {
            return Err(TEXTS.text("hd_axis.no_control"));
        }
        if self.asked.is_some() {
            return Err(TEXTS.text("hd_axis.busy"));
        }
        if let Some(step) = self.invalidated_step() {
            return Err(labels::invalidated_step(step));
        }
        match seen.actual.map(|actual| actual.status.state()) {
            Some(State::Fault) => return Err(TEXTS.text("hd_refused.fault")),
            Some(State::Locked) => return Err(TEXTS.text("hd_refused.lock")),
            _ => {}
        }
        match seen.locks.first() {
            Some(lock) => Err(explained::lock_text(*lock)),
            None => Ok(()),
        }
    }

    /// Checks whether the current position of the axis can become a limit.
    ///
    /// # Errors
    /// Returns an error with the reason if the position cannot become a limit.
    pub fn check_can_adopt_position(&self, seen: &DriveFacts) -> Result<(), Text> {
        if let Some(step) = self.invalidated_step() {
            return Err(labels::invalidated_step(step));
        }
        if self.asked.is_some() {
            return Err(TEXTS.text("hd_axis.busy"));
        }
        if seen.moves {
            return Err(TEXTS.text("hd_axis.moving"));
        }
        seen.position.map(|_| ()).ok_or_else(|| TEXTS.text("hd_axis.no_position"))
    }

    /// Checks whether a step has been shown long enough to be left. A click before that may be a double click meant for
    /// the previous step.
    ///
    /// # Errors
    /// Returns the remaining time as an error if the step has not been shown long enough.
    pub fn check_step_settled(looked_at: Duration) -> Result<(), Duration> {
        match MIN_STEP_TIME.saturating_sub(looked_at) {
            Duration::ZERO => Ok(()),
            left => Err(left),
        }
    }

    pub fn can_go_back(&self, seen: &DriveFacts) -> bool {
        self.step != AxisStep::Request && self.asked.is_none() && !seen.moves
    }

    pub fn can_skip(&self, seen: &DriveFacts) -> bool {
        self.step.is_optional() && self.asked.is_none() && !seen.moves && self.invalidated_step().is_none()
    }

    /// Checks whether the current step is complete.
    ///
    /// # Errors
    /// Returns an error with the missing condition if the step is not complete.
    pub fn check_can_continue(&self, seen: &DriveFacts) -> Result<(), Text> {
        let lacks = |holds: bool, id: &'static str| if holds { Ok(()) } else { Err(TEXTS.text(id)) };
        if self.asked.is_some() {
            return Err(TEXTS.text("hd_axis.busy"));
        }
        if seen.moves {
            return Err(TEXTS.text("hd_axis.moving"));
        }
        if let Some(step) = self.invalidated_step() {
            return Err(labels::invalidated_step(step));
        }
        match self.step {
            AxisStep::Request => {
                lacks(seen.requested == Some(true), "hd_axis.needs_request")?;
                lacks(seen.actual.is_some_and(|own| own.status.is_present()), "hd_axis.needs_drive")
            }
            AxisStep::Scale => {
                let preview = self.entries.preview(seen)?;
                lacks(seen.scale == Some(preview.scale), "hd_axis.needs_scale")
            }
            AxisStep::Confirm => lacks(self.is_confirmed(seen), "hd_axis.needs_confirm"),
            AxisStep::Jog => {
                lacks(self.travel.up > 0, "hd_axis.needs_up")?;
                lacks(self.travel.down > 0, "hd_axis.needs_down")
            }
            AxisStep::Reference => {
                let is_set = self.reference.is_some_and(|(_, origin)| origin == self.position_origin(seen));
                lacks(is_set || self.chain.is_complete(AxisStep::Reference), "hd_axis.needs_reference")
            }
            AxisStep::Lower => self.entries.lower_limit(seen.ruler()).map(|_| ()),
            AxisStep::Upper => {
                let taught = self.teach_in_limits(seen)?;
                lacks(seen.limits == Some(taught), "hd_axis.needs_limits")
            }
            AxisStep::Test => {
                let reached = |place| self.test_outcome(place).is_some_and(|own| own.is_good());
                lacks(TestTarget::ALL.into_iter().all(reached), "hd_axis.needs_test")
            }
            AxisStep::Save => lacks(self.saved, "hd_axis.needs_save"),
            AxisStep::PowerCycle => match self.power {
                Some(Power::Back { restart: RestartEvidence::Unproven, .. }) => Err(TEXTS.text("hd_axis.needs_proof")),
                Some(Power::Back { restart: RestartEvidence::Disproved, .. }) => {
                    Err(TEXTS.text("hd_axis.not_restarted"))
                }
                _ => lacks(self.has_survived(), "hd_axis.needs_power"),
            },
        }
    }

    /// Returns whether the user has confirmed the current limits of the drive in the current scale.
    pub(super) fn is_confirmed(&self, seen: &DriveFacts) -> bool {
        let (Some(own), Some((low, high))) = (&self.confirmed, seen.limits) else { return false };
        let (agreed, begun) = (own.agreed, own.begun.unwrap_or(own.agreed));
        let are_agreed = (low == agreed.0 || low == begun.0) && (high == agreed.1 || high == begun.1);
        own.scale == seen.scale && are_agreed && !seen.locks.contains(&MotionLock::LimitsUnconfirmed)
    }

    /// Returns the position that a test move goes to.
    ///
    /// # Errors
    /// Returns an error if the limits are not known.
    pub fn target(&self, place: TestTarget, seen: &DriveFacts) -> Result<i32, Text> {
        let (low, high) = seen.limits.ok_or_else(|| TEXTS.text("hd_axis.unread"))?;
        Ok(place.position_between(low, high))
    }
}
