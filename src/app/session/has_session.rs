//! A device on the desk, or a profile of one, whatever its kind.

use super::{Kind, Session};

/// A device with a session.
pub trait HasSession {
    /// Its kind.
    type Device: Kind;

    /// Returns the session.
    fn session(&self) -> &Session<Self::Device>;

    /// The same, to be changed.
    fn session_mut(&mut self) -> &mut Session<Self::Device>;
}
