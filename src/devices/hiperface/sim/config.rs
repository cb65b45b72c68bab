//! Settings of a virtual line, given in the query of a `sim:` link, such as `seed=7&fault=drop:0.01&encoders=2`.
//! [`Bus::new`](super::Bus::new) creates the line from them.

use super::encoder::ResponseTimes;
use super::models::{MODELS, Model};
use crate::devices::hiperface::protocol::{AccessCode, DeviceAddress, EncoderTypes, Geometry, LineSettings};
use crate::expected::{AllowedValues, Quantity};
use crate::parameter::{
    CustomNotation, Keywords, OptionalValue, ParameterValues, RejectedParameter, SWITCH, WholeNumbers, parse_whole,
};
use crate::parameters;
use crate::sim::{ConfigError, FAULTS, RPM, SEED, SimulatedFaults, VirtualDevice, setting};

parameters! {
    /// Settings of a virtual line with encoders. The default is a single SKM36 with factory settings, at rest and
    /// without faults.
    pub struct Config: ConfigError {
        pub(super) seed: u64 = 0, "seed" => SEED;
        pub(super) faults: SimulatedFaults = SimulatedFaults::default(), "fault" => FAULTS, "connect.fault" like "drop:0.01";
        pub(super) model: Model = default_model(), "model" => ModelValues;
        pub(super) encoder_type: Option<u8> = None, "type" => OptionalValue(CustomNotation(AllowedValues::TypeByte, parse_whole::<u8>));
        pub(super) serial_number: Option<String> = None, "serial" => OptionalValue(CustomNotation(AllowedValues::SerialNumber, parse_serial_number));
        pub(super) address: DeviceAddress = DeviceAddress::FACTORY, "address" => CustomNotation(AllowedValues::BusAddress { last: DeviceAddress::LAST.byte() }, address);
        pub(super) settings: LineSettings = LineSettings::FACTORY,
            "settings" => CustomNotation(AllowedValues::SettingsByte, settings);
        pub(super) rpm: f64 = 0.0, "rpm" => RPM, "connect.rpm";
        pub(super) position: Option<u32> = None, "position" => OptionalValue(CustomNotation(AllowedValues::Steps, parse_whole::<u32>));
        pub(super) temperature: i16 = 42, "temperature" => WholeNumbers(Quantity::WholeCelsius, -100..=300);
        pub(super) echo: bool = false, "echo" => SWITCH;
        pub(super) encoders: u8 = 1, "encoders" => WholeNumbers(Quantity::Number, 1..=8);
        pub(super) pace: ResponseTimes = ResponseTimes::Typical, "pace" => Keywords(&[("typical", ResponseTimes::Typical), ("worst", ResponseTimes::Worst)]);
        pub(super) codes: [AccessCode; 4] = [AccessCode::FACTORY; 4], secret "codes" => Codes;
    }
}

impl Config {
    /// Parses percent-decoded keys and values. If a key is repeated, its last value applies. Numbers are decimal, or
    /// hexadecimal with the prefix `0x`. If there are several encoders, they have consecutive addresses and serial
    /// numbers, starting with those specified for the first encoder.
    ///
    /// # Errors
    /// Returns an error with the key and the allowed values if a key or a value is invalid.
    pub fn from_pairs(pairs: &[(String, String)]) -> Result<Self, ConfigError> {
        let config: Config = setting::read(VirtualDevice::Encoder, pairs)?;
        config.check_combination()?;
        Ok(config)
    }

    pub(super) fn device_address(&self, index: u8) -> DeviceAddress {
        DeviceAddress::new(self.address.byte().saturating_add(index)).unwrap_or(self.address)
    }

    /// Returns the serial number of an encoder. Its final digits increase with `index`, so that the encoders can be
    /// distinguished.
    pub(super) fn derive_serial_number(&self, index: u8) -> String {
        let first = self.serial_number.as_deref().unwrap_or(self.model.serial_number);
        let stem = first.trim_end_matches(|c: char| c.is_ascii_digit());
        let digits = first.strip_prefix(stem).unwrap_or_default();
        let width = digits.len();
        let own = match digits.parse::<u64>() {
            Ok(number) if index > 0 => {
                let wrapped = (number + u64::from(index)) % 10u64.saturating_pow(u32::try_from(width).unwrap_or(0));
                format!("{stem}{wrapped:0width$}")
            }
            _ => first.to_owned(),
        };
        format!("{own:<9}")
    }

    /// Returns the geometry of the requested encoder type, or that of the model if the type is unknown.
    pub(super) fn geometry(&self, types: &EncoderTypes) -> Geometry {
        self.encoder_type.and_then(|code| types.find(code)?.geometry).unwrap_or(self.model.geometry)
    }

    /// Returns whether the requested encoder type is a kit without a bearing. If the type is unknown, the model
    /// determines this.
    pub(super) fn is_kit(&self, types: &EncoderTypes) -> bool {
        self.encoder_type.and_then(|code| types.find(code)).map_or(self.model.kit, |row| row.kit)
    }

    fn check_combination(&self) -> Result<(), ConfigError> {
        let range = self.geometry(&EncoderTypes::built_in()).position_count();
        if let (Some(position), Some(range)) = (self.position, range)
            && u64::from(position) >= range
        {
            let allowed = AllowedValues::range(Quantity::Position, 0, range - 1);
            return Err(RejectedParameter::new("position", position, allowed).into());
        }
        let last_first = DeviceAddress::LAST.byte() - (self.encoders - 1);
        if self.address.byte() > last_first {
            let allowed = AllowedValues::FirstAddress { last: last_first };
            let address = format!("{:#04X}", self.address.byte());
            return Err(RejectedParameter::new("address", address, allowed).into());
        }
        Ok(())
    }
}

