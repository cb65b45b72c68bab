//! Tests of all families against the golden frames (reference section 8) and the pitfalls (section 6).

use super::*;
use crate::devices::ssi::protocol::{BitMeaning, Direction, Flags, FrameFinding, Location, Range, gray_to_binary};

fn resolve(text: &str) -> Result<ResolvedFrame, String> {
    let (key, settings) = Settings::parse(text).map_err(|error| error.to_string())?;
    let families = Families::built_in();
    let family = families.find_by_key(&key).ok_or_else(|| format!("no family {key}"))?;
    settings.resolve(family).map_err(|error| error.to_string())
}

fn error_flag(resolved: &ResolvedFrame, name: &str) -> Flags {
    let errors = &resolved.layout.descriptor().errors;
    errors.iter().position(|bit| bit.name == name).map_or(Flags::NONE, Flags::error)
}

#[test]
fn built_in_families_parse() {
    let (families, errors) = Families::read(Families::BUILT_IN);
    assert_eq!(errors, []);
    for (family, (file, _)) in families.iter().zip(Families::BUILT_IN) {
        assert_eq!(format!("{}.ron", family.key), file);
    }
}

#[test]
fn family_errors_have_locations() {
    let (_, good) = Families::BUILT_IN[0];
    let whole = good.lines().position(|line| line.trim_start().starts_with("frames:")).unwrap() + 1;
    let key = good.lines().position(|line| line.trim_start().starts_with("key:")).unwrap() + 1;
    let cases = [
        ("\"ahs36\"", "\"AHS 36\"", key, "the key \"AHS 36\" may contain only lower-case letters, digits, - and _"),
        ("\"ahs36\"", "\"\"", key, "the key \"\" may contain only"),
        ("clock: 15", "clock: 14", whole, "factory setting: clock 14 is used by both the position and ERROR"),
        ("singleturn: (1, 14, 14)", "singleturn: (1, 14)", 6, ""),
    ];
    for (old, new, line, what) in cases {
        assert!(good.contains(old), "{old}");
        let own = good.replacen(old, new, 1);
        let (families, errors) = Families::read([("own.ron", own.as_str()), Families::BUILT_IN[1]]);
        let [error] = errors.as_slice() else { panic!("{new}: {errors:?}") };
        assert_eq!((error.file.as_str(), error.line), ("own.ron", line), "{new}: {error}");
        assert!(error.problem.to_string().starts_with(what), "{error}");
        assert_eq!(families.iter().map(|family| family.key.as_str()).collect::<Vec<_>>(), ["ahm36"]);
    }
}

/// Frames of reference section 8: settings, turns, steps, active error bit, and bits in clock order.
const GOLDEN: [(&str, u64, u64, &str, &str); 28] = [
    ("ahs36", 0, 0x2A5B, "", "101010010110110"),
    ("ahs36,code=gray", 0, 0x2A5B, "", "111111011101100"),
    ("ahs36,st=12,err=fix", 0, 0xABC, "ERROR", "101010111100001"),
    ("ahs36,st=12,err=following", 0, 0xABC, "ERROR", "101010111100100"),
    ("ahm36", 0x123, 0x2A5B, "", "000100100011101010010110110"),
    ("ahm36,code=gray", 0x123, 0x2A5B, "", "000110110010011111011101100"),
    ("ahm36,st=12", 0x123, 0xABC, "", "000100100011101010111100000"),
    ("ahm36,st=12,err=following", 0x123, 0xABC, "ERROR", "000100100011101010111100100"),
    ("afs60", 0, 0x2ABCD, "", "101010101111001101000"),
    ("afs60,code=gray", 0, 0x2ABCD, "", "111111111000101011000"),
    ("afs60,st=13", 0, 0x1234, "ERRSI", "1001000110100010"),
    ("afm60", 0x5A5, 0x2ABCD, "", "010110100101101010101111001101000"),
    ("afm60,st=15", 0x5A5, 0x4321, "ERRSYNC", "010110100101100001100100001001"),
    ("afm60,st=15,code=gray", 0x5A5, 0x4321, "ERRSYNC", "011101110111010001010110001001"),
    ("atm60,mt=8,st=8,align=tree12_13", 0xA5, 0x3C, "", "0000101001010011110000000"),
    ("atm60,mt=8,st=8,align=tree13_12", 0xA5, 0x3C, "", "0000010100101001111000000"),
    ("atm60,mt=8,st=8,code=gray", 0xA5, 0x3C, "", "0000111101111010001000000"),
    ("atm60,mt=8,st=8,align=right24", 0xA5, 0x3C, "", "0000000010100101001111000"),
    ("atm60,mt=8,st=8,align=right24,shift=1", 0xA5, 0x3C, "", "0000000001010010100111100"),
    ("atm90,mt=8,st=8,align=right25", 0xA5, 0x3C, "", "0000000001010010100111100"),
    ("atm60", 0x5A5, 0x1234, "", "0101101001011001000110100"),
    ("atm60,err=fix", 0x5A5, 0x1234, "ERROR", "01011010010110010001101001"),
    ("atm60,code=gray", 0x5A5, 0x1234, "", "0111011101110101100101110"),
    ("atm60,steps=3600,code=gray-excess,align=right24", 0, 1234, "", "0000000000000111001011110"),
    ("ars60,st=13", 0, 0x1ABC, "", "1101010111100"),
    ("ars60", 0, 0x5ABC, "position error", "10110101011110010"),
    ("ttk70", 0, 0xAB_CDEF, "", "10101011110011011110111100"),
    ("ttk70,clocks=31", 0, 0x12_3456, "gap", "0001001000110100010101101000000"),
];

