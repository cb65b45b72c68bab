//! Arguments of the `analyse` command.

use std::path::PathBuf;
use std::time::Duration;

use clap::{Args, ValueEnum};

use crate::analysis::capture::Columns;
use crate::analysis::quality::Family;

#[derive(Args)]
pub(super) struct AnalyseArgs {
    /// Table of time, sine and cosine in seconds and volts. The delimiter, decimal sign, header and units are detected
    /// automatically. Without a file, the signals are sampled by the adapter at --link.
    #[arg(value_name = "FILE.csv")]
    pub(super) file: Option<PathBuf>,
    /// How long the adapter samples the signals.
    #[arg(long, value_name = "SECONDS", value_parser = parse_duration, default_value = "1", allow_negative_numbers = true)]
    pub(super) seconds: Duration,
    /// Sample rate of the adapter in hertz. The adapter uses the nearest rate that it supports.
    #[arg(long, value_name = "HZ", value_parser = clap::value_parser!(u32).range(10..=1_000_000), default_value_t = 50_000, allow_negative_numbers = true)]
    pub(super) rate: u32,
    /// Column numbers, starting at 1: time, sine and cosine, or time, SIN, REFSIN, COS and REFCOS. Optional: reference=N
    /// (mechanical degrees) and absolute=N (steps of 1/32 period).
    #[arg(long, value_name = "1,2,3", value_parser = parse_columns)]
    pub(super) columns: Option<Columns>,
    /// Volts per unit of the sine and cosine columns.
    #[arg(long, value_name = "X", value_parser = parse_factor, allow_negative_numbers = true)]
    pub(super) volts_per_unit: Option<f64>,
    /// Encoder family whose limits are used.
    #[arg(long, value_enum, default_value_t = Limits::Hiperface)]
    pub(super) limits: Limits,
    /// Signal periods per revolution, used to determine the speed, errors that repeat each revolution, and, with a
    /// reference, DNL and INL.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000), allow_negative_numbers = true)]
    pub(super) periods: Option<u32>,
}

/// Options for a report on a capture.
#[derive(Args)]
pub(super) struct ReportOptions {
    /// For a capture: encoder family whose limits apply.
    #[arg(long, value_enum, default_value_t = Limits::Hiperface)]
    pub(super) limits: Limits,
    /// For a capture: signal periods per revolution, used to determine the speed and errors in mechanical angles.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000), allow_negative_numbers = true)]
    pub(super) periods: Option<u32>,
}

/// Encoder families with known signal limits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Limits {
    /// 0.9 … 1.1 V peak to peak, references at 2.0 … 3.0 V.
    Hiperface,
    /// 0.8 … 1.2 V peak to peak, references at 2.25 … 2.75 V.
    AfsAfm60,
    /// 0.9 … 1.1 V peak to peak, references at 2.375 … 2.625 V.
    Ttk70,
}

impl Limits {
    pub(super) fn family(self) -> Family {
        match self {
            Limits::Hiperface => Family::Hiperface,
            Limits::AfsAfm60 => Family::AfsAfm60,
            Limits::Ttk70 => Family::Ttk70,
        }
    }
}

fn parse_columns(text: &str) -> Result<Columns, String> {
    let number = |word: &str| word.trim().parse().ok().filter(|number: &usize| *number > 0);
    let mut numbers: Vec<usize> = Vec::new();
    let (mut reference_angle, mut absolute) = (None, None);
    for word in text.split(',') {
        let place = match word.split_once('=') {
            None => &mut None,
            Some(("reference", _)) => &mut reference_angle,
            Some(("absolute", _)) => &mut absolute,
            Some((name, _)) => return Err(format!("{name} is not a column; use reference= or absolute=")),
        };
        let column = number(word.split_once('=').map_or(word, |(_, number)| number));
        *place = Some(column.ok_or("columns are numbers from 1, such as 1,2,3 or 1,2,3,reference=4")?);
        if !word.contains('=') {
            numbers.extend(column);
        }
    }
    let (time, sine, cosine, references) = match *numbers.as_slice() {
        [time, sine, cosine] => (Some(time), sine, cosine, None),
        [time, sine, refsin, cosine, refcos] => (Some(time), sine, cosine, Some((refsin, refcos))),
        _ => return Err("three or five column numbers from 1 are required, such as 1,2,3".to_owned()),
    };
    numbers.extend(reference_angle.into_iter().chain(absolute));
    let different: std::collections::BTreeSet<&usize> = numbers.iter().collect();
    if different.len() < numbers.len() {
        return Err("a column appears twice".to_owned());
    }
    Ok(Columns { time, sine, cosine, references, reference_angle, absolute })
}

fn parse_duration(text: &str) -> Result<Duration, String> {
    let seconds = text.parse().ok().filter(|seconds: &f64| (0.01..=60.0).contains(seconds));
    seconds.map(Duration::from_secs_f64).ok_or_else(|| "a time from 0.01 to 60 s is required".to_owned())
}

fn parse_factor(text: &str) -> Result<f64, String> {
    let factor = text.parse().ok().filter(|factor: &f64| factor.is_finite() && *factor > 0.0);
    factor.ok_or_else(|| "a number above 0 is required, such as 0.001".to_owned())
}
