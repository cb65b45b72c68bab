//! Traffic on a line, decoded for the trace panel. Each frame is decoded once, when it arrives.

use std::collections::VecDeque;

use jiff::Zoned;

use super::{Language, Text};
use crate::link::{Direction, TRACE_HEADER as HEADER, TraceEntry, entry_line};
use crate::units::Moment;

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TraceLine {
    /// Time of the first byte on the session's clock.
    pub at: Moment,
    pub direction: Direction,
    /// Bytes of the frame. A masked byte is shown as `**`.
    pub bytes: String,
    /// Number of bytes at the start that belong to the transport.
    pub header: usize,
    pub meaning: Vec<Text>,
    /// Fault at the end of the frame, if any.
    pub fault: Option<TraceFault>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TraceFault {
    /// The frame contains an error or a warning from the device.
    Reported,
    /// The bytes are not a valid frame, or do not reply to the request before them.
    Broken,
}

#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FrameExplanation {
    /// Number of bytes at the start that belong to the transport.
    pub header: usize,
    pub meaning: Vec<Text>,
    pub fault: Option<TraceFault>,
}

impl FrameExplanation {
    pub fn from_error(why: Text) -> Self {
        FrameExplanation { meaning: vec![why], fault: Some(TraceFault::Broken), ..FrameExplanation::default() }
    }
}

impl From<Vec<Text>> for FrameExplanation {
    fn from(meaning: Vec<Text>) -> Self {
        FrameExplanation { meaning, ..FrameExplanation::default() }
    }
}

impl TraceLine {
    /// Returns the approximate memory use in bytes.
    fn size(&self) -> usize {
        size_of::<Self>() + self.bytes.len() + self.meaning.iter().map(Text::size).sum::<usize>()
    }

    /// Returns the bytes of the message without the transport header.
    pub fn message(&self) -> &str {
        // Each byte takes two digits and a space.
        self.bytes.get(3 * self.header..).unwrap_or(&self.bytes)
    }

    pub fn to_string_in(&self, language: Language) -> String {
        self.meaning.iter().map(|text| text.to_string_in(language)).collect::<Vec<_>>().join(" · ")
    }
}

/// Criteria for the frames to show.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct TraceFilter {
    /// Text to search for in the bytes or in the meaning of a frame, ignoring case.
    pub search: String,
    /// Whether to show only broken frames and those with an error or a warning.
    pub faults_only: bool,
}

impl TraceFilter {
    /// Returns whether the filter selects all frames.
    pub fn is_empty(&self) -> bool {
        self.search.trim().is_empty() && !self.faults_only
    }

    fn matches(&self, line: &TraceLine, language: Language) -> bool {
        let search = self.search.trim().to_lowercase();
        (!self.faults_only || line.fault.is_some())
            && (search.is_empty()
                || line.bytes.to_lowercase().contains(&search)
                || line.to_string_in(language).to_lowercase().contains(&search))
    }
}

/// The frames of a log that match a filter. Each frame is compared only once, not each time it is drawn.
#[derive(Debug, Default)]
pub struct TraceMatches {
    filter: TraceFilter,
    language: Option<Language>,
    /// Numbers of the matching frames, in ascending order.
    numbers: VecDeque<u64>,
    /// Number of matching frames that the log has removed since the filter was set.
    removed: u64,
    /// Number of the first frame not yet compared.
    next: u64,
}

impl TraceMatches {
    /// Compares the frames before `end` with the filter. A new filter or language discards the previous matches.
    pub fn update_matches(&mut self, log: &TraceLog, filter: &TraceFilter, language: Language, end: u64) {
        if self.filter != *filter || self.language != Some(language) || self.next > end {
            *self = TraceMatches { filter: filter.clone(), language: Some(language), ..TraceMatches::default() };
        }
        while self.numbers.front().is_some_and(|number| *number < log.removed_count()) {
            self.numbers.pop_front();
            self.removed += 1;
        }
        for number in self.next.max(log.removed_count())..end {
            if log.line_by_number(number).is_some_and(|line| self.filter.matches(line, language)) {
                self.numbers.push_back(number);
            }
        }
        self.next = end;
    }

    /// Returns the numbers of the matching frames, in ascending order.
    pub fn frame_numbers(&self) -> &VecDeque<u64> {
        &self.numbers
    }

    /// Returns the number of matching frames that the log has removed since the filter was set.
    pub fn removed_count(&self) -> u64 {
        self.removed
    }
}

/// A log of the newest trace frames.
#[derive(Debug, Default)]
pub struct TraceLog {
    lines: VecDeque<TraceLine>,
    size: usize,
    gone: u64,
    dropped: u64,
    began: Option<Zoned>,
}

impl TraceLog {
    /// Maximum memory of the log in bytes, enough for about 40,000 position readings.
    const MAX_BYTES: usize = 16 << 20;

    /// Adds frames with their explanations. `dropped` is the number of frames that arrived too fast to be logged.
    pub fn add_frames(&mut self, entries: impl IntoIterator<Item = (TraceEntry, FrameExplanation)>, dropped: u64) {
        self.dropped += dropped;
        for (entry, FrameExplanation { header, meaning, fault }) in entries {
            let bytes = entry.bytes.to_string();
            let line = TraceLine { at: entry.at, direction: entry.direction, bytes, header, meaning, fault };
            self.size += line.size();
            self.lines.push_back(line);
        }
        self.trim(Self::MAX_BYTES);
    }

    /// Removes the oldest frames until the log takes at most `size` bytes.
    fn trim(&mut self, size: usize) {
        while self.size > size
            && let Some(oldest) = self.lines.pop_front()
        {
            self.size -= oldest.size();
            self.gone += 1;
        }
    }

