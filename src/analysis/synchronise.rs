//! Combines the absolute position of the parameter channel with the angle of the analogue signals into one fine
//! position. See SICK 8010701, forming the absolute position, and section 4 of the project's sine/cosine reference.
//!
//! Both positions resolve 1/32 of a period. The coarse value is corrected by at most one period towards the smaller
//! difference, which tolerates half a period of drift and delay. The manual does not define the offset between the two
//! zero points (U). It can be set or [measured](measure_offset).

use std::f64::consts::TAU;

use super::arctan::Phase;
use super::quality::Verdict;

/// Number of absolute position steps per period.
pub const STEPS: u64 = 32;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Synchroniser {
    /// Number of periods in the whole range, at least 1: the periods per revolution times the number of revolutions.
    pub periods: u64,
    /// Amount by which a correct absolute position leads the analogue position, in steps of 1/32 period, or 0 if
    /// unknown.
    pub offset_steps: f64,
    /// Whether the absolute position refers to the middle of its step instead of the beginning.
    pub half_step: bool,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SynchronisedPosition {
    /// Number of whole periods, always less than the number in the range.
    pub period: u64,
    pub phase: Phase,
    /// Correction of the absolute position in periods: −1, 0 or 1.
    pub correction: i8,
    pub residual_periods: f64,
    /// Verdict on the difference between the positions. Above 8/32 of a period it is a warning (the encoder's own drift
    /// is up to 4/32), and above 14/32 a fault (U).
    pub verdict: Verdict,
}

/// The positions differ by exactly half a period, so either neighbouring period could be the correct one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("absolute and analogue position are half a period apart")]
pub struct AmbiguousPeriodError;

impl Synchroniser {
    /// Largest difference between the positions, in steps of 1/32 period, that is not a fault (U).
    pub const MAX_STEPS: f64 = 14.0;

    pub fn new(periods: u64) -> Self {
        Synchroniser { periods: periods.max(1), offset_steps: 0.0, half_step: false }
    }

    /// Combines an absolute position in steps of 1/32 period with an analogue phase.
    ///
    /// # Errors
    /// Returns an [`AmbiguousPeriodError`] if the positions differ by exactly half a period.
    pub fn combine(&self, absolute: u64, phase: Phase) -> Result<SynchronisedPosition, AmbiguousPeriodError> {
        /// Tolerance in steps for rounding at half a period.
        const ROUNDING_TOLERANCE: f64 = 1e-9;
        let half = if self.half_step { 0.5 } else { 0.0 };
        let low = (absolute % STEPS) as f64 + half - self.offset_steps;
        let difference = low - STEPS as f64 * phase.to_periods();
        // The offset may add several periods to the difference. Only the last period is uncertain.
        let periods = difference / STEPS as f64;
        let nearest = periods.round();
        let residual = periods - nearest;
        if (residual.abs() - 0.5).abs() * (STEPS as f64) < ROUNDING_TOLERANCE || !residual.is_finite() {
            return Err(AmbiguousPeriodError);
        }
        let range = self.periods.max(1);
        let forward = (nearest as i64).rem_euclid(i64::try_from(range).unwrap_or(i64::MAX)).unsigned_abs();
        let period = ((u128::from(absolute / STEPS) + u128::from(forward)) % u128::from(range)) as u64;
        let off = residual.abs() * STEPS as f64;
        let verdict = match off {
            off if off > Self::MAX_STEPS => Verdict::Fault,
            off if off > 8.0 => Verdict::Warn,
            _ => Verdict::Ok,
        };
        Ok(SynchronisedPosition { period, phase, correction: nearest as i8, residual_periods: residual, verdict })
    }

    /// Returns the fine position from a phase and a quadrature counter, which counts quarters of a period.
    pub fn with_quadrature(&self, quarters: u64, phase: Phase) -> (u64, Phase) {
        let nearest = (((quarters % 4) as f64 + 0.5) / 4.0 - phase.to_periods()).round();
        let range = u128::from(self.periods.max(1));
        // `nearest` is −1, 0 or 1. Adding the range once keeps the sum positive.
        let period = (u128::from(quarters / 4) + range).saturating_add_signed(nearest as i128) % range;
        (period as u64, phase)
    }
}

impl SynchronisedPosition {
    pub fn periods(&self) -> f64 {
        self.period as f64 + self.phase.to_periods()
    }

    /// Returns the fine position with 2^`bits` steps per period, where `bits` is at most 32.
    pub fn steps_per_period(&self, bits: u32) -> u128 {
        (u128::from(self.period) << bits.min(32)) + u128::from(self.phase.step(bits))
    }
}

/// Returns the average lead of the absolute position in steps of 1/32 period, from samples over at least one turn.
/// Differences are averaged as angles, where 31 steps equal −1. Returns `None` without samples, or if the differences
/// cancel each other out.
pub fn measure_offset(samples: impl IntoIterator<Item = (u64, Phase)>) -> Option<f64> {
    let (mut sine, mut cosine, mut count) = (0.0, 0.0, 0_usize);
    for (absolute, phase) in samples {
        let angle = TAU * ((absolute % STEPS) as f64 / STEPS as f64 - phase.to_periods());
        sine += angle.sin();
        cosine += angle.cos();
        count += 1;
    }
    let sure = f64::hypot(sine, cosine) > 0.1 * count as f64;
    (count > 0 && sure).then(|| sine.atan2(cosine) / TAU * STEPS as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn phase(periods: f64) -> Phase {
        Phase::from_periods(periods).unwrap()
    }

    /// Results match the table of section 4: periods in the range, A, φ, k, fine position, residual, verdict.
    #[test]
    fn cases_match_section_4() {
        use Verdict::{Fault, Ok, Warn};
        let rows = [
            ("SKM36", 128 * 4096, 0x000E_0531, 0.5375, 0, 28_713.537_5, -0.0062, Ok),
            ("lag", 1024, 0x2A5F, 0.02, 1, 339.02, -0.0512, Ok),
            ("lead", 1024, 0x2A40, 0.97, -1, 337.97, 0.03, Ok),
            ("mid", 1024, 0x2A4F, 0.47, 0, 338.47, -0.0013, Ok),
            ("end of a revolution", 1024, 0x7FFF, 0.03, 1, 0.03, -0.0612, Ok),
            ("start of a revolution", 1024, 0x0000, 0.96, -1, 1023.96, 0.04, Ok),
            ("warn", 1024, 0x2A47, 0.47, 0, 338.47, -0.2513, Warn),
            ("limit", 16, 0, 0.49, 0, 0.49, -0.49, Fault),
            ("past the limit", 16, 0, 0.51, -1, 15.51, 0.49, Fault),
        ];
        for (label, periods, absolute, phi, k, fine, residual, verdict) in rows {
            let told = Synchroniser::new(periods).combine(absolute, phase(phi)).unwrap();
            assert_eq!((told.correction, told.verdict), (k, verdict), "{label}: {told:?}");
            assert!((told.periods() - fine).abs() < 1e-9, "{label}: {told:?}");
            assert!((told.residual_periods - residual).abs() < 6e-5, "{label}: {told:?}");
        }
        assert_eq!(Synchroniser::new(16).combine(0, phase(0.5)), Err(AmbiguousPeriodError));
    }

    #[test]
    fn interpolates_to_sixteen_bits() {
        let told = Synchroniser::new(1024).combine(0x2A5F, phase(0.02)).unwrap();
        assert_eq!(told.steps_per_period(16), 0x0153_051E);
        let degrees = told.steps_per_period(16) as f64 * 360.0 / (1024.0 * 65_536.0);
        assert!((degrees - 119.186_715).abs() < 5e-7, "{degrees}");
    }

    #[test]
    fn counters_match_section_4() {
        let rows = [(43, 0.76, 10), (44, 0.98, 10), (43, 0.02, 11), (45, 0.26, 11), (45, 0.24, 11), (0, 0.98, 1023)];
        for (quarters, phi, period) in rows {
            assert_eq!(
                Synchroniser::new(1024).with_quadrature(quarters, phase(phi)),
                (period, phase(phi)),
                "{quarters}"
            );
        }
    }

    /// The true position is reconstructed throughout the range if every delay is below half a period.
    #[test]
    fn corrects_drift_below_half_period() {
        let synchroniser = Synchroniser { half_step: true, ..Synchroniser::new(64) };
        for step in 0..64 * 100 {
            let fine = f64::from(step) / 100.0;
            for drift in [-0.48, -0.2, 0.0, 0.2, 0.48] {
                let absolute = ((fine + drift).rem_euclid(64.0) * 32.0) as u64;
                let told = synchroniser.combine(absolute, phase(fine)).unwrap();
                assert!((told.periods() - fine).abs() < 1e-9, "{fine} {drift}: {told:?}");
                assert!((told.residual_periods - drift).abs() <= 0.5 / 32.0 + 1e-9, "{fine} {drift}: {told:?}");
            }
        }
    }

    #[test]
    fn corrects_fixed_offset() {
        let pairs: Vec<(u64, Phase)> = (0..5000)
            .map(|step| {
                let fine = f64::from(step) * 0.0127;
                (((fine + 0.55).rem_euclid(64.0) * 32.0) as u64, phase(fine))
            })
            .collect();
        let offset = measure_offset(pairs.iter().copied()).unwrap();
        // 0.55 periods are 17.6 steps, which equal −14.4 steps. Rounding down subtracts half a step on average.
        assert!((offset - -14.9).abs() < 0.05, "{offset}");
        let synchroniser = Synchroniser { offset_steps: offset, ..Synchroniser::new(64) };
        for (absolute, phase) in pairs {
            let told = synchroniser.combine(absolute, phase).unwrap();
            assert!(told.residual_periods.abs() < 0.02, "{told:?}");
        }
        assert_eq!(measure_offset([]), None);
    }
}
