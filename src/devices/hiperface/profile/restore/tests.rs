//! Tests of restore plans.

use super::super::{Interface, MountingMark, Op, ProfileIdentity, RecordedValues};
use super::*;
use crate::devices::hiperface::protocol::{DataFieldStatus, LineSettings};

fn field(number: u8, status: u8, bytes: &[(usize, u8)]) -> FieldImage {
    let status = DataFieldStatus::from_byte(status);
    let mut content = vec![0; status.size().bytes()];
    for (at, byte) in bytes {
        content[*at] = *byte;
    }
    FieldImage { number, status, bytes: Some(content) }
}

fn locked(number: u8, status: u8) -> FieldImage {
    FieldImage { number, status: DataFieldStatus::from_byte(status), bytes: None }
}

fn profile(serial_number: &str, fields: Vec<FieldImage>) -> HiperfaceProfile {
    HiperfaceProfile {
        identity: ProfileIdentity {
            serial_number: serial_number.to_owned(),
            encoder_type: 0x37,
            encoder_name: String::new(),
            firmware_version: String::new(),
            firmware_date: String::new(),
            eeprom_bytes: 2048,
            options: 1,
            extended_label: None,
            unknown: Default::default(),
        },
        interface: Interface { address: 0x40, settings: LineSettings::FACTORY, unknown: Default::default() },
        recorded: RecordedValues::default(),
        mounting: Vec::new(),
        fields,
        created: Vec::new(),
        unknown_in_fields: Vec::new(),
    }
}

fn device(free_blocks: u8, fields: Vec<FieldImage>) -> DeviceState {
    DeviceState {
        serial_number: "A".to_owned(),
        encoder_type: 0x37,
        memory: FreeMemory { blocks: free_blocks, fields: fields.len() as u8 },
        fields,
    }
}

/// Returns the operations in a short notation: `C9>A9` changes a field's status, and `@3+2` writes two bytes from index
/// 3.
fn ops(profile: &HiperfaceProfile, device: &DeviceState, options: RestoreOptions) -> Result<Vec<String>, PlanError> {
    let restore = plan_restore(profile, device, options)?.common;
    let short = |op: &Op| match op {
        Op::Define { field, from: None, to } => format!("{field}:new {:02X}", to.byte()),
        Op::Define { field, from: Some(from), to } => format!("{field}:{:02X}>{:02X}", from.byte(), to.byte()),
        Op::Store { field, address, new, .. } => format!("{field}@{address}+{}", new.len()),
        other => format!("{other:?}"),
    };
    Ok(restore.plan.ops.iter().map(short).collect())
}

