//! Messages about a planned write: the plan, its operations, its result, and the state in which it leaves the encoder.

use std::path::Path;

use super::encoder_error_text;
use super::item::{cam_mask_text, edge_text, parameter_text, parameter_value_text};
use crate::app::explain::{self, literal_text};
use crate::app::review::{ChangeDescription, OperationDescription};
use crate::app::{Severity, Text};
use crate::devices::interbus::jobs::{Change, ChangeKind, Prepared, WEAR_CONFIRMATION, WEAR_LIMIT, WearAfterPlan};
use crate::devices::interbus::procedures::write::{EndState, InterruptedWrite, WrittenChanges};
use crate::devices::interbus::profile::{
    CamChange, Edge, Item, Op, ParameterChange, PlanError, ProgramChange, TypeMismatch,
};
use crate::devices::interbus::protocol::{Flags, GearError, Value};
use crate::devices::interbus::state::TEXTS;
use crate::worker::NotStarted;

pub fn change_text(change: &Change) -> Text {
    match change {
        Change::Restore { profile, .. } => match profile.identity.serial_number.as_str() {
            "" => Text::new("ib_change.restore"),
            serial => Text::new("change.restore").with("serial", serial),
        },
        Change::Write(_) | Change::Item(..) => TEXTS.text("ib_change.write"),
        Change::Preset { value } => TEXTS.text("ib_change.preset").with("value", value),
        Change::Default => TEXTS.text("ib_change.default"),
    }
}

pub fn operation_texts(op: &Op) -> OperationDescription {
    match op {
        Op::Parameterise(changes) => OperationDescription {
            item: TEXTS.text("ib_op.parameters"),
            changes: changes
                .iter()
                .map(|ParameterChange { parameter: own, from, to }| ChangeDescription {
                    part: Some(parameter_text(*own)),
                    old: parameter_value_text(*own, *from),
                    new: parameter_value_text(*own, *to),
                })
                .collect(),
        },
        Op::Program(change) => OperationDescription {
            item: TEXTS.text("ib_op.program").with("program", change.program.get()),
            changes: describe_program_change(change),
        },
        Op::FirePreset { value } => {
            OperationDescription::single(TEXTS.text("ib_op.fire"), TEXTS.text("ib_op.place"), literal_text(value))
        }
        Op::Default => OperationDescription::single(
            TEXTS.text("ib_op.default"),
            TEXTS.text("ib_op.as_set"),
            TEXTS.text("ib_op.as_delivered"),
        ),
    }
}

fn describe_program_change(change: &ProgramChange) -> Vec<ChangeDescription> {
    let words = |part: Text, old: Text, new: Text| ChangeDescription { part: Some(part), old, new };
    // Both edges of a cam are on one line.
    let of_cam = |own: &[CamChange]| match own {
        [start @ CamChange { edge: Edge::Start, .. }, stop] => {
            let edges = |start: Value, stop: Value| literal_text(format!("{}…{}", start.get(), stop.get()));
            let cam = TEXTS.text("ib_item.cam").with("cam", start.cam.get());
            vec![words(cam, edges(start.from, stop.from), edges(start.to, stop.to))]
        }
        own => {
            let each = |own: &CamChange| {
                words(edge_text(own.cam, own.edge), literal_text(own.from.get()), literal_text(own.to.get()))
            };
            own.iter().map(each).collect()
        }
    };
    let of_cams = change.cams.chunk_by(|one, other| one.cam == other.cam).flat_map(of_cam);
    let mask = change.mask.map(|(old, new)| words(TEXTS.text("ib_item.mask"), cam_mask_text(old), cam_mask_text(new)));
    let shift = change
        .shift
        .map(|(old, new)| words(TEXTS.text("ib_item.shift"), literal_text(old.get()), literal_text(new.get())));
    of_cams.chain(mask).chain(shift).collect()
}

pub fn other_type(types: TypeMismatch) -> Text {
    type_mismatch_text("ib_review.other_type", types)
}

fn type_mismatch_text(id: &'static str, types: TypeMismatch) -> Text {
    let name = |flags: Flags| match (flags.counts_turns(), flags.steps_minus_one()) {
        (true, false) => "ib_type.multiturn",
        (false, false) => "ib_type.single_turn",
        (true, true) => "ib_type.multiturn_less_one",
        (false, true) => "ib_type.single_turn_less_one",
    };
    let [profile, device] = [types.profile, types.device].map(|flags| TEXTS.text(name(flags)));
    TEXTS.text(id).with_text("profile", profile).with_text("device", device)
}

