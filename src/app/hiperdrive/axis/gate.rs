//! What can be pressed in the set-up of an axis, what that asks for, and what is missing before the next step.

use super::{Ask, Axis, Button, Place, Seen, Step, words};
use crate::app::{Text, explain};
use crate::device::hiperdrive::dead_man::Lock;

impl Axis {
    /// What pressing would ask for.
    ///
    /// # Errors
    /// Why it cannot be pressed now.
    pub fn ask(&self, button: Button, seen: &Seen) -> Result<Ask, Text> {
        if !seen.connected {
            return Err(Text::new("hd_axis.not_connected"));
        }
        if seen.busy || self.asked.is_some() {
            return Err(Text::new("hd_axis.busy"));
        }
        if seen.stale && button != Button::Give {
            return Err(Text::new("hd_axis.unread"));
        }
        let stands = || if seen.moves { Err(Text::new("hd_axis.moving")) } else { Ok(()) };
        match button {
            Button::Take | Button::Give if seen.controlled == (button == Button::Take) => {
                Err(Text::new("hd_axis.already"))
            }
            Button::Take => Ok(Ask::Take),
            Button::Give => stands().map(|()| Ask::Give),
            Button::Recall if self.saved => Err(Text::new("hd_axis.already")),
            Button::Recall => stands().map(|()| Ask::Recall),
            _ if self.end.is_some() => Err(Text::new("hd_axis.over")),
            Button::Do => stands().and_then(|()| self.ask_of_step(seen)),
            Button::Confirm => match (seen.scale, seen.limits) {
                (Some(_), Some(_)) => Ok(Ask::ConfirmLimits),
                _ => Err(Text::new("hd_axis.unread")),
            },
            Button::Widen => {
                let preview = self.entries.preview(seen)?;
                stands().map(|()| Ask::Try(vec![(158, preview.lower.into()), (160, preview.upper.into())]))
            }
            Button::Go(place) => {
                self.may_move(seen)?;
                stands().and_then(|()| self.target(place, seen).map(Ask::Move))
            }
            Button::PowerCycle if !seen.is_virtual => Err(Text::new("hd_axis.not_virtual")),
            Button::PowerCycle if seen.controlled => Err(Text::new("hd_axis.give_first")),
            Button::PowerCycle => Ok(Ask::PowerCycle),
        }
    }

    /// What the step itself does to the drive.
    fn ask_of_step(&self, seen: &Seen) -> Result<Ask, Text> {
        match self.step {
            Step::Request if seen.requested == Some(true) => Err(Text::new("hd_axis.already")),
            Step::Request => Ok(Ask::Try(vec![(152, 1)])),
            Step::Scale => {
                let preview = self.entries.preview(seen)?;
                if seen.scale == Some(preview.scale) {
                    return Err(Text::new("hd_axis.already"));
                }
                let (numerator, denominator) = (preview.scale.numerator(), preview.scale.denominator());
                let (low, high) = (preview.lower, preview.upper);
                let all = [(154, numerator.into()), (156, denominator.into()), (158, low.into()), (160, high.into())];
                Ok(Ask::Try(all.to_vec()))
            }
            Step::Reference => {
                let reference = self.entries.reference(self.ruler(seen), seen.limits)?;
                Ok(Ask::SetPosition(reference.becomes))
            }
            Step::Upper => {
                let (low, high) = self.taught(seen)?;
                if seen.limits == Some((low, high)) {
                    return Err(Text::new("hd_axis.already"));
                }
                Ok(Ask::Try(vec![(158, low.into()), (160, high.into())]))
            }
            Step::Save => Ok(Ask::Save),
            Step::Confirm | Step::Jog | Step::Lower | Step::Test | Step::PowerCycle => {
                Err(Text::new("hd_axis.already"))
            }
        }
    }

