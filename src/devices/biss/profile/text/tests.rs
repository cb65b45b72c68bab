//! Tests of handwritten profiles, round trips and error messages.

use super::*;
use crate::devices::biss::protocol::{Access, Area, DeviceMode, RegisterAddress};
use crate::profile::testing::assert_edit_in_place;
use crate::profile::{Body, ProfileDocument};

const SHORT: &str = r#"(
    schema: 1, device: "biss",
    identity: (serial_number: "1234567", profile_id: 0x6129, device_id: "01 01 68 11 00 01", manufacturer: "46 72"),
    data: [(banks: (0x24, 0x43), listed: [(bank: 0x25, bytes: [
        "00 01 02 03 04 05 06 07 08 09 0A 0B 0C 0D 0E 0F",
        "10 11 12 13 14 15 16 17 18 19 1A 1B 1C 1D 1E 1F 20 21 22 23 24 25 26 27 28 29 2A 2B 2C 2D 2E 2F",
        "30 31 32 33 34 35 36 37 38 39 3A 3B 3C 3D 3E 3F",
    ])])],
)"#;

fn profile(text: &str) -> BissProfile {
    ProfileDocument::parse(text, BissProfile::FORMATS).unwrap().body.into_profile().unwrap()
}

#[test]
fn parses_handwritten_profile() {
    let profile = profile(SHORT);
    assert_eq!(profile.identity.serial_number, "1234567");
    assert_eq!(profile.identity.device_id, [0x01, 0x01, 0x68, 0x11, 0x00, 0x01]);
    assert_eq!((profile.filter, &profile.preset, profile.identity.firmware), (None, &None, None));
    assert_eq!(profile.bank(0x25).unwrap().bytes[0x2A], 0x2A);
    assert_eq!(profile.bank(0x24), None, "without `empty` nothing is said about it");
    let filled = profile_with("listed:", "empty: 0xFF, listed:");
    assert_eq!(filled.bank(0x24), Some(Bank::filled_with(0x24, 0xFF)));
    assert_eq!((filled.bank(0x23), filled.bank(0x44)), (None, None));
    assert_eq!(filled.banks().count(), 32);
    assert_eq!(profile.banks().count(), 1);
}

fn profile_with(from: &str, to: &str) -> BissProfile {
    profile(&SHORT.replacen(from, to, 1))
}

/// Returns a profile with every possible entry.
fn full_profile() -> BissProfile {
    let mut profile = profile_with("listed:", "name: \"OEM data\", empty: 0x00, listed:");
    profile.identity.firmware = Some(Firmware::new(1, 6, 0));
    profile.identity.description = "quote \" and \\ and ä".to_owned();
    (profile.identity.multiturn_bits, profile.identity.singleturn_bits) = (Some(16), Some(17));
    profile.filter = Some(PositionFilter::Dynamic);
    profile.preset = Some(PresetSetting { value: PresetValue::new(98_304, 7).unwrap(), unknown: Default::default() });
    profile.recorded = RecordedValues {
        eds: vec![Bank::filled_with(0x02, 0x17).into()],
        wiegand_last: Some(WiegandResult::parse([63, 58, 64, 57])),
        wiegand_production: Some(WiegandResult::parse([1, 2, 3, 4])),
        wiegand_saved: None,
        calibration_status: Some(0x22),
        device_mode: Some(DeviceMode::DATA_WRITE),
        unknown: Default::default(),
    };
    profile.mark_mounting_dependent_values();
    profile.mark_mounting_dependent_values();
    profile
}

#[test]
fn emitted_profile_parses_back() {
    let mut document = ProfileDocument::new("2026-11-21T13:20:18Z".to_owned(), Body::new(full_profile()));
    document.note = Some("two\nlines".to_owned());
    let text = document.emit();
    assert_eq!(ProfileDocument::parse(&text, BissProfile::FORMATS), Ok(document));
    // These lines are the most relevant for a user.
    for line in [
        "    device: \"biss\",",
        "        profile_id: 0x6129,",
        "        manufacturer: \"46 72\", // Fr",
        "        firmware: \"1.6.0\",",
        "    filter: 0x04, // dynamic",
        "        singleturn: 98304, // 270.000°",
        "        wiegand_last: [63, 58, 64, 57],",
        "        (item: \"0x01:0x02+6\", meaning: \"preset value\"),",
        "            banks: (0x24, 0x43),",
        "                        \"20 21 22 23 24 25 26 27 28 29 2A 2B 2C 2D 2E 2F\", //  !\"#$%&'()*+,-./",
    ] {
        assert!(text.lines().any(|own| own == line), "{line} is not in\n{text}");
    }
    let marks = text.matches("meaning:").count();
    assert_eq!(marks, 2, "each is marked once");
}

