//! Writes to an independently written K3 encoder. Each word and each store is checked.

use std::fmt::Write as _;

use encoder_studio::store::DeviceKey;
use serde_json::{Value, json};

use super::support::{Bench, Foreign, Ran, run_on_terminal};

fn ask(bench: &Bench, encoder: &Foreign, words: &[&str]) -> Ran {
    bench.run(&[words, &["--link", &encoder.url, "--json"]].concat())
}

/// Returns the words that set a value, with their effects, since the last call.
fn written(encoder: &Foreign) -> Vec<String> {
    let reads = ["R", "W 2021", "W 2020", "W 2080", "W 80000000", "W 00000000"];
    encoder.requests().into_iter().filter(|line| !reads.iter().any(|begin| line.starts_with(begin))).collect()
}

/// Returns the default start and stop of a cam.
fn edges(program: u32, cam: u32) -> (u32, u32) {
    (100 * cam + program, 100 * cam + program + 49)
}

/// Returns all 64 cams with mask FFh, as JSON for the encoder and as RON for a profile. `other` changes individual
/// cams.
fn cams(other: impl Fn(u32, u32) -> Option<(u32, u32)>) -> (String, String) {
    let (mut json, mut ron) = (String::new(), String::new());
    for program in 1..=8 {
        let (mut json_cams, mut ron_cams) = (Vec::new(), String::new());
        for cam in 0..8 {
            let (start, stop) = other(program, cam).unwrap_or(edges(program, cam));
            json_cams.push(format!("\"{cam}\": [{start}, {stop}]"));
            let _ = write!(ron_cams, "(cam: {cam}, start: {start}, stop: {stop}),");
        }
        let comma = if program == 1 { "" } else { ", " };
        let _ = write!(json, "{comma}\"{program}\": {{\"mask\": 255, \"cams\": {{{}}}}}", json_cams.join(", "));
        let _ = write!(ron, "(program: {program}, mask: 0xFF, cams: [{ron_cams}]),");
    }
    (format!("{{{json}}}"), ron)
}

fn profile(serial_number: &str, parameters: &str, programs: &str) -> String {
    format!(
        r#"(schema: 1, device: "interbus", identity: (serial_number: "{serial_number}"), parameters: ({parameters}),
            mounting: [(item: "preset"), (item: "zero-shift")], programs: [{programs}])"#
    )
}

const PARAMETERS: &str = r#"steps: 3600, revolutions: 1, direction: "cw", preset: 0, zero_shift: 0"#;

/// Restores 64 cams and 8 masks to an encoder that already has 60 of the cams.
#[test]
fn cams_are_stored_once_per_program() {
    let bench = Bench::new();
    let (there, _) = cams(|_, _| None);
    let moved = |program, cam| match (program, cam) {
        (2, 0) => Some((20, 51)),
        (2, 7) => Some((3500, 40)),
        (5, 3) => Some((305, 400)),
        (8, 1) => Some((0, 157)),
        _ => None,
    };
    let (_, wanted) = cams(moved);
    let file = bench.write("cams.ron", profile("4000", PARAMETERS, &wanted));
    let Some(encoder) = bench.gateway(&["--steps=3600", "--programs", &there]) else { return };
    let dry = ask(&bench, &encoder, &["restore", &file, "--dry-run"]).json();
    assert_eq!((&dry["write_cycles"], &dry["unchanged"]), (&json!(3), &json!(5 + 8 + 60)), "{dry}");
    let expected = json!([
        {"item": "cam:2:0 start", "old": "2", "new": "20", "write_cycles": 0},
        {"item": "cam:2:7 start", "old": "702", "new": "3500", "write_cycles": 0},
        {"item": "cam:2:7 stop", "old": "751", "new": "40", "write_cycles": 0},
        {"item": "cam program 2", "old": null, "new": "stored", "write_cycles": 1},
        {"item": "cam:5:3 start", "old": "305", "new": "305", "write_cycles": 0},
        {"item": "cam:5:3 stop", "old": "354", "new": "400", "write_cycles": 0},
        {"item": "cam program 5", "old": null, "new": "stored", "write_cycles": 1},
        {"item": "cam:8:1 start", "old": "108", "new": "0", "write_cycles": 0},
        {"item": "cam program 8", "old": null, "new": "stored", "write_cycles": 1},
    ]);
    // Edges that already have the value are left out.
    let expected: Vec<&Value> = expected.as_array().unwrap().iter().filter(|own| own["old"] != own["new"]).collect();
    assert_eq!(dry["operations"].as_array().unwrap().iter().collect::<Vec<_>>(), expected);
    assert!(written(&encoder).is_empty());
    let told = ask(&bench, &encoder, &["restore", &file, "--yes"]).json();
    assert_eq!(
        (&told["written"], &told["verified"], &told["write_cycles"]),
        (&json!(4), &json!(4), &json!(3)),
        "{told}"
    );
    // A word consists of 010 or 011, four bits for the cam and 25 bits for the position (reference 5).
    let words = [
        "W 40000014",
        "W 4E000DAC",
        "W 6E000028",
        "STORE program 2",
        "W 66000190",
        "STORE program 5",
        "W 42000000",
        "STORE program 8",
    ];
    assert_eq!(written(&encoder), words);
    assert_eq!(ask(&bench, &encoder, &["verify", &file]).json()["equal"], json!(true));
    // When the restore is repeated, nothing differs, so nothing is set and no backup is stored.
    let again = ask(&bench, &encoder, &["restore", &file, "--yes"]).json();
    assert_eq!((&again["written"], &again["write_cycles"], &again["backup"]), (&json!(0), &json!(0), &Value::Null));
    // The backup is a profile of the changed values and restores them.
    let backup = told["backup"].as_str().unwrap();
    let undone = ask(&bench, &encoder, &["restore", backup, "--yes"]).json();
    assert_eq!((&undone["written"], &undone["write_cycles"]), (&json!(4), &json!(3)), "{undone}");
    assert_eq!(written(&encoder).len(), 8);
}

