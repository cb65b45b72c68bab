//! Tests of handwritten profiles, round trips and error messages.

use proptest::prelude::*;

use super::*;
use crate::devices::ssi::protocol::{BitMeaning, Families, Settings, any_layouts};
use crate::profile::testing::assert_edit_in_place;
use crate::profile::{Body, ProfileDocument};

const SHORT: &str = r#"(
    schema: 1, device: "ssi",
    frame: (clocks: 27, multiturn: 12, singleturn: 14, errors: [(name: "ERROR", clock: 27, meaning: "invalid")]),
)"#;

fn profile(text: &str) -> SsiProfile {
    ProfileDocument::parse(text, SsiProfile::FORMATS).unwrap().body.into_profile().unwrap()
}

fn document(profile: SsiProfile) -> ProfileDocument {
    ProfileDocument {
        saved: None,
        note: None,
        body: Body::new(profile),
        unknown: Default::default(),
        schema: 1,
        beyond: Vec::new(),
    }
}

fn of_family(text: &str) -> SsiProfile {
    let (key, settings) = Settings::parse(text).unwrap();
    let families = Families::built_in();
    let family = families.find_by_key(&key).unwrap();
    SsiProfile::from_family(family, &settings.resolve(family).unwrap())
}

#[test]
fn parses_handwritten_profile() {
    let short = profile(SHORT);
    assert_eq!(short.descriptor, of_family("ahm36").descriptor, "what is left out is as usual");
    assert_eq!((short.name.as_str(), &short.family), ("", &None));
    assert_eq!((short.direction, short.preset, short.reading), Default::default());
    let named = profile(&SHORT.replace("frame:", "family: \"AHM36\", frame:"));
    assert_eq!(named, of_family("ahm36"));
}

/// Returns a profile whose frame uses every feature.
fn full_profile() -> SsiProfile {
    let error = |name: &str, clock, meaning, active_low| ErrorBit {
        name: name.to_owned(),
        clock,
        meaning,
        active_low,
        cleared_by_transfer: !active_low,
    };
    let pattern = |name: &str, word, meaning| Pattern { name: name.to_owned(), word, meaning };
    let frame = FrameDescriptor {
        clocks: 51,
        range: Range::Bits { multiturn: 7, singleturn: 12 },
        code: Code::Gray,
        coded: GrayCoverage::AreaAndErrors,
        area: 22,
        lead: 1,
        between: 1,
        shift_right: false,
        errors: vec![
            error("LAMP", 23, BitMeaning::Invalid, true),
            error("quote \" and ä", 24, BitMeaning::Warning, false),
        ],
        parity: Some(Parity { clock: 25, even: false }),
        repeat: Some(Repeat { word: 25, gap: 1 }),
        inverted: true,
        patterns: vec![
            pattern("fault", Word::Ones, BitMeaning::Invalid),
            pattern("perhaps", Word::Bits(0xFFFE), BitMeaning::Warning),
        ],
    };
    SsiProfile {
        name: "press 3".to_owned(),
        family: Some("own-type".to_owned()),
        direction: Direction::CounterClockwise,
        preset: 524_287,
        reading: ReadingSettings { clock_hz: 1_000_000, pause_us: 30, cable_metres: Some(0), synchronous: true },
        ..SsiProfile::new(frame)
    }
}

const FULL: &str = r#"(
    schema: 1,
    device: "ssi",
    name: "press 3",
    family: "own-type",
    frame: (
        clocks: 51,
        multiturn: 7,
        singleturn: 12,
        code: "gray",
        over: "errors",
        area: 22,
        lead: 1,
        between: 1,
        inverted: true,
        errors: [
            (name: "LAMP", clock: 23, meaning: "invalid", active_low: true),
            (name: "quote \" and ä", clock: 24, meaning: "warning", cleared_by_transfer: true),
        ],
        parity: (clock: 25, even: false),
        repeat: (word: 25, gap: 1),
        patterns: [
            (name: "fault", word: "ones", meaning: "invalid"),
            (name: "perhaps", word: 0x000000000FFFE, meaning: "warning"),
        ],
    ),
    direction: "ccw",
    preset: 524287,
    reading: (
        clock_hz: 1000000,
        pause_us: 30,
        cable_metres: 0,
        synchronous: true,
    ),
)
"#;

