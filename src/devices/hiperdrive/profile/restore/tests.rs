//! Tests of restored, unchanged and rejected items, and of comparisons.

use super::*;
use crate::devices::hiperdrive::profile::test_profiles::{
    drive, identity, image, image_with_values, parameter, profile,
};
use crate::devices::hiperdrive::profile::{MountingMark, Op, Service};
use crate::devices::hiperdrive::protocol::{Topology, Variant};
use crate::profile::{Profile, ProfileDocument};

fn device() -> DeviceState {
    let profile = profile();
    DeviceState { identity: profile.identity, image: profile.image, positions: Positions::new() }
}

const NONE: RestoreOptions =
    RestoreOptions { allow_other_device: false, allow_other_type: false, with_mounting: false };
const OTHER: RestoreOptions = RestoreOptions { allow_other_device: true, ..NONE };
const TYPE: RestoreOptions = RestoreOptions { allow_other_type: true, ..NONE };
const ALL: RestoreOptions = RestoreOptions { with_mounting: true, ..OTHER };

fn written(restore: &Restore) -> Vec<u16> {
    let write = |op: &Op| match op {
        Op::Write { number, .. } => Some(number.get()),
        _ => None,
    };
    restore.plan.ops.iter().filter_map(write).collect()
}

#[test]
fn writes_only_differences() {
    let mut device = device();
    device.image = device.image.with_overlay(&image_with_values(&[(166, 100), (398, 64)]));
    let restore = plan_restore(&profile(), &device, NONE).unwrap();
    assert_eq!(written(&restore), [166]);
    assert_eq!(restore.plan.ops.last(), Some(&Op::Service(Service::Save)));
    // 2 registers and 2 · 13 parameters, less these two.
    assert_eq!((restore.unchanged, restore.missing.len()), (26, 0));
    assert_eq!(restore.mounting_left, [Item(parameter(398))], "a reference is never restored, on its own drive either");
    let restore = plan_restore(&profile(), &device, ALL).unwrap();
    assert_eq!((written(&restore), restore.mounting_left), (vec![166], vec![Item(parameter(398))]));
}

#[test]
fn skips_and_names_empty_ports() {
    let mut device = device();
    device.image = image(&[1]).with_overlay(&image_with_values(&[(166, 100)]));
    device.identity = identity("100", &[(1, "4711")]);
    let restore = plan_restore(&profile(), &device, NONE).unwrap();
    assert_eq!((written(&restore), restore.missing.len()), (vec![166], 13));
    assert_eq!((restore.missing[0].as_str(), restore.missing[12].as_str()), ("152 drive 3", "198 drive 3"));
}

#[test]
fn rejects_other_device_or_drive() {
    let mut device = device();
    device.identity = identity("101", &[(1, "4711"), (3, "4712")]);
    let error = plan_restore(&profile(), &device, NONE).unwrap_err();
    assert_eq!(error, PlanError::OtherDevice { profile: "100".to_owned(), device: "101".to_owned() });
    assert!(plan_restore(&profile(), &device, OTHER).is_ok());
    device.identity = identity("100", &[(1, "4711"), (3, "5000")]);
    let error = plan_restore(&profile(), &device, NONE).unwrap_err();
    let expected = PlanError::OtherDrive { drive: drive(3), profile: "4712".to_owned(), device: "5000".to_owned() };
    assert_eq!(error, expected);
    assert!(plan_restore(&profile(), &device, OTHER).is_ok());
    let mut by_hand = profile();
    by_hand.identity = ProfileIdentity::default();
    assert!(plan_restore(&by_hand, &device, NONE).is_ok());
}

/// All of these have the same serial number, so that only the permission for another type is needed (issue 22.9).
#[test]
fn rejects_other_device_or_drive_type() {
    let mut device = device();
    device.identity.topology = Some(Topology::Adapter);
    device.image = image(&[1]).with_overlay(&image_with_values(&[(166, 100)]));
    let error = plan_restore(&profile(), &device, OTHER).unwrap_err();
    assert_eq!(error, TypeMismatch::Device { profile: Topology::Hub4, device: Topology::Adapter }.into());
    assert_eq!(error.to_string(), "the profile is for a HIPERDRIVE HUB-4, but the device is a HIPERDRIVE SINGLE");
    let restore = plan_restore(&profile(), &device, TYPE).unwrap();
    assert_eq!((written(&restore), restore.missing.len()), (vec![166], 13), "what is of a place that both have");
    device.identity = profile().identity;
    device.identity.drives[1].variant = Some(Variant::new(13));
    let error = plan_restore(&profile(), &device, OTHER).unwrap_err();
    let (profiles, devices) = (Variant::new(7), Variant::new(13));
    assert_eq!(error, TypeMismatch::Drive { drive: drive(3), profile: profiles, device: devices }.into());
    assert!(error.to_string().contains("7 (HDA30A)") && error.to_string().contains("13 (HDA70)"), "{error}");
    assert!(plan_restore(&profile(), &device, TYPE).is_ok());
    // With another serial number as well, both are needed.
    device.identity.drives[1].serial_number = "5000".to_owned();
    let error = plan_restore(&profile(), &device, TYPE).unwrap_err();
    assert!(matches!(error, PlanError::OtherDrive { .. }), "{error}");
    assert!(plan_restore(&profile(), &device, RestoreOptions { allow_other_type: true, ..OTHER }).is_ok());
    let mut by_hand = profile();
    by_hand.identity = ProfileIdentity::default();
    assert!(plan_restore(&by_hand, &device, NONE).is_ok());
}

