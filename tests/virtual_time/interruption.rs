//! A restore that is cancelled, cut off, or interrupted by a power loss at each transaction. The report matches the
//! content of the encoder, nothing else has changed, and a second run completes the restore.

use encoder_studio::devices::hiperface::jobs::{Change, Committed, JobError, Prepared};
use encoder_studio::devices::hiperface::procedures::Error;
use encoder_studio::devices::hiperface::procedures::write::InterruptedWrite;
use encoder_studio::devices::hiperface::profile::{FieldImage, FieldRange, HiperfaceProfile, Op};
use encoder_studio::devices::hiperface::protocol::{DataFieldStatus, StatusCode};
use encoder_studio::link::CancelToken;

use crate::support::{Desk, Fields, backup, bytes, restore_of};

/// Returns an encoder with a write-protected field guarded by its own code, and the profile to restore. The profile
/// changes several byte ranges in three fields, one of them protected, and creates a field that is to be protected.
fn scene() -> (Desk, HiperfaceProfile) {
    let mut desk = Desk::new("codes=2:66");
    desk.remember_code(2, 0x66);
    let status = DataFieldStatus::from_byte;
    for (number, byte, count) in [(1, 0xE8, 16), (2, 0xC9, 32), (3, 0xC8, 16)] {
        desk.change(Change::CreateField { number, status: status(byte) }).unwrap();
        let bytes = bytes(number, count);
        desk.change(Change::Store(vec![(FieldRange::new(number, 0, count), bytes)])).unwrap();
    }
    desk.change(Change::LockField { number: 1, lock: true }).unwrap();
    let mut wanted = desk.save().unwrap();
    for (field, places) in [(0, vec![2, 3, 9, 30]), (1, vec![0, 7, 15]), (2, vec![5])] {
        for place in places {
            wanted.fields[field].bytes.as_mut().unwrap()[place] ^= 0x3C;
        }
    }
    wanted.fields.push(FieldImage { number: 4, status: status(0xA8), bytes: Some(bytes(9, 16)) });
    (desk, wanted)
}

/// Returns the memory after the first operations of the plan.
fn applied(before: &Fields, ops: &[Op]) -> Fields {
    let mut fields = before.clone();
    for op in ops {
        match op {
            Op::Define { field, to, .. } => match fields.get_mut(usize::from(*field)) {
                Some(entry) => entry.0 = to.byte(),
                // The encoder has never written these bytes.
                None => fields.push((to.byte(), vec![0xFF; to.size().bytes()])),
            },
            Op::Store { field, address, new, .. } => {
                let start = usize::from(*address);
                fields[usize::from(*field)].1[start..start + new.len()].copy_from_slice(new);
            }
            other => panic!("{other:?} in a restore"),
        }
    }
    fields
}

fn with_protected_fields(mut fields: Fields) -> Fields {
    // Fields 1 and 4 are protected. Field 4 may not exist yet.
    for (number, status) in [(1, 0xA8), (4, 0xA8)] {
        if let Some(field) = fields.get_mut(number) {
            field.0 = status;
        }
    }
    fields
}

fn profile_fields(profile: &HiperfaceProfile) -> Fields {
    profile.fields.iter().map(|field| (field.status.byte(), field.bytes.clone().unwrap())).collect()
}

#[test]
fn plan_is_shortest_possible() {
    let (mut desk, wanted) = scene();
    let prepared = desk.prepare(restore_of(&wanted)).unwrap();
    let items: Vec<String> = prepared.plan.ops.iter().map(|op| op.plan_item().to_string()).collect();
    let expected = [
        "field:0@2+2",
        "field:0@9+1",
        "field:0@30+1", // three runs
        "status:1",
        "field:1@0+1",
        "field:1@7+1",
        "field:1@15+1",
        "status:1", // unlock, write, lock
        "field:2@5+1",
        "status:4",
        "field:4@0+16",
        "status:4", // create, write, lock
    ];
    assert_eq!(items, expected);
    assert_eq!(prepared.plan.write_cycles(), 12);
}

/// The result of a commit, with the memory before and after.
struct Ending<'a> {
    desk: &'a Desk,
    prepared: &'a Prepared,
    before: &'a Fields,
    worn_before: u64,
    context: String,
}

