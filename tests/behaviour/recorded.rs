//! The interface that scripts rely on: the exit status and JSON output of every command. They are compared with the
//! recordings under `tests/fixtures/cli`, one file per kind of device. A recording also lists the commands: a line with
//! `$` begins one, `=` gives its exit status, and its JSON follows. Text for users is not recorded.
//!
//! `ENCODER_STUDIO_RECORD=1` rewrites the files. Use it only if the contract is meant to grow.

use std::fmt::Write as _;
use std::path::PathBuf;

use serde_json::Value;

use crate::support::{Bench, finish};

fn fixtures() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures/cli")
}

/// Runs the commands of a recording in a separate folder and compares their output.
fn assert_recorded(kind: &str) {
    let path = fixtures().join(format!("{kind}.txt"));
    let recorded = std::fs::read_to_string(&path).unwrap();
    let bench = Bench::new();
    let mut text = String::new();
    for line in recorded.lines().filter_map(|line| line.strip_prefix("$ ")) {
        let filled = line.replace("{fixtures}", fixtures().to_str().unwrap());
        let mut arguments: Vec<&str> = filled.split(' ').collect();
        if !line.ends_with("--csv") {
            arguments.push("--json");
        }
        let mut program = bench.program(&arguments);
        program.current_dir(bench.path(""));
        let ran = finish(program);
        let _ = writeln!(text, "$ {line}\n= {}", ran.status.unwrap());
        for own in ran.out.lines() {
            let _ = match serde_json::from_str(own) {
                Ok(value) => writeln!(text, "{}", steady(value)),
                Err(_) if line.ends_with("--csv") => writeln!(text, "{}", own.split_once(',').unwrap().1),
                Err(error) => panic!("{line}: {error}: {own}"),
            };
        }
    }
    if std::env::var_os("ENCODER_STUDIO_RECORD").is_some() {
        std::fs::write(&path, text).unwrap();
        return;
    }
    for (number, (is, was)) in (1..).zip(text.lines().zip(recorded.lines())) {
        assert_eq!(is, was, "{kind}, line {number}");
    }
    assert_eq!(text, recorded, "{kind}");
}

/// Replaces values that differ between runs, such as times and names of backups.
fn steady(value: Value) -> Value {
    match value {
        Value::Object(entries) => entries.into_iter().map(|(key, value)| steady_entry(key, value)).collect(),
        Value::Array(items) => items.into_iter().map(steady).collect(),
        // The sentence contains a measured time.
        Value::String(text) if text.contains(" ms") => without_numbers(&text).into(),
        other => other,
    }
}

/// Replaces each number with a placeholder, because measured times depend on the load of the computer.
fn without_numbers(text: &str) -> String {
    let mut signs = String::new();
    for sign in text.chars() {
        if !sign.is_ascii_digit() {
            signs.push(sign);
        } else if !signs.ends_with('#') {
            signs.push('#');
        }
    }
    signs
}

fn steady_entry(key: String, value: Value) -> (String, Value) {
    let varies = ["t_s", "answer_ms_median", "answer_ms_p99", "backup"].contains(&key.as_str());
    let steady = match value {
        Value::Number(_) if varies => "a number".into(),
        Value::String(_) if varies => "a text".into(),
        other => steady(other),
    };
    (key, steady)
}

#[test]
fn hiperface_output_matches_recording() {
    assert_recorded("hiperface");
}

#[test]
fn biss_output_matches_recording() {
    assert_recorded("biss");
}

#[test]
fn ssi_output_matches_recording() {
    assert_recorded("ssi");
}

#[test]
fn interbus_output_matches_recording() {
    assert_recorded("interbus");
}

#[test]
fn hiperdrive_output_matches_recording() {
    assert_recorded("hiperdrive");
}

#[test]
fn common_output_matches_recording() {
    assert_recorded("common");
}

/// Every type of connection, as the kind of device and the beginning of a link.
const LINKS: [&str; 18] = [
    "hiperface sim:",
    "hiperface serial:none",
    "hiperface tcp:none:1",
    "hiperface bridge:none",
    "hiperface replay:none",
    "biss sim:",
    "biss sim:?bridge=on",
    "biss serial:none",
    "biss tcp:none:1",
    "biss bridge:none",
    "biss bridge:none?pin=on",
    "biss bridge:tcp:none:1",
    "ssi sim:",
    "ssi bridge:none",
    "interbus sim:",
    "interbus modbus:none",
    "hiperdrive sim:",
    "hiperdrive enip:none",
];

/// Recorded link parameters and virtual device settings must stay valid, because users have them in scripts.
#[test]
fn links_accept_recorded_parameters() {
    let (path, bench) = (fixtures().join("links.txt"), Bench::new());
    let mut text = String::new();
    for link in LINKS {
        let (kind, url) = link.split_once(' ').unwrap();
        let url = format!("{url}{}toaster=1", if url.contains('?') { '&' } else { '?' });
        let layout: &[&str] = if kind == "ssi" { &["--layout", "ahm36"] } else { &[] };
        let ran = bench.run(&[&["position", kind, "--link", &url], layout].concat());
        let known = ran.err.split_once(" are ").map(|(_, known)| known.split('.').next().unwrap());
        let _ = writeln!(text, "{link}: {}", known.unwrap_or_else(|| panic!("{link}: {}", ran.err)));
    }
    if std::env::var_os("ENCODER_STUDIO_RECORD").is_some() {
        std::fs::write(&path, &text).unwrap();
    }
    assert_eq!(text, std::fs::read_to_string(&path).unwrap());
}
