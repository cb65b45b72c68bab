//! The settings of virtual drives and what stands in front of them, as the query of a `sim:` link gives them:
//! `hub=4&drives=1,0,1&position=65536`. It opens nothing.

use std::time::Duration;

use super::axis::{Defect, Load};
use super::station::RESETS;
use crate::devices::hiperdrive::protocol::{AddressSwitch, ByteOrder, DriveNumber, Topology, VARIANTS, Variant};
use crate::expected::{Expected, Quantity};
use crate::sim::setting::Setting;
use crate::sim::{ConfigError, Faults};

/// What a virtual adapter or hub and its drives shall be like. The default is an adapter with one drive HDA30A from the
/// factory, at rest, without faults.
#[derive(Clone, Debug, PartialEq)]
pub struct Config {
    pub(super) topology: Topology,
    /// Place by place; `None`: everywhere is a drive.
    plugged: Option<Vec<bool>>,
    pub(super) variant: Variant,
    pub(super) requested: Option<bool>,
    pub(super) position: i32,
    pub(super) speed: Option<u16>,
    pub(super) resets: Duration,
    load: u8,
    blocked: bool,
    defect: Option<Defect>,
    temperature: f64,
    pub(super) s3: u8,
    pub(super) switch: u8,
    pub(super) supply_tenths: u16,
    pub(super) serial_number: u16,
    pub(super) name: String,
    pub(super) order: ByteOrder,
    pub(super) counted_texts: bool,
    pub(super) seed: u64,
    pub(super) faults: Faults,
}

impl Default for Config {
    fn default() -> Self {
        Config {
            topology: Topology::Adapter,
            plugged: None,
            variant: Variant::new(7),
            requested: None,
            position: 0,
            speed: None,
            resets: RESETS,
            load: Load::default().percent,
            blocked: false,
            defect: None,
            temperature: Load::default().ambient,
            s3: 0,
            switch: 0,
            supply_tenths: 240,
            serial_number: 4711,
            name: "HIPERDRIVE".to_owned(),
            order: ByteOrder::Little,
            counted_texts: false,
            seed: 0,
            faults: Faults::default(),
        }
    }
}

impl Config {
    /// The keys that [`from_pairs`](Self::from_pairs) takes. What concerns drives concerns all of them.
    ///
    /// | key | value |
    /// |---|---|
    /// | `hub` | `4` or `8` places; without it an adapter with one drive |
    /// | `drives` | which places have a drive: `1,0,1`; without it all, behind a list's end none |
    /// | `variant` | parameter 120, 1…13, or the name as `HDA70` |
    /// | `requested` | parameter 152: 0 or 1; without it as from the factory |
    /// | `position` | where the drives stand, in steps of which a turn has 65536 |
    /// | `speed` | parameter 166: greatest speed in tenths of rpm, 5…350 |
    /// | `load` | percent of the nominal torque that the spindle takes, 0…200: above 100 no drive can move it |
    /// | `blocked` | `on`: the spindle is held where it stands |
    /// | `defect` | `runs-on`: the drives stop neither at a target nor at a limit; `reversed`: they turn the other way; `says-outside`: status bit 15 is always set |
    /// | `temperature` | degrees Celsius around the drives: from 80 on they fail |
    /// | `s3` | switch S3, 0…9; away from 0 nothing moves from the bus |
    /// | `switch` | address switch, 0…99 |
    /// | `supply` | control supply in volts |
    /// | `reset` | milliseconds that a reset of all drives takes (47 = −4), 0…8000: it is answered when it is done |
    /// | `serial`, `name` | parameters 17 and 15 |
    /// | `order` | `little` or `big`: of the numbers in process data (`U`) |
    /// | `text` | `plain`, or `counted` by a byte in front: texts of parameters (`U`) |
    /// | `seed`, `fault` | noise; `drop`: share of replies lost, and of packets both ways; `flip`, `garbage`: share of replies and packets back with a bit inverted, or replaced by random bytes; `silent-after` counts frames and packets |
    pub const KEYS: [&str; 20] = [
        "hub",
        "drives",
        "variant",
        "requested",
        "position",
        "speed",
        "load",
        "blocked",
        "defect",
        "temperature",
        "s3",
        "switch",
        "supply",
        "reset",
        "serial",
        "name",
        "order",
        "text",
        "seed",
        "fault",
    ];

    /// Reads keys and values, already percent-decoded. Of a key given twice the last counts. Numbers are decimal or
    /// `0x…`.
    ///
    /// # Errors
    /// With a sentence that names the key and what is allowed.
    pub fn from_pairs(pairs: &[(String, String)]) -> Result<Self, ConfigError> {
        let mut config = Config::default();
        let mut drives = None;
        for (key, value) in pairs {
            let setting = Setting { key, value };
            if key == "drives" {
                drives = Some(setting);
            } else if !config.set_drives(setting)? && !config.set_device(setting)? {
                return Err(setting.unknown("a virtual HIPERDRIVE", &Self::KEYS));
            }
        }
        config.plugged = drives.map(|setting| places(setting, config.topology)).transpose()?;
        Ok(config)
    }

