//! Tests of plans for single changes and guided procedures.

use super::*;
use crate::devices::biss::profile::test_profiles::{data_areas, profile, set_bank_bytes};
use crate::devices::biss::protocol::Descriptions;
use crate::profile::Operation;

fn kit() -> Description {
    Descriptions::built_in().find_by_name("POSITAL IXARC kit encoder").unwrap().clone()
}

fn device() -> DeviceState {
    let profile = profile("1");
    DeviceState {
        identity: profile.identity.clone(),
        filter: profile.filter,
        preset: profile.preset.as_ref().map(|preset| preset.value),
        areas: data_areas().to_vec(),
        banks: profile.banks().collect(),
    }
}

fn at(text: &str) -> RegisterAddress {
    text.parse().unwrap()
}

fn edit(place: &str, bytes: &[u8]) -> (RegisterRange, Vec<u8>) {
    (place.parse().unwrap(), bytes.to_vec())
}

fn items(plan: &BissPlan) -> Vec<(String, u64)> {
    plan.ops.iter().map(|op| (op.item_name(), op.write_cycles())).collect()
}

#[test]
fn area_edits_need_one_save() {
    let mut before = Bank::filled_with(0x24, 0);
    before.bytes[1] = 7;
    let banks = [before, Bank::filled_with(0x25, 0), Bank::filled_with(0x04, 0)];
    let edits =
        [edit("0x25:0x3F", &[9]), edit("0x24:0x00+3", &[1, 7, 3]), edit("0x24:0x02", &[4]), edit("0x04:0x00", &[0])];
    let plan = plan_edits(&kit(), &banks, &[], &edits).unwrap();
    assert_eq!(items(&plan), [("0x24:0x00, 0x24:0x02, 0x25:0x3F".to_owned(), 1)]);
    assert_eq!(plan.base.banks, banks[..2]);
    let Op::StoreData { registers, .. } = &plan.ops[0] else { panic!() };
    let changes: Vec<(u8, u8)> = registers.iter().map(|change| (change.old, change.new)).collect();
    assert_eq!(changes, [(0, 1), (0, 4), (0, 9)], "of two edits of one register the later counts");
}

/// The registers in appendix 9.1 of the manual: commands, lock registers, read-only registers, and writable registers.
#[test]
fn does_not_write_procedure_registers_directly() {
    let kit = kit();
    for text in
        ["0x6A", "0x6B", "0x00:0x00", "0x00:0x06", "0x00:0x1A", "0x00:0x24", "0x01:0x00", "0x01:0x02", "0x01:0x07"]
    {
        assert_eq!(register_kind(&kit, at(text)), Err(PlanError::Guarded { address: at(text) }), "{text}");
    }
    for text in ["0x66", "0x44", "0x02:0x00", "0x00:0x09"] {
        assert_eq!(register_kind(&kit, at(text)), Err(PlanError::ReadOnly { address: at(text) }), "{text}");
    }
    for text in ["0x40", "0x50", "0x00:0x30", "0x01:0x08"] {
        assert_eq!(register_kind(&kit, at(text)), Ok(RegisterKind::Register), "{text}");
    }
    assert!(matches!(register_kind(&kit, at("0x43:0x3F")), Ok(RegisterKind::Data(area)) if area.open == Some(2)));
    let plan =
        plan_edits(&kit, &[], &[(at("0x40"), Some(2)), (at("0x50"), None)], &[edit("0x40", &[3]), edit("0x50", &[1])]);
    let plan = plan.unwrap();
    // The bank selection is not stored. It is unknown whether the other register is stored, so it may cost a write
    // cycle.
    assert_eq!(items(&plan), [("0x40".to_owned(), 0), ("0x50".to_owned(), 1)]);
    assert_eq!(plan.base.registers, [(at("0x40"), 2)]);
    let same = plan_edits(&kit, &[], &[(at("0x40"), Some(2))], &[edit("0x40", &[2])]).unwrap();
    assert_eq!(same, BissPlan { base: Base::default(), ops: vec![] });
    let error = plan_edits(&kit, &[], &[], &[edit("0x40", &[1, 2])]).unwrap_err();
    assert_eq!(error.to_string(), "0x40 cannot be written with 2 bytes");
}

#[test]
fn selects_filter_if_different() {
    let plan = plan_filter(&kit(), &device(), PositionFilter::Dynamic).unwrap();
    assert_eq!(items(&plan), [("0x6E".to_owned(), 1)]);
    assert_eq!(plan.base.filter, Some(PositionFilter::Balanced));
    assert!(plan_filter(&kit(), &device(), PositionFilter::Balanced).unwrap().is_empty());
    let error = plan_filter(&kit(), &device(), PositionFilter::Unknown(9)).unwrap_err();
    assert_eq!(error, PlanError::UnknownFilter { code: 9 });
    let mut old = device();
    (old.identity.firmware, old.filter) = (Some(Firmware::new(1, 0, 9)), None);
    let error = plan_filter(&kit(), &old, PositionFilter::Dynamic).unwrap_err();
    assert_eq!(error.to_string(), "firmware 1.1.0 is required, but the encoder has 1.0.9");
    let any = Descriptions::built_in().find_by_name("BiSS C encoder").unwrap().clone();
    let error = plan_filter(&any, &device(), PositionFilter::Dynamic).unwrap_err();
    assert!(matches!(error, PlanError::NoProcedure { kind: ProcedureKind::FilterSelection, .. }), "{error}");
}

