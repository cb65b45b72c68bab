//! Tests of restore plans.

use super::*;
use crate::devices::biss::profile::test_profiles::{data_areas, profile, set_bank_bytes};
use crate::devices::biss::profile::{MountingItem, MountingMark, PresetSetting};
use crate::profile::{Profile, ProfileDocument};

fn device(profile: &BissProfile) -> DeviceState {
    DeviceState {
        identity: profile.identity.clone(),
        filter: profile.filter,
        preset: profile.preset.as_ref().map(|preset| preset.value),
        areas: data_areas().to_vec(),
        banks: profile.banks().collect(),
    }
}

fn with_preset(profile: &mut BissProfile, singleturn: u32, multiturn: u32) {
    let value = PresetValue::new(singleturn, multiturn).unwrap();
    profile.preset = Some(PresetSetting { value, unknown: Default::default() });
}

/// Returns the operations in a short notation, with their cost in write cycles.
fn ops(restore: &Restore) -> Vec<String> {
    let short = |op: &Op| {
        let cost = crate::profile::Operation::write_cycles(op);
        match op {
            Op::StoreData { area, registers } => {
                let bytes: Vec<String> =
                    registers.iter().map(|own| format!("{}:{:02X}>{:02X}", own.address, own.old, own.new)).collect();
                format!("{} {} ({cost})", area.name, bytes.join(" "))
            }
            op => format!("{} ({cost})", op.item_name()),
        }
    };
    restore.plan.ops.iter().map(short).collect()
}

fn planned(profile: &BissProfile, device: &DeviceState) -> Restore {
    plan_restore(profile, device, RestoreOptions::default()).unwrap()
}

/// Three changed bytes in one bank need only one save.
#[test]
fn area_differences_need_one_save() {
    let now = profile("1");
    let mut wanted = now.clone();
    set_bank_bytes(&mut wanted, 0x24, &[(0x10, 1), (0x11, 2), (0x30, 3)]);
    let restore = planned(&wanted, &device(&now));
    assert_eq!(ops(&restore), ["OEM data 0x24:0x10:00>01 0x24:0x11:00>02 0x24:0x30:00>03 (1)"]);
    assert_eq!(restore.plan.ops[0].item_name(), "0x24:0x10+2, 0x24:0x30");
    assert_eq!(restore.plan.ops[0].compared_items(), 3);
    assert_eq!(restore.plan.write_cycles(), 1);
    assert_eq!(restore.plan.base.banks, [Bank::filled_with(0x24, 0)]);
    // These are the filter, six registers of the preset value, and all but three registers of 64 banks.
    assert_eq!(restore.unchanged, 1 + 6 + 64 * 64 - 3);
    assert_eq!((restore.missing, restore.mounting_left), (vec![], vec![]));
}

#[test]
fn restore_plans_for_each_case() {
    type Change = fn(&mut BissProfile);
    let cases: [(&str, Change, &[&str], u64); 6] = [
        ("nothing differs", |_| {}, &[], 0),
        (
            "two areas are two saves, whatever lies between",
            |wanted| {
                set_bank_bytes(wanted, 0x30, &[(0, 1)]);
                set_bank_bytes(wanted, 0x05, &[(0, 1)]);
                set_bank_bytes(wanted, 0x24, &[(0, 1)]);
            },
            &["EDS motor data 0x05:0x00:00>01 (1)", "OEM data 0x24:0x00:00>01 0x30:0x00:00>01 (1)"],
            2,
        ),
        ("the filter", |wanted| wanted.filter = Some(PositionFilter::Dynamic), &["0x6E (1)"], 1),
        ("the preset value, stored and not carried out", |wanted| with_preset(wanted, 7, 0), &["0x01:0x02+6 (1)"], 1),
        (
            "all of it, what restarts the encoder last",
            |wanted| {
                wanted.filter = Some(PositionFilter::Dynamic);
                with_preset(wanted, 7, 0);
                set_bank_bytes(wanted, 0x43, &[(0x3F, 9)]);
            },
            &["OEM data 0x43:0x3F:00>09 (1)", "0x6E (1)", "0x01:0x02+6 (1)"],
            3,
        ),
        (
            "a profile that says nothing about settings and banks",
            |wanted| {
                (wanted.filter, wanted.preset) = (None, None);
                wanted.data.iter_mut().for_each(|image| image.empty = None);
            },
            &[],
            0,
        ),
    ];
    for (label, change, expected, cycles) in cases {
        let mut now = profile("1");
        let mut wanted = now.clone();
        // Banks that the profile does not contain remain unchanged.
        if label.starts_with("a profile") {
            set_bank_bytes(&mut now, 0x24, &[(0, 0x55)]);
        }
        change(&mut wanted);
        let restore = planned(&wanted, &device(&now));
        assert_eq!(ops(&restore), expected, "{label}");
        assert_eq!(restore.plan.write_cycles(), cycles, "{label}");
        // After the restore, no item differs.
        if cycles > 0 {
            assert_eq!(planned(&wanted, &device(&wanted)).plan.ops, [], "{label}");
        }
    }
}

