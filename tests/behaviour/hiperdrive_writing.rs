//! Writes to virtual HIPERDRIVE drives, with a proxy that records each request and each save.

use serde_json::{Value, json};

use super::hiperdrive_tap::TappedDevice;
use super::support::Bench;

/// The request that saves: parameter 47 is set to 1 (reference 9).
const SAVE: &str = "10 03 20 64 24 01 30 2F 01 00";

#[test]
fn writes_parameter_and_saves_once() {
    let bench = Bench::new();
    let device = TappedDevice::start(&bench, &[]);
    let told = device.ask(&bench, &["write", "hiperdrive", "158", "-1000000", "--yes"]).json();
    let operations = json!([
        {"item": "158", "old": -33_488_896, "new": -1_000_000, "write_cycles": 0},
        {"item": "47", "old": null, "new": 1, "write_cycles": 1},
    ]);
    assert_eq!((&told["item"], &told["operations"], &told["write_cycles"]), (&json!("158"), &operations, &json!(1)));
    assert_eq!((&told["written"], &told["verified"]), (&json!(1), &json!(1)), "{told}");
    // −1000000 is FFF0BDC0h, sent with the low byte first.
    assert_eq!(device.sets(), ["10 03 20 65 24 01 30 9E C0 BD F0 FF", SAVE]);
    assert_eq!(device.ask(&bench, &["read", "hiperdrive", "158"]).json()["value"], json!(-1_000_000));
    device.heard();
    // When the write is repeated, the values are already equal.
    let again = device.ask(&bench, &["write", "hiperdrive", "158", "-1000000", "--yes"]).json();
    assert_eq!((&again["written"], &again["write_cycles"], &again["backup"]), (&json!(0), &json!(0), &Value::Null));
    assert_eq!(device.sets(), Vec::<String>::new());
    // Restoring the backup restores the value.
    let backup = told["backup"].as_str().unwrap();
    let undone = device.ask(&bench, &["restore", backup, "--yes"]).json();
    assert_eq!((&undone["written"], &undone["write_cycles"]), (&json!(1), &json!(1)), "{undone}");
    // −33488896 is FE010000h.
    assert_eq!(device.sets(), ["10 03 20 65 24 01 30 9E 00 00 01 FE", SAVE]);
}

#[test]
fn does_not_save_volatile_parameters() {
    let bench = Bench::new();
    let device = TappedDevice::start(&bench, &["--set", "hub=4", "--set", "drives=0,1", "--set", "requested=1"]);
    let told = device.ask(&bench, &["write", "hiperdrive", "170", "100", "--drive", "2", "--yes"]).json();
    assert_eq!((&told["item"], &told["write_cycles"]), (&json!("170 drive 2"), &json!(0)), "{told}");
    // Parameter 270 is in class 66h.
    assert_eq!(device.sets(), ["10 03 20 66 24 01 30 AA 64 00 00 00"]);
}

