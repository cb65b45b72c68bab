//! Construction of a virtual adapter with its attached devices from the query of a `sim:` link.

use super::adapter::Adapter;
use super::attached::{AttachableKind, AttachedDevice};
use super::config::{Config, Shaft, Shared};
use crate::parameter::{Entry, Parameters};
use crate::sim::{ConfigError, VirtualDevice};

/// Returns the setting keys of an adapter with these devices: first those of the adapter and of devices with few
/// settings in alphabetical order, then those of the last device.
pub fn keys(devices: &[&dyn AttachableKind]) -> Vec<&'static str> {
    let (last, others) = devices.split_last().map_or((None, devices), |(last, others)| (Some(last), others));
    let mut keys = Config::KEYS.to_vec();
    keys.extend(Shaft::KEYS.iter().filter(|_| owns_shaft(devices)));
    keys.extend(others.iter().flat_map(|device| device.keys()));
    keys.sort_unstable();
    keys.extend(Shared::KEYS);
    let last = last.into_iter().flat_map(|device| device.keys());
    keys.extend(last.filter(|key| !Shared::KEYS.contains(key)));
    keys
}

/// Returns the form entries of an adapter: its faults and the shaft speed, regardless of which device owns the shaft.
pub fn entries() -> Vec<Entry> {
    [Shaft::entries(), Shared::entries()].concat()
}

/// Returns whether the adapter owns the shaft, because no attached device has a speed setting.
fn owns_shaft(devices: &[&dyn AttachableKind]) -> bool {
    devices.iter().all(|device| Shaft::KEYS.iter().all(|key| !device.keys().contains(key)))
}

impl Adapter {
    /// Creates the adapter with these devices from percent-decoded keys and values. If a key occurs twice, its last
    /// value counts.
    ///
    /// # Errors
    /// Names the key and the allowed values.
    pub fn from_pairs(pairs: &[(String, String)], devices: &[&dyn AttachableKind]) -> Result<Self, ConfigError> {
        let known = keys(devices);
        if let Some((key, _)) = pairs.iter().find(|(key, _)| !known.contains(&key.as_str())) {
            return Err(ConfigError::unknown(VirtualDevice::Adapter, key, &known));
        }
        let (config, shared) = (Config::read(pairs)?, Shared::read(pairs)?);
        let shaft = if owns_shaft(devices) { Shaft::read(pairs)? } else { Shaft::default() };
        let mut attached: Vec<AttachedDevice> = Vec::new();
        for device in devices {
            let own = pairs.iter().filter(|(key, _)| device.keys().contains(&key.as_str())).cloned();
            attached.extend(device.attach_device(&own.collect::<Vec<_>>())?);
        }
        Ok(Adapter::new(&config, &shared, &shaft, attached))
    }
}
