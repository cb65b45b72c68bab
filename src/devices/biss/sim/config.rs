//! Settings of a virtual encoder in the query of a `sim:` link, such as `seed=7&fault=drop:0.01&rpm=-500`. This module
//! does not open a connection.

use std::ops::RangeInclusive;
use std::time::Duration;

use super::wiegand::WiegandPulses;
use crate::bits::ByteOrder;
use crate::devices::biss::protocol::{Firmware, PositionFilter};
use crate::expected::{AllowedValues, Limit, Quantity};
use crate::parameter::{CustomNotation, Keywords, SWITCH, WholeNumbers, parse_whole};
use crate::parameters;
use crate::sim::{ConfigError, FAULTS, RPM, SEED, SimulatedFaults, VirtualDevice, setting};

parameters! {
    /// Settings of a virtual encoder. By default, it has factory settings, the latest known firmware, no faults, and a
    /// shaft at rest.
    pub struct Config: ConfigError {
        pub(super) seed: u64 = 0, "seed" => SEED;
        pub(super) faults: SimulatedFaults = SimulatedFaults::default(), "fault" => FAULTS, "connect.fault" like "drop:0.01";
        pub(super) firmware: Firmware = Firmware::new(1, 6, 0), "firmware" => CustomNotation(AllowedValues::FirmwareVersion, firmware);
        pub(super) serial_number: u32 = 0x0012_D687, "serial" => CustomNotation(AllowedValues::Number32, parse_whole::<u32>);
        pub(super) rpm: f64 = 0.0, "rpm" => RPM, "connect.rpm";
        pub(super) reverses: bool = false, "motor" => Keywords(&[("steady", false), ("reverse", true)]);
        pub(super) waver: f64 = 0.5, "waver" => CustomNotation(AllowedValues::UnidirectionalSpeed { most: 1000 }, |text| parse_in_range(text, 0.0..=1000.0));
        pub(super) position: u64 = 0x1234 << 17 | 0x18000, "position" => WholeNumbers(Quantity::Position, 0..=(1 << 33) - 1);
        pub(super) temperature: i16 = 30, "temperature" => WholeNumbers(Quantity::WholeCelsius, -50..=205);
        pub(super) errors: u8 = 0, "errors" => CustomNotation(AllowedValues::ErrorRegister, parse_whole::<u8>);
        pub(super) filter: PositionFilter = PositionFilter::Balanced,
            "filter" => Keywords(&[("balanced", PositionFilter::Balanced), ("dynamic", PositionFilter::Dynamic)]);
        pub(super) cycles: u32 = 3, "cycles" => CustomNotation(AllowedValues::WriteCycles, parse_whole::<u32>);
        pub(super) pulses: WiegandPulses = WiegandPulses { average: 63, lowest: 58 },
            "pulses" => CustomNotation(AllowedValues::Pulses, parse_pulses);
        pub(super) calibration_time: Duration = Duration::from_secs(5),
            "calibration" => CustomNotation(AllowedValues::Seconds { low: Limit::from_thousandths(100), high: Limit::whole(60) }, |text| parse_in_range(text, 0.1..=60.0).map(Duration::from_secs_f64));
        pub(super) silent_calibration: bool = true, "calibration-silent" => SWITCH;
        pub(super) keeps_status: bool = false, "calibration-status" => Keywords(&[("fresh", false), ("kept", true)]);
        pub(super) echo: bool = false, "echo" => SWITCH;
        pub(super) order: ByteOrder = ByteOrder::LowFirst,
            "order" => Keywords(&[("low-first", ByteOrder::LowFirst), ("high-first", ByteOrder::HighFirst)]);
    }
}

impl Config {
    /// Parses percent-decoded keys and values. If a key is repeated, its last value applies. Numbers are decimal, or
    /// hexadecimal with the prefix `0x`.
    ///
    /// # Errors
    /// Returns an error with the key and the allowed values if a setting is invalid.
    pub fn from_pairs(pairs: &[(String, String)]) -> Result<Self, ConfigError> {
        setting::read(VirtualDevice::Encoder, pairs)
    }

