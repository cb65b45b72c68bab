//! The text there and back, as a person writes it, and what is wrong with it.

use super::super::test_profiles::{cam, edges, profile, program};
use super::*;
use crate::profile::{Body, Document};

fn document(profile: InterbusProfile) -> Document {
    let saved = Some("2024-06-03T14:05:00Z".to_owned());
    Document {
        saved,
        note: None,
        body: Body::Interbus(Box::new(profile)),
        unknown: Default::default(),
        schema: 1,
        beyond: Vec::new(),
    }
}

fn parse(text: &str) -> Result<InterbusProfile, ProfileError> {
    Document::parse(text)?.body.into_interbus()
}

/// As a person writes it, with the least that has to be there.
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
fn what_is_written_is_what_is_read() {
    let mut full = profile("1234567");
    full.names.set_program(program(8), "\"best\" cartons".to_owned());
    full.names.set_cam(program(8), cam(0), "Leimdüse".to_owned());
    let text = document(full.clone()).emit();
    assert_eq!(Document::parse(&text).unwrap(), document(full));
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
fn a_short_one_says_nothing_of_the_rest() {
    let read = parse(SHORT).unwrap();
    assert_eq!(read.image.parameters.direction, Direction::Counterclockwise);
    assert_eq!((read.image.shift, read.image.known().count()), (None, 1));
    let own = read.image.program(program(2)).unwrap();
    assert_eq!((own.mask, own.cam(cam(2)), own.cam(cam(0))), (5, Some(edges(3500, 40)), None));
    assert_eq!((read.names.program(program(2)), read.names.cam(program(2), cam(2))), ("carton", "glue"));
    let items: Vec<String> = read.items().map(|item| item.to_string()).collect();
    let parameters = ["steps", "revolutions", "direction", "preset", "zero-shift"];
    assert_eq!(items, [&parameters[..], &["cam-mask:2", "cam:2:2"]].concat());
    assert_eq!((read.identity, read.mounting), (ProfileIdentity::default(), vec![]));
}

#[test]
fn what_is_not_known_is_kept_where_it_stands() {
    let text = replaced("zero_shift: 0", "zero_shift: 0, gearbox: 3");
    let text = text.replace("mask: 0b101", "mask: 5, colour: \"red\"").replace("stop: 0x28", "stop: 40, lamp: 7");
    let once = Document::parse(&text).unwrap().emit();
    assert_eq!(Document::parse(&once).unwrap().emit(), once);
    for line in
        ["        extra: {\"gearbox\": 3},", "            extra: {\"colour\": \"red\"},", "extra: {\"lamp\": 7}),"]
    {
        assert!(once.lines().any(|own| own.ends_with(line)), "{line}\n{once}");
    }
}

#[test]
fn what_is_wrong_names_its_entry() {
    let cases = [
        ("steps: 3600, ", "", "parameters.steps is missing"),
        ("steps: 3600", "steps: -1", "parameters.steps must be a number from 0 to 33554431"),
        ("steps: 3600", "steps: 33554432", "parameters.steps must be a number from 0 to 33554431"),
        ("\"ccw\"", "\"left\"", "parameters.direction must be cw or ccw"),
        ("program: 2", "program: 9", "programs[0].program: program 9 is not within 1 to 8"),
        ("mask: 0b101, ", "", "programs[0].mask is missing"),
        ("mask: 0b101", "mask: 256", "programs[0].mask must be a number from 0 to 255 (0x00 to 0xFF)"),
        ("cam: 2", "cam: 8", "programs[0].cams[0].cam: cam 8 is not within 0 to 7"),
        ("start: 3500, ", "", "programs[0].cams[0].start is missing"),
        ("        ]),\n", "        ]), (program: 2, mask: 0)\n", "programs[1].program: program 2 stands twice"),
        ("name: \"glue\"),", "), (cam: 2, start: 1, stop: 2)", "programs[0].cams[1].cam: cam 2 stands twice"),
        ("    programs", "    shift: 26, programs", "shift must be a number from 0 to 25"),
        (
            "    programs",
            "    mounting: [(item: \"temperature\")], programs",
            "mounting[0].item: temperature is measured, and belongs to no mounting",
        ),
    ];
    for (from, to, message) in cases {
        assert_eq!(parse(&replaced(from, to)).unwrap_err().to_string(), message);
    }
}
