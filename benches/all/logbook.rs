//! Measures the time to open the view of a logbook with 100,000 entries (goal: 200 ms) and to search it (goal: 50 ms).
//! If `ENCODER_STUDIO_LOGBOOK` names the database of a logbook server, the benchmark fills it with entries and also
//! measures the time to send all entries, to copy them to another computer's logbook, and to open and search the view
//! if new entries are fetched from the server first. The naive alternative searches on the server.

use std::path::Path;
use std::time::{Duration, Instant};

use encoder_studio::store::{EntryFilter, EntryKind, Logbook, ServerAddress, Store};
use rusqlite::Connection;

use crate::median;

const ENTRIES: u32 = 100_000;
/// Number of entries to query: one more than the view shows.
const SHOWN: u32 = 2_001;
const ROUNDS: usize = 7;
const TIMEOUT: Duration = Duration::from_secs(30);

/// Adds entries for 500 devices on ten computers. Three entries in ten are writes. One entry in a thousand contains the
/// word `needle`.
pub(crate) fn fill(path: &Path, entries: u32) {
    drop(Logbook::open(path).unwrap());
    let mut database = Connection::open(path).unwrap();
    let transaction = database.transaction().unwrap();
    {
        let sql = "INSERT INTO event (uid, at, what, kind, device_type, serial_number, is_virtual, description, items,
                                      planned_cycles, bench, user, version)
            VALUES (lower(hex(randomblob(16))), ?1, ?2, ?3, '37h', ?4, 0, ?5, ?6, 1, ?7, 'user', '1.0.0')";
        let mut event = transaction.prepare(sql).unwrap();
        let mut result =
            transaction.prepare("INSERT INTO result SELECT uid, at, 'done', NULL, 1 FROM event WHERE id = ?1").unwrap();
        let begin: jiff::Timestamp = "2026-01-01T00:00:00Z".parse().unwrap();
        for number in 0..entries {
            let at = begin + jiff::SignedDuration::from_secs(i64::from(number) * 60);
            let is_write = number % 10 < 3;
            let what = if is_write { EntryKind::Write } else { EntryKind::Connected };
            let kind = ["hiperface", "biss", "interbus", "hiperdrive"][number as usize % 4];
            let word = if number % 1_000 == 500 { "needle" } else { "value" };
            let items = format!(r#"[{{"item":"field:1@{number}","old":"00FF","new":"C0FF"}}]"#);
            let description = format!("field:1@{number} {word}: 00FF → C0FF");
            let (serial, bench) = (format!("GB{:04}", number % 500), format!("bench {}", number % 10));
            let what = what.keyword();
            event.execute((at.to_string(), what, kind, serial, description, items, bench)).unwrap();
            if is_write {
                result.execute([transaction.last_insert_rowid()]).unwrap();
            }
        }
    }
    transaction.commit().unwrap();
}

pub(crate) fn view(path: &Path) -> usize {
    let logbook = Logbook::open(path).unwrap();
    let entries = logbook.entries(&EntryFilter::default(), SHOWN).unwrap();
    logbook.devices().unwrap().len() + logbook.assets().unwrap().len() + entries.len()
}

pub(crate) fn search(path: &Path, text: &str) -> usize {
    let filter = EntryFilter { search: text.to_owned(), ..EntryFilter::default() };
    Logbook::open(path).unwrap().entries(&filter, SHOWN).unwrap().len()
}

fn print_times(path: &Path, before: impl Fn()) {
    let time = |work: &dyn Fn() -> usize| {
        median(ROUNDS, || {
            before();
            work()
        }) * 1e3
    };
    println!("  view                                  {:8.1} ms", time(&|| view(path)));
    println!(
        "  search, {:3} entries                   {:8.1} ms",
        search(path, "needle"),
        time(&|| search(path, "NEEDLE"))
    );
    println!("  search, no entry                      {:8.1} ms", time(&|| search(path, "nothing like this")));
}

fn seconds(what: &str, work: impl FnOnce()) {
    let begun = Instant::now();
    work();
    println!("  {what:38}{:8.2} s", begun.elapsed().as_secs_f64());
}

pub(crate) fn run() {
    let (one, two) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let [one, two] = [one.path(), two.path()].map(Store::at_root);
    let path = one.logbook_path();
    fill(&path, ENTRIES);
    println!("{ENTRIES} entries on SQLite, median of {ROUNDS} (goals: 200 and 50 ms)");
    print_times(&path, || ());
    let Ok(address) = std::env::var("ENCODER_STUDIO_LOGBOOK") else {
        println!("skipped: ENCODER_STUDIO_LOGBOOK names no server");
        return;
    };
    println!("over PostgreSQL");
    let transfer = |store: &Store| {
        store.logbook_server().set_address(Some(ServerAddress::from_environment(&address)));
        store.logbook_server().transfer(&store.logbook_path(), TIMEOUT).unwrap().unwrap();
    };
    seconds("all entries are sent", || transfer(&one));
    seconds("all entries are copied to a new bench", || transfer(&two));
    print_times(&two.logbook_path(), || transfer(&two));
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap();
    let found = runtime.block_on(async {
        let (client, connection) = tokio_postgres::connect(&address, tokio_postgres::NoTls).await.unwrap();
        tokio::spawn(connection);
        let sql = "SELECT * FROM event LEFT JOIN result ON result.event = event.uid
                   WHERE lower(description || kind || serial_number || bench) LIKE '%needle%' ORDER BY event.id DESC";
        let begun = Instant::now();
        (client.query(sql, &[]).await.unwrap().len(), begun.elapsed())
    });
    println!("  naive search on the server, {:3} entries{:7.1} ms", found.0, found.1.as_secs_f64() * 1e3);
}
