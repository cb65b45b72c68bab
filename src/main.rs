//! The program: arguments → a command.

use std::process::ExitCode;

fn main() -> ExitCode {
    encoder_studio::cli::run()
}
