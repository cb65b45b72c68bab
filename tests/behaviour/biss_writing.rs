//! Writes to an independently written kit encoder over its configuration pin and over an adapter.

use encoder_studio::store::DeviceKey;
use serde_json::{Value, json};

use super::biss_profile::PROFILE;
use super::support::{Bench, Foreign, Ran, run_on_terminal};

/// The profile's content of banks 24h and 25h.
const AS_PROFILE: &str = r#"{"0x24:0x00": "000102030405060708090A0B0C0D0E0F101112131415161718191A1B1C1D1E1F202122232425262728292A2B2C2D2E2F303132333435363738393A3B3C3D3E3F", "0x25:0x00": "A1B2C3"}"#;
/// The preset value of the profile: 270°.
const PRESET: &str = "008001000000";

/// Starts the same encoder on each type of connection.
fn both(bench: &Bench, arguments: &[&str]) -> Option<[Foreign; 2]> {
    Some([bench.kit(arguments)?, bench.adapter(arguments)?])
}

fn ask(bench: &Bench, encoder: &Foreign, words: &[&str]) -> Ran {
    bench.run(&[words, &["--link", &encoder.url, "--json"]].concat())
}

/// Returns the registers written since the last call, except for bank selections.
fn written(encoder: &Foreign) -> Vec<String> {
    encoder.registers_written().into_iter().filter(|line| !line.starts_with("0x40 ")).collect()
}

/// Returns the register writes of a save according to reference 5.3: set password and mode, open the OEM data, write
/// the registers, save, return to operation and reset the password.
fn saved(registers: &[&str]) -> Vec<String> {
    let around = (["0x6B 2A", "0x6A 04", "0x00:0x1A 02"], ["0x00:0x1A 03", "0x6A 00", "0x6B 00"]);
    [&around.0[..], registers, &around.1].concat().into_iter().map(str::to_owned).collect()
}

#[test]
fn three_bytes_take_one_save() {
    let bench = Bench::new();
    let Some(encoders) = both(&bench, &["--data", AS_PROFILE, "--preset", PRESET]) else { return };
    let wanted = PROFILE.replace("[\"00 01 02", "[\"00 A1 A2").replace("0E 0F\"", "0E EE\"");
    let file = bench.write("wanted.ron", wanted);
    for encoder in &encoders {
        let dry = ask(&bench, encoder, &["restore", &file, "--dry-run"]).json();
        assert_eq!(written(encoder), [""; 0]);
        let expected = json!([
            {"item": "0x24:0x01+2", "old": "0102", "new": "A1A2", "write_cycles": 0},
            {"item": "0x24:0x0F", "old": "0F", "new": "EE", "write_cycles": 0},
            {"item": "OEM data", "old": null, "new": "saved", "write_cycles": 1},
        ]);
        assert_eq!((&dry["operations"], &dry["write_cycles"]), (&expected, &json!(1)), "{dry}");
        let told = ask(&bench, encoder, &["restore", &file, "--yes"]).json();
        assert_eq!((&told["written"], &told["verified"], &told["write_cycles"]), (&json!(3), &json!(3), &json!(1)));
        // Everything else is unchanged: the other data registers, the filter and the preset value.
        assert!(told["unchanged"].as_u64() >= Some(4096 - 3), "{told}");
        assert_eq!(written(encoder), saved(&["0x24:0x01 A1", "0x24:0x02 A2", "0x24:0x0F EE"]));
        assert_eq!(ask(&bench, encoder, &["verify", &file]).json()["equal"], json!(true));

        // The backup is a profile, and restoring it restores the previous content.
        let backup = told["backup"].as_str().unwrap();
        let undone = ask(&bench, encoder, &["restore", backup, "--yes"]).json();
        assert_eq!((&undone["written"], &undone["write_cycles"]), (&json!(3), &json!(1)));
        let there = ask(&bench, encoder, &["read", "biss", "0x24:0x00+16"]).json();
        assert_eq!(there["value"], json!("000102030405060708090A0B0C0D0E0F"));
        // When the restore is repeated, nothing differs, so nothing is sent and no backup is stored.
        written(encoder);
        let again = ask(&bench, encoder, &["restore", backup, "--yes"]).json();
        assert_eq!((&again["written"], &again["write_cycles"], &again["backup"]), (&json!(0), &json!(0), &Value::Null));
        assert_eq!(written(encoder), [""; 0]);
    }
}

