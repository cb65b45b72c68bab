//! Settings stored between runs: appearance, language, links, recent profiles and panel layout. If they cannot be read, the defaults
//! apply. This module does not access files.

use std::collections::BTreeMap;
use std::fmt;

use ron::error::SpannedError;
use serde::de::{Error as _, MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::Language;
use super::drives::{PartialDriveEntry, RememberedDrives};
use super::kinds::KindRegistry;
use super::tab::Tab;
use crate::store::UserName;

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum ColorScheme {
    #[default]
    Dark,
    Light,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Settings {
    pub theme: ColorScheme,
    pub language: Language,
    /// Links used in each tab, most recent first. They contain no access codes.
    links: Links,
    /// Layout of the panels. Only the window interprets it.
    pub layout: Option<String>,
    pub tab: Tab,
    /// Size of the window in points.
    pub size: Option<(u32, u32)>,
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub lower_open: bool,
    /// Whether the user has stopped live values. They then no longer start automatically.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub live_stopped: bool,
    /// Whether the Live panel shows values without a plot.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub values_alone: bool,
    /// Name of the company in reports.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub company: Option<String>,
    /// Path of the company's logo in reports, a PNG file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub company_logo: Option<String>,
    /// How the logbook refers to the user.
    #[serde(skip_serializing_if = "is_default")]
    pub user_name: UserName,
    /// Address of the server for a shared logbook, empty without a server, or [`UNKNOWN_LOGBOOK`](Self::UNKNOWN_LOGBOOK).
    /// It contains no password.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub logbook: String,
    /// Paths of the profiles opened or saved most recently, newest first.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    recent_profiles: Vec<String>,
    /// Stored data about drives, by the name of the device to which they are connected.
    drives: BTreeMap<String, RememberedDrives>,
}

impl Default for Settings {
    fn default() -> Self {
        Settings {
            theme: ColorScheme::Dark,
            language: Language::English,
            links: Links::default(),
            layout: None,
            tab: Tab::default(),
            size: None,
            lower_open: false,
            live_stopped: false,
            values_alone: false,
            company: None,
            company_logo: None,
            user_name: UserName::default(),
            logbook: String::new(),
            recent_profiles: Vec::new(),
            drives: BTreeMap::new(),
        }
    }
}

impl Settings {
    /// Returns the settings for the first run of the program.
    pub fn initial(kinds: KindRegistry) -> Self {
        Settings { tab: kinds.first_tab(), ..Settings::default() }
    }

    /// Value of [`logbook`](Self::logbook) after the setting could not be read. It also replaces the unreadable value in the
    /// file, because the logbook may be shared until the user enters an address or none.
    pub const UNKNOWN_LOGBOOK: &str = "unknown";

    /// Maximum number of links of a tab, and of recent profiles.
    const MAX_RECENT_ENTRIES: usize = 12;

    /// Parses settings.
    ///
    /// # Errors
    /// Returns the place of the first error if the text is not in the form that [`emit`](Self::emit) writes.
    pub fn parse(text: &str) -> Result<Self, SpannedError> {
        ron::from_str(text)
    }

    /// Returns the settings that apply while the file cannot be read. They name no user and assume a logbook server,
    /// because the file may require both.
    pub(super) fn unread(kinds: KindRegistry) -> Self {
        Settings { tab: kinds.first_tab(), ..Self::parse_partial("") }
    }

    /// Returns the readable part of a file that [`parse`](Self::parse) rejects. Entries are read one by one, so an
    /// unknown tab, for example, does not affect the links.
    pub(super) fn parse_partial(text: &str) -> Self {
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
            theme: entry!(theme: ColorScheme, usual.theme),
            language: entry!(language: Language, usual.language),
            links: entry!(
                links: Links,
                // This is the format from the time when there was only one kind of device.
                entry!(links: Vec<String>, Vec::new()).into_iter().rev().fold(Links::default(), |mut links, link| {
                    links.edit_links(Tab::default(), |own| own.insert(0, link));
                    links
                })
            ),
            layout: entry!(layout: Option<String>, usual.layout),
            tab: entry!(tab: Tab, usual.tab),
            size: entry!(size: Option<(u32, u32)>, usual.size),
            lower_open: entry!(lower_open: bool, usual.lower_open),
            live_stopped: entry!(live_stopped: bool, usual.live_stopped),
            values_alone: entry!(values_alone: bool, usual.values_alone),
            company: entry!(company: Option<String>, usual.company),
            company_logo: entry!(company_logo: Option<String>, usual.company_logo),
            user_name: {
                #[derive(Deserialize)]
                struct Own {
                    #[serde(default)]
                    user_name: UserName,
                }
                // The rules of the plant may forbid names.
                ron::from_str::<Own>(text).map_or(UserName::Off, |own| own.user_name)
            },
            logbook: {
                #[derive(Deserialize)]
                struct Own {
                    #[serde(default)]
                    logbook: String,
                }
                ron::from_str::<Own>(text).map_or_else(|_| Self::UNKNOWN_LOGBOOK.to_owned(), |own| own.logbook)
            },
            recent_profiles: entry!(recent_profiles: Vec<String>, usual.recent_profiles),
            drives: entry!(
                drives: BTreeMap<String, RememberedDrives>,
                // Unconfirmed limits stay unconfirmed, even if other parts are invalid.
                entry!(drives: BTreeMap<String, PartialDriveEntry>, BTreeMap::new())
                    .into_iter()
                    .map(|(device, locks)| (device, locks.into()))
                    .collect()
            ),
        }
    }

    /// Applies the changes from `known` to `ours` to these settings. Another window may have changed other parts in the
    /// meantime.
    #[must_use]
    pub(super) fn with_changes(mut self, known: &Settings, ours: &Settings) -> Self {
        macro_rules! take {
            ($($name:ident),*) => { $(if ours.$name != known.$name { self.$name = ours.$name.clone(); })* };
        }
        take!(
            theme,
            language,
            layout,
            tab,
            size,
            lower_open,
            live_stopped,
            values_alone,
            company,
            company_logo,
            user_name,
            logbook
        );
        self.apply_drive_changes(known, ours);
        for tab in ours.links.tabs() {
            let used = recently_used_entries(known.links_of(tab), ours.links_of(tab));
            used.iter().rev().for_each(|link| self.use_link(tab, link));
        }
        let used = recently_used_entries(&known.recent_profiles, &ours.recent_profiles);
        used.iter().rev().for_each(|path| self.use_profile(path));
        self
    }

    pub(super) fn apply_drive_changes(&mut self, known: &Settings, ours: &Settings) {
        let none = RememberedDrives::default();
        for (device, own) in &ours.drives {
            let before = known.drives.get(device).unwrap_or(&none);
            if own != before || !known.drives.contains_key(device) {
                let there = self.drives.remove(device).unwrap_or_default();
                self.drives.insert(device.clone(), there.with_changes(before, own));
            }
        }
    }

    pub(super) fn adopt_drive_data(&mut self, from: &Settings) {
        self.drives = from.drives.clone();
    }

    /// Returns the first unknown name in a valid file. It may be misspelt or come from a newer version.
    pub(super) fn unknown_name(text: &str) -> Option<String> {
        let ron::Value::Map(entries) = ron::from_str(text).ok()? else { return None };
        let known = setting_names();
        entries.keys().find_map(|key| match key {
            ron::Value::String(name) if !known.contains(&name.as_str()) => Some(name.clone()),
            _ => None,
        })
    }

    pub fn emit(&self) -> String {
        ron::ser::to_string_pretty(self, ron::ser::PrettyConfig::default()).unwrap_or_default()
    }

    pub(crate) fn drives(&self, device: &str) -> RememberedDrives {
        self.drives.get(device).cloned().unwrap_or_default()
    }

    pub(crate) fn remember_drives(&mut self, device: String, what: RememberedDrives) {
        self.drives.insert(device, what);
    }

    /// Returns the links used in a tab, most recent first.
    pub fn links_of(&self, tab: Tab) -> &[String] {
        self.links.links_of(tab)
    }

    /// Replaces an unknown tab with the first one.
    pub(super) fn replace_unknown_tab(&mut self, kinds: KindRegistry) {
        if !kinds.has_tab(self.tab) {
            self.tab = kinds.first_tab();
        }
        self.links.migrate_old_links(kinds.first_tab());
    }

    pub fn use_link(&mut self, tab: Tab, link: &str) {
        self.links.edit_links(tab, |links| move_to_front(links, link, Self::MAX_RECENT_ENTRIES));
    }

    /// Returns the paths of the profiles opened or saved most recently, newest first.
    pub fn recent_profiles(&self) -> &[String] {
        &self.recent_profiles
    }

    pub fn use_profile(&mut self, path: &str) {
        move_to_front(&mut self.recent_profiles, path, Self::MAX_RECENT_ENTRIES);
    }
}

/// Returns the names of the settings in a file.
fn setting_names() -> &'static [&'static str] {
    /// A deserialiser that only collects the field names of a structure.
    struct FieldNames<'n>(&'n mut &'static [&'static str]);
    impl<'de> Deserializer<'de> for FieldNames<'_> {
        type Error = serde::de::value::Error;

        fn deserialize_any<V: Visitor<'de>>(self, _: V) -> Result<V::Value, Self::Error> {
            Err(Self::Error::custom("only the names are of interest"))
        }

        fn deserialize_struct<V: Visitor<'de>>(
            self,
            _: &'static str,
            fields: &'static [&'static str],
            visitor: V,
        ) -> Result<V::Value, Self::Error> {
            *self.0 = fields;
            self.deserialize_any(visitor)
        }

        serde::forward_to_deserialize_any! {
            bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf option unit unit_struct
            newtype_struct seq tuple tuple_struct map enum identifier ignored_any
        }
    }
    let mut names: &[&str] = &[];
    let _ = Settings::deserialize(FieldNames(&mut names));
    names
}

fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

/// Links used in each tab. The tabs are in order of first use.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
struct Links(Vec<(Tab, Vec<String>)>);

impl Links {
    fn links_of(&self, tab: Tab) -> &[String] {
        self.0.iter().find(|(own, _)| *own == tab).map_or(&[], |(_, links)| links)
    }

    fn edit_links(&mut self, tab: Tab, change: impl FnOnce(&mut Vec<String>)) {
        if let Some((_, links)) = self.0.iter_mut().find(|(own, _)| *own == tab) {
            change(links);
        } else {
            let mut links = Vec::new();
            change(&mut links);
            self.0.push((tab, links));
        }
    }

    fn tabs(&self) -> impl Iterator<Item = Tab> {
        self.0.iter().map(|(tab, _)| *tab)
    }

    /// Moves links from an old file to the first tab. Such a file dates from when there was only one kind of device.
    fn migrate_old_links(&mut self, first: Tab) {
        let Some(at) = self.0.iter().position(|(tab, _)| *tab == Tab::default()) else { return };
        let (_, links) = self.0.remove(at);
        self.edit_links(first, |own| drop(own.splice(0..0, links)));
    }
}

impl Serialize for Links {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(tab, links)| (tab, links)))
    }
}

impl<'de> Deserialize<'de> for Links {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct LinksVisitor;
        impl<'de> Visitor<'de> for LinksVisitor {
            type Value = Links;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("links by tab")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Links, A::Error> {
                let mut links = Links::default();
                while let Some((tab, used)) = map.next_entry()? {
                    links.edit_links(tab, |own| *own = used);
                }
                Ok(links)
            }
        }
        deserializer.deserialize_map(LinksVisitor)
    }
}

/// Moves an entry to the beginning of a list of at most `limit` entries.
fn move_to_front(list: &mut Vec<String>, entry: &str, limit: usize) {
    list.retain(|known| known != entry);
    list.insert(0, entry.to_owned());
    list.truncate(limit);
}

/// Returns the entries of `ours` that were used since `known`. They precede the unchanged ones.
fn recently_used_entries<'o>(known: &[String], ours: &'o [String]) -> &'o [String] {
    let is_rest = |at: &usize| {
        let (used, rest) = ours.split_at(*at);
        let mut before = known.iter().filter(|entry| !used.contains(entry));
        rest.iter().all(|entry| before.next() == Some(entry))
    };
    let used = (0..=ours.len()).find(is_rest).unwrap_or(ours.len());
    ours.get(..used).unwrap_or(ours)
}

#[cfg(test)]
mod tests;
