//! Reads virtual HIPERDRIVE drives in the same process and over TCP, without setting anything.

use serde_json::{Value, json};

use super::hiperdrive_tap::TappedDevice;
use super::support::{Bench, Ran};

fn ask(bench: &Bench, link: &str, words: &[&str]) -> Ran {
    bench.run(&[words, &["--link", link, "--json"]].concat())
}

const HUB: &str = "sim:?hub=4&drives=1,0,1&serial=1234&requested=1";

#[test]
fn identify_lists_device_and_drives() {
    let bench = Bench::new();
    let told = ask(&bench, HUB, &["identify", "hiperdrive"]).json();
    for (key, value) in [
        ("device", json!("hiperdrive")),
        ("category", json!("HIPERDRIVE HUB-4")),
        ("name", json!("HIPERDRIVE")),
        ("serial_number", json!("1234")),
    ] {
        assert_eq!(told[key], value, "{told}");
    }
    assert!(told["article_number"].is_string() && told["version"].is_string(), "{told}");
    let drives: Vec<(&Value, &Value, &Value)> = told["drives"]
        .as_array()
        .unwrap()
        .iter()
        .map(|drive| (&drive["number"], &drive["variant"], &drive["name"]))
        .collect();
    // Variant 7 in the manual's table is HDA30A.
    let expected = [(&json!(1), &json!(7), &json!("HDA30A")), (&json!(3), &json!(7), &json!("HDA30A"))];
    assert_eq!(drives, expected);
    assert!(told["drives"][0]["serial_number"].is_string(), "{told}");
    let single = ask(&bench, "sim:?variant=13", &["identify", "hiperdrive"]).json();
    assert_eq!((&single["category"], &single["drives"][0]["variant"]), (&json!("HIPERDRIVE SINGLE"), &json!(13)));
}

#[test]
fn healthy_device_reports_no_errors() {
    let bench = Bench::new();
    let told = ask(&bench, "sim:", &["status", "hiperdrive"]).json();
    assert_eq!((&told["ok"], &told["errors"], &told["warnings"]), (&json!(true), &json!([]), &json!([])), "{told}");
    // 2A30 is the status of a drive that is not under control (reference 3).
    let drive = &told["drives"][0];
    assert_eq!((&drive["status_word"], &drive["state"]), (&json!(0x2A30), &json!("not-ready")));
    let text = bench.run(&["status", "hiperdrive", "--link", "sim:"]);
    assert!(text.out.contains("errors") && text.out.contains("Not ready (0x2A30)"), "{text:?}");
}

/// If the lower limit is above the upper one, the device rejects the value with 09 and keeps 8501 as the drive's error
/// (reference 4).
#[test]
fn past_errors_are_reported_as_notes() {
    let bench = Bench::new();
    let device = TappedDevice::start(&bench, &["--hub", "4", "--set", "drives=0,1", "--set", "requested=1"]);
    // Parameter 258, the lower limit of drive 2, is set to 7FFFFFFFh.
    let refused = device.request(&[0x10, 3, 0x20, 0x66, 0x24, 1, 0x30, 0x9E, 0xFF, 0xFF, 0xFF, 0x7F]);
    assert_eq!(refused[..3], [0x90, 0, 9]);
    let told = device.ask(&bench, &["status", "hiperdrive"]).json();
    let error = &told["errors"][0];
    assert_eq!((&told["ok"], &error["code"], &error["drive"]), (&json!(false), &json!(0x8501), &json!(2)), "{told}");
    assert!(error["text"].as_str().unwrap().len() > 20 && told["warnings"] == json!([]), "{told}");
    device.ask(&bench, &["do", "hiperdrive", "acknowledge", "--drive", "2", "--yes"]).json();
    let told = device.ask(&bench, &["status", "hiperdrive"]).json();
    assert_eq!((&told["ok"], &told["errors"]), (&json!(true), &json!([])), "{told}");
    // The content of the error buffer is not a current warning.
    assert_eq!(told["warnings"], json!([]), "{told}");
    let text = bench.run(&["status", "hiperdrive", "--link", &device.url()]);
    let notes = text.out.lines().filter(|line| line.starts_with("note")).count();
    assert_eq!(notes, told["earlier"].as_array().unwrap().len(), "{text:?}");
}

