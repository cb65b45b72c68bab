//! Settings of a virtual device in the query of a `sim:` link: keys, values, allowed values and errors. Each device has
//! its own keys.

use super::FaultError;
use crate::expected::AllowedValues;
use crate::parameter::{CustomNotation, ParameterGroup, ParameterValues, RejectedParameter, parse_whole};

/// The reason why settings are invalid.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ConfigError {
    /// The key is unknown.
    #[error("{device} has no setting `{key}`; valid settings are {known}")]
    Key {
        /// Device to which the settings belong.
        device: VirtualDevice,
        /// Key as entered.
        key: String,
        /// Known keys.
        known: String,
    },
    /// The value is not allowed for this key.
    #[error("`{key}={value}` is not valid (allowed: {allowed})")]
    Value {
        /// Name of the key.
        key: String,
        /// Value as entered.
        value: String,
        /// Allowed values.
        allowed: AllowedValues,
    },
    /// The value of `fault` is invalid.
    #[error(transparent)]
    Fault(#[from] FaultError),
}

/// The virtual device to which a setting belongs, as named in error messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum VirtualDevice {
    /// An encoder.
    #[error("a virtual encoder")]
    Encoder,
    /// An encoder of the given kind.
    #[error("a virtual {0} encoder")]
    EncoderOf(&'static str),
    /// The adapter for clocked buses.
    #[error("a virtual adapter")]
    Adapter,
    /// A device with the given name.
    #[error("a virtual {0}")]
    Device(&'static str),
}

impl ConfigError {
    /// Creates the error for an unknown setting of `device`. `known` lists the existing keys.
    pub fn unknown_setting(device: VirtualDevice, key: &str, known: &[&str]) -> Self {
        ConfigError::Key { device, key: key.to_owned(), known: known.join(", ") }
    }
}

impl From<RejectedParameter> for ConfigError {
    fn from(RejectedParameter { key, value, allowed }: RejectedParameter) -> Self {
        ConfigError::Value { key, value, allowed }
    }
}

/// Parses the percent-decoded settings of `device`. If a key is repeated, its last value applies.
///
/// # Errors
/// Returns an error that names the key and the allowed values.
pub fn read<P: ParameterGroup<Error = ConfigError>>(
    device: VirtualDevice,
    pairs: &[(String, String)],
) -> Result<P, ConfigError> {
    let mut own = P::default();
    for (key, value) in pairs {
        if !own.set_value(key, value)? {
            return Err(ConfigError::unknown_setting(device, key, P::KEYS));
        }
    }
    Ok(own)
}

/// Parser for the seed of the noise, which can be any whole number.
pub const SEED: CustomNotation<u64> = CustomNotation(AllowedValues::Whole, parse_whole);

/// Parser for a speed in revolutions per minute, in either direction.
pub const RPM: Rpm = Rpm;

/// The type of [`RPM`].
#[derive(Clone, Copy, Debug)]
pub struct Rpm;

impl Rpm {
    const MAX: u32 = 12_000;
}

impl ParameterValues for Rpm {
    type Value = f64;

    fn read(&self, text: &str) -> Option<f64> {
        let most = f64::from(Self::MAX);
        text.parse().ok().filter(|rpm| (-most..=most).contains(rpm))
    }

    fn allowed_values(&self) -> AllowedValues {
        AllowedValues::Speed { most: Self::MAX }
    }

    fn format_example(&self, value: &f64) -> String {
        value.to_string()
    }

    fn is_decimal(&self) -> bool {
        true
    }
}

/// Returns the keys and values of a query, for tests.
#[cfg(test)]
pub(crate) fn query_pairs(query: &str) -> Vec<(String, String)> {
    let pairs = query.split('&').filter_map(|item| item.split_once('='));
    pairs.map(|(key, value)| (key.to_owned(), value.to_owned())).collect()
}