#[test]
fn keeps_unknown_fields() {
    let text = SHORT
        .replace("schema: 1,", "schema: 1, owner: (name: \"CK\", floors: [1, 2]),")
        .replace("serial_number:", "colour: Some(\"red\"), serial_number:")
        .replace("data: [(", "preset: (singleturn: 1, multiturn: 2, by: \"a\"), mounting: [(item: \"0x24:0x00\", by: \"b\")], data: [(area_note: \"c\", ")
        .replace("bank: 0x25,", "bank: 0x25, label: \"motor\",")
        .replace("data:", "recorded: (place: \"d\", eds: [(bank: 2, bytes: ZEROS, from: \"e\")]), data:");
    let zeros = format!("\"{}\"", "00".repeat(64));
    let document = ProfileDocument::parse(&text.replace("ZEROS", &zeros), BissProfile::FORMATS).unwrap();
    let written = document.emit();
    for kept in [
        "extra: {\"owner\": (floors: [1, 2], name: \"CK\")}",
        "extra: {\"colour\": Some(\"red\")}",
        "extra: {\"by\": \"a\"}",
        "extra: {\"by\": \"b\"}",
        "extra: {\"area_note\": \"c\"}",
        "extra: {\"label\": \"motor\"}",
        "extra: {\"place\": \"d\"}",
        "extra: {\"from\": \"e\"}",
    ] {
        assert!(written.contains(kept), "{kept} is not in\n{written}");
    }
    assert_eq!(document.beyond.len(), 8);
    assert_eq!(
        ProfileDocument::parse(&written, BissProfile::FORMATS),
        Ok(ProfileDocument { beyond: Vec::new(), ..document })
    );
}

#[test]
fn profile_errors_name_their_location() {
    let cases = [
        ("schema: 1", "schema: 0", "schema 0 is not supported (supported: 1 to 1)"),
        ("identity:", "identy:", "line 3, column 5: identy is unknown, and identity is missing"),
        ("data:", "date:", "line 4, column 5: date is unknown, and data is missing"),
        ("\"1234567\"", "1234567", "identity.serial_number must be a string"),
        ("0x6129", "0x16129", "identity.profile_id must be a number from 0 to 65535 (0x0000 to 0xFFFF)"),
        ("01 01 68 11 00 01", "01 01 68 11 00", "identity.device_id: 5 bytes instead of 6"),
        ("manufacturer:", "maker:", "identity.manufacturer is missing"),
        (
            "profile_id:",
            "firmware: \"1.6\", profile_id:",
            "identity.firmware: \"1.6\" is not a version number such as 1.6.0",
        ),
        ("profile_id:", "firmware: \"1.6.256\", profile_id:", "identity.firmware: \"1.6.256\" is not"),
        ("data:", "filter: \"dynamic\", data:", "filter must be a number from 0 to 255 (0x00 to 0xFF)"),
        ("data:", "preset: (singleturn: 1), data:", "preset.multiturn is missing"),
        (
            "data:",
            "preset: (singleturn: 16777216, multiturn: 0), data:",
            "preset.singleturn must be a number from 0 to 16777215",
        ),
        ("data:", "preset: (singleturn: -1, multiturn: 0), data:", "preset.singleturn must be a number from 0 to"),
        (
            "data:",
            "recorded: (wiegand_saved: [1, 2, 3]), data:",
            "recorded.wiegand_saved must be a list of four numbers from 0 to 255, in tenths of a volt",
        ),
        (
            "data:",
            "mounting: [(item: \"preset\")], data:",
            "mounting[0].item: \"preset\" is neither \"calibration\" nor a register range such as 0x24:0x10+3",
        ),
        ("(0x24, 0x43)", "(0x43, 0x24)", "data[0].banks: the first bank 0x43 comes after the last bank 0x24"),
        ("(0x24, 0x43)", "0x24", "data[0].banks must be the first and the last bank, such as (0x24, 0x43)"),
        ("(0x24, 0x43)", "(0x24, 0x143)", "data[0].banks must be the first and the last bank, such as (0x24, 0x43)"),
        ("bank: 0x25", "bank: 0x23", "data[0].listed[0].bank: bank 0x23 is outside the range 0x24 to 0x43"),
        (
            "data: [(banks: (0x24, 0x43)",
            "data: [(banks: (0x04, 0x24)), (banks: (0x24, 0x43)",
            "data[1].banks: bank 0x24 appears twice",
        ),
        ("\"00 01", "\"01", "data[0].listed[0].bytes: 63 bytes instead of 64"),
        ("\"00 01", "\"00 1", "data[0].listed[0].bytes: \"1\" has an odd number of hexadecimal digits"),
        ("\"00 01", "\"0O 01", "data[0].listed[0].bytes: 'O' is not a hexadecimal digit"),
        ("bytes:", "bites:", "line 4, column 56: data[0].listed[0].bites is unknown, and bytes is missing"),
        ("bank: 0x25,", "", "data[0].listed[0].bank is missing"),
    ];
    for (old, new, message) in cases {
        assert!(SHORT.contains(old), "{old}");
        let error = ProfileDocument::parse(&SHORT.replacen(old, new, 1), BissProfile::FORMATS).unwrap_err().to_string();
        assert!(error.starts_with(message), "{error:?} does not begin with {message:?}");
    }
    let bank = SHORT.split("listed: [").nth(1).unwrap().split(")])]").next().unwrap();
    let error =
        ProfileDocument::parse(&SHORT.replace("listed: [", &format!("listed: [{bank}), ")), BissProfile::FORMATS)
            .unwrap_err()
            .to_string();
    assert_eq!(error, "data[0].listed[1].bank: bank 0x25 appears twice");
}

