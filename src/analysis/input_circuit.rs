//! Effect of a drive's input circuit on the signals: the signal frequency at a given speed, and the phase and gain of
//! the input filter. See SICK 8010701, process data channel, and section 1 of the project's sine/cosine reference. The
//! manual names the input resistor in the text, but the feedback resistor in the formula. The relevant resistor is the
//! one in parallel with the capacitor.

use std::f64::consts::TAU;

/// Bandwidth of the process data channel (−3 dB) in hertz.
pub const BANDWIDTH_HZ: f64 = 150_000.0;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InputFilter {
    pub resistance_ohm: f64,
    pub capacitance_f: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilterResponse {
    /// Lag of the output behind the input in electrical degrees, 0 to 90.
    pub phase_deg: f64,
    /// Ratio of the output amplitude to the input amplitude, 0 to 1.
    pub gain: f64,
}

impl InputFilter {
    pub fn response_at(&self, frequency_hz: f64) -> FilterResponse {
        let product = TAU * frequency_hz * self.resistance_ohm * self.capacitance_f;
        FilterResponse { phase_deg: product.atan().to_degrees(), gain: 1.0 / product.hypot(1.0) }
    }
}

impl FilterResponse {
    /// Returns the lag in steps of the absolute position, each of which is 1/32 of a period.
    pub fn lag_in_steps(&self) -> f64 {
        self.phase_deg / 360.0 * 32.0
    }
}

/// Returns the signal frequency in hertz at a speed in revolutions per minute.
pub fn signal_frequency_hz(periods: u32, speed_rpm: f64) -> f64 {
    f64::from(periods) * speed_rpm / 60.0
}

/// Returns the speed in revolutions per minute at which a signal reaches a frequency in hertz. Returns `None` if
/// `periods` is zero.
pub fn speed_rpm_at(periods: u32, frequency_hz: f64) -> Option<f64> {
    if periods == 0 { None } else { Some(frequency_hz * 60.0 / f64::from(periods)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn filters_match_section_1() {
        let rows = [
            (100e3, 22e-12, 7.870, 0.700, 0.99058),
            (100e3, 47e-12, 16.452, 1.462, 0.95906),
            (102.4e3, 47e-12, 16.825, 1.496, 0.95719),
        ];
        for (frequency, capacitance_f, phase, steps, gain) in rows {
            let response = InputFilter { resistance_ohm: 10e3, capacitance_f }.response_at(frequency);
            assert!((response.phase_deg - phase).abs() < 6e-4, "{response:?}");
            assert!((response.lag_in_steps() - steps).abs() < 6e-4, "{response:?}");
            assert!((response.gain - gain).abs() < 6e-6, "{response:?}");
        }
    }

    #[test]
    fn frequencies_match_sections_1_and_8() {
        let rows =
            [(512, 12_000.0, 102_400.0), (1024, 6000.0, 102_400.0), (128, 12_000.0, 25_600.0), (16, 12_000.0, 3200.0)];
        for (periods, rpm, hertz) in rows {
            assert_eq!(signal_frequency_hz(periods, rpm), hertz);
        }
        for (periods, rpm) in [(16, 562_500.0), (128, 70_312.5), (512, 17_578.125), (1024, 8_789.062_5)] {
            assert_eq!(speed_rpm_at(periods, BANDWIDTH_HZ), Some(rpm));
        }
        assert_eq!(speed_rpm_at(0, BANDWIDTH_HZ), None);
    }
}
