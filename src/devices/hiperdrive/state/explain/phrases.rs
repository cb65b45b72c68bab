//! Tests of the messages for errors from lower layers, in both languages.

use std::time::Duration;

use crate::app::Language::German;
use crate::app::explain::{assert_in_both_languages, profile_error_text, setting_error_text, url_error_text};
use crate::app::{DeviceType, KindRegistry};
use crate::devices::hiperdrive::procedures::Station;
use crate::devices::hiperdrive::profile::HiperdriveProfile;
use crate::devices::hiperdrive::sim::Config;
use crate::devices::hiperdrive::state::HiperdriveDevice;
use crate::link::UrlQuery;
use crate::profile::{Profile, ProfileDocument, ProfileFormats};

const KINDS: KindRegistry = KindRegistry::new(ProfileFormats::new(&[]), &[HiperdriveDevice::KIND], &[]);

#[test]
fn explains_link_errors() {
    for text in ["rpi=1", "timeout=1", "order=middle", "udp=0"] {
        let query: UrlQuery = text.parse().unwrap();
        let error = Station::from_query(&query, None, Duration::ZERO).unwrap_err();
        assert_in_both_languages(&url_error_text(&error), &error);
    }
}

#[test]
fn explains_virtual_drive_errors() {
    for text in ["sed=1", "s3=10", "switch=100", "hub=2", "variant=x", "drives=1,1", "speed=1", "load=x", "name=ä"] {
        let query: UrlQuery = text.parse().unwrap();
        let error = Config::from_pairs(query.pairs()).unwrap_err();
        assert_in_both_languages(&setting_error_text(&error), &error);
    }
}

#[test]
fn explains_profile_errors() {
    let good = r#"(schema: 1, device: "hiperdrive", identity: (category: "HIPERDRIVE HUB-4"),
        drives: [(number: 1, parameters: {158: 5}), (number: 2)], mounting: [(item: "198")])"#;
    assert!(ProfileDocument::parse(good, HiperdriveProfile::FORMATS).is_ok());
    let cases = [
        ("HUB-4", "HUB-5"),
        ("number: 2", "number: 9"),
        ("number: 2", "number: 1"),
        ("{158: 5}", "[158]"),
        ("{158: 5}", "{158: \"x\"}"),
        ("\"198\"", "\"drive\""),
        ("\"198\"", "\"9\""),
        ("\"198\"", "\"198 drive 9\""),
        ("\"198\"", "\"100\""),
    ];
    for (from, to) in cases {
        let error = ProfileDocument::parse(&good.replacen(from, to, 1), HiperdriveProfile::FORMATS).unwrap_err();
        assert_in_both_languages(&profile_error_text(&error, KINDS), &error);
    }
    // The window uses its own names for the parameters.
    for (from, to, german) in [
        ("drives: [", "parameters: {9: 5}, drives: [", "vom Gerät nicht gespeichert"),
        ("{158: 5}", "{186: 300}", "300"),
    ] {
        let error = ProfileDocument::parse(&good.replacen(from, to, 1), HiperdriveProfile::FORMATS).unwrap_err();
        let words = profile_error_text(&error, KINDS).to_string_in(German);
        assert!(words.contains(german) && !words.contains(" not ") && !words.contains(" must "), "{words}");
    }
}
