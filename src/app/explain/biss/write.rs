//! Writes in words: what is wanted, the operations of a plan, why there is no plan, what was written, why it ended early and
//! in which state the encoder was left.

use std::path::Path;

use super::encoder;
use super::guide::{blocker, task};
use crate::app::Text;
use crate::app::biss::words::filter;
use crate::app::explain::plain;
use crate::app::review::OpWords;
use crate::bits::hex;
use crate::device::biss::procedure::{Activity, Failure, Run, Standing};
use crate::device::biss::write::{Interrupted, Left, Written};
use crate::profile::biss::{Op, PlanError, PresetParts, RegisterChange, RegisterRange};
use crate::protocol::biss::{CalibrationStatus, PresetValue, ProcedureKind, WiegandStatus};
use crate::worker::biss::{Change, ChangeKind};

/// A change in words.
pub fn change(change: &Change) -> Text {
    match change {
        Change::Restore { profile, .. } => Text::new("change.restore").with("serial", &profile.identity.serial_number),
        Change::Write(edits) => {
            let bytes: usize = edits.iter().map(|(_, bytes)| bytes.len()).sum();
            Text::new(if bytes == 1 { "change.store_one" } else { "change.store" }).with("bytes", bytes)
        }
        Change::SelectFilter(to) => Text::new("biss_change.filter").with_text("filter", filter(*to)),
        Change::Preset { parts: None, .. } => Text::new("biss_change.store_preset"),
        Change::Preset { .. } => Text::new("biss_change.fire_preset"),
        Change::Guided { .. } => Text::new("biss_change.guided"),
    }
}

/// An operation in words.
pub fn op(op: &Op) -> OpWords {
    match op {
        Op::StoreData { area, registers } => {
            let addresses = registers.iter().map(|own| own.address);
            let ranges: Vec<String> = RegisterRange::runs(addresses).iter().map(ToString::to_string).collect();
            let bytes = |value: fn(&RegisterChange) -> u8| hex(&registers.iter().map(value).collect::<Vec<u8>>());
            OpWords {
                item: Text::new("biss_op.data").with("area", &area.name).with("ranges", ranges.join(", ")),
                old: plain(bytes(|own| own.old)),
                new: plain(bytes(|own| own.new)),
            }
        }
        Op::StorePreset { from, to } => {
            OpWords { item: Text::new("biss_op.preset"), old: preset(*from), new: preset(*to) }
        }
        Op::FirePreset { parts, value } => OpWords {
            item: Text::new("biss_op.fire"),
            old: Text::new("biss_op.place"),
            new: match parts {
                PresetParts::Both => preset(*value),
                PresetParts::Singleturn => Text::new("biss_op.singleturn").with("value", value.singleturn()),
                PresetParts::Multiturn => Text::new("biss_op.multiturn").with("value", value.multiturn()),
            },
        },
        Op::SelectFilter { from, to } => {
            OpWords { item: Text::new("biss_op.filter"), old: filter(*from), new: filter(*to) }
        }
        Op::Calibrate => OpWords {
            item: Text::new("guide.calibration"),
            old: Text::new("biss_op.present_table"),
            new: Text::new("biss_op.new_table"),
        },
        Op::WiegandTest { save } => OpWords {
            item: Text::new("guide.wiegand"),
            old: Text::new("biss_op.last_result"),
            new: Text::new(if *save { "biss_op.saved_result" } else { "biss_op.fresh_result" }),
        },
        Op::WriteRegister { address, old, new, .. } => OpWords {
            item: Text::new("biss_op.register").with("address", address),
            old: old.map_or_else(|| Text::new("biss_op.not_readable"), |old| plain(format!("{old:02X}"))),
            new: plain(format!("{new:02X}")),
        },
    }
}

fn preset(value: PresetValue) -> Text {
    Text::new("biss_op.preset_value").with("singleturn", value.singleturn()).with("multiturn", value.multiturn())
}

/// Why something cannot be planned.
pub fn plan(error: &PlanError) -> Text {
    match error {
        PlanError::OtherDevice { profile, device } => {
            Text::new("plan.other_device").with("profile", profile).with("device", device)
        }
        PlanError::OtherKind { profile, device } => {
            Text::new("biss_plan.other_kind").with("profile", profile).with("device", device)
        }
        PlanError::NoBank { bank } => Text::new("biss_plan.no_bank").with("bank", format!("{bank:02X}h")),
        PlanError::PresetTooWide { value, bits, .. } => {
            Text::new("biss_plan.too_wide").with("value", value).with("bits", bits)
        }
        PlanError::UnknownFilter { code } => Text::new("biss_plan.no_filter").with("code", format!("{code:02X}h")),
        PlanError::NoProcedure { kind, description } => {
            Text::new("biss_plan.no_procedure").with_text("what", kind_of(*kind)).with("name", description)
        }
        PlanError::FirmwareTooOld { kind, needed, found } => Text::new("biss_plan.old_firmware")
            .with_text("what", kind_of(*kind))
            .with("needed", needed)
            .with("found", found),
        PlanError::ReadOnly { address } => Text::new("biss_plan.read_only").with("address", address),
        PlanError::Guarded { address } => Text::new("biss_plan.guarded").with("address", address),
        PlanError::ByteCount { range, count } => {
            Text::new("biss_plan.byte_count").with("range", range).with("count", count)
        }
        PlanError::NotBalanced { .. } => Text::new("biss_plan.not_balanced"),
        PlanError::DrivenByThisEncoder => Text::new("mounting_card.refused"),
    }
}