#[test]
fn stores_and_executes_preset() {
    let value = PresetValue::new(0x18000, 2);
    let cases: [(Option<PresetValue>, Option<PresetParts>, &[&str]); 5] = [
        (value, Some(PresetParts::Both), &["0x01:0x02+6", "position"]),
        (value, None, &["0x01:0x02+6"]),
        (None, Some(PresetParts::Singleturn), &["position"]),
        (Some(PresetValue::default()), Some(PresetParts::Multiturn), &["position"]),
        (Some(PresetValue::default()), None, &[]),
    ];
    for (value, parts, expected) in cases {
        let plan = plan_preset(&kit(), &device(), value, parts).unwrap();
        let names: Vec<String> = plan.ops.iter().map(Op::item_name).collect();
        assert_eq!(names, expected);
        assert_eq!(plan.write_cycles(), expected.len() as u64);
    }
    let plan = plan_preset(&kit(), &device(), value, Some(PresetParts::Both)).unwrap();
    assert_eq!(plan.ops[1], Op::FirePreset { parts: PresetParts::Both, value: value.unwrap() });

    let mut old = device();
    old.identity.firmware = Some(Firmware::new(1, 2, 0));
    assert!(plan_preset(&kit(), &old, value, Some(PresetParts::Both)).is_ok());
    let error = plan_preset(&kit(), &old, value, Some(PresetParts::Singleturn)).unwrap_err();
    assert_eq!(error.to_string(), "firmware 1.6.0 is required, but the encoder has 1.2.0");
    old.identity.firmware = Some(Firmware::new(1, 1, 9));
    let error = plan_preset(&kit(), &old, value, Some(PresetParts::Both)).unwrap_err();
    assert_eq!(error.to_string(), "firmware 1.2.0 is required, but the encoder has 1.1.9");
    let wide = PresetValue::new(1 << 17, 0);
    assert!(matches!(plan_preset(&kit(), &device(), wide, None), Err(PlanError::PresetTooWide { bits: 17, .. })));
}

#[test]
fn mounting_run_forms_one_plan() {
    let mut data = profile("another");
    set_bank_bytes(&mut data, 0x24, &[(0, 1), (1, 2)]);
    let run = MountingSteps {
        calibrate: true,
        wiegand: Some(true),
        preset: PresetValue::new(0x8000, 0).map(|value| (value, PresetParts::Both)),
        data: Some(Box::new(data)),
    };
    let plan = plan_mounting(&kit(), &device(), &run, MotorSource::Other).unwrap();
    let names: Vec<String> = plan.ops.iter().map(Op::item_name).collect();
    assert_eq!(names, ["calibration", "Wiegand test", "0x01:0x02+6", "position", "0x24:0x00+2"]);
    assert_eq!(plan.write_cycles(), 5);
    assert_eq!((plan.base.filter, plan.base.preset), (Some(PositionFilter::Balanced), Some(PresetValue::default())));
    assert_eq!(plan.base.banks.len(), 1);
    let unsaved = MountingSteps { wiegand: Some(false), ..MountingSteps::default() };
    assert_eq!(
        items(&plan_mounting(&kit(), &device(), &unsaved, MotorSource::Other).unwrap()),
        [("Wiegand test".to_owned(), 0)]
    );
}

#[test]
fn rejects_motor_that_needs_encoder() {
    let run = |calibrate, wiegand| MountingSteps { calibrate, wiegand, ..MountingSteps::default() };
    for run in [run(true, None), run(false, Some(false))] {
        let error = plan_mounting(&kit(), &device(), &run, MotorSource::ThisEncoder).unwrap_err();
        assert_eq!(error, PlanError::DrivenByThisEncoder);
    }
    // Steps that need no motor can be planned in any case.
    assert!(plan_mounting(&kit(), &device(), &run(false, None), MotorSource::ThisEncoder).is_ok());
    let mut dynamic = device();
    dynamic.filter = Some(PositionFilter::Dynamic);
    let error = plan_mounting(&kit(), &dynamic, &run(true, None), MotorSource::Other).unwrap_err();
    assert_eq!(error, PlanError::NotBalanced { code: 4 });
    assert!(plan_mounting(&kit(), &dynamic, &run(false, Some(true)), MotorSource::Other).is_ok());
}
