//! What lower floors say, in both languages.

use std::time::Duration;

use super::*;
use crate::app::Language::{English, German};
use crate::devices::biss::procedures as biss;
use crate::devices::biss::profile::BissProfile;
use crate::devices::hiperface::procedures::Station;
use crate::devices::hiperface::profile::HiperfaceProfile;
use crate::devices::hiperface::sim::Config;
use crate::devices::interbus::profile::InterbusProfile;
use crate::devices::ssi::procedures as ssi;
use crate::devices::ssi::profile::SsiProfile;
use crate::link::{LinkUrl, Query, read_trace};
use crate::profile::{Document, Profile};

/// English is what the lower floor says, and German is not.
#[track_caller]
fn check(text: &Text, error: &dyn std::fmt::Display) {
    assert_eq!(text.words(English), error.to_string());
    assert_eq!(text.terminal(), error.to_string());
    let german = text.words(German);
    assert_ne!(german, error.to_string());
    for english in [" is ", " must ", " from ", " to ", " the ", " or ", " and ", " of ", " a "] {
        assert!(!format!(" {german} ").contains(english), "{german}");
    }
}

#[test]
fn a_wrong_link_is_told_in_both_languages() {
    for text in ["usb:1", "serial:", "replay:", "tcp:host", "bridge:", "serial:x?baud", "serial:x?baud=1&baud=2"] {
        let error = text.parse::<LinkUrl>().unwrap_err();
        check(&url(&error), &error);
    }
    let error = UrlError::Device { scheme: "bridge", known: "sim:, serial:, tcp:, replay:" };
    assert_eq!(url(&error).words(English), error.to_string());
    assert_ne!(url(&error).words(German), error.to_string());
    let known = "baud, parity".to_owned();
    let error = UrlError::Unknown { name: "bad".to_owned(), scheme: "serial", known };
    check(&url(&error), &error);
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
        check(&url(&error), &error);
    }
    for text in ["order=x", "echo=x", "timeout=0", "margin=x", "clock=1", "voltage=24"] {
        let query: Query = text.parse().unwrap();
        let error = biss::Station::from_query(&query, biss::Way::Adapter, Duration::ZERO).unwrap_err();
        check(&url(&error), &error);
    }
    for text in ["margin=x", "clock=1", "pause=0", "voltage=48"] {
        let query: Query = text.parse().unwrap();
        let error = ssi::Station::from_query(&query, Duration::ZERO).unwrap_err();
        check(&url(&error), &error);
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
        check(&setting(&error), &error);
    }
    let queries = "sed=1 seed=x firmware=1 serial=x rpm=x waver=x position=x temperature=x errors=x filter=x \
                   cycles=x pulses=x calibration=x calibration-silent=x echo=x order=x line=x noise=x ssi=x \
                   ssi-error=x ssi=afs60&ssi-error=x supply=x uart=x motor=x version=x";
    for text in queries.split_whitespace() {
        let query: Query = text.parse().unwrap();
        let error =
            crate::buses::bridge::sim::Adapter::from_pairs(query.pairs(), &crate::sim::AT_ADAPTER).err().unwrap();
        check(&setting(&error), &error);
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
        check(&document(&error), &error);
    }
}

#[test]
fn a_wrong_biss_profile_is_told_in_both_languages() {
    let bytes = "00 ".repeat(64);
    let good = r#"(schema: 1, device: "biss", identity: (serial_number: "1", profile_id: 0x6129, firmware: "1.6.0",
        device_id: "01 01 68 11 00 01", manufacturer: "46 72"), recorded: (wiegand_last: [1, 2, 3, 4]),
        mounting: [(item: "calibration")], data: [(banks: (0x24, 0x43), listed: [(bank: 0x25, bytes: "BYTES")])])"#
        .replace("BYTES", &bytes);
    assert!(Document::parse(&good, BissProfile::FORMATS).is_ok());
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
        let error = Document::parse(&good.replacen(from, to, 1), BissProfile::FORMATS).unwrap_err();
        check(&document(&error), &error);
    }
}

#[test]
fn a_wrong_interbus_profile_is_told_in_both_languages() {
    let good = r#"(schema: 1, device: "interbus", parameters: (steps: 3600, revolutions: 1, direction: "cw", preset: 0,
        zero_shift: 0), shift: 8, mounting: [(item: "preset")], programs: [(program: 1, mask: 1, cams: [(cam: 0,
        start: 1, stop: 2)])])"#;
    assert!(Document::parse(good, InterbusProfile::FORMATS).is_ok());
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
        let error = Document::parse(&good.replacen(from, to, 1), InterbusProfile::FORMATS).unwrap_err();
        check(&document(&error), &error);
    }
}

#[test]
fn a_wrong_ssi_profile_is_told_in_both_languages() {
    let good = r#"(schema: 1, device: "ssi", direction: "cw", preset: 0, reading: (clock_hz: 1000), frame: (clocks: 15,
        singleturn: 14, errors: [(name: "ERROR", clock: 15, meaning: "invalid")], patterns: [(name: "fault",
        word: "ones", meaning: "invalid")]))"#;
    assert!(Document::parse(good, SsiProfile::FORMATS).is_ok());
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
        let error = Document::parse(&good.replacen(from, to, 1), SsiProfile::FORMATS).unwrap_err();
        check(&document(&error), &error);
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

#[test]
fn wrong_recordings_and_logbooks_are_told_in_both_languages() {
    for text in ["", "# encoder-studio trace 1\n0.1 = 40", "# encoder-studio trace 1\n1 > 4G"] {
        let error = read_trace(text).unwrap_err();
        check(&recording(&error), &error);
    }
    let problems = [
        LogbookProblem::NoAccess,
        LogbookProblem::WriteProtected,
        LogbookProblem::Locked,
        LogbookProblem::DiskFull,
        LogbookProblem::Damaged { what: "page 3".to_owned() },
        LogbookProblem::Newer { found: 3, known: 2 },
    ];
    for problem in problems {
        let error = LogbookError { path: "l.sqlite".into(), problem };
        check(&logbook_problem(&error), &error);
    }
}
