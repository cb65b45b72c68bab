//! Messages about writes: changes, operations of a plan, planning errors, warnings, results and interruptions.

use std::path::Path;

use super::check::{source_text, switch_text};
use super::error::{device_error_text, out_of_range};
use super::names::{parameter_name_text, variant_text};
use crate::app::Text;
use crate::app::explain::literal_text;
use crate::app::review::OperationDescription;
use crate::devices::hiperdrive::jobs::{Change, ChangeKind};
use crate::devices::hiperdrive::procedures::write::{InterruptedWrite, WrittenChanges};
use crate::devices::hiperdrive::profile::{Item, NetworkSettings, Op, PlanError, Service, TypeMismatch, Warning};
use crate::devices::hiperdrive::protocol::DriveNumber;
use crate::devices::hiperdrive::state::TEXTS;
use crate::devices::hiperdrive::state::network::address_error_text;

pub fn change_text(change: &Change) -> Text {
    match change {
        Change::Restore { profile, .. } => match profile.identity.serial_number.as_str() {
            "" => Text::new("ib_change.restore"),
            serial => Text::new("change.restore").with("serial", serial),
        },
        Change::Write(_) => TEXTS.text("hd_change.write"),
        Change::Try(_) => TEXTS.text("hd_change.try"),
        Change::SetPosition { drive, position, .. } => {
            TEXTS.text("hd_change.position").with("drive", drive.get()).with("position", position)
        }
        Change::Do(own) => service_text(*own),
        Change::Network(_) => TEXTS.text("hd_change.network"),
    }
}

pub fn service_text(service: Service) -> Text {
    match service {
        Service::Save => TEXTS.text("hd_service.save"),
        Service::Recall => TEXTS.text("hd_service.recall"),
        Service::Factory => TEXTS.text("hd_service.factory"),
        Service::FactoryAll => TEXTS.text("hd_service.factory_all"),
        Service::Reset => TEXTS.text("hd_service.reset"),
        Service::Acknowledge(drive) => TEXTS.text("hd_service.acknowledge").with("drive", drive.get()),
    }
}

pub fn operation_texts(op: &Op) -> OperationDescription {
    match op {
        Op::Write { number, old, new } => {
            let old = old.map_or_else(|| TEXTS.text("hd_op.unknown"), literal_text);
            OperationDescription::single(item_text(Item(*number)), old, literal_text(new))
        }
        Op::Service(own) => {
            let (before, after) = match own {
                Service::Save => ("hd_op.unsaved", "hd_op.saved"),
                Service::Recall => ("hd_op.as_now", "hd_op.as_saved"),
                Service::Factory | Service::FactoryAll => ("hd_op.as_now", "hd_op.as_delivered"),
                Service::Reset => ("hd_op.as_now", "hd_op.restarted"),
                Service::Acknowledge(_) => ("hd_op.fault", "hd_op.acknowledged"),
            };
            OperationDescription::single(service_text(*own), TEXTS.text(before), TEXTS.text(after))
        }
        Op::Network { from, to } => {
            OperationDescription::single(TEXTS.text("hd_op.network"), network_text(from), network_text(to))
        }
    }
}

fn network_text(settings: &NetworkSettings) -> Text {
    let NetworkSettings { source: own, interface } = settings;
    TEXTS
        .text("hd_op.addresses")
        .with_text("source", source_text(*own))
        .with("address", interface.address)
        .with("mask", interface.mask)
        .with("gateway", interface.gateway)
}

/// Returns the name of a parameter with its number, including the drive number if it is not drive 1.
pub fn item_text(item: Item) -> Text {
    let text = match item.0.drive() {
        None | Some(DriveNumber::FIRST) => TEXTS.text("hd_op.parameter").with("number", item),
        Some(drive) => {
            TEXTS.text("hd_op.parameter_of").with("number", item.0.drive1_number()).with("drive", drive.get())
        }
    };
    text.with_text("name", parameter_name_text(item.0))
}

pub fn other_type(types: &TypeMismatch) -> Text {
    type_mismatch_text(types, "hd_review.other_kind", "hd_review.other_variant")
}

fn type_mismatch_text(types: &TypeMismatch, whole: &'static str, of_drive: &'static str) -> Text {
    match types {
        TypeMismatch::Device { profile, device } => {
            TEXTS.text(whole).with("profile", profile.category()).with("device", device.category())
        }
        TypeMismatch::Drive { drive, profile, device } => TEXTS
            .text(of_drive)
            .with("drive", drive.get())
            .with_text("profile", variant_text(*profile))
            .with_text("device", variant_text(*device)),
    }
}

