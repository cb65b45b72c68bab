//! Tests of handwritten profiles, round trips and error messages.

use super::super::test_profiles::{cam, cam_between, profile, program};
use super::*;
use crate::profile::testing::{assert_edit_in_place, edit_profile};
use crate::profile::{Body, Change, ChangedSide, ProfileDocument, UpdatedText, diverging_changes};

fn document(profile: InterbusProfile) -> ProfileDocument {
    let saved = Some("2024-06-03T14:05:00Z".to_owned());
    ProfileDocument {
        saved,
        note: None,
        body: Body::new(profile),
        unknown: Default::default(),
        schema: 1,
        beyond: Vec::new(),
    }
}

fn parse(text: &str) -> Result<InterbusProfile, ProfileError> {
    ProfileDocument::parse(text, InterbusProfile::FORMATS)?.body.into_profile()
}

/// A minimal profile as a user might write it.
const SHORT: &str = r#"(
    schema: 1,
    device: "interbus",
    parameters: (steps: 3600, revolutions: 1, direction: "ccw", preset: 0, zero_shift: 0),
    programs: [
        (program: 2, name: "carton", mask: 0b101, cams: [
            (cam: 2, start: 3500, stop: 0x28, name: "glue"),
        ]),
    ],
)"#;

fn replaced(from: &str, to: &str) -> String {
    assert_eq!(SHORT.matches(from).count(), 1, "{from}");
    SHORT.replace(from, to)
}

#[test]
fn emitted_profiles_round_trip() {
    let mut full = profile("1234567");
    full.names.set_program(program(8), "\"best\" cartons".to_owned());
    full.names.set_cam(program(8), cam(0), "Leimdüse".to_owned());
    let text = document(full.clone()).emit();
    assert_eq!(ProfileDocument::parse(&text, InterbusProfile::FORMATS).unwrap(), document(full));
    for line in [
        "        steps: 3600, // over all turns: the measuring range",
        "        direction: \"cw\",",
        "        temperature_tenths: -100, // -10.0 °C",
        "        (item: \"preset\", meaning: \"preset value\"),",
        "            mask: 0xFF, // these cams work: 0, 1, 2, 3, 4, 5, 6, 7",
        "                (cam: 0, start: 8, stop: 57, name: \"Leimdüse\"),",
    ] {
        assert!(text.lines().any(|own| own == line), "{line}\n{text}");
    }
}

#[test]
fn short_profile_omits_optional_values() {
    let read = parse(SHORT).unwrap();
    assert_eq!(read.image.parameters.direction, Direction::Counterclockwise);
    assert_eq!((read.image.shift, read.image.known_programs().count()), (None, 1));
    let own = read.image.program(program(2)).unwrap();
    assert_eq!((own.mask, own.cam(cam(2)), own.cam(cam(0))), (5, Some(cam_between(3500, 40)), None));
    assert_eq!((read.names.program(program(2)), read.names.cam(program(2), cam(2))), ("carton", "glue"));
    let items: Vec<String> = read.items().map(|item| item.to_string()).collect();
    let parameters = ["steps", "revolutions", "direction", "preset", "zero-shift"];
    assert_eq!(items, [&parameters[..], &["cam-mask:2", "cam:2:2"]].concat());
    assert_eq!((read.identity, read.mounting), (ProfileIdentity::default(), vec![]));
}

#[test]
fn keeps_unknown_fields_in_place() {
    let text = replaced("zero_shift: 0", "zero_shift: 0, gearbox: 3");
    let text = text.replace("mask: 0b101", "mask: 5, colour: \"red\"").replace("stop: 0x28", "stop: 40, lamp: 7");
    let once = ProfileDocument::parse(&text, InterbusProfile::FORMATS).unwrap().emit();
    assert_eq!(ProfileDocument::parse(&once, InterbusProfile::FORMATS).unwrap().emit(), once);
    for line in
        ["        extra: {\"gearbox\": 3},", "            extra: {\"colour\": \"red\"},", "extra: {\"lamp\": 7}),"]
    {
        assert!(once.lines().any(|own| own.ends_with(line)), "{line}\n{once}");
    }
}

