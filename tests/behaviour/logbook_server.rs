//! Several computers share a logbook on a PostgreSQL server, which may be unreachable, crash or reject them.

use std::net::TcpListener;
use std::os::unix::net::UnixListener;
use std::process::{Command, Stdio};
use std::time::Duration;

use encoder_studio::store::{DeviceKey, Store};
use serde_json::Value;

use super::postgres::{PASSWORD, Postgres};
use super::support::{Bench, Ran, Simulated};

const WRITE: [&str; 7] = ["write", "hiperface", "field:0@3+2", "C0FF", "--yes", "--link", "sim:"];
pub(crate) const LIMIT: Duration = Duration::from_secs(5);

/// Returns the key of a device that is not virtual.
pub(crate) fn device() -> DeviceKey {
    DeviceKey::new("hiperface", "37h", "GB1", false)
}

/// Returns the entries printed by `log`, oldest first.
fn entries(ran: &Ran) -> Vec<Value> {
    assert_eq!(ran.status, Some(0), "{ran:?}");
    ran.out.lines().rev().map(|line| serde_json::from_str(line).unwrap()).collect()
}

fn kinds(entries: &[Value]) -> Vec<&str> {
    entries.iter().map(|entry| entry["what"].as_str().unwrap()).collect()
}

#[test]
fn benches_share_entries_and_wear() {
    let Some(server) = Postgres::start() else { return };
    let (one, two) = (Bench::new(), Bench::new());
    for (bench, expected) in [(&one, vec!["connected", "write"]), (&two, ["connected", "write"].repeat(2))] {
        let ran = bench.run_with_server(&server.url(), &WRITE);
        assert_eq!((ran.status, ran.err.contains("server")), (Some(0), false), "{ran:?}");
        let log = bench.run_with_server(&server.url(), &["log", "--json"]);
        assert_eq!(kinds(&entries(&log)), expected, "{log:?}");
    }
    let log = one.run_with_server(&server.url(), &["log", "--json"]);
    assert_eq!(kinds(&entries(&log)), ["connected", "write"].repeat(2));
    assert_eq!(server.sql("SELECT what FROM event ORDER BY id"), ["connected", "write"].repeat(2));
    assert_eq!(server.sql("SELECT outcome, cycles_spent FROM result"), ["done|1", "done|1"]);
    let device = DeviceKey::new("hiperface", "37h", "GB0450179", true);
    assert_eq!((one.logbook().write_cycles(&device), two.logbook().write_cycles(&device)), (Ok(2), Ok(2)));
    // Without the server, everything that was received is still here.
    assert_eq!(entries(&one.run(&["log", "--json"])).len(), 4);
}

/// The undo on one computer marks the write in the logbook of another.
#[test]
fn undo_names_its_entry_on_every_bench() {
    let Some(server) = Postgres::start() else { return };
    let (one, two) = (Bench::new(), Bench::new());
    let simulated = Simulated::start(&one, &["hiperface", "--listen", "127.0.0.1:0"]);
    let link = format!("tcp:{}", simulated.place);
    let run = |words: &[&str]| {
        let ran = one.run_with_server(&server.url(), &[words, &["--yes", "--link", &link]].concat());
        assert_eq!(ran.status, Some(0), "{ran:?}");
    };
    run(&["write", "hiperface", "field:0@3+2", "C0FF"]);
    let write = entries(&one.run(&["log", "--json"])).into_iter().find(|entry| entry["what"] == "write").unwrap();
    run(&["undo", write["entry"].as_str().unwrap()]);
    let elsewhere = entries(&two.run_with_server(&server.url(), &["log", "--json"]));
    let of = |what: &str| elsewhere.iter().find(|entry| entry["what"] == what).unwrap();
    assert_eq!((&of("restore")["undoes"], &of("write")["undoes"]), (&of("write")["entry"], &Value::Null));
    assert_eq!(of("write")["undone_by"], of("restore")["entry"]);
}

/// The setting has the same effect as the environment variable.
#[test]
fn server_is_read_from_settings() {
    let Some(server) = Postgres::start() else { return };
    let bench = Bench::new();
    std::fs::create_dir_all(bench.path("config/encoder-studio")).unwrap();
    bench.write("config/encoder-studio/settings.ron", format!("(theme: Light, logbook: \"{}\")", server.url()));
    let mut command = bench.program(&WRITE);
    command.env("PGPASSWORD", PASSWORD);
    assert_eq!(super::support::finish(command).status, Some(0));
    assert_eq!(server.sql("SELECT what FROM event ORDER BY id"), ["connected", "write"]);
}

