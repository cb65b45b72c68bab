//! Tests of format strings and tables. `tests/behaviour/ssi_export.rs` tests the compiled decoders.

use super::*;
use crate::devices::ssi::protocol::{ErrorBit, Families, FrameDescriptor, Layout, Parity, Settings};

fn layout(text: &str) -> Layout {
    let (key, settings) = Settings::parse(text).unwrap();
    settings.resolve(Families::built_in().find_by_key(&key).unwrap()).unwrap().layout
}

#[test]
fn format_strings_match_linuxcnc() {
    let table = [
        ("atm60,code=gray", "position%25ge"),
        ("ahs36", "error%1bposition%14e"),
        ("ahs36,st=12,code=gray", "error%1b%2pposition%12ge"),
        ("ahm36,st=12,err=following", "%2perror%1bposition%24e"),
        ("atm60,mt=8,st=8", "%5pposition%16e%4p"),
        ("ttk70,clocks=31", "%5ptemperature%1bgap%1bposition%24e"),
        ("ars60", "transmitter%1bposition-error%1bposition%15e"),
    ];
    for (text, format) in table {
        let layout = layout(text);
        assert_eq!(to_linuxcnc(&layout).as_deref(), Ok(format), "{text}");
        let read = from_linuxcnc(format).unwrap();
        assert_eq!(to_linuxcnc(&read).as_deref(), Ok(format), "{text}");
        for frame in [0x123_4567, 0x2A_5B5A, 1] {
            assert_eq!(read.decode(frame).position, layout.decode(frame).position, "{text}");
        }
    }
    assert_eq!(from_linuxcnc("ssi_chan_0=error%1bposition%24ge").unwrap().clock_count(), 25);
}

/// A handwritten layout may give its bits any names, but LinuxCNC requires a unique pin name for each bit.
#[test]
fn each_bit_has_unique_pin() {
    let mut frame = layout("ahs36").descriptor().clone();
    let names = ["LAMP", "lamp", "", "50 % \n load", "position"];
    let [error] = frame.errors.as_slice() else { panic!("{frame:?}") };
    let named = |(name, clock): (&&str, u8)| ErrorBit { name: (*name).to_owned(), clock, ..error.clone() };
    frame.errors = names.iter().zip(15..).map(named).collect();
    frame.clocks = 19;
    let layout = Layout::new(frame).unwrap();
    let format = to_linuxcnc(&layout).unwrap();
    assert_eq!(format, "position-2%1b50-----load%1bbit%1blamp%1blamp-2%1bposition%14e");
    assert_eq!(to_linuxcnc(&from_linuxcnc(&format).unwrap()), Ok(format));
}

#[test]
fn reports_linuxcnc_limits() {
    let cases = [
        ("atm60,steps=3600,code=gray-excess", "LinuxCNC cannot decode gray excess"),
        ("ahs36,code=gray,st=12,over=padded", "LinuxCNC cannot decode Gray code that also covers zeros or error bits"),
    ];
    for (text, reason) in cases {
        assert_eq!(to_linuxcnc(&layout(text)).unwrap_err().to_string(), reason);
    }
    let cases = [
        (
            "",
            "the format string contains no position; add a field of type e or u (for Gray code, put g before the type)",
        ),
        (
            "error%1b",
            "the format string contains no position; add a field of type e or u (for Gray code, put g before the type)",
        ),
        ("a%12eb%12e", "the format string contains two positions, \"b\" and \"a\""),
        (
            "position%24",
            "\"position%24\" must be NAME%BITS followed by a type (p, b, u, s, f or e; for Gray code, put g before the type)",
        ),
        (
            "position%0e",
            "\"position%0e\" must be NAME%BITS followed by a type (p, b, u, s, f or e; for Gray code, put g before the type)",
        ),
        (
            "low%16l",
            "the field type \"l\" is not supported; use p, b, u, s, f or e (for Gray code, put g before the type)",
        ),
        ("position%60e%5p", "the fields together have more than 64 bits"),
    ];
    for (text, reason) in cases {
        assert_eq!(from_linuxcnc(text).unwrap_err().to_string(), reason, "{text}");
    }
}

#[test]
fn sheet_separates_parity_from_error_bits() {
    let sheet = |layout: &Layout| {
        settings_sheet(layout, None, "", &english_text).lines().map(str::to_owned).collect::<Vec<_>>()
    };
    let power_failure = |lines: &[String]| lines.iter().find(|line| line.contains("power failure bit")).cloned();
    let error = power_failure(&sheet(&layout("ahs36"))).unwrap();
    assert!(error.ends_with("1 (the last bit is an error bit)"), "{error}");
    let parity = Some(Parity { clock: 15, even: true });
    let own = Layout::new(FrameDescriptor { clocks: 15, parity, ..FrameDescriptor::binary(0, 14) }).unwrap();
    let lines = sheet(&own);
    let error = power_failure(&lines).unwrap();
    assert!(error.ends_with(" 0"), "{error}");
    assert!(lines.iter().any(|line| line.contains("divide the value by 2 ")), "{lines:?}");
}

/// Two flags with the same name would be a redefinition in C, and one of them would be lost.
#[test]
fn flags_have_unique_names() {
    let text = generate_c99(&from_linuxcnc("ones%1berror%1bposition%14eerror%1b").unwrap(), "");
    let names: Vec<&str> = text.lines().filter_map(|line| line.strip_prefix("#define ")?.split(' ').next()).collect();
    assert_eq!(names, ["SSI_ERROR", "SSI_ERROR_", "SSI_ONES", "SSI_NO_CODE", "SSI_PADDING", "SSI_ONES_", "SSI_ZEROS"]);
}

#[test]
fn sheet_has_row_per_clock() {
    let table = bit_table(&layout("ahs36,st=12,err=following"), &english_text);
    let rows: Vec<&str> = table.lines().collect();
    assert_eq!(rows.len(), 16);
    assert_eq!(rows[..2], ["clock,frame_bit,meaning", "1,14,ST11"]);
    assert_eq!(rows[12..], ["12,3,ST0", "13,2,ERROR", "14,1,0", "15,0,0"]);
}
