//! Tests of the logbook on disk: counting, use by two windows, and everything that can make its file unusable.

mod undo;

use std::{fmt, fs};

use super::*;
use crate::profile::ChangedItem;
use crate::store::{FileErrorKind, Store};

fn at(second: i64) -> Timestamp {
    Timestamp::from_second(1_795_263_287 + second).unwrap()
}

fn device(serial_number: &str) -> DeviceKey {
    DeviceKey {
        kind: "hiperface".into(),
        device_type: "37h".into(),
        serial_number: serial_number.into(),
        is_virtual: false,
    }
}

/// Returns a folder, and the path of a logbook inside it.
fn place() -> (tempfile::TempDir, PathBuf) {
    let root = tempfile::tempdir().unwrap();
    let path = Store::at_root(root.path()).logbook_path();
    (root, path)
}

fn intent(item: &str, planned_cycles: u64, backup: Option<&Path>) -> Intent {
    let items = vec![ChangedItem::new(item, None, None)];
    Intent { kind: EntryKind::Write, items, planned_cycles, backup: backup.map(Path::to_owned), undoes: None }
}

fn problem<T: fmt::Debug>(result: Result<T, LogbookError>) -> LogbookErrorKind {
    result.unwrap_err().problem
}

#[test]
fn counts_cycles_per_device() {
    let (_root, path) = place();
    let mut logbook = Logbook::open(&path).unwrap();
    let own = device("1");
    let others = [
        device("2"),
        DeviceKey { kind: "biss".into(), ..own.clone() },
        DeviceKey { device_type: "27h".into(), ..own.clone() },
        DeviceKey { is_virtual: true, ..own.clone() },
    ];
    assert_eq!(logbook.write_cycles(&own), Ok(0));
    for (spent, outcome) in [(8, Outcome::Done), (3, Outcome::Failed("no reply".into())), (0, Outcome::Cancelled)] {
        let id = logbook.record_intent(at(0), &own, &intent("data field 1", 8, None)).unwrap();
        logbook.record_outcome(id, at(1), outcome, spent).unwrap();
    }
    assert_eq!(logbook.write_cycles(&own), Ok(11));
    for other in &others {
        assert_eq!(logbook.write_cycles(other), Ok(0), "{other:?}");
        logbook.record_intent(at(0), other, &intent("x", 100, None)).unwrap();
    }
    assert_eq!(logbook.write_cycles(&own), Ok(11));
}

#[test]
fn unfinished_intent_counts_planned_cycles() {
    let (_root, path) = place();
    let mut logbook = Logbook::open(&path).unwrap();
    logbook.record_intent(at(0), &device("1"), &intent("data field 1", 8, None)).unwrap();
    // The program dies here.
    drop(logbook);
    let logbook = Logbook::open(&path).unwrap();
    assert_eq!(logbook.write_cycles(&device("1")), Ok(8));
    assert_eq!(logbook.history(&device("1"), 1).unwrap()[0].conclusion, None);
}

#[test]
fn history_is_complete_newest_first() {
    let (_root, path) = place();
    let mut logbook = Logbook::open(&path).unwrap();
    let own = device("A/B ä\0");
    let backup = path.with_file_name("a backup.ron");
    let first = logbook.record_intent(at(0), &own, &intent("first", 1, Some(&backup))).unwrap();
    let second = logbook.record_intent(at(5), &own, &intent("second", 2, None)).unwrap();
    logbook.record_intent(at(6), &device("2"), &intent("another", 1, None)).unwrap();
    logbook.record_outcome(first, at(1), Outcome::Failed(String::new()), 1).unwrap();

    let history = logbook.history(&own, 10).unwrap();
    let conclusion = WriteResult { at: at(1), outcome: Outcome::Failed(String::new()), cycles_spent: 1 };
    let entry = |id, second, item: &str, planned_cycles| Entry {
        id,
        uid: logbook.entry(id).unwrap().unwrap().uid,
        kind: EntryKind::Write,
        at: at(second),
        device: own.clone(),
        asset: None,
        description: item.to_owned(),
        items: vec![ChangedItem::new(item, None, None)],
        planned_cycles,
        backup: None,
        origin: Origin::of_this_process(),
        undoes: None,
        undone_by: None,
        conclusion: None,
    };
    let first = Entry { backup: Some(backup), conclusion: Some(conclusion), ..entry(first, 0, "first", 1) };
    let expected = [entry(second, 5, "second", 2), first];
    assert_eq!(history, expected);
    assert_eq!(logbook.history(&own, 1).unwrap(), expected[..1]);
    assert_eq!(logbook.history(&own, 0), Ok(Vec::new()));
}

