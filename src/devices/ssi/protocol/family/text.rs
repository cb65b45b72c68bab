//! One-word notation of a family with its settings, such as `ahm36,code=gray,st=12`.

use std::fmt;
use std::str::FromStr;

use super::{Alignment, ErrorPlace, Settings};
use crate::devices::ssi::protocol::code::Code;
use crate::devices::ssi::protocol::descriptor::{BitMeaning, GrayCoverage};
use crate::devices::ssi::protocol::range::Direction;
use crate::devices::ssi::protocol::spec::{Setting, SpecError};
use crate::expected::AllowedValues;

const NAMES: &[&str] = &[
    "code",
    "over",
    "mt",
    "st",
    "steps",
    "turns",
    "revolutions",
    "clocks",
    "align",
    "shift",
    "err",
    "step",
    "direction",
    "preset",
];

impl Settings {
    /// Splits a specification such as `ahm36,code=gray,st=12` into the family key and its settings.
    ///
    /// # Errors
    /// Returns a [`SpecError`] with the valid values if the specification is invalid.
    pub fn parse(text: &str) -> Result<(String, Self), SpecError> {
        let mut words = text.split(',').map(str::trim);
        let key = words.next().unwrap_or_default().to_ascii_lowercase();
        let mut settings = Settings::default();
        for setting in Setting::parse_all(words, NAMES)? {
            settings.apply_setting(setting)?;
        }
        Ok((key, settings))
    }

    /// Returns the family key and all settings that are not `None` as one word, such as `ahm36,code=gray,st=12`.
    pub fn emit(&self, key: &str) -> String {
        fn to_keyword<T: ToString>(value: Option<T>) -> Option<String> {
            value.map(|value| value.to_string())
        }
        let values = [
            to_keyword(self.code),
            to_keyword(self.coded),
            to_keyword(self.multiturn),
            to_keyword(self.singleturn),
            to_keyword(self.steps),
            to_keyword(self.turns),
            to_keyword(self.revolutions),
            to_keyword(self.clocks),
            to_keyword(self.align),
            to_keyword(self.shift.then_some(1)),
            to_keyword(self.errors),
            to_keyword(self.step_nanometres),
            to_keyword(self.direction),
            to_keyword(self.preset),
        ];
        let named = NAMES.iter().zip(values).filter_map(|(name, value)| Some(format!(",{name}={}", value?)));
        key.to_owned() + &named.collect::<String>()
    }

    fn apply_setting(&mut self, setting: Setting<'_>) -> Result<(), SpecError> {
        let value = setting.value;
        let wrong = |expected| setting.wrong_value(expected);
        match setting.name {
            "code" => self.code = Some(value.parse().map_err(wrong)?),
            "over" => self.coded = Some(value.parse().map_err(wrong)?),
            "mt" => self.multiturn = Some(setting.parse_u8()?),
            "st" => self.singleturn = Some(setting.parse_u8()?),
            "steps" => self.steps = Some(setting.parse_u32()?),
            "turns" => self.turns = Some(setting.parse_u32()?),
            "revolutions" => self.revolutions = Some(value.parse().map_err(wrong)?),
            "clocks" => self.clocks = Some(setting.parse_u8()?),
            "align" => self.align = Some(value.parse().map_err(wrong)?),
            "shift" => self.shift = setting.parse_switch()?,
            "err" => self.errors = Some(value.parse().map_err(wrong)?),
            "step" => self.step_nanometres = Some(setting.parse_u32()?),
            "direction" => self.direction = Some(value.parse().map_err(wrong)?),
            "preset" => self.preset = Some(value.parse().map_err(|_| wrong(AllowedValues::Whole))?),
            _ => return Err(setting.unknown_name()),
        }
        Ok(())
    }
}

/// A type whose values are written as keywords. Each value has a preferred keyword and can have alternatives.
trait Keyword: Copy + PartialEq + 'static {
    const ALL: &'static [(&'static str, Self)];

    fn keyword(self) -> &'static str {
        Self::ALL.iter().find(|(_, value)| *value == self).map_or("", |(word, _)| word)
    }

    fn from_keyword(word: &str) -> Option<Self> {
        Self::ALL.iter().find(|(known, _)| *known == word).map(|(_, value)| *value)
    }
}

impl Keyword for Code {
    const ALL: &'static [(&'static str, Self)] = &[
        ("binary", Code::Binary),
        ("bin", Code::Binary),
        ("gray", Code::Gray),
        ("gray-excess", Code::GrayExcess),
        ("bcd", Code::Bcd),
    ];
}

