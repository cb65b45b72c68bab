//! `simulate biss`, tested by independently written hosts with the frames and rules of the references.

use std::io::Write;
use std::net::TcpStream;
use std::time::Duration;

use serde_json::{Value, json};

use super::support::{Bench, Simulated, foreign_host, python};

/// Checks the published exchanges in UBICOM reference 6. The encoder is at 25 °C, turn 1234h and 270.0°.
fn examine(path: &str) {
    let replies = foreign_host(
        "ubicom_host.py",
        path,
        &[
            "80 01 01 02 00 26 00 55",
            "80 01 01 02 00 C5 00 B6",
            "80 01 03 01 00 01 79",
            "80 01 01 02 00 01 00 7A",
            "80 01 01 02 00 05 01 75",
            "80 01 02 03 00 2A 00 07 48",
            "80 01 02 03 00 2B 00 2A 24",
            "80 01 02 03 00 2A 00 07 48",
            "80 01 01 02 00 26 00 54",
            "80 02 01 02 00 26 00 54",
            "80 01 04 02 00 26 00 52",
            "80 01 01 03 00 26 00 54",
            "80 01 01 02 00 34 00 47",
        ],
    );
    let expected = [
        "80 01 01 01 00 4B 31",
        "80 01 01 01 00 1C 60",
        "80 01 03 05 00 00 80 69 24 00 69",
        "80 01 01 01 00 02 7A",
        "80 01 01 01 00 02 7A", // bank 3, 05: the second feedback bit is a warning
        "80 01 02 01 00 A0 DB", // no password yet
        "80 01 02 01 00 90 EB",
        "80 01 02 01 00 90 EB",
        "-", // a wrong checksum
        "-", // another node
        "-", // an unknown command
        "-", // length does not match
        "80 01 01 01 00 01 7B",
    ];
    assert_eq!(replies, expected);
}

const TEMPERATURE_SETTING: [&str; 2] = ["--set", "temperature=25"];

#[test]
fn configuration_pin_answers_reference_frames() {
    let bench = Bench::new();
    if python("ubicom_host.py").is_none() {
        return;
    }
    let terminal =
        Simulated::start(&bench, &[&["biss", "--pty", &bench.file("enc")], &TEMPERATURE_SETTING[..]].concat());
    assert!(bench.path("enc").is_symlink());
    examine(&terminal.place);
    // The next client finds the mode that the first one has set.
    let mode = foreign_host("ubicom_host.py", &terminal.place, &["80 01 01 02 00 2A 00 51"]);
    assert_eq!(mode, ["80 01 01 01 00 07 75"]);
    terminal.end("INT");
    assert!(!bench.path("enc").is_symlink());
    let port = Simulated::start(&bench, &[&["biss", "--listen", "127.0.0.1:0"], &TEMPERATURE_SETTING[..]].concat());
    examine(&format!("tcp:{}", port.place));
    port.end("TERM");
}

/// Like the real encoder (UBICOM reference 1), the simulation does not understand requests at another speed.
#[test]
fn link_sets_baud_rate() {
    let bench = Bench::new();
    let terminal =
        Simulated::start(&bench, &[&["biss", "--pty", &bench.file("enc")], &TEMPERATURE_SETTING[..]].concat());
    let ask = |parameters: &str| {
        let link = format!("serial:{}?{parameters}", terminal.place);
        bench.run(&["read", "biss", "0x66", "--link", &link, "--json"])
    };
    for parameters in ["baud=115200", "baud=115200&parity=none&echo=auto&order=low-first"] {
        assert_eq!(ask(parameters).json()["value"], json!(75), "{parameters}");
    }
    assert_eq!(ask("baud=9600").status, Some(1));
    terminal.end("INT");
}

