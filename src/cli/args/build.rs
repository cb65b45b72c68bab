//! Construction of the clap command line from the common part and from the options and commands of all device kinds.

use std::ffi::OsString;
use std::path::PathBuf;

use clap::builder::{PossibleValue, PossibleValuesParser};
use clap::{ArgMatches, CommandFactory, FromArgMatches, Subcommand};

use super::{COMMON_HEADING, Cli, Command, CommonArgs};
use crate::cli::commands::{CliCommand, CommandId, Commands, DeviceCommands};

/// Display order of options added by a device kind. They follow the shared options.
const KIND_OPTION_ORDER: usize = 200;

pub(in crate::cli) struct Arguments {
    pub(in crate::cli) common: CommonArgs,
    pub(in crate::cli) profile: Option<PathBuf>,
    pub(in crate::cli) command: Option<ParsedCommand>,
}

pub(in crate::cli) enum ParsedCommand {
    Shared(Command),
    Own(&'static dyn CliCommand, ArgMatches),
}

/// Parses the arguments of a process. The first one is the program name.
pub(in crate::cli) fn parse_arguments(
    words: impl IntoIterator<Item = OsString>,
    commands: Commands,
) -> Result<Arguments, clap::Error> {
    let mut command = command(commands);
    let matches = command.try_get_matches_from_mut(words)?;
    read(&matches, commands).map_err(|error| error.format(&mut command))
}

fn read(matches: &ArgMatches, commands: Commands) -> Result<Arguments, clap::Error> {
    let Cli { common, profile } = Cli::from_arg_matches(matches)?;
    let common = CommonArgs { commands, ..common };
    let own = matches.subcommand().and_then(|(name, own)| {
        let command = commands.kind_commands().find(|command| command.command().get_name() == name)?;
        Some(ParsedCommand::Own(command, own.clone()))
    });
    let command = match own {
        Some(own) => Some(own),
        None if matches.subcommand_name().is_some() => Some(ParsedCommand::Shared(Command::from_arg_matches(matches)?)),
        None => None,
    };
    Ok(Arguments { common, profile, command })
}

/// Returns the command line with all commands and options, as parsed by the program and described in its manual.
pub fn command(commands: Commands) -> clap::Command {
    let front = commands.common_options().fold(Cli::command(), |front, option| {
        // Several kinds of devices may have the same option.
        let is_new = front.get_arguments().all(|other| other.get_id() != option.get_id());
        if is_new { front.arg(option.help_heading(COMMON_HEADING).display_order(KIND_OPTION_ORDER)) } else { front }
    });
    let shared = Command::augment_subcommands(front).after_help(command_summary(commands));
    let extended = CommandId::ALL
        .into_iter()
        .fold(shared, |all, id| all.mut_subcommand(id.name(), |command| add_kind_options(command, id, commands)));
    // The entries are about devices, so the names are those of a command that applies to any device.
    let names = kind_name_parser(CommandId::Identify, commands);
    let extended = extended.mut_subcommand("log", |log| log.mut_arg("device", |device| device.value_parser(names)));
    let options = commands.kind_commands().flat_map(|own| own.report_options());
    let extended = extended
        .mut_subcommand("report", |report| report.args(options.map(|own| own.display_order(KIND_OPTION_ORDER))));
    extended.subcommands(commands.kind_commands().map(|own| own.command()))
}

/// Adds the options of all device kinds to a shared command.
fn add_kind_options(command: clap::Command, id: CommandId, commands: Commands) -> clap::Command {
    let mut command = command;
    // Change the argument in place, because `mut_arg` would move it after the other arguments.
    command = command.mut_args(|argument| match argument.get_id().as_str() {
        "device" | "protocol" => argument.value_parser(kind_name_parser(id, commands)),
        "action" => argument.value_parser(action_parser(commands)),
        _ => argument,
    });
    for device in commands.devices() {
        let own = device.options(id).into_iter();
        let settings = device.setting_options().into_iter().filter(|_| id == CommandId::Simulate);
        for option in own.chain(settings) {
            // Several kinds of devices may have the same option.
            if command.get_arguments().all(|other| other.get_id() != option.get_id()) {
                command = command.arg(option.display_order(KIND_OPTION_ORDER));
            }
        }
    }
    let of_devices = commands.devices().iter().filter_map(|device| Some((device.name(), device.command_help(id)?)));
    let protocols = commands.protocols().iter().filter(|_| id == CommandId::Decode);
    let of_protocols = protocols.map(|protocol| (protocol.name(), protocol.help_text().to_owned()));
    let help: Vec<String> =
        of_devices.chain(of_protocols).map(|(name, help)| format!("{name}: {}", help.trim_end())).collect();
    if help.is_empty() { command } else { command.after_long_help(help.join("\n\n")) }
}

/// Returns the parser for the device kinds that a command accepts. `decode` also accepts protocols.
fn kind_name_parser(id: CommandId, commands: Commands) -> PossibleValuesParser {
    let devices = commands.devices().iter().filter(|device| id != CommandId::Find || device.is_searchable());
    let devices = devices.map(|device| PossibleValue::new(device.name()).help(device.description()));
    let protocols = commands.protocols().iter().filter(|_| id == CommandId::Decode);
    let protocols = protocols.map(|protocol| PossibleValue::new(protocol.name()).help(protocol.description()));
    PossibleValuesParser::new(devices.chain(protocols).collect::<Vec<_>>())
}

/// Returns the parser for the actions of all device kinds. The help of an action states its meaning for each kind that
/// supports it.
fn action_parser(commands: Commands) -> PossibleValuesParser {
    let single = commands.devices().iter().map(|device| (device.name(), device.action_values()));
    let combined = commands.devices().iter().map(|device| (device.name(), device.combined_actions()));
    let mut actions: Vec<(PossibleValue, Vec<String>)> = Vec::new();
    for (kind, of_kind) in single.chain(combined) {
        for action in of_kind {
            let help = action.get_help().map(ToString::to_string).unwrap_or_default();
            let help = format!("{kind}: {help}");
            match actions.iter_mut().find(|(known, _)| known.get_name() == action.get_name()) {
                Some((_, helps)) => helps.push(help),
                None => actions.push((action, vec![help])),
            }
        }
    }
    let values = actions.into_iter().map(|(action, helps)| action.help(helps.join("; ")));
    PossibleValuesParser::new(values.collect::<Vec<_>>())
}

/// Returns a summary that lists the device kinds for each command.
fn command_summary(commands: Commands) -> String {
    let devices = commands.devices();
    let list = |is: &dyn Fn(&dyn DeviceCommands) -> bool| {
        let names: Vec<&str> = devices.iter().filter(|device| is(**device)).map(|device| device.name()).collect();
        match names.split_last() {
            Some((last, others)) if !others.is_empty() => format!("{} and {last}", others.join(", ")),
            _ => names.concat(),
        }
    };
    let all = list(&|_| true);
    let searchable = list(&|device| device.is_searchable());
    let notes: String =
        devices.iter().filter_map(|device| device.help_note()).map(|note| format!("{note}\n")).collect();
    let example = devices.first().map(|device| device.name()).unwrap_or_default();
    format!(
        "Kinds of device: {all}.\ndiff, verify and restore take the kind from the profile. find supports {searchable}. The \
         actions of do differ by kind (help do).\n{notes}\nTo try a command without hardware, use --link sim:\n\n  \
         encoder-studio identify {example} --link sim:\n\nAddresses and registers are decimal, or hexadecimal with 0x."
    )
}
