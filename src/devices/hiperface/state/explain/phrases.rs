//! Tests of the messages for protocol and link errors, in English and German.

use std::time::Duration;

use crate::app::Language::German;
use crate::app::explain::{assert_in_both_languages, profile_error_text, setting_error_text, url_error_text};
use crate::app::{DeviceType, KindRegistry};
use crate::devices::hiperface::procedures::{ReadBackValue, Station};
use crate::devices::hiperface::profile::{FieldRange, HiperfaceProfile, Item, PlanItem};
use crate::devices::hiperface::protocol::AccessCodeNumber;
use crate::devices::hiperface::sim::Config;
use crate::devices::hiperface::state::Encoder;
use crate::devices::hiperface::state::explain::{plan_item_text, read_back};
use crate::link::UrlQuery;
use crate::profile::{Profile, ProfileDocument, ProfileFormats};

const KINDS: KindRegistry = KindRegistry::new(ProfileFormats::new(&[]), &[Encoder::KIND], &[]);

#[test]
fn explains_link_errors_in_both_languages() {
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
        let query: UrlQuery = text.parse().unwrap();
        let error = Station::from_query(&query, Duration::ZERO).unwrap_err();
        assert_in_both_languages(&url_error_text(&error), &error);
    }
}

#[test]
fn explains_simulator_errors_in_both_languages() {
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
        let query: UrlQuery = text.parse().unwrap();
        let error = Config::from_pairs(query.pairs()).unwrap_err();
        assert_in_both_languages(&setting_error_text(&error), &error);
    }
}

#[test]
fn explains_profile_errors_in_both_languages() {
    let good = r#"(schema: 1, device: "hiperface", identity: (serial_number: "A1", encoder_type: 0x37),
        interface: (address: 0x40, settings: 0xE4), fields: [(number: 0, status: 0xC8, bytes: "00 01 02 03 04 05 06 07 08 09 0A 0B 0C 0D 0E 0F")])"#;
    assert!(ProfileDocument::parse(good, HiperfaceProfile::FORMATS).is_ok());
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
        let error = ProfileDocument::parse(&good.replacen(from, to, 1), HiperfaceProfile::FORMATS).unwrap_err();
        assert_in_both_languages(&profile_error_text(&error, KINDS), &error);
    }
}

#[test]
fn names_checked_items_in_both_languages() {
    let range = |start, count| PlanItem::Item(Item::Field(FieldRange { field: 1, start, count }));
    let cases = [
        (range(3, Some(2)), "Datenfeld 1 ab 3 (2 Bytes)"),
        (range(16, None), "Datenfeld 1 ab 16"),
        (range(0, None), "Datenfeld 1"),
        (PlanItem::Item(Item::Status(2)), "Status von Datenfeld 2"),
        (PlanItem::Item(Item::Analogue(0x48)), "Analogkanal 0x48"),
        (PlanItem::Item(Item::Counter), "Zähler"),
        (PlanItem::Item(Item::Address), "Adresse"),
        (PlanItem::Item(Item::Settings), "Schnittstelleneinstellungen"),
        (PlanItem::Code(AccessCodeNumber::new(2).unwrap()), "Zugriffsschlüssel 2"),
        (PlanItem::Encoder, "Der Geber selbst"),
        (PlanItem::FieldCount, "Anzahl der Datenfelder"),
    ];
    for (item, german) in cases {
        assert_in_both_languages(&plan_item_text(&item), &item);
        assert_eq!(plan_item_text(&item).to_string_in(German), german);
    }
    assert_in_both_languages(&read_back(&ReadBackValue::StatusMismatch), &ReadBackValue::StatusMismatch);
}
