//! Programs that exchange entries with a PostgreSQL server at the same time, on one computer and on several.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::{Shutdown, TcpListener, TcpStream};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use encoder_studio::store::{EntryFilter, EntryKind, Event, Intent, Logbook, Outcome, ServerAddress, Store};
use encoder_studio::worker::SessionLog;
use encoder_studio::worker::commit::{CycleCount, cycles_seen};
use jiff::Timestamp;

use super::logbook_server::{LIMIT, device};
use super::postgres::{PASSWORD, Postgres};
use super::support::signal;

const WRITES: usize = 500;

/// The part of the next test that runs in a separate process. It records entries as fast as possible, prints each
/// acknowledged one, and sends them at the same time.
#[test]
#[ignore = "is started by another test"]
fn writer() {
    let Ok(root) = std::env::var("WRITER_ROOT") else { return };
    let (store, name) = (Store::at_root(Path::new(&root)), std::env::var("WRITER_NAME").unwrap());
    let address = ServerAddress::from_environment(&std::env::var("WRITER_SERVER").unwrap());
    store.logbook_server().set_address(Some(address));
    let sender = store.clone();
    std::thread::spawn(move || {
        loop {
            sender.logbook_server().transfer(&sender.logbook_path(), LIMIT);
            sleep(Duration::from_millis(5));
        }
    });
    let mut logbook = Logbook::open(&store.logbook_path()).unwrap();
    for number in 1..=WRITES {
        let description = format!("{name} {number}");
        if number % 5 == 0 {
            let items = vec![encoder_studio::profile::ChangedItem::new(&description, None, None)];
            let intent = Intent { kind: EntryKind::Write, items, planned_cycles: 2, backup: None, undoes: None };
            let id = logbook.record_intent(Timestamp::now(), &device(), &intent).unwrap();
            logbook.record_outcome(id, Timestamp::now(), Outcome::Done, 1).unwrap();
        } else {
            logbook.record(Timestamp::now(), &device(), &Event::new(EntryKind::Note, description)).unwrap();
        }
        println!("acknowledged {number}");
        sleep(Duration::from_millis(2));
    }
    let deadline = Instant::now() + Duration::from_secs(60);
    while logbook.count_waiting().unwrap() > 0 && Instant::now() < deadline {
        sleep(Duration::from_millis(20));
    }
    println!("waiting {}", logbook.count_waiting().unwrap());
}

fn start_writer(root: &Path, name: &str, server: &Postgres) -> Child {
    Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "logbook_transfer::writer", "--ignored", "--nocapture"])
        .envs([("WRITER_ROOT", root.to_str().unwrap()), ("WRITER_NAME", name), ("WRITER_SERVER", &server.url())])
        .env("PGPASSWORD", PASSWORD)
        .stdout(Stdio::piped())
        .spawn()
        .unwrap()
}

/// PostgreSQL is killed and restarted while two programs make 1,000 writes (issue 30).
#[test]
fn entries_arrive_once_and_in_order() {
    let (one, two) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    check_two_writers([one.path(), two.path()]);
}

/// Both programs run on one computer and send the entries in their common file.
#[test]
fn two_programs_share_one_file() {
    let root = tempfile::tempdir().unwrap();
    check_two_writers([root.path(); 2]);
}

fn check_two_writers(roots: [&Path; 2]) {
    let Some(mut server) = Postgres::start() else { return };
    let mut writers = [start_writer(roots[0], "a", &server), start_writer(roots[1], "b", &server)];
    let outputs = writers.each_mut().map(|writer| BufReader::new(writer.stdout.take().unwrap()).lines());
    let readers = outputs.map(|mut lines| {
        let first = lines.by_ref().map(Result::unwrap).find(|line| *line == format!("acknowledged {}", WRITES / 2));
        assert!(first.is_some());
        std::thread::spawn(move || lines.map(Result::unwrap).collect::<Vec<_>>())
    });
    let before: usize = server.sql("SELECT count(*) FROM event")[0].parse().unwrap();
    server.kill();
    sleep(Duration::from_secs(1));
    server.run(&[]);
    for (reader, mut writer) in readers.into_iter().zip(writers) {
        let lines = reader.join().unwrap();
        assert!(lines.iter().any(|line| line == "waiting 0"), "{lines:?}");
        assert!(lines.iter().any(|line| *line == format!("acknowledged {WRITES}")));
        assert!(writer.wait().unwrap().success());
    }
    assert!((1..2 * WRITES).contains(&before), "killed in the middle: {before}");
    let expected = |name: &str| (1..=WRITES).map(|number| format!("{name} {number}")).collect::<Vec<_>>();
    let on_server = server.sql("SELECT description FROM event ORDER BY id");
    assert_eq!(on_server.len(), 2 * WRITES);
    assert_eq!(server.sql("SELECT count(*) FROM result"), [(2 * WRITES / 5).to_string()]);
    for root in roots {
        let store = server.store_at(root);
        store.logbook_server().transfer(&store.logbook_path(), LIMIT).unwrap().unwrap();
        let logbook = Logbook::open(&store.logbook_path()).unwrap();
        let entries = logbook.entries(&EntryFilter::default(), 10_000).unwrap();
        let local: Vec<String> = entries.into_iter().rev().map(|entry| entry.description).collect();
        for (place, found) in [("server", &on_server), ("file", &local)] {
            assert_eq!(found.len(), 2 * WRITES, "{place}");
            for name in ["a", "b"] {
                let own: Vec<String> = found.iter().filter(|text| text.starts_with(name)).cloned().collect();
                assert_eq!(own, expected(name), "{place}");
            }
        }
        assert_eq!(logbook.write_cycles(&device()), Ok(2 * WRITES as u64 / 5));
    }
}

