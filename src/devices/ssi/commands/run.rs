//! Runs jobs on an SSI encoder behind an adapter.

use super::SsiCommands;
use super::layout::SelectedLayout;
use crate::app::TypeMap;
use crate::cli::Result;
use crate::cli::args::CommonArgs;
use crate::cli::commands::DeviceCommands;
use crate::cli::output::Output;
use crate::cli::runner::{self, CliDevice};
use crate::devices::ssi::jobs::{JobStep, Ssi, SsiJob, SsiOutput};
use crate::devices::ssi::procedures::{ClockSettings, Words};
use crate::devices::ssi::protocol::ReadConditions;
use crate::devices::ssi::state::explain;
use crate::result_of;
use crate::worker::Session;

/// The job runner for a session with an SSI encoder.
pub(super) type Runner = runner::Runner<Ssi>;

impl CliDevice for Ssi {
    /// Settings for reading SSI words, taken from the link unless an option overrides them.
    type Context = ClockSettings;
    const COMMANDS: &'static dyn DeviceCommands = &SsiCommands;

    fn prepare_context(session: &mut Session<Self>, _given: &TypeMap) -> ClockSettings {
        session.station().clock_settings
    }

    fn describe_step(_: &JobStep) -> String {
        "words".to_owned()
    }
}

/// Opens the link and configures it for the layout.
///
/// Clock and pause are taken from the link if it specifies them, and from the profile if not. A remark is printed for
/// each timing limit of the encoder that they violate.
pub(super) fn open_runner(common: &CommonArgs, output: &Output, chosen: &SelectedLayout) -> Result<Runner> {
    let mut runner = Runner::open(common)?;
    let names = |name: &str| common.link.as_ref().is_some_and(|url| url.query.get(name).is_some());
    let (own, reading) = (runner.context, chosen.profile.reading);
    let clock_settings = ClockSettings {
        clocks: chosen.layout.clock_count(),
        clock_hz: if names("clock") { own.clock_hz } else { reading.clock_hz },
        pause_us: if names("pause") { own.pause_us } else { reading.pause_us },
    };
    let identity = result_of!(runner.run(SsiJob::Set(clock_settings))?, SsiOutput::Set(identity) => identity);
    if let Some(times) = &chosen.times {
        let reads = ReadConditions {
            clock_hz: identity.clock_hz.into(),
            pause: std::time::Duration::from_micros(clock_settings.pause_us.into()),
            ..chosen.profile.read_conditions()
        };
        for warning in times.calculate_timing(&reads).warnings {
            output.print_message(&explain::timing_warning_text(&warning).terminal_text());
        }
    }
    Ok(runner)
}

pub(super) fn words_from_output(came: SsiOutput) -> Result<Words> {
    Ok(result_of!(came, SsiOutput::Read(words) => words))
}
