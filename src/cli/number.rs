//! Parsing and formatting of numbers for the command line.

use super::Failure;

/// Parses a decimal number, or a hexadecimal number with the prefix `0x`. Either may have a sign.
pub(crate) fn parse_number(text: &str) -> Option<i64> {
    let (sign, digits) = match text.strip_prefix('-') {
        Some(digits) => (-1, digits),
        None => (1, text),
    };
    let number = match digits.strip_prefix("0x").or_else(|| digits.strip_prefix("0X")) {
        Some(hex) if hex.starts_with(|c: char| c.is_ascii_hexdigit()) => i64::from_str_radix(hex, 16),
        None if digits.starts_with(|c: char| c.is_ascii_digit()) => digits.parse(),
        _ => return None,
    };
    number.ok().map(|number| sign * number)
}

/// Creates the error for a number outside its range.
pub(crate) fn out_of_range(what: impl std::fmt::Display, value: &str, low: i64, high: i64) -> Failure {
    Failure::Failed(vec![format!("{what}: {value} is not within {low} to {high} ({low:#X} to {high:#X}).")])
}
