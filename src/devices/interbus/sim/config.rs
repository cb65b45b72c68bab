//! The settings of a virtual encoder and its gateway, as the query of a `sim:` link gives them:
//! `steps=360&revolutions=1&cams=demo&rpm=10`. It opens nothing.

use std::time::Duration;

use super::memory::{Memory, PLACES};
use crate::devices::interbus::protocol::{
    Class, Gear, Parameter, ProgramNumber, STEPS_PER_TURN, StartupMode, Value, WordOrder,
};
use crate::expected::{Expected, Quantity};
use crate::sim::setting::Setting;
use crate::sim::{ConfigError, Faults};

/// What a virtual gateway and the encoders behind it shall be like. The default is one K3 encoder as delivered, at rest,
/// without faults; a gateway with unit 1, registers from 0 and the high word first.
#[derive(Clone, Debug, PartialEq)]
pub struct Config {
    pub(super) seed: u64,
    pub(super) faults: Faults,
    pub(super) exceptions: f64,
    pub(super) unit: u8,
    pub(super) input: u16,
    pub(super) output: u16,
    pub(super) order: WordOrder,
    pub(super) encoders: u8,
    pub(super) class: Class,
    pub(super) serial_number: u32,
    pub(super) rpm: f64,
    pub(super) position: u32,
    pub(super) memory: Memory,
    pub(super) mode: StartupMode,
    pub(super) stores: u32,
    pub(super) temperature: i32,
    pub(super) narrow_temperature: bool,
    pub(super) operating_time: u32,
    pub(super) steps_minus_one: bool,
    pub(super) complement_bit: bool,
    pub(super) busy: Duration,
    pub(super) stale: u32,
    pub(super) acknowledges_selection: bool,
}

impl Default for Config {
    fn default() -> Self {
        Config {
            seed: 0,
            faults: Faults::default(),
            exceptions: 0.0,
            unit: 1,
            input: 0,
            output: 0,
            order: WordOrder::HighFirst,
            encoders: 1,
            class: Class::K3,
            serial_number: 7_101_234,
            rpm: 0.0,
            position: 0x12_3456,
            memory: Memory::delivered(),
            mode: StartupMode::K3,
            stores: 3,
            temperature: 253,
            narrow_temperature: false,
            operating_time: 1000,
            steps_minus_one: false,
            complement_bit: false,
            busy: Duration::from_millis(5),
            stale: 1,
            acknowledges_selection: true,
        }
    }
}

impl Config {
    /// The keys that [`from_pairs`](Self::from_pairs) takes.
    ///
    /// | key | value |
    /// |---|---|
    /// | `steps`, `revolutions` | the gear, checked together |
    /// | `direction`, `preset`, `zero-shift` | `cw` or `ccw`; steps; the preset is within the range, not fired and not armed |
    /// | `rpm`, `position` | speed of the shaft, and its place at the start in steps of the disc, 0…33554431 |
    /// | `serial`, `operating-time`, `temperature` | number; tens of minutes; degrees Celsius |
    /// | `temperature-bits` | 25 or 16: of a negative temperature (reference 3, `U`) |
    /// | `complement` | what read-out 3 gives: `code` (3 or 4) or `bit` (0 or 1) (`U`) |
    /// | `program`, `cams` | the cam program that runs, 0 for none; `demo` for programs with cams, `none` |
    /// | `stores` | stores that the EEPROM has had |
    /// | `steps-minus-one` | `on`: steps are given less one, as in older encoders |
    /// | `busy`, `stale` | milliseconds of busy words; cycles in which the IN word is still the old one after a new OUT word |
    /// | `selection` | `echo` or `output`: what a selected program says first (`U`) |
    /// | `class` | `K1`, `K2` or `K3` |
    /// | `encoders`, `unit`, `input`, `output`, `order` | the gateway: 1…8 encoders, two registers each from `input` and `output` on, `high-first` or `low-first` |
    /// | `exception` | share of requests, 0…1, answered with exception 0Bh and not carried out |
    /// | `seed`, `fault` | noise; `drop`, `flip`, `garbage`: share of replies lost, with a bit inverted, replaced by random bytes |
    pub const KEYS: [&str; 28] = [
        "steps",
        "revolutions",
        "direction",
        "preset",
        "zero-shift",
        "rpm",
        "position",
        "serial",
        "operating-time",
        "temperature",
        "temperature-bits",
        "complement",
        "program",
        "cams",
        "stores",
        "steps-minus-one",
        "busy",
        "stale",
        "selection",
        "class",
        "encoders",
        "unit",
        "input",
        "output",
        "order",
        "exception",
        "seed",
        "fault",
    ];

    const MAX_ENCODERS: u8 = 8;
    const MAX_BUSY_MS: u32 = 60_000;
    const MAX_STALE: u32 = 1000;