    /// Both limits as they were taught, and where the axis stands between them.
    fn taught(&self, seen: &Seen) -> Result<(i32, i32), Text> {
        let ruler = self.ruler(seen);
        let (low, high) = (self.entries.lower(ruler)?, self.entries.upper(ruler)?);
        let mm = |steps: i32| words::millimetres(ruler, steps.into());
        if low >= high {
            return Err(Text::new("hd_axis.crossed").with_text("low", mm(low)).with_text("high", mm(high)));
        }
        let position = seen.actual.ok_or_else(|| Text::new("hd_axis.unread"))?.position;
        if !(low..=high).contains(&position) {
            let outside = Text::new("hd_axis.outside").with_text("position", mm(position));
            return Err(outside.with_text("low", mm(low)).with_text("high", mm(high)));
        }
        Ok((low, high))
    }

    /// Why the axis must not be moved.
    ///
    /// # Errors
    /// In words.
    pub fn may_move(&self, seen: &Seen) -> Result<(), Text> {
        if !seen.connected {
            return Err(Text::new("hd_axis.not_connected"));
        }
        if !seen.controlled {
            return Err(Text::new("hd_axis.no_control"));
        }
        if self.asked.is_some() {
            return Err(Text::new("hd_axis.busy"));
        }
        match seen.locks.first() {
            Some(lock) => Err(explain::hiperdrive::lock(*lock)),
            None => Ok(()),
        }
    }

    /// Whether the step that counts is done, so that the next one may come.
    ///
    /// # Errors
    /// What is missing.
    pub fn may_go_on(&self, seen: &Seen) -> Result<(), Text> {
        let lacks = |holds: bool, id: &'static str| if holds { Ok(()) } else { Err(Text::new(id)) };
        if self.asked.is_some() {
            return Err(Text::new("hd_axis.busy"));
        }
        if seen.moves {
            return Err(Text::new("hd_axis.moving"));
        }
        match self.step {
            Step::Request => {
                lacks(seen.requested == Some(true), "hd_axis.needs_request")?;
                lacks(seen.actual.is_some_and(|own| own.status.is_present()), "hd_axis.needs_drive")
            }
            Step::Scale => {
                let preview = self.entries.preview(seen)?;
                lacks(seen.scale == Some(preview.scale), "hd_axis.needs_scale")
            }
            Step::Confirm => lacks(self.is_confirmed(seen), "hd_axis.needs_confirm"),
            Step::Jog => {
                lacks(self.travel.up > 0, "hd_axis.needs_up")?;
                lacks(self.travel.down > 0, "hd_axis.needs_down")
            }
            Step::Reference => lacks(self.reference.is_some(), "hd_axis.needs_reference"),
            Step::Lower => self.entries.lower(self.ruler(seen)).map(|_| ()),
            Step::Upper => {
                let taught = self.taught(seen)?;
                lacks(seen.limits == Some(taught), "hd_axis.needs_limits")
            }
            Step::Test => {
                let reached = |place| self.outcome(place).is_some_and(|own| own.is_good());
                lacks(Place::ALL.into_iter().all(reached), "hd_axis.needs_test")
            }
            Step::Save => lacks(self.saved, "hd_axis.needs_save"),
            Step::PowerCycle => lacks(self.survived(), "hd_axis.needs_power"),
        }
    }

    /// Somebody has confirmed the limits under the scale that the drive has.
    pub(super) fn is_confirmed(&self, seen: &Seen) -> bool {
        let scale = self.confirmed.map(|(scale, _)| scale);
        scale.is_some() && scale == seen.scale && !seen.locks.contains(&Lock::LimitsUnconfirmed)
    }

    /// Where a test move leads.
    ///
    /// # Errors
    /// Without limits.
    pub fn target(&self, place: Place, seen: &Seen) -> Result<i32, Text> {
        let (low, high) = seen.limits.ok_or_else(|| Text::new("hd_axis.unread"))?;
        Ok(place.between(low, high))
    }
}