    fn set_drives(&mut self, setting: Setting<'_>) -> Result<bool, ConfigError> {
        match setting.key {
            "variant" => self.variant = variant(setting)?,
            "requested" => self.requested = Some(setting.one_of(&[("0", false), ("1", true)])?),
            "position" => {
                let allowed = || Expected::range(Quantity::Steps, i32::MIN, i32::MAX);
                self.position = setting.value.parse().map_err(|_| setting.refused(allowed()))?;
            }
            "speed" => self.speed = Some(setting.within(5..=350, Expected::range(Quantity::TenthsOfRpm, 5, 350))?),
            "load" => self.load = setting.within(0..=200, Expected::range(Quantity::Torque, 0, 200))?,
            "blocked" => self.blocked = setting.switch()?,
            "defect" => {
                let defects = [
                    ("runs-on", Defect::RunsOn),
                    ("reversed", Defect::Reversed),
                    ("says-outside", Defect::SaysOutside),
                ];
                self.defect = Some(setting.one_of(&defects)?);
            }
            "temperature" => {
                self.temperature = setting.decimal(-40.0..=120.0, Expected::range(Quantity::Celsius, -40, 120))?
            }
            _ => return Ok(false),
        }
        Ok(true)
    }

    fn set_device(&mut self, setting: Setting<'_>) -> Result<bool, ConfigError> {
        match setting.key {
            "hub" => {
                let hubs = [("4", Topology::Hub4), ("8", Topology::Hub8)];
                let found = hubs.into_iter().find(|(word, _)| *word == setting.value);
                self.topology = found.ok_or_else(|| setting.refused(Expected::Hub))?.1;
            }
            "s3" => self.s3 = setting.within(0..=9, Expected::range(Quantity::SwitchPosition, 0, 9))?,
            "switch" => {
                let refused = || setting.refused(Expected::SwitchDigits);
                let switch = AddressSwitch::parse(setting.number(Expected::SwitchDigits)?).ok_or_else(refused)?;
                self.switch = switch.number();
            }
            "supply" => {
                // At most 1000 tenths.
                self.supply_tenths =
                    (setting.decimal(0.0..=100.0, Expected::range(Quantity::Volts, 0, 100))? * 10.0).round() as u16;
            }
            "reset" => {
                let ms: u16 = setting.within(0..=8000, Expected::range(Quantity::Milliseconds, 0, 8000))?;
                self.resets = Duration::from_millis(ms.into());
            }
            "serial" => self.serial_number = setting.number(Expected::number(0, u16::MAX))?,
            "name" => {
                let fits =
                    setting.value.len() <= Self::MAX_NAME && setting.value.bytes().all(|c| (b' '..=b'~').contains(&c));
                let name = Some(setting.value).filter(|_| fits);
                self.name = name.ok_or_else(|| setting.refused(Expected::Ascii { most: 32 }))?.to_owned();
            }
            "order" => {
                let orders = [("little", ByteOrder::Little), ("big", ByteOrder::Big)];
                self.order = setting.one_of(&orders)?;
            }
            "text" => {
                self.counted_texts = setting.one_of(&[("plain", false), ("counted", true)])?;
            }
            "seed" => self.seed = setting.number(Expected::Whole)?,
            "fault" => self.faults = setting.value.parse()?,
            _ => return Ok(false),
        }
        Ok(true)
    }

    const MAX_NAME: usize = 32;

    /// What is plugged into a place.
    pub(super) fn drive(&self, number: DriveNumber) -> Option<(Variant, Load)> {
        let place = usize::from(number.get()) - 1;
        let plugged = self.plugged.as_ref().is_none_or(|places| places.get(place) == Some(&true));
        plugged.then(|| (self.variant, self.load()))
    }

    fn load(&self) -> Load {
        let wall = self.blocked.then(|| self.place());
        Load { percent: self.load, wall_below: wall, wall_above: wall, ambient: self.temperature, defect: self.defect }
    }

    /// Where the drives stand, in steps of 65536 a turn.
    fn place(&self) -> f64 {
        f64::from(self.position)
    }
}

fn variant(setting: Setting<'_>) -> Result<Variant, ConfigError> {
    let row =
        VARIANTS.iter().find(|row| row.name == setting.value || row.variant.number().to_string() == setting.value);
    row.map(|row| row.variant).ok_or_else(|| setting.refused(Expected::Variant))
}