/// Saving a preset restarts the encoder. It does not answer for half a second and then returns to operation.
#[test]
fn restart_is_silent_and_faults_are_injected() {
    let bench = Bench::new();
    if python("ubicom_host.py").is_none() {
        return;
    }
    let port = Simulated::start(&bench, &["biss", "--listen", "127.0.0.1:0"]);
    let path = format!("tcp:{}", port.place);
    let (read_mode, acknowledged) = ("80 01 01 02 00 2A 00 51", "80 01 02 01 00 90 EB");
    let replies = foreign_host(
        "ubicom_host.py",
        &path,
        &[
            "80 01 02 03 00 2B 00 2A 24",
            "80 01 02 03 00 2A 00 07 48",
            "80 01 02 03 00 80 00 02 F7",
            "80 01 02 03 00 80 00 03 F6",
            read_mode,
            "wait:0.5",
            read_mode,
        ],
    );
    assert_eq!(replies, [acknowledged, acknowledged, acknowledged, acknowledged, "-", "80 01 01 01 00 00 7C"]);
    let silent = Simulated::start(&bench, &["biss", "--listen", "127.0.0.1:0", "--fault", "silent-after:1"]);
    let replies = foreign_host("ubicom_host.py", &format!("tcp:{}", silent.place), &[read_mode, read_mode]);
    assert_eq!(replies, ["80 01 01 01 00 00 7C", "-"]);
}

fn host_replies(path: &str, actions: &[&str]) -> Vec<Value> {
    let lines = foreign_host("bridge_host.py", path, actions);
    lines.iter().map(|line| serde_json::from_str(line).unwrap()).collect()
}

/// Checks the exchange with an adapter against bridge reference 2 to 4.
fn examine_adapter(path: &str) {
    let said = host_replies(
        path,
        &[
            "frame",
            "hello",
            "config:2000000:35:6:18",
            "frame",
            "reg:66",
            "reg:40=02",
            "reg:05",
            "reg:40=03",
            "reg:0A",
            "reg:6A=07",
            "reg:6B=2A",
            "reg:6A=07",
            "reg:6A=00",
            "reg:6B=00",
            "raw:0501011F3F00", // the published HELLO with a wrong CRC
            "raw:0000",
            "reg:7E",
        ],
    );
    assert_eq!((&said[0]["error"], &said[0]["op"]), (&json!(2), &json!(0x21)), "not configured");
    let hello = &said[1];
    assert_eq!(hello["version"], json!(1));
    assert_eq!(hello["capabilities"].as_u64().unwrap() & 0b110, 0b110, "{hello}");
    assert!(hello["max_clock_hz"].as_u64() >= Some(2_000_000), "{hello}");
    assert_eq!(said[2], json!({"clock_hz": 2_000_000}));
    // The frame of turn 1234h and step 18000h, from BiSS reference 2.
    assert_eq!((&said[3]["status"], &said[3]["raw"]), (&json!(0), &json!("024698000CF")));
    let values: Vec<&Value> = said[4..14].iter().map(|told| &told["value"]).collect();
    // The values are 25 °C, bank 2, the minimum time-out, bank 3, 16 bits of turns, a mode without and with the
    // password, and the values reset.
    assert_eq!(values, [0x4B, 0x02, 0x1C, 0x03, 0x10, 0x00, 0x2A, 0x07, 0x00, 0x00]);
    assert_eq!(said[16], json!({"value": 0x46}));
}

#[test]
fn adapter_reads_frames_and_all_banks() {
    let bench = Bench::new();
    if python("bridge_host.py").is_none() {
        return;
    }
    let bridge =
        |more: &[&str]| Simulated::start(&bench, &[&["biss", "--bridge"], more, &TEMPERATURE_SETTING[..]].concat());
    let port = bridge(&["--listen", "127.0.0.1:0"]);
    examine_adapter(&format!("tcp:{}", port.place));
    port.end("INT");
    let terminal = bridge(&["--pty", &bench.file("adapter")]);
    examine_adapter(&terminal.place);
    terminal.end("TERM");
}

