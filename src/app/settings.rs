//! What the studio remembers from one start to the next: looks, language, links, the arrangement of its panels. A text
//! that cannot be read costs the memory of a few clicks, and the defaults hold. Files are opened elsewhere.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::Language;
use super::hiperdrive::Remembered;
use super::tab::Tab;

/// Dark or light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Theme {
    /// Light text on dark surfaces.
    #[default]
    Dark,
    /// Dark text on light surfaces.
    Light,
}

/// Everything that is remembered.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Settings {
    /// Dark or light.
    pub theme: Theme,
    /// Language of the window.
    pub language: Language,
    /// Links used, the latest first, by the tab of the device; never with access codes, which are no part of a link.
    links: BTreeMap<Tab, Vec<String>>,
    /// Arrangement of the panels, which only the window reads.
    pub layout: Option<String>,
    /// The open tab.
    pub tab: Tab,
    /// Size of the window in points.
    pub size: Option<(u32, u32)>,
    /// What is remembered of drives, by the device that they are behind.
    drives: BTreeMap<String, Remembered>,
}

impl Default for Settings {
    fn default() -> Self {
        Settings {
            theme: Theme::Dark,
            language: Language::English,
            links: BTreeMap::new(),
            layout: None,
            tab: Tab::Hiperface,
            size: None,
            drives: BTreeMap::new(),
        }
    }
}

impl Settings {
    /// Links that are remembered.
    const LINKS: usize = 12;

    /// Reads settings; `None` when the text is not what [`emit`](Self::emit) writes.
    pub fn parse(text: &str) -> Option<Self> {
        ron::from_str(text).ok()
    }

    /// What can be read of a text that [`parse`](Self::parse) refuses, each entry by itself: a tab that this program does
    /// not know costs nobody his links.
    pub(super) fn salvage(text: &str) -> Self {
        macro_rules! entry {
            ($name:ident: $type:ty, $usual:expr) => {{
                #[derive(Deserialize)]
                struct Own {
                    $name: $type,
                }
                ron::from_str::<Own>(text).map_or($usual, |own| own.$name)
            }};
        }
        let usual = Settings::default();
        Settings {
            theme: entry!(theme: Theme, usual.theme),
            language: entry!(language: Language, usual.language),
            links: entry!(
                links: BTreeMap<Tab, Vec<String>>,
                // As it was while there was one kind of device.
                entry!(links: Vec<String>, Vec::new()).into_iter().rev().fold(BTreeMap::new(), |mut links, link| {
                    links.entry(Tab::Hiperface).or_insert_with(Vec::new).insert(0, link);
                    links
                })
            ),
            layout: entry!(layout: Option<String>, usual.layout),
            tab: entry!(tab: Tab, usual.tab),
            size: entry!(size: Option<(u32, u32)>, usual.size),
            drives: entry!(drives: BTreeMap<String, Remembered>, usual.drives),
        }
    }

    /// Takes over what was found on disk wherever nothing was set since the start.
    pub(super) fn stand_on(&mut self, found: Settings) {
        let usual = Settings::default();
        let since = std::mem::replace(self, found);
        macro_rules! keep {
            ($($name:ident),*) => { $(if since.$name != usual.$name { self.$name = since.$name; })* };
        }
        keep!(theme, language, layout, tab, size);
        self.drives.extend(since.drives);
        for (tab, links) in &since.links {
            links.iter().rev().for_each(|link| self.use_link(*tab, link));
        }
    }

    /// The settings as text.
    pub fn emit(&self) -> String {
        ron::ser::to_string_pretty(self, ron::ser::PrettyConfig::default()).unwrap_or_default()
    }

    /// What is remembered of the drives behind a device.
    pub(super) fn drives(&self, device: &str) -> Option<&Remembered> {
        self.drives.get(device)
    }

    /// What is to be remembered of them.
    pub(super) fn remember_drives(&mut self, device: String, what: Remembered) {
        self.drives.insert(device, what);
    }

    /// Links to the devices of a tab that were used, the latest first.
    pub fn links(&self, tab: Tab) -> &[String] {
        self.links.get(&tab).map_or(&[], Vec::as_slice)
    }

    /// Notes that a link was used.
    pub fn use_link(&mut self, tab: Tab, link: &str) {
        let links = self.links.entry(tab).or_default();
        links.retain(|known| known != link);
        links.insert(0, link.to_owned());
        links.truncate(Self::LINKS);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_come_back_and_unknown_ones_do_not_hurt() {
        let mut settings = Settings { theme: Theme::Light, language: Language::German, ..Settings::default() };
        settings.use_link(Tab::Hiperface, "serial:/dev/ttyUSB0");
        settings.layout = Some("(tiles: {})".to_owned());
        assert_eq!(Settings::parse(&settings.emit()), Some(settings));
        assert_eq!(Settings::parse("(theme: Light, colour: 7)").map(|s| s.theme), Some(Theme::Light));
        assert_eq!(Settings::parse("(theme: Mauve)"), None);
        assert_eq!(Settings::parse(""), None);
    }

    #[test]
    fn what_can_be_read_of_broken_settings_is_kept() {
        let mut settings = Settings { theme: Theme::Light, size: Some((1500, 900)), ..Settings::default() };
        settings.use_link(Tab::Hiperface, "serial:/dev/ttyUSB0");
        let broken = settings.emit().replace("tab: Hiperface", "tab: Gearbox");
        assert_eq!(Settings::parse(&broken), None);
        assert_eq!(Settings::salvage(&broken), settings);
        assert_eq!(Settings::salvage("(theme: Light, links: 7)").theme, Theme::Light);
        assert_eq!(Settings::salvage("(links: [\"sim:\"])").links(Tab::Hiperface), ["sim:"], "from before");
        assert!(Settings::salvage("no settings").links(Tab::Hiperface).is_empty());
    }

    #[test]
    fn what_was_set_since_the_start_stays() {
        let mut found = Settings { theme: Theme::Light, size: Some((1500, 900)), ..Settings::default() };
        found.use_link(Tab::Hiperface, "tcp:host:1");
        let mut settings = Settings { language: Language::German, ..Settings::default() };
        settings.use_link(Tab::Hiperface, "sim:");
        settings.stand_on(found);
        assert_eq!(
            (settings.theme, settings.language, settings.size),
            (Theme::Light, Language::German, Some((1500, 900)))
        );
        assert_eq!(settings.links(Tab::Hiperface), ["sim:", "tcp:host:1"]);
    }

    #[test]
    fn the_latest_link_comes_first_and_stands_once() {
        let mut settings = Settings::default();
        for at in 0..20 {
            settings.use_link(Tab::Hiperface, &format!("tcp:host:{at}"));
        }
        settings.use_link(Tab::Hiperface, "tcp:host:15");
        assert_eq!(settings.links(Tab::Hiperface).len(), 12);
        assert_eq!(settings.links(Tab::Hiperface)[..3], ["tcp:host:15", "tcp:host:19", "tcp:host:18"]);
    }
}
