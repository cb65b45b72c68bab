//! The `undo` command, and `diff` with an earlier logbook entry. A virtual device in a separate process keeps its
//! memory between commands.

use serde_json::{Value, json};

use super::support::{Bench, Ran, Simulated};

/// A virtual device and the program that uses it.
struct Device {
    bench: Bench,
    kind: &'static str,
    link: String,
    _simulated: Simulated,
}

impl Device {
    fn start(kind: &'static str) -> Self {
        let bench = Bench::new();
        let simulated = Simulated::start(&bench, &[kind, "--listen", "127.0.0.1:0"]);
        let scheme = match kind {
            "interbus" => "modbus",
            "hiperdrive" => "enip",
            _ => "tcp",
        };
        let link = format!("{scheme}:{}", simulated.place);
        Device { bench, kind, link, _simulated: simulated }
    }

    fn run(&self, words: &[&str]) -> Ran {
        self.bench.run(&[words, &["--link", &self.link, "--json"]].concat())
    }

    fn read(&self, item: &str) -> Value {
        self.run(&["read", self.kind, item]).json()["value"].clone()
    }

    /// Writes an item and returns the number of the logbook entry.
    fn write(&self, item: &str, value: &str) -> String {
        let ran = self.run(&["write", self.kind, item, value, "--yes"]);
        assert_eq!(ran.status, Some(0), "{ran:?}");
        self.last_entry()
    }

    /// Returns the number of the newest entry that is not a reading.
    fn last_entry(&self) -> String {
        let log = self.bench.run(&["log", "--json"]).out;
        let entries = log.lines().map(|line| serde_json::from_str::<Value>(line).unwrap());
        let of_reading = ["connected", "status", "procedure"].map(Value::from);
        let last = entries.into_iter().find(|entry| !of_reading.contains(&entry["what"])).unwrap();
        last["entry"].as_str().unwrap().to_owned()
    }

    fn undo(&self, entry: &str) -> Ran {
        self.run(&["undo", entry, "--yes"])
    }
}

#[test]
fn undoes_write() {
    for (kind, item, value, cycles) in [
        ("hiperface", "field:0@3+2", "C0FF", 1),
        ("interbus", "cam:2:5", "10..20", 1),
        ("biss", "0x24:0x10+4", "C0FFEE01", 1),
        ("hiperdrive", "158", "-100000", 1),
    ] {
        let device = Device::start(kind);
        let before = device.read(item);
        let entry = device.write(item, value);
        assert_ne!(device.read(item), before, "{kind}");
        let planned = device.run(&["undo", &entry, "--dry-run"]);
        assert_eq!(planned.status, Some(0), "{kind}: {planned:?}");
        let planned = planned.json();
        assert_eq!(
            (&planned["written"], &planned["write_cycles"], &planned["dry_run"]),
            (&json!(0), &json!(cycles), &json!(true))
        );
        assert!(!planned["operations"].as_array().unwrap().is_empty(), "{planned}");
        let undone = device.undo(&entry);
        assert_eq!(undone.status, Some(0), "{kind}: {undone:?}");
        let undone = undone.json();
        assert_eq!((&undone["write_cycles"], &undone["entry"]), (&json!(cycles), &json!(entry)), "{kind}");
        assert_eq!(undone["written"], undone["verified"], "{kind}");
        assert_eq!(undone["not_undone"], json!([]), "{kind}");
        assert_eq!(device.read(item), before, "{kind}");
        // The undo is an entry with the values exchanged, and can be undone as well.
        assert_eq!(device.undo(&device.last_entry()).status, Some(0), "{kind}");
        assert_ne!(device.read(item), before, "{kind}");
    }
}

