//! Fuzz tests of every parser for data from a device, a host or a file. No input may make a parser panic or hang, and
//! everything it reads must be the same after writing and reading it again. The folder `corpus` contains examples, most
//! of them from the golden vectors. Each test reads the examples and a thousand random mutations of them.
//!
//! `ENCODER_STUDIO_FUZZ_SECONDS=600 cargo test --release --test fuzz -- --nocapture` runs each parser for that time. An
//! input that fails is printed and should be added to the corpus.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::indexing_slicing, clippy::panic)]

mod bytes;
mod devices;
mod mutation;
mod texts;

use std::thread;
use std::time::{Duration, Instant};

use fastrand::Rng;

use mutation::mutate;

/// Number of mutated inputs if no time is given.
const ROUNDS: u64 = 1_000;
/// Maximum time for one input. The largest one takes only a fraction of it.
const LIMIT: Duration = Duration::from_secs(5);

/// Returns the examples in a file with one example per line in hexadecimal. `#` begins a comment.
fn hex_lines(text: &str) -> Vec<Vec<u8>> {
    let lines = text.lines().map(|line| line.split('#').next().unwrap_or_default());
    let digits = |line: &str| line.chars().filter(|c| !c.is_whitespace()).collect::<String>();
    let bytes = |digits: String| {
        let pairs = digits.as_bytes().chunks(2).map(|pair| std::str::from_utf8(pair).unwrap());
        pairs.map(|pair| u8::from_str_radix(pair, 16).unwrap()).collect::<Vec<u8>>()
    };
    lines.map(digits).filter(|line| !line.is_empty()).map(bytes).collect()
}

/// Runs a parser on the examples and on random mutations of them.
fn fuzz(name: &str, examples: &[Vec<u8>], parse: impl Fn(&[u8])) {
    assert!(!examples.is_empty(), "{name} has no examples");
    let tried = |input: &[u8]| {
        let _shown = Shown { name, input };
        let begun = Instant::now();
        parse(input);
        assert!(begun.elapsed() < LIMIT, "{name}: {:?}", begun.elapsed());
    };
    examples.iter().for_each(|example| tried(example));
    let seconds = std::env::var("ENCODER_STUDIO_FUZZ_SECONDS").ok().map(|text| text.parse::<u64>().unwrap());
    let (begun, mut count) = (Instant::now(), 0);
    let mut rng = match seconds {
        Some(_) => Rng::new(),
        None => Rng::with_seed(1),
    };
    while seconds.map_or(count < ROUNDS, |seconds| begun.elapsed() < Duration::from_secs(seconds)) {
        let example = rng.choice(examples).unwrap();
        let other = rng.choice(examples).unwrap();
        tried(&mutate(example, other, &mut rng));
        count += 1;
    }
    println!("{name}: {count} inputs");
}

/// A guard that prints the input if the parser panics.
struct Shown<'a> {
    name: &'a str,
    input: &'a [u8],
}

impl Drop for Shown<'_> {
    fn drop(&mut self) {
        if thread::panicking() {
            let hex: String = self.input.iter().map(|byte| format!("{byte:02X}")).collect();
            eprintln!("{}: add to the corpus: {hex}\n{:?}", self.name, String::from_utf8_lossy(self.input));
        }
    }
}
