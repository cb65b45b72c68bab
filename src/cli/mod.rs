//! The command line: the same jobs without a window. It parses, asks for consent and prints; the work is done by the
//! worker.

mod analyse;
pub(crate) mod args;
pub(crate) mod check;
pub(crate) mod consent;
pub(crate) mod decode;
pub(crate) mod kind;
pub(crate) mod number;
pub(crate) mod output;
pub(crate) mod patience;
pub(crate) mod plan;
mod ports;
pub(crate) mod positions;
pub(crate) mod profiles;
pub(crate) mod runner;
pub(crate) mod simulate;

use crate::buses::ethernet_ip::commands as ethernet_ip;
use crate::devices::hiperdrive::commands as hiperdrive;
use crate::devices::ssi::commands as ssi;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;

use args::{Arguments, Command, Common, DeviceKind, OfDrive, Protocol, Words};
use output::Output;

use crate::devices::hiperface::protocol::{AccessCode, CodeNumber};
use crate::link::LinkUrl;
use crate::profile::Formats;

/// How a command ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Done {
    /// As it should: status 0.
    Well,
    /// `diff` or `verify` found differences: status 3.
    Differs,
}

/// Why a command did not do what it should.
#[derive(Debug)]
pub(crate) enum Failure {
    /// It was called wrongly: status 2.
    Usage(String),
    /// The device or the operation failed: status 1. One to four lines.
    Failed(Vec<String>),
    /// Whoever reads our output has gone: nothing more to say.
    NobodyReads,
}

pub(crate) type Result<T = Done> = std::result::Result<T, Failure>;

/// What the arguments of this process ask for.
pub enum Asked {
    /// A command, which has ended like this.
    Command(ExitCode),
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
    /// Access codes that the user knows.
    pub codes: Vec<(CodeNumber, AccessCode)>,
}

/// Runs the command that the arguments of this process name; without one the window is asked for. Profiles are read in these
/// formats.
pub fn run(formats: Formats) -> Asked {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) => {
            output::say_usage(&error);
            return Asked::Command(ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(2)));
        }
    };
    let Arguments { common, profile, command } = arguments;
    match command {
        Some(_) if profile.is_some() => {
            Asked::Command(end(Err(usage("--profile is for the window, without a command"))))
        }
        Some(command) => {
            output::log_to_stderr();
            Asked::Command(end(dispatch(&common, command, formats)))
        }
        None => window(common, profile),
    }
}

/// Says why there is no window, and how the process ends.
pub fn no_window(why: &str) -> ExitCode {
    end(Err(Failure::Failed(vec![why.to_owned()])))
}

fn window(common: Common, profile: Option<PathBuf>) -> Asked {
    if common.only_master {
        return Asked::Command(end(Err(usage("--only-master needs a command; the window asks"))));
    }
    if common.json || common.trace.is_some() {
        return Asked::Command(end(Err(usage("--json and --trace need a command; encoder-studio help lists them"))));
    }
    match runner::codes(&common) {
        Ok(codes) => {
            let codes = codes.into_iter().map(|code| (code.number, code.code)).collect();
            Asked::Window(Window { link: common.link, profile, codes })
        }
        Err(failure) => Asked::Command(end(Err(failure))),
    }
}

fn usage(message: &str) -> Failure {
    Failure::Usage(message.to_owned())
}

fn end(result: Result) -> ExitCode {
    match result {
        Ok(Done::Well) | Err(Failure::NobodyReads) => ExitCode::SUCCESS,
        Ok(Done::Differs) => ExitCode::from(3),
        Err(Failure::Failed(lines)) => {
            for (at, line) in lines.iter().enumerate() {
                output::say(&format!("{}{line}\n", if at == 0 { "error: " } else { "" }));
            }
            ExitCode::FAILURE
        }
        Err(Failure::Usage(message)) => {
            output::say(&format!("error: {message}\n"));
            ExitCode::from(2)
        }
    }
}

fn dispatch(common: &Common, command: Command, formats: Formats) -> Result {
    let output = Output::new(common.json, formats);
    match command {
        Command::Ports => ports::ports(&output),
        Command::Find(find) => (kind::of(find.device).find)(common, &output, &find),
        Command::Identify(on) => (kind::of(on.device).identify)(common, &output),
        Command::Status(status) => {
            no_layout(status.layout.as_ref(), status.device)?;
            (kind::of(status.device).status)(common, &output, &status)
        }
        Command::Position(position) => {
            no_layout(position.layout.as_ref(), position.device)?;
            no_drive(&position.of, position.device)?;
            (kind::of(position.device).position)(common, &output, &position)
        }
        Command::Read(read) => {
            no_drive(&read.of, read.device)?;
            (kind::of(read.device).read)(common, &output, &read)
        }
        Command::Save(save) => {
            no_layout(save.layout.as_ref(), save.device)?;
            let replaces = consent::replaces(&save.file, save.force)?;
            let done = (kind::of(save.device).save)(common, &output, &save)?;
            replaces.said(&output);
            Ok(done)
        }
        Command::Write(write) => {
            no_drive(&write.of, write.device)?;
            (kind::of(write.device).write)(common, &output, &write)
        }
        Command::Move(target) => hiperdrive::drive_to(common, &output, &target),
        Command::Do(act) => {
            no_drive(&act.of, act.device)?;
            if act.all && act.device != DeviceKind::Hiperdrive {
                return Err(args::no_option("--all", kind::of(act.device).name));
            }
            (kind::of(act.device).act)(common, &output, &act)
        }
        Command::Decode(decode) => {
            no_words(&decode.words, decode.protocol)?;
            match decode.protocol.device() {
                Some(device) => (kind::of(device).decode)(&output, &decode),
                None => ethernet_ip::decode(&output, &decode.hex),
            }
        }
        Command::Analyse(capture) => analyse::analyse(&output, &capture),
        Command::Ssi(command) => ssi::ssi(&output, &command),
        Command::Simulate(simulate) => {
            no_layout(simulate.layout.as_ref(), simulate.device)?;
            simulate::simulate(&output, &simulate)
        }
        Command::Diff(diff) => profiles::diff(common, &output, &diff),
        Command::Verify(verify) => profiles::verify(common, &output, &verify.file),
        Command::Restore(restore) => profiles::restore(common, &output, &restore),
    }
}

/// Other devices tell themselves how what they send is made.
fn no_layout(layout: Option<&String>, device: DeviceKind) -> Result<()> {
    match layout {
        Some(_) if device != DeviceKind::Ssi => Err(usage("--layout is for ssi devices; others tell that themselves")),
        _ => Ok(()),
    }
}

/// Only behind a hub there are several.
fn no_drive(of: &OfDrive, device: DeviceKind) -> Result<()> {
    match of.drive {
        Some(_) if device != DeviceKind::Hiperdrive => Err(args::no_option("--drive", kind::of(device).name)),
        _ => Ok(()),
    }
}

/// What other devices send says itself which way it went.
fn no_words(words: &Words, protocol: Protocol) -> Result<()> {
    match words.foreign_to(protocol) {
        Some((option, of)) => Err(Failure::Usage(format!("{option} is for the words of {of} devices"))),
        None => Ok(()),
    }
}
