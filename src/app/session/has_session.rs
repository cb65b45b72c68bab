//! An open device, or a profile of one, of any kind.

use super::{Kind, Session};

pub trait HasSession {
    type Device: Kind;

    fn session(&self) -> &Session<Self::Device>;

    fn session_mut(&mut self) -> &mut Session<Self::Device>;
}
