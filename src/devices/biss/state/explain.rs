//! Messages for a BiSS encoder: job errors and session messages.

mod check;
mod damage;
mod description_error;
mod entry;
mod guide;
#[cfg(test)]
mod phrases;
mod plan;
mod write;

use crate::devices::biss::state::TEXTS;
pub use check::{check_lines, flag_text};
pub use damage::damage_text;
pub use entry::entry_error_text;
pub use guide::{
    advice_text, blocker_text, calibration_requirements_text, mode_text, outcome_texts, procedure_step_text,
    procedure_text, report_lines, task_text, wiegand_requirements_text,
};
pub use plan::{other_type, plan_error_text};
pub use write::{
    change_text, failure_text, operation_texts, preset_value_text, severity_of, wear_warning, written_text,
};

use crate::app::Text;
use crate::app::explain::{self as general, link_error_text, not_started_text, syntax_error_text};
use crate::buses::bridge::state::adapter_error_text;
use crate::devices::biss::jobs::{DeviceMessage, JobError, JobStep};
use crate::devices::biss::procedures::{Error, RequestedItem};
use crate::devices::biss::profile::BissProfile;
use crate::devices::biss::protocol::{CrcError, DescriptionError, DeviceMode, IdentityMismatch, LayoutError, Name};
use crate::link::LinkError;
use crate::store::StoreError;

pub fn name_text(name: &Name) -> Text {
    Text::new("plain.words").with_name("words", name.english(), name.german())
}

/// Returns messages about a failed or interrupted job. They can be shown on separate lines.
pub fn job_error_texts(error: &JobError) -> Vec<Text> {
    match error {
        JobError::Device(error) => vec![encoder_error_text(error)],
        JobError::Plan(error) => vec![plan_error_text(error)],
        JobError::NotStarted(why) => vec![not_started_text(why)],
        JobError::Interrupted { interrupted, backup, planned, kind } => {
            write::interruption_text(interrupted, backup, *planned, *kind)
        }
    }
}

/// Returns the reason why the connection was lost, or `None` if the connection can still be used.
pub fn connection_loss_text(error: &JobError) -> Option<Text> {
    lost_link(error.device()?).map(link_error_text)
}

fn lost_link(error: &Error) -> Option<&LinkError> {
    match error {
        Error::Link(error) => Some(error),
        Error::Unclear { cause, .. } => lost_link(cause),
        _ => None,
    }
}

pub fn encoder_error_text(error: &Error) -> Text {
    match error {
        Error::Link(error) => link_error_text(error),
        Error::Adapter(error) => adapter_error_text(error),
        Error::NoReply { requested, tries, echo_heard } => {
            let id = if *echo_heard { "biss.echo_only" } else { "biss.no_reply" };
            TEXTS.text(id).with_text("asked", self::item_text(*requested)).with("tries", tries)
        }
        Error::Damaged { requested, tries, cause } => TEXTS
            .text("biss.damaged")
            .with_text("asked", self::item_text(*requested))
            .with("tries", tries)
            .with_text("why", damage_text(cause)),
        Error::NeverSilent => TEXTS.text("biss.never_silent"),
        Error::NoAcknowledge { tries, supply_off: false } => TEXTS.text("biss.no_acknowledge").with("tries", tries),
        Error::NoAcknowledge { tries, supply_off: true } => TEXTS.text("biss.supply_off").with("tries", tries),
        Error::StuckLow { tries } => TEXTS.text("biss.stuck_low").with("tries", tries),
        Error::StuckHigh { tries } => TEXTS.text("biss.stuck_high").with("tries", tries),
        Error::WrongWidths { frames, data_bits, crc_bits } => {
            TEXTS.text("biss.wrong_widths").with("frames", frames).with("data", data_bits).with("crc", crc_bits)
        }
        Error::WidthsUnknown { moving } => {
            TEXTS.text(if *moving { "biss.widths_unknown" } else { "biss.widths_at_rest" })
        }
        Error::NoSuchRegister { address } => TEXTS.text("biss.no_such_register").with("address", address),
        Error::NotWatched { address } => TEXTS.text("biss.not_watched").with("address", address),
        Error::Refused { address, value, reads } => {
            let id = if reads.is_some() { "biss.refused_reads" } else { "biss.refused" };
            let reads = reads.map(format_byte).unwrap_or_default();
            TEXTS.text(id).with("address", address).with("value", format_byte(*value)).with("reads", reads)
        }
        Error::Unclear { address, value, cause } => TEXTS
            .text("biss.unclear")
            .with("address", address)
            .with("value", format_byte(*value))
            .with_text("cause", encoder_error_text(cause)),
        Error::Cancelled => Text::new("encoder.cancelled"),
        Error::OrderUnknown { answer } => TEXTS.text("biss.order_unknown").with("answer", format_byte(*answer)),
        Error::TooWide { word, multiturn, singleturn } => TEXTS
            .text("biss.too_wide")
            .with("word", format!("0x{word:X}"))
            .with("multiturn", multiturn)
            .with("singleturn", singleturn),
        Error::OutOfRange { start, count } => TEXTS.text("biss.out_of_range").with("start", start).with("count", count),
        Error::NoDescription(found) => TEXTS.text("biss.no_description").with("found", found),
        Error::NotIdentified => TEXTS.text("biss.not_identified"),
        Error::Moving { rpm } => moving_text(*rpm),
        Error::NotInOperation { mode } => in_mode("biss.not_in_operation", *mode),
        Error::Changed { item } => TEXTS.text("biss.changed").with("item", item),
        Error::OtherReply { requested, reply } => {
            TEXTS.text("biss.other_reply").with_text("asked", self::item_text(*requested)).with("reply", reply)
        }
        Error::FrameStatus { status } => TEXTS.text("biss.frame_status").with("status", format_byte(*status)),
        Error::Layout(error) => layout_error_text(error),
        Error::TooFewRegisters { start, expected, got } => {
            TEXTS.text("biss.too_few").with("start", start).with("expected", expected).with("got", got)
        }
        Error::StaysUnlocked { mode } => in_mode("biss.stays_unlocked", *mode),
    }
}