#[test]
fn omits_empty_banks() {
    let area = Area { name: "OEM data".to_owned().into(), first: 0x24, last: 0x27, access: Access::Rw, open: Some(2) };
    let some = |number| {
        let mut bank = Bank::filled_with(number, 0);
        bank.bytes[5] = 9;
        bank
    };
    let numbers = |image: &DataImage| image.listed.iter().map(|listed| listed.bank.number).collect::<Vec<_>>();
    let zero = |number| Bank::filled_with(number, 0);
    let erased = |number| Bank::filled_with(number, 0xFF);
    for (label, banks, empty, listed) in [
        ("some zero", vec![zero(0x24), some(0x25), zero(0x26), erased(0x27)], Some(0), vec![0x25, 0x27]),
        ("most erased", vec![erased(0x24), some(0x25), zero(0x26), erased(0x27)], Some(0xFF), vec![0x25, 0x26]),
        ("none empty", vec![some(0x24), some(0x25), some(0x26), some(0x27)], None, vec![0x24, 0x25, 0x26, 0x27]),
        ("not all of it", vec![zero(0x24), some(0x25)], None, vec![0x24, 0x25]),
        ("empty", vec![zero(0x24), zero(0x25), zero(0x26), zero(0x27)], Some(0), vec![]),
    ] {
        let image = DataImage::new(&area, banks.clone());
        assert_eq!((image.empty, numbers(&image)), (empty, listed), "{label}");
        assert_eq!(image.all_banks().collect::<Vec<_>>(), banks, "{label}");
    }
}

#[test]
fn mounting_mark_covers_listed_registers() {
    let mut profile = profile(SHORT);
    let item = MountingItem::Registers("0x25:0x08+4".parse().unwrap());
    profile.mounting.push(MountingMark { item, meaning: String::new(), unknown: Default::default() });
    let marked: Vec<u8> =
        (0..64).filter(|at| profile.depends_on_mounting(RegisterAddress::in_bank(0x25, *at).unwrap())).collect();
    assert_eq!(marked, [8, 9, 10, 11]);
    assert!(!profile.depends_on_mounting(RegisterAddress::in_bank(0x26, 8).unwrap()));
    let count = profile.mounting.len();
    profile.mark_mounting_dependent_values();
    assert_eq!(profile.mounting.len(), count, "an encoder without a preset value has nothing of the kind");
}

/// Changing a value changes only that part of the text (issue 22.26).
#[test]
fn change_edits_only_its_value() {
    let text = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/fixtures/commented/biss.ron"));
    let edit = |own: &mut BissProfile| own.filter = Some(PositionFilter::from_byte(0));
    assert_edit_in_place(text, edit, "filter: 4", "filter: 0x00");
}
