//! The `ssi` command: frames without an encoder. The expected values come from section 8 of the reference.

use serde_json::{Value, json};

use super::support::Bench;

#[test]
fn encodes_and_decodes_frames() {
    let bench = Bench::new();
    let table: [(&[&str], &str, &str); 6] = [
        (&["ahm36", "--turns", "0x123", "--steps", "0x2A5B"], "000100100011101010010110110", "091D4B6"),
        (&["ahm36,code=gray", "--turns", "0x123", "--steps", "0x2A5B"], "000110110010011111011101100", "0D93EEC"),
        (&["ahs36,st=12,err=following", "--steps", "0xABC", "--error", "error"], "101010111100100", "55E4"),
        (
            &["afm60,st=15", "--turns", "0x5A5", "--steps", "0x4321", "--error", "ERRSYNC"],
            "010110100101100001100100001001",
            "16961909",
        ),
        (
            &["atm60,steps=3600,code=gray-excess,align=right24", "--position", "1234"],
            "0000000000000111001011110",
            "0000E5E",
        ),
        (&["ttk70", "--position", "0xABCDEF"], "10101011110011011110111100", "2AF37BC"),
    ];
    for (words, bits, hex) in table {
        let encoded = bench.run(&[&["ssi", "encode", "--json", "--layout"], words].concat()).json();
        assert_eq!(encoded, json!({ "bits": bits, "hex": hex }), "{words:?}");
    }
    let decoded = |layout: &str, frame: &str| bench.run(&["ssi", "decode", "--json", "--layout", layout, frame]).json();
    for frame in ["000100100011101010010110110", "0b000100100011101010010110110", "0x091D4B6"] {
        let told = decoded("ahm36", frame);
        // 2A5Bh of 16384 steps is 238.0847… degrees.
        assert_eq!(told["raw_bits"], "000100100011101010010110110");
        assert_eq!(
            (&told["position"], &told["turns"], &told["steps"]),
            (&json!(4_778_587), &json!(0x123), &json!(0x2A5B))
        );
        assert!((told["degrees"].as_f64().unwrap() - 10843.0 * 360.0 / 16384.0).abs() < 1e-9);
        assert_eq!((&told["errors"], &told["warnings"], &told["valid"]), (&json!([]), &json!([]), &json!(true)));
    }
    let told = decoded("ttk70,clocks=31", "0x091A2B40");
    assert_eq!(
        (&told["errors"], &told["turns"], &told["millimetres"]),
        (&json!(["gap"]), &Value::Null, &json!(1193.046))
    );
    assert_eq!(decoded("kh53", "0xFFFFFE")["errors"], json!(["overspeed or gap"]));
    assert_eq!(decoded("kh53", "0x0FFFFE")["warnings"], json!(["perhaps overspeed or gap"]));
    assert_eq!(decoded("afm60s", "0x1FFFFFFFF")["errors"][0], "safety fault");
    assert_eq!(decoded("afm60", "0x1FFFFFFFF")["errors"][0], "line stuck high");
    assert_eq!(decoded("ahs36,st=12", "101010111100010")["warnings"], json!(["format mismatch"]));
    let none = decoded("atm60,steps=3600,code=gray-excess", "0x0");
    assert_eq!((&none["position"], &none["errors"]), (&Value::Null, &json!(["line stuck low", "invalid code"])));
    let text = bench.run(&["ssi", "decode", "--layout", "ahm36", "000100100011101010010110110"]).out;
    assert!(text.contains("MT 000100100011  ST 10101001011011  ERROR 0"), "{text}");
}