fn layout_error_text(error: &LayoutError) -> Text {
    let hex = |number: u64| format!("{number:#X}");
    match *error {
        LayoutError::Field { field, bits } => TEXTS.text("biss.layout_field").with("field", field).with("bits", bits),
        LayoutError::Empty => TEXTS.text("biss.layout_empty"),
        LayoutError::Long(bits) => TEXTS.text("biss.layout_long").with("bits", bits),
        LayoutError::Crc(CrcError::Degree(polynomial)) => {
            TEXTS.text("biss.crc_degree").with("polynomial", hex(polynomial))
        }
        LayoutError::Crc(CrcError::LowestTerm(polynomial)) => {
            TEXTS.text("biss.crc_lowest").with("polynomial", hex(polynomial))
        }
        LayoutError::Crc(CrcError::Start { start, width }) => {
            TEXTS.text("biss.crc_start").with("start", hex(start.into())).with("width", width)
        }
    }
}

/// Returns the warning for a device mode in which registers may show values that were never saved.
pub fn unsaved_warning(mode: DeviceMode) -> Text {
    in_mode("biss.unsaved", mode)
}

/// Returns a warning if a profile that was just saved may contain values that the encoder never saved. Returns `None`
/// if it was read in operation mode.
pub fn unsaved_profile_warning(profile: &BissProfile) -> Option<Text> {
    profile.recorded.device_mode.map(unsaved_warning)
}

/// Returns a message if a profile was read in a device mode, or `None` if it was read in operation mode.
pub fn profile_unsaved(profile: &BissProfile) -> Option<Text> {
    profile.recorded.device_mode.map(unsaved_profile_text_for_mode)
}

/// Returns the message for a profile that was read in the given device mode.
pub fn unsaved_profile_text_for_mode(mode: DeviceMode) -> Text {
    in_mode("biss.profile_unsaved", mode)
}

fn in_mode(id: &'static str, mode: DeviceMode) -> Text {
    TEXTS.text(id).with_text("mode", self::mode_text(mode))
}

fn moving_text(rpm: Option<f64>) -> Text {
    let Some(rpm) = rpm.filter(|rpm| rpm.abs() >= 0.05) else { return TEXTS.text("biss.moving") };
    let id = if rpm > 0.0 { "biss.moving_cw" } else { "biss.moving_ccw" };
    TEXTS.text(id).with_number("rpm", rpm.abs(), if rpm.abs() < 10.0 { 1 } else { 0 })
}

pub fn item_text(requested: RequestedItem) -> Text {
    match requested {
        RequestedItem::Read(address) => TEXTS.text("biss.asked_read").with("address", address),
        RequestedItem::Write(address, value) => {
            TEXTS.text("biss.asked_write").with("address", address).with("value", format_byte(value))
        }
        RequestedItem::Position => TEXTS.text("biss.asked_position"),
    }
}

/// Returns the message for an encoder that differs from the closest description.
pub fn mismatch_text(mismatch: &IdentityMismatch) -> Text {
    TEXTS
        .text("biss.mismatch")
        .with("found", &mismatch.found)
        .with("name", &mismatch.name)
        .with("expected", &mismatch.expected)
}

/// Returns the lines to display for a message from a job.
pub fn message_texts(remark: &DeviceMessage) -> Vec<Text> {
    match remark {
        DeviceMessage::CrcErrors(1) => vec![TEXTS.text("biss.crc_error")],
        DeviceMessage::CrcErrors(count) => vec![TEXTS.text("biss.crc_errors").with("count", count)],
        DeviceMessage::Descriptions(errors) => errors.iter().map(description_error_text).collect(),
    }
}

