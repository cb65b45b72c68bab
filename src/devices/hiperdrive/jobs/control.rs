//! The cyclic connection of a session. The user opens and closes it. The permits to move its drives come from the
//! parameters that were read last.

use std::sync::Arc;
use std::time::Duration;

use super::commit::commit_plan as carry_through;
use super::rules_refresh::RulesRefresh;
use super::{Commit, Committed, Cyclic, DeviceMessage, Hiperdrive, JobError, Motion, ProgressSink};
use crate::buses::ethernet_ip::protocol::ForwardClose;
use crate::devices::hiperdrive::procedures::cyclic::{ConnectionLoss, ParameterReading, ParameterResult};
use crate::devices::hiperdrive::procedures::{
    DriveLimits, Error, GROUPS, Identity, MotionLimitParameters, Survey, Temperature, TemperatureReading, identify,
};
use crate::devices::hiperdrive::protocol::{ActualValues, DriveNumber, ParameterNumber, PkwError, Value};
use crate::link::{Clock, DatagramPort, LinkError, LinkErrorKind, measure_timer_step};
use crate::units::Moment;
use crate::worker::SessionContext;

/// Cyclic connection to a device and the motion permits of its drives.
pub(super) struct CyclicControl {
    port: Option<Box<dyn DatagramPort>>,
    clock: Arc<dyn Clock>,
    motion: Motion,
    open: Option<OpenConnection>,
    /// Device and drives as identified when the connection was last opened.
    identity: Option<Identity>,
    pub(super) rules_refresh: RulesRefresh,
}

struct OpenConnection {
    cyclic: Cyclic,
    close: ForwardClose,
}

impl CyclicControl {
    pub(super) fn new(port: Option<Box<dyn DatagramPort>>, clock: Arc<dyn Clock>) -> Self {
        CyclicControl {
            port,
            clock: clock.clone(),
            motion: Motion::new(clock),
            open: None,
            identity: None,
            rules_refresh: RulesRefresh::default(),
        }
    }

    pub(super) fn motion(&self) -> Motion {
        self.motion.clone()
    }

    /// Returns the data of a drive from the cyclic connection, or `None` if the connection is closed or has not
    /// received any data yet.
    pub(super) fn actual_values(&self, drive: DriveNumber) -> Option<ActualValues> {
        let view = self.motion.snapshot();
        let speaks = view.open && view.link.received > 0;
        view.drives.iter().find(|own| speaks && own.number == drive).map(|own| own.actual)
    }

    /// Requests a temperature through the parameter words of the cyclic connection. Returns the latest reading, or
    /// `None` if the connection has no parameter words or the device has not replied.
    pub(super) fn temperature(&self, what: Temperature) -> Result<Option<TemperatureReading>, Error> {
        let reading = self.motion.watch_parameter(what.parameter()?);
        Ok(reading.and_then(|ParameterReading { at, result }| match result {
            ParameterResult::Number(celsius) => Some(TemperatureReading { at, what, celsius: Some(celsius) }),
            ParameterResult::Refused(PkwError::NO_PARAMETER) => Some(TemperatureReading { at, what, celsius: None }),
            ParameterResult::Refused(_) | ParameterResult::NoReply => None,
        }))
    }

    /// Returns the device and its drives, or `None` if the cyclic connection is closed, in which case the drives cannot
    /// be moved.
    pub(super) fn controlled_device(&self) -> Option<Identity> {
        self.open.as_ref().and(self.identity.clone())
    }

    /// Stops the drives after explicit messaging was lost.
    pub(super) fn stop_after_session_loss(&self) {
        if let Some(open) = &self.open {
            open.cyclic.report_loss(ConnectionLoss::Session);
        }
    }

    /// Updates the motion permits (locks and limits) of the drives from parameters whose reading began at the given
    /// moment.
    pub(super) fn update_permits(&mut self, survey: &Survey, began: Moment) {
        for drive in &survey.identity.drives {
            let read = |base| match survey.values.get(&ParameterNumber::for_drive(base, drive.number)?)? {
                Value::Number(value) => Some(*value),
                Value::Text(_) => None,
            };
            self.publish_limits(
                &survey.identity,
                drive.number,
                MotionLimitParameters::from_parameters(read),
                [began; GROUPS],
            );
        }
    }

    pub(super) fn forget_drive(&mut self, drive: DriveNumber) {
        self.motion.with_limits(drive, DriveLimits::clear);
    }

    /// Publishes the limits of a drive, taken from its parameters, together with the times at which these were read.
    pub(super) fn publish_limits(
        &self,
        identity: &Identity,
        drive: DriveNumber,
        rules: MotionLimitParameters,
        times: [Moment; GROUPS],
    ) {
        let Some(variant) = identity.drive(drive).map(|drive| drive.variant) else { return };
        self.motion.with_limits(drive, |limits| limits.update(rules, (identity.topology, variant), times));
    }
}

