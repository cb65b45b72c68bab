//! Measured quantities of a signal, each with its unit, limit and verdict. The limits come from `analysis::quality`.
//! See SICK 8010701 for amplitudes and bandwidth.

use super::MeasurementResult;
use crate::analysis::input_circuit::{BANDWIDTH_HZ, speed_rpm_at};
use crate::analysis::quality::{Family, Verdict};
use crate::analysis::signal_analysis::{Analysis, MIN_OCTANTS};

#[derive(Clone, Debug, PartialEq)]
pub struct Quantity {
    pub word: &'static str,
    pub value: f64,
    /// Number of decimals to display.
    pub decimals: usize,
    pub unit: Unit,
    pub also: Option<(f64, usize, Unit)>,
    pub bound: Option<QuantityLimit>,
    /// Whether the limit is met, or `None` without a limit.
    pub verdict: Option<Verdict>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    One,
    Volts,
    Millivolts,
    /// Decibels relative to one volt rms.
    DecibelVolts,
    Percent,
    Degrees,
    ArcSeconds,
    Kilohertz,
    Rpm,
    Milliseconds,
}

/// The limit of a quantity, in the quantity's unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum QuantityLimit {
    Between(f64, f64),
    /// Maximum absolute value.
    Within(f64),
    AtMost(f64),
    AtLeast(f64),
}

impl Unit {
    /// Returns the symbol of the unit, or an empty string for a plain number.
    pub fn unit_symbol(self) -> &'static str {
        match self {
            Unit::One => "",
            Unit::Volts => "V",
            Unit::Millivolts => "mV",
            Unit::DecibelVolts => "dBV",
            Unit::Percent => "%",
            Unit::Degrees => "°",
            Unit::ArcSeconds => "″",
            Unit::Kilohertz => "kHz",
            Unit::Rpm => "rpm",
            Unit::Milliseconds => "ms",
        }
    }
}

impl QuantityLimit {
    /// Returns whether a value meets the limit. A value equal to the limit does.
    pub fn is_met(self, value: f64) -> bool {
        /// Tolerance for rounding errors of a value that equals the limit.
        const ROUNDING_TOLERANCE: f64 = 1e-9;
        match self {
            QuantityLimit::Between(least, most) => {
                value >= least - ROUNDING_TOLERANCE && value <= most + ROUNDING_TOLERANCE
            }
            QuantityLimit::Within(most) => value.abs() <= most + ROUNDING_TOLERANCE,
            QuantityLimit::AtMost(most) => value <= most + ROUNDING_TOLERANCE,
            QuantityLimit::AtLeast(least) => value >= least - ROUNDING_TOLERANCE,
        }
    }
}

impl QuantityLimit {
    /// Formats the limit without its unit, using `number` to format each number.
    pub fn format(self, number: impl Fn(f64) -> String) -> String {
        match self {
            QuantityLimit::Between(least, most) => format!("{} … {}", number(least), number(most)),
            QuantityLimit::Within(most) => format!("± {}", number(most)),
            QuantityLimit::AtMost(most) => format!("≤ {}", number(most)),
            QuantityLimit::AtLeast(least) => format!("≥ {}", number(least)),
        }
    }
}

impl Quantity {
    pub(super) fn new(word: &'static str, value: f64, decimals: usize, unit: Unit) -> Self {
        Quantity { word, value, decimals, unit, also: None, bound: None, verdict: None }
    }

    pub(super) fn with_secondary_value(mut self, value: f64, decimals: usize, unit: Unit) -> Self {
        self.also = Some((value, decimals, unit));
        self
    }

    /// Adds a limit and the resulting verdict. A value beyond the limit is only a warning, because the position is
    /// still correct.
    fn with_limit(mut self, bound: QuantityLimit) -> Self {
        self.bound = Some(bound);
        self.verdict = Some(if bound.is_met(self.value) { Verdict::Ok } else { Verdict::Warn });
        self
    }

