//! Output as text in columns or as a single JSON object.

use std::io::{self, Write};

use serde_json::Value;

use super::{Commands, Failure};
use crate::app::KindRegistry;
use crate::profile::ProfileFormats;

pub struct Output {
    json: bool,
    kinds: KindRegistry,
    commands: Commands,
}

/// Lines that each have a label and a value, printed in aligned columns.
#[derive(Default)]
pub struct Lines(Vec<(String, String)>);

impl Lines {
    pub fn add_line(&mut self, label: impl Into<String>, value: impl ToString) -> &mut Self {
        self.0.push((label.into(), value.to_string()));
        self
    }

    pub fn text(&self) -> String {
        let width = self.0.iter().map(|(label, _)| label.chars().count()).max().unwrap_or(0);
        self.0.iter().map(|(label, value)| format!("{label:width$}  {value}").trim_end().to_owned() + "\n").collect()
    }
}

impl Output {
    pub(super) fn new(json: bool, kinds: KindRegistry, commands: Commands) -> Self {
        Output { json, kinds, commands }
    }

    pub(crate) fn as_text(&self) -> Self {
        Output { json: false, kinds: self.kinds, commands: self.commands }
    }

    pub(super) fn is_json(&self) -> bool {
        self.json
    }

    pub(super) fn formats(&self) -> ProfileFormats {
        self.kinds.formats
    }

    pub(super) fn kinds(&self) -> KindRegistry {
        self.kinds
    }

    pub(super) fn commands(&self) -> Commands {
        self.commands
    }

    pub fn show(&self, json: &Value, text: &str) -> Result<(), Failure> {
        if self.json {
            self.write_stdout(&format!("{json}\n"))
        } else {
            self.write_stdout(&show_control_characters(text))
        }
    }

    pub fn write_stdout(&self, printed: &str) -> Result<(), Failure> {
        let mut out = io::stdout().lock();
        match out.write_all(printed.as_bytes()).and_then(|()| out.flush()) {
            Ok(()) => Ok(()),
            Err(error) if is_closed_pipe(&error) => Err(Failure::OutputClosed),
            Err(error) => Err(Failure::Failed(vec![format!("Could not print the result: {error}.")])),
        }
    }

    /// Prints the result of a write like [`show`](Self::show). If printing fails, the error also reports the write,
    /// because it has already taken place.
    pub(super) fn show_write_result(&self, json: &Value, text: &str) -> Result<(), Failure> {
        self.show(json, text).map_err(|failure| match failure {
            Failure::Failed(lines) => {
                let written = "The write to the device was completed and read back.".to_owned();
                Failure::Failed(std::iter::once(written).chain(lines).collect())
            }
            other => other,
        })
    }

    /// Prints a message in addition to the result.
    pub fn print_message(&self, text: &str) {
        write_stderr(&format!("{text}\n"));
    }
}

/// Returns whether an error means that the reader of the output has closed the pipe. Windows has several codes for
/// this. The standard library recognises all of them except 233, "no process is on the other end of the pipe".
fn is_closed_pipe(error: &io::Error) -> bool {
    error.kind() == io::ErrorKind::BrokenPipe || cfg!(windows) && error.raw_os_error() == Some(233)
}

/// Returns a number with its noun, such as `1 data field` or `3 data fields`.
pub(crate) fn count(number: usize, noun: &str) -> String {
    let ending = if number == 1 { "" } else { "s" };
    format!("{number} {noun}{ending}")
}

/// Prints help text unchanged, or the message of an argument error joined into one line and followed by the usage.
pub(super) fn print_usage_error(error: &clap::Error) {
    use clap::error::ErrorKind::{DisplayHelp, DisplayHelpOnMissingArgumentOrSubcommand, DisplayVersion};
    if matches!(error.kind(), DisplayHelp | DisplayHelpOnMissingArgumentOrSubcommand | DisplayVersion) {
        // An error that occurs while printing the help cannot be reported either.
        let _ = error.print();
        return;
    }
    let rendered = error.render().to_string();
    let (words, usage) = rendered.split_once("Usage:").unwrap_or((&rendered, ""));
    let words: Vec<&str> = words.lines().map(str::trim).filter(|line| !line.is_empty()).collect();
    write_stderr(&format!("{}\n", words.join(" ")));
    if let Some(usage) = usage.lines().next().filter(|usage| !usage.is_empty()) {
        write_stderr(&format!("usage:{usage}\n"));
    }
}

/// Writes to stderr. Errors are ignored because there is nowhere to report them.
pub(crate) fn write_stderr(text: &str) {
    let mut err = io::stderr().lock();
    let _ = err.write_all(show_control_characters(text).as_bytes()).and_then(|()| err.flush());
}

/// Replaces control characters with visible ones, so text from a file, a device or an argument cannot control the
/// terminal.
fn show_control_characters(text: &str) -> String {
    let mut shown = String::with_capacity(text.len());
    for c in text.chars() {
        if c.is_control() && c != '\n' { shown.extend(c.escape_default()) } else { shown.push(c) }
    }
    shown
}

/// Prints the program's warnings to stderr. Only the window also writes details to a log file.
pub(super) fn log_to_stderr() {
    let subscriber = tracing_subscriber::fmt()
        .with_writer(io::stderr)
        .with_ansi(false)
        .with_target(false)
        .without_time()
        .log_internal_errors(false)
        .with_max_level(tracing::Level::WARN)
        .finish();
    // If another subscriber is already set, that one remains.
    let _ = tracing::subscriber::set_global_default(subscriber);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn escapes_control_characters() {
        assert_eq!(show_control_characters("GB\u{1b}[31m\tÄ µ\r\u{9b}x\n"), "GB\\u{1b}[31m\\tÄ µ\\r\\u{9b}x\n");
    }
}
