//! Tests of what a restore writes, leaves unchanged and rejects, and of the items that a comparison names.

use super::super::test_profiles::{cam_between, identity, image, image_with, logbook_note, profile, value};
use super::super::{Base, ItemValue, Op};
use super::*;
use crate::devices::interbus::protocol::{Flags, WindowShift};
use crate::profile::{Profile, ProfileDocument};

use ItemValue::{Cam, Mask, Number};

const MINE: &str = "1234567";

fn device(serial_number: &str, items: &[(&str, ItemValue)]) -> DeviceState {
    DeviceState { identity: identity(serial_number), image: image_with(&image(), items) }
}

fn operations(restore: &Restore) -> Vec<String> {
    restore.plan.ops.iter().map(logbook_note).collect()
}

#[test]
fn equal_profile_writes_nothing() {
    let restore = plan_restore(&profile(MINE), &device(MINE, &[]), RestoreOptions::default()).unwrap();
    // 5 parameters, the shift, 8 masks, 64 cams.
    assert_eq!((restore.plan.is_empty(), restore.unchanged), (true, 78));
    assert_eq!(restore.plan.base, Base::default());
}

#[test]
fn writes_only_differences() {
    let items =
        [("steps", Number(4096)), ("preset", Number(1)), ("cam:3:4", Cam(cam_between(1, 2))), ("shift", Number(8))];
    let restore = plan_restore(&profile(MINE), &device(MINE, &items), RestoreOptions::default()).unwrap();
    let expected =
        ["steps: 4096 → 3600, preset: 1 → 500", "cam:3:4 start: 1 → 403, cam:3:4 stop: 2 → 452, shift: 8 → 0"];
    assert_eq!(operations(&restore), expected);
    assert_eq!((restore.plan.write_cycles(), restore.unchanged), (2, 74));
    let written: u64 = restore.plan.ops.iter().map(Op::change_count).sum();
    assert_eq!(written + restore.unchanged, 78);
}

#[test]
fn other_encoder_needs_permission() {
    let of = profile(MINE);
    let other = device("7654321", &[("preset", Number(7)), ("zero-shift", Number(9)), ("cam-mask:1", Mask(0))]);
    let refused = PlanError::OtherDevice { profile: MINE.to_owned(), device: "7654321".to_owned() };
    assert_eq!(plan_restore(&of, &other, RestoreOptions::default()), Err(refused));
    let allowed = RestoreOptions { allow_other_device: true, ..RestoreOptions::default() };
    let restore = plan_restore(&of, &other, allowed).unwrap();
    assert_eq!(operations(&restore), ["cam-mask:1: 0x00 → 0xFF"]);
    assert_eq!(restore.mounting_left, [Item::Preset, Item::ZeroShift]);
    assert_eq!(restore.unchanged, 75);
    let with_it = RestoreOptions { with_mounting: true, ..allowed };
    let restore = plan_restore(&of, &other, with_it).unwrap();
    assert_eq!(operations(&restore), ["preset: 7 → 500, zero-shift: 9 → 0", "cam-mask:1: 0x00 → 0xFF"]);
    assert!(restore.mounting_left.is_empty());
    // Values from another mounting are reported if they are written (issue 22.7).
    assert_eq!(restore.mounting_written, [Item::Preset, Item::ZeroShift]);
}

/// The marks in the file decide which values depend on the mounting, even if they mark unusual items.
#[test]
fn mounting_covers_only_marked_items() {
    let mut of = profile(MINE);
    of.mounting.retain(|mark| mark.item == Item::Preset);
    if let Some(mark) = of.mounting.first_mut() {
        mark.item = "cam:1:1".parse().unwrap();
    }
    let other = device("7654321", &[("preset", Number(7)), ("cam:1:1", Cam(cam_between(0, 1)))]);
    let options = RestoreOptions { allow_other_device: true, ..RestoreOptions::default() };
    let restore = plan_restore(&of, &other, options).unwrap();
    assert_eq!((operations(&restore), restore.mounting_left.len()), (vec!["preset: 7 → 500".to_owned()], 1));
}

/// A handwritten profile without a serial number may be written to any encoder, except for the mounting-dependent
/// values.
#[test]
fn profile_without_identity_fits_any_encoder() {
    let options = RestoreOptions::default();
    let restore = plan_restore(&profile(""), &device(MINE, &[("preset", Number(7))]), options).unwrap();
    assert_eq!((restore.plan.is_empty(), restore.mounting_left), (true, vec![Item::Preset]));
}

#[test]
fn rejects_out_of_range_device_preset() {
    let other = device("7654321", &[("steps", Number(8192)), ("preset", Number(5000))]);
    let options = RestoreOptions { allow_other_device: true, ..RestoreOptions::default() };
    let left = PlanError::MountingLeft { item: Item::Preset, value: 5000, low: 0, high: 3599 };
    assert_eq!(plan_restore(&profile(MINE), &other, options), Err(left));
    assert!(plan_restore(&profile(MINE), &other, RestoreOptions { with_mounting: true, ..options }).is_ok());
}

