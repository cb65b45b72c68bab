//! Reasons why a link, setting, profile, table or logbook cannot be used, as parts of a sentence. Messages from the
//! operating system or a library are quoted unchanged.

#[cfg(test)]
pub(crate) mod tests;

use super::{expected_text, file_error_text, literal_text};
use crate::app::{KindRegistry, Text};
use crate::bits::HexError;
use crate::link::{LinkScheme, TRACE_HEADER, TraceFileError, UrlError};
use crate::profile::{ProfileError, SyntaxErrorKind};
use crate::sim::{ConfigError, FaultError, VirtualDevice};
use crate::store::{LogbookError, LogbookErrorKind};

/// Returns the reason why a string is not a valid link, or why a link parameter is rejected.
pub fn url_error_text(error: &UrlError) -> Text {
    match error {
        UrlError::Scheme(text) => Text::new("url.no_link").with("text", format!("{text:?}")),
        UrlError::Device { scheme, known } => Text::new("url.other_device").with("scheme", scheme).with("known", known),
        UrlError::Target { scheme } => Text::new(match scheme {
            LinkScheme::Tcp => "url.needs_host_and_port",
            LinkScheme::Modbus => "url.needs_gateway",
            LinkScheme::Enip => "url.needs_device",
            LinkScheme::Bridge => "url.needs_adapter",
            LinkScheme::Replay => "url.needs_file",
            LinkScheme::Serial | LinkScheme::Sim => "url.needs_port",
        }),
        UrlError::Port { scheme, port } => Text::new("detail.no_port").with("scheme", scheme).with("port", port),
        UrlError::Parameter(text) => Text::new("url.no_parameter").with("text", format!("{text:?}")),
        UrlError::Twice(name) => Text::new("url.twice").with("name", name),
        UrlError::Unknown { name, scheme, known } => {
            Text::new("url.unknown").with("name", name).with("scheme", scheme).with("known", known)
        }
        UrlError::Value { name, value, allowed } => Text::new("detail.parameter")
            .with("name", name)
            .with("value", value)
            .with_text("allowed", expected_text(allowed)),
    }
}

pub fn setting_error_text(error: &ConfigError) -> Text {
    match error {
        ConfigError::Key { device, key, known } => {
            let device = match device {
                VirtualDevice::Encoder => Text::new("sim.encoder"),
                VirtualDevice::EncoderOf(name) => Text::new("sim.encoder_of").with("name", name),
                VirtualDevice::Adapter => Text::new("sim.adapter"),
                VirtualDevice::Device(name) => Text::new("sim.device").with("name", name),
            };
            Text::new("sim.no_setting").with_text("device", device).with("key", key).with("known", known)
        }
        ConfigError::Value { key, value, allowed } => Text::new("detail.setting")
            .with("name", key)
            .with("value", value)
            .with_text("allowed", expected_text(allowed)),
        ConfigError::Fault(FaultError::Unknown { item }) => Text::new("sim.no_fault").with("item", item),
        ConfigError::Fault(FaultError::Probability { item }) => Text::new("sim.fault_probability").with("item", item),
        ConfigError::Fault(FaultError::Number { item, min, max }) => {
            Text::new("sim.fault_number").with("item", item).with("min", min).with("max", max)
        }
    }
}

/// Returns the reason why a file is not a valid profile. `kinds` explain the values that they reject.
pub fn profile_error_text(error: &ProfileError, kinds: KindRegistry) -> Text {
    match error {
        ProfileError::Syntax { line, column, what } => syntax_error_text(*line, *column, syntax_problem(what)),
        ProfileError::Misspelt { line, column, path, intended } => Text::new("detail.misspelt")
            .with("line", line)
            .with("column", column)
            .with("path", path)
            .with("meant", intended),
        ProfileError::Missing { path } => Text::new("detail.missing").with("path", path),
        ProfileError::Shape { path, expected: shape } => {
            Text::new("detail.shape").with("path", path).with_text("expected", expected_text(shape))
        }
        ProfileError::Bytes { path, problem } => {
            Text::new("detail.value").with("path", path).with_text("what", hex_error_text(problem))
        }
        ProfileError::Refused { path, cause } => {
            Text::new("detail.value").with("path", path).with_text("what", kinds.explain_rejection(cause))
        }
        // These errors have separate messages.
        ProfileError::Schema { .. } | ProfileError::Device { .. } | ProfileError::OtherKind { .. } => {
            literal_text(error)
        }
    }
}

fn syntax_problem(problem: &SyntaxErrorKind) -> Text {
    match problem {
        SyntaxErrorKind::TooDeep => Text::new("detail.too_deep"),
        SyntaxErrorKind::Twice(name) => Text::new("detail.twice").with("name", name),
        SyntaxErrorKind::Parser(words) => literal_text(words),
    }
}

fn hex_error_text(error: &HexError) -> Text {
    match error {
        HexError::Digit(digit) => Text::new("detail.hex_digit").with("digit", format!("{digit:?}")),
        HexError::Odd(digits) => Text::new("detail.hex_odd").with("digits", format!("{digits:?}")),
    }
}

pub fn trace_error_text(error: &TraceFileError) -> Text {
    match error {
        TraceFileError::Header => Text::new("detail.no_trace").with("header", TRACE_HEADER),
        TraceFileError::Line { line } => Text::new("detail.trace_line").with("line", line),
        TraceFileError::Hex { line, source } => {
            Text::new("detail.in_line").with("line", line).with_text("what", hex_error_text(source))
        }
    }
}

pub fn logbook_problem(error: &LogbookError) -> Text {
    let problem = match &error.problem {
        LogbookErrorKind::Folder(error) => file_error_text(error),
        LogbookErrorKind::NoAccess => Text::new("logbook.access"),
        LogbookErrorKind::WriteProtected => Text::new("logbook.protected"),
        LogbookErrorKind::Locked => Text::new("logbook.locked"),
        LogbookErrorKind::DiskFull => Text::new("logbook.full"),
        LogbookErrorKind::Damaged { what } => Text::new("logbook.damaged").with("what", what),
        LogbookErrorKind::SetAside { kept } => Text::new("logbook.set_aside").with("kept", kept.display()),
        LogbookErrorKind::Newer { found, known } => {
            Text::new("logbook.newer").with("found", found).with("known", known)
        }
        LogbookErrorKind::NotOpen { entry } => Text::new("logbook.not_open").with("entry", entry),
        LogbookErrorKind::Database { what, .. } => literal_text(what),
    };
    Text::new("detail.logbook").with("path", error.path.display()).with_text("problem", problem)
}

/// Describes a syntax error and its location in a file.
pub(crate) fn syntax_error_text(line: usize, column: usize, what: Text) -> Text {
    Text::new("detail.syntax").with("line", line).with("column", column).with_text("what", what)
}