#[test]
fn emitted_profile_matches_handwritten_text() {
    assert_eq!(document(full_profile()).emit(), FULL);
    assert_eq!(profile(FULL), full_profile());
    let cases = [
        ("atm60,mt=11,align=right24,shift=1", "        lead: 0,", false),
        ("atm60,shift=1", "        shift: true,", true),
        ("ahs36,st=12", "        area: 14,", true),
        ("ahs36", "        area: 14,", false),
        ("ahm36,steps=1000,turns=400", "        turns: 400,", true),
        ("ahm36,steps=1000", "        turns: 1,", false),
        ("ahm36,steps=100,revolutions=25/2", "        revolutions: \"25/2\",", true),
        ("ttk70", "        step_nanometres: 1000,", true),
        ("kh53", "            (name: \"overspeed or gap\", word: 0xFFFFFE, meaning: \"invalid\"),", true),
    ];
    for (spec, line, is_there) in cases {
        let text = document(of_family(spec)).emit();
        assert_eq!(text.lines().any(|own| own == line), is_there, "{spec}: {line}\n{text}");
        assert!(!text.contains("reading:"), "{text}");
        assert_eq!(profile(&text), of_family(spec), "{spec}");
    }
}

#[test]
fn whole_revolutions_are_integers() {
    let text = document(of_family("ahm36,steps=100,revolutions=25")).emit();
    assert!(text.contains("revolutions: \"25\","), "{text}");
    assert_eq!(profile(&text.replace("\"25\"", "25")), profile(&text));
}

proptest! {
    #[test]
    fn emitted_profiles_round_trip(
        layout in any_layouts(),
        name in ".{0,12}",
        preset in any::<u64>(),
        clock_hz in 1_000..=20_000_000_u32,
        pause_us in 1..=u16::MAX,
        cable_metres in any::<Option<u16>>(),
        synchronous in any::<bool>(),
        bits in any::<u64>(),
    ) {
        let mut descriptor = layout.descriptor().clone();
        let bits = bits & u64::MAX >> (64 - descriptor.clocks);
        let word = if bits % 2 == 0 { Word::Ones } else { Word::Bits(bits) };
        descriptor.patterns = vec![Pattern { name: name.clone(), word, meaning: BitMeaning::Warning }];
        let direction = if synchronous { Direction::CounterClockwise } else { Direction::Clockwise };
        let preset = layout.position_code().last_position().checked_add(1).map_or(preset, |count| preset % count);
        let reading = ReadingSettings { clock_hz, pause_us, cable_metres, synchronous };
        let profile = SsiProfile { name, direction, preset, reading, ..SsiProfile::new(descriptor) };
        let document = document(profile);
        let text = document.emit();
        prop_assert_eq!(ProfileDocument::parse(&text, SsiProfile::FORMATS), Ok(document), "{}", text);
    }
}

proptest! {
    /// Any numbers yield either a valid frame that survives a round trip, or an error with the reason.
    #[test]
    fn arbitrary_frames_round_trip_or_fail(
        clocks in 0..=70_u8,
        (multiturn, singleturn) in (0..=40_u8, 0..=40_u8),
        (area, lead, between) in (any::<Option<u8>>(), 0..=8_u8, 0..=8_u8),
        error in 0..=70_u8,
        parity in any::<u8>(),
        (word, gap) in (0..=40_u8, any::<u8>()),
        rest in 0..32_u8,
        pattern in any::<u64>(),
        code in prop::sample::select(&["binary", "gray", "gray-excess", "bcd"]),
        over in prop::sample::select(&["position", "padded", "errors"]),
    ) {
        let has = |bit: u8| rest >> bit & 1 == 1;
        let entry = |is_there: bool, text: String| if is_there { text } else { String::new() };
        let frame = [
            format!("clocks: {clocks}, multiturn: {multiturn}, singleturn: {singleturn}, lead: {lead}, between: {between},"),
            format!("code: \"{code}\", over: \"{over}\", shift: {},", has(0)),
            area.map(|area| format!("area: {area},")).unwrap_or_default(),
            entry(has(1), format!("errors: [(name: \"E\", clock: {error}, meaning: \"warning\")],")),
            entry(has(2), format!("parity: (clock: {parity}, even: true),")),
            entry(has(3), format!("repeat: (word: {word}, gap: {gap}),")),
            entry(has(4), format!("patterns: [(name: \"P\", word: {pattern}, meaning: \"invalid\")],")),
        ];
        let text = format!("(schema: 1, device: \"ssi\", frame: ({}))", frame.concat());
        match ProfileDocument::parse(&text, SsiProfile::FORMATS) {
            Ok(document) => prop_assert_eq!(ProfileDocument::parse(&document.emit(), SsiProfile::FORMATS), Ok(document)),
            Err(error) => prop_assert!(error.to_string().starts_with("frame: "), "{}", error),
        }
    }
}

