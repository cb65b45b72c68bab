//! Tests of handwritten profiles, round trips and error messages.

use super::*;
use crate::profile::testing::{assert_edit_in_place, edit_profile};
use crate::profile::{ProfileDocument, ProfileError};

/// A profile as a user might write it by hand.
const SHORT: &str = r#"(
    schema: 1, device: "hiperface",
    identity: (serial_number: "A1", encoder_type: 0x37),
    interface: (address: 0x40, settings: 0xE4),
    fields: [(number: 0, status: 0xC8, bytes: "00 01 02 03 04 05 06 07 08 09 0A 0B 0C 0D 0E 0F")],
)"#;

/// Returns a profile with a user's comments and CR LF line ends.
fn commented_profile() -> String {
    include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/fixtures/commented/hiperface.ron")).replace('\n', "\r\n")
}

fn parse(text: &str) -> Result<ProfileDocument, ProfileError> {
    ProfileDocument::parse(text, HiperfaceProfile::FORMATS)
}

fn profile(text: &str) -> HiperfaceProfile {
    parse(text).unwrap().body.into_profile().unwrap()
}

#[test]
fn parses_handwritten_profile() {
    let profile = profile(SHORT);
    assert_eq!(profile.identity.serial_number, "A1");
    let bytes = Some((0..16).collect());
    let status = DataFieldStatus::from_byte(0xC8);
    assert_eq!(profile.fields, [FieldImage { number: 0, status, bytes }]);
    assert_eq!(profile.recorded.position, None);
}

#[test]
fn rejects_misspelled_key() {
    let cases = [
        ("fields: [(", "fields: [], fields: [(", "fields appears twice"),
        ("status: 0xC8", "status: 0xC9, status: 0xC8", "status appears twice"),
        ("fields:", "feilds:", "fields is missing"),
    ];
    for (from, to, why) in cases {
        let error = parse(&SHORT.replace(from, to)).unwrap_err().to_string();
        assert!(error.ends_with(why), "{to}: {error}");
    }
}

#[test]
fn emitted_profiles_round_trip() {
    let mut document = parse(SHORT).unwrap();
    let profile = document.body.get_mut::<HiperfaceProfile>().unwrap();
    profile.recorded.position = Some(0x000E_0531);
    profile.identity.extended_label = Some(vec![0x53; 64]);
    profile.identity.serial_number = "quote \" and \\ and ä".to_owned();
    let mut offset = b"CO1".to_vec();
    offset.resize(32, 0);
    let status = DataFieldStatus::from_byte(0x89);
    profile.fields.push(FieldImage { number: 1, status, bytes: Some(offset) });
    let status = DataFieldStatus::from_byte(0xE8);
    profile.fields.push(FieldImage { number: 2, status, bytes: None });
    profile.mark_mounting_dependent_values();
    assert_eq!(profile.mounting[0].item, FieldRange::new(1, 0, 16));
    document.note = Some("two\nlines".to_owned());
    assert_eq!(parse(&document.emit()), Ok(document));
}

#[test]
fn profile_errors_have_locations() {
    let cases = [
        ("", "", "line 1, column 1: "),
        ("schema: 1,", "schema: 1,,", "line 2, column 15: "),
        ("schema: 1,", "", "schema is missing"),
        ("schema: 1,", "schema: 0,", "schema 0 is not supported (supported: 1 to 1)"),
        ("\"hiperface\"", "\"sse\"", "device \"sse\" is not supported (supported: \"hiperface\")"),
        ("\"A1\"", "17", "identity.serial_number must be a string"),
        ("0x37", "0x137", "identity.encoder_type must be a number from 0 to 255 (0x00 to 0xFF)"),
        ("status: 0xC8", "status: 0x48", "fields[0].status: 48h is not the status of an existing field"),
        ("status: 0xC8", "status: 0xC9", "fields[0].bytes: the field has 16 bytes, but its status specifies 32"),
        ("00 01", "0G 01", "fields[0].bytes: 'G' is not a hexadecimal digit"),
        ("00 01", "00 1", "fields[0].bytes: \"1\" has an odd number of hexadecimal digits"),
        ("bytes:", "byts:", "line 5, column 40: fields[0].byts is unknown, and bytes is missing"),
        (
            "bytes: \"00 01 02 03 04 05 06 07 08 09 0A 0B 0C 0D 0E 0F\"",
            "",
            "fields[0].bytes: the bytes are missing; a field without bytes must have locked: true",
        ),
        ("bytes:", "locked: true, bytes:", "fields[0].bytes: the bytes of a locked field must not be specified"),
        ("fields: [", "fields: [5, ", "fields[0] must be a structure: (name: value, …)"),
        ("fields: [", "mounting: [(item: \"counter\")], fields: [", "mounting[0].item: \"counter\" is not"),
    ];
    for (old, new, message) in cases {
        let text = if old.is_empty() { String::new() } else { SHORT.replacen(old, new, 1) };
        let error = parse(&text).unwrap_err().to_string();
        assert!(error.starts_with(message), "{error:?} does not begin with {message:?}");
    }
}

