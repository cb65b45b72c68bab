//! A trial frame for a layout, which can be entered as a position or as bits.

use crate::app::Text;
use crate::devices::ssi::protocol::{Cell, Flags, FrameFinding, FrameReading, Layout, Location, parse_frame};
use crate::devices::ssi::state::TEXTS;
use crate::devices::ssi::state::explain;

#[derive(Clone, Debug, Default, PartialEq)]
pub struct TrialFrame {
    frame: u64,
    problem: Option<Text>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Decoded {
    /// Right-justified frame.
    pub frame: u64,
    pub reading: FrameReading,
    /// Position and its location on the shaft or scale, or `None` if the bits do not represent a position.
    pub place: Option<(u64, Location)>,
    pub findings: Vec<FrameFinding>,
    /// Whether the position is valid.
    pub is_valid: bool,
}

impl Decoded {
    pub fn decode(layout: &Layout, frame: u64) -> Self {
        let reading = layout.decode(frame);
        let is_none = reading.flags.contains(Flags::CODE);
        let place = (!is_none).then(|| (reading.position, layout.descriptor().range.locate(reading.position)));
        Decoded { frame, reading, place, findings: layout.to_findings(reading), is_valid: layout.is_valid(reading) }
    }

    pub fn to_cells(&self, layout: &Layout) -> Vec<Cell> {
        layout.to_cells(self.frame)
    }
}

impl TrialFrame {
    pub fn frame(&self) -> u64 {
        self.frame
    }

    pub fn problem(&self) -> Option<&Text> {
        self.problem.as_ref()
    }

    pub fn decode(&self, layout: &Layout) -> Decoded {
        Decoded::decode(layout, self.frame)
    }

    /// Sets the position in the frame, and keeps the error bits.
    pub(super) fn set_position(&mut self, layout: &Layout, position: u64) {
        let errors = error_bits(layout, layout.decode(self.frame).flags);
        match layout.encode(position, errors) {
            Some(frame) => self.set_frame(frame),
            None => {
                let most = layout.position_code().last_position();
                self.problem = Some(TEXTS.text("ssi_trial.range").with("position", position).with("most", most));
            }
        }
    }

    /// Sets the position in the frame to a turn and a step within the turn.
    pub(super) fn set_turn_and_step(&mut self, layout: &Layout, turns: u64, steps: u64) {
        match layout.descriptor().range.position(turns, steps) {
            Some(position) => self.set_position(layout, position),
            None => self.problem = Some(TEXTS.text("ssi_trial.place").with("turns", turns).with("steps", steps)),
        }
    }

    pub(super) fn set_text(&mut self, layout: &Layout, text: &str) {
        match parse_frame(text, layout.clock_count()) {
            Ok(frame) => self.set_frame(frame),
            Err(error) => self.problem = Some(explain::frame_text(&error)),
        }
    }

    /// Inverts the bit at a clock, counted from 1.
    pub(super) fn toggle(&mut self, layout: &Layout, clock: u8) {
        if (1..=layout.clock_count()).contains(&clock) {
            self.set_frame(self.frame ^ 1 << (layout.clock_count() - clock));
        }
    }

    pub(super) fn set_frame(&mut self, frame: u64) {
        *self = TrialFrame { frame, problem: None };
    }

    /// Switches to another layout. The position is kept if it exists in the new layout.
    pub(super) fn switch_layout(&mut self, before: &Layout, now: &Layout) {
        let reading = before.decode(self.frame);
        let position = reading.position.min(now.position_code().last_position());
        let frame = now.encode(position, Flags::NONE).unwrap_or(0);
        self.set_frame(frame);
    }
}

/// Returns the error bits among the flags. Other flags cannot be encoded.
fn error_bits(layout: &Layout, flags: Flags) -> Flags {
    let all = (0..layout.descriptor().errors.len()).map(Flags::error);
    all.filter(|error| flags.contains(*error)).fold(Flags::NONE, Flags::union)
}
