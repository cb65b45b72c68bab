//! What an adapter or a hub brings to a write.

use jiff::Timestamp;

use super::{Commit, Committed, Doing, Hiperdrive, JobError, Prepared, Told, device_key};
use crate::device::hiperdrive::write::{Confirmed, Interrupted, Written, carry_out, confirm};
use crate::device::hiperdrive::{Error, Master};
use crate::profile::hiperdrive::{HiperdriveProfile, Op};
use crate::profile::{Body, Document};
use crate::store::Outcome;
use crate::worker::commit::{Failed, Intended, Terms, Write, commit as carry_through};
use crate::worker::{Desk, Progress, Tell};

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
    // Nobody knows a limit (`U`): saves are counted and told, and none is refused.
    let terms = Terms::of(key, plan, Op::note, (prepared.cycles_seen, u64::MAX), true);
    let told = &mut |progress| tell(Tell::Progress(progress));
    let mut write = DeviceWrite { master: device.master(desk), commit, told };
    carry_through(&store, &terms, &mut write).map_err(|failed| match failed {
        Failed::NotBegun(why) => why.into(),
        Failed::Refused(error) => error.into(),
        Failed::Interrupted { interrupted, backup } => {
            JobError::Interrupted { interrupted, backup, planned: plan.ops.len(), kind: prepared.kind }
        }
    })
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
    type Interrupted = Box<Interrupted>;

    fn confirm(&mut self) -> Result<Confirmed<'w>, Error> {
        let Commit { prepared, consent } = self.commit;
        confirm(&mut self.master, &prepared.plan, *consent, &prepared.identity)
    }

    fn before_image(&self) -> String {
        before_image(&self.commit.prepared)
    }

    fn carry_out(&mut self, confirmed: &Confirmed<'w>, _intended: &Intended) -> Result<Written, Box<Interrupted>> {
        let ops = &self.commit.prepared.plan.ops;
        let told = &mut |number: usize| {
            let item = ops.get(number).map(Op::item).unwrap_or_default();
            let (done, total) = (number as u64, ops.len() as u64);
            (self.told)(Progress { done, total, what: Doing::Operation(item) });
        };
        carry_out(&mut self.master, confirmed, told)
    }

    fn conclusion(ended: Result<&Written, &Box<Interrupted>>) -> (Outcome, u64) {
        match ended {
            Ok(written) => (Outcome::Done, written.write_cycles),
            Err(interrupted) => {
                let outcome = match &interrupted.cause {
                    Error::Cancelled => Outcome::Cancelled,
                    cause => Outcome::Failed(cause.to_string()),
                };
                (outcome, interrupted.done.write_cycles)
            }
        }
    }
}

/// A profile of all that the device keeps, as it was.
fn before_image(prepared: &Prepared) -> String {
    let profile = HiperdriveProfile::of(prepared.identity.profile(), prepared.image.clone());
    let mut document = Document::new(Timestamp::now().to_string(), Body::Hiperdrive(Box::new(profile)));
    document.note = Some("before-image of a write".to_owned());
    document.emit()
}
