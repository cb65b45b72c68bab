//! The command line, which offers the same functions as the window. This module parses arguments, asks for consent and
//! prints results. The worker executes the jobs.

pub(crate) mod args;
pub(crate) mod check;
pub(crate) mod commands;
pub(crate) mod consent;
pub(crate) mod decode;
mod log;
pub(crate) mod number;
pub(crate) mod output;
pub mod plan;
mod ports;
pub(crate) mod positions;
pub(crate) mod profiles;
mod report;
pub(crate) mod runner;
pub(crate) mod simulate;
pub(crate) mod slow_reply_notice;
pub(crate) mod undo;
mod user_store;

use std::ffi::OsString;
use std::path::PathBuf;

use args::{Arguments, ParsedCommand};

pub use args::{
    ActionArgs, Command, CommonArgs, ConsentArgs, DecodeArgs, FindArgs, Position, Read, Restore, SaveArgs,
    SimulateArgs, Status, Write, command,
};
pub use commands::{CliCommand, CommandId, Commands, DeviceCommands, KindOptions, ProfileCommands, ProtocolDecoder};
pub use consent::{check_wear, confirm_plan, require_consent};
pub use output::{Lines, Output};
pub use positions::{print_readings, try_readings};
pub use profiles::{UnrestoredItems, profile_to_restore, restore_options, save_profile, write_restore};
pub use runner::{CliDevice, JobFailure, Runner, to_failure, unexpected_output};
pub use simulate::{ServableDevice, settings};
pub use slow_reply_notice::ReplyTiming;

use crate::app::{KindRegistry, TypeMap};
use crate::link::LinkUrl;

/// Ways in which a command can succeed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Success {
    /// The command found no errors and no differences. The exit status is 0.
    Completed,
    /// `diff` or `verify` has found differences. The exit status is 3.
    ValueDifference,
}

#[derive(Debug)]
pub enum Failure {
    /// The command line was used incorrectly. The exit status is 2.
    Usage(String),
    /// The device or the operation has failed. The message has one to four lines, and the exit status is 1.
    Failed(Vec<String>),
    /// The program that reads the output has closed the pipe, so nothing more can be printed.
    OutputClosed,
}

pub type Result<T = Success> = std::result::Result<T, Failure>;

/// Action that the program arguments request.
pub enum Invocation {
    Command(u8),
    Window(Window),
}

#[derive(Debug, Default)]
pub struct Window {
    pub link: Option<LinkUrl>,
    pub profile: Option<PathBuf>,
    pub given: TypeMap,
}

/// Runs the command given by the arguments of a process, which start with the program name. Without a command, requests
/// the window. `kinds` are the device kinds with their profiles, and `commands` are the available commands.
pub fn run(words: impl IntoIterator<Item = OsString>, kinds: KindRegistry, commands: Commands) -> Invocation {
    let arguments = match args::parse_arguments(words, commands) {
        Ok(arguments) => arguments,
        Err(error) => {
            output::print_usage_error(&error);
            return Invocation::Command(u8::try_from(error.exit_code()).unwrap_or(2));
        }
    };
    let Arguments { common, profile, command } = arguments;
    match command {
        Some(_) if profile.is_some() => {
            Invocation::Command(exit_code(Err(usage_error("--profile is for the window, without a command"))))
        }
        Some(command) => {
            output::log_to_stderr();
            let output = Output::new(common.json, kinds, commands);
            let status = exit_code(run_command(&common, command, &output));
            user_store::finish_entries(&common, &output);
            Invocation::Command(status)
        }
        None => open_window(common, profile),
    }
}

/// Prints the reason why the window cannot open, and returns the exit status.
pub fn report_window_error(why: &str) -> u8 {
    exit_code(Err(Failure::Failed(vec![why.to_owned()])))
}

