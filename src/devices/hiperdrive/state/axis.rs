//! Axis set-up. This procedure starts with an unknown drive and ends with limits in millimetres that have survived a
//! power cycle. It is a state machine that receives the drive data ([`DriveFacts`]) and issues requests to the drive
//! ([`DriveRequest`]). It performs no I/O, and every step waits until the drive has confirmed it.
//!
//! The results of the steps form a chain. Each result depends on data of the drive: scale, pitch, reference and limits.
//! When this data changes, the result becomes void together with all later results, even if another program made the
//! change. The displayed step changes only when the user presses a button.
//!
//! Parameters are first written without saving and read back. Saving is a separate step, the last but one. If the
//! set-up is aborted before that, the previous values are written back, because the manual does not guarantee that
//! unsaved values are lost at power-off.

mod act;
mod differences;
mod drive_facts;
mod entries;
mod follow;
mod gate;
pub mod labels;
mod report;
mod standstill;
mod step_outcomes;
mod supply;
mod test_targets;

#[cfg(test)]
mod tests;

pub use act::{AxisAction, AxisButton, DriveRequest};
pub use drive_facts::DriveFacts;
pub use entries::{LengthEntries, LimitsPreview, ReferencePosition};
pub use report::{AxisReport, Device, write_outcome_lines};
pub use supply::{Power, RestartEvidence};
pub use test_targets::{JogTravel, Outcome, TestTarget};

use standstill::StandstillMonitor;
use step_outcomes::{PositionOrigin, Preconditions, StepOutcomes};

