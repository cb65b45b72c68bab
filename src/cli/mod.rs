//! The command line: the same jobs without a window. It parses, asks for consent and prints; the work is done by the
//! worker.

mod args;
mod hiperface;
mod output;
mod ports;
mod runner;
mod simulate;

use std::process::ExitCode;

use clap::Parser;

use args::{Arguments, Command, DeviceKind};
use output::Output;

/// How a command ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Done {
    /// As it should: status 0.
    Well,
    /// `diff` or `verify` found differences: status 3.
    Differs,
}

/// Why a command did not do what it should.
#[derive(Debug)]
enum Failure {
    /// It was called wrongly: status 2.
    Usage(String),
    /// The device or the operation failed: status 1. One to four lines.
    Failed(Vec<String>),
    /// Whoever reads our output has gone: nothing more to say.
    NobodyReads,
}

type Result<T = Done> = std::result::Result<T, Failure>;

/// Runs the command that the arguments of this process name.
pub fn run() -> ExitCode {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) => {
            output::say_usage(&error);
            return ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(2));
        }
    };
    output::log_to_stderr();
    match dispatch(arguments) {
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

fn dispatch(arguments: Arguments) -> Result {
    let Arguments { common, command } = arguments;
    let output = Output::new(common.json);
    match command {
        Command::Ports => ports::ports(&output),
        Command::Find(find) => match find.device {
            DeviceKind::Hiperface => hiperface::find(&common, &output, &find),
        },
        Command::Identify(on) => match on.device {
            DeviceKind::Hiperface => hiperface::identify(&common, &output),
        },
        Command::Status(on) => match on.device {
            DeviceKind::Hiperface => hiperface::status(&common, &output),
        },
        Command::Position(position) => match position.device {
            DeviceKind::Hiperface => hiperface::position(&common, &output, &position),
        },
        Command::Read(read) => match read.device {
            DeviceKind::Hiperface => hiperface::read(&common, &output, &read.item),
        },
        Command::Save(save) => match save.device {
            DeviceKind::Hiperface => hiperface::save(&common, &output, &save),
        },
        Command::Write(write) => match write.device {
            DeviceKind::Hiperface => hiperface::write(&common, &output, &write),
        },
        Command::Do(act) => match act.device {
            DeviceKind::Hiperface => hiperface::act(&common, &output, &act),
        },
        Command::Decode(decode) => match decode.protocol {
            DeviceKind::Hiperface => hiperface::decode(&output, &decode.hex),
        },
        Command::Simulate(simulate) => match simulate.device {
            DeviceKind::Hiperface => simulate::simulate(&simulate),
        },
        // The kind of device is in the file.
        Command::Diff(diff) => hiperface::diff(&common, &output, &diff),
        Command::Verify(verify) => hiperface::verify(&common, &output, &verify.file),
        Command::Restore(restore) => hiperface::restore(&common, &output, &restore),
    }
}