    /// Reads keys and values, already percent-decoded. Of a key given twice the last counts. Numbers are decimal or
    /// `0x…`.
    ///
    /// # Errors
    /// With a sentence that names the key and what is allowed.
    pub fn from_pairs(pairs: &[(String, String)]) -> Result<Self, ConfigError> {
        let mut config = Config::default();
        let mut gear = Geared::default();
        for (key, value) in pairs {
            let setting = Setting { key, value };
            if !gear.take(setting)? && !config.set_encoder(setting)? && !config.set_gateway(setting)? {
                return Err(setting.unknown("a virtual INTERBUS encoder", &Self::KEYS));
            }
        }
        gear.put_into(&mut config.memory)?;
        Ok(config)
    }

    fn set_encoder(&mut self, setting: Setting<'_>) -> Result<bool, ConfigError> {
        match setting.key {
            "direction" => {
                self.memory.counterclockwise = setting.one_of(&[("cw", false), ("ccw", true)])?;
            }
            "rpm" => self.rpm = setting.rpm()?,
            "position" => {
                self.position = setting.within(..PLACES, Expected::range(Quantity::PlaceOfDisc, 0, PLACES - 1))?
            }
            "serial" => self.serial_number = value(setting)?,
            "operating-time" => self.operating_time = value(setting)?,
            "temperature" => {
                let celsius = setting.decimal(-273.0..=1000.0, Expected::range(Quantity::Celsius, -273, 1000))?;
                self.temperature = (celsius * 10.0).round() as i32;
            }
            "temperature-bits" => {
                self.narrow_temperature = setting.one_of(&[("25", false), ("16", true)])?;
            }
            "complement" => {
                self.complement_bit = setting.one_of(&[("code", false), ("bit", true)])?;
            }
            "program" => {
                let refused = || setting.refused(Expected::Program);
                self.mode = match setting.number::<u8>(Expected::Program)? {
                    0 => StartupMode::K3,
                    number => StartupMode::Cams(ProgramNumber::new(number).ok_or_else(refused)?),
                };
            }
            "stores" => self.stores = setting.number(Expected::Stores)?,
            "steps-minus-one" => self.steps_minus_one = setting.switch()?,
            "busy" => {
                let allowed = Expected::range(Quantity::Milliseconds, 0, Self::MAX_BUSY_MS);
                self.busy = Duration::from_millis(setting.within(..=Self::MAX_BUSY_MS, allowed)?.into());
            }
            "stale" => {
                self.stale =
                    setting.within(..=Self::MAX_STALE, Expected::range(Quantity::Cycles, 0, Self::MAX_STALE))?
            }
            "selection" => {
                self.acknowledges_selection = setting.one_of(&[("echo", true), ("output", false)])?;
            }
            "class" => {
                let classes = [("K1", Class::K1), ("K2", Class::K2), ("K3", Class::K3)];
                self.class = setting.one_of(&classes)?;
            }
            _ => return Ok(false),
        }
        Ok(true)
    }

    fn set_gateway(&mut self, setting: Setting<'_>) -> Result<bool, ConfigError> {
        match setting.key {
            "encoders" => {
                self.encoders = setting
                    .within(1..=Self::MAX_ENCODERS, Expected::range(Quantity::Encoders, 1, Self::MAX_ENCODERS))?;
            }
            "unit" => self.unit = setting.number(Expected::range(Quantity::Unit, 0, u8::MAX))?,
            "input" => self.input = setting.number(Expected::range(Quantity::Register, 0, u16::MAX))?,
            "output" => self.output = setting.number(Expected::range(Quantity::Register, 0, u16::MAX))?,
            "order" => {
                let order = WordOrder::read(setting.value);
                self.order = order.ok_or_else(|| setting.refused(Expected::words(&WordOrder::WORDS)))?;
            }
            "exception" => {
                self.exceptions = setting.decimal(0.0..=1.0, Expected::range(Quantity::RefusedRequests, 0, 1))?
            }
            "seed" => self.seed = setting.number(Expected::Whole)?,
            "fault" => self.faults = setting.value.parse()?,
            _ => return Ok(false),
        }
        Ok(true)
    }
}

/// What depends on each other and is checked when all is known.
#[derive(Default)]
struct Geared<'a> {
    steps: Option<Setting<'a>>,
    revolutions: Option<Setting<'a>>,
    preset: Option<Setting<'a>>,
    zero_shift: Option<Setting<'a>>,
    demonstration: bool,
}

impl<'a> Geared<'a> {
    fn take(&mut self, setting: Setting<'a>) -> Result<bool, ConfigError> {
        match setting.key {
            "steps" => self.steps = Some(setting),
            "revolutions" => self.revolutions = Some(setting),
            "preset" => self.preset = Some(setting),
            "zero-shift" => self.zero_shift = Some(setting),
            "cams" => self.demonstration = setting.one_of(&[("demo", true), ("none", false)])?,
            _ => return Ok(false),
        }
        Ok(true)
    }