/// The error message recommends writing 0 to parameter 197 as an acknowledgement (issue 26.7).
#[test]
fn writing_0_to_197_acknowledges_one_drive() {
    let bench = Bench::new();
    let device = TappedDevice::start(&bench, &["--hub", "4", "--set", "drives=1,1", "--set", "requested=1"]);
    // Parameter 258, the lower limit of drive 2, is set to 7FFFFFFFh.
    let refused = device.request(&[0x10, 3, 0x20, 0x66, 0x24, 1, 0x30, 0x9E, 0xFF, 0xFF, 0xFF, 0x7F]);
    assert_eq!(refused[..3], [0x90, 0, 9]);
    let status = |drive: &str| device.ask(&bench, &["status", "hiperdrive", "--drive", drive]).json();
    for (drive, is_ok) in [("1", true), ("2", false)] {
        let told = status(drive);
        assert_eq!((&told["ok"], told["drives"].as_array().unwrap().len()), (&json!(is_ok), 1), "{told}");
        assert_eq!(told["drives"][0]["number"].to_string(), drive, "{told}");
    }
    device.ask(&bench, &["write", "hiperdrive", "197", "0", "--drive", "2", "--yes"]).json();
    assert_eq!(status("2")["ok"], json!(true));
    // No error is left to acknowledge, so nothing is sent.
    device.sets();
    device.ask(&bench, &["write", "hiperdrive", "297", "0", "--yes"]).assert_stderr(&["Drive 2 has no fault"]);
    assert!(device.sets().is_empty());
}

/// A device or drive of another type may have the same serial number. The message names the type, and a restore is
/// rejected unless the user permits it explicitly (issue 22.9).
#[test]
fn other_type_needs_permission() {
    let bench = Bench::new();
    let file = bench.file("single.ron");
    ask(&bench, "sim:?serial=77&requested=1", &["save", "hiperdrive", "-o", &file]).json();
    let (hub, other) = ("sim:?serial=77&requested=1&hub=4&speed=200", "sim:?serial=77&requested=1&variant=13");
    for (device, types) in [(hub, ["HIPERDRIVE SINGLE", "HIPERDRIVE HUB-4"]), (other, ["HDA30A", "HDA70"])] {
        for consent in ["--yes", "--dry-run"] {
            let ran = ask(&bench, device, &["restore", &file, consent, "--allow-other-device"]);
            ran.fails(1, &[types[0], types[1], "--allow-other-type"]);
        }
        let dry = ask(&bench, device, &["restore", &file, "--dry-run", "--allow-other-type"]);
        assert!(types.iter().all(|own| dry.err.contains(own)), "{dry:?}");
    }
    let told = ask(&bench, hub, &["restore", &file, "--yes", "--allow-other-type"]).json();
    assert_eq!(told["written"], json!(1), "{told}");
}

#[test]
fn check_reports_each_fact_once() {
    let bench = Bench::new();
    let ran = bench.run(&["do", "hiperdrive", "check", "--link", "sim:?hub=4&drives=1"]);
    assert!(!ran.out.contains("HDA30A HDA30A") && !ran.out.contains(".;"), "{ran:?}");
    let line = ran.out.lines().find(|line| line.contains("RS-485")).unwrap();
    assert_eq!(line.matches("good").count(), 1, "{line}");
}

/// A speed is in tenths of rpm only at the factory scale (manual 6.2). Nominal data may be in tenths. At standstill,
/// the speed is 0 at any scale (issue 21.10).
#[test]
fn units_match_manual() {
    let bench = Bench::new();
    let device = TappedDevice::start(&bench, &[]);
    let read = |number: &str| device.ask(&bench, &["read", "hiperdrive", number]).json();
    assert_eq!(read("106")["unit"], json!("0.1 rpm"));
    // Parameter 162 is set to 100.
    assert_eq!(device.request(&[0x10, 3, 0x20, 0x65, 0x24, 1, 0x30, 162, 100, 0])[..3], [0x90, 0, 0]);
    assert!(read("106").get("unit").is_none());
    let text = |number: &str| bench.run(&["read", "hiperdrive", number, "--link", &device.url()]).out;
    assert_eq!((text("106").as_str(), text("127").as_str()), ("0 = 0.0 rpm\n", "A25 = 2.5 A\n"));
    assert_eq!((read("127")["value"].clone(), read("127").get("unit")), (json!("A25"), None));
}

