//! The settings of a virtual adapter, as the query of a `sim:` link gives them: those of the virtual encoder behind it,
//! and its own.

use super::trouble::Trouble;
use crate::protocol::bridge::VERSION;
use crate::protocol::ssi::{Direction, Families, Layout, Settings};
use crate::sim::setting::Setting;
use crate::sim::{ConfigError, biss};

/// What a virtual adapter shall be like. The default has nothing wrong with it, and the encoder's supply comes from
/// elsewhere.
#[derive(Clone, Debug, PartialEq)]
pub struct Config {
    pub(super) encoder: biss::Config,
    pub(super) rpm: f64,
    pub(super) line: Line,
    pub(super) noise: f64,
    /// An SSI encoder on the same shaft; none: there is no such encoder.
    pub(super) ssi: Option<SsiEncoder>,
    /// What its frames say of it beside the position.
    pub(super) troubles: Vec<Trouble>,
    pub(super) switched_supply: bool,
    pub(super) uart: bool,
    pub(super) version: u8,
}

/// A virtual SSI encoder.
#[derive(Clone, Debug, PartialEq)]
pub struct SsiEncoder {
    /// Its frame.
    pub layout: Layout,
    /// Which way it counts.
    pub direction: Direction,
    /// Its position at the shaft's zero, within the frame's range.
    pub preset: u64,
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
            encoder: biss::Config::default(),
            rpm: 0.0,
            line: Line::Good,
            noise: 0.0,
            ssi: ssi(DELIVERED),
            troubles: Vec::new(),
            switched_supply: false,
            uart: false,
            version: VERSION,
        }
    }
}

impl Config {
    /// The keys that [`from_pairs`](Self::from_pairs) takes, beside those of the encoder.
    ///
    /// | key | value |
    /// |---|---|
    /// | `line` | the wires to the encoder: `good`, `open`, `low` or `high` (stuck) |
    /// | `noise` | share of frames with a bit inverted, 0…1 |
    /// | `ssi` | family and settings of the SSI encoder, `atm60,code=gray`; a host that clocks otherwise gets its frame cut off, or zeros behind it |
    /// | `ssi-error` | error bits of its frame that speak and words that it sends instead (`ERRSYNC:0.5,ERRSI:4`, `safety-fault`), each with the seconds after which it happens again |
    /// | `supply` | the encoder's: `external`, or `switched` by the adapter |
    /// | `uart` | what is at the serial line: `none` or `hiperface` |
    /// | `version` | of the bridge protocol, as the adapter says |
    pub const KEYS: [&str; 7] = ["line", "noise", "ssi", "ssi-error", "supply", "uart", "version"];

    /// Reads keys and values, already percent-decoded. Of a key given twice the last counts.
    ///
    /// # Errors
    /// With a sentence that names the key and what is allowed.
    pub fn from_pairs(pairs: &[(String, String)]) -> Result<Self, ConfigError> {
        Self::with_encoder(pairs, None)
    }

    /// The same, with this SSI encoder where `pairs` name none.
    ///
    /// # Errors
    /// As [`from_pairs`](Self::from_pairs).
    pub fn with_encoder(pairs: &[(String, String)], encoder: Option<SsiEncoder>) -> Result<Self, ConfigError> {
        let mut config = Config::default();
        config.ssi = encoder.or(config.ssi);
        let mut others = Vec::new();
        let mut troubles = "";
        for (key, value) in pairs {
            if biss::Config::KEYS.contains(&key.as_str()) {
                others.push((key.clone(), value.clone()));
            } else if key == TROUBLES {
                troubles = value;
            } else {
                config.set(key, value)?;
            }
        }
        config.encoder = biss::Config::from_pairs(&others)?;
        config.rpm = config.encoder.rpm();
        config.set_troubles(troubles)?;
        Ok(config)
    }

