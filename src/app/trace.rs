//! Traffic on a line, decoded for the trace panel. Frames are decoded on arrival, not when drawn.

use std::collections::VecDeque;

use jiff::Zoned;

use super::{Language, Text};
use crate::link::{Direction, TraceEntry};
use crate::units::Moment;

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TraceLine {
    /// Time on the session's clock at which the first byte was sent or received.
    pub at: Moment,
    pub direction: Direction,
    /// Bytes of the frame, in which `**` represents a masked byte.
    pub bytes: String,
    pub meaning: Vec<Text>,
    /// Fault at the end of the frame, if any.
    pub fault: Option<TraceFault>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TraceFault {
    /// The frame reports an error or a warning of the device.
    Reported,
    /// The bytes are not a valid frame, or not a reply to the preceding request.
    Broken,
}

#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Explained {
    pub meaning: Vec<Text>,
    pub fault: Option<TraceFault>,
}

impl Explained {
    pub fn broken(why: Text) -> Self {
        Explained { meaning: vec![why], fault: Some(TraceFault::Broken) }
    }
}

impl From<Vec<Text>> for Explained {
    fn from(meaning: Vec<Text>) -> Self {
        Explained { meaning, fault: None }
    }
}

impl TraceLine {
    /// Returns the approximate memory use in bytes.
    fn size(&self) -> usize {
        size_of::<Self>() + self.bytes.len() + self.meaning.iter().map(Text::size).sum::<usize>()
    }

    pub fn words(&self, language: Language) -> String {
        self.meaning.iter().map(|text| text.words(language)).collect::<Vec<_>>().join(" · ")
    }
}

/// A log of the newest frames on a line.
#[derive(Debug, Default)]
pub struct TraceLog {
    lines: VecDeque<TraceLine>,
    size: usize,
    gone: u64,
    dropped: u64,
    began: Option<Zoned>,
}

impl TraceLog {
    /// Maximum memory of the log lines in bytes, enough for about 40,000 position readings.
    const MOST: usize = 16 << 20;

    /// Adds frames with their explanations. `dropped` frames arrived too fast to be shown.
    pub fn add(&mut self, entries: impl IntoIterator<Item = (TraceEntry, Explained)>, dropped: u64) {
        self.dropped += dropped;
        for (entry, Explained { meaning, fault }) in entries {
            let bytes = entry.bytes.to_string();
            let line = TraceLine { at: entry.at, direction: entry.direction, bytes, meaning, fault };
            self.size += line.size();
            self.lines.push_back(line);
        }
        while self.size > Self::MOST
            && let Some(oldest) = self.lines.pop_front()
        {
            self.size -= oldest.size();
            self.gone += 1;
        }
    }

    /// Returns the number of lines that were removed to make room for newer ones.
    pub fn gone(&self) -> u64 {
        self.gone
    }

    /// Returns the frames, oldest first.
    pub fn lines(&self) -> &VecDeque<TraceLine> {
        &self.lines
    }

    /// Returns the number of frames that arrived too fast to be shown.
    pub fn dropped_count(&self) -> u64 {
        self.dropped
    }

    pub fn line_time(&self, line: &TraceLine) -> Option<Zoned> {
        self.began.as_ref()?.checked_add(line.at.since_start()).ok()
    }

    pub(super) fn begin(&mut self, began: Zoned) {
        *self = TraceLog { began: Some(began), ..TraceLog::default() };
    }
}
