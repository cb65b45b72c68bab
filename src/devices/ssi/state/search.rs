//! Search for the layout of recorded frames, from the encoder or a file.

mod capture;
#[cfg(test)]
mod tests;

use std::path::Path;

use super::form::parse_whole;
use crate::app::{Text, explain};
use crate::devices::ssi::protocol::{ExtractedFrames, FrameTextError, Search, extract_frames, parse_frame};
use crate::devices::ssi::state::TEXTS;
use crate::devices::ssi::state::explain as words;
use crate::store::{FileError, FileErrorKind, read_file};

/// Maximum number of frames searched. Only the newest frames are used.
pub(super) const MAX_SEARCHED_FRAMES: usize = 8_000;

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Origin {
    Live,
    File(String),
}

/// A series of consecutive frames with its origin.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Frames {
    pub origin: Origin,
    /// Number of bits per frame, 1 to 64.
    pub clocks: u8,
    /// Right-justified frames.
    pub frames: Vec<u64>,
    /// Number of incomplete bursts in a logic analyser recording.
    pub left_out: usize,
    /// Whether the frames are given as numbers, which do not show leading zeros.
    pub are_numbers: bool,
}

#[derive(Clone, Debug, Default, PartialEq)]
pub enum SearchState {
    #[default]
    Nothing,
    Running(u32),
    Found {
        origin: Origin,
        /// Number of bits per frame.
        clocks: u8,
        /// Number of incomplete bursts in a logic analyser recording.
        left_out: usize,
        frames: Vec<u64>,
        search: Box<Search>,
    },
    /// The search failed because there were no frames. Contains the reason and a remedy.
    Failed(Text),
}

/// Parses a number of clocks.
///
/// # Errors
/// Returns an error with a message if the text is not a whole number, or if no frame has this number of clocks.
pub fn read_clocks(text: &str) -> Result<u8, Text> {
    let number = parse_whole(text)?;
    let clocks = u8::try_from(number).ok().filter(|clocks| (1..=64).contains(clocks));
    clocks.ok_or_else(|| TEXTS.text("ssi_find.clocks_range").with("clocks", number))
}

/// Reads frames from a text file, from a table of `position ssi --csv`, or from a logic analyser export.
///
/// A text file has one frame per line, as bits in clock order or as 0x and hexadecimal digits. The first column that
/// looks like a frame is used. Hexadecimal frames have `clocks` bits. Empty lines, a heading and lines that begin with
/// # are skipped.
///
/// # Errors
/// Returns an error with a message if the file cannot be read or a line is not a frame. The message contains the line
/// number.
pub fn read_frames(path: &Path, clocks: u8) -> Result<Frames, Text> {
    let text = read_file(path).map_err(|error| file_error_text(&error))?;
    let name = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    parse_frame_file(&text, name, clocks)
}

/// Parses the text of a file like [`read_frames`]. `name` is stored as the origin of the frames.
///
/// # Errors
/// Returns an error with the line number if a line is not a frame.
pub fn parse_frame_file(text: &str, name: String, clocks: u8) -> Result<Frames, Text> {
    let read = match capture::parse_levels(text) {
        Some(levels) => frames_from_bursts(extract_frames(&levels?).map_err(words::burst_error_text)?),
        None => parse_table(text, clocks).unwrap_or_else(|| parse_frames(text, clocks))?,
    };
    Ok(Frames { origin: Origin::File(name), ..read })
}

fn file_error_text(error: &FileError) -> Text {
    match &error.problem {
        FileErrorKind::TooLarge { limit } => {
            let path = error.path.display();
            TEXTS.text("ssi_capture.too_large").with("path", path).with("megabytes", limit >> 20)
        }
        _ => explain::file_error_text(error),
    }
}

fn frames_from_bursts(bursts: ExtractedFrames) -> Frames {
    let ExtractedFrames { clocks, frames, left_out } = bursts;
    Frames { origin: Origin::Live, clocks, frames, left_out, are_numbers: false }
}

fn numbered_text(line: usize, why: Text) -> Text {
    TEXTS.text("ssi_find.line").with("line", line).with_text("why", why)
}