    fn with_verdict(mut self, verdict: Verdict) -> Self {
        self.verdict = Some(verdict);
        self
    }
}

/// Returns the quantities of a signal, with verdicts according to the limits of an encoder family. The speed is
/// included if the number of `periods` per revolution is known. The list is empty if no ellipse could be fitted.
pub fn signal_quantities(measurement: &MeasurementResult, family: Family, periods: Option<u32>) -> Vec<Quantity> {
    let Ok(analysis) = &measurement.analysis else { return Vec::new() };
    let mut list = ellipse_quantities(analysis, family);
    let (least, most) = family.limits().level_v;
    for (word, level) in [("quality.level_sine", 0), ("quality.level_cosine", 1)] {
        let volts = measurement.levels_v.map(|(sine, cosine)| if level == 0 { sine } else { cosine });
        let level = |volts| Quantity::new(word, volts, 3, Unit::Volts).with_limit(QuantityLimit::Between(least, most));
        list.extend(volts.map(level));
    }
    if let Some(frequency_hz) = analysis.frequency_hz() {
        let frequency = Quantity::new("quality.frequency", frequency_hz / 1e3, 4, Unit::Kilohertz)
            .with_limit(QuantityLimit::Within(BANDWIDTH_HZ / 1e3));
        list.push(if analysis.is_angle_tracked() { frequency } else { frequency.with_verdict(Verdict::Warn) });
        let speed = periods.and_then(|periods| speed_rpm_at(periods, frequency_hz));
        list.extend(speed.map(|rpm| Quantity::new("quality.speed", rpm, 2, Unit::Rpm)));
    }
    list.push(Quantity::new("quality.samples", analysis.samples as f64, 0, Unit::One));
    let left_out = |count: usize| Quantity::new("quality.left_out", count as f64, 0, Unit::One);
    list.extend(analysis.outliers.as_ref().map(|outliers| left_out(outliers.count)));
    let rows = measurement.rows_left_out;
    list.extend(
        (rows > 0)
            .then(|| Quantity::new("quality.rows_left_out", rows as f64, 0, Unit::One).with_verdict(Verdict::Warn)),
    );
    list.extend(analysis.duration_s.map(|s| Quantity::new("quality.duration", 1e3 * s, 3, Unit::Milliseconds)));
    list
}

fn ellipse_quantities(analysis: &Analysis, family: Family) -> Vec<Quantity> {
    let limits = family.limits();
    let Analysis { ellipse, coverage, .. } = analysis;
    let volts = |word, peak: f64, factor: f64| {
        let (least, most) = limits.ok_v;
        let quantity = Quantity::new(word, factor * peak, 4, Unit::Volts);
        quantity
            .with_limit(QuantityLimit::Between(factor * least, factor * most))
            .with_verdict(limits.amplitude_verdict(peak))
    };
    let percent = |word, share: f64, decimals| Quantity::new(word, 100.0 * share, decimals, Unit::Percent);
    let offset = |word, offset_v: f64| {
        percent(word, offset_v / ellipse.amplitude_v, 2)
            .with_secondary_value(1000.0 * offset_v, 1, Unit::Millivolts)
            .with_limit(QuantityLimit::Within(100.0 * limits.offset))
    };
    let (least, most) = coverage.vector_v;
    vec![
        volts("quality.amplitude_sine", ellipse.amplitude_sine_v(), 2.0),
        volts("quality.amplitude_cosine", ellipse.amplitude_v, 2.0),
        volts("quality.vector_least", least, 1.0),
        volts("quality.vector_most", most, 1.0),
        offset("quality.offset_sine", ellipse.offset_sine_v),
        offset("quality.offset_cosine", ellipse.offset_cosine_v),
        Quantity::new("quality.gain", ellipse.gain_ratio, 4, Unit::One)
            .with_limit(QuantityLimit::Between(limits.gain_ratio.0, limits.gain_ratio.1)),
        Quantity::new("quality.phase", ellipse.phase_error_deg(), 2, Unit::Degrees)
            .with_limit(QuantityLimit::Within(limits.phase_deg)),
        percent("quality.residual", coverage.residual_rms, 2)
            .with_limit(QuantityLimit::AtMost(100.0 * limits.residual)),
        Quantity::new("quality.octants", f64::from(coverage.octants), 0, Unit::One)
            .with_limit(QuantityLimit::AtLeast(f64::from(MIN_OCTANTS))),
        Quantity::new("quality.periods", coverage.periods, 2, Unit::One),
    ]
}

