//! Tests of the order of writes, and of rejections and warnings, against the rules in the manual.

use super::*;
use crate::devices::hiperdrive::profile::test_profiles::{drive, identity, image, image_with_values, parameter};
use crate::devices::hiperdrive::profile::{Warning, plan_warnings};
use crate::devices::hiperdrive::protocol::{ParameterRange, Variant};

/// Returns the writes of a plan in order. A service is listed as a write of its code to parameter 47.
fn steps(plan: &HiperdrivePlan) -> Vec<(u16, i64)> {
    let step = |op: &Op| match op {
        Op::Write { number, new, .. } => (number.get(), *new),
        Op::Service(service) => (47, service.code().unwrap()),
        Op::Network { .. } => panic!(),
    };
    plan.ops.iter().map(step).collect()
}

fn at(place: u8, position: i32) -> Positions {
    [(drive(place), position)].into()
}

/// Returns the state of a hub with HDA30A drives in ports 1 and 3.
fn state(image: &Image, positions: &Positions) -> DeviceState {
    let identity = identity("100", &[(1, "4711"), (3, "4712")]);
    DeviceState { identity, image: image.clone(), positions: positions.clone() }
}

fn plan_edits(device: &Image, wanted: &Image, positions: &Positions) -> Result<HiperdrivePlan, PlanError> {
    super::plan_edits(&state(device, positions), wanted)
}

fn plan_set_position(device: &Image, drive: DriveNumber, position: i32) -> Result<HiperdrivePlan, PlanError> {
    super::plan_set_position(&state(device, &Positions::new()), drive, position)
}

fn plan(wanted: &[(u16, i64)], position: i32) -> Result<HiperdrivePlan, PlanError> {
    plan_edits(&image(&[1, 3]), &image_with_values(wanted), &at(1, position))
}

#[test]
fn writes_nothing_without_differences() {
    let device = image(&[1, 3]);
    let plan = plan_edits(&device, &device, &at(1, 0)).unwrap();
    assert_eq!((plan.is_empty(), plan.write_cycles(), plan.base), (true, 0, Base::default()));
}

#[test]
fn writes_and_saves_differences_once() {
    let plan = plan(&[(24, 5), (26, 7), (166, 200), (366, 100)], 0).unwrap();
    assert_eq!(steps(&plan), [(24, 5), (166, 200), (366, 100), (47, 1)]);
    assert_eq!(plan.write_cycles(), 1);
    assert_eq!(plan.ops[1], Op::Write { number: parameter(166), old: Some(350), new: 200 });
    assert_eq!(plan.base.values, image_with_values(&[(24, 0), (166, 350), (366, 350)]).values);
    assert_eq!(steps(&plan.without_save()), [(24, 5), (166, 200), (366, 100)]);
}

#[test]
fn volatile_parameters_need_no_save() {
    let device = image(&[1]).with_overlay(&image_with_values(&[(170, 4096)]));
    let plan = plan_edits(&device, &image_with_values(&[(170, 100)]), &Positions::new()).unwrap();
    assert_eq!((steps(&plan), plan.write_cycles()), (vec![(170, 100)], 0));
}

#[test]
fn writes_scale_before_speed_and_limits() {
    let wanted = [(152, 1), (154, 400), (156, 256), (158, -1000), (160, 1000), (162, 1), (166, 200), (186, 10)];
    let plan = plan(&wanted, 0).unwrap();
    let expected = [(156, 256), (154, 400), (162, 1), (166, 200), (158, -1000), (160, 1000), (186, 10), (47, 1)];
    assert_eq!(steps(&plan), expected);
}

#[test]
fn requests_drive_first_and_releases_last() {
    let device = image(&[1, 3]).with_overlay(&image_with_values(&[(152, 0)]));
    let wanted = image_with_values(&[(24, 1), (152, 1), (166, 200), (352, 0), (366, 200)]);
    let plan = plan_edits(&device, &wanted, &Positions::new()).unwrap();
    assert_eq!(steps(&plan), [(152, 1), (24, 1), (166, 200), (366, 200), (352, 0), (47, 1)]);
    assert_eq!(plan_warnings(&plan), [Warning::NotRequested(drive(3))]);
}

