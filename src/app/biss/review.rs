//! The review of a write into a BiSS encoder: what its plan needs, warns of and costs.

use std::path::PathBuf;

use crate::app::review::{self, OpWords, Reviewed, Toggle};
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
    pub(super) fn toggled(&self, at: usize) -> Option<Change> {
        let Change::Restore { profile, options } = &self.change else { return None };
        let mut options = *options;
        let own = match at {
            0 => &mut options.allow_other_device,
            _ => &mut options.with_mounting,
        };
        *own = !*own;
        Some(Change::Restore { profile: profile.clone(), options })
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
    matches!(op, Op::Calibrate | Op::WiegandTest { .. } | Op::FirePreset { .. })
}

impl Reviewed for Review {
    type Prepared = Prepared;
    type Done = Committed;

    fn plan(prepared: &Prepared) -> Option<PlanId> {
        (!prepared.plan.is_empty()).then(|| prepared.plan.id())
    }

    fn lines(prepared: &Prepared) -> Vec<OpWords> {
        prepared.plan.ops.iter().map(explain::biss::op).collect()
    }

    fn warnings(prepared: &Prepared) -> Vec<Text> {
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

    fn needs(prepared: &Prepared) -> Vec<Text> {
        let ops = &prepared.plan.ops;
        let mut needs = Vec::new();
        if ops.iter().any(|op| matches!(op, Op::Calibrate | Op::WiegandTest { .. })) {
            needs.push(Text::new("biss_review.needs_motor"));
        }
        if ops.iter().any(|op| matches!(op, Op::StoreData { .. } | Op::FirePreset { .. })) {
            needs.push(Text::new("biss_review.needs_standstill"));
        }
        let restarts = |op: &Op| matches!(op, Op::SelectFilter { .. } | Op::StorePreset { .. } | Op::FirePreset { .. });
        if ops.iter().any(restarts) {
            needs.push(Text::new("biss_review.needs_restart"));
        }
        needs
    }

    fn cost(prepared: &Prepared) -> Text {
        let cycles = prepared.plan.write_cycles();
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
        let hint = Some("review.with_mounting_hint");
        vec![
            Toggle { word: "review.allow_other", hint: None, is_on: options.allow_other_device },
            Toggle { word: "review.with_mounting", hint, is_on: options.with_mounting },
        ]
    }

    fn done(done: &Committed) -> (Text, Option<PathBuf>, Option<Text>) {
        let logbook = done.logbook_warning.as_ref().map(explain::logbook);
        (explain::biss::written(&done.written), done.backup.clone(), logbook)
    }
}
