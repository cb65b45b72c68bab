//! A program that goes on until something ends it: what it has printed says how far it is.

use std::io::{BufRead, BufReader, Read};
use std::process::{Child, ChildStdout, Command};
use std::time::Instant;

use super::support::{Ran, ended};

/// A program that goes on until something ends it, and what it has printed until then.
pub(crate) struct Going {
    pub(crate) child: Child,
    out: BufReader<ChildStdout>,
    text: String,
}

impl Going {
    /// Started, and it has printed so many lines.
    #[track_caller]
    pub(crate) fn since(mut command: Command, lines: usize) -> Self {
        let mut child = command.spawn().unwrap();
        let mut out = BufReader::new(child.stdout.take().unwrap());
        let mut text = String::new();
        for _ in 0..lines {
            if out.read_line(&mut text).unwrap() == 0 {
                panic!("it has ended: {text} {:?}", ended(child, Instant::now()));
            }
        }
        Going { child, out, text }
    }

    /// Waits for its end. The time is that from now on.
    pub(crate) fn ended(self) -> Ran {
        let Going { child, mut out, mut text } = self;
        let rest = std::thread::spawn(move || {
            out.read_to_string(&mut text).unwrap();
            text
        });
        let ran = ended(child, Instant::now());
        Ran { out: rest.join().unwrap(), ..ran }
    }
}