#[test]
fn plans_each_restore_case() {
    type Case = (&'static str, Vec<FieldImage>, Vec<FieldImage>, &'static [&'static str]);
    let cases: [Case; 11] = [
        ("nothing differs", vec![field(0, 0xC9, &[])], vec![field(0, 0xC9, &[])], &[]),
        (
            "only differing runs are written",
            vec![field(0, 0xC9, &[(3, 1), (4, 2), (9, 1)])],
            vec![field(0, 0xC9, &[])],
            &["0@3+2", "0@9+1"],
        ),
        (
            "a protected field is unlocked, written and locked",
            vec![field(0, 0x88, &[(0, 1)])],
            vec![field(0, 0x88, &[])],
            &["0:88>C8", "0@0+1", "0:C8>88"],
        ),
        (
            "a field that becomes protected is written first",
            vec![field(0, 0x88, &[(0, 1)])],
            vec![field(0, 0xC8, &[])],
            &["0@0+1", "0:C8>88"],
        ),
        (
            "a field that becomes writable is written afterwards",
            vec![field(0, 0xC8, &[(0, 1)])],
            vec![field(0, 0x88, &[])],
            &["0:88>C8", "0@0+1"],
        ),
        ("only the protection differs", vec![field(0, 0x88, &[])], vec![field(0, 0xC8, &[])], &["0:C8>88"]),
        (
            "the last field grows: its new part is written whole",
            vec![field(0, 0xC9, &[(1, 7)])],
            vec![field(0, 0xC8, &[])],
            &["0:C8>C9", "0@1+1", "0@16+16"],
        ),
        ("the last field shrinks", vec![field(0, 0xC8, &[(1, 7)])], vec![field(0, 0xC9, &[])], &["0@1+1", "0:C9>C8"]),
        (
            "missing fields are created, surplus ones left",
            vec![field(0, 0xC8, &[]), field(1, 0xA8, &[])],
            vec![field(0, 0xC8, &[])],
            &["1:new E8", "1@0+16", "1:E8>A8"],
        ),
        ("a locked field is left alone", vec![locked(0, 0xE8)], vec![field(0, 0xC8, &[])], &[]),
        ("an unreadable field is left alone", vec![field(0, 0xE8, &[(0, 1)])], vec![locked(0, 0xE8)], &[]),
    ];
    for (label, wanted, now, expected) in cases {
        let got = ops(&profile("A", wanted), &device(100, now), RestoreOptions::default());
        assert_eq!(got.unwrap(), expected, "{label}");
    }
}

#[test]
fn recreating_fields_needs_consent() {
    let wanted = profile("A", vec![field(0, 0xC9, &[(0, 1)]), field(1, 0xC8, &[])]);
    let now = device(1, vec![field(0, 0xC8, &[]), field(1, 0xC8, &[]), field(2, 0x88, &[(0, 9)])]);
    let error = ops(&wanted, &now, RestoreOptions::default()).unwrap_err();
    assert_eq!(error, PlanError::SizeFixed { field: 0, profile: 32, device: 16 });
    let recreate = RestoreOptions { recreate: true, ..RestoreOptions::default() };
    assert_eq!(
        ops(&wanted, &now, recreate.clone()).unwrap(),
        ["2:88>08", "1:C8>48", "0:C8>48", "0:new C9", "0@0+32", "1:new C8", "1@0+16", "2:new C8", "2@0+16", "2:C8>88"]
    );
    let unreadable = device(1, vec![field(0, 0xC8, &[]), locked(1, 0xE8)]);
    let error = ops(&wanted, &unreadable, recreate).unwrap_err();
    assert!(matches!(error, PlanError::WouldLose { field: 1, .. }));
}

#[test]
fn rejects_profiles_that_do_not_fit() {
    let now = device(1, vec![field(0, 0xC8, &[])]);
    let too_large = profile("A", vec![field(0, 0xC8, &[]), field(1, 0xC9, &[])]);
    let error = ops(&too_large, &now, RestoreOptions::default()).unwrap_err();
    assert_eq!(error, PlanError::NoMemory { needed: 32, free: 16 });
    let gap = profile("A", vec![field(2, 0xC8, &[])]);
    assert_eq!(ops(&gap, &now, RestoreOptions::default()), Err(PlanError::Gap { field: 2, missing: 1 }));
}

#[test]
fn other_encoder_keeps_mounting() {
    let mut wanted = profile("B", vec![field(0, 0xC9, &[(2, 1), (3, 1), (4, 1), (20, 1)])]);
    wanted.mounting.push(MountingMark {
        item: FieldRange::new(0, 3, 10),
        meaning: String::new(),
        unknown: Default::default(),
    });
    let now = device(10, vec![field(0, 0xC9, &[])]);
    assert!(matches!(ops(&wanted, &now, RestoreOptions::default()), Err(PlanError::OtherDevice { .. })));
    let other = RestoreOptions { allow_other_device: true, copy: [(0, true)].into(), ..RestoreOptions::default() };
    assert_eq!(ops(&wanted, &now, other.clone()).unwrap(), ["0@2+1", "0@20+1"]);
    let restore = plan_restore(&wanted, &now, other.clone()).unwrap().common;
    assert_eq!((restore.mounting_left, restore.mounting_written), (vec![FieldRange::new(0, 3, 2)], vec![]));
    // Mounting values written to another encoder are reported as well (issue 22.7).
    let with_mounting = RestoreOptions { with_mounting: true, ..other };
    assert_eq!(ops(&wanted, &now, with_mounting.clone()).unwrap(), ["0@2+3", "0@20+1"]);
    let restore = plan_restore(&wanted, &now, with_mounting).unwrap().common;
    assert_eq!((restore.mounting_left, restore.mounting_written), (vec![], vec![FieldRange::new(0, 3, 2)]));
}

/// Bytes of unknown meaning are written to another encoder only if the user has agreed for each field (issue 22.8).
#[test]
fn copies_unknown_bytes_only_on_request() {
    let mut wanted =
        profile("B", vec![field(0, 0xC8, &[(3, 1)]), field(1, 0x88, &[(0, 7)]), field(2, 0xC8, &[(1, 2)])]);
    wanted.mounting.push(MountingMark {
        item: FieldRange::new(0, 3, 1),
        meaning: String::new(),
        unknown: Default::default(),
    });
    let now = device(10, vec![field(0, 0xC8, &[]), field(1, 0xC8, &[])]);
    let options = |copy: &[(u8, bool)], with_mounting| RestoreOptions {
        allow_other_device: true,
        with_mounting,
        copy: copy.iter().copied().collect(),
        ..RestoreOptions::default()
    };
    let none = plan_restore(&wanted, &now, options(&[], false)).unwrap();
    assert_eq!(
        none.unknown_fields,
        [
            UnknownMeaningField { field: 1, bytes: 1, answer: None },
            UnknownMeaningField { field: 2, bytes: 16, answer: None }
        ],
        "of a field that is not there every byte"
    );
    assert!(none.common.plan.is_empty() && none.common.missing.is_empty(), "{none:?}");
    assert_eq!(none.common.mounting_left, [FieldRange::new(0, 3, 1)]);
    type Case<'c> = (&'c str, &'c [(u8, bool)], bool, &'c [&'c str]);
    let cases: [Case<'_>; 5] = [
        ("left by answer", &[(1, false), (2, false)], false, &[]),
        ("one is copied, with its protection", &[(1, true)], false, &["1@0+1", "1:C8>88"]),
        ("one is created", &[(2, true)], false, &["2:new C8", "2@0+16"]),
        ("the mounting is another matter", &[], true, &["0@3+1"]),
        ("all", &[(1, true), (2, true)], true, &["0@3+1", "1@0+1", "1:C8>88", "2:new C8", "2@0+16"]),
    ];
    for (label, copy, with_mounting, expected) in cases {
        assert_eq!(ops(&wanted, &now, options(copy, with_mounting)).unwrap(), expected, "{label}");
    }
    // A skipped field is created without content if another field must be created after it.
    let empty = device(10, vec![]);
    assert_eq!(
        ops(&wanted, &empty, options(&[(2, true)], false)).unwrap(),
        ["0:new C8", "1:new 88", "2:new C8", "2@0+16"]
    );
    // If a field contains mounting values that may be written, its unknown bytes and its protection remain unchanged.
    let mixed = FieldRange::new(0, 0, 2);
    let mut wanted = profile("B", vec![field(0, 0x88, &[(0, 1), (1, 2), (9, 9)])]);
    wanted.mounting.push(MountingMark { item: mixed, meaning: String::new(), unknown: Default::default() });
    let now = device(10, vec![field(0, 0xC8, &[])]);
    assert_eq!(ops(&wanted, &now, options(&[(0, false)], true)).unwrap(), ["0@0+2"]);
    assert_eq!(ops(&wanted, &now, options(&[(0, false)], false)).unwrap(), [""; 0]);
    // The encoder from which the profile was read requires no decision.
    let own = device(10, vec![field(0, 0xC8, &[])]);
    let own = DeviceState { serial_number: "B".to_owned(), ..own };
    assert_eq!(plan_restore(&wanted, &own, RestoreOptions::default()).unwrap().unknown_fields, []);
}

/// Another encoder type requires permission even if another serial number is already permitted (issue 22.9).
#[test]
fn type_change_needs_permission() {
    let mut wanted = profile("B", vec![]);
    wanted.identity.encoder_type = 0x32;
    let now = device(10, vec![]);
    let type_refused = PlanError::TypeMismatch { profile: 0x32, device: 0x37 };
    let device_refused = PlanError::OtherDevice { profile: "B".to_owned(), device: "A".to_owned() };
    let cases = [
        (false, false, Err(type_refused.clone())),
        (true, false, Err(type_refused)),
        (false, true, Err(device_refused)),
        (true, true, Ok(vec![])),
    ];
    for (allow_other_device, allow_other_type, expected) in cases {
        let options = RestoreOptions { allow_other_device, allow_other_type, ..RestoreOptions::default() };
        assert_eq!(ops(&wanted, &now, options), expected, "{allow_other_device} {allow_other_type}");
    }
    // Encoders of different types may have the same serial number, so an encoder of another type is another encoder.
    let mut wanted = profile("A", vec![field(0, 0xC8, &[(0, 1)])]);
    wanted.identity.encoder_type = 0x32;
    let options = RestoreOptions { allow_other_type: true, ..RestoreOptions::default() };
    let restore = plan_restore(&wanted, &device(10, vec![field(0, 0xC8, &[])]), options).unwrap();
    assert!(restore.common.plan.is_empty() && restore.unknown_fields.len() == 1);
}

#[test]
fn rejects_other_type_and_missing_serial() {
    let mut wanted = profile("A", vec![field(0, 0xC9, &[])]);
    wanted.identity.encoder_type = 0x22;
    let now = device(10, vec![field(0, 0xC9, &[])]);
    let other_type = PlanError::TypeMismatch { profile: 0x22, device: 0x37 };
    assert_eq!(ops(&wanted, &now, RestoreOptions::default()), Err(other_type));
    let nameless = DeviceState { serial_number: String::new(), ..now };
    let wanted = profile("", vec![field(0, 0xC9, &[])]);
    assert!(matches!(ops(&wanted, &nameless, RestoreOptions::default()), Err(PlanError::OtherDevice { .. })));
}

#[test]
fn counts_unchanged_bytes() {
    let restore = plan_restore(
        &profile("A", vec![field(0, 0xC9, &[(3, 1)])]),
        &device(10, vec![field(0, 0xC9, &[]), field(1, 0xC8, &[])]),
        RestoreOptions::default(),
    )
    .unwrap()
    .common;
    assert_eq!(restore.unchanged, 1 + 31);
    assert_eq!(restore.missing, [FieldRange::whole_field(1)]);
    assert_eq!(restore.plan.write_cycles(), 1);
}

/// Restoring a backup deletes unchanged fields that the write created, starting with the last one. Other profiles never
/// delete surplus fields (issue 22.12).
#[test]
fn restore_deletes_created_fields() {
    let wanted = profile("A", vec![field(0, 0xC9, &[(0, 1)]), field(1, 0xA8, &[(3, 7)]), field(2, 0xC8, &[])]);
    let before = device(100, vec![field(0, 0xC8, &[])]);
    let restore = plan_restore(&wanted, &before, RestoreOptions::default()).unwrap().common;
    let created = created_fields(&restore.plan);
    assert_eq!(created, wanted.fields[1..], "with the protection that it got");
    let mut image = profile("A", restore.plan.base.fields.clone());
    image.created = created;
    let after = |fields: Vec<FieldImage>| device(90, fields);
    let undone = plan_restore(&image, &after(wanted.fields.clone()), RestoreOptions::default()).unwrap();
    assert_eq!(
        ops(&image, &after(wanted.fields.clone()), RestoreOptions::default()).unwrap(),
        ["2:C8>48", "1:A8>28", "0@0+1", "0:C9>C8"],
        "the field before them is the last then, and shrinks again"
    );
    assert_eq!((undone.created_left, undone.common.missing), (vec![], vec![]));
    assert_eq!(undone.common.plan.base.field_count, 3);
    assert_eq!(undone.common.plan.base.fields.len(), 3, "all of them are read again before anything is deleted");
    // If the last field has changed since the write, it and the created fields before it are not deleted.
    let mut changed = wanted.fields.clone();
    changed[2].bytes.as_mut().unwrap()[5] = 9;
    let now = after(vec![field(0, 0xC8, &[]), changed[1].clone(), changed[2].clone()]);
    let left = plan_restore(&image, &now, RestoreOptions::default()).unwrap();
    assert_eq!((left.created_left, left.common.plan.is_empty()), (vec![1, 2], true));
    assert_eq!(left.common.missing, [FieldRange::whole_field(1), FieldRange::whole_field(2)]);
    // Another field follows the created ones.
    let now = after(vec![field(0, 0xC8, &[]), wanted.fields[1].clone(), wanted.fields[2].clone(), field(3, 0xC8, &[])]);
    assert_eq!(plan_restore(&image, &now, RestoreOptions::default()).unwrap().created_left, [1, 2]);
    // Nothing is deleted in another encoder, or by a profile that is not a backup.
    let options = RestoreOptions { allow_other_device: true, ..RestoreOptions::default() };
    let other = DeviceState { serial_number: "Z".to_owned(), ..after(wanted.fields.clone()) };
    let onto_other = plan_restore(&image, &other, options).unwrap();
    assert!(onto_other.common.plan.ops.iter().all(|op| !matches!(op, Op::Define { to, .. } if !to.exists())));
    let plain = profile("A", vec![field(0, 0xC8, &[])]);
    let now = after(vec![field(0, 0xC8, &[]), wanted.fields[1].clone()]);
    assert!(plan_restore(&plain, &now, RestoreOptions::default()).unwrap().common.plan.is_empty());
}
