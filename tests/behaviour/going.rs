//! Support for programs that run until they are stopped, with their output so far.

use std::io::{BufRead, BufReader, Read};
use std::process::{Child, ChildStdout, Command};
use std::time::Instant;

use super::support::{Ran, ended};

/// A running program and its output so far.
pub(crate) struct Going {
    pub(crate) child: Child,
    out: BufReader<ChildStdout>,
    text: String,
}

impl Going {
    /// Starts the program and waits until it has printed the given number of lines.
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

    /// Waits for the program to end. The time is measured from this call.
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