impl Ending<'_> {
    /// Checks the result of a cancellation: exactly the counted operations were executed, and the protected fields are
    /// locked.
    fn assert_cancelled_cleanly(&self, interrupted: &InterruptedWrite) {
        let Ending { context, .. } = self;
        assert_eq!(interrupted.cause, Error::Cancelled, "{context}");
        assert_eq!(interrupted.end_state.unlocked, Vec::<u8>::new(), "{context}");
        let done = applied(self.before, &self.prepared.plan.ops[..interrupted.done.ops]);
        assert_eq!(self.desk.memory(), with_protected_fields(done), "{context}");
        assert_eq!(interrupted.done.write_cycles, self.desk.wear() - self.worn_before, "{context}");
    }

    /// Checks the result of a lost connection: the counted operations were executed, and the one in progress either was
    /// or was not. A field that stays unlocked must be named.
    fn assert_interruption_reported(&self, interrupted: &InterruptedWrite) {
        let Ending { context, .. } = self;
        let ops = &self.prepared.plan.ops;
        let count = interrupted.done.ops;
        let in_flight = ops.get(count);
        let memory = self.desk.memory();
        let without = applied(self.before, &ops[..count]);
        let with = applied(self.before, &ops[..ops.len().min(count + 1)]);
        assert!(memory == without || memory == with, "{context}: {interrupted:?}\n{memory:02X?}\n{without:02X?}");
        assert!(interrupted.cause.is_lost(), "{context}: {interrupted:?}");
        for field in [1, 4] {
            let open = memory.get(usize::from(field)).is_some_and(|(status, _)| status & 0x40 != 0);
            let told = interrupted.end_state.unlocked.contains(&field);
            let changes_it = |op: &Op| op.field() == Some(field) && (op.removes_protection() || op.locks_field(field));
            let unclear = in_flight.is_some_and(changes_it);
            assert!(open == told || told && unclear, "{context}: field {field} open {open}, told {told}");
        }
        assert!(
            interrupted.end_state.unlocked.iter().all(|field| [1, 4].contains(field)),
            "{context}: {interrupted:?}"
        );
        let spent = self.desk.wear() - self.worn_before;
        let reported = interrupted.done.write_cycles;
        assert!(reported == spent || reported == spent + 1, "{context}: {reported} told, {spent} spent");
    }
}

/// Checks that the profile can be restored from any state and that the backup restores the previous content.
fn assert_restorable(desk: &Desk, wanted: &HiperfaceProfile, before: &Fields, kept: Option<&HiperfaceProfile>) {
    let mut forwards = desk.copied();
    forwards.remember_code(2, 0x66);
    forwards.restore(wanted).unwrap();
    assert_eq!(forwards.memory(), profile_fields(wanted));
    assert_eq!(forwards.prepare(restore_of(wanted)).unwrap().plan.ops, [], "a third run has nothing to do");
    let Some(kept) = kept else { return };
    let mut backwards = desk.copied();
    backwards.remember_code(2, 0x66);
    backwards.restore(kept).unwrap();
    // A field that was created remains, because a restore never deletes fields.
    assert_eq!(backwards.memory()[..before.len()], before[..]);
}

