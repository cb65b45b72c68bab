//! How links are opened, by kind of device: as the kind says, or as a test puts in its place.

use std::any::{Any, TypeId};
use std::collections::HashMap;
use std::sync::Arc;

use crate::link::LinkUrl;
use crate::store::Store;
use crate::worker::{Device, OpenError, Session};

/// Opens links to a kind of device.
type Opener<D> = Arc<dyn Fn(&LinkUrl, Store) -> Result<Session<D>, OpenError> + Send + Sync>;

/// What opens links in place of a kind's own way. Empty outside of tests.
#[derive(Clone, Default)]
pub struct Openers(HashMap<TypeId, Arc<dyn Any + Send + Sync>>);

impl Openers {
    /// Opens links to this kind of device so.
    #[must_use]
    pub fn with<D: Device>(
        mut self,
        open: impl Fn(&LinkUrl, Store) -> Result<Session<D>, OpenError> + Send + Sync + 'static,
    ) -> Self {
        let opener: Opener<D> = Arc::new(open);
        self.0.insert(TypeId::of::<D>(), Arc::new(opener));
        self
    }

    /// Returns what opens links to this kind of device; `None`: its own way.
    pub(super) fn get<D: Device>(&self) -> Option<&Opener<D>> {
        self.0.get(&TypeId::of::<D>())?.downcast_ref()
    }
}