#[test]
fn concludes_entry_once() {
    let (_root, path) = place();
    let mut logbook = Logbook::open(&path).unwrap();
    let id = logbook.record_intent(at(0), &device("1"), &intent("x", 8, None)).unwrap();
    logbook.record_outcome(id, at(1), Outcome::Done, 8).unwrap();
    let not_open = LogbookErrorKind::NotOpen { entry: id };
    assert_eq!(problem(logbook.record_outcome(id, at(2), Outcome::Cancelled, 0)), not_open);
    assert!(logbook.record_outcome(EntryId(99), at(2), Outcome::Done, 0).is_err());
    assert_eq!(logbook.write_cycles(&device("1")), Ok(8));
}

#[test]
fn sum_saturates_on_absurd_count() {
    let (_root, path) = place();
    let mut logbook = Logbook::open(&path).unwrap();
    for _ in 0..3 {
        logbook.record_intent(at(0), &device("1"), &intent("x", u64::MAX, None)).unwrap();
    }
    assert_eq!(logbook.write_cycles(&device("1")), Ok(3 * u64::from(u32::MAX)));
}

#[test]
fn windows_share_logbook() {
    let (_root, path) = place();
    let mut first = Logbook::open(&path).unwrap();
    let mut second = Logbook::open(&path).unwrap();
    let id = first.record_intent(at(0), &device("1"), &intent("x", 8, None)).unwrap();
    assert_eq!(second.write_cycles(&device("1")), Ok(8));
    second.record_intent(at(0), &device("1"), &intent("y", 1, None)).unwrap();
    second.record_outcome(id, at(1), Outcome::Done, 2).unwrap();
    assert_eq!(first.write_cycles(&device("1")), Ok(3));
}

#[test]
fn concurrent_writers_keep_all_entries() {
    let (_root, path) = place();
    std::thread::scope(|scope| {
        for _ in 0..6 {
            scope.spawn(|| {
                let mut logbook = Logbook::open(&path).unwrap();
                for _ in 0..5 {
                    logbook.record_intent(at(0), &device("1"), &intent("x", 1, None)).unwrap();
                }
            });
        }
    });
    assert_eq!(Logbook::open(&path).unwrap().write_cycles(&device("1")), Ok(30));
}

#[test]
fn reports_locked_logbook() {
    let (_root, path) = place();
    let patience = Duration::from_millis(20);
    let mut logbook = Logbook::open_with_timeout(&path, patience).unwrap();
    let other = Connection::open(&path).unwrap();
    other.execute_batch("BEGIN IMMEDIATE").unwrap();
    assert_eq!(problem(logbook.record_intent(at(0), &device("1"), &intent("x", 1, None))), LogbookErrorKind::Locked);
    // Reading, and opening to read, do not wait.
    assert_eq!(Logbook::open_with_timeout(&path, patience).unwrap().write_cycles(&device("1")), Ok(0));
    other.execute_batch("ROLLBACK").unwrap();
    logbook.record_intent(at(0), &device("1"), &intent("x", 1, None)).unwrap();
}

#[test]
fn does_not_change_newer_logbook() {
    let (_root, path) = place();
    drop(Logbook::open(&path).unwrap());
    for found in [schema::SCHEMA_VERSION + 1, i64::from(i32::MAX), -1] {
        Connection::open(&path).unwrap().pragma_update(None, "user_version", found).unwrap();
        let before = fs::read(&path).unwrap();
        assert_eq!(problem(Logbook::open(&path)), LogbookErrorKind::Newer { found, known: schema::SCHEMA_VERSION });
        assert_eq!(fs::read(&path).unwrap(), before, "{found}");
    }
}

#[test]
fn keeps_newer_write_ahead_log() {
    let (_root, path) = place();
    drop(Logbook::open(&path).unwrap());
    let newer = Connection::open(&path).unwrap();
    newer.set_db_config(rusqlite::config::DbConfig::SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, true).unwrap();
    newer.pragma_update(None, "user_version", 77).unwrap();
    drop(newer);
    let wal = path.with_extension("sqlite-wal");
    let before = [&path, &wal].map(|path| fs::read(path).unwrap());
    assert!(matches!(problem(Logbook::open(&path)), LogbookErrorKind::Newer { found: 77, .. }));
    assert_eq!([&path, &wal].map(|path| fs::read(path).unwrap()), before);
}

