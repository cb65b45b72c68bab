//! Reads an independently written kit encoder over its configuration pin and over an adapter.

use serde_json::{Value, json};

use super::going::Going;
use super::support::{Bench, Foreign, Ran, finish, signal};

const JSON: &str = "--json";

/// Starts the same encoder on each type of connection.
fn both(bench: &Bench, arguments: &[&str]) -> Option<[Foreign; 3]> {
    Some([bench.kit(arguments)?, bench.adapter(arguments)?, bench.adapter_on_terminal(arguments)?])
}

fn ask(bench: &Bench, encoder: &Foreign, words: &[&str]) -> Ran {
    bench.run(&[words, &["--link", &encoder.url]].concat())
}

#[test]
fn identify_prints_every_key() {
    let bench = Bench::new();
    let Some(encoders) = both(&bench, &["--temperature", "-7", "--firmware", "1.6.2"]) else { return };
    for encoder in &encoders {
        let told = ask(&bench, encoder, &["identify", "biss", JSON]).json();
        let expected = json!({
            "device": "biss", "profile_id": "6129", "serial_number": "12345678", "firmware": "1.6.2",
            "device_id": "010168110001", "manufacturer": "Fr", "multiturn_bits": 16, "singleturn_bits": 17,
            "temperature_c": -7.0,
        });
        for (key, value) in expected.as_object().unwrap() {
            assert_eq!(&told[key], value, "{key}");
        }
        let text = ask(&bench, encoder, &["identify", "biss"]);
        assert!(text.out.contains("12345678 (00 BC 61 4E)") && text.out.contains("-7 °C"), "{text:?}");
    }
}

#[test]
fn configuration_pin_handles_echo_and_byte_order() {
    let bench = Bench::new();
    let Some(echoing) = bench.kit(&["--echo", "--order", "big"]) else { return };
    for parameters in ["", "?echo=on&order=high-first", "?timeout=300&margin=20"] {
        let link = format!("{}{parameters}", echoing.url);
        let told = bench.run(&["read", "biss", "0x02:0x05", "--link", &link, JSON]).json();
        assert_eq!(told["value"], json!(0x1C), "{parameters}");
    }
    let Some(noisy) = bench.kit(&["--broken", "0.05"]) else { return };
    assert_eq!(ask(&bench, &noisy, &["identify", "biss", JSON]).json()["serial_number"], json!("12345678"));
}

/// Error register 12h reports the multiturn counter and a weak magnetic field. Warning 01h reports the temperature
/// (BiSS reference 7).
#[test]
fn status_names_set_bits() {
    let bench = Bench::new();
    let Some(well) = both(&bench, &[]) else { return };
    let Some(ill) = both(&bench, &["--errors", "0x12", "--warnings", "1", "--filter", "4"]) else { return };
    for encoder in &well {
        let told = ask(&bench, encoder, &["status", "biss", JSON]).json();
        assert_eq!((&told["ok"], &told["errors"], &told["warnings"]), (&json!(true), &json!([]), &json!([])));
    }
    for encoder in &ill {
        let told = ask(&bench, encoder, &["status", "biss", JSON]).json();
        let errors = json!([
            {"code": 1, "text": "multiturn synchronisation error"},
            {"code": 4, "text": "magnetic field too low"},
        ]);
        assert_eq!((&told["ok"], &told["errors"], &told["filter"]), (&json!(false), &errors, &json!("dynamic")));
        assert_eq!(told["warnings"], json!([{"code": 0, "text": "temperature too high"}]));
        let text = ask(&bench, encoder, &["status", "biss"]);
        assert!(text.out.contains("magnetic field too low"), "{text:?}");
        // The error bits come from the position itself, or from the registers if the position has none.
        let position = ask(&bench, encoder, &["position", "biss", JSON]).json();
        assert_eq!((&position["valid"], &position["warning"]), (&json!(false), &json!(true)));
    }
}