    /// Where only one half of the gear is given, the other is as much as fits.
    fn put_into(self, memory: &mut Memory) -> Result<(), ConfigError> {
        let Geared { steps, revolutions, preset, zero_shift, demonstration } = self;
        if let Some(setting) = revolutions {
            let allowed = || Expected::range(Quantity::Turns, 1, 4096);
            let turns = setting.number(allowed())?;
            let steps = memory.gear.steps().min(STEPS_PER_TURN.saturating_mul(turns));
            memory.gear = Gear::new(steps, turns).map_err(|_| setting.refused(allowed()))?;
        }
        if let Some(setting) = steps {
            let range = Parameter::Steps.range(memory.gear);
            let allowed = || Expected::StepsOfTurns { low: *range.start(), high: *range.end() };
            let gear = Gear::new(setting.number(allowed())?, memory.gear.turns());
            memory.gear = gear.map_err(|_| setting.refused(allowed()))?;
        }
        let steps = memory.gear.steps();
        let allowed = Expected::range(Quantity::Steps, 0, steps - 1);
        memory.preset = preset.map_or(Ok(0), |setting| setting.within(..steps, allowed.clone()))?;
        memory.zero_shift = zero_shift.map_or(Ok(0), value)?;
        if demonstration {
            *memory = memory.clone().with_demonstration();
        }
        Ok(())
    }
}

/// A number that a word has room for.
fn value(setting: Setting<'_>) -> Result<u32, ConfigError> {
    setting.within(..=Value::MAX.get(), Expected::number(0, Value::MAX.get()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::devices::interbus::sim::Gateway;
    use crate::sim::setting::pairs;
    use proptest::prelude::*;

    fn read(query: &str) -> Result<Config, ConfigError> {
        Config::from_pairs(&pairs(query))
    }

    #[test]
    fn every_key_is_read() {
        let query = "preset=99&zero-shift=500&steps=100&revolutions=2&direction=ccw&rpm=-5&position=0x10&serial=7&\
                     operating-time=8&temperature=-1.25&temperature-bits=16&complement=bit&program=8&cams=none&stores=449&\
                     steps-minus-one=on&busy=20&stale=3&selection=output&class=K2&encoders=2&unit=17&input=100&output=0x200&\
                     order=low-first&exception=0.5&seed=9&fault=drop:0.25";
        assert_eq!(query.split('&').count(), Config::KEYS.len());
        let memory = Memory {
            gear: Gear::new(100, 2).unwrap(),
            counterclockwise: true,
            preset: 99,
            zero_shift: 500,
            ..Memory::delivered()
        };
        let expected = Config {
            seed: 9,
            faults: "drop:0.25".parse().unwrap(),
            exceptions: 0.5,
            unit: 17,
            input: 100,
            output: 0x200,
            order: WordOrder::LowFirst,
            encoders: 2,
            class: Class::K2,
            serial_number: 7,
            rpm: -5.0,
            position: 16,
            memory,
            mode: StartupMode::Cams(ProgramNumber::new(8).unwrap()),
            stores: 449,
            temperature: -13,
            narrow_temperature: true,
            operating_time: 8,
            steps_minus_one: true,
            complement_bit: true,
            busy: Duration::from_millis(20),
            stale: 3,
            acknowledges_selection: false,
        };
        assert_eq!(read(query), Ok(expected));
        assert_eq!(Config::from_pairs(&[]), Ok(Config::default()));
    }

    #[test]
    fn half_a_gear_takes_as_much_of_the_other_half_as_fits() {
        let gear = |query: &str| read(query).map(|config| (config.memory.gear.steps(), config.memory.gear.turns()));
        assert_eq!(gear("steps=360"), Ok((360, 4096)));
        assert_eq!(gear("revolutions=2"), Ok((16384, 2)));
    }

    #[test]
    fn what_is_wrong_is_told_in_a_sentence() {
        let keys = Config::KEYS.join(", ");
        let cases = [
            ("sed=1", format!("a virtual INTERBUS encoder has no setting `sed`; allowed are {keys}")),
            (
                "steps=8193&revolutions=1",
                "`steps=8193` cannot be used: allowed is steps from 1 to 8192, which is what its turns have".to_owned(),
            ),
            ("preset=360&steps=360", "`preset=360` cannot be used: allowed is steps from 0 to 359".to_owned()),
            ("fault=drop:7", "fault `drop:7`: the probability must be a number from 0 to 1".to_owned()),
        ];
        for (query, sentence) in cases {
            assert_eq!(read(query).unwrap_err().to_string(), sentence, "{query}");
        }
        let wrong = "revolutions=0 revolutions=4097 steps=0 steps=33554432 direction=3 rpm=NaN position=33554432 serial=33554432 \
                     temperature=NaN program=9 program=-1 cams=all stores=-1 busy=60001 stale=-1 stale=1001 class=K4 encoders=0 encoders=9 \
                     unit=256 input=65536 order=big exception=2 zero-shift=33554432";
        for query in wrong.split_whitespace() {
            assert!(matches!(read(query), Err(ConfigError::Value { .. })), "{query}");
        }
    }

    proptest! {
        #[test]
        fn no_value_panics(key in 0..Config::KEYS.len(), value in ".*|[0-9]{1,9}|0x[0-9A-F]{1,7}") {
            let _ = Config::from_pairs(&[(Config::KEYS[key].to_owned(), value)]).map(|config| Gateway::new(&config));
        }
    }
}