    pub const fn faults(&self) -> &SimulatedFaults {
        &self.faults
    }

    pub const fn seed(&self) -> u64 {
        self.seed
    }

    /// Returns the initial speed in revolutions per minute.
    pub const fn rpm(&self) -> f64 {
        self.rpm
    }
}

fn parse_in_range(text: &str, range: RangeInclusive<f64>) -> Option<f64> {
    text.parse().ok().filter(|number| range.contains(number))
}

fn firmware(text: &str) -> Option<Firmware> {
    let numbers: Vec<u8> = text.split('.').map(str::parse::<u8>).collect::<Result<_, _>>().ok()?;
    match numbers.as_slice() {
        [major, minor, patch] => Some(Firmware::new(*major, *minor, *patch)),
        _ => None,
    }
}

fn parse_pulses(text: &str) -> Option<WiegandPulses> {
    let tenths = |volts: &str| {
        let volts: f64 = volts.parse().ok()?;
        // The product is at most 255.
        (0.0..=25.5).contains(&volts).then(|| (volts * 10.0).round() as u8)
    };
    let (average, lowest) = text.split_once(',')?;
    Some(WiegandPulses { average: tenths(average)?, lowest: tenths(lowest)? })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sim::setting::query_pairs;
    use proptest::prelude::*;

    fn read(query: &str) -> Result<Config, ConfigError> {
        Config::from_pairs(&query_pairs(query))
    }

    #[test]
    fn parses_every_key() {
        let config = read(
            "seed=7&fault=drop:0.5&firmware=1.2.3&serial=0x10&rpm=-500&motor=reverse&waver=3&position=0x20000&temperature=-10&\
             errors=0x12&filter=dynamic&cycles=801&pulses=6.1,5.2&calibration=0.5&calibration-silent=off&calibration-status=kept&echo=on&\
             order=high-first",
        )
        .unwrap();
        let expected = Config {
            seed: 7,
            faults: "drop:0.5".parse().unwrap(),
            firmware: Firmware::new(1, 2, 3),
            serial_number: 16,
            rpm: -500.0,
            reverses: true,
            waver: 3.0,
            position: 0x20000,
            temperature: -10,
            errors: 0x12,
            filter: PositionFilter::Dynamic,
            cycles: 801,
            pulses: WiegandPulses { average: 61, lowest: 52 },
            calibration_time: Duration::from_millis(500),
            silent_calibration: false,
            keeps_status: true,
            echo: true,
            order: ByteOrder::HighFirst,
        };
        assert_eq!(config, expected);
        assert_eq!(Config::from_pairs(&[]), Ok(Config::default()));
    }

    #[test]
    fn reports_invalid_values() {
        let cases = [
            (
                "sed=1",
                "a virtual encoder has no setting `sed`; valid settings are seed, fault, firmware, serial, rpm, motor, \
                 waver, position, temperature, errors, filter, cycles, pulses, calibration, calibration-silent, \
                 calibration-status, echo, order",
            ),
            ("filter=fast", "`filter=fast` is not valid (allowed: balanced or dynamic)"),
            ("fault=drop:7", "fault `drop:7`: the probability must be a number from 0 to 1"),
        ];
        for (query, sentence) in cases {
            assert_eq!(read(query).unwrap_err().to_string(), sentence, "{query}");
        }
        let wrong = "seed=-1 firmware=1.6 firmware=1.6.256 serial=0x100000000 rpm=NaN rpm=inf motor=on waver=-1 temperature=206 \
                     position=8589934592 errors=256 cycles=-1 pulses=6.3 pulses=6.3,26 calibration=0 echo=yes order=low";
        for query in wrong.split_whitespace() {
            assert!(matches!(read(query), Err(ConfigError::Value { .. })), "{query}");
        }
    }

    proptest! {
        #[test]
        fn arbitrary_values_never_panic(key in 0..Config::KEYS.len(), value in ".*") {
            let _ = Config::from_pairs(&[(Config::KEYS[key].to_owned(), value)]).map(|config| super::super::Encoder::new(&config));
        }
    }
}
