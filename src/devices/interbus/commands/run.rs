//! Runs jobs on an INTERBUS encoder.

use super::InterbusCommands;
use crate::app::TypeMap;
use crate::cli::Result;
use crate::cli::commands::DeviceCommands;
use crate::cli::runner::{self, CliDevice, to_failure};
use crate::devices::interbus::jobs::{Interbus, InterbusJob, InterbusOutput, JobStep};
use crate::devices::interbus::procedures::{Identity, Survey};
use crate::devices::interbus::protocol::{Program, ProgramNumber, WindowShift};
use crate::devices::interbus::state::explain;
use crate::result_of;
use crate::worker::Session;

pub(super) type Runner = runner::Runner<Interbus>;

// The steps of the handshake are only shown in the window. A recording contains their bytes.
impl CliDevice for Interbus {
    type Context = ();
    const COMMANDS: &'static dyn DeviceCommands = &InterbusCommands;

    fn prepare_context(_session: &mut Session<Self>, _given: &TypeMap) {}

    fn describe_step(doing: &JobStep) -> String {
        doing.to_string()
    }
}

pub(super) fn identity(runner: &mut Runner) -> Result<Box<Identity>> {
    let identity = result_of!(runner.run(InterbusJob::Identify)?, InterbusOutput::Identity(identity) => identity);
    identity.gear().map_err(|why| to_failure(&explain::implausible_value_text(why)))?;
    Ok(identity)
}

/// Reads everything that can be read without selecting a cam program.
pub(super) fn read_survey(runner: &mut Runner) -> Result<Box<Survey>> {
    let survey = result_of!(runner.run(InterbusJob::Survey)?, InterbusOutput::Surveyed(survey) => survey);
    survey.identity.gear().map_err(|why| to_failure(&explain::implausible_value_text(why)))?;
    Ok(survey)
}

pub(super) fn programs(
    runner: &mut Runner,
    wanted: Vec<ProgramNumber>,
) -> Result<(Vec<(ProgramNumber, Program)>, WindowShift)> {
    Ok(
        result_of!(runner.run(InterbusJob::Programs(wanted))?, InterbusOutput::Programs(programs, shift) => (programs, shift)),
    )
}
