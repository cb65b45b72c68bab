//! The search for the layout of frames: those read last, or those in a file.

use std::path::Path;

use super::form::whole;
use crate::app::{Text, explain};
use crate::devices::ssi::protocol::{Search, parse_frame};
use crate::devices::ssi::state::TEXTS;
use crate::devices::ssi::state::explain as words;
use crate::store::read_file;

/// Maximum number of frames searched: the newest.
pub(super) const MOST: usize = 8_000;

/// The origin of the frames.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Origin {
    /// Read from the encoder.
    Live,
    /// From a file of this name.
    File(String),
}

/// Frames that follow each other.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Frames {
    pub origin: Origin,
    /// Bits of each, 1…64.
    pub clocks: u8,
    /// The frames, right-justified.
    pub frames: Vec<u64>,
}

/// The state of the search.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum SearchState {
    /// No search.
    #[default]
    Nothing,
    /// Running, with its number.
    Running(u32),
    /// A result.
    Found {
        origin: Origin,
        /// Bits of each.
        clocks: u8,
        search: Box<Search>,
    },
    /// There were no frames: why, and what to do.
    Failed(Text),
}

/// Returns a number of clocks as people write one.
///
/// # Errors
/// Not a whole number, or one that a frame cannot have.
pub fn read_clocks(text: &str) -> Result<u8, Text> {
    let number = whole(text)?;
    let clocks = u8::try_from(number).ok().filter(|clocks| (1..=64).contains(clocks));
    clocks.ok_or_else(|| TEXTS.text("ssi_find.clocks_range").with("clocks", number))
}

/// Reads frames from a file, one per line: bits in the order of the clocks or 0x and hex digits, in the first column that
/// looks like a frame; others are ignored. Empty lines, a heading and lines that begin with # are skipped. Hexadecimal
/// frames have `clocks` bits.
///
/// # Errors
/// The file cannot be read, or a line is not a frame: which, and why.
pub fn read_frames(path: &Path, clocks: u8) -> Result<Frames, Text> {
    let text = read_file(path).map_err(|error| explain::file(&error))?;
    let name = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    parse_frames(&text, clocks).map(|(clocks, frames)| Frames { origin: Origin::File(name), clocks, frames })
}

fn parse_frames(text: &str, clocks: u8) -> Result<(u8, Vec<u64>), Text> {
    // The column of the frames and their bits, once a line has shown it.
    let mut own: Option<(usize, u8)> = None;
    let mut frames = Vec::new();
    for (number, line) in (1..).zip(text.lines()) {
        let line = line.trim().trim_start_matches('\u{feff}');
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let columns: Vec<&str> = columns(line);
        let place = columns.iter().position(|column| is_frame(column));
        let (place, width) = match (own, place) {
            (Some(own), _) => own,
            (None, Some(place)) => {
                let width = columns.get(place).and_then(|column| bits_of(column)).unwrap_or(clocks);
                *own.insert((place, width))
            }
            // A heading.
            (None, None) if number == 1 || columns.len() > 1 => continue,
            (None, None) => (0, clocks),
        };
        match parse_frame(columns.get(place).copied().unwrap_or_default(), width) {
            Ok(frame) => frames.push(frame),
            Err(error) => {
                let why = words::frame_text(&error);
                return Err(TEXTS.text("ssi_find.line").with("line", number).with_text("why", why));
            }
        }
    }
    match own.map(|(_, clocks)| clocks) {
        Some(clocks) if !frames.is_empty() && (1..=64).contains(&clocks) => Ok((clocks, frames)),
        _ => Err(TEXTS.text("ssi_find.no_frames")),
    }
}

/// Splits a line into columns: separated by commas, semicolons, tabs, or blanks; but bits may be written in groups of at
/// most a byte.
fn columns(line: &str) -> Vec<&str> {
    let first = line.split_whitespace().next().unwrap_or_default();
    let parted = line.contains([',', ';', '\t']);
    let groups = bits_of(line).is_some() && bits_of(first).is_some_and(|bits| bits <= 8);
    let columns: Vec<&str> = match () {
        () if parted => line.split([',', ';', '\t']).collect(),
        () if is_frame(first) && !groups => line.split_whitespace().collect(),
        () => vec![line],
    };
    columns.into_iter().map(|column| column.trim().trim_matches('"')).collect()
}

/// Returns whether a column looks like a frame: bits of more than a nibble, or hex digits after 0x.
fn is_frame(column: &str) -> bool {
    let hex = column.strip_prefix("0x").or(column.strip_prefix("0X"));
    hex.is_some() || bits_of(column).is_some_and(|bits| bits >= 4)
}

/// Returns the number of bits in a column; `None` if it does not hold bits.
fn bits_of(column: &str) -> Option<u8> {
    let bits = column.strip_prefix("0b").or(column.strip_prefix("0B")).unwrap_or(column);
    let mut bits = bits.chars().filter(|bit| *bit != '_' && !bit.is_whitespace()).peekable();
    bits.peek()?;
    bits.try_fold(0_u8, |count, bit| matches!(bit, '0' | '1').then(|| count.saturating_add(1)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_stand_in_a_file_one_a_line() {
        assert_eq!(parse_frames("1010\n\n# comment\n0b1111\n", 25), Ok((4, vec![0b1010, 0b1111])));
        assert_eq!(parse_frames("0B10_10\n1 1 1 1\n", 25), Ok((4, vec![0b1010, 0b1111])));
        assert_eq!(parse_frames("time;frame\n0.1;0x1F\n0.2;0x2\n", 25), Ok((25, vec![0x1F, 2])));
        assert_eq!(parse_frames("\u{feff}t,\"frame\"\n1,\"0x0B\"\n", 8), Ok((8, vec![0x0B])));
        // Further columns are ignored.
        assert_eq!(parse_frames("frame,position\n10101,5\n10111,1010\n", 8), Ok((5, vec![0b10101, 0b10111])));
        assert_eq!(parse_frames("10101 17\n11111 -\n", 8), Ok((5, vec![0b10101, 0b11111])));
        assert_eq!(parse_frames("1010101010 11\n", 8), Ok((10, vec![0b10_1010_1010])));
        assert_eq!(parse_frames("1010 1010 11\n", 8), Ok((10, vec![0b10_1010_1011])));
    }

    #[test]
    fn clocks_are_read_or_refused_in_words() {
        assert_eq!(read_clocks(" 25 "), Ok(25));
        assert_eq!(read_clocks("0x40"), Ok(64));
        for (text, id) in [("0", "ssi_find.clocks_range"), ("65", "ssi_find.clocks_range"), ("many", "ssi_form.whole")]
        {
            assert_eq!(read_clocks(text).unwrap_err().id(), id, "{text}");
        }
    }

    #[test]
    fn a_line_that_is_no_frame_is_named() {
        let said = |text: &str| parse_frames(text, 8).unwrap_err();
        let line = said("1010\n10\n");
        assert_eq!(line.id(), "ssi_find.line");
        assert!(line.terminal().contains('2'), "{}", line.terminal());
        assert_eq!(said("0x1\nx\n").id(), "ssi_find.line");
        assert_eq!(said("0x1FF\n").id(), "ssi_find.line");
        for text in ["", "# nothing\n", "heading\n"] {
            assert_eq!(said(text).id(), "ssi_find.no_frames");
        }
    }
}