    /// Which there are is the SSI encoder's matter.
    fn set_troubles(&mut self, value: &str) -> Result<(), ConfigError> {
        let Some(ssi) = &self.ssi else { return Ok(()) };
        let allowed = || match Trouble::names(&ssi.layout).join(", ") {
            own if own.is_empty() => "nothing, as this encoder's frame has no error bits".to_owned(),
            own => format!("{own}, each with :SECONDS where it happens again and again, separated by commas"),
        };
        let troubles = Trouble::read(value, &ssi.layout);
        self.troubles = troubles.ok_or_else(|| Setting { key: TROUBLES, value }.refused(&allowed()))?;
        Ok(())
    }

    fn set(&mut self, key: &str, value: &str) -> Result<(), ConfigError> {
        let setting = Setting { key, value };
        match key {
            "line" => {
                let lines = [("good", Line::Good), ("open", Line::Open), ("low", Line::Low), ("high", Line::High)];
                self.line = setting.one_of(&lines, "good, open, low or high")?;
            }
            "noise" => self.noise = setting.decimal(0.0..=1.0, "the share of damaged frames from 0 to 1")?,
            "ssi" => {
                let allowed = "a family of SSI encoders with its settings, as atm60,code=gray";
                self.ssi = Some(ssi(setting.value).ok_or_else(|| setting.refused(allowed))?);
            }
            "supply" => {
                let supplies = [("external", false), ("switched", true)];
                self.switched_supply = setting.one_of(&supplies, "external or switched")?;
            }
            "uart" => self.uart = setting.one_of(&[("none", false), ("hiperface", true)], "none or hiperface")?,
            "version" => self.version = setting.number("a version from 0 to 255")?,
            _ => {
                return Err(setting.unknown("a virtual adapter", &[&Self::KEYS[..], &biss::Config::KEYS].concat()));
            }
        }
        Ok(())
    }
}

const TROUBLES: &str = "ssi-error";
/// The SSI frame of an encoder that nothing else is said of: 12 bits of turns, 13 within one.
pub const DELIVERED: &str = "atm60,code=gray";

fn ssi(text: &str) -> Option<SsiEncoder> {
    let (key, settings) = Settings::parse(text).ok()?;
    let families = Families::built_in();
    let resolved = settings.resolve(families.named(&key)?).ok()?;
    Some(SsiEncoder { layout: resolved.layout, direction: resolved.direction, preset: resolved.preset })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sim::setting::pairs;
    use proptest::prelude::*;

    fn read(query: &str) -> Result<Config, ConfigError> {
        Config::from_pairs(&pairs(query))
    }

    #[test]
    fn every_key_is_read() {
        let config =
            read("line=low&noise=0.5&ssi-error=error:2&ssi=ahm36,st=12&supply=switched&uart=hiperface&version=2&rpm=60&seed=3").unwrap();
        let pairs = [("rpm", "60"), ("seed", "3")].map(|(key, value)| (key.to_owned(), value.to_owned()));
        let expected = Config {
            encoder: biss::Config::from_pairs(&pairs).unwrap(),
            rpm: 60.0,
            line: Line::Low,
            noise: 0.5,
            ssi: Some(ssi("ahm36,st=12").unwrap()),
            troubles: Trouble::read("error:2", &ssi("ahm36,st=12").unwrap().layout).unwrap(),
            switched_supply: true,
            uart: true,
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
        assert!(matches!(read("rpm=NaN"), Err(ConfigError::Value { .. })));
        let sentence = "`ssi-error=ERRDIG` cannot be used: allowed is ERROR, each with :SECONDS where it happens again and \
                        again, separated by commas";
        assert_eq!(read("ssi=ahm36&ssi-error=ERRDIG").unwrap_err().to_string(), sentence);
        let none = read("ssi-error=ERROR").unwrap_err().to_string();
        assert!(none.contains("nothing, as this encoder's frame has no error bits"), "{none}");
        for query in ["noise=2", "noise=NaN", "ssi=x", "supply=on", "uart=on", "version=256", "version=-1"] {
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
