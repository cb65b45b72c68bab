//! Review of a write to a HIPERFACE encoder: permissions, warnings and costs of the plan.

use crate::app::Text;
use crate::app::explain::cycle_count_text;
use crate::app::review::{self, OperationDescription, Permit, Question, Reviewable};
use crate::devices::hiperface::jobs::{Change, Hiperface, Prepared};
use crate::devices::hiperface::procedures::write::WrittenChanges;
use crate::devices::hiperface::profile::{Op, RestoreOptions, UnknownMeaningField};
use crate::devices::hiperface::protocol::AccessCodeNumber;
use crate::devices::hiperface::state::TEXTS;
use crate::devices::hiperface::state::explain as words;

pub type Review = review::Review<Hiperface>;
pub type ReviewState = review::ReviewState<Hiperface>;

impl Review {
    pub fn options(&self) -> Option<RestoreOptions> {
        match &self.change {
            Change::Restore { options, .. } => Some(options.clone()),
            _ => None,
        }
    }
}

impl Reviewable for Hiperface {
    type Change = Change;
    type Prepared = Prepared;
    type Written = WrittenChanges;

    fn change_title(change: &Change) -> Text {
        words::change_text(change)
    }

    fn permit_flag(change: &mut Change, permit: Permit) -> Option<&mut bool> {
        let Change::Restore { options, .. } = change else { return None };
        match permit {
            Permit::OtherDevice => Some(&mut options.allow_other_device),
            Permit::Mounting => Some(&mut options.with_mounting),
            Permit::Recreate => Some(&mut options.recreate),
            Permit::TypeMismatch => Some(&mut options.allow_other_type),
            Permit::Copy(field) => Some(options.copy.entry(field).or_insert(false)),
        }
    }

    fn operation_texts(prepared: &Prepared, op: &Op) -> OperationDescription {
        words::operation_texts(op, prepared.identity.geometry)
    }

    fn skips_mounting_values(prepared: &Prepared) -> bool {
        !prepared.mounting_left.is_empty()
    }

    fn retain_missing(prepared: &mut Prepared, concerns: &dyn Fn(&str) -> bool) {
        prepared.missing.retain(|item| concerns(&item.to_string()));
    }

    fn redo(prepared: &Prepared) -> Vec<Text> {
        prepared.redo().iter().map(words::required_setup_text).collect()
    }

    fn questions(prepared: &Prepared) -> Vec<Question> {
        let question = |own: &UnknownMeaningField| Question {
            title: words::unknown_field(own),
            no: TEXTS.text("review.leave_field").with("field", own.field),
            yes: Text::new("review.copy_field").with("field", own.field),
            permit: Permit::Copy(own.field),
            is_on: own.is_copied(),
        };
        prepared.unknown_fields.iter().map(question).collect()
    }

    fn warnings(prepared: &Prepared) -> Vec<Text> {
        let mut warnings = Vec::new();
        warnings.extend(prepared.other_type.map(words::other_type));
        warnings.extend(words::remaining_fields_text(&prepared.created_left));
        if prepared.plan.ops.iter().any(|op| matches!(op, Op::SetPosition { .. })) {
            warnings.push(Text::new("review.commutation"));
        }
        if let Some(wanted) = prepared.wanted_position {
            let set = prepared.plan.ops.iter().find_map(|op| match op {
                Op::SetPosition { to, .. } => Some(*to),
                _ => None,
            });
            warnings
                .push(TEXTS.text("review.other_position").with("wanted", wanted).with("set", set.unwrap_or(wanted)));
        }
        let missing = prepared.missing.iter().map(words::field_range).collect();
        let mounting = prepared.mounting_left.iter().map(words::field_range).collect();
        warnings.extend(review::skipped_item_messages(TEXTS.text("review.missing"), missing, mounting));
        if prepared.plan.ops.iter().any(|op| matches!(op, Op::IncrementCounter { .. })) {
            warnings.push(TEXTS.text("review.counter"));
        }
        warnings
    }

    fn requirements(_: &Change, prepared: &Prepared) -> Vec<Text> {
        let mut needs = Vec::new();
        let mut codes: Vec<AccessCodeNumber> = Vec::new();
        for op in &prepared.plan.ops {
            let need = match op {
                Op::SetPosition { synchronise: true, .. } => Some(TEXTS.text("review.needs_synchronise")),
                Op::SetPosition { .. } => Some(TEXTS.text("review.needs_standstill")),
                Op::SetAddress { .. } => Some(TEXTS.text("review.needs_alone")),
                Op::Configure { .. } => Some(TEXTS.text("review.needs_restart")),
                Op::Define { from: Some(_), to, .. } if !to.exists() => Some(TEXTS.text("review.needs_loss")),
                _ => None,
            };
            needs.extend(need.filter(|need| !needs.contains(need)));
            let code = match op {
                Op::Store { status, .. } => Some(status.code()),
                Op::Define { from, to, .. } => Some(from.unwrap_or(*to).code()),
                // The frames of these commands contain access code 0.
                Op::SetPosition { .. } | Op::SetAddress { .. } | Op::Configure { .. } | Op::ClearCounter { .. } => {
                    Some(AccessCodeNumber::ZERO)
                }
                Op::ChangeCode { .. } | Op::IncrementCounter { .. } => None,
            };
            codes.extend(code.filter(|code| !codes.contains(code)));
            if let Op::ChangeCode { .. } = op {
                needs.push(TEXTS.text("review.needs_code_kept"));
            }
        }
        if !codes.is_empty() {
            let numbers: Vec<String> = codes.iter().map(ToString::to_string).collect();
            needs.push(TEXTS.text("review.needs_code").with("codes", numbers.join(", ")));
        }
        needs
    }

    fn cost_text(prepared: &Prepared) -> Text {
        let cycles = prepared.plan.write_cycles();
        match prepared.cycles_seen {
            Some(seen) => TEXTS.text("review.cost").with("cycles", cycles).with_text("seen", cycle_count_text(seen)),
            None => TEXTS.text("review.cost_unknown").with("cycles", cycles),
        }
    }

    fn written_text(written: &WrittenChanges) -> Text {
        words::written_text(written)
    }

    fn verified_text(written: &WrittenChanges) -> Text {
        words::verified_text(written)
    }
}