impl Hiperdrive {
    /// Opens the cyclic connection, without moving any drive.
    pub(super) fn take_control(
        &mut self,
        context: &mut SessionContext,
        progress: &mut dyn FnMut(u64, u64, ParameterNumber),
    ) -> Result<(), Error> {
        if self.control.open.is_some() {
            return Err(Error::InControl);
        }
        if cfg!(windows) {
            check_timer(measure_timer_step(&*self.control.clock), self.station.link.interval)?;
        }
        let identity = identify(&mut self.create_master(context), progress)?;
        self.control.rules_refresh = RulesRefresh::default();
        identity.drives.iter().for_each(|drive| self.control.motion.invalidate_limits(drive.number));
        self.read_rules(context, &identity)?;
        let mut packets = self.control.port.as_mut().ok_or(Error::NoCyclic)?.open()?;
        let opened = self.create_master(context).forward_open(identity.topology, packets.port())?;
        packets.set_target_port(opened.port);
        let joined = opened.group.map_or(Ok(()), |group| packets.join(group));
        let drives: Vec<DriveNumber> = identity.drives.iter().map(|drive| drive.number).collect();
        let started = joined.and_then(|()| {
            let clock = self.control.clock.clone();
            let started = Cyclic::start(packets, &opened, &drives, clock, &self.control.motion);
            started.map_err(|error| LinkError::new("cyclic data", LinkErrorKind::Other(error.to_string())))
        });
        match started {
            Ok(cyclic) => {
                self.control.open = Some(OpenConnection { cyclic, close: opened.close });
                self.control.motion.set_connected(true);
                self.control.identity = Some(identity);
                Ok(())
            }
            Err(error) => {
                // The unusable connection is closed, but the original error is reported.
                if let Err(why) = self.create_master(context).forward_close(&opened.close) {
                    tracing::warn!("{why}");
                }
                Err(error.into())
            }
        }
    }

    pub(super) fn release(&mut self, context: &mut SessionContext) -> Result<(), Error> {
        let Some(OpenConnection { cyclic, close }) = self.control.open.take() else { return Ok(()) };
        cyclic.close();
        let closed = self.create_master(context).forward_close(&close);
        self.control.motion.set_connected(false);
        closed
    }

    /// Stops and releases the drives, then ends the EtherNet/IP session if drives were under control.
    pub(super) fn end_session(&mut self, context: &mut SessionContext) {
        let had_control = self.control.identity.is_some();
        if let Err(why) = self.release(context) {
            tracing::warn!("{why}");
        }
        // This request has no reply, and its failure does not matter if the device is disconnected.
        if had_control && let Err(why) = self.create_master(context).unregister_session() {
            tracing::debug!("{why}");
        }
    }

    /// Returns whether the program is shutting down while drives are still under control.
    pub(super) fn should_release_control(&self) -> bool {
        self.control.open.is_some() && self.control.motion.is_shutting_down()
    }

    /// Closes a lost cyclic connection at the target and reports the loss once. A lost session for explicit messages
    /// has the same effect, because a drive must not move while its parameters are inaccessible.
    pub(super) fn release_lost_control(&mut self, context: &mut SessionContext) {
        if self.control.open.is_some() && self.wire.check_connection().is_err() {
            self.control.stop_after_session_loss();
        }
        if self.should_release_control() {
            return self.end_session(context);
        }
        if self.control.open.as_ref().is_none_or(|open| open.cyclic.connection_loss().is_none()) {
            return;
        }
        self.remark = Some(DeviceMessage::ControlLost);
        // The target may already have closed the connection, or may not reply. Its own time-out then ends the
        // connection.
        if let Err(why) = self.release(context) {
            tracing::warn!("{why}");
        }
    }

    /// Executes a plan, then reads the limits of the drives again. No drive may move until its limits are known.
    pub(super) fn commit_plan(
        &mut self,
        context: &mut SessionContext,
        commit: &Commit,
        tell: ProgressSink<'_>,
    ) -> Result<Committed, JobError> {
        let identity = &commit.prepared.identity;
        for drive in &identity.drives {
            // These values are from before the plan. A changed scale is detected by comparison with them.
            let rules =
                MotionLimitParameters::from_parameters(|base| commit.prepared.image.for_drive(drive.number, base));
            let now = context.clock.now();
            self.control.motion.with_limits(drive.number, |limits| {
                limits.update(rules, (identity.topology, drive.variant), [now; GROUPS]);
                limits.clear();
            });
        }
        let ended = carry_through(self, context, commit, tell);
        let lost = ended.as_ref().err().and_then(JobError::device).is_some_and(Error::is_lost);
        // A device that is lost is not queried again.
        if !lost && let Err(why) = self.read_rules(context, identity) {
            tracing::warn!("{why}");
        }
        ended
    }
}

/// Checks that the timer of this computer is fine enough for an interval. A packet is late by at most one timer step,
/// which may be half an interval, since the target tolerates several intervals without a packet.
fn check_timer(step: Duration, interval: Duration) -> Result<(), Error> {
    let milliseconds = |time: Duration| u64::try_from(time.as_millis()).unwrap_or(u64::MAX);
    if step > interval / 2 {
        return Err(Error::CoarseTimer { asked_ms: milliseconds(interval), step_ms: milliseconds(step) });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rejects_interval_finer_than_timer() {
        let check =
            |step_us, interval_ms| check_timer(Duration::from_micros(step_us), Duration::from_millis(interval_ms));
        assert_eq!(check(1_100, 5), Ok(()));
        assert_eq!(check(2_501, 5), Err(Error::CoarseTimer { asked_ms: 5, step_ms: 2 }));
        assert_eq!(check(15_625, 10), Err(Error::CoarseTimer { asked_ms: 10, step_ms: 15 }));
        assert_eq!(check(15_625, 40), Ok(()));
    }
}
