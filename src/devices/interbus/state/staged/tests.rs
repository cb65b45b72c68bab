//! Tests of edits, undo steps and drafts of a K3 encoder.

use super::{Edit, EditError, EditFinding, EditedValues, SavedEdit, StagedEdits, ValueDifference, ValueId};
use crate::app::PendingEdits;
use crate::devices::interbus::profile::{CamNames, Direction, Edge, Image, ImportedProgram, Parameters};
use crate::devices::interbus::protocol::{
    Cam, CamNumber, GearError, Parameter, Program, ProgramNumber, Value, WindowShift,
};

fn parameters(steps: u32, revolutions: u32) -> Parameters {
    Parameters { steps, revolutions, direction: Direction::Clockwise, preset: 0, zero_shift: 0 }
}

fn number(program: u8) -> ProgramNumber {
    ProgramNumber::new(program).unwrap()
}

fn cam(cam: u8) -> CamNumber {
    CamNumber::new(cam).unwrap()
}

fn edges(start: u32, stop: u32) -> Cam {
    Cam { start: Value::new(start).unwrap(), stop: Value::new(stop).unwrap() }
}

/// Returns a program in which cam i is on from 100·i to 100·i + 50. Only cams 0 and 3 are active.
fn program() -> Program {
    let cams = [0, 1, 2, 3, 4, 5, 6, 7].map(|cam| Some(edges(100 * cam, 100 * cam + 50)));
    Program { cams, mask: 0b1001 }
}

/// Returns the edits of an encoder with 1000 steps, of which program 1 has been read.
fn staged() -> StagedEdits {
    let mut staged = StagedEdits::default();
    staged.refresh_parameters(parameters(1000, 1));
    staged.refresh_programs(&[(number(1), program())], WindowShift::new(8));
    staged
}

fn edge(program: u8, own: u8, edge: Edge, to: u32) -> Edit {
    Edit::Edge { program: number(program), cam: cam(own), edge, to }
}

fn name(own: u8, name: &str) -> Edit {
    Edit::Name { program: number(1), cam: cam(own), name: name.to_owned() }
}

fn cam_edges(staged: &StagedEdits, own: u8) -> (u32, u32) {
    let cam = staged.edited_values().unwrap().cam(number(1), cam(own)).unwrap();
    (cam.start.get(), cam.stop.get())
}

#[test]
fn edits_do_not_touch_encoder() {
    let mut staged = staged();
    assert!(!staged.is_dirty() && staged.differences().is_empty());
    assert_eq!(staged.apply_edit(&edge(1, 3, Edge::Stop, 399)), Ok(true));
    assert_eq!(staged.apply_edit(&Edit::Switch { program: number(1), cam: cam(7), on: true }), Ok(true));
    assert_eq!(staged.apply_edit(&Edit::Direction(Direction::Counterclockwise)), Ok(true));
    assert_eq!(
        staged.apply_edit(&Edit::Direction(Direction::Counterclockwise)),
        Ok(false),
        "nothing is other than before"
    );
    let differs = |place, from, to| ValueDifference { place, from: Some(from), to: Some(to) };
    let expected = [
        differs(ValueId::Parameter(Parameter::Direction), 3, 4),
        differs(ValueId::Edge(number(1), cam(3), Edge::Stop), 350, 399),
        differs(ValueId::On(number(1), cam(7)), 0, 1),
    ];
    assert_eq!(staged.differences(), expected);
    assert!(staged.is_edited(number(1), cam(3)) && !staged.is_edited(number(1), cam(4)));
    assert!(staged.is_program_edited(number(1)) && !staged.is_program_edited(number(2)));
    assert_eq!(staged.device().unwrap().program(number(1)), Some(&program()));
}

