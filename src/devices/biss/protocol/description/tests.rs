//! Tests of the built-in descriptions against the reference, and of the positions of errors.

use proptest::prelude::*;

use super::super::eds::EdsBank;
use super::super::procedure::{PulseVoltage, *};
use super::super::status::{DeviceMode, ErrorRegister, Temperature, WarningRegister};
use super::*;
use crate::bits::ByteOrder;

fn at(text: &str) -> RegisterAddress {
    text.parse().unwrap()
}

fn kit() -> Description {
    let [(file, text), _] = Descriptions::BUILT_IN;
    Description::parse(file, text).unwrap()
}

fn kit_identity() -> Identity {
    Identity { profile: ProfileId::new(0x6129), manufacturer: *b"Fr", device_id: [0x01, 0x01, 0x68, 0x11, 0x00, 0x01] }
}

#[test]
fn built_in_descriptions_parse() {
    let (all, errors) = Descriptions::read(Descriptions::BUILT_IN);
    assert_eq!(errors, []);
    assert_eq!(all.iter().map(Description::name).collect::<Vec<_>>(), ["POSITAL IXARC kit encoder", "BiSS C encoder"]);
    assert_eq!(all, Descriptions::built_in());
}

/// The expected address, width, access and default values are taken from section 4, "Direct", of the reference.
#[test]
fn kit_encoder_registers_match_reference() {
    use Access::{R, Rw};
    let cases: [(&str, u8, Access, &[u8], Firmware); 24] = [
        ("0x40", 1, Rw, &[], Firmware::new(0, 0, 0)),
        ("0x41", 1, R, &[0x02], Firmware::new(0, 0, 0)),
        ("0x42", 2, R, &[0x61, 0x29], Firmware::new(0, 0, 0)),
        ("0x44", 4, R, &[], Firmware::new(0, 0, 0)),
        ("0x66", 1, R, &[], Firmware::new(0, 0, 0)),
        ("0x68", 1, R, &[], Firmware::new(1, 6, 0)),
        ("0x69", 1, R, &[], Firmware::new(1, 6, 0)),
        ("0x6A", 1, Rw, &[0x00], Firmware::new(0, 0, 0)),
        ("0x6B", 1, Rw, &[0x00], Firmware::new(0, 0, 0)),
        ("0x6E", 1, R, &[0x03], Firmware::new(1, 1, 0)),
        ("0x74", 3, R, &[], Firmware::new(0, 0, 0)),
        ("0x78", 6, R, &[0x01, 0x01, 0x68, 0x11, 0x00, 0x01], Firmware::new(0, 0, 0)),
        ("0x7E", 2, R, b"Fr", Firmware::new(0, 0, 0)),
        ("0x00:0x00", 1, Rw, &[0x00], Firmware::new(0, 0, 0)),
        ("0x00:0x07", 1, R, &[0x00], Firmware::new(0, 0, 0)),
        ("0x00:0x14", 1, R, &[], Firmware::new(0, 0, 0)),
        ("0x00:0x1A", 1, Rw, &[], Firmware::new(0, 0, 0)),
        ("0x00:0x1B", 1, R, &[], Firmware::new(0, 0, 0)),
        ("0x00:0x24", 1, Rw, &[], Firmware::new(1, 1, 0)),
        ("0x01:0x00", 1, Rw, &[0x00], Firmware::new(1, 2, 0)),
        ("0x01:0x02", 3, Rw, &[0x00; 3], Firmware::new(1, 2, 0)),
        ("0x01:0x05", 3, Rw, &[0x00; 3], Firmware::new(1, 2, 0)),
        ("0x02:0x17", 1, R, &[0x21], Firmware::new(0, 0, 0)),
        ("0x03:0x2C", 2, R, &[0x2E, 0xE0], Firmware::new(0, 0, 0)),
    ];
    let kit = kit();
    for (place, width, access, default, since) in cases {
        let register = kit.register_at(at(place)).unwrap();
        assert_eq!(register.address, at(place), "{place}");
        assert_eq!((register.width, register.access), (width, access), "{place}");
        assert_eq!((register.default.as_slice(), register.since), (default, since), "{place}");
    }
    assert_eq!(kit.register_at(at("0x47")).map(|register| register.name.english()), Some("serial number"));
    assert_eq!(kit.register_at(at("0x67")), None);
    let areas: Vec<_> = kit.areas().iter().map(|area| (area.first, area.last, area.size(), area.open)).collect();
    assert_eq!(areas, [(0x04, 0x23, 2048, Some(0x01)), (0x24, 0x43, 2048, Some(0x02))]);
    assert_eq!(kit.access_at(at("0x24:0x10")), Some(Rw));
    assert_eq!(kit.access_at(at("0x44:0x00")), None);
    assert_eq!(kit.area_at(at("0x43:0x3F")).map(|area| area.name.english()), Some("OEM data"));
    assert_eq!(kit.area_at(at("0x66")), None);
    assert_eq!(kit.layout(), Some(&Layout::default()));
    let lock = kit.lock().unwrap();
    assert_eq!((lock.password_at, lock.password, lock.mode_at), (at("0x6B"), 0x2A, at("0x6A")));
}