/// Explains why a plan cannot be made. In this case, nothing has been written.
pub fn plan_error_text(error: &PlanError) -> Text {
    match error {
        PlanError::OtherDevice { profile, device } => {
            TEXTS.text("hd_plan.other_device").with("profile", profile).with("device", device)
        }
        PlanError::OtherDrive { drive, profile, device } => {
            TEXTS.text("hd_plan.other_drive").with("drive", drive.get()).with("profile", profile).with("device", device)
        }
        PlanError::TypeMismatch(types) => type_mismatch_text(types, "hd_plan.other_kind", "hd_plan.other_variant"),
        PlanError::OutOfRange(error) => out_of_range(error),
        PlanError::ReadOnly { item } => text_about("hd_said.read_only", *item),
        PlanError::Moves { item } => text_about("hd_said.motion", *item),
        PlanError::Acts { item } => text_about("hd_plan.acts", *item),
        PlanError::NotRead { item } => text_about("hd_plan.not_read", *item),
        PlanError::LimitsCrossed { drive, lower, upper } => {
            TEXTS.text("hd_plan.crossed").with("drive", drive.get()).with("lower", lower).with("upper", upper)
        }
        PlanError::PositionOutside { drive, position, lower, upper } => TEXTS
            .text("hd_plan.outside")
            .with("drive", drive.get())
            .with("position", position)
            .with("lower", lower)
            .with("upper", upper),
        PlanError::PositionTooLarge { drive, position } => {
            TEXTS.text("hd_plan.too_large").with("drive", drive.get()).with("position", position)
        }
        PlanError::ReferenceOutside { drive, position, becomes, lower, upper } => TEXTS
            .text("hd_plan.reference_outside")
            .with("drive", drive.get())
            .with("position", position)
            .with("becomes", becomes)
            .with("lower", lower)
            .with("upper", upper),
        PlanError::Address(why) => TEXTS.text("hd_plan.address").with_text("why", address_error_text(why)),
        PlanError::Source(method) => TEXTS.text("hd_plan.source").with("method", method),
    }
}

fn text_about(id: &'static str, item: Item) -> Text {
    TEXTS.text(id).with("number", item).with_text("name", parameter_name_text(item.0))
}

pub fn warning_text(warning: &Warning) -> Text {
    match warning {
        Warning::LimitsMove { drive, now, then } => TEXTS
            .text("hd_warning.limits_move")
            .with("drive", drive.get())
            .with_number("lower_now", now.0, 2)
            .with_number("upper_now", now.1, 2)
            .with_number("lower_then", then.0, 2)
            .with_number("upper_then", then.1, 2),
        Warning::AfterReset(own) => TEXTS.text("hd_warning.after_reset").with_text("item", item_text(*own)),
        Warning::NoTimeout(drive) => TEXTS.text("hd_warning.no_timeout").with("drive", drive.get()),
        Warning::NotRequested(drive) => TEXTS.text("hd_warning.not_requested").with("drive", drive.get()),
        Warning::SwitchDecides(own) => TEXTS.text("hd_warning.switch").with_text("switch", switch_text(*own)),
    }
}

pub fn written_text(written: &WrittenChanges) -> Text {
    // A service of the device cannot be read back.
    let id = if written.verified == 0 { "biss_review.done" } else { "review.verified" };
    TEXTS.text(id).with("verified", written.verified).with("cycles", written.write_cycles)
}

pub(super) fn interruption_text(
    interrupted: &InterruptedWrite,
    backup: &Path,
    planned: usize,
    kind: ChangeKind,
) -> Vec<Text> {
    let (InterruptedWrite { done, cause, .. }, unclear) = (interrupted, interrupted.uncertain_write());
    let mut texts = vec![if cause.is_cancelled() {
        Text::new("write.cancelled").with("done", done.ops).with("planned", planned)
    } else {
        let text = Text::new("write.interrupted").with("done", done.ops).with("planned", planned);
        text.with_text("cause", device_error_text(cause))
    }];
    if let Some(item) = &unclear {
        texts.push(TEXTS.text("hd_left.unclear").with("item", item));
    }
    let untouched = done.written == 0 && done.write_cycles == 0 && unclear.is_none();
    if !untouched && done.write_cycles == 0 && done.written > 0 {
        texts.push(TEXTS.text("hd_left.unsaved"));
    }
    let what_next = match kind {
        _ if untouched => "write.untouched",
        ChangeKind::Restore => "write.backup",
        ChangeKind::Edits => "ib_left.edits",
        ChangeKind::Try | ChangeKind::Position | ChangeKind::Service(_) | ChangeKind::Network => "hd_left.again",
    };
    texts.push(TEXTS.text(what_next).with("backup", backup.display()));
    texts
}
