//! Tests of handwritten profiles, unchanged round trips and error messages.

use super::super::test_profiles::{drive, identity, image_with_values, parameter, profile};
use super::*;
use crate::profile::testing::{assert_edit_in_place, edit_profile};
use crate::profile::{Body, ProfileDocument};

fn document(profile: HiperdriveProfile) -> ProfileDocument {
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

fn parse(text: &str) -> Result<HiperdriveProfile, ProfileError> {
    ProfileDocument::parse(text, HiperdriveProfile::FORMATS)?.body.into_profile()
}

/// A profile written by hand that is not for a particular device.
const SHORT: &str = r#"(
    schema: 1,
    device: "hiperdrive",
    parameters: {24: 0x10},
    drives: [
        (number: 2, parameters: {154: 400, 156: 256, 158: -1000, 160: 204400}),
    ],
)"#;

fn replaced(from: &str, to: &str) -> String {
    assert_eq!(SHORT.matches(from).count(), 1, "{from}");
    SHORT.replace(from, to)
}

#[test]
fn emitted_profile_parses_back() {
    let text = document(profile()).emit();
    assert_eq!(ProfileDocument::parse(&text, HiperdriveProfile::FORMATS).unwrap(), document(profile()));
    for line in [
        "        category: \"HIPERDRIVE HUB-4\",\n",
        "        serial_number: \"100\",\n",
        "        (item: \"198 drive 3\", meaning: \"the position that was set\"),\n",
        "    parameters: {\n        24: 0, // free register 1\n        26: 7, // free register 2\n    },\n",
        "            number: 3,\n            variant: 7, // HDA30A\n            name: \"HDA30A\",\n            serial_number: \"4712\",\n",
        "                152: 1, // requested\n",
        // 511 turns of 65536 steps.
        "                158: -33488896, // lower limit [steps], -511.000 turns\n",
        "                166: 350, // maximum speed [0.1 rpm]\n",
    ] {
        assert!(text.contains(line), "{line} is not in\n{text}");
    }
}

#[test]
fn handwritten_profile_has_no_identity() {
    let profile = parse(SHORT).unwrap();
    assert!(profile.identity.is_device_unknown());
    assert_eq!(profile.image, image_with_values(&[(24, 16), (254, 400), (256, 256), (258, -1000), (260, 204_400)]));
    assert_eq!(profile.drive(drive(2)), Some(&ProfileDrive::unknown_drive(drive(2))));
    let text = document(profile.clone()).emit();
    assert!(!text.contains("identity"), "{text}");
    // 204400 steps of 400 a turn.
    assert!(text.contains("160: 204400, // upper limit [steps], 511.000 turns\n"), "{text}");
    assert_eq!(parse(&text), Ok(profile));
}

#[test]
fn accepts_drive_parameters_at_top_level() {
    let text = r#"(schema: 1, device: "hiperdrive", parameters: {166: 200, 366: 100})"#;
    assert_eq!(parse(text).unwrap().image, image_with_values(&[(166, 200), (366, 100)]));
}

#[test]
fn keeps_unknown_fields() {
    let text = SHORT
        .replace("24: 0x10", "24: 0x10, \"owner\": (name: \"CK\")")
        .replace("number: 2,", "number: 2, axis: \"feed\",")
        .replace("154: 400,", "154: 400, \"spare\": Some(3),")
        .replace("schema: 1,", "schema: 1, identity: (colour: \"red\"), mounting: [(item: \"258\", by: \"CK\")],");
    let document = ProfileDocument::parse(&text, HiperdriveProfile::FORMATS).unwrap();
    let profile = document.body.get::<HiperdriveProfile>().unwrap();
    assert!(profile.depends_on_mounting(Item(parameter(258))) && profile.depends_on_mounting(Item(parameter(398))));
    let written = document.emit();
    for kept in [
        "\"owner\": (name: \"CK\"),",
        "{\"axis\": \"feed\"}",
        "\"spare\": Some(3),",
        "{\"colour\": \"red\"}",
        "{\"by\": \"CK\"}",
    ] {
        assert!(written.contains(kept), "{kept} is not in\n{written}");
    }
    assert_eq!(document.beyond.len(), 5);
    let again = ProfileDocument::parse(&written, HiperdriveProfile::FORMATS).unwrap();
    assert_eq!(
        (again.emit(), again.beyond.len()),
        (written, 2),
        "those among the parameters stay there, and are named"
    );
}