/// The cases list the old limits, the position, the new limits, and the order of writes that the drive accepts. After
/// each write, parameter 160 must be above 158, with the position between them (reference, section 4).
#[test]
fn writes_limits_in_accepted_order() {
    let cases = [
        ("closer", (-1000, 1000), 0, (-100, 100), [158, 160]),
        ("wider", (-100, 100), 0, (-1000, 1000), [158, 160]),
        ("up, past the old upper limit", (-100, 100), 100, (100, 300), [160, 158]),
        ("down, past the old lower limit", (-100, 100), -100, (-300, -100), [158, 160]),
        ("the drive above both", (-100, 100), 200, (150, 300), [160, 158]),
        ("the drive below both", (-100, 100), -200, (-300, -150), [158, 160]),
        ("the drive above, overlapping", (-100, 100), 200, (0, 300), [160, 158]),
    ];
    for (name, old, position, new, order) in cases {
        let device = image(&[1]).with_overlay(&image_with_values(&[(158, old.0), (160, old.1)]));
        let wanted = image_with_values(&[(158, new.0), (160, new.1)]);
        let plan = plan_edits(&device, &wanted, &at(1, position)).unwrap();
        let (mut lower, mut upper) = old;
        let mut written = Vec::new();
        for (own, value) in steps(&plan) {
            match own {
                158 => lower = value,
                160 => upper = value,
                _ => continue,
            }
            written.push(own);
            let is_between = lower <= position.into() && i64::from(position) <= upper;
            assert!(lower < upper && is_between, "{name}: {own} = {value}");
        }
        assert_eq!(written, order, "{name}");
    }
}

proptest::proptest! {
    /// For any limits and any position, each write leaves the limits in order and the position between them.
    #[test]
    fn arbitrary_limits_have_accepted_order(
        old in (-100i64..100, 1i64..100),
        new in (-100i64..100, 1i64..100),
        position in -110i32..110,
    ) {
        let (old, new) = ((old.0, old.0 + old.1), (new.0, new.0 + new.1));
        let device = image(&[1]).with_overlay(&image_with_values(&[(158, old.0), (160, old.1)]));
        let plan = plan_edits(&device, &image_with_values(&[(158, new.0), (160, new.1)]), &at(1, position));
        let is_inside = (new.0..=new.1).contains(&i64::from(position));
        // Without differences, nothing is checked.
        proptest::prop_assert_eq!(plan.is_ok(), is_inside || old == new);
        let mut limits = old;
        for (own, value) in plan.iter().flat_map(steps) {
            match own {
                158 => limits.0 = value,
                160 => limits.1 = value,
                _ => continue,
            }
            proptest::prop_assert!(limits.0 < limits.1 && (limits.0..=limits.1).contains(&i64::from(position)));
        }
    }
}

#[test]
fn rejects_limits_that_exclude_position() {
    let refused = |wanted: &[(u16, i64)], position| plan(wanted, position).unwrap_err();
    let outside = |position, lower, upper| PlanError::PositionOutside { drive: drive(1), position, lower, upper };
    assert_eq!(refused(&[(158, 0), (160, 1000)], -1), outside(-1, 0, 1000));
    assert_eq!(refused(&[(160, 1000)], 1001), outside(1001, -33_488_896, 1000));
    // 163840 steps are 2.5 turns, which are 1000 steps at 400 steps per turn.
    assert_eq!(refused(&[(154, 400), (156, 256), (158, 0), (160, 999)], 163_840), outside(1000, 0, 999));
    assert!(plan(&[(154, 400), (156, 256), (158, 0), (160, 1000)], 163_840).is_ok());
    // Position −1 at 65536 steps per turn is within step −1 at 400 steps per turn, which reaches from −1/400 turn to 0.
    assert_eq!(refused(&[(154, 400), (156, 256), (158, 0), (160, 999)], -1), outside(-1, 0, 999));
    // The position of another drive has no effect.
    assert!(plan_edits(&image(&[1, 3]), &image_with_values(&[(358, 0)]), &at(1, -1)).is_ok());
}

#[test]
fn rejects_position_beyond_new_scale() {
    // 500 turns of 65536 steps, times 255.996: 500 · 256 · 65535 = 8388480000.
    let error = plan(&[(154, 65_535)], 32_768_000).unwrap_err();
    assert_eq!(error, PlanError::PositionTooLarge { drive: drive(1), position: 8_388_480_000 });
}

#[test]
fn rejects_crossed_limits() {
    for (lower, upper) in [(100, 100), (101, 100)] {
        let error = plan(&[(158, lower), (160, upper)], 100).unwrap_err();
        assert_eq!(error, PlanError::LimitsCrossed { drive: drive(1), lower, upper });
    }
    assert!(plan(&[(158, 99), (160, 100)], 100).is_ok());
}

