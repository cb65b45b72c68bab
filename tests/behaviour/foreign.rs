//! An independently written encoder on a real pseudo-terminal: reading, saving, comparing, restoring and verifying.

use serde_json::{Value, json};

use super::support::{Bench, Foreign, frame};

/// Two data fields: 32 writable bytes with code 0 and 16 protected ones with code 2.
const FIELDS: &str = r#"[{"status":"C9","bytes":"0815"},{"status":"A8","bytes":"01"}]"#;

fn save(bench: &Bench, encoder: &Foreign, file: &str) -> String {
    let file = bench.file(file);
    let ran = bench.run(&["save", "hiperface", "--link", &encoder.url, "-o", &file]);
    assert_eq!(ran.status, Some(0), "{ran:?}");
    encoder.requests();
    file
}

#[test]
fn identify_prints_every_key() {
    let bench = Bench::new();
    let Some(encoder) = bench.encoder(&["--fields", FIELDS]) else { return };
    let told = bench.run(&["identify", "hiperface", "--link", &encoder.url, "--json"]).json();
    let expected = json!({
        "device": "hiperface", "address": 0x40, "encoder_type": 0x37, "encoder_name": "SKM36",
        "serial_number": "GB0450179", "firmware_version": "V1.23", "firmware_date": "01.02.16",
        "eeprom_bytes": 2048, "free_bytes": (112 - 3) * 16, "data_fields": 2, "baud": 9600, "parity": "even",
    });
    for (key, value) in expected.as_object().unwrap() {
        assert_eq!(&told[key], value, "{key}");
    }
    let text = bench.run(&["identify", "hiperface", "--link", &encoder.url]);
    assert!(text.out.contains("GB0450179") && text.out.contains("SKM36"), "{text:?}");
}

#[test]
fn uses_address_and_baud_rate_of_link() {
    let bench = Bench::new();
    let Some(encoder) = bench.encoder(&["--address", "45"]) else { return };
    let url = format!("{}?address=0x45&baud=19200&parity=none", encoder.url);
    let told = bench.run(&["identify", "hiperface", "--link", &url, "--json"]).json();
    assert_eq!((&told["address"], &told["baud"], &told["parity"]), (&json!(0x45), &json!(19200), &json!("none")));
}

#[test]
fn position_has_turns_steps_and_degrees() {
    let bench = Bench::new();
    let Some(encoder) = bench.encoder(&[]) else { return };
    let ran =
        bench.run(&["position", "hiperface", "--link", &encoder.url, "--json", "--count", "3", "--interval", "0"]);
    assert_eq!(ran.status, Some(0), "{ran:?}");
    let lines: Vec<Value> = ran.out.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!(lines.len(), 3);
    for line in &lines {
        // An SKM36 at position 000E0531h is at turn E0h, step 1329 of 4096.
        assert_eq!((&line["raw"], &line["turns"], &line["steps"]), (&json!(918_833), &json!(224), &json!(1329)));
        assert!((line["degrees"].as_f64().unwrap() - 116.806_641).abs() < 1e-5, "{line}");
        assert_eq!(line["valid"], json!(true));
    }
    assert!(lines[0]["t_s"].as_f64() < lines[2]["t_s"].as_f64());
}

#[test]
fn reads_single_values() {
    let bench = Bench::new();
    let Some(encoder) = bench.encoder(&["--fields", FIELDS, "--counter", "0x012345"]) else { return };
    let cases = [
        ("field:0@0+2", json!("0815")),
        ("field:0@30", json!("FFFF")),
        ("field:1@0+1", json!("01")),
        ("analogue:0x48", json!(42)),
        ("counter", json!(0x01_2345)),
        ("address", json!(0x40)),
        ("settings", json!(0xE4)),
    ];
    for (item, value) in cases {
        let told = bench.run(&["read", "hiperface", item, "--link", &encoder.url, "--json"]).json();
        assert_eq!((told["item"].as_str(), &told["value"]), (Some(item), &value));
    }
    let whole = bench.run(&["read", "hiperface", "field:0", "--link", &encoder.url, "--json"]).json();
    assert_eq!(whole["value"], json!(format!("0815{}", "FF".repeat(30))));
}

#[test]
fn write_stores_exact_bytes() {
    let bench = Bench::new();
    let Some(encoder) = bench.encoder(&["--fields", FIELDS]) else { return };
    let arguments = ["write", "hiperface", "field:0@3+2", "aabb", "--link", &encoder.url, "--yes", "--json"];
    let told = bench.run(&arguments).json();
    assert_eq!((&told["written"], &told["write_cycles"]), (&json!(2), &json!(1)));
    assert_eq!(encoder.writes(), [frame("40 4B 00 03 02 55 AA BB")]);
    assert_eq!(encoder.host_address(&["40 4A 00 02 04 55"]), [frame("40 4A 00 02 04 FF AA BB FF")]);
    // When the restore is repeated, nothing differs, and nothing is sent.
    encoder.requests();
    assert_eq!(bench.run(&arguments).json()["write_cycles"], json!(0));
    assert_eq!(encoder.writes(), [""; 0]);
}

