//! The settings of a virtual adapter, as the query of a `sim:` link gives them: its own. What hangs on it has others.

use crate::buses::bridge::protocol::VERSION;
use crate::expected::{Expected, Quantity};
use crate::sim::setting::Setting;
use crate::sim::{ConfigError, Faults};

/// What a virtual adapter shall be like. The default has nothing wrong with it, and the encoder's supply comes from
/// elsewhere.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Config {
    pub(super) seed: u64,
    pub(super) faults: Faults,
    pub(super) line: Line,
    pub(super) noise: f64,
    pub(super) switched_supply: bool,
    pub(super) version: u8,
    /// Speed of the shaft at the start, where no device on it has this setting.
    pub(super) rpm: f64,
}

/// The wires between adapter and encoder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Line {
    Good,
    /// Nobody acknowledges.
    Open,
    /// The data line stays at 0.
    Low,
    /// The data line stays at 1.
    High,
}

impl Default for Config {
    fn default() -> Self {
        Config {
            seed: 0,
            faults: Faults::default(),
            line: Line::Good,
            noise: 0.0,
            switched_supply: false,
            version: VERSION,
            rpm: 0.0,
        }
    }
}

impl Config {
    /// The keys that are the adapter's alone.
    ///
    /// | key | value |
    /// |---|---|
    /// | `line` | the wires to the encoder: `good`, `open`, `low` or `high` (stuck) |
    /// | `noise` | share of frames with a bit inverted, 0…1 |
    /// | `supply` | the encoder's: `external`, or `switched` by the adapter |
    /// | `version` | of the bridge protocol, as the adapter says |
    pub(super) const KEYS: [&str; 4] = ["line", "noise", "supply", "version"];
    /// What a device that hangs on it may take as well: where noise begins, and faults of the line and the device.
    pub(super) const SHARED: [&str; 2] = ["seed", "fault"];

    /// Revolutions a minute of the shaft: the adapter's where no device on it has this key.
    pub(super) const RPM: &str = "rpm";

    /// Takes a key with its value; false where it is none of the adapter's.
    pub(super) fn set(&mut self, setting: Setting) -> Result<bool, ConfigError> {
        match setting.key {
            "seed" => self.seed = setting.number(Expected::Whole)?,
            "fault" => self.faults = setting.value.parse()?,
            "line" => {
                let lines = [("good", Line::Good), ("open", Line::Open), ("low", Line::Low), ("high", Line::High)];
                self.line = setting.one_of(&lines)?;
            }
            Self::RPM => self.rpm = setting.rpm()?,
            "noise" => self.noise = setting.decimal(0.0..=1.0, Expected::range(Quantity::DamagedFrames, 0, 1))?,
            "supply" => {
                let supplies = [("external", false), ("switched", true)];
                self.switched_supply = setting.one_of(&supplies)?;
            }
            "version" => self.version = setting.number(Expected::range(Quantity::Version, 0, 255))?,
            _ => return Ok(false),
        }
        Ok(true)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sim::setting::pairs;

    fn read(query: &str) -> Result<Config, ConfigError> {
        let mut config = Config::default();
        for (key, value) in &pairs(query) {
            assert!(config.set(Setting { key, value })?, "{key}");
        }
        Ok(config)
    }

    #[test]
    fn every_key_is_read() {
        let config = read("line=low&noise=0.5&supply=switched&version=2&seed=3&fault=drop:0.5&rpm=-6").unwrap();
        let faults = "drop:0.5".parse().unwrap();
        let expected =
            Config { seed: 3, faults, line: Line::Low, noise: 0.5, switched_supply: true, version: 2, rpm: -6.0 };
        assert_eq!(config, expected);
    }

    #[test]
    fn what_is_wrong_is_told_in_a_sentence() {
        let sentence = "`line=bad` cannot be used: allowed is good, open, low or high";
        assert_eq!(read("line=bad").unwrap_err().to_string(), sentence);
        for query in ["noise=2", "noise=NaN", "supply=on", "version=256", "version=-1"] {
            assert!(matches!(read(query), Err(ConfigError::Value { .. })), "{query}");
        }
    }
}
