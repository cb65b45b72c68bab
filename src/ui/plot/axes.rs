//! Ticks and their labels, with round steps for values and suitable units for times. All functions are pure.

use crate::analysis::SampleTime;
use crate::app::recorder::UNTIMED_SAMPLE_INTERVAL_NS;
use crate::app::{Language, format_decimal};
pub(super) use crate::drawing::ticks::{decimal_places, step_1_2_5, tick_values};

/// Formats a value as an axis label for the given step.
pub(super) fn value_label(value: f64, step: f64, language: Language) -> String {
    let decimals = decimal_places(step);
    if value.abs() >= 1e9 { format!("{value:.2e}") } else { format_decimal(value, decimals, language) }
}

/// Returns a range that contains `low` to `high` and is at least `least` long. Its limits are multiples of a round
/// step, so the range does not change with every sample.
pub(super) fn round_range(low: f64, high: f64, least: f64) -> (f64, f64) {
    let (low, high) = if high - low < least {
        let middle = f64::midpoint(low, high);
        (middle - least / 2.0, middle + least / 2.0)
    } else {
        (low, high)
    };
    let span = high - low;
    if !span.is_finite() || span <= 0.0 {
        // The values are so large that their difference exceeds the range of a double. Such values are not measured
        // values.
        return (f64::MIN / 4.0, f64::MAX / 4.0);
    }
    let (low, high) = (low - span * 0.04, high + span * 0.04);
    let step = step_1_2_5(high - low, 6.0) / 2.0;
    ((low / step).floor() * step, (high / step).ceil() * step)
}

#[derive(Debug, PartialEq)]
pub(super) struct TimeTicks {
    pub(super) ticks: Vec<(SampleTime, String)>,
    /// Reference time of the labels, or `None` if the labels count from the beginning.
    pub(super) base: Option<String>,
}

const SECOND: i64 = 1_000_000_000;

pub(super) fn time_ticks(from: SampleTime, to: SampleTime, most: usize, language: Language) -> TimeTicks {
    let span = to.nanoseconds_since(from).max(1);
    let step = time_step(span, most.max(1));
    // If labels would differ only in their last digits, they count from a round time before them.
    let coarse = if step < SECOND && from.as_nanoseconds().abs() > 2000 * step {
        Some(axis_base_time(from, step))
    } else {
        None
    };
    let origin = coarse.unwrap_or(0);
    let first = from.as_nanoseconds().saturating_sub(origin).div_euclid(step);
    let mut ticks = Vec::new();
    for count in first..=first.saturating_add(most as i64 + 3) {
        let offset = count.saturating_mul(step);
        let at = SampleTime::from_nanoseconds(origin.saturating_add(offset));
        if at > to {
            break;
        }
        if at >= from {
            let plus = if coarse.is_some() && offset >= 0 { "+" } else { "" };
            ticks.push((at, format!("{plus}{}", time_label(offset, step, language))));
        }
    }
    TimeTicks { ticks, base: coarse.map(|base| clock(base, 1, language)) }
}

/// Returns ticks labelled with sample numbers instead of times.
pub(super) fn sample_ticks(from: SampleTime, to: SampleTime, most: usize, language: Language) -> TimeTicks {
    let number = |time: SampleTime| time.as_nanoseconds() as f64 / UNTIMED_SAMPLE_INTERVAL_NS as f64;
    let step = step_1_2_5(number(to) - number(from), most as f64).max(1.0);
    let tick = |value: f64| {
        (
            SampleTime::from_nanoseconds((value * UNTIMED_SAMPLE_INTERVAL_NS as f64) as i64),
            format_decimal(value, 0, language),
        )
    };
    TimeTicks { ticks: tick_values(number(from), number(to), step).map(tick).collect(), base: None }
}

/// Returns the base time of the labels, at or before `from`. It is a multiple of 0.1 s for steps below 1 ms, and of 10
/// s otherwise.
fn axis_base_time(from: SampleTime, step: i64) -> i64 {
    let grain = if step < SECOND / 1000 { SECOND / 10 } else { SECOND * 10 };
    from.as_nanoseconds().div_euclid(grain).saturating_mul(grain)
}

