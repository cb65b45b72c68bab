//! BiSS commands without a device: decoding captured bytes, comparing profiles, and playing back recordings.

use serde_json::{Value, json};

use super::biss_profile::PROFILE;
use super::support::Bench;

/// The examples are from ubicom.md 6, bridge.md 2 and biss.md 2.
#[test]
fn explains_example_bytes() {
    let bench = Bench::new();
    let cases: [(&str, &[&str]); 12] = [
        ("80 01 01 02 00 26 00 55", &["read", "0x66", "temperature"]),
        ("80 01 01 02 00 26 00 55 80 01 01 01 00 4B 31", &["0x66", "25 °C"]),
        ("800102030083008076", &["0x80", "0x01:0x03"]),
        ("80 01 02 01 00 90 EB", &["written"]),
        ("80 01 02 01 00 A0 DB", &["refused"]),
        ("80 01 03 05 00 00 80 69 24 00 69", &["turn 4660", "step 98304", "270.000000°"]),
        ("05 01 01 1F 3E 00", &["HELLO"]),
        ("06 06 20 80 84 1E 04 23 06 12 03 C0 43 00", &["BISS_CONFIG", "2000000 Hz", "35 data bits", "18 µs"]),
        ("06 07 A1 41 42 0F 01 01 01 01 01 02 CF 04 80 69 24 01 01 03 56 DA 00", &["1.000001 s", "turn 4660"]),
        ("10 07 FF 21 04 08 6E 6F 20 73 6C 61 76 65 4E E1 00", &["BISS_READ", "no slave"]),
        ("00 24 69 80 00 CF", &["turn 4660", "no error"]),
        ("024698000CF", &["turn 4660", "step 98304", "270.000000°"]),
    ];
    for (bytes, words) in cases {
        let arguments: Vec<&str> = bytes.split(' ').collect();
        let ran = bench.run(&[&["decode", "biss"], &arguments[..]].concat());
        assert_eq!(ran.status, Some(0), "{ran:?}");
        for word in words {
            assert!(ran.out.contains(word), "{word}: {ran:?}");
        }
    }
}

/// Every frame of the table in BiSS reference 2 is decoded.
#[test]
fn checks_position_frames() {
    let bench = Bench::new();
    let table = [
        ("000000000FA", 0, 0, false, false),
        ("0000000007C", 0, 0, true, false),
        ("000000000B9", 0, 0, false, true),
        ("000000001F6", 0, 1, false, false),
        ("000020000D8", 1, 0, false, false),
        ("024698000CF", 0x1234, 0x18000, false, false),
        ("001FEABCDF0", 0xFF, 0xABCD, false, false),
        ("14B4B55552D", 0xA5A5, 0x15555, true, true),
        ("1FFFFFFFFF5", 0xFFFF, 0x1FFFF, false, false),
    ];
    let words: Vec<&str> = table.iter().map(|row| row.0).collect();
    let told = bench.run(&[&["decode", "biss", "--json"], &words[..]].concat()).json();
    for ((word, turns, steps, error, warning), frame) in table.iter().zip(told["frames"].as_array().unwrap()) {
        assert_eq!((&frame["bytes"], &frame["valid"]), (&json!(word), &json!(true)));
        assert_eq!((&frame["turns"], &frame["steps"]), (&json!(turns), &json!(steps)), "{word}");
        assert_eq!((&frame["error"], &frame["warning"]), (&json!(error), &json!(warning)), "{word}");
    }
    let prefixed = bench.run(&["decode", "biss", "0x24698000CF", "--json"]).json();
    assert_eq!(prefixed["frames"][0]["turns"], json!(0x1234));
}

/// A word printed by `position` can be decoded in decimal and in hexadecimal. This one is turn 1234h at 270° (UBICOM
/// reference 6).
#[test]
fn decodes_printed_position_words() {
    let bench = Bench::new();
    let table = bench.run(&["position", "biss", "--csv", "--count", "1", "--link", "sim:"]).out;
    let raw = format!("raw={}", table.lines().nth(1).unwrap().split(',').nth(1).unwrap());
    let line = bench.run(&["position", "biss", "--link", "sim:?bridge=on"]).out;
    let hex = line.split_whitespace().find(|word| word.starts_with("0x")).unwrap();
    assert_eq!((raw.as_str(), hex), ("raw=610893824", "0x024698000"));
    let told = bench.run(&["decode", "biss", &raw, hex, "raw=0x24698000", "024698000CF", "--json"]).json();
    for one in told["frames"].as_array().unwrap() {
        assert_eq!((&one["raw"], &one["turns"], &one["steps"]), (&json!(0x2469_8000), &json!(4660), &json!(98_304)));
    }
    bench.run(&["decode", "biss", "raw=8589934592"]).fails(1, &["33 bits"]);
    // Nine digits may be a decimal or a hexadecimal number.
    bench.run(&["decode", "biss", "123456789"]).fails(2, &["0x024698000", "raw="]);
    bench.run(&["decode", "biss", "raw=x"]).fails(2, &["raw=x", "0x024698000"]);
}