#[test]
fn write_stores_exact_bytes() {
    let bench = Bench::new();
    let Some(encoders) = both(&bench, &["--data", AS_PROFILE]) else { return };
    for encoder in &encoders {
        let told = ask(&bench, encoder, &["write", "biss", "0x25:0x10", "0x5A", "--yes"]).json();
        assert_eq!(
            (&told["item"], &told["written"], &told["write_cycles"]),
            (&json!("0x25:0x10"), &json!(1), &json!(1))
        );
        assert_eq!(written(encoder), saved(&["0x25:0x10 5A"]));
        // Only the changed registers of a contiguous range are sent.
        let told = ask(&bench, encoder, &["write", "biss", "0x25:0x00+4", "A1 00 C3 01", "--yes"]).json();
        assert_eq!((&told["written"], &told["write_cycles"]), (&json!(2), &json!(1)));
        assert_eq!(written(encoder), saved(&["0x25:0x01 00", "0x25:0x03 01"]));
        let told = ask(&bench, encoder, &["write", "biss", "0x25:0x10", "90", "--yes"]).json();
        assert_eq!((&told["written"], &told["backup"]), (&json!(0), &Value::Null), "5Ah is there already");
        assert_eq!(written(encoder), [""; 0]);
        assert_eq!(ask(&bench, encoder, &["read", "biss", "0x25:0x00+4"]).json()["value"], json!("A100C301"));
        assert_eq!(ask(&bench, encoder, &["read", "biss", "0x6A"]).json()["value"], json!(0), "operation");
        // Motor data are opened with a different command.
        ask(&bench, encoder, &["write", "biss", "0x04:0x00", "1", "--yes"]).json();
        assert!(written(encoder).contains(&"0x00:0x1A 01".to_owned()));
    }
}

/// A restore stores the filter and the preset value, but does not execute a preset (reference 5.4 and 5.5).
#[test]
fn restore_does_not_execute_preset() {
    let bench = Bench::new();
    let Some(encoders) = both(&bench, &["--data", AS_PROFILE, "--filter", "4"]) else { return };
    let file = bench.write("p.ron", PROFILE);
    for encoder in &encoders {
        let told = ask(&bench, encoder, &["restore", &file, "--yes"]).json();
        assert_eq!((&told["written"], &told["verified"], &told["write_cycles"]), (&json!(2), &json!(2), &json!(2)));
        let lines = written(encoder);
        assert!(lines.contains(&"0x00:0x24 03".to_owned()) && lines.contains(&"0x00:0x24 02".to_owned()), "{lines:?}");
        assert!(lines.contains(&"0x01:0x00 03".to_owned()), "stored: {lines:?}");
        let fires = ["0x01:0x00 01", "0x01:0x00 04", "0x01:0x00 05"];
        assert!(lines.iter().all(|line| !fires.contains(&line.as_str())), "carried out: {lines:?}");
        assert_eq!(ask(&bench, encoder, &["verify", &file]).json()["equal"], json!(true));
        let position = ask(&bench, encoder, &["position", "biss"]).json();
        assert_eq!((&position["turns"], &position["steps"]), (&json!(0x1234), &json!(98_304)), "where it was");
        let password = ask(&bench, encoder, &["read", "biss", "0x6A+2"]).json();
        assert_eq!(password["value"], json!("0000"), "operation, and no password");
    }
}

#[test]
fn restore_keeps_mounting_of_other_encoder() {
    let bench = Bench::new();
    let Some(encoder) = bench.kit(&["--serial-number", "7", "--data", AS_PROFILE]) else { return };
    let file = bench.write("p.ron", PROFILE);
    for consent in ["--yes", "--dry-run"] {
        let refused = ask(&bench, &encoder, &["restore", &file, consent]);
        refused.fails(1, &["12345678", "7", "--allow-other-device"]);
    }
    assert_eq!(written(&encoder), [""; 0]);
    let left = ask(&bench, &encoder, &["restore", &file, "--yes", "--allow-other-device"]);
    assert!(left.err.contains("0x01:0x02+6") && left.err.contains("--with-mounting"), "{left:?}");
    assert_eq!(left.json()["written"], json!(0));
    let with = ["restore", &file, "--yes", "--allow-other-device", "--with-mounting"];
    assert_eq!(ask(&bench, &encoder, &with).json()["written"], json!(1));
    let value = ask(&bench, &encoder, &["read", "biss", "0x01:0x02+6"]).json();
    assert_eq!(value["value"], json!(PRESET));
}

