//! What is wrong with a link, a setting, a profile, a table or the logbook: the part of a sentence that says why. What
//! the system or a library says is quoted as it is.

#[cfg(test)]
pub(crate) mod tests;

use super::{expected, file, plain};
use crate::app::{COMMON, Text};
use crate::link::{TraceFileError, UrlError};
use crate::profile::ProfileError;
use crate::sim::ConfigError;
use crate::store::{LogbookError, LogbookProblem};

/// What lower floors say in phrases: what a value may be, what is wrong with an entry, names of
/// what can be read. The first that fits counts.
const PHRASES: &[&str] = &[
    "phrase.no_link",
    "phrase.link_device",
    "phrase.bridge",
    "phrase.no_parameter",
    "phrase.unknown_parameter",
    "phrase.port",
    "phrase.file",
    "phrase.host",
    "phrase.no_setting",
    "phrase.sim_adapter",
    "phrase.no_fault",
    "phrase.fault_probability",
    "phrase.fault_number",
    "phrase.whole_number",
    "phrase.byte",
    "phrase.number",
    "phrase.text_such_as",
    "phrase.text",
    "phrase.flag",
    "phrase.hex_lines",
    "phrase.structure",
    "phrase.names",
    "phrase.list",
    "phrase.too_deep",
    "phrase.field_twice",
    "phrase.program_twice",
    "phrase.cam_twice",
    "phrase.program_outside",
    "phrase.cam_outside",
    "phrase.ib_no_item",
    "phrase.ib_measured",
    "phrase.bank_twice",
    "phrase.bank_order",
    "phrase.bank_outside",
    "phrase.banks",
    "phrase.bytes_expected",
    "phrase.release",
    "phrase.mounting_item",
    "phrase.four_tenths",
    "phrase.ssi_codes",
    "phrase.ssi_over",
    "phrase.ssi_directions",
    "phrase.ssi_meanings",
    "phrase.ssi_word",
    "phrase.ssi_revolutions_text",
    "phrase.ssi_which",
    "phrase.ssi_not_with",
    "phrase.twice",
    "phrase.no_status",
    "phrase.locked_bytes",
    "phrase.no_bytes",
    "phrase.bytes_status",
    "phrase.no_item",
    "phrase.hex_digit",
    "phrase.hex_odd",
    "phrase.no_trace",
    "phrase.trace_line",
    "phrase.log_access",
    "phrase.log_protected",
    "phrase.log_locked",
    "phrase.log_full",
    "phrase.log_damaged",
    "phrase.log_newer",
    "phrase.log_entry",
    "phrase.item_range",
    "phrase.item_rest",
    "phrase.item_field",
    "phrase.item_status",
    "phrase.item_analogue",
    "phrase.item_counter",
    "phrase.item_address",
    "phrase.item_settings",
    "phrase.item_position",
    "phrase.item_code",
    "phrase.item_encoder",
    "phrase.item_fields",
    "phrase.another_status",
    "phrase.ssi_position",
    "phrase.ssi_parity",
    "phrase.ssi_error_bits",
    "phrase.ssi_patterns",
    "phrase.ssi_clocks",
    "phrase.ssi_area",
    "phrase.ssi_wide",
    "phrase.ssi_between",
    "phrase.ssi_overlap",
    "phrase.ssi_behind",
    "phrase.ssi_many",
    "phrase.ssi_not_gray",
    "phrase.ssi_inside_coded",
    "phrase.ssi_inside_shifted",
    "phrase.ssi_lost",
    "phrase.ssi_repeat",
    "phrase.ssi_pattern_bits",
    "phrase.ssi_field_bits",
    "phrase.ssi_single",
    "phrase.ssi_revolutions",
    "phrase.ssi_odd",
    "phrase.ssi_digits",
    "phrase.ssi_lc_form",
    "phrase.ssi_lc_kind",
    "phrase.ssi_lc_two",
    "phrase.ssi_lc_none",
    "phrase.ssi_lc_long",
    "phrase.ssi_lc_gray_over",
    "phrase.ssi_lc_between",
    "phrase.ssi_lc_inverted",
];