/// An encoder that reports its steps minus one, or does not count turns, is a different type. Allowing another type
/// does not allow another serial number (issue 22.9).
#[test]
fn type_change_needs_permission() {
    let mut own = device(MINE, &[("preset", Number(7))]);
    let (device_only, type_only) = (
        RestoreOptions { allow_other_device: true, ..RestoreOptions::default() },
        RestoreOptions { allow_other_type: true, ..RestoreOptions::default() },
    );
    for other in [0, 1, 3] {
        own.identity.flags = Some(Flags::new(value(other)));
        let types = TypeMismatch { profile: Flags::new(value(2)), device: Flags::new(value(other)) };
        for refused in [RestoreOptions::default(), device_only] {
            assert_eq!(plan_restore(&profile(MINE), &own, refused), Err(types.into()));
        }
        // An encoder of another type keeps its mounting-dependent values, even with the same serial number.
        let restore = plan_restore(&profile(MINE), &own, type_only).unwrap();
        assert_eq!(restore.mounting_left, [Item::Preset]);
        let mut two = own.clone();
        two.identity.serial_number = "7654321".to_owned();
        assert!(matches!(plan_restore(&profile(MINE), &two, type_only), Err(PlanError::OtherDevice { .. })));
        let both = RestoreOptions { allow_other_type: true, ..device_only };
        assert!(plan_restore(&profile(MINE), &two, both).is_ok());
    }
    // Unknown bits do not change the type.
    own.identity.flags = Some(Flags::new(value(6)));
    assert!(plan_restore(&profile(MINE), &own, RestoreOptions::default()).is_ok());
    own.identity.flags = None;
    assert!(plan_restore(&profile(MINE), &own, RestoreOptions::default()).is_ok());
}

#[test]
fn reads_only_needed_programs() {
    let mut of = profile(MINE);
    let numbers = |profile: &InterbusProfile| -> Vec<u8> {
        programs_to_read(profile).into_iter().map(ProgramNumber::get).collect()
    };
    assert_eq!(numbers(&of), [1, 2, 3, 4, 5, 6, 7, 8]);
    of.image.programs[..6].fill(None);
    assert_eq!(numbers(&of), [7, 8]);
    of.image.programs.fill(None);
    assert_eq!(numbers(&of), [1]);
    of.image.shift = None;
    assert!(numbers(&of).is_empty());
    // Items missing from the profile are left unchanged.
    let restore = plan_restore(&of, &device(MINE, &[("cam-mask:2", Mask(0))]), RestoreOptions::default()).unwrap();
    assert_eq!((restore.plan.is_empty(), restore.unchanged), (true, 5));
}

#[test]
fn lists_values_missing_on_encoder() {
    let mut own = device(MINE, &[]);
    (own.image.shift, own.image.programs[2]) = (None, None);
    let restore = plan_restore(&profile(MINE), &own, RestoreOptions::default()).unwrap();
    assert_eq!((restore.plan.is_empty(), restore.missing.len()), (true, 1 + 9));
    assert_eq!(restore.missing[..3], ["shift", "cam-mask:3", "cam:3:0"]);
}

/// The profiles are written to an encoder with the test programs.
#[test]
fn sample_profiles_plan_expected_writes() {
    let read = |name: &str| {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("profiles/interbus").join(name);
        let text = std::fs::read_to_string(path).unwrap();
        let document = ProfileDocument::parse(&text, InterbusProfile::FORMATS).unwrap();
        assert_eq!(document.emit(), text, "as this program writes it");
        document.body.into_profile().unwrap()
    };
    let machine = read("packaging-machine.ron");
    let now = device(MINE, &[]);
    let restore = plan_restore(&machine, &now, RestoreOptions::default()).unwrap();
    // Only three programs differ. The preset depends on the mounting and is not written.
    assert_eq!((restore.plan.ops.len(), restore.plan.write_cycles()), (3, 3));
    assert_eq!((restore.mounting_left, restore.missing), (vec![Item::Preset], Vec::<String>::new()));
    let after =
        machine.image.known_programs().map(|(number, own)| (machine.names.program(number), own.outputs(value(1500))));
    assert_eq!(
        after.collect::<Vec<_>>(),
        [("carton 120 mm", 1 << 2), ("carton 180 mm", 1 << 2), ("set-up, glue off", 0)]
    );
    // With 100 steps per millimetre over 2.5 m, the preset is beyond the encoder's current range.
    let spindle = read("scaled-encoder.ron");
    assert_eq!(spindle.image.parameters.gear().map(|gear| gear.total_steps()), Ok(250_000));
    let with_it = RestoreOptions { with_mounting: true, ..RestoreOptions::default() };
    let restore = plan_restore(&spindle, &now, with_it).unwrap();
    let expected = ["revolutions: 1 → 250, steps: 3600 → 250000, direction: cw → ccw, preset: 500 → 125000"];
    assert_eq!(operations(&restore), expected);
}

#[test]
fn comparison_lists_differences() {
    let (left, mut right) = (profile(MINE), profile("7654321"));
    right.recorded.temperature_tenths = None;
    assert_eq!(left.compare(&right).compared, 78);
    assert!(left.compare(&right).differences().is_empty());
    right.image =
        image_with(&right.image, &[("direction", ItemValue::Direction(super::super::Direction::Counterclockwise))]);
    right.image = image_with(&right.image, &[("cam:2:5", Cam(cam_between(1, 2))), ("cam-mask:2", Mask(0x0F))]);
    right.image.shift = WindowShift::new(25);
    right.image.programs[7] = None;
    let comparison = left.compare(&right);
    let differences = comparison.differences();
    let found: Vec<[&str; 3]> =
        differences.iter().map(|own| [own.item.as_str(), own.left.as_str(), own.right.as_str()]).collect();
    let expected = [
        ["direction", "cw", "ccw"],
        ["shift", "0", "25"],
        ["cam-mask:2", "0xFF", "0x0F"],
        ["cam:2:5", "502..551", "1..2"],
    ];
    assert_eq!((found, comparison.compared), (expected.to_vec(), 69));
    assert_eq!((comparison.only_left().len(), comparison.only_right().len()), (9, 0));
    assert_eq!(comparison.only_left()[1], "cam:8:0");
}