/// The message names the other type, and the restore is rejected unless the user permits it explicitly (issue 22.9).
#[test]
fn other_type_needs_permission() {
    let bench = Bench::new();
    let Some(encoder) = bench.kit(&[]) else { return };
    let types = ["01 01 68 11 00 01", "01 01 68 11 00 02"];
    let file = bench.write("p.ron", PROFILE.replace(types[0], types[1]));
    for consent in ["--yes", "--dry-run"] {
        let ran = ask(&bench, &encoder, &["restore", &file, consent, "--allow-other-device"]);
        ran.fails(1, &[types[0], types[1], "--allow-other-type"]);
    }
    let dry = ask(&bench, &encoder, &["restore", &file, "--dry-run", "--allow-other-type"]);
    assert!(types.iter().all(|own| dry.err.contains(own)), "{dry:?}");
    assert_eq!((dry.status, written(&encoder)), (Some(0), vec![]));
    let other = bench.file("hiperface.ron");
    assert_eq!(bench.run(&["save", "hiperface", "--link", "sim:", "-o", &other]).status, Some(0));
    // The file names the kind of device, so the program looks for a HIPERFACE encoder, which does not answer.
    ask(&bench, &encoder, &["restore", &other, "--dry-run"]).fails(1, &[]);
    assert_eq!(encoder.requests(), [""; 0]);
}

#[test]
fn writes_nothing_without_consent() {
    let bench = Bench::new();
    let Some(encoder) = bench.kit(&[]) else { return };
    let file = bench.write("p.ron", PROFILE);
    let commands: [&[&str]; 7] = [
        &["write", "biss", "0x24:0x00", "1"],
        &["restore", &file],
        &["do", "biss", "calibrate"],
        &["do", "biss", "wiegand-test", "save"],
        &["do", "biss", "filter", "dynamic"],
        &["do", "biss", "preset"],
        &["do", "biss", "mounting"],
    ];
    for command in commands {
        ask(&bench, &encoder, command).fails(2, &["--yes"]);
    }
    assert_eq!(encoder.requests(), [""; 0]);
}

#[test]
fn rejects_unwritable_values() {
    let bench = Bench::new();
    let Some(encoder) = bench.kit(&[]) else { return };
    let cases: [(i32, &[&str], &[&str]); 16] = [
        (1, &["write", "biss", "0x24:0x00", "256"], &["0 to 255"]),
        (1, &["write", "biss", "0x24:0x00", "-1"], &["0 to 255"]),
        (1, &["write", "biss", "0x66", "1"], &["0x66"]),
        (1, &["write", "biss", "0x02:0x00", "1"], &["0x02:0x00"]),
        (1, &["write", "biss", "0x6A", "4"], &["0x6A"]),
        (1, &["write", "biss", "0x00:0x1A", "1"], &["0x00:0x1A"]),
        (2, &["write", "biss", "0x24:0x40", "1"], &["0x24:0x40"]),
        (2, &["write", "biss", "colour", "1"], &["colour", "0x24:0x10"]),
        (2, &["write", "biss", "0x24:0x00", "blue"], &["blue", "number"]),
        (2, &["write", "biss", "0x24:0x00+2", "AA"], &["2 bytes", "1"]),
        (2, &["write", "biss", "0x24:0x00+2", "XX YY"], &["hex"]),
        (2, &["do", "biss", "filter", "fast"], &["balanced or dynamic"]),
        (2, &["do", "biss", "create-field", "1", "16"], &["create-field", "calibrate"]),
        (1, &["do", "biss", "preset", "131072"], &["131071"]),
        (1, &["do", "biss", "preset", "0", "-1"], &["0 to"]),
        (2, &["do", "biss", "preset", "north"], &["north"]),
    ];
    for (status, command, words) in cases {
        ask(&bench, &encoder, &[command, &["--yes"]].concat()).fails(status, words);
    }
    assert_eq!(written(&encoder), [""; 0]);
    bench.run(&["do", "hiperface", "calibrate", "--link", "sim:", "--yes"]).fails(2, &["calibrate", "set-position"]);
    bench.run(&["do", "biss", "calibrate", "--link", "sim:", "--yes", "--timeout", "0"]).fails(2, &["timeout"]);
    for option in ["--exact", "--kit"] {
        bench.run(&["do", "biss", "check", "--link", "sim:", option]).fails(2, &[option, "biss"]);
    }
    bench.run(&["do", "hiperface", "reset", "--link", "sim:", "--timeout", "5"]).fails(2, &["--timeout", "hiperface"]);
}

#[test]
fn does_not_write_data_while_shaft_turns() {
    let bench = Bench::new();
    let Some(encoder) = bench.kit(&["--rpm", "30"]) else { return };
    ask(&bench, &encoder, &["write", "biss", "0x24:0x00", "1", "--yes"]).fails(1, &["Stop the shaft"]);
    assert_eq!(written(&encoder), [""; 0]);
}

