//! Encoders that do not answer, send invalid data, lose power or are unplugged.

use std::path::Path;
use std::thread::sleep;
use std::time::{Duration, Instant};

use serde_json::json;

use super::going::Going;
use super::support::{Bench, ended, frame, signal};

const FIELDS: &str = r#"[{"status":"C9","bytes":"0815"},{"status":"88","bytes":"01"}]"#;

#[test]
fn silent_encoder_times_out() {
    let bench = Bench::new();
    let Some(encoder) = bench.encoder(&["--silent"]) else { return };
    let ran = bench.run(&["identify", "hiperface", "--link", &encoder.url, "--json"]);
    ran.fails(1, &["40h"]);
    assert!(ran.took < Duration::from_secs(10), "{ran:?}");
    // The request is repeated a limited number of times.
    assert!((2..=5).contains(&encoder.requests().len()));
}

#[test]
fn detects_silent_encoder_behind_echo() {
    let bench = Bench::new();
    let Some(encoder) = bench.encoder(&["--silent", "--echo"]) else { return };
    let ran = bench.run(&["save", "hiperface", "--link", &encoder.url, "-o", &bench.file("p.ron")]);
    ran.fails(1, &["40h"]);
    assert!(ran.took < Duration::from_secs(10), "{ran:?}");
    assert!(!bench.path("p.ron").exists());
}

#[test]
fn garbage_is_not_a_value() {
    let bench = Bench::new();
    for seed in ["1", "2"] {
        let Some(encoder) = bench.encoder(&["--nonsense", "--seed", seed]) else { return };
        for arguments in [&["identify", "hiperface"][..], &["read", "hiperface", "counter"]] {
            let ran = bench.run(&[arguments, &["--link", &encoder.url]].concat());
            ran.fails(1, &[]);
            assert!(ran.took < Duration::from_secs(10), "{ran:?}");
        }
    }
}

#[test]
fn unplugging_ends_polling_with_one_message() {
    let bench = Bench::new();
    // The encoder is polled without pauses, and is disconnected during a long pause between two readings.
    for interval in ["0", "100", "60000"] {
        let Some(mut encoder) = bench.encoder(&[]) else { return };
        let arguments = ["position", "hiperface", "--link", &encoder.url, "--count", "100000", "--interval", interval];
        let going = Going::since(bench.program(&arguments), 1);
        encoder.kill();
        let ran = going.ended();
        assert_eq!(ran.status, Some(1), "{ran:?}");
        ran.assert_stderr(&["lost", "unplugged"]);
        assert!(!ran.out.is_empty(), "{ran:?}");
        assert!(ran.took < Duration::from_secs(4), "interval {interval}: {ran:?}");
    }
}

#[test]
fn interrupt_ends_polling() {
    let bench = Bench::new();
    for (interval, name) in [("0", "INT"), ("100", "TERM"), ("60000", "INT")] {
        let Some(encoder) = bench.encoder(&[]) else { return };
        let arguments = ["position", "hiperface", "--link", &encoder.url, "--count", "100000", "--interval", interval];
        let going = Going::since(bench.program(&arguments), 1);
        signal(&going.child, name);
        let ran = going.ended();
        assert!(ran.status.is_some(), "killed by the signal instead of ending: {ran:?}");
        assert!(!ran.err.contains("panicked"), "{ran:?}");
        assert!(ran.took < Duration::from_secs(4), "interval {interval}: {ran:?}");
    }
}

