//! Errors of a wire.

use std::io;

/// A wire that cannot be opened or is gone.
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
        /// The group that may, where the system tells.
        group: Option<String>,
    },
    /// Another program has it.
    #[error("in use by another program")]
    Busy,
    /// It exists and is no serial port.
    #[error("not a serial port")]
    NotAPort,
    /// Nothing listens at that address, or it cannot be reached.
    #[error("cannot be reached: {0}")]
    Unreachable(String),
    /// It was there and is gone: unplugged, or the connection was closed.
    #[error("connection lost")]
    Lost,
    /// The port cannot be set to this speed or parity.
    #[error("cannot be set to {0}")]
    Format(String),
    /// A recording has no answer to what was sent.
    #[error("the recording has no answer to {0}")]
    NotRecorded(String),
    /// Anything else the system says.
    #[error("{0}")]
    Other(String),
}

impl LinkError {
    /// An error at `target`.
    pub fn new(target: impl Into<String>, kind: LinkErrorKind) -> Self {
        LinkError { target: target.into(), kind }
    }

    /// An error while reading or writing an open wire: whatever the system calls it, an error there means that the
    /// other end is gone, except for what is plainly something else.
    pub(super) fn during_use(target: &str, error: &io::Error) -> Self {
        let kind = match error.kind() {
            io::ErrorKind::InvalidInput | io::ErrorKind::OutOfMemory => LinkErrorKind::Other(error.to_string()),
            _ => LinkErrorKind::Lost,
        };
        LinkError::new(target, kind)
    }

    /// The wire was open and is gone.
    pub fn is_lost(&self) -> bool {
        self.kind == LinkErrorKind::Lost
    }
}
