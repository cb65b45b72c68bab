//! The results of the set-up, step by step. Each keeps the facts of the drive that it depends on. If one of them changes,
//! whoever changed it, the result is void, and with it all later ones.

use super::{AxisStep, Seen};
use crate::devices::hiperdrive::protocol::drive_parameter::REFERENCE;
use crate::devices::hiperdrive::protocol::{Length, PositionScale};

/// Origin of positions: the position that was set last (198), how often one was set by this program, and how often the
/// position jumped at a standstill, which alone reveals a reference set again to the same number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Origin {
    set: Option<i64>,
    times: u32,
    jumps: u32,
}

/// The facts on which results rest, at a moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Basis {
    pub(super) requested: Option<bool>,
    pub(super) scale: Option<PositionScale>,
    pub(super) pitch: Option<Length>,
    /// The limits of the drive are confirmed under this scale.
    pub(super) confirmed: bool,
    pub(super) origin: Origin,
    pub(super) limits: Option<(i32, i32)>,
    /// Lower limit as taught.
    pub(super) lower: Option<i32>,
}

/// The result of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Made {
    on: Basis,
    /// The step was skipped.
    skipped: bool,
}

/// Results, from the first step on without a gap.
#[derive(Clone, Debug, Default)]
pub(super) struct Chain(Vec<Made>);

impl Origin {
    pub(super) fn of(seen: &Seen, jumps: u32) -> Self {
        Origin { set: seen.values.get(&REFERENCE).copied(), times: seen.times_set, jumps }
    }
}

impl Chain {
    /// Returns the first step that has no result; `None` if all have one.
    pub(super) fn end(&self) -> Option<AxisStep> {
        AxisStep::ALL.get(self.0.len()).copied()
    }

    /// Returns whether a step has a result.
    pub(super) fn holds(&self, step: AxisStep) -> bool {
        step.index() < self.0.len()
    }

    /// Returns whether a step was left out.
    pub(super) fn is_skipped(&self, step: AxisStep) -> bool {
        self.0.get(step.index()).is_some_and(|made| made.skipped)
    }

    /// Stores the result of a step. If it differs from the previous one, discards all later results and returns true.
    pub(super) fn make(&mut self, step: AxisStep, on: Basis, skipped: bool) -> bool {
        let made = Made { on, skipped };
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

    /// Discards results that no longer agree with the present facts; returns the first step affected.
    pub(super) fn fall(&mut self, now: &Basis) -> Option<AxisStep> {
        let stands = |(step, made): (&AxisStep, &Made)| stands(*step, &made.on, now);
        let left = AxisStep::ALL.iter().zip(&self.0).take_while(|own| stands(*own)).count();
        let fallen = (left < self.0.len()).then(|| AxisStep::ALL.get(left).copied()).flatten();
        self.0.truncate(left);
        fallen
    }
}

/// Returns whether the drive's own facts of a step are unchanged. Those of earlier steps are checked there.
fn stands(step: AxisStep, on: &Basis, now: &Basis) -> bool {
    match step {
        AxisStep::Request => now.requested == Some(true),
        AxisStep::Scale => (on.scale, on.pitch) == (now.scale, now.pitch),
        AxisStep::Confirm => now.confirmed,
        AxisStep::Reference => on.origin == now.origin,
        AxisStep::Upper => on.limits == now.limits,
        AxisStep::Jog | AxisStep::Lower | AxisStep::Test | AxisStep::Save | AxisStep::PowerCycle => true,
    }
}

/// Returns whether a result equals the previous one.
fn is_same(step: AxisStep, before: &Basis, now: &Basis) -> bool {
    stands(step, before, now) && (step != AxisStep::Lower || before.lower == now.lower)
}