fn open_window(common: CommonArgs, profile: Option<PathBuf>) -> Invocation {
    if common.only_master {
        return Invocation::Command(exit_code(Err(usage_error(
            "--only-master needs a command; the window asks instead",
        ))));
    }
    if common.json || common.trace.is_some() {
        return Invocation::Command(exit_code(Err(usage_error(
            "--json and --trace need a command; encoder-studio help lists them",
        ))));
    }
    match common.kind_option_values() {
        Ok(given) => Invocation::Window(Window { link: common.link, profile, given }),
        Err(failure) => Invocation::Command(exit_code(Err(failure))),
    }
}

fn usage_error(message: &str) -> Failure {
    Failure::Usage(message.to_owned())
}

fn exit_code(result: Result) -> u8 {
    match result {
        Ok(Success::Completed) | Err(Failure::OutputClosed) => 0,
        Ok(Success::ValueDifference) => 3,
        Err(Failure::Failed(lines)) => {
            for (at, line) in lines.iter().enumerate() {
                output::write_stderr(&format!("{}{line}\n", if at == 0 { "error: " } else { "" }));
            }
            1
        }
        Err(Failure::Usage(message)) => {
            output::write_stderr(&format!("error: {message}\n"));
            2
        }
    }
}

fn run_command(common: &CommonArgs, called: ParsedCommand, output: &Output) -> Result {
    match called {
        ParsedCommand::Shared(command) => dispatch(common, &command, output),
        ParsedCommand::Own(command, matches) => command.run(common, output, &matches),
    }
}

fn dispatch(common: &CommonArgs, command: &Command, output: &Output) -> Result {
    let (id, chosen, own) = match command {
        Command::Ports => return ports::ports(output),
        Command::Log(log) => return log::log(common, output, log),
        Command::Undo(undo) => return undo::undo(common, output, undo),
        Command::Diff(diff) => return profiles::diff(common, output, diff),
        Command::Report(report) => {
            let done = report::report(common, output, report)?;
            if common.link.is_some() {
                assign_asset(common, output, command);
            }
            return Ok(done);
        }
        Command::Verify(verify) => return profiles::verify_profile(common, output, &verify.file),
        Command::Restore(restore) => {
            let done = profiles::restore(common, output, restore)?;
            assign_asset(common, output, command);
            return Ok(done);
        }
        Command::Find(find) => (CommandId::Find, &find.device, &find.own),
        Command::Identify(identify) => (CommandId::Identify, &identify.device, &identify.own),
        Command::Status(status) => (CommandId::Status, &status.device, &status.own),
        Command::Position(position) => (CommandId::Position, &position.device, &position.own),
        Command::Read(read) => (CommandId::Read, &read.device, &read.own),
        Command::Save(save) => (CommandId::Save, &save.device, &save.own),
        Command::Write(write) => (CommandId::Write, &write.device, &write.own),
        Command::Do(act) => (CommandId::Do, &act.device, &act.own),
        Command::Decode(decode) => (CommandId::Decode, &decode.protocol, &decode.own),
        Command::Simulate(simulate) => (CommandId::Simulate, &simulate.device, &simulate.own),
    };
    if let Some(why) = output.commands().foreign_option_error(id, chosen, own) {
        return Err(Failure::Usage(why));
    }
    let run = || {
        let lacking = || Err(usage_error(&format!("{} is not for {chosen} devices", id.name())));
        output.commands().device(chosen)?.run(common, output, command).unwrap_or_else(lacking)
    };
    let done = match (command, output.commands().protocol(chosen)) {
        (Command::Simulate(simulate), _) => simulate::run_simulation(output, simulate),
        (Command::Decode(decode), Some(protocol)) => protocol.decode(output, decode),
        (Command::Save(save), _) => {
            let replaces = consent::confirm_replacement(&save.file, save.force)?;
            let done = run()?;
            replaces.report_replacement(output);
            Ok(done)
        }
        _ => run(),
    }?;
    assign_asset(common, output, command);
    Ok(done)
}

/// Assigns the device to the asset of a command that has succeeded.
fn assign_asset(common: &CommonArgs, output: &Output, command: &Command) {
    common.log.complete();
    if command.asset().is_some_and(|asset| !common.log.assign(asset)) {
        output
            .print_message("The asset was not recorded: the device was not identified, or the logbook cannot be used.");
    }
}