/// A plan is made while the window's thread is waiting for a server that has stopped replying.
#[test]
fn write_cycles_are_incomplete_during_transfer() {
    let Some(server) = Postgres::start() else { return };
    let root = tempfile::tempdir().unwrap();
    let store = server.store_at(root.path());
    assert_eq!(cycles_seen(&SessionLog::default(), &store, &device()), Some(CycleCount::complete(0)));
    let mut locked = server.start_sql("BEGIN; LOCK TABLE event; SELECT pg_sleep(60)");
    server.until("SELECT count(*) FROM pg_locks WHERE mode = 'AccessExclusiveLock' AND granted", "1");
    let other = store.clone();
    let thread = std::thread::spawn(move || other.logbook_server().transfer(&other.logbook_path(), LIMIT));
    server.until("SELECT count(*) FROM pg_locks WHERE NOT granted", "1");
    let seen = cycles_seen(&SessionLog::default(), &store, &device());
    assert!(store.logbook_server().contact().is_reached, "the other thread has not noticed it yet");
    assert_eq!(seen, Some(CycleCount { seen: 0, is_complete: false }));
    locked.kill().unwrap();
    locked.wait().unwrap();
    assert!(thread.join().unwrap().unwrap().is_err());
}

/// A computer that is suspended during a transfer keeps its connection open.
#[test]
fn suspended_program_does_not_block_others() {
    let Some(server) = Postgres::start() else { return };
    let (one, two) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let store = server.store_at(two.path());
    store.logbook_server().transfer(&store.logbook_path(), LIMIT).unwrap().unwrap();
    server.sql(
        "CREATE FUNCTION slow() RETURNS trigger LANGUAGE plpgsql AS $$ BEGIN PERFORM pg_sleep(1); RETURN NULL; END $$;
         CREATE TRIGGER slow BEFORE INSERT ON event FOR EACH STATEMENT EXECUTE FUNCTION slow()",
    );
    let mut writer = start_writer(one.path(), "a", &server);
    server.until("SELECT count(*) FROM pg_stat_activity WHERE wait_event = 'PgSleep'", "1");
    signal(&writer, "STOP");
    server.until("SELECT count(*) FROM pg_stat_activity WHERE state = 'idle in transaction'", "1");
    let deadline = Instant::now() + Duration::from_secs(20);
    Logbook::open(&store.logbook_path())
        .unwrap()
        .record(Timestamp::now(), &device(), &Event::new(EntryKind::Note, "another bench"))
        .unwrap();
    while store.logbook_server().transfer(&store.logbook_path(), LIMIT).unwrap().is_err() {
        assert!(Instant::now() < deadline, "the program that sleeps still holds the lock");
    }
    writer.kill().unwrap();
    writer.wait().unwrap();
}

/// Starts a network through which programs receive the given number of bytes per second from a server.
fn slow_network(server: &Postgres, bytes_per_second: usize) -> u16 {
    let (listener, port) = (TcpListener::bind("127.0.0.1:0").unwrap(), server.port);
    let own_port = listener.local_addr().unwrap().port();
    std::thread::spawn(move || {
        for client in listener.incoming() {
            let (mut client, mut server) = (client.unwrap(), TcpStream::connect(("127.0.0.1", port)).unwrap());
            let (mut requests, mut place) = (client.try_clone().unwrap(), server.try_clone().unwrap());
            std::thread::spawn(move || std::io::copy(&mut requests, &mut place));
            std::thread::spawn(move || {
                let mut part = vec![0; bytes_per_second / 50];
                while let Ok(length @ 1..) = server.read(&mut part) {
                    if client.write_all(&part[..length]).is_err() {
                        break;
                    }
                    sleep(Duration::from_millis(20));
                }
                let _ = client.shutdown(Shutdown::Both);
            });
        }
    });
    own_port
}

#[test]
fn slow_network_delays_entries() {
    const LIMIT: Duration = Duration::from_secs(2);
    const ENTRIES: usize = 3_000;
    let Some(server) = Postgres::start() else { return };
    let (one, two) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let near = server.store_at(two.path());
    near.logbook_server().transfer(&near.logbook_path(), LIMIT).unwrap().unwrap();
    server.sql(&format!(
        "INSERT INTO event (uid, at, what, kind, device_type, serial_number, is_virtual, description, bench, version)
         SELECT i, '2026-11-01T08:00:00Z', 'note', 'hiperface', '37h', 'GB1', 0, repeat('x', 200), 'bench 2', '1'
         FROM generate_series(1, {ENTRIES}) AS i"
    ));
    let store = Store::at_root(one.path());
    let address = format!("postgres://bench:{PASSWORD}@127.0.0.1:{}/logs", slow_network(&server, 200_000));
    store.logbook_server().set_address(Some(ServerAddress::from_environment(&address)));
    let mut logbook = Logbook::open(&store.logbook_path()).unwrap();
    logbook.record(Timestamp::now(), &device(), &Event::new(EntryKind::Note, "own")).unwrap();
    let mut attempts = 0;
    loop {
        let began = Instant::now();
        let result = store.logbook_server().transfer(&store.logbook_path(), LIMIT).unwrap();
        assert!(began.elapsed() < LIMIT + Duration::from_secs(1), "{:?}", began.elapsed());
        attempts += 1;
        // The entry of this bench does not wait for those of the others.
        assert_eq!(server.sql("SELECT count(*) FROM event WHERE description = 'own'"), ["1"], "{attempts}");
        if result.is_ok() {
            break;
        }
        assert!(attempts < 10, "{result:?}");
    }
    assert!(attempts > 1, "the network is not slow");
    assert_eq!(logbook.entries(&EntryFilter::default(), 10_000).unwrap().len(), ENTRIES + 1);
}
