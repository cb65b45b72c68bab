//! Construction of a virtual adapter and its attached devices from the query of a `sim:` link.

use super::adapter::Adapter;
use super::attached::{AttachableKind, AttachedDevice};
use super::config::{Config, Shaft, Shared};
use crate::parameter::{Entry, ParameterGroup};
use crate::sim::{ConfigError, VirtualDevice};

/// Returns the names of all settings. Those of the adapter and of all devices but the last come first, in alphabetical
/// order, followed by those of the last device.
pub fn all_setting_names(devices: &[&dyn AttachableKind]) -> Vec<&'static str> {
    let (last, others) = devices.split_last().map_or((None, devices), |(last, others)| (Some(last), others));
    let mut keys = Config::KEYS.to_vec();
    keys.extend(Shaft::KEYS.iter().filter(|_| owns_shaft(devices)));
    keys.extend(others.iter().flat_map(|device| device.setting_names()));
    keys.sort_unstable();
    keys.extend(Shared::KEYS);
    let last = last.into_iter().flat_map(|device| device.setting_names());
    keys.extend(last.filter(|key| !Shared::KEYS.contains(key)));
    keys
}

/// Returns the form entries of an adapter: its faults, and the speed of the shaft if no attached device owns it.
pub fn entries() -> Vec<Entry> {
    [Shaft::entries(), Shared::entries()].concat()
}

/// Returns whether the adapter owns the shaft. This is the case if no attached device has a setting for the speed.
fn owns_shaft(devices: &[&dyn AttachableKind]) -> bool {
    devices.iter().all(|device| Shaft::KEYS.iter().all(|key| !device.setting_names().contains(key)))
}

impl Adapter {
    /// Creates an adapter with the given devices from percent-decoded keys and values. The last value of a repeated key
    /// applies.
    ///
    /// # Errors
    /// Returns an error with the key and the allowed values if a setting is invalid.
    pub fn from_pairs(pairs: &[(String, String)], devices: &[&dyn AttachableKind]) -> Result<Self, ConfigError> {
        let known = all_setting_names(devices);
        if let Some((key, _)) = pairs.iter().find(|(key, _)| !known.contains(&key.as_str())) {
            return Err(ConfigError::unknown_setting(VirtualDevice::Adapter, key, &known));
        }
        let (config, shared) = (Config::read(pairs)?, Shared::read(pairs)?);
        let shaft = if owns_shaft(devices) { Shaft::read(pairs)? } else { Shaft::default() };
        let mut attached: Vec<AttachedDevice> = Vec::new();
        for device in devices {
            let own = pairs.iter().filter(|(key, _)| device.setting_names().contains(&key.as_str())).cloned();
            attached.extend(device.attach_device(&own.collect::<Vec<_>>())?);
        }
        Ok(Adapter::new(&config, &shared, &shaft, attached))
    }
}
