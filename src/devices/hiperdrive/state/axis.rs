//! Axis set-up: a procedure that begins with an unknown drive and ends with limits in millimetres that have survived a
//! power cycle. This module is a state machine that receives data about the drive ([`DriveFacts`]) and issues requests
//! to it ([`DriveRequest`]). It performs no I/O, and every step waits for confirmation from the drive.
//!
//! Each result of a step depends on data of the drive: scale, pitch, reference and limits. If this data changes, even
//! by another program, the result and all later results become void. The displayed step changes only when the user
//! presses a button.
//!
//! Parameters are first written without saving them, and read back. Saving is a separate step, the last but one. If the
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
    /// Parameter 152 (Requested) of the drive is set.
    Request,
    /// Pitch and resolution are written as parameters 154 and 156.
    Scale,
    /// The user checks the limits that apply during the set-up, in millimetres.
    Confirm,
    /// The axis is moved slowly to find out which way its position increases.
    Jog,
    /// A number is assigned to the current position (parameter 198).
    Reference,
    Lower,
    /// The upper limit is set by teach-in, and both limits are written (parameters 158 and 160).
    Upper,
    /// The axis is moved to the middle of its range and to both limits.
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
    /// A new value of a parameter, given by its number for drive 1.
    Parameter(u16, i64),
    Position(i32),
}

#[derive(Clone, Debug)]
pub struct RunSummary {
    pub end: SetupEnd,
    /// Date and time as shown in the report.
    pub when: String,
    seen: Box<DriveFacts>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct ConfirmedLimits {
    scale: Option<PositionScale>,
    seen: (i32, i32),
    /// Limits that the user has confirmed: those seen, or the taught limits written since then by an approved plan.
    agreed: (i32, i32),
    /// Taught limits in an interrupted plan. Each of them may or may not have been written.
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
    /// Last position that was set, and the zero point to which positions have referred since then.
    reference: Option<(i32, PositionOrigin)>,
    sets: Option<i32>,
    standstill: StandstillMonitor,
    /// Number of position jumps detected at standstill.
    jumps: u32,
    /// Steps by which the position has changed unobserved since the reference was set.
    unexplained: Option<i64>,
    outcomes: [Option<Outcome>; 3],
    /// Test move in progress: the target, its position, and the number of the action that moves the drive.
    going: Option<(TestTarget, i32, u64)>,
    saved: bool,
    power: Option<Power>,
    changes: Vec<AxisChange>,
    /// Whether a write was interrupted, so that some of the changes may be missing.
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

    pub const fn needs_cyclic_connection(self) -> bool {
        matches!(self, AxisStep::Jog | AxisStep::Reference | AxisStep::Lower | AxisStep::Upper | AxisStep::Test)
    }

    /// Returns whether the user jogs the axis in this step.
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
    /// Creates a set-up at its first step. `ruler` contains the spindle data, if already known.
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

    /// Returns how the set-up ended, or `None` while it is running.
    pub fn setup_end(&self) -> Option<SetupEnd> {
        self.over.as_ref().map(|over| over.end)
    }

    pub const fn run_summary(&self) -> Option<&RunSummary> {
        self.over.as_ref()
    }

    /// Returns the drive data from the end of the set-up, or the current data while it is running.
    pub fn displayed_facts<'a>(&'a self, now: &'a DriveFacts) -> &'a DriveFacts {
        self.over.as_ref().map_or(now, |over| &over.seen)
    }

    pub fn changes(&self) -> &[AxisChange] {
        &self.changes
    }

    /// Returns whether a write was interrupted, so that some of the changes may be missing.
    pub const fn is_partly_written(&self) -> bool {
        self.partly
    }

    pub const fn is_saved(&self) -> bool {
        self.saved
    }

    pub const fn is_writing(&self) -> bool {
        self.asked.is_some()
    }

    /// Returns how far the user has jogged the axis in each direction.
    pub const fn travel(&self) -> JogTravel {
        self.travel
    }

    pub fn reference_position(&self) -> Option<i32> {
        self.reference.map(|(position, _)| position)
    }

    pub fn test_outcome(&self, place: TestTarget) -> Option<Outcome> {
        self.outcomes.get(place as usize).copied().flatten()
    }

    pub fn running_test_target(&self) -> Option<TestTarget> {
        self.going.map(|(place, ..)| place)
    }

    pub const fn power(&self) -> Option<Power> {
        self.power
    }

    /// Returns the first step before the current one that has lost its result. This step and all later ones must be
    /// repeated. Returns `None` if all results are valid.
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

    /// Returns whether the axis has survived a power cycle: the supply was off, the saved values are still present, and
    /// the axis has not moved.
    pub fn has_survived(&self) -> bool {
        self.power.is_some_and(Power::has_survived_power_cycle)
    }

    fn position_origin(&self, seen: &DriveFacts) -> PositionOrigin {
        PositionOrigin::from_facts(seen, self.jumps)
    }

    /// Returns the current drive data that the results of the steps depend on.
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