#[test]
fn keeps_unknown_fields() {
    let text = FULL
        .replace("schema: 1,", "schema: 1, owner: (name: \"CK\", floors: [1, 2]),")
        .replace("clocks: 51,", "clocks: 51, drawn: \"a\",")
        .replace("(name: \"quote", "(colour: Some(\"b\"), name: \"quote")
        .replace("clock: 25,", "clock: 25, by: \"c\",")
        .replace("word: 25,", "word: 25, by: \"d\",")
        .replace("(name: \"fault\",", "(name: \"fault\", seen: \"e\",")
        .replace("clock_hz:", "module: \"f\", clock_hz:");
    let read = ProfileDocument::parse(&text, SsiProfile::FORMATS).unwrap();
    let written = read.emit();
    for kept in [
        "    extra: {\"owner\": (floors: [1, 2], name: \"CK\")},",
        "        extra: {\"drawn\": \"a\"},",
        "clock: 24, meaning: \"warning\", cleared_by_transfer: true, extra: {\"colour\": Some(\"b\")}),",
        "parity: (clock: 25, even: false, extra: {\"by\": \"c\"}),",
        "repeat: (word: 25, gap: 1, extra: {\"by\": \"d\"}),",
        "(name: \"fault\", word: \"ones\", meaning: \"invalid\", extra: {\"seen\": \"e\"}),",
        "        extra: {\"module\": \"f\"},",
    ] {
        assert!(written.contains(kept), "{kept} is not in\n{written}");
    }
    assert_eq!(read.beyond.len(), 7);
    let read = ProfileDocument { beyond: Vec::new(), ..read };
    assert_eq!(ProfileDocument::parse(&written, SsiProfile::FORMATS).unwrap(), read);
    // Unknown entries stay with their error bit even if the order of the bits changes.
    let mut moved = read.body.into_profile::<SsiProfile>().unwrap();
    moved.descriptor.errors.reverse();
    let written = document(moved).emit();
    assert!(written.contains(
        "(name: \"quote \\\" and ä\", clock: 24, meaning: \"warning\", cleared_by_transfer: true, extra: {\"colour"
    ));
}

