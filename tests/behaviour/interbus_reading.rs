//! Reads an independently written K3 encoder behind a gateway, without changing anything in the encoder.

use serde_json::{Value, json};

use super::support::{Bench, Foreign, Ran, run_on_terminal};

/// Two cam programs of the encoder, as JSON.
const PROGRAMS: &str =
    r#"{"1": {"mask": 9, "cams": {"0": [3000, 200], "3": [21, 531]}}, "3": {"mask": 128, "cams": {"7": [100, 100]}}}"#;

fn ask(bench: &Bench, encoder: &Foreign, words: &[&str]) -> Ran {
    bench.run(&[words, &["--link", &encoder.url, "--json"]].concat())
}

/// Returns the OUT words, stores and presets logged since the last call.
fn done(encoder: &Foreign) -> Vec<String> {
    encoder.requests().into_iter().filter(|line| line != "R").collect()
}

/// Checks that the host has only read (reference 3 and 5), selected or run a program, or returned to normal operation,
/// and has not stored anything.
#[track_caller]
fn only_read(encoder: &Foreign) {
    for line in done(encoder) {
        let reads = ["W 2021", "W 2020", "W 2080", "W 80000000", "W 00000000"];
        assert!(reads.iter().any(|begin| line.starts_with(begin)), "{line}");
    }
}

#[test]
fn identify_prints_every_key() {
    let bench = Bench::new();
    let options = ["--serial-number=4711", "--steps=3600", "--turns=10", "--direction=ccw", "--flags=2", "--busy=20"];
    let Some(encoder) = bench.gateway(&[&options[..], &["--stale=2", "--software-version=77"]].concat()) else {
        return;
    };
    let told = ask(&bench, &encoder, &["identify", "interbus"]);
    assert!(told.err.contains("instead of its position"), "{told:?}");
    let expected = json!({
        "device": "interbus", "profile": "K3", "serial_number": "4711", "steps": 3600, "revolutions": 10,
        "direction": "ccw", "software_version": "77", "mode": "K3", "multiturn": true, "steps_minus_one": false,
    });
    assert_eq!(told.json(), expected);
    only_read(&encoder);
    let text = bench.run(&["identify", "interbus", "--link", &encoder.url]);
    assert!(text.out.contains("3600 over 10 revolutions") && text.out.contains("counterclockwise"), "{text:?}");
}

#[test]
fn reads_every_item_by_name() {
    let bench = Bench::new();
    let options = ["--steps=3600", "--preset=500", "--zero-shift=7", "--shift=8", "--programs", PROGRAMS];
    let Some(encoder) = bench.gateway(&[&options[..], &["--temperature=-100", "--operating-time=12"]].concat()) else {
        return;
    };
    let cases = [
        ("steps", json!(3600), Some("steps")),
        ("revolutions", json!(1), Some("turns")),
        ("direction", json!("cw"), None),
        ("preset", json!(500), Some("steps")),
        ("zero-shift", json!(7), Some("steps")),
        ("shift", json!(8), Some("bits")),
        ("cam-mask:1", json!(9), None),
        ("cam:1:0", json!("3000..200"), Some("steps")),
        ("cam:3:7", json!("100..100"), Some("steps")),
        ("temperature", json!(-10.0), Some("°C")),
        ("operating-time", json!(120), Some("min")),
    ];
    for (item, value, unit) in cases {
        let ran = ask(&bench, &encoder, &["read", "interbus", item]);
        assert_eq!(
            ran.err.contains("To read a cam program, the encoder must select it"),
            item.contains("cam") || item == "shift",
            "{ran:?}"
        );
        let told = ran.json();
        assert_eq!((&told["item"], &told["value"]), (&json!(item), &value), "{told}");
        assert_eq!(told.get("unit").and_then(Value::as_str), unit, "{told}");
    }
    only_read(&encoder);
    // The encoder is in position mode, as before, and OUT is 0.
    assert_eq!(encoder_mode(&bench, &encoder), "K3");
}

fn encoder_mode(bench: &Bench, encoder: &Foreign) -> String {
    ask(bench, encoder, &["identify", "interbus"]).json()["mode"].as_str().unwrap().to_owned()
}

