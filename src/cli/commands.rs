//! Interface through which devices, buses and the `signals` module add commands. The commands are listed in `kinds.rs`,
//! so this module does not depend on any device.

#![warn(missing_docs)]

use clap::builder::PossibleValue;
use clap::{Arg, ArgMatches, FromArgMatches, ValueEnum};

use super::args::{Command, CommonArgs, DecodeArgs, ReportArgs, Restore, SimulateArgs};
use super::output::Output;
use super::simulate::ServableDevice;
use super::{Failure, Result};
use crate::app::report::{DeviceReading, ReportContext};
use crate::app::{Text, TypeMap};
use crate::profile::{Body, IrreversibleItem};
use crate::report::Report;

/// Commands that a device kind may support.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CommandId {
    /// Search for devices.
    Find,
    /// Read the identity of a device.
    Identify,
    /// Read errors and warnings.
    Status,
    /// Read the position.
    Position,
    /// Read a value from the device memory.
    Read,
    /// Save a profile.
    Save,
    /// Compare two profiles, or a profile with a device.
    Diff,
    /// Compare a device with a profile.
    Verify,
    /// Write a profile to a device.
    Restore,
    /// Write values.
    Write,
    /// Perform another action of the device.
    Do,
    /// Create a report of a profile or a device.
    Report,
    /// Explain captured bytes.
    Decode,
    /// Serve a virtual device.
    Simulate,
}

impl CommandId {
    pub(super) const ALL: [CommandId; 14] = [
        CommandId::Find,
        CommandId::Identify,
        CommandId::Status,
        CommandId::Position,
        CommandId::Read,
        CommandId::Save,
        CommandId::Diff,
        CommandId::Verify,
        CommandId::Restore,
        CommandId::Write,
        CommandId::Do,
        CommandId::Report,
        CommandId::Decode,
        CommandId::Simulate,
    ];

    pub(super) const fn name(self) -> &'static str {
        match self {
            CommandId::Find => "find",
            CommandId::Identify => "identify",
            CommandId::Status => "status",
            CommandId::Position => "position",
            CommandId::Read => "read",
            CommandId::Save => "save",
            CommandId::Diff => "diff",
            CommandId::Verify => "verify",
            CommandId::Restore => "restore",
            CommandId::Write => "write",
            CommandId::Do => "do",
            CommandId::Report => "report",
            CommandId::Decode => "decode",
            CommandId::Simulate => "simulate",
        }
    }
}

/// A device kind on the command line. Unsupported commands are reported as incorrect usage.
pub trait DeviceCommands: ProfileCommands {
    /// Returns the name of this device kind on the command line and in profiles.
    fn name(&self) -> &'static str;

    /// Returns a one-sentence description for the help text.
    fn description(&self) -> &'static str;

    /// Returns additional sentences for the program's help text.
    fn help_note(&self) -> Option<&'static str> {
        None
    }

    /// Returns the help text that this kind adds to a command: its items, values and formats.
    fn command_help(&self, _command: CommandId) -> Option<String> {
        None
    }

    /// Returns the options that this device kind adds to a command. Several kinds may share an option.
    fn options(&self, _command: CommandId) -> Vec<Arg> {
        Vec::new()
    }

    /// Returns the options that this device kind adds to every command and to the window. Several kinds may share an
    /// option.
    fn common_options(&self) -> Vec<Arg> {
        Vec::new()
    }

    /// Adds the values of this kind's common options to `given`, including those from environment variables.
    ///
    /// # Errors
    /// Returns an error if a value is invalid.
    fn add_given(&self, _options: &KindOptions, given: TypeMap) -> Result<TypeMap> {
        Ok(given)
    }

    /// Returns the actions of `do` with their help. Several kinds may share an action.
    fn action_values(&self) -> Vec<PossibleValue> {
        Vec::new()
    }

    /// Returns the actions of `do` that combine several other actions. The help lists these actions last.
    fn combined_actions(&self) -> Vec<PossibleValue> {
        Vec::new()
    }

    /// Returns the options of `simulate` that are equivalent to a `--set` option with the same name.
    fn setting_options(&self) -> Vec<Arg> {
        Vec::new()
    }

    /// Returns the reason why other device kinds reject an option of this kind. Returns `None` if no specific reason
    /// can be given.
    fn refused_option(&self, _option: &str) -> Option<String> {
        None
    }

    /// Returns the commands that only this kind provides.
    fn extra_commands(&self) -> &'static [&'static dyn CliCommand] {
        &[]
    }

    /// Returns whether `find` searches for devices of this kind.
    fn is_searchable(&self) -> bool {
        false
    }

    /// Runs one of the commands find, identify, status, position, read, save, write, do and decode for this kind.
    /// Returns `None` if the kind does not support the command.
    fn run(&self, common: &CommonArgs, output: &Output, command: &Command) -> Option<Result>;

    /// Creates the virtual device to serve.
    fn create_simulated(&self, output: &Output, simulate: &SimulateArgs) -> Result<Box<dyn ServableDevice>>;
}