#[test]
fn undo_keeps_later_changes() {
    let device = Device::start("hiperface");
    let first = device.write("field:0@3+2", "0001");
    let second = device.write("field:0@4+1", "02");
    let refused = device.undo(&first);
    refused.fails(1, &["changed since", "field:0@4", "expected 01, found 02"]);
    assert_eq!(device.read("field:0@3+2"), "0002");
    assert_eq!(device.undo(&second).status, Some(0));
    assert_eq!(device.undo(&first).status, Some(0));
    // Nothing is left to undo.
    let again = device.undo(&first);
    assert_eq!((again.status, &again.json()["written"]), (Some(0), &json!(0)), "{again:?}");
    let undo = device.last_entry();
    assert!(again.err.contains(&format!("Entry {first} was already undone by entry {undo}, on 20")), "{again:?}");
}

/// The two entries refer to each other, in JSON and in text.
#[test]
fn undo_names_its_entry() {
    let device = Device::start("hiperface");
    let write = device.write("field:0@3+2", "C0FF");
    assert_eq!(device.undo(&write).status, Some(0));
    let undo = device.last_entry();
    let links = |entry: &str| {
        let log = device.bench.run(&["log", "--json"]).out;
        let mut entries = log.lines().map(|line| serde_json::from_str::<Value>(line).unwrap());
        let found = entries.find(|own| own["entry"] == entry).unwrap();
        (found["undoes"].clone(), found["undone_by"].clone())
    };
    assert_eq!(links(&undo), (json!(write), Value::Null));
    assert_eq!(links(&write), (Value::Null, json!(undo)));
    let text = device.bench.run(&["log"]).out;
    for line in [format!("    undoes: entry {write} of 20"), format!("    undone by: entry {undo} of 20")] {
        assert_eq!(text.matches(&line).count(), 1, "{line}: {text}");
    }
    let file = device.bench.file("r.html");
    assert_eq!(device.run(&["report", "hiperface", "-o", &file, "--language", "en"]).status, Some(0));
    let report = device.bench.read("r.html");
    for mark in ["Undoes the write from 20", "Undone on 20"] {
        assert_eq!(report.matches(mark).count(), 1, "{mark}");
    }
    // With the undo undone, the values of the write are in the device again.
    assert_eq!(device.undo(&undo).status, Some(0));
    assert_eq!(links(&write), (Value::Null, Value::Null));
    assert_eq!(links(&undo), (json!(write), json!(device.last_entry())));
}

/// Only the parameters of the undone write are changed.
#[test]
fn undo_keeps_other_parameters() {
    let device = Device::start("hiperdrive");
    let before = device.read("158");
    let first = device.write("158", "-100000");
    device.write("160", "200000");
    assert_eq!(device.undo(&first).status, Some(0));
    assert_eq!((device.read("158"), device.read("160")), (before, json!(200_000)));
}

#[test]
fn undo_restores_deleted_field() {
    let device = Device::start("hiperface");
    let fields = device.run(&["identify", "hiperface"]).json()["data_fields"].to_string();
    assert_eq!(device.run(&["do", "hiperface", "create-field", &fields, "32", "--yes"]).status, Some(0));
    // It is not known whether its bytes have been used since.
    device.undo(&device.last_entry()).fails(1, &[&format!("status:{fields}"), "delete-field"]);
    device.write(&format!("field:{fields}@0+2"), "AB12");
    assert_eq!(device.run(&["do", "hiperface", "delete-field", &fields, "--yes"]).status, Some(0));
    let deleted = device.last_entry();
    let undone = device.undo(&deleted);
    assert_eq!(undone.status, Some(0), "{undone:?}");
    assert_eq!(device.read(&format!("field:{fields}@0+2")), "AB12");
}

