//! Commands for SSI encoders: `ssi`, which needs no encoder, and the commands for an encoder or its profile.

mod args;
mod export;
mod find;
mod frames;
mod layout;
mod live;
mod profiles;
mod run;
mod source;

use clap::{Arg, ArgMatches, Subcommand};

use self::args::{LayoutOption, Ssi, SsiLayoutArgs};
use crate::buses::bridge::sim::{Adapter, AttachableKind};
use crate::cli::args::{Command, CommonArgs, Restore, SimulateArgs};
use crate::cli::commands::{CliCommand, CommandId, DeviceCommands, ProfileCommands, arg_list, parse};
use crate::cli::output::Output;
use crate::cli::simulate::{ServableDevice, settings};
use crate::cli::{Failure, Result};
use crate::devices::ssi::protocol::KIND;
use crate::devices::ssi::sim::{AttachableEncoder, Encoder};
use crate::kinds::attachable_kinds;
use crate::profile::Body;

pub(crate) struct SsiCommands;

impl DeviceCommands for SsiCommands {
    fn name(&self) -> &'static str {
        KIND
    }

    fn description(&self) -> &'static str {
        "SSI encoder, which sends only its position; --layout defines the frame"
    }

    fn help_note(&self) -> Option<&'static str> {
        Some(
            "An SSI encoder sends only its position: --layout defines the frame, and the ssi command processes frames \
             without a device.",
        )
    }

    fn options(&self, command: CommandId) -> Vec<Arg> {
        let help = match command {
            CommandId::Status | CommandId::Position => "ssi: layout of the frame",
            CommandId::Save => "ssi: layout to save",
            CommandId::Simulate => "ssi: layout of the encoder behind the adapter (default atm60,code=gray)",
            _ => return Vec::new(),
        };
        let help = format!("{help}, as a profile or a family with settings (listed by help ssi decode)");
        arg_list::<LayoutOption>().into_iter().map(|option| option.help(help.clone())).collect()
    }

    fn refused_option(&self, option: &str) -> Option<String> {
        let is_own = option == "--layout";
        is_own.then(|| format!("{option} is only for {KIND} devices; other devices report their layout"))
    }

    fn extra_commands(&self) -> &'static [&'static dyn CliCommand] {
        &[&SsiCommand]
    }

    fn run(&self, common: &CommonArgs, output: &Output, command: &Command) -> Option<Result> {
        Some(match command {
            Command::Identify(_) => unsupported_command("identify", "see the type label for the identity"),
            Command::Status(status) => live::status(common, output, status),
            Command::Position(position) => live::position(common, output, position),
            Command::Read(_) => unsupported_command("read", "it has no registers"),
            Command::Save(save) => profiles::save(common, output, save),
            Command::Write(_) => unsupported_command("write", CONFIGURE_REMEDY),
            Command::Do(_) => unsupported_command("do", CONFIGURE_REMEDY),
            Command::Decode(_) => unsupported_command("decode", "use ssi decode --layout FILE|SPEC FRAME"),
            _ => return None,
        })
    }

    fn create_simulated(&self, output: &Output, arguments: &SimulateArgs) -> Result<Box<dyn ServableDevice>> {
        create_simulated(output, arguments)
    }
}

impl ProfileCommands for SsiCommands {
    fn restore(&self, _: &CommonArgs, _: &Output, _: &Restore, _: Body) -> Result {
        unsupported_command("restore", CONFIGURE_REMEDY)
    }

    fn read_for_comparison(&self, _: &CommonArgs, _: &Output, _: Option<&Body>) -> Result<Body> {
        unsupported_command("reading a profile from a link", "compare two files with diff FILE FILE")
    }
}

const CONFIGURE_REMEDY: &str = "configure it with the manufacturer's tool";

/// The command `ssi`, which works with frames and needs no encoder.
struct SsiCommand;

impl CliCommand for SsiCommand {
    fn command(&self) -> clap::Command {
        Ssi::augment_subcommands(clap::Command::new(KIND))
            .about("Decode, encode and analyse SSI frames, and export decoders")
            .subcommand_required(true)
            .arg_required_else_help(true)
    }

    fn run(&self, _: &CommonArgs, output: &Output, matches: &ArgMatches) -> Result {
        match parse(matches)? {
            Ssi::Decode(arguments) => frames::decode(output, &arguments),
            Ssi::Encode(arguments) => frames::encode(output, &arguments),
            Ssi::Find(arguments) => find::find(output, &arguments),
            Ssi::Export(arguments) => export::export(output, &arguments),
        }
    }
}

/// Creates a virtual adapter with an encoder that sends the frames of `--layout`.
fn create_simulated(output: &Output, arguments: &SimulateArgs) -> Result<Box<dyn ServableDevice>> {
    let settings = settings(output, arguments)?;
    let LayoutOption { layout } = arguments.own.read()?;
    let encoder = match layout {
        Some(_) if settings.iter().any(|(name, _)| name == "ssi") => {
            return Err(Failure::Usage("--layout and --set ssi= set the same value: use only one of them".to_owned()));
        }
        Some(spec) => {
            let chosen = layout::select_layout(&output.as_text(), &SsiLayoutArgs { spec })?;
            let (direction, preset) = (chosen.profile.direction, chosen.profile.preset);
            AttachableEncoder::with_default_encoder(Encoder { layout: chosen.layout, direction, preset })
        }
        None => AttachableEncoder::DEFAULT_ADAPTER,
    };
    // The encoder replaces the one with the factory settings, which has the same keys.
    let others = attachable_kinds().iter().copied().filter(|device| device.setting_names() != encoder.setting_names());
    let devices: Vec<&dyn AttachableKind> = [&encoder as &dyn AttachableKind].into_iter().chain(others).collect();
    let adapter = Adapter::from_pairs(&settings, &devices).map_err(|error| Failure::Usage(error.to_string()))?;
    Ok(Box::new(adapter))
}

/// Returns an error for a command that SSI encoders do not support. The error suggests an alternative.
fn unsupported_command<T>(command: &str, instead: &str) -> Result<T> {
    Err(Failure::Usage(format!("{command} is not available for {KIND} devices, which send only a position: {instead}")))
}