#[test]
fn rejects_unwritable_parameters() {
    let device =
        image(&[1]).with_overlay(&image_with_values(&[(101, 0), (104, 0), (105, 0), (107, 0), (47, 0), (199, 0)]));
    let refused = |own, value| plan_edits(&device, &image_with_values(&[(own, value)]), &Positions::new()).unwrap_err();
    let item = |own| Item(parameter(own));
    assert_eq!(refused(101, 0x0400), PlanError::Moves { item: item(101) });
    assert_eq!(refused(104, 1), PlanError::Moves { item: item(104) });
    assert_eq!(refused(107, 1), PlanError::ReadOnly { item: item(107) });
    for own in [47, 198, 199] {
        assert_eq!(refused(own, 1), PlanError::Acts { item: item(own) }, "{own}");
    }
    assert_eq!(refused(352, 1), PlanError::NotRead { item: item(352) });
    let PlanError::OutOfRange(error) = refused(166, 351) else { panic!() };
    assert_eq!((error.value, error.range), (351, ParameterRange::Within(5, 350)));
    let PlanError::OutOfRange(error) = refused(158, 1 << 31) else { panic!() };
    // 512 turns of 65536 steps.
    assert_eq!(error.range, ParameterRange::Within(-33_554_432, 33_554_432));
}

/// The ±512 turns of an HDA30 are 33554432 steps at 65536 steps per turn, or 204800 at 400 steps per turn. A jog step
/// of the keys on the drive can be up to the whole travel of 1024 turns (issue 21.10).
#[test]
fn plans_no_limit_beyond_travel() {
    let jogs = |image: Image| image.with_overlay(&image_with_values(&[(170, 4096), (176, -4096)]));
    let scaled = image(&[1, 3]).with_overlay(&image_with_values(&[(154, 400), (156, 256), (158, -1000), (160, 1000)]));
    let factory = image(&[1, 3]);
    type Case<'c> = (&'c Image, &'c [(u16, i64)], Option<(u16, i64)>);
    let cases: [Case<'_>; 12] = [
        (&factory, &[(158, -33_554_432), (160, 33_554_432)], None),
        (&factory, &[(158, -33_554_433)], Some((158, 33_554_432))),
        (&factory, &[(360, 33_554_433)], Some((360, 33_554_432))),
        (&scaled, &[(158, -204_800), (160, 204_800)], None),
        (&scaled, &[(158, -204_801)], Some((158, 204_800))),
        (&scaled, &[(160, 204_801)], Some((160, 204_800))),
        // The scale changes in the same plan, in both directions.
        (&factory, &[(154, 400), (156, 256), (160, 204_801)], Some((160, 204_800))),
        (&scaled, &[(154, 256), (156, 1), (158, -33_554_432), (160, 33_554_432)], None),
        (&factory, &[(170, 67_108_864), (176, -67_108_864)], None),
        (&factory, &[(170, 67_108_865)], Some((170, 67_108_864))),
        (&scaled, &[(176, -409_601)], Some((176, 409_600))),
        // Limits that are not written are not checked. They move with the scale, and the plan warns of this.
        (&factory, &[(154, 400), (156, 256)], None),
    ];
    for (device, wanted, refused) in cases {
        let planned = plan_edits(&jogs(device.clone()), &image_with_values(wanted), &at(1, 0));
        match (planned, refused) {
            (Ok(_), None) => {}
            (Err(PlanError::OutOfRange(error)), Some((own, most))) => {
                assert_eq!(
                    (error.number, error.range),
                    (parameter(own), ParameterRange::Within(-most, most)),
                    "{wanted:?}"
                );
            }
            (planned, _) => panic!("{wanted:?}: {planned:?}"),
        }
    }
    // An unknown variant is limited by the 32 bits only. An HDA70 has 16000 turns.
    for (variant, most) in [(Variant::OTHER, i64::from(i32::MAX)), (Variant::new(13), 1_048_576_000)] {
        let mut state = state(&factory, &at(1, 0));
        state.identity.drives[0].variant = Some(variant);
        assert!(super::plan_edits(&state, &image_with_values(&[(160, most)])).is_ok(), "{variant:?}");
        let error = super::plan_edits(&state, &image_with_values(&[(160, most + 1)])).unwrap_err();
        let PlanError::OutOfRange(error) = error else { panic!("{error}") };
        assert!(matches!(error.range, ParameterRange::Within(_, high) if high == most), "{variant:?}");
    }
    // Even if a change of scale moves the limits beyond the travel, no position beyond the travel can be set.
    let moved = image(&[1]).with_overlay(&image_with_values(&[(154, 400), (156, 256)]));
    let PlanError::OutOfRange(error) = plan_set_position(&moved, drive(1), 300_000).unwrap_err() else { panic!() };
    assert_eq!((error.number, error.range), (parameter(198), ParameterRange::Within(-204_800, 204_800)));
}