#[test]
fn clears_bank_marked_empty() {
    let wanted = profile("1");
    let mut now = wanted.clone();
    set_bank_bytes(&mut now, 0x25, &[(1, 0xAB)]);
    assert_eq!(ops(&planned(&wanted, &device(&now))), ["OEM data 0x25:0x01:AB>00 (1)"]);
    assert_eq!(required_banks(&wanted, &data_areas()).len(), 64);
    let mut partial = wanted.clone();
    partial.data.iter_mut().for_each(|image| image.empty = None);
    set_bank_bytes(&mut partial, 0x25, &[(1, 0xAB)]);
    assert_eq!(required_banks(&partial, &data_areas()), [0x25]);
}

/// Another kind of encoder must be allowed separately. Allowing another serial number is not sufficient (issue 22.9).
#[test]
fn different_encoder_kind_needs_permission() {
    let mut wanted = profile("1");
    set_bank_bytes(&mut wanted, 0x24, &[(0, 1)]);
    let now = device(&profile("2"));
    let kind_refused = |profile: &BissProfile| {
        let (profile, device) = (Box::new(profile.identity.kind()), Box::new(now.identity.kind()));
        Err(TypeMismatch::Kind { profile, device }.into())
    };
    let number_refused = Err(PlanError::OtherDevice { profile: "1".to_owned(), device: "2".to_owned() });
    let mut other = wanted.clone();
    other.identity.device_id[0] ^= 1;
    let mut same_number = other.clone();
    same_number.identity.serial_number = "2".to_owned();
    let planned = Ok(vec!["OEM data 0x24:0x00:00>01 (1)".to_owned()]);
    let cases = [
        ("nothing", &other, false, false, kind_refused(&other)),
        ("another serial number", &other, true, false, kind_refused(&other)),
        ("another type", &other, false, true, number_refused.clone()),
        ("both", &other, true, true, planned.clone()),
        ("another type with the same number", &same_number, false, true, planned.clone()),
        ("the same kind", &wanted, true, false, planned),
        ("the same kind and another type", &wanted, false, true, number_refused),
    ];
    for (label, profile, allow_other_device, allow_other_type, expected) in cases {
        let options = RestoreOptions { allow_other_device, allow_other_type, with_mounting: false };
        assert_eq!(plan_restore(profile, &now, options).map(|restore| ops(&restore)), expected, "{label}");
    }
}

