//! A trace of all frames on a connection, with secrets masked. A `replay:` link reads its text format.
//!
//! ```text
//! # encoder-studio trace 1
//! 0.031204 > 40 42 02
//! 0.047511 < 40 42 00 0E 05 31 38
//! ```
//! Each line consists of a time in seconds, `>` for sent or `<` for received, and the bytes. `**` is a masked byte.
//! Lines that start with `#` are comments.

use std::fmt;
use std::io::{self, Write};
use std::time::Duration;

use crate::bits::{HexError, MaskedBytes};
use crate::units::Moment;

/// Direction of transmission.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// The computer sent the frame to the device.
    Sent,
    /// The computer received the frame from the device.
    Received,
}

/// A frame recorded in a trace.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TraceEntry {
    /// Time at which the first byte was sent or received.
    pub at: Moment,
    /// Direction of transmission.
    pub direction: Direction,
    /// Bytes of the frame, with secrets masked.
    pub bytes: MaskedBytes,
}

type Watcher = Box<dyn FnMut(&TraceEntry) + Send>;

/// A recorder that reports every frame on a connection to its watchers.
#[derive(Default)]
pub struct Trace {
    watchers: Vec<Watcher>,
    /// Time of the last frame.
    last: Moment,
}

impl fmt::Debug for Trace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Trace({} watchers)", self.watchers.len())
    }
}

impl Trace {
    /// Calls `watcher` for every subsequent frame. The watcher must not block.
    pub fn add_watcher(&mut self, watcher: impl FnMut(&TraceEntry) + Send + 'static) {
        self.watchers.push(Box::new(watcher));
    }

    /// Reports a frame to all watchers.
    ///
    /// The time of a reply is calculated back from the duration of its bytes. If a device server or a pseudo-terminal
    /// transfers all bytes at once, the result may be earlier than the request. In this case, the time of the request
    /// is used.
    pub fn record_frame(&mut self, at: Moment, direction: Direction, bytes: MaskedBytes) {
        if bytes.is_empty() {
            return;
        }
        self.last = at.max(self.last);
        let entry = TraceEntry { at: self.last, direction, bytes };
        for watcher in &mut self.watchers {
            watcher(&entry);
        }
    }
}

/// First line of a trace file.
pub const HEADER: &str = "# encoder-studio trace 1";

/// Writes the header of a trace file.
///
/// # Errors
/// Returns an error if writing fails.
pub fn write_header(file: &mut impl Write) -> io::Result<()> {
    writeln!(file, "{HEADER}")
}

/// Appends a line to a trace file.
///
/// # Errors
/// Returns an error if writing fails.
pub fn write_entry(file: &mut impl Write, entry: &TraceEntry) -> io::Result<()> {
    writeln!(file, "{}", entry_line(entry.at, entry.direction, &entry.bytes))
}

/// Formats a line of a trace file without the line ending. `bytes` must be hexadecimal, with `**` for masked bytes.
pub fn entry_line(at: Moment, direction: Direction, bytes: impl fmt::Display) -> String {
    let sign = match direction {
        Direction::Sent => '>',
        Direction::Received => '<',
    };
    format!("{:.6} {sign} {bytes}", at.since_start().as_secs_f64())
}

/// The reason why a text is not a valid trace.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TraceFileError {
    /// The first line is not the header of a trace file.
    #[error("the file does not begin with \"{HEADER}\"")]
    Header,
    /// A line does not consist of time, direction and bytes.
    #[error("line {line} is not of the form \"0.031204 > 40 42 02\"")]
    Line {
        /// Line number, starting at 1.
        line: usize,
    },
    /// The bytes of a line are invalid.
    #[error("line {line}: {source}")]
    Hex {
        /// Line number, starting at 1.
        line: usize,
        /// Cause of the error.
        source: HexError,
    },
}

/// Parses a trace file.
///
/// # Errors
/// Returns an error if the header is missing, or if a line is invalid. The error names the first invalid line.
pub fn read_trace(text: &str) -> Result<Vec<TraceEntry>, TraceFileError> {
    let mut lines = text.lines().zip(1..);
    if lines.next().map(|(line, _)| line.trim_end()) != Some(HEADER) {
        return Err(TraceFileError::Header);
    }
    lines
        .filter(|(text, _)| !text.trim().is_empty() && !text.trim_start().starts_with('#'))
        .map(|(text, line)| read_entry(text, line))
        .collect()
}

fn read_entry(text: &str, line: usize) -> Result<TraceEntry, TraceFileError> {
    let malformed = || TraceFileError::Line { line };
    let (time, rest) = text.trim_start().split_once(' ').ok_or_else(malformed)?;
    let seconds: f64 = time.parse().map_err(|_| malformed())?;
    let elapsed = Duration::try_from_secs_f64(seconds).map_err(|_| malformed())?;
    let (direction, bytes) = match rest.trim_start().split_at_checked(1) {
        Some((">", bytes)) => (Direction::Sent, bytes),
        Some(("<", bytes)) => (Direction::Received, bytes),
        _ => return Err(malformed()),
    };
    let bytes = bytes.parse().map_err(|source| TraceFileError::Hex { line, source })?;
    Ok(TraceEntry { at: Moment::from_elapsed(elapsed), direction, bytes })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn traces_round_trip() {
        let text = "# encoder-studio trace 1\n0.031204 > 40 4F 02 ** ** **\n0.047511 < 40 4F 02 0D\n";
        let entries = read_trace(text).unwrap();
        assert_eq!(entries.len(), 2);
        assert_eq!(entries[1].at, Moment::from_elapsed(Duration::from_micros(47_511)));
        let mut written = Vec::new();
        write_header(&mut written).unwrap();
        for entry in &entries {
            write_entry(&mut written, entry).unwrap();
        }
        assert_eq!(String::from_utf8(written).unwrap(), text);
    }

    #[test]
    fn frame_times_never_decrease() {
        let (sender, receiver) = std::sync::mpsc::channel();
        let mut trace = Trace::default();
        trace.add_watcher(move |entry| sender.send(entry.at).unwrap());
        let at = |millis| Moment::from_elapsed(Duration::from_millis(millis));
        for (millis, direction) in [(358, Direction::Sent), (354, Direction::Received), (374, Direction::Sent)] {
            trace.record_frame(at(millis), direction, "40 42 02".parse().unwrap());
        }
        assert_eq!(receiver.try_iter().collect::<Vec<_>>(), [at(358), at(358), at(374)]);
    }

    #[test]
    fn broken_trace_names_line() {
        let cases = [
            ("", "the file does not begin with \"# encoder-studio trace 1\""),
            ("# encoder-studio trace 1\n\n0.1 = 40", "line 3 is not of the form \"0.031204 > 40 42 02\""),
            ("# encoder-studio trace 1\n-1 > 40", "line 2 is not of the form \"0.031204 > 40 42 02\""),
            ("# encoder-studio trace 1\n# note\n1 > 4G", "line 3: 'G' is not a hexadecimal digit"),
        ];
        for (text, message) in cases {
            assert_eq!(read_trace(text).unwrap_err().to_string(), message);
        }
    }
}
