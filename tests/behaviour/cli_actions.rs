//! Actions on an independently written encoder, checked frame by frame, and encoders with unusual properties.

use serde_json::{Value, json};

use super::support::{Bench, Foreign, Ran, frame};

fn act(bench: &Bench, encoder: &Foreign, arguments: &[&str]) -> Ran {
    encoder.requests();
    bench.run(&[&["do", "hiperface"], arguments, &["--link", &encoder.url, "--yes", "--json"]].concat())
}

#[test]
fn data_field_lifecycle() {
    let bench = Bench::new();
    let Some(encoder) = bench.encoder(&["--fields", r#"[{"status":"C9","bytes":"0815"}]"#]) else { return };
    let steps: [(&[&str], &str); 7] = [
        // Creates field 1 of the manual's example. Its access code is required, as the manual's text demands.
        (&["create-field", "1", "16", "code=2"], "40 4D 01 E8 55"),
        (&["lock-field", "1"], "40 4D 01 A8 55"),
        (&["unlock-field", "1"], "40 4D 01 E8 55"),
        (&["resize-field", "1", "32"], "40 4D 01 E9 55"),
        (&["delete-field", "1"], "40 4D 01 69 55"),
        (&["create-field", "1", "0xE0"], "40 4D 01 E0 55"),
        (&["delete-field", "1"], "40 4D 01 60 55"),
    ];
    for (arguments, sent) in steps {
        act(&bench, &encoder, arguments).json();
        assert_eq!(encoder.writes(), [frame(sent)], "{arguments:?}");
    }
    act(&bench, &encoder, &["create-field", "3", "16"]).fails(1, &["1", "3"]);
    act(&bench, &encoder, &["create-field", "1", "20"]).fails(1, &["16 to 128"]);
    act(&bench, &encoder, &["delete-field", "7"]).fails(1, &["7", "0 to 0"]);
    act(&bench, &encoder, &["lock-field", "0"]).json();
    let protected = bench.run(&["write", "hiperface", "field:0", "00", "--yes", "--link", &encoder.url, "--json"]);
    encoder.requests();
    protected.fails(1, &["write protected", "unlock-field 0"]);
    assert_eq!(encoder.writes(), [""; 0]);
}

#[test]
fn memory_cannot_be_overfilled() {
    let bench = Bench::new();
    let Some(encoder) = bench.encoder(&["--blocks", "2"]) else { return };
    act(&bench, &encoder, &["create-field", "0", "48"]).fails(1, &["48", "32"]);
    assert_eq!(encoder.writes(), [""; 0]);
}

#[test]
fn sets_position_in_phase_or_exactly() {
    let bench = Bench::new();
    let Some(encoder) = bench.encoder(&[]) else { return };
    act(&bench, &encoder, &["set-position", "4096"]).json();
    let sent = encoder.writes();
    assert_eq!(sent.len(), 1, "{sent:?}");
    let bytes: Vec<u32> = sent[0].split(' ').map(|byte| u32::from_str_radix(byte, 16).unwrap()).collect();
    let set = bytes[2..6].iter().fold(0, |word, byte| word << 8 | byte);
    // The five lowest bits are those of the sine signal, here 17. The remaining bits are as close to the requested
    // position as that allows.
    assert_eq!(set % 32, 0x000E_0531 % 32);
    assert!(set.abs_diff(4096) <= 16, "{set}");

    act(&bench, &encoder, &["set-position", "0x1234", "--exact"]).json();
    assert_eq!(encoder.writes(), ["40 43 00 00 12 34 55 70"]);
    // An encoder with its own bearing does not need to be synchronised.
    act(&bench, &encoder, &["set-position", "0x1000000"]).fails(1, &["0 to 16777215"]);
}

#[test]
fn accepts_all_address_reply_variants() {
    let bench = Bench::new();
    for reply in [&[][..], &["--reply-from", "new"], &["--no-repeat"], &["--reply-from", "new", "--no-repeat"]] {
        let Some(encoder) = bench.encoder(reply) else { return };
        let write = ["write", "hiperface", "address", "0x45", "--yes", "--link", &encoder.url, "--json"];
        let told = bench.run(&write).json();
        assert_eq!((&told["written"], &told["verified"]), (&json!(1), &json!(1)), "{reply:?}");
        assert_eq!(encoder.writes(), [frame("40 55 45 55")]);
        let url = format!("{}?address=0x45", encoder.url);
        assert_eq!(bench.run(&["identify", "hiperface", "--link", &url, "--json"]).json()["address"], json!(0x45));
    }
}

#[test]
fn stores_settings_and_clears_counter() {
    let bench = Bench::new();
    for reply in [&[][..], &["--no-repeat"]] {
        let Some(encoder) = bench.encoder(&[reply, &["--counter", "0xFFFFFF"]].concat()) else { return };
        let write = |item, value| {
            encoder.requests();
            bench.run(&["write", "hiperface", item, value, "--yes", "--link", &encoder.url, "--json"])
        };
        write("settings", "0xE5").json();
        assert_eq!(encoder.writes(), ["40 57 E5 55 A7"], "{reply:?}");
        write("settings", "0x97").fails(1, &["reserved"]);
        // A counter overflow is a warning and not a failure.
        let ran = act(&bench, &encoder, &["increment-counter"]);
        ran.json();
        assert!(ran.err.contains("08h"), "{ran:?}");
        write("counter", "5").fails(2, &["increment-counter"]);
        act(&bench, &encoder, &["increment-counter"]).json();
        write("counter", "0").json();
        assert_eq!(encoder.writes(), ["40 49 55 5C"]);
    }
}

#[test]
fn waits_for_reset() {
    let bench = Bench::new();
    let Some(encoder) = bench.encoder(&[]) else { return };
    let ran = act(&bench, &encoder, &["reset"]);
    assert_eq!(ran.status, Some(0), "{ran:?}");
    assert_eq!(encoder.writes(), ["40 53 13"]);
}

/// The extended label of the reference encoder: rotary, 16 periods, 4096 turns.
const LABEL: &str = "530000000010000010 0053454C33372D484642302D4B30322020202000030048 0073";

#[test]
fn extended_label_identifies_encoder() {
    let bench = Bench::new();
    let Some(encoder) =
        bench.encoder(&["--type", "FF", "--label", &format!("{LABEL}{}", "00".repeat(30)), "--position", "0x0531"])
    else {
        return;
    };
    let told = bench.run(&["identify", "hiperface", "--link", &encoder.url, "--json"]).json();
    assert_eq!((&told["encoder_type"], &told["encoder_name"]), (&json!(0xFF), &json!("SEL37-HFB0-K02")));
    let line = bench.run(&["position", "hiperface", "--link", &encoder.url, "--json"]).json();
    // A turn has 512 steps.
    assert_eq!((&line["turns"], &line["steps"]), (&json!(2), &json!(0x131)));
    assert!((line["degrees"].as_f64().unwrap() - 305.0 * 360.0 / 512.0).abs() < 1e-9, "{line}");
}

#[test]
fn linear_encoder_reports_millimetres() {
    let bench = Bench::new();
    // A label of a linear encoder with 1000 periods of 1,000,000 nm each.
    let label = format!("00 01 000F4240 000003E8 {} {}", "20".repeat(18), "00".repeat(36));
    let Some(encoder) = bench.encoder(&["--type", "FF", "--label", &label, "--position", "1329"]) else { return };
    let line = bench.run(&["position", "hiperface", "--link", &encoder.url, "--json"]).json();
    assert_eq!((&line["turns"], &line["degrees"], &line["raw"]), (&Value::Null, &Value::Null, &json!(1329)));
    assert!((line["millimetres"].as_f64().unwrap() - 1329.0 / 32.0).abs() < 1e-9, "{line}");
}

#[test]
fn unknown_type_uses_periods_from_link() {
    let bench = Bench::new();
    let Some(encoder) = bench.encoder(&["--type", "77", "--position", "0x0531"]) else { return };
    let ran = bench.run(&["position", "hiperface", "--link", &encoder.url, "--json"]);
    let line = ran.json();
    assert_eq!((&line["raw"], &line["turns"], &line["degrees"]), (&json!(0x0531), &Value::Null, &Value::Null));
    assert!(ran.err.contains("periods="), "{ran:?}");
    let url = format!("{}?periods=16&turns=4096", encoder.url);
    let line = bench.run(&["position", "hiperface", "--link", &url, "--json"]).json();
    assert_eq!((&line["turns"], &line["steps"]), (&json!(2), &json!(0x131)));
}

/// Restoring a profile to another encoder creates data fields, and restoring the backup deletes them again. A field
/// that was changed in the meantime is kept with those before it, and named in the message (issue 22.12).
#[test]
fn undo_deletes_only_created_fields() {
    let bench = Bench::new();
    let bytes = |byte: &str| byte.repeat(16);
    let fields = format!(
        r#"[{{"status":"C8","bytes":"{}"}},{{"status":"C8","bytes":"{}"}},{{"status":"C8","bytes":"{}"}}]"#,
        bytes("11"),
        bytes("22"),
        bytes("33")
    );
    let Some(source) = bench.encoder(&["--serial", "XX0000001", "--fields", &fields]) else { return };
    let file = bench.file("source.ron");
    assert_eq!(bench.run(&["save", "hiperface", "--link", &source.url, "-o", &file]).status, Some(0));
    for changed in [false, true] {
        let own = format!(r#"[{{"status":"C8","bytes":"{}"}}]"#, bytes("AA"));
        let Some(target) = bench.encoder(&["--serial", "XX0000002", "--fields", &own]) else { return };
        let at = ["--link", &target.url, "--json"];
        let copy = ["--copy", "field:0", "--copy", "field:1", "--copy", "field:2"];
        let restore = [&["restore", &file, "--yes", "--allow-other-device"], &copy[..], &at].concat();
        let told = bench.run(&restore).json();
        let backup = told["backup"].as_str().unwrap().to_owned();
        assert_eq!(
            target.host_address(&["40 4E"]),
            [frame("40 4E 6D 03")],
            "two fields of one block were created, 109 of 112 are free"
        );
        if changed {
            target.host_address(&["40 4B 01 00 01 55 77"]);
        }
        target.requests();
        let undo = bench.run(&[&["restore", &backup, "--yes"], &at[..]].concat());
        assert_eq!(undo.status, Some(0), "{undo:?}");
        let deleted = |number: u8| frame(&format!("40 4D 0{number} 48 55"));
        let defined: Vec<String> = target.writes().into_iter().filter(|frame| frame.starts_with("40 4D")).collect();
        if changed {
            // Field 2 is as written, so it is deleted. Field 1 was changed, so it remains.
            assert_eq!(defined, [deleted(2)], "{undo:?}");
            assert!(undo.err.contains("Data field 1"), "{undo:?}");
            assert_eq!(target.host_address(&["40 4A 01 00 01 55"]), [frame("40 4A 01 00 01 77")]);
        } else {
            assert_eq!(defined, [deleted(2), deleted(1)], "{undo:?}");
            assert!(!undo.err.contains("data field"), "{undo:?}");
        }
        // The earlier fields have their previous bytes again.
        assert_eq!(target.host_address(&["40 4A 00 00 01 55"]), [frame("40 4A 00 00 01 AA")]);
    }
}
