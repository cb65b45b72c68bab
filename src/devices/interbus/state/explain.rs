//! Explains job errors and device messages of an INTERBUS encoder.

mod check;
mod entry;
mod gateway;
mod item;
#[cfg(test)]
mod phrases;
mod write;

use crate::devices::interbus::state::TEXTS;
pub use check::check_lines;
pub use entry::entry_error_text;
pub use gateway::{damage_text, exception_text};
pub use item::{cam_mask_text, direction_text, parameter_text, read_out, startup_mode_text};
pub use write::{change_text, operation_texts, other_type, plan_error_text, severity_of, wear_warning, written_text};

use crate::app::Text;
use crate::app::explain::{link_error_text, literal_text};
use crate::devices::interbus::jobs::{JobError, JobStep};
use crate::devices::interbus::procedures::{Error, ExpectedWord, ImplausibleValue, LeftState};
use crate::devices::interbus::protocol::{ErrorWord, GearError, Reply};
use crate::link::LinkError;

/// Returns the lines of text that explain why a job ended early.
pub fn job_error_texts(error: &JobError) -> Vec<Text> {
    match error {
        JobError::Device(error) => vec![encoder_error_text(error)],
        JobError::Plan(error) => vec![plan_error_text(error)],
        JobError::NotStarted(why) => vec![write::not_started_text(why)],
        JobError::Interrupted { interrupted, backup, planned, kind } => {
            write::interruption_text(interrupted, backup, *planned, *kind)
        }
    }
}

/// Returns why the connection was lost, or `None` if it can still be used.
pub fn connection_loss_text(error: &JobError) -> Option<Text> {
    lost_link(error.device()?).map(link_error_text)
}

/// Returns whether the link is open but the gateway does not reply.
pub fn is_no_response(error: &JobError) -> bool {
    matches!(error.device(), Some(Error::NoReply { .. }))
}

fn lost_link(error: &Error) -> Option<&LinkError> {
    match error {
        Error::Link(error) => Some(error),
        Error::ModeNotRestored { cause, .. } => lost_link(cause),
        _ => None,
    }
}

pub fn encoder_error_text(error: &Error) -> Text {
    match error {
        Error::Link(error) => link_error_text(error),
        Error::NoReply { requested, tries } => {
            TEXTS.text("interbus.no_reply").with_text("asked", gateway::item_text(*requested)).with("tries", tries)
        }
        Error::Damaged { requested, tries, cause } => TEXTS
            .text("interbus.damaged")
            .with_text("asked", gateway::item_text(*requested))
            .with("tries", tries)
            .with_text("why", gateway::damage_text(*cause)),
        Error::NeverSilent => TEXTS.text("interbus.never_silent"),
        Error::Exception { requested, exception } => TEXTS
            .text("interbus.exception")
            .with_text("asked", gateway::item_text(*requested))
            .with("code", format!("0x{:02X}", exception.code()))
            .with_text("name", gateway::exception_name(*exception))
            .with_text("cause", gateway::exception_text(*exception)),
        Error::Cancelled => Text::new("encoder.cancelled"),
        Error::Illegal(refused) => TEXTS.text("interbus.illegal").with("word", format_word(refused.command.emit())),
        Error::Refused { sent, error } => TEXTS
            .text("interbus.refused")
            .with("word", format_word(sent.emit()))
            .with("error", format_word(Reply::Error(*error).emit()))
            .with_text("why", error_word_text(*error)),
        Error::UnknownReadOut { command } => {
            TEXTS.text("interbus.no_read_out").with("word", format_word(command.emit()))
        }
        Error::TimeOut { awaited, sent, input, milliseconds } => {
            let text = match Reply::parse(*input) {
                Reply::Busy { .. } => TEXTS.text("interbus.still_busy"),
                Reply::Echo { .. } => TEXTS.text("interbus.other_echo"),
                _ => time_out(*awaited),
            };
            text.with("sent", format_word(*sent)).with("input", format_word(*input)).with("milliseconds", milliseconds)
        }
        Error::OtherMaster { sent, output } => {
            TEXTS.text("interbus.other_master_out").with("sent", format_word(*sent)).with("seen", format_word(*output))
        }
        Error::NotRunning { input } => TEXTS.text("interbus.not_running").with("input", format_word(*input)),
        Error::WordOrder { input, swapped } => {
            TEXTS.text("interbus.word_order").with("input", format_word(*input)).with("swapped", format_word(*swapped))
        }
        Error::Implausible(why) => implausible_value_text(*why),
        Error::NoMode { wanted, is } => TEXTS
            .text("interbus.no_mode")
            .with_text("wanted", startup_mode_text(*wanted))
            .with_text("is", startup_mode_text(*is)),
        Error::NotSelectable { mode } => {
            TEXTS.text("interbus.not_selectable").with_text("mode", startup_mode_text(*mode))
        }
        Error::UnknownMode { mode } => TEXTS.text("interbus.unknown_mode").with_text("mode", startup_mode_text(*mode)),
        Error::Moving { from, to } => TEXTS.text("interbus.moving").with("from", from).with("to", to),
        Error::NotAccepted { item, wanted, reads } => {
            TEXTS.text("interbus.not_taken").with("item", item).with("wanted", wanted).with("reads", reads)
        }
        Error::Changed { item } => TEXTS.text("interbus.changed").with("item", item),
        Error::ModeNotRestored { cause, standing } => TEXTS
            .text("interbus.not_led_back")
            .with_text("cause", encoder_error_text(cause))
            .with_text("standing", self::left_state_text(standing)),
    }
}

