//! The `log` command, which lists what was written, by whom and with which values.

use serde_json::{Value, json};

use super::support::Bench;

fn lines(text: &str) -> Vec<Value> {
    text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

#[test]
fn logs_old_and_new_values() {
    let bench = Bench::new();
    let empty = bench.run(&["log"]);
    assert_eq!((empty.status, empty.out.as_str()), (Some(0), "no entries\n"));
    let empty = bench.run(&["log", "--json"]);
    assert_eq!((empty.status, empty.out.as_str()), (Some(0), ""));
    let old = bench.run(&["read", "hiperface", "field:0@3+2", "--link", "sim:", "--json"]).json();
    let write = ["write", "hiperface", "field:0@3+2", "C0FF", "--yes", "--link", "sim:", "--json"];
    assert_eq!(bench.run(&write).status, Some(0));
    let entry = bench.run(&["log", "--json", "--limit", "1"]).json();
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
fn newest_entry_comes_first() {
    let bench = Bench::new();
    for (device, item, value) in [("hiperface", "field:0@0+1", "77"), ("hiperdrive", "158", "-100000")] {
        assert_eq!(bench.run(&["write", device, item, value, "--yes", "--link", "sim:"]).status, Some(0));
    }
    let devices = |options: &[&str]| {
        let ran = bench.run(&[&["log", "--json"], options].concat());
        assert_eq!(ran.status, Some(0), "{ran:?}");
        lines(&ran.out).iter().map(|line| line["device"].as_str().unwrap().to_owned()).collect::<Vec<_>>()
    };
    // Each command adds an entry for connecting and one for writing.
    assert_eq!(devices(&[]), ["hiperdrive", "hiperdrive", "hiperface", "hiperface"]);
    assert_eq!(devices(&["--limit", "1"]), ["hiperdrive"]);
    assert_eq!(devices(&["--device", "hiperface"]), ["hiperface", "hiperface"]);
    assert_eq!(devices(&["--serial-number", "GB0450179"]), ["hiperface", "hiperface"]);
    assert_eq!(devices(&["--search", "LOWER limit"]), ["hiperdrive"]);
    assert_eq!(devices(&["--since", "2020-01-01"]).len(), 4);
    assert_eq!(devices(&["--since", "2999-12-31T23:59:59Z"]), [] as [String; 0]);
    let hour_ahead = jiff::Zoned::now().checked_add(jiff::Span::new().hours(1)).unwrap();
    for form in ["%Y-%m-%dT%H:%M", "%Y-%m-%d %H:%M:%S"] {
        let local = hour_ahead.strftime(form).to_string();
        assert_eq!(devices(&["--since", &local]), [] as [String; 0], "{local}");
    }
    bench.run(&["log", "--since", "yesterday"]).fails(2, &["--since", "2026-11-27"]);
    bench.run(&["log", "--device", "toaster"]).fails(2, &["toaster", "hiperface"]);
}

/// Neither the old nor the new access code appears in an entry.
#[test]
fn logbook_omits_access_codes() {
    let bench = Bench::new();
    let change = ["do", "hiperface", "change-code", "2", "A7", "--yes", "--link", "sim:", "--json"];
    assert_eq!(bench.run(&change).status, Some(0));
    let entry = bench.run(&["log", "--json", "--limit", "1"]).json();
    assert_eq!((&entry["items"][0]["old"], &entry["items"][0]["new"]), (&Value::Null, &Value::Null));
    assert!(!entry["text"].to_string().contains("A7"), "{entry}");
}

#[test]
fn corrupt_logbook_is_kept_and_replaced() {
    let bench = Bench::new();
    std::fs::create_dir_all(bench.path("data/encoder-studio")).unwrap();
    bench.write("data/encoder-studio/logbook.sqlite", "no database, and not a short one at that. ".repeat(30));
    let ran = bench.run(&["log"]);
    assert_eq!((ran.status, ran.out.as_str()), (Some(0), "no entries\n"));
    ran.assert_stderr(&["logbook-damaged-", "write cycles are missing"]);
    let names = std::fs::read_dir(bench.path("data/encoder-studio")).unwrap().map(|entry| entry.unwrap().file_name());
    let kept = names.map(|name| name.into_string().unwrap()).find(|name| name.starts_with("logbook-damaged-")).unwrap();
    assert!(bench.read(&format!("data/encoder-studio/{kept}")).starts_with("no database"));
    // Commands continue to work, but a write must be permitted explicitly, because the earlier write cycles are in the
    // damaged file.
    let store = ["write", "interbus", "preset", "7", "--yes", "--link", "sim:"];
    let write = ["write", "hiperface", "field:0@3+2", "C0FF", "--yes", "--link", "sim:"];
    for words in [&store, &write] {
        bench.run(words).fails(1, &["was damaged", "unknown", "--force-wear"]);
        assert_eq!(bench.run(&[&words[..], &["--force-wear"]].concat()).status, Some(0));
    }
    // Without that file, the count is only a minimum. Writes to a memory that wears out quickly must still be permitted
    // explicitly.
    std::fs::remove_file(bench.path(&format!("data/encoder-studio/{kept}"))).unwrap();
    assert_eq!(bench.run(&write).status, Some(0));
    bench.run(&store).fails(1, &["at least 1 of", "the file was damaged", "--force-wear"]);
}

/// Returns the kinds of the entries, oldest first.
fn kinds(bench: &Bench, options: &[&str]) -> Vec<String> {
    let ran = bench.run(&[&["log", "--json"], options].concat());
    assert_eq!(ran.status, Some(0), "{ran:?}");
    lines(&ran.out).iter().rev().map(|line| line["what"].as_str().unwrap().to_owned()).collect()
}

#[test]
fn logs_each_event_kind() {
    for device in ["hiperface", "biss", "interbus", "hiperdrive"] {
        let bench = Bench::new();
        let file = bench.path("saved.ron");
        let file = file.to_str().unwrap();
        for command in [vec!["identify", device], vec!["save", device, "-o", file], vec!["do", device, "check"]] {
            let ran = bench.run(&[command.as_slice(), &["--link", "sim:"]].concat());
            assert_eq!(ran.status, Some(0), "{device}: {ran:?}");
        }
        let found = kinds(&bench, &["--device", device]);
        let expected = ["connected", "connected", "backup", "connected", "check"];
        // These kinds are left out: a check may read status codes, and reading cam programs may cost stores, which are
        // counted.
        let is_own = |kind: &&str| !["status", "procedure"].contains(kind);
        let found: Vec<&str> = found.iter().map(String::as_str).filter(is_own).collect();
        assert_eq!(found, expected, "{device}");
        let saved = lines(&bench.run(&["log", "--json", "--search", "saved to"]).out);
        assert_eq!((saved.len(), &saved[0]["backup"]), (1, &json!(file)), "{device}");
        let check = lines(&bench.run(&["log", "--json", "--limit", "1"]).out);
        assert!(check[0]["text"].as_str().unwrap().contains("good"), "{check:?}");
    }
}

/// A command that only reads works without a logbook, but reports on stderr that nothing was recorded.
#[test]
fn reading_needs_no_logbook() {
    let bench = Bench::new();
    std::fs::create_dir_all(bench.path("data/encoder-studio/logbook.sqlite")).unwrap();
    let ran = bench.run(&["identify", "hiperface", "--link", "sim:", "--json"]);
    assert_eq!(ran.status, Some(0), "{ran:?}");
    assert_eq!(ran.json()["serial_number"], "GB0450179");
    assert!(ran.err.contains("logbook.sqlite") && ran.err.contains("cannot be opened"), "{ran:?}");
}

#[test]
fn filters_entries_by_asset() {
    let bench = Bench::new();
    let write = |value: &str, options: &[&str]| {
        let command = ["write", "hiperface", "field:0@3+2", value, "--yes", "--link", "sim:"];
        assert_eq!(bench.run(&[&command, options].concat()).status, Some(0));
    };
    write("0001", &[]);
    write("0002", &["--asset", "Achse 3 · Süd"]);
    write("0003", &[]);
    assert_eq!(kinds(&bench, &[]), ["connected", "write", "connected", "assigned", "write", "connected", "write"]);
    let of = |asset: &str| lines(&bench.run(&["log", "--json", "--asset", asset]).out);
    let entries = of("Achse 3 · Süd");
    assert_eq!(entries.len(), 4, "an assignment is valid until the next one");
    assert!(entries.iter().all(|entry| entry["asset"] == "Achse 3 · Süd"));
    assert_eq!(entries[3]["items"], json!([{"item": "asset", "name": null, "old": null, "new": "Achse 3 · Süd"}]));
    assert_eq!(of("Achse 3").len(), 0);
    let identify = bench.run(&["do", "hiperface", "check", "--asset", "shelf", "--link", "sim:"]);
    assert_eq!(identify.status, Some(0), "{identify:?}");
    assert_eq!((of("shelf").len(), of("Achse 3 · Süd").len()), (2, 5));
    assert!(bench.run(&["log"]).out.contains("GB0450179 (virtual) at shelf: check"));
    for (bad, words) in [("", "empty"), ("a\nb", "control character"), (&"x".repeat(81), "at most 80")] {
        bench.run(&["save", "hiperface", "-o", "x.ron", "--asset", bad, "--link", "sim:"]).fails(2, &[words]);
    }
}

#[test]
fn failed_commands_assign_no_asset() {
    let bench = Bench::new();
    let profile = bench.path("saved.ron");
    let profile = profile.to_str().unwrap();
    assert_eq!(bench.run(&["save", "hiperface", "-o", profile, "--link", "sim:"]).status, Some(0));
    let missing = bench.path("missing/report.html");
    let missing = missing.to_str().unwrap();
    let cases: [(&[&str], i32); 4] = [
        (&["restore", profile, "--dry-run"], 0),
        (&["write", "hiperface", "field:0@3000+2", "0001", "--yes"], 1),
        (&["save", "hiperface", "-o", missing], 1),
        (&["report", "hiperface", "-o", missing], 1),
    ];
    for (command, status) in cases {
        let ran = bench.run(&[command, &["--asset", "M-17", "--link", "sim:"]].concat());
        assert_eq!(ran.status, Some(status), "{ran:?}");
        assert!(!kinds(&bench, &[]).contains(&"assigned".to_owned()), "{command:?}");
    }
}

/// A company's rules may forbid user names in the logbook.
#[test]
fn settings_choose_user_name() {
    let bench = Bench::new();
    std::fs::create_dir_all(bench.path("config/encoder-studio")).unwrap();
    let user_with = |settings: &str| {
        bench.write("config/encoder-studio/settings.ron", settings);
        assert_eq!(bench.run(&["identify", "hiperface", "--link", "sim:"]).status, Some(0));
        bench.run(&["log", "--json", "--limit", "1"]).json()["user"].clone()
    };
    let full = user_with("(theme: Dark)");
    let initials = user_with("(user_name: Initials)");
    assert_eq!(user_with("(user_name: Off)"), Value::Null);
    // Other settings that this version cannot read are ignored.
    assert_eq!(user_with("(theme: Pink, user_name: Off)"), Value::Null);
    if let (Some(full), Some(initials)) = (full.as_str(), initials.as_str()) {
        assert!(!initials.is_empty() && initials.chars().count() <= full.chars().count(), "{full} {initials}");
        assert!(initials.chars().all(|c| c.is_uppercase() || c.is_numeric()), "{initials}");
    }
}
