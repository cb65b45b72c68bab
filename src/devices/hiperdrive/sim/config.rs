//! Settings of a virtual adapter or hub and its drives, taken from the query of a `sim:` link such as
//! `hub=4&drives=1,0,1&position=65536`. This module opens no connection.

use std::time::Duration;

use super::axis::{DriveDefect, SpindleLoad};
use super::station::RESET_TIME;
use crate::devices::hiperdrive::protocol::drive_parameter::MAXIMUM_SPEEDS;
use crate::devices::hiperdrive::protocol::{AddressSwitch, ByteOrder, DriveNumber, Topology, VARIANTS, Variant};
use crate::expected::{AllowedValues, Quantity};
use crate::parameter::{
    ANY, CustomNotation, DecimalNumbers, Keywords, Milliseconds, OptionalValue, RejectedParameter, SWITCH,
    WholeNumbers, parse_whole,
};
use crate::parameters;
use crate::sim::{ConfigError, FAULTS, SEED, SimulatedFaults, VirtualDevice, setting};

parameters! {
    /// Settings of a virtual adapter or hub and its drives. The default is an adapter with a single HDA30A at rest,
    /// with factory settings and without faults. The drive settings apply to all drives alike.
    pub struct Config: ConfigError {
        /// Topology, by default an adapter with one drive.
        pub(super) topology: Topology = Topology::Adapter, "hub" => CustomNotation(AllowedValues::Hub, |text| HUBS.read(text));
        /// Ports that have a drive, by default all. Ports that are not listed are empty.
        drives: Option<String> = None, "drives" => OptionalValue(ANY), "connect.plugged" like "1,0,1";
        /// Whether each port has a drive, or `None` if all ports have one.
        plugged: Option<Vec<bool>> = None;
        /// Variant of the drives, given as the value of parameter 120 or by name.
        pub(super) variant: Variant = Variant::new(7), "variant" => CustomNotation(AllowedValues::Variant, parse_variant);
        /// Value of parameter 152, by default the factory setting.
        pub(super) requested: Option<bool> = None, "requested" => OptionalValue(Keywords(&[("0", false), ("1", true)]));
        /// Position of the drives, in steps of 65536 per turn.
        pub(super) position: i32 = 0, "position" => WholeNumbers(Quantity::Steps, i32::MIN..=i32::MAX);
        /// Maximum speed (parameter 166), in tenths of rpm.
        pub(super) speed: Option<u16> = None, "speed" => OptionalValue(WholeNumbers(Quantity::TenthsOfRpm, MAXIMUM_SPEEDS));
        /// Load of the spindles in percent. A load above 100 cannot be moved.
        load: u8 = SpindleLoad::default().percent, "load" => WholeNumbers(Quantity::Torque, 0..=200);
        blocked: bool = false, "blocked" => SWITCH;
        /// Defect of the drives: they do not stop at a target or limit, turn in the wrong direction, or always set
        /// status bit 15.
        defect: Option<DriveDefect> = None, "defect" => OptionalValue(Keywords(&[
            ("runs-on", DriveDefect::RunsOn), ("reversed", DriveDefect::Reversed), ("says-outside", DriveDefect::SaysOutside),
        ]));
        /// Ambient temperature of the drives in degrees Celsius. A drive hotter than 80 degrees reports a fault.
        temperature: f64 = SpindleLoad::default().ambient, "temperature" => DecimalNumbers(Quantity::Celsius, -40.0..=120.0);
        /// Position of switch S3. Drives can be moved over the bus only in position 0.
        pub(super) s3: u8 = 0, "s3" => WholeNumbers(Quantity::SwitchPosition, 0..=9);
        pub(super) switch: u8 = 0, "switch" => CustomNotation(AllowedValues::SwitchDigits, parse_switches);
        pub(super) volts: f64 = 24.0, "supply" => DecimalNumbers(Quantity::Volts, 0.0..=100.0);
        /// Duration of a reset of all drives (47 = −4), after which the reply is sent.
        pub(super) resets: Duration = RESET_TIME, "reset" => Milliseconds(0..=8000);
        /// Serial number, parameter 17.
        pub(super) serial_number: u16 = 4711, "serial" => WholeNumbers(Quantity::Number, 0..=u16::MAX);
        /// Product name, parameter 15.
        pub(super) name: String = "HIPERDRIVE".to_owned(), "name" => CustomNotation(AllowedValues::Ascii { most: 32 }, name);
        /// Byte order of numbers in process data (`U`: not documented).
        pub(super) order: ByteOrder = ByteOrder::Little, "order" => ByteOrder::KEYWORDS;
        /// Whether parameter strings are preceded by their length (`U`: not documented).
        pub(super) counted_texts: bool = false, "text" => Keywords(&[("plain", false), ("counted", true)]);
        pub(super) seed: u64 = 0, "seed" => SEED;
        /// Faults to inject. `drop` is the fraction of replies, and of packets in both directions, that are lost.
        /// `flip` and `garbage` are the fractions of replies and returned packets in which a bit is inverted or all
        /// bytes are random. `silent-after` counts frames and packets.
        pub(super) faults: SimulatedFaults = SimulatedFaults::default(), "fault" => FAULTS, "connect.fault" like "drop:0.01";
    }
}

