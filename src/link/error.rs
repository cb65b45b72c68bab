//! Errors of a wire.

use std::io;

/// An error of a connection that cannot be opened or is lost.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{target}: {kind}")]
pub struct LinkError {
    /// Port, host or file, as the user named it.
    pub target: String,
    /// The kind of error.
    pub kind: LinkErrorKind,
}

/// The kind of an error of a wire.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LinkErrorKind {
    /// No such port, host or file.
    #[error("does not exist")]
    NotFound,
    /// The user may not open it.
    #[error("permission denied")]
    Permission {
        /// The group with permission, if the system names one.
        group: Option<String>,
    },
    /// Another program has it.
    #[error("in use by another program")]
    Busy,
    /// The path exists and is not a serial port.
    #[error("not a serial port")]
    NotAPort,
    /// Nothing listens at that address, or it cannot be reached.
    #[error("cannot be reached: {0}")]
    Unreachable(String),
    /// The connection was lost: unplugged, or closed by the other side.
    #[error("connection lost")]
    Lost,
    /// A recording has no answer to the request.
    #[error("cannot be set to {0}")]
    Format(String),
    /// Any other error of the system.
    #[error("the recording has no answer to {0}")]
    NotRecorded(String),
    /// Anything else the system says.
    #[error("{0}")]
    Other(String),
}

impl LinkError {
    /// Creates an error at `target`.
    pub fn new(target: impl Into<String>, kind: LinkErrorKind) -> Self {
        LinkError { target: target.into(), kind }
    }

    /// Converts an error of reading or writing an open connection: whatever the system calls it, it means that the
    /// connection is lost, except for errors that clearly mean something else.
    pub(super) fn during_use(target: &str, error: &io::Error) -> Self {
        let kind = match error.kind() {
            io::ErrorKind::InvalidInput | io::ErrorKind::OutOfMemory => LinkErrorKind::Other(error.to_string()),
            _ => LinkErrorKind::Lost,
        };
        LinkError::new(target, kind)
    }

    /// Returns whether the connection was open and is lost.
    pub fn is_lost(&self) -> bool {
        self.kind == LinkErrorKind::Lost
    }
}