/// Ignoring one of these settings would yield a wrong position.
#[test]
fn rejects_ineffective_settings() {
    let cases = [
        ("ahm36,steps=3600,mt=12", "steps and mt cannot be used together"),
        ("ahm36,steps=3600,st=12", "steps and st cannot be used together"),
        ("ahm36,steps=100,revolutions=25/2,turns=2", "revolutions and turns cannot be used together"),
        ("afs60,steps=1000,turns=4", "AFS60 SSI has no turns"),
    ];
    for (text, reason) in cases {
        assert_eq!(resolve(text).unwrap_err(), reason, "{text}");
    }
    assert!(resolve("afs60,steps=1000,turns=1").is_ok());
}

#[test]
fn frames_match_reference() {
    for (text, turns, steps, error, bits) in GOLDEN {
        let resolved = resolve(text).unwrap_or_else(|reason| panic!("{text}: {reason}"));
        let layout = &resolved.layout;
        let range = layout.descriptor().range;
        let position = match range {
            Range::Length { .. } => steps,
            _ => range.position(turns, steps).unwrap(),
        };
        // In one row of the reference, the error bit is 1 in the picture although the title says otherwise. This row
        // would fail here.
        let flags = error_flag(&resolved, error);
        assert_eq!(error.is_empty(), flags == Flags::NONE, "{text}");
        let frame = layout.encode(position, flags).unwrap();
        assert_eq!(format!("{frame:0width$b}", width = bits.len()), bits, "{text}");
        assert_eq!(usize::from(layout.clock_count()), bits.len(), "{text}");
        let reading = layout.decode(frame);
        assert_eq!((reading.position, reading.flags), (position, flags), "{text}");
        if let Location::Shaft { turns: read, steps: rest, .. } = range.locate(reading.position) {
            assert_eq!((read, rest), (turns, steps), "{text}");
        }
    }
}

/// Delaying the whole 25-bit frame by one clock loses its last bit (reference section 8, "full, SHIFT-RIGHT only").
#[test]
fn right_shift_alone_loses_last_bit() {
    let layout = resolve("atm60,shift=1").unwrap().layout;
    let position = 0x5A5 << 13 | 0x1234;
    assert_eq!(layout.encode(position, Flags::NONE), Some(0x05A_591A));
    assert_eq!(layout.encode(position | 1, Flags::NONE), Some(0x05A_591A));
    assert!(layout.loses_lowest_bit());
    assert_eq!(layout.decode(0x05A_591A).position, position);
    // Combined with an alignment to the right, the shift does not lose any bit (reference section 6, traps 2 and 3).
    for text in ["atm60,mt=11,align=right24,shift=1", "atm60,align=right25,shift=1"] {
        assert!(!resolve(text).unwrap().layout.loses_lowest_bit(), "{text}");
    }
}