#[test]
fn profile_errors_have_locations() {
    let cases = [
        ("frame:", "fram:", "line 3, column 5: fram is unknown, and frame is missing"),
        ("clocks: 27,", "", "frame.clocks is missing"),
        ("clocks: 27", "clocks: 300", "frame.clocks must be a number from 0 to 255"),
        ("clocks: 27", "clocks: 65", "frame: a frame has 1 to 64 clocks, not 65"),
        ("clocks: 27", "clocks: 26", "frame: ERROR is on clock 27, but the frame has only 26 clocks"),
        ("clock: 27", "clock: 26", "frame: clock 26 is used by both the position and ERROR"),
        ("multiturn: 12", "multiturn: 33", "frame: multiturn must have at most 32 bits, not 33"),
        (
            "multiturn: 12, singleturn: 14",
            "code: \"gray\"",
            "frame: one of the entries singleturn, steps or bits is required",
        ),
        ("singleturn: 14", "steps: 16384", "frame.multiturn: this entry cannot be combined with steps"),
        ("singleturn: 14", "singleturn: 14, turns: 4", "frame.turns: this entry cannot be combined with singleturn"),
        ("multiturn: 12, singleturn: 14", "bits: 24", "frame.step_nanometres is missing"),
        (
            "multiturn: 12, singleturn: 14",
            "steps: 359, code: \"gray-excess\"",
            "frame: Gray excess requires an even number",
        ),
        (
            "multiturn: 12, singleturn: 14",
            "steps: 9, revolutions: \"1/0\"",
            "frame: the numerator and denominator of revolutions must be greater than 0, not 1/0",
        ),
        (
            "multiturn: 12, singleturn: 14",
            "steps: 9, revolutions: \"x\"",
            "frame.revolutions must be a whole number, or a string such as \"25/2\"",
        ),
        ("multiturn: 12, singleturn: 14", "steps: 9, revolutions: -1", "frame.revolutions must be a whole number, or"),
        ("clocks: 27", "code: \"grey\", clocks: 27", "frame.code must be binary, gray, gray-excess or bcd"),
        ("clocks: 27", "code: 1, clocks: 27", "frame.code must be a string"),
        ("clocks: 27", "over: \"all\", clocks: 27", "frame.over must be position, padded or errors"),
        (
            "clocks: 27",
            "over: \"padded\", clocks: 27",
            "frame: zeros and error bits can be included in the code word only if Gray code is used",
        ),
        ("clocks: 27", "shift: 1, clocks: 27", "frame.shift must be true or false"),
        ("clocks: 27", "repeat: (gap: 1), clocks: 27", "frame.repeat.word is missing"),
        ("clocks: 27", "parity: (clock: 28), clocks: 28", "frame.parity.even is missing"),
        (
            "clocks: 27",
            "patterns: [(name: \"x\", word: \"all\", meaning: \"invalid\")], clocks: 27",
            "frame.patterns[0].word must be \"ones\", or a number that contains all bits of a frame",
        ),
        (
            "clocks: 27",
            "patterns: [(name: \"x\", word: 0x8000000, meaning: \"invalid\")], clocks: 27",
            "frame: the pattern 8000000 has more than 27 bits",
        ),
        ("\"invalid\"", "\"bad\"", "frame.errors[0].meaning must be invalid or warning"),
        (", meaning: \"invalid\"", "", "frame.errors[0].meaning is missing"),
        ("errors: [", "errors: [7, ", "frame.errors[0] must be a structure: (name: value, …)"),
        ("frame:", "direction: \"left\", frame:", "direction must be cw or ccw"),
        ("frame:", "preset: 67108864, frame:", "preset: 67108864 is not within 0 to 67108863"),
        ("frame:", "preset: -1, frame:", "preset must be a whole number"),
        ("frame:", "reading: (clock_hz: 999), frame:", "reading.clock_hz must be a number from 1000 to 20000000"),
        ("frame:", "reading: (pause_us: 0), frame:", "reading.pause_us must be a number from 1 to 65535"),
        ("frame:", "reading: (cable_metres: -1), frame:", "reading.cable_metres must be a number from 0 to 65535"),
        ("frame:", "reading: (synchronous: 1), frame:", "reading.synchronous must be true or false"),
        ("frame:", "family: 7, frame:", "family must be a string"),
    ];
    for (old, new, message) in cases {
        assert!(SHORT.contains(old), "{old}");
        let error = ProfileDocument::parse(&SHORT.replacen(old, new, 1), SsiProfile::FORMATS).unwrap_err().to_string();
        assert!(error.starts_with(message), "{error:?} does not begin with {message:?}");
    }
}

/// Changing a value edits the text only at that value (issue 22.26).
#[test]
fn change_edits_only_its_value() {
    let edit = |own: &mut SsiProfile| {
        own.preset = 9;
        own.reading.clock_hz = 250_000;
    };
    let text = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/fixtures/commented/ssi.ron"));
    assert_edit_in_place(text, edit, "preset: 7", "preset: 9, reading: (\n    clock_hz: 250000,\n)");
}
