//! Errors of the adapter in front of an encoder. The encoder itself reports errors only in its words.

use crate::buses::bridge::procedures::{AdapterError, Failure};
use crate::link::LinkError;
use crate::link::line::LineError;

#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Error {
    #[error(transparent)]
    Link(#[from] LinkError),
    #[error(transparent)]
    Adapter(#[from] AdapterError),
    #[error("cancelled")]
    Cancelled,
}

impl From<Failure> for Error {
    fn from(failure: Failure) -> Self {
        match failure {
            Failure::Adapter(error) => Error::Adapter(error),
            Failure::Line(error) => error.into(),
        }
    }
}

impl From<LineError> for Error {
    fn from(error: LineError) -> Self {
        match error {
            LineError::Cancelled => Error::Cancelled,
            LineError::Link(error) => Error::Link(error),
            // Packets do not have to be separated by silence.
            LineError::NeverSilent => Error::Adapter(AdapterError::Silent),
        }
    }
}
