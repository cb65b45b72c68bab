//! Recordings that are converted to frames: the program's own table, and the clock and data lines from logic analysers.
//! Python generates them from the frames of `tests/vectors/ssi_find`.

use std::io::Write;
use std::process::Stdio;

use serde_json::Value;

use crate::support::{Bench, Ran, finish, python};

/// Returns a recording of an AHM36 in Gray code with 27 clocks: its frames and the expected positions.
fn recording() -> Vec<(String, Option<u64>)> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/vectors/ssi_find/ahm36_gray.txt");
    let text = std::fs::read_to_string(path).unwrap();
    let lines = text.lines().filter(|line| !line.starts_with('#')).map(|line| line.split_once(' ').unwrap());
    lines.map(|(frame, meant)| (frame.to_owned(), meant.parse().ok())).collect()
}

/// Converts the frames to a logic analyser export, or returns `None` if Python is missing.
fn capture(analyser: &str, frames: &[(String, Option<u64>)]) -> Option<String> {
    let mut child =
        python("ssi_capture.py")?.arg(analyser).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
    let text: String = frames.iter().map(|(frame, _)| format!("{frame}\n")).collect();
    child.stdin.take().unwrap().write_all(text.as_bytes()).unwrap();
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success());
    Some(String::from_utf8(output.stdout).unwrap())
}

fn positions(ran: &Ran) -> Vec<Option<u64>> {
    let told = ran.out.lines().map(|line| serde_json::from_str::<Value>(line).unwrap());
    told.map(|told| told["position"].as_u64()).collect()
}

/// Runs the program with `text` on its standard input.
fn fed(bench: &Bench, arguments: &[&str], text: &str) -> Ran {
    let path = bench.write("input", text);
    let mut program = bench.program(arguments);
    program.stdin(std::fs::File::open(path).unwrap());
    finish(program)
}

const LAYOUT: [&str; 5] = ["ssi", "decode", "--json", "--layout", "ahm36,code=gray"];

#[test]
fn decodes_logic_analyser_edges() {
    let rows = recording();
    // The positions that Python intended. A damaged frame has none.
    let meant: Vec<Option<u64>> = rows.iter().map(|(_, meant)| *meant).collect();
    for (analyser, count) in [("saleae", rows.len()), ("sigrok", 300)] {
        let Some(text) = capture(analyser, &rows[..count]) else { return };
        let bench = Bench::new();
        let path = bench.write("capture.csv", text.clone());
        let decoded = bench.run(&[&LAYOUT[..], &[&format!("@{path}")]].concat());
        assert!(decoded.err.contains("Incomplete bursts excluded: 2."), "{analyser}: {}", decoded.err);
        let read = positions(&decoded);
        assert_eq!(read.len(), count, "{analyser}");
        for (number, (read, meant)) in read.iter().zip(&meant).enumerate() {
            assert!(meant.is_none() || read == meant, "{analyser}, frame {number}: {read:?}, not {meant:?}");
        }
        let input = fed(&bench, &[&LAYOUT[..], &["-"]].concat(), &text);
        assert_eq!(positions(&input), read, "{analyser}");
        // The search finds the same layout as in the frames themselves.
        let frames: String = rows[..count].iter().map(|(frame, _)| format!("{frame}\n")).collect();
        let frames = bench.run(&["ssi", "find", "--json", &bench.write("frames.txt", frames)]).json();
        assert_eq!(bench.run(&["ssi", "find", "--json", &path]).json(), frames, "{analyser}");
        assert_eq!(fed(&bench, &["ssi", "find", "--json", "-"], &text).json(), frames, "{analyser}");
    }
}

#[test]
fn reloads_position_table() {
    let bench = Bench::new();
    let link = "--link=sim:?ssi=ahm36,code=gray&rpm=60";
    let asked = ["position", "ssi", "--layout", "ahm36,code=gray", link, "--count", "20", "--interval", "0", "--csv"];
    let table = bench.run(&asked).out;
    let meant: Vec<Option<u64>> = table
        .lines()
        .skip(1)
        .map(|row| {
            let cells: Vec<&str> = row.split(',').collect();
            Some(cells[2].parse::<u64>().unwrap() << 14 | cells[3].parse::<u64>().unwrap())
        })
        .collect();
    let path = bench.write("table.csv", table.clone());
    let read = bench.run(&[&LAYOUT[..], &[&format!("@{path}")]].concat());
    assert_eq!((positions(&read).len(), positions(&read)), (20, meant));
    // The frame from section 8 of the reference together with a file.
    let both = bench.run(&[&LAYOUT[..], &["0x0D93EEC", &format!("@{path}")]].concat());
    assert_eq!((positions(&both)[0], positions(&both).len()), (Some(0x123 << 14 | 0x2A5B), 21));
    // Twenty frames are too few to decide.
    let found = bench.run(&["ssi", "find", "--json", "--clocks", "27", &path]);
    assert_eq!(serde_json::from_str::<Value>(&found.out).unwrap()["frames"], 20, "{found:?}");
    assert!(bench.run(&["ssi", "find", &path]).err.contains("--clocks N"), "a number has no leading zeros");
}

#[test]
fn invalid_recording_names_line_and_remedy() {
    let bench = Bench::new();
    let refused = |text: &str, told: &[&str]| {
        let path = bench.write("bad.csv", text);
        bench.run(&["ssi", "find", &path]).fails(1, told);
        bench.run(&[&LAYOUT[..], &[&format!("@{path}")]].concat()).fails(1, told);
    };
    refused("Time [s],Channel 0\n0.0,1\n0.1,0\n", &["one channel", "Record both the clock and the data"]);
    refused(
        "Time [s],Channel 0,Channel 1\n0.0,1,1\n0.000001,0",
        &["line 3", "2 columns instead of 3", "file is incomplete"],
    );
    refused("Time [s],Channel 0,Channel 1\n0,000001,1,1\n", &["Line 2", "4 columns", "decimal point"]);
    refused("Time [s],Channel 0,Channel 1\n0.0,3.31,0.02\n", &["Line 2", "3.31", "digital channels"]);
    refused("t_s,raw,turns,steps,degrees,millimetres,valid\n0.0,17\n", &["line 2", "file is incomplete"]);
    refused("date,price\nmonday,17\n", &["no frames", "time, clock and data"]);
    let other = bench.write("other.txt", "101010101\n");
    bench.run(&[&LAYOUT[..], &[&format!("@{other}")]].concat()).fails(1, &["other.txt", "9 bits", "27 clocks"]);
    bench.run(&[&LAYOUT[..], &["@nowhere.csv"]].concat()).fails(1, &["nowhere.csv"]);
    let huge = bench.file("huge.csv");
    std::fs::File::create(&huge).unwrap().set_len(17 << 20).unwrap();
    bench.run(&["ssi", "find", &huge]).fails(1, &["huge.csv", "16 MB", "shorter section"]);
}

/// Exports are passed on to other people, so they contain the file name of a profile without its folder.
#[test]
fn exports_omit_local_paths() {
    let bench = Bench::new();
    let path = bench.file("feeder.ron");
    bench.run(&["save", "ssi", "--layout", "atm60,code=gray", "-o", &path]);
    for format in ["c", "st", "st-dword", "scl", "sheet", "svg", "timing", "csv", "profile"] {
        let told = bench.run(&["ssi", "export", "--layout", &path, "--format", format]).out;
        assert!(!told.is_empty() && !told.contains(&bench.file("")), "{format}: {told}");
        assert_eq!(told.contains("feeder.ron"), !["csv", "profile"].contains(&format), "{format}");
    }
}