/// A turn has 65536 steps: position −1 is turn −1, step 65535, and 163840 is 2.5 turns (reference 2).
#[test]
fn position_has_signed_turns() {
    let bench = Bench::new();
    for (link, drive, raw, turns, steps, degrees) in [
        ("sim:?position=163840", "1", 163_840, 2, 32_768, 180.0),
        ("sim:?position=-1", "1", -1, -1, 65_535, 360.0 * 65_535.0 / 65_536.0),
        ("sim:?hub=4&drives=0,0,1&position=65536", "3", 65_536, 1, 0, 0.0),
    ] {
        let told = ask(&bench, link, &["position", "hiperdrive", "--drive", drive]).json();
        assert_eq!(
            (&told["raw"], &told["turns"], &told["steps"]),
            (&json!(raw), &json!(turns), &json!(steps)),
            "{told}"
        );
        assert_eq!((&told["degrees"], &told["valid"]), (&json!(degrees), &json!(true)), "{told}");
        assert!(told["t_s"].is_f64(), "{told}");
    }
    let several = ask(&bench, "sim:", &["position", "hiperdrive", "--count", "3", "--interval", "0"]);
    assert_eq!((several.status, several.out.lines().count()), (Some(0), 3), "{several:?}");
    let table = bench.run(&["position", "hiperdrive", "--csv", "--count", "2", "--link", "sim:?position=-1"]);
    let lines: Vec<&str> = table.out.lines().collect();
    assert_eq!((lines.len(), lines[0]), (3, "t_s,raw,turns,steps,degrees,valid"), "{table:?}");
    assert!(lines[1].contains(",-1,-1,65535,359.99"), "{table:?}");
}

#[test]
fn reads_parameters_by_number() {
    let bench = Bench::new();
    let cases: [(&[&str], &str, Value, Value); 7] = [
        (&["13"], "13", json!("HIPERDRIVE HUB-4"), Value::Null),
        (&["17"], "17", json!(1234), Value::Null),
        (&["47"], "47", json!(0), Value::Null),
        // −511 turns of 65536 steps.
        (&["158"], "158", json!(-33_488_896), json!("steps")),
        (&["158", "--drive", "3"], "158 drive 3", json!(-33_488_896), json!("steps")),
        (&["366"], "166 drive 3", json!(350), json!("0.1 rpm")),
        (&["321"], "121 drive 3", json!("HDA30A"), Value::Null),
    ];
    for (words, item, value, unit) in cases {
        let told = ask(&bench, HUB, &[&["read", "hiperdrive"], words].concat()).json();
        assert_eq!((&told["item"], &told["value"], &told["unit"]), (&json!(item), &value, &unit), "{told}");
    }
    // 7 in the manual's table is HDA30A. 2A30 is the status of a drive that is not under control.
    for (item, text) in [
        ("166", "350 × 0.1 rpm = 35.0 rpm\n"),
        ("0x9E", "-33488896 steps\n"),
        ("9", "240 × 0.1 V = 24.0 V\n"),
        ("186", "20 × 0.1 s = 2.0 s\n"),
        ("105", "0x2A30 (Not ready)\n"),
        ("108", "0x0000 (no error)\n"),
        ("120", "7 (HDA30A)\n"),
    ] {
        assert_eq!(bench.run(&["read", "hiperdrive", item, "--link", "sim:"]).out, text);
    }
}

