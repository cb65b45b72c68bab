//! The `simulate` command, tested by an independently written host with the frames of the reference.

use std::io::{Read, Write};
use std::net::TcpStream;
use std::thread::sleep;
use std::time::{Duration, Instant};

use serde_json::json;

use super::support::{Bench, Simulated, frame, host_address, python};

/// Compares an encoder at factory settings with the reference. An error frame may begin with 40 50 or 40 D0.
fn examine(path: &str) {
    let replies = host_address(
        path,
        &[
            "40 52 12",
            "40 50 10",
            "40 4E 0E",
            "40 4D 00 C9 55 91",
            "40 4C 00 0C",
            "40 4B 00 00 04 55 DE AD BE EF 78",
            "40 4A 00 00 04 55 5B",
            "40 4F 02 00 66 6B",
            "40 42 03",
            "40 4A 01 00 01 55 5F",
            "41 42 03",
            "40 67 E4 C3",
            "40 47 07",
            "40 46 06",
        ],
    );
    let error = |code: &str| [frame(&format!("40 50 {code}")), frame(&format!("40 D0 {code}"))];
    assert!(replies[0].starts_with("40 52 E4 ") && replies[0].len() == 7 * 3 - 1, "{replies:?}");
    assert_eq!(replies[0], frame(&replies[0][..17]));
    assert_eq!(replies[1], "40 50 00 10");
    assert!(replies[2].starts_with("40 4E "), "{replies:?}");
    assert!(u8::from_str_radix(&replies[2][6..8], 16).unwrap() >= 2, "{replies:?}");
    assert_eq!(replies[3], "40 4D 00 C9 C4");
    assert_eq!(replies[4], frame("40 4C 00 C9"));
    assert_eq!(replies[5], "40 4B 00 00 04 0F");
    assert_eq!(replies[6], "40 4A 00 00 04 DE AD BE EF 2C");
    assert!(error("0F").contains(&replies[7]), "{replies:?}");
    assert!(error("0A").contains(&replies[8]), "{replies:?}");
    assert!(error("12").contains(&replies[9]), "{replies:?}");
    assert_eq!(replies[10], "-", "another address");
    assert_eq!(replies[11], "40 67 E4 C3");
    assert_eq!(replies[12], "40 47 07");
    assert_eq!(replies[13], frame("40 46 00 00 01"));
}

#[test]
fn pseudoterminal_serves_successive_clients() {
    let bench = Bench::new();
    if python("master.py").is_none() {
        return;
    }
    let simulated = Simulated::start(&bench, &["hiperface", "--pty", &bench.file("enc")]);
    assert_eq!(simulated.place, bench.file("enc"));
    assert!(bench.path("enc").is_symlink());
    examine(&simulated.place);
    // The next client finds the content that the first one has left.
    assert_eq!(host_address(&simulated.place, &["40 4A 00 00 04 55 5B"]), ["40 4A 00 00 04 DE AD BE EF 2C"]);
    assert_eq!(
        host_address(&simulated.place, &["FF 50 AF", "40 53 13", "40 50 10"]),
        ["40 50 00 10", "-", "40 50 00 10"]
    );
    let url = format!("serial:{}", simulated.place);
    let told = bench.run(&["identify", "hiperface", "--link", &url, "--json"]).json();
    assert_eq!((&told["address"], &told["data_fields"]), (&json!(0x40), &json!(1)));
    simulated.end("INT");
    assert!(!bench.path("enc").is_symlink());
}

#[test]
fn tcp_port_serves_successive_clients() {
    let bench = Bench::new();
    if python("master.py").is_none() {
        return;
    }
    let simulated = Simulated::start(&bench, &["hiperface", "--listen", "127.0.0.1:0"]);
    assert!(simulated.place.starts_with("127.0.0.1:") && !simulated.place.ends_with(":0"));
    let path = format!("tcp:{}", simulated.place);
    examine(&path);
    assert_eq!(host_address(&path, &["40 4A 00 00 04 55 5B"]), ["40 4A 00 00 04 DE AD BE EF 2C"]);
    let told = bench.run(&["identify", "hiperface", "--link", &path, "--json"]).json();
    assert_eq!(told["data_fields"], json!(1));
    simulated.end("TERM");
}

#[test]
fn interrupt_ends_simulation_with_connected_client() {
    let bench = Bench::new();
    for name in ["INT", "TERM"] {
        let simulated = Simulated::start(&bench, &["hiperface", "--listen", "127.0.0.1:0"]);
        let client = TcpStream::connect(&simulated.place).unwrap();
        sleep(Duration::from_millis(100));
        simulated.end(name);
        drop(client);
    }
    let simulated = Simulated::start(&bench, &["hiperface", "--pty", &bench.file("enc")]);
    simulated.end("TERM");
    assert!(!bench.path("enc").is_symlink());
}