#[test]
fn errors_name_entry() {
    let cases = [
        ("steps: 3600, ", "", "parameters.steps is missing"),
        ("steps: 3600", "steps: -1", "parameters.steps must be a number from 0 to 33554431"),
        ("steps: 3600", "steps: 33554432", "parameters.steps must be a number from 0 to 33554431"),
        ("\"ccw\"", "\"left\"", "parameters.direction must be cw or ccw"),
        ("program: 2", "program: 9", "programs[0].program: program 9 is outside the range 1 to 8"),
        ("mask: 0b101, ", "", "programs[0].mask is missing"),
        ("mask: 0b101", "mask: 256", "programs[0].mask must be a number from 0 to 255 (0x00 to 0xFF)"),
        ("cam: 2", "cam: 8", "programs[0].cams[0].cam: cam 8 is outside the range 0 to 7"),
        ("start: 3500, ", "", "programs[0].cams[0].start is missing"),
        ("        ]),\n", "        ]), (program: 2, mask: 0)\n", "programs[1].program: program 2 appears twice"),
        ("name: \"glue\"),", "), (cam: 2, start: 1, stop: 2)", "programs[0].cams[1].cam: cam 2 appears twice"),
        ("    programs", "    shift: 26, programs", "shift must be a number from 0 to 25"),
        (
            "    programs",
            "    mounting: [(item: \"temperature\")], programs",
            "mounting[0].item: temperature is a measured value and cannot be specific to a mounting",
        ),
    ];
    for (from, to, message) in cases {
        assert_eq!(parse(&replaced(from, to)).unwrap_err().to_string(), message);
    }
}

fn parse_document(text: &str) -> ProfileDocument {
    ProfileDocument::parse(text, InterbusProfile::FORMATS).unwrap()
}

/// A profile with comments as a user might write it.
const COMMENTED: &str = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/fixtures/commented/interbus.ron"));

/// When a value changes, the rest of the text stays unchanged (issue 22.26).
#[test]
fn change_edits_only_its_value() {
    let edit = |own: &mut InterbusProfile| {
        let program = own.image.program_mut(ProgramNumber::new(2).unwrap()).unwrap().as_mut().unwrap();
        program.set_cam(cam(1), Some(cam_between(15, 20)));
    };
    assert_edit_in_place(COMMENTED, edit, "start: 10,", "start: 15,");
}

/// When an entry is added or removed, no other line changes (issue 22.26).
#[test]
fn entry_change_preserves_other_lines() {
    let (_, carried) = edit_profile(COMMENTED, |note, own: &mut InterbusProfile| {
        let program = own.image.program_mut(ProgramNumber::new(2).unwrap()).unwrap().as_mut().unwrap();
        program.set_cam(cam(1), None);
        program.set_cam(cam(4), Some(cam_between(300, 400)));
        *note = Some("as of today".to_owned());
    });
    let expected = COMMENTED
        .replace("(cam: 1, start: 10, stop: 20), // knife\n", "")
        .replace("name: \"glue\"),\n", "name: \"glue\"),\n(cam: 4, start: 300, stop: 400),\n")
        .replace("device: \"interbus\", schema: 1,\n", "device: \"interbus\",\nnote: \"as of today\",\nschema: 1,\n");
    let lines = |text: &str| text.lines().map(|line| line.trim().to_owned()).collect::<Vec<_>>();
    assert_eq!(lines(&carried.text), lines(&expected));
    assert_eq!(carried.lost, ["knife"]);
}

/// In a ready-made profile, the comment about a value is updated with the value (issue 22.26).
#[test]
fn generated_comments_follow_values() {
    let text = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/profiles/interbus/packaging-machine.ron"));
    let (document, carried) = edit_profile(text, |_, own: &mut InterbusProfile| {
        let program = own.image.program_mut(ProgramNumber::new(1).unwrap()).unwrap().as_mut().unwrap();
        program.mask = 0x03;
    });
    assert_eq!(carried, UpdatedText { text: document.emit(), lost: Vec::new() });
    assert!(carried.text.contains("mask: 0x03, // these cams work: 0, 1\n"));
}

/// When two users have changed a common profile, the changes of both are listed by entry (issue 22.25).
#[test]
fn lists_divergent_changes_by_entry() {
    let base = parse_document(COMMENTED);
    let theirs = parse_document(&COMMENTED.replace("start: 10,", "start: 12,").replace("mask: 3", "mask: 1"));
    let mine = parse_document(&COMMENTED.replace("start: 10,", "start: 14,").replace("stop: 200", "stop: 222"));
    let found = diverging_changes(&base, &theirs, &mine);
    let told: Vec<(String, ChangedSide)> = found.iter().map(|(change, who)| (change.location(), *who)).collect();
    let place = |rest: &str| format!("programs[program: 2].{rest}");
    let expected = [
        (place("mask"), ChangedSide::There),
        (place("cams[cam: 0].stop"), ChangedSide::Here),
        (place("cams[cam: 1].start"), ChangedSide::Both),
    ];
    assert_eq!(told, expected);
    let here: Vec<Change> =
        found.into_iter().filter(|(_, who)| *who == ChangedSide::Here).map(|(own, _)| own).collect();
    let merged = theirs.with_changes(&here, InterbusProfile::FORMATS).unwrap();
    let expected = COMMENTED.replace("start: 10,", "start: 12,").replace("mask: 3", "mask: 1");
    assert_eq!(merged, parse_document(&expected.replace("stop: 200", "stop: 222")));
}
