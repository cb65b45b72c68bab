//! Reasons why the logbook server cannot be used, grouped by what the user can do about them.

use std::error::Error as _;
use std::io;
use std::path::PathBuf;

use tokio_postgres::error::SqlState;

use super::super::LogbookError;
use super::address::ServerAddressError;

/// An error with the name of the server on which it occurred.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("logbook server {server}: {problem}")]
pub struct ServerError {
    /// Host, port and database.
    pub server: String,
    pub problem: ServerErrorKind,
}

#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ServerErrorKind {
    /// The setting or environment variable contains no valid server address.
    #[error(transparent)]
    Address(ServerAddressError),
    /// The host name does not resolve to an address.
    #[error("the host is unknown")]
    UnknownHost,
    /// The server does not accept connections, or the connection was lost.
    #[error("the server cannot be reached: {why}")]
    Unreachable { why: UnreachableCause },
    #[error("the server did not reply in time")]
    NoReply,
    /// The server requires a password, but none is known.
    #[error("the server requires a password")]
    PasswordMissing,
    #[error("the password or the user name is wrong")]
    WrongPassword,
    /// The server does not accept this user, computer or type of connection.
    #[error("the server rejects the connection: {why}")]
    Rejected { why: String },
    #[error("the database does not exist")]
    NoDatabase,
    /// The certificate of the server is not trusted or is not valid for the host.
    #[error("the encrypted connection failed: {why}")]
    Encryption { why: String },
    /// A certificate file cannot be used.
    #[error("{path} contains no usable certificate: {why}")]
    Certificates { path: PathBuf, why: String },
    /// The database user lacks a required permission.
    #[error("the user of the database lacks a right: {what}")]
    NoRights { what: String },
    #[error("the disk of the server is full")]
    DiskFull,
    /// The tables were created by a newer version of the program.
    #[error("the server uses schema {found} of a newer version; this version supports schemas up to {known}")]
    Newer {
        found: i64,
        /// Latest schema that this version of the program supports.
        known: i64,
    },
    /// The tables were created by an older version, and this user has no permission to update them.
    #[error("the server uses the older schema {found}, and the user of the database may not update it to {known}")]
    Older { found: i64, known: i64 },
    /// Another program on this computer has switched the local logbook to another server.
    #[error("another program on this computer uses another logbook server")]
    OtherServer,
    /// The logbook on this computer cannot be used.
    #[error(transparent)]
    Local(LogbookError),
    #[error("{what}")]
    Database {
        /// Error code from the SQL standard, or `None` if the error is not from the server.
        code: Option<String>,
        what: String,
    },
}

/// The reason why a server cannot be reached.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum UnreachableCause {
    /// The connection was refused.
    #[error("connection refused")]
    Refused,
    /// There is no network route to the address.
    #[error("no route to the server")]
    NoRoute,
    /// The server or the network closed the connection.
    #[error("connection lost")]
    Lost,
    /// The message from the server or the system.
    #[error("{0}")]
    Other(String),
}

impl UnreachableCause {
    pub(super) fn from_io(error: &io::Error) -> Self {
        match error.kind() {
            io::ErrorKind::ConnectionRefused => UnreachableCause::Refused,
            io::ErrorKind::HostUnreachable
            | io::ErrorKind::NetworkUnreachable
            | io::ErrorKind::NetworkDown
            | io::ErrorKind::AddrNotAvailable => UnreachableCause::NoRoute,
            io::ErrorKind::ConnectionReset
            | io::ErrorKind::ConnectionAborted
            | io::ErrorKind::NotConnected
            | io::ErrorKind::BrokenPipe
            | io::ErrorKind::UnexpectedEof => UnreachableCause::Lost,
            _ => {
                // The number of the error tells the user nothing.
                let message = error.to_string();
                let words = message.rsplit_once(" (os error ").map_or(message.as_str(), |(words, _)| words);
                UnreachableCause::Other(words.to_owned())
            }
        }
    }
}

impl ServerErrorKind {
    pub(super) fn into_error(self, server: &str) -> ServerError {
        ServerError { server: server.to_owned(), problem: self }
    }
}

impl From<tokio_postgres::Error> for ServerErrorKind {
    fn from(error: tokio_postgres::Error) -> Self {
        if let Some(database) = error.as_db_error() {
            let what = database.message().to_owned();
            return match database.code() {
                code if *code == SqlState::INVALID_PASSWORD => ServerErrorKind::WrongPassword,
                code if *code == SqlState::INVALID_AUTHORIZATION_SPECIFICATION => {
                    ServerErrorKind::Rejected { why: what }
                }
                code if *code == SqlState::INVALID_CATALOG_NAME => ServerErrorKind::NoDatabase,
                code if *code == SqlState::INSUFFICIENT_PRIVILEGE => ServerErrorKind::NoRights { what },
                code if *code == SqlState::DISK_FULL => ServerErrorKind::DiskFull,
                code if *code == SqlState::QUERY_CANCELED => ServerErrorKind::NoReply,
                code if *code == SqlState::IDLE_IN_TRANSACTION_SESSION_TIMEOUT => ServerErrorKind::NoReply,
                code if UNAVAILABLE_SERVER_CODES.contains(&code.code()) => {
                    ServerErrorKind::Unreachable { why: UnreachableCause::Other(what) }
                }
                code => ServerErrorKind::Database { code: Some(code.code().to_owned()), what },
            };
        }
        let cause = error.source();
        if let Some(source) = cause.and_then(|cause| cause.downcast_ref()) {
            return from_io(source);
        }
        if error.is_closed() {
            return ServerErrorKind::Unreachable { why: UnreachableCause::Lost };
        }
        ServerErrorKind::Database { code: None, what: cause.map_or_else(|| error.to_string(), ToString::to_string) }
    }
}

/// Codes of a server that is starting up, is shutting down, has crashed or has no free connection.
const UNAVAILABLE_SERVER_CODES: [&str; 5] = ["57P01", "57P02", "57P03", "53300", "08006"];

fn from_io(error: &io::Error) -> ServerErrorKind {
    match error.kind() {
        _ if error.get_ref().is_some_and(|inner| inner.is::<rustls::Error>()) => {
            ServerErrorKind::Encryption { why: error.to_string() }
        }
        io::ErrorKind::TimedOut => ServerErrorKind::NoReply,
        _ => ServerErrorKind::Unreachable { why: UnreachableCause::from_io(error) },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reason_omits_system_error_number() {
        let cause = |error: io::Error| match from_io(&error) {
            ServerErrorKind::Unreachable { why } => why,
            other => panic!("{other:?}"),
        };
        assert_eq!(cause(io::ErrorKind::ConnectionRefused.into()), UnreachableCause::Refused);
        assert_eq!(cause(io::ErrorKind::ConnectionReset.into()), UnreachableCause::Lost);
        assert_eq!(cause(io::ErrorKind::HostUnreachable.into()), UnreachableCause::NoRoute);
        let message = io::Error::from_raw_os_error(1).to_string();
        assert!(message.contains("os error 1"), "{message}");
        let UnreachableCause::Other(words) = cause(io::Error::from_raw_os_error(1)) else { panic!("no message") };
        assert_eq!(format!("{words} (os error 1)"), message);
        assert_eq!(cause(io::Error::other("no entropy")), UnreachableCause::Other("no entropy".to_owned()));
    }
}
