//! What is asked of one kind of device, on its way through what knows no kind. It is put in typed and taken out typed; the
//! one place that can find another kind's is [`Payload::open`].

use std::any::Any;
use std::fmt;

use super::action::{Action, Done};
use super::studio::SessionId;

/// An action that a kind of device takes.
pub trait DeviceAction: Any + Send {}

/// An action, or a result of a task, for a device whose kind is not known on the way.
pub struct Payload(Box<dyn Any + Send>);

/// A payload reached a device of another kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the action is for another kind of device")]
pub struct WrongKind;

impl Payload {
    pub(super) fn of(content: impl Any + Send) -> Self {
        Payload(Box::new(content))
    }

    /// Returns what was put in.
    ///
    /// # Errors
    /// [`WrongKind`] where that is of another type.
    pub(super) fn open<T: Any>(self) -> Result<T, WrongKind> {
        self.0.downcast().map(|content| *content).map_err(|_| WrongKind)
    }
}

impl fmt::Debug for Payload {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Payload")
    }
}

impl Action {
    /// Returns an action for one device, as its kind takes it.
    pub fn device(id: SessionId, action: impl DeviceAction) -> Self {
        Action::Device(id, Payload::of(action))
    }
}

impl Done {
    /// Returns what a task of one device comes back with, as its kind takes it.
    pub(crate) fn device(id: SessionId, done: impl Any + Send) -> Self {
        Done::Device(id, Payload::of(done))
    }
}
