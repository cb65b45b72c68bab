//! Compares the bytes sent by each kind of write, with and without interruptions, with the recordings under
//! `tests/fixtures/wire`. Each file contains the complete write. For each interruption it has the number of lines that
//! equal those of the complete write, the number of lines after them, a checksum of all lines, and the result.
//!
//! `ENCODER_STUDIO_RECORD=1` rewrites the files. Use it only if the data are meant to change, and commit the difference
//! with the change.

mod biss;
mod hiperdrive;
mod hiperface;
mod interbus;

use std::fmt::Write as _;
use std::path::PathBuf;
use std::sync::{Arc, Mutex};

use encoder_studio::link::{CancelToken, Direction};
use encoder_studio::worker::{Device, Session};

use crate::support::Tap;

/// A prepared write with the means to interrupt it.
struct Ready {
    tap: Arc<Mutex<Tap>>,
    cancel: CancelToken,
    lines: Lines,
    /// Executes the write and returns the result as text.
    carry_out: Box<dyn FnOnce() -> String>,
}

/// Frames as shown by the trace, with masked access codes.
type Lines = Arc<Mutex<Vec<String>>>;

/// Records every following frame of the session. Also returns the token that cancels its job.
fn listen<D: Device>(session: &mut Session<D>) -> (Lines, CancelToken) {
    let lines = Lines::default();
    let kept = lines.clone();
    session.add_watcher(move |entry| {
        let sign = if entry.direction == Direction::Sent { '>' } else { '<' };
        kept.lock().unwrap().push(format!("{sign} {}", entry.bytes));
    });
    let cancel = CancelToken::default();
    session.set_cancel(cancel.clone());
    (lines, cancel)
}

/// A function that interrupts a write at the frame with the given number.
type InterruptFn = fn(&mut Tap, &CancelToken, usize);

/// The ways to interrupt a write, with their names in the recordings.
const INTERRUPTIONS: [(&str, InterruptFn); 3] = [
    ("cancelled", |tap, cancel, at| tap.cancel_at = Some((at, cancel.clone()))),
    ("lost", |tap, _, at| tap.lost_from = Some(at)),
    ("mute", |tap, _, at| tap.mute_from = Some(at)),
];

impl Ready {
    fn run(self) -> (Vec<String>, String) {
        let ended = (self.carry_out)();
        let lines = std::mem::take(&mut *self.lines.lock().unwrap());
        (lines, ended)
    }
}

/// Compares a write with its recording, both complete and interrupted at the sent frames `points` (counted from 0, or
/// at every frame if `None`).
fn compare(name: &str, points: Option<&[usize]>, ready: &mut dyn FnMut() -> Ready) {
    let undisturbed = ready();
    let (tap, first) = (undisturbed.tap.clone(), undisturbed.tap.lock().unwrap().sent.len());
    let (whole, ended) = undisturbed.run();
    let frames = tap.lock().unwrap().sent.len() - first;
    let mut text = whole.join("\n");
    let _ = writeln!(text, "\n= {ended}");
    let all: Vec<usize> = (0..frames).collect();
    for (label, disturb) in INTERRUPTIONS {
        for at in points.unwrap_or(&all) {
            let ready = ready();
            let first = ready.tap.lock().unwrap().sent.len();
            disturb(&mut ready.tap.lock().unwrap(), &ready.cancel, first + at);
            let (lines, ended) = ready.run();
            let same = lines.iter().zip(&whole).take_while(|(one, other)| one == other).count();
            let more = lines.len() - same;
            let _ = writeln!(text, "{label} {at}: {same}+{more} {:016x} = {ended}", sum(&lines));
        }
    }
    assert_recorded(name, &text);
}

/// Returns the 64-bit FNV-1a hash of the lines.
fn sum(lines: &[String]) -> u64 {
    let bytes = lines.iter().flat_map(|line| line.bytes().chain([b'\n']));
    bytes.fold(0xCBF2_9CE4_8422_2325, |sum, byte| (sum ^ u64::from(byte)).wrapping_mul(0x0100_0000_01B3))
}

fn assert_recorded(name: &str, text: &str) {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures/wire").join(format!("{name}.txt"));
    if std::env::var_os("ENCODER_STUDIO_RECORD").is_some() {
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(&path, text).unwrap();
        return;
    }
    let recorded = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let pairs = recorded.lines().map(Some).chain([None]).zip(text.lines().map(Some).chain([None]));
    for (number, (was, is)) in (1..).zip(pairs) {
        assert_eq!(is, was, "{name}, line {number}: the wire has changed");
    }
    assert_eq!(text, recorded, "{name}");
}
