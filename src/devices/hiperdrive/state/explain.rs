//! Messages and names for HIPERDRIVE: job errors, states, bits, errors and parameters, and the outcomes of motion.

mod check;
mod entry;
mod error;
mod motion;
mod names;
#[cfg(test)]
mod phrases;
mod status;
#[cfg(test)]
mod tests;
mod write;

pub use check::{check_lines, source_text, switch_text};
pub use entry::entry_error_text;
pub use error::{damage_text, device_error_text, out_of_range, range_text, wrong_length};
pub use motion::{
    CONNECTION_LOSS_IDS, MOTION_ENDS, cyclic_loss_text, end_severity, end_text, lock_text, parameter_words, phase_text,
    refusal_text, target_state_text,
};
pub use names::{
    ErrorExplanation, control_bit, error_code_explanation, parameter_name_text, state_text, status_bit, variant_text,
};
pub use write::{
    change_text, item_text, operation_texts, other_type, plan_error_text, service_text, warning_text, written_text,
};

use crate::app::Text;
use crate::app::explain::{link_error_text, literal_text};
use crate::devices::hiperdrive::jobs::{JobError, JobStep};
use crate::devices::hiperdrive::procedures::Error;

/// Returns the messages for a job that failed or was interrupted. Each can be shown on its own line.
pub fn job_error_texts(error: &JobError) -> Vec<Text> {
    match error {
        JobError::Device(error) => vec![device_error_text(error)],
        JobError::Plan(error) => vec![plan_error_text(error)],
        JobError::NotStarted(why) => vec![crate::app::explain::not_started_text(why)],
        JobError::Interrupted { interrupted, backup, planned, kind } => {
            write::interruption_text(interrupted, backup, *planned, *kind)
        }
    }
}

/// Returns a message if the connection has failed, or `None` if further requests are possible.
pub fn connection_loss_text(error: &JobError) -> Option<Text> {
    match error.device()? {
        Error::Link(error) => Some(link_error_text(error)),
        _ => None,
    }
}

/// Returns whether the error means that the link is open but the device does not reply.
pub fn is_no_response(error: &JobError) -> bool {
    matches!(error.device(), Some(Error::NoReply { .. }))
}

pub fn step_text(job_step: &JobStep) -> Text {
    match job_step {
        JobStep::Parameter(number) => parameter_name_text(*number),
        JobStep::Step(own) => check::check_step_text(*own),
        JobStep::Operation(item) => literal_text(item),
    }
}