#[test]
fn warns_when_scale_moves_limits() {
    let warned = |wanted: &[(u16, i64)]| plan_warnings(&plan(wanted, 0).unwrap());
    // 511 turns of 65536 steps are 33488896 steps, which are 83722.24 turns of 400 steps.
    let moved = warned(&[(154, 400), (156, 256)]);
    let [Warning::LimitsMove { drive: of, now, then }] = moved.as_slice() else { panic!("{moved:?}") };
    assert_eq!((*of, *now), (drive(1), (-511.0, 511.0)));
    assert!((then.0 + 83_722.24).abs() < 1e-6 && (then.1 - 83_722.24).abs() < 1e-6, "{then:?}");
    // 511 turns of 400 steps.
    assert_eq!(warned(&[(154, 400), (156, 256), (158, -204_400), (160, 204_400)]), []);
    assert_eq!(warned(&[(158, -204_400)]), [], "the scale is as it was");
    // The same scale as a different fraction.
    assert_eq!(warned(&[(154, 512), (156, 2)]), []);
}

#[test]
fn warns_about_plan_side_effects() {
    let warned = |wanted: &[(u16, i64)]| plan_warnings(&plan(wanted, 0).unwrap());
    assert_eq!(warned(&[(186, 255)]), [Warning::NoTimeout(drive(1))]);
    assert_eq!(warned(&[(390, 9600)]), [Warning::AfterReset(Item(parameter(390)))]);
    assert_eq!(warned(&[(166, 200), (186, 100)]), []);
}

/// Positions are rounded to 64 steps (reference, section 5): 31 → 0, 33 → 64, 100 → 128, −33 → −64.
#[test]
fn rounds_position_to_multiple_of_64() {
    for (position, becomes) in [(31, 0), (33, 64), (100, 128), (-33, -64), (163_840, 163_840)] {
        let plan = plan_set_position(&image(&[1, 3]), drive(3), position).unwrap();
        assert_eq!(steps(&plan), [(398, becomes), (47, 1)], "{position}");
        assert_eq!(plan.base.values.keys().map(|own| own.get()).collect::<Vec<_>>(), [354, 356, 358, 360, 398]);
    }
}

#[test]
fn rejects_set_position_beyond_limits() {
    let device = image(&[1]).with_overlay(&image_with_values(&[(158, 0), (160, 100)]));
    let refused = |position| plan_set_position(&device, drive(1), position).map(|plan| steps(&plan)).unwrap_err();
    let outside =
        |position, becomes| PlanError::ReferenceOutside { drive: drive(1), position, becomes, lower: 0, upper: 100 };
    assert_eq!(refused(-33), outside(-33, -64));
    assert_eq!(refused(100), outside(100, 128), "inside, but not once it is rounded");
    assert_eq!(refused(i32::MAX), outside(i32::MAX, 2_147_483_648));
    assert!(plan_set_position(&device, drive(1), 95).is_ok());
    let error = plan_set_position(&device, drive(2), 0).unwrap_err();
    assert_eq!(error, PlanError::NotRead { item: Item(parameter(298)) });
}

#[test]
fn service_plans_check_affected_values() {
    let device = image(&[1]);
    for (service, code, cost) in
        [(Service::Save, 1, 1), (Service::Factory, -1, 0), (Service::FactoryAll, -3, 1), (Service::Recall, -2, 0)]
    {
        let plan = plan_service(&device, service);
        assert_eq!((steps(&plan), plan.write_cycles()), (vec![(47, code)], cost));
        assert_eq!((plan.base.values, Service::from_code(code)), (device.values.clone(), Some(service)));
    }
    let plan = plan_service(&device, Service::Acknowledge(drive(1)));
    assert_eq!((plan.base, plan.ops.len()), (Base::default(), 1));
}
