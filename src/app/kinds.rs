//! The kinds of devices and the tools that a program supports. They are passed to the studio, which does not depend on
//! any particular one.

use std::fmt;

use super::devices::DeviceKind;
use super::logbook::LOGBOOK_TAB;
use super::tab::Tab;
use super::tool::ToolKind;
use super::{Text, explain};
use crate::link::LinkUrl;
use crate::profile::{Cause, ProfileFormats};

#[derive(Clone, Copy)]
pub struct KindRegistry {
    pub formats: ProfileFormats,
    devices: &'static [&'static dyn DeviceKind],
    tools: &'static [&'static dyn ToolKind],
}

impl fmt::Debug for KindRegistry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.devices.iter().map(|kind| kind.keyword())).finish()
    }
}

impl KindRegistry {
    pub const NONE: KindRegistry = KindRegistry::new(ProfileFormats::new(&[]), &[], &[]);

    pub const fn new(
        formats: ProfileFormats,
        devices: &'static [&'static dyn DeviceKind],
        tools: &'static [&'static dyn ToolKind],
    ) -> Self {
        KindRegistry { formats, devices, tools }
    }

    pub fn devices(self) -> &'static [&'static dyn DeviceKind] {
        self.devices
    }

    pub(super) fn tools(self) -> &'static [&'static dyn ToolKind] {
        self.tools
    }

    /// Returns the kind of device shown in a tab, or `None` for a tool or an unknown tab.
    pub(super) fn kind_for_tab(self, tab: Tab) -> Option<&'static dyn DeviceKind> {
        self.devices.iter().copied().find(|kind| kind.tab() == tab)
    }

    pub(crate) fn for_profile(self, word: &str) -> Option<&'static dyn DeviceKind> {
        self.devices.iter().copied().find(|kind| kind.keyword() == word)
    }

    /// Returns the reason why a profile was rejected. If no kind of device recognises the cause, its English message is
    /// returned.
    pub(super) fn explain_rejection(self, cause: &Cause) -> Text {
        self.devices
            .iter()
            .find_map(|kind| kind.explain_rejection(cause))
            .unwrap_or_else(|| explain::literal_text(cause))
    }

    /// Returns the display name of an item in a profile or the logbook. `manual_name` is the name in the manual, if the
    /// item is an address. For an unknown kind of device, the name from the command line is returned.
    pub fn item_name(self, kind: &str, item: &str, manual_name: Option<&str>) -> Text {
        self.for_profile(kind).and_then(|kind| kind.item_name(item, manual_name)).unwrap_or_else(|| match manual_name {
            Some(name) => explain::literal_text(format!("{item} {name}")),
            None => explain::literal_text(item),
        })
    }

    /// Returns a link in the form in which it may be displayed and stored. Parameters that are secret for any kind of
    /// device are removed, because the link may be meant for another kind.
    pub fn display_link(self, url: &LinkUrl) -> String {
        let secrets: Vec<&str> = self.devices.iter().flat_map(|kind| kind.secret_parameters()).collect();
        let query: Vec<String> =
            url.query.without(&secrets).into_iter().map(|(name, value)| format!("{name}={value}")).collect();
        let question = if query.is_empty() { "" } else { "?" };
        format!("{}:{}{question}{}", url.scheme.keyword(), url.target, query.join("&"))
    }

    /// Returns the first device tab, or the first tool tab if there are no devices.
    pub(super) fn first_tab(self) -> Tab {
        let device = self.devices.first().map(|kind| kind.tab());
        device.or_else(|| self.tools.first().map(|kind| kind.tab())).unwrap_or_default()
    }

    pub(super) fn has_tab(self, tab: Tab) -> bool {
        tab == LOGBOOK_TAB || self.kind_for_tab(tab).is_some() || self.tools.iter().any(|kind| kind.tab() == tab)
    }
}
