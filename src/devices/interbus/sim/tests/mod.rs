//! Tests of the virtual encoder as seen by a master, in virtual time. The expected words come from the reference and
//! not from the code under test.

mod any;
mod cams;
mod gateway;
mod parameters;
mod read_outs;
mod storage;
mod vectors;

use std::time::Duration;

use super::*;
use crate::devices::interbus::protocol::ProgramNumber;
use crate::units::Moment;

/// A master that writes OUT words and reads IN words directly, without a bus.
struct Master {
    encoder: Encoder,
    now: Moment,
}

impl Master {
    /// Creates a master from the query of a `sim:` link. Unless the query configures them, there are no stale or busy
    /// words.
    fn with(query: &str) -> Self {
        let config = config(&format!("stale=0&busy=0&{query}"));
        Master { encoder: Encoder::new(&config, 0), now: Moment::START }
    }

    fn write(&mut self, word: u32) {
        self.encoder.write(self.now, word);
    }

    fn read(&mut self) -> u32 {
        self.encoder.read(self.now).unwrap()
    }

    /// Writes words and checks the IN word after each of them.
    #[track_caller]
    fn exchange(&mut self, words: &[(u32, u32)]) {
        for (out, expected) in words {
            self.write(*out);
            let word = self.read();
            assert_eq!(word, *expected, "{out:08X} gave {word:08X}, not {expected:08X}");
        }
    }

    /// Writes words and checks that none is rejected.
    #[track_caller]
    fn put(&mut self, words: &[u32]) {
        for word in words {
            self.write(*word);
            let reply = self.read();
            assert!(reply >> 29 != 0b100, "{word:08X} gave {reply:08X}");
        }
    }

    fn wait(&mut self, milliseconds: u64) {
        self.now = self.now + Duration::from_millis(milliseconds);
    }

    fn set_shaft_position(&mut self, place: i32) {
        self.encoder.set_shaft_position(self.now, place);
    }

    /// Returns the IN word at a disc position.
    fn position(&mut self, place: i32) -> u32 {
        self.set_shaft_position(place);
        self.read()
    }

    fn power_cycle(&mut self) {
        self.encoder.disconnect();
        self.encoder.connect(self.now);
    }
}

fn config(query: &str) -> Config {
    let pair = |item: &str| item.split_once('=').map(|(key, value)| (key.to_owned(), value.to_owned()));
    let pairs: Vec<_> = query.split('&').filter_map(pair).collect();
    Config::from_pairs(&pairs).unwrap()
}

fn program(number: u8) -> ProgramNumber {
    ProgramNumber::new(number).unwrap()
}
