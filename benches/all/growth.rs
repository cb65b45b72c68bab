//! Measures how the cost of an operation grows with the number of samples, registers, trace frames, logbook entries and
//! connected devices, each at three sizes. The slope is the exponent with which the time grows from the smallest to the
//! largest size: 0 if it does not depend on the size, 1 if it is proportional. Prints figures without a verdict.
//!
//! `cargo bench -- growth`

use std::fmt::Write as _;
use std::hint::black_box;
use std::time::Duration;

use encoder_studio::analysis::SampleTime;
use encoder_studio::analysis::history::{ColumnPart, Grid, History, Kind, RenderedHistory};
use encoder_studio::app::{FrameExplanation, Language, Text, TraceFilter, TraceLog, TraceMatches};
use encoder_studio::bits::MaskedBytes;
use encoder_studio::kinds::program;
use encoder_studio::link::{Direction, TraceEntry};
use encoder_studio::profile::ProfileDocument;
use encoder_studio::units::Moment;

use crate::logbook::{fill, search, view};
use crate::median;
use crate::soak::{connect_devices, open_window};

const ROUNDS: usize = 9;

pub(crate) fn run(parts: &[String]) {
    let is_wanted = |part: &str| parts.is_empty() || parts.iter().any(|wanted| wanted == part);
    println!("{:<44} {:>10} {:>12} {:>12}", "median of 9", "size", "ms", "slope");
    for (name, measure) in [
        ("samples", samples as fn()),
        ("registers", registers),
        ("trace", trace),
        ("logbook", logbook),
        ("devices", devices),
    ] {
        if is_wanted(name) {
            measure();
        }
    }
}

/// Prints the times for three sizes, followed by the slope.
fn print(what: &str, times: &[(usize, f64)]) {
    for (at, (size, seconds)) in times.iter().enumerate() {
        let slope = match times {
            [(least, before), .., last] if at + 1 == times.len() => {
                format!("{:.2}", (last.1 / before).ln() / (last.0 as f64 / *least as f64).ln())
            }
            _ => String::new(),
        };
        println!("{what:<44} {size:>10} {:>12.4} {slope:>12}", seconds * 1e3);
    }
}

fn samples() {
    const SIGNALS: usize = 4;
    const BATCH: usize = 10_000;
    const PERIOD: i64 = 10_000;
    const PIXELS: usize = 1_000;
    let (mut append, mut picture_times, mut scan_times, mut memory) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for count in [100_000, 1_000_000, 10_000_000] {
        let values: Vec<f64> = (0..BATCH).map(|at| (at as f64 * 0.01).sin()).collect();
        let parts: Vec<ColumnPart<'_>> = (0..SIGNALS).map(|_| ColumnPart::from_reals(&values)).collect();
        let mut history = History::new(&[Kind::Real; SIGNALS], count);
        let mut batches = Vec::new();
        for first in (0..count).step_by(BATCH) {
            let times: Vec<SampleTime> =
                (first..first + BATCH).map(|at| SampleTime::from_nanoseconds(at as i64 * PERIOD)).collect();
            let begun = std::time::Instant::now();
            history.append(&times, &parts).unwrap();
            batches.push(begun.elapsed().as_secs_f64());
        }
        batches.sort_by(f64::total_cmp);
        append.push((count, batches[batches.len() / 2]));
        memory.push((count, history.memory() as f64 / (count * 8 * (SIGNALS + 1)) as f64));
        let end = SampleTime::from_nanoseconds(count as i64 * PERIOD);
        let mut picture = RenderedHistory::default();
        picture_times.push((
            count,
            median(ROUNDS, || {
                let cut = history.divide_into_pixels(&Grid::new(SampleTime::ORIGIN, end, PIXELS));
                for column in 0..SIGNALS {
                    history.render_column(column, &cut, &mut picture);
                    black_box(&picture);
                }
            }),
        ));
        let raw: Vec<f64> = values.iter().copied().cycle().take(count).collect();
        scan_times.push((
            count,
            median(ROUNDS, || {
                for _ in 0..SIGNALS {
                    for pixel in raw.chunks(count / PIXELS) {
                        let least = pixel.iter().copied().fold(f64::INFINITY, f64::min);
                        let most = pixel.iter().copied().fold(f64::NEG_INFINITY, f64::max);
                        black_box((least, most));
                    }
                }
            }),
        ));
    }
    print("samples: append a batch of 10,000 × 4", &append);
    print("samples: a picture of all", &picture_times);
    print("samples: the same by a full scan", &scan_times);
    for (count, ratio) in memory {
        println!("{:<44} {count:>10} {ratio:>12.3} × the raw bytes", "samples: memory");
    }
}

