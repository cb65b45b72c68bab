//! Signal quality of sine and cosine: the length of the amplitude vector √(sin² + cos²), the offsets, the gain ratio
//! and the phase error, each compared with its limits. Amplitude limits are from SICK 8010701. All other limits are
//! assumptions (U) from section 2 of the project's sine/cosine reference and can be changed here.

use super::ellipse::Ellipse;
use crate::units::SupplyVoltage;

/// Verdict on a signal, ordered from good to bad.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    Ok,
    /// The signal is outside its limits, but the position is still correct.
    Warn,
    /// The signal is far outside its limits. A wire is broken, or the angle is wrong.
    Fault,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Minimum and maximum good amplitude (peak, differential) in volts.
    pub ok_v: (f64, f64),
    /// Amplitude limits in volts outside which the signal is faulty.
    pub fault_v: (f64, f64),
    /// Largest offset as a fraction of the amplitude.
    pub offset: f64,
    /// Minimum and maximum gain ratio.
    pub gain_ratio: (f64, f64),
    pub phase_deg: f64,
    /// Largest RMS deviation from the ellipse as a fraction of the amplitude.
    pub residual: f64,
    /// Minimum and maximum mean level of REFSIN and REFCOS in volts.
    pub level_v: (f64, f64),
}

/// Encoder family with known signal limits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Family {
    #[default]
    Hiperface,
    /// AFS60 and AFM60 encoders with sine and cosine.
    AfsAfm60,
    Ttk70,
}

impl Family {
    pub const ALL: [Family; 3] = [Family::Hiperface, Family::AfsAfm60, Family::Ttk70];

    pub const fn name(self) -> &'static str {
        match self {
            Family::Hiperface => "HIPERFACE",
            Family::AfsAfm60 => "AFS/AFM60",
            Family::Ttk70 => "TTK70",
        }
    }

    /// Returns the supply voltage of the family's encoders. The source is the HIPERFACE description 8010701, except for
    /// AFS and AFM60 encoders with sine and cosine (4.5 V to 5.5 V).
    pub const fn supply_voltage(self) -> SupplyVoltage {
        match self {
            Family::Hiperface | Family::Ttk70 => SupplyVoltage { least: 7_000, nominal: 8_000, greatest: 12_000 },
            Family::AfsAfm60 => SupplyVoltage { least: 4_500, nominal: 5_000, greatest: 5_500 },
        }
    }

    pub const fn limits(self) -> Limits {
        match self {
            Family::Hiperface => Limits::HIPERFACE,
            Family::AfsAfm60 => Limits::AFS_AFM60,
            Family::Ttk70 => Limits::TTK70,
        }
    }
}

/// A quantity that is outside its limits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum QualityFinding {
    /// The amplitude of a channel is outside its limits. If both are, the worse one is reported.
    Amplitude {
        /// Peak amplitude found, in volts.
        volts: f64,
        /// Minimum and maximum good amplitude in volts.
        ok_v: (f64, f64),
        verdict: Verdict,
    },
    OffsetSine(f64),
    OffsetCosine(f64),
    GainRatio(f64),
    PhaseError(f64),
    /// RMS distance of the samples from the ellipse, relative to the amplitude. It is caused by noise, interference and
    /// harmonics.
    Residual(f64),
}

/// Tolerance of the limits, so that rounding does not move a value at a limit beyond it.
const ROUNDING_TOLERANCE: f64 = 1e-9;

impl Limits {
    /// Limits for HIPERFACE: 0.9 V to 1.1 V peak to peak, mean level 2.0 V to 3.0 V.
    pub const HIPERFACE: Limits = Limits {
        ok_v: (0.45, 0.55),
        fault_v: (0.30, 0.70),
        offset: 0.05,
        gain_ratio: (0.9, 1.1),
        phase_deg: 5.0,
        residual: 0.02,
        level_v: (2.0, 3.0),
    };

    /// Limits for AFS/AFM60: 0.8 V to 1.2 V peak to peak, mean level 2.5 V ± 10 %.
    pub const AFS_AFM60: Limits = Limits { ok_v: (0.40, 0.60), level_v: (2.25, 2.75), ..Limits::HIPERFACE };

    /// Limits for TTK70: 0.9 V to 1.1 V peak to peak, mean level 2.5 V ± 5 %.
    pub const TTK70: Limits = Limits { level_v: (2.375, 2.625), ..Limits::HIPERFACE };

    /// Returns the verdict on the length of one amplitude vector. A single vector also contains offset and gain errors,
    /// so use the minimum and maximum over a period. Returns `None` without a signal.
    pub fn vector_verdict(&self, sine: f64, cosine: f64) -> Option<Verdict> {
        let length = sine.hypot(cosine);
        if length.is_nan() || length == 0.0 { None } else { Some(self.amplitude_verdict(length)) }
    }