/// Which places have a drive.
fn places(setting: Setting<'_>, topology: Topology) -> Result<Vec<bool>, ConfigError> {
    let count = topology.drives();
    let refused = || setting.refused(Expected::Places { count });
    let place = |text: &str| match text.trim() {
        "1" => Ok(true),
        "0" => Ok(false),
        _ => Err(refused()),
    };
    let places: Vec<bool> = setting.value.split(',').map(place).collect::<Result<_, _>>()?;
    if places.len() <= usize::from(count) { Ok(places) } else { Err(refused()) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::devices::hiperdrive::protocol::{ErrorCode, OutData, OutImage, ParameterNumber, StatusBit, Value};
    use crate::devices::hiperdrive::sim::{Station, Target};
    use crate::sim::setting::pairs;
    use crate::units::Moment;
    use proptest::prelude::*;

    fn read(query: &str) -> Result<Config, ConfigError> {
        Config::from_pairs(&pairs(query))
    }

    #[test]
    fn every_key_is_read() {
        let query = "drives=1,0,1&hub=4&variant=HDA70&requested=1&position=-100&speed=200&load=60&blocked=on&defect=reversed&\
                     temperature=-12.5&s3=2&switch=17&supply=23.5&reset=8000&serial=0x10&name=Feeder&order=big&text=counted&seed=9&\
                     fault=drop:0.25";
        assert_eq!(query.split('&').count(), Config::KEYS.len());
        let expected = Config {
            topology: Topology::Hub4,
            plugged: Some(vec![true, false, true]),
            variant: Variant::new(13),
            requested: Some(true),
            position: -100,
            speed: Some(200),
            resets: Duration::from_secs(8),
            load: 60,
            blocked: true,
            defect: Some(Defect::Reversed),
            temperature: -12.5,
            s3: 2,
            switch: 17,
            supply_tenths: 235,
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
    fn what_is_wrong_is_told_in_a_sentence() {
        let keys = Config::KEYS.join(", ");
        let cases = [
            ("sed=1", format!("a virtual HIPERDRIVE has no setting `sed`; allowed are {keys}")),
            (
                "drives=1,1",
                "`drives=1,1` cannot be used: allowed is 0 or 1 for each of 1 places, separated by commas, as 1,0"
                    .to_owned(),
            ),
            (
                "hub=2",
                "`hub=2` cannot be used: allowed is 4 or 8; without it there is an adapter with one drive".to_owned(),
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

    /// What a drive says of a setting: read from it, not from the settings.
    #[test]
    fn a_station_is_as_it_was_asked_for() {
        let query = "hub=4&drives=0,1&variant=HDA70&requested=1&position=-100&speed=200&switch=17&supply=23.5&serial=16&name=Feeder";
        let mut station = Station::of(&read(query).unwrap());
        let mut value = |number| station.read(Moment::START, ParameterNumber::new(number).unwrap()).ok();
        for (number, expected) in [(9, 235), (12, 17), (17, 16), (120, 0), (220, 13), (252, 1), (207, -100), (266, 200)]
        {
            assert_eq!(value(number), Some(Value::Number(expected)), "{number}");
        }
        assert_eq!((value(15), value(307)), (Some(Value::Text("Feeder".to_owned())), None));
        // 16000 turns of 65536 steps.
        assert_eq!(value(260), Some(Value::Number(1_048_576_000)));
    }

    /// Leads the first drive to a move, as far as it comes; what it says then, and its newest error.
    fn driven(query: &str) -> (u16, Option<ErrorCode>) {
        let mut station = Station::of(&read(query).unwrap());
        let mut now = Moment::START;
        station.open(now, Duration::from_secs(60));
        for control in [0x0400, 0x0401, 0x0409, 0x0439, 0x0479] {
            let out = OutData { control, speed: 100, torque: 100, target: 65536 };
            station.cyclic(now, &OutImage { drives: vec![out], pkw: None }, true);
            now = now + Duration::from_secs(4);
        }
        let drive = station.drive(DriveNumber::FIRST).unwrap();
        let status = drive.actual(now).status;
        let error = match drive.read(now, 108) {
            Some(Value::Number(0)) | None => None,
            Some(Value::Number(code)) => Some(ErrorCode::new(u16::try_from(code).unwrap())),
            Some(Value::Text(text)) => panic!("{text}"),
        };
        (status.with(StatusBit::SetpointAcknowledged, false).word(), error)
    }

    /// Reference 3 and 9: done is 3E37, of which bit 12 is left out; a fault 2AB8.
    #[test]
    fn drives_do_what_one_wants_to_see() {
        for (query, status, error) in [
            ("", 0x2E37, None),
            ("load=90", 0x2E37, None),
            ("load=101", 0x2AB8, Some(ErrorCode::FOLLOWING)),
            ("blocked=on", 0x2AB8, Some(ErrorCode::BLOCK_FORWARD)),
            ("blocked=on&position=70000", 0x2AB8, Some(ErrorCode::BLOCK_REVERSE)),
            ("temperature=85", 0x2AB8, Some(ErrorCode::OVER_TEMPERATURE)),
            ("requested=0", 0x2A30, None),
            ("s3=1", 0x2A30, None),
        ] {
            assert_eq!(driven(query), (status, error), "{query}");
        }
    }

    proptest! {
        #[test]
        fn no_value_panics(key in 0..Config::KEYS.len(), value in ".*|[0-9]{1,9}|0x[0-9A-F]{1,7}|[01](,[01]){0,9}") {
            let _ = Config::from_pairs(&[(Config::KEYS[key].to_owned(), value)]).map(|config| Target::new(&config));
        }
    }
}
