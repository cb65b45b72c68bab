//! What a BiSS encoder brings to a write.

use super::{Attendance, Biss, Commit, Committed, Doing, JobError, Prepared, WEAR_LIMIT, device_key};
use crate::devices::biss::procedures::procedure::{Failure, News};
use crate::devices::biss::procedures::write::{Confirmed, Interrupted, Left, Written, carry_out, confirm};
use crate::devices::biss::procedures::{Error, Master};
use crate::devices::biss::profile::{BissProfile, DataImage, Op, PresetSetting, Recorded};
use crate::profile::{Body, Unknown};
use crate::worker::commit::{Intended, OldWrite as Write, Terms, backup_of, commit as carry_through};
use crate::worker::{Desk, Interruption, Progress};

pub(super) fn commit(
    encoder: &mut Biss,
    desk: &mut Desk,
    commit: &Commit,
    tell: &mut dyn FnMut(Progress<Doing>),
) -> Result<Committed, JobError> {
    let prepared = &commit.prepared;
    let plan = &prepared.plan;
    let store = desk.store.clone();
    let device = device_key(&prepared.identity, desk.is_virtual);
    let note = |op: &Op| op.note(&prepared.identity.description);
    let terms = Terms::of(device, plan, note, (prepared.cycles_seen, WEAR_LIMIT), commit.force_wear);
    encoder.know(desk)?;
    let attendance = commit.attendance.clone();
    let mut write = EncoderWrite { master: encoder.master(desk), commit, attendance, tell };
    let ended = carry_through(&store, &terms, prepared.kind, &mut write);
    match &ended {
        Ok(_) => encoder.station.unfinished = false,
        Err(JobError::Interrupted { interrupted, .. }) => {
            encoder.station.unfinished = interrupted.left != Left::Operation;
        }
        Err(_) => {}
    }
    ended
}

struct EncoderWrite<'w, 'm> {
    master: Master<'m>,
    commit: &'w Commit,
    attendance: Attendance,
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
        let told = &mut |news: News| {
            let item = ops.get(news.op).map(Op::item).unwrap_or_default();
            let at = news.op;
            (self.tell)(Progress::at(ops, at, Doing::Operation { item, news: Box::new(news) }));
        };
        carry_out(&mut self.master, confirmed, &mut self.attendance, told)
    }

    fn write_cycles(written: &Written) -> u64 {
        written.write_cycles
    }
}

impl Interruption for Interrupted {
    type Error = Error;

    fn error(&self) -> Option<&Error> {
        match &self.cause {
            Failure::Device(error) => Some(error),
            _ => None,
        }
    }

    fn why(&self) -> Option<String> {
        (!self.cause.is_cancelled()).then(|| self.cause.to_string())
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
    let description = &prepared.identity.description;
    let touched = description.areas().iter().map(|area| {
        let banks = base.banks.iter().filter(|bank| area.contains(bank.number)).copied();
        DataImage::of(area, banks.collect())
    });
    let mut profile = BissProfile {
        identity: prepared.identity.profile(),
        filter: base.filter,
        preset: base.preset.map(|value| PresetSetting { value, unknown: Unknown::new() }),
        recorded: Recorded::default(),
        mounting: Vec::new(),
        data: touched.filter(|image| image.all().next().is_some()).collect(),
    };
    profile.mark_mounting();
    let mut document = backup_of(Body::new(profile));
    let note = document.note.get_or_insert_default();
    for (address, value) in &base.registers {
        // A profile has no place for them.
        note.push_str(&format!("; {address} was 0x{value:02X}"));
    }
    document.emit()
}
