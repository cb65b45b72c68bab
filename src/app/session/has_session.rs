//! A device on the desk, or a profile of one, whatever its kind.

use super::{Kind, Session};

/// Whoever is shown in a session. What is the same for all rests on this.
pub trait HasSession {
    /// Its kind.
    type Device: Kind;

    /// What every session has.
    fn session(&self) -> &Session<Self::Device>;

    /// The same, to be changed.
    fn session_mut(&mut self) -> &mut Session<Self::Device>;
}