#[test]
fn entries_wait_for_server() {
    let Some(mut server) = Postgres::start() else { return };
    let bench = Bench::new();
    server.kill();
    let ran = bench.run_with_server(&server.url(), &WRITE);
    assert_eq!(ran.status, Some(0), "{ran:?}");
    let name = format!("127.0.0.1:{}/logs", server.port);
    for words in [name.as_str(), "cannot be reached", "sent later", "Entries waiting to be sent: 2."] {
        assert!(ran.err.contains(words), "{words}: {ran:?}");
    }
    assert_eq!(ran.err.matches(&name).count(), 1, "said once: {ran:?}");
    assert!(ran.err.contains("(connection refused)") && !ran.err.contains("os error"), "{ran:?}");
    // A command that does not use the server does not mention it.
    let offline = bench.run_with_server(&server.url(), &["decode", "hiperface", "40 42 02"]);
    assert!(!offline.err.contains(&name), "{offline:?}");
    server.run(&[]);
    let log = bench.run_with_server(&server.url(), &["log", "--json"]);
    assert_eq!((entries(&log).len(), log.err.as_str()), (2, ""));
    assert_eq!(server.sql("SELECT what FROM event ORDER BY id"), ["connected", "write"]);
}

/// Unknown writes by other computers could wear out a memory with few write cycles, but not one with many.
#[test]
fn fast_wear_needs_permit_without_server() {
    let bench = Bench::new();
    let away = "postgres://bench@127.0.0.1:1/logs";
    let write = |words: &[&str]| bench.run_with_server(away, &[words, &["--yes", "--link", "sim:"]].concat());
    for words in [["write", "interbus", "preset", "7"], ["write", "biss", "0x24:0x10", "0xAA"]] {
        let refused = write(&words);
        assert_eq!(refused.status, Some(1), "{refused:?}");
        for part in ["at least 0 of", "the server is away", "--force-wear", "127.0.0.1:1/logs"] {
            assert!(refused.err.contains(part), "{part}: {refused:?}");
        }
        assert_eq!(write(&[&words[..], &["--force-wear"]].concat()).status, Some(0));
    }
    for words in [["write", "hiperface", "field:0@3+2", "C0FF"], ["write", "hiperdrive", "158", "-100000"]] {
        let ran = write(&words[..]);
        assert_eq!(ran.status, Some(0), "{ran:?}");
    }
}

#[test]
fn benches_see_shared_device() {
    let Some(server) = Postgres::start() else { return };
    let (one, two) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let [one, two] = [one.path(), two.path()].map(|root| server.store_at(root));
    let others = |store: &Store| {
        store.logbook_server().transfer(&store.logbook_path(), LIMIT).unwrap().unwrap();
        store.logbook_server().contact().others.into_iter().map(|other| other.device).collect::<Vec<_>>()
    };
    let simulated = DeviceKey { is_virtual: true, ..device() };
    assert!(one.logbook_server().hold(&simulated).is_none(), "each bench has the same one");
    let _held = one.logbook_server().hold(&device());
    assert_eq!(others(&one), []);
    // Another program holds it, as its name in the table says.
    server.sql("UPDATE hold SET program = 'other', bench = 'bench 2'");
    let again = two.logbook_server().hold(&device());
    assert_eq!((others(&one), others(&two)), (vec![device()], vec![device()]));
    assert_eq!(two.logbook_server().contact().others[0].bench, "bench 2");
    drop(again);
    assert_eq!(others(&two), []);
    // A program that was killed counts as gone after half a minute.
    server.sql("UPDATE hold SET until = now() - interval '1 second'");
    assert_eq!(others(&one), []);
}

