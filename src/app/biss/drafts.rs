//! Edits of an encoder's plain data, kept over a crash: global address and byte.

use super::encoder::Encoder;
use crate::app::services::Services;
use crate::app::session::{DraftDone, DraftKey, Source};
use crate::protocol::biss::KIND;
use crate::store::DeviceKey;

/// Edited bytes: global address, byte.
pub(in crate::app) type Edits = Vec<(u16, u8)>;

impl Encoder {
    /// Whose draft it is: a profile's, or an encoder's by manufacturer, device and serial number, because another device
    /// may have the same; `None` for an encoder that does not say who it is.
    fn draft_key(&self) -> Option<DraftKey> {
        match &self.session.source {
            Source::File { key, .. } => Some(DraftKey::of_file(KIND, key)),
            Source::Link(_) => {
                let DeviceKey { device_type, serial_number, is_virtual, .. } = self.key()?;
                let name = || format!("{device_type}-{serial_number}");
                (!serial_number.is_empty()).then(|| DraftKey::of_device(KIND, is_virtual, name()))
            }
        }
    }

    pub(super) fn load_draft(&mut self, services: &Services) {
        if let Some(key) = self.draft_key() {
            self.drafting.load(key, services);
        }
    }

    /// What was just saved has no edits: those of an earlier time are for what it replaced.
    pub(super) fn begin_draft(&mut self, services: &Services) {
        if let Some(key) = self.draft_key() {
            self.drafting.begin(key, services);
        }
    }

    /// Takes what a task comes back with.
    pub(in crate::app) fn take_draft(&mut self, done: DraftDone, services: &mut Services) {
        let (key, name, dirty) = (self.draft_key(), self.session.name(), self.memory.is_dirty());
        if let Some(edits) = self.drafting.take(done, key.as_ref(), dirty, &name, services) {
            self.memory.take_draft(edits);
            self.drafting.came_back(self.memory.edits(), &name, services);
        }
    }

    /// Keeps the edits when they have changed.
    pub(in crate::app) fn keep_draft(&mut self, services: &mut Services) {
        let nameless = self.serial_number().is_some_and(str::is_empty);
        if nameless && matches!(self.session.source, Source::Link(_)) && self.memory.is_dirty() {
            self.drafting.tell_of_none(&self.session.name(), services);
        }
        self.drafting.keep(self.draft_key(), self.memory.edits(), services);
    }

    /// Its edits come back after it was closed.
    pub(in crate::app) fn keeps_edits(&self) -> bool {
        self.drafting.has_looked() && self.draft_key().is_some()
    }

    /// Another encoder comes, or none: what is edited for this one stays on disk.
    pub(in crate::app) fn leave_draft(&mut self, services: &mut Services) {
        self.drafting.leave(self.draft_key(), self.memory.edits(), services);
    }

    /// The edits are in the file of `key` now: where that is another one, those for the one before are no draft any more.
    pub(super) fn forget_draft_unless(&mut self, key: &str, services: &mut Services) -> bool {
        let Source::File { key: own, .. } = &self.session.source else { return false };
        if own == key {
            return false;
        }
        self.drafting.forget(self.draft_key(), services);
        true
    }
}
