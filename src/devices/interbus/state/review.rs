//! What the user reviews before a write to an INTERBUS encoder: permissions, warnings and the cost of the plan.

use crate::app::explain::{cycle_count_text, literal_text};
use crate::app::review::{self, OperationDescription, Permit, Reviewable};
use crate::app::{Text, explain};
use crate::devices::interbus::jobs::{Change, Interbus, Prepared, WEAR_CONFIRMATION, WEAR_GUARANTEE, WearAfterPlan};
use crate::devices::interbus::procedures::write::WrittenChanges;
use crate::devices::interbus::profile::Op;
use crate::devices::interbus::state::TEXTS;
use crate::devices::interbus::state::explain as words;

pub type Review = review::Review<Interbus>;
pub type ReviewState = review::ReviewState<Interbus>;

impl Reviewable for Interbus {
    type Change = Change;
    type Prepared = Prepared;
    type Written = WrittenChanges;

    fn change_title(change: &Change) -> Text {
        words::change_text(change)
    }

    fn permit_flag(change: &mut Change, permit: Permit) -> Option<&mut bool> {
        let Change::Restore { options, .. } = change else { return None };
        permit.restore_option(options)
    }

    fn operation_texts(_: &Prepared, op: &Op) -> OperationDescription {
        words::operation_texts(op)
    }

    fn skips_mounting_values(prepared: &Prepared) -> bool {
        !prepared.mounting_left.is_empty()
    }

    fn redo(prepared: &Prepared) -> Vec<Text> {
        prepared.mounting_written.iter().map(explain::literal_text).collect()
    }

    fn warnings(prepared: &Prepared) -> Vec<Text> {
        let mut warnings = Vec::new();
        warnings.extend(prepared.other_type.map(words::other_type));
        warnings.extend(words::wear_warning(prepared));
        if prepared.plan.ops.contains(&Op::Default) {
            warnings.push(TEXTS.text("ib_review.experimental"));
        }
        let mounting = prepared.mounting_left.iter().map(explain::literal_text).collect();
        warnings.extend(review::skipped_item_messages(
            TEXTS.text("ib_review.missing"),
            prepared.missing.iter().map(literal_text).collect(),
            mounting,
        ));
        warnings
    }

    fn requirements(_: &Change, prepared: &Prepared) -> Vec<Text> {
        let ops = &prepared.plan.ops;
        let mut needs = vec![TEXTS.text("ib_review.needs_stop")];
        if ops.iter().any(|op| matches!(op, Op::Program(_))) {
            needs.push(TEXTS.text("ib_review.switches"));
        }
        if ops.iter().any(|op| matches!(op, Op::FirePreset { .. })) {
            needs.push(TEXTS.text("ib_review.needs_standstill"));
        }
        needs
    }

    fn cost_text(prepared: &Prepared) -> Text {
        let stores = prepared.plan.write_cycles();
        if stores == 0 {
            return TEXTS.text("ib_review.cost_nothing");
        }
        match prepared.cycles_seen {
            Some(seen) => TEXTS.text("ib_review.cost").with("stores", stores).with_text("seen", cycle_count_text(seen)),
            None => TEXTS.text("ib_review.cost_unknown").with("stores", stores),
        }
        .with("nominal", WEAR_CONFIRMATION)
        .with("last", WEAR_GUARANTEE)
    }

    fn reaches_wear_limit(prepared: &Prepared) -> bool {
        // Above the manufacturer's limit, the user has to confirm again. This also applies to a plan that is only
        // executed if it is forced.
        matches!(
            prepared.wear_to_report(),
            Some(WearAfterPlan::Ask(_) | WearAfterPlan::Worn(_) | WearAfterPlan::Unknown)
        )
    }

    fn written_text(written: &WrittenChanges) -> Text {
        words::written_text(written)
    }
}
