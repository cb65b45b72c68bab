//! Runs jobs on a HIPERFACE encoder with the access codes from the command line, and prints announced status codes.

use super::HiperfaceCommands;
use crate::app::TypeMap;
use crate::cli::commands::DeviceCommands;
use crate::cli::output::write_stderr;
use crate::cli::runner::{self, CliDevice};
use crate::devices::hiperface::jobs::{DeviceMessage, Hiperface, JobStep, may_have_other_master};
use crate::devices::hiperface::procedures::InitialAccessCodes;
use crate::devices::hiperface::protocol::StatusCode;
use crate::devices::hiperface::state::explain;
use crate::link::LinkUrl;
use crate::units::CharacterFormat;
use crate::worker::Session;

pub(super) type Runner = runner::Runner<Hiperface>;

impl CliDevice for Hiperface {
    /// Character format of the serial line, which `identify` prints.
    type Context = CharacterFormat;
    const HAS_ONE_MASTER: bool = true;
    const COMMANDS: &'static dyn DeviceCommands = &HiperfaceCommands;

    fn may_have_other_master(url: &LinkUrl) -> bool {
        may_have_other_master(url)
    }

    fn prepare_context(session: &mut Session<Self>, given: &TypeMap) -> CharacterFormat {
        if let Some(codes) = given.get::<InitialAccessCodes>() {
            codes.apply_codes(session.access_codes_mut());
        }
        session.station().format
    }

    /// Prints each announced status code on its own line.
    fn print_message(remark: &DeviceMessage) {
        if let DeviceMessage::CodesLost(count) = remark {
            write_stderr(&format!("{}\n", explain::unanswered_codes(*count).terminal_text()));
        }
        for code in message_codes(remark) {
            let kind = if code.is_warning() { "warning" } else { "error" };
            write_stderr(&format!("encoder {kind}: {code}\n"));
        }
    }

    fn describe_step(doing: &JobStep) -> String {
        doing.to_string()
    }
}

pub(super) fn reported_codes(runner: &Runner) -> Vec<StatusCode> {
    runner.remarks.iter().flat_map(message_codes).copied().collect()
}

fn message_codes(remark: &DeviceMessage) -> &[StatusCode] {
    match remark {
        DeviceMessage::Codes(codes) => codes,
        DeviceMessage::CodesLost(_) | DeviceMessage::Found(_) | DeviceMessage::Line(_) => &[],
    }
}