#[test]
fn other_encoder_keeps_mounting() {
    let mut wanted = profile("1");
    with_preset(&mut wanted, 0x18000, 3);
    set_bank_bytes(&mut wanted, 0x24, &[(0, 1), (1, 2), (2, 3)]);
    let item = MountingItem::Registers("0x24:0x01+2".parse().unwrap());
    wanted.mounting.push(MountingMark { item, meaning: String::new(), unknown: Default::default() });
    let now = device(&profile("2"));
    let error = plan_restore(&wanted, &now, RestoreOptions::default()).unwrap_err();
    assert_eq!(error, PlanError::OtherDevice { profile: "1".to_owned(), device: "2".to_owned() });
    let other = RestoreOptions { allow_other_device: true, ..RestoreOptions::default() };
    let restore = plan_restore(&wanted, &now, other).unwrap();
    assert_eq!(ops(&restore), ["OEM data 0x24:0x00:00>01 (1)"]);
    let left: Vec<String> = restore.mounting_left.iter().map(ToString::to_string).collect();
    assert_eq!(left, ["0x01:0x02+6", "0x24:0x01+2"]);
    let with_mounting = RestoreOptions { with_mounting: true, ..other };
    let restore = plan_restore(&wanted, &now, with_mounting).unwrap();
    let all = ["OEM data 0x24:0x00:00>01 0x24:0x01:00>02 0x24:0x02:00>03 (1)", "0x01:0x02+6 (1)"];
    assert_eq!(ops(&restore), all);
    assert_eq!(restore.mounting_left, []);
    // Mounting values of another encoder are reported if they are written (issue 22.7).
    let written: Vec<String> = restore.mounting_written.iter().map(ToString::to_string).collect();
    assert_eq!(written, ["0x01:0x02+6", "0x24:0x01+2"]);
    assert_eq!(planned(&wanted, &device(&profile("1"))).mounting_written, []);
    // In the encoder from which the profile was read, all values are restored.
    assert_eq!(ops(&planned(&wanted, &device(&profile("1")))), all);
    assert_eq!(ops(&plan_data_areas(&wanted, &now).unwrap()), all[..1]);
}

/// An encoder with another device ID or position width is of another type, which must be allowed separately. If the
/// serial number differs as well, both must be allowed (issue 22.9).
#[test]
fn other_type_needs_permission() {
    let mut wanted = profile("1");
    with_preset(&mut wanted, 5, 5);
    let same = device(&profile("1"));
    let (mut other_id, mut wider, mut unknown) = (same.clone(), same.clone(), same.clone());
    other_id.identity.device_id = [9; 6];
    wider.identity.multiturn_bits = Some(24);
    unknown.identity.multiturn_bits = None;
    for mut now in [other_id, wider] {
        let device_only = RestoreOptions { allow_other_device: true, ..RestoreOptions::default() };
        for refused in [RestoreOptions::default(), device_only] {
            let error = plan_restore(&wanted, &now, refused).unwrap_err();
            assert!(matches!(error, PlanError::TypeMismatch(_)), "{error}");
        }
        // An encoder of another type is another encoder even if the serial numbers are equal, so mounting values are
        // not written.
        let type_only = RestoreOptions { allow_other_type: true, ..RestoreOptions::default() };
        let restore = plan_restore(&wanted, &now, type_only).unwrap();
        assert_eq!((ops(&restore).len(), restore.mounting_left.len()), (0, 1));
        now.identity.serial_number = "2".to_owned();
        let error = plan_restore(&wanted, &now, type_only).unwrap_err();
        assert!(matches!(error, PlanError::OtherDevice { .. }), "{error}");
        assert!(plan_restore(&wanted, &now, RestoreOptions { allow_other_type: true, ..device_only }).is_ok());
    }
    // A width that is unknown on one side matches any width.
    assert!(plan_restore(&wanted, &unknown, RestoreOptions::default()).is_ok());
}

#[test]
fn rejects_other_kind_and_missing_serial_number() {
    let wanted = profile("1");
    let mut now = device(&wanted);
    now.identity.device_id = [9; 6];
    let error = plan_restore(&wanted, &now, RestoreOptions::default()).unwrap_err();
    assert_eq!(
        error.to_string(),
        "the profile is for profile 0x6129, manufacturer 46 72, device ID 01 01 68 11 00 01, but the encoder reports \
         profile 0x6129, manufacturer 46 72, device ID 09 09 09 09 09 09"
    );
    let nameless = profile("");
    let error = plan_restore(&nameless, &device(&nameless), RestoreOptions::default()).unwrap_err();
    assert!(matches!(error, PlanError::OtherDevice { .. }), "{error}");
}