fn time_out(awaited: ExpectedWord) -> Text {
    TEXTS.text(match awaited {
        ExpectedWord::Echo => "interbus.no_echo",
        ExpectedWord::Value => "interbus.no_value",
        ExpectedWord::Run => "interbus.no_run",
        ExpectedWord::Preset => "interbus.no_preset",
    })
}

/// Returns the meaning of an error word and a remedy.
pub fn error_word_text(error: ErrorWord) -> Text {
    TEXTS.text(match (error.code.get(), error.data.get()) {
        (1, _) => "ib_refused.data",
        (2, _) => "ib_refused.code",
        (3, _) => "ib_refused.lost",
        (0xC, ErrorWord::CAM_BEYOND_RANGE) => "ib_refused.cam",
        (0xC, _) => "ib_refused.maker",
        _ => "ib_refused.invalid",
    })
}

pub fn implausible_value_text(why: ImplausibleValue) -> Text {
    match why {
        ImplausibleValue::Gear(GearError::Turns { turns }) => {
            TEXTS.text("interbus.implausible_turns").with("turns", turns)
        }
        ImplausibleValue::Gear(GearError::Steps { steps, turns, most }) => {
            TEXTS.text("interbus.implausible_steps").with("steps", steps).with("turns", turns).with("most", most)
        }
        ImplausibleValue::Direction(code) => TEXTS.text("interbus.implausible_direction").with("code", code),
        ImplausibleValue::Value { read, value } => {
            TEXTS.text("interbus.implausible_value").with("read", format_word(read)).with("value", value)
        }
    }
}

/// Returns the state in which an encoder may be if it could not be returned to operation, as part of a sentence.
fn left_state_text(standing: &LeftState) -> Text {
    let id = if standing.parameterising { "ib_standing.set" } else { "ib_standing.out" };
    let state = TEXTS.text(id).with("out", format_word(standing.out));
    match (standing.found, standing.is) {
        (Some(found), Some(is)) if found != is => TEXTS
            .text("ib_standing.other")
            .with_text("state", state)
            .with_text("found", startup_mode_text(found))
            .with_text("is", startup_mode_text(is)),
        (Some(found), _) => {
            TEXTS.text("ib_standing.found").with_text("state", state).with_text("found", startup_mode_text(found))
        }
        (None, _) => state,
    }
}

pub fn step_text(job_step: &JobStep) -> Text {
    match job_step {
        JobStep::ReadOut(read_out) => item::read_out(*read_out),
        JobStep::Program(program) => TEXTS.text("ib_startup.program").with("program", program.get()),
        JobStep::Operation(item) => literal_text(item),
    }
}

fn format_word(word: u32) -> String {
    format!("0x{word:08X}")
}

#[cfg(test)]
mod tests;
