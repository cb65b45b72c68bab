//! `simulate ssi`, tested by an independently written host and by the program's own host.

use serde_json::{Value, json};

use super::support::{Bench, Simulated, foreign_host, python};

fn host_replies(path: &str, actions: &[&str]) -> Vec<Value> {
    let lines = foreign_host("bridge_host.py", path, actions);
    lines.iter().map(|line| serde_json::from_str(line).unwrap()).collect()
}

/// Checks bridge reference 2 to 4. The shaft is at turn 1234h and 270°, which is turn 234h of 4096 and step 1800h of
/// 8192 in Gray code.
fn examine(path: &str) {
    let actions =
        ["word", "hello", "ssi:25:1500000:30", "word", "ssi:27:400000:200", "word", "ssi:12:400000:200", "word"];
    let said = host_replies(path, &[&actions[..], &["ssi:0:400000:200", "ssi:65:400000:200", "word"]].concat());
    assert_eq!((&said[0]["error"], &said[0]["op"]), (&json!(2), &json!(0x11)), "not configured");
    assert_eq!((&said[1]["version"], said[1]["capabilities"].as_u64().unwrap() & 1), (&json!(1), 1));
    assert_eq!((&said[2], &said[3]["raw"]), (&json!({"clock_hz": 1_500_000}), &json!("65D400")));
    // With more clocks than bits, zeros follow the frame. With fewer, only its first bits are read.
    assert_eq!((&said[5]["raw"], &said[7]["raw"]), (&json!("1975000"), &json!("32E")));
    assert_eq!((&said[8]["error"], &said[9]["error"]), (&json!(2), &json!(2)));
    assert_eq!(said[10]["raw"], json!("32E"), "a setting that is refused changes nothing");
}

#[test]
fn serves_pseudoterminal_and_tcp_port() {
    let bench = Bench::new();
    if python("bridge_host.py").is_none() {
        return;
    }
    let layout = ["--layout", "atm60,code=gray"];
    let port = Simulated::start(&bench, &[&["ssi", "--listen", "127.0.0.1:0"], &layout[..]].concat());
    examine(&format!("tcp:{}", port.place));
    port.end("INT");
    let terminal = Simulated::start(&bench, &[&["ssi", "--pty", &bench.file("adapter")], &layout[..]].concat());
    assert!(bench.path("adapter").is_symlink());
    examine(&terminal.place);
    terminal.end("TERM");
    assert!(!bench.path("adapter").is_symlink());
}

/// Each word has its time and the position of a shaft that turns ten times per second: 81 920 steps per second are
/// 4.096 steps per word.
#[test]
fn streams_20k_words_per_second_without_gaps() {
    let bench = Bench::new();
    if python("bridge_host.py").is_none() {
        return;
    }
    let arguments = ["ssi", "--listen", "127.0.0.1:0", "--layout", "atm60,code=gray", "--set", "rpm=600"];
    let port = Simulated::start(&bench, &arguments);
    let path = format!("tcp:{}", port.place);
    let said = host_replies(&path, &["hello", "ssi:25:1500000:30", "words:50:2.0:12,13,gray,0", "word"]);
    let stream = &said[2];
    for key in ["broken", "gaps", "lost", "off_time"] {
        assert_eq!(stream[key], json!(0), "{key}: {stream}");
    }
    assert_eq!((&stream["period_us"], &stream["ended"]), (&json!(50), &json!(true)), "{stream}");
    assert_eq!((&stream["least_move"], &stream["greatest_move"]), (&json!(4), &json!(5)), "{stream}");
    // On a busy computer, the host may start counting late, but no counted word is missing even then.
    assert!(stream["words"].as_u64() > Some(30_000), "{stream}");
    assert!(said[3]["raw"].is_string(), "single words again when the stream has ended");
    // 25 clocks at 400 kHz take 62.5 µs. With the pause of 200 µs, the interval is rounded to whole microseconds.
    let slower = host_replies(&path, &["hello", "ssi:25:400000:200", "words:50:0.2:12,13,gray,0"]);
    assert_eq!((&slower[2]["period_us"], &slower[2]["gaps"]), (&json!(263), &json!(0)), "{}", slower[2]);
}

