//! An open device or profile of any kind.

use super::{Kind, Session};

pub trait HasSession {
    type Device: Kind;

    fn session(&self) -> &Session<Self::Device>;

    fn session_mut(&mut self) -> &mut Session<Self::Device>;
}