impl Config {
    /// Parses keys and values, already percent-decoded. Numbers are decimal, or hexadecimal with the prefix `0x`. If a
    /// key occurs twice, the last value applies.
    ///
    /// # Errors
    /// Returns an error with the key and the allowed values if a setting is invalid.
    pub fn from_pairs(pairs: &[(String, String)]) -> Result<Self, ConfigError> {
        let mut config: Config = setting::read(VirtualDevice::Device("HIPERDRIVE"), pairs)?;
        config.plugged = config.drives.take().map(|drives| parse_ports(&drives, config.topology)).transpose()?;
        Ok(config)
    }

    /// Returns the control supply voltage, in tenths of a volt.
    pub(super) fn supply_in_tenths_of_volt(&self) -> u16 {
        // The result is at most 1000.
        (self.volts * 10.0).round() as u16
    }

    pub(super) fn drive(&self, number: DriveNumber) -> Option<(Variant, SpindleLoad)> {
        let place = usize::from(number.get()) - 1;
        let plugged = self.plugged.as_ref().is_none_or(|places| places.get(place) == Some(&true));
        plugged.then(|| (self.variant, self.load()))
    }

    fn load(&self) -> SpindleLoad {
        let wall = self.blocked.then(|| self.start_position());
        SpindleLoad {
            percent: self.load,
            wall_below: wall,
            wall_above: wall,
            ambient: self.temperature,
            defect: self.defect,
        }
    }

    /// Returns the position of the drives, in steps of 65536 per turn.
    fn start_position(&self) -> f64 {
        f64::from(self.position)
    }
}

/// Allowed values of the `hub` setting.
const HUBS: Keywords<Topology> = Keywords(&[("4", Topology::Hub4), ("8", Topology::Hub8)]);

fn parse_variant(text: &str) -> Option<Variant> {
    let row = VARIANTS.iter().find(|row| row.name == text || row.variant.number().to_string() == text);
    row.map(|row| row.variant)
}

fn parse_switches(text: &str) -> Option<u8> {
    parse_whole(text).and_then(AddressSwitch::parse).map(AddressSwitch::number)
}

fn name(text: &str) -> Option<String> {
    let fits = text.len() <= 32 && text.bytes().all(|c| (b' '..=b'~').contains(&c));
    fits.then(|| text.to_owned())
}

