//! Conversion between link parameters and the entries of a form. Parameters without an entry are preserved.

use std::collections::BTreeMap;

use super::target::{optional_entry, unusable_link_text};
use crate::app::{Text, explain};
use crate::link::{LinkScheme, LinkUrl, UrlQuery};
use crate::parameter::Entry;

/// The name and value of a link parameter.
pub(crate) type NameValuePair = (String, String);

/// Returns the link parameters that have no entry in the form. `take` fills in an entry and returns whether the entry
/// exists.
pub(crate) fn parameters_without_entry(
    query: &UrlQuery,
    mut take: impl FnMut(&str, &str) -> bool,
) -> Vec<NameValuePair> {
    query.pairs().iter().filter(|(name, value)| !take(name, value)).cloned().collect()
}

/// The strings typed into a form, by parameter name.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct EnteredValues(BTreeMap<&'static str, String>);

impl EnteredValues {
    /// Returns the string typed for a parameter. An empty string means the default.
    pub fn get(&self, key: &str) -> &str {
        self.0.get(key).map_or("", String::as_str)
    }

    pub fn set(&mut self, key: &'static str, text: impl Into<String>) {
        let text = text.into();
        if text.is_empty() {
            self.0.remove(key)
        } else {
            self.0.insert(key, text)
        };
    }

    /// Fills in an entry. Returns `false` if the entry does not exist.
    pub(crate) fn fill_entry(&mut self, entries: &[Entry], name: &str, value: &str) -> bool {
        let entry = entries.iter().find(|entry| entry.key == name);
        entry.inspect(|entry| self.set(entry.key, value)).is_some()
    }
}

/// The link parameters of a form's entries, in order. Default values are omitted.
#[derive(Default)]
pub(crate) struct Parameters(Vec<NameValuePair>);

impl Parameters {
    pub(crate) fn set(&mut self, name: &str, value: &str) {
        self.0.push((name.to_owned(), value.to_owned()));
    }

    /// Adds an entry unless it is empty.
    pub(crate) fn entry(&mut self, name: &str, entry: &str) {
        self.0.extend(optional_entry(entry).map(|value| (name.to_owned(), value)));
    }

    /// Adds the strings typed into the form, converting decimal commas to points.
    pub(crate) fn add_typed_entries(&mut self, entries: &[Entry], typed: &EnteredValues) {
        for entry in entries {
            match entry.is_decimal {
                true => self.add_decimal(entry.key, typed.get(entry.key)),
                false => self.entry(entry.key, typed.get(entry.key)),
            }
        }
    }

    /// Adds a number, converting a decimal comma to a point.
    pub(crate) fn add_decimal(&mut self, name: &str, entry: &str) {
        self.entry(name, &entry.replace(',', "."));
    }

    /// Adds the parameters that have no entry in the form. Parameters of a virtual device are added only to a link to a
    /// virtual device.
    pub(crate) fn add_remaining(
        &mut self,
        rest: &[NameValuePair],
        is_virtual: bool,
        (link, of_the_virtual): (&[&str], &[&str]),
    ) {
        self.add_parameters_without_entry(rest, |name| {
            is_virtual || link.contains(&name) || !of_the_virtual.contains(&name)
        });
    }

    /// Adds the parameters without an entry that are valid for the link. An entry overrides an older parameter of the
    /// same name.
    pub(crate) fn add_parameters_without_entry(&mut self, rest: &[NameValuePair], belongs: impl Fn(&str) -> bool) {
        for (name, value) in rest.iter().filter(|(name, _)| belongs(name)) {
            if self.0.iter().all(|(own, _)| own != name) {
                self.set(name, value);
            }
        }
    }

    /// Returns the link with these parameters.
    ///
    /// # Errors
    /// Returns a message if a character would end a part of the link prematurely, or if the parts do not form a link.
    pub(crate) fn build_link(&self, (scheme, target): (LinkScheme, String)) -> Result<LinkUrl, Text> {
        let unfit = |text: &str, characters: &[char]| text.contains(characters).then(|| text.to_owned());
        let unfit = unfit(&target, &['?'])
            .or_else(|| self.0.iter().find_map(|(name, value)| unfit(name, &['&']).or_else(|| unfit(value, &['&']))));
        if let Some(value) = unfit {
            return Err(Text::new("form.characters").with("value", value));
        }
        let words: Vec<String> = self.0.iter().map(|(name, value)| format!("{name}={value}")).collect();
        let question = if words.is_empty() { "" } else { "?" };
        let link = format!("{}:{target}{question}{}", scheme.keyword(), words.join("&"));
        link.parse().map_err(|error| unusable_link_text(explain::url_error_text(&error)))
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// Checks that filling each link into a form yields an equivalent link.
    pub(crate) fn assert_round_trip(links: &[&str], through: impl Fn(&LinkUrl) -> Result<LinkUrl, Text>) {
        let sorted = |url: &LinkUrl| {
            let mut pairs = url.query.pairs().to_vec();
            pairs.sort();
            pairs
        };
        for link in links {
            let url: LinkUrl = link.parse().unwrap();
            let back = through(&url).unwrap();
            assert_eq!((back.scheme, &back.target, sorted(&back)), (url.scheme, &url.target, sorted(&url)), "{link}");
        }
    }
}