use super::ruler::Ruler;
use crate::devices::hiperdrive::protocol::{DriveNumber, PositionScale};

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum AxisStep {
    /// The drive is requested with parameter 152.
    Request,
    /// Pitch and resolution are written as parameters 154 and 156.
    Scale,
    /// The user checks the limits for the set-up in millimetres.
    Confirm,
    /// The axis is moved slowly to find out which direction is positive.
    Jog,
    /// The current position is assigned a number (parameter 198).
    Reference,
    Lower,
    /// The upper limit is taught, and both limits are written (parameters 158 and 160).
    Upper,
    /// The axis is moved to the middle of the range and to both limits.
    Test,
    /// All parameters are saved (47 = 1).
    Save,
    PowerCycle,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StepStatus {
    Done,
    Now,
    Skipped,
    Failed,
    /// The step has not been reached yet.
    Ahead,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SetupEnd {
    Done,
    Cancelled,
}

/// A change made by the set-up.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum AxisChange {
    /// Change of a parameter, identified by its number for drive 1.
    Parameter(u16, i64),
    Position(i32),
}

#[derive(Clone, Debug)]
pub struct RunSummary {
    pub end: SetupEnd,
    /// Date and time as written in the report.
    pub when: String,
    seen: Box<DriveFacts>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct ConfirmedLimits {
    scale: Option<PositionScale>,
    seen: (i32, i32),
    /// Limits that the user has seen, or the taught limits that a reviewed plan has written since then.
    agreed: (i32, i32),
    /// Taught limits of an interrupted plan. Each limit may have been written.
    begun: Option<(i32, i32)>,
}

#[derive(Clone, Debug)]
pub struct Axis {
    drive: DriveNumber,
    step: AxisStep,
    entries: LengthEntries,
    chain: StepOutcomes,
    confirmed: Option<ConfirmedLimits>,
    travel: JogTravel,
    /// Position that was last set, and the origin from which positions have been counted since.
    reference: Option<(i32, PositionOrigin)>,
    sets: Option<i32>,
    standstill: StandstillMonitor,
    /// Number of position jumps that were detected at standstill.
    jumps: u32,
    /// Number of steps by which the position has changed since the reference was set, while the position was not being
    /// read.
    unexplained: Option<i64>,
    outcomes: [Option<Outcome>; 3],
    /// Test move in progress: the target, the position of the target, and the number of the action that started the
    /// move.
    going: Option<(TestTarget, i32, u64)>,
    saved: bool,
    power: Option<Power>,
    changes: Vec<AxisChange>,
    /// Whether a write ended early, so that some of the changes may not have been made.
    partly: bool,
    returned: Vec<(u16, i64)>,
    asked: Option<DriveRequest>,
    over: Option<RunSummary>,
}

impl AxisStep {
    pub const ALL: [AxisStep; 10] = [
        AxisStep::Request,
        AxisStep::Scale,
        AxisStep::Confirm,
        AxisStep::Jog,
        AxisStep::Reference,
        AxisStep::Lower,
        AxisStep::Upper,
        AxisStep::Test,
        AxisStep::Save,
        AxisStep::PowerCycle,
    ];

    pub const fn needs_cyclic(self) -> bool {
        matches!(self, AxisStep::Jog | AxisStep::Reference | AxisStep::Lower | AxisStep::Upper | AxisStep::Test)
    }

    /// Returns whether the user jogs the drive in this step.
    pub const fn is_jogging(self) -> bool {
        matches!(self, AxisStep::Jog | AxisStep::Reference | AxisStep::Lower | AxisStep::Upper)
    }

    pub const fn is_optional(self) -> bool {
        matches!(self, AxisStep::Reference | AxisStep::PowerCycle)
    }

    pub const fn index(self) -> usize {
        // The variants are in the order of `ALL`.
        self as usize
    }

    fn step_by(self, by: isize) -> Option<AxisStep> {
        AxisStep::ALL.get(self.index().checked_add_signed(by)?).copied()
    }
}

impl Axis {
    /// Creates a set-up that starts at the first step. `ruler` contains the spindle data if it is already known.
    pub fn new(drive: DriveNumber, ruler: Option<Ruler>) -> Self {
        Axis {
            drive,
            step: AxisStep::Request,
            entries: LengthEntries::new(ruler),
            chain: StepOutcomes::default(),
            confirmed: None,
            travel: JogTravel::default(),
            reference: None,
            sets: None,
            standstill: StandstillMonitor::default(),
            jumps: 0,
            unexplained: None,
            outcomes: [None; 3],
            going: None,
            saved: false,
            power: None,
            changes: Vec::new(),
            partly: false,
            returned: Vec::new(),
            asked: None,
            over: None,
        }
    }

    pub const fn drive(&self) -> DriveNumber {
        self.drive
    }

    pub const fn step(&self) -> AxisStep {
        self.step
    }

    pub const fn entries(&self) -> &LengthEntries {
        &self.entries
    }

    /// Returns the result of the set-up, or `None` while the set-up is running.
    pub fn setup_end(&self) -> Option<SetupEnd> {
        self.over.as_ref().map(|over| over.end)
    }

    pub const fn run_summary(&self) -> Option<&RunSummary> {
        self.over.as_ref()
    }

    /// Returns the drive data at the end of the set-up, or the current drive data while the set-up is running.
    pub fn displayed_facts<'a>(&'a self, now: &'a DriveFacts) -> &'a DriveFacts {
        self.over.as_ref().map_or(now, |over| &over.seen)
    }

    pub fn changes(&self) -> &[AxisChange] {
        &self.changes
    }

    /// Returns whether a write ended early, so that some of the changes may not have been made.
    pub const fn is_partly_written(&self) -> bool {
        self.partly
    }

    pub const fn is_saved(&self) -> bool {
        self.saved
    }

    pub const fn is_writing(&self) -> bool {
        self.asked.is_some()
    }

    /// Returns how far the user has jogged the axis.
    pub const fn travel(&self) -> JogTravel {
        self.travel
    }

    pub fn reference_position(&self) -> Option<i32> {
        self.reference.map(|(position, _)| position)
    }

    pub fn outcome_of(&self, place: TestTarget) -> Option<Outcome> {
        self.outcomes.get(place as usize).copied().flatten()
    }

    pub fn running_test_target(&self) -> Option<TestTarget> {
        self.going.map(|(place, ..)| place)
    }

    pub const fn power(&self) -> Option<Power> {
        self.power
    }

    /// Returns the earliest step before the current one whose result is no longer valid, if any. This step and all
    /// later steps must be repeated.
    pub fn invalidated_step(&self) -> Option<AxisStep> {
        self.chain.first_open_step().filter(|step| *step < self.step)
    }

    pub fn step_status(&self, step: AxisStep) -> StepStatus {
        let is_shown = step == self.step && self.over.is_none();
        match step {
            AxisStep::PowerCycle if matches!(self.power, Some(Power::Back { .. })) && !self.has_survived() => {
                StepStatus::Failed
            }
            _ if self.invalidated_step() == Some(step) => StepStatus::Failed,
            _ if is_shown => StepStatus::Now,
            _ if self.chain.is_skipped(step) => StepStatus::Skipped,
            _ if self.chain.is_complete(step) => StepStatus::Done,
            _ => StepStatus::Ahead,
        }
    }

    /// Returns whether the supply was switched off, the saved values are still present, and the axis has not moved.
    pub fn has_survived(&self) -> bool {
        self.power.is_some_and(Power::has_survived_power_cycle)
    }

    fn position_origin(&self, seen: &DriveFacts) -> PositionOrigin {
        PositionOrigin::from_facts(seen, self.jumps)
    }

    /// Returns the current drive data on which the results of the steps depend.
    fn preconditions(&self, seen: &DriveFacts) -> Preconditions {
        Preconditions {
            requested: seen.requested,
            scale: seen.scale,
            pitch: seen.pitch,
            confirmed: self.is_confirmed(seen),
            origin: self.position_origin(seen),
            limits: seen.limits,
            lower: self.entries.lower_limit(seen.ruler()).ok(),
        }
    }
}
