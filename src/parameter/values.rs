//! Parameter values: how they are parsed, printed and described.

use std::ops::RangeInclusive;
use std::time::Duration;

use super::RejectedParameter;
use crate::expected::{AllowedValues, Limit, Quantity};

pub trait ParameterValues {
    type Value;

    fn read(&self, text: &str) -> Option<Self::Value>;

    fn allowed_values(&self) -> AllowedValues;

    /// Formats a value if it is short enough to serve as an example.
    fn format_example(&self, _value: &Self::Value) -> String {
        String::new()
    }

    /// Returns the unit symbol, or an empty string if the values have no unit.
    fn unit(&self) -> &'static str {
        ""
    }

    /// Returns whether values may have a decimal point.
    fn is_decimal(&self) -> bool {
        false
    }

    /// Parses the value of a key.
    ///
    /// # Errors
    /// Returns the allowed values if the key does not accept the value.
    fn parse_value(&self, key: &str, value: &str) -> Result<Self::Value, RejectedParameter> {
        self.read(value).ok_or_else(|| RejectedParameter::new(key, value, self.allowed_values()))
    }
}

/// Whole numbers, with their quantity and range.
#[derive(Clone, Debug)]
pub struct WholeNumbers<T>(pub Quantity, pub RangeInclusive<T>);

/// Numbers with an optional decimal point, with their quantity and range, exact to a thousandth.
#[derive(Clone, Debug)]
pub struct DecimalNumbers(pub Quantity, pub RangeInclusive<f64>);

#[derive(Clone, Debug)]
pub struct Milliseconds(pub RangeInclusive<u64>);

/// Voltages entered in volts and stored in millivolts. The allowed range is in millivolts.
#[derive(Clone, Debug)]
pub struct Millivolts(pub RangeInclusive<u16>);

#[derive(Clone, Copy, Debug)]
pub struct Keywords<T: 'static>(pub &'static [(&'static str, T)]);

/// Values in a custom notation, parsed by the given function.
#[derive(Clone, Debug)]
pub struct CustomNotation<T>(pub AllowedValues, pub fn(&str) -> Option<T>);

#[derive(Clone, Debug)]
pub struct OptionalValue<V>(pub V);

pub const SWITCH: Keywords<bool> = Keywords(&[("on", true), ("off", false)]);

/// Any string, accepted without a check, because its meaning depends on other parameters.
pub const ANY: CustomNotation<String> = CustomNotation(AllowedValues::words(&[]), |text| Some(text.to_owned()));

/// Parses a whole number that fits into `T`. It is decimal, or hexadecimal after `0x`.
pub fn parse_whole<T: TryFrom<i128>>(text: &str) -> Option<T> {
    let number = match text.strip_prefix("0x").or_else(|| text.strip_prefix("0X")) {
        Some(digits) => u64::from_str_radix(digits, 16).ok()?.into(),
        None => text.parse().ok()?,
    };
    T::try_from(number).ok()
}

/// Returns the unit symbol shown next to a value in a form.
const fn unit_symbol(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Milliseconds => "ms",
        Quantity::Microseconds => "µs",
        Quantity::Hertz => "Hz",
        Quantity::Volts => "V",
        _ => "",
    }
}

impl<T: TryFrom<i128> + Into<i128> + Copy + PartialOrd> ParameterValues for WholeNumbers<T> {
    type Value = T;

    fn read(&self, text: &str) -> Option<T> {
        parse_whole(text).filter(|number| self.1.contains(number))
    }

    fn allowed_values(&self) -> AllowedValues {
        AllowedValues::range(self.0, *self.1.start(), *self.1.end())
    }

    fn format_example(&self, value: &T) -> String {
        (*value).into().to_string()
    }

    fn unit(&self) -> &'static str {
        unit_symbol(self.0)
    }
}

impl ParameterValues for DecimalNumbers {
    type Value = f64;

    fn read(&self, text: &str) -> Option<f64> {
        text.parse().ok().filter(|number| self.1.contains(number))
    }

    fn allowed_values(&self) -> AllowedValues {
        let limit = |number: &f64| Limit::from_thousandths((number * 1000.0).round() as i128);
        AllowedValues::range(self.0, limit(self.1.start()), limit(self.1.end()))
    }

    fn format_example(&self, value: &f64) -> String {
        value.to_string()
    }

    fn unit(&self) -> &'static str {
        unit_symbol(self.0)
    }

    fn is_decimal(&self) -> bool {
        true
    }
}

impl ParameterValues for Milliseconds {
    type Value = Duration;

    fn read(&self, text: &str) -> Option<Duration> {
        parse_whole(text).filter(|ms| self.0.contains(ms)).map(Duration::from_millis)
    }