/// A spindle with a pitch of 4 mm in steps of 0.01 mm has 400 steps per turn, which is 400/256 (reference 5). At 2.5
/// turns, the position is 1000.
#[test]
fn restore_writes_scale_before_limits() {
    let bench = Bench::new();
    let parameters = "24: 5, 154: 400, 156: 256, 158: 500, 160: 2000, 166: 200, 198: 640, 186: 20";
    let profile = format!("(schema: 1, device: \"hiperdrive\", parameters: {{{parameters}}})");
    let file = bench.write("spindle.ron", profile);
    let device = TappedDevice::start(&bench, &["--set", "position=163840"]);
    let dry = device.ask(&bench, &["restore", &file, "--dry-run"]).json();
    let items: Vec<&str> =
        dry["operations"].as_array().unwrap().iter().map(|op| op["item"].as_str().unwrap()).collect();
    assert_eq!(items, ["24", "156", "154", "166", "158", "160", "47"]);
    assert_eq!((&dry["unchanged"], &dry["write_cycles"]), (&json!(1), &json!(1)), "{dry}");
    assert_eq!(device.sets(), Vec::<String>::new());
    let ran = device.ask(&bench, &["restore", &file, "--yes"]);
    let told = ran.json();
    assert_eq!(
        (&told["written"], &told["verified"], &told["write_cycles"]),
        (&json!(6), &json!(6), &json!(1)),
        "{told}"
    );
    assert!(ran.err.contains("198 belongs to the mounting"), "{ran:?}");
    let expected = [
        "10 03 20 64 24 01 30 18 05 00 00 00",
        "10 03 20 65 24 01 30 9C 00 01",
        "10 03 20 65 24 01 30 9A 90 01",
        "10 03 20 65 24 01 30 A6 C8 00",
        "10 03 20 65 24 01 30 9E F4 01 00 00",
        "10 03 20 65 24 01 30 A0 D0 07 00 00",
        SAVE,
    ];
    assert_eq!(device.sets(), expected);
    let place = device.ask(&bench, &["position", "hiperdrive"]).json();
    assert_eq!((&place["raw"], &place["turns"], &place["steps"]), (&json!(1000), &json!(2), &json!(200)), "{place}");
    // Only the reference differs, which is never restored, so nothing is written or saved.
    device.heard();
    let again = device.ask(&bench, &["restore", &file, "--yes", "--with-mounting"]).json();
    assert_eq!((&again["written"], &again["unchanged"], &again["write_cycles"]), (&json!(0), &json!(7), &json!(0)));
    assert_eq!(device.sets(), Vec::<String>::new());
    // Both limits move up, past their old values, so the upper limit is written first (1000 lies between 500 and 2000,
    // and between 600 and 5000).
    let up = bench.write("up.ron", r#"(schema: 1, device: "hiperdrive", parameters: {158: 1000, 160: 1001})"#);
    device.ask(&bench, &["restore", &up, "--yes"]).json();
    device.sets();
    let higher = bench.write("higher.ron", r#"(schema: 1, device: "hiperdrive", parameters: {158: -5, 160: 1000})"#);
    device.ask(&bench, &["restore", &higher, "--yes"]).json();
    assert_eq!(
        device.sets(),
        ["10 03 20 65 24 01 30 9E FB FF FF FF", "10 03 20 65 24 01 30 A0 E8 03 00 00", SAVE],
        "160 = 1000 would not be above 158 = 1000"
    );
}

#[test]
fn does_not_change_drive_outside_new_limits() {
    let bench = Bench::new();
    let device = TappedDevice::start(&bench, &["--set", "position=100"]);
    let file =
        bench.write("limits.ron", r#"(schema: 1, device: "hiperdrive", parameters: {24: 1, 158: 200, 160: 300})"#);
    for words in [
        &["restore", &file, "--yes"][..],
        &["restore", &file, "--dry-run"],
        &["write", "hiperdrive", "158", "200", "--yes"],
    ] {
        device.ask(&bench, words).fails(1, &["100", "200", "198", "reference"]);
        assert_eq!(device.sets(), Vec::<String>::new());
    }
}

#[test]
fn sets_position_in_steps_of_64() {
    let bench = Bench::new();
    let device = TappedDevice::start(&bench, &["--set", "position=5000"]);
    let ran = device.ask(&bench, &["do", "hiperdrive", "set-position", "100", "--yes"]);
    assert_eq!(ran.json()["write_cycles"], json!(1));
    ran.assert_stderr(&["100 becomes 128"]);
    assert_eq!(device.sets(), ["10 03 20 65 24 01 30 C6 80 00 00 00", SAVE]);
    assert_eq!(device.ask(&bench, &["position", "hiperdrive"]).json()["raw"], json!(128));
    // The value −33 becomes −64.
    device.ask(&bench, &["write", "hiperdrive", "198", "-33", "--yes"]).assert_stderr(&["-33 becomes -64"]);
    assert_eq!(device.ask(&bench, &["position", "hiperdrive"]).json()["raw"], json!(-64));
    device.sets();
    let beyond = device.ask(&bench, &["do", "hiperdrive", "set-position", "33488930", "--yes"]);
    beyond.fails(1, &["-33488896", "33488896"]);
    assert_eq!(device.sets(), Vec::<String>::new());
}

#[test]
fn services_write_parameter_47() {
    let bench = Bench::new();
    let device = TappedDevice::start(&bench, &[]);
    device.ask(&bench, &["write", "hiperdrive", "166", "200", "--yes"]).json();
    device.sets();
    for (words, sent, cost) in [
        (&["save"][..], "01 00", 1),
        (&["factory"], "FF FF", 0),
        (&["recall"], "FE FF", 0),
        (&["presence-test"], "FC FF", 0),
        (&["factory", "--all"], "FD FF", 1),
    ] {
        let told = device.ask(&bench, &[&["do", "hiperdrive"], words, &["--yes"]].concat()).json();
        assert_eq!(told["write_cycles"], json!(cost), "{words:?}: {told}");
        assert_eq!(device.sets(), [format!("10 03 20 64 24 01 30 2F {sent}")], "{words:?}");
        let speed = device.ask(&bench, &["read", "hiperdrive", "166"]).json();
        // −1 and −2 apply to the adapter's own parameters (manual, 47), so the drive keeps its speed.
        let expected = if words.contains(&"--all") { 350 } else { 200 };
        assert_eq!(speed["value"], json!(expected), "{words:?}");
    }
    device.ask(&bench, &["do", "hiperdrive", "acknowledge", "--yes"]).json();
    device.ask(&bench, &["do", "hiperdrive", "factory", "--yes"]).assert_stderr(&["saved"]);
}

#[test]
fn restore_skips_empty_ports() {
    let bench = Bench::new();
    let file = bench.file("hub.ron");
    let hub = |serial: &str, drives: &str| {
        let (serial, drives) = (format!("serial={serial}"), format!("drives={drives}"));
        let own = ["--set", "hub=4", "--set", "requested=1", "--set", "speed=100", "--set", &serial, "--set", &drives];
        TappedDevice::start(&bench, &own)
    };
    let mine = hub("10", "1,0,1");
    mine.ask(&bench, &["save", "hiperdrive", "-o", &file]).json();
    bench.write("hub.ron", bench.read("hub.ron").replace("166: 100", "166: 200"));
    let other = hub("11", "1,1");
    other.ask(&bench, &["restore", &file, "--yes"]).fails(1, &["10", "11", "--allow-other-device"]);
    assert_eq!(other.sets(), Vec::<String>::new());
    let ran = other.ask(&bench, &["restore", &file, "--yes", "--allow-other-device"]);
    let told = ran.json();
    assert_eq!((&told["written"], &told["missing"].as_array().unwrap().len()), (&json!(1), &13), "{told}");
    ran.assert_stderr(&["port 3"]);
    assert_eq!(other.sets(), ["10 03 20 65 24 01 30 A6 C8 00", SAVE]);
}

#[test]
fn shows_scale_change_effect_on_limits() {
    let bench = Bench::new();
    let file = bench.write("scale.ron", r#"(schema: 1, device: "hiperdrive", parameters: {154: 400, 156: 256})"#);
    let ran = bench.run(&["restore", &file, "--dry-run", "--link", "sim:"]);
    // 511 turns become 33488896 / 400.
    assert_eq!(ran.status, Some(0), "{ran:?}");
    ran.assert_stderr(&["511", "83722.24"]);
}

#[test]
fn names_values_that_trigger_actions() {
    let bench = Bench::new();
    for (code, name) in [("-1", "47 = −1"), ("-2", "47 = −2"), ("-3", "47 = −3"), ("-4", "47 = −4")] {
        let ran = bench.run(&["write", "hiperdrive", "47", code, "--yes", "--link", "sim:"]);
        assert!(ran.status == Some(0) && ran.err.contains(name) && ran.out.contains(name), "{ran:?}");
        assert_eq!(ran.err.contains("Without a DHCP server"), code == "-3", "{ran:?}");
    }
    let ran = bench.run(&["do", "hiperdrive", "factory", "--all", "--yes", "--link", "sim:"]);
    assert!(ran.err.contains("the device loses its address"), "{ran:?}");
}

#[test]
fn reports_location_of_unknown_parameter_number() {
    let bench = Bench::new();
    let file = bench.write("slip.ron", r#"(schema: 1, device: "hiperdrive", parameters: {166: 200, 999: 7})"#);
    bench.run(&["restore", &file, "--yes", "--link", "sim:"]).fails(1, &["parameters.999"]);
}