/// The filter is set as in the reference. A preset sets the whole position, the singleturn or the multiturn.
#[test]
fn filter_and_preset_are_actions() {
    let bench = Bench::new();
    let Some(encoders) = both(&bench, &[]) else { return };
    for encoder in &encoders {
        let told = ask(&bench, encoder, &["do", "biss", "filter", "dynamic", "--yes"]).json();
        assert_eq!((&told["write_cycles"], &told["results"][0]["filter"]), (&json!(1), &json!("dynamic")), "{told}");
        assert_eq!(ask(&bench, encoder, &["read", "biss", "0x6E"]).json()["value"], json!(4));

        let place = |encoder: &Foreign| {
            let told = ask(&bench, encoder, &["position", "biss"]).json();
            (told["turns"].as_u64().unwrap(), told["steps"].as_u64().unwrap())
        };
        let preset = |words: &[&str]| {
            let told = ask(&bench, encoder, &[&["do", "biss", "preset"], words, &["--yes"]].concat()).json();
            told["write_cycles"].as_u64().unwrap()
        };
        // The preset of 270° and turn 5 is stored first and executed afterwards.
        assert_eq!(preset(&["98304", "5"]), 2);
        assert_eq!(place(encoder), (5, 98_304));
        // The preset is already stored. Only the shaft has moved since, so nothing needs to be stored.
        assert_eq!(preset(&[]), 1);
        assert_eq!(preset(&["1000", "singleturn"]), 2);
        assert_eq!(place(encoder), (5, 1000), "the turn stays");
        assert_eq!(preset(&["7", "9", "multiturn"]), 2);
        assert_eq!(place(encoder), (9, 1000), "the place within the turn stays");
        assert_eq!(preset(&["0"]), 2);
        assert_eq!(place(encoder), (0, 0));
    }
}

/// The flash is rated for 1000 write cycles (manual 6.1). A warning is printed from 800 cycles. Beyond 1000, a write
/// must be forced.
#[test]
fn worn_flash_needs_force() {
    let bench = Bench::new();
    let write = |more: &[&str]| {
        let words = ["do", "biss", "preset", "98304", "0", "--yes", "--link", "sim:", "--json"];
        bench.run(&[&words[..], more].concat())
    };
    let first = write(&[]);
    assert_eq!((first.json()["write_cycles"].as_u64(), first.err.contains("write cycles")), (Some(2), false));
    let device = DeviceKey {
        kind: "biss".to_owned(),
        device_type: "4672-010168110001".to_owned(),
        serial_number: "1234567".to_owned(),
        is_virtual: true,
    };
    let wear_to = |cycles: u64| bench.wear_to(&device, cycles);
    wear_to(798);
    write(&[]).assert_stderr(&["at least 800 of its 1000"]);
    wear_to(999);
    write(&[]).fails(1, &["999", "(2)", "1000", "--force-wear"]);
    assert_eq!(write(&["--force-wear"]).json()["write_cycles"], json!(2));
    assert_eq!(bench.logbook().write_cycles(&device).unwrap(), 1001);
}

/// The connection is lost once while reading and at three points while writing.
#[test]
fn lost_link_names_backup() {
    let bench = Bench::new();
    let file = bench.write("p.ron", PROFILE);
    let Some(whole) = bench.kit(&[]) else { return };
    let restore = ["restore", &file, "--yes"];
    assert_eq!(ask(&bench, &whole, &restore).status, Some(0));
    let accesses = whole.requests();
    let begins = accesses.iter().position(|line| line == "W 0x6B 2A").unwrap();
    let third = (accesses.len() - begins) / 3;
    for after in [begins / 2, begins + 1, begins + third, begins + 2 * third] {
        let Some(encoder) = bench.kit(&["--silent-after", &after.to_string()]) else { return };
        let ran = ask(&bench, &encoder, &restore);
        assert_eq!((ran.status, ran.out.as_str()), (Some(1), ""), "cut after {after}: {ran:?}");
        let backup = ran.err.contains("backups/biss/12345678");
        assert_eq!(backup, after > begins, "cut after {after}, writing begins after {begins}: {ran:?}");
    }
}

