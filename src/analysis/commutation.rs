//! From the position to the electrical angle of a motor: the offset between the two by the manual's two methods. SICK
//! 8010701, commutation; section 5 of the project's sine/cosine reference.

use super::arctan::Phase;

/// An angle inside one electrical period of a motor, as a fraction in units of 2⁻³².
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ElectricalAngle(u32);

/// Motor with an encoder on its shaft.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Motor {
    periods: u32,
    pole_pairs: u32,
}

/// The result of energising a second vector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SecondVector {
    /// Pole pairs by the movement, rounded; 0 if the shaft has moved by more than an electrical turn.
    pub pole_pairs: u32,
    /// The movement divided by the expected one: 1 if all is well, negative if two phases are exchanged.
    pub ratio: f64,
}

impl ElectricalAngle {
    /// Creates an angle from electrical turns; whole turns are dropped. `None` if it is not finite.
    pub fn from_turns(turns: f64) -> Option<Self> {
        const STEPS: f64 = 4_294_967_296.0;
        // 0.999… may round to a whole turn, which is 0.
        Phase::of_periods(turns).map(|phase| ElectricalAngle((phase.periods() * STEPS).round() as u64 as u32))
    }

    /// Creates an angle from the number in the encoder's memory.
    pub const fn from_bits(bits: u32) -> Self {
        ElectricalAngle(bits)
    }

    /// Returns the fraction of an electrical turn in units of 2⁻³².
    pub const fn bits(self) -> u32 {
        self.0
    }

    /// Returns the electrical degrees, 0 to below 360.
    pub fn degrees(self) -> f64 {
        f64::from(self.0) * (360.0 / 4_294_967_296.0)
    }
}

impl Motor {
    /// Creates a motor with signal periods per revolution and pole pairs; `None` if one of them is zero.
    pub const fn new(periods: u32, pole_pairs: u32) -> Option<Self> {
        if periods == 0 || pole_pairs == 0 { None } else { Some(Motor { periods, pole_pairs }) }
    }

    /// Method 1: returns the offset to store, from the fine position in periods at which the shaft rests in a static
    /// vector. `None` if the position is not finite.
    pub fn offset(&self, fine_periods: f64) -> Option<ElectricalAngle> {
        ElectricalAngle::from_turns(f64::from(self.pole_pairs) * self.revolutions(fine_periods))
    }

    /// Returns the electrical angle at a fine position in periods, with the stored offset.
    pub fn electrical_angle(&self, fine_periods: f64, offset: ElectricalAngle) -> Option<ElectricalAngle> {
        self.offset(fine_periods).map(|angle| ElectricalAngle(angle.0.wrapping_sub(offset.0)))
    }

    /// Returns the difference between two neighbouring values of [`position_to_set`], in degrees of the shaft.
    pub fn mechanical_step_deg(&self) -> f64 {
        360.0 / f64::from(self.periods)
    }

    /// Returns the same in electrical degrees: the resolution of method 2. 30° and more make a motor weak or unusable (U).
    pub fn electrical_step_deg(&self) -> f64 {
        self.mechanical_step_deg() * f64::from(self.pole_pairs)
    }

    /// Judges how far the shaft moved, in periods, from one static vector to one that is this many electrical turns ahead
    /// (below ½, or the shaft may take the other way round). `None` if it has not moved or the turns are zero.
    pub fn second_vector(&self, moved_periods: f64, electrical_turns: f64) -> Option<SecondVector> {
        let moved = moved_periods / f64::from(self.periods);
        let ratio = moved * f64::from(self.pole_pairs) / electrical_turns;
        let pole_pairs = (electrical_turns / moved).abs().round();
        let sensible = ratio.is_finite() && ratio != 0.0 && pole_pairs.is_finite();
        sensible.then_some(SecondVector { pole_pairs: pole_pairs as u32, ratio })
    }

    /// Returns the revolutions within one turn: whole ones, multiplied by the pole pairs, would cost digits of the
    /// fraction.
    fn revolutions(&self, periods: f64) -> f64 {
        periods.rem_euclid(f64::from(self.periods)) / f64::from(self.periods)
    }
}

/// Method 2: returns the value for command 43h that makes the present position that of period `period`; its five lower bits
/// are the upper ones of the phase, as the encoder requires. `None` beyond 2²⁷ periods.
pub fn position_to_set(period: u32, phase: Phase) -> Option<u32> {
    if period >> 27 == 0 { Some(period << 5 | phase.step(5)) } else { None }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn phase(periods: f64) -> Phase {
        Phase::of_periods(periods).unwrap()
    }

    #[test]
    fn method_1_matches_section_5() {
        let motor = Motor::new(1024, 4).unwrap();
        let offset = motor.offset(339.02).unwrap();
        assert_eq!(offset.bits(), 0x5305_1EB8);
        assert!((offset.degrees() - 116.746_875).abs() < 1e-7);
        // A tenth of a revolution further, and any number of whole ones.
        for turns in [0.0, 1.0, 4095.0] {
            let angle = motor.electrical_angle(339.02 + 102.4 + 1024.0 * turns, offset).unwrap();
            assert!((angle.degrees() / 360.0 - 0.4).abs() < 1e-8, "{angle:?}");
        }
        assert_eq!(motor.electrical_angle(339.02, offset), Some(ElectricalAngle::default()));
        assert_eq!(motor.offset(f64::NAN), None);
    }

    #[test]
    fn method_2_matches_section_5() {
        assert_eq!(position_to_set(0, phase(0.47)), Some(0x0F));
        assert_eq!(position_to_set(3, phase(0.47)), Some(0x6F));
        assert_eq!(position_to_set(0, phase(0.02)), Some(0));
        assert_eq!(position_to_set(0, phase(0.97)), Some(31));
        assert_eq!(position_to_set(1 << 27, phase(0.0)), None);
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
    fn a_second_vector_yields_pole_pairs_and_phase_order() {
        // A quarter of an electrical turn of four pole pairs is 1/16 revolution: 64 of 1024 periods.
        let motor = Motor::new(1024, 4).unwrap();
        assert_eq!(motor.second_vector(64.0, 0.25), Some(SecondVector { pole_pairs: 4, ratio: 1.0 }));
        let exchanged = motor.second_vector(-64.0, 0.25).unwrap();
        assert_eq!((exchanged.pole_pairs, exchanged.ratio), (4, -1.0));
        assert_eq!(motor.second_vector(128.0, 0.25), Some(SecondVector { pole_pairs: 2, ratio: 2.0 }));
        assert_eq!((motor.second_vector(0.0, 0.25), motor.second_vector(64.0, 0.0)), (None, None));
    }
}
