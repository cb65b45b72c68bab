//! Values supplied to a kind of device from outside: start options, or substitutes in tests. The application does not
//! know their types.

use std::any::{Any, TypeId};
use std::collections::HashMap;
use std::fmt;
use std::sync::Arc;

use crate::link::LinkUrl;
use crate::store::Store;
use crate::worker::{Device, OpenError, Session};

/// A map of values for kinds of devices, at most one of each type.
#[derive(Clone, Default)]
pub struct TypeMap(HashMap<TypeId, Arc<dyn Any + Send + Sync>>);

impl TypeMap {
    /// Adds a value, replacing any earlier value of the same type.
    #[must_use]
    pub fn with_value<T: Send + Sync + 'static>(mut self, value: T) -> Self {
        self.0.insert(TypeId::of::<T>(), Arc::new(value));
        self
    }

    pub fn get<T: Send + Sync + 'static>(&self) -> Option<&T> {
        self.0.get(&TypeId::of::<T>())?.downcast_ref()
    }
}

/// Prints only the number of values, because they may be secret.
impl fmt::Debug for TypeMap {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Given({})", self.0.len())
    }
}

type OpenFn<D> = dyn Fn(&LinkUrl, Store) -> Result<Session<D>, OpenError> + Send + Sync;

/// A function that replaces the usual way of opening links for a kind of device, in tests.
pub struct LinkOpener<D: Device>(Box<OpenFn<D>>);

impl<D: Device> LinkOpener<D> {
    pub fn new(open: impl Fn(&LinkUrl, Store) -> Result<Session<D>, OpenError> + Send + Sync + 'static) -> Self {
        LinkOpener(Box::new(open))
    }

    /// Opens a link.
    ///
    /// # Errors
    /// Returns an [`OpenError`] if the link cannot be opened.
    pub(super) fn open(&self, url: &LinkUrl, store: Store) -> Result<Session<D>, OpenError> {
        (self.0)(url, store)
    }
}

impl<D: Device> fmt::Debug for LinkOpener<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Opener")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, PartialEq)]
    struct Secret(u8);

    #[test]
    fn keeps_one_value_per_type() {
        let given = TypeMap::default()
            .with_value(Secret(0x9D))
            .with_value(String::from("first"))
            .with_value(String::from("second"));
        assert_eq!(given.get::<Secret>(), Some(&Secret(0x9D)));
        assert_eq!(given.get::<String>().map(String::as_str), Some("second"));
        assert_eq!(given.get::<u8>(), None);
        assert_eq!(format!("{given:?}"), "Given(2)");
        assert_eq!(given.clone().get::<Secret>(), Some(&Secret(0x9D)), "a copy of the world has them too");
    }
}
