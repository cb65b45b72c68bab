//! An SSI encoder on an adapter: position, status, and invalid input for both.

use std::io::{BufRead, BufReader, Read};
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use super::support::{Bench, Foreign, Ran, ended, signal};

/// Starts an independently written adapter that supports only SSI, with an encoder of the given format.
fn adapter(bench: &Bench, format: &str, more: &[&str]) -> Option<Foreign> {
    bench.adapter(&[&["--capabilities", "1", "--ssi", format], more].concat())
}

fn position(bench: &Bench, layout: &str, link: &str, more: &[&str]) -> Ran {
    bench.run(&[&["position", "ssi", "--layout", layout, "--link", link], more].concat())
}

fn lines(ran: &Ran) -> Vec<Value> {
    assert_eq!(ran.status, Some(0), "{ran:?}");
    ran.out.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

/// The shaft is at turn 1234h and 270°. For the ATM60, this is turn 234h of 4096 and step 1800h of 8192.
#[test]
fn position_has_turns_steps_and_degrees() {
    let bench = Bench::new();
    let arguments = ["--capabilities", "1", "--ssi", "12,13,gray,0"];
    let encoders = [bench.adapter(&arguments), bench.adapter_on_terminal(&arguments)];
    for encoder in encoders.into_iter().flatten() {
        let more = ["--json", "--count", "3", "--interval", "0"];
        let told = lines(&position(&bench, "atm60,code=gray", &encoder.url, &more));
        assert_eq!(told.len(), 3);
        for line in &told {
            let number = (&line["raw"], &line["turns"], &line["steps"], &line["degrees"]);
            assert_eq!(number, (&json!(0x65_D400), &json!(564), &json!(6144), &json!(270.0)), "{line}");
            assert_eq!((&line["valid"], &line["errors"]), (&json!(true), &json!([])));
        }
        assert!(told[0]["t_s"].as_f64() < told[2]["t_s"].as_f64());
        let text = position(&bench, "atm60,code=gray", &encoder.url, &[]);
        assert!(text.out.contains("0x065D400  turn 564, step 6144, 270.000000°"), "{text:?}");
        assert_eq!(text.err, "");
        let table = position(&bench, "atm60,code=gray", &encoder.url, &["--csv", "--count", "2"]);
        let rows: Vec<&str> = table.out.lines().collect();
        assert_eq!((rows.len(), rows[0]), (3, "t_s,raw,turns,steps,degrees,millimetres,valid"));
        assert!(rows[1].ends_with(",6673408,564,6144,270,,true"), "{table:?}");
    }
}

/// A KH53 counts tenths of a millimetre. The position is three quarters of 2^24.
#[test]
fn linear_encoder_reports_millimetres() {
    let bench = Bench::new();
    let Some(encoder) = adapter(&bench, "0,24,binary,0", &[]) else { return };
    let told = &lines(&position(&bench, "kh53", &encoder.url, &["--json"]))[0];
    assert_eq!((&told["turns"], &told["degrees"], &told["steps"]), (&Value::Null, &Value::Null, &json!(0xC0_0000)));
    assert!((told["millimetres"].as_f64().unwrap() - 1_258_291.2).abs() < 1e-6, "{told}");
    let table = position(&bench, "kh53", &encoder.url, &["--csv", "--count", "1"]);
    assert!(table.out.contains(",12582912,,12582912,,1258291.2,true"), "{table:?}");
}

/// The AFS60 has ERRDIG, ERRSI and ERRSYNC on clocks 19 to 21. A transfer clears ERRSYNC.
#[test]
fn reports_and_counts_error_bits() {
    let bench = Bench::new();
    let Some(encoder) = adapter(&bench, "0,18,binary,3", &["--ssi-error", "3"]) else { return };
    let ran = position(&bench, "afs60", &encoder.url, &["--json", "--count", "7", "--interval", "10"]);
    let valid: Vec<bool> = lines(&ran).iter().map(|line| line["valid"] == json!(true)).collect();
    assert_eq!(valid, [true, true, false, true, true, false, true]);
    let said: Vec<&str> = ran.err.lines().collect();
    assert_eq!(said.len(), 3, "{ran:?}");
    assert!(said[..2].iter().all(|line| line.contains(" s: ERRSYNC: ")), "{ran:?}");
    let told = said[2].strip_prefix("ERRSYNC: 2 times, last at ").unwrap().strip_suffix(" s").unwrap();
    let last = lines(&ran)[5]["t_s"].as_f64().unwrap();
    assert!((told.parse::<f64>().unwrap() - last).abs() <= 0.000_5, "{told} {last}");
    let every = adapter(&bench, "0,18,binary,3", &["--ssi-error", "1"]).unwrap();
    let status = bench.run(&["status", "ssi", "--layout", "afs60", "--link", &every.url, "--json"]).json();
    let expected = json!({"ok": false, "errors": [{"code": 21, "text": "ERRSYNC"}], "warnings": []});
    assert_eq!(status, expected);
    let good = bench.run(&["status", "ssi", "--layout", "afs60", "--link", &encoder.url]);
    assert_eq!(good.status, Some(0), "{good:?}");
    assert!(good.out.contains("errors    none") && good.out.contains("step 196608"), "{good:?}");
}

/// All ones mean a fault of a safety encoder, or a broken wire with other encoders. All zeros mean that the line is
/// stuck (reference 6.7).
#[test]
fn reports_stuck_line() {
    let bench = Bench::new();
    let told = |line: &str, layout: &str| {
        let encoder = adapter(&bench, "12,13,gray,0", &["--line", line])?;
        let status = bench.run(&["status", "ssi", "--layout", layout, "--link", &encoder.url, "--json"]).json();
        let of = |key: &str| status[key].as_array().unwrap().iter().map(|one| one["text"].clone()).collect::<Vec<_>>();
        let ran = position(&bench, layout, &encoder.url, &["--count", "2", "--interval", "0"]);
        assert_eq!(ran.status, Some(0), "{ran:?}");
        Some((of("errors"), of("warnings"), ran.err))
    };
    let Some((errors, _, said)) = told("high", "afs60s") else { return };
    assert!(errors.contains(&json!("safety fault")) && said.contains("safety fault: 1 time"), "{errors:?}, {said}");
    let (errors, warnings, said) = told("high", "atm60,code=gray").unwrap();
    assert_eq!((errors, warnings), (vec![], vec![json!("line stuck high")]));
    assert!(said.contains("line stuck high: 1 time"), "{said}");
    let (_, warnings, said) = told("low", "atm60").unwrap();
    assert_eq!(warnings, [json!("line stuck low")]);
    assert!(said.contains("line stuck low: 1 time"), "{said}");
}

/// Clock and pause come from the link, else from the profile, else from slow defaults. They are checked against the
/// limits of the encoder.
#[test]
fn link_or_profile_sets_clock_and_pause() {
    let bench = Bench::new();
    let Some(encoder) = adapter(&bench, "12,13,gray,0", &[]) else { return };
    let link = format!("{}?clock=3000000&pause=15", encoder.url);
    let ran = position(&bench, "atm60,code=gray", &link, &["--json"]);
    assert_eq!(lines(&ran)[0]["turns"], json!(564));
    assert!(ran.err.contains("kHz") && ran.err.contains("µs"), "{ran:?}");
    let profile = bench.file("slow.ron");
    let saved = bench.run(&["save", "ssi", "--layout", "atm60,code=gray", "-o", &profile]);
    assert_eq!(saved.status, Some(0), "{saved:?}");
    let ran = position(&bench, &profile, &encoder.url, &["--json"]);
    assert_eq!((&lines(&ran)[0]["steps"], ran.err.as_str()), (&json!(6144), ""));
}

#[test]
fn reports_unsuitable_adapter() {
    let bench = Bench::new();
    let Some(other) = bench.adapter(&[]) else { return };
    position(&bench, "atm60", &other.url, &[]).fails(1, &["bench adapter", "SSI"]);
    let newer = adapter(&bench, "12,13,gray,0", &["--version", "2"]).unwrap();
    position(&bench, "atm60", &newer.url, &[]).fails(1, &["version 2", "version 1"]);
    let silent = adapter(&bench, "12,13,gray,0", &["--silent"]).unwrap();
    let ran = position(&bench, "atm60", &silent.url, &[]);
    ran.fails(1, &["does not respond"]);
    let mut gone = adapter(&bench, "12,13,gray,0", &[]).unwrap();
    gone.kill();
    position(&bench, "atm60", &gone.url, &[]).fails(1, &["Cannot reach"]);
}

/// The counts so far are printed if the cable is unplugged or the user cancels during the measurement.
#[test]
fn interrupted_stream_reports_counts() {
    let bench = Bench::new();
    let format = ["--capabilities", "1", "--ssi", "0,18,binary,3", "--ssi-error", "2"];
    let encoders = [bench.adapter(&format), bench.adapter_on_terminal(&format), bench.adapter(&format)];
    for (number, encoder) in encoders.into_iter().flatten().enumerate() {
        let mut encoder = encoder;
        let arguments = ["position", "ssi", "--layout", "afs60", "--link", &encoder.url, "--csv", "--interval", "5"];
        let mut child = bench.program(&arguments).spawn().unwrap();
        let begun = Instant::now();
        let mut out = BufReader::new(child.stdout.take().unwrap());
        let mut line = String::new();
        while line.split(',').count() < 30 {
            assert!(out.read_line(&mut line).unwrap() > 0, "{line}");
        }
        let is_cut = number < 2;
        if is_cut {
            encoder.kill();
        } else {
            signal(&child, "INT");
        }
        let rest = std::thread::spawn(move || out.read_to_string(&mut String::new()));
        let ran = ended(child, begun);
        rest.join().unwrap().unwrap();
        assert_eq!(ran.status, Some(if is_cut { 1 } else { 0 }), "{ran:?}");
        assert!(ran.took < Duration::from_secs(10) && ran.err.contains("ERRSYNC: "), "{ran:?}");
        assert!(ran.err.contains(" times, last at ") && ran.err.contains("error: ") == is_cut, "{ran:?}");
    }
}

#[test]
fn invalid_arguments_are_usage_errors() {
    let bench = Bench::new();
    for command in ["position", "status"] {
        bench.run(&[command, "ssi", "--link", "sim:", "--json"]).fails(2, &["--layout", command]);
        bench.run(&[command, "ssi", "--layout", "atm60", "--json"]).fails(2, &["--link"]);
        bench.run(&[command, "biss", "--layout", "atm60", "--link", "sim:"]).fails(2, &["--layout", "ssi"]);
        let cases: [(&str, &str, i32, &[&str]); 12] = [
            ("atm61", "sim:", 2, &["atm61", "ttk70"]),
            ("atm60,colour=1", "sim:", 2, &["colour"]),
            ("ahs36,clocks=14", "sim:", 1, &["14"]),
            ("atm60", "serial:/dev/ttyUSB0", 2, &["serial:", "bridge:"]),
            ("atm60", "tcp:127.0.0.1:1", 2, &["tcp:", "bridge:"]),
            ("atm60", "bridge:/dev/x?baud=115200", 2, &["baud", "clock, pause, voltage"]),
            ("atm60", "bridge:/dev/x?layout=atm60", 2, &["layout"]),
            ("atm60", "bridge:/dev/x?clock=5", 2, &["clock=5", "80000"]),
            ("atm60", "sim:?ssi=atm61", 2, &["ssi=atm61", "atm60,code=gray"]),
            ("atm60", "sim:?ssi-error=ERRDIG", 2, &["ssi-error=ERRDIG", "no error bits"]),
            ("atm60", "sim:?version=2", 1, &["version 2"]),
            ("atm60", "bridge:tcp:127.0.0.1:1", 1, &["Cannot reach"]),
        ];
        for (layout, link, status, words) in cases {
            let ran = bench.run(&[command, "ssi", "--layout", layout, "--link", link, "--json"]);
            ran.fails(status, words);
        }
    }
}
