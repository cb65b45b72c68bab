//! A virtual adapter with what hangs on it, as the query of a `sim:` link gives both.

use super::adapter::Adapter;
use super::attached::{Attachable, Attached};
use super::config::Config;
use crate::sim::ConfigError;
use crate::sim::setting::Setting;

/// The settings of an adapter with these devices: the adapter's and those of the devices with a few, by the alphabet, then
/// those of the last device.
pub fn keys(devices: &[&dyn Attachable]) -> Vec<&'static str> {
    let (last, others) = devices.split_last().map_or((None, devices), |(last, others)| (Some(last), others));
    let mut keys = Config::KEYS.to_vec();
    keys.extend(turns_itself(devices).then_some(Config::RPM));
    keys.extend(others.iter().flat_map(|device| device.keys()));
    keys.sort_unstable();
    keys.extend(Config::SHARED);
    let last = last.into_iter().flat_map(|device| device.keys());
    keys.extend(last.filter(|key| !Config::SHARED.contains(key)));
    keys
}

/// Whether the shaft is the adapter's own: no device on it has a setting for its speed.
fn turns_itself(devices: &[&dyn Attachable]) -> bool {
    devices.iter().all(|device| !device.keys().contains(&Config::RPM))
}

impl Adapter {
    /// The adapter with these devices, as keys and values say, already percent-decoded. Of a key given twice the last
    /// counts.
    ///
    /// # Errors
    /// With a sentence that names the key and what is allowed.
    pub fn from_pairs(pairs: &[(String, String)], devices: &[&dyn Attachable]) -> Result<Self, ConfigError> {
        let mut config = Config::default();
        for (key, value) in pairs {
            let setting = Setting { key, value };
            let is_own = (key != Config::RPM || turns_itself(devices)) && config.set(setting)?;
            if !is_own && !devices.iter().any(|device| device.keys().contains(&key.as_str())) {
                return Err(setting.unknown("a virtual adapter", &keys(devices)));
            }
        }
        let mut attached: Vec<Attached> = Vec::new();
        for device in devices {
            let own = pairs.iter().filter(|(key, _)| device.keys().contains(&key.as_str())).cloned();
            attached.extend(device.attached(&own.collect::<Vec<_>>())?);
        }
        Ok(Adapter::new(&config, attached))
    }
}
