//! Tests that errors from profiles and gateways are explained in both languages.

use crate::app::explain::{assert_in_both_languages, profile_error_text};
use crate::app::{DeviceType, KindRegistry};
use crate::devices::interbus::procedures::Exception;
use crate::devices::interbus::profile::InterbusProfile;
use crate::devices::interbus::state::Encoder;
use crate::profile::{Profile, ProfileDocument, ProfileFormats};

const KINDS: KindRegistry = KindRegistry::new(ProfileFormats::new(&[]), &[Encoder::KIND], &[]);

#[test]
fn explains_profile_errors_in_both_languages() {
    let good = r#"(schema: 1, device: "interbus", parameters: (steps: 3600, revolutions: 1, direction: "cw", preset: 0,
        zero_shift: 0), shift: 8, mounting: [(item: "preset")], programs: [(program: 1, mask: 1, cams: [(cam: 0,
        start: 1, stop: 2)])])"#;
    assert!(ProfileDocument::parse(good, InterbusProfile::FORMATS).is_ok());
    let cases = [
        ("parameters:", "parametres:"),
        ("3600", "-1"),
        ("\"cw\"", "\"left\""),
        ("shift: 8", "shift: 26"),
        ("\"preset\"", "7"),
        ("\"preset\"", "\"operating-time\""),
        ("\"preset\"", "\"cam:9:0\""),
        ("\"preset\"", "\"cam:1:8\""),
        ("\"preset\"", "\"x\""),
        ("program: 1", "program: 0"),
        ("mask: 1", "mask: 256"),
        ("cam: 0", "cam: 8"),
        ("cams: [", "cams: [(cam: 0, start: 1, stop: 2), "),
        ("programs: [", "programs: [(program: 1, mask: 1), "),
        ("start: 1, ", ""),
    ];
    for (from, to) in cases {
        let error = ProfileDocument::parse(&good.replacen(from, to, 1), InterbusProfile::FORMATS).unwrap_err();
        assert_in_both_languages(&profile_error_text(&error, KINDS), &error);
    }
}

#[test]
fn names_exceptions_in_both_languages() {
    for code in 0..=u8::MAX {
        let exception = Exception::new(code);
        assert_in_both_languages(&super::gateway::exception_name(exception), &exception.name());
    }
}
