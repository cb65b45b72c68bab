//! The review of a write into a HIPERDRIVE: what its plan needs, warns of and costs.

use std::path::PathBuf;

use crate::app::review::{self, Manner, OpWords, Permit, Reviewed, Toggle};
use crate::app::{Text, explain};
use crate::profile::PlanId;
use crate::profile::hiperdrive::{Op, RestoreOptions, Service, warnings};
use crate::worker::hiperdrive::{Change, Committed, Prepared};

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
        prepared.plan.ops.iter().map(explain::hiperdrive::op).collect()
    }

    fn warnings(&self, prepared: &Prepared) -> Vec<Text> {
        let mut texts: Vec<Text> = warnings(&prepared.plan).iter().map(explain::hiperdrive::warning).collect();
        texts.extend(prepared.wear().map(|after| Text::new("hd_review.wear").with("after", after)));
        if prepared.plan.ops.contains(&Op::Service(Service::FactoryAll)) {
            texts.push(Text::new("hd_review.factory_all"));
        }
        if !prepared.missing.is_empty() {
            let items = prepared.missing.iter().map(|item| explain::phrase(item));
            texts.push(Text::new("hd_review.missing").with_list("items", items));
        }
        if !prepared.mounting_left.is_empty() {
            let items = prepared.mounting_left.iter().map(explain::plain);
            texts.push(Text::new("review.mounting_left").with_list("items", items));
        }
        texts
    }

    fn needs(&self, prepared: &Prepared) -> Vec<Text> {
        let mut needs = vec![Text::new("hd_review.needs_stop")];
        let resets = |op: &Op| {
            matches!(op, Op::Service(Service::Reset | Service::Factory | Service::FactoryAll | Service::Acknowledge(_)))
        };
        if prepared.plan.ops.iter().any(resets) {
            needs.push(Text::new("hd_review.may_move"));
        }
        if matches!(self.change, Change::Restore { .. } | Change::Write(_) | Change::Try(_)) {
            needs.push(Text::new("hd_review.controller"));
        }
        needs
    }

    fn cost(prepared: &Prepared) -> Text {
        let saves = prepared.plan.write_cycles();
        if saves == 0 {
            return Text::new("hd_review.cost_nothing");
        }
        match prepared.cycles_seen {
            Some(seen) => Text::new("hd_review.cost").with("saves", saves).with("seen", seen),
            None => Text::new("hd_review.cost_unknown").with("saves", saves),
        }
    }

    fn is_worn(_: &Prepared) -> bool {
        // No limit is known.
        false
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
        (explain::hiperdrive::written(&done.written), done.backup.clone(), logbook)
    }
}