/// 12345 of the encoder's own steps are 542 steps at 360 per turn, which is turn 1 and step 182, or 182° (reference 7).
#[test]
fn position_stays_within_programmed_turns() {
    let bench = Bench::new();
    let Some(encoder) = bench.gateway(&["--position=12345", "--steps=720", "--turns=2"]) else { return };
    let ran = ask(&bench, &encoder, &["position", "interbus", "--count", "3", "--interval", "1"]);
    let lines: Vec<Value> = ran.out.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!((ran.status, lines.len()), (Some(0), 3), "{ran:?}");
    for told in &lines {
        assert_eq!((&told["raw"], &told["turns"], &told["steps"]), (&json!(542), &json!(1), &json!(182)), "{told}");
        assert_eq!((&told["degrees"], &told["valid"]), (&json!(182.0), &json!(true)));
        assert!(told["t_s"].as_f64() >= Some(0.0));
    }
    only_read(&encoder);
    let table = bench.run(&["position", "interbus", "--link", &encoder.url, "--csv", "--count", "1"]);
    assert!(table.out.starts_with("t_s,raw,turns,steps,degrees,valid\n"), "{table:?}");
    assert!(table.out.trim_end().ends_with(",542,1,182,182,true"), "{table:?}");
}

/// Words with cam states, a speed or an error must not be printed as a position. In the first case, the position window
/// shows 1000 of 3600, and cam 3 is on from 900 (reference 5).
#[test]
fn prints_only_position_words_as_position() {
    let bench = Bench::new();
    let programs = r#"{"2": {"mask": 8, "cams": {"3": [900, 1100]}}}"#;
    let position = ["--position=2276", "--steps=3600"];
    let Some(encoder) = bench.gateway(&[&position[..], &["--mode=4", "--programs", programs]].concat()) else { return };
    let told = ask(&bench, &encoder, &["position", "interbus"]).json();
    // 2276 · 3600 / 8192 is 1000.2, and 1000 is 3E8h.
    assert_eq!((&told["raw"], &told["position"]), (&json!(0x0003_E808), &json!(1000)), "{told}");
    assert_eq!((&told["mode"], &told["cams"], &told["valid"]), (&json!("cam 2"), &json!([3]), &json!(true)));
    // The encoder is in the same program as before.
    assert_eq!(encoder_mode(&bench, &encoder), "cam 2");
    only_read(&encoder);
    let Some(encoder) = bench.gateway(&["--mode=2", "--rpm=120"]) else { return };
    let told = ask(&bench, &encoder, &["position", "interbus"]).json();
    assert_eq!((&told["rpm"], &told["turns"], &told["mode"]), (&json!(120), &Value::Null, &json!("velocity")));
    let Some(encoder) = bench.gateway(&["--lost"]) else { return };
    let told = ask(&bench, &encoder, &["status", "interbus"]).json();
    assert_eq!((&told["ok"], &told["errors"][0]["code"]), (&json!(false), &json!(3)), "{told}");
    assert!(told["errors"][0]["text"].as_str().unwrap().contains("Restore them from a profile"), "{told}");
    let told = ask(&bench, &encoder, &["position", "interbus"]).json();
    assert_eq!((&told["raw"], &told["valid"], &told["turns"]), (&json!(0x8600_0000_u32), &json!(false), &Value::Null));
}

#[test]
fn healthy_encoder_reports_no_errors() {
    let bench = Bench::new();
    let Some(encoder) = bench.gateway(&["--temperature=253"]) else { return };
    let told = ask(&bench, &encoder, &["status", "interbus"]).json();
    assert_eq!((&told["ok"], &told["errors"], &told["warnings"]), (&json!(true), &json!([]), &json!([])));
    assert_eq!((&told["temperature_c"], &told["operating_minutes"]), (&json!(25.3), &json!(10_000)));
    let told = ask(&bench, &encoder, &["do", "interbus", "check"]).json();
    assert_eq!((&told["ok"], &told["steps"][0]["verdict"]), (&json!(true), &json!("good")), "{told}");
    only_read(&encoder);
}

#[test]
fn saved_profile_matches_encoder() {
    let bench = Bench::new();
    let Some(encoder) = bench.gateway(&["--steps=3600", "--preset=500", "--mode=5", "--programs", PROGRAMS]) else {
        return;
    };
    let file = bench.file("saved.ron");
    let ran = ask(&bench, &encoder, &["save", "interbus", "-o", &file]);
    assert_eq!(ran.json()["programs"], json!(8));
    assert!(ran.err.contains("To read a cam program, the encoder must select it"), "{ran:?}");
    let text = bench.read("saved.ron");
    for line in ["steps: 3600,", "preset: 500,", "(cam: 0, start: 3000, stop: 200),", "mask: 0x80,", "startup_mode: 5,"]
    {
        assert!(text.contains(line), "{line}\n{text}");
    }
    let told = ask(&bench, &encoder, &["verify", &file]).json();
    assert_eq!(
        (&told["equal"], &told["compared"], &told["missing"]),
        (&json!(true), &json!(5 + 1 + 8 * 9), &json!([]))
    );
    assert_eq!(ask(&bench, &encoder, &["diff", &file]).json()["equal"], json!(true));
    only_read(&encoder);
    assert_eq!(encoder_mode(&bench, &encoder), "cam 3", "as it was found");
    // Values that the profile does not contain are not read, so no program is selected.
    let short = bench.write(
        "short.ron",
        r#"(schema: 1, device: "interbus", parameters: (steps: 3600, revolutions: 1, direction: "ccw", preset: 500,
            zero_shift: 0))"#,
    );
    encoder.requests();
    let told = ask(&bench, &encoder, &["verify", &short]).json_with_status(3);
    assert_eq!(told["differences"], json!([{"item": "direction", "left": "ccw", "right": "cw"}]), "{told}");
    let selected = done(&encoder).into_iter().filter(|line| line.starts_with("W 2080"));
    assert!(selected.clone().all(|line| line == "W 20800003"), "{:?}", selected.collect::<Vec<_>>());
    // Comparing two files does not require an encoder.
    let told = bench.run(&["diff", &file, &short, "--json"]).json_with_status(3);
    assert_eq!((&told["compared"], told["missing"].as_array().map(Vec::len)), (&json!(5), Some(1 + 8 * 9)), "{told}");
}

