//! Benchmarks, each compared with a naive solution or a physical limit. They print figures without a verdict.
//!
//! `cargo bench` runs all of them, `cargo bench -- NAME` a single one. Further arguments select parts of that
//! benchmark.
#![allow(missing_docs, clippy::unwrap_used, clippy::expect_used, clippy::indexing_slicing, clippy::panic)]

mod analyse;
mod biss;
mod growth;
mod hiperdrive;
mod history;
mod interbus;
mod logbook;
mod plot;
mod poll;
mod soak;
mod ssi;
mod window;

use std::hint::black_box;
use std::time::Instant;

/// Runs the work several times and returns the median time in seconds.
fn median<T>(rounds: usize, mut work: impl FnMut() -> T) -> f64 {
    let mut times: Vec<f64> = (0..rounds)
        .map(|_| {
            let begun = Instant::now();
            black_box(work());
            begun.elapsed().as_secs_f64()
        })
        .collect();
    times.sort_by(f64::total_cmp);
    times[rounds / 2]
}

/// A benchmark and its name. The function's arguments select the parts to run.
type Benchmark = (&'static str, fn(&[String]));

const ALL: &[Benchmark] = &[
    ("analyse", |_| analyse::run()),
    ("biss", |_| biss::run()),
    ("growth", growth::run),
    ("hiperdrive", |_| hiperdrive::run()),
    ("history", history::run),
    ("interbus", |_| interbus::run()),
    ("logbook", |_| logbook::run()),
    ("plot", plot::run),
    ("poll", |_| poll::run()),
    ("soak", soak::run),
    ("ssi", |_| ssi::run()),
    ("window", window::run),
];

fn main() {
    // Cargo adds one more option.
    let words: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with('-')).collect();
    let Some((name, parts)) = words.split_first() else {
        for (name, run) in ALL {
            println!("── {name}");
            run(&[]);
        }
        return;
    };
    match ALL.iter().find(|(own, _)| own == name) {
        Some((_, run)) => run(parts),
        None => {
            let names: Vec<&str> = ALL.iter().map(|(name, _)| *name).collect();
            eprintln!("No benchmark \"{name}\". Choose one of: {}.", names.join(", "));
            std::process::exit(2);
        }
    }
}