/// Expected values from section 5 of the reference.
#[test]
fn procedure_registers_match_reference() {
    let kit = kit();
    let cases = [
        (ProcedureKind::WiegandTest, DeviceMode::WIEGAND_TEST, "0x00:0x06", "0x00:0x07", Firmware::new(0, 0, 0)),
        (ProcedureKind::Calibration, DeviceMode::CALIBRATION, "0x00:0x00", "0x00:0x01", Firmware::new(0, 0, 0)),
        (ProcedureKind::DataWrite, DeviceMode::DATA_WRITE, "0x00:0x1A", "0x00:0x1B", Firmware::new(0, 0, 0)),
        (ProcedureKind::FilterSelection, DeviceMode::FILTER, "0x00:0x24", "0x00:0x25", Firmware::new(1, 1, 0)),
        (ProcedureKind::Preset, DeviceMode::PRESET, "0x01:0x00", "0x01:0x01", Firmware::new(1, 2, 0)),
    ];
    for (kind, mode, command, status, since) in cases {
        let procedure = kit.procedure(kind).unwrap();
        assert_eq!((procedure.mode, procedure.since), (mode.byte(), since), "{kind:?}");
        assert_eq!((procedure.command, procedure.status), (at(command), at(status)), "{kind:?}");
    }
    let saves: Vec<_> = kit.registers().iter().filter(|own| !own.saves.is_empty()).collect();
    let saves: Vec<_> = saves.iter().map(|own| (own.address.to_string(), own.saves.clone())).collect();
    assert_eq!(
        saves,
        [
            ("0x00:0x00".to_owned(), vec![2]),
            ("0x00:0x06".to_owned(), vec![5]),
            ("0x00:0x1A".to_owned(), vec![3]),
            ("0x00:0x24".to_owned(), vec![2]),
            ("0x01:0x00".to_owned(), vec![1, 3, 4, 5]),
        ]
    );
}

/// Checks that the description uses the same names, widths and defaults as the tables of the data sheet.
#[test]
fn file_matches_protocol_tables() {
    let kit = kit();
    for bank in [EdsBank::Common, EdsBank::Encoder] {
        for field in bank.fields() {
            let register = kit.register_at(RegisterAddress::in_bank(bank.kit_number(), field.offset).unwrap()).unwrap();
            assert_eq!((register.name.english(), register.width), (field.name, field.width));
            let default = register.to_number(&register.default).and_then(|number| u32::try_from(number).ok());
            assert_eq!(default, field.default, "{}", field.name);
        }
    }
}

