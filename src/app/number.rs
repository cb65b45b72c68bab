//! Parsing of numbers typed by the user. Both decimal point and comma are accepted. Numbers are always finite, and
//! errors name the allowed range.

use super::Text;

/// Maximum number of signal periods per revolution that can be entered, more than any known encoder has.
pub(crate) const MAX_PERIODS: u32 = 65_536;

/// Parses a decimal number with an optional exponent. Returns `None` if the text is invalid.
pub fn parse_decimal(text: &str) -> Option<f64> {
    let text = text.trim().replace(',', ".").replace('−', "-");
    // The parser would accept words such as `inf`.
    let plain = text.bytes().all(|c| c.is_ascii_digit() || matches!(c, b'.' | b'-' | b'+' | b'e' | b'E'));
    text.parse().ok().filter(|value: &f64| plain && value.is_finite())
}

/// Parses a number from `least` to `most`. Errors refer to it as `what`.
///
/// # Errors
/// Returns the reason why the entry is invalid.
pub(crate) fn parse_in_range(what: impl Into<Text>, text: &str, least: f64, most: f64) -> Result<f64, Text> {
    let what = what.into();
    check_not_empty(&what, text)?;
    let refused = || {
        let refusal = Text::new("entry.number").with_text("what", what.clone()).with("entry", text.trim());
        refusal.with_number("least", least, decimal_places(least)).with_number("most", most, decimal_places(most))
    };
    parse_decimal(text).filter(|value| (least..=most).contains(value)).ok_or_else(refused)
}

/// Parses a whole number from `least` to `most`, in decimal or in hexadecimal with the prefix `0x`.
///
/// # Errors
/// Returns the reason why the entry is invalid.
pub(crate) fn parse_integer(what: impl Into<Text>, text: &str, least: u32, most: u32) -> Result<u32, Text> {
    let what = what.into();
    check_not_empty(&what, text)?;
    let digits = text.trim();
    let value = match digits.strip_prefix("0x") {
        Some(hex) if hex.bytes().all(|c| c.is_ascii_hexdigit()) => u32::from_str_radix(hex, 16).ok(),
        None if digits.bytes().all(|c| c.is_ascii_digit()) => digits.parse().ok(),
        _ => None,
    };
    let refused = || {
        let refusal = Text::new("entry.whole").with_text("what", what.clone()).with("entry", digits);
        refusal.with("least", least).with("most", most)
    };
    value.filter(|value| (least..=most).contains(value)).ok_or_else(refused)
}

/// Parses a number from 0 to `last`, in decimal, or in hexadecimal with the prefix `0x` or a final `h`.
///
/// # Errors
/// Returns the reason why the entry is invalid.
pub(crate) fn parse_number_or_hex(what: impl Into<Text>, text: &str, last: u64) -> Result<u64, Text> {
    let what = what.into();
    check_not_empty(&what, text)?;
    let digits = text.trim();
    let hex = digits.strip_prefix("0x").or_else(|| digits.strip_suffix(['h', 'H']));
    let value = match hex {
        Some(hex) if hex.bytes().all(|c| c.is_ascii_hexdigit()) => u64::from_str_radix(hex, 16).ok(),
        None if digits.bytes().all(|c| c.is_ascii_digit()) => digits.parse().ok(),
        _ => None,
    };
    let refused = || {
        let refusal = Text::new("entry.position_range").with_text("what", what.clone());
        refusal.with("entry", digits).with("last", last)
    };
    value.filter(|value| *value <= last).ok_or_else(refused)
}

/// Parses a quantity as printed on components, or returns `None` if the text is invalid.
///
/// An SI prefix from f to G may follow the number or replace its decimal point, and the unit may be omitted: `10k`, `10
/// kΩ`, `4k7`, `22p`, `22 pF`, `0,1µ`. An exponent is also accepted: `22e-12`.
fn parse_component_value(text: &str) -> Option<f64> {
    const UNITS: [&str; 6] = ["Ohm", "ohm", "Ω", "\u{2126}", "F", "R"];
    const PREFIXES: [(char, f64); 10] = [
        ('f', 1e-15),
        ('p', 1e-12),
        ('n', 1e-9),
        ('µ', 1e-6),
        ('μ', 1e-6),
        ('u', 1e-6),
        ('m', 1e-3),
        ('k', 1e3),
        ('M', 1e6),
        ('G', 1e9),
    ];
    let text = text.trim();
    let text = UNITS.iter().find_map(|unit| text.strip_suffix(unit)).unwrap_or(text).trim_end();
    let prefix = PREFIXES.iter().find_map(|(prefix, factor)| Some((text.split_once(*prefix)?, factor)));
    match prefix {
        Some(((before, ""), factor)) => parse_decimal(before).map(|value| value * factor),
        // In `4k7` the prefix replaces the decimal point, so there must not be another one.
        Some(((before, behind), factor)) => {
            let whole = |digits: &str| !digits.is_empty() && digits.bytes().all(|c| c.is_ascii_digit());
            let value = parse_decimal(&format!("{before}.{behind}")).filter(|_| whole(before) && whole(behind))?;
            Some(value * factor)
        }
        None => parse_decimal(text),
    }
}