#[test]
fn sets_damaged_logbook_aside() {
    let (root, path) = place();
    drop(Logbook::open(&path).unwrap());
    let whole = fs::read(&path).unwrap();
    let mut shredded = whole.clone();
    shredded[100..].fill(0xA5);
    let cases = [
        ("empty", Vec::new()),
        ("two bytes", b"xy".to_vec()),
        ("a text", b"this is a text, and not a short one at that. ".repeat(30)),
        ("a header only", whole[..100].to_vec()),
        ("cut off", whole[..whole.len() / 2].to_vec()),
        ("shredded", shredded),
    ];
    for (label, content) in cases {
        fs::write(&path, &content).unwrap();
        let record = || {
            Logbook::open(&path).and_then(|mut logbook| {
                logbook.record_intent(at(0), &device("1"), &intent("x", 1, None))?;
                Ok((logbook.write_cycles(&device("1"))?, logbook.damaged_file()?))
            })
        };
        // Some damage shows at the first use only.
        let (cycles, kept) = record().or_else(|_| record()).unwrap();
        let kept = kept.unwrap_or_else(|| panic!("{label}"));
        assert_eq!((cycles, kept.parent()), (1, path.parent()), "{label}");
        assert_eq!(fs::read(&kept).unwrap(), content, "{label}");
        assert!(kept.starts_with(root.path()), "{label}");
    }
}

#[test]
fn reports_missing_logbook_folder() {
    let (root, path) = place();
    fs::create_dir_all(&path).unwrap();
    assert_eq!(problem(Logbook::open(&path)), LogbookErrorKind::NoAccess);
    let file = root.path().join("file");
    fs::write(&file, "x").unwrap();
    let LogbookErrorKind::Folder(error) = problem(Logbook::open(&file.join("logbook.sqlite"))) else { panic!() };
    assert_eq!(error.problem, FileErrorKind::NotFolder);
}

/// Schema 2 is created with its original statements.
#[test]
fn older_logbook_keeps_entries() {
    let (_root, path) = place();
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    let old = Connection::open(&path).unwrap();
    for step in &schema::STEPS[..2] {
        old.execute_batch(step).unwrap();
    }
    old.execute_batch(
        "INSERT INTO entry VALUES (1, '2026-11-01T08:00:00Z', 'hiperface', '37h', '1', 0, 'field:1@3+2', 8, '/b.ron',
                                   '2026-11-01T08:00:02Z', 'failed', 'no reply', 3);
         INSERT INTO entry VALUES (2, '2026-11-03T08:00:00Z', 'hiperface', '37h', '1', 0, 'counter', 1, NULL,
                                   NULL, NULL, NULL, NULL);
         INSERT INTO status VALUES (1, '2026-11-02T08:00:00Z', 'hiperface', '37h', '1', 0, '08h, 1Eh');
         PRAGMA user_version = 2;",
    )
    .unwrap();
    drop(old);
    let mut logbook = Logbook::open(&path).unwrap();
    assert_eq!(logbook.write_cycles(&device("1")), Ok(4));
    let entries = logbook.entries(&EntryFilter::default(), 10).unwrap();
    let told: Vec<_> =
        entries.iter().map(|entry| (entry.kind, entry.description.as_str(), entry.write_cycles())).collect();
    let expected =
        [(EntryKind::Write, "counter", 1), (EntryKind::Status, "08h, 1Eh", 0), (EntryKind::Write, "field:1@3+2", 3)];
    assert_eq!(told, expected);
    assert_eq!(entries[2].backup.as_deref(), Some(Path::new("/b.ron")));
    assert_eq!(entries[2].origin, Origin::default());
    let end = entries[2].conclusion.as_ref().unwrap();
    assert_eq!(end.outcome, Outcome::Failed("no reply".to_owned()));
    // The open intent can still be concluded, and new entries follow the old ones.
    logbook.record_outcome(entries[0].id, at(0), Outcome::Done, 1).unwrap();
    assert!(logbook.record_intent(at(0), &device("1"), &intent("x", 1, None)).unwrap() > entries[0].id);
}

