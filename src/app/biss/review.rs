//! The review of a write into a BiSS encoder: what its plan needs, warns of and costs.

use std::path::PathBuf;

use crate::app::review::{self, Manner, OpWords, Permit, Reviewed, Toggle};
use crate::app::{Text, explain};
use crate::profile::PlanId;
use crate::profile::biss::{Op, RestoreOptions};
use crate::worker::biss::{Change, Committed, Prepared, WEAR_LIMIT};

/// A write on its way.
pub type Review = review::Review<Change, Prepared, Committed>;
/// How far it is.
pub type ReviewState = review::ReviewState<Prepared, Committed>;

impl Review {
    /// What is wanted, with one of the review's toggles the other way round.
    pub(super) fn toggled(&self, permit: Permit) -> Option<Change> {
        let Change::Restore { profile, options } = &self.change else { return None };
        let mut options = *options;
        let own = match permit {
            Permit::OtherDevice => &mut options.allow_other_device,
            Permit::Mounting => &mut options.with_mounting,
            Permit::Recreate => return None,
        };
        *own = !*own;
        Some(Change::Restore { profile: profile.clone(), options })
    }

    /// What was chosen for a mounting and is not in its plan, because it is so already.
    fn left_out(&self, ops: &[Op]) -> impl Iterator<Item = Text> {
        let run = match &self.change {
            Change::Guided { run, .. } => Some(run),
            _ => None,
        };
        let preset = run.is_some_and(|run| run.preset.is_some());
        let data = run.is_some_and(|run| run.data.is_some());
        let stores = ops.iter().any(|op| matches!(op, Op::StorePreset { .. }));
        let writes = ops.iter().any(|op| matches!(op, Op::StoreData { .. } | Op::WriteRegister { .. }));
        let preset = (preset && !stores).then(|| Text::new("biss_review.preset_stored"));
        preset.into_iter().chain((data && !writes).then(|| Text::new("biss_review.data_equal")))
    }

    fn options(&self) -> Option<RestoreOptions> {
        match &self.change {
            Change::Restore { options, .. } => Some(*options),
            _ => None,
        }
    }
}

/// A person has to be there for it, or may lead it.
pub(super) fn is_guided(op: &Op) -> bool {
    op.turns() || matches!(op, Op::FirePreset { .. })
}

impl Reviewed for Review {
    type Prepared = Prepared;
    type Done = Committed;

    fn plan(prepared: &Prepared) -> Option<PlanId> {
        (!prepared.plan.is_empty()).then(|| prepared.plan.id())
    }

    fn lines(prepared: &Prepared) -> Vec<OpWords> {
        let layout = &prepared.identity.layout;
        prepared.plan.ops.iter().map(|op| explain::biss::op(op, layout)).collect()
    }

    fn warnings(&self, prepared: &Prepared) -> Vec<Text> {
        let mut warnings = Vec::new();
        warnings.extend(explain::biss::wear(prepared));
        if prepared.plan.ops.contains(&Op::Calibrate) {
            warnings.push(Text::new("biss_review.table"));
        }
        if !prepared.missing.is_empty() {
            let items = prepared.missing.iter().map(|item| explain::phrase(item));
            warnings.push(Text::new("biss_review.missing").with_list("items", items));
        }
        if !prepared.mounting_left.is_empty() {
            let items = prepared.mounting_left.iter().map(explain::plain);
            warnings.push(Text::new("review.mounting_left").with_list("items", items));
        }
        warnings
    }

    fn needs(&self, prepared: &Prepared) -> Vec<Text> {
        let ops = &prepared.plan.ops;
        let mut needs = Vec::new();
        if ops.iter().any(Op::turns) {
            needs.push(Text::new("biss_review.needs_motor"));
        }
        if ops.iter().any(|op| matches!(op, Op::StoreData { .. } | Op::FirePreset { .. })) {
            let turns = ops.iter().any(Op::turns);
            let id = if turns { "biss_review.needs_rest" } else { "biss_review.needs_standstill" };
            needs.push(Text::new(id));
        }
        let restarts = |op: &Op| matches!(op, Op::SelectFilter { .. } | Op::StorePreset { .. } | Op::FirePreset { .. });
        if ops.iter().any(restarts) {
            needs.push(Text::new("biss_review.needs_restart"));
        }
        needs.extend(self.left_out(ops));
        needs
    }

    fn cost(prepared: &Prepared) -> Text {
        let cycles = prepared.plan.write_cycles();
        if cycles == 0 {
            return Text::new("biss_review.cost_nothing");
        }
        match prepared.cycles_seen {
            Some(seen) => Text::new("biss_review.cost").with("cycles", cycles).with("seen", seen),
            None => Text::new("biss_review.cost_unknown").with("cycles", cycles),
        }
        .with("limit", WEAR_LIMIT)
    }

    fn is_worn(prepared: &Prepared) -> bool {
        prepared.cycles_seen.unwrap_or(0).saturating_add(prepared.plan.write_cycles()) > WEAR_LIMIT
    }

    fn toggles(&self) -> Vec<Toggle> {
        let Some(options) = self.options() else { return Vec::new() };
        let leaves = self.prepared().is_some_and(|prepared| !prepared.mounting_left.is_empty());
        [
            (Permit::OtherDevice, options.allow_other_device, self.is_for_another),
            (Permit::Mounting, options.with_mounting, leaves),
        ]
        .into_iter()
        .filter(|(_, is_on, matters)| *is_on || *matters)
        .map(|(permit, is_on, _)| Toggle { permit, is_on })
        .collect()
    }

    fn manner(prepared: &Prepared) -> Manner {
        match prepared.plan.ops.iter().any(is_guided) {
            false => Manner::Writes,
            true if prepared.plan.write_cycles() == 0 => Manner::Tests,
            true => Manner::Leads,
        }
    }

    fn done(done: &Committed) -> (Text, Option<PathBuf>, Option<Text>) {
        let logbook = done.logbook_warning.as_ref().map(explain::logbook);
        (explain::biss::written(&done.written), done.backup.clone(), logbook)
    }
}