#[test]
fn exports_layouts() {
    let bench = Bench::new();
    let export = |format: &str| bench.run(&["ssi", "export", "--layout", "ahs36,code=gray", "--format", format]).out;
    assert_eq!(export("linuxcnc"), "error%1bposition%14ge\n");
    assert!(export("c").contains("ssi_reading ssi_decode(uint64_t frame)"));
    assert!(export("st").contains("FUNCTION_BLOCK SSI_DECODE"));
    assert_eq!(export("csv").lines().nth(15), Some("15,0,ERROR"));
    let sheet = export("sheet");
    for line in [
        "Frame length                    15 bits",
        "does not program the encoder",
        "Bit number LSB of the position  1",
        "power failure bit    1",
    ] {
        assert!(sheet.contains(line), "{line}\n{sheet}");
    }
    assert_eq!(export("svg").matches("<rect").count(), 1 + 15);
    let timing = |more: &[&str]| {
        let asked = ["ssi", "export", "--layout", "ahs36", "--format", "timing"];
        bench.run(&[&asked[..], more].concat())
    };
    // 15 clocks at 400 kHz take 37.5 µs.
    assert!(timing(&[]).out.contains("15 clocks, 37.50 µs"));
    assert_eq!(timing(&[]).err, "");
    assert!(timing(&["--cable", "150"]).err.contains("to 200 kHz or less"));
    assert!(timing(&["--pause", "20"]).err.contains("more than 25 µs"));
    // Without a family, the general times of SSI apply, and the output says so. 13 clocks at 500 kHz take 26 µs.
    let any = ["ssi", "export", "--layout", "frame,st=13", "--format", "timing", "--clock", "500000", "--pause", "20"];
    let any = bench.run(&any);
    assert!(any.out.contains("13 clocks, 26.00 µs") && any.out.contains("tm up to 25 µs"), "{}", any.out);
    assert!(any.err.contains("The general SSI timing applies") && any.err.contains("more than 25 µs"), "{}", any.err);
    let file = bench.file("decoder.c");
    bench.run(&["ssi", "export", "--layout", "atm60", "--format", "c", "-o", &file]);
    assert!(bench.read("decoder.c").starts_with("/* SSI decoder: atm60\n"));
    let told = bench.run(&["ssi", "decode", "--json", "--layout", "linuxcnc:error%1bposition%14ge", "0x7EEC"]).json();
    assert_eq!(told["position"], 0x2A5B);
}