#[test]
fn mounting_parameters_stay_on_their_drive() {
    let mut marked = profile();
    let mark = |own| MountingMark { item: Item(parameter(own)), meaning: String::new(), unknown: Default::default() };
    marked.mounting.extend([mark(160), mark(360)]);
    let mut device = device();
    device.image = device.image.with_overlay(&image_with_values(&[(160, 1000), (360, 1000)]));
    device.identity = identity("100", &[(1, "4711"), (3, "5000")]);
    let restore = plan_restore(&marked, &device, OTHER).unwrap();
    assert_eq!((written(&restore), restore.mounting_left), (vec![160], vec![Item(parameter(360))]));
    let restore = plan_restore(&marked, &device, ALL).unwrap();
    assert_eq!(written(&restore), [160, 360]);
    // Issue 22.7: items from another mounting are named if they are written; drive 1 is the profile's own.
    assert_eq!(restore.mounting_written, [Item(parameter(360))]);
}

#[test]
fn names_differences_by_drive() {
    let mut right = profile();
    right.image = image(&[1, 3, 4]).with_overlay(&image_with_values(&[(24, 1), (166, 100), (366, 200)]));
    right.image.values.remove(&parameter(190));
    let comparison = profile().compare(&right);
    let differences = comparison.differences();
    let differences: Vec<(&str, &str, &str)> =
        differences.iter().map(|own| (own.item.as_str(), own.left.as_str(), own.right.as_str())).collect();
    assert_eq!(differences, [("24", "0", "1"), ("166", "350", "100"), ("166 drive 3", "350", "200")]);
    assert_eq!((comparison.compared, comparison.only_left()), (27, vec!["190".to_owned()]));
    assert_eq!(comparison.only_right().len(), 13);
    assert_eq!(comparison.only_right()[0], "152 drive 4");
}

/// Steps per turn are 256 · numerator / denominator (reference, section 5): 400 steps of 0.01 mm at a pitch of 4 mm, 20
/// steps of 0.1 mm at a pitch of 2 mm, or 3600 steps of 0.1°. 511 turns are 204400 and 10220 steps. Half a turn is 1800
/// steps.
#[test]
fn supplied_profiles_plan_expected_writes() {
    let read = |name: &str| {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("profiles/hiperdrive").join(name);
        let text = std::fs::read_to_string(path).unwrap();
        ProfileDocument::parse(&text, HiperdriveProfile::FORMATS).unwrap().body.into_profile().unwrap()
    };
    let mut now = device();
    now.positions = [(drive(1), 0), (drive(3), 0)].into();
    for (name, steps, writes) in [
        ("spindle-4-mm-in-0.01-mm.ron", 400.0, vec![(156, 256), (154, 400), (158, -204_400), (160, 204_400)]),
        ("spindle-2-mm-in-0.1-mm.ron", 20.0, vec![(156, 256), (154, 20), (158, -10_220), (160, 10_220)]),
        ("rotary-axis-in-0.1-degree.ron", 3600.0, vec![(156, 256), (154, 3600), (158, -1800), (160, 1800)]),
        ("gentle-commissioning.ron", 65_536.0, vec![(166, 50), (186, 5)]),
        ("short-drive-as-delivered.ron", 65_536.0, vec![]),
    ] {
        let profile = read(name);
        let restore = plan_restore(&profile, &now, NONE).unwrap();
        let write = |op: &Op| match op {
            Op::Write { number, new, .. } => Some((number.get(), *new)),
            _ => None,
        };
        assert_eq!(restore.plan.ops.iter().filter_map(write).collect::<Vec<_>>(), writes, "{name}");
        assert_eq!((restore.missing, restore.mounting_left), (Vec::new(), Vec::new()), "{name}");
        let after = now.image.with_overlay(&profile.image);
        assert_eq!(after.scale(drive(1)).map(|scale| scale.steps_per_turn()), Some(steps), "{name}");
    }
}
