//! Tests of messages from the layers below, in both languages.

use std::time::Duration;

use crate::app::explain::{assert_in_both_languages, profile_error_text, url_error_text};
use crate::app::{DeviceType, KindRegistry};
use crate::devices::biss::procedures::{Station, Transport};
use crate::devices::biss::profile::BissProfile;
use crate::devices::biss::state::Encoder;
use crate::link::UrlQuery;
use crate::profile::{Profile, ProfileDocument, ProfileFormats};

const KINDS: KindRegistry = KindRegistry::new(ProfileFormats::new(&[]), &[Encoder::KIND], &[]);

#[test]
fn explains_link_errors() {
    for text in ["order=x", "echo=x", "timeout=0", "margin=x", "clock=1", "voltage=24"] {
        let query: UrlQuery = text.parse().unwrap();
        let error = Station::from_query(&query, Transport::Adapter, Duration::ZERO).unwrap_err();
        assert_in_both_languages(&url_error_text(&error), &error);
    }
}

#[test]
fn explains_profile_errors() {
    let bytes = "00 ".repeat(64);
    let good = r#"(schema: 1, device: "biss", identity: (serial_number: "1", profile_id: 0x6129, firmware: "1.6.0",
        device_id: "01 01 68 11 00 01", manufacturer: "46 72"), recorded: (wiegand_last: [1, 2, 3, 4]),
        mounting: [(item: "calibration")], data: [(banks: (0x24, 0x43), listed: [(bank: 0x25, bytes: "BYTES")])])"#
        .replace("BYTES", &bytes);
    assert!(ProfileDocument::parse(&good, BissProfile::FORMATS).is_ok());
    let cases = [
        ("0x6129", "0x16129"),
        ("1.6.0", "1.6"),
        ("46 72", "46"),
        ("3, 4]", "3]"),
        ("\"calibration\"", "\"x\""),
        ("\"calibration\"", "7"),
        ("(0x24, 0x43)", "7"),
        ("(0x24, 0x43)", "(0x43, 0x24)"),
        ("(0x24, 0x43)", "(0x26, 0x43)"),
        ("data: [", "data: [(banks: (0, 0x24)), "),
    ];
    for (from, to) in cases {
        let error = ProfileDocument::parse(&good.replacen(from, to, 1), BissProfile::FORMATS).unwrap_err();
        assert_in_both_languages(&profile_error_text(&error, KINDS), &error);
    }
}
