//! Actions and results passed through code that does not know the type of the device. Only [`Payload::open`] detects an
//! action for another kind of device.

use std::any::Any;
use std::fmt;

use super::action::{Action, TaskResult};
use super::connect::form::Finder;
use super::studio::SessionId;
use super::tab::Tab;

pub trait DeviceAction: Any + Send {}

/// A type-erased action or task result for any kind of device.
pub struct Payload(Box<dyn Any + Send>);

/// The error for a payload that has reached the wrong kind of device.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the action is for another kind of device")]
pub struct PayloadKindError;

impl Payload {
    pub(in crate::app) fn new(content: impl Any + Send) -> Self {
        Payload(Box::new(content))
    }

    pub(in crate::app) fn contains<T: Any>(&self) -> bool {
        self.0.is::<T>()
    }

    /// Returns the content.
    ///
    /// # Errors
    /// Returns [`PayloadKindError`] if the content has a different type.
    pub fn open<T: Any>(self) -> Result<T, PayloadKindError> {
        self.0.downcast().map(|content| *content).map_err(|_| PayloadKindError)
    }
}

impl fmt::Debug for Payload {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Payload")
    }
}

impl Action {
    pub fn device(id: SessionId, action: impl DeviceAction) -> Self {
        Action::Device(id, Payload::new(action))
    }
}

impl TaskResult {
    /// Wraps the result of a task that a device has started.
    pub(crate) fn device(id: SessionId, done: impl Any + Send) -> Self {
        TaskResult::Device(id, Payload::new(done))
    }

    /// Wraps the result of a task started by the device search of a connection form.
    pub fn from_finder<F: Finder>(tab: Tab, done: F::TaskResult) -> Self {
        TaskResult::Finder(tab, Payload::new(done))
    }

    pub fn from_tool(tab: Tab, done: impl Any + Send) -> Self {
        TaskResult::Tool(tab, Payload::new(done))
    }
}
