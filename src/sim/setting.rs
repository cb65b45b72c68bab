//! Settings of a virtual device, as the query of a `sim:` link: keys with their values, the allowed values, and the errors.
//! Each device defines its keys.

use super::FaultError;
use crate::expected::Expected;
use crate::parameter::{Checked, Parameters, Refused, Values, number};

/// The reason why settings are invalid.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ConfigError {
    /// The key does not exist.
    #[error("{device} has no setting `{key}`; valid settings are {known}")]
    Key {
        /// The device without such a key.
        device: VirtualDevice,
        /// The key as written.
        key: String,
        /// The existing keys.
        known: String,
    },
    /// The value is not allowed for its key.
    #[error("`{key}={value}` is not valid (allowed: {allowed})")]
    Value {
        /// The key.
        key: String,
        /// The value as written.
        value: String,
        /// The allowed values.
        allowed: Expected,
    },
    /// The value of `fault`.
    #[error(transparent)]
    Fault(#[from] FaultError),
}

/// The name of a virtual device in an error about an unknown setting.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum VirtualDevice {
    /// An encoder.
    #[error("a virtual encoder")]
    Encoder,
    /// An encoder of this kind.
    #[error("a virtual {0} encoder")]
    EncoderOf(&'static str),
    /// The adapter for clocked buses.
    #[error("a virtual adapter")]
    Adapter,
    /// A device of this name.
    #[error("a virtual {0}")]
    Device(&'static str),
}

impl ConfigError {
    /// Creates the error that `device` has no setting `key`; `known` are the existing ones.
    pub fn unknown(device: VirtualDevice, key: &str, known: &[&str]) -> Self {
        ConfigError::Key { device, key: key.to_owned(), known: known.join(", ") }
    }
}

impl From<Refused> for ConfigError {
    fn from(Refused { key, value, allowed }: Refused) -> Self {
        ConfigError::Value { key, value, allowed }
    }
}

/// Parses the settings of `device`, already percent-decoded. Of a key given twice the last one counts.
///
/// # Errors
/// A sentence that names the key and the allowed values.
pub fn read<P: Parameters<Error = ConfigError>>(
    device: VirtualDevice,
    pairs: &[(String, String)],
) -> Result<P, ConfigError> {
    let mut own = P::default();
    for (key, value) in pairs {
        if !own.set(key, value)? {
            return Err(ConfigError::unknown(device, key, P::KEYS));
        }
    }
    Ok(own)
}

/// Any number: the seed of noise.
pub const SEED: Checked<u64> = Checked(Expected::Whole, number);

/// Revolutions per minute, in either direction.
pub const RPM: Rpm = Rpm;

/// See [`RPM`].
#[derive(Clone, Copy, Debug)]
pub struct Rpm;

impl Rpm {
    const MAX: u32 = 12_000;
}

impl Values for Rpm {
    type Value = f64;

    fn read(&self, text: &str) -> Option<f64> {
        let most = f64::from(Self::MAX);
        text.parse().ok().filter(|rpm| (-most..=most).contains(rpm))
    }

    fn allowed(&self) -> Expected {
        Expected::Speed { most: Self::MAX }
    }

    fn print(&self, value: &f64) -> String {
        value.to_string()
    }

    fn is_decimal(&self) -> bool {
        true
    }
}

/// Returns the keys and values of a query, for a test.
#[cfg(test)]
pub(crate) fn pairs(query: &str) -> Vec<(String, String)> {
    let pairs = query.split('&').filter_map(|item| item.split_once('='));
    pairs.map(|(key, value)| (key.to_owned(), value.to_owned())).collect()
}
