//! Type-erased device errors for code that is common to all devices.

use std::any::Any;
use std::error::Error;
use std::fmt;

/// The device-specific reason why a profile entry is invalid. Display and comparison are those of the wrapped error.
pub struct Cause(Box<dyn DynCause>);

trait DynCause: Any + Error + Send + Sync {
    fn clone_boxed(&self) -> Box<dyn DynCause>;
    fn dyn_eq(&self, other: &dyn DynCause) -> bool;
}

impl<E: Error + Clone + Eq + Send + Sync + 'static> DynCause for E {
    fn clone_boxed(&self) -> Box<dyn DynCause> {
        Box::new(self.clone())
    }

    fn dyn_eq(&self, other: &dyn DynCause) -> bool {
        let other: &dyn Any = other;
        other.downcast_ref::<E>() == Some(self)
    }
}

impl Cause {
    /// Wraps a device-specific error.
    pub fn new<E: Error + Clone + Eq + Send + Sync + 'static>(error: E) -> Self {
        Cause(Box::new(error))
    }

    /// Returns the wrapped error if it has type `E`.
    pub fn get<E: Error + 'static>(&self) -> Option<&E> {
        let any: &dyn Any = self.0.as_ref();
        any.downcast_ref()
    }
}

impl Clone for Cause {
    fn clone(&self) -> Self {
        Cause(self.0.clone_boxed())
    }
}

impl fmt::Debug for Cause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(&self.0, f)
    }
}

impl fmt::Display for Cause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(&self.0, f)
    }
}

impl PartialEq for Cause {
    fn eq(&self, other: &Self) -> bool {
        self.0.dyn_eq(other.0.as_ref())
    }
}

impl Eq for Cause {}

impl Error for Cause {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        self.0.source()
    }
}
