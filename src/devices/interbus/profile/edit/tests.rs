//! Tests of planned edits: what is written, in which order, and what is rejected.

use super::super::test_profiles::{cam, cam_between, image, image_with, logbook_note, parse_item, program, value};
use super::super::{Direction, ItemValue};
use super::*;
use crate::devices::interbus::protocol::{GearError, OutOfRange, WindowShift};

use ItemValue::Number;

/// Returns the parameters in the order in which they are sent.
fn sent(device: &Image, wanted: &Image) -> Vec<(Parameter, u32)> {
    match plan_edits(device, wanted).unwrap().ops.as_slice() {
        [Op::Parameterise(changes)] => changes.iter().map(|change| (change.parameter, change.to)).collect(),
        ops => panic!("{ops:?}"),
    }
}

#[test]
fn skips_equal_values() {
    let plan = plan_edits(&image(), &image()).unwrap();
    assert_eq!(plan, InterbusPlan { base: Base::default(), ops: vec![] });
    // Values that are not to be written need not be known.
    let nothing = Image::from_parameters(image().parameters);
    assert!(plan_edits(&image(), &nothing).unwrap().is_empty());
    assert!(plan_edits(&nothing, &nothing).unwrap().is_empty());
}

/// If the zero shift is beyond the new measuring range, it must be changed before the range (issue 22.6).
#[test]
fn rejects_zero_shift_beyond_range() {
    let device = Image::from_parameters(Parameters {
        steps: 255,
        revolutions: 1,
        preset: 0,
        zero_shift: 0,
        ..image().parameters
    });
    let with = |change: &dyn Fn(&mut Parameters)| {
        let mut wanted = device.clone();
        change(&mut wanted.parameters);
        wanted
    };
    let beyond = OutOfRange { parameter: Parameter::ZeroShift, value: 255, low: 0, high: 254 };
    let refused = plan_edits(&device, &with(&|own| own.zero_shift = 255));
    assert_eq!(refused, Err(PlanError::OutOfRange(beyond)));
    assert_eq!(sent(&device, &with(&|own| own.zero_shift = 254)), [(Parameter::ZeroShift, 254)]);
    // Like the preset, a zero shift that does not change must be within the new range.
    let full = with(&|own| own.zero_shift = 254);
    let shorter = |zero_shift| with(&|own| (own.steps, own.zero_shift) = (100, zero_shift));
    assert!(matches!(plan_edits(&full, &shorter(254)), Err(PlanError::OutOfRange(_))));
    assert_eq!(sent(&full, &shorter(99)), [(Parameter::ZeroShift, 99), (Parameter::Steps, 100)]);
    // If the range becomes longer, the zero shift is changed after it.
    let longer = with(&|own| (own.steps, own.zero_shift) = (1000, 999));
    assert_eq!(sent(&device, &longer), [(Parameter::Steps, 1000), (Parameter::ZeroShift, 999)]);
}

/// Only the differences are written to an encoder that already has 60 of the 64 cams. Each changed program uses one
/// EEPROM write cycle.
#[test]
fn full_set_writes_only_differences() {
    let device = image();
    let wanted = image_with(
        &device,
        &[
            ("cam:2:0", ItemValue::Cam(cam_between(20, 300))),
            ("cam:2:7", ItemValue::Cam(cam_between(3500, 40))),
            ("cam:5:3", ItemValue::Cam(cam_between(305, 400))),
            ("cam:8:1", ItemValue::Cam(cam_between(0, 157))),
            ("cam-mask:8", ItemValue::Mask(0x7F)),
        ],
    );
    let plan = plan_edits(&device, &wanted).unwrap();
    let change = |at, edge, from, to| CamChange { cam: cam(at), edge, from: value(from), to: value(to) };
    let of = |number, cams: Vec<CamChange>, mask| {
        Op::Program(ProgramChange { program: program(number), cams, mask, shift: None })
    };
    let expected = [
        of(
            2,
            vec![
                change(0, Edge::Start, 2, 20),
                change(0, Edge::Stop, 51, 300),
                change(7, Edge::Start, 702, 3500),
                change(7, Edge::Stop, 751, 40),
            ],
            None,
        ),
        of(5, vec![change(3, Edge::Stop, 354, 400)], None),
        of(8, vec![change(1, Edge::Start, 108, 0)], Some((0xFF, 0x7F))),
    ];
    assert_eq!(plan.ops, expected);
    assert_eq!(plan.write_cycles(), 3);
    let touched: Vec<u8> = plan.base.programs.iter().map(|(number, _)| number.get()).collect();
    assert_eq!((touched, plan.base.parameters, plan.base.shift), (vec![2, 5, 8], Some(device.parameters), None));
    assert_eq!(plan.base.programs[0].1, *device.program(program(2)).unwrap());
    let items: Vec<String> = plan.ops.iter().map(Op::item_names).collect();
    assert_eq!(items, ["cam:2:0, cam:2:7", "cam:5:3", "cam-mask:8, cam:8:1"]);
    assert_eq!(plan.ops.iter().map(Op::change_count).sum::<u64>(), 5);
    assert_eq!(logbook_note(&plan.ops[2]), "cam:8:1 start: 108 → 0, cam-mask:8: 0xFF → 0x7F");
}