#[test]
fn command_announces_its_device() {
    let Some(server) = Postgres::start() else { return };
    let bench = Bench::new();
    let Some(encoder) = bench.encoder(&[]) else { return };
    let run = |words: &[&str]| {
        let ran = bench.run_with_server(&server.url(), &[words, &["--link", &encoder.url]].concat());
        assert_eq!(ran.status, Some(0), "{ran:?}");
        assert_eq!(server.sql("SELECT count(*) FROM hold WHERE program <> 'other'"), ["0"], "it is withdrawn");
        ran.err.matches("also connected to a program on bench 2").count()
    };
    let write = ["do", "hiperface", "increment-counter", "--yes"];
    let report = ["report", "hiperface", "--force", "-o", &bench.file("r.html")];
    for command in [&write[..], &report, &report] {
        assert_eq!(run(command), 0, "{command:?}");
    }
    server.sql(
        "INSERT INTO hold SELECT DISTINCT 'other', kind, device_type, serial_number, 'bench 2', NULL::text,
             now() + interval '1 hour' FROM event",
    );
    for command in [&write[..], &report] {
        assert_eq!(run(command), 1, "{command:?}");
    }
}

/// A locked keyring prompts the user, who may be absent.
#[test]
fn keyring_is_queried_once() {
    let Some(server) = Postgres::start() else { return };
    let bench = Bench::new();
    let bus = UnixListener::bind(bench.path("bus")).unwrap();
    bus.set_nonblocking(true).unwrap();
    let run = |url: &str, password: Option<&str>| {
        let mut command = bench.program(&WRITE);
        command.env("ENCODER_STUDIO_LOGBOOK", url).env_remove("PGPASSWORD");
        command.env("DBUS_SESSION_BUS_ADDRESS", format!("unix:path={}", bench.file("bus")));
        command.envs(password.map(|password| ("PGPASSWORD", password)));
        let ran = super::support::finish(command);
        assert_eq!(ran.status, Some(0), "{ran:?}");
        (std::iter::from_fn(|| bus.accept().ok()).count(), ran)
    };
    let (asked, ran) = run(&server.url(), None);
    assert!(ran.err.contains("requires a password"), "{ran:?}");
    assert_eq!(asked, 1, "{ran:?}");
    assert!(ran.took < Duration::from_secs(5), "{ran:?}");
    assert_eq!(run(&server.url(), Some(PASSWORD)).0, 0);
    assert_eq!(run("postgres://bench@127.0.0.1:1/logs", None).0, 0, "the server is away");
}

/// The server accepts connections but does not reply. It delays a command by seconds, not forever.
#[test]
fn silent_server_delays_command_briefly() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let url = format!("postgres://bench@{}/logs", listener.local_addr().unwrap());
    let bench = Bench::new();
    let ran = bench.run_with_server(&url, &WRITE);
    assert_eq!(ran.status, Some(0), "{ran:?}");
    assert!(ran.err.contains("does not reply"), "{ran:?}");
    assert!(ran.took < Duration::from_secs(8), "{:?}", ran.took);
}

