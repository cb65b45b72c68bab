//! Messages about a HIPERFACE encoder, such as job errors and status codes.

mod change;
mod check;
mod command;
mod damage;
mod format;
mod frame;
mod items;
mod job_step;
mod label;
mod op;
#[cfg(test)]
mod phrases;
mod types;

use std::path::Path;

use crate::devices::hiperface::state::TEXTS;

pub use change::{change_text, edit_error_text};
pub use check::{check_lines, line_quality};
pub use command::command_text;
pub use damage::damage_text;
pub use format::{
    field_access, field_code_required, field_status, geometry_text, line_settings, position_text, raw_position_text,
    status_code_name, status_with_number,
};
pub use frame::detail_text;
pub use items::{field_range, item_text, plan_item_text, read_back, rejection_text};
pub use job_step::step_text;
pub use label::{LabelRow, label_rows};
pub use op::operation_texts;
pub use types::{open_error_text, table_error_text};

use crate::app::Text;
use crate::app::explain::{link_error_text, not_started_text};
use crate::devices::hiperface::jobs::{ChangeKind, JobError, TypeMismatch};
use crate::devices::hiperface::procedures::Error;
use crate::devices::hiperface::procedures::write::{InterruptedWrite, WrittenChanges};
use crate::devices::hiperface::profile::{PlanError, RequiredSetup, UnknownMeaningField};
use crate::devices::hiperface::protocol::{EncoderTypes, StatusCode};

/// Returns one or more messages for a job that ended early.
pub fn job_error_texts(error: &JobError) -> Vec<Text> {
    match error {
        JobError::Device(error) => vec![encoder_error_text(error)],
        JobError::Plan(error) => vec![plan_error_text(error)],
        JobError::NotStarted(why) => vec![not_started_text(why)],
        JobError::Interrupted { interrupted, backup, planned, kind } => {
            interruption_text(interrupted, backup, *planned, *kind)
        }
    }
}

/// Returns the messages for an interrupted write: its progress, its result and the location of the backup.
pub fn interruption_text(interrupted: &InterruptedWrite, backup: &Path, planned: usize, kind: ChangeKind) -> Vec<Text> {
    let done = &interrupted.done;
    let mut texts = vec![match &interrupted.cause {
        Error::Cancelled => Text::new("write.cancelled").with("done", done.ops).with("planned", planned),
        cause => {
            let text = Text::new("write.interrupted").with("done", done.ops).with("planned", planned);
            text.with_text("cause", encoder_error_text(cause))
        }
    }];
    if !interrupted.end_state.unlocked.is_empty() {
        let fields: Vec<String> = interrupted.end_state.unlocked.iter().map(ToString::to_string).collect();
        texts.push(TEXTS.text("write.left_unlocked").with("fields", fields.join(", ")));
    }
    // An operation with an unknown result is counted as a write cycle.
    let id = match kind {
        _ if done.write_cycles == 0 => "write.untouched",
        ChangeKind::Restore => "write.backup",
        ChangeKind::Bytes => "write.backup_bytes",
        ChangeKind::Single => "write.backup_single",
    };
    texts.push(TEXTS.text(id).with("backup", backup.display()));
    texts
}

/// Returns the reason why the connection was lost, or `None` if the connection can still be used.
pub fn connection_loss_text(error: &JobError) -> Option<Text> {
    match error.device()? {
        Error::Link(error) => Some(link_error_text(error)),
        _ => None,
    }
}

/// Returns the message for a completed write. If nothing was read back, it only states that the encoder has
/// acknowledged the write.
pub fn written_text(written: &WrittenChanges) -> Text {
    let id = if written.verified == 0 { "session.acknowledged" } else { "session.written" };
    TEXTS.text(id).with("cycles", written.write_cycles)
}

/// Returns the message that ends the review of a completed write.
pub fn verified_text(written: &WrittenChanges) -> Text {
    match written.verified {
        0 => Text::new("session.acknowledged").with("cycles", written.write_cycles),
        verified => Text::new("review.verified").with("verified", verified).with("cycles", written.write_cycles),
    }
}