#[test]
fn filters_and_searches_entries() {
    let (_root, path) = place();
    let mut logbook = Logbook::open(&path).unwrap();
    logbook.record_intent(at(0), &device("GB1"), &intent("field:1", 1, None)).unwrap();
    let status = |codes| Event::new(EntryKind::Status, codes);
    logbook.record(at(10), &device("GB2"), &status("08h overheated, 100 % of 5_0")).unwrap();
    let biss = DeviceKey { kind: "biss".into(), ..device("GB1") };
    logbook.record_intent(at(20), &biss, &intent("0x6E", 1, None)).unwrap();
    let found = |filter: EntryFilter| {
        let entries = logbook.entries(&filter, 10).unwrap();
        entries.into_iter().map(|entry| entry.at).collect::<Vec<_>>()
    };
    let all = EntryFilter::default();
    assert_eq!(found(all.clone()), [at(20), at(10), at(0)]);
    assert_eq!(found(EntryFilter { kind: Some("biss".into()), ..all.clone() }), [at(20)]);
    assert_eq!(found(EntryFilter { serial_number: Some("GB1".into()), ..all.clone() }), [at(20), at(0)]);
    assert_eq!(found(EntryFilter { since: Some(at(10)), ..all.clone() }), [at(20), at(10)]);
    let half = at(10) + jiff::SignedDuration::from_millis(500);
    logbook.record(half, &device("GB3"), &status("1Eh")).unwrap();
    let found = |filter: EntryFilter| {
        let entries = logbook.entries(&filter, 10).unwrap();
        entries.into_iter().map(|entry| entry.at).collect::<Vec<_>>()
    };
    let since = |since| found(EntryFilter { since: Some(since), ..all.clone() });
    assert_eq!((since(at(10)).len(), since(at(11)).len()), (3, 1), "half a second later");
    let search = |text: &str| found(EntryFilter { search: text.to_owned(), ..all.clone() });
    assert_eq!(search("OVERHEATED"), [at(10)]);
    assert_eq!((search("100 %"), search("5_0")), (vec![at(10)], vec![at(10)]), "no character has a special meaning");
    assert_eq!(search("5%0"), []);
    assert_eq!(search("gb2"), [at(10)]);
    assert_eq!(logbook.status_entries(&device("GB2"), 10).unwrap().len(), 1);
    assert_eq!(logbook.history(&device("GB2"), 10).unwrap(), []);
}

/// Schema 3 is created with its original statements, and its rows are as that version wrote them.
#[test]
fn schema_3_logbook_keeps_entries() {
    let (_root, path) = place();
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    let old = Connection::open(&path).unwrap();
    for step in &schema::STEPS[..3] {
        old.execute_batch(step).unwrap();
    }
    old.execute_batch(
        r#"INSERT INTO event VALUES (1, 'aa', '2026-11-26T08:00:00Z', 'write', 'hiperface', '37h', '1', 0,
               'field:1@3+2: 00FF → C0FF', '[{"item":"field:1@3+2","old":"00FF","new":"C0FF"}]', 1, '/b.ron', 'bench 1',
               'user', '1.5.0');
           INSERT INTO result VALUES ('aa', '2026-11-26T08:00:01Z', 'done', NULL, 1);
           INSERT INTO event VALUES (2, 'bb', '2026-11-26T09:00:00Z', 'status', 'hiperface', '37h', '1', 0, '1Eh', '[]', 0,
               NULL, 'bench 1', NULL, '1.5.0');
           PRAGMA user_version = 3;"#,
    )
    .unwrap();
    drop(old);
    let mut logbook = Logbook::open(&path).unwrap();
    let [noon, later] = ["2026-11-26T12:00:00Z", "2026-11-26T12:00:00.5Z"].map(|time| time.parse().unwrap());
    logbook.assign(noon, &device("1"), &"M-17".parse().unwrap()).unwrap();
    logbook.record(later, &device("1"), &Event::new(EntryKind::Connected, "identified")).unwrap();
    let entries = logbook.entries(&EntryFilter::default(), 10).unwrap();
    let told: Vec<_> = entries.iter().map(|entry| (entry.kind.keyword(), entry.asset.as_deref())).collect();
    assert_eq!(told, [("connected", Some("M-17")), ("assigned", Some("M-17")), ("status", None), ("write", None)]);
    assert_eq!(entries[3].items, [ChangedItem::new("field:1@3+2", Some("00FF".into()), Some("C0FF".into()))]);
    assert_eq!(entries[3].origin.user.as_deref(), Some("user"));
    assert_eq!(logbook.write_cycles(&device("1")), Ok(1));
    let writes = logbook.history(&device("1"), 10).unwrap();
    assert_eq!(writes.len(), 1, "a connection is not a write");
}

