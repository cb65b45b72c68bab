//! `move hiperdrive`, the only command that causes motion.

use std::time::Duration;

use serde_json::json;

use super::support::{Bench, Simulated};

/// A turn has 65536 steps (reference 3 and 5). The drive is off after it has reached its target.
#[test]
fn drive_moves_to_position() {
    let bench = Bench::new();
    let simulated = Simulated::start(&bench, &["hiperdrive", "--listen", "127.0.0.1:0", "--hub", "4"]);
    let link = format!("enip:{}", simulated.place);
    let run = |arguments: &[&str]| bench.run(&[arguments, &["--link", &link]].concat());
    // With factory settings, parameter 152 (Requested) is 0 for every drive of a hub.
    assert_eq!(run(&["write", "hiperdrive", "152", "1", "--drive", "2", "--yes"]).status, Some(0));
    let ran = run(&["move", "hiperdrive", "65536", "--drive", "2", "--yes", "--json"]);
    assert_eq!(ran.json(), json!({"drive": 2, "target": 65_536, "position": 65_536, "reached": true}));
    let ran = run(&["move", "hiperdrive", "-1000", "--drive", "2", "--yes", "--speed", "50", "--torque", "25"]);
    assert_eq!((ran.status, ran.out.as_str()), (Some(0), "drive 2 is at -1000\n"));
    // The limits are ±511 turns, and 1000 of 65536 steps are 0.015 of a turn.
    let range = "drive 2 moves to -1000 (-0.02 turns), within -33488896 (-511.00 turns) to 33488896 (511.00 turns)\n";
    assert_eq!(ran.err, range);
    // The status word is 0E30 or 2E30: the reference is found, the drive is at standstill and not ready.
    let word = run(&["read", "hiperdrive", "105", "--drive", "2", "--json"]).json()["value"].as_u64().unwrap();
    assert_eq!(word & 0x007F, 0x0030, "{word:04X}");
    // The other drives have not moved.
    assert_eq!(run(&["read", "hiperdrive", "107", "--json"]).json()["value"], 0);
    simulated.end("INT");
}

/// The command ends with status 2, which means wrong usage. It does not open a connection: there is no device at this
/// address.
#[test]
fn moves_nothing_without_consent() {
    let bench = Bench::new();
    for (arguments, words) in [
        (&["65536"][..], &["--yes", "nothing was changed"][..]),
        (&["65536", "--json"], &["--yes"]),
        (&["far", "--yes"], &["far", "a number of steps"]),
        (&["0", "--yes", "--drive", "9"], &["--drive", "1..=8"]),
        (&["0", "--yes", "--speed", "101"], &["--speed", "101"]),
        (&["0", "--yes", "--timeout", "0"], &["--timeout"]),
    ] {
        let ran = bench.run(&[&["move", "hiperdrive"], arguments, &["--link", "enip:127.0.0.1:1"]].concat());
        assert_eq!((ran.status, ran.out.as_str()), (Some(2), ""), "{ran:?}");
        words.iter().for_each(|word| assert!(ran.err.contains(word), "{word}: {ran:?}"));
    }
    assert_eq!(bench.run(&["move", "hiperdrive", "1", "--yes"]).status, Some(2), "there is no default link");
    assert_eq!(bench.run(&["move", "interbus", "1", "--yes", "--link", "sim:"]).status, Some(2));
}

/// The command ends with status 1 and one sentence, and the drive does not move.
#[test]
fn rejects_invalid_moves() {
    let bench = Bench::new();
    let limits = ["-33488896", "33488896"];
    for (link, arguments, words) in [
        ("sim:", &["33488897"][..], &limits[..]),
        ("sim:", &["-65536000000"], &["-65536000000", limits[0], limits[1]]),
        ("sim:", &["1000", "--speed", "0"], &["0 %", "1 %"]),
        ("sim:", &["1000", "--torque", "0"], &["0 %", "1 %"]),
        ("sim:?hub=4", &["1000"], &["152", "write hiperdrive 152 1"]),
        ("sim:?hub=4&drives=1", &["1000", "--drive", "3"], &["No drive is connected at port 3"]),
    ] {
        bench.run(&[&["move", "hiperdrive"], arguments, &["--yes", "--link", link]].concat()).fails(1, words);
    }
}

/// The position is printed even in the format for scripts.
#[test]
fn incomplete_move_reports_position() {
    let bench = Bench::new();
    let run = |link: &str, seconds: &str| {
        bench.run(&["move", "hiperdrive", "9000000", "--yes", "--json", "--timeout", seconds, "--link", link])
    };
    let late = run("sim:", "1");
    let position = late.json_with_status(1)["position"].as_i64().unwrap();
    assert!(0 < position && position < 9_000_000, "{late:?}");
    assert_eq!(late.json_with_status(1)["reached"], false);
    late.assert_stderr(&["1 s", "--timeout", &position.to_string()]);
    assert!(late.took < Duration::from_secs(10), "{late:?}");
    run("sim:?s3=1", "5").assert_stderr(&["S3", "at 0"]);
    // A following error is 8203h, or 33283 (reference 4).
    let blocked = run("sim:?load=120", "5");
    blocked.assert_stderr(&["fault", "at 0", "0x8203"]);
    assert_eq!(blocked.json_with_status(1)["error"]["code"], 33_283);
}