#[test]
fn explains_server_problems() {
    let Some(server) = Postgres::start() else { return };
    let bench = Bench::new();
    let port = server.port;
    let check = |url: &str, password: &str, words: &[&str]| {
        let mut command = bench.program(&WRITE);
        command.env("ENCODER_STUDIO_LOGBOOK", url);
        match password {
            "" => command.env_remove("PGPASSWORD"),
            password => command.env("PGPASSWORD", password),
        };
        let ran = super::support::finish(command);
        assert_eq!(ran.status, Some(0), "{ran:?}");
        for word in words {
            assert!(ran.err.contains(word), "{word:?} is not in {ran:?}");
        }
        assert!(!ran.err.contains(PASSWORD) && !ran.err.contains("wr0ng"), "{ran:?}");
    };
    let url = server.url();
    check(&url, "wr0ng", &["rejects the user name or the password"]);
    check(&url, "", &["requires a password", "PGPASSWORD"]);
    check(&format!("postgres://bench:wr0ng@127.0.0.1:{port}/logs"), "", &["rejects the user name or the password"]);
    check(&format!("postgres://bench@127.0.0.1:{port}/other"), PASSWORD, &["no database", "/other"]);
    check(
        "postgres://bench@no-such-host.invalid/logs",
        PASSWORD,
        &["no-such-host.invalid", "not found on the network"],
    );
    check(&format!("{url}?sslmode=verify-full"), PASSWORD, &["encrypted connection", "sslrootcert"]);
    check(&format!("{url}?sslmode=prefer"), PASSWORD, &["sslmode=prefer", "verify-full"]);
    check("mysql://db.plant/logs", PASSWORD, &["postgres://USER@HOST/DATABASE"]);
    for account in ["bench:wr0ng/x", "bench:wr0ng?x", "bench:x@wr0ng"] {
        check(&format!("postgres://{account}@127.0.0.1:{port}/logs"), "", &["%40, %2F, %3F and %26"]);
    }
    check(&format!("{url}?hostaddr=10.0.0.5"), PASSWORD, &["hostaddr", "unsupported"]);
    server.sql("CREATE ROLE guest LOGIN PASSWORD 'k3y-of-the-bench'");
    check(
        &format!("postgres://guest@127.0.0.1:{port}/logs"),
        PASSWORD,
        &["does not have the required permission", "schema public"],
    );
    // The tables, then a newer and an older schema.
    check(&url, PASSWORD, &[]);
    let guest = format!("postgres://guest@127.0.0.1:{port}/logs");
    check(&guest, PASSWORD, &["does not have the required permission", "logbook"]);
    server.sql(
        "CREATE FUNCTION full_disk() RETURNS trigger LANGUAGE plpgsql AS
         $$ BEGIN RAISE 'could not extend file' USING ERRCODE = 'disk_full'; END $$;
         CREATE TRIGGER full_disk BEFORE INSERT ON event EXECUTE FUNCTION full_disk()",
    );
    check(&url, PASSWORD, &["disk of the logbook server", "is full", "sent later"]);
    server.sql("DROP FUNCTION full_disk CASCADE");
    server.sql("UPDATE logbook SET schema = 99");
    check(&url, PASSWORD, &["schema 99", "newer program version", "Update the program"]);
    server.sql(
        "UPDATE logbook SET schema = 1; DROP TABLE hold; ALTER TABLE event DROP COLUMN undoes;
         GRANT SELECT ON logbook TO guest",
    );
    check(&guest, PASSWORD, &["older schema 1", "owner of the tables"]);
    let count = |table: &str| server.sql(&format!("SELECT count(*) FROM {table}"))[0].parse::<usize>().unwrap();
    let (written, sent) = (entries(&bench.run(&["log", "--json"])).len(), count("event"));
    assert!(sent < written, "{sent} of {written}");
    // The owner updates the tables, and everything that waited is sent.
    check(&url, PASSWORD, &[]);
    assert_eq!((count("hold"), count("event")), (0, written + 2));
    assert_eq!(server.sql("SELECT schema FROM logbook"), ["3"]);
    assert_eq!(server.sql("SELECT count(*) FROM event WHERE undoes IS NOT NULL"), ["0"]);
    server.sql("ALTER ROLE bench PASSWORD 'k3y@/?:%'");
    check(&url.replace('@', ":k3y%40%2F%3F%3A%25@"), "", &[]);
    assert_eq!(count("event"), written + 4, "this password was accepted");
    let kept = bench.all_text_files();
    assert!(!kept.contains("k3y") && !kept.contains("wr0ng"), "{kept}");
}

/// The password is neither used nor repeated in a message.
#[test]
fn rejects_password_in_setting() {
    let bench = Bench::new();
    std::fs::create_dir_all(bench.path("config/encoder-studio")).unwrap();
    bench.write("config/encoder-studio/settings.ron", "(logbook: \"postgres://bench:0pen@127.0.0.1:1/logs\")");
    let ran = bench.run(&WRITE);
    assert_eq!(ran.status, Some(0), "{ran:?}");
    assert!(ran.err.contains("must not contain a password") && !ran.err.contains("0pen"), "{ran:?}");
}

