//! The cyclic connection of a session: it is opened and closed by a person, and what the drives may do comes from their
//! parameters, as they were read last.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::commit::commit as carry_through;
use super::{Commit, Committed, Cyclic, Hiperdrive, JobError, Motion, Remark, Told};
use crate::device::hiperdrive::cyclic::CyclicLost;
use crate::device::hiperdrive::dead_man::Permit;
use crate::device::hiperdrive::{Error, Identity, Rules, Survey, identify, read_rules};
use crate::link::{Clock, DatagramPort, LinkError, LinkErrorKind};
use crate::protocol::ethernet_ip::ForwardClose;
use crate::protocol::hiperdrive::{Actual, DriveNumber, ParameterNumber, Value};
use crate::worker::Desk;

/// Who has the cyclic connection, and what drives may do over it.
pub(super) struct Control {
    port: Option<Box<dyn DatagramPort>>,
    clock: Arc<dyn Clock>,
    motion: Motion,
    open: Option<Open>,
    /// What rules the drives, as it was read last.
    rules: BTreeMap<DriveNumber, Rules>,
}

struct Open {
    cyclic: Cyclic,
    close: ForwardClose,
}

impl Control {
    pub(super) fn new(port: Option<Box<dyn DatagramPort>>, clock: Arc<dyn Clock>) -> Self {
        Control { port, clock: clock.clone(), motion: Motion::new(clock), open: None, rules: BTreeMap::new() }
    }

    pub(super) fn motion(&self) -> Motion {
        self.motion.clone()
    }

    /// What a drive says over the cyclic connection, while there is one.
    pub(super) fn actual(&self, drive: DriveNumber) -> Option<Actual> {
        let view = self.motion.view();
        view.drives.iter().find(|own| view.open && own.number == drive).map(|own| own.actual)
    }

    /// The explicit messages are gone: drives stop.
    pub(super) fn lose_session(&self) {
        if let Some(open) = &self.open {
            open.cyclic.lose(CyclicLost::Session);
        }
    }

    /// What drives may do, by a survey.
    pub(super) fn rule_by(&mut self, survey: &Survey) {
        for drive in &survey.identity.drives {
            let read = |base| match survey.values.get(&ParameterNumber::of_drive(base, drive.number)?)? {
                Value::Number(value) => Some(*value),
                Value::Text(_) => None,
            };
            self.rule(&survey.identity, drive.number, Rules::by(read));
        }
    }

    /// Where the scale is another one than before, limits lie elsewhere: nobody has looked at them yet.
    fn rule(&mut self, identity: &Identity, drive: DriveNumber, rules: Rules) {
        let Some(variant) = identity.drive(drive).map(|drive| drive.variant) else { return };
        let before = self.rules.insert(drive, rules);
        if before.is_some_and(|before| before.scale.is_some() && before.scale != rules.scale) {
            self.motion.limits_changed(drive);
        }
        self.motion.permit(drive, rules.permit(identity.topology, variant));
    }
}

impl Hiperdrive {
    /// Opens the cyclic connection. Nothing moves by that.
    pub(super) fn take(&mut self, desk: &mut Desk) -> Result<(), Error> {
        if self.control.open.is_some() {
            return Err(Error::InControl);
        }
        let identity = identify(&mut self.master(desk))?;
        self.read_rules(desk, &identity)?;
        let mut packets = self.control.port.as_mut().ok_or(Error::NoCyclic)?.open()?;
        let opened = self.master(desk).forward_open(identity.topology, packets.port())?;
        packets.aim(opened.port);
        let joined = opened.group.map_or(Ok(()), |group| packets.join(group));
        let drives: Vec<DriveNumber> = identity.drives.iter().map(|drive| drive.number).collect();
        let started = joined.and_then(|()| {
            let clock = self.control.clock.clone();
            let started = Cyclic::start(packets, &opened, &drives, clock, &self.control.motion);
            started.map_err(|error| LinkError::new("cyclic data", LinkErrorKind::Other(error.to_string())))
        });
        match started {
            Ok(cyclic) => {
                self.control.open = Some(Open { cyclic, close: opened.close });
                self.station.in_control = true;
                Ok(())
            }
            Err(error) => {
                // What cannot be used is given back; why it cannot be used is what counts.
                if let Err(why) = self.master(desk).forward_close(&opened.close) {
                    tracing::warn!("{why}");
                }
                Err(error.into())
            }
        }
    }

    /// Stops all drives and closes the cyclic connection.
    pub(super) fn give(&mut self, desk: &mut Desk) -> Result<(), Error> {
        self.station.in_control = false;
        let Some(Open { cyclic, close }) = self.control.open.take() else { return Ok(()) };
        cyclic.close();
        self.master(desk).forward_close(&close)
    }

    /// A cyclic connection that was lost is closed at the other end as well, and told once. It is lost also where explicit
    /// messages are: whoever cannot write parameters any more does not move anything either.
    pub(super) fn let_go_of_lost(&mut self, desk: &mut Desk) {
        if self.control.open.is_some() && self.wire.check().is_err() {
            self.control.lose_session();
        }
        if self.control.open.as_ref().is_none_or(|open| open.cyclic.lost().is_none()) {
            return;
        }
        self.remark = Some(Remark::ControlLost);
        // It may have ended there already, or nobody answers: it ends there by itself then.
        if let Err(why) = self.give(desk) {
            tracing::warn!("{why}");
        }
    }

    /// Carries a plan out, and looks again at what drives may do: until that is known, nothing.
    pub(super) fn commit(&mut self, desk: &mut Desk, commit: &Commit, tell: Told<'_>) -> Result<Committed, JobError> {
        let identity = &commit.prepared.identity;
        for drive in &identity.drives {
            let rules = Rules::by(|base| commit.prepared.image.of_drive(drive.number, base));
            self.control.rule(identity, drive.number, rules);
            self.control.motion.permit(drive.number, Permit::default());
        }
        let ended = carry_through(self, desk, commit, tell);
        let lost = match &ended {
            Err(JobError::Device(error)) => error.is_lost(),
            Err(JobError::Interrupted { interrupted, .. }) => interrupted.cause.is_lost(),
            _ => false,
        };
        // Who is gone is not asked again.
        if !lost && let Err(why) = self.read_rules(desk, identity) {
            tracing::warn!("{why}");
        }
        ended
    }

    fn read_rules(&mut self, desk: &mut Desk, identity: &Identity) -> Result<(), Error> {
        for drive in &identity.drives {
            let rules = read_rules(&mut self.master(desk), drive.number)?;
            self.control.rule(identity, drive.number, rules);
        }
        Ok(())
    }
}