fn time_step(span: i64, most: usize) -> i64 {
    let most = i64::try_from(most).unwrap_or(i64::MAX);
    let least = span / most + i64::from(span % most > 0);
    let mut decimal = 1_i64;
    while decimal <= SECOND {
        for factor in [1, 2, 5] {
            // A minute is not divided into steps of 20 or 50 seconds.
            if factor * decimal >= least && factor * decimal <= 10 * SECOND {
                return factor * decimal;
            }
        }
        decimal *= 10;
    }
    const MINUTE: i64 = 60;
    const HOUR: i64 = 60 * MINUTE;
    let clock = [10, 15, 30, MINUTE, 2 * MINUTE, 5 * MINUTE, 10 * MINUTE, 15 * MINUTE, 30 * MINUTE, HOUR, 2 * HOUR];
    let more = [3 * HOUR, 6 * HOUR, 12 * HOUR, 24 * HOUR, 48 * HOUR, 120 * HOUR, 240 * HOUR, 480 * HOUR, 1200 * HOUR];
    let found = clock.into_iter().chain(more).map(|seconds| seconds * SECOND).find(|step| *step >= least);
    found.unwrap_or(2400 * HOUR * SECOND)
}

/// Formats a time as an axis label for the given step. The label has a unit if the step is below one second, and clock
/// notation otherwise.
fn time_label(nanoseconds: i64, step: i64, language: Language) -> String {
    if nanoseconds == 0 {
        return "0".to_owned();
    }
    let (unit, per, decimals) = match step {
        0..100 => ("µs", 1e3, 2),
        100..1_000 => ("µs", 1e3, 1),
        1_000..1_000_000 => ("µs", 1e3, 0),
        1_000_000..SECOND => ("ms", 1e6, 0),
        _ => return clock(nanoseconds, step, language),
    };
    // Whole seconds are shown as seconds and not as milliseconds.
    if step >= 1_000_000 && nanoseconds.abs() >= SECOND {
        let decimals = if step >= 100_000_000 {
            1
        } else if step >= 10_000_000 {
            2
        } else {
            3
        };
        return format!("{} s", format_decimal(nanoseconds as f64 / 1e9, decimals, language));
    }
    if step >= 1_000 && unit == "µs" && nanoseconds.abs() >= 1_000_000 {
        let decimals = if step >= 100_000 {
            1
        } else if step >= 10_000 {
            2
        } else {
            3
        };
        return format!("{} ms", format_decimal(nanoseconds as f64 / 1e6, decimals, language));
    }
    format!("{} {unit}", format_decimal(nanoseconds as f64 / per, decimals, language))
}

/// Formats a time in whole seconds in clock notation, with tenths for a finer step.
fn clock(nanoseconds: i64, step: i64, language: Language) -> String {
    let sign = if nanoseconds < 0 { "-" } else { "" };
    let tenths = nanoseconds.unsigned_abs() / 100_000_000;
    let (seconds, tenth) = (tenths / 10, tenths % 10);
    let (days, hours, minutes) = (seconds / 86_400, seconds / 3600 % 24, seconds / 60 % 60);
    let fraction =
        if step < SECOND { format_decimal(tenth as f64 / 10.0, 1, language).split_off(1) } else { String::new() };
    match (days, hours, minutes) {
        (0, 0, 0) => format!("{sign}{seconds}{fraction} s"),
        (0, 0, _) => format!("{sign}{minutes}:{:02}{fraction}", seconds % 60),
        (0, ..) => format!("{sign}{hours}:{minutes:02}:{:02}{fraction}", seconds % 60),
        _ => format!("{sign}{days} d {hours}:{minutes:02}:{:02}{fraction}", seconds % 60),
    }
}

/// Formats a time with the precision of a plot that spans `span` nanoseconds.
pub(super) fn time_of_day(time: SampleTime, span: i64, language: Language) -> String {
    let nanoseconds = time.as_nanoseconds();
    let digits = [(SECOND, 3), (SECOND / 1_000, 6), (0, 9)].into_iter().find(|(least, _)| span >= *least);
    let decimals = digits.map_or(9, |(_, digits)| digits);
    let sign = if nanoseconds < 0 { "-" } else { "" };
    let whole = nanoseconds.unsigned_abs();
    let fraction = format!("{:09}", whole % SECOND.unsigned_abs());
    let seconds = format!("{sign}{}.{}", whole / SECOND.unsigned_abs(), fraction.get(..decimals).unwrap_or_default());
    match language {
        Language::German => format!("{} s", seconds.replace('.', ",")),
        Language::English => format!("{seconds} s"),
    }
}

