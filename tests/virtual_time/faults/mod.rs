//! A fault campaign: in each run, one or two pseudo-random faults occur at any request of any operation that writes.
//! Afterwards no value is wrong, the device is in a state that the plan passes through, and a second run completes the
//! change.
//!
//! `ENCODER_STUDIO_FAULT_RUNS` sets the total number of runs of all kinds. `ENCODER_STUDIO_FAULT_SEED` repeats a single
//! run of each kind.

mod biss;
mod hiperdrive;
mod hiperface;
mod interbus;
mod link;

use std::collections::BTreeMap;
use std::fmt::Debug;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread;
use std::time::Duration;

use fastrand::Rng;

pub(crate) use self::link::{Fault, FaultyLink, Schedule};

/// Total number of runs of all kinds if no number is given.
const RUNS: u64 = 4_000;

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum End {
    /// The operation was completed in spite of the faults.
    Done,
    /// The operation was interrupted, and a second run completed it.
    Interrupted,
    /// The operation ended before anything was written.
    NotStarted,
}

/// Executes seeded runs on all threads and prints how they ended. `share` is the fraction of all runs, in thousandths.
/// If a run panics, the seed for repeating it is printed.
pub(crate) fn campaign(kind: &str, share: u64, run: impl Fn(&mut Rng) -> End + Sync) {
    let setting = |name| std::env::var(name).ok().map(|text: String| text.parse::<u64>().expect(name));
    let (first, runs) = match setting("ENCODER_STUDIO_FAULT_SEED") {
        Some(seed) => (seed, 1),
        None => (0, setting("ENCODER_STUDIO_FAULT_RUNS").unwrap_or(RUNS) * share / 1000),
    };
    let next = AtomicU64::new(first);
    let ends = [const { AtomicU64::new(0) }; 3];
    thread::scope(|scope| {
        for _ in 0..thread::available_parallelism().map_or(1, usize::from) {
            scope.spawn(|| {
                loop {
                    let seed = next.fetch_add(1, Ordering::Relaxed);
                    if seed >= first + runs {
                        return;
                    }
                    let _named = Named { kind, seed };
                    ends[run(&mut Rng::with_seed(seed)) as usize].fetch_add(1, Ordering::Relaxed);
                }
            });
        }
    });
    let [done, interrupted, not_begun] = ends.map(AtomicU64::into_inner);
    println!("{kind}: {runs} runs, {done} done, {interrupted} interrupted, {not_begun} not begun");
    if runs > 1 {
        assert!(done > runs / 20 && interrupted > runs / 40, "{kind}: the faults are not varied");
    }
}

/// Prints the seed if the run panics.
struct Named<'a> {
    kind: &'a str,
    seed: u64,
}

impl Drop for Named<'_> {
    fn drop(&mut self) {
        if thread::panicking() {
            eprintln!("{}: repeat with ENCODER_STUDIO_FAULT_SEED={}", self.kind, self.seed);
        }
    }
}

/// Returns one or two faults at random requests below `requests`. A late reply takes about ten times the usual time,
/// `usual`. On a stream, bytes are neither damaged nor inserted.
pub(crate) fn random_faults(
    rng: &mut Rng,
    requests: usize,
    usual: Duration,
    is_stream: bool,
) -> BTreeMap<usize, Fault> {
    let count = rng.usize(1..=2);
    (0..count).map(|_| (rng.usize(0..requests.max(1)), random_fault(rng, usual, is_stream))).collect()
}

fn random_fault(rng: &mut Rng, usual: Duration, is_stream: bool) -> Fault {
    let late = usual.mul_f64(5.0 + 10.0 * rng.f64());
    match rng.u8(..if is_stream { 6 } else { 14 }) {
        0 => Fault::LoseRequest,
        1 => Fault::LoseReply,
        2 => Fault::Silence,
        3 => Fault::Lost,
        4 => Fault::PowerLoss,
        5 => Fault::LateReply(late),
        6 => Fault::RepeatRequest,
        7 => Fault::RepeatReply,
        8 => Fault::FlipRequest { byte: rng.usize(..16), bit: rng.u8(..8) },
        9 => Fault::FlipReply { byte: rng.usize(..12), bit: rng.u8(..8) },
        10 => Fault::CutReply(rng.usize(..8)),
        11 => Fault::Garbage((0..rng.usize(1..6)).map(|_| rng.u8(..)).collect()),
        12 => Fault::StaleReply,
        _ => Fault::Echo,
    }
}

/// Asserts that the state also occurs in a run without faults.
pub(crate) fn assert_one_of<S: PartialEq + Debug>(state: &S, course: &[S], context: &str) {
    if !course.contains(state) {
        panic!("{context}: {state:?} is not a state of the plan: {course:?}");
    }
}
