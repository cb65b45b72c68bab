//! Settings of the adapter in the query of a `sim:` link. The settings of attached devices are not included.

use crate::buses::bridge::protocol::VERSION;
use crate::expected::Quantity;
use crate::parameter::{DecimalNumbers, Keywords, WholeNumbers};
use crate::parameters;
use crate::sim::{ConfigError, FAULTS, RPM, SEED, SimulatedFaults};

parameters! {
    /// Settings of a virtual adapter. By default, no faults are simulated and the encoder has an external supply.
    pub(super) struct Config: ConfigError {
        pub(super) line: EncoderWiring = EncoderWiring::Good,
            "line" => Keywords(&[("good", EncoderWiring::Good), ("open", EncoderWiring::Open), ("low", EncoderWiring::Low), ("high", EncoderWiring::High)]);
        /// Fraction of frames with an inverted bit.
        pub(super) noise: f64 = 0.0, "noise" => DecimalNumbers(Quantity::DamagedFrames, 0.0..=1.0);
        pub(super) switched_supply: bool = false, "supply" => Keywords(&[("external", false), ("switched", true)]);
        /// Version of the bridge protocol that the adapter reports.
        pub(super) version: u8 = VERSION, "version" => WholeNumbers(Quantity::Version, 0..=255);
    }
}

parameters! {
    /// Settings that attached devices may share: the seed for the noise, and the faults.
    pub(super) struct Shared: ConfigError {
        pub(super) seed: u64 = 0, "seed" => SEED;
        pub(super) faults: SimulatedFaults = SimulatedFaults::default(), "fault" => FAULTS, "connect.fault" like "drop:0.01";
    }
}

parameters! {
    /// Settings of the shaft, used if no attached device has a shaft.
    pub(super) struct Shaft: ConfigError {
        pub(super) rpm: f64 = 0.0, "rpm" => RPM, "connect.rpm";
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum EncoderWiring {
    Good,
    /// The wires are open, so no encoder acknowledges.
    Open,
    /// The data line stays at 0.
    Low,
    /// The data line stays at 1.
    High,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parameter::ParameterGroup;
    use crate::sim::setting::query_pairs;

    fn read(query: &str) -> Result<Config, ConfigError> {
        assert!(query_pairs(query).iter().all(|(key, _)| Config::KEYS.contains(&key.as_str())), "{query}");
        Config::read(&query_pairs(query))
    }

    #[test]
    fn parses_every_key() {
        let config = read("line=low&noise=0.5&supply=switched&version=2").unwrap();
        assert_eq!(config, Config { line: EncoderWiring::Low, noise: 0.5, switched_supply: true, version: 2 });
        let faults = "drop:0.5".parse().unwrap();
        assert_eq!(Shared::read(&query_pairs("seed=3&fault=drop:0.5")), Ok(Shared { seed: 3, faults }));
        assert_eq!(Shaft::read(&query_pairs("rpm=-6")), Ok(Shaft { rpm: -6.0 }));
    }

    #[test]
    fn reports_invalid_values() {
        let sentence = "`line=bad` is not valid (allowed: good, open, low or high)";
        assert_eq!(read("line=bad").unwrap_err().to_string(), sentence);
        for query in ["noise=2", "noise=NaN", "supply=on", "version=256", "version=-1"] {
            assert!(matches!(read(query), Err(ConfigError::Value { .. })), "{query}");
        }
    }
}