pub(super) fn sample_number(time: SampleTime) -> String {
    time.as_nanoseconds().div_euclid(UNTIMED_SAMPLE_INTERVAL_NS).to_string()
}

/// Formats a duration with about four digits.
pub(super) fn duration(nanoseconds: i64, language: Language) -> String {
    let sign = if nanoseconds < 0 { "-" } else { "" };
    let length = nanoseconds.unsigned_abs() as f64;
    let (unit, per) = match length {
        ..1e3 => return format!("{sign}{} ns", nanoseconds.unsigned_abs()),
        ..1e6 => ("µs", 1e3),
        ..1e9 => ("ms", 1e6),
        ..60e9 => ("s", 1e9),
        _ => return clock(nanoseconds, 1, language),
    };
    format!("{sign}{} {unit}", format_decimal(length / per, 3, language))
}

/// Formats a duration with three digits, for narrow spaces.
pub(super) fn format_short_duration(nanoseconds: i64, language: Language) -> String {
    let length = nanoseconds.unsigned_abs() as f64;
    if length >= 60e9 {
        return clock(nanoseconds / SECOND * SECOND, SECOND, language);
    }
    let (unit, per) = match length {
        ..1e3 => ("ns", 1.0),
        ..1e6 => ("µs", 1e3),
        ..1e9 => ("ms", 1e6),
        _ => ("s", 1e9),
    };
    let value = length / per;
    let decimals = if value < 10.0 { 2 } else { usize::from(value < 100.0) };
    format!("{} {unit}", format_decimal(value, decimals, language))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axis_steps_are_round_and_few() {
        for (span, most, expected) in [
            (10.0, 5.0, 2.0),
            (10.0, 4.0, 5.0),
            (1.0, 10.0, 0.1),
            (0.000_37, 4.0, 0.000_1),
            (7e6, 3.0, 5e6),
            (0.0, 4.0, 1.0),
            (f64::NAN, 4.0, 1.0),
            (f64::INFINITY, 4.0, 1.0),
        ] {
            let found = step_1_2_5(span, most);
            assert!((found / expected - 1.0).abs() < 1e-9, "{span} {most}: {found}");
        }
        assert_eq!([2.0, 0.5, 0.01, 0.002, 1000.0].map(decimal_places), [0, 1, 2, 3, 0]);
        assert_eq!(tick_values(-1.0, 1.0, 0.5).collect::<Vec<_>>(), [-1.0, -0.5, 0.0, 0.5, 1.0]);
        assert_eq!(tick_values(0.1, 0.2, 1.0).count(), 0);
        assert_eq!(tick_values(f64::NEG_INFINITY, 1.0, 0.5).count(), 0);
        assert_eq!(tick_values(0.0, 1e12, 1.0).count(), 200);
    }

    #[test]
    fn range_contains_values_and_is_never_empty() {
        for (low, high) in [(0.0, 1.0), (-3.2, 4.7), (5.0, 5.0), (1e9, 1e9 + 1.0), (0.0, 0.0), (-1e-7, 1e-7)] {
            let (from, to) = round_range(low, high, 1e-3);
            assert!(from <= low && to >= high && to - from >= 1e-3, "{low} {high}: {from} {to}");
        }
        let (from, to) = round_range(f64::MIN, f64::MAX, 1.0);
        assert!(from < to && (to - from).is_finite());
    }

    fn tick_labels(from: i64, to: i64) -> (Vec<String>, Option<String>) {
        let ticks =
            time_ticks(SampleTime::from_nanoseconds(from), SampleTime::from_nanoseconds(to), 4, Language::English);
        (ticks.ticks.into_iter().map(|(_, label)| label).collect(), ticks.base)
    }

    #[test]
    fn labels_time_in_step_unit() {
        let second = SECOND;
        let cases: [(i64, i64, &[&str]); 8] = [
            (0, 10 * second, &["0", "5 s", "10 s"]),
            (55 * second, 130 * second, &["1:00", "1:30", "2:00"]),
            (3590 * second, 3620 * second, &["59:50", "1:00:00", "1:00:10", "1:00:20"]),
            (0, 3_000_000, &["0", "1 ms", "2 ms", "3 ms"]),
            (-200_000, 200_000, &["-200 µs", "-100 µs", "0", "100 µs", "200 µs"]),
            (0, 800, &["0", "0.2 µs", "0.4 µs", "0.6 µs", "0.8 µs"]),
            (900_000_000, 1_500_000_000, &["1.0 s", "1.2 s", "1.4 s"]),
            (86_400 * second, 86_430 * second, &["1 d 0:00:00", "1 d 0:00:10", "1 d 0:00:20", "1 d 0:00:30"]),
        ];
        for (from, to, expected) in cases {
            let (found, base) = tick_labels(from, to);
            assert_eq!((found, base), (expected.iter().map(|own| (*own).to_owned()).collect(), None), "{from} {to}");
        }
    }

    #[test]
    fn small_distant_steps_use_round_base() {
        let hour = 3600 * SECOND;
        let (found, base) = tick_labels(hour + 30_000, hour + 33_000);
        assert_eq!(
            (found, base),
            (["+30 µs", "+31 µs", "+32 µs", "+33 µs"].map(ToOwned::to_owned).to_vec(), Some("1:00:00.0".to_owned()))
        );
    }

    #[test]
    fn sample_ticks_are_whole_numbers() {
        let at = |sample: i64| SampleTime::from_nanoseconds(sample * 1_000);
        let ticks = |from, to| sample_ticks(at(from), at(to), 4, Language::English).ticks;
        assert_eq!(ticks(0, 1000).into_iter().map(|own| own.1).collect::<Vec<_>>(), ["0", "500", "1000"]);
        assert_eq!(ticks(7, 9), [(at(7), "7".to_owned()), (at(8), "8".to_owned()), (at(9), "9".to_owned())]);
    }

    #[test]
    fn time_spans_have_few_ticks() {
        let mut span = 1;
        // A hundred days, the length of the longest view.
        while span < 8_640_000 * SECOND {
            for from in [0, -span, 123_456_789_012, i64::MAX / 2] {
                let ticks = time_ticks(
                    SampleTime::from_nanoseconds(from),
                    SampleTime::from_nanoseconds(from + span),
                    6,
                    Language::German,
                );
                assert!(ticks.ticks.len() <= 8, "{from} {span}: {}", ticks.ticks.len());
                assert!(ticks.ticks.is_sorted_by(|a, b| a.0 < b.0));
            }
            span *= 3;
        }
    }

    #[test]
    fn time_label_has_axis_precision() {
        for (nanoseconds, span, expected) in [
            (12_345_678_901, 30 * SECOND, "12.345 s"),
            (-1_500_000_000, SECOND, "-1.500 s"),
            (12_345_678_901, 5_000_000, "12.345678 s"),
            (901, 1_000, "0.000000901 s"),
        ] {
            assert_eq!(time_of_day(SampleTime::from_nanoseconds(nanoseconds), span, Language::English), expected);
        }
        assert_eq!(sample_number(SampleTime::from_nanoseconds(7_999)), "7");
    }

    #[test]
    fn durations_have_units() {
        for (nanoseconds, expected) in [
            (0, "0 ns"),
            (-750, "-750 ns"),
            (1_500, "1.500 µs"),
            (26_000_000, "26.000 ms"),
            (1_250_000_000, "1.250 s"),
            (-61_500_000_000, "-1:01.5"),
        ] {
            assert_eq!(duration(nanoseconds, Language::English), expected);
        }
        for (nanoseconds, expected) in [
            (700, "700 ns"),
            (6_767_000, "6,77 ms"),
            (15_629_000_000, "15,6 s"),
            (123_456_789, "123 ms"),
            (61_500_000_000, "1:01"),
        ] {
            assert_eq!(format_short_duration(nanoseconds, Language::German), expected);
        }
    }
}