/// All parameters are written with a single store, in an order that keeps each intermediate value valid. The preset is
/// stored but not triggered (reference 3).
#[test]
fn parameters_are_stored_once() {
    let bench = Bench::new();
    let parameters = r#"steps: 36000, revolutions: 10, direction: "ccw", preset: 20000, zero_shift: 0"#;
    let file = bench.write("gear.ron", profile("4000", parameters, ""));
    let Some(encoder) = bench.gateway(&["--steps=3600", "--busy=10", "--stale=1"]) else { return };
    let told = ask(&bench, &encoder, &["restore", &file, "--yes"]).json();
    assert_eq!((&told["written"], &told["write_cycles"], &told["unchanged"]), (&json!(4), &json!(1), &json!(1)));
    let words = ["W 0400000A", "W 02008CA0", "W 06000004", "W 08004E20", "STORE parameters"];
    assert_eq!(written(&encoder), words);
    assert_eq!(ask(&bench, &encoder, &["verify", &file]).json()["equal"], json!(true));
}

#[test]
fn writes_each_item_by_name() {
    let bench = Bench::new();
    let Some(encoder) = bench.gateway(&["--steps=3600"]) else { return };
    let cases = [
        ("cam:3:5", "100..200", json!("100..200"), &["W 4A000064", "W 6A0000C8", "STORE program 3"][..]),
        ("cam-mask:3", "0x20", json!(32), &["W 20400020", "STORE program 3"]),
        ("shift", "8", json!(8), &["W 20100008", "STORE program 1"]),
        ("preset", "1000", json!(1000), &["W 080003E8", "STORE parameters"]),
        ("direction", "ccw", json!("ccw"), &["W 06000004", "STORE parameters"]),
        ("zero-shift", "5", json!(5), &["W 0A000005", "STORE parameters"]),
        ("steps", "4096", json!(4096), &["W 02001000", "STORE parameters"]),
        ("revolutions", "2", json!(2), &["W 04000002", "STORE parameters"]),
    ];
    for (item, text, value, words) in cases {
        let told = ask(&bench, &encoder, &["write", "interbus", item, text, "--yes"]).json();
        assert_eq!((&told["item"], &told["write_cycles"]), (&json!(item), &json!(1)), "{told}");
        assert_eq!(written(&encoder), words, "{item}");
        assert_eq!(ask(&bench, &encoder, &["read", "interbus", item]).json()["value"], value, "{item}");
    }
    // Cams that were not read may lie outside a shorter range.
    let shorter = ask(&bench, &encoder, &["write", "interbus", "steps", "2048", "--yes"]);
    assert!(shorter.status == Some(0) && shorter.err.contains("may then be outside the range"), "{shorter:?}");
    assert_eq!(written(&encoder), ["W 02000800", "STORE parameters"]);
    let again = ask(&bench, &encoder, &["write", "interbus", "direction", "4", "--yes"]).json();
    assert_eq!((&again["written"], &again["write_cycles"]), (&json!(0), &json!(0)), "it is so already: {again}");
    assert!(written(&encoder).is_empty());
}

