//! The `position` command: a table for scripts, and streams that Ctrl-C ends between two lines.

use std::io::{BufRead, BufReader, Read};
use std::time::Instant;

use super::support::{Bench, Foreign, ended, signal};

const HEADER: &str = "t_s,raw,turns,steps,degrees,valid,codes";

#[test]
fn prints_one_header_and_line_per_reading() {
    let bench = Bench::new();
    // An SKM36 has 128 periods of 32 steps and 4096 turns. The position 0E0531h is turn 224 and step 1329, or
    // 116.806640625°.
    let link = "sim:?position=0xE0531";
    let ran = bench.run(&["position", "hiperface", "--link", link, "--csv", "--count", "3", "--interval", "0"]);
    assert_eq!((ran.status, ran.err.as_str()), (Some(0), ""), "{ran:?}");
    let lines: Vec<&str> = ran.out.lines().collect();
    assert_eq!((lines.len(), lines[0]), (4, HEADER));
    let mut last = -1.0;
    for line in &lines[1..] {
        let (time, rest) = line.split_once(',').unwrap();
        assert_eq!(rest, "918833,224,1329,116.806640625,true,");
        let time: f64 = time.parse().unwrap();
        assert!(time > last, "{lines:?}");
        last = time;
    }
}

#[test]
fn prints_millimetre_and_status_columns() {
    let bench = Bench::new();
    // Type 90h has periods of 1 mm. 0E0531h is 918833 steps of 1/32 mm.
    let Some(encoder) = bench.encoder(&["--type", "90", "--status", "1C08"]).map(Foreign::with_long_reply_margin)
    else {
        return;
    };
    let arguments = ["position", "hiperface", "--link", &encoder.url, "--csv", "--count", "2", "--interval", "0"];
    let ran = bench.run(&arguments);
    let lines: Vec<&str> = ran.out.lines().collect();
    assert_eq!(lines[0], "t_s,raw,turns,steps,millimetres,valid,codes");
    let behind_the_time = |line: &str| line.split_once(',').unwrap().1.to_owned();
    // Warnings leave the position valid, and are printed in the line of the sample that reported them.
    assert_eq!(behind_the_time(lines[1]), "918833,,,28713.53125,true,1C 08", "{ran:?}");
    assert_eq!(behind_the_time(lines[2]), "918833,,,28713.53125,true,", "{ran:?}");
}

#[test]
fn ctrl_c_ends_stream_between_lines() {
    let bench = Bench::new();
    // Without a number of lines, a table runs until Ctrl-C, which is then not a failure. A stream with a number of
    // lines is interrupted by it.
    let cases: [(&[&str], i32); 3] =
        [(&["--csv"], 0), (&["--csv", "--count", "100000"], 1), (&["--json", "--count", "100000"], 1)];
    for (options, status) in cases {
        for interval in ["0", "40"] {
            let arguments = [&["position", "hiperface", "--link", "sim:", "--interval", interval], options].concat();
            let mut child = bench.program(&arguments).spawn().unwrap();
            let mut out = BufReader::new(child.stdout.take().unwrap());
            let mut text = String::new();
            // Each line is printed as soon as it is read, without waiting for a full buffer.
            (0..4).for_each(|_| assert!(out.read_line(&mut text).unwrap() > 0));
            signal(&child, "INT");
            let rest = std::thread::spawn(move || {
                let mut rest = String::new();
                out.read_to_string(&mut rest).unwrap();
                rest
            });
            let ran = ended(child, Instant::now());
            text.push_str(&rest.join().unwrap());
            assert_eq!(ran.status, Some(status), "{options:?}: {ran:?}");
            assert_eq!(ran.err.is_empty(), status == 0, "{options:?}: {ran:?}");
            assert!(text.ends_with('\n'), "{options:?}: {text:?}");
            let fields = |line: &str| line.split(',').count();
            let whole = |line: &str| match options[0] {
                "--csv" => fields(line) == 7,
                _ => serde_json::from_str::<serde_json::Value>(line).is_ok(),
            };
            assert!(text.lines().all(whole), "{options:?}: {text}");
        }
    }
}

#[test]
fn csv_and_json_exclude_each_other() {
    let bench = Bench::new();
    bench.run(&["position", "hiperface", "--link", "sim:", "--csv", "--json"]).fails(2, &["--csv", "--json"]);
}