/// A phrase of a lower floor, which speaks English: recognised by its words.
pub fn phrase(words: &str) -> Text {
    PHRASES.iter().find_map(|id| COMMON.recognised(id, words)).unwrap_or_else(|| plain(words))
}

/// A phrase of a lower layer, some arguments of which are phrases themselves.
pub fn phrase_with(words: &str, arguments: &[(&'static str, String)]) -> Text {
    arguments.iter().fold(phrase(words), |text, (name, words)| text.replacing(name, &phrase(words)))
}

/// A text that is no link, or a parameter that it does not take.
pub fn url(error: &UrlError) -> Text {
    match error {
        UrlError::Target { scheme, what } => {
            Text::new("detail.needs").with("scheme", scheme).with_text("what", phrase(what))
        }
        UrlError::Port { scheme, port } => Text::new("detail.no_port").with("scheme", scheme).with("port", port),
        UrlError::Value { name, value, allowed } => Text::new("detail.parameter")
            .with("name", name)
            .with("value", value)
            .with_text("allowed", expected(allowed)),
        UrlError::Scheme(_)
        | UrlError::Device { .. }
        | UrlError::Parameter(_)
        | UrlError::Twice(_)
        | UrlError::Unknown { .. } => phrase(&error.to_string()),
    }
}

/// A setting that a virtual encoder does not take.
pub fn setting(error: &ConfigError) -> Text {
    match error {
        ConfigError::Value { key, value, allowed } => {
            Text::new("detail.setting").with("name", key).with("value", value).with_text("allowed", expected(allowed))
        }
        ConfigError::Key { .. } | ConfigError::Fault(_) => phrase(&error.to_string()),
    }
}

/// A text that is no profile.
pub fn document(error: &ProfileError) -> Text {
    match error {
        ProfileError::Syntax { line, column, what } => syntax(*line, *column, what),
        ProfileError::Misspelt { line, column, path, meant } => Text::new("detail.misspelt")
            .with("line", line)
            .with("column", column)
            .with("path", path)
            .with("meant", meant),
        ProfileError::Missing { path } => Text::new("detail.missing").with("path", path),
        ProfileError::Shape { path, expected } => {
            Text::new("detail.shape").with("path", path).with_text("expected", phrase(expected))
        }
        ProfileError::Value { path, what } => {
            Text::new("detail.value").with("path", path).with_text("what", phrase(what))
        }
        ProfileError::Refused { path, cause } => {
            let what = phrase_with(&cause.to_string(), cause.arguments());
            Text::new("detail.value").with("path", path).with_text("what", what)
        }
        // These have sentences of their own.
        ProfileError::Schema { .. } | ProfileError::Device { .. } | ProfileError::OtherKind { .. } => plain(error),
    }
}

/// A file that is no recording.
pub fn recording(error: &TraceFileError) -> Text {
    match error {
        TraceFileError::Hex { line, source } => {
            Text::new("detail.in_line").with("line", line).with_text("what", phrase(&source.to_string()))
        }
        TraceFileError::Header | TraceFileError::Line { .. } => phrase(&error.to_string()),
    }
}

/// A logbook that cannot be used.
pub fn logbook_problem(error: &LogbookError) -> Text {
    let problem = match &error.problem {
        LogbookProblem::Folder(error) => file(error),
        problem => phrase(&problem.to_string()),
    };
    Text::new("detail.logbook").with("path", error.path.display()).with_text("problem", problem)
}

/// A place in a text, and what is wrong there.
pub(crate) fn syntax(line: usize, column: usize, what: &str) -> Text {
    Text::new("detail.syntax").with("line", line).with("column", column).with_text("what", phrase(what))
}