impl Keyword for GrayCoverage {
    const ALL: &'static [(&'static str, Self)] = &[
        ("position", GrayCoverage::Position),
        ("padded", GrayCoverage::Area),
        ("errors", GrayCoverage::AreaAndErrors),
    ];
}

impl Keyword for Direction {
    const ALL: &'static [(&'static str, Self)] = &[("cw", Direction::Clockwise), ("ccw", Direction::CounterClockwise)];
}

impl Keyword for BitMeaning {
    const ALL: &'static [(&'static str, Self)] = &[("invalid", BitMeaning::Invalid), ("warning", BitMeaning::Warning)];
}

impl Keyword for Alignment {
    const ALL: &'static [(&'static str, Self)] = &[
        ("left", Alignment::Left),
        ("right24", Alignment::Right24),
        ("right25", Alignment::Right25),
        ("tree12_13", Alignment::Tree12),
        ("tree13_12", Alignment::Tree13),
    ];
}

impl Keyword for ErrorPlace {
    const ALL: &'static [(&'static str, Self)] =
        &[("none", ErrorPlace::None), ("fix", ErrorPlace::Fix), ("following", ErrorPlace::Following)];
}

/// Implements the conversion between values and their keywords. A parse error lists the valid keywords.
macro_rules! in_words {
    ($($type:ty: $expected:expr,)*) => {$(
        impl fmt::Display for $type {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(self.keyword())
            }
        }

        impl FromStr for $type {
            type Err = AllowedValues;

            fn from_str(word: &str) -> Result<Self, AllowedValues> {
                Self::from_keyword(word).ok_or(AllowedValues::words(&$expected))
            }
        }
    )*};
}

in_words! {
    Code: ["binary", "gray", "gray-excess", "bcd"],
    GrayCoverage: ["position", "padded", "errors"],
    Direction: ["cw", "ccw"],
    BitMeaning: ["invalid", "warning"],
    Alignment: ["left", "right24", "right25", "tree12_13", "tree13_12"],
    ErrorPlace: ["none", "fix", "following"],
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::devices::ssi::protocol::range::Fraction;
    use proptest::option::of;
    use proptest::prelude::*;
    use proptest::sample::select;

    fn one_of<T: Keyword + fmt::Debug>() -> impl Strategy<Value = Option<T>> {
        of(select(T::ALL).prop_map(|(_, value)| value))
    }

    fn settings() -> impl Strategy<Value = Settings> {
        let numbers = (of(any::<u8>()), of(any::<u8>()), of(any::<u32>()), of(any::<u32>()), of(any::<u8>()));
        let fraction = of((any::<u32>(), any::<u32>()));
        let words = (one_of(), one_of(), one_of(), one_of(), one_of());
        let more = (any::<bool>(), of(any::<u32>()), of(any::<u64>()));
        (numbers, fraction, words, more).prop_map(|(numbers, revolutions, words, more)| {
            let (multiturn, singleturn, steps, turns, clocks) = numbers;
            let (code, coded, align, errors, direction) = words;
            let (shift, step_nanometres, preset) = more;
            let revolutions = revolutions.map(|(numerator, denominator)| Fraction { numerator, denominator });
            Settings {
                multiturn,
                singleturn,
                steps,
                turns,
                revolutions,
                code,
                coded,
                clocks,
                align,
                shift,
                errors,
                step_nanometres,
                direction,
                preset,
            }
        })
    }

    proptest! {
        #[test]
        fn emitted_settings_round_trip(settings in settings()) {
            let text = settings.emit("ahm36");
            prop_assert_eq!(Settings::parse(&text), Ok(("ahm36".to_owned(), settings)), "{}", text);
        }
    }

    #[test]
    fn emits_only_changed_settings() {
        let set = Settings { code: Some(Code::Gray), singleturn: Some(12), ..Settings::default() };
        assert_eq!(set.emit("ahm36"), "ahm36,code=gray,st=12");
        assert_eq!(Settings::default().emit("kh53"), "kh53");
        for text in [
            "ahm36,steps=100,revolutions=25/2,direction=ccw,preset=99",
            "atm60,over=padded,mt=8,st=8,clocks=26,align=tree12_13,shift=1,err=fix",
            "ahm36,steps=100,revolutions=3",
            "ttk70,step=500",
        ] {
            let (key, settings) = Settings::parse(text).unwrap();
            assert_eq!(settings.emit(&key), text);
        }
    }
}
