//! SSI layouts in files: saving and comparing them, using them in place of a layout name, and user-defined families.

use std::fs;

use serde_json::{Value, json};

use super::support::Bench;

/// A layout as a user might write it: 4 + 8 bits in Gray code, followed by an error bit.
const LAYOUT: &str = r#"(
    schema: 1,
    device: "ssi",
    name: "feeder",
    frame: (clocks: 13, multiturn: 4, singleturn: 8, code: "gray", errors: [(name: "LAMP", clock: 13, meaning: "warning")]),
    reading: (clock_hz: 100000, pause_us: 30),
)"#;

#[test]
fn saved_layout_works_like_family() {
    let bench = Bench::new();
    let file = bench.file("line.ron");
    let spec = "ahm36,code=gray,st=12,direction=ccw,preset=5";
    let saved = bench.run(&["save", "ssi", "--layout", spec, "-o", &file, "--json"]);
    assert_eq!(saved.json(), json!({ "file": file, "clocks": 27 }));
    let text = bench.read("line.ron");
    for line in ["    family: \"ahm36\",", "        area: 26,", "    direction: \"ccw\",", "    preset: 5,"] {
        assert!(text.lines().any(|own| own == line), "{line} is not in\n{text}");
    }
    for command in [&["decode", "000110110010011111011101100"][..], &["encode", "--position", "4778587"]] {
        let run = |layout: &str| {
            let words = [&["ssi", command[0], "--json", "--layout", layout], &command[1..]].concat();
            let ran = bench.run(&words);
            assert_eq!((ran.status, ran.err.as_str()), (Some(0), ""), "{words:?}");
            ran.out
        };
        assert_eq!(run(&file), run(spec));
    }
    // Exporting the file gives its text again, and so does exporting the same layout from its specification.
    let exported = bench.run(&["ssi", "export", "--layout", &file, "--format", "profile"]);
    assert_eq!(exported.out, text);
    let again = bench.file("again.ron");
    bench.run(&["ssi", "export", "--layout", spec, "--format", "profile", "-o", &again]);
    assert_eq!(bench.read("again.ron"), text);
    let read = bench.run(&["ssi", "export", "--layout", "linuxcnc:error%1bposition%14ge", "--format", "profile"]).out;
    assert!(read.contains("        singleturn: 14,\n        code: \"gray\",") && !read.contains("family"), "{read}");
}

/// The Gray code 1011 0110 1101 is binary 110110110110, which is turn 13, step 182 of 256.
#[test]
fn accepts_handwritten_layout_from_any_folder() {
    let bench = Bench::new();
    let file = bench.write("feeder.ron", LAYOUT);
    bench.write("no-ending", LAYOUT);
    for layout in [file.as_str(), "no-ending", "./no-ending", "feeder.ron"] {
        let mut program = bench.program(&["ssi", "decode", "--json", "--layout", layout, "1011011011011"]);
        let output = program.current_dir(bench.path("")).output().unwrap();
        let told: Value = serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{layout}: {error}"));
        assert_eq!((&told["turns"], &told["steps"], &told["degrees"]), (&json!(13), &json!(182), &json!(255.9375)));
        assert_eq!(told["warnings"], json!(["LAMP"]));
    }
    let source = bench.run(&["ssi", "export", "--layout", &file, "--format", "c"]).out;
    assert!(source.starts_with("/* SSI decoder: feeder\n"), "{source}");
    // The profile defines the clock and pause. Without a family, the general times of SSI apply.
    let general = bench.run(&["ssi", "export", "--layout", &file, "--format", "timing"]);
    assert!(general.out.contains("13 clocks, 130.00 µs"), "{general:?}");
    assert!(general.err.starts_with("The general SSI timing applies"), "{general:?}");
    let with_family = LAYOUT.replace("frame:", "family: \"ahm36\", frame:");
    let file = bench.write("with-family.ron", &with_family);
    let drawn = bench.run(&["ssi", "export", "--layout", &file, "--format", "timing"]);
    assert!(drawn.out.contains("13 clocks, 130.00 µs"), "{drawn:?}");
    assert!(drawn.err.contains("No settings of AHM36 SSI result in this frame"), "{drawn:?}");
    let of_family = bench.file("of-family.ron");
    bench.run(&["save", "ssi", "--layout", "ahs36,steps=360,code=bcd", "-o", &of_family]);
    let advised = bench.run(&["ssi", "decode", "--layout", &of_family, "0x0"]);
    assert!(advised.err.contains("does not list the code bcd") && !advised.err.contains("No setting"), "{advised:?}");
    let faster = bench.run(&["ssi", "export", "--layout", &file, "--format", "timing", "--clock", "1000000"]);
    assert!(faster.out.contains("13 clocks, 13.00 µs"), "{faster:?}");
}

