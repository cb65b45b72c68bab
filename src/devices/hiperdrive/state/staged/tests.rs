//! Tests of edits, undo steps and drafts.

use super::{Edit, EditError, EditFinding, LimitsPolicy, SavedEdit, StagedEdits, ValueDifference};
use crate::app::PendingEdits;
use crate::devices::hiperdrive::profile::Image;
use crate::devices::hiperdrive::protocol::{DriveNumber, Family, ParameterNumber, ParameterRange, PositionScale};

const ONE: DriveNumber = DriveNumber::FIRST;

fn number(number: u16) -> ParameterNumber {
    ParameterNumber::new(number).unwrap()
}

fn image(values: &[(u16, i64)]) -> Image {
    Image { values: values.iter().map(|(own, value)| (number(*own), *value)).collect() }
}

/// Returns the values of a drive with factory scaling, limits of ±511 turns, a speed and a jog step.
fn read() -> Image {
    image(&[(24, 0), (154, 256), (156, 1), (158, -33_488_896), (160, 33_488_896), (166, 350), (170, 4096), (186, 20)])
}

fn staged() -> StagedEdits {
    let mut staged = StagedEdits::default();
    staged.refresh(read());
    staged
}

#[test]
fn undoes_edit() {
    let mut staged = staged();
    assert!(!staged.is_dirty() && !staged.can_undo());
    assert_eq!(staged.apply_edit(&Edit::Set(number(166), 200)), Ok(true));
    assert_eq!(staged.apply_edit(&Edit::Set(number(166), 200)), Ok(false), "nothing is other than before");
    assert_eq!(staged.apply_edit(&Edit::Set(number(170), -64)), Ok(true));
    assert_eq!(staged.differences()[0], ValueDifference { number: number(166), from: Some(350), to: Some(200) });
    assert_eq!(staged.changed_values(), image(&[(166, 200), (170, -64)]));
    assert!(staged.undo() && staged.undo() && !staged.undo());
    assert!(!staged.is_dirty());
    assert!(staged.redo());
    assert_eq!(staged.value(number(166)), Some(200));
    assert_eq!(staged.apply_edit(&Edit::Revert(number(166))), Ok(true));
    assert!(!staged.is_dirty() && !staged.can_redo());
}

#[test]
fn rejects_invalid_edits() {
    let mut staged = staged();
    let out = |staged: &mut StagedEdits, own, value| match staged.apply_edit(&Edit::Set(number(own), value)) {
        Err(EditError::OutOfRange(error)) => (error.value, error.range),
        other => panic!("{other:?}"),
    };
    // The ranges are 5 to 350, and 1 to 100 or 255 (reference, section 4).
    assert_eq!(out(&mut staged, 166, 351), (351, ParameterRange::Within(5, 350)));
    assert_eq!(out(&mut staged, 186, 101), (101, ParameterRange::WithinOrEqual(1, 100, 255)));
    assert_eq!(staged.apply_edit(&Edit::Set(number(107), 0)), Err(EditError::NotAValue(number(107))), "it is read");
    assert_eq!(
        staged.apply_edit(&Edit::Set(number(198), 0)),
        Err(EditError::NotAValue(number(198))),
        "a separate change"
    );
    assert_eq!(staged.apply_edit(&Edit::Set(number(104), 0)), Err(EditError::NotAValue(number(104))), "it moves");
    assert_eq!(
        staged.apply_edit(&Edit::Set(number(266), 100)),
        Err(EditError::NotRead(number(266))),
        "no second drive"
    );
    assert_eq!(staged.apply_edit(&Edit::Set(number(44), 100)), Err(EditError::Unknown(number(44))));
    let crossed = Edit::Limits { drive: ONE, lower: 5, upper: 5 };
    assert_eq!(staged.apply_edit(&crossed), Err(EditError::Crossed { lower: 5, upper: 5 }));
    assert_eq!(StagedEdits::default().apply_edit(&crossed), Err(EditError::NothingRead));
    assert!(!staged.is_dirty());
}

/// A value beyond the travel is rejected when entered. If it results from a scale or a profile, it is marked. The ±512
/// turns of an HDA30 are 33554432 steps at 65536 steps per turn, and 204800 at 400 (issue 21.10).
#[test]
fn rejects_limits_beyond_travel() {
    let mut staged = staged();
    staged.set_families([(ONE, Family::Short)].into());
    let out = |staged: &mut StagedEdits, edit: Edit| match staged.apply_edit(&edit) {
        Err(EditError::OutOfRange(error)) => (error.number.get(), error.value, error.range),
        other => panic!("{other:?}"),
    };
    let within = |most: i64| ParameterRange::Within(-most, most);
    assert_eq!(out(&mut staged, Edit::Set(number(158), -33_554_433)), (158, -33_554_433, within(33_554_432)));
    let limits = Edit::Limits { drive: ONE, lower: 0, upper: 40_000_000 };
    assert_eq!(out(&mut staged, limits), (160, 40_000_000, within(33_554_432)));
    assert_eq!(out(&mut staged, Edit::Set(number(170), 1 << 30)), (170, 1 << 30, within(67_108_864)));
    assert_eq!(staged.apply_edit(&Edit::Set(number(158), -33_554_432)), Ok(true));
    let hundredths = PositionScale::new(400, 256).unwrap();
    staged.apply_edit(&Edit::Scale { drive: ONE, scale: hundredths, limits: LimitsPolicy::InPlace }).unwrap();
    assert_eq!((staged.value(number(158)), staged.findings(|_| None)), (Some(-204_800), vec![]));
    assert_eq!(out(&mut staged, Edit::Set(number(160), 204_801)), (160, 204_801, within(204_800)));
    assert!(staged.undo() && staged.undo() && !staged.is_dirty());
    staged.apply_edit(&Edit::Scale { drive: ONE, scale: hundredths, limits: LimitsPolicy::AsNumbers }).unwrap();
    assert!(matches!(staged.findings(|_| None)[..], [EditFinding::LimitsMove { .. }]), "that they move is told, once");
    let mut profile = StagedEdits::for_profile(image(&[(154, 400), (156, 256), (158, -204_801), (160, 204_800)]));
    profile.set_families([(ONE, Family::Short)].into());
    let [EditFinding::OutOfRange(error)] = profile.findings(|_| None)[..] else { panic!() };
    assert_eq!((error.number.get(), error.range), (158, within(204_800)));
}

