//! The tabs of the window.

use std::collections::BTreeSet;
use std::fmt;
use std::sync::{Mutex, PoisonError};

use serde::de::{EnumAccess, Error, VariantAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// A tab of the window, for a kind of device or a tool. The settings store it by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Tab(&'static str);

impl Tab {
    /// Creates a tab with a name. The name is stored in the users' settings and must never change.
    pub const fn named(name: &'static str) -> Self {
        Tab(name)
    }

    pub fn name(self) -> &'static str {
        self.0
    }
}

/// The first tab is the default if the settings name none.
impl Default for Tab {
    fn default() -> Self {
        Tab("First")
    }
}

impl Serialize for Tab {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_unit_variant("Tab", 0, self.0)
    }
}

impl<'de> Deserialize<'de> for Tab {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_enum("Tab", &[], TabVisitor)
    }
}

struct TabVisitor;

impl<'de> Visitor<'de> for TabVisitor {
    type Value = Tab;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("the name of a tab")
    }

    fn visit_enum<A: EnumAccess<'de>>(self, data: A) -> Result<Tab, A::Error> {
        let (TabName(name), variant) = data.variant()?;
        variant.unit_variant()?;
        Ok(Tab(intern_name(name)))
    }
}

/// The name of a tab, as stored in the settings.
struct TabName(String);

impl<'de> Deserialize<'de> for TabName {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct NameVisitor;
        impl Visitor<'_> for NameVisitor {
            type Value = TabName;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a name")
            }

            fn visit_str<E: Error>(self, name: &str) -> Result<TabName, E> {
                Ok(TabName(name.to_owned()))
            }
        }
        deserializer.deserialize_identifier(NameVisitor)
    }
}

/// Returns a static string with the given tab name.
///
/// Unknown names are included, because another version of the program may still use the links of such a tab. Each name
/// is stored once and kept until the process ends.
fn intern_name(name: String) -> &'static str {
    static NAMES: Mutex<BTreeSet<&'static str>> = Mutex::new(BTreeSet::new());
    let mut names = NAMES.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(known) = names.get(name.as_str()) {
        return known;
    }
    let name: &'static str = name.leak();
    names.insert(name);
    name
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn serializes_tab_as_name() {
        let tab: Tab = ron::from_str("Canopen").unwrap();
        assert_eq!(tab, Tab::named("Canopen"), "also one that no kind has");
        assert_eq!(ron::to_string(&tab).unwrap(), "Canopen");
        for broken in ["\"Canopen\"", "Canopen(1)", "7", ""] {
            assert!(ron::from_str::<Tab>(broken).is_err(), "{broken}");
        }
    }
}
