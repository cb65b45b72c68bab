//! Review of a write before the user approves it: required permits, warnings, and the number of saves.

use super::axis::labels::millimetres_text;
use super::format;
use super::network::PowerUpAddress;
use super::ruler::{PositionUnit, Ruler};
use crate::app::explain::{cycle_count_text, literal_text};
use crate::app::number::required_decimals;
use crate::app::review::{self, OperationDescription, Permit, Reviewable};
use crate::app::{Text, explain};
use crate::devices::hiperdrive::jobs::{Change, Hiperdrive, Prepared};
use crate::devices::hiperdrive::procedures::write::WrittenChanges;
use crate::devices::hiperdrive::profile::{self, Base, Image, Op, Service, plan_warnings};
use crate::devices::hiperdrive::protocol::drive_parameter::{LOWER_LIMIT, REFERENCE, UPPER_LIMIT};
use crate::devices::hiperdrive::protocol::{AddressSwitch, DriveNumber, Length, ParameterNumber};
use crate::devices::hiperdrive::state::TEXTS;
use crate::devices::hiperdrive::state::explain as explained;
use crate::profile::Plan;

pub type Review = review::Review<Hiperdrive>;
pub type ReviewState = review::ReviewState<Hiperdrive>;

impl Reviewable for Hiperdrive {
    type Change = Change;
    type Prepared = Prepared;
    type Written = WrittenChanges;

    fn change_title(change: &Change) -> Text {
        explained::change_text(change)
    }

    fn permit_flag(change: &mut Change, permit: Permit) -> Option<&mut bool> {
        let Change::Restore { options, .. } = change else { return None };
        permit.restore_option(options)
    }

    fn operation_texts(prepared: &Prepared, op: &Op) -> OperationDescription {
        operation_texts(prepared, op, |_| None)
    }

    fn skips_mounting_values(prepared: &Prepared) -> bool {
        !prepared.mounting_left.is_empty()
    }

    fn redo(prepared: &Prepared) -> Vec<Text> {
        prepared.mounting_written.iter().map(explain::literal_text).collect()
    }

    fn warnings(prepared: &Prepared) -> Vec<Text> {
        let mut texts: Vec<Text> = prepared.other_types.iter().map(explained::other_type).collect();
        texts.extend(plan_warnings(&prepared.plan).iter().map(explained::warning_text));
        texts.extend(prepared.wear_to_report().map(|after| TEXTS.text("hd_review.wear").with("after", after)));
        if prepared.plan.ops.contains(&Op::Service(Service::FactoryAll)) {
            texts.push(TEXTS.text("hd_review.factory_all"));
        }
        texts.extend(power_up(&prepared.plan));
        let mounting = prepared.mounting_left.iter().map(explain::literal_text).collect();
        texts.extend(review::skipped_item_messages(
            TEXTS.text("hd_review.missing"),
            prepared.missing.iter().map(literal_text).collect(),
            mounting,
        ));
        texts
    }

    fn requirements(change: &Change, prepared: &Prepared) -> Vec<Text> {
        let mut needs = vec![TEXTS.text("hd_review.needs_stop")];
        let resets = |op: &Op| {
            matches!(op, Op::Service(Service::Reset | Service::Factory | Service::FactoryAll | Service::Acknowledge(_)))
        };
        if prepared.plan.ops.iter().any(resets) {
            needs.push(TEXTS.text("hd_review.may_move"));
        }
        if matches!(change, Change::Restore { .. } | Change::Write(_) | Change::Try(_)) {
            needs.push(TEXTS.text("hd_review.controller"));
        }
        needs
    }

    fn cost_text(prepared: &Prepared) -> Text {
        let saves = prepared.plan.write_cycles();
        if saves == 0 {
            let sets = |op: &Op| matches!(op, Op::Write { number, .. } if number.drive1_number() == REFERENCE);
            let position = prepared.plan.ops.iter().any(sets);
            return TEXTS.text(if position { "hd_review.cost_position" } else { "hd_review.cost_nothing" });
        }
        match prepared.cycles_seen {
            Some(seen) => TEXTS.text("hd_review.cost").with("saves", saves).with_text("seen", cycle_count_text(seen)),
            None => TEXTS.text("hd_review.cost_unknown").with("saves", saves),
        }
    }

    fn written_text(written: &WrittenChanges) -> Text {
        explained::written_text(written)
    }
}

/// Describes an operation. Positions are given in millimetres if the spindle pitch of the drive is known.
pub(super) fn operation_texts(
    prepared: &Prepared,
    op: &Op,
    pitch: impl Fn(DriveNumber) -> Option<Length>,
) -> OperationDescription {
    let mut words = explained::operation_texts(op);
    if let (Op::Write { number, old, new }, [change]) = (op, &mut *words.changes) {
        let now = prepared.plan.base.image();
        let then = now.with_overlay(&profile::written_values(&prepared.plan));
        let pitch = number.drive().and_then(pitch);
        let meant = |text: &mut Text, value, image| {
            if let Some(meaning) = value_meaning(*number, value, image, pitch) {
                let value = text.clone();
                *text = TEXTS.text("hd_op.meant").with_text("value", value).with_text("meaning", meaning);
            }
        };
        old.iter().for_each(|old| meant(&mut change.old, *old, &now));
        meant(&mut change.new, *new, &then);
    }
    words
}

/// Describes a value. Positions are given in millimetres if the pitch is known, and otherwise in turns. `image`
/// contains the scale.
fn value_meaning(number: ParameterNumber, value: i64, image: &Image, pitch: Option<Length>) -> Option<Text> {
    match (number.drive1_number(), number.drive()) {
        (LOWER_LIMIT | UPPER_LIMIT | 170 | 176 | REFERENCE, Some(drive)) => {
            let scale = image.scale(drive)?;
            if pitch.is_some() {
                return Some(millimetres_text(Some(Ruler { scale, pitch }), value));
            }
            let turns = value as f64 / scale.steps_per_turn();
            let text = TEXTS.text("hd_entry.place").with_number("value", turns, required_decimals(turns, 3));
            Some(text.with_text("unit", TEXTS.text(PositionUnit::Turns.unit())))
        }
        _ => format::value_meaning(number, value),
    }
}

fn power_up(plan: &Plan<Base, Op>) -> Option<Text> {
    let to = plan.ops.iter().find_map(|op| match op {
        Op::Network { to, .. } => Some(to),
        Op::Write { .. } | Op::Service(_) => None,
    })?;
    let digits = ParameterNumber::new(12).and_then(|number| plan.base.values.get(&number));
    let switch = digits.and_then(|digits| AddressSwitch::parse(u8::try_from(*digits).ok()?));
    Some(TEXTS.text("hd_review.power_up").with_text("what", PowerUpAddress::from_settings(switch, to).to_text()))
}