const fn default_model() -> Model {
    let [usual, ..] = MODELS;
    usual
}

struct ModelValues;

impl ParameterValues for ModelValues {
    type Value = Model;

    fn read(&self, text: &str) -> Option<Model> {
        Model::find(text).copied()
    }

    fn allowed_values(&self) -> AllowedValues {
        AllowedValues::OneOf(MODELS.map(|model| model.name.to_owned()).to_vec())
    }
}

/// Access codes with their numbers, such as `0:55,2:66`.
struct Codes;

impl ParameterValues for Codes {
    type Value = [AccessCode; 4];

    fn read(&self, text: &str) -> Option<[AccessCode; 4]> {
        let mut codes = [AccessCode::FACTORY; 4];
        for item in text.split(',') {
            let (number, code) = item.split_once(':')?;
            let entry = codes.get_mut(number.parse::<usize>().ok()?)?;
            *entry = AccessCode::new(u8::from_str_radix(code, 16).ok()?);
        }
        Some(codes)
    }

    fn allowed_values(&self) -> AllowedValues {
        AllowedValues::AccessCodes
    }
}

fn parse_serial_number(text: &str) -> Option<String> {
    let fits = (1..=9).contains(&text.len()) && text.bytes().all(|c| matches!(c, b' '..=b'~'));
    fits.then(|| text.to_owned())
}

fn address(text: &str) -> Option<DeviceAddress> {
    parse_whole(text).and_then(DeviceAddress::new)
}

fn settings(text: &str) -> Option<LineSettings> {
    parse_whole(text).map(LineSettings::from_byte).filter(|settings| settings.is_valid())
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
            "seed=7&fault=drop:0.5&model=sel37&type=0x47&serial=AB123&address=0x58&settings=0xE5&rpm=-12.5&\
             position=0x1234&temperature=-10&echo=on&encoders=8&pace=worst&codes=0:12,3:AB",
        )
        .unwrap();
        let expected = Config {
            seed: 7,
            faults: "drop:0.5".parse().unwrap(),
            model: MODELS[2],
            encoder_type: Some(0x47),
            serial_number: Some("AB123".to_owned()),
            address: DeviceAddress::new(0x58).unwrap(),
            settings: LineSettings::from_byte(0xE5),
            rpm: -12.5,
            position: Some(0x1234),
            temperature: -10,
            echo: true,
            encoders: 8,
            pace: ResponseTimes::Worst,
            codes: [0x12, 0x55, 0x55, 0xAB].map(AccessCode::new),
        };
        assert!(config == expected);
        assert!(Config::from_pairs(&[]) == Ok(Config::default()));
    }

    #[test]
    fn reports_invalid_values() {
        let cases = [
            (
                "sed=1",
                "a virtual encoder has no setting `sed`; valid settings are seed, fault, model, type, serial, address, \
                 settings, rpm, position, temperature, echo, encoders, pace, codes",
            ),
            ("model=skm", "`model=skm` is not valid (allowed: one of skm36, sks36, sel37)"),
            ("address=0x60", "`address=0x60` is not valid (allowed: an address from 0x40 to 0x5F)"),
            ("echo=yes", "`echo=yes` is not valid (allowed: on or off)"),
            ("encoders=9", "`encoders=9` is not valid (allowed: a number from 1 to 8)"),
            ("model=sks36&position=4096", "`position=4096` is not valid (allowed: a position from 0 to 4095)"),
            (
                "encoders=2&address=95",
                "`address=0x5F` is not valid (allowed: an address from 0x40 to 0x5E, so that there is an address for \
                 every encoder)",
            ),
            (
                "codes=4:66",
                "`codes=**` is not valid (allowed: NUMBER:HEX for the access codes 0 to 3, separated by \
                 commas, such as 0:55,2:66)",
            ),
            ("fault=drop:7", "fault `drop:7`: the probability must be a number from 0 to 1"),
        ];
        for (query, sentence) in cases {
            assert_eq!(read(query).unwrap_err().to_string(), sentence, "{query}");
        }
        for query in ["seed=-1", "type=256", "serial=", "serial=1234567890", "settings=0xE7", "rpm=NaN", "rpm=inf"] {
            assert!(matches!(read(query), Err(ConfigError::Value { .. })), "{query}");
        }
        for query in ["position=-1", "temperature=4.5", "pace=fast", "codes=", "codes=1:155", "encoders=0"] {
            assert!(matches!(read(query), Err(ConfigError::Value { .. })), "{query}");
        }
    }

    #[test]
    fn serial_numbers_are_consecutive() {
        let config = Config { serial_number: Some("AB999".to_owned()), ..Config::default() };
        assert_eq!(config.derive_serial_number(0), "AB999    ");
        assert_eq!(config.derive_serial_number(2), "AB001    ");
        assert_eq!(Config::default().derive_serial_number(1), "GB0450180");
    }

    proptest! {
        #[test]
        fn arbitrary_values_do_not_panic(key in 0..Config::KEYS.len(), value in ".*") {
            let _ = Config::from_pairs(&[(Config::KEYS[key].to_owned(), value)]).map(|config| super::super::Bus::new(&config));
        }
    }
}