/// Explains why a change cannot be planned.
pub fn plan_error_text(error: &PlanError) -> Text {
    match error {
        PlanError::OtherDevice { profile, device } => {
            Text::new("plan.other_device").with("profile", profile).with("device", device)
        }
        PlanError::TypeMismatch(types) => type_mismatch_text("ib_plan.other_type", *types),
        PlanError::Gear(GearError::Turns { turns }) => TEXTS.text("ib_plan.turns").with("turns", turns),
        PlanError::Gear(GearError::Steps { steps, turns, most }) => {
            TEXTS.text("ib_plan.steps").with("steps", steps).with("turns", turns).with("most", most)
        }
        PlanError::OutOfRange(error) => TEXTS
            .text("ib_plan.range")
            .with_text("item", parameter_text(error.parameter))
            .with("value", error.value)
            .with("low", error.low)
            .with("high", error.high),
        PlanError::MountingLeft { item, value, low, high } => TEXTS
            .text("ib_plan.mounting_left")
            .with_text("item", item.parameter().map_or_else(|| literal_text(item), parameter_text))
            .with("value", value)
            .with("low", low)
            .with("high", high),
        PlanError::CamBeyondRange { item: Item::Cam(program, cam), edge, position, last } => {
            let id = match edge {
                Edge::Start => "ib_plan.cam_start",
                Edge::Stop => "ib_plan.cam_stop",
            };
            let text = TEXTS.text(id).with("program", program.get()).with("cam", cam.get());
            text.with("position", position).with("last", last)
        }
        PlanError::CamBeyondRange { item, position, last, .. } => {
            let text = TEXTS.text("ib_plan.range").with("item", item);
            text.with("value", position).with("low", 0).with("high", last)
        }
        PlanError::NotRead { item } => TEXTS.text("ib_plan.not_read").with("item", item),
    }
}

/// Returns a warning about the wear of the EEPROM if the plan comes close to the limit.
pub fn wear_warning(prepared: &Prepared) -> Option<Text> {
    let (id, after) = match prepared.wear_to_report()? {
        WearAfterPlan::Known(after) => ("ib_stores.known", after),
        WearAfterPlan::Ask(after) => ("ib_stores.ask", after),
        WearAfterPlan::Worn(after) => ("ib_stores.worn", after),
        WearAfterPlan::Unknown => return Some(TEXTS.text("ib_stores.unknown")),
    };
    Some(TEXTS.text(id).with("after", after).with("nominal", WEAR_CONFIRMATION).with("limit", WEAR_LIMIT))
}

pub(super) fn not_started_text(why: &NotStarted) -> Text {
    match why {
        NotStarted::Worn { seen, cost, .. } => {
            TEXTS.text("ib_stores.refused").with("used", seen).with("cost", cost).with("limit", WEAR_LIMIT)
        }
        NotStarted::OtherPlan
        | NotStarted::BackupFailed(_)
        | NotStarted::WearUnknown { .. }
        | NotStarted::WearIncomplete { .. } => explain::not_started_text(why),
    }
}

pub fn written_text(written: &WrittenChanges) -> Text {
    // The values of the factory settings are unknown, so none of them is verified.
    let id = if written.verified == 0 { "biss_review.done" } else { "review.verified" };
    TEXTS.text(id).with("verified", written.verified).with("cycles", written.write_cycles)
}

/// Describes an interrupted write: its progress, its cause, the state of the encoder and where the backup is.
pub(super) fn interruption_text(
    interrupted: &InterruptedWrite,
    backup: &Path,
    planned: usize,
    kind: ChangeKind,
) -> Vec<Text> {
    let InterruptedWrite { done, unfinished, cause, end_state: left } = interrupted;
    let unclear = unfinished.as_ref().map(Op::affected_items).unwrap_or_default();
    let mut texts = vec![if cause.is_cancelled() && *left == EndState::AsFound {
        Text::new("write.cancelled").with("done", done.ops).with("planned", planned)
    } else {
        let text = Text::new("write.interrupted").with("done", done.ops).with("planned", planned);
        text.with_text("cause", encoder_error_text(cause))
    }];
    let untouched = done.write_cycles == 0 && done.written == 0;
    let state = match left {
        EndState::AsFound => TEXTS.text("ib_left.as_found"),
        EndState::Unknown(_) => TEXTS.text("ib_left.unknown"),
    };
    texts.push(if untouched || unclear.is_empty() {
        state
    } else {
        let items = TEXTS.text("ib_left.unclear").with_list("items", unclear.iter().map(literal_text));
        TEXTS.text("ib_left.both").with_text("state", state).with_text("unclear", items)
    });
    let what_next = match kind {
        _ if untouched => Text::new("write.untouched"),
        ChangeKind::Restore => Text::new("write.backup"),
        ChangeKind::Edits => Text::new("ib_left.edits"),
        ChangeKind::Preset => TEXTS.text("ib_left.preset"),
        ChangeKind::Default => TEXTS.text("ib_left.default"),
    };
    let what_next = what_next.with("backup", backup.display());
    texts.push(match left {
        EndState::AsFound => what_next,
        EndState::Unknown(_) => Text::new("write.after_lead_back").with_text("next", what_next),
    });
    texts
}

pub fn severity_of(text: &Text) -> Severity {
    match text.id() {
        "ib_left.as_found" => Severity::Good,
        "write.after_lead_back"
        | "write.backup"
        | "write.untouched"
        | "ib_left.edits"
        | "ib_left.preset"
        | "ib_left.default" => Severity::Note,
        "write.cancelled" | "ib_left.both" => Severity::Warning,
        _ => Severity::Error,
    }
}