/// Entries stay with the asset when its encoder is replaced, and do not move with the old encoder.
#[test]
fn asset_lists_entries_of_assigned_devices() {
    let (_root, path) = place();
    let mut logbook = Logbook::open(&path).unwrap();
    let (old, new) = (device("old"), device("new"));
    let [motor, shelf] = ["motor 17", "shelf"].map(|name| name.parse::<AssetName>().unwrap());
    let write = |logbook: &mut Logbook, second, of: &DeviceKey, item: &str| {
        logbook.record_intent(at(second), of, &intent(item, 1, None)).unwrap();
    };
    write(&mut logbook, 0, &old, "before");
    logbook.assign(at(1), &old, &motor).unwrap();
    logbook.assign(at(2), &old, &motor).unwrap();
    write(&mut logbook, 3, &old, "first encoder");
    logbook.assign(at(4), &old, &shelf).unwrap();
    write(&mut logbook, 5, &old, "on the shelf");
    logbook.assign(at(6), &new, &motor).unwrap();
    write(&mut logbook, 7, &new, "second encoder");
    // Another kind of device may have the same serial number.
    write(&mut logbook, 8, &DeviceKey { kind: "biss".into(), ..new.clone() }, "another kind");
    let of = |asset: &str| {
        let filter = EntryFilter { asset: Some(asset.to_owned()), ..EntryFilter::default() };
        let entries = logbook.entries(&filter, 10).unwrap();
        entries.into_iter().map(|entry| entry.description).collect::<Vec<_>>()
    };
    let assigned = "asset: → motor 17";
    assert_eq!(of("motor 17"), ["second encoder", assigned, "first encoder", assigned]);
    assert_eq!(of("shelf"), ["on the shelf", "asset: motor 17 → shelf"]);
    assert_eq!(of("Motor 17"), [] as [String; 0]);
    assert_eq!(logbook.assets().unwrap(), ["motor 17", "shelf"]);
    let search = |text: &str| {
        let filter = EntryFilter { search: text.to_owned(), ..EntryFilter::default() };
        let entries = logbook.entries(&filter, 10).unwrap();
        entries.into_iter().map(|entry| entry.description).collect::<Vec<_>>()
    };
    assert_eq!(search("Motor 17"), ["second encoder", assigned, "asset: motor 17 → shelf", "first encoder", assigned]);
}

#[test]
fn finds_entry_by_number() {
    let (_root, path) = place();
    let mut logbook = Logbook::open(&path).unwrap();
    let id = logbook.record_intent(at(0), &device("1"), &intent("x", 1, None)).unwrap();
    let parsed = EntryId::parse(&id.to_string()).unwrap();
    assert_eq!(logbook.entry(parsed).unwrap().map(|entry| entry.description), Some("x".to_owned()));
    assert_eq!(logbook.entry(EntryId::parse("99").unwrap()), Ok(None));
    for bad in ["0", "-1", "x", "", "99999999999999999999"] {
        assert_eq!(EntryId::parse(bad), None, "{bad}");
    }
}

#[test]
fn notes_are_entries_without_write() {
    let (_root, path) = place();
    let mut logbook = Logbook::open(&path).unwrap();
    let (own, simulated) = (device("GB1"), DeviceKey { is_virtual: true, ..device("GB1") });
    logbook.record_intent(at(0), &own, &intent("field:1", 1, None)).unwrap();
    logbook.add_note(at(10), &own, "Flange changed: see drawing 12").unwrap();
    logbook.add_note(at(20), &simulated, "a virtual encoder").unwrap();
    let of_own = EntryFilter { device: Some(own.clone()), ..EntryFilter::default() };
    let entries = logbook.entries(&of_own, 10).unwrap();
    assert_eq!(entries.iter().map(|entry| entry.at).collect::<Vec<_>>(), [at(10), at(0)], "not the virtual one");
    let notes = EntryFilter { what: Some(EntryKind::Note), ..of_own };
    let [note] = logbook.entries(&notes, 10).unwrap().try_into().unwrap();
    assert_eq!((note.description.as_str(), note.conclusion), ("Flange changed: see drawing 12", None));
    assert_eq!(logbook.history(&own, 10).unwrap().len(), 1, "a note is not a write");
    assert_eq!(logbook.write_cycles(&own), Ok(1));
    assert_eq!(logbook.devices().unwrap(), [own, simulated]);
}

/// The server may have lost rows without that version noticing.
#[test]
fn schema_6_logbook_has_unknown_server_rows() {
    let (_root, path) = place();
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    let old = Connection::open(&path).unwrap();
    for step in &schema::STEPS[..6] {
        old.execute_batch(step).unwrap();
    }
    old.execute_batch("INSERT INTO server VALUES (1, 'plant', 7, 3); PRAGMA user_version = 6").unwrap();
    drop(old);
    let logbook = Logbook::open(&path).unwrap();
    let unknown = |number| outbox::Mark { number, uid: String::new() };
    let expected = outbox::Marks { event: unknown(7), result: unknown(3) };
    assert_eq!(outbox::marks(&logbook.database, "plant"), Ok(Some(expected)));
}