/// Parses a quantity from `least` to `most`. Errors state the allowed range as `range`.
///
/// # Errors
/// Returns the reason why the entry is invalid.
pub(crate) fn parse_quantity(
    what: impl Into<Text>,
    text: &str,
    (least, most): (f64, f64),
    range: (&'static str, &'static str),
) -> Result<f64, Text> {
    let what = what.into();
    check_not_empty(&what, text)?;
    let refused = || {
        let refusal = Text::new("entry.quantity").with_text("what", what.clone()).with("entry", text.trim());
        refusal.with("least", range.0).with("most", range.1)
    };
    parse_component_value(text).filter(|value| (least..=most).contains(value)).ok_or_else(refused)
}

fn check_not_empty(what: &Text, text: &str) -> Result<(), Text> {
    if text.trim().is_empty() { Err(Text::new("entry.missing").with_text("what", what.clone())) } else { Ok(()) }
}

/// Returns the number of decimals needed to display a limit, at most three.
pub(crate) fn decimal_places(value: f64) -> usize {
    required_decimals(value, 3)
}

/// Returns the number of decimals needed to display a number with at most twelve significant digits.
pub fn significant_decimals(value: f64) -> usize {
    const DIGITS: i32 = 12;
    let before = if value == 0.0 { 1 } else { (value.abs().log10().floor() as i32).saturating_add(1) };
    let rounded = format!("{value:.*}", usize::try_from(DIGITS - before).unwrap_or(0));
    rounded.split_once('.').map_or(0, |(_, behind)| behind.trim_end_matches('0').len())
}

/// Returns the number of decimals needed to display a number, at most `most`.
pub(crate) fn required_decimals(value: f64, most: usize) -> usize {
    (0..most).find(|count| (value * 10_f64.powi(*count as i32)).fract() == 0.0).unwrap_or(most)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::Language;

    #[test]
    fn numbers_accept_point_or_comma() {
        for (text, value) in [
            ("1.5", 1.5),
            (" 1,5 ", 1.5),
            ("-0.25", -0.25),
            ("−2", -2.0),
            ("+7", 7.0),
            (".5", 0.5),
            ("3.", 3.0),
            ("1e3", 1000.0),
        ] {
            assert_eq!(parse_decimal(text), Some(value), "{text}");
        }
        let endless = "9".repeat(400);
        for text in [
            "", " ", "-", ".", "e3", "1e999", "NaN", "nan", "inf", "-inf", "--1", "+-1", "1.2.3", "1 2", "0x10", "½",
            &endless,
        ] {
            assert_eq!(parse_decimal(text), None, "{text}");
        }
    }

    #[test]
    fn parses_component_notation() {
        for (text, value) in [
            ("10k", 1e4),
            ("10 kΩ", 1e4),
            ("10 kOhm", 1e4),
            ("4k7", 4.7e3),
            ("4,7k", 4.7e3),
            ("10000", 1e4),
            ("330R", 330.0),
            ("1M", 1e6),
            ("22p", 22e-12),
            ("22 pF", 22e-12),
            ("22e-12", 22e-12),
            ("22E-12 F", 22e-12),
            ("0,1µ", 1e-7),
            ("0.1 uF", 1e-7),
            ("2n2", 2.2e-9),
            ("5m", 5e-3),
        ] {
            let read = parse_component_value(text).unwrap_or(f64::NAN);
            assert!((read - value).abs() <= value * 1e-12, "{text}: {read}");
        }
        let none = [
            "", "k", "kΩ", "k7", "4.7k5", "4k 7", "4k7k", "10kk", "10x", "NaN", "inf", "1e", "1e1.5", "1e999", "F",
            "1pn",
        ];
        for text in none {
            assert_eq!(parse_component_value(text), None, "{text}");
        }
    }

    #[test]
    fn rejection_names_entry_and_range() {
        let refusal = parse_in_range("connect.tcp_port", "91", 0.1, 90.0).unwrap_err();
        assert_eq!(refusal.to_string_in(Language::English), "TCP port: \"91\" is not a number from 0.1 to 90.");
        assert!(refusal.to_string_in(Language::German).ends_with("keine Zahl von 0,1 bis 90."));
        assert_eq!(parse_in_range("connect.tcp_port", "90", 0.1, 90.0), Ok(90.0));
        assert_eq!(parse_in_range("connect.tcp_port", "  ", 0.1, 90.0).unwrap_err().id(), "entry.missing");
        for text in ["-1", "1.5", "4294967296", "99999999999999999999999", "0x", "0xG", "+1", "0", "501"] {
            assert_eq!(parse_integer("connect.margin", text, 1, 500).unwrap_err().id(), "entry.whole", "{text}");
        }
        assert_eq!(parse_integer("connect.margin", "0x10", 1, 500), Ok(16));
    }
}
