//! The settings of a virtual adapter, as the query of a `sim:` link gives them: those of the virtual encoder behind it,
//! and its own.

use crate::protocol::bridge::VERSION;
use crate::sim::biss;

/// What a virtual adapter shall be like. The default has nothing wrong with it, and the encoder's supply comes from
/// elsewhere.
#[derive(Clone, Debug, PartialEq)]
pub struct Config {
    pub(super) encoder: biss::Config,
    pub(super) rpm: f64,
    pub(super) line: Line,
    pub(super) noise: f64,
    pub(super) gray: bool,
    pub(super) switched_supply: bool,
    pub(super) version: u8,
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

/// Why settings cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ConfigError {
    /// No such key.
    #[error(
        "a virtual adapter has no setting `{key}`; allowed are {}, {}",
        Config::KEYS.join(", "),
        biss::Config::KEYS.join(", ")
    )]
    Key {
        /// The key as written.
        key: String,
    },
    /// A value that its key does not take.
    #[error("`{key}={value}` cannot be used: allowed is {allowed}")]
    Value {
        /// The key.
        key: String,
        /// The value as written.
        value: String,
        /// What would do, in words.
        allowed: &'static str,
    },
    /// A setting of the encoder.
    #[error(transparent)]
    Encoder(#[from] biss::ConfigError),
}

impl Default for Config {
    fn default() -> Self {
        Config {
            encoder: biss::Config::default(),
            rpm: 0.0,
            line: Line::Good,
            noise: 0.0,
            gray: true,
            switched_supply: false,
            version: VERSION,
        }
    }
}

impl Config {
    /// The keys that [`from_pairs`](Self::from_pairs) takes, beside those of the encoder.
    pub const KEYS: [&str; 5] = ["line", "noise", "ssi", "supply", "version"];

    /// Reads keys and values, already percent-decoded. Of a key given twice the last counts.
    ///
    /// # Errors
    /// With a sentence that names the key and what is allowed.
    pub fn from_pairs(pairs: &[(String, String)]) -> Result<Self, ConfigError> {
        let mut config = Config::default();
        let mut others = Vec::new();
        for (key, value) in pairs {
            if biss::Config::KEYS.contains(&key.as_str()) {
                others.push((key.clone(), value.clone()));
            } else {
                config.set(key, value)?;
            }
        }
        config.encoder = biss::Config::from_pairs(&others)?;
        config.rpm = config.encoder.rpm();
        Ok(config)
    }

    fn set(&mut self, key: &str, value: &str) -> Result<(), ConfigError> {
        let refuse =
            |allowed: &'static str| ConfigError::Value { key: key.to_owned(), value: value.to_owned(), allowed };
        match key {
            "line" => {
                self.line = match value {
                    "good" => Line::Good,
                    "open" => Line::Open,
                    "low" => Line::Low,
                    "high" => Line::High,
                    _ => return Err(refuse("good, open, low or high")),
                };
            }
            "noise" => {
                let noise = value.parse().ok().filter(|share: &f64| (0.0..=1.0).contains(share));
                self.noise = noise.ok_or_else(|| refuse("the share of damaged frames from 0 to 1"))?;
            }
            "ssi" => {
                self.gray = match value {
                    "gray" => true,
                    "binary" => false,
                    _ => return Err(refuse("gray or binary")),
                };
            }
            "supply" => {
                self.switched_supply = match value {
                    "external" => false,
                    "switched" => true,
                    _ => return Err(refuse("external or switched")),
                };
            }
            "version" => self.version = value.parse().map_err(|_| refuse("a version from 0 to 255"))?,
            _ => return Err(ConfigError::Key { key: key.to_owned() }),
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn read(query: &str) -> Result<Config, ConfigError> {
        let pair = |(key, value): (&str, &str)| (key.to_owned(), value.to_owned());
        let pairs: Vec<_> = query.split('&').filter_map(|item| item.split_once('=')).map(pair).collect();
        Config::from_pairs(&pairs)
    }

    #[test]
    fn every_key_is_read() {
        let config = read("line=low&noise=0.5&ssi=binary&supply=switched&version=2&rpm=60&seed=3").unwrap();
        let pairs = [("rpm", "60"), ("seed", "3")].map(|(key, value)| (key.to_owned(), value.to_owned()));
        let expected = Config {
            encoder: biss::Config::from_pairs(&pairs).unwrap(),
            rpm: 60.0,
            line: Line::Low,
            noise: 0.5,
            gray: false,
            switched_supply: true,
            version: 2,
        };
        assert_eq!(config, expected);
        assert_eq!(Config::from_pairs(&[]), Ok(Config::default()));
    }

    #[test]
    fn what_is_wrong_is_told_in_a_sentence() {
        let unknown = read("lin=low").unwrap_err().to_string();
        assert!(unknown.starts_with("a virtual adapter has no setting `lin`; allowed are line, noise, "), "{unknown}");
        let sentence = "`line=bad` cannot be used: allowed is good, open, low or high";
        assert_eq!(read("line=bad").unwrap_err().to_string(), sentence);
        assert!(matches!(read("rpm=NaN"), Err(ConfigError::Encoder(_))));
        for query in ["noise=2", "noise=NaN", "ssi=x", "supply=on", "version=256", "version=-1"] {
            assert!(matches!(read(query), Err(ConfigError::Value { .. })), "{query}");
        }
    }

    proptest! {
        #[test]
        fn no_value_panics(key in 0..Config::KEYS.len(), value in ".*") {
            let _ = Config::from_pairs(&[(Config::KEYS[key].to_owned(), value)]);
        }
    }
}