/// Triggering a preset sends 00000000, then 40000000 until IN shows the preset, then 00000000. This happens once for
/// each time the preset was programmed (reference 4).
#[test]
fn preset_triggers_at_standstill() {
    let bench = Bench::new();
    let Some(encoder) = bench.gateway(&["--steps=3600", "--preset=500"]) else { return };
    let told = ask(&bench, &encoder, &["do", "interbus", "preset", "--yes"]).json();
    assert_eq!((&told["item"], &told["write_cycles"]), (&json!("preset"), &json!(1)), "{told}");
    assert_eq!(written(&encoder), ["W 080001F4", "STORE parameters", "W 40000000", "PRESET 500"]);
    let position = ask(&bench, &encoder, &["position", "interbus"]).json();
    assert_eq!(position["raw"], json!(500), "{position}");
    let told = ask(&bench, &encoder, &["do", "interbus", "preset", "7", "--yes"]).json();
    assert_eq!(told["written"], json!(2), "{told}");
    assert_eq!(written(&encoder), ["W 08000007", "STORE parameters", "W 40000000", "PRESET 7"]);
    ask(&bench, &encoder, &["do", "interbus", "preset", "3600", "--yes"]).fails(1, &["3600", "0", "3599"]);
    let Some(turning) = bench.gateway(&["--steps=3600", "--rpm=60"]) else { return };
    ask(&bench, &turning, &["do", "interbus", "preset", "7", "--yes"])
        .fails(1, &["is moving", "the position was not set"]);
    assert!(written(&turning).is_empty());
}

#[test]
fn restoring_defaults_is_experimental() {
    let bench = Bench::new();
    let Some(encoder) = bench.gateway(&["--steps=3600"]) else { return };
    let ran = ask(&bench, &encoder, &["do", "interbus", "default", "--yes"]);
    assert!(ran.err.contains("experimental"), "{ran:?}");
    assert_eq!(ran.json()["write_cycles"], json!(1));
    assert_eq!(written(&encoder)[..1], ["W 0E000000"]);
}

/// The mode is not reported as restored if the encoder then sends an error word (issue 22.19).
#[test]
fn encoder_error_fails_mode_restore() {
    let bench = Bench::new();
    let Some(encoder) = bench.gateway(&["--lost"]) else { return };
    let ran = ask(&bench, &encoder, &["do", "interbus", "lead-back"]);
    assert_eq!(ran.status, Some(1), "{ran:?}");
    assert!(ran.out.contains("0x86000000") && ran.err.contains("0x86000000"), "{ran:?}");
    let Some(encoder) = bench.gateway(&[]) else { return };
    assert_eq!(ask(&bench, &encoder, &["do", "interbus", "lead-back"]).json()["done"], json!("lead-back"));
}