/// The same virtual encoder is read in this process and over TCP.
#[test]
fn reads_virtual_encoder_directly_and_over_modbus() {
    use super::support::Simulated;
    let bench = Bench::new();
    let settings = ["steps=3600", "revolutions=1", "cams=demo", "position=5000", "serial=99"];
    let set: Vec<&str> = settings.iter().flat_map(|setting| ["--set", setting]).collect();
    let port = Simulated::start(&bench, &[&["interbus", "--listen", "127.0.0.1:0"], &set[..]].concat());
    let links = [format!("sim:?{}", settings.join("&")), format!("modbus:{}", port.place)];
    for command in
        [&["identify", "interbus"][..], &["read", "interbus", "cam:2:5"], &["read", "interbus", "cam-mask:1"]]
    {
        let told = links.each_ref().map(|link| bench.run(&[command, &["--link", link, "--json"]].concat()).json());
        assert_eq!(told[0], told[1]);
    }
    port.end("INT");
}

#[track_caller]
fn assert_help_warns(bench: &Bench, command: &str) {
    let help = bench.run(&[command, "--help"]).out.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(help.contains("live outputs") && help.contains("may cost one EEPROM write cycle"), "{command}: {help}");
}

/// A report reads the cam programs, as `save` does.
#[test]
fn report_help_warns_about_cam_programs() {
    assert_help_warns(&Bench::new(), "report");
}

/// Reading cam programs switches live outputs, so the program asks for confirmation on a terminal. Without a terminal
/// it continues, because the help of these commands warns of the effect (issue 22.31).
#[test]
fn reading_cam_programs_needs_confirmation() {
    let bench = Bench::new();
    let Some(foreign) = bench.gateway(&["--steps=3600"]) else { return };
    let (url, all) = (format!("{}?cycle=1", foreign.url), bench.file("k3.ron"));
    let file = bench.write(
        "one.ron",
        r#"(schema: 1, device: "interbus", parameters: (steps: 3600, revolutions: 1, direction: "cw", preset: 0,
            zero_shift: 0), programs: [(program: 2, mask: 0x00, cams: [(cam: 3, start: 0, stop: 0)])])"#,
    );
    let commands: [&[&str]; 4] = [
        &["save", "interbus", "-o", &all, "--force", "--link", &url],
        &["verify", &file, "--link", &url],
        &["diff", &file, "--link", &url],
        &["read", "interbus", "cam:2:3", "--link", &url],
    ];
    let selects = || done(&foreign).iter().any(|line| line.starts_with("W 2080"));
    for command in commands {
        // Run the command without a terminal.
        let ran = bench.run(command);
        // Some programs exist only in the encoder, so `diff` reports differences.
        assert!(matches!(ran.status, Some(0 | 3)) && ran.err.contains("The outputs switch to each program"), "{ran:?}");
        assert!(selects(), "{command:?}");
        assert_help_warns(&bench, command[0]);
        let ran = run_on_terminal(&bench, command, "n\n");
        assert!(ran.status == Some(1) && ran.out.contains("Does the machine stand still?"), "{ran:?}");
        assert!(!selects(), "{command:?}");
    }
    let ran = run_on_terminal(&bench, commands[3], "y\n");
    assert!(ran.status == Some(0) && ran.out.contains("0..0"), "{ran:?}");
    // A command that does not select a program does not ask for confirmation.
    let ran = run_on_terminal(&bench, &["do", "interbus", "check", "--link", &url], "");
    assert!(ran.status == Some(0) && !ran.out.contains("stand still?"), "{ran:?}");
}