#[test]
fn rejected_edits_name_limits() {
    let mut staged = StagedEdits::default();
    assert_eq!(staged.apply_edit(&Edit::Preset(1)), Err(EditError::NothingRead));
    staged = self::staged();
    let beyond = |parameter, value, low, high| {
        EditError::Parameter(crate::devices::interbus::protocol::OutOfRange { parameter, value, low, high })
    };
    let cases = [
        (Edit::Steps(8193), EditError::Gear(GearError::Steps { steps: 8193, turns: 1, most: 8192 })),
        (Edit::Steps(0), EditError::Gear(GearError::Steps { steps: 0, turns: 1, most: 8192 })),
        (Edit::Revolutions(4097), EditError::Gear(GearError::Turns { turns: 4097 })),
        (Edit::Preset(1000), beyond(Parameter::Preset, 1000, 0, 999)),
        // The zero shift must be within the measuring range (issue 22.6).
        (Edit::ZeroShift(1000), beyond(Parameter::ZeroShift, 1000, 0, 999)),
        (edge(1, 0, Edge::Start, 1000), EditError::Edge { edge: Edge::Start, to: 1000, last: 999 }),
        (edge(1, 0, Edge::Stop, u32::MAX), EditError::Edge { edge: Edge::Stop, to: u32::MAX, last: 999 }),
        (edge(2, 0, Edge::Start, 5), EditError::NotRead(number(2))),
        (Edit::Mirror(number(2)), EditError::NotRead(number(2))),
        (Edit::Copy { from: number(2), to: number(1) }, EditError::NotRead(number(2))),
        (Edit::Copy { from: number(1), to: number(8) }, EditError::NotRead(number(8))),
        (name(0, "a\nb"), EditError::Name),
        (name(0, &"n".repeat(41)), EditError::Name),
    ];
    for (edit, why) in cases {
        assert_eq!(staged.apply_edit(&edit), Err(why), "{edit:?}");
    }
    assert!(!staged.is_dirty() && !staged.can_undo());
    let mut unread = StagedEdits::default();
    unread.refresh_parameters(parameters(1000, 1));
    assert_eq!(unread.apply_edit(&Edit::Shift(WindowShift::default())), Err(EditError::ShiftNotRead));
}

#[test]
fn gear_parts_can_change_together() {
    let mut staged = staged();
    assert_eq!(staged.apply_edit(&Edit::Gear { steps: 40_960, revolutions: 10 }), Ok(true));
    let refused = GearError::Steps { steps: 40_960, turns: 4, most: 32_768 };
    assert_eq!(staged.apply_edit(&Edit::Revolutions(4)), Err(EditError::Gear(refused)));
    assert_eq!(staged.apply_edit(&Edit::Gear { steps: 0x1FF_FFFF, revolutions: 4096 }), Ok(true));
}

#[test]
fn copies_mirrors_and_shifts_programs() {
    let mut staged = staged();
    staged.refresh_programs(&[(number(5), Program { cams: [Some(edges(0, 0)); 8], mask: 0 })], None);
    staged.apply_edit(&name(3, " feed ")).unwrap();
    // 999 - 350 = 649 and 999 - 300 = 699.
    staged.apply_edit(&Edit::Mirror(number(1))).unwrap();
    assert_eq!((cam_edges(&staged, 0), cam_edges(&staged, 3)), ((949, 999), (649, 699)));
    // 949 + 60 = 1009 and 999 + 60 = 1059, both reduced by the range of 1000.
    staged.apply_edit(&Edit::Rotate { program: number(1), by: 60 }).unwrap();
    assert_eq!((cam_edges(&staged, 0), cam_edges(&staged, 3)), ((9, 59), (709, 759)));
    staged.apply_edit(&Edit::Rotate { program: number(1), by: -1_000_020 }).unwrap();
    assert_eq!(cam_edges(&staged, 0), (989, 39), "over the end");
    staged.apply_edit(&Edit::Copy { from: number(1), to: number(5) }).unwrap();
    let wanted = staged.edited_values().unwrap();
    assert_eq!(wanted.image.program(number(5)), wanted.image.program(number(1)));
    assert_eq!(wanted.name(number(5), cam(3)), Some("feed"));
}