/// Each layout entry listed in the help can be used in a file.
#[test]
fn help_names_valid_entries() {
    let bench = Bench::new();
    let help = bench.run(&["ssi", "export", "--help"]).out;
    let entry = |name: &str| {
        let at = help.find(&format!("{name}: ")).unwrap_or_else(|| panic!("{name} is not in\n{help}"));
        let value = &help[at..];
        // The value ends at two blanks, after which the entry is explained, or at the end of the line.
        let end = value.find("  ").into_iter().chain(value.find('\n')).min().unwrap();
        value[..end].to_owned()
    };
    let frame = ["clocks", "multiturn", "code", "area", "errors", "repeat", "patterns"].map(entry).join(", ");
    let frame = frame.replace("clocks: 27", "clocks: 55").replace("repeat: (word: 25", "repeat: (word: 27");
    let text = format!("(schema: 1, device: \"ssi\", frame: ({frame}), {}, {})", entry("reading"), entry("direction"));
    let text = text.replace(", preset: 100, and", ", preset: 100");
    let file = bench.write("of-help.ron", text);
    let read = bench.run(&["ssi", "export", "--layout", &file, "--format", "profile"]);
    assert_eq!(read.status, Some(0), "{read:?}");
    for line in ["        repeat: (word: 27, gap: 1),", "    preset: 100,", "        cable_metres: 20,"] {
        assert!(read.out.lines().any(|own| own == line), "{line} is not in\n{}", read.out);
    }
}

#[test]
fn compares_layouts() {
    let bench = Bench::new();
    let (one, other) = (bench.file("one.ron"), bench.file("other.ron"));
    bench.run(&["save", "ssi", "--layout", "atm60", "-o", &one]);
    bench.run(&["save", "ssi", "--layout", "atm60,st=12,code=gray,err=fix", "-o", &other]);
    let same = bench.run(&["diff", &one, &one, "--json"]);
    let expected = json!({ "equal": true, "differences": [], "compared": 17, "missing": [] });
    assert_eq!((same.status, same.json()), (Some(0), expected));
    let differs = bench.run(&["diff", &one, &other, "--json"]);
    let item = |item: &str, left: &str, right: &str| json!({ "item": item, "left": left, "right": right });
    let differences =
        json!([item("clocks", "25", "26"), item("singleturn", "13", "12"), item("code", "binary", "gray")]);
    let told: Value = serde_json::from_str(&differs.out).unwrap();
    assert_eq!(told["differences"], differences);
    let missing = ["name", "clock", "meaning", "active_low", "cleared_by_transfer"].map(|of| format!("errors[0].{of}"));
    assert_eq!((differs.status, &told["equal"], &told["missing"]), (Some(3), &json!(false), &json!(missing)));
    let text = bench.run(&["diff", &one, &other]).out;
    assert!(text.contains("singleturn") && text.contains("13  →  12"), "{text}");
}

#[test]
fn ready_made_profiles_match_factory_settings() {
    let bench = Bench::new();
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/profiles/ssi");
    for key in "ahs36 ahm36 afs60 afm60 afs60s afm60s atm60 atm90 ars60 ttk70 kh53".split(' ') {
        let delivered = bench.file("delivered.ron");
        bench.run(&["save", "ssi", "--layout", key, "-o", &delivered]);
        let shipped = format!("{folder}/{key}.ron");
        assert_eq!(bench.run(&["diff", &shipped, &delivered]).status, Some(0), "{key}");
    }
    // The frame has 12 bits of turns (5A5h) followed by 12 bits within a turn (91Ah), and nothing else.
    let short = format!("{folder}/atm60-tree-24-bit-controller.ron");
    let words = ["ssi", "encode", "--json", "--layout", &short, "--turns", "0x5A5", "--steps", "0x91A"];
    assert_eq!(bench.run(&words).json(), json!({ "bits": "010110100101100100011010", "hex": "5A591A" }));
}

#[test]
fn loads_user_families_and_reports_broken_ones() {
    let bench = Bench::new();
    let folder = bench.path("config/encoder-studio/devices/ssi");
    fs::create_dir_all(&folder).unwrap();
    let family = r#"(
        key: "feeder", name: "Feeder encoder", source: "its label",
        singleturn: (8, 10, 12), codes: [gray], align: [left], frames: [(up_to: 12, area: Some(13))],
        times: (monoflop: (10, 20), most_hz: 1000000),
    )"#;
    fs::write(folder.join("feeder.ron"), family).unwrap();
    let encoded = bench.run(&["ssi", "encode", "--layout", "feeder", "--position", "1", "--json"]);
    // The value 1 in Gray code sets clock 10 of 13.
    assert_eq!((encoded.json()["bits"].clone(), encoded.err), (json!("0000000001000"), String::new()));
    fs::write(folder.join("broken.ron"), family.replace("codes: [gray]", "codes: [grey]")).unwrap();
    let told = bench.run(&["ssi", "encode", "--layout", "feeder", "--position", "1"]);
    assert_eq!(told.status, Some(0));
    for said in ["broken.ron", "line 3, column ", "grey", "All other families remain available"] {
        assert!(told.err.contains(said), "{said}: {}", told.err);
    }
    bench
        .run(&["ssi", "decode", "--layout", "feder", "0"])
        .fails(2, &["\"feder\" is neither a file nor a family", "feeder ahs36"]);
}

