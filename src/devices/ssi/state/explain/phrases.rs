//! Tests of the messages for errors of the lower layers, in both languages.

use std::time::Duration;

use crate::app::Language::German;
use crate::app::explain::{assert_in_both_languages, profile_error_text, url_error_text};
use crate::app::{DeviceType, KindRegistry};
use crate::devices::ssi::procedures::Station;
use crate::devices::ssi::profile::SsiProfile;
use crate::devices::ssi::protocol::{ClockUse, LayoutError, RepeatableElement};
use crate::devices::ssi::state::Encoder;
use crate::devices::ssi::state::explain::layout_error_text;
use crate::link::UrlQuery;
use crate::profile::{Profile, ProfileDocument, ProfileFormats};

const KINDS: KindRegistry = KindRegistry::new(ProfileFormats::new(&[]), &[Encoder::KIND], &[]);

#[test]
fn explains_link_errors_in_both_languages() {
    for text in ["margin=x", "clock=1", "pause=0", "voltage=48"] {
        let query: UrlQuery = text.parse().unwrap();
        let error = Station::from_query(&query, Duration::ZERO).unwrap_err();
        assert_in_both_languages(&url_error_text(&error), &error);
    }
}

#[test]
fn explains_profile_errors_in_both_languages() {
    let good = r#"(schema: 1, device: "ssi", direction: "cw", preset: 0, reading: (clock_hz: 1000), frame: (clocks: 15,
        singleturn: 14, errors: [(name: "ERROR", clock: 15, meaning: "invalid")], patterns: [(name: "fault",
        word: "ones", meaning: "invalid")]))"#;
    assert!(ProfileDocument::parse(good, SsiProfile::FORMATS).is_ok());
    let cases = [
        ("frame:", "fram:"),
        ("clocks: 15", "clocks: 256"),
        ("clocks: 15", "clocks: 15, code: \"grey\""),
        ("clocks: 15", "clocks: 15, over: \"all\""),
        ("clocks: 15", "clocks: 15, steps: 3"),
        ("clocks: 15", "clocks: 15, shift: 1"),
        ("singleturn: 14", "multiturn: 14"),
        ("singleturn: 14", "steps: 9, revolutions: 0.5"),
        ("\"cw\"", "\"left\""),
        ("preset: 0", "preset: 16384"),
        ("preset: 0", "preset: -1"),
        ("clock_hz: 1000", "clock_hz: 999"),
        ("meaning: \"invalid\"", "meaning: \"bad\""),
        ("\"ones\"", "\"all\""),
        ("clocks: 15", "clocks: 65"),
        ("clocks: 15", "clocks: 13"),
        ("clocks: 15", "clocks: 14"),
        ("clocks: 15", "clocks: 15, lead: 1, area: 14"),
        ("clocks: 15", "clocks: 15, between: 1, area: 15"),
        ("clocks: 15", "clocks: 15, area: 15, over: \"padded\", code: \"gray\""),
        ("clocks: 15", "clocks: 15, area: 15, shift: true"),
        ("clocks: 15", "clocks: 15, over: \"padded\""),
        ("clocks: 15", "clocks: 15, parity: (clock: 14, even: true)"),
        ("clocks: 15", "clocks: 15, repeat: (word: 15)"),
        ("clock: 15", "clock: 14"),
        ("singleturn: 14", "singleturn: 33"),
        ("singleturn: 14", "singleturn: 0"),
        ("singleturn: 14", "steps: 9, revolutions: \"1/0\""),
        ("singleturn: 14", "steps: 359, code: \"gray-excess\""),
        ("\"ones\"", "0x8000"),
    ];
    for (from, to) in cases {
        let error = ProfileDocument::parse(&good.replacen(from, to, 1), SsiProfile::FORMATS).unwrap_err();
        assert_in_both_languages(&profile_error_text(&error, KINDS), &error);
    }
}

#[test]
fn translates_nested_phrases_to_german() {
    let cases = [
        (
            LayoutError::Overlap { clock: 14, first: ClockUse::Position, second: ClockUse::Error("ERROR".to_owned()) },
            "Takt 14 wird von der Position und von ERROR belegt",
        ),
        (
            LayoutError::Behind { name: ClockUse::Parity, clock: 30, clocks: 15 },
            "Takt 30 mit dem Paritätsbit liegt hinter den 15 Takten",
        ),
        (
            LayoutError::Many { what: RepeatableElement::Patterns, limit: 32, count: 33 },
            "höchstens 32 Muster sind möglich, nicht 33",
        ),
    ];
    for (error, german) in cases {
        let words = layout_error_text(&error).to_string_in(German);
        assert!(words.contains(german), "{words}");
    }
}
