//! The program: arguments → a command, or the window.

use std::process::ExitCode;

use encoder_studio::cli::{self, Asked};
use encoder_studio::kinds::{COMMANDS, FORMATS, TABS};
use encoder_studio::ui;

fn main() -> ExitCode {
    match cli::run(FORMATS, COMMANDS) {
        Asked::Command(code) => code,
        Asked::Window(start) => match ui::run(start, FORMATS, TABS) {
            Ok(()) => ExitCode::SUCCESS,
            Err(why) => cli::no_window(&why),
        },
    }
}
