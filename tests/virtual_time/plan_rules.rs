//! The rules for writing: only planned changes and only differing values are written, and only if the encoder still has
//! the content for which the plan was made.

use encoder_studio::devices::hiperface::jobs::{Change, Commit, HiperfaceJob, JobError};
use encoder_studio::devices::hiperface::procedures::Error;
use encoder_studio::devices::hiperface::profile::{FieldRange, Op, PlanError};
use encoder_studio::devices::hiperface::protocol::{Command, DataFieldStatus, DeviceAddress, LineSettings};
use encoder_studio::profile::Consent;

use crate::support::{Desk, bytes, restore_of};

fn store(field: u8, start: usize, bytes: Vec<u8>) -> Change {
    Change::Store(vec![(FieldRange::new(field, start, bytes.len()), bytes)])
}

#[test]
fn does_not_overwrite_changed_base() {
    let create = Change::CreateField { number: 1, status: DataFieldStatus::from_byte(0xC8) };
    let set = Change::SetPosition { wanted: 0, exact: true, synchronise: false, kit: false };
    let cases: [(Change, Change, &str); 7] = [
        (store(0, 0, vec![1, 2]), store(0, 20, vec![9]), "field:0"),
        (store(0, 0, vec![1, 2]), Change::LockField { number: 0, lock: true }, "field:0"),
        (store(0, 0, vec![1, 2]), create.clone(), "number of data fields"),
        (create.clone(), create, "number of data fields"),
        (Change::IncrementCounter, Change::IncrementCounter, "counter"),
        (
            Change::Configure(LineSettings::from_byte(0xE5)),
            Change::Configure(LineSettings::from_byte(0xE6)),
            "settings",
        ),
        (set, Change::SetPosition { wanted: 500, exact: true, synchronise: false, kit: false }, ""),
    ];
    for (wanted, meanwhile, item) in cases {
        let mut desk = Desk::new("");
        let prepared = desk.prepare(wanted).unwrap();
        desk.change(meanwhile).unwrap();
        let (memory, worn) = (desk.memory(), desk.wear());
        match desk.commit(&prepared) {
            Err(JobError::Device(Error::Changed { item: named })) => assert_eq!(named.to_string(), item),
            Err(JobError::Device(Error::Moving { .. })) => assert_eq!(item, ""),
            other => panic!("{item}: {other:?}"),
        }
        assert_eq!((desk.memory(), desk.wear()), (memory, worn), "{item}");
    }
}

/// Two new encoders have the same memory and differ only in their serial numbers.
#[test]
fn plan_applies_to_one_encoder() {
    let mut desk = Desk::new("serial=A1");
    let prepared = desk.prepare(store(0, 0, vec![1, 2])).unwrap();
    *desk.bus() = crate::support::bus("serial=B2");
    match desk.commit(&prepared) {
        Err(JobError::Device(Error::Changed { item })) => assert_eq!(item.to_string(), "the encoder itself"),
        other => panic!("{other:?}"),
    }
    assert_eq!(desk.wear(), 0);
}

#[test]
fn consent_to_different_plan_writes_nothing() {
    let mut desk = Desk::new("");
    let shown = desk.prepare(store(0, 0, vec![1])).unwrap();
    let other = desk.prepare(store(0, 0, vec![2])).unwrap();
    let sent = desk.tap().sent.len();
    let commit = Commit { prepared: other, consent: Consent::to(shown.plan.id()), force_wear: false, undoes: None };
    desk.run(HiperfaceJob::Commit(Box::new(commit))).unwrap_err();
    assert_eq!(desk.tap().sent.len(), sent, "not even asked");
    assert_eq!(desk.wear(), 0);
}

#[test]
fn empty_plan_sends_nothing() {
    let mut desk = Desk::new("");
    let profile = desk.save().unwrap();
    let name_plate = desk.memory()[0].1.clone();
    let nothing = [
        restore_of(&profile),
        store(0, 4, name_plate[4..9].to_vec()),
        Change::LockField { number: 0, lock: false },
        Change::SetAddress(DeviceAddress::FACTORY),
        Change::Configure(LineSettings::FACTORY),
        Change::ClearCounter,
    ];
    for change in nothing {
        let prepared = desk.prepare(change).unwrap();
        assert!(prepared.plan.is_empty());
        let sent = desk.tap().sent.len();
        let done = desk.commit(&prepared).unwrap();
        assert_eq!((done.written.ops, done.backup), (0, None));
        assert_eq!(desk.tap().sent.len(), sent);
    }
    assert_eq!(desk.wear(), 0);
    assert!(!desk.folder.path().join("data/backups").exists(), "no backup");
}

