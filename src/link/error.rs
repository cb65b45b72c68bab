//! Errors of connections to devices.

use std::io;

/// An error of a connection that cannot be opened or was lost.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{target}: {kind}")]
pub struct LinkError {
    /// Port, host or file, as given by the user.
    pub target: String,
    /// Kind of error.
    pub kind: LinkErrorKind,
}

/// The kind of a connection error.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LinkErrorKind {
    /// The port, host or file does not exist.
    #[error("does not exist")]
    NotFound,
    /// The user has no permission to open the target.
    #[error("permission denied")]
    Permission {
        /// User group that has permission, if the system reports one.
        group: Option<String>,
    },
    /// Another program is using the target.
    #[error("in use by another program")]
    Busy,
    /// The path exists but is not a serial port.
    #[error("not a serial port")]
    NotAPort,
    /// Nothing listens at the address, or the address cannot be reached.
    #[error("cannot be reached: {0}")]
    Unreachable(String),
    /// The cable was unplugged, or the remote end closed the connection.
    #[error("connection lost")]
    Lost,
    /// The port cannot be set to the requested format.
    #[error("cannot be set to {0}")]
    Format(String),
    /// The replayed recording contains no reply to the request.
    #[error("the recording has no answer to {0}")]
    NotRecorded(String),
    /// Any other error reported by the operating system.
    #[error("{0}")]
    Other(String),
}

impl LinkError {
    /// Creates an error of the given kind for `target`.
    pub fn new(target: impl Into<String>, kind: LinkErrorKind) -> Self {
        LinkError { target: target.into(), kind }
    }

    /// Converts an I/O error on an open connection. An unknown error is treated as a lost connection.
    pub(super) fn from_io_error(target: &str, error: &io::Error) -> Self {
        let kind = match error.kind() {
            io::ErrorKind::InvalidInput | io::ErrorKind::OutOfMemory => LinkErrorKind::Other(error.to_string()),
            _ => LinkErrorKind::Lost,
        };
        LinkError::new(target, kind)
    }

    /// Returns whether an open connection was lost.
    pub fn is_lost(&self) -> bool {
        self.kind == LinkErrorKind::Lost
    }
}
