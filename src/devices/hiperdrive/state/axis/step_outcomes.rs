//! Results of the steps in the axis set-up. Each result includes the drive data that it depends on. If this data
//! changes for any reason, the result and all later results become void.

use super::{AxisStep, DriveFacts};
use crate::devices::hiperdrive::protocol::drive_parameter::REFERENCE;
use crate::devices::hiperdrive::protocol::{Length, PositionScale};

/// Identifies the zero point that positions refer to. It may have moved if any field changes: the reference (parameter
/// 198), the number of times this program has set the position, or the number of jumps at standstill. A jump is the
/// only sign of the same reference being set again at another location.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct PositionOrigin {
    set: Option<i64>,
    times: u32,
    jumps: u32,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Preconditions {
    pub(super) requested: Option<bool>,
    pub(super) scale: Option<PositionScale>,
    pub(super) pitch: Option<Length>,
    /// Whether the limits of the drive are confirmed in the current scale.
    pub(super) confirmed: bool,
    pub(super) origin: PositionOrigin,
    pub(super) limits: Option<(i32, i32)>,
    pub(super) lower: Option<i32>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct StepOutcome {
    on: Preconditions,
    skipped: bool,
}

/// Results of the completed steps, in order from the first step.
#[derive(Clone, Debug, Default)]
pub(super) struct StepOutcomes(Vec<StepOutcome>);

impl PositionOrigin {
    pub(super) fn from_facts(seen: &DriveFacts, jumps: u32) -> Self {
        PositionOrigin { set: seen.values.get(&REFERENCE).copied(), times: seen.times_set, jumps }
    }
}

impl StepOutcomes {
    /// Returns the first step without a result, or `None` if all steps have a result.
    pub(super) fn first_open_step(&self) -> Option<AxisStep> {
        AxisStep::ALL.get(self.0.len()).copied()
    }

    pub(super) fn is_complete(&self, step: AxisStep) -> bool {
        step.index() < self.0.len()
    }

    pub(super) fn is_skipped(&self, step: AxisStep) -> bool {
        self.0.get(step.index()).is_some_and(|made| made.skipped)
    }

    /// Records the result of a step. If it differs from the previous result, all later results become void and `true`
    /// is returned.
    pub(super) fn record(&mut self, step: AxisStep, on: Preconditions, skipped: bool) -> bool {
        let made = StepOutcome { on, skipped };
        let before = self.0.get(step.index()).copied();
        if before.is_some_and(|before| before.skipped == skipped && is_same(step, &before.on, &on)) {
            return false;
        }
        if step.index() <= self.0.len() {
            self.0.truncate(step.index());
            self.0.push(made);
        }
        before.is_some()
    }

    /// Discards results that no longer match the current drive data. Returns the first step that has lost its result.
    pub(super) fn discard_outdated(&mut self, now: &Preconditions) -> Option<AxisStep> {
        let holds = |(step, made): (&AxisStep, &StepOutcome)| is_unchanged(*step, &made.on, now);
        let left = AxisStep::ALL.iter().zip(&self.0).take_while(|own| holds(*own)).count();
        let fallen = (left < self.0.len()).then(|| AxisStep::ALL.get(left).copied()).flatten();
        self.0.truncate(left);
        fallen
    }
}

/// Returns whether the drive data that this step depends on are unchanged. Data of earlier steps are checked with those
/// steps.
fn is_unchanged(step: AxisStep, on: &Preconditions, now: &Preconditions) -> bool {
    match step {
        AxisStep::Request => now.requested == Some(true),
        AxisStep::Scale => (on.scale, on.pitch) == (now.scale, now.pitch),
        AxisStep::Confirm => now.confirmed,
        AxisStep::Reference => on.origin == now.origin,
        AxisStep::Upper => on.limits == now.limits,
        AxisStep::Jog | AxisStep::Lower | AxisStep::Test | AxisStep::Save | AxisStep::PowerCycle => true,
    }
}

fn is_same(step: AxisStep, before: &Preconditions, now: &Preconditions) -> bool {
    is_unchanged(step, before, now) && (step != AxisStep::Lower || before.lower == now.lower)
}
