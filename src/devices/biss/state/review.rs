//! The summary of a write to a BiSS encoder before it starts: required permissions, warnings and write cycles.

use crate::app::explain::{cycle_count_text, literal_text};
use crate::app::review::{self, ExecutionMode, OperationDescription, Permit, Reviewable};
use crate::app::{Text, explain};
use crate::devices::biss::jobs::{Biss, Change, Prepared, WEAR_LIMIT};
use crate::devices::biss::procedures::write::WrittenValues;
use crate::devices::biss::profile::Op;
use crate::devices::biss::state::TEXTS;
use crate::devices::biss::state::explain as words;

pub type Review = review::Review<Biss>;
pub type ReviewState = review::ReviewState<Biss>;

/// Returns whether an operation is shown step by step, because it may need an operator at the motor.
pub(super) fn is_guided(op: &Op) -> bool {
    op.needs_motor() || matches!(op, Op::FirePreset { .. })
}

impl Reviewable for Biss {
    type Change = Change;
    type Prepared = Prepared;
    type Written = WrittenValues;

    fn change_title(change: &Change) -> Text {
        words::change_text(change)
    }

    fn permit_flag(change: &mut Change, permit: Permit) -> Option<&mut bool> {
        let Change::Restore { options, .. } = change else { return None };
        permit.restore_option(options)
    }

    fn operation_texts(prepared: &Prepared, op: &Op) -> OperationDescription {
        words::operation_texts(op, &prepared.identity.layout)
    }

    fn skips_mounting_values(prepared: &Prepared) -> bool {
        !prepared.mounting_left.is_empty()
    }

    fn redo(prepared: &Prepared) -> Vec<Text> {
        prepared.mounting_written.iter().map(explain::literal_text).collect()
    }

    fn warnings(prepared: &Prepared) -> Vec<Text> {
        let mut warnings = Vec::new();
        warnings.extend(prepared.other_type.as_ref().map(words::other_type));
        warnings.extend(words::wear_warning(prepared));
        if prepared.plan.ops.contains(&Op::Calibrate) {
            warnings.push(TEXTS.text("biss_review.table"));
        }
        if prepared.plan.ops.iter().any(|op| matches!(op, Op::FirePreset { .. })) {
            warnings.push(Text::new("review.commutation"));
        }
        warnings.extend(prepared.unsaved.map(words::unsaved_profile_text_for_mode));
        let mounting = prepared.mounting_left.iter().map(explain::literal_text).collect();
        warnings.extend(review::skipped_item_messages(
            TEXTS.text("biss_review.missing"),
            prepared.missing.iter().map(literal_text).collect(),
            mounting,
        ));
        warnings
    }

    fn requirements(change: &Change, prepared: &Prepared) -> Vec<Text> {
        let ops = &prepared.plan.ops;
        let mut needs = Vec::new();
        if ops.iter().any(Op::needs_motor) {
            needs.push(TEXTS.text("biss_review.needs_motor"));
        }
        if ops.iter().any(|op| matches!(op, Op::StoreData { .. } | Op::FirePreset { .. })) {
            let turns = ops.iter().any(Op::needs_motor);
            let id = if turns { "biss_review.needs_rest" } else { "biss_review.needs_standstill" };
            needs.push(TEXTS.text(id));
        }
        let restarts = |op: &Op| matches!(op, Op::SelectFilter { .. } | Op::StorePreset { .. } | Op::FirePreset { .. });
        if ops.iter().any(restarts) {
            needs.push(TEXTS.text("biss_review.needs_restart"));
        }
        needs.extend(skipped_operations(change, ops));
        needs
    }

    fn cost_text(prepared: &Prepared) -> Text {
        let cycles = prepared.plan.write_cycles();
        if cycles == 0 {
            return TEXTS.text("biss_review.cost_nothing");
        }
        match prepared.cycles_seen {
            Some(seen) => {
                TEXTS.text("biss_review.cost").with("cycles", cycles).with_text("seen", cycle_count_text(seen))
            }
            None => TEXTS.text("biss_review.cost_unknown").with("cycles", cycles),
        }
        .with("limit", WEAR_LIMIT)
    }

    fn written_text(written: &WrittenValues) -> Text {
        words::written_text(written)
    }

    fn execution_mode(prepared: &Prepared) -> ExecutionMode {
        match prepared.plan.ops.iter().any(is_guided) {
            false => ExecutionMode::Writes,
            true if prepared.plan.write_cycles() == 0 => ExecutionMode::Tests,
            true => ExecutionMode::Guided,
        }
    }
}

/// Returns the selected steps that are not in the plan because they would change nothing.
fn skipped_operations(change: &Change, ops: &[Op]) -> impl Iterator<Item = Text> {
    let run = match change {
        Change::Guided { run, .. } => Some(run),
        _ => None,
    };
    let preset = run.is_some_and(|run| run.preset.is_some());
    let data = run.is_some_and(|run| run.data.is_some());
    let stores = ops.iter().any(|op| matches!(op, Op::StorePreset { .. }));
    let writes = ops.iter().any(|op| matches!(op, Op::StoreData { .. } | Op::WriteRegister { .. }));
    let preset = (preset && !stores).then(|| TEXTS.text("biss_review.preset_stored"));
    preset.into_iter().chain((data && !writes).then(|| TEXTS.text("biss_review.data_equal")))
}
