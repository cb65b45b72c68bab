//! Reads the limits repeatedly while drives may be moved, because another master may change them. Only the limits of
//! the displayed drive and of the last moved drive are read. The interval does not depend on other polling.

use std::time::Duration;

use super::session_watch::REQUEST;
use super::{DeviceMessage, Hiperdrive};
use crate::devices::hiperdrive::procedures::{Error, GROUPS, Identity, read_rule_group, read_rules};
use crate::devices::hiperdrive::protocol::DriveNumber;
use crate::units::Moment;
use crate::worker::SessionContext;

/// Length of a time slot while no drive moves. Each group of limit parameters has one slot per second.
const TURN: Duration = Duration::from_millis(250);
/// Length of a time slot while a drive moves. Every slot sends a request, so that a device that stops replying is
/// detected and the motion ends.
const MOTION_SLOT_LENGTH: Duration = REQUEST;
/// Pause after a failed reading.
const RETRY_PAUSE: Duration = Duration::from_millis(500);

#[derive(Debug, Default)]
pub(super) struct RulesRefresh {
    rests: Option<Moment>,
}

/// Returns the groups that have not been read since their last time slot began, least recently read first.
fn due_groups(read: [Moment; GROUPS], now: Moment, turn: Duration) -> Vec<usize> {
    let is_due = |(group, at): &(usize, Moment)| started_slots(*group, now, turn) > started_slots(*group, *at, turn);
    let mut groups: Vec<(usize, Moment)> = read.into_iter().enumerate().filter(is_due).collect();
    groups.sort_by_key(|(_, at)| *at);
    groups.into_iter().map(|(group, _)| group).collect()
}

/// Returns the number of time slots of a group that have begun by the given time.
fn started_slots(group: usize, at: Moment, turn: Duration) -> u128 {
    let begun = at.since_start().as_nanos() / turn.as_nanos();
    let groups = GROUPS as u128;
    (begun + groups - group as u128) / groups
}

impl Hiperdrive {
    /// Reads the limit parameters that are due while drives may be moved. After a failure, which is reported once, no
    /// drive may move until a reading succeeds.
    pub(super) fn refresh_rules(&mut self, context: &mut SessionContext) {
        let Some(identity) = self.control.controlled_device() else { return };
        if self.control.rules_refresh.rests.is_some_and(|until| context.clock.now() < until) {
            return;
        }
        let moved = self.control.motion().requested_drive();
        for drive in [Some(self.watched), Some(moved).filter(|moved| *moved != self.watched)].into_iter().flatten() {
            if identity.drive(drive).is_none() {
                continue;
            }
            match self.read_group(context, &identity, drive) {
                Ok(()) => {}
                // A job takes precedence, or a newer request has arrived.
                Err(error) if error.is_cancelled() => return,
                Err(error) => return self.handle_refresh_failure(context, drive, error),
            }
        }
        if self.control.rules_refresh.rests.take().is_some() {
            self.remark.get_or_insert(DeviceMessage::RulesRead);
        }
    }

    fn read_group(
        &mut self,
        context: &mut SessionContext,
        identity: &Identity,
        drive: DriveNumber,
    ) -> Result<(), Error> {
        if self.control.actual_values(drive).is_some_and(|actual| !actual.status.is_present()) {
            self.control.forget_drive(drive);
            return Ok(());
        }
        let known = self.control.motion().limits(drive);
        let Some(mut times) = known.read_times() else {
            let began = context.clock.now();
            let rules = read_rules(&mut self.create_master(context), drive)?;
            self.control.publish_limits(identity, drive, rules, [began; GROUPS]);
            return Ok(());
        };
        let mut rules = known.rules();
        let turn = if self.control.motion().is_motion_active() { MOTION_SLOT_LENGTH } else { TURN };
        for group in due_groups(times, context.clock.now(), turn) {
            let now = context.clock.now();
            rules = read_rule_group(&mut self.create_master(context), drive, rules, group)?;
            if let Some(at) = times.get_mut(group) {
                *at = now;
            }
            self.control.publish_limits(identity, drive, rules, times);
        }
        Ok(())
    }

    fn handle_refresh_failure(&mut self, context: &mut SessionContext, drive: DriveNumber, error: Error) {
        tracing::warn!("{error}");
        // All limits are read before anything moves again.
        self.control.motion().invalidate_limits(drive);
        if matches!(error, Error::Link(_)) || self.wire.check_connection().is_err() {
            // A device that can no longer be queried is treated as lost.
            return self.control.stop_after_session_loss();
        }
        if self.control.rules_refresh.rests.replace(context.clock.now() + RETRY_PAUSE).is_none() {
            self.control.motion().stop();
            self.remark.get_or_insert(DeviceMessage::RulesUnread(Box::new(error)));
        }
    }

    /// Reads the limits of a newly selected drive before anything else. This is not needed for the last moved drive,
    /// whose limits are read even while another drive is selected. A paused job of that drive can therefore be resumed.
    pub(super) fn restart_refresh(&mut self, context: &mut SessionContext, drive: DriveNumber) {
        if drive != self.control.motion().requested_drive() {
            self.control.motion().invalidate_limits(drive);
        }
        self.refresh_rules(context);
    }

    /// Reads the limits of all drives. This cannot be cancelled, because the limits must be known after a change.
    ///
    /// # Errors
    /// Returns an error if the exchange fails.
    pub(super) fn read_rules(&mut self, context: &mut SessionContext, identity: &Identity) -> Result<(), Error> {
        for drive in &identity.drives {
            let began = context.clock.now();
            let rules = self.create_master(context).run_uncancellable(|master| read_rules(master, drive.number))?;
            self.control.publish_limits(identity, drive.number, rules, [began; GROUPS]);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(ms: u64) -> Moment {
        Moment::START + Duration::from_millis(ms)
    }

    /// While a drive moves, a group becomes due at least every 60 ms (issue 21.13).
    #[test]
    fn reads_group_every_60_ms_in_motion() {
        let mut read = [at(0); GROUPS];
        let mut last = 0;
        for now in (0..4000).step_by(20) {
            for group in due_groups(read, at(now), MOTION_SLOT_LENGTH) {
                read[group] = at(now);
                last = now;
            }
            assert!(now - last <= 80, "{now}: nothing since {last}, looked at every 20 ms");
        }
        assert_eq!(MOTION_SLOT_LENGTH, Duration::from_millis(60));
    }

    #[test]
    fn reads_every_group_once_per_second() {
        for (step, first) in
            [10, 100, 200, 249, 250, 300, 500, 2000].into_iter().flat_map(|step| [(step, 0), (step, 777)])
        {
            let mut read = [at(first); GROUPS];
            let (mut now, mut asked) = (first, 0);
            while now < first + 10_000 {
                now += step;
                let age = at(now).duration_since(read.into_iter().min().unwrap());
                assert!(age <= Duration::from_millis(1000 + step), "{step}: {age:?}");
                let groups = due_groups(read, at(now), TURN);
                assert!(groups.len() as u64 <= step.div_ceil(250).min(4), "{step}: {groups:?} at once");
                for group in groups {
                    read[group] = at(now);
                    asked += 1;
                }
            }
            assert!((20..=41).contains(&asked), "{step}: {asked} in ten seconds");
        }
    }
}