#[test]
fn saved_profile_is_human_readable() {
    let bench = Bench::new();
    let file = bench.file("hub.ron");
    let told = ask(&bench, HUB, &["save", "hiperdrive", "-o", &file]).json();
    // There are 10 registers of the device and 13 of each drive: 152 to 166, 186 to 192, and 198.
    assert_eq!((&told["parameters"], &told["drives"]), (&json!(36), &json!(2)), "{told}");
    let text = bench.read("hub.ron");
    for line in [
        "    device: \"hiperdrive\",\n",
        "        category: \"HIPERDRIVE HUB-4\",\n",
        "        serial_number: \"1234\",\n",
        "            number: 3,\n            variant: 7, // HDA30A\n",
        "                158: -33488896, // lower limit [steps], -511.000 turns\n",
        "        (item: \"198 drive 3\", ",
    ] {
        assert!(text.contains(line), "{line} is not in\n{text}");
    }
    assert!(!text.contains("107:"), "a position is no part of it:\n{text}");
    assert_eq!(
        ask(&bench, HUB, &["verify", &file]).json(),
        json!({"equal": true, "differences": [], "compared": 36, "missing": []})
    );
    // A changed position is not a difference.
    let moved = HUB.replace("requested=1", "requested=1&position=5000&supply=22");
    assert_eq!(ask(&bench, &moved, &["diff", &file]).json()["equal"], json!(true));
    let slower = HUB.replace("requested=1", "requested=1&speed=200");
    let told = ask(&bench, &slower, &["diff", &file]).json_with_status(3);
    let expected = json!([
        {"item": "166", "left": "350", "right": "200"},
        {"item": "166 drive 3", "left": "350", "right": "200"},
    ]);
    assert_eq!(told["differences"], expected);
    // One slot of the hub has become empty.
    let fewer = HUB.replace("1,0,1", "1,0,0");
    let told = ask(&bench, &fewer, &["verify", &file]).json_with_status(3);
    assert_eq!((&told["compared"], &told["missing"][0]), (&json!(23), &json!("152 drive 3")), "{told}");
}

/// Only the services get attribute single (0E) and get attribute all (01) are requested, and no cyclic connection is
/// opened.
#[test]
fn reading_writes_nothing() {
    let bench = Bench::new();
    let file = bench.file("drive.ron");
    let changed =
        bench.write("changed.ron", r#"(schema: 1, device: "hiperdrive", parameters: {166: 200, 158: -1000000})"#);
    let device = TappedDevice::start(&bench, &["--set", "position=100"]);
    for words in [
        &["identify", "hiperdrive"][..],
        &["status", "hiperdrive"],
        &["position", "hiperdrive", "--count", "3", "--interval", "1"],
        &["read", "hiperdrive", "158"],
        &["save", "hiperdrive", "-o", &file],
        &["diff", &file],
        &["verify", &file],
        &["do", "hiperdrive", "check"],
        &["restore", &changed, "--dry-run"],
        &["restore", &changed],
        &["write", "hiperdrive", "166", "200"],
    ] {
        let ran = device.ask(&bench, words);
        let heard = device.heard();
        let foreign: Vec<&String> =
            heard.iter().filter(|own| !own.starts_with("0E ") && !own.starts_with("01 ")).collect();
        assert!(foreign.is_empty(), "{words:?}: {foreign:?}");
        // Without consent, no connection is opened.
        let asks = !matches!(words, ["restore", _] | ["write", ..]);
        assert_eq!((ran.status, heard.is_empty()), (Some(if asks { 0 } else { 2 }), !asks), "{words:?}: {ran:?}");
    }
}

#[test]
fn finds_devices_by_address() {
    let bench = Bench::new();
    let device = TappedDevice::start(&bench, &["--set", "hub=8", "--set", "serial=77"]);
    let url = device.url();
    let told = bench.run(&["find", "hiperdrive", "--link", &url, "--json"]).json();
    let found = &told["devices"][0];
    assert_eq!((&found["link"], &found["product_name"]), (&json!(url), &json!("HIPERDRIVE HUB-8")), "{told}");
    let wrong = bench.run(&["find", "hiperdrive", "--link", "sim:"]);
    wrong.fails(2, &["enip:ADDRESS"]);
}

/// A terminal shows a progress bar and a note about the network. A script receives neither.
#[test]
fn scripts_receive_no_progress_output() {
    let bench = Bench::new();
    let ran = ask(&bench, "sim:?fault=delay:200", &["status", "hiperdrive"]);
    assert!(ran.json()["ok"] == json!(true) && ran.err.is_empty(), "{ran:?}");
    bench
        .run(&["read", "hiperdrive", "158", "--link", "sim:?fault=delay:100&timeout=20"])
        .fails(1, &["too late", "timeout=2000 in the link"]);
    bench
        .run(&["read", "hiperdrive", "158", "--link", "sim:?fault=silent-after:0&timeout=20"])
        .fails(1, &["does not answer", "timeout=2000 in the link"]);
}