/// The profile of a multiturn encoder is rejected for an encoder that does not count turns, unless the user permits it
/// explicitly. The message names the difference (issue 22.9).
#[test]
fn other_type_needs_permission() {
    let bench = Bench::new();
    let parameters = r#"steps: 3600, revolutions: 1, direction: "ccw", preset: 9, zero_shift: 3"#;
    let text = profile("4000", parameters, "").replace(r#""4000")"#, r#""4000", flags: 2)"#);
    let file = bench.write("p.ron", text);
    let Some(encoder) = bench.gateway(&["--steps=3600", "--flags=0"]) else { return };
    for consent in ["--yes", "--dry-run"] {
        let ran = ask(&bench, &encoder, &["restore", &file, consent, "--allow-other-device"]);
        ran.fails(1, &["multiturn", "single turn", "--allow-other-type"]);
    }
    let restore = ["restore", &file, "--allow-other-type"];
    let dry = ask(&bench, &encoder, &[&restore[..], &["--dry-run"]].concat());
    assert!(dry.err.contains("multiturn") && dry.err.contains("single turn"), "{dry:?}");
    assert_eq!((dry.status, written(&encoder)), (Some(0), vec![]));
    // `verify` reports the difference, too.
    let ran = ask(&bench, &encoder, &["verify", &file]);
    assert!(ran.err.contains("single turn"), "{ran:?}");
    // The encoder keeps the values of its mounting.
    assert_eq!(ask(&bench, &encoder, &[&restore[..], &["--yes"]].concat()).json()["written"], json!(1));
    assert_eq!(written(&encoder), ["W 06000004", "STORE parameters"]);
}

#[test]
fn writes_nothing_without_consent() {
    let bench = Bench::new();
    let file = bench.write(
        "p.ron",
        profile("4711", r#"steps: 3600, revolutions: 1, direction: "ccw", preset: 9, zero_shift: 3"#, ""),
    );
    let Some(encoder) = bench.gateway(&["--steps=3600"]) else { return };
    for command in [
        &["write", "interbus", "steps", "100"][..],
        &["restore", &file, "--allow-other-device"],
        &["do", "interbus", "preset"],
        &["do", "interbus", "default"],
    ] {
        ask(&bench, &encoder, command).fails(2, &["--yes"]);
    }
    assert!(encoder.requests().is_empty(), "nothing is even asked");
    ask(&bench, &encoder, &["restore", &file, "--yes"]).fails(1, &["4711", "4000", "--allow-other-device"]);
    assert!(written(&encoder).is_empty());
    let ran = ask(&bench, &encoder, &["restore", &file, "--yes", "--allow-other-device"]);
    assert!(
        ["preset belongs", "zero-shift belongs", "--with-mounting"].iter().all(|own| ran.err.contains(own)),
        "{ran:?}"
    );
    assert_eq!(ran.json()["written"], json!(1));
    assert_eq!(written(&encoder), ["W 06000004", "STORE parameters"]);
    let told = ask(&bench, &encoder, &["restore", &file, "--yes", "--allow-other-device", "--with-mounting"]).json();
    assert_eq!(told["written"], json!(2));
    assert_eq!(written(&encoder), ["W 08000009", "W 0A000003", "STORE parameters"]);
    // The mode is unchanged.
    assert_eq!(ask(&bench, &encoder, &["identify", "interbus"]).json()["mode"], json!("K3"));
}

/// From 150 stores, a warning is printed. Beyond 200, the program asks again. From 450, a write must be forced.
#[test]
fn counts_eeprom_stores() {
    let bench = Bench::new();
    let Some(encoder) = bench.gateway(&["--steps=3600"]) else { return };
    let mut direction = ["ccw", "cw"].into_iter().cycle();
    let mut write = |options: &[&str]| {
        let value = direction.next().unwrap();
        ask(&bench, &encoder, &[&["write", "interbus", "direction", value, "--yes"], options].concat())
    };
    assert_eq!(write(&[]).json()["write_cycles"], json!(1));
    let device = DeviceKey {
        kind: "interbus".to_owned(),
        device_type: "K3".to_owned(),
        serial_number: "4000".to_owned(),
        is_virtual: false,
    };
    let wear_to = |stores: u64| bench.wear_to(&device, stores);
    wear_to(148);
    assert!(!write(&[]).err.contains("write cycles have been counted"));
    let warned = write(&[]);
    assert!(warned.status == Some(0) && warned.err.contains("150 EEPROM write cycles have been counted"), "{warned:?}");
    wear_to(200);
    let told = write(&[]);
    assert!(told.status == Some(0) && told.err.contains("201") && told.err.contains("specifies only 200"), "{told:?}");
    // On a terminal, the program asks about the plan, and a second time beyond 200 stores.
    encoder.requests();
    let typed = ["write", "interbus", "zero-shift", "5", "--link", &encoder.url];
    for no in ["n\n", "y\nn\n"] {
        let ran = run_on_terminal(&bench, &typed, no);
        assert!(ran.status == Some(1) && ran.out.contains("nothing was written"), "{ran:?}");
    }
    assert!(written(&encoder).is_empty());
    let ran = run_on_terminal(&bench, &typed, "y\ny\n");
    assert!(ran.status == Some(0) && ran.out.contains("must be stopped"), "{ran:?}");
    assert_eq!(written(&encoder), ["W 0A000005", "STORE parameters"]);
    wear_to(449);
    encoder.requests();
    let refused = write(&[]);
    refused.fails(1, &["449", "(1)", "450", "--force-wear"]);
    assert!(written(&encoder).is_empty());
    // The value is the same as before, because it was not written.
    let _ = write(&["--force-wear"]);
    assert_eq!(write(&["--force-wear"]).json()["write_cycles"], json!(1));
    assert_eq!(bench.logbook().write_cycles(&device).unwrap(), 450);
}

/// The message states the written values and the backup within the timeout.
#[test]
fn lost_gateway_names_backup() {
    let bench = Bench::new();
    let (_, wanted) = cams(|program, _| (program > 2).then_some((0, 0)));
    let file = bench.write("cams.ron", profile("4000", PARAMETERS, &wanted));
    let restore = ["restore", &file, "--yes"];
    let Some(encoder) = bench.gateway(&["--steps=3600", "--vanish-writing=10"]) else { return };
    let ran = ask(&bench, &encoder, &restore);
    assert_eq!((ran.status, ran.out.as_str()), (Some(1), ""), "{ran:?}");
    assert!(ran.err.contains("backups/interbus/4000") && ran.err.contains("lead-back"), "{ran:?}");
    assert!(!ran.err.contains("panicked") && ran.took.as_secs() < 20, "{ran:?}");
}