/// Users may keep their own entries of any structure in `extra` (issue 22.17).
#[test]
fn keeps_user_entries() {
    let text = SHORT
        .replace("schema: 1,", "schema: 1, extra: {\"owner\": (name: \"CK\")},")
        .replace("serial_number:", "extra: (colour: Some(\"red\")), serial_number:")
        .replace("fields: [", "mounting: [(item: \"field:0@0+4\", extra: {\"by\": \"CK\"})], fields: [")
        .replace("number: 0,", "number: 0, extra: {},");
    let document = parse(&text).unwrap();
    assert_eq!(document.beyond, [""; 0]);
    let written = document.emit();
    for kept in ["extra: {\"owner\": (name: \"CK\")}", "extra: {\"colour\": Some(\"red\")}", "extra: {\"by\": \"CK\"}"]
    {
        assert!(written.contains(kept), "{kept} is not in\n{written}");
    }
    assert_eq!(parse(&written), Ok(document));
    let error = parse(&SHORT.replace("schema: 1,", "schema: 1, extra: 5,")).unwrap_err();
    assert!(matches!(&error, ProfileError::Shape { path, .. } if path == "extra"), "{error}");
}

/// Unknown entries in a file that predates `extra` are moved to `extra` and reported by name (issue 22.17).
#[test]
fn moves_unknown_old_entries_to_extra() {
    let text = SHORT.replace("schema: 1,", "schema: 1, owner: \"CK\",").replace("number: 0,", "number: 0, label: 3,");
    let document = parse(&text).unwrap();
    assert_eq!(document.beyond, ["fields[0].label", "owner"]);
    let written = document.emit();
    assert!(written.contains("extra: {\"owner\": \"CK\"}") && written.contains("extra: {\"label\": 3}"), "{written}");
    let again = parse(&written).unwrap();
    assert_eq!((again.beyond, again.unknown, again.body), (Vec::new(), document.unknown, document.body));
}

/// A profile with a newer schema is never written, so that its unknown entries are not lost (issue 22.17).
#[test]
fn newer_schema_is_read_only() {
    let newer = SHORT.replace("schema: 1,", "schema: 7, feilds: 1,").replace("number: 0,", "number: 0, statsu: 3,");
    let document = parse(&newer).unwrap();
    assert!(document.is_newer());
    assert_eq!(document.beyond, ["fields[0].statsu", "feilds"]);
    assert!(document.emit().contains("schema: 7,"), "never as an older one");
    assert_eq!(document.check_schema(), Err(ProfileError::Schema { found: 7, known: 1 }));
    let zero = parse(&SHORT.replace("schema: 1,", "schema: 0,"));
    assert_eq!(zero, Err(ProfileError::Schema { found: 0, known: 1 }));
}

/// Changing a value edits the file in a single place (issue 22.26).
#[test]
fn change_edits_only_its_value() {
    let edit = |own: &mut HiperfaceProfile| own.interface.address = 0x41;
    assert_edit_in_place(&commented_profile(), edit, "address: 64", "address: 0x41");
}

/// Bytes with custom line breaks are reformatted, and a comment that is lost is reported. All other text remains
/// unchanged (issue 22.26).
#[test]
fn reformats_custom_line_breaks() {
    let (_, carried) = edit_profile(&commented_profile(), |_, own: &mut HiperfaceProfile| {
        own.fields[0].bytes.as_mut().unwrap()[1] = 0xFF;
    });
    assert_eq!(carried.lost, ["name plate"]);
    let rest = [
        "// bench 3, Monday\r\n",
        "status: 0xC8, number: 0, // ours\r\n",
        "(settings: 0xE4, address: 64), /* as wired */",
    ];
    rest.iter().for_each(|kept| assert!(carried.text.contains(kept), "{kept}\n{}", carried.text));
    assert!(carried.text.contains("\"00 FF 02 03 04 05 06 07 08 09 0A 0B 0C 0D 0E 0F\""));
}
