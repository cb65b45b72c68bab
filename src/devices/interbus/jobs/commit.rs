//! What an INTERBUS encoder brings to a write.

use super::{Commit, Committed, Doing, Interbus, JobError, Prepared, Remark, Told, device_key, wear_limit};
use crate::devices::interbus::procedures::write::{Confirmed, Interrupted, Written, carry_out, confirm};
use crate::devices::interbus::procedures::{Error, Master};
use crate::devices::interbus::profile::{Image, InterbusProfile, Op, Recorded};
use crate::profile::Body;
use crate::worker::commit::{Intended, OldWrite as Write, Terms, backup_of, commit as carry_through};
use crate::worker::{Desk, Interruption, Progress, Tell};

pub(super) fn commit(
    encoder: &mut Interbus,
    desk: &mut Desk,
    commit: &Commit,
    tell: Told<'_>,
) -> Result<Committed, JobError> {
    let prepared = &commit.prepared;
    let plan = &prepared.plan;
    let store = desk.store.clone();
    let device = device_key(&prepared.identity, desk.is_virtual);
    let limit = wear_limit(plan.write_cycles());
    let terms = Terms::of(device, plan, Op::note, (prepared.cycles_seen, limit), commit.force_wear);
    let tell = std::cell::RefCell::new(tell);
    let master = encoder.master(desk, |step| (tell.borrow_mut())(Tell::Remark(Remark::Handshake(step))));
    let told = &mut |progress| (tell.borrow_mut())(Tell::Progress(progress));
    let mut write = EncoderWrite { master, commit, told };
    carry_through(&store, &terms, prepared.kind, &mut write)
}

struct EncoderWrite<'w, 'm> {
    master: Master<'m>,
    commit: &'w Commit,
    told: &'w mut dyn FnMut(Progress<Doing>),
}

impl<'w> Write for EncoderWrite<'w, '_> {
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

/// A profile of what the plan touches, as it was; the parameters stand in every profile.
fn before_image(prepared: &Prepared) -> String {
    let (base, identity) = (&prepared.plan.base, &prepared.identity);
    let mut image = Image::of(prepared.parameters);
    image.shift = base.shift;
    for (number, program) in &base.programs {
        if let Some(place) = image.program_mut(*number) {
            *place = Some(*program);
        }
    }
    let profile = InterbusProfile::of(identity.profile(), image, Recorded::default());
    backup_of(Body::new(profile)).emit()
}
