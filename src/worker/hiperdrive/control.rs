//! The cyclic connection of a session: it is opened and closed by a person, and what the drives may do comes from their
//! parameters, as they were read last.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::commit::commit as carry_through;
use super::{Commit, Committed, Hiperdrive, JobError, Motion, Told};
use crate::device::hiperdrive::dead_man::Permit;
use crate::device::hiperdrive::{Error, Identity, Rules, Survey, identify, read_rules};
use crate::link::Clock;
use crate::protocol::hiperdrive::{Actual, DriveNumber, ParameterNumber, Value};
use crate::worker::Desk;

/// Who has the cyclic connection, and what drives may do over it.
pub(super) struct Control {
    motion: Motion,
    /// What rules the drives, as it was read last.
    rules: BTreeMap<DriveNumber, Rules>,
}

impl Control {
    pub(super) fn new(clock: Arc<dyn Clock>) -> Self {
        Control { motion: Motion::new(clock), rules: BTreeMap::new() }
    }

    pub(super) fn motion(&self) -> Motion {
        self.motion.clone()
    }

    /// What a drive says over the cyclic connection, while there is one.
    pub(super) fn actual(&self, drive: DriveNumber) -> Option<Actual> {
        let view = self.motion.view();
        view.drives.iter().find(|own| view.open && own.number == drive).map(|own| own.actual)
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
        let identity = identify(&mut self.master(desk))?;
        self.read_rules(desk, &identity)?;
        Err(Error::NoCyclic)
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
        if let Err(why) = self.read_rules(desk, identity) {
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