/// Registers that were written but never saved are reported, and a comparison does not show them as the encoder's
/// content. Only `lead-back` restores the mode (issue 22.15).
#[test]
fn compare_ignores_unsaved_registers() {
    let bench = Bench::new();
    let Some(encoders) = both(&bench, &["--data", AS_PROFILE, "--preset", PRESET, "--left-in", "4"]) else { return };
    let file = bench.write("p.ron", PROFILE);
    for encoder in &encoders {
        for compares in [vec!["verify", &file], vec!["diff", &file]] {
            let ran = ask(&bench, encoder, &compares);
            assert_eq!((ran.status, ran.out.as_str()), (Some(1), ""), "{ran:?}");
            assert!(ran.err.contains("device mode 0x04") && ran.err.contains("do biss lead-back --yes"), "{ran:?}");
        }
        let read = ask(&bench, encoder, &["read", "biss", "0x24:0x01"]);
        read.assert_stderr(&["device mode 0x04", "never saved", "lead-back"]);
        assert_eq!((read.status, &read.json()["value"]), (Some(0), &json!(1)));
        let saved = bench.file("saved.ron");
        let ran = ask(&bench, encoder, &["save", "biss", "-o", &saved]);
        ran.assert_stderr(&["device mode 0x04", "never saved"]);
        assert_eq!(ran.json()["unsaved_in_mode"], json!(4));
        assert!(bench.read("saved.ron").contains("device_mode: 0x04"));
        assert_eq!(written(encoder), [""; 0], "reading leads nothing back");
        assert_eq!(ask(&bench, encoder, &["do", "biss", "lead-back", "--yes"]).json()["mode"], json!(4));
        assert_eq!(ask(&bench, encoder, &["verify", &file]).json()["equal"], json!(true));
        let ran = ask(&bench, encoder, &["verify", &saved]);
        ran.assert_stderr(&["saved.ron", "device mode 0x04"]);
        assert_eq!(ran.json()["equal"], json!(true));
    }
}

/// The adapter's supply is restored when the program exits (issue 22.16).
#[test]
fn restores_adapter_supply_on_exit() {
    let bench = Bench::new();
    let Some(adapter) = bench.adapter(&["--supply", "off"]) else { return };
    let supplied = |parameters: &str| -> Vec<String> {
        let url = format!("{}?voltage=5{parameters}", adapter.url);
        let ran = bench.run(&["read", "biss", "0x66", "--json", "--link", &url]);
        assert_eq!(ran.json()["value"], json!(80), "{ran:?}");
        adapter.requests().into_iter().filter(|line| line.starts_with("S ")).collect()
    };
    assert_eq!(supplied(""), ["S 5000", "S off"]);
    assert_eq!(supplied("&leave-supply=on"), ["S 5000"]);
    assert_eq!(supplied(""), ["S 5000"], "it was on before");
    assert_eq!(supplied("&leave-supply=off"), ["S 5000", "S off"]);
    let url = format!("{}?voltage=5&leave-supply=no", adapter.url);
    bench.run(&["read", "biss", "0x66", "--link", &url]).fails(2, &["leave-supply=no", "as-found, on or off"]);
}

/// The mode and password set by another host are reset (reference 5).
#[test]
fn returns_encoder_to_operation() {
    let bench = Bench::new();
    let Some(encoders) = both(&bench, &["--left-in", "4"]) else { return };
    for encoder in &encoders {
        assert_eq!(ask(&bench, encoder, &["status", "biss"]).json()["mode"], json!(4));
        ask(&bench, encoder, &["write", "biss", "0x24:0x00", "1", "--yes"]).fails(1, &["lead-back"]);
        let told = ask(&bench, encoder, &["do", "biss", "lead-back"]).json();
        assert_eq!(told["mode"], json!(4));
        assert_eq!(ask(&bench, encoder, &["read", "biss", "0x6A+2"]).json()["value"], json!("0000"));
        assert_eq!(ask(&bench, encoder, &["do", "biss", "lead-back"]).json()["mode"], json!(0), "again");
    }
}

/// Restoring the mode discards unsaved changes, so the program asks for confirmation on a terminal unless `--yes` was
/// given. Scripts need no `--yes`, because nothing is stored (issue 22.15).
#[test]
fn terminal_confirms_return_to_operation() {
    let bench = Bench::new();
    let Some(encoder) = bench.kit(&[]) else { return };
    let lead_back = ["do", "biss", "lead-back", "--link", &encoder.url];
    for no in ["n\n", "\n"] {
        let ran = run_on_terminal(&bench, &lead_back, no);
        assert!(
            ran.status == Some(1) && ran.out.contains("not saved") && ran.out.contains("was not changed"),
            "{ran:?}"
        );
    }
    assert_eq!(encoder.requests(), [""; 0]);
    assert_eq!(run_on_terminal(&bench, &lead_back, "y\n").status, Some(0));
    assert_eq!(run_on_terminal(&bench, &[&lead_back[..], &["--yes"]].concat(), "").status, Some(0));
    assert_eq!(bench.run(&lead_back).status, Some(0));
}