/// Another encoder family with its error bits, and a layout from a profile.
#[test]
fn encoder_follows_layout() {
    let bench = Bench::new();
    if python("bridge_host.py").is_none() {
        return;
    }
    let with = |arguments: &[&str], actions: &[&str]| {
        let port = Simulated::start(&bench, &[&["ssi", "--listen", "127.0.0.1:0"], arguments].concat());
        host_replies(&format!("tcp:{}", port.place), actions)
    };
    // AFS60: 18 bits at step 30000h, ERRSI on clock 20 permanently, and ERRSYNC on clock 21 only in the first transfer.
    let actions = ["ssi:21:1000000:30", "word", "word"];
    let said = with(&["--layout", "afs60", "--set", "ssi-error=ERRSI,ERRSYNC"], &actions);
    assert_eq!((&said[1]["raw"], &said[2]["raw"]), (&json!("180003"), &json!("180002")));
    let said = with(&["--layout", "afs60s", "--set", "ssi-error=safety-fault"], &actions);
    assert_eq!(said[1]["raw"], json!("1FFFFF"));
    let said = with(&["--layout", "kh53", "--set", "ssi-error=overspeed-or-gap"], &["ssi:24:1000000:30", "word"]);
    assert_eq!(said[1]["raw"], json!("FFFFFE"));
    for (line, raw) in [("low", "0"), ("high", "1FFFFF"), ("open", "1FFFFF")] {
        let said = with(&["--layout", "afs60", "--set", &format!("line={line}")], &actions);
        assert_eq!(said[1]["raw"], json!(raw), "{line}");
    }
    let profile = bench.file("counting.ron");
    bench.run(&["save", "ssi", "--layout", "ahs36,err=none,preset=5,direction=ccw", "-o", &profile]);
    // The position is a quarter of 16384 steps backwards, plus 5.
    let said = with(&["--layout", &profile], &["ssi:14:1000000:30", "word"]);
    assert_eq!(said[1]["raw"], json!("1005"));
    let silent = with(&["--fault", "silent-after:2", "--seed", "3"], &["hello", "ssi:25:1000000:30", "word"]);
    assert_eq!((&silent[1]["clock_hz"], &silent[2]["error"]), (&json!(1_000_000), &json!("no answer")));
}

/// The program's own host reads the encoder over both transports.
#[test]
fn position_command_reads_simulated_encoder() {
    let bench = Bench::new();
    let port = Simulated::start(&bench, &["ssi", "--listen", "127.0.0.1:0", "--layout", "ahm36"]);
    let terminal = Simulated::start(&bench, &["ssi", "--pty", &bench.file("adapter"), "--layout", "ahm36"]);
    for link in [format!("bridge:tcp:{}", port.place), format!("bridge:{}", terminal.place)] {
        let told = bench.run(&["position", "ssi", "--layout", "ahm36", "--link", &link, "--json"]).json();
        let place = (&told["turns"], &told["steps"], &told["degrees"], &told["valid"]);
        assert_eq!(place, (&json!(564), &json!(12_288), &json!(270.0), &json!(true)), "{link}");
        let status = bench.run(&["status", "ssi", "--layout", "ahm36", "--link", &link, "--json"]).json();
        assert_eq!(status, json!({"ok": true, "errors": [], "warnings": []}));
    }
    port.end("INT");
    terminal.end("TERM");
}

#[test]
fn rejects_impossible_simulations() {
    let bench = Bench::new();
    bench.run(&["simulate", "ssi"]).fails(2, &["--listen"]);
    let cases: [(&[&str], i32, &[&str]); 8] = [
        (&["ssi", "--layout", "atm61"], 2, &["atm61", "atm60"]),
        (&["ssi", "--layout", "ahs36,clocks=14"], 1, &["14"]),
        (&["ssi", "--layout", "atm60", "--set", "ssi=atm60"], 2, &["--layout", "ssi="]),
        (&["ssi", "--layout", "afs60", "--set", "ssi-error=ERRX"], 2, &["ERRX", "ERRDIG, ERRSI, ERRSYNC"]),
        (&["ssi", "--set", "line=bad"], 2, &["good, open, low or high"]),
        (&["ssi", "--set", "colour=red"], 2, &["colour", "ssi-error"]),
        (&["ssi", "--fault", "lose:1"], 2, &["lose:1"]),
        (&["biss", "--layout", "atm60"], 2, &["--layout", "ssi"]),
    ];
    for (arguments, status, words) in cases {
        let listen = ["--listen", "127.0.0.1:0"];
        bench.run(&[&["simulate"], arguments, &listen].concat()).fails(status, words);
    }
}