#[test]
fn decodes_registers() {
    let kit = kit();
    let decode = |place: &str, bytes: &[u8]| match kit.register_at(at(place)).unwrap().decode(bytes) {
        Some(DecodedValue::Bits(set)) => {
            let words = |(bit, name): (u8, Option<&Name>)| format!("{bit} {}", name.map_or("?", Name::english));
            set.into_iter().map(words).collect::<Vec<_>>().join(", ")
        }
        Some(DecodedValue::Choice(value, name)) => format!("{value} {}", name.map_or("?", Name::english)),
        other => format!("{other:?}"),
    };
    let cases: [(&str, &[u8], &str); 9] = [
        ("0x66", &[0x4B], "Some(Scaled(25.0))"),
        ("0x68", &[0x32], "1 multiturn synchronisation error, 4 magnetic field too low, 5 ?"),
        ("0x6A", &[0x07], "7 preset"),
        ("0x6A", &[0x03], "3 ?"),
        ("0x74", &[1, 6, 0], "Some(Text(\"1.6.0\"))"),
        ("0x7E", b"Fr", "Some(Text(\"Fr\"))"),
        ("0x01:0x02", &[0x00, 0x80, 0x01], "Some(Number(98304))"),
        ("0x03:0x2C", &[0x2E, 0xE0], "Some(Number(12000))"),
        ("0x66", &[], "None"),
    ];
    for (place, bytes, said) in cases {
        assert_eq!(decode(place, bytes), said, "{place}");
    }
    let preset = kit.register_at(at("0x01:0x02")).unwrap();
    assert_eq!(preset.bytes(98_304), Some(vec![0x00, 0x80, 0x01]));
    assert_eq!(preset.bytes(1 << 24), None);
    let average = kit.register_at(at("0x00:0x0A")).unwrap();
    let Some(DecodedValue::Scaled(volts)) = average.decode(&[PulseVoltage::LIMIT.byte()]) else { panic!() };
    assert!((volts - 5.3).abs() < 1e-9 && average.unit == "V");
    let set = |role: Role, byte: u8| match kit.register_with_role(role).unwrap().decode(&[byte]) {
        Some(DecodedValue::Bits(set)) => {
            set.into_iter().map(|(bit, name)| (bit, name.map(Name::english))).collect::<Vec<_>>()
        }
        other => panic!("{other:?}"),
    };
    let errors: Vec<_> = ErrorRegister::new(0x1F).set_bits().map(|(bit, name)| (bit, Some(name))).collect();
    assert_eq!(set(Role::Errors, 0x1F), errors);
    let warnings: Vec<_> =
        WarningRegister::new(0x81).set_bits().map(|(bit, name)| (bit, (bit == 0).then_some(name))).collect();
    assert_eq!(set(Role::Warnings, 0x81), warnings);
    let warm = f64::from(Temperature::new(0xB4).to_celsius());
    assert_eq!(kit.register_with_role(Role::Temperature).unwrap().decode(&[0xB4]), Some(DecodedValue::Scaled(warm)));
}

#[test]
fn german_names_fall_back_to_english() {
    for (file, text) in Descriptions::BUILT_IN {
        let description = Description::parse(file, text).unwrap();
        let all =
            description.registers().iter().map(|own| &own.name).chain(description.areas().iter().map(|own| &own.name));
        let same: Vec<_> = all.filter(|name| name.german() == name.english()).collect();
        assert!(same.is_empty(), "{file}: {same:?}");
    }
    let kit = kit();
    let german = |place: &str| kit.register_at(at(place)).unwrap().name.german();
    assert_eq!((german("0x44"), german("0x02:0x3F")), ("Seriennummer", "Prüfsumme"));
    let banks: Vec<_> = [0x00, 0x01, 0x02, 0x24].map(|bank| kit.bank_name(bank).unwrap().german()).into();
    assert_eq!(banks, ["Sonderfunktionen", "Preset", "EDS, allgemein", "OEM-Daten"]);
    let own = "(name: \"x\", areas: [(name: \"data\", banks: (4, 5), access: rw), (name: \"more\", banks: (6, 7), access: r)], \
               german: { \"data\": \"Daten\" })";
    let own = Description::parse("own.ron", own).unwrap();
    let names: Vec<_> = own.areas().iter().map(|area| (area.name.english(), area.name.german())).collect();
    assert_eq!(names, [("data", "Daten"), ("more", "more")]);
}

#[test]
fn finds_encoder_description() {
    let all = Descriptions::built_in();
    assert_eq!(all.find(&kit_identity()).unwrap().name(), "POSITAL IXARC kit encoder");
    let other = Identity { manufacturer: *b"XY", ..kit_identity() };
    assert_eq!(all.find(&other).unwrap().name(), "BiSS C encoder");
    assert_eq!(
        kit().check_identity(&other).unwrap_err().to_string(),
        "the encoder reports profile 0x6129, manufacturer 58 59, device ID 01 01 68 11 00 01, but the description \
         \"POSITAL IXARC kit encoder\" is for profile 0x6129, manufacturer 46 72, device ID 01 01 68 11 00 01"
    );
    let own = "(name: \"mine\", identity: Some((profile: 0x6129, manufacturer: (70, 114), device_id: (1, 1, 104, 17, 0, 1))))";
    let anything = "(name: \"anything\")";
    let broken = "(name: 7)";
    let (own, errors) = Descriptions::read([("a.ron", anything), ("b.ron", broken), ("c.ron", own)]);
    assert_eq!(errors.iter().map(|error| error.file.as_str()).collect::<Vec<_>>(), ["b.ron"], "the rest still loads");
    let all = all.merged_with(own);
    assert_eq!(all.find(&kit_identity()).unwrap().name(), "mine");
    assert_eq!(all.find(&other).unwrap().name(), "anything");
    assert!(all.find_by_name("BiSS C encoder").is_some());
}

