//! The command `log`: what was written, by whom and with which values.

use serde_json::{Value, json};

use super::support::Bench;

fn lines(text: &str) -> Vec<Value> {
    text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

#[test]
fn a_write_is_logged_with_its_old_and_new_values() {
    let bench = Bench::new();
    let empty = bench.run(&["log"]);
    assert_eq!((empty.status, empty.out.as_str()), (Some(0), "no entries\n"));
    let empty = bench.run(&["log", "--json"]);
    assert_eq!((empty.status, empty.out.as_str()), (Some(0), ""));
    let old = bench.run(&["read", "hiperface", "field:0@3+2", "--link", "sim:", "--json"]).json();
    let write = ["write", "hiperface", "field:0@3+2", "C0FF", "--yes", "--link", "sim:", "--json"];
    assert_eq!(bench.run(&write).status, Some(0));
    let entry = bench.run(&["log", "--json"]).json();
    assert_eq!(entry["items"], json!([{"item": "field:0@3+2", "name": null, "old": old["value"], "new": "C0FF"}]));
    let expected = [
        ("device", json!("hiperface")),
        ("type", json!("37h")),
        ("serial_number", json!("GB0450179")),
        ("virtual", json!(true)),
        ("what", json!("write")),
        ("result", json!("done")),
        ("failure", Value::Null),
        ("write_cycles", json!(1)),
        ("version", json!(env!("CARGO_PKG_VERSION"))),
    ];
    for (key, value) in expected {
        assert_eq!(entry[key], value, "{key}");
    }
    assert!(entry["bench"].as_str().is_some_and(|bench| !bench.is_empty()), "{entry}");
    assert!(std::fs::read_to_string(entry["backup"].as_str().unwrap()).unwrap().contains("before-image"));
    let text = bench.run(&["log"]).out;
    for words in ["GB0450179 (virtual): write, done, 1 write cycle", "field:0@3+2: ", "→ C0FF", "backup: "] {
        assert!(text.contains(words), "{words}: {text}");
    }
}

#[test]
fn entries_are_selected_and_the_newest_is_first() {
    let bench = Bench::new();
    for (device, item, value) in [("hiperface", "field:0@0+1", "77"), ("hiperdrive", "158", "-100000")] {
        assert_eq!(bench.run(&["write", device, item, value, "--yes", "--link", "sim:"]).status, Some(0));
    }
    let devices = |options: &[&str]| {
        let ran = bench.run(&[&["log", "--json"], options].concat());
        assert_eq!(ran.status, Some(0), "{ran:?}");
        lines(&ran.out).iter().map(|line| line["device"].as_str().unwrap().to_owned()).collect::<Vec<_>>()
    };
    assert_eq!(devices(&[]), ["hiperdrive", "hiperface"]);
    assert_eq!(devices(&["--limit", "1"]), ["hiperdrive"]);
    assert_eq!(devices(&["--device", "hiperface"]), ["hiperface"]);
    assert_eq!(devices(&["--serial-number", "GB0450179"]), ["hiperface"]);
    assert_eq!(devices(&["--search", "LOWER limit"]), ["hiperdrive"]);
    assert_eq!(devices(&["--since", "2020-01-01"]).len(), 2);
    assert_eq!(devices(&["--since", "2999-12-31T23:59:59Z"]), [] as [String; 0]);
    bench.run(&["log", "--since", "yesterday"]).fails(2, &["--since", "2026-11-27"]);
    bench.run(&["log", "--device", "toaster"]).fails(2, &["toaster", "hiperface"]);
}

/// An access code is in no entry, neither the old nor the new one.
#[test]
fn access_codes_are_not_in_the_logbook() {
    let bench = Bench::new();
    let change = ["do", "hiperface", "change-code", "2", "A7", "--yes", "--link", "sim:", "--json"];
    assert_eq!(bench.run(&change).status, Some(0));
    let entry = bench.run(&["log", "--json"]).json();
    assert_eq!((&entry["items"][0]["old"], &entry["items"][0]["new"]), (&Value::Null, &Value::Null));
    assert!(!entry["text"].to_string().contains("A7"), "{entry}");
}

#[test]
fn a_damaged_logbook_is_named() {
    let bench = Bench::new();
    std::fs::create_dir_all(bench.path("data/encoder-studio")).unwrap();
    bench.write("data/encoder-studio/logbook.sqlite", "no database, and not a short one at that. ".repeat(30));
    bench.run(&["log"]).fails(1, &["logbook.sqlite", "damaged"]);
}