    /// Returns the verdict on a peak amplitude in volts.
    pub fn amplitude_verdict(&self, volts: f64) -> Verdict {
        if is_within(volts, self.ok_v) {
            Verdict::Ok
        } else if is_within(volts, self.fault_v) {
            Verdict::Warn
        } else {
            Verdict::Fault
        }
    }

    /// Returns the quantities of an ellipse that are outside their limits, in the order of section 2 of the project's
    /// sine/cosine reference. `residual_rms` is relative to the amplitude.
    pub fn check_ellipse(&self, ellipse: &Ellipse, residual_rms: f64) -> Vec<QualityFinding> {
        let amplitude = ellipse.amplitude_v;
        let worst = [amplitude, ellipse.amplitude_sine_v()].map(|volts| (self.amplitude_verdict(volts), volts));
        let (verdict, volts) = if worst[1].0 > worst[0].0 { worst[1] } else { worst[0] };
        let offsets = [ellipse.offset_sine_v / amplitude, ellipse.offset_cosine_v / amplitude];
        let beyond = |value: f64, limit: f64| !is_within(value, (-limit, limit));
        [
            (verdict != Verdict::Ok, QualityFinding::Amplitude { volts, ok_v: self.ok_v, verdict }),
            (beyond(offsets[0], self.offset), QualityFinding::OffsetSine(offsets[0])),
            (beyond(offsets[1], self.offset), QualityFinding::OffsetCosine(offsets[1])),
            (!is_within(ellipse.gain_ratio, self.gain_ratio), QualityFinding::GainRatio(ellipse.gain_ratio)),
            (beyond(ellipse.phase_error_deg(), self.phase_deg), QualityFinding::PhaseError(ellipse.phase_error_deg())),
            (beyond(residual_rms, self.residual), QualityFinding::Residual(residual_rms)),
        ]
        .into_iter()
        .filter_map(|(out, finding)| out.then_some(finding))
        .collect()
    }
}

pub(super) fn is_within(value: f64, (least, most): (f64, f64)) -> bool {
    value >= least - ROUNDING_TOLERANCE && value <= most + ROUNDING_TOLERANCE
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn amplitudes_match_section_8() {
        let limits = Limits::HIPERFACE;
        let cases = [
            (0.45, 0.0, Some(Verdict::Ok)),
            (0.44, 0.0, Some(Verdict::Warn)),
            (0.25, 0.0, Some(Verdict::Fault)),
            (0.0, 0.0, None),
            (0.33, -0.44, Some(Verdict::Ok)),
            (0.0, -0.7, Some(Verdict::Warn)),
            (0.5, 0.5, Some(Verdict::Fault)),
            (f64::NAN, 0.5, None),
        ];
        for (sine, cosine, expected) in cases {
            assert_eq!(limits.vector_verdict(sine, cosine), expected, "{sine} {cosine}");
        }
        assert_eq!(Limits::AFS_AFM60.vector_verdict(0.0, 0.4), Some(Verdict::Ok));
        assert_eq!(Limits::TTK70.vector_verdict(0.0, 0.4), Some(Verdict::Warn));
    }

    /// The levels match section 1 of the project's sine/cosine reference.
    #[test]
    fn families_have_mean_levels() {
        let levels = Family::ALL.map(|family| (family.name(), family.limits().level_v));
        let expected = [("HIPERFACE", (2.0, 3.0)), ("AFS/AFM60", (2.25, 2.75)), ("TTK70", (2.375, 2.625))];
        assert_eq!(levels, expected);
    }

    #[test]
    fn checks_ellipse_parameters_against_limits() {
        let good = Ellipse {
            amplitude_v: 0.5,
            offset_cosine_v: 0.025,
            offset_sine_v: -0.025,
            gain_ratio: 1.1,
            phase_error_rad: -5.0_f64.to_radians(),
        };
        let limits = Limits::HIPERFACE;
        assert_eq!(limits.check_ellipse(&good, 0.02), []);
        let bad = Ellipse { amplitude_v: 0.5, gain_ratio: 2.0, offset_sine_v: 0.03, ..good };
        let amplitude = QualityFinding::Amplitude { volts: 0.25, ok_v: (0.45, 0.55), verdict: Verdict::Fault };
        let expected = [
            amplitude,
            QualityFinding::OffsetSine(0.06),
            QualityFinding::GainRatio(2.0),
            QualityFinding::Residual(0.03),
        ];
        assert_eq!(limits.check_ellipse(&bad, 0.03), expected);
    }
}