/// Commands that restore profiles and read a device for comparison.
pub trait ProfileCommands: Sync {
    /// Writes a profile to a device after review and consent.
    fn restore(&self, common: &CommonArgs, output: &Output, restore: &Restore, profile: Body) -> Result;

    /// Reads a device for comparison with a profile. Without a profile, all items are read. With a profile, at least
    /// the items that it contains are read.
    fn read_for_comparison(&self, common: &CommonArgs, output: &Output, profile: Option<&Body>) -> Result<Body>;

    /// Reads a device for a report: the same values as for a profile, and the status of the device.
    fn read_for_report(&self, common: &CommonArgs, output: &Output) -> Result<DeviceReading> {
        let body = self.read_for_comparison(common, output, None)?;
        Ok(DeviceReading { body, status: None })
    }

    /// Returns an instruction with the command that writes back an item that an undo leaves unchanged. Returns `None`
    /// if this kind has no such command.
    fn redo_command(&self, _kept: &IrreversibleItem) -> Option<String> {
        None
    }

    /// Returns a note to print whenever the profile is used.
    fn profile_note(&self, _profile: &Body) -> Option<Text> {
        None
    }

    /// Returns a message if the two profiles are from different devices, or `None` if they are not.
    fn device_mismatch(&self, _profile: &Body, _device: &Body) -> Option<String> {
        None
    }
}

/// A command that belongs to one device kind or to another part of the program.
pub trait CliCommand: Sync {
    /// Returns the command with its options and help.
    fn command(&self) -> clap::Command;

    /// Runs the command with its arguments.
    fn run(&self, common: &CommonArgs, output: &Output, matches: &ArgMatches) -> Result;

    /// Returns the options that this part of the program adds to `report`.
    fn report_options(&self) -> Vec<Arg> {
        Vec::new()
    }

    /// Returns the report of a file if this part of the program can read it, or `None` otherwise.
    fn report(&self, _output: &Output, _report: &ReportArgs, _context: &ReportContext<'_>) -> Option<Result<Report>> {
        None
    }
}

/// A protocol whose captured bytes `decode` explains. Several device kinds may share it.
pub trait ProtocolDecoder: Sync {
    /// Returns the name of the protocol on the command line.
    fn name(&self) -> &'static str;

    /// Returns a one-sentence description for the help text.
    fn description(&self) -> &'static str;

    /// Returns the help text of `decode` for this protocol.
    fn help_text(&self) -> &'static str;

    /// Explains captured bytes.
    fn decode(&self, output: &Output, decode: &DecodeArgs) -> Result;
}

/// All commands that device kinds, protocols and other parts of the program provide.
#[derive(Clone, Copy)]
pub struct Commands {
    devices: &'static [&'static dyn DeviceCommands],
    protocols: &'static [&'static dyn ProtocolDecoder],
    further: &'static [&'static dyn CliCommand],
}

impl std::fmt::Debug for Commands {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_list().entries(self.devices.iter().map(|device| device.name())).finish()
    }
}

impl Commands {
    /// Only the commands of the core.
    pub(super) const NONE: Commands = Commands::new(&[], &[], &[]);

