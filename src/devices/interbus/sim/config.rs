//! Settings of a virtual encoder and its gateway, given in the query of a `sim:` link. An example is
//! `steps=360&revolutions=1&cams=demo&rpm=10`.

use std::time::Duration;

use super::memory::{DISC_POSITIONS, Memory};
use crate::devices::interbus::protocol::{
    Class, Gear, INPUT, OUTPUT, Parameter, ProgramNumber, STEPS_PER_TURN, StartupMode, TURNS, UNIT, Value, WordOrder,
};
use crate::expected::{AllowedValues, Quantity};
use crate::parameter::{
    ANY, CustomNotation, DecimalNumbers, Keywords, Milliseconds, OptionalValue, ParameterValues, RejectedParameter,
    SWITCH, WholeNumbers, parse_whole,
};
use crate::parameters;
use crate::sim::{ConfigError, FAULTS, RPM, SEED, SimulatedFaults, VirtualDevice, setting};

parameters! {
    /// Settings of a virtual gateway and its encoders. The default is one K3 encoder with factory settings, at
    /// standstill and without faults. By default, the gateway has unit 1, registers from 0 and the high word first.
    pub struct Config: ConfigError {
        // The gear and the values within its range are checked together and then stored in `memory`.
        steps: Option<String> = None, "steps" => OptionalValue(ANY);
        revolutions: Option<String> = None, "revolutions" => OptionalValue(ANY);
        pub(super) memory: Memory = Memory::factory_default();
        counterclockwise: bool = false, "direction" => Keywords(&[("cw", false), ("ccw", true)]);
        /// Preset in steps, which is programmed but not yet executed.
        preset: Option<String> = None, "preset" => OptionalValue(ANY);
        zero_shift: u32 = 0, "zero-shift" => VALUE;
        pub(super) rpm: f64 = 0.0, "rpm" => RPM, "connect.rpm";
        /// Initial shaft position in disc steps.
        pub(super) position: u32 = 0x12_3456, "position" => WholeNumbers(Quantity::PlaceOfDisc, 0..=DISC_POSITIONS - 1);
        pub(super) serial_number: u32 = 7_101_234, "serial" => VALUE;
        /// Operating time in units of ten minutes.
        pub(super) operating_time: u32 = 1000, "operating-time" => VALUE;
        pub(super) celsius: f64 = 25.3, "temperature" => DecimalNumbers(Quantity::Celsius, -273.0..=1000.0);
        /// Whether a negative temperature is sent with 16 bits instead of 25 (`U`: not documented). See reference 3.
        pub(super) narrow_temperature: bool = false, "temperature-bits" => Keywords(&[("25", false), ("16", true)]);
        /// Whether read-out 3 returns a flag of 0 or 1 instead of the parameter value (`U`: not documented).
        pub(super) complement_bit: bool = false, "complement" => Keywords(&[("code", false), ("bit", true)]);
        /// Selected cam program, or normal operation.
        pub(super) mode: StartupMode = StartupMode::K3, "program" => CustomNotation(AllowedValues::Program, mode);
        /// Whether the encoder starts with demonstration cam programs.
        demonstration: bool = false, "cams" => Keywords(&[("demo", true), ("none", false)]);
        pub(super) stores: u32 = 3, "stores" => CustomNotation(AllowedValues::Stores, parse_whole::<u32>);
        /// Whether the encoder reports its number of steps minus one, as older encoders do.
        pub(super) steps_minus_one: bool = false, "steps-minus-one" => SWITCH;
        pub(super) busy: Duration = Duration::from_millis(5), "busy" => Milliseconds(0..=60_000);
        /// Number of cycles for which the old IN word is still returned after a new OUT word.
        pub(super) stale: u32 = 1, "stale" => WholeNumbers(Quantity::Cycles, 0..=1000);
        /// Whether selecting a program is echoed before its outputs are sent (`U`: not documented).
        pub(super) acknowledges_selection: bool = true, "selection" => Keywords(&[("echo", true), ("output", false)]);
        pub(super) class: Class = Class::K3, "class" => Keywords(&[("K1", Class::K1), ("K2", Class::K2), ("K3", Class::K3)]);
        /// Number of encoders. Each has two registers, starting at `input` and `output`.
        pub(super) encoders: u8 = 1, "encoders" => WholeNumbers(Quantity::Encoders, 1..=8);
        pub(super) unit: u8 = 1, "unit" => UNIT;
        pub(super) input: u16 = 0, "input" => INPUT;
        pub(super) output: u16 = 0, "output" => OUTPUT;
        pub(super) order: WordOrder = WordOrder::HighFirst, "order" => WordOrder::KEYWORDS;
        /// Fraction of requests that the gateway rejects with exception 0Bh.
        pub(super) exceptions: f64 = 0.0, "exception" => DecimalNumbers(Quantity::RefusedRequests, 0.0..=1.0);
        pub(super) seed: u64 = 0, "seed" => SEED;
        /// Fractions of replies that are lost (`drop`), have one inverted bit (`flip`) or are replaced with random
        /// bytes (`garbage`).
        pub(super) faults: SimulatedFaults = SimulatedFaults::default(), "fault" => FAULTS, "connect.fault" like "drop:0.01";
    }
}

