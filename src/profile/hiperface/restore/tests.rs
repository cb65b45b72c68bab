//! Plans by case.

use super::super::{Interface, MountingMark, ProfileIdentity, Recorded};
use super::*;
use crate::protocol::hiperface::LineSettings;

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
        recorded: Recorded::default(),
        mounting: Vec::new(),
        fields,
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

/// Operations in short: `C9>A9` define, `@3+2` store.
fn ops(profile: &HiperfaceProfile, device: &DeviceState, options: RestoreOptions) -> Result<Vec<String>, PlanError> {
    let restore = plan_restore(profile, device, options)?;
    let short = |op: &Op| match op {
        Op::Define { field, from: None, to } => format!("{field}:new {:02X}", to.byte()),
        Op::Define { field, from: Some(from), to } => format!("{field}:{:02X}>{:02X}", from.byte(), to.byte()),
        Op::Store { field, address, new, .. } => format!("{field}@{address}+{}", new.len()),
        other => format!("{other:?}"),
    };
    Ok(restore.plan.ops.iter().map(short).collect())
}

#[test]
fn plans_by_case() {
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
fn another_size_needs_consent_to_create_again() {
    let wanted = profile("A", vec![field(0, 0xC9, &[(0, 1)]), field(1, 0xC8, &[])]);
    let now = device(1, vec![field(0, 0xC8, &[]), field(1, 0xC8, &[]), field(2, 0x88, &[(0, 9)])]);
    let error = ops(&wanted, &now, RestoreOptions::default()).unwrap_err();
    assert_eq!(error, PlanError::SizeFixed { field: 0, profile: 32, device: 16 });
    let recreate = RestoreOptions { recreate: true, ..RestoreOptions::default() };
    assert_eq!(
        ops(&wanted, &now, recreate).unwrap(),
        ["2:88>08", "1:C8>48", "0:C8>48", "0:new C9", "0@0+32", "1:new C8", "1@0+16", "2:new C8", "2@0+16", "2:C8>88"]
    );
    let unreadable = device(1, vec![field(0, 0xC8, &[]), locked(1, 0xE8)]);
    let error = ops(&wanted, &unreadable, recreate).unwrap_err();
    assert!(matches!(error, PlanError::WouldLose { field: 1, .. }));
}

#[test]
fn what_does_not_fit_is_refused_before_anything_is_written() {
    let now = device(1, vec![field(0, 0xC8, &[])]);
    let too_large = profile("A", vec![field(0, 0xC8, &[]), field(1, 0xC9, &[])]);
    let error = ops(&too_large, &now, RestoreOptions::default()).unwrap_err();
    assert_eq!(error, PlanError::NoMemory { needed: 32, free: 16 });
    let gap = profile("A", vec![field(2, 0xC8, &[])]);
    assert_eq!(ops(&gap, &now, RestoreOptions::default()), Err(PlanError::Gap { field: 2, missing: 1 }));
}

#[test]
fn another_encoder_keeps_its_mounting() {
    let mut wanted = profile("B", vec![field(0, 0xC9, &[(2, 1), (3, 1), (4, 1), (20, 1)])]);
    wanted.mounting.push(MountingMark {
        item: FieldRange::new(0, 3, 10),
        meaning: String::new(),
        unknown: Default::default(),
    });
    let now = device(10, vec![field(0, 0xC9, &[])]);
    assert!(matches!(ops(&wanted, &now, RestoreOptions::default()), Err(PlanError::OtherDevice { .. })));
    let other = RestoreOptions { allow_other_device: true, ..RestoreOptions::default() };
    assert_eq!(ops(&wanted, &now, other).unwrap(), ["0@2+1", "0@20+1"]);
    let restore = plan_restore(&wanted, &now, other).unwrap();
    assert_eq!(restore.mounting_left, [FieldRange::new(0, 3, 2)]);
    let with_mounting = RestoreOptions { with_mounting: true, ..other };
    assert_eq!(ops(&wanted, &now, with_mounting).unwrap(), ["0@2+3", "0@20+1"]);
}

#[test]
fn another_type_and_an_encoder_without_a_number_are_not_the_same() {
    let mut wanted = profile("A", vec![field(0, 0xC9, &[])]);
    wanted.identity.encoder_type = 0x22;
    let now = device(10, vec![field(0, 0xC9, &[])]);
    let other_type = PlanError::OtherType { profile: 0x22, device: 0x37 };
    assert_eq!(ops(&wanted, &now, RestoreOptions::default()), Err(other_type));
    let nameless = DeviceState { serial_number: String::new(), ..now };
    let wanted = profile("", vec![field(0, 0xC9, &[])]);
    assert!(matches!(ops(&wanted, &nameless, RestoreOptions::default()), Err(PlanError::OtherDevice { .. })));
}

#[test]
fn what_stays_is_counted() {
    let restore = plan_restore(
        &profile("A", vec![field(0, 0xC9, &[(3, 1)])]),
        &device(10, vec![field(0, 0xC9, &[]), field(1, 0xC8, &[])]),
        RestoreOptions::default(),
    )
    .unwrap();
    assert_eq!(restore.unchanged, 1 + 31);
    assert_eq!(restore.missing, ["field:1"]);
    assert_eq!(restore.plan.write_cycles(), 1);
}