#[test]
fn stores_all_parameters_once() {
    let device = image();
    let items = [
        ("steps", Number(7200)),
        ("direction", ItemValue::Direction(Direction::Counterclockwise)),
        ("preset", Number(1)),
        ("zero-shift", Number(7)),
    ];
    let plan = plan_edits(&device, &image_with(&device, &items)).unwrap();
    assert_eq!(plan.write_cycles(), 1);
    assert_eq!(plan.base, Base { parameters: Some(device.parameters), ..Base::default() });
    assert_eq!(
        logbook_note(&plan.ops[0]),
        "steps: 3600 → 7200, direction: cw → ccw, preset: 500 → 1, zero-shift: 0 → 7"
    );
    assert_eq!(plan.ops[0].change_count(), 4);
}

/// Each parameter must be within its limits when it is sent: steps ≤ 8192 · turns, and preset < steps (reference 3).
#[test]
fn sends_parameters_in_legal_order() {
    use Parameter::{Preset, Steps, Turns};
    let image = Image::from_parameters(image().parameters);
    let gear = |steps, turns, preset| {
        image_with(&image, &[("steps", Number(steps)), ("revolutions", Number(turns)), ("preset", Number(preset))])
    };
    let cases = [
        ("the range grows", gear(3600, 1, 500), gear(36_000, 10, 500), vec![(Turns, 10), (Steps, 36_000)]),
        ("it becomes shorter", gear(36_000, 10, 500), gear(3600, 1, 500), vec![(Steps, 3600), (Turns, 1)]),
        ("more turns for fewer steps", gear(8192, 1, 0), gear(100, 10, 0), vec![(Steps, 100), (Turns, 10)]),
        ("the preset with it", gear(3600, 1, 500), gear(8192, 1, 8191), vec![(Steps, 8192), (Preset, 8191)]),
        ("the preset before", gear(8192, 1, 8191), gear(3600, 1, 500), vec![(Preset, 500), (Steps, 3600)]),
        ("all of them", gear(81_920, 10, 81_919), gear(4096, 2, 4095), vec![(Preset, 4095), (Steps, 4096), (Turns, 2)]),
    ];
    for (label, device, wanted, order) in cases {
        assert_eq!(sent(&device, &wanted), order, "{label}");
        // The limits are met after every word.
        let Parameters { mut steps, revolutions: mut turns, mut preset, .. } = device.parameters;
        for (parameter, number) in order {
            match parameter {
                Steps => steps = number,
                Turns => turns = number,
                _ => preset = number,
            }
            assert!(steps <= 8192 * turns && preset < steps, "{label}: {parameter:?} {number}");
        }
    }
}

#[test]
fn stores_shift_with_changed_program() {
    let device = image();
    let (zero, eight) = (WindowShift::new(0).unwrap(), WindowShift::new(8).unwrap());
    let items = [("shift", Number(8)), ("cam-mask:3", ItemValue::Mask(1)), ("cam-mask:6", ItemValue::Mask(2))];
    let plan = plan_edits(&device, &image_with(&device, &items)).unwrap();
    let shifts: Vec<_> = plan
        .ops
        .iter()
        .map(|op| match op {
            Op::Program(change) => (change.program.get(), change.shift),
            op => panic!("{op:?}"),
        })
        .collect();
    assert_eq!((shifts, plan.write_cycles()), (vec![(3, Some((zero, eight))), (6, None)], 2));
    assert_eq!(plan.base.shift, Some(zero));
    // Changing only the shift uses one EEPROM write cycle.
    let plan = plan_edits(&device, &image_with(&device, &items[..1])).unwrap();
    assert_eq!((plan.ops[0].item_names().as_str(), logbook_note(&plan.ops[0]).as_str()), ("shift", "shift: 0 → 8"));
    assert_eq!((plan.ops.len(), plan.write_cycles(), plan.base.programs.len()), (1, 1, 1));
}