const VALUE: WholeNumbers<u32> = WholeNumbers(Quantity::Number, 0..=Value::MAX.get());

impl Config {
    /// Parses percent-decoded keys and values. The last value of a repeated key applies. Numbers are decimal, or
    /// hexadecimal with the prefix `0x`.
    ///
    /// # Errors
    /// Returns an error with the key and the allowed values if a setting is invalid.
    pub fn from_pairs(pairs: &[(String, String)]) -> Result<Self, ConfigError> {
        let mut config: Config = setting::read(VirtualDevice::EncoderOf("INTERBUS"), pairs)?;
        config.apply_memory_settings()?;
        Ok(config)
    }

    /// Returns the temperature in tenths of a degree Celsius.
    pub(super) fn temperature(&self) -> i32 {
        (self.celsius * 10.0).round() as i32
    }

    /// Stores the gear, the preset and the cams in the memory. If only the steps or the turns are given, the other
    /// number is as large as possible.
    fn apply_memory_settings(&mut self) -> Result<(), ConfigError> {
        let memory = &mut self.memory;
        if let Some(turns) = self.revolutions.take() {
            let range = WholeNumbers(Quantity::Turns, 1..=TURNS);
            let turns = range.parse_value("revolutions", &turns)?;
            let steps = memory.gear.total_steps().min(STEPS_PER_TURN.saturating_mul(turns));
            let gear = Gear::new(steps, turns);
            memory.gear = gear.map_err(|_| RejectedParameter::new("revolutions", turns, range.allowed_values()))?;
        }
        if let Some(steps) = self.steps.take() {
            let range = Parameter::Steps.valid_range(memory.gear);
            let allowed = AllowedValues::StepsOfTurns { low: *range.start(), high: *range.end() };
            let gear = parse_whole(&steps).and_then(|steps| Gear::new(steps, memory.gear.turns()).ok());
            memory.gear = gear.ok_or_else(|| RejectedParameter::new("steps", steps, allowed))?;
        }
        if let Some(preset) = self.preset.take() {
            memory.preset =
                WholeNumbers(Quantity::Steps, 0..=memory.gear.total_steps() - 1).parse_value("preset", &preset)?;
        }
        (memory.counterclockwise, memory.zero_shift) = (self.counterclockwise, self.zero_shift);
        if self.demonstration {
            *memory = memory.clone().with_demonstration_programs();
        }
        Ok(())
    }
}

fn mode(text: &str) -> Option<StartupMode> {
    match parse_whole(text)? {
        0 => Some(StartupMode::K3),
        program => ProgramNumber::new(program).map(StartupMode::Cams),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::devices::interbus::sim::Gateway;
    use crate::sim::setting::query_pairs;
    use proptest::prelude::*;

    fn read(query: &str) -> Result<Config, ConfigError> {
        Config::from_pairs(&query_pairs(query))
    }

    #[test]
    fn parses_every_key() {
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
            ..Memory::factory_default()
        };
        let expected = Config {
            counterclockwise: true,
            zero_shift: 500,
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
            celsius: -1.25,
            narrow_temperature: true,
            operating_time: 8,
            steps_minus_one: true,
            complement_bit: true,
            busy: Duration::from_millis(20),
            stale: 3,
            acknowledges_selection: false,
            ..Config::default()
        };
        assert_eq!(read(query), Ok(expected));
        assert_eq!(Config::from_pairs(&[]), Ok(Config::default()));
    }

    #[test]
    fn omitted_gear_part_defaults_to_maximum() {
        let gear =
            |query: &str| read(query).map(|config| (config.memory.gear.total_steps(), config.memory.gear.turns()));
        assert_eq!(gear("steps=360"), Ok((360, 4096)));
        assert_eq!(gear("revolutions=2"), Ok((16384, 2)));
    }

    #[test]
    fn reports_invalid_values() {
        let keys = Config::KEYS.join(", ");
        let cases = [
            ("sed=1", format!("a virtual INTERBUS encoder has no setting `sed`; valid settings are {keys}")),
            (
                "steps=8193&revolutions=1",
                "`steps=8193` is not valid (allowed: a number of steps from 1 to 8192, limited by the encoder's number \
                 of turns)"
                    .to_owned(),
            ),
            (
                "preset=360&steps=360",
                "`preset=360` is not valid (allowed: a position in steps from 0 to 359)".to_owned(),
            ),
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
        fn arbitrary_values_do_not_panic(key in 0..Config::KEYS.len(), value in ".*|[0-9]{1,9}|0x[0-9A-F]{1,7}") {
            let _ = Config::from_pairs(&[(Config::KEYS[key].to_owned(), value)]).map(|config| Gateway::new(&config));
        }
    }
}