#[test]
fn restores_changes_by_another_host() {
    let bench = Bench::new();
    let Some(encoder) = bench.encoder(&["--fields", FIELDS]) else { return };
    let file = save(&bench, &encoder, "as-saved.ron");
    let link = ["--link", &encoder.url, "--json"];
    let equal = bench.run(&[&["verify", &file], &link[..]].concat()).json();
    assert_eq!((&equal["equal"], &equal["differences"], &equal["missing"]), (&json!(true), &json!([]), &json!([])));
    assert!(equal["compared"].as_u64() >= Some(48));

    encoder.host_address(&["40 4B 00 03 02 55 AA BB", "40 4B 00 1F 01 55 00"]);
    let differences = json!([
        {"item": "field:0@3+2", "left": "FFFF", "right": "AABB"},
        {"item": "field:0@31+1", "left": "FF", "right": "00"},
    ]);
    for command in ["diff", "verify"] {
        let told = bench.run(&[&[command, &file], &link[..]].concat()).json_with_status(3);
        assert_eq!((&told["equal"], &told["differences"]), (&json!(false), &differences), "{command}");
    }
    encoder.requests();
    let told = bench.run(&[&["restore", &file, "--yes"], &link[..]].concat()).json();
    assert_eq!((&told["written"], &told["verified"], &told["write_cycles"]), (&json!(3), &json!(3), &json!(2)));
    assert!(told["unchanged"].as_u64() >= Some(45), "{told}");
    assert_eq!(encoder.writes(), [frame("40 4B 00 03 02 55 FF FF"), frame("40 4B 00 1F 01 55 FF")]);
    assert_eq!(bench.run(&[&["verify", &file], &link[..]].concat()).json()["equal"], json!(true));

    // The backup is a profile, and restoring it restores the foreign bytes.
    let backup = told["backup"].as_str().unwrap();
    let undone = bench.run(&[&["restore", backup, "--yes"], &link[..]].concat()).json();
    assert_eq!(undone["written"], json!(3));
    assert_eq!(encoder.host_address(&["40 4A 00 03 02 55"]), [frame("40 4A 00 03 02 AA BB")]);
}

#[test]
fn equal_values_write_nothing() {
    let bench = Bench::new();
    let Some(encoder) = bench.encoder(&["--fields", FIELDS]) else { return };
    let file = save(&bench, &encoder, "p.ron");
    let told = bench.run(&["restore", &file, "--yes", "--link", &encoder.url, "--json"]).json();
    assert_eq!((&told["written"], &told["write_cycles"], &told["backup"]), (&json!(0), &json!(0), &Value::Null));
    assert_eq!(encoder.writes(), [""; 0]);
}

#[test]
fn compares_files_offline() {
    let bench = Bench::new();
    let Some(encoder) = bench.encoder(&["--fields", FIELDS]) else { return };
    let left = save(&bench, &encoder, "left.ron");
    let right = bench.write("right.ron", bench.read("left.ron").replace("\"08 15", "\"08 16"));
    let told = bench.run(&["diff", &left, &right, "--json"]).json_with_status(3);
    assert_eq!(told["differences"], json!([{"item": "field:0@1+1", "left": "15", "right": "16"}]));
    let text = bench.run(&["diff", &left, &right]);
    assert_eq!(text.status, Some(3));
    assert!(text.out.contains("field:0@1+1"), "{text:?}");
    assert_eq!(bench.run(&["diff", &left, &left, "--json"]).json()["equal"], json!(true));
    assert_eq!(encoder.requests(), [""; 0]);
}

#[test]
fn dry_run_prints_plan_and_writes_nothing() {
    let bench = Bench::new();
    let Some(encoder) = bench.encoder(&["--fields", FIELDS]) else { return };
    save(&bench, &encoder, "p.ron");
    let text = bench.read("p.ron").replace("\"08 15 FF", "\"08 16 00").replace("\"01 FF", "\"02 FF");
    let file = bench.write("wanted.ron", text);
    let dry = bench.run(&["restore", &file, "--dry-run", "--link", &encoder.url, "--json"]).json();
    assert_eq!(encoder.writes(), [""; 0]);
    // Unlocking, writing and locking of the protected field are listed with their cost.
    let expected = [
        ("field:0@1+2", "15FF", "1600"),
        ("status:1", "A8", "E8"),
        ("field:1@0+1", "01", "02"),
        ("status:1", "E8", "A8"),
    ];
    let shown = dry["operations"].as_array().unwrap();
    assert_eq!(shown.len(), expected.len(), "{dry}");
    for (operation, (item, old, new)) in shown.iter().zip(expected) {
        assert_eq!(operation["item"], json!(item));
        assert!(operation["old"].as_str().unwrap().starts_with(old), "{operation}");
        assert!(operation["new"].as_str().unwrap().starts_with(new), "{operation}");
    }
    assert_eq!(dry["write_cycles"], json!(4));
    let words = bench.run(&["restore", &file, "--dry-run", "--link", &encoder.url]).out;
    assert_eq!(words.lines().take(4).filter(|line| line.contains('→')).count(), 4, "{words}");

    let told = bench.run(&["restore", &file, "--yes", "--link", &encoder.url, "--json"]).json();
    assert_eq!(told["write_cycles"], json!(4));
    let sent = ["40 4B 00 01 02 55 16 00", "40 4D 01 E8 55", "40 4B 01 00 01 55 02", "40 4D 01 A8 55"].map(frame);
    assert_eq!(encoder.writes(), sent);
    assert_eq!(bench.run(&["verify", &file, "--link", &encoder.url, "--json"]).json()["equal"], json!(true));
}

