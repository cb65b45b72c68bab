//! Messages for BiSS planning errors and for profiles of another encoder type.

use crate::app::Text;
use crate::devices::biss::profile::{PlanError, TypeMismatch};
use crate::devices::biss::protocol::ProcedureKind;
use crate::devices::biss::state::TEXTS;

/// Returns the message for a profile of another type of encoder.
pub fn other_type(types: &TypeMismatch) -> Text {
    type_mismatch_text(types, "biss_review.other_kind", "biss_review.other_width")
}

fn type_mismatch_text(types: &TypeMismatch, kind: &'static str, width: &'static str) -> Text {
    match types {
        TypeMismatch::Kind { profile, device } => TEXTS.text(kind).with("profile", profile).with("device", device),
        TypeMismatch::Width { profile, device } => TEXTS.text(width).with("profile", profile).with("device", device),
    }
}

pub fn plan_error_text(error: &PlanError) -> Text {
    match error {
        PlanError::OtherDevice { profile, device } => {
            Text::new("plan.other_device").with("profile", profile).with("device", device)
        }
        PlanError::TypeMismatch(types) => type_mismatch_text(types, "biss_plan.other_kind", "biss_plan.other_width"),
        PlanError::NoBank { bank } => TEXTS.text("biss_plan.no_bank").with("bank", format!("0x{bank:02X}")),
        PlanError::PresetTooWide { value, bits, .. } => {
            let last = (1u64 << bits.min(&63)) - 1;
            TEXTS.text("biss_plan.too_wide").with("value", value).with("bits", bits).with("last", last)
        }
        PlanError::UnknownFilter { code } => TEXTS.text("biss_plan.no_filter").with("code", format!("0x{code:02X}")),
        PlanError::NoProcedure { kind, description } => {
            TEXTS.text("biss_plan.no_procedure").with_text("what", procedure_kind_text(*kind)).with("name", description)
        }
        PlanError::FirmwareTooOld { kind, needed, found } => TEXTS
            .text("biss_plan.old_firmware")
            .with_text("what", procedure_kind_text(*kind))
            .with("needed", needed)
            .with("found", found),
        PlanError::ReadOnly { address } => TEXTS.text("biss_plan.read_only").with("address", address),
        PlanError::Guarded { address } => TEXTS.text("biss_plan.guarded").with("address", address),
        PlanError::ByteCount { range, count } => {
            TEXTS.text("biss_plan.byte_count").with("range", range).with("count", count)
        }
        PlanError::NotBalanced { .. } => TEXTS.text("biss_plan.not_balanced"),
        PlanError::DrivenByThisEncoder => TEXTS.text("mounting_card.refused"),
    }
}

pub(super) fn procedure_kind_text(kind: ProcedureKind) -> Text {
    TEXTS.text(match kind {
        ProcedureKind::WiegandTest => "guide.wiegand",
        ProcedureKind::Calibration => "guide.calibration",
        ProcedureKind::DataWrite => "guide.data",
        ProcedureKind::FilterSelection => "guide.filter",
        ProcedureKind::Preset => "guide.store_preset",
    })
}