fn parse_ports(text: &str, topology: Topology) -> Result<Vec<bool>, RejectedParameter> {
    let count = topology.drives();
    let place = |own: &str| match own.trim() {
        "1" => Some(true),
        "0" => Some(false),
        _ => None,
    };
    let places: Option<Vec<bool>> = text.split(',').map(place).collect();
    let places = places.filter(|places| places.len() <= usize::from(count));
    places.ok_or_else(|| RejectedParameter::new("drives", text, AllowedValues::Places { count }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::devices::hiperdrive::protocol::{ErrorCode, OutputData, OutputImage, ParameterNumber, StatusBit, Value};
    use crate::devices::hiperdrive::sim::{Station, Target};
    use crate::sim::setting::query_pairs;
    use crate::units::Moment;
    use proptest::prelude::*;

    fn read(query: &str) -> Result<Config, ConfigError> {
        Config::from_pairs(&query_pairs(query))
    }

    #[test]
    fn parses_every_key() {
        let query = "drives=1,0,1&hub=4&variant=HDA70&requested=1&position=-100&speed=200&load=60&blocked=on&defect=reversed&\
                     temperature=-12.5&s3=2&switch=17&supply=23.5&reset=8000&serial=0x10&name=Feeder&order=big&text=counted&seed=9&\
                     fault=drop:0.25";
        assert_eq!(query.split('&').count(), Config::KEYS.len());
        let expected = Config {
            topology: Topology::Hub4,
            drives: None,
            plugged: Some(vec![true, false, true]),
            variant: Variant::new(13),
            requested: Some(true),
            position: -100,
            speed: Some(200),
            resets: Duration::from_secs(8),
            load: 60,
            blocked: true,
            defect: Some(DriveDefect::Reversed),
            temperature: -12.5,
            s3: 2,
            switch: 17,
            volts: 23.5,
            serial_number: 16,
            name: "Feeder".to_owned(),
            order: ByteOrder::Big,
            counted_texts: true,
            seed: 9,
            faults: "drop:0.25".parse().unwrap(),
        };
        assert_eq!(read(query), Ok(expected));
        assert_eq!(Config::from_pairs(&[]), Ok(Config::default()));
        assert_eq!(read("variant=13").unwrap().variant, Variant::new(13));
    }

    #[test]
    fn reports_invalid_values() {
        let keys = Config::KEYS.join(", ");
        let cases = [
            ("sed=1", format!("a virtual HIPERDRIVE has no setting `sed`; valid settings are {keys}")),
            (
                "drives=1,1",
                "`drives=1,1` is not valid (allowed: 0 or 1 for each port (number of ports: 1), separated by commas, \
                 such as 1,0)"
                    .to_owned(),
            ),
            (
                "hub=2",
                "`hub=2` is not valid (allowed: 4 or 8 ports; omit the setting for an adapter with one drive)"
                    .to_owned(),
            ),
            ("fault=drop:7", "fault `drop:7`: the probability must be a number from 0 to 1".to_owned()),
        ];
        for (query, sentence) in cases {
            assert_eq!(read(query).unwrap_err().to_string(), sentence, "{query}");
        }
        let wrong = "drives=2 drives= variant=0 variant=14 variant=HDA requested=2 position=2147483648 position=1.5 speed=4 speed=351 \
                     load=201 blocked=1 temperature=NaN temperature=121 s3=10 switch=100 supply=-1 reset=8001 serial=65536 name=Ü order=le \
                     text=raw seed=-1";
        for query in wrong.split_whitespace() {
            assert!(matches!(read(query), Err(ConfigError::Value { .. })), "{query}");
        }
    }

    #[test]
    fn station_applies_config() {
        let query = "hub=4&drives=0,1&variant=HDA70&requested=1&position=-100&speed=200&switch=17&supply=23.5&serial=16&name=Feeder";
        let mut station = Station::from_config(&read(query).unwrap());
        let mut value = |number| station.read(Moment::START, ParameterNumber::new(number).unwrap()).ok();
        for (number, expected) in [(9, 235), (12, 17), (17, 16), (120, 0), (220, 13), (252, 1), (207, -100), (266, 200)]
        {
            assert_eq!(value(number), Some(Value::Number(expected)), "{number}");
        }
        assert_eq!((value(15), value(307)), (Some(Value::Text("Feeder".to_owned())), None));
        // 16000 turns of 65536 steps.
        assert_eq!(value(260), Some(Value::Number(1_048_576_000)));
    }

    /// Moves the first drive towards a target until it stops, and returns its last status and newest error.
    fn move_to_target(query: &str) -> (u16, Option<ErrorCode>) {
        let mut station = Station::from_config(&read(query).unwrap());
        let mut now = Moment::START;
        station.open(now, Duration::from_secs(60));
        for control in [0x0400, 0x0401, 0x0409, 0x0439, 0x0479] {
            let out = OutputData { control, speed: 100, torque: 100, target: 65536 };
            station.handle_process_data(now, &OutputImage { drives: vec![out], pkw: None }, true);
            now = now + Duration::from_secs(4);
        }
        let drive = station.drive(DriveNumber::FIRST).unwrap();
        let status = drive.actual_values(now).status;
        let error = match drive.read(now, 108) {
            Some(Value::Number(0)) | None => None,
            Some(Value::Number(code)) => Some(ErrorCode::new(u16::try_from(code).unwrap())),
            Some(Value::Text(text)) => panic!("{text}"),
        };
        (status.with_bit(StatusBit::SetpointAcknowledged, false).to_u16(), error)
    }

    /// The status words are those of sections 3 and 9 of the reference: 3E37 at the target (compared without bit 12)
    /// and 2AB8 for a fault.
    #[test]
    fn drives_show_configured_faults() {
        for (query, status, error) in [
            ("", 0x2E37, None),
            ("load=90", 0x2E37, None),
            ("load=101", 0x2AB8, Some(ErrorCode::FOLLOWING_ERROR)),
            ("blocked=on", 0x2AB8, Some(ErrorCode::BLOCK_FORWARD)),
            ("blocked=on&position=70000", 0x2AB8, Some(ErrorCode::BLOCK_REVERSE)),
            ("temperature=85", 0x2AB8, Some(ErrorCode::OVER_TEMPERATURE)),
            ("requested=0", 0x2A30, None),
            ("s3=1", 0x2A30, None),
        ] {
            assert_eq!(move_to_target(query), (status, error), "{query}");
        }
    }

    proptest! {
        #[test]
        fn arbitrary_values_never_panic(key in 0..Config::KEYS.len(), value in ".*|[0-9]{1,9}|0x[0-9A-F]{1,7}|[01](,[01]){0,9}") {
            let _ = Config::from_pairs(&[(Config::KEYS[key].to_owned(), value)]).map(|config| Target::new(&config));
        }
    }
}