/// Parses a table of `position ssi --csv`, in which frames are decimal numbers. Returns `None` if the text is not such
/// a table.
fn parse_table(text: &str, clocks: u8) -> Option<Result<Frames, Text>> {
    const HEADING: &str = "t_s,raw,";
    let rows = (1..).zip(text.lines()).map(|(number, line)| (number, line.trim().trim_start_matches('\u{feff}')));
    let mut rows = rows.filter(|(_, line)| !line.is_empty());
    let (_, heading) = rows.next().filter(|(_, heading)| heading.starts_with(HEADING))?;
    let expected = heading.split(',').count();
    let frame = |(number, line): (usize, &str)| {
        let cells: Vec<&str> = line.split(',').map(str::trim).collect();
        if cells.len() != expected {
            let id = if cells.len() < expected { "ssi_capture.cut_off" } else { "ssi_capture.columns" };
            let text = TEXTS.text(id).with("line", number);
            return Err(text.with("columns", cells.len()).with("expected", expected));
        }
        let raw = cells.get(1).copied().unwrap_or_default();
        let frame: u64 =
            raw.parse().map_err(|_| numbered_text(number, TEXTS.text("ssi_capture.raw").with("text", raw)))?;
        let bits = u64::BITS - frame.leading_zeros();
        if bits > u32::from(clocks) {
            let error = FrameTextError::Bits { text: raw.to_owned(), bits, clocks, is_number: true };
            return Err(numbered_text(number, words::frame_text(&error)));
        }
        Ok(frame)
    };
    let frames: Result<Vec<u64>, Text> = rows.map(frame).collect();
    Some(frames.and_then(|frames| {
        if frames.is_empty() {
            return Err(TEXTS.text("ssi_find.no_frames"));
        }
        Ok(Frames { origin: Origin::Live, clocks, frames, left_out: 0, are_numbers: true })
    }))
}

fn parse_frames(text: &str, clocks: u8) -> Result<Frames, Text> {
    // Column of the frames and their number of bits, once a line has shown them.
    let mut own: Option<(usize, u8)> = None;
    let mut are_numbers = false;
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
                let bits = columns.get(place).and_then(|column| count_bits(column));
                are_numbers = bits.is_none();
                *own.insert((place, bits.unwrap_or(clocks)))
            }
            // This line is a heading.
            (None, None) if number == 1 || columns.len() > 1 => continue,
            (None, None) => (0, clocks),
        };
        match parse_frame(columns.get(place).copied().unwrap_or_default(), width) {
            Ok(frame) => frames.push(frame),
            Err(error) => return Err(numbered_text(number, words::frame_text(&error))),
        }
    }
    match own.map(|(_, clocks)| clocks) {
        Some(clocks) if !frames.is_empty() && (1..=64).contains(&clocks) => {
            Ok(Frames { origin: Origin::Live, clocks, frames, left_out: 0, are_numbers })
        }
        _ => Err(TEXTS.text("ssi_find.no_frames")),
    }
}

/// Splits a line into columns at commas, semicolons, tabs or blanks. Blanks between groups of up to eight bits do not
/// separate columns.
fn columns(line: &str) -> Vec<&str> {
    let first = line.split_whitespace().next().unwrap_or_default();
    let parted = line.contains([',', ';', '\t']);
    let groups = count_bits(line).is_some() && count_bits(first).is_some_and(|bits| bits <= 8);
    let columns: Vec<&str> = match () {
        () if parted => line.split([',', ';', '\t']).collect(),
        () if is_frame(first) && !groups => line.split_whitespace().collect(),
        () => vec![line],
    };
    columns.into_iter().map(|column| column.trim().trim_matches('"')).collect()
}

/// Returns whether a column looks like a frame. It must have more than four bits, or 0x and hexadecimal digits.
fn is_frame(column: &str) -> bool {
    let hex = column.strip_prefix("0x").or(column.strip_prefix("0X"));
    hex.is_some() || count_bits(column).is_some_and(|bits| bits >= 4)
}

fn count_bits(column: &str) -> Option<u8> {
    let bits = column.strip_prefix("0b").or(column.strip_prefix("0B")).unwrap_or(column);
    let mut bits = bits.chars().filter(|bit| *bit != '_' && !bit.is_whitespace()).peekable();
    bits.peek()?;
    bits.try_fold(0_u8, |count, bit| matches!(bit, '0' | '1').then(|| count.saturating_add(1)))
}