fn kind_of(kind: ProcedureKind) -> Text {
    Text::new(match kind {
        ProcedureKind::WiegandTest => "guide.wiegand",
        ProcedureKind::Calibration => "guide.calibration",
        ProcedureKind::DataWrite => "guide.data",
        ProcedureKind::FilterSelection => "guide.filter",
        ProcedureKind::Preset => "guide.store_preset",
    })
}

/// A write that is done.
pub fn written(written: &Written) -> Text {
    Text::new("review.verified").with("verified", written.verified).with("cycles", written.write_cycles)
}

/// A write that was cut off: how far it came, why, in which state the encoder was left, and where the state before is.
pub(super) fn interruption(interrupted: &Interrupted, backup: &Path, planned: usize, kind: ChangeKind) -> Vec<Text> {
    let done = &interrupted.done;
    let mut texts = vec![if interrupted.cause.is_cancelled() {
        Text::new("write.cancelled").with("done", done.ops).with("planned", planned)
    } else {
        let text = Text::new("write.interrupted").with("done", done.ops).with("planned", planned);
        text.with_text("cause", failure(&interrupted.cause))
    }];
    texts.extend(match &interrupted.left {
        Left::Operation => vec![Text::new("biss_left.operation")],
        Left::Unknown(standing) => left(standing),
    });
    // An operation that may have been carried out counts as a write cycle.
    let id = match kind {
        _ if done.write_cycles == 0 => "write.untouched",
        ChangeKind::Restore => "write.backup",
        ChangeKind::Bytes => "write.backup_bytes",
        ChangeKind::Guided | ChangeKind::Single => "write.backup_single",
    };
    texts.push(Text::new(id).with("backup", backup.display()));
    texts
}

/// In which state an encoder was left that could not be led back.
fn left(standing: &Standing) -> Vec<Text> {
    let modes: Vec<String> = standing.mode.values().iter().map(ToString::to_string).collect();
    let mut texts = vec![Text::new("biss_left.mode").with_list("modes", modes.iter().map(plain))];
    if standing.password.may_be(true) {
        texts.push(Text::new("biss_left.password"));
    }
    texts.extend(match standing.activity {
        Activity::Nothing => None,
        Activity::Running(run) if run.calibrates() => Some(Text::new("biss_left.calibrating")),
        Activity::Running(_) => Some(Text::new("biss_left.testing")),
        Activity::Entered => Some(Text::new("biss_left.entered")),
        Activity::Saving => Some(Text::new("biss_left.saving")),
        Activity::Restarting => Some(Text::new("biss_left.restarting")),
    });
    texts.push(Text::new("biss_left.lead_back"));
    texts
}

/// Why a procedure did not reach its end.
pub fn failure(failure: &Failure) -> Text {
    match failure {
        Failure::Device(error) => encoder(error),
        Failure::Calibration { run, status } => calibration(*run, *status),
        Failure::Wiegand { status, code, .. } => wiegand(*status, *code),
        Failure::NotBalanced { .. } => Text::new("biss_plan.not_balanced"),
        Failure::Mode { wanted, found } => Text::new("biss_failure.mode").with("wanted", wanted).with("found", found),
        Failure::Status { kind, expected, found } => Text::new("biss_failure.status")
            .with_text("what", kind_of(*kind))
            .with("expected", format!("{expected:02X}h"))
            .with("found", format!("{found:02X}h")),
        Failure::TooLong { seconds, .. } => Text::new("biss_failure.too_long").with("seconds", seconds),
        Failure::NotReady { task: asked, blockers } => Text::new("biss_failure.not_ready")
            .with_text("task", task(*asked))
            .with_list("why", blockers.iter().map(|own| blocker(*own))),
        Failure::NotVerified { item, expected, got } => {
            Text::new("biss_failure.not_verified").with("item", item).with("expected", expected).with("got", got)
        }
        Failure::NotDescribed { kind } => Text::new("biss_failure.not_described").with_text("what", kind_of(*kind)),
    }
}

fn calibration(run: Run, status: CalibrationStatus) -> Text {
    let why = match status {
        CalibrationStatus::WrongDirection => "biss_failure.direction",
        CalibrationStatus::Temperature => "biss_failure.temperature",
        CalibrationStatus::Speed => "biss_failure.speed",
        CalibrationStatus::Failed => "biss_failure.calibration",
        _ => return Text::new("biss_failure.unknown").with("status", status),
    };
    let id = if run.is_clockwise() { "biss_failure.table_lost" } else { "biss_failure.table_kept" };
    Text::new(id).with_text("why", Text::new(why))
}

fn wiegand(status: WiegandStatus, code: u8) -> Text {
    match status {
        WiegandStatus::WrongDirection => Text::new("biss_failure.direction"),
        WiegandStatus::Failed => Text::new("biss_failure.wiegand").with("code", format!("{code:02X}h")),
        _ => Text::new("biss_failure.unknown").with("status", status),
    }
}
