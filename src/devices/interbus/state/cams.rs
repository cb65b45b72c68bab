//! The cams of a program as a chart, with one lane per cam. The lanes extend across the measuring range or around a
//! ring. The chart also calculates the result of a drag, but does not apply it.
//!
//! A position is drawn one step wide. A cam from 10 to 19 extends from 10 to 20, so adjoining cams have no gap between
//! them.

mod grid;
pub mod labels;
mod moving;
mod snap;
pub mod table_text;
#[cfg(test)]
mod tests;

pub use grid::{Tick, grid_ticks, next_grid_line, round_up_1_2_5};
pub use moving::{DragTarget, apply_drag, cam_between, move_cam};
pub use snap::{SnapSettings, snap_distance};

use super::staged::{EditFinding, EditedValues, StagedEdits};
use crate::devices::interbus::profile::Edge;
use crate::devices::interbus::protocol::{Cam, CamNumber, Program, ProgramNumber, Value};

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Chart {
    pub program: ProgramNumber,
    pub range: u32,
    /// One lane per cam, by cam number.
    pub lanes: [Lane; Program::CAMS],
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Lane {
    pub cam: CamNumber,
    pub name: Option<String>,
    pub on: bool,
    /// Edges of the cam, or `None` if the profile does not contain the cam.
    pub edges: Option<Cam>,
    pub edited: bool,
    pub beyond: bool,
    /// Whether the cam is active and overlaps another cam with the same name.
    pub clashes: bool,
}

/// A contiguous range of positions, both ends included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PositionRange {
    pub first: u32,
    pub last: u32,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VisibleRange {
    first: f64,
    span: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OutputState {
    /// Output according to the edited program, or `None` if the program or the position is unknown.
    pub simulated: Option<bool>,
    /// Output according to the word from the encoder, or `None` if the word contains no outputs.
    pub own: Option<bool>,
}

/// Minimum number of visible steps.
const MIN_SPAN: f64 = 8.0;

impl Chart {
    /// Creates the chart of an edited program, or returns `None` if the program is unknown.
    pub fn from_edits(staged: &StagedEdits, program: ProgramNumber) -> Option<Self> {
        let wanted = staged.edited_values()?;
        wanted.image.program(program)?;
        Some(Chart::from_values(staged, wanted, program))
    }

    pub fn from_values(staged: &StagedEdits, wanted: &EditedValues, program: ProgramNumber) -> Self {
        let marks = wanted.findings();
        let about =
            |cam, is: fn(&EditFinding) -> bool| marks.iter().any(|mark| is(mark) && mark.refers_to(program, cam));
        let lane = |cam| Lane {
            cam,
            name: wanted.name(program, cam).map(str::to_owned),
            on: wanted.is_on(program, cam),
            edges: wanted.cam(program, cam),
            edited: staged.is_edited(program, cam),
            beyond: about(cam, |mark| matches!(mark, EditFinding::Beyond { .. })),
            clashes: about(cam, |mark| matches!(mark, EditFinding::Clash { .. })),
        };
        let lanes = CamNumber::ALL.map(lane);
        Chart { program, range: wanted.step_count(), lanes }
    }

    pub fn find_lane(&self, cam: CamNumber) -> Option<&Lane> {
        self.lanes.get(usize::from(cam.get()))
    }

    /// Returns the chart with one cam moved, for display during a drag.
    #[must_use]
    pub fn with_cam(&self, cam: CamNumber, to: Cam) -> Self {
        let mut chart = self.clone();
        if let Some(lane) = chart.lanes.get_mut(usize::from(cam.get())) {
            lane.edges = Some(to);
            lane.beyond = false;
        }
        chart
    }

    /// Returns an inactive cam whose lane can be used to draw a new one, or `None` if all cams are active.
    pub fn unused_cam(&self) -> Option<CamNumber> {
        self.lanes.iter().find(|lane| !lane.on).map(|lane| lane.cam)
    }

    pub const fn last_position(&self) -> u32 {
        self.range.saturating_sub(1)
    }

    /// Returns the outputs at a position, with bit i for cam i. Cams with unknown edges are off.
    pub fn outputs(&self, position: u32) -> u8 {
        let on = |lane: &&Lane| lane.on && lane.edges.is_some_and(|cam| cam.is_on(Value::from_word(position)));
        self.lanes.iter().filter(on).fold(0, |outputs, lane| outputs | 1 << lane.cam.get())
    }

    /// Returns the output indicators at a position. `own` contains the outputs that the encoder reports.
    pub fn output_states(&self, position: Option<u32>, own: Option<u8>) -> [OutputState; Program::CAMS] {
        let simulated = position.filter(|position| *position < self.range).map(|position| self.outputs(position));
        let bit = |outputs: Option<u8>, cam: CamNumber| outputs.map(|outputs| outputs >> cam.get() & 1 == 1);
        CamNumber::ALL.map(|cam| OutputState { simulated: bit(simulated, cam), own: bit(own, cam) })
    }

    /// Returns an edge of a cam, or `None` if the cam has no edges.
    pub fn edge_position(&self, cam: CamNumber, edge: Edge) -> Option<u32> {
        Some(edge_value(self.find_lane(cam)?.edges?, edge).get())
    }
}

impl Lane {
    /// Returns the sections of the measuring range in which the cam is on. There are two if the cam wraps around the
    /// end.
    pub fn on_ranges(&self, range: u32) -> Vec<PositionRange> {
        self.edges.map(|cam| on_ranges(cam, range)).unwrap_or_default()
    }
}

impl OutputState {
    /// Returns whether the encoder reports a different state than the program calls for.
    pub fn is_mismatch(self) -> bool {
        self.simulated.zip(self.own).is_some_and(|(simulated, own)| simulated != own)
    }

    /// Returns the state of the output. The state reported by the encoder takes precedence.
    pub const fn effective_state(self) -> Option<bool> {
        match self.own {
            Some(own) => Some(own),
            None => self.simulated,
        }
    }
}

impl VisibleRange {
    pub fn full(range: u32) -> Self {
        VisibleRange { first: 0.0, span: f64::from(range.max(1)) }
    }

    /// Returns the position at the left end of the view, which may lie within a step.
    pub const fn first(&self) -> f64 {
        self.first
    }

    pub const fn length(&self) -> f64 {
        self.span
    }

    pub fn is_whole(&self, range: u32) -> bool {
        self.span >= f64::from(range)
    }

    /// Returns where a position lies in the view, as a fraction from 0 at the left end to 1 at the right.
    pub fn fraction_at(&self, position: f64) -> f64 {
        (position - self.first) / self.span
    }

    pub fn position(&self, part: f64) -> f64 {
        self.first + part * self.span
    }

    /// Returns the view zoomed by a factor. The position `around` does not move on the screen.
    #[must_use]
    pub fn zoomed(&self, times: f64, around: f64, range: u32) -> Self {
        let most = f64::from(range.max(1));
        let span = if times.is_finite() && times > 0.0 { self.span / times } else { self.span };
        let span = span.clamp(MIN_SPAN.min(most), most);
        let part = self.fraction_at(around);
        VisibleRange { first: around - part * span, span }.clamped_to(range)
    }

    #[must_use]
    pub fn panned(&self, by: f64, range: u32) -> Self {
        VisibleRange { first: self.first + by, ..*self }.clamped_to(range)
    }

    /// Returns the view adjusted to fit into another range, which may be shorter.
    #[must_use]
    pub fn clamped_to(&self, range: u32) -> Self {
        let most = f64::from(range.max(1));
        let span = self.span.min(most);
        VisibleRange { first: self.first.clamp(0.0, most - span), span }
    }
}

/// Returns the sections of the measuring range in which a cam is on.
pub fn on_ranges(cam: Cam, range: u32) -> Vec<PositionRange> {
    let (start, stop) = (cam.start.get(), cam.stop.get());
    let Some(last) = range.checked_sub(1) else { return Vec::new() };
    let parts = if cam.wraps_around() { vec![(0, stop), (start, last)] } else { vec![(start, stop)] };
    let within = parts.into_iter().filter(|(first, _)| *first <= last);
    within.map(|(first, end)| PositionRange { first, last: end.min(last) }).collect()
}

pub const fn edge_value(cam: Cam, edge: Edge) -> Value {
    match edge {
        Edge::Start => cam.start,
        Edge::Stop => cam.stop,
    }
}