/// A check must not report a Wiegand sensor as good if the result of its test was never saved (issue 22.19). One
/// encoder has factory settings. The other has the errors of reference 7, is hotter than its data sheet allows (105
/// °C), and is on a noisy line.
#[test]
fn check_judges_encoder_diagnostics() {
    let bench = Bench::new();
    let check = |link: &str| bench.run(&["do", "biss", "check", "--link", link, JSON]);
    let verdicts = |told: &Value| {
        let steps = told["steps"].as_array().unwrap().iter();
        steps.map(|line| format!("{} {}", line["step"], line["verdict"]).replace('"', "")).collect::<Vec<_>>()
    };
    let good = ["identity", "status", "position", "data sheet", "limits", "Wiegand test", "line", "wear"];
    for link in ["sim:", "sim:?bridge=on"] {
        let told = check(link).json();
        let expected = good.map(|step| format!("{step} {}", if step == "Wiegand test" { "skipped" } else { "good" }));
        assert_eq!(verdicts(&told), expected, "{told}");
    }
    let ill =
        check("sim:?bridge=on&errors=0x12&temperature=106&supply=switched&voltage=4.9&noise=0.2").json_with_status(1);
    let expected = [
        "identity good",
        "status bad",
        "position bad",
        "data sheet good",
        "limits attention",
        "Wiegand test skipped",
        "line attention",
        "wear good",
    ];
    assert_eq!(verdicts(&ill), expected, "{ill}");
    let text = ill.to_string();
    for words in ["magnetic field too low", "106 °C, allowed -40 to 105 °C", "4900 mV, allowed 5000 to 12000 mV"] {
        assert!(text.contains(words), "{words}: {text}");
    }
    bench.run(&["do", "biss", "check", "restart", "--link", "sim:"]).fails(2, &["no argument"]);
}

/// Without a frame format from the encoder or the link, the position is only a raw word (issue 22.20). The shaft is at
/// turn 1234h and 270°.
#[test]
fn position_is_raw_without_frame_format() {
    let bench = Bench::new();
    let Some(adapter) = bench.adapter(&["--stranger"]) else { return };
    let read = |parameters: &str| {
        let link = format!("{}{parameters}", adapter.url);
        bench.run(&["position", "biss", JSON, "--link", &link]).json()
    };
    let raw = read("");
    assert_eq!(raw["raw"], json!(0x2469_8000));
    assert!(["turns", "steps", "degrees"].iter().all(|key| raw[key].is_null()), "{raw}");
    let text = bench.run(&["position", "biss", "--link", &adapter.url]);
    assert!(text.out.contains("mt= and st=") && !text.out.contains('°'), "{text:?}");
    let told = read("?mt=16&st=17&crc=0x43");
    assert_eq!((&told["turns"], &told["steps"], &told["degrees"]), (&json!(4660), &json!(98_304), &json!(270.0)));
}

/// Each connection returns the same word for turn 1234h and 270°. Over BiSS, the frame and its CRC are returned as
/// well.
#[test]
fn position_has_turns_steps_and_degrees() {
    let bench = Bench::new();
    let Some(encoders) = both(&bench, &[]) else { return };
    let raw = 0x2469_8000;
    for (encoder, frame) in encoders.iter().zip([Value::Null, json!("024698000CF"), json!("024698000CF")]) {
        let ran = ask(&bench, encoder, &["position", "biss", JSON, "--count", "3", "--interval", "0"]);
        assert_eq!(ran.status, Some(0), "{ran:?}");
        let lines: Vec<Value> = ran.out.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
        assert_eq!(lines.len(), 3);
        for line in &lines {
            assert_eq!(line["frame"], frame);
            assert_eq!((&line["raw"], &line["turns"], &line["steps"]), (&json!(raw), &json!(4660), &json!(98_304)));
            assert_eq!((&line["degrees"], &line["valid"]), (&json!(270.0), &json!(true)));
        }
        assert!(lines[0]["t_s"].as_f64() < lines[2]["t_s"].as_f64());
        let over_biss = encoder.url.starts_with("bridge:");
        assert_eq!(ran.err, if over_biss { "crc errors: 0\n" } else { "" });
        let table = ask(&bench, encoder, &["position", "biss", "--csv", "--count", "2"]);
        let rows: Vec<&str> = table.out.lines().collect();
        assert_eq!((rows.len(), rows[0]), (3, "t_s,raw,turns,steps,degrees,valid,warning"));
        assert!(rows[2].ends_with(&format!(",{raw},4660,98304,270,true,false")), "{table:?}");
    }
}

