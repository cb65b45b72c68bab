//! Recorded writes to a HIPERFACE encoder.

use encoder_studio::devices::hiperface::jobs::{Change, JobError};
use encoder_studio::devices::hiperface::procedures::Error;
use encoder_studio::devices::hiperface::profile::{FieldImage, FieldRange, HiperfaceProfile};
use encoder_studio::devices::hiperface::protocol::{
    AccessCode, AccessCodeNumber, DataFieldStatus, DeviceAddress, FieldSize, LineSettings,
};

use super::{Ready, compare, listen};
use crate::support::{Desk, bytes, restore_of};

fn status(byte: u8) -> DataFieldStatus {
    DataFieldStatus::from_byte(byte)
}

/// Connects to an encoder with four data fields, one of which is write-protected and has its own access code.
fn scene() -> Desk {
    let mut desk = Desk::new("codes=2:66&position=4096");
    desk.remember_code(2, 0x66);
    for (number, byte, count) in [(1, 0xE8, 16), (2, 0xC9, 32), (3, 0xC8, 16)] {
        desk.change(Change::CreateField { number, status: status(byte) }).unwrap();
        let bytes = bytes(number, count);
        desk.change(Change::Store(vec![(FieldRange::new(number, 0, count), bytes)])).unwrap();
    }
    desk.change(Change::LockField { number: 1, lock: true }).unwrap();
    desk
}

/// Returns a profile that changes several byte ranges in three fields, one of them protected, and creates a field.
fn wanted(desk: &mut Desk) -> HiperfaceProfile {
    let mut wanted = desk.save().unwrap();
    for (field, places) in [(0, vec![2, 3, 9, 30]), (1, vec![0, 7, 15]), (2, vec![5])] {
        for place in places {
            wanted.fields[field].bytes.as_mut().unwrap()[place] ^= 0x3C;
        }
    }
    wanted.fields.push(FieldImage { number: 4, status: status(0xA8), bytes: Some(bytes(9, 16)) });
    wanted
}

fn recorded(name: &str, change: Change) {
    compare_with_recording(name, scene(), change);
}

fn compare_with_recording(name: &str, original: Desk, change: Change) {
    compare(&format!("hiperface/{name}"), None, &mut || {
        let mut desk = original.copied();
        desk.remember_code(2, 0x66);
        let prepared = desk.prepare(change.clone()).unwrap();
        let (lines, cancel) = listen(&mut desk.session);
        let tap = desk.tap.clone();
        let carry_out = Box::new(move || match desk.commit(&prepared) {
            Ok(done) => format!("done, {} operations, {} cycles", done.written.ops, done.written.write_cycles),
            Err(JobError::Interrupted { interrupted, .. }) => format!(
                "{} after {} operations, {} cycles, unlocked {:?}",
                if interrupted.cause == Error::Cancelled { "cancelled" } else { "cut off" },
                interrupted.done.ops,
                interrupted.done.write_cycles,
                interrupted.end_state.unlocked,
            ),
            Err(JobError::Device(Error::Cancelled)) => "cancelled, nothing written".to_owned(),
            Err(JobError::Device(error)) if error.is_lost() => "cut off, nothing written".to_owned(),
            Err(other) => panic!("{other:?}"),
        });
        Ready { tap, cancel, lines, carry_out }
    });
}

#[test]
fn restore_matches_recording() {
    let wanted = wanted(&mut scene());
    recorded("restore", restore_of(&wanted));
}

#[test]
fn data_field_writes_match_recording() {
    recorded(
        "store",
        Change::Store(vec![(FieldRange::new(2, 30, 2), vec![1, 2]), (FieldRange::new(3, 0, 1), vec![3])]),
    );
    recorded("create-field", Change::CreateField { number: 4, status: status(0xC9) });
    recorded("redefine-field", Change::Redefine { number: 2, status: status(0xE9) });
    recorded("unlock-field", Change::LockField { number: 1, lock: false });
    recorded("lock-field", Change::LockField { number: 2, lock: true });
    recorded("resize-field", Change::ResizeField { number: 3, size: FieldSize::from_bytes(64).unwrap() });
    recorded("delete-field", Change::DeleteField { number: 3 });
}

#[test]
fn other_writes_match_recording() {
    let number = AccessCodeNumber::new(2).unwrap();
    recorded("change-code", Change::ChangeCode { number, new: AccessCode::new(0x77) });
    recorded("set-position", Change::SetPosition { wanted: 77, exact: false, synchronise: false, kit: false });
    recorded("set-position-exactly", Change::SetPosition { wanted: 77, exact: true, synchronise: false, kit: false });
    let synchronise = Change::SetPosition { wanted: 4096, exact: true, synchronise: true, kit: true };
    compare_with_recording("synchronise", Desk::new("model=sel37"), synchronise);
    recorded("shift-position", Change::ShiftPosition { steps: -9 });
    recorded("set-address", Change::SetAddress(DeviceAddress::new(0x45).unwrap()));
    recorded("increment-counter", Change::IncrementCounter);
    let mut counted = scene();
    counted.change(Change::IncrementCounter).unwrap();
    compare_with_recording("clear-counter", counted, Change::ClearCounter);
    recorded("configure", Change::Configure(LineSettings::from_byte(0xE5)));
}
