//! The review of a write into an INTERBUS encoder: what its plan needs, warns of and costs.

use std::path::PathBuf;

use crate::app::review::{self, Manner, OpWords, Permit, Reviewed, Toggle};
use crate::app::{Text, explain};
use crate::profile::PlanId;
use crate::profile::interbus::{Op, RestoreOptions};
use crate::worker::interbus::{Change, Committed, Prepared, Wear};

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

    fn options(&self) -> Option<RestoreOptions> {
        match &self.change {
            Change::Restore { options, .. } => Some(*options),
            _ => None,
        }
    }
}

impl Reviewed for Review {
    type Prepared = Prepared;
    type Done = Committed;

    fn plan(prepared: &Prepared) -> Option<PlanId> {
        (!prepared.plan.is_empty()).then(|| prepared.plan.id())
    }

    fn lines(prepared: &Prepared) -> Vec<OpWords> {
        prepared.plan.ops.iter().map(explain::interbus::op).collect()
    }

    fn warnings(&self, prepared: &Prepared) -> Vec<Text> {
        let mut warnings = Vec::new();
        warnings.extend(explain::interbus::wear(prepared));
        if prepared.plan.ops.contains(&Op::Default) {
            warnings.push(Text::new("ib_review.experimental"));
        }
        if !prepared.missing.is_empty() {
            let items = prepared.missing.iter().map(|item| explain::phrase(item));
            warnings.push(Text::new("ib_review.missing").with_list("items", items));
        }
        if !prepared.mounting_left.is_empty() {
            let items = prepared.mounting_left.iter().map(explain::plain);
            warnings.push(Text::new("review.mounting_left").with_list("items", items));
        }
        warnings
    }

    fn needs(&self, prepared: &Prepared) -> Vec<Text> {
        let ops = &prepared.plan.ops;
        let mut needs = vec![Text::new("ib_review.needs_stop")];
        if ops.iter().any(|op| matches!(op, Op::Program(_))) {
            needs.push(Text::new("ib_review.switches"));
        }
        if ops.iter().any(|op| matches!(op, Op::FirePreset { .. })) {
            needs.push(Text::new("ib_review.needs_standstill"));
        }
        needs
    }

    fn cost(prepared: &Prepared) -> Text {
        let stores = prepared.plan.write_cycles();
        if stores == 0 {
            return Text::new("ib_review.cost_nothing");
        }
        match prepared.cycles_seen {
            Some(seen) => Text::new("ib_review.cost").with("stores", stores).with("seen", seen),
            None => Text::new("ib_review.cost_unknown").with("stores", stores),
        }
    }

    fn is_worn(prepared: &Prepared) -> bool {
        // Beyond what the maker names, somebody has to say once more that it is wanted; so where it is refused otherwise.
        matches!(prepared.wear(), Some(Wear::Ask(_) | Wear::Worn(_)))
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

    fn manner(_: &Prepared) -> Manner {
        Manner::Writes
    }

    fn done(done: &Committed) -> (Text, Option<PathBuf>, Option<Text>) {
        let logbook = done.logbook_warning.as_ref().map(explain::logbook);
        (explain::interbus::written(&done.written), done.backup.clone(), logbook)
    }
}