#[test]
fn encoder_is_silent_after_reset() {
    let bench = Bench::new();
    let simulated = Simulated::start(&bench, &["hiperface", "--listen", "127.0.0.1:0"]);
    let mut line = TcpStream::connect(&simulated.place).unwrap();
    line.set_nodelay(true).unwrap();
    let mut ask = |bytes: &[u8], wait: u64| {
        line.write_all(bytes).unwrap();
        line.set_read_timeout(Some(Duration::from_millis(wait))).unwrap();
        // The only expected reply has four bytes.
        let mut reply = Vec::new();
        let mut byte = [0];
        while reply.len() < 4 && line.read_exact(&mut byte).is_ok() {
            reply.push(byte[0]);
        }
        reply
    };
    // On a busy computer, a request may arrive after the silent time has ended. The attempt is then repeated.
    for _ in 0..5 {
        let begun = Instant::now();
        assert!(ask(&[0x40, 0x53, 0x13], 25).is_empty());
        let reply = ask(&[0x40, 0x50, 0x10], 20);
        // The request may also be joined with the reset to one frame of the wrong length.
        let asked_in_time = begun.elapsed() < Duration::from_millis(55) && reply != [0x40, 0x50, 0x0C, 0x1C];
        sleep(Duration::from_millis(200));
        assert_eq!(ask(&[0x40, 0x50, 0x10], 2000), [0x40, 0x50, 0x00, 0x10]);
        if asked_in_time {
            assert!(reply.is_empty(), "an answer while the encoder initialises: {reply:02X?}");
            return;
        }
        sleep(Duration::from_millis(50));
    }
    println!("skipped: this machine is too busy to ask within the initialisation");
}

#[test]
fn power_returns_with_next_client() {
    let bench = Bench::new();
    if python("master.py").is_none() {
        return;
    }
    let simulated = Simulated::start(&bench, &["hiperface", "--pty", &bench.file("enc"), "--fault", "die-in-store:1"]);
    let replies =
        host_address(&simulated.place, &["40 4D 00 C9 55 91", "40 4B 00 00 04 55 DE AD BE EF 78", "40 50 10"]);
    assert_eq!(replies, ["40 4D 00 C9 C4", "-", "-"]);
    sleep(Duration::from_millis(1500));
    let url = format!("serial:{}", simulated.place);
    let arguments = ["write", "hiperface", "field:0@0+4", "DEADBEEF", "--yes", "--link", &url, "--json"];
    let told = bench.run(&arguments).json();
    assert_eq!(told["verified"], told["written"]);
    assert_eq!(host_address(&simulated.place, &["40 4A 00 00 04 55 5B"]), ["40 4A 00 00 04 DE AD BE EF 2C"]);
}

#[test]
fn restores_virtual_encoder_over_both_wires() {
    let bench = Bench::new();
    let terminal = Simulated::start(&bench, &["hiperface", "--pty", &bench.file("enc"), "--set", "serial=HF0000001"]);
    let port = Simulated::start(&bench, &["hiperface", "--listen", "127.0.0.1:0", "--set", "serial=HF0000001"]);
    let (serial, tcp) = (format!("serial:{}", terminal.place), format!("tcp:{}", port.place));
    let there = bench.run(&["identify", "hiperface", "--link", &serial, "--json"]).json()["data_fields"].to_string();
    let create = ["do", "hiperface", "create-field", &there, "32", "--yes", "--link", &serial];
    assert_eq!(bench.run(&create).status, Some(0));
    bench
        .run(&["write", "hiperface", &format!("field:{there}@4"), "0102", "--yes", "--link", &serial, "--json"])
        .json();
    let file = bench.file("p.ron");
    assert_eq!(bench.run(&["save", "hiperface", "--link", &serial, "-o", &file]).status, Some(0));
    bench.run(&["restore", &file, "--yes", "--link", &tcp, "--json"]).json();
    assert_eq!(bench.run(&["diff", &file, "--link", &tcp, "--json"]).json()["equal"], json!(true));
}

#[test]
fn rejects_impossible_simulations() {
    let bench = Bench::new();
    bench.run(&["simulate", "hiperface"]).fails(2, &["--listen"]);
    bench.run(&["simulate", "hiperface", "--listen", "127.0.0.1:0", "--fault", "explode:1"]).fails(2, &["explode:1"]);
    bench.run(&["simulate", "hiperface", "--listen", "256.1.1.1:0"]).fails(1, &["256.1.1.1:0"]);
    let taken = bench.write("taken", "not ours");
    bench.run(&["simulate", "hiperface", "--pty", &taken]).fails(1, &["taken"]);
    assert_eq!(bench.read("taken"), "not ours");
}
