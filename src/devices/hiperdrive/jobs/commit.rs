//! What an adapter or a hub brings to a write.

use super::{Commit, Committed, Doing, Hiperdrive, JobError, Prepared, Told, device_key};
use crate::devices::hiperdrive::procedures::write::{Confirmed, Interrupted, Written, carry_out, confirm};
use crate::devices::hiperdrive::procedures::{Error, Master};
use crate::devices::hiperdrive::profile::{HiperdriveProfile, Op};
use crate::profile::Body;
use crate::worker::commit::{Intended, OldWrite as Write, Terms, backup_of, commit as carry_through};
use crate::worker::{Desk, Interruption, Progress, Tell};

pub(super) fn commit(
    device: &mut Hiperdrive,
    desk: &mut Desk,
    commit: &Commit,
    tell: Told<'_>,
) -> Result<Committed, JobError> {
    let prepared = &commit.prepared;
    let plan = &prepared.plan;
    let store = desk.store.clone();
    let key = device_key(&prepared.identity, desk.is_virtual);
    // No limit is known (`U`): saves are counted and told, and refused only where they cannot be.
    let terms = Terms::of(key, plan, Op::note, (prepared.cycles_seen, u64::MAX), commit.force_wear);
    let told = &mut |progress| tell(Tell::Progress(progress));
    let mut write = DeviceWrite { master: device.master(desk), commit, told };
    carry_through(&store, &terms, prepared.kind, &mut write)
}

struct DeviceWrite<'w, 'm> {
    master: Master<'m>,
    commit: &'w Commit,
    told: &'w mut dyn FnMut(Progress<Doing>),
}

impl<'w> Write for DeviceWrite<'w, '_> {
    type Confirmed = Confirmed<'w>;
    type Written = Written;
    type Refusal = Error;
    type Interrupted = Interrupted;

    fn confirm(&mut self) -> Result<Confirmed<'w>, Error> {
        let Commit { prepared, consent, .. } = self.commit;
        confirm(&mut self.master, &prepared.plan, *consent, &prepared.identity)
    }

    fn before_image(&self) -> String {
        before_image(&self.commit.prepared)
    }

    fn carry_out(&mut self, confirmed: &Confirmed<'w>, _intended: &Intended) -> Result<Written, Box<Interrupted>> {
        let ops = &self.commit.prepared.plan.ops;
        let told = &mut |number: usize| {
            let item = ops.get(number).map(Op::item).unwrap_or_default();
            (self.told)(Progress::at(ops, number, Doing::Operation(item)));
        };
        carry_out(&mut self.master, confirmed, told)
    }

    fn write_cycles(written: &Written) -> u64 {
        written.write_cycles
    }
}

impl Interruption for Interrupted {
    type Error = Error;

    fn error(&self) -> Option<&Error> {
        Some(&self.cause)
    }

    fn why(&self) -> Option<String> {
        (self.cause != Error::Cancelled).then(|| self.cause.to_string())
    }

    fn done(&self) -> usize {
        self.done.ops
    }

    fn write_cycles(&self) -> u64 {
        self.done.write_cycles
    }
}

/// A profile of all that the device keeps, as it was.
fn before_image(prepared: &Prepared) -> String {
    let profile = HiperdriveProfile::of(prepared.identity.profile(), prepared.image.clone());
    backup_of(Body::new(profile)).emit()
}