    fn allowed_values(&self) -> AllowedValues {
        AllowedValues::range(Quantity::Milliseconds, *self.0.start(), *self.0.end())
    }

    fn format_example(&self, value: &Duration) -> String {
        value.as_millis().to_string()
    }

    fn unit(&self) -> &'static str {
        unit_symbol(Quantity::Milliseconds)
    }
}

impl ParameterValues for Millivolts {
    type Value = u16;

    fn read(&self, text: &str) -> Option<u16> {
        let millivolts = (text.parse::<f64>().ok()? * 1000.0).round();
        // Within the range of its type, `as` is exact.
        let fits = (0.0..=f64::from(u16::MAX)).contains(&millivolts);
        fits.then_some(millivolts as u16).filter(|own| self.0.contains(own))
    }

    fn allowed_values(&self) -> AllowedValues {
        let limit = |millivolts: u16| Limit::from_thousandths(millivolts.into());
        AllowedValues::range(Quantity::Volts, limit(*self.0.start()), limit(*self.0.end()))
    }

    fn format_example(&self, value: &u16) -> String {
        (f64::from(*value) / 1000.0).to_string()
    }

    fn unit(&self) -> &'static str {
        unit_symbol(Quantity::Volts)
    }

    fn is_decimal(&self) -> bool {
        true
    }
}

impl<T: Clone + PartialEq> ParameterValues for Keywords<T> {
    type Value = T;

    fn read(&self, text: &str) -> Option<T> {
        self.0.iter().find(|(word, _)| *word == text).map(|(_, meaning)| meaning.clone())
    }

    fn allowed_values(&self) -> AllowedValues {
        AllowedValues::Words(self.0.iter().map(|(word, _)| *word).collect())
    }

    fn format_example(&self, value: &T) -> String {
        self.0.iter().find(|(_, meaning)| meaning == value).map_or_else(String::new, |(word, _)| (*word).to_owned())
    }
}

impl<T> ParameterValues for CustomNotation<T> {
    type Value = T;

    fn read(&self, text: &str) -> Option<T> {
        (self.1)(text)
    }

    fn allowed_values(&self) -> AllowedValues {
        self.0.clone()
    }
}

impl<V: ParameterValues> ParameterValues for OptionalValue<V> {
    type Value = Option<V::Value>;

    fn read(&self, text: &str) -> Option<Self::Value> {
        self.0.read(text).map(Some)
    }

    fn allowed_values(&self) -> AllowedValues {
        self.0.allowed_values()
    }

    fn format_example(&self, value: &Self::Value) -> String {
        value.as_ref().map_or_else(String::new, |value| self.0.format_example(value))
    }

    fn unit(&self) -> &'static str {
        self.0.unit()
    }

    fn is_decimal(&self) -> bool {
        self.0.is_decimal()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parses_formats_and_rejects_values() {
        let told = |allowed: AllowedValues| allowed.to_string();
        let unit = WholeNumbers::<u8>(Quantity::Unit, 1..=247);
        assert_eq!(
            [unit.read("0x10"), unit.read("247"), unit.read("248"), unit.read("")],
            [Some(16), Some(247), None, None]
        );
        assert_eq!(
            (unit.format_example(&16), told(unit.allowed_values())),
            ("16".to_owned(), "a unit ID from 1 to 247".to_owned())
        );
        let time = Milliseconds(50..=8000);
        assert_eq!((time.read("50"), time.read("49")), (Some(Duration::from_millis(50)), None));
        assert_eq!((time.format_example(&Duration::from_secs(2)), time.unit()), ("2000".to_owned(), "ms"));
        let supply = Millivolts(4_750..=12_500);
        assert_eq!(
            [supply.read("4.75"), supply.read("12.501"), supply.read("NaN"), supply.read("-5")],
            [Some(4_750), None, None, None]
        );
        assert_eq!(told(supply.allowed_values()), "a voltage in volts from 4.75 to 12.5");
        let warm = DecimalNumbers(Quantity::Celsius, -12.5..=40.0);
        assert_eq!([warm.read("-12.5"), warm.read("-12.6"), warm.read("inf")], [Some(-12.5), None, None]);
        assert_eq!(told(warm.allowed_values()), "a temperature in °C from -12.5 to 40");
        assert_eq!((OptionalValue(SWITCH).read("on"), OptionalValue(SWITCH).read("yes")), (Some(Some(true)), None));
        let refused = SWITCH.parse_value("echo", "yes").unwrap_err();
        assert_eq!(
            (refused.key.as_str(), refused.value.as_str(), told(refused.allowed)),
            ("echo", "yes", "on or off".to_owned())
        );
    }
}