/// Every byte written by request 4Bh differs from the byte it replaces, and only planned addresses are written.
#[test]
fn writes_and_counts_only_differences() {
    for seed in 0..20_u8 {
        let mut desk = Desk::new("");
        desk.change(Change::CreateField { number: 1, status: DataFieldStatus::from_byte(0xCF) }).unwrap();
        desk.change(store(1, 0, bytes(seed, 128))).unwrap();
        let mut wanted = desk.save().unwrap();
        for field in &mut wanted.fields {
            for (at, byte) in field.bytes.as_mut().unwrap().iter_mut().enumerate() {
                if (at * usize::from(seed + 1)) % 7 < 2 {
                    *byte = byte.wrapping_add(seed + 1);
                }
            }
        }
        let (before, worn) = (desk.memory(), desk.wear());
        let prepared = desk.prepare(restore_of(&wanted)).unwrap();
        desk.tap().sent.clear();
        let done = desk.commit(&prepared).unwrap();
        assert_eq!(done.written.write_cycles, prepared.plan.write_cycles());
        assert_eq!(desk.wear() - worn, done.written.write_cycles);
        let mut differing = 0;
        let tap = desk.tap();
        for frame in tap.sent.iter().filter(|frame| frame[1] == 0x4B) {
            let (field, start, count) = (usize::from(frame[2]), usize::from(frame[3]), usize::from(frame[4]));
            let stored = &frame[6..6 + count];
            for (at, byte) in stored.iter().enumerate() {
                assert_ne!(*byte, before[field].1[start + at], "seed {seed}, field {field}, byte {}", start + at);
                differing += 1;
            }
        }
        assert_eq!(tap.count(Command::StoreData) as u64, done.written.write_cycles);
        assert_eq!(done.written.written, differing);
        drop(tap);
        for (field, (_, bytes)) in wanted.fields.iter().zip(desk.memory()) {
            assert_eq!(field.bytes.as_ref(), Some(&bytes));
        }
    }
}

#[test]
fn rejects_other_encoder_before_reading_fields() {
    let mut other = Desk::new("serial=ZZ1");
    let profile = other.save().unwrap();
    let mut desk = Desk::new("");
    let error = desk.prepare(restore_of(&profile)).unwrap_err();
    assert!(matches!(error, JobError::Plan(PlanError::OtherDevice { .. })), "{error:?}");
    assert_eq!(desk.tap().count(Command::ReadData), 0);
}

#[test]
fn rejects_protected_and_out_of_range_writes() {
    let mut desk = Desk::new("");
    desk.change(Change::LockField { number: 0, lock: true }).unwrap();
    let size = encoder_studio::devices::hiperface::protocol::FieldSize::from_bytes(16).unwrap();
    let refused = [
        store(0, 0, vec![0]),
        store(0, 31, vec![0, 0]),
        store(1, 0, vec![0]),
        Change::CreateField { number: 2, status: DataFieldStatus::from_byte(0xC8) },
        Change::DeleteField { number: 1 },
        Change::ResizeField { number: 1, size },
        Change::SetPosition { wanted: 1 << 24, exact: true, synchronise: false, kit: false },
        Change::SetPosition { wanted: 0, exact: true, synchronise: true, kit: false },
    ];
    let worn = desk.wear();
    for change in refused {
        let words = format!("{change:?}");
        assert!(desk.prepare(change).is_err(), "{words}");
    }
    assert_eq!(desk.wear(), worn);
    let ops = desk.prepare(Change::DeleteField { number: 0 }).unwrap().plan.ops;
    assert!(matches!(ops[..], [Op::Define { field: 0, to, .. }] if !to.exists()));
}

/// Edits to several fields result in one plan and one backup. Each field is read once, and only differing bytes are
/// sent.
#[test]
fn one_plan_writes_several_edits() {
    let mut desk = Desk::new("");
    desk.change(Change::CreateField { number: 1, status: DataFieldStatus::from_byte(0xE8) }).unwrap();
    let before = desk.memory();
    let (there, worn) = (before[0].1[28], desk.wear());
    let other = |at: usize| !before[0].1[at];
    let edits = vec![
        (FieldRange::new(1, 3, 1), vec![0x33]),
        (FieldRange::new(0, 28, 1), vec![there]),
        (FieldRange::new(0, 21, 1), vec![other(21)]),
        (FieldRange::new(0, 20, 1), vec![other(20)]),
        (FieldRange::new(0, 2, 1), vec![other(2)]),
    ];
    let reads = desk.tap().count(Command::ReadData);
    let prepared = desk.prepare(Change::Store(edits)).unwrap();
    assert_eq!(desk.tap().count(Command::ReadData) - reads, 2, "each field once");
    let ops: Vec<String> = prepared.plan.ops.iter().map(|op| op.plan_item().to_string()).collect();
    assert_eq!(ops, ["field:0@2+1", "field:0@20+2", "field:1@3+1"]);
    assert_eq!(prepared.plan.base.fields.iter().map(|field| field.number).collect::<Vec<_>>(), [0, 1]);
    desk.commit(&prepared).unwrap();
    let mut expected = before.clone();
    for at in [2, 20, 21] {
        expected[0].1[at] = other(at);
    }
    expected[1].1[3] = 0x33;
    assert_eq!(desk.memory(), expected);
    assert_eq!(desk.wear() - worn, 3);
    match desk.prepare(Change::Store(vec![(FieldRange::new(0, 0, 1), vec![1]), (FieldRange::new(7, 0, 1), vec![1])])) {
        Err(JobError::Plan(PlanError::NoSuchField { field: 7, count: 2 })) => {}
        other => panic!("{other:?}"),
    }
}
