//! Running jobs on a BiSS encoder and printing their messages.

use super::BissCommands;
use crate::app::TypeMap;
use crate::cli::commands::DeviceCommands;
use crate::cli::output::write_stderr;
use crate::cli::runner::{self, CliDevice, unexpected_output};
use crate::cli::{Failure, Result};
use crate::devices::biss::jobs::{Biss, BissJob, BissOutput, DeviceMessage, JobStep, RegisterValues};
use crate::devices::biss::procedures::procedure::{ProcedureProgress, StepDetail};
use crate::devices::biss::procedures::{Identity, Transport};
use crate::devices::biss::profile::RegisterRange;
use crate::devices::biss::state::explain;
use crate::result_of;
use crate::worker::Session;

pub(super) type Runner = runner::Runner<Biss>;

impl CliDevice for Biss {
    type Context = Transport;
    const COMMANDS: &'static dyn DeviceCommands = &BissCommands;

    fn prepare_context(session: &mut Session<Self>, _given: &TypeMap) -> Transport {
        session.station().transport
    }

    fn print_message(remark: &DeviceMessage) {
        match remark {
            // Checksum errors are counted and reported at the end.
            DeviceMessage::CrcErrors(_) => {}
            remark => explain::message_texts(remark)
                .iter()
                .for_each(|text| write_stderr(&format!("{}\n", text.terminal_text()))),
        }
    }

    fn describe_step(doing: &JobStep) -> String {
        match doing {
            JobStep::Operation { progress: news, .. } => describe_detail(news),
            other => other.to_string(),
        }
    }

    fn step_message(doing: &JobStep) -> Option<String> {
        match doing {
            JobStep::Operation { item, progress: news } => {
                Some(format!("{item}: {}", explain::procedure_step_text(news.step).terminal_text()))
            }
            JobStep::Register(_) | JobStep::Bank(_) => None,
        }
    }
}

/// Describes the progress of a step, such as a count, the elapsed time, or what prevents the start.
fn describe_detail(news: &ProcedureProgress) -> String {
    match &news.detail {
        StepDetail::Begins => String::new(),
        StepDetail::Count { done, total } => format!("{done} of {total}"),
        StepDetail::Lasts { elapsed, expected: Some(expected) } => {
            format!("{} of about {} s", elapsed.as_secs(), expected.as_secs())
        }
        StepDetail::Lasts { elapsed, expected: None } => format!("{} s", elapsed.as_secs()),
        StepDetail::Demand(demand) => {
            let against = demand.blockers.iter().map(|blocker| explain::blocker_text(*blocker).terminal_text());
            let turning = demand.motion.map(|motion| format!("{:.1} 1/min", motion.rpm));
            turning.into_iter().chain(against).collect::<Vec<_>>().join("; ")
        }
    }
}

pub(super) fn identity(runner: &mut Runner) -> Result<Box<Identity>> {
    Ok(result_of!(runner.run(BissJob::Identify)?, BissOutput::Identity(identity) => identity))
}

/// Returns the number of frames with a wrong checksum in the last job, without those counted in a position reading.
pub(super) fn crc_errors(runner: &Runner) -> u64 {
    let count = |remark: &DeviceMessage| match remark {
        DeviceMessage::CrcErrors(count) => u64::from(*count),
        _ => 0,
    };
    runner.remarks.iter().map(count).sum()
}

pub(super) fn registers(runner: &mut Runner, range: RegisterRange) -> Result<Vec<u8>> {
    read_registers(runner, range).map(|read| read.bytes)
}

/// Reads consecutive registers, and reports whether they may show values that were never saved.
pub(super) fn read_registers(runner: &mut Runner, range: RegisterRange) -> Result<RegisterValues> {
    match runner.run(BissJob::Read(range))? {
        BissOutput::Registers(read) if read.bytes.len() == usize::from(range.count()) => Ok(read),
        BissOutput::Registers(read) => {
            let (wanted, came) = (range.count(), read.bytes.len());
            Err(Failure::Failed(vec![format!("{range}: {came} registers were received instead of {wanted}.")]))
        }
        other => Err(unexpected_output(&other)),
    }
}