/// Returns the message for a user-defined description that cannot be read or used.
fn description_error_text(error: &StoreError) -> Text {
    let StoreError::Refused(cause) = error else { return general::store_error_text(error) };
    match cause.get::<DescriptionError>() {
        Some(DescriptionError { file, line, column, problem: what }) => TEXTS
            .text("store.description")
            .with("path", file)
            .with_text("why", syntax_error_text(*line, *column, description_error::description_problem_text(what))),
        None => general::store_error_text(error),
    }
}

pub fn step_text(job_step: &JobStep) -> Text {
    match job_step {
        JobStep::Register(address) => TEXTS.text("biss.register").with("address", address),
        JobStep::Bank(bank) => TEXTS.text("biss.bank").with("bank", format!("0x{bank:02X}")),
        JobStep::Operation { progress: news, .. } => procedure_step_text(news.step),
    }
}

fn format_byte(byte: u8) -> String {
    format!("0x{byte:02X}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::Language::{English, German};
    use crate::buses::bridge::procedures::AdapterError;
    use crate::devices::biss::procedures::ReplyDamage;
    use crate::devices::biss::protocol::{Identity, ProfileId, RegisterAddress};
    use crate::link::LinkErrorKind;

    #[test]
    fn errors_show_cause_and_remedy() {
        let address: RegisterAddress = "0x24:0x10".parse().unwrap();
        let requested = RequestedItem::Read(address);
        let kind = Identity { profile: ProfileId::new(0x6129), manufacturer: *b"Fr", device_id: [1, 2, 3, 4, 5, 6] };
        let cases = [
            (Error::NoReply { requested, tries: 5, echo_heard: false }, vec!["0x24:0x10", "5"]),
            (Error::NoReply { requested, tries: 5, echo_heard: true }, vec!["0x24:0x10", "5"]),
            (Error::Damaged { requested, tries: 5, cause: ReplyDamage::Inconsistent }, vec!["0x24:0x10", "5"]),
            (Error::NeverSilent, vec![]),
            (Error::NoAcknowledge { tries: 5, supply_off: false }, vec!["MA", "SLO"]),
            (Error::NoAcknowledge { tries: 5, supply_off: true }, vec!["voltage="]),
            (Error::StuckLow { tries: 5 }, vec!["SLO"]),
            (Error::StuckHigh { tries: 5 }, vec!["SLO"]),
            (Error::WrongWidths { frames: 21, data_bits: 27, crc_bits: 6 }, vec!["21", "27 ", " 6 "]),
            (Error::WidthsUnknown { moving: true }, vec!["10", "48"]),
            (Error::WidthsUnknown { moving: false }, vec![]),
            (Error::NoSuchRegister { address }, vec!["0x24:0x10"]),
            (Error::NotWatched { address }, vec!["0x24:0x10"]),
            (Error::Refused { address, value: 7, reads: None }, vec!["0x24:0x10", "0x07"]),
            (Error::Refused { address, value: 7, reads: Some(1) }, vec!["0x24:0x10", "0x07", "0x01"]),
            (Error::Unclear { address, value: 7, cause: Box::new(Error::NeverSilent) }, vec!["0x24:0x10", "0x07"]),
            (Error::OrderUnknown { answer: 3 }, vec!["0x03", "order="]),
            (Error::TooWide { word: 0x2_0000, multiturn: 0, singleturn: 17 }, vec!["0x20000", " 0 ", " 17 "]),
            (Error::OutOfRange { start: address, count: 70_000 }, vec!["0x24:0x10", "70000"]),
            (Error::Moving { rpm: Some(-499.6) }, vec!["500"]),
            (Error::Moving { rpm: None }, vec![]),
            (Error::NoDescription(kind), vec!["0x6129"]),
            (Error::NotIdentified, vec![]),
            (Error::Adapter(AdapterError::Silent), vec![]),
            (Error::Adapter(AdapterError::Version { expected: 1, got: 2 }), vec!["1", "2"]),
        ];
        for (error, facts) in cases {
            for language in [English, German] {
                let words = encoder_error_text(&error).to_string_in(language);
                assert!(facts.iter().all(|fact| words.contains(fact)), "{words}");
                assert!(words.trim_end_matches('.').contains(['.', ';', ':']), "{words}");
                assert!(!words.contains('{') && words.ends_with('.'), "{words}");
            }
            assert_ne!(
                encoder_error_text(&error).to_string_in(English),
                encoder_error_text(&error).to_string_in(German)
            );
        }
    }

    #[test]
    fn distinguishes_lost_link_from_other_errors() {
        let gone = Error::Link(LinkError::new("COM3", LinkErrorKind::Lost));
        let address = RegisterAddress::BANK_SELECT;
        let unclear = Error::Unclear { address, value: 1, cause: Box::new(gone.clone()) };
        for error in [gone, unclear] {
            assert_eq!(connection_loss_text(&JobError::Device(error)).unwrap().id(), "link.lost");
        }
        assert_eq!(connection_loss_text(&JobError::Device(Error::NeverSilent)), None);
        assert_eq!(job_error_texts(&JobError::Device(Error::NeverSilent)).len(), 1);
    }
}