    /// Creates the list of commands.
    pub const fn new(
        devices: &'static [&'static dyn DeviceCommands],
        protocols: &'static [&'static dyn ProtocolDecoder],
        further: &'static [&'static dyn CliCommand],
    ) -> Self {
        Commands { devices, protocols, further }
    }

    pub(super) fn devices(self) -> &'static [&'static dyn DeviceCommands] {
        self.devices
    }

    pub(super) fn protocols(self) -> &'static [&'static dyn ProtocolDecoder] {
        self.protocols
    }

    /// Returns the options that device kinds add to every command and to the window.
    pub(super) fn common_options(self) -> impl Iterator<Item = Arg> {
        self.devices.iter().flat_map(|device| device.common_options())
    }

    /// Returns an explanation why the chosen device kind does not accept an option.
    pub(super) fn option_rejection(self, option: &str, chosen: &str) -> String {
        let own = self.devices.iter().find_map(|device| device.refused_option(option));
        own.unwrap_or_else(|| format!("{option} is not for {chosen} devices"))
    }

    /// Returns an error message if a given common option does not exist for the chosen device kind.
    pub(super) fn foreign_common_option_error(
        self,
        chosen: &dyn DeviceCommands,
        given: &KindOptions,
    ) -> Option<String> {
        let own = chosen.common_options();
        let foreign = self.common_options().find(|option| {
            given.is_given(option.get_id().as_str()) && own.iter().all(|other| other.get_id() != option.get_id())
        })?;
        Some(self.option_rejection(&format!("--{}", foreign.get_long().unwrap_or_default()), chosen.name()))
    }

    /// Returns the commands that are not part of the core.
    pub(super) fn kind_commands(self) -> impl Iterator<Item = &'static dyn CliCommand> {
        let of_devices = self.devices.iter().flat_map(|device| device.extra_commands());
        of_devices.chain(self.further).copied()
    }

    pub(super) fn protocol(self, name: &str) -> Option<&'static dyn ProtocolDecoder> {
        self.protocols.iter().copied().find(|protocol| protocol.name() == name)
    }

    /// Returns the device kind with this name.
    ///
    /// # Errors
    /// Returns an error if the name is unknown.
    pub fn device(self, name: &str) -> Result<&'static dyn DeviceCommands> {
        let named = self.devices.iter().copied().find(|device| device.name() == name);
        named.ok_or_else(|| Failure::Failed(vec![format!("There are no commands for {name} devices.")]))
    }

    /// Returns an error message if a given option does not exist for the chosen device kind or protocol.
    pub(super) fn foreign_option_error(self, command: CommandId, chosen: &str, given: &KindOptions) -> Option<String> {
        let has = |device: &&&dyn DeviceCommands, id: &clap::Id| {
            device.options(command).iter().any(|option| option.get_id() == id)
        };
        let foreign = self.devices.iter().flat_map(|device| device.options(command)).find(|option| {
            let is_own = self.devices.iter().any(|device| device.name() == chosen && has(&device, option.get_id()));
            !is_own && given.is_given(option.get_id().as_str())
        })?;
        let owners: Vec<_> = self.devices.iter().filter(|device| has(device, foreign.get_id())).collect();
        let option = format!("--{}", foreign.get_long().unwrap_or_default());
        if command == CommandId::Decode {
            let names: Vec<&str> = owners.iter().map(|device| device.name()).collect();
            return Some(format!("{option} is for the words of {} devices", names.join(" and ")));
        }
        let own = owners.iter().find_map(|device| device.refused_option(&option));
        Some(own.unwrap_or_else(|| format!("{option} is not for {chosen} devices")))
    }
}

/// Values of the options that device kinds add to a command.
#[derive(Clone)]
pub struct KindOptions(ArgMatches);

impl KindOptions {
    /// Parses the options that a device kind has added into its own type.
    pub(crate) fn read<O: FromArgMatches>(&self) -> Result<O> {
        parse(&self.0)
    }

    /// Returns whether an option was given on the command line. Default values do not count.
    pub(super) fn is_given(&self, id: &str) -> bool {
        self.0.value_source(id) == Some(clap::parser::ValueSource::CommandLine)
    }

    pub(super) fn text(&self, id: &str) -> Option<&String> {
        self.0.get_one(id)
    }
}

pub(crate) fn parse<O: FromArgMatches>(matches: &ArgMatches) -> Result<O> {
    O::from_arg_matches(matches).map_err(|error| Failure::Usage(error.to_string()))
}

pub(crate) fn arg_list<O: clap::Args>() -> Vec<Arg> {
    O::augment_args(clap::Command::new("options")).get_arguments().cloned().collect()
}

pub(crate) fn enum_values<V: ValueEnum>() -> Vec<PossibleValue> {
    V::value_variants().iter().filter_map(ValueEnum::to_possible_value).collect()
}

/// Adds no options here, because the list of kinds is only known later.
impl clap::Args for KindOptions {
    fn augment_args(command: clap::Command) -> clap::Command {
        command
    }

    fn augment_args_for_update(command: clap::Command) -> clap::Command {
        command
    }
}

impl FromArgMatches for KindOptions {
    fn from_arg_matches(matches: &ArgMatches) -> std::result::Result<Self, clap::Error> {
        Ok(KindOptions(matches.clone()))
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> std::result::Result<(), clap::Error> {
        *self = KindOptions(matches.clone());
        Ok(())
    }
}
