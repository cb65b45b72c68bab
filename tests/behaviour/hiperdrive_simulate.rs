//! `simulate hiperdrive`, checked by two independent clients: one written from the reference, and pycomm3.

use super::support::{Bench, Simulated, foreign_host, foreign_host_with, pycomm3, python};

fn host_replies(place: &str, things: &[&str]) -> Vec<String> {
    foreign_host("enip_client.py", place, things)
}

fn drives(bench: &Bench, arguments: &[&str]) -> Simulated {
    Simulated::start(bench, &[&["hiperdrive", "--listen", "127.0.0.1:0"], arguments].concat())
}

/// Runs the steps of the independent client and checks its output after each step.
#[track_caller]
fn walk(place: &str, options: &[&str], walk: &[(&str, &str)]) {
    let (things, expected): (Vec<&str>, Vec<&str>) = walk.iter().copied().unzip();
    let said = host_replies(place, &[options, &things].concat());
    let pairs: Vec<_> = things.iter().zip(&said).collect();
    assert_eq!(said, expected, "{pairs:?}");
}

/// Checks the limits of 511 turns of 65536 steps (33488896), the category, and the codes of rejected requests
/// (reference 4 and 7).
#[test]
fn reads_and_writes_parameters() {
    let bench = Bench::new();
    if python("enip_client.py").is_none() {
        return;
    }
    let port = drives(&bench, &["--set", "position=163840"]);
    let steps = [
        ("get:13", "HIPERDRIVE SINGLE"),
        ("get:17", "4711"),
        ("get:107", "163840"),
        ("raw:0E 03 20 65 24 01 30 6B", "8E 00 00 00 00 80 02 00"),
        ("get:158", "-33488896"),
        ("get:160", "33488896"),
        ("set:166=200", "done"),
        ("get:166", "200"),
        ("set:166=351", "status 09"),
        ("set:107=5", "status 0E"),
        ("get:130", "status 14"),
        ("raw:0E 03 20 66 24 01 30 6B", "8E 00 05 00"),
        ("raw:10 03 20 65 24 01 30 A6 C8", "90 00 13 00"),
        ("frame:72:", "01"),
        ("frame:00:", "silence"),
        ("identity", "1010 1 4711 HIPERDRIVE SINGLE"),
        ("shout", "1010 1 4711 HIPERDRIVE SINGLE"),
        ("end", "closed"),
    ];
    walk(&port.place, &[], &steps);
    // The next client finds the drive as the first one has left it.
    walk(&port.place, &[], &[("get:166", "200")]);
    port.end("INT");
}

/// Checks the control words and the states they lead to, a move to a target and back, and that a jog ends when the
/// button is released (reference 3 and 9).
#[test]
fn enables_moves_and_jogs_drive() {
    let bench = Bench::new();
    if python("enip_client.py").is_none() {
        return;
    }
    let port = drives(&bench, &[]);
    let steps = [
        ("open", "00020001"),
        ("word:0000", "2A30"),
        ("word:0400", "2A31"),
        ("word:0401", "2A33"),
        ("word:0409", "2A37"),
        ("move:163840", "163840"),
        ("get:107", "163840"),
        ("move:100000", "100000"),
        ("jog:300", "moved stands rests"),
        ("move:-65536", "-65536"),
        ("leave", "done"),
        ("word:0400", "2A31"),
        ("close", "done"),
        ("close", "status 01 0107"),
    ];
    walk(&port.place, &[], &steps);
    port.end("TERM");
}

/// Parameter 852 (Requested) enables the eighth drive of a hub. The process data contain no parameter words.
#[test]
fn hub_moves_only_selected_drive() {
    let bench = Bench::new();
    if python("enip_client.py").is_none() {
        return;
    }
    let port = drives(&bench, &["--hub", "8"]);
    let last = [("get:13", "HIPERDRIVE HUB-8"), ("set:152=1", "done"), ("open", "00020001"), ("move:30000", "30000")];
    walk(&port.place, &["--hub=8", "--drive=8"], &last);
    walk(&port.place, &["--hub=8"], &[("get:107", "0"), ("get:152", "0")]);
    port.end("INT");
    let port = drives(&bench, &["--hub", "4", "--set", "requested=1", "--set", "drives=0,1"]);
    let steps = [("open", "00020001"), ("move:20000", "20000"), ("get:120", "7"), ("close", "done")];
    walk(&port.place, &["--hub=4", "--drive=2", "--without-words"], &steps);
    walk(&port.place, &["--hub=4"], &[("get:107", "status 0C"), ("get:120", "0")]);
    port.end("INT");
}

/// If the master is lost, the motion ends within the watchdog time and fault 8601 (34305) reports it (reference 7).
#[test]
fn silent_master_stops_drive() {
    let bench = Bench::new();
    if python("enip_client.py").is_none() {
        return;
    }
    let port = drives(&bench, &[]);
    let steps =
        [("open", "00020001"), ("begin:33000000", "done"), ("hush", "moved stands silent"), ("get:108", "34305")];
    walk(&port.place, &[], &steps);
    // Another master takes control and finds the fault: 2AB8, with the acknowledged set-point (bit 12).
    walk(&port.place, &[], &[("open", "00020002"), ("until:8:8", "3AB8"), ("close", "done")]);
    port.end("INT");
}