/// The shaft turns counterclockwise at 360° per second.
#[test]
fn prints_positions_while_turning() {
    let bench = Bench::new();
    let Some(encoders) = both(&bench, &["--rpm", "-60"]) else { return };
    for encoder in &encoders {
        let ran = ask(&bench, encoder, &["position", "biss", JSON, "--count", "11", "--interval", "20"]);
        let lines: Vec<Value> = ran.out.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
        let place = |line: &Value| line["turns"].as_f64().unwrap() + line["degrees"].as_f64().unwrap() / 360.0;
        let time = |line: &Value| line["t_s"].as_f64().unwrap();
        let moved = place(&lines[10]) - place(&lines[0]);
        let speed = moved / (time(&lines[10]) - time(&lines[0]));
        assert!((speed + 1.0).abs() < 0.1, "{speed} revolutions a second: {ran:?}");
        // Data are not read while the shaft turns.
        let file = bench.file("p.ron");
        ask(&bench, encoder, &["save", "biss", "-o", &file, JSON]).fails(1, &["is turning", "Stop the shaft"]);
        ask(&bench, encoder, &["read", "biss", "0x24:0x10", JSON]).fails(1, &["is turning", "Stop the shaft"]);
        assert!(!bench.path("p.ron").exists());
        assert_eq!(ask(&bench, encoder, &["read", "biss", "0x66", JSON]).json()["value"], json!(80));
    }
}

#[test]
fn counts_frames_with_wrong_crc() {
    let bench = Bench::new();
    let Some(encoder) = bench.adapter(&["--damage", "3"]) else { return };
    let ran = ask(&bench, &encoder, &["position", "biss", "--csv", "--count", "20", "--interval", "0"]);
    assert_eq!((ran.status, ran.out.lines().count()), (Some(0), 21), "{ran:?}");
    assert!(ran.out.lines().skip(1).all(|line| line.contains(",4660,98304,270,")), "{ran:?}");
    // There are 20 good frames. Every third of all frames is damaged.
    let count: u64 = ran.err.strip_prefix("crc errors: ").unwrap().trim().parse().unwrap();
    assert!((9..=10).contains(&count), "{ran:?}");
    let Some(hopeless) = bench.adapter(&["--damage", "1"]) else { return };
    let ran = ask(&bench, &hopeless, &["position", "biss", JSON]);
    ran.fails(1, &["crc errors: ", "35 data bits, 6 CRC bits"]);
}

#[test]
fn reads_registers_by_name() {
    let bench = Bench::new();
    let data = r#"{"0x24:0x10": "A1B2C3", "0x43:0x3F": "7E", "0x04:0x00": "0102"}"#;
    let Some(encoders) = both(&bench, &["--data", data, "--temperature", "25", "--preset", "008001340200"]) else {
        return;
    };
    let cases = [
        ("0x66", json!(0x4B)),
        ("0x24:0x10", json!(0xA1)),
        ("0x24:0x10+3", json!("A1B2C3")),
        ("0x43:0x3F", json!(0x7E)),
        ("0x04:0x00+2", json!("0102")),
        ("0x44+4", json!("00BC614E")),
        ("0x01:0x02+6", json!("008001340200")),
        ("0x03:0x2C+2", json!("2EE0")),
        ("0x50", json!(0)),
    ];
    for encoder in &encoders {
        for (item, value) in &cases {
            let told = ask(&bench, encoder, &["read", "biss", item, JSON]).json();
            assert_eq!((told["item"].as_str(), &told["value"]), (Some(*item), value), "{}", encoder.url);
        }
        let text = ask(&bench, encoder, &["read", "biss", "0x66"]);
        assert_eq!(text.out, "0x4B  25 °C\n", "{text:?}");
        ask(&bench, encoder, &["read", "biss", "0x44:0x00", JSON]).fails(1, &["0x44:0x00"]);
    }
}

#[test]
fn omits_missing_meaning_from_json() {
    let bench = Bench::new();
    let read = |item: &str| bench.run(&["read", "biss", item, "--link", "sim:", JSON]).json();
    assert_eq!(read("0x24:0x10"), json!({"item": "0x24:0x10", "value": 0}));
    assert_eq!(read("0x66")["text"], json!("30 °C"));
}

