//! Detects the format of a table from its first lines: delimiter, decimal separator, first row of numbers, names, units
//! and columns. The columns are named as in SICK 8010701.

use super::CaptureError;
use super::encoding::decode_head;
use super::header::{Columns, TimeUnit, VoltUnit, column_unit, is_unit};
use super::import::{CellNumber, is_missing_value, parse_number, to_integer};

pub const HEAD_BYTES: usize = 64 << 10;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Delimiter {
    Comma,
    Semicolon,
    Tab,
}

/// Properties of a table that are known in advance. A property that is `None` is detected.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TableHints {
    pub delimiter: Option<Delimiter>,
    /// Whether numbers use a decimal comma.
    pub decimal_comma: Option<bool>,
    pub columns: Option<Columns>,
    pub time_unit: Option<TimeUnit>,
    /// Volts per unit of the sine and cosine columns, which overrides the header's unit. Must be finite and not zero.
    pub volts_per_unit: Option<f64>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Layout {
    pub delimiter: Delimiter,
    pub decimal_comma: bool,
    /// Line number of the first row of numbers in the file, counted from 1.
    pub first_row: u64,
    /// Column names, empty without a header.
    pub names: Vec<String>,
    pub columns: Columns,
    pub time_unit: TimeUnit,
    /// Volts per unit of the sine and cosine columns.
    pub volts_per_unit: f64,
    /// Sample clock from the header, present if the time column counts samples.
    pub clock: Option<SampleClock>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampleClock {
    /// Time of sample 0 in seconds.
    pub start_s: f64,
    /// Sampling interval in seconds.
    pub increment_s: f64,
}

impl Delimiter {
    /// All delimiters, least ambiguous first. The comma is last, because it may also be a decimal separator.
    pub const ALL: [Delimiter; 3] = [Delimiter::Semicolon, Delimiter::Tab, Delimiter::Comma];

    pub const fn byte(self) -> u8 {
        match self {
            Delimiter::Comma => b',',
            Delimiter::Semicolon => b';',
            Delimiter::Tab => b'\t',
        }
    }
}

/// A line that precedes the data.
struct HeaderLine {
    row: u64,
    fields: Vec<Vec<u8>>,
}

impl Layout {
    /// Detects the layout from the first [`HEAD_BYTES`] bytes of a table, or from all bytes of a shorter table.
    ///
    /// # Errors
    /// Returns a [`CaptureError`] if the bytes contain no table with sine and cosine.
    pub fn detect(head: &[u8], hints: &TableHints) -> Result<Self, CaptureError> {
        let decoded = decode_head(head);
        let text = complete_lines(&decoded, head.len());
        if text.iter().all(u8::is_ascii_whitespace) {
            return Err(CaptureError::Empty);
        }
        let delimiter = hints.delimiter.or_else(|| delimiter(text)).ok_or(match has_numbers(text) {
            true => CaptureError::OneColumn,
            false => CaptureError::NoNumbers,
        })?;
        let lines = split_lines(text, delimiter);
        let decimal_comma = hints.decimal_comma.unwrap_or_else(|| decimal_comma(&lines));
        let usual = most_common_width(&lines, decimal_comma);
        let first = lines.iter().position(|line| is_data(line, usual, decimal_comma)).ok_or(CaptureError::NoNumbers)?;
        let (before, data) = lines.split_at(first);
        let width = data.first().map_or(0, |line| count_filled_fields(&line.fields));
        // Rows without a value may lie between the names and the first complete row.
        let gaps = before.iter().rev().take_while(|line| is_gap(line, width, decimal_comma)).count();
        let (before, rows) = lines.split_at(first - gaps);
        let first_row = rows.first().map_or(1, |line| line.row);
        let clock = sample_clock(before, decimal_comma)?;
        let header = header(before, width);
        let names = header.first().cloned().unwrap_or_default();
        let named =
            Columns::find_by_name(&names).map(|columns| drop_unsuitable_columns(columns, data.first(), decimal_comma));
        let named = named.map(|columns| if clock.is_some() { columns.with_sample_counter() } else { columns });
        let columns = match (hints.columns, named) {
            (Some(columns), _) | (None, Some(columns)) => columns,
            (None, None) if width >= 3 => Columns::TIME_SINE_COSINE,
            (None, None) if width == 1 => return Err(CaptureError::OneColumn),
            (None, None) => return Err(CaptureError::TooFewColumns { columns: width }),
        };
        let unit = |column: usize| {
            let of_line = |line: &Vec<String>| line.get(column.checked_sub(1)?).map(|name| name.to_lowercase());
            header.iter().filter_map(of_line).find_map(|name| column_unit(&name).map(str::to_owned))
        };
        let time_unit = columns.time.and_then(unit).and_then(|unit| TimeUnit::parse(&unit));
        let volt_unit = unit(columns.sine).and_then(|unit| VoltUnit::parse(&unit)).unwrap_or_default();
        Ok(Layout {
            delimiter,
            decimal_comma,
            first_row,
            names,
            columns,
            time_unit: hints.time_unit.or(time_unit).unwrap_or_default(),
            volts_per_unit: hints.volts_per_unit.unwrap_or(volt_unit.factor()),
            // A given unit for the time column excludes sample numbers.
            clock: clock.filter(|_| columns.time.is_some() && hints.time_unit.is_none()),
        })
    }
}

/// Drops the reference angle column if its first value is not a number, and the absolute position column if its first
/// value is not a whole number.
fn drop_unsuitable_columns(columns: Columns, first: Option<&HeaderLine>, decimal_comma: bool) -> Columns {
    let read = |column: usize| {
        let field = first.and_then(|line| line.fields.get(column.checked_sub(1)?));
        field.map_or(CellNumber::Text, |field| parse_number(field, decimal_comma))
    };
    let angle = columns.reference_angle.filter(|column| matches!(read(*column), CellNumber::Finite(_)));
    let absolute = columns
        .absolute
        .filter(|column| matches!(read(*column), CellNumber::Finite(value) if to_integer(value).is_some()));
    Columns { reference_angle: angle, absolute, ..columns }
}

/// Returns the first bytes of the table without a truncated last line. `read` is the number of bytes read.
fn complete_lines(head: &[u8], read: usize) -> &[u8] {
    match head.iter().rposition(|byte| *byte == b'\n') {
        Some(end) if read + 3 >= HEAD_BYTES => head.get(..=end).unwrap_or(head),
        _ => head,
    }
}

/// Parses the header columns `Start` and `Increment` and the line below them, as written by Rigol oscilloscopes. If
/// both are present, the first column of the table counts samples.
fn sample_clock(before: &[HeaderLine], decimal_comma: bool) -> Result<Option<SampleClock>, CaptureError> {
    let at = |line: &HeaderLine, name: &[u8]| line.fields.iter().position(|field| field.eq_ignore_ascii_case(name));
    let places = |line: &HeaderLine| at(line, b"start").zip(at(line, b"increment"));
    let named = before.iter().enumerate().find_map(|(row, line)| Some((row, places(line)?)));
    let Some((row, (start, increment))) = named else { return Ok(None) };
    let below = before.get(row + 1);
    let value = |column: usize| match parse_number(below?.fields.get(column)?, decimal_comma) {
        CellNumber::Finite(value) => Some(value),
        CellNumber::NotFinite | CellNumber::Text => None,
    };
    match (value(start), value(increment)) {
        (Some(start_s), Some(increment_s)) if increment_s > 0.0 => Ok(Some(SampleClock { start_s, increment_s })),
        _ => Err(CaptureError::NoSampleClock { row: below.map_or(0, |line| line.row) }),
    }
}

fn delimiter(text: &[u8]) -> Option<Delimiter> {
    let lines = || text.split(|byte| *byte == b'\n').filter(|line| !line.trim_ascii().is_empty());
    let count = lines().count();
    let having = |delimiter: Delimiter| lines().filter(|line| line.contains(&delimiter.byte())).count();
    Delimiter::ALL.into_iter().find(|delimiter| 2 * having(*delimiter) > count)
}

fn has_numbers(text: &[u8]) -> bool {
    text.split(|byte| *byte == b'\n').any(|line| !matches!(parse_number(line.trim_ascii(), true), CellNumber::Text))
}

fn split_lines(text: &[u8], delimiter: Delimiter) -> Vec<HeaderLine> {
    let lines = text.split(|byte| *byte == b'\n').enumerate();
    lines
        .filter(|(_, line)| !line.trim_ascii().is_empty())
        .map(|(at, line)| HeaderLine { row: at as u64 + 1, fields: fields(line, delimiter) })
        .collect()
}

/// Splits a line into fields. A quoted field may contain the delimiter.
fn fields(line: &[u8], delimiter: Delimiter) -> Vec<Vec<u8>> {
    let mut fields = vec![Vec::new()];
    let mut quoted = false;
    for byte in line {
        match byte {
            b'"' => quoted = !quoted,
            byte if *byte == delimiter.byte() && !quoted => fields.push(Vec::new()),
            byte => {
                if let Some(field) = fields.last_mut() {
                    field.push(*byte);
                }
            }
        }
    }
    fields.iter().map(|field| field.trim_ascii().to_vec()).collect()
}

/// Returns whether at least one number has a decimal comma and none has a decimal point.
fn decimal_comma(lines: &[HeaderLine]) -> bool {
    let numeric = |field: &&Vec<u8>| matches!(parse_number(field, true), CellNumber::Finite(_));
    let has = |byte: u8| lines.iter().flat_map(|line| &line.fields).filter(numeric).any(|field| field.contains(&byte));
    has(b',') && !has(b'.')
}

/// Returns whether a line is a data row. In a data row all fields are numbers, or at least half of them if the row has
/// the usual width. A malformed number in the first row is thus reported as an error instead of being mistaken for a
/// header.
fn is_data(line: &HeaderLine, usual: usize, decimal_comma: bool) -> bool {
    let (numbers, width) = (count_numbers(line, decimal_comma), count_filled_fields(&line.fields));
    (numbers == width && width > 1) || (numbers > 0 && 2 * numbers >= width && width == usual)
}

/// Returns whether a row has at least one number, and all its other fields are empty or mark a missing value.
fn is_gap(line: &HeaderLine, width: usize, decimal_comma: bool) -> bool {
    let is_text = |field: &Vec<u8>| matches!(parse_number(field, decimal_comma), CellNumber::Text);
    line.fields.len() >= width
        && line.fields.iter().any(|field| !is_text(field))
        && line.fields.iter().all(|field| !is_text(field) || is_missing_value(field))
}

fn count_numbers(line: &HeaderLine, decimal_comma: bool) -> usize {
    line.fields.iter().filter(|field| !matches!(parse_number(field, decimal_comma), CellNumber::Text)).count()
}

/// Returns the most frequent width of the rows in which at least half the fields are numbers, or the larger width in a
/// tie.
fn most_common_width(lines: &[HeaderLine], decimal_comma: bool) -> usize {
    let mut counts = std::collections::BTreeMap::<usize, usize>::new();
    for line in lines.iter().filter(|line| 2 * count_numbers(line, decimal_comma) >= count_filled_fields(&line.fields))
    {
        *counts.entry(count_filled_fields(&line.fields)).or_default() += 1;
    }
    counts.into_iter().max_by_key(|(width, count)| (*count, *width)).map_or(0, |(width, _)| width)
}

/// Returns the number of fields up to the last non-empty one. Some programs end each line with a delimiter.
fn count_filled_fields(fields: &[Vec<u8>]) -> usize {
    fields.iter().rposition(|field| !field.is_empty()).map_or(0, |at| at + 1)
}

/// Returns the column names and, if present, the units. The header consists of the last lines before the data that have
/// as many columns as the data.
fn header(before: &[HeaderLine], width: usize) -> Vec<Vec<String>> {
    let wide = |line: &&HeaderLine| {
        count_filled_fields(&line.fields) >= width.min(2) && count_filled_fields(&line.fields) + 1 >= width
    };
    let name = |field: &Vec<u8>| String::from_utf8_lossy(&normalise_header_field(field)).into_owned();
    let mut found: Vec<Vec<String>> =
        before.iter().rev().take_while(wide).take(2).map(|line| line.fields.iter().map(name).collect()).collect();
    // If the header has two lines, the second contains the units. Otherwise, the first line is not part of the header.
    // A field in the second line that is not a unit may be a count ("Sequence") or a number from the header.
    let is_named = |line: &Vec<String>| Columns::find_by_name(line).is_some();
    let units = |line: &Vec<String>| {
        !is_named(line) && line.iter().any(|name| name.starts_with(['(', '[']) || is_unit(&name.to_lowercase()))
    };
    if found.len() == 2 && !found.first().is_some_and(units) {
        found.truncate(1);
    }
    found.reverse();
    if let [names, units] = found.as_mut_slice() {
        // Put a unit that stands alone in brackets, like a unit after a name.
        for unit in units.iter_mut().filter(|unit| is_unit(&unit.to_lowercase())) {
            *unit = format!("({unit})");
        }
        names.truncate(width.max(names.len()));
    }
    found
}

/// Normalises a header field. A lone B5h becomes a UTF-8 µ, and a leading # or % is removed, because it marks a
/// comment.
fn normalise_header_field(field: &[u8]) -> Vec<u8> {
    let field = field.strip_prefix(b"#").or_else(|| field.strip_prefix(b"%")).unwrap_or(field).trim_ascii();
    if std::str::from_utf8(field).is_ok() {
        return field.to_vec();
    }
    field.iter().flat_map(|byte| if *byte == 0xB5 { vec![0xC2, 0xB5] } else { vec![*byte] }).collect()
}

#[cfg(test)]
#[path = "tests.rs"]
mod tests;