#[test]
fn failed_undo_names_alternative() {
    let device = Device::start("hiperface");
    let act = |words: &[&str]| {
        let ran = device.run(&[&["do", "hiperface"], words, &["--yes"]].concat());
        assert_eq!(ran.status, Some(0), "{ran:?}");
        device.last_entry()
    };
    let code = act(&["change-code", "2", "A7"]);
    device.undo(&code).fails(1, &["code 2", "change-code"]);
    let counter = act(&["increment-counter"]);
    device.undo(&counter).fails(1, &["counter", "increment or clear"]);
    let position = act(&["set-position", "4096"]);
    device.undo(&position).fails(1, &["position was set", "help do"]);
    assert_eq!(device.run(&["do", "hiperface", "check"]).status, Some(0));
    device.undo(&device.last_entry()).fails(1, &["check", "nothing to undo"]);
    device.undo("9999").fails(1, &["no entry 9999"]);
    device.undo("first").fails(2, &["number of an entry"]);
}

#[test]
fn rejects_other_device() {
    let device = Device::start("hiperface");
    let entry = device.write("field:0@3+2", "C0FF");
    let other = Simulated::start(&device.bench, &["hiperface", "--listen", "127.0.0.1:0", "--set", "serial=HF0000001"]);
    let link = format!("tcp:{}", other.place);
    device.bench.run(&["undo", &entry, "--yes", "--link", &link]).fails(1, &["HF0000001"]);
    // The virtual encoder in the process has the serial number of the one outside, and is another one.
    device.bench.run(&["undo", &entry, "--yes", "--link", "sim:"]).fails(1, &["virtual"]);
    device.bench.run(&["undo", &entry, "--link", &device.link]).fails(2, &["--yes"]);
}

/// The backup was made on another computer. A file with the same path may exist here.
#[test]
fn missing_backup_names_bench() {
    let device = Device::start("hiperface");
    let entry = device.write("field:0@3+2", "C0FF");
    let logbook = device.bench.path("data/encoder-studio/logbook.sqlite");
    let logbook = rusqlite::Connection::open(logbook).unwrap();
    for (moved, path) in [
        ("UPDATE event SET bench = 'bench 7' WHERE what = 'write'", "backups/hiperface"),
        ("UPDATE event SET backup = '/data/of bench 7/backup.ron' WHERE what = 'write'", "/data/of bench 7/backup.ron"),
    ] {
        logbook.execute(moved, []).unwrap();
        let parts = ["entry", "on bench 7", path, "Run the command there", "copy the file"];
        device.undo(&entry).fails(1, &parts);
        device.run(&["diff", &format!("log:{entry}")]).fails(1, &parts);
    }
    let (file, out) = (device.bench.file("a.ron"), device.bench.file("r.html"));
    device.run(&["save", "hiperface", "-o", &file]);
    device.bench.run(&["report", &file, "-o", &out]);
    assert!(device.bench.read("r.html").contains("on bench 7"));
    assert_eq!(device.read("field:0@3+2"), "C0FF");
}

#[test]
fn compares_with_logbook_entry() {
    let device = Device::start("hiperface");
    let before = device.read("field:0@3+2");
    let entry = device.write("field:0@3+2", "C0FF");
    let moment = format!("log:{entry}");
    let differences = device.run(&["diff", &moment]);
    assert_eq!(differences.status, Some(3), "{differences:?}");
    let found = differences.json_with_status(3)["differences"].clone();
    let (left, right): (String, String) =
        found.as_array().unwrap().iter().fold(Default::default(), |(left, right), own| {
            (left + own["left"].as_str().unwrap(), right + own["right"].as_str().unwrap())
        });
    assert!(before.as_str().unwrap().contains(&left) && "C0FF".contains(&right), "{found}");
    let same = device.bench.run(&["diff", &moment, &moment, "--json"]);
    assert_eq!((same.status, &same.json()["equal"]), (Some(0), &json!(true)));
    assert_eq!(device.run(&["identify", "hiperface"]).status, Some(0));
    let connected = device.bench.run(&["log", "--json", "--limit", "1"]).json();
    let connected = format!("log:{}", connected["entry"].as_str().unwrap());
    device.bench.run(&["diff", &connected, &moment]).fails(1, &["connected", "no backup"]);
    device.bench.run(&["diff", "log:x", &moment]).fails(2, &["log:x"]);
}