#[test]
fn creates_missing_and_keeps_surplus_fields() {
    let bench = Bench::new();
    let Some(two) = bench.encoder(&["--fields", FIELDS]) else { return };
    let Some(none) = bench.encoder(&[]) else { return };
    let with_two = save(&bench, &two, "two.ron");
    let with_none = save(&bench, &none, "none.ron");

    let told = bench.run(&["diff", &with_two, "--link", &none.url, "--json"]).json_with_status(3);
    assert_eq!((&told["equal"], &told["missing"]), (&json!(false), &json!(["field:0", "field:1"])));
    none.requests();
    bench.run(&["restore", &with_two, "--yes", "--link", &none.url, "--json"]).json();
    let writes = none.writes();
    let created: Vec<&String> = writes.iter().filter(|frame| frame.starts_with("40 4D")).collect();
    assert_eq!(created, [&frame("40 4D 00 C9 55"), &frame("40 4D 01 E8 55"), &frame("40 4D 01 A8 55")]);
    assert_eq!(bench.run(&["verify", &with_two, "--link", &none.url, "--json"]).json()["equal"], json!(true));

    let told = bench.run(&["restore", &with_none, "--yes", "--link", &two.url, "--json"]);
    assert!(told.err.contains("field:0") && told.err.contains("field:1"), "{told:?}");
    assert_eq!(told.json()["missing"], json!(["field:0", "field:1"]));
    assert_eq!(two.writes(), [""; 0]);
}

#[test]
fn resizes_only_last_field_by_default() {
    let bench = Bench::new();
    let Some(encoder) = bench.encoder(&["--fields", FIELDS]) else { return };
    let Some(other) = bench.encoder(&["--fields", r#"[{"status":"C8","bytes":"0815"},{"status":"A9"}]"#]) else {
        return;
    };
    let file = save(&bench, &other, "other.ron");
    let refused = bench.run(&["restore", &file, "--yes", "--link", &encoder.url, "--json"]);
    refused.fails(1, &["32", "16", "--recreate"]);
    assert_eq!(encoder.writes(), [""; 0]);
    bench.run(&["restore", &file, "--yes", "--recreate", "--link", &encoder.url, "--json"]).json();
    assert_eq!(bench.run(&["diff", &file, "--link", &encoder.url, "--json"]).json()["equal"], json!(true));
}

#[test]
fn detects_echoing_converter() {
    let bench = Bench::new();
    let Some(encoder) = bench.encoder(&["--echo", "--fields", FIELDS]) else { return };
    for echo in ["", "?echo=auto", "?echo=on"] {
        let url = format!("{}{echo}", encoder.url);
        let told = bench.run(&["identify", "hiperface", "--link", &url, "--json"]).json();
        assert_eq!((&told["serial_number"], &told["data_fields"]), (&json!("GB0450179"), &json!(2)), "{echo}");
        let told = bench.run(&["read", "hiperface", "field:0@0+2", "--link", &url, "--json"]).json();
        assert_eq!(told["value"], json!("0815"), "{echo}");
    }
    // The reply to 47h equals its request. That alone does not prove that the line echoes, so another request is made
    // first.
    for action in [&["increment-counter", "--yes"][..], &["configure-for-now", "0xE4"][..]] {
        encoder.requests();
        let ran = bench.run(&[&["do", "hiperface", "--link", &encoder.url], action].concat());
        assert_eq!(ran.status, Some(0), "{ran:?}");
        let first = encoder.requests().first().cloned().unwrap_or_default();
        assert!(!first.starts_with("40 47") && !first.starts_with("40 67"), "{first}");
    }
    let counter = bench.run(&["read", "hiperface", "counter", "--link", &encoder.url, "--json"]).json();
    assert_eq!(counter["value"], json!(1));
}

#[test]
fn reading_writes_nothing() {
    let bench = Bench::new();
    let Some(encoder) = bench.encoder(&["--fields", FIELDS]) else { return };
    let file = save(&bench, &encoder, "p.ron");
    let commands: [&[&str]; 7] = [
        &["identify", "hiperface"],
        &["status", "hiperface"],
        &["position", "hiperface"],
        &["read", "hiperface", "field:0"],
        &["diff", &file],
        &["verify", &file],
        &["restore", &file, "--dry-run"],
    ];
    for command in commands {
        let ran = bench.run(&[command, &["--link", &encoder.url]].concat());
        assert_eq!(ran.status, Some(0), "{ran:?}");
        assert_eq!(encoder.writes(), [""; 0], "{command:?}");
    }
}