/// The pattern is tested before the frame is decoded. A frame in which only some of its ones are set is suspicious, but
/// its position remains valid (reference section 6, trap 1).
#[test]
fn kh53_has_error_pattern() {
    for code in ["binary", "gray"] {
        let layout = resolve(&format!("kh53,code={code}")).unwrap().layout;
        let fault = layout.decode(0xFF_FFFE);
        assert!(!layout.is_valid(fault), "{code}");
        assert_eq!(
            layout.to_findings(fault),
            [FrameFinding::Pattern { name: "overspeed or gap".to_owned(), meaning: BitMeaning::Invalid }]
        );
        let suspicious = layout.decode(0x0F_FFFE);
        assert!(layout.is_valid(suspicious), "{code}");
        assert_eq!(suspicious.position, if code == "gray" { gray_to_binary(0x0F_FFFE) } else { 0x0F_FFFE });
        assert_eq!(layout.to_findings(layout.decode(0x0F_FFFC)), []);
    }
}

/// All ones can be a safety fault, a stuck line or a valid position (reference section 6, traps 4 and 7).
#[test]
fn distinguishes_safety_fault_from_stuck_line() {
    let safe = resolve("afm60s").unwrap().layout;
    assert_eq!(safe.clock_count(), 33);
    let fault = safe.decode(0x1_FFFF_FFFF);
    assert!(!safe.is_valid(fault));
    assert!(matches!(&safe.to_findings(fault)[0], FrameFinding::Pattern { name, .. } if name == "safety fault"));
    assert_eq!(resolve("afm60s,st=13").unwrap().layout.clock_count(), 28);

    let plain = resolve("afm60").unwrap().layout;
    let high = plain.decode(0x1_FFFF_FFFF);
    assert_eq!(plain.to_findings(high)[0], FrameFinding::StuckHigh { sure: true });
    assert!(!plain.is_valid(high));
    // Position 8191 of an ARS60 also consists of all ones, so a stuck line is only suspected.
    let short = resolve("ars60,st=13").unwrap().layout;
    assert_eq!(short.to_findings(short.decode(0x1FFF)), [FrameFinding::StuckHigh { sure: false }]);
    assert!(short.is_valid(short.decode(0x1FFF)));
    assert_eq!(short.to_findings(short.decode(0)), [FrameFinding::StuckLow { sure: false }]);
    // In Gray excess with 3600 steps, no position has the code word 0.
    let excess = resolve("atm60,steps=3600,code=gray-excess").unwrap().layout;
    assert_eq!(excess.to_findings(excess.decode(0)), [FrameFinding::StuckLow { sure: true }, FrameFinding::Code]);
}

/// At a lower resolution, the frame of an AFS60 becomes shorter, whereas that of an AHS36 does not (reference section
/// 6, trap 5).
#[test]
fn some_frames_shrink_with_resolution() {
    let clocks = |text: &str| resolve(text).unwrap().layout.clock_count();
    assert_eq!([clocks("afs60,st=13"), clocks("afs60,st=18")], [16, 21]);
    assert_eq!([clocks("ahs36,st=8"), clocks("ahs36,st=8,err=following")], [15, 15]);
    assert_eq!([clocks("ars60,st=12"), clocks("ars60,st=14"), clocks("ahm36,err=none")], [13, 17, 26]);
}

#[test]
fn reports_wrong_padding() {
    let layout = resolve("ahs36,st=12").unwrap().layout;
    let reading = layout.decode(0b101010111100010);
    assert_eq!(layout.to_findings(reading), [FrameFinding::Padding]);
    assert!(layout.is_valid(reading));
}