pub fn encoder_error_text(error: &Error) -> Text {
    match error {
        Error::Link(error) => link_error_text(error),
        Error::NoReply { address, command, tries, echo_heard } => {
            let id = if *echo_heard { "encoder.echo_only" } else { "encoder.no_reply" };
            TEXTS
                .text(id)
                .with("address", format!("{address:02X}h"))
                .with_text("command", command::command_text(*command))
                .with("tries", tries)
        }
        Error::Damaged { command, tries, cause } => {
            let text = TEXTS
                .text("encoder.damaged")
                .with_text("command", command::command_text(*command))
                .with("tries", tries);
            text.with_text("why", damage_text(cause))
        }
        Error::NeverSilent => TEXTS.text("encoder.never_silent"),
        Error::Rejected { command, codes } => {
            let code_needed = codes.contains(&StatusCode::WRONG_CODE);
            let id = if code_needed { "encoder.rejected_code" } else { "encoder.rejected" };
            let codes = codes.iter().copied().map(status_with_number);
            TEXTS.text(id).with_text("command", command::command_text(*command)).with_list("codes", codes)
        }
        Error::Unclear { command, cause } => TEXTS
            .text("encoder.unclear")
            .with_text("command", command::command_text(*command))
            .with_text("cause", encoder_error_text(cause)),
        Error::Cancelled => Text::new("encoder.cancelled"),
        Error::Moving { readings } => {
            let words: Vec<String> = readings.iter().map(ToString::to_string).collect();
            TEXTS.text("encoder.moving").with("readings", words.join(", "))
        }
        Error::NotAKit { encoder } => TEXTS.text("encoder.not_a_kit").with("encoder", encoder),
        Error::AddressTaken { address } => {
            TEXTS.text("encoder.address_taken").with("address", format!("{address:02X}h"))
        }
        Error::PositionRange { wanted, last } => {
            TEXTS.text("encoder.position_range").with("wanted", wanted).with("last", last)
        }
        Error::OutOfField { field, address, count, size } => {
            out_of_field_text(*field, size.saturating_sub(1), *address, *count)
        }
        Error::CodeUnknown { field, number } => unknown_code_text(*field, number),
        Error::Changed { item } => TEXTS.text("encoder.changed").with_text("item", plan_item_text(item)),
        Error::NotVerified { item, expected, got } => TEXTS
            .text("encoder.not_verified")
            .with_text("item", plan_item_text(item))
            .with("expected", expected)
            .with_text("got", read_back(got)),
        Error::OtherReply { command, reply } => {
            TEXTS.text("encoder.other_reply").with_text("command", command::command_text(*command)).with("reply", reply)
        }
        Error::PositionUnchanged => TEXTS.text("encoder.position_unchanged"),
        Error::CodeGuardsNothing { number } => TEXTS.text("encoder.code_guards_nothing").with("number", number),
        Error::ReservedFormat { settings } => {
            TEXTS.text("encoder.reserved_format").with("settings", format!("0x{:02X}", settings.byte()))
        }
    }
}

/// Returns the name of a value that must be set up again.
pub fn required_setup_text(redo: &RequiredSetup) -> Text {
    match redo {
        RequiredSetup::Commutation => TEXTS.text("redo.commutation"),
        RequiredSetup::Value(range) => field_range(range),
    }
}

/// Returns the message for a data field that contains bytes of unknown meaning.
pub fn unknown_field(field: &UnknownMeaningField) -> Text {
    let id = if field.bytes == 1 { "review.unknown_field_one" } else { "review.unknown_field" };
    TEXTS.text(id).with("field", field.field).with("bytes", field.bytes)
}

/// Returns the message for created fields that an undo has not deleted, or `None` if there are none.
pub fn remaining_fields_text(fields: &[u8]) -> Option<Text> {
    let numbers: Vec<String> = fields.iter().map(ToString::to_string).collect();
    (!fields.is_empty()).then(|| TEXTS.text("review.created_left").with("fields", numbers.join(", ")))
}

pub fn unanswered_codes(count: u32) -> Text {
    TEXTS.text("status.unheard").with("count", count)
}

/// Returns the message for a profile from another type of encoder.
pub fn other_type(types: TypeMismatch) -> Text {
    let TypeMismatch { profile, device } = types;
    TEXTS.text("review.other_type").with("profile", type_name(profile)).with("device", type_name(device))
}

/// Returns the name and the code of an encoder type, or only the code if the type is unknown.
fn type_name(code: u8) -> String {
    match EncoderTypes::built_in().find(code) {
        Some(own) => format!("{} ({code:02X}h)", own.name),
        None => format!("{code:02X}h"),
    }
}

