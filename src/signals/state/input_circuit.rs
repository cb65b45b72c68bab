//! Calculator for the input circuit of a drive: signal frequency and effect of the filter, at a given speed and up to
//! the encoder's bandwidth. See SICK 8010701, process data channel, and section 1 of the project's sine/cosine
//! reference.

use crate::analysis::input_circuit::{BANDWIDTH_HZ, FilterResponse, InputFilter, signal_frequency_hz, speed_rpm_at};
use crate::app::Text;
use crate::app::number::{MAX_PERIODS, parse_in_range, parse_integer, parse_quantity};
use crate::signals::state::TEXTS;

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Form {
    pub periods: String,
    /// Speed in revolutions per minute, as entered.
    pub speed: String,
    /// Resistance of the filter, as entered, such as `10k`.
    pub resistance: String,
    /// Capacitance of the filter, as entered, such as `22p`.
    pub capacitance: String,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OperatingPoint {
    pub speed_rpm: f64,
    pub frequency_hz: f64,
    pub response: FilterResponse,
    /// Lag of the measured shaft angle behind the actual one, in mechanical degrees.
    pub shaft_deg: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InputCircuitResult {
    pub here: OperatingPoint,
    /// Speed in revolutions per minute at which the signal frequency equals the encoder's bandwidth.
    pub most_rpm: f64,
    /// Corner frequency of the filter in hertz, where 71 % of the amplitude remains.
    pub corner_hz: f64,
    periods: u32,
    filter: InputFilter,
}

/// Highest speed that can be entered, in revolutions per minute.
const MAX_RPM: f64 = 1_000_000.0;

impl Default for Form {
    fn default() -> Self {
        let typed = |text: &str| text.to_owned();
        Form { periods: typed("1024"), speed: typed("6000"), resistance: typed("10k"), capacitance: typed("47p") }
    }
}

impl Form {
    /// Calculates the result from the entries.
    ///
    /// # Errors
    /// Returns the reason why the first invalid entry was rejected.
    pub fn calculate_circuit(&self) -> Result<InputCircuitResult, Text> {
        let periods = parse_integer(TEXTS.text("input.periods"), &self.periods, 1, MAX_PERIODS)?;
        let speed_rpm = parse_in_range(TEXTS.text("input.speed"), &self.speed, 0.0, MAX_RPM)?;
        let ohms = parse_quantity(TEXTS.text("input.resistance"), &self.resistance, (1.0, 1e9), ("1 Ω", "1 GΩ"))?;
        let farads =
            parse_quantity(TEXTS.text("input.capacitance"), &self.capacitance, (1e-15, 1e-3), ("1 fF", "1 mF"))?;
        let filter = InputFilter { resistance_ohm: ohms, capacitance_f: farads };
        let most_rpm = speed_rpm_at(periods, BANDWIDTH_HZ).unwrap_or(MAX_RPM);
        let corner_hz = 1.0 / (std::f64::consts::TAU * ohms * farads);
        Ok(InputCircuitResult {
            here: operating_point(periods, filter, speed_rpm),
            most_rpm,
            corner_hz,
            periods,
            filter,
        })
    }
}

impl InputCircuitResult {
    pub fn is_within_bandwidth(&self) -> bool {
        self.here.frequency_hz <= BANDWIDTH_HZ
    }

    /// Returns the operating points at `count` evenly spaced speeds, up to the highest speed within the encoder's
    /// bandwidth.
    pub fn operating_points(&self, count: u32) -> Vec<OperatingPoint> {
        let speed = |at: u32| self.most_rpm * f64::from(at) / f64::from(count.max(1));
        (1..=count).map(|at| operating_point(self.periods, self.filter, speed(at))).collect()
    }

    /// Returns the angle error for each microsecond by which the two channels are sampled apart. The error is in
    /// electrical degrees, at the entered speed.
    pub fn sampling_skew_deg(&self) -> f64 {
        360.0 * self.here.frequency_hz * 1e-6
    }
}

fn operating_point(periods: u32, filter: InputFilter, speed_rpm: f64) -> OperatingPoint {
    let frequency_hz = signal_frequency_hz(periods, speed_rpm);
    let response = filter.response_at(frequency_hz);
    OperatingPoint { speed_rpm, frequency_hz, response, shaft_deg: response.phase_deg / f64::from(periods.max(1)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn form(periods: &str, speed: &str, resistance: &str, capacitance: &str) -> Form {
        let typed = |text: &str| text.to_owned();
        Form {
            periods: typed(periods),
            speed: typed(speed),
            resistance: typed(resistance),
            capacitance: typed(capacitance),
        }
    }

    /// Rows of section 1: a filter of 10 kΩ and 47 pF at 102.4 kHz, and 1024 periods at 5859.375 rpm. The latter give
    /// 100 kHz and a shaft lag of 1/1024 of the electrical lag.
    #[test]
    fn rows_match_section_1() {
        let rows = [
            ("512", "12000", "47p", 102_400.0, 16.825, 1.496, 0.95719, 17_578.125),
            ("1024", "5859,375", "22p", 100_000.0, 7.870, 0.700, 0.99058, 8_789.062_5),
            ("1024", "5859.375", "47 pF", 100_000.0, 16.452, 1.462, 0.95906, 8_789.062_5),
        ];
        for (periods, speed, farads, frequency, phase, steps, gain, most) in rows {
            let circuit = form(periods, speed, "10k", farads).calculate_circuit().unwrap();
            let OperatingPoint { frequency_hz, response, shaft_deg, .. } = circuit.here;
            assert!((frequency_hz - frequency).abs() < 1e-6 && circuit.is_within_bandwidth(), "{circuit:?}");
            assert!((response.phase_deg - phase).abs() < 6e-4 && (response.gain - gain).abs() < 6e-6, "{circuit:?}");
            assert!((response.lag_in_steps() - steps).abs() < 6e-4, "{circuit:?}");
            assert!((shaft_deg * periods.parse::<f64>().unwrap() - phase).abs() < 6e-4);
            assert!((circuit.most_rpm - most).abs() < 1e-6, "{circuit:?}");
        }
        // 1/(2π · 10 kΩ · 47 pF) = 338.628 kHz; a microsecond at 102.4 kHz is 36.864°.
        let circuit = form("1024", "6000", "10k", "47p").calculate_circuit().unwrap();
        assert!((circuit.corner_hz - 338_627.5).abs() < 0.5, "{circuit:?}");
        assert!((circuit.sampling_skew_deg() - 36.864).abs() < 1e-9);
    }

    #[test]
    fn curve_ends_at_bandwidth() {
        let circuit = form("1024", "9000", "10k", "47p").calculate_circuit().unwrap();
        assert!(!circuit.is_within_bandwidth(), "153.6 kHz");
        let course = circuit.operating_points(10);
        assert_eq!(course.len(), 10);
        assert!((course[0].frequency_hz - 15e3).abs() < 1e-6 && (course[9].frequency_hz - 150e3).abs() < 1e-6);
        // arctan(2π · 150 kHz · 10 kΩ · 47 pF) = 23.8916°
        assert!((course[9].response.phase_deg - 23.8916).abs() < 6e-4, "{:?}", course[9]);
    }

    #[test]
    fn invalid_input_names_its_entry() {
        for (form, id) in [
            (form("0", "6000", "10k", "47p"), "entry.whole"),
            (form("1000001", "6000", "10k", "47p"), "entry.whole"),
            (form("1024", "-1", "10k", "47p"), "entry.number"),
            (form("1024", "NaN", "10k", "47p"), "entry.number"),
            (form("1024", "1000001", "10k", "47p"), "entry.number"),
            (form("1024", "6000", "0", "47p"), "entry.quantity"),
            (form("1024", "6000", "10x", "47p"), "entry.quantity"),
            (form("1024", "6000", "10k", "47"), "entry.quantity"),
            (form("1024", "6000", "10k", ""), "entry.missing"),
        ] {
            assert_eq!(form.calculate_circuit().unwrap_err().id(), id, "{form:?}");
        }
        let still = form("1024", "0", "10k", "47p").calculate_circuit().unwrap();
        assert_eq!((still.here.frequency_hz, still.here.response.phase_deg, still.here.response.gain), (0.0, 0.0, 1.0));
    }
}
