//! The device selected in each tab.

use std::collections::HashMap;

use super::AnyDevice;
use crate::app::kinds::KindRegistry;
use crate::app::studio::SessionId;
use crate::app::tab::Tab;

#[derive(Debug, Default)]
pub(crate) struct Selection {
    by_tab: HashMap<Tab, SessionId>,
    last: Option<SessionId>,
}

impl Selection {
    pub(crate) fn session_in_tab(&self, tab: Tab) -> Option<SessionId> {
        self.by_tab.get(&tab).copied()
    }

    /// Returns the device shown most recently in any tab.
    pub(in crate::app) fn last(&self) -> Option<SessionId> {
        self.last
    }

    pub(in crate::app) fn select_session(&mut self, tab: Tab, id: SessionId) {
        self.by_tab.insert(tab, id);
        self.last = Some(id);
    }

    /// Removes a device. `left` contains the remaining devices.
    ///
    /// The tab of the removed device then shows its most recently opened device. If the removed device was the most
    /// recently shown one of all tabs, the device of the last tab takes its place.
    pub(in crate::app) fn remove(&mut self, kinds: KindRegistry, left: &[Box<AnyDevice>], id: SessionId) {
        for (tab, shown) in &mut self.by_tab {
            if *shown == id
                && let Some(other) = left.iter().rev().find(|device| device.tab() == *tab)
            {
                *shown = other.id();
            }
        }
        self.by_tab.retain(|_, shown| *shown != id);
        if self.last == Some(id) {
            let tabs = kinds.devices().iter().rev().map(|kind| kind.tab());
            self.last = tabs.filter_map(|tab| self.session_in_tab(tab)).next();
        }
    }
}