#[test]
fn second_restore_completes_after_power_loss() {
    let bench = Bench::new();
    let wanted = r#"[{"status":"C9","bytes":"00112233445566778899"},{"status":"88","bytes":"02"}]"#;
    let Some(source) = bench.encoder(&["--fields", wanted]) else { return };
    let Some(encoder) = bench.encoder(&["--fields", FIELDS, "--die-in-store", "1"]) else { return };
    let file = bench.file("wanted.ron");
    assert_eq!(bench.run(&["save", "hiperface", "--link", &source.url, "-o", &file]).status, Some(0));

    let ran = bench.run(&["restore", &file, "--yes", "--link", &encoder.url, "--json"]);
    ran.fails(1, &["backups"]);
    assert!(ran.took < Duration::from_secs(12), "{ran:?}");
    let mut words = ran.err.split_whitespace().map(|word| word.trim_end_matches([';', ',', '.']));
    let backup = words.find(|word| word.ends_with(".ron") && word.contains("backups")).unwrap();
    assert!(Path::new(backup).is_file(), "{ran:?}");
    // Stores must not be repeated: one store is sent, and only readings after it.
    assert_eq!(encoder.writes(), [frame("40 4B 00 00 0A 55 00 11 22 33 44 55 66 77 88 99")]);

    let text = std::fs::read_to_string(backup).unwrap();
    assert!(text.contains("GB0450179") && text.contains("08 15 FF"), "{text}");
    let told = bench.run(&["diff", backup, &file, "--json"]).json_with_status(3);
    assert!(
        told["differences"].as_array().unwrap().iter().any(|item| item["left"].as_str().unwrap().starts_with("0815"))
    );

    bench.run(&["restore", &file, "--yes", "--link", &encoder.url, "--json"]).json();
    let equal = bench.run(&["verify", &file, "--link", &encoder.url, "--json"]).json();
    assert_eq!((&equal["equal"], &equal["missing"]), (&json!(true), &json!([])));
}

#[test]
fn tolerates_line_noise() {
    let bench = Bench::new();
    let url = "sim:?seed=3&fault=drop:0.01,flip:0.005";
    for _ in 0..3 {
        let ran = bench.run(&["read", "hiperface", "settings", "--link", url, "--json"]);
        assert_eq!(ran.json()["value"], json!(0xE4));
    }
}

#[test]
fn second_restore_protects_unprotected_field() {
    let bench = Bench::new();
    let Some(source) = bench.encoder(&["--fields", r#"[{"status":"88","bytes":"0A0B0C0D"}]"#]) else { return };
    let there = r#"[{"status":"88","bytes":"01020304"}]"#;
    let Some(encoder) = bench.encoder(&["--fields", there, "--die-in-store", "1"]) else { return };
    let file = bench.file("wanted.ron");
    assert_eq!(bench.run(&["save", "hiperface", "--link", &source.url, "-o", &file]).status, Some(0));
    let ran = bench.run(&["restore", &file, "--yes", "--link", &encoder.url, "--json"]);
    ran.fails(1, &["still not write-protected: 0", "backups"]);
    assert!(ran.took < Duration::from_secs(15), "{ran:?}");
    assert_eq!(encoder.writes(), [frame("40 4D 00 C8 55"), frame("40 4B 00 00 04 55 0A 0B 0C 0D")]);

    bench.run(&["restore", &file, "--yes", "--link", &encoder.url, "--json"]).json();
    assert_eq!(encoder.host_address(&["40 4C 00"]), [frame("40 4C 00 88")]);
    assert_eq!(bench.run(&["verify", &file, "--link", &encoder.url, "--json"]).json()["equal"], json!(true));
}

/// Encoders found before the interruption are printed. This encoder answers at the first format and address.
#[test]
fn interrupt_ends_search() {
    let bench = Bench::new();
    for (query, found) in [("settings=0xE5&address=0x43", false), ("address=0x40", true)] {
        let link = format!("sim:?{query}");
        let child = bench.program(&["find", "hiperface", "--only-master", "--link", &link]).spawn().unwrap();
        sleep(Duration::from_millis(2000));
        signal(&child, "INT");
        let ran = ended(child, Instant::now());
        assert_eq!(ran.out.contains("address 40h at 9600"), found, "{ran:?}");
        assert!(ran.took < Duration::from_secs(5), "{ran:?}");
        assert!(ran.status == Some(1) && ran.err.contains("Cancelled: the search is incomplete"), "{ran:?}");
    }
}