#[test]
fn profile_errors_name_their_location() {
    let cases = [
        ("24: 0x10", "24: \"a\"", "parameters.24 must be a whole number"),
        ("24: 0x10", "24: 1, 24: 2", "line 4, column "),
        ("24: 0x10", "258: 1", "drives[0].parameters.158: 158 drive 2 appears twice"),
        ("24: 0x10", "107: 1", "parameters.107: actual position is not saved by the device"),
        ("24: 0x10", "999: 7", "parameters.999: parameter 999 does not exist"),
        ("24: 0x10", "45: 7", "parameters.45: parameter 45 does not exist"),
        ("24: 0x10", "70000: 7", "parameters.70000: parameter 70000 does not exist"),
        ("24: 0x10", "17: 1", "parameters.17: serial number is not saved by the device"),
        ("154: 400", "155: 1", "drives[0].parameters.155: drives have no parameter 155"),
        ("154: 400", "24: 1", "drives[0].parameters.24: drives have no parameter 24"),
        ("154: 400", "254: 1", "drives[0].parameters.254: drives have no parameter 254"),
        ("24: 0x10", "101: 1", "parameters.101: control word is not saved by the device"),
        ("{24: 0x10}", "[24]", "parameters must be a map: {number: value, …}"),
        (
            "154: 400",
            "154: 0",
            "drives[0].parameters.154: parameter 254 (position scale numerator) cannot be 0 (allowed: 1 to 65535)",
        ),
        ("number: 2", "number: 9", "drives[0].number must be a number from 1 to 8"),
        ("number: 2,", "", "drives[0].number is missing"),
        ("drives: [", "drives: [(number: 2), ", "drives[1].number: drive 2 appears twice"),
        ("drives: [", "identity: (category: \"HUB\"), drives: [", "identity.category must be \"HIPERDRIVE SINGLE\""),
        ("drives: [", "mounting: [(item: \"107\")], drives: [", "mounting[0].item: 107 is not saved"),
        ("drives: [", "mounting: [(item: \"x\")], drives: [", "mounting[0].item: \"x\" is not a parameter"),
    ];
    for (from, to, why) in cases {
        let error = parse(&replaced(from, to)).unwrap_err().to_string();
        assert!(error.starts_with(why), "{to}: {error}");
    }
}

#[test]
fn identity_round_trips() {
    let profile = HiperdriveProfile::from_image(identity("7", &[(8, "1")]), image_with_values(&[(898, 64)]));
    assert_eq!(parse(&document(profile.clone()).emit()), Ok(profile));
}

/// A profile written by hand, with comments.
const COMMENTED: &str = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/fixtures/commented/hiperdrive.ron"));

/// Changing a value changes the text in only one place (issue 22.26).
#[test]
fn change_edits_only_its_value() {
    let edit = |own: &mut HiperdriveProfile| assert_eq!(own.image.values.insert(parameter(166), 40), Some(50));
    assert_edit_in_place(COMMENTED, edit, "166: 50", "166: 40");
}

/// Adding or removing an entry changes only the line of this entry (issue 22.26).
#[test]
fn entry_change_edits_only_its_line() {
    let (_, carried) = edit_profile(COMMENTED, |_, own: &mut HiperdriveProfile| {
        own.image.values.remove(&parameter(158));
        own.image.values.insert(parameter(24), 1);
    });
    assert!(carried.text.contains("\n166: 50, // slow\n})],\n"), "{}", carried.text);
    assert!(carried.text.contains("parameters: {"), "{}", carried.text);
    assert_eq!(carried.lost, ["to the wall"]);
}
