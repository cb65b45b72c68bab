//! Settings of a virtual device, as the query of a `sim:` link gives them, a key with its value each: what can be written
//! for a value, and what is wrong with one. Which keys there are is each device's matter.

use std::ops::{RangeBounds, RangeInclusive};

use super::FaultError;
use crate::expected::Expected;

/// Why settings cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ConfigError {
    /// No such key.
    #[error("{device} has no setting `{key}`; allowed are {known}")]
    Key {
        /// What has no such key, with its article.
        device: &'static str,
        /// The key as written.
        key: String,
        /// The keys that it has.
        known: String,
    },
    /// A value that its key does not take.
    #[error("`{key}={value}` cannot be used: allowed is {allowed}")]
    Value {
        /// The key.
        key: String,
        /// The value as written.
        value: String,
        /// What would do.
        allowed: Expected,
    },
    /// The value of `fault`.
    #[error(transparent)]
    Fault(#[from] FaultError),
}

/// A key with its value, about to be read. What cannot be used is refused with words that say what can.
#[derive(Clone, Copy)]
pub struct Setting<'a> {
    /// The key.
    pub key: &'a str,
    /// The value as it was written.
    pub value: &'a str,
}

type Result<T> = std::result::Result<T, ConfigError>;

impl Setting<'_> {
    const MAX_RPM: u32 = 12_000;

    /// `device` has no such key; what it has is `known`.
    pub fn unknown(self, device: &'static str, known: &[&str]) -> ConfigError {
        ConfigError::Key { device, key: self.key.to_owned(), known: known.join(", ") }
    }

    pub(crate) fn refused(self, allowed: Expected) -> ConfigError {
        ConfigError::Value { key: self.key.to_owned(), value: self.value.to_owned(), allowed }
    }

    /// A whole number that fits into its type.
    pub fn number<T: TryFrom<u64>>(self, allowed: Expected) -> Result<T> {
        integer(self.value).and_then(|number| T::try_from(number).ok()).ok_or_else(|| self.refused(allowed))
    }

    /// A whole number of the range.
    pub(crate) fn within<T: TryFrom<u64> + PartialOrd>(
        self,
        range: impl RangeBounds<T>,
        allowed: Expected,
    ) -> Result<T> {
        let number = Some(self.number(allowed.clone())?).filter(|number| range.contains(number));
        number.ok_or_else(|| self.refused(allowed))
    }

    /// A whole number of the range, which may be negative, and is decimal.
    pub(crate) fn signed(self, range: RangeInclusive<i16>, allowed: Expected) -> Result<i16> {
        let number = self.value.parse().ok().filter(|number| range.contains(number));
        number.ok_or_else(|| self.refused(allowed))
    }

    /// A number of the range, with a decimal point where it needs one.
    pub(crate) fn decimal(self, range: RangeInclusive<f64>, allowed: Expected) -> Result<f64> {
        let number = self.value.parse().ok().filter(|number| range.contains(number));
        number.ok_or_else(|| self.refused(allowed))
    }

    /// Revolutions a minute, either way.
    pub fn rpm(self) -> Result<f64> {
        let most = f64::from(Self::MAX_RPM);
        self.decimal(-most..=most, Expected::Speed { most: Self::MAX_RPM })
    }

    /// One of these words.
    pub(crate) fn one_of<T: Copy>(self, words: &[(&'static str, T)]) -> Result<T> {
        let found = words.iter().find(|(word, _)| *word == self.value);
        let allowed = || Expected::Words(words.iter().map(|(word, _)| *word).collect());
        found.map(|(_, meaning)| *meaning).ok_or_else(|| self.refused(allowed()))
    }

    pub(crate) fn switch(self) -> Result<bool> {
        self.one_of(&[("on", true), ("off", false)])
    }
}

/// Decimal, or hexadecimal after `0x`.
pub(super) fn integer(text: &str) -> Option<u64> {
    match text.strip_prefix("0x").or_else(|| text.strip_prefix("0X")) {
        Some(digits) => u64::from_str_radix(digits, 16).ok(),
        None => text.parse().ok(),
    }
}

/// The keys and values of a query, for a test.
#[cfg(test)]
pub(crate) fn pairs(query: &str) -> Vec<(String, String)> {
    let pairs = query.split('&').filter_map(|item| item.split_once('='));
    pairs.map(|(key, value)| (key.to_owned(), value.to_owned())).collect()
}