#[test]
fn reports_or_rejects_unsupported_values() {
    let mut wanted = profile("1");
    with_preset(&mut wanted, 5, 5);
    wanted.filter = Some(PositionFilter::Dynamic);
    let mut old = device(&profile("1"));
    (old.filter, old.preset) = (None, None);
    let restore = planned(&wanted, &old);
    assert_eq!(restore.missing, ["0x6E", "0x01:0x02+6"]);
    assert_eq!(restore.plan.ops, []);

    let now = device(&profile("1"));
    for (singleturn, multiturn, part, value, bits) in
        [(1 << 17, 0, "singleturn", 1 << 17, 17), (0, 1 << 16, "multiturn", 1 << 16, 16)]
    {
        with_preset(&mut wanted, singleturn, multiturn);
        let error = plan_restore(&wanted, &now, RestoreOptions::default()).unwrap_err();
        assert_eq!(error, PlanError::PresetTooWide { part, value, bits });
    }
    with_preset(&mut wanted, (1 << 17) - 1, (1 << 16) - 1);
    assert_eq!(planned(&wanted, &now).plan.write_cycles(), 2);

    wanted.filter = Some(PositionFilter::Unknown(5));
    let error = plan_restore(&wanted, &now, RestoreOptions::default()).unwrap_err();
    assert_eq!(error, PlanError::UnknownFilter { code: 5 });

    let mut fewer = device(&profile("1"));
    fewer.areas.truncate(1);
    let error = plan_restore(&profile("1"), &fewer, RestoreOptions::default()).unwrap_err();
    assert_eq!(error, PlanError::NoBank { bank: 0x24 });
    let mut read_only = device(&profile("1"));
    read_only.areas[1].access = crate::devices::biss::protocol::Access::R;
    let mut other = profile("1");
    assert_eq!(planned(&other, &read_only).plan.ops, [], "nothing differs there");
    set_bank_bytes(&mut other, 0x24, &[(0, 1)]);
    let error = plan_restore(&other, &read_only, RestoreOptions::default()).unwrap_err();
    assert_eq!(error, PlanError::NoBank { bank: 0x24 });
}

/// Without an opening command, each register is written individually, at an assumed cost of one write cycle.
#[test]
fn writes_area_without_procedure_directly() {
    let mut now = device(&profile("1"));
    now.areas[1].open = None;
    let mut wanted = profile("1");
    set_bank_bytes(&mut wanted, 0x24, &[(0, 1), (1, 2)]);
    let restore = planned(&wanted, &now);
    assert_eq!(ops(&restore), ["0x24:0x00 (1)", "0x24:0x01 (1)"]);
    assert_eq!(restore.plan.write_cycles(), 2);
}

/// Restores the profiles supplied with the program to a new encoder with another serial number.
#[test]
fn supplied_profiles_plan_expected_writes() {
    let read = |name: &str| {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("profiles/biss").join(name);
        let text = std::fs::read_to_string(path).unwrap();
        ProfileDocument::parse(&text, BissProfile::FORMATS).unwrap().body.into_profile().unwrap()
    };
    let now = device(&profile("7"));
    let other = RestoreOptions { allow_other_device: true, ..RestoreOptions::default() };
    let plan = |name: &str, options| plan_restore(&read(name), &now, options).unwrap();
    assert_eq!(ops(&plan("kit-encoder-as-delivered.ron", other)), Vec::<String>::new());
    assert_eq!(ops(&plan("dynamic-filter.ron", other)), ["0x6E (1)"]);
    let restore = plan("servo-motor-data.ron", other);
    assert_eq!(restore.plan.write_cycles(), 2);
    let left: Vec<String> = restore.mounting_left.iter().map(ToString::to_string).collect();
    assert!(
        left.contains(&"0x04:0x20+3".to_owned()) && left.iter().any(|item| item.starts_with("0x25:0x0")),
        "{left:?}"
    );
    let all = plan("servo-motor-data.ron", RestoreOptions { with_mounting: true, ..other });
    assert_eq!((all.mounting_left, all.plan.write_cycles()), (vec![], 2));
    assert_eq!(all.plan.base.banks.len(), 3, "nothing else is touched");
    // The profile contains a commutation record, as used in HIPERFACE encoders, for a motor with four pole pairs. 5299h
    // is the result of Python's `binascii.crc_hqx(record, 0xFFFF)` for the bytes before it.
    let record = [0x43, 0x4F, 0x31, 0x00, 0x1C, 0x71, 0xC7, 0x1C, 0x04, 0x00, 0x00, 0x00, 0x00, 0x00, 0x52, 0x99];
    assert_eq!(read("servo-motor-data.ron").bank(4).unwrap().bytes[32..48], record);
}
