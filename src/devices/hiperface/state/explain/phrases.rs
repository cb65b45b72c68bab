//! What the lower layers of the device say, in both languages.

use std::time::Duration;

use crate::app::Language::{English, German};
use crate::app::explain::{document, in_both_languages, phrase, setting, url};
use crate::devices::hiperface::procedures::Station;
use crate::devices::hiperface::profile::HiperfaceProfile;
use crate::devices::hiperface::sim::Config;
use crate::link::Query;
use crate::profile::{Document, Profile};

#[test]
fn a_wrong_link_is_told_in_both_languages() {
    let queries = [
        "baud=1",
        "parity=x",
        "address=x",
        "echo=x",
        "timeout=1",
        "margin=x",
        "periods=0",
        "turns=2",
        "periods=2&turns=0",
    ];
    for text in queries {
        let query: Query = text.parse().unwrap();
        let error = Station::from_query(&query, Duration::ZERO).unwrap_err();
        in_both_languages(&url(&error), &error);
    }
}

#[test]
fn a_wrong_setting_of_a_virtual_encoder_is_told_in_both_languages() {
    let queries = [
        "sed=1",
        "seed=x",
        "fault=x",
        "fault=drop:2",
        "fault=delay:x",
        "model=x",
        "type=x",
        "serial=",
        "address=x",
        "settings=x",
        "rpm=x",
        "position=x",
        "temperature=x",
        "echo=x",
        "encoders=9",
        "pace=x",
        "codes=x",
        "model=sks36&position=4096",
        "address=0x5F&encoders=2",
    ];
    for text in queries {
        let query: Query = text.parse().unwrap();
        let error = Config::from_pairs(query.pairs()).unwrap_err();
        in_both_languages(&setting(&error), &error);
    }
}

#[test]
fn a_wrong_profile_is_told_in_both_languages() {
    let good = r#"(schema: 1, device: "hiperface", identity: (serial_number: "A1", encoder_type: 0x37),
        interface: (address: 0x40, settings: 0xE4), fields: [(number: 0, status: 0xC8, bytes: "00 01 02 03 04 05 06 07 08 09 0A 0B 0C 0D 0E 0F")])"#;
    assert!(Document::parse(good, HiperfaceProfile::FORMATS).is_ok());
    let cases = [
        ("fields:", "feilds:"),
        ("identity: (", "identity: 7, was: ("),
        ("fields: [", "fields: 7, was: ["),
        ("encoder_type: 0x37", "encoder_type: 300"),
        ("\"A1\"", "7"),
        ("number: 0", "number: 300"),
        ("schema: 1", "schema: \"x\""),
        ("status: 0xC8", "status: 0x48"),
        ("status: 0xC8", "status: 0xC8, locked: true"),
        ("status: 0xC8", "status: 0xC8, locked: 7"),
        ("bytes: ", "bites: "),
        ("bytes: \"00", "bytes: \""),
        ("bytes: \"00", "bytes: \"0G"),
        ("bytes: \"00", "bytes: \"0"),
        ("schema: 1", "schema: 1, schema: 1"),
    ];
    for (from, to) in cases {
        let error = Document::parse(&good.replacen(from, to, 1), HiperfaceProfile::FORMATS).unwrap_err();
        in_both_languages(&document(&error), &error);
    }
}

#[test]
fn what_can_be_read_is_named_in_both_languages() {
    let cases = [
        ("field:1@3+2", "Datenfeld 1 ab 3 (2 Bytes)"),
        ("field:255@16", "Datenfeld 255 ab 16"),
        ("field:0", "Datenfeld 0"),
        ("status:2", "Status von Datenfeld 2"),
        ("analogue:0x48", "Analogkanal 0x48"),
        ("code 2", "Zugriffsschlüssel 2"),
        ("settings", "Schnittstelleneinstellung"),
    ];
    for (words, german) in cases {
        assert_eq!((phrase(words).words(English), phrase(words).words(German)), (words.to_owned(), german.to_owned()));
    }
}
