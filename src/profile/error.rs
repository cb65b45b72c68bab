//! The reasons why a text is not a profile.

use super::Cause;
use crate::bits::HexError;
use crate::expected::Expected;

/// The reason why a text is not a profile.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ProfileError {
    /// The text is not RON.
    #[error("line {line}, column {column}: {what}")]
    Syntax {
        /// Counted from 1.
        line: usize,
        /// Counted from 1.
        column: usize,
        /// The problem.
        what: SyntaxProblem,
    },
    /// The name of an entry is not known, and a similar one is missing.
    #[error("line {line}, column {column}: {path} is unknown, and {intended} is missing")]
    Misspelt {
        /// Counted from 1.
        line: usize,
        /// Counted from 1.
        column: usize,
        /// Path of the entry, such as `fields[2].statsu`.
        path: String,
        /// The name that is missing.
        intended: String,
    },
    /// The version of the form is missing, or newer than known where the whole profile has to be known.
    #[error("schema {found}; this program knows schema 1 to {known}")]
    Schema {
        /// The value in the file.
        found: u32,
        /// The newest known version.
        known: u32,
    },
    /// The kind of device has no profiles in this program.
    #[error("device {found:?}; this program knows {}", quoted(known))]
    Device {
        /// The value in the file.
        found: String,
        /// The known kinds.
        known: Vec<&'static str>,
    },
    /// A kind of device that this program saves, and not the one that is asked for.
    #[error("a profile of a {found} device where one of a {wanted} device is needed")]
    OtherKind {
        /// The value in the file.
        found: &'static str,
        /// The required value.
        wanted: &'static str,
    },
    /// Something has to be there and is not.
    #[error("{path} is missing")]
    Missing {
        /// Path of the entry, such as `fields[2].status`.
        path: String,
    },
    /// Something is of another kind.
    #[error("{path} must be {expected}")]
    Shape {
        /// Path of the entry.
        path: String,
        /// The expected value.
        expected: Expected,
    },
    /// Bytes that are none.
    #[error("{path}: {problem}")]
    Bytes {
        /// Path of the entry.
        path: String,
        /// The problem.
        problem: HexError,
    },
    /// An invalid value, or an invalid combination of values, with the error of the device.
    #[error("{path}: {cause}")]
    Refused {
        /// Path of the entry.
        path: String,
        /// The reason.
        cause: Cause,
    },
}

/// The reason why a text is not RON, or not RON of a profile.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SyntaxProblem {
    /// Structures in structures in structures.
    #[error("nested too deeply")]
    TooDeep,
    /// A name that a structure has twice.
    #[error("{0} appears twice")]
    Twice(String),
    /// The message of the parser.
    #[error("{0}")]
    Parser(String),
}

impl ProfileError {
    /// Creates the error for a device that refuses the entry at `path`.
    pub fn refused<E: std::error::Error + Clone + Eq + Send + Sync + 'static>(path: String, error: E) -> Self {
        ProfileError::Refused { path, cause: Cause::new(error) }
    }
}

fn quoted(kinds: &[&str]) -> String {
    let kinds: Vec<String> = kinds.iter().map(|kind| format!("{kind:?}")).collect();
    match kinds.split_last() {
        Some((last, before)) if !before.is_empty() => format!("{} and {last}", before.join(", ")),
        _ => kinds.concat(),
    }
}