/// Returns a BiSS profile with the given number of OEM data registers, all of which have the value `byte`.
fn profile(registers: usize, byte: u8) -> String {
    let line = vec![format!("{byte:02X}"); 16].join(" ");
    let mut banks = String::new();
    for bank in 0..registers / 64 {
        let _ = writeln!(banks, "(bank: {}, bytes: [{}]),", 0x24 + bank, vec![format!("{line:?}"); 4].join(",\n"));
    }
    format!(
        "(schema: 1, device: \"biss\", saved: \"2026-11-21T22:00:00Z\", identity: (serial_number: \"1234567\", \
         profile_id: 0x6129, device_id: \"01 01 68 11 00 01\", manufacturer: \"46 72\", firmware: \"1.6.0\", \
         description: \"kit\", multiturn_bits: 16, singleturn_bits: 17), recorded: (), \
         data: [(name: \"OEM data\", banks: (0x24, 0x43), listed: [{banks}])])"
    )
}

fn registers() {
    let formats = program().studio.formats;
    let (mut parse, mut compare, mut bytes) = (Vec::new(), Vec::new(), Vec::new());
    for count in [128, 512, 2_048] {
        let (old, new) = (profile(count, 0x11), profile(count, 0x22));
        let read = |text: &str| ProfileDocument::parse(text, formats).unwrap();
        let (before, after) = (read(&old), read(&new));
        parse.push((count, median(ROUNDS, || read(&old))));
        compare.push((count, median(ROUNDS, || before.body.compare(&after.body).unwrap())));
        bytes
            .push((count, median(ROUNDS, || black_box(&old).lines().zip(new.lines()).filter(|(a, b)| a != b).count())));
    }
    print("registers: read a profile", &parse);
    print("registers: compare two, all differ", &compare);
    print("registers: the same texts line by line", &bytes);
}

fn trace() {
    let frame = |number: usize| {
        let bytes: MaskedBytes = "40 42 00 0E 05 31 38".parse().unwrap();
        let at = Moment::from_elapsed(Duration::from_millis(number as u64));
        let meaning = vec![Text::new("recorder.position"), Text::new("unit.degrees")];
        (TraceEntry { at, direction: Direction::Received, bytes }, FrameExplanation { header: 0, meaning, fault: None })
    };
    let filter = TraceFilter { search: "05 31 39".to_owned(), faults_only: false };
    let (mut add, mut search, mut next, mut all) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for count in [400, 4_000, 40_000] {
        let mut log = TraceLog::default();
        log.add_frames((0..count).map(frame), 0);
        let found = |matches: &mut TraceMatches, log: &TraceLog| {
            matches.update_matches(log, &filter, Language::English, log.next_number());
        };
        search.push((count, median(ROUNDS, || found(&mut TraceMatches::default(), &log))));
        let mut matches = TraceMatches::default();
        found(&mut matches, &log);
        all.push((count, median(ROUNDS, || log.lines().iter().filter(|line| line.bytes.contains("05 31 39")).count())));
        add.push((count, median(ROUNDS, || log.add_frames((0..100).map(frame), 0))));
        next.push((
            count,
            median(ROUNDS, || {
                log.add_frames((0..100).map(frame), 0);
                found(&mut matches, &log);
            }),
        ));
    }
    print("trace: add 100 frames", &add);
    print("trace: first search of bytes and meaning", &search);
    print("trace: add 100 frames and update the search", &next);
    print("trace: bytes alone, every frame again", &all);
}

fn logbook() {
    let (mut open, mut found, mut scan) = (Vec::new(), Vec::new(), Vec::new());
    for count in [1_000, 10_000, 100_000] {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("logbook.sqlite");
        fill(&path, count);
        let size = count as usize;
        open.push((size, median(ROUNDS, || view(&path))));
        found.push((size, median(ROUNDS, || search(&path, "not in any entry"))));
        let database = rusqlite::Connection::open(&path).unwrap();
        scan.push((
            size,
            median(ROUNDS, || {
                let mut statement = database.prepare("SELECT description FROM event").unwrap();
                let rows = statement.query_map((), |row| row.get::<_, String>(0)).unwrap();
                rows.filter(|row| row.as_ref().unwrap().contains("not in any entry")).count()
            }),
        ));
    }
    print("logbook: open the view", &open);
    print("logbook: a search without a match", &found);
    print("logbook: every description read and compared", &scan);
}

fn devices() {
    let mut frames = Vec::new();
    for count in [1, 3, 5] {
        let folder = tempfile::tempdir().unwrap();
        let mut screen = open_window(folder.path());
        connect_devices(&mut screen, count);
        frames.push((count, median(601, || screen.step())));
    }
    print("devices polled: a frame, median of 601", &frames);
}