/// An empty server replaces the old one, as after a disk failure. All entries are sent again.
#[test]
fn empty_server_receives_all_entries() {
    let Some(server) = Postgres::start() else { return };
    let bench = Bench::new();
    bench.run_with_server(&server.url(), &WRITE);
    server.sql("DROP TABLE event, result, hold, logbook CASCADE");
    bench.run_with_server(&server.url(), &WRITE);
    assert_eq!(server.sql("SELECT what FROM event ORDER BY id"), ["connected", "write"].repeat(2));
    assert_eq!(server.sql("SELECT count(*) FROM result"), ["2"]);
    // A backup of the server's disk lacks the newest rows.
    server.sql("DELETE FROM result WHERE id = (SELECT max(id) FROM result)");
    bench.run_with_server(&server.url(), &["log"]);
    assert_eq!(server.sql("SELECT count(*) FROM result"), ["2"]);
    // Since then, another bench has added more rows than were lost, with the same numbers.
    let number = |sql: &str| server.sql(sql)[0].parse::<u32>().unwrap();
    let (event, result) = (number("SELECT max(id) FROM event"), number("SELECT max(id) FROM result"));
    server.sql(&format!(
        "DELETE FROM result WHERE id = {result};
         DELETE FROM event WHERE id = {event};
         INSERT INTO event (id, uid, at, what, kind, device_type, serial_number, is_virtual, description, bench, version)
             OVERRIDING SYSTEM VALUE
             SELECT {event} + i, 'new ' || i, at, 'write', kind, device_type, serial_number, 0, 'new', 'bench 2', '1'
             FROM event, generate_series(0, 4) AS i WHERE id = (SELECT min(id) FROM event);
         INSERT INTO result (id, event, at, outcome, cycles_spent) OVERRIDING SYSTEM VALUE
             SELECT {result} + id - {event}, uid, at, 'done', 1 FROM event WHERE description = 'new';
         ALTER TABLE event ALTER COLUMN id RESTART WITH {};
         ALTER TABLE result ALTER COLUMN id RESTART WITH {}",
        event + 5,
        result + 5
    ));
    let log = bench.run_with_server(&server.url(), &["log", "--json"]);
    assert_eq!(entries(&log).len(), 9);
    assert_eq!((number("SELECT count(*) FROM event"), number("SELECT count(*) FROM result")), (9, 7));
}

#[test]
fn checks_server_certificate() {
    let Some(mut server) = Postgres::start() else { return };
    let openssl = |arguments: &[&str]| {
        let ran = Command::new("openssl").args(arguments).stderr(Stdio::null()).stdout(Stdio::null()).status();
        assert!(ran.unwrap().success(), "{arguments:?}");
    };
    let path = |name: &str| server.path(name).to_str().unwrap().to_owned();
    let (ca, ca_key, other) = (path("ca.pem"), path("ca.key"), path("other.pem"));
    let (request, key, certificate) = (path("server.csr"), path("server.key"), path("server.pem"));
    let new = ["req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "2"];
    openssl(&[&new[..], &["-subj", "/CN=plant", "-keyout", &ca_key, "-out", &ca]].concat());
    openssl(
        &[&new[..], &["-subj", "/CN=elsewhere", "-keyout", &ca_key.replace("ca", "other"), "-out", &other]].concat(),
    );
    openssl(&["req", "-newkey", "rsa:2048", "-nodes", "-subj", "/CN=x", "-keyout", &key, "-out", &request]);
    std::fs::write(path("names"), "subjectAltName=IP:127.0.0.1").unwrap();
    let names = path("names");
    openssl(&[
        "x509",
        "-req",
        "-in",
        &request,
        "-CA",
        &ca,
        "-CAkey",
        &ca_key,
        "-days",
        "2",
        "-extfile",
        &names,
        "-out",
        &certificate,
    ]);
    for file in [&key, &certificate] {
        // The server reads a key only if it is its own and no other user can read it.
        let _ = Command::new("chown").args(["postgres", file]).status();
        assert!(Command::new("chmod").args(["600", file]).status().unwrap().success());
    }
    server.kill();
    server.run(&["-c", "ssl=on", "-c", &format!("ssl_cert_file={certificate}"), "-c", &format!("ssl_key_file={key}")]);
    let bench = Bench::new();
    let url = |authority: &str| format!("{}?sslrootcert={authority}", server.url());
    let ran = bench.run_with_server(&url(&ca), &WRITE);
    assert_eq!((ran.status, ran.err.contains("server")), (Some(0), false), "{ran:?}");
    assert_eq!(server.sql("SELECT count(*) FROM event"), ["2"]);
    let ran = bench.run_with_server(&url(&other), &WRITE);
    assert!(ran.status == Some(0) && ran.err.contains("encrypted connection"), "{ran:?}");
    let ran = bench.run_with_server(&url("/nowhere.pem"), &WRITE);
    assert!(ran.status == Some(0) && ran.err.contains("/nowhere.pem"), "{ran:?}");
    // Another name than that in the certificate.
    let ran = bench.run_with_server(&url(&ca).replace("127.0.0.1", "localhost"), &WRITE);
    assert!(ran.status == Some(0) && ran.err.contains("encrypted connection"), "{ran:?}");
}
