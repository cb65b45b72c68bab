//! Entry point of the program. Arguments run a command or open the window.

use std::process::ExitCode;

use encoder_studio::cli::{self, Invocation};
use encoder_studio::kinds::program;
use encoder_studio::ui;

fn main() -> ExitCode {
    let program = program();
    match cli::run(std::env::args_os(), program.studio, program.commands) {
        Invocation::Command(status) => ExitCode::from(status),
        Invocation::Window(start) => match ui::run(start, program.studio, program.tabs) {
            Ok(()) => ExitCode::SUCCESS,
            Err(why) => ExitCode::from(cli::report_window_error(&why)),
        },
    }
}