/// Each frame has its time, its CRC, and the position of a shaft that turns ten times per second.
#[test]
fn streams_20k_frames_per_second_without_gaps() {
    let bench = Bench::new();
    if python("bridge_host.py").is_none() {
        return;
    }
    let port = Simulated::start(&bench, &["biss", "--bridge", "--listen", "127.0.0.1:0", "--set", "rpm=600"]);
    let path = format!("tcp:{}", port.place);
    let said = host_replies(&path, &["hello", "config:2000000:35:6:18", "stream:50:2.0", "frame"]);
    let stream = &said[2];
    for key in ["broken", "gaps", "lost", "wrong_crc", "bad_status", "off_time"] {
        assert_eq!(stream[key], json!(0), "{key}: {stream}");
    }
    assert_eq!((&stream["period_us"], &stream["ended"]), (&json!(50), &json!(true)), "{stream}");
    let number = |key: &str| stream[key].as_u64().unwrap();
    // On a busy computer, the host may start counting late, but no counted frame is missing even then.
    assert!(number("frames") > 30_000, "{stream}");
    let (moved, expected) = (number("last_steps") - number("first_steps"), (number("frames") - 1) * 131_072 / 2_000);
    assert!(moved.abs_diff(expected) <= 1, "{moved} steps where {expected} were expected: {stream}");
    assert_eq!(said[3]["status"], json!(0), "single frames again when the stream has ended");
}

/// Between host and adapter, damaged bytes are dropped and lost bytes are requested again.
#[test]
fn injects_adapter_line_faults() {
    let bench = Bench::new();
    if python("bridge_host.py").is_none() {
        return;
    }
    let with = |fault: &str, actions: &[&str]| {
        let arguments = ["biss", "--bridge", "--listen", "127.0.0.1:0", "--seed", "3", "--fault", fault];
        let port = Simulated::start(&bench, &arguments);
        host_replies(&format!("tcp:{}", port.place), actions)
    };
    assert_eq!(with("drop:1", &["hello"])[0]["error"], json!("no answer"));
    let said = with("silent-after:2", &["hello", "config:2000000:35:6:18", "frame"]);
    assert_eq!((&said[1]["clock_hz"], &said[2]["error"]), (&json!(2_000_000), &json!("no answer")));
    let damaged = with("flip:0.001", &["config:2000000:35:6:18", "config:2000000:35:6:18", "stream:1000:1.5"]);
    assert!(damaged[2]["broken"].as_u64() > Some(0), "{damaged:?}");
    let died = with(
        "die-in-store:1",
        &["config:2000000:35:6:18", "reg:6B=2A", "reg:6A=07", "reg:40=01", "reg:00=01", "frame"],
    );
    assert_eq!((&died[4]["error"], &died[5]["status"]), (&json!(4), &json!(1)), "{died:?}");
}

/// The client has started a stream that it does not read.
#[test]
fn interrupt_ends_simulation_with_busy_client() {
    let bench = Bench::new();
    let port = Simulated::start(&bench, &["biss", "--bridge", "--listen", "127.0.0.1:0"]);
    let mut client = TcpStream::connect(&port.place).unwrap();
    // The requests ANALOG_CONFIG and ANALOG_STREAM start a stream of a million samples per second of four bytes each.
    client.write_all(b"\x06\x0B\x30\x40\x42\x0F\x03\x33\xCC\x00").unwrap();
    client.write_all(b"\x06\x0C\x31\x01\x78\x9F\x00").unwrap();
    std::thread::sleep(Duration::from_secs(5));
    port.end("TERM");
    drop(client);
}

#[test]
fn rejects_impossible_simulations() {
    let bench = Bench::new();
    bench.run(&["simulate", "biss"]).fails(2, &["--listen"]);
    let listen = ["--listen", "127.0.0.1:0"];
    bench.run(&[&["simulate", "hiperface", "--bridge"], &listen[..]].concat()).fails(2, &["--bridge", "biss"]);
    for (setting, words) in [
        ("rpm=fast", &["rpm=fast", "-12000 to 12000"][..]),
        ("motor=on", &["steady or reverse"]),
        ("model=skm36", &["model", "temperature"]),
        ("line=open", &["line", "--bridge"]),
        ("rpm", &["NAME=VALUE"]),
    ] {
        bench.run(&[&["simulate", "biss", "--set", setting], &listen[..]].concat()).fails(2, words);
    }
    let bad = bench.run(&[&["simulate", "biss", "--bridge", "--set", "line=bad"], &listen[..]].concat());
    bad.fails(2, &["good, open, low or high"]);
    assert!(bad.took < Duration::from_secs(10));
}
