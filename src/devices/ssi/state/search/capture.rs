//! Import of logic analyser exports as levels of clock and data.
//!
//! Saleae Logic writes a header `Time [s],Channel 0,Channel 1` and a row for each change. sigrok (PulseView) begins
//! with lines that start with `;`, one of which states the sample rate. It then writes a row for each sample, with or
//! without a time.

use crate::app::Text;
use crate::devices::ssi::protocol::LineLevels;
use crate::devices::ssi::state::TEXTS;

/// Rows of a file with their line numbers, and the heading above them.
struct Table<'t> {
    heading: Vec<&'t str>,
    delimiter: char,
    rate_hz: Option<f64>,
    rows: Vec<(usize, &'t str)>,
}

/// The source of the times in a file.
#[derive(Clone, Copy)]
enum Times {
    /// A time column. Contains its unit in seconds.
    Column(f64),
    /// No time column. There is one row per sample, at this interval in seconds.
    Samples(f64),
}

/// Parts of a channel name that identify the clock channel.
const CLOCK: [&str; 4] = ["clk", "clock", "takt", "sck"];
const DATA: [&str; 2] = ["dat", "miso"];

/// Parses the levels of both lines. Returns `None` if the text is not a logic analyser export.
///
/// # Errors
/// Returns an error with the line, the reason and a remedy if the export is unusable.
pub(super) fn parse_levels(text: &str) -> Option<Result<Vec<LineLevels>, Text>> {
    let table = Table::parse(text)?;
    Some(table.find_times().and_then(|times| table.parse_levels(times)))
}

impl<'t> Table<'t> {
    fn parse(text: &'t str) -> Option<Self> {
        let mut rate_hz = None;
        let mut has_comment = false;
        let mut rows = Vec::new();
        for (number, line) in (1..).zip(text.lines()) {
            let line = line.trim().trim_start_matches('\u{feff}');
            match line.strip_prefix(';') {
                Some(comment) if rows.is_empty() => {
                    let rate = comment.trim().strip_prefix("Samplerate:").and_then(frequency);
                    has_comment |= rate.is_some() || comment.contains("sigrok");
                    rate_hz = rate.or(rate_hz);
                }
                _ if line.is_empty() => {}
                _ => rows.push((number, line)),
            }
        }
        let (_, first) = *rows.first()?;
        let count = |delimiter: &char| first.matches(*delimiter).count();
        let delimiter = [',', ';', '\t'].into_iter().max_by_key(|own| (count(own), *own == ','))?;
        let cells = |line: &'t str| line.split(delimiter).map(unquote).collect::<Vec<_>>();
        let heading = cells(first);
        let has_time = heading.first().is_some_and(|own| time_unit(own, rate_hz).is_some() || is_time_column(own));
        let is_saleae = heading.first().is_some_and(|own| own.to_ascii_lowercase().starts_with("time ["));
        // A table that has only columns of 0 and 1 contains levels. Other tables also have a time column.
        let are_levels = rows.get(1).is_some_and(|(_, row)| {
            let mut levels = row.split(delimiter).map(unquote).skip(1).peekable();
            levels.peek().is_some() && levels.all(|own| matches!(own, "0" | "1" | "X"))
        });
        if !(has_comment || is_saleae || has_time && are_levels) {
            return None;
        }
        // If there are no names, the first row already contains levels.
        let is_named = !heading.iter().all(|own| own.parse::<f64>().is_ok());
        let heading = if is_named { heading } else { vec![""; heading.len()] };
        let rows = if is_named { rows.get(1..).unwrap_or_default().to_vec() } else { rows };
        Some(Table { heading, delimiter, rate_hz, rows })
    }

    fn find_times(&self) -> Result<Times, Text> {
        let first = self.heading.first().copied().unwrap_or_default();
        if let Some(unit) = time_unit(first, self.rate_hz) {
            return Ok(Times::Column(unit));
        }
        match self.rate_hz {
            Some(rate) if !is_time_column(first) => Ok(Times::Samples(1.0 / rate)),
            _ => Err(TEXTS.text("ssi_capture.no_times")),
        }
    }