/// Returns the path of a recording in `tests/vectors/ssi_find` (made with Python), its frames as text, and the expected
/// positions.
fn recording(name: &str) -> (String, Vec<(String, Option<u64>)>) {
    let path = format!("{}/tests/vectors/ssi_find/{name}.txt", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(&path).unwrap();
    let lines = text.lines().filter(|line| !line.starts_with('#')).map(|line| line.split_once(' ').unwrap());
    let rows = lines.map(|(frame, meant)| (frame.to_owned(), meant.parse().ok())).collect();
    (path, rows)
}

/// The first layout listed by `ssi find` decodes the frames correctly and can be used as printed (issue 22.22).
#[test]
fn finds_layout_of_recorded_frames() {
    let bench = Bench::new();
    // Each recording, and whether its frames leave the layout ambiguous.
    for (name, ambiguous) in
        [("excess_360_fast", false), ("start_bit", true), ("twice_with_gap", true), ("gray_even_parity", true)]
    {
        let (path, rows) = recording(name);
        let found = bench.run(&["ssi", "find", "--json", &path]).json();
        assert_eq!((&found["frames"], &found["ambiguous"]), (&json!(900), &json!(ambiguous)), "{name}");
        assert_eq!(found["next"].is_string(), ambiguous, "{name}: {}", found["next"]);
        let layouts = found["layouts"].as_array().unwrap();
        let scores: Vec<f64> = layouts.iter().map(|layout| layout["score"].as_f64().unwrap()).collect();
        assert!(scores.iter().all(|score| (0.0..=1.0).contains(score)), "{name}: {scores:?}");
        assert!(scores.windows(2).all(|pair| pair[0] >= pair[1]), "{name}: {scores:?}");
        let first = &layouts[0];
        assert!(first["explained"].as_u64().unwrap() > 860 && first["why"].is_string(), "{name}: {first}");
        let spec = first["spec"].as_str().unwrap();
        let (frame, meant) = rows.iter().rev().find(|(_, meant)| meant.is_some()).unwrap();
        let decoded = bench.run(&["ssi", "decode", "--json", "--layout", spec, frame]).json();
        assert_eq!(decoded["position"].as_u64(), *meant, "{name}: {spec}");
    }
    // Additional columns are ignored, the number of clocks of hexadecimal frames comes from the option, and the text
    // output has the same content as the JSON.
    let (_, rows) = recording("excess_360_fast");
    let hex = |(frame, _): &(String, Option<u64>)| format!("0x{:X},17\n", u64::from_str_radix(frame, 2).unwrap());
    let hex = bench.write("hex.csv", rows.iter().map(hex).collect::<String>());
    let found = bench.run(&["ssi", "find", &hex, "--clocks", "9"]);
    assert!(found.out.contains("steps=360") && found.out.contains("accounts for every bit"), "{found:?}");
    let guessed = bench.run(&["ssi", "find", &hex]);
    assert!(guessed.err.contains("9 was assumed"), "{guessed:?}");
    // These recordings contain no information.
    let standing = bench.write("standing.txt", "101010101\n".repeat(300));
    bench.run(&["ssi", "find", &standing]).fails(1, &["the shaft is at rest"]);
    let low = bench.write("low.txt", "000000000\n".repeat(300));
    bench.run(&["ssi", "find", &low]).fails(1, &["low"]);
    let broken = bench.write("broken.txt", "101010101\n10101\n");
    bench.run(&["ssi", "find", &broken]).fails(1, &["Line 2", "9 clocks"]);
    bench.run(&["ssi", "find", &bench.file("nowhere.txt")]).fails(1, &["nowhere.txt"]);
    bench.run(&["ssi", "find", &hex, "--clocks", "65"]).fails(2, &["65"]);
}

/// The layout of any frame can be written as one word, in the notation printed by `ssi find` (issue 22.22).
#[test]
fn frame_notation_specifies_any_layout() {
    let bench = Bench::new();
    let decoded = |layout: &str, frame: &str| bench.run(&["ssi", "decode", "--json", "--layout", layout, frame]).json();
    // Section 8 of the reference: AHM36 in Gray code, and the same with swapped wires.
    let ahm36 = "frame,clocks=27,mt=12,st=14,code=gray,area=26,err=27";
    assert_eq!(decoded(ahm36, "0x0D93EEC")["position"], 4_778_587);
    assert_eq!(decoded(&format!("{ahm36},inverted=1"), "0x726C113")["position"], 4_778_587);
    bench
        .run(&["ssi", "decode", "--layout", "frame,clock=3", "0"])
        .fails(2, &["there is no \"clock\"", "clocks, mt, st"]);
    bench.run(&["ssi", "decode", "--layout", "frame,clocks=3,st=4", "000"]).fails(1, &["3"]);
}

#[test]
fn reports_invalid_arguments() {
    let bench = Bench::new();
    let fails = |status: i32, words: &[&str], said: &[&str]| {
        bench.run(&[&["ssi"], words].concat()).fails(status, said);
    };
    fails(2, &["decode", "--layout", "bce", "0"], &["\"bce\" is neither a file nor a family", "ahs36 ahm36", "kh53"]);
    fails(2, &["decode", "--layout", "ahs36,code=grey", "0"], &["binary, gray, gray-excess or bcd", "grey"]);
    fails(2, &["decode", "--layout", "ahs36", "12"], &["\"12\" is not a frame", "0b1010"]);
    fails(2, &["decode", "--layout", "ahs36", "0x+54B6"], &["\"0x+54B6\" is not a frame"]);
    fails(2, &["encode", "--layout", "ahs36"], &["--position"]);
    fails(2, &["export", "--layout", "ahs36", "--format", "c", "--cable", "10"], &["--format timing"]);
    fails(2, &["encode", "--layout", "ahs36", "--steps", "1", "--error", "GAP"], &["\"GAP\"", "ERROR"]);
    fails(2, &["encode", "--layout", "ttk70", "--steps", "1"], &["a length", "--position"]);
    fails(1, &["decode", "--layout", "ahs36", "1010"], &["1010 has 4 bits", "15 clocks"]);
    fails(1, &["decode", "--layout", "ahs36", "0x8000"], &["needs 16 bits", "15 clocks"]);
    fails(1, &["encode", "--layout", "ahs36", "--position", "16384"], &["not within 0 to 16383"]);
    fails(1, &["encode", "--layout", "ahs36", "--position", "-1"], &["not within 0 to 16383"]);
    fails(
        1,
        &["encode", "--layout", "ahm36,steps=1000,turns=400", "--turns", "2", "--steps", "1000"],
        &["not within 0 to 999"],
    );
    fails(1, &["encode", "--layout", "ttk70,clocks=32", "--position", "1"], &["at most 31 clocks, not 32"]);
    fails(
        1,
        &["encode", "--layout", "ahs36,steps=359,code=gray-excess", "--position", "1"],
        &["even number of steps", "359"],
    );
    fails(
        1,
        &["export", "--layout", "ahs36,steps=360,code=gray-excess", "--format", "linuxcnc"],
        &["cannot decode gray excess"],
    );
    let remark = bench.run(&["ssi", "encode", "--layout", "ahs36,steps=360,code=bcd", "--position", "359"]);
    assert_eq!(remark.status, Some(0));
    assert!(remark.err.contains("does not list the code bcd"), "{remark:?}");
}
