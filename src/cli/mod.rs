//! The command line: the same jobs without a window. It parses, asks for consent and prints; the work is done by the
//! worker.

pub(crate) mod args;
pub(crate) mod check;
pub(crate) mod commands;
pub(crate) mod consent;
pub(crate) mod decode;
pub(crate) mod number;
pub(crate) mod output;
pub(crate) mod patience;
pub mod plan;
mod ports;
pub(crate) mod positions;
pub(crate) mod profiles;
pub(crate) mod runner;
pub(crate) mod simulate;

use std::ffi::OsString;
use std::path::PathBuf;

use args::{Arguments, Called, Command};

pub use args::{Common, Consenting, Decode, Do, Find, Position, Read, Restore, Save, Simulate, Status, Write};
pub use commands::{CommandId, Commands, DeviceCommands, OwnCommand, OwnOptions, ProtocolDecoder};
pub use consent::{agreed, check_wear, require_consent};
pub use output::{Lines, Output};
pub use patience::Pace;
pub use positions::readings;
pub use profiles::{Left, keep, restore_options, show_dry_run, show_restored};
pub use runner::{Ended, Runner, Runs, failed, unexpected};
pub use simulate::{Simulated, settings};

use crate::app::Given;
use crate::link::LinkUrl;
use crate::profile::Formats;

/// How a command ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Done {
    /// As it should: status 0.
    Well,
    /// `diff` or `verify` found differences: status 3.
    Differs,
}

/// Why a command did not do what it should.
#[derive(Debug)]
pub enum Failure {
    /// It was called wrongly: status 2.
    Usage(String),
    /// The device or the operation failed: status 1. One to four lines.
    Failed(Vec<String>),
    /// Whoever reads our output has gone: nothing more to say.
    NobodyReads,
}

/// What a command comes to.
pub type Result<T = Done> = std::result::Result<T, Failure>;

/// What arguments ask for.
pub enum Asked {
    /// A command, which has ended with this status.
    Command(u8),
    /// The window.
    Window(Window),
}

/// What the window is to begin with.
#[derive(Debug, Default)]
pub struct Window {
    /// A link to open.
    pub link: Option<LinkUrl>,
    /// A profile to open.
    pub profile: Option<PathBuf>,
    /// What the options give to kinds of device.
    pub given: Given,
}

/// Runs the command that the arguments of a process name, the first of which is the program's name; without one the window is
/// asked for. Profiles are read in these formats; these are the kinds of device that there are commands for.
pub fn run(words: impl IntoIterator<Item = OsString>, formats: Formats, commands: Commands) -> Asked {
    let arguments = match args::parse_arguments(words, commands) {
        Ok(arguments) => arguments,
        Err(error) => {
            output::say_usage(&error);
            return Asked::Command(u8::try_from(error.exit_code()).unwrap_or(2));
        }
    };
    let Arguments { common, profile, command } = arguments;
    match command {
        Some(_) if profile.is_some() => {
            Asked::Command(end(Err(usage("--profile is for the window, without a command"))))
        }
        Some(command) => {
            output::log_to_stderr();
            Asked::Command(end(call(&common, command, &Output::new(common.json, formats, commands))))
        }
        None => window(common, profile),
    }
}

/// Says why there is no window. Returns the status with which the process ends.
pub fn no_window(why: &str) -> u8 {
    end(Err(Failure::Failed(vec![why.to_owned()])))
}

fn window(common: Common, profile: Option<PathBuf>) -> Asked {
    if common.only_master {
        return Asked::Command(end(Err(usage("--only-master needs a command; the window asks"))));
    }
    if common.json || common.trace.is_some() {
        return Asked::Command(end(Err(usage("--json and --trace need a command; encoder-studio help lists them"))));
    }
    match common.given() {
        Ok(given) => Asked::Window(Window { link: common.link, profile, given }),
        Err(failure) => Asked::Command(end(Err(failure))),
    }
}

fn usage(message: &str) -> Failure {
    Failure::Usage(message.to_owned())
}

fn end(result: Result) -> u8 {
    match result {
        Ok(Done::Well) | Err(Failure::NobodyReads) => 0,
        Ok(Done::Differs) => 3,
        Err(Failure::Failed(lines)) => {
            for (at, line) in lines.iter().enumerate() {
                output::say(&format!("{}{line}\n", if at == 0 { "error: " } else { "" }));
            }
            1
        }
        Err(Failure::Usage(message)) => {
            output::say(&format!("error: {message}\n"));
            2
        }
    }
}

fn call(common: &Common, called: Called, output: &Output) -> Result {
    match called {
        Called::Shared(command) => dispatch(common, command, output),
        Called::Own(command, matches) => command.run(common, output, &matches),
    }
}

fn dispatch(common: &Common, command: Command, output: &Output) -> Result {
    let device = |name: &str| output.commands().device(name);
    let no_foreign = |id: CommandId, name: &str, own: &OwnOptions| match output.commands().foreign_option(id, name, own)
    {
        Some(why) => Err(Failure::Usage(why)),
        None => Ok(()),
    };
    match command {
        Command::Ports => ports::ports(output),
        Command::Find(find) => {
            no_foreign(CommandId::Find, &find.device, &find.own)?;
            device(&find.device)?.find(common, output, &find)
        }
        Command::Identify(on) => device(&on.device)?.identify(common, output),
        Command::Status(status) => {
            no_foreign(CommandId::Status, &status.device, &status.own)?;
            device(&status.device)?.status(common, output, &status)
        }
        Command::Position(position) => {
            no_foreign(CommandId::Position, &position.device, &position.own)?;
            device(&position.device)?.position(common, output, &position)
        }
        Command::Read(read) => {
            no_foreign(CommandId::Read, &read.device, &read.own)?;
            device(&read.device)?.read(common, output, &read)
        }
        Command::Save(save) => {
            no_foreign(CommandId::Save, &save.device, &save.own)?;
            let replaces = consent::replaces(&save.file, save.force)?;
            let done = device(&save.device)?.save(common, output, &save)?;
            replaces.said(output);
            Ok(done)
        }
        Command::Write(write) => {
            no_foreign(CommandId::Write, &write.device, &write.own)?;
            device(&write.device)?.write(common, output, &write)
        }
        Command::Do(act) => {
            no_foreign(CommandId::Do, &act.device, &act.own)?;
            device(&act.device)?.act(common, output, &act)
        }
        Command::Decode(decode) => {
            no_foreign(CommandId::Decode, &decode.protocol, &decode.own)?;
            match output.commands().protocol(&decode.protocol) {
                Some(protocol) => protocol.decode(output, &decode),
                None => device(&decode.protocol)?.decode(output, &decode),
            }
        }
        Command::Simulate(simulate) => {
            no_foreign(CommandId::Simulate, &simulate.device, &simulate.own)?;
            simulate::simulate(output, &simulate)
        }
        Command::Diff(diff) => profiles::diff(common, output, &diff),
        Command::Verify(verify) => profiles::verify(common, output, &verify.file),
        Command::Restore(restore) => profiles::restore(common, output, &restore),
    }
}