#[test]
fn enabled_cam_beyond_range_blocks_mirroring() {
    let mut staged = staged();
    staged.apply_edit(&Edit::Steps(340)).unwrap();
    let refused = EditError::Beyond { program: number(1), cam: cam(3), last: 339 };
    assert_eq!(staged.apply_edit(&Edit::Mirror(number(1))), Err(refused.clone()));
    assert_eq!(staged.apply_edit(&Edit::Rotate { program: number(1), by: 1 }), Err(refused));
    staged.apply_edit(&Edit::Switch { program: number(1), cam: cam(3), on: false }).unwrap();
    staged.apply_edit(&Edit::Mirror(number(1))).unwrap();
    assert_eq!((cam_edges(&staged, 0), cam_edges(&staged, 3)), ((289, 339), (300, 350)), "that one stays where it is");
}

#[test]
fn table_import_is_one_edit() {
    let mut staged = staged();
    let mut filled = ImportedProgram { program: number(1), cams: [None; 8], names: Default::default() };
    filled.cams[1] = Some(edges(900, 20));
    filled.names[1] = "glue".to_owned();
    staged.apply_edit(&Edit::Table(vec![filled.clone()])).unwrap();
    let wanted = staged.edited_values().unwrap();
    assert_eq!(wanted.image.program(number(1)).unwrap().mask, 0b10);
    assert_eq!(cam_edges(&staged, 1), (900, 20));
    assert_eq!(cam_edges(&staged, 0), (0, 50), "its edges cost nothing where they are");
    filled.cams[4] = Some(edges(0, 1000));
    let refused = EditError::Edge { edge: Edge::Stop, to: 1000, last: 999 };
    assert_eq!(staged.apply_edit(&Edit::Table(vec![filled])), Err(refused));
    assert!(staged.undo() && !staged.is_dirty() && !staged.undo());
}

#[test]
fn undoes_and_redoes_edits() {
    let mut staged = staged();
    for to in [310, 320, 330] {
        staged.apply_edit(&edge(1, 3, Edge::Start, to)).unwrap();
    }
    assert!(staged.undo() && staged.undo());
    assert_eq!(cam_edges(&staged, 3), (310, 350));
    assert!(staged.redo());
    assert_eq!(cam_edges(&staged, 3), (320, 350));
    staged.apply_edit(&edge(1, 3, Edge::Start, 0)).unwrap();
    assert!(!staged.redo(), "another way was taken");
    staged.discard_all();
    assert!(!staged.is_dirty());
    assert!(staged.undo());
    assert_eq!(cam_edges(&staged, 3), (0, 350));
    for to in 0..500 {
        staged.apply_edit(&edge(1, 0, Edge::Stop, 100 + to)).unwrap();
    }
    let mut steps = 0;
    while staged.undo() {
        steps += 1;
    }
    assert_eq!(steps, 200);
}

#[test]
fn edits_and_undo_survive_rereading() {
    let mut staged = staged();
    staged.apply_edit(&edge(1, 3, Edge::Stop, 399)).unwrap();
    staged.apply_edit(&Edit::Switch { program: number(1), cam: cam(7), on: true }).unwrap();
    staged.apply_edit(&Edit::Preset(7)).unwrap();
    let mut now = program();
    now.cams[3] = Some(edges(305, 350)); // by another master
    now.mask = 0b1000_1011; // cam 1 too, and our edit was written
    staged.refresh_programs(&[(number(1), now)], None);
    staged.refresh_parameters(Parameters { preset: 7, ..parameters(2000, 1) });
    assert_eq!(cam_edges(&staged, 3), (305, 399));
    let wanted = staged.edited_values().unwrap();
    assert_eq!((wanted.image.program(number(1)).unwrap().mask, wanted.step_count()), (0b1000_1011, 2000));
    assert_eq!(staged.count(), 1, "{:?}", staged.differences());
    assert!(staged.undo(), "the edit of the stop is one step still");
    assert_eq!(cam_edges(&staged, 3), (305, 350));
    assert!(!staged.is_dirty() && !staged.undo());
}

