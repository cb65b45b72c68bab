//! The review of a write into a HIPERFACE encoder: what its plan needs, warns of and costs.

use std::path::PathBuf;

use crate::app::Text;
use crate::app::explain;
use crate::app::review::{self, Manner, OpWords, Permit, Reviewed, Toggle};
use crate::profile::PlanId;
use crate::profile::hiperface::{HiperfacePlan, Op, RestoreOptions};
use crate::protocol::hiperface::CodeNumber;
use crate::worker::hiperface::{Change, Committed, Prepared, WEAR_LIMIT};

/// A write on its way.
pub type Review = review::Review<Change, Prepared, Committed>;
/// How far it is.
pub type ReviewState = review::ReviewState<Prepared, Committed>;

impl Review {
    /// The options of a restore, where this is one.
    pub fn options(&self) -> Option<RestoreOptions> {
        match &self.change {
            Change::Restore { options, .. } => Some(*options),
            _ => None,
        }
    }

    pub(super) fn set_options(&mut self, wanted: RestoreOptions) {
        if let Change::Restore { options, .. } = &mut self.change {
            *options = wanted;
        }
    }

    /// The options of a restore with one of the review's toggles the other way round.
    pub(super) fn toggled(&self, permit: Permit) -> Option<RestoreOptions> {
        let mut options = self.options()?;
        let own = match permit {
            Permit::OtherDevice => &mut options.allow_other_device,
            Permit::Mounting => &mut options.with_mounting,
            Permit::Recreate => &mut options.recreate,
        };
        *own = !*own;
        Some(options)
    }
}

impl Reviewed for Review {
    type Prepared = Prepared;
    type Done = Committed;

    fn plan(prepared: &Prepared) -> Option<PlanId> {
        (!prepared.plan.is_empty()).then(|| prepared.plan.id())
    }

    fn lines(prepared: &Prepared) -> Vec<OpWords> {
        lines(&prepared.plan)
    }

    fn warnings(&self, prepared: &Prepared) -> Vec<Text> {
        warnings(prepared)
    }

    fn needs(&self, prepared: &Prepared) -> Vec<Text> {
        needs(&prepared.plan)
    }

    fn cost(prepared: &Prepared) -> Text {
        cost(prepared)
    }

    fn is_worn(prepared: &Prepared) -> bool {
        is_worn(prepared)
    }

    fn toggles(&self) -> Vec<Toggle> {
        let Some(options) = self.options() else { return Vec::new() };
        let leaves = self.prepared().is_some_and(|prepared| !prepared.mounting_left.is_empty());
        [
            (Permit::OtherDevice, options.allow_other_device, self.is_for_another),
            (Permit::Mounting, options.with_mounting, leaves),
            (Permit::Recreate, options.recreate, true),
        ]
        .into_iter()
        .filter(|(_, is_on, matters)| *is_on || *matters)
        .map(|(permit, is_on, _)| Toggle { permit, is_on })
        .collect()
    }

    fn manner(_prepared: &Prepared) -> Manner {
        Manner::Writes
    }

    fn done(done: &Committed) -> (Text, Option<PathBuf>, Option<Text>) {
        let logbook = done.logbook_warning.as_ref().map(explain::logbook);
        (explain::hiperface::verified(&done.written), done.backup.clone(), logbook)
    }
}

/// What a plan needs from the person in front of the encoder, and what to know before it is carried out.
pub fn needs(plan: &HiperfacePlan) -> Vec<Text> {
    let mut needs = Vec::new();
    let mut codes: Vec<CodeNumber> = Vec::new();
    for op in &plan.ops {
        let need = match op {
            Op::SetPosition { synchronise: true, .. } => Some(Text::new("review.needs_synchronise")),
            Op::SetPosition { .. } => Some(Text::new("review.needs_standstill")),
            Op::SetAddress { .. } => Some(Text::new("review.needs_alone")),
            Op::Configure { .. } => Some(Text::new("review.needs_restart")),
            Op::Define { from: Some(_), to, .. } if !to.exists() => Some(Text::new("review.needs_loss")),
            _ => None,
        };
        needs.extend(need.filter(|need| !needs.contains(need)));
        if let Op::Store { status, .. } = op
            && !codes.contains(&status.code())
        {
            codes.push(status.code());
        }
        if let Op::ChangeCode { .. } = op {
            needs.push(Text::new("review.needs_code_kept"));
        }
    }
    if !codes.is_empty() {
        let numbers: Vec<String> = codes.iter().map(ToString::to_string).collect();
        needs.push(Text::new("review.needs_code").with("codes", numbers.join(", ")));
    }
    needs
}

/// What should make somebody stop and look, in a plan.
pub fn warnings(prepared: &Prepared) -> Vec<Text> {
    let mut warnings = Vec::new();
    if let Some(wanted) = prepared.wanted_position {
        let set = prepared.plan.ops.iter().find_map(|op| match op {
            Op::SetPosition { to, .. } => Some(*to),
            _ => None,
        });
        warnings.push(Text::new("review.other_position").with("wanted", wanted).with("set", set.unwrap_or(wanted)));
    }
    if !prepared.missing.is_empty() {
        warnings.push(
            Text::new("review.missing").with_list("items", prepared.missing.iter().map(|item| explain::phrase(item))),
        );
    }
    if !prepared.mounting_left.is_empty() {
        let ranges = prepared.mounting_left.iter().map(|range| explain::phrase(&range.to_string()));
        warnings.push(Text::new("review.mounting_left").with_list("items", ranges));
    }
    if prepared.plan.ops.iter().any(|op| matches!(op, Op::IncrementCounter { .. })) {
        warnings.push(Text::new("review.counter"));
    }
    warnings
}

/// What a plan costs, beside what this computer has seen the encoder take.
pub fn cost(prepared: &Prepared) -> Text {
    let cycles = prepared.plan.write_cycles();
    match prepared.cycles_seen {
        Some(seen) => Text::new("review.cost").with("cycles", cycles).with("seen", seen),
        None => Text::new("review.cost_unknown").with("cycles", cycles),
    }
}

/// One line of the plan.
pub fn lines(plan: &HiperfacePlan) -> Vec<OpWords> {
    plan.ops.iter().map(explain::hiperface::op).collect()
}

/// The encoder counts as worn when this plan is carried out.
pub fn is_worn(prepared: &Prepared) -> bool {
    prepared.cycles_seen.unwrap_or(0).saturating_add(prepared.plan.write_cycles()) > WEAR_LIMIT
}