#[test]
fn invalid_value_error_names_limits() {
    let device = image();
    let refusal = |items: &[(&str, ItemValue)]| plan_edits(&device, &image_with(&device, items)).unwrap_err();
    assert_eq!(refusal(&[("steps", Number(8193))]), GearError::Steps { steps: 8193, turns: 1, most: 8192 }.into());
    assert_eq!(refusal(&[("revolutions", Number(4097))]), GearError::Turns { turns: 4097 }.into());
    let preset = OutOfRange { parameter: Parameter::Preset, value: 3600, low: 0, high: 3599 };
    assert_eq!(refusal(&[("preset", Number(3600))]), preset.into());
    // The preset of 500 does not change, so the new range is too short for it.
    let stays = OutOfRange { value: 500, high: 359, ..preset };
    let short: Vec<(String, ItemValue)> =
        ProgramNumber::all().map(|number| (format!("cam-mask:{}", number.get()), ItemValue::Mask(0))).collect();
    let mut items: Vec<(&str, ItemValue)> = short.iter().map(|(name, mask)| (name.as_str(), *mask)).collect();
    items.push(("steps", Number(360)));
    assert_eq!(refusal(&items), stays.into());
    let start = refusal(&[("cam:2:5", ItemValue::Cam(cam_between(3600, 10)))]);
    let beyond =
        PlanError::CamBeyondRange { item: parse_item("cam:2:5"), edge: Edge::Start, position: 3600, last: 3599 };
    assert_eq!(start, beyond);
    assert_eq!(start.to_string(), "cam:2:5, start: 3600 is outside the range 0 to 3599");
    assert!(plan_edits(&device, &image_with(&device, &[("cam:2:5", ItemValue::Cam(cam_between(3599, 10)))])).is_ok());
}

/// Cams that are not written may lie beyond the new range, unless they are active.
#[test]
fn shorter_range_rejects_cams_out_of_range() {
    let device = image();
    let shorter = image_with(&device, &[("steps", Number(750))]);
    // Cam 7 of program 1 ends at 750, and cam 7 of program 8 at 757.
    let beyond = PlanError::CamBeyondRange { item: parse_item("cam:1:7"), edge: Edge::Stop, position: 750, last: 749 };
    assert_eq!(plan_edits(&device, &shorter), Err(beyond.clone()));
    // The same applies if no programs are to be written.
    let parameters = Image::from_parameters(shorter.parameters);
    assert_eq!(plan_edits(&device, &parameters), Err(beyond));
    let mut resting = shorter;
    for number in ProgramNumber::all() {
        resting.set_value(Item::CamMask(number), ItemValue::Mask(0x7F));
    }
    assert_eq!(plan_edits(&device, &resting).unwrap().write_cycles(), 9);
}

#[test]
fn leaves_unread_values_unchanged() {
    let device = Image::from_parameters(image().parameters);
    let refusal = |items: &[(&str, ItemValue)]| plan_edits(&device, &image_with(&device, items)).unwrap_err();
    assert_eq!(refusal(&[("cam-mask:4", ItemValue::Mask(1))]), PlanError::NotRead { item: parse_item("cam-mask:4") });
    assert_eq!(refusal(&[("shift", Number(8))]), PlanError::NotRead { item: Item::Shift });
    let empty = image_with(&device, &[("cam-mask:4", ItemValue::Mask(1))]);
    let wanted = image_with(&empty, &[("cam:4:2", ItemValue::Cam(cam_between(1, 2)))]);
    assert_eq!(plan_edits(&empty, &wanted), Err(PlanError::NotRead { item: parse_item("cam:4:2") }));
}

#[test]
fn programs_preset_before_each_trigger() {
    let parameters = image().parameters;
    let plan = plan_preset(&parameters, 500).unwrap();
    let again = ParameterChange { parameter: Parameter::Preset, from: 500, to: 500 };
    assert_eq!(plan.ops, [Op::Parameterise(vec![again]), Op::FirePreset { value: 500 }]);
    assert_eq!((plan.write_cycles(), plan.base.parameters), (1, Some(parameters)));
    assert!(matches!(plan_preset(&parameters, 3600), Err(PlanError::OutOfRange(_))));
    let plan = plan_default(&parameters);
    assert_eq!((plan.ops, plan.base.parameters), (vec![Op::Default], Some(parameters)));
}