#[test]
fn partial_rereading_keeps_other_values() {
    let mut staged = staged();
    staged.refresh_programs(&[(number(2), Program { mask: 0x93, ..program() })], None);
    staged.refresh_parameters(parameters(500, 1));
    let known = staged.device().unwrap();
    assert_eq!(
        known.known_programs().map(|(program, own)| (program.get(), own.mask)).collect::<Vec<_>>(),
        [(1, 9), (2, 0x93)]
    );
    assert_eq!(known.shift, WindowShift::new(8));
    assert!(!staged.is_dirty());
}

#[test]
fn restored_draft_waits_for_unread_values() {
    let mut staged = staged();
    for edit in [
        edge(1, 3, Edge::Stop, 399),
        Edit::Switch { program: number(1), cam: cam(0), on: false },
        name(3, "feed"),
        Edit::Steps(360),
        Edit::Shift(WindowShift::new(3).unwrap()),
    ] {
        staged.apply_edit(&edit).unwrap();
    }
    let expected = [
        SavedEdit::Gear(360, 1),
        SavedEdit::Shift(3),
        SavedEdit::On(1, 0, false),
        SavedEdit::Cam(1, 3, 300, 399),
        SavedEdit::Name(1, 3, "feed".to_owned()),
    ];
    let kept = staged.draft_edits();
    assert_eq!(kept, expected);

    let mut other = StagedEdits::default();
    let none = [
        SavedEdit::Cam(9, 0, 1, 2),
        SavedEdit::Cam(1, 8, 1, 2),
        SavedEdit::Direction(7),
        SavedEdit::Preset(1 << 25),
        SavedEdit::Shift(26),
    ];
    other.take_draft(kept.iter().cloned().chain(none));
    assert_eq!(other.draft_edits().len(), 10, "nothing is lost before anything was read");
    other.refresh_parameters(parameters(1000, 1));
    assert_eq!(other.edited_values().unwrap().step_count(), 360);
    assert_eq!(other.pending_programs(), [number(1)]);
    other.refresh_programs(&[(number(1), program())], WindowShift::new(8));
    assert_eq!(other.edited_values(), staged.edited_values(), "the cam beyond the range too");
    assert_eq!((other.draft_edits(), other.pending_programs()), (kept, Vec::new()));
    let mask = other.edited_values().unwrap().image.program(number(1)).unwrap().mask;
    assert_eq!(mask, 0b1000);
}

#[test]
fn drafts_round_trip_as_text() {
    let kept = vec![SavedEdit::Gear(360, 1), SavedEdit::NoCam(2, 7), SavedEdit::Name(1, 3, "feed".to_owned())];
    let text = ron::to_string(&kept).unwrap();
    assert_eq!(text, "[Gear(360,1),NoCam(2,7),Name(1,3,\"feed\")]");
    assert_eq!(ron::from_str::<Vec<SavedEdit>>(&text).unwrap(), kept);
}

#[test]
fn adds_missing_values_to_profile() {
    let mut staged = StagedEdits::for_profile(Image::from_parameters(parameters(1000, 1)), CamNames::default());
    let switch = Edit::Switch { program: number(2), cam: cam(4), on: true };
    assert_eq!(staged.apply_edit(&switch), Err(EditError::NoCam { program: number(2), cam: cam(4) }));
    let drawn = Edit::Cam { program: number(2), cam: cam(4), start: 900, stop: 99, on: true };
    assert_eq!(staged.apply_edit(&drawn), Ok(true));
    assert_eq!(
        staged.apply_edit(&edge(2, 5, Edge::Stop, 3)),
        Err(EditError::NoCam { program: number(2), cam: cam(5) })
    );
    assert_eq!(staged.program(number(2)).unwrap().cams.iter().flatten().count(), 1);
    assert_eq!(staged.apply_edit(&Edit::Shift(WindowShift::new(3).unwrap())), Ok(true));
    let kept = staged.draft_edits();
    assert_eq!(kept, [SavedEdit::Shift(3), SavedEdit::Cam(2, 4, 900, 99), SavedEdit::On(2, 4, true)]);
    let mut other = StagedEdits::for_profile(Image::from_parameters(parameters(1000, 1)), CamNames::default());
    other.take_draft(kept);
    assert_eq!(other.edited_values(), staged.edited_values());
    let EditedValues { image, names } = staged.edited_values().unwrap().clone();
    staged.adopt_saved(image, names);
    assert!(!staged.is_dirty() && staged.undo() && staged.is_dirty(), "what was saved can still be undone");
}