#[test]
fn description_errors_name_their_location() {
    let register = |row: &str| format!("(\n    name: \"x\",\n    registers: [\n        {row},\n    ],\n)");
    let cases = [
        (String::new(), 1, ""),
        ("(\n  nam: \"x\",\n)".to_owned(), 2, "nam"),
        ("(\n  name: \"x\",\n  frame: Some((multiturn: 40, singleturn: 17, error: true, warning: true)),\n)".to_owned(), 3,
            "multiturn must have at most 32 bits, not 40"),
        ("(\n  name: \"x\",\n  frame: Some((multiturn: 4, singleturn: 7, error: true, warning: true,\n    crc: Some((polynomial: 0x42, inverted: true)))),\n)"
            .to_owned(), 4, "the CRC polynomial 0x42 must have the constant term 1"),
        (register("(at: direct(0x3F), name: \"y\", access: r)"), 4, "must be from 0x40 to 0x7F"),
        (register("(at: bank(0x01, 0x40), name: \"y\", access: r)"), 4, "must be from 0x00 to 0x3F"),
        (register("(at: direct(0x7F), width: 2, name: \"y\", access: r)"), 4, "2 bytes at 0x7F extends past"),
        (register("(at: direct(0x70), width: 9, name: \"y\", access: r)"), 4, "a register has 1 to 8 bytes, not 9"),
        (register("(at: direct(0x70), width: 0, name: \"y\", access: r)"), 4, "a register has 1 to 8 bytes, not 0"),
        (register("(at: direct(0x70), name: \"y\", access: r, default: [1, 2])"), 4, "default bytes (2) does not match"),
        (register("(at: direct(0x70), name: \"y\", access: r, decode: bits([(8, \"z\")]))"), 4, "bit 8 is outside"),
        (register("(at: direct(0x70), name: \"y\", access: r, saves: [1])"), 4, "cannot have \"saves\" values"),
        (register("(at: direct(0x70), name: \"y\", access: x)"), 4, "x"),
        (register("(at: direct(0x70), name: \"y\", access: r, decode: scaled(factor: inf, offset: 0.0))"), 4, "finite"),
        (register("(at: direct(0x70), name: \"y\", access: r),\n        (at: direct(0x70), name: \"z\", access: r)"), 5,
            "register 0x70 is defined more than once"),
        ("(\n  name: \"x\",\n  areas: [\n    (name: \"a\", banks: (5, 4), access: rw),\n  ],\n)".to_owned(), 4,
            "the first bank (0x05) comes after the last bank (0x04)"),
        ("(\n  name: \"x\",\n  areas: [\n    (name: \"a\", banks: (4, 5), access: rw),\n    (name: \"b\", banks: (5, 6), access: rw),\n  ],\n)"
            .to_owned(), 5, "bank 0x05 is defined more than once"),
        ("(\n  name: \"x\",\n  areas: [(name: \"a\", banks: (4, 5), access: rw)],\n  german: {\n    \"b\": \"c\",\n  },\n)".to_owned(),
            5, "the description does not contain the name \"b\""),
        ("(\n  name: \"x\",\n  german: {\n    \"a\": \" \",\n  },\n)".to_owned(), 4, "the German name is empty"),
    ];
    for (text, line, what) in cases {
        let error = Description::parse("mine.ron", &text).unwrap_err();
        assert_eq!(error.line, line, "{error}");
        assert!(error.problem.to_string().contains(what), "{error}");
        assert!(error.to_string().starts_with(&format!("mine.ron, line {line}, column ")), "{error}");
    }
}

proptest! {
    #[test]
    fn numbers_round_trip_in_both_byte_orders(number: u64, width in 1u8..=8, low_first: bool) {
        let mut register = kit().registers()[0].clone();
        (register.width, register.order) = (width, if low_first { ByteOrder::LowFirst } else { ByteOrder::HighFirst });
        let fits = width == 8 || number >> (8 * u32::from(width)) == 0;
        let bytes = register.bytes(number);
        prop_assert_eq!(bytes.is_some(), fits);
        if let Some(bytes) = bytes {
            prop_assert_eq!(register.to_number(&bytes), Some(number));
        }
    }

    #[test]
    fn arbitrary_text_never_panics(cut in 0usize..400, more in ".*") {
        let [_, (_, text)] = Descriptions::BUILT_IN;
        let head: String = text.chars().rev().take(cut).collect::<String>().chars().rev().collect();
        let _ = Description::parse("x", &format!("{head}{more}"));
    }
}