/// A round axis with 100 steps over 12.5 turns has 8 steps per turn (reference section 5).
#[test]
fn rotary_axis_divides_into_turns() {
    let layout = resolve("ahm36,steps=100,revolutions=25/2").unwrap().layout;
    let range = layout.descriptor().range;
    assert_eq!(layout.position_code().last_position(), 99);
    assert_eq!(range.locate(48), Location::Shaft { turns: 6, steps: 0, degrees: 0.0 });
    assert_eq!(range.locate(99), Location::Shaft { turns: 12, steps: 3, degrees: 135.0 });
    assert_eq!(range.position(12, 3), Some(99));
    assert_eq!((range.position(12, 4), range.position(6, 8)), (None, None));
}

#[test]
fn rejects_unsupported_settings() {
    let cases = [
        ("ttk70,clocks=32", "TTK70 SSI supports at most 31 clocks, not 32"),
        ("ahs36,clocks=14", "ERROR is on clock 15, but the frame has only 14 clocks"),
        (
            "ahs36,steps=359,code=gray-excess",
            "Gray excess requires an even number of steps, because with 359 steps two bits would change at the end of \
             the range",
        ),
        ("ahs36,st=15", "AHS36 SSI: singleturn bits must be from 1 to 14, not 15"),
        ("ahs36,mt=4", "AHS36 SSI has no multiturn"),
        ("afm60,mt=10", "AFM60 SSI: multiturn bits must be from 12 to 12, not 10"),
        ("atm60,mt=13,st=13", "ATM60 SSI: singleturn bits must be from 1 to 12, not 13"),
        (
            "atm60,align=right24",
            "ATM60 SSI does not support the alignment right24 for 25 position bits; supported: tree12_13, right25",
        ),
        ("afs60,err=fix", "AFS60 SSI does not support the setting fix for error bits; supported: following, none"),
        ("afs60s,err=none,shift=1", "AFS60S Pro has no right shift"),
        ("atm60,steps=9000", "ATM60 SSI: steps per turn must be from 2 to 8192, not 9000"),
        (
            "atm60,steps=9000,revolutions=1",
            "ATM60 SSI: steps over this number of revolutions must be from 2 to 8192, not 9000",
        ),
        ("atm60,code=grey", "code must be binary, gray, gray-excess or bcd, not \"grey\""),
        ("atm60,st=12,st=13", "st is specified twice"),
        (
            "atm60,bits=12",
            "there is no \"bits\"; names: code, over, mt, st, steps, turns, revolutions, clocks, align, shift, err, step, direction, preset",
        ),
        (
            "atm60,gray",
            "\"gray\" is not NAME=VALUE; names: code, over, mt, st, steps, turns, revolutions, clocks, align, shift, err, step, direction, preset",
        ),
        ("ahm36,steps=100,revolutions=25/2,preset=100", "AHM36 SSI: preset must be from 0 to 99, not 100"),
        ("ahs36,preset=16384", "AHS36 SSI: preset must be from 0 to 16383, not 16384"),
        ("ahs36,preset=-1", "preset must be a whole number, not \"-1\""),
        ("ahs36,direction=left", "direction must be cw or ccw, not \"left\""),
        ("bce", "no family bce"),
    ];
    for (text, reason) in cases {
        assert_eq!(resolve(text).unwrap_err(), reason, "{text}");
    }
}

/// Direction and preset change the position, but not the meaning of its bits.
#[test]
fn direction_and_preset_keep_frame() {
    let (plain, set) = (resolve("ahs36").unwrap(), resolve("ahs36,direction=ccw,preset=16383").unwrap());
    assert_eq!(plain.layout, set.layout);
    assert_eq!((plain.direction, plain.preset), (Direction::Clockwise, 0));
    assert_eq!((set.direction, set.preset), (Direction::CounterClockwise, 16383));
}

#[test]
fn accepts_undocumented_settings_with_advice() {
    assert_eq!(resolve("ahs36,steps=360,code=bcd").unwrap().advice, [SettingAdvice::Code(Code::Bcd)]);
    assert_eq!(resolve("kh53,clocks=25").unwrap().advice, [SettingAdvice::Clocks { bits: 24, clocks: 25 }]);
    assert_eq!(resolve("ttk70,clocks=31").unwrap().advice, []);
    // A host that cannot use the error bits clocks in only the position (manual 3.1).
    assert_eq!(resolve("ahs36,st=12,err=none,clocks=12").unwrap().layout.clock_count(), 12);
}