    fn parse_levels(&self, times: Times) -> Result<Vec<LineLevels>, Text> {
        let skipped = match times {
            Times::Column(_) => 1,
            Times::Samples(_) => 0,
        };
        let channels = self.heading.len().saturating_sub(skipped);
        if channels < 2 {
            return Err(TEXTS.text("ssi_capture.one_channel"));
        }
        let mut read = Vec::with_capacity(self.rows.len());
        let mut last = f64::NEG_INFINITY;
        for (index, (line, row)) in self.rows.iter().enumerate() {
            let at = |id| TEXTS.text(id).with("line", line);
            let cells: Vec<&str> = row.split(self.delimiter).map(unquote).collect();
            if cells.len() != self.heading.len() {
                let id = if cells.len() < self.heading.len() { "ssi_capture.cut_off" } else { "ssi_capture.columns" };
                return Err(at(id).with("columns", cells.len()).with("expected", self.heading.len()));
            }
            let (time, levels) = cells.split_at(skipped);
            let time = match (times, time.first()) {
                (Times::Column(unit), Some(text)) => {
                    let number: Option<f64> = text.replace(',', ".").parse().ok().filter(|own: &f64| own.is_finite());
                    number.ok_or_else(|| at("ssi_capture.time").with("text", text))? * unit
                }
                (Times::Column(unit) | Times::Samples(unit), _) => index as f64 * unit,
            };
            if time < last {
                return Err(at("ssi_capture.back"));
            }
            last = time;
            let bits: Vec<Option<bool>> = levels
                .iter()
                .map(|text| match *text {
                    "0" => Ok(Some(false)),
                    "1" => Ok(Some(true)),
                    // No level was recorded at this time.
                    "X" | "x" => Ok(None),
                    other => Err(at("ssi_capture.level").with("text", other)),
                })
                .collect::<Result<_, Text>>()?;
            read.push((time, bits));
        }
        let (clock, data) = self.find_channels(skipped, &read)?;
        let of = |bits: &[Option<bool>], channel: usize| bits.get(channel).copied().flatten();
        let mut levels: Vec<LineLevels> = Vec::new();
        for (at, bits) in &read {
            let (Some(clock), Some(data)) = (of(bits, clock), of(bits, data)) else { continue };
            levels.push(LineLevels { at: *at, clock, data });
        }
        Ok(levels)
    }

    /// Returns the clock channel and the data channel, which are identified by name. If the names are not conclusive,
    /// the channel that changes more often is taken as the clock.
    fn find_channels(&self, skipped: usize, read: &[(f64, Vec<Option<bool>>)]) -> Result<(usize, usize), Text> {
        let names: Vec<String> = self.heading.iter().skip(skipped).map(|name| name.to_lowercase()).collect();
        let named = |words: &[&str]| names.iter().position(|name| words.iter().any(|word| name.contains(word)));
        if let (Some(clock), Some(data)) = (named(&CLOCK), named(&DATA))
            && clock != data
        {
            return Ok((clock, data));
        }
        let changes = |channel: usize| {
            let levels = read.iter().filter_map(|(_, bits)| bits.get(channel).copied().flatten());
            levels.clone().zip(levels.skip(1)).filter(|(before, now)| before != now).count()
        };
        let counts: Vec<usize> = (0..names.len()).map(changes).collect();
        let mut active: Vec<usize> =
            (0..names.len()).filter(|own| counts.get(*own).is_some_and(|own| *own > 0)).collect();
        // If there are only two channels, the data line may never change.
        if active.len() == 1 && names.len() == 2 {
            active.extend((0..2).filter(|own| counts.get(*own) == Some(&0)));
        }
        let count = |channel: &usize| counts.get(*channel).copied().unwrap_or(0);
        match active.as_slice() {
            [] => Err(TEXTS.text("ssi_capture.no_edges")),
            [one, other] if count(one) >= count(other) => Ok((*one, *other)),
            [one, other] => Ok((*other, *one)),
            more => Err(TEXTS.text("ssi_capture.channels").with("count", more.len().max(names.len()))),
        }
    }
}

fn unquote(text: &str) -> &str {
    text.trim().trim_matches('"').trim()
}

fn is_time_column(name: &str) -> bool {
    name.to_ascii_lowercase().starts_with("time")
}

/// Returns the unit of a time column in seconds, or `None` if the column is not a time. The name is `Time [s]`,
/// sigrok's `nanoseconds`, or `Time`, whose unit depends on the sample rate.
fn time_unit(name: &str, rate_hz: Option<f64>) -> Option<f64> {
    const UNITS: [(&str, &str, f64); 5] = [
        ("s", "seconds", 1.0),
        ("ms", "milliseconds", 1e-3),
        ("us", "microseconds", 1e-6),
        ("ns", "nanoseconds", 1e-9),
        ("ps", "picoseconds", 1e-12),
    ];
    let name = name.to_lowercase().replace(['µ', 'μ'], "u");
    let inside = name
        .split_once(['[', '('])
        .and_then(|(time, unit)| (time.trim() == "time").then(|| unit.trim_end_matches([']', ')']).trim().to_owned()));
    match inside {
        Some(own) => UNITS.iter().find(|(short, ..)| *short == own).map(|(.., unit)| *unit),
        None if name == "time" => {
            // The unit is the largest one in which the interval between samples is at least 1.
            let rate = rate_hz?;
            Some(UNITS.iter().map(|(.., unit)| *unit).find(|unit| 1.0 / rate >= *unit).unwrap_or(1e-12))
        }
        None => UNITS.iter().find(|(_, long, _)| *long == name).map(|(.., unit)| *unit),
    }
}

/// Parses a sample rate as written by sigrok, such as `24 MHz`.
fn frequency(text: &str) -> Option<f64> {
    let text = text.trim();
    let begins = text.find(|c: char| c.is_alphabetic())?;
    let (number, unit) = text.split_at_checked(begins)?;
    let unit = match unit.trim() {
        "Hz" => 1.0,
        "kHz" => 1e3,
        "MHz" => 1e6,
        "GHz" => 1e9,
        _ => return None,
    };
    number.trim().parse::<f64>().ok().map(|own| own * unit).filter(|own| *own > 0.0)
}