/// Returns the position error within a period, before and after the correction. If the number of `periods` per
/// revolution is known, the error is also given in mechanical arcseconds.
pub fn error_quantities(analysis: &Analysis, periods: Option<u32>) -> Vec<Quantity> {
    /// Mechanical arcseconds per electrical degree at one period per revolution.
    const ARC_SECONDS: f64 = 3600.0;
    let a_degree = periods.map(|periods| ARC_SECONDS / f64::from(periods.max(1)));
    let peak_to_peak = |word, degrees: f64| {
        let quantity = Quantity::new(word, degrees, 3, Unit::Degrees);
        match a_degree {
            Some(a_degree) => quantity.with_secondary_value(degrees * a_degree, 2, Unit::ArcSeconds),
            None => quantity,
        }
    };
    let mut list = vec![
        peak_to_peak("error.raw_pp", analysis.error.raw_peak_to_peak_deg()),
        peak_to_peak("error.corrected_pp", analysis.error.corrected_pp_deg),
    ];
    list.extend(a_degree.map(|own| Quantity::new("error.period", 360.0 * own, 2, Unit::ArcSeconds)));
    list
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::capture::Capture;
    use crate::signals::state::{DiagnosisSettings, Measurement, Origin};
    use std::sync::Arc;

    /// Returns the example of section 7: R = 0.5, p = 0.02, q = −0.03, r = 1.05, α = 3°, with 1000 samples over two
    /// periods in 20 ms.
    fn section_7_example() -> Measurement {
        let (alpha, turns) = (3.0_f64.to_radians(), 2.0 * std::f64::consts::TAU);
        let angle = |at: i32| f64::from(at) / 999.0 * turns;
        let capture = Capture {
            time_s: (0..1000).map(|at| f64::from(at) / 999.0 * 0.02).collect(),
            sine_v: (0..1000).map(|at| 0.5 * (angle(at) - alpha).sin() / 1.05 - 0.03).collect(),
            cosine_v: (0..1000).map(|at| 0.5 * angle(at).cos() + 0.02).collect(),
            ..Capture::default()
        };
        Measurement::from_capture(Origin::Virtual, Arc::new(capture), DiagnosisSettings::default())
    }

    #[test]
    fn quantities_match_section_7() {
        let list = signal_quantities(&section_7_example(), Family::Hiperface, Some(50));
        let find = |word: &str| list.iter().find(|own| own.word == word).unwrap_or_else(|| panic!("{word}"));
        // The amplitudes are 2·0.5 and 2·0.5/1.05. Offsets are fractions of 0.5 V. 2 periods in 20 ms are 100 Hz; with
        // 50 periods per revolution, this is 2 revolutions per second.
        for (word, value, verdict) in [
            ("quality.amplitude_cosine", 1.0, Some(Verdict::Ok)),
            ("quality.amplitude_sine", 0.952_381, Some(Verdict::Ok)),
            ("quality.offset_sine", -6.0, Some(Verdict::Warn)),
            ("quality.offset_cosine", 4.0, Some(Verdict::Ok)),
            ("quality.gain", 1.05, Some(Verdict::Ok)),
            ("quality.phase", 3.0, Some(Verdict::Ok)),
            ("quality.residual", 0.0, Some(Verdict::Ok)),
            ("quality.octants", 8.0, Some(Verdict::Ok)),
            ("quality.periods", 2.0, None),
            ("quality.frequency", 0.1, Some(Verdict::Ok)),
            ("quality.speed", 120.0, None),
            ("quality.samples", 1000.0, None),
            ("quality.duration", 20.0, None),
        ] {
            let own = find(word);
            assert!((own.value - value).abs() < 2e-6, "{word}: {}", own.value);
            assert_eq!(own.verdict, verdict, "{word}");
        }
        let (millivolts, _, unit) = find("quality.offset_sine").also.unwrap();
        assert!((millivolts - -30.0).abs() < 1e-6 && unit == Unit::Millivolts);
        // Raw vectors of section 7: 0.44595 V to 0.53764 V. The shortest is below 0.45 V.
        let least = find("quality.vector_least");
        assert!((least.value - 0.445_95).abs() < 2e-5 && least.verdict == Some(Verdict::Warn), "{least:?}");
        assert!((find("quality.vector_most").value - 0.537_64).abs() < 2e-5);
        let bare = signal_quantities(&section_7_example(), Family::Hiperface, None);
        assert!(bare.len() + 1 == list.len() && bare.iter().all(|own| own.unit != Unit::Rpm), "issue 22.13");
        let wide = signal_quantities(&section_7_example(), Family::AfsAfm60, Some(50));
        let least = wide.iter().find(|own| own.word == "quality.vector_least").unwrap();
        assert_eq!((least.verdict, least.bound), (Some(Verdict::Ok), Some(QuantityLimit::Between(0.4, 0.6))));
    }

    /// A sine offset of 1 % causes an error of ±0.5730°, or 1.1459° peak to peak, which is 4.029″ at 1024 periods
    /// (section 6).
    #[test]
    fn shows_section_6_error_in_arcseconds() {
        let angle = |at: i32| f64::from(at) / 1000.0 * 4.0 * std::f64::consts::TAU;
        let capture = Capture {
            sine_v: (0..1000).map(|at| 0.5 * angle(at).sin() + 0.005).collect(),
            cosine_v: (0..1000).map(|at| 0.5 * angle(at).cos()).collect(),
            ..Capture::default()
        };
        let analysis = Measurement::from_capture(Origin::Virtual, Arc::new(capture), DiagnosisSettings::default())
            .analysis
            .clone()
            .unwrap();
        // Without the periods per revolution, there are no mechanical angles and no speed (issue 22.13).
        let bare = error_quantities(&analysis, None);
        assert!(bare.len() == 2 && bare.iter().all(|own| own.unit == Unit::Degrees && own.also.is_none()), "{bare:?}");
        let list = error_quantities(&analysis, Some(1024));
        assert!((list[0].value - 1.1459).abs() < 1e-3 && list[0].unit == Unit::Degrees, "{:?}", list[0]);
        let (arc_seconds, _, unit) = list[0].also.unwrap();
        assert!((arc_seconds - 4.029).abs() < 4e-3 && unit == Unit::ArcSeconds, "{:?}", list[0]);
        assert!(list[1].value < 1e-3, "{:?}", list[1]);
        assert_eq!((list[2].value, list[2].unit), (1265.625, Unit::ArcSeconds));
    }

    #[test]
    fn limits_are_inclusive() {
        for (bound, inside, outside) in [
            (QuantityLimit::Between(0.9, 1.1), [0.9, 1.1], [0.89, 1.11]),
            (QuantityLimit::Within(5.0), [-5.0, 5.0], [-5.1, f64::NAN]),
            (QuantityLimit::AtMost(2.0), [2.0, -9.0], [2.1, f64::INFINITY]),
            (QuantityLimit::AtLeast(6.0), [6.0, 8.0], [5.0, f64::NAN]),
        ] {
            assert_eq!(inside.map(|value| bound.is_met(value)), [true, true], "{bound:?}");
            assert_eq!(outside.map(|value| bound.is_met(value)), [false, false], "{bound:?}");
        }
    }
}