/// Executes the restore on a new copy of the scene. `disturb` is called when the plan is complete.
fn disturbed(
    scene: &(Desk, HiperfaceProfile),
    context: String,
    disturb: impl FnOnce(&mut Desk),
    judge: impl FnOnce(&Ending<'_>, &InterruptedWrite),
) -> bool {
    let (original, wanted) = scene;
    let mut desk = original.copied();
    desk.remember_code(2, 0x66);
    let (before, worn_before) = (desk.memory(), desk.wear());
    let prepared = desk.prepare(restore_of(wanted)).unwrap();
    disturb(&mut desk);
    let result = desk.commit(&prepared);
    // The fault no longer exists.
    desk.bus().set_faults(&Default::default());
    let reconnected = desk.reconnected();
    match result {
        Ok(Committed { written, .. }) => {
            assert_eq!(desk.memory(), profile_fields(wanted), "{context}");
            assert_eq!((written.ops, written.write_cycles), (12, 12), "{context}");
            assert_eq!(desk.wear() - worn_before, 12, "{context}");
            return true;
        }
        Err(JobError::Interrupted { interrupted, backup: path, planned: 12, .. }) => {
            judge(&Ending { desk: &desk, prepared: &prepared, before: &before, worn_before, context }, &interrupted);
            let kept = backup(&path);
            assert_restorable(&reconnected, wanted, &before, Some(&kept));
        }
        Err(JobError::Device(error)) => {
            assert!(error == Error::Cancelled || error.is_lost(), "{context}: {error}");
            assert_eq!(desk.memory(), before, "{context}");
            assert_eq!(desk.wear(), worn_before, "{context}");
            assert_restorable(&reconnected, wanted, &before, None);
        }
        Err(error) => panic!("{context}: {error:?}"),
    }
    false
}

#[test]
fn cancelling_ends_cleanly() {
    let scene = scene();
    let mut steps = 0;
    while !disturbed(
        &scene,
        format!("cancelled after {steps}"),
        |desk| desk.session.set_cancel(CancelToken::after_transactions(steps)),
        |ending, told| ending.assert_cancelled_cleanly(told),
    ) {
        steps += 1;
    }
    assert!(steps > 12, "each operation is a transaction at least: {steps}");
}

/// A reply to a write announces a waiting status code, but the write was executed nevertheless.
#[test]
fn cancelling_with_warnings_ends_cleanly() {
    let scene = scene();
    for code in [StatusCode::TEMPERATURE, StatusCode::COUNTER_OVERFLOW] {
        for steps in 0.. {
            let warn = |desk: &mut Desk| {
                desk.session.set_cancel(CancelToken::after_transactions(steps));
                for _ in 0..4 {
                    desk.bus().encoder_mut(0).unwrap().queue_code(code);
                }
            };
            let context = format!("warning, cancelled after {steps}");
            if disturbed(&scene, context, warn, |ending, told| ending.assert_cancelled_cleanly(told)) {
                break;
            }
        }
    }
}

/// The user cancels right after the reply that announces a warning. The write still counts as executed.
#[test]
fn warning_does_not_hide_executed_write() {
    let (original, wanted) = scene();
    for store in 1..=7 {
        for steps in 0..40 {
            let mut desk = original.copied();
            desk.remember_code(2, 0x66);
            let (before, worn_before) = (desk.memory(), desk.wear());
            let prepared = desk.prepare(restore_of(&wanted)).unwrap();
            desk.session.set_cancel(CancelToken::after_transactions(steps));
            let (bus, mut stores) = (desk.bus.clone(), 0);
            let mut raised = false;
            // The trace receives a request before it is sent.
            desk.session.add_watcher(move |entry| {
                stores += usize::from(entry.bytes.to_string().starts_with("40 4B"));
                if stores == store && !raised {
                    raised = true;
                    bus.lock().unwrap().encoder_mut(0).unwrap().queue_code(StatusCode::TEMPERATURE);
                }
            });
            if let Err(JobError::Interrupted { interrupted, .. }) = desk.commit(&prepared) {
                let context = format!("store {store}, cancelled after {steps}");
                let ending = Ending { desk: &desk, prepared: &prepared, before: &before, worn_before, context };
                ending.assert_cancelled_cleanly(&interrupted);
            }
        }
    }
}

#[test]
fn reports_cut_at_any_transaction() {
    let scene = scene();
    type Cut = fn(&mut Desk, usize);
    let cuts: [(&str, Cut); 4] = [
        ("lost", |desk, at| desk.tap().lost_from = Some(at)),
        ("deaf", |desk, at| desk.tap().deaf_from = Some(at)),
        ("mute", |desk, at| desk.tap().mute_from = Some(at)),
        ("silent", |desk, at| {
            // The setup has already used some frames, and the fault counts all of them.
            let already = received_frame_count(&desk.bus().clone());
            desk.bus().set_faults(&format!("silent-after:{}", already + at).parse().unwrap());
        }),
    ];
    for (name, cut) in cuts {
        for at in 0.. {
            let disturb = |desk: &mut Desk| {
                let sent = desk.tap().sent.len();
                cut(desk, if name == "silent" { at } else { sent + at });
            };
            if disturbed(&scene, format!("{name} after {at}"), disturb, |ending, told| {
                ending.assert_interruption_reported(told)
            }) {
                assert!(at > 20, "{name}: the read-back counts as well: {at}");
                break;
            }
        }
    }
}

/// Returns the number of frames that an encoder has received: the lowest number for which the fault "silent after this
/// number of frames" has occurred.
fn received_frame_count(bus: &encoder_studio::devices::hiperface::sim::Bus) -> usize {
    let is_silent = |frames: usize| {
        let mut probe = bus.clone();
        probe.set_faults(&format!("silent-after:{frames}").parse().unwrap());
        probe.encoders()[0].active_settings_at(encoder_studio::units::Moment::START).is_none()
    };
    (0..).take_while(|frames| is_silent(*frames)).count().saturating_sub(1)
}

#[test]
fn reports_power_loss_in_any_store() {
    let (original, wanted) = scene();
    // Field 0 takes three stores, field 1 three, field 2 one and field 4 one.
    for store in 1..=8 {
        let mut desk = original.copied();
        desk.remember_code(2, 0x66);
        let before = desk.memory();
        let prepared = desk.prepare(restore_of(&wanted)).unwrap();
        let stores = desk.bus().encoders()[0]
            .wear()
            .write_count(encoder_studio::devices::hiperface::protocol::Command::StoreData);
        desk.bus().set_faults(&format!("die-in-store:{}", stores + store).parse().unwrap());
        let error = desk.commit(&prepared).unwrap_err();
        let JobError::Interrupted { interrupted, backup: path, planned: 12, .. } = error else { panic!("{error:?}") };
        assert!(interrupted.cause.is_lost(), "store {store}: {interrupted:?}");
        // Three stores go into field 1, between unlocking and locking. One goes into field 4, which is created but not
        // yet locked.
        let expected = match store {
            4..=6 => vec![1],
            8 => vec![4],
            _ => vec![],
        };
        assert_eq!(interrupted.end_state.unlocked, expected, "store {store}");
        let reconnected = desk.reconnected();
        assert_restorable(&reconnected, &wanted, &before, Some(&backup(&path)));
    }
    let mut desk = original.copied();
    desk.remember_code(2, 0x66);
    let stores =
        desk.bus().encoders()[0].wear().write_count(encoder_studio::devices::hiperface::protocol::Command::StoreData);
    desk.bus().set_faults(&format!("die-in-store:{}", stores + 9).parse().unwrap());
    desk.restore(&wanted).unwrap();
}
