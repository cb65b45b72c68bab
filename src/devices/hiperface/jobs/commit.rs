//! What a HIPERFACE encoder brings to a write.

use super::{Commit, Committed, Doing, Hiperface, JobError, Prepared, WEAR_LIMIT};
use crate::devices::hiperface::procedures::write::{Confirmed, Interrupted, Written, carry_out, confirm};
use crate::devices::hiperface::procedures::{Error, Identity, Master, profile_of};
use crate::devices::hiperface::profile::{Op, Recorded, Scalar, created_by};
use crate::devices::hiperface::protocol::KIND;
use crate::profile::Body;
use crate::store::DeviceKey;
use crate::worker::commit::{Intended, Terms, Write, backup_of, commit as carry_through};
use crate::worker::{Desk, Interruption, Progress};

pub(super) fn commit(
    encoder: &mut Hiperface,
    desk: &mut Desk,
    commit: &Commit,
    tell: &mut dyn FnMut(Progress<Doing>),
) -> Result<Committed, JobError> {
    let prepared = &commit.prepared;
    let plan = &prepared.plan;
    let store = desk.store.clone();
    let device = device_key(&prepared.identity, desk.is_virtual);
    let terms = Terms::of(device, plan, Op::item, (prepared.cycles_seen, WEAR_LIMIT), commit.force_wear);
    let mut write = EncoderWrite { master: encoder.master(desk), commit, tell };
    carry_through(&store, &terms, prepared.kind, &mut write)
}

/// How backups and the logbook know an encoder.
pub fn device_key(identity: &Identity, is_virtual: bool) -> DeviceKey {
    DeviceKey {
        kind: KIND.to_owned(),
        device_type: format!("{:02X}h", identity.label.encoder_type),
        serial_number: identity.serial.serial_number.clone(),
        is_virtual,
    }
}

struct EncoderWrite<'w, 'm> {
    master: Master<'m>,
    commit: &'w Commit,
    tell: &'w mut dyn FnMut(Progress<Doing>),
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
        let progress = &mut |at: usize, op: &Op| (self.tell)(Progress::at(ops, at, Doing::Operation(op.clone())));
        carry_out(&mut self.master, confirmed, progress)
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

/// A profile of what the plan touches, as it was.
fn before_image(prepared: &Prepared) -> String {
    let base = &prepared.plan.base;
    let mut recorded = Recorded::default();
    for scalar in &base.scalars {
        match scalar {
            Scalar::Position(position) => recorded.position = Some(*position),
            Scalar::Counter(counter) => recorded.counter = Some(*counter),
            Scalar::Address(_) | Scalar::Settings(_) => {}
        }
    }
    let mut profile = profile_of(&prepared.identity, base.fields.clone(), recorded);
    profile.created = created_by(&prepared.plan);
    backup_of(Body::new(profile)).emit()
}