#[test]
fn edits_survive_rereading() {
    let mut staged = staged();
    staged.apply_edit(&Edit::Set(number(166), 200)).unwrap();
    staged.apply_edit(&Edit::Set(number(24), 7)).unwrap();
    let mut now = read();
    now.values.extend(image(&[(24, 7), (186, 30)]).values);
    staged.refresh(now);
    assert_eq!(staged.changed_values(), image(&[(166, 200)]), "24 is as it was wanted");
    assert_eq!((staged.value(number(186)), staged.previous_value(number(186))), (Some(30), Some(20)));
    assert_eq!(staged.previous_value(number(166)), None);
    staged.undo();
    assert_eq!(staged.value(number(186)), Some(30), "in the steps before too");
    let mut without = read();
    without.values.remove(&number(166));
    staged.apply_edit(&Edit::Set(number(166), 100)).unwrap();
    staged.refresh(without);
    assert_eq!(staged.value(number(166)), None, "of what is not there nothing is wanted");
}

#[test]
fn draft_waits_for_its_parameters() {
    let mut first = staged();
    first.apply_edit(&Edit::Set(number(166), 200)).unwrap();
    let kept = first.saved_edits();
    assert_eq!(kept, [SavedEdit(166, Some(200))]);
    let mut later = StagedEdits::default();
    later.take_draft(kept.into_iter().chain([
        SavedEdit(266, Some(7)),
        SavedEdit(198, Some(0)),
        SavedEdit(9999, Some(1)),
    ]));
    assert!(!later.is_dirty());
    later.refresh(read());
    assert_eq!(later.changed_values(), image(&[(166, 200)]));
    assert_eq!(
        later.saved_edits(),
        [SavedEdit(166, Some(200)), SavedEdit(266, Some(7))],
        "the second drive may be plugged in again"
    );
}

#[test]
fn new_scale_converts_or_moves_limits() {
    let hundredths = PositionScale::new(400, 256).unwrap();
    let mut along = staged();
    along.apply_edit(&Edit::Scale { drive: ONE, scale: hundredths, limits: LimitsPolicy::InPlace }).unwrap();
    // 511 turns of 400 steps.
    assert_eq!(along.changed_values(), image(&[(154, 400), (156, 256), (158, -204_400), (160, 204_400)]));
    // 600 turns are 240 000 steps at 400 steps per turn, which is outside the new limits.
    assert!(along.findings(|_| Some(0)).is_empty());
    let outside = along.findings(|_| Some(600 * 65536));
    let expected = EditFinding::Outside { drive: ONE, position: 240_000, lower: -204_400, upper: 204_400 };
    assert_eq!(outside, [expected]);

    let mut moved = staged();
    moved.apply_edit(&Edit::Scale { drive: ONE, scale: hundredths, limits: LimitsPolicy::AsNumbers }).unwrap();
    let [EditFinding::LimitsMove { lower, upper, .. }] = moved.findings(|_| Some(0))[..] else { panic!() };
    // 33 488 896 steps at 400 steps per turn.
    assert_eq!((lower, upper), ((-511.0, -83_722.24), (511.0, 83_722.24)));
    assert!(moved.undo() && !moved.is_dirty(), "one step");
}

#[test]
fn marks_questionable_values() {
    let mut profile = StagedEdits::for_profile(image(&[(158, 10), (160, 10), (166, 999), (186, 255)]));
    let marks = profile.findings(|_| None);
    assert!(matches!(marks[0], EditFinding::OutOfRange(error) if error.number == number(166)));
    assert_eq!(
        marks[1..],
        [EditFinding::Crossed { drive: ONE, lower: 10, upper: 10 }, EditFinding::NoTimeout { drive: ONE }]
    );
    assert_eq!(marks[1].parameters(), [number(158), number(160)]);
    assert_eq!(profile.apply_edit(&Edit::Leave(number(166))), Ok(true));
    assert_eq!(profile.apply_edit(&Edit::Set(number(266), 100)), Ok(true), "a profile can be made to say it");
    assert_eq!(
        profile.apply_edit(&Edit::Set(number(170), 1)),
        Err(EditError::NotAValue(number(170))),
        "it is not kept"
    );
    assert_eq!(profile.saved_edits(), [SavedEdit(166, None), SavedEdit(266, Some(100))]);
}
