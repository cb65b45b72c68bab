//! Offset between the shaft position and the electrical angle of a motor, determined by the two methods of the manual.
//! See SICK 8010701, commutation, and section 5 of the project's sine/cosine reference.

use super::arctan::Phase;

/// Angle within one electrical period of a motor, in units of 2⁻³² of the period.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ElectricalAngle(u32);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Motor {
    periods: u32,
    pole_pairs: u32,
}

/// Result of moving the shaft from one static vector to a second one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SecondVectorResult {
    /// Number of pole pairs derived from the movement, rounded. 0 if the shaft has moved by more than an electrical
    /// turn.
    pub pole_pairs: u32,
    /// Ratio of the actual to the expected movement: 1 if the movement is as expected, and negative if two phases are
    /// exchanged.
    pub ratio: f64,
}

impl ElectricalAngle {
    /// Creates an angle from electrical turns, ignoring whole turns. Returns `None` if the number is not finite.
    pub fn from_turns(turns: f64) -> Option<Self> {
        const STEPS: f64 = 4_294_967_296.0;
        // 0.999… may round to a whole turn, which is equivalent to 0.
        Phase::from_periods(turns).map(|phase| ElectricalAngle((phase.to_periods() * STEPS).round() as u64 as u32))
    }

    /// Creates an angle from the number stored in the encoder's memory.
    pub const fn from_bits(bits: u32) -> Self {
        ElectricalAngle(bits)
    }

    /// Returns the fraction of an electrical turn in units of 2⁻³².
    pub const fn bits(self) -> u32 {
        self.0
    }

    /// Returns the angle in electrical degrees, from 0 to below 360.
    pub fn to_degrees(self) -> f64 {
        f64::from(self.0) * (360.0 / 4_294_967_296.0)
    }
}

impl Motor {
    /// Creates a motor from its signal periods per revolution and its pole pairs. Returns `None` if either is zero.
    pub const fn new(periods: u32, pole_pairs: u32) -> Option<Self> {
        if periods == 0 || pole_pairs == 0 { None } else { Some(Motor { periods, pole_pairs }) }
    }

    /// Returns the offset to store (method 1). `fine_periods` is the fine position, in periods, at which a static
    /// vector holds the shaft. Returns `None` if the position is not finite.
    pub fn offset(&self, fine_periods: f64) -> Option<ElectricalAngle> {
        ElectricalAngle::from_turns(f64::from(self.pole_pairs) * self.revolutions_from_periods(fine_periods))
    }

    /// Returns the electrical angle for a fine position in periods and the stored offset.
    pub fn electrical_angle(&self, fine_periods: f64, offset: ElectricalAngle) -> Option<ElectricalAngle> {
        self.offset(fine_periods).map(|angle| ElectricalAngle(angle.0.wrapping_sub(offset.0)))
    }

    /// Returns the difference between two neighbouring values of [`preset_position`], in degrees of shaft rotation.
    pub fn mechanical_step_deg(&self) -> f64 {
        360.0 / f64::from(self.periods)
    }

    /// Returns the resolution of method 2 in electrical degrees. At 30° or more, the motor is weak or unusable (U).
    pub fn electrical_step_deg(&self) -> f64 {
        self.mechanical_step_deg() * f64::from(self.pole_pairs)
    }

    /// Evaluates the shaft's movement, in periods, from one static vector to another that is `electrical_turns` ahead.
    /// `electrical_turns` must be below ½, because the shaft may otherwise turn in the opposite direction. Returns
    /// `None` if the shaft has not moved or the distance is zero.
    pub fn second_vector(&self, moved_periods: f64, electrical_turns: f64) -> Option<SecondVectorResult> {
        let moved = moved_periods / f64::from(self.periods);
        let ratio = moved * f64::from(self.pole_pairs) / electrical_turns;
        let pole_pairs = (electrical_turns / moved).abs().round();
        let sensible = ratio.is_finite() && ratio != 0.0 && pole_pairs.is_finite();
        sensible.then_some(SecondVectorResult { pole_pairs: pole_pairs as u32, ratio })
    }

    /// Converts periods to revolutions and drops the whole revolutions. They are dropped first, because they would
    /// reduce the precision of the fraction.
    fn revolutions_from_periods(&self, periods: f64) -> f64 {
        periods.rem_euclid(f64::from(self.periods)) / f64::from(self.periods)
    }
}

/// Returns the position to set with command 43h so that the shaft is in period `period` (method 2). The lowest five
/// bits are the upper bits of the phase, as the encoder requires. Returns `None` beyond 2²⁷ periods.
pub fn preset_position(period: u32, phase: Phase) -> Option<u32> {
    if period >> 27 == 0 { Some(period << 5 | phase.step(5)) } else { None }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn phase(periods: f64) -> Phase {
        Phase::from_periods(periods).unwrap()
    }

    #[test]
    fn method_1_matches_section_5() {
        let motor = Motor::new(1024, 4).unwrap();
        let offset = motor.offset(339.02).unwrap();
        assert_eq!(offset.bits(), 0x5305_1EB8);
        assert!((offset.to_degrees() - 116.746_875).abs() < 1e-7);
        // A movement of a tenth of a revolution, plus any number of whole revolutions.
        for turns in [0.0, 1.0, 4095.0] {
            let angle = motor.electrical_angle(339.02 + 102.4 + 1024.0 * turns, offset).unwrap();
            assert!((angle.to_degrees() / 360.0 - 0.4).abs() < 1e-8, "{angle:?}");
        }
        assert_eq!(motor.electrical_angle(339.02, offset), Some(ElectricalAngle::default()));
        assert_eq!(motor.offset(f64::NAN), None);
    }

    #[test]
    fn method_2_matches_section_5() {
        assert_eq!(preset_position(0, phase(0.47)), Some(0x0F));
        assert_eq!(preset_position(3, phase(0.47)), Some(0x6F));
        assert_eq!(preset_position(0, phase(0.02)), Some(0));
        assert_eq!(preset_position(0, phase(0.97)), Some(31));
        assert_eq!(preset_position(1 << 27, phase(0.0)), None);
        let rows = [
            (16, 5, 22.5, 112.5),
            (128, 5, 2.8125, 14.0625),
            (512, 4, 0.703_125, 2.8125),
            (1024, 4, 0.351_562_5, 1.406_25),
        ];
        for (periods, pairs, mechanical, electrical) in rows {
            let motor = Motor::new(periods, pairs).unwrap();
            assert_eq!((motor.mechanical_step_deg(), motor.electrical_step_deg()), (mechanical, electrical));
        }
        assert_eq!((Motor::new(0, 4), Motor::new(4, 0)), (None, None));
    }

    #[test]
    fn second_vector_yields_pole_pairs() {
        // With four pole pairs, a quarter of an electrical turn is 1/16 revolution: 64 of 1024 periods.
        let motor = Motor::new(1024, 4).unwrap();
        assert_eq!(motor.second_vector(64.0, 0.25), Some(SecondVectorResult { pole_pairs: 4, ratio: 1.0 }));
        let exchanged = motor.second_vector(-64.0, 0.25).unwrap();
        assert_eq!((exchanged.pole_pairs, exchanged.ratio), (4, -1.0));
        assert_eq!(motor.second_vector(128.0, 0.25), Some(SecondVectorResult { pole_pairs: 2, ratio: 2.0 }));
        assert_eq!((motor.second_vector(0.0, 0.25), motor.second_vector(64.0, 0.0)), (None, None));
    }
}
