//! Reasons why a file is not a valid profile.

use super::Cause;
use crate::bits::HexError;
use crate::expected::AllowedValues;

/// The reason why a file is not a valid profile.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ProfileError {
    /// The file is not valid RON.
    #[error("line {line}, column {column}: {what}")]
    Syntax {
        /// Line number, starting at 1.
        line: usize,
        /// Column number, starting at 1.
        column: usize,
        /// Description of the problem.
        what: SyntaxErrorKind,
    },
    /// An unknown entry name resembles that of a missing entry.
    #[error("line {line}, column {column}: {path} is unknown, and {intended} is missing")]
    Misspelt {
        /// Line number, starting at 1.
        line: usize,
        /// Column number, starting at 1.
        column: usize,
        /// Path of the entry, such as `fields[2].statsu`.
        path: String,
        /// Name of the missing entry.
        intended: String,
    },
    /// The schema version is missing, or is newer than supported where a supported version is required.
    #[error("schema {found} is not supported (supported: 1 to {known})")]
    Schema {
        /// Version in the file.
        found: u32,
        /// Newest supported version.
        known: u32,
    },
    /// The profile is for an unknown kind of device.
    #[error("device {found:?} is not supported (supported: {})", quoted_list(known))]
    Device {
        /// Kind of device in the file.
        found: String,
        /// Known kinds of device.
        known: Vec<&'static str>,
    },
    /// The profile is for a kind of device other than the required one.
    #[error("the profile is for a {found} device, not for a {wanted} device")]
    OtherKind {
        /// Kind of device in the file.
        found: &'static str,
        /// Required kind of device.
        wanted: &'static str,
    },
    /// A required entry is missing.
    #[error("{path} is missing")]
    Missing {
        /// Path of the entry, such as `fields[2].status`.
        path: String,
    },
    /// An entry has the wrong type.
    #[error("{path} must be {expected}")]
    Shape {
        /// Path of the entry.
        path: String,
        /// Description of the expected value.
        expected: AllowedValues,
    },
    /// An entry does not contain valid bytes.
    #[error("{path}: {problem}")]
    Bytes {
        /// Path of the entry.
        path: String,
        /// Description of the problem.
        problem: HexError,
    },
    /// A value or combination of values is invalid for the kind of device.
    #[error("{path}: {cause}")]
    Refused {
        /// Path of the entry.
        path: String,
        /// Device-specific reason.
        cause: Cause,
    },
}

/// A violation of RON syntax, or of the stricter rules for RON in profiles.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SyntaxErrorKind {
    /// Structures are nested too deeply.
    #[error("the structures are nested too deeply")]
    TooDeep,
    /// A name occurs twice in the same structure.
    #[error("{0} appears twice")]
    Twice(String),
    /// Message of the RON parser.
    #[error("{0}")]
    Parser(String),
}

impl ProfileError {
    /// Creates an error for an entry that is invalid for the kind of device.
    pub fn invalid_entry<E: std::error::Error + Clone + Eq + Send + Sync + 'static>(path: String, error: E) -> Self {
        ProfileError::Refused { path, cause: Cause::new(error) }
    }
}

fn quoted_list(kinds: &[&str]) -> String {
    let kinds: Vec<String> = kinds.iter().map(|kind| format!("{kind:?}")).collect();
    match kinds.split_last() {
        Some((last, before)) if !before.is_empty() => format!("{} and {last}", before.join(", ")),
        _ => kinds.concat(),
    }
}