/// The only write is the bank selection.
#[test]
fn reading_writes_nothing() {
    let bench = Bench::new();
    let Some(encoders) = both(&bench, &[]) else { return };
    let file = bench.file("p.ron");
    for encoder in &encoders {
        let commands: [&[&str]; 7] = [
            &["identify", "biss"],
            &["status", "biss"],
            &["position", "biss"],
            &["read", "biss", "0x24:0x10"],
            &["save", "biss", "-o", &file],
            &["diff", &file],
            &["verify", &file],
        ];
        for command in commands {
            encoder.requests();
            let ran = ask(&bench, encoder, command);
            assert_eq!(ran.status, Some(0), "{ran:?}");
            let other = |line: &String| !line.starts_with("0x40 ");
            let written: Vec<String> = encoder.registers_written().into_iter().filter(other).collect();
            assert_eq!(written, [""; 0], "{command:?} over {}", encoder.url);
        }
    }
}

#[test]
fn reports_wire_and_adapter_faults() {
    let bench = Bench::new();
    let cases: [(&[&str], &[&str]); 6] = [
        (&["--line", "open"], &["acknowledged the request", "MA+"]),
        (&["--line", "low"], &["stays low", "SLO"]),
        (&["--line", "high"], &["stays high", "SLO"]),
        (&["--version", "2"], &["version 2", "version 1"]),
        (&["--capabilities", "1"], &["bench adapter"]),
        (&["--silent"], &["does not respond"]),
    ];
    for (arguments, words) in cases {
        let Some(adapter) = bench.adapter(arguments) else { return };
        for command in [&["identify", "biss"][..], &["position", "biss"], &["read", "biss", "0x66"]] {
            let ran = ask(&bench, &adapter, command);
            ran.fails(1, words);
            assert!(ran.took.as_secs() < 10, "{ran:?}");
        }
    }
}

#[test]
fn fails_on_silent_or_garbled_encoder() {
    let bench = Bench::new();
    for arguments in [&["--silent-after", "0"][..], &["--silent-after", "40"], &["--silent-after", "2000"]] {
        let Some(encoders) = both(&bench, arguments) else { return };
        for encoder in &encoders {
            let file = bench.file("p.ron");
            let ran = ask(&bench, encoder, &["save", "biss", "-o", &file, JSON]);
            ran.fails(1, &["Check"]);
            assert!(ran.took.as_secs() < 20 && !bench.path("p.ron").exists(), "{ran:?}");
        }
    }
    let Some(nonsense) = bench.kit(&["--nonsense"]) else { return };
    let ran = ask(&bench, &nonsense, &["identify", "biss", JSON]);
    ran.fails(1, &[]);
    assert!(ran.took.as_secs() < 10, "{ran:?}");
}

#[test]
fn reports_line_lost_while_reading() {
    let bench = Bench::new();
    let Some(encoders) = both(&bench, &[]) else { return };
    for mut encoder in encoders {
        let arguments = ["position", "biss", "--csv", "--link", &encoder.url, "--count", "100000", "--interval", "20"];
        let going = Going::since(bench.program(&arguments), 11);
        encoder.kill();
        let ran = going.ended();
        assert_eq!(ran.status, Some(1), "{ran:?}");
        assert!(ran.out.lines().count() > 10 && ran.took.as_secs() < 10, "{ran:?}");
        ran.assert_stderr(&[]);
    }
}

#[test]
fn ctrl_c_ends_stream_between_lines() {
    let bench = Bench::new();
    for (link, options, status) in [
        ("sim:", &["--csv"][..], 0),
        ("sim:?bridge=on", &["--csv"], 0),
        ("sim:?bridge=on", &["--json", "--count", "100000"], 1),
    ] {
        let arguments = [&["position", "biss", "--link", link, "--interval", "5"], options].concat();
        let going = Going::since(bench.program(&arguments), 6);
        signal(&going.child, "INT");
        let ran = going.ended();
        assert_eq!(ran.status, Some(status), "{ran:?}");
        assert!(ran.out.ends_with('\n') && ran.out.lines().count() > 5, "{ran:?}");
        assert_eq!(ran.err.contains("crc errors: 0"), link.contains("bridge") && status == 0, "{ran:?}");
    }
}

#[test]
fn rejects_access_codes() {
    let bench = Bench::new();
    bench.run(&["identify", "biss", "--link", "sim:", "--code", "0=66"]).fails(2, &["--code"]);
    let mut command = bench.program(&["read", "biss", "0x66", "--link", "sim:", "--json"]);
    // Codes in the environment may belong to other devices.
    command.env("ENCODER_STUDIO_CODES", "0=66");
    assert_eq!(finish(command).json()["value"], json!(80));
}