#[test]
fn duplicate_positions_must_agree() {
    let bench = Bench::new();
    let encode = |words: &[&str]| bench.run(&[&["ssi", "encode", "--json", "--layout"], words].concat());
    // 123h · 4000h + 2A5Bh.
    let both = ["ahm36", "--position", "4778587", "--turns", "0x123", "--steps", "0x2A5B"];
    assert_eq!(encode(&both).json(), encode(&both[..3]).json());
    assert_eq!(encode(&["ahm36", "--position", "4778587", "--turns", "291"]).json()["hex"], "091D4B6");
    encode(&["ahm36", "--position", "4778587", "--turns", "290", "--steps", "0x2A5B"])
        .fails(2, &["--position 4778587 is turn 291, step 10843", "--turns 290"]);
    encode(&["ahm36", "--position", "4778587", "--steps", "99999"]).fails(2, &["step 10843", "--steps 99999"]);
    encode(&["ahm36", "--turns", "1"]).fails(2, &["--position"]);
    encode(&["ttk70", "--position", "1", "--steps", "1"]).fails(2, &["a length has no turns and steps"]);
}

#[test]
fn invalid_layout_names_entry_and_reason() {
    let bench = Bench::new();
    let file = bench.file("wrong.ron");
    let cases = [
        (LAYOUT.replace("clock: 13", "clock: 12"), "frame: clock 12 is used by both the position and LAMP"),
        (LAYOUT.replace("frame:", "preset: 4096, frame:"), "preset: 4096 is not within 0 to 4095"),
        (LAYOUT.replace("frame:", "frame"), "line 5, column "),
        (LAYOUT.replace("clocks: 13, ", ""), "frame.clocks is missing"),
        (LAYOUT.replace("\"gray\"", "\"grey\""), "frame.code must be binary, gray, gray-excess or bcd"),
        (LAYOUT.replace("clocks: 13", "clocks: 13, clocks: 14"), "clocks appears twice"),
    ];
    for (text, reason) in cases {
        bench.write("wrong.ron", &text);
        bench.run(&["ssi", "decode", "--layout", &file, "0"]).fails(1, &["wrong.ron", reason]);
        bench.run(&["diff", &file, &file]).fails(1, &["wrong.ron", reason]);
        let kept = bench.file("kept.ron");
        bench.run(&["save", "ssi", "--layout", &file, "-o", &kept]).fails(1, &[reason]);
        assert!(!bench.path("kept.ron").exists());
    }
    let biss = bench.write("kit.ron", super::biss_profile::PROFILE);
    bench.write("wrong.ron", LAYOUT);
    bench.run(&["ssi", "decode", "--layout", &biss, "0"]).fails(1, &["biss", "ssi"]);
    bench.run(&["diff", &file, &biss]).fails(1, &["kit.ron", "biss", "ssi"]);
    bench.run(&["ssi", "decode", "--layout", &bench.file("none.ron"), "0"]).fails(1, &["none.ron"]);
    bench.run(&["ssi", "decode", "--layout", "none", "0"]).fails(2, &["\"none\" is neither a file nor a family"]);
    bench.write("unknown.ron", LAYOUT.replace("frame:", "family: \"feeder\", frame:"));
    let unknown = bench.run(&["ssi", "decode", "--layout", &bench.file("unknown.ron"), "0x0"]);
    assert!(unknown.status == Some(0) && unknown.err.contains("names the unknown family \"feeder\""), "{unknown:?}");
}

#[test]
fn unsupported_command_names_alternative() {
    let bench = Bench::new();
    let file = bench.write("feeder.ron", LAYOUT);
    let out = bench.file("out.ron");
    let sim = "--link=sim:";
    let cases: [(&[&str], &str); 11] = [
        (&["identify", "ssi", sim], "type label"),
        (&["read", "ssi", "0x10", sim], "registers"),
        (&["write", "ssi", "0x10", "1", "--yes", sim], "the manufacturer's tool"),
        (&["do", "ssi", "preset", sim], "the manufacturer's tool"),
        (&["restore", &file, "--yes", sim], "the manufacturer's tool"),
        (&["verify", &file, sim], "diff FILE FILE"),
        (&["diff", &file, sim], "diff FILE FILE"),
        (&["decode", "ssi", "00"], "ssi decode --layout"),
        (&["save", "ssi", "-o", &out], "--layout FILE|SPEC"),
        (&["save", "ssi", "--layout", "ahs36", "-o", &out, sim], "remove --link"),
        (&["save", "biss", "--layout", "ahs36", "-o", &out, sim], "--layout is only for ssi devices"),
    ];
    for (words, said) in cases {
        bench.run(words).fails(2, &[said]);
    }
    assert!(!bench.path("out.ron").exists());
}