/// Random bytes in both directions affect neither the motion nor other requests.
#[test]
fn ignores_garbage() {
    let bench = Bench::new();
    if python("enip_client.py").is_none() {
        return;
    }
    let port = drives(&bench, &[]);
    let steps = [
        ("flood:300", "done"),
        ("get:17", "4711"),
        ("open", "00020001"),
        ("begin:131072", "done"),
        ("flood:200", "done"),
        ("until:2400:2400", "3E37"),
        ("get:107", "131072"),
        ("close", "done"),
    ];
    walk(&port.place, &[], &steps);
    port.end("INT");
}

/// After a loss of power, the next client finds the saved values, or half of them if the save was interrupted.
#[test]
fn interrupts_save_where_configured() {
    let bench = Bench::new();
    if python("enip_client.py").is_none() {
        return;
    }
    let port = drives(&bench, &["--fault", "die-in-store:2", "--set", "serial=7"]);
    walk(&port.place, &[], &[("set:166=200", "done"), ("set:47=1", "done"), ("get:47", "1")]);
    let second = [("set:152=0", "done"), ("set:186=10", "done"), ("get:47", "0"), ("set:47=1", "done")];
    walk(&port.place, &[], &second);
    // The power is lost before the next client connects and returns when it does.
    std::thread::sleep(std::time::Duration::from_millis(500));
    let after = [("get:17", "7"), ("get:166", "200"), ("get:152", "0"), ("get:186", "20"), ("set:47=-3", "done")];
    walk(&port.place, &[], &after);
    std::thread::sleep(std::time::Duration::from_millis(500));
    walk(&port.place, &[], &[("get:47", "0"), ("get:166", "350"), ("get:152", "1")]);
    port.end("INT");
}

/// The third-party client sends unconnected and wrapped requests, and opens an explicit connection after trying the
/// large ForwardOpen.
#[test]
fn pycomm3_reads_and_writes() {
    let bench = Bench::new();
    let Some(client) = pycomm3("enip_pycomm3.py") else { return };
    let port = drives(&bench, &["--set", "position=163840"]);
    let refused = "Error in data segment or invalid attribute value";
    let mut things = vec!["identity", "all"];
    let mut expected = vec!["halstrup-walcher GmbH 4711 HIPERDRIVE SINGLE"; 2];
    for steps in [
        ["get:plain:107", "set:plain:166:C8 00", "get:plain:166", "set:plain:166:5F 01"],
        ["get:wrapped:107", "set:wrapped:166:C9 00", "get:wrapped:166", "set:wrapped:166:5F 01"],
        ["get:connected:107", "set:connected:166:CA 00", "get:connected:166", "set:connected:166:5F 01"],
    ] {
        things.extend(steps);
    }
    for value in ["C8 00", "C9 00", "CA 00"] {
        expected.extend(["00 80 02 00", "done", value, refused]);
    }
    assert_eq!(foreign_host_with(client, &port.place, &things), expected);
    port.end("INT");
}

#[test]
fn rejects_impossible_simulations() {
    let bench = Bench::new();
    bench.run(&["simulate", "hiperdrive", "--pty", &bench.file("drive")]).fails(2, &["--listen", "EtherNet/IP"]);
    bench.run(&["simulate", "hiperdrive", "--listen", "127.0.0.1:0", "--bridge"]).fails(2, &["--bridge", "biss"]);
    bench.run(&["simulate", "hiperdrive"]).fails(2, &["--listen"]);
    bench.run(&["simulate", "hiperdrive", "--listen", "127.0.0.1:0", "--hub", "5"]).fails(2, &["--hub", "4, 8"]);
    bench.run(&["simulate", "interbus", "--listen", "127.0.0.1:0", "--hub", "4"]).fails(2, &["hub", "encoders"]);
    let wrong = ["simulate", "hiperdrive", "--listen", "127.0.0.1:0", "--set", "drives=1,1"];
    bench.run(&wrong).fails(2, &["drives=1,1", "number of ports: 1"]);
    bench.run(&["simulate", "hiperdrive", "--listen", "nowhere"]).fails(2, &["nowhere", "HOST:PORT"]);
    bench.run(&["simulate", "hiperdrive", "--listen", "[::1]:0"]).fails(1, &["::1", "127.0.0.1:4001"]);
    let taken = drives(&bench, &[]);
    bench.run(&["simulate", "hiperdrive", "--listen", &taken.place]).fails(1, &["in use by another program"]);
    // The port is used for TCP only, so it is still free for UDP.
    let datagrams = std::net::UdpSocket::bind("127.0.0.1:0").unwrap();
    let place = datagrams.local_addr().unwrap().to_string();
    bench.run(&["simulate", "hiperdrive", "--listen", &place]).fails(1, &["in use by another program"]);
    taken.end("INT");
    assert!(!bench.path("drive").exists());
}