#[test]
fn names_are_saved_but_not_written() {
    let mut encoder = staged();
    encoder.apply_edit(&name(0, "feed")).unwrap();
    encoder.apply_edit(&Edit::ProgramName { program: number(1), name: "size 2".to_owned() }).unwrap();
    assert!(!encoder.is_dirty() && !encoder.is_program_edited(number(1)) && encoder.can_undo());
    let kept = encoder.draft_edits();
    assert_eq!(kept, [SavedEdit::ProgramName(1, "size 2".to_owned()), SavedEdit::Name(1, 0, "feed".to_owned())]);
    let mut other = staged();
    other.take_draft(kept);
    assert_eq!(other.edited_values(), encoder.edited_values());
    let mut profile = StagedEdits::for_profile(Image::from_parameters(parameters(1000, 1)), CamNames::default());
    profile.apply_edit(&name(0, "feed")).unwrap();
    assert!(profile.is_dirty() && profile.is_program_edited(number(1)));
    profile.apply_edit(&name(0, "  ")).unwrap();
    assert!(!profile.is_dirty());
}

#[test]
fn marks_out_of_range_and_conflicting_values() {
    let mut staged = staged();
    staged.apply_edit(&Edit::Preset(400)).unwrap();
    staged.apply_edit(&Edit::Steps(340)).unwrap();
    let beyond = EditFinding::Beyond { program: number(1), cam: cam(3), edge: Edge::Stop, last: 339 };
    assert_eq!(staged.edited_values().unwrap().findings(), [EditFinding::Preset { last: 339 }, beyond]);
    assert!(beyond.refers_to(number(1), cam(3)) && !beyond.refers_to(number(1), cam(0)));
    staged.undo();
    staged.undo();
    assert!(staged.edited_values().unwrap().findings().is_empty());

    // Of two pulses of one track, the first is from 300 to 350, and the second may begin within it.
    let drawn = |start, stop| Edit::Cam { program: number(1), cam: cam(5), start, stop, on: true };
    staged.apply_edit(&name(3, "Feed")).unwrap();
    staged.apply_edit(&name(5, "feed")).unwrap();
    for (start, stop, at) in [
        (350, 400, Some(350)),
        (351, 400, None),
        (100, 299, None),
        (100, 300, Some(300)),
        (310, 320, Some(310)),
        (900, 305, Some(300)),
        (900, 299, None),
        (340, 10, Some(340)),
    ] {
        staged.apply_edit(&drawn(start, stop)).unwrap();
        let expected = at.map(|at| EditFinding::Clash { program: number(1), first: cam(3), second: cam(5), at });
        assert_eq!(staged.edited_values().unwrap().findings(), Vec::from_iter(expected), "{start} to {stop}");
    }
    staged.apply_edit(&edge(1, 3, Edge::Start, 990)).unwrap();
    let clash = EditFinding::Clash { program: number(1), first: cam(3), second: cam(5), at: 0 };
    assert_eq!(staged.edited_values().unwrap().findings(), [clash], "both go over the end");
    staged.apply_edit(&name(5, "other")).unwrap();
    assert!(staged.edited_values().unwrap().findings().is_empty());
}
