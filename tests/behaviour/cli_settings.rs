//! Settings files that can be read only in part.

use serde_json::Value;

use super::postgres::Postgres;
use super::support::Bench;

const IDENTIFY: [&str; 4] = ["identify", "hiperface", "--link", "sim:"];
/// A write to an encoder whose memory wears out quickly.
const WRITE: [&str; 7] = ["write", "interbus", "preset", "7", "--yes", "--link", "sim:"];

fn bench_with_settings(settings: &str) -> Bench {
    let bench = Bench::new();
    std::fs::create_dir_all(bench.path("config/encoder-studio")).unwrap();
    bench.write("config/encoder-studio/settings.ron", settings);
    bench
}

fn last_entry_user(bench: &Bench) -> Value {
    bench.run(&["log", "--json", "--limit", "1"]).json()["user"].clone()
}

#[test]
fn broken_settings_count_as_unreachable_server() {
    let bench = bench_with_settings("(\n    user_name: Initials,\n    logbook: postgres,\n)");
    let ran = bench.run(&IDENTIFY);
    assert_eq!(ran.status, Some(0), "{ran:?}");
    for words in ["settings.ron could not be read completely: line 3, column ", "unknown whether the logbook is shared"]
    {
        assert_eq!(ran.err.matches(words).count(), 1, "{words}: {ran:?}");
    }
    assert_ne!(last_entry_user(&bench), Value::Null, "the rule about names can be read");
    bench.run(&WRITE).fails(1, &["at least 0 of", "--force-wear"]);
    assert_eq!(bench.run(&[&WRITE[..], &["--force-wear"]].concat()).status, Some(0));
}

#[test]
fn unreadable_rule_hides_user() {
    let bench = bench_with_settings("(user_name: Initials");
    let ran = bench.run(&IDENTIFY);
    assert!(ran.status == Some(0) && ran.err.contains("line 1, column "), "{ran:?}");
    assert_eq!(last_entry_user(&bench), Value::Null);
    // A folder in its place cannot be read at all.
    let bench = Bench::new();
    std::fs::create_dir_all(bench.path("config/encoder-studio/settings.ron")).unwrap();
    let ran = bench.run(&IDENTIFY);
    assert!(ran.status == Some(0) && ran.err.contains("The settings could not be read."), "{ran:?}");
    assert_eq!(last_entry_user(&bench), Value::Null);
    bench.run(&WRITE).fails(1, &["at least 0 of"]);
}

#[test]
fn reports_location_of_misspelt_setting() {
    let bench = bench_with_settings("(theme: Dark,\n  logbok: \"postgres://db.plant/logs\")");
    let ran = bench.run(&IDENTIFY);
    assert!(ran.status == Some(0) && ran.err.contains("line 2, column 3: logbok is not a setting"), "{ran:?}");
}

/// A broken setting is reported, but ignored if it does not concern the logbook.
#[test]
fn unrelated_broken_setting_allows_write() {
    let bench = bench_with_settings("(theme: Pink)");
    let ran = bench.run(&WRITE);
    assert!(ran.status == Some(0) && ran.err.contains("line 1, column ") && ran.err.contains("Pink"), "{ran:?}");
    assert!(!ran.err.contains("shared"), "{ran:?}");
}

#[test]
fn environment_server_needs_no_settings() {
    let Some(server) = Postgres::start() else { return };
    let bench = bench_with_settings("(");
    let ran = bench.run_with_server(&server.url(), &WRITE);
    assert!(ran.status == Some(0) && !ran.err.contains("shared"), "{ran:?}");
    assert_eq!(server.sql("SELECT what FROM event ORDER BY id"), ["connected", "write"]);
}