pub fn plan_error_text(error: &PlanError) -> Text {
    match error {
        PlanError::OtherDevice { profile, device } => {
            let named = |number: &str| if number.is_empty() { "–".to_owned() } else { number.to_owned() };
            Text::new("plan.other_device").with("profile", named(profile)).with("device", named(device))
        }
        PlanError::TypeMismatch { profile, device } => {
            TEXTS.text("plan.other_type").with("profile", type_name(*profile)).with("device", type_name(*device))
        }
        PlanError::SizeFixed { field, profile, device } => {
            TEXTS.text("plan.size_fixed").with("field", field).with("profile", profile).with("device", device)
        }
        PlanError::Gap { field, missing } => TEXTS.text("plan.gap").with("field", field).with("missing", missing),
        PlanError::NoMemory { needed, free } => TEXTS.text("plan.no_memory").with("needed", needed).with("free", free),
        PlanError::WouldLose { field, code } => TEXTS.text("plan.would_lose").with("field", field).with("code", code),
        PlanError::NotNext { field, next } => TEXTS.text("plan.not_next").with("field", field).with("next", next),
        PlanError::NotLast { field, last } => TEXTS.text("plan.not_last").with("field", field).with("last", last),
        PlanError::NoSuchField { field, count: 0 } => TEXTS.text("encoder.no_fields").with("field", field),
        PlanError::NoSuchField { field, count } => {
            TEXTS.text("encoder.no_field").with("field", field).with("count", count).with("last", count - 1)
        }
        PlanError::WriteProtected { field } => TEXTS.text("plan.write_protected").with("field", field),
        PlanError::OutOfField { field, last, start, count } => out_of_field_text(*field, *last, *start, *count),
        PlanError::CodeUnknown { field, code } => unknown_code_text(*field, code),
    }
}

/// Returns the message for an access to bytes beyond the end of a field.
pub fn out_of_field_text(field: u8, last: usize, start: usize, count: usize) -> Text {
    let text = TEXTS.text(if count == 1 { "encoder.out_of_field_one" } else { "encoder.out_of_field" });
    text.with("field", field).with("last", last).with("start", start).with("count", count)
}

fn unknown_code_text(field: u8, number: impl ToString) -> Text {
    TEXTS.text("encoder.code_unknown").with("field", field).with("number", number)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::Language;
    use crate::devices::hiperface::procedures::write::EndState;
    use crate::link::{LinkError, LinkErrorKind};

    fn cut_off(cause: Error, write_cycles: u64) -> InterruptedWrite {
        let ops = usize::try_from(write_cycles).unwrap();
        let done = WrittenChanges { ops, write_cycles, ..WrittenChanges::default() };
        InterruptedWrite { done, unfinished: None, cause, end_state: EndState::default() }
    }

    #[test]
    fn interrupted_write_remedy_matches_kind() {
        let path = Path::new("b.ron");
        let words = |cycles, kind| {
            let texts = interruption_text(&cut_off(Error::Cancelled, cycles), path, 4, kind);
            texts.last().unwrap().to_string_in(Language::English)
        };
        let cases = [
            (
                ChangeKind::Restore,
                "To complete the write, restore the profile again",
                "To complete the write, restore the profile again",
            ),
            (ChangeKind::Bytes, "are kept as edits", "Run the command again to complete the write"),
            (ChangeKind::Single, "repeat the change", "run the command again if necessary"),
        ];
        for (kind, part, terminal) in cases {
            let cut = |cycles| {
                interruption_text(&cut_off(Error::Cancelled, cycles), path, 4, kind).pop().unwrap().terminal_text()
            };
            assert!(words(2, kind).contains(part), "{}", words(2, kind));
            assert!(words(0, kind).contains("Nothing was changed."), "{}", words(0, kind));
            assert!(cut(2).contains(terminal) && cut(2).contains("b.ron"), "{}", cut(2));
            assert!(cut(0).contains("Nothing was changed") && cut(0).contains("b.ron"), "{}", cut(0));
        }
    }

    #[test]
    fn reports_line_loss_during_write() {
        let gone = || Error::Link(LinkError::new("COM3", LinkErrorKind::Lost));
        let interrupted = Box::new(cut_off(gone(), 1));
        let backup = Path::new("b.ron").to_owned();
        let error = JobError::Interrupted { interrupted, backup, planned: 4, kind: ChangeKind::Restore };
        assert_eq!(connection_loss_text(&error).unwrap().id(), "link.lost");
        assert_eq!(connection_loss_text(&JobError::Device(gone())).unwrap().id(), "link.lost");
        assert_eq!(connection_loss_text(&JobError::Device(Error::NeverSilent)), None);
    }

    #[test]
    fn access_code_is_not_read_back() {
        let of = |verified| WrittenChanges { ops: 1, written: 1, verified, write_cycles: 1 };
        assert!(verified_text(&of(3)).to_string_in(Language::English).starts_with("Read back and verified"));
        for text in [written_text(&of(0)), verified_text(&of(0))] {
            assert_eq!(text.id(), "session.acknowledged");
        }
        assert_eq!(written_text(&of(1)).id(), "session.written");
    }
}