    /// Returns the number of frames that were removed to make room for newer ones.
    pub fn removed_count(&self) -> u64 {
        self.gone
    }

    /// Returns the frames, oldest first.
    pub fn lines(&self) -> &VecDeque<TraceLine> {
        &self.lines
    }

    /// Returns the number of the next frame. Frames are numbered from 0 since the connection was opened.
    pub fn next_number(&self) -> u64 {
        self.gone + self.lines.len() as u64
    }

    /// Returns the frame with this number, or `None` if it has been removed or has not arrived yet.
    pub fn line_by_number(&self, number: u64) -> Option<&TraceLine> {
        self.lines.get(usize::try_from(number.checked_sub(self.gone)?).ok()?)
    }

    /// Returns the content of a trace file with all logged frames.
    pub fn file_content(&self) -> String {
        let mut text = format!("{HEADER}\n");
        if self.gone > 0 {
            text.push_str(&format!("# {} earlier frames are not included.\n", self.gone));
        }
        if self.dropped > 0 {
            text.push_str(&format!("# {} frames arrived too fast to be recorded.\n", self.dropped));
        }
        for line in &self.lines {
            text.push_str(&entry_line(line.at, line.direction, &line.bytes));
            text.push('\n');
        }
        text
    }

    /// Returns the number of frames that arrived too fast to be stored.
    pub fn dropped_count(&self) -> u64 {
        self.dropped
    }

    pub fn line_time(&self, line: &TraceLine) -> Option<Zoned> {
        self.began.as_ref()?.checked_add(line.at.since_start()).ok()
    }

    pub(super) fn begin_connection(&mut self, began: Zoned) {
        *self = TraceLog { began: Some(began), ..TraceLog::default() };
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;
    use crate::bits::MaskedBytes;
    use crate::link::read_trace;

    fn log(frames: &[(u64, Direction, &str, Text, Option<TraceFault>)]) -> TraceLog {
        let mut log = TraceLog::default();
        log.add_frames(
            frames.iter().cloned().map(|(millis, direction, bytes, meaning, fault)| {
                let at = Moment::from_elapsed(Duration::from_millis(millis));
                let bytes: MaskedBytes = bytes.parse().unwrap();
                (TraceEntry { at, direction, bytes }, FrameExplanation { header: 0, meaning: vec![meaning], fault })
            }),
            0,
        );
        log
    }

    fn three_frame_log() -> TraceLog {
        log(&[
            (31, Direction::Sent, "40 42 02", Text::new("trace.position"), None),
            (47, Direction::Received, "40 42 00 0e", Text::new("trace.taken"), None),
            (90, Direction::Received, "FF **", Text::new("trace.hidden"), Some(TraceFault::Broken)),
        ])
    }

    fn matching(log: &TraceLog, search: &str, faults_only: bool, end: u64) -> Vec<u64> {
        let mut matches = TraceMatches::default();
        let filter = TraceFilter { search: search.to_owned(), faults_only };
        matches.update_matches(log, &filter, Language::English, end);
        matches.frame_numbers().iter().copied().collect()
    }

    #[test]
    fn finds_frames_by_bytes_meaning_and_fault() {
        let log = three_frame_log();
        assert_eq!(matching(&log, "", false, 3), [0, 1, 2]);
        assert_eq!(matching(&log, " 42 00 0E ", false, 3), [1], "upper and lower case are equal");
        assert_eq!(matching(&log, "READ POS", false, 3), [0]);
        assert_eq!(matching(&log, "", true, 3), [2]);
        assert_eq!(matching(&log, "accepted", true, 3), [] as [u64; 0]);
        assert_eq!(matching(&log, "", true, 2), [] as [u64; 0], "paused before the fault");
    }

    #[test]
    fn changed_filter_rechecks_all_frames() {
        let log = three_frame_log();
        let mut matches = TraceMatches::default();
        let mut update = |search: &str, end| {
            let filter = TraceFilter { search: search.to_owned(), faults_only: false };
            matches.update_matches(&log, &filter, Language::English, end);
            matches.frame_numbers().iter().copied().collect::<Vec<_>>()
        };
        assert_eq!(update("40", 1), [0]);
        assert_eq!(update("40", 3), [0, 1]);
        assert_eq!(update("ff", 3), [2]);
        assert_eq!(update("ff", 1), [] as [u64; 0], "a pause shows fewer frames");
    }

    #[test]
    fn removed_frames_no_longer_match() {
        let frame = |at| (at, Direction::Sent, "40 42 02", Text::new("trace.position"), None);
        let one = log(&[frame(0)]).size;
        let mut log = log(&[frame(0), frame(1), frame(2)]);
        let mut matches = TraceMatches::default();
        let filter = TraceFilter { search: "42".to_owned(), faults_only: false };
        matches.update_matches(&log, &filter, Language::English, log.next_number());
        log.trim(2 * one);
        matches.update_matches(&log, &filter, Language::English, log.next_number());
        assert_eq!((matches.removed_count(), matches.frame_numbers().front()), (1, Some(&1)));
        assert_eq!((log.removed_count(), log.next_number()), (1, 3));
        assert!(log.line_by_number(0).is_none() && log.line_by_number(2).is_some() && log.line_by_number(3).is_none());
    }

    /// A trace saved in the window equals one written on the command line, and can be opened with `replay:`.
    #[test]
    fn saved_log_reads_as_trace() {
        let text = three_frame_log().file_content();
        let expected = "# encoder-studio trace 1\n0.031000 > 40 42 02\n0.047000 < 40 42 00 0E\n0.090000 < FF **\n";
        assert_eq!(text, expected);
        assert_eq!(read_trace(&text).unwrap().len(), 3);
    }
}