#[test]
fn corrupt_frame_names_failed_checksum() {
    let bench = Bench::new();
    let cases: [(&str, &[&str]); 7] = [
        ("024698000CE", &["CRC-6", "0E", "0F"]),
        ("02469800 00CF", &["no bridge packet"]),
        ("05 01 01 1F 3F 00", &["CRC-16", "3F1F", "3E1F"]),
        ("80 01 01 02 00 26 00 54", &["checksum", "54", "55"]),
        ("80 01 01 02 00 26 00", &["7 bytes", "8"]),
        ("00000000000", &["stays low"]),
        ("1FFFFFFFFFF", &["stays high"]),
    ];
    for (bytes, words) in cases {
        let arguments: Vec<&str> = bytes.split(' ').collect();
        let command = [&["decode", "biss"], &arguments[..]].concat();
        bench.run(&command).fails(1, words);
        let told = bench.run(&[&command[..], &["--json"]].concat()).json_with_status(1);
        assert!(told["frames"].as_array().unwrap().iter().all(|frame| frame["valid"] == json!(false)), "{told}");
    }
    // The adapter has read a frame with a wrong CRC, but the packet that contains it is valid.
    let packet = "06 07 A1 41 42 0F 01 01 01 01 01 02 CE 04 80 69 24 01 01 03 85 9D 00";
    bench.run(&["decode", "biss", packet]).fails(1, &["CRC-6", "024698000CE"]);
    // Valid frames are printed even if the same command contains invalid ones.
    let mixed = bench.run(&["decode", "biss", "024698000CF", "024698000CE", "--json"]).json_with_status(1);
    let valid: Vec<&Value> = mixed["frames"].as_array().unwrap().iter().map(|frame| &frame["valid"]).collect();
    assert_eq!(valid, [&json!(true), &json!(false)]);
    for words in [&["xy"][..], &[""], &["0xG24"], &["0x"]] {
        bench.run(&[&["decode", "biss"], words].concat()).fails(2, &[]);
    }
}

#[test]
fn replays_recorded_replies() {
    let bench = Bench::new();
    for (link, way) in [("sim:?temperature=25", ""), ("sim:?temperature=25&bridge=on", "?bridge=on")] {
        let trace = bench.file("t.trace");
        let replay = format!("replay:{trace}{way}");
        let told = bench.run(&["identify", "biss", "--link", link, "--trace", &trace, "--json"]).json();
        assert_eq!(bench.run(&["identify", "biss", "--link", &replay, "--json"]).json(), told, "{link}");
        bench.run(&["read", "biss", "0x24:0x10", "--link", &replay]).fails(1, &["t.trace"]);
    }
}

#[test]
fn compares_profiles_offline() {
    let bench = Bench::new();
    let left = bench.write("left.ron", PROFILE);
    let equal = bench.run(&["diff", &left, &left, "--json"]).json();
    assert_eq!((&equal["equal"], &equal["differences"], &equal["missing"]), (&json!(true), &json!([]), &json!([])));
    // A profile has at least 64 banks of 64 registers.
    assert!(equal["compared"].as_u64() >= Some(4096), "{equal}");
    let other =
        PROFILE.replace("(bank: 0x24, bytes: [\"00", "(bank: 0x24, bytes: [\"A1").replace("0x03, // b", "0x04, // b");
    let right = bench.write("right.ron", other);
    let told = bench.run(&["diff", &left, &right, "--json"]).json_with_status(3);
    let differences = json!([
        {"item": "0x6E", "left": "03", "right": "04"},
        {"item": "0x24:0x00", "left": "00", "right": "A1"},
    ]);
    assert_eq!((&told["equal"], &told["differences"]), (&json!(false), &differences), "{told}");
    let text = bench.run(&["diff", &left, &right]);
    assert!(text.status == Some(3) && text.out.contains("0x24:0x00  00  →  A1"), "{text:?}");
    // The message about a profile of another kind of device names both kinds.
    let other = bench.file("other.ron");
    assert_eq!(bench.run(&["save", "hiperface", "--link", "sim:", "-o", &other]).status, Some(0));
    bench.run(&["diff", &left, &other, "--json"]).fails(1, &["other.ron", "hiperface", "biss"]);
    bench.run(&["diff", &other, &left, "--json"]).fails(1, &["left.ron", "hiperface", "biss"]);
}

/// A misspelt name prevents a restore, and the message states its position. A profile with a newer schema can be
/// compared but not restored (issue 22.17).
#[test]
fn reports_misspelt_name_and_newer_schema() {
    let bench = Bench::new();
    for (name, slip, place) in [("filter", "filtr", "line 14, column 5"), ("preset", "presett", "line 15, column 5")] {
        let file = bench.write("slip.ron", PROFILE.replace(&format!("    {name}:"), &format!("    {slip}:")));
        for command in [
            &["restore", &file, "--yes", "--link", "sim:"][..],
            &["diff", &file, &file],
            &["verify", &file, "--link", "sim:"],
        ] {
            bench.run(command).fails(1, &["slip.ron", place, slip, name]);
        }
    }
    let text = PROFILE.replace("schema: 1", "schema: 9").replace("    filter:", "    motor: \"M1\", filter:");
    let newer = bench.write("newer.ron", &text);
    let ran = bench.run(&["diff", &newer, &newer, "--json"]);
    ran.assert_stderr(&["newer.ron", "schema 9", "motor"]);
    assert_eq!(ran.json()["equal"], json!(true));
    bench.run(&["restore", &newer, "--yes", "--link", "sim:"]).fails(1, &["newer.ron", "schema 9", "up to 1"]);
    assert_eq!(bench.read("newer.ron"), text);
}
