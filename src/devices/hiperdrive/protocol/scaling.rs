//! Conversion between steps, turns, millimetres and rpm, based on parameters 154 to 164 (reference, section 5).

/// Scale that converts transmitted steps to turns. A turn has 256 · numerator / denominator steps. The formula in
/// section 8.4 of the manual is garbled.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct PositionScale {
    numerator: u16,
    denominator: u16,
}

/// Scale that converts a transmitted speed to rpm. A speed of 1 rpm is transmitted as numerator / denominator.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct SpeedScale {
    numerator: u16,
    denominator: u16,
}

/// A length, exact to the nanometre.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Length {
    /// Number of nanometres.
    pub nanometres: u64,
}

/// Drive family, which determines how many turns the drive can make in either direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Family {
    /// HDA30 and HDA45. HRA is assumed to belong to this family (`U`).
    Short,
    /// HDA70.
    Long,
    /// PSE441, included for comparison.
    Pse441,
}

/// Reason why a scale cannot be used.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ScaleError {
    /// The numerator or the denominator is 0.
    #[error("numerator and denominator of the scaling must be from 1 to 65535, not 0")]
    Zero,
    /// The pitch or the step size is 0.
    #[error("the spindle pitch and the step size must be greater than 0")]
    NoLength,
    /// The numerator or the denominator would exceed 16 bits.
    #[error(
        "the scaling would be {numerator}/{denominator} for {steps} steps: choose a step size for which neither \
         exceeds 65535"
    )]
    TooFine {
        /// Steps per turn, rounded.
        steps: u64,
        /// Numerator in lowest terms.
        numerator: u64,
        /// Denominator in lowest terms.
        denominator: u64,
    },
}

/// Number of steps per turn at a scale of 1/1.
const UNIT: i64 = 256;

impl PositionScale {
    /// Factory scale of 256/1, which gives 65536 steps per turn.
    pub const FACTORY: PositionScale = PositionScale { numerator: 256, denominator: 1 };

    /// Creates a scale from parameters 154 and 156.
    ///
    /// # Errors
    /// Returns [`ScaleError::Zero`] if either parameter is 0.
    pub const fn new(numerator: u16, denominator: u16) -> Result<Self, ScaleError> {
        match (numerator, denominator) {
            (0, _) | (_, 0) => Err(ScaleError::Zero),
            _ => Ok(PositionScale { numerator, denominator }),
        }
    }

    /// Returns the scale that gives a step the required length on a spindle with this pitch. If a turn has a whole
    /// number of steps, the numerator is that number and the denominator 256, where possible.
    ///
    /// # Errors
    /// Returns [`ScaleError`] if either length is 0, or if no scale yields exactly this step.
    pub fn for_spindle(pitch: Length, step: Length) -> Result<Self, ScaleError> {
        let (pitch, step) = (pitch.nanometres, step.nanometres);
        if pitch == 0 || step == 0 {
            return Err(ScaleError::NoLength);
        }
        let exact = |numerator: u64, denominator: u64| {
            Some(PositionScale { numerator: numerator.try_into().ok()?, denominator: denominator.try_into().ok()? })
        };
        let whole = pitch.is_multiple_of(step).then(|| exact(pitch / step, UNIT.unsigned_abs())).flatten();
        // Steps per turn are pitch / step, and the scale is 1/256 of them.
        let divisor = gcd(pitch, step.saturating_mul(UNIT.unsigned_abs()));
        let (numerator, denominator) = (pitch / divisor, step.saturating_mul(UNIT.unsigned_abs()) / divisor);
        let steps = pitch.saturating_add(step / 2) / step;
        whole.or_else(|| exact(numerator, denominator)).ok_or(ScaleError::TooFine { steps, numerator, denominator })
    }

    /// Returns the numerator, parameter 154.
    pub const fn numerator(self) -> u16 {
        self.numerator
    }

    /// Returns the denominator, parameter 156.
    pub const fn denominator(self) -> u16 {
        self.denominator
    }

    /// Returns the number of steps per turn, which may be fractional.
    pub fn steps_per_turn(self) -> f64 {
        256.0 * f64::from(self.numerator) / f64::from(self.denominator)
    }

    /// Converts degrees to steps, rounded up to at least 1.
    pub fn degrees_to_steps(self, degrees: f64) -> u32 {
        // The float cast saturates at the limits of the type.
        (self.steps_per_turn() * degrees / 360.0).ceil().max(1.0) as u32
    }

    /// Converts turns to steps, rounded towards 0. Returns `None` if the result exceeds 32 bits.
    pub fn steps_of_turns(self, turns: i32) -> Option<i32> {
        i32::try_from(self.integer_steps(turns)).ok()
    }

    /// Converts turns to steps, rounded towards 0, without a 32-bit limit.
    pub fn integer_steps(self, turns: i32) -> i64 {
        i64::from(turns) * UNIT * i64::from(self.numerator) / i64::from(self.denominator)
    }

    /// Converts steps to turns.
    pub fn to_turns(self, steps: i32) -> f64 {
        f64::from(steps) / self.steps_per_turn()
    }

    /// Converts steps to millimetres for a spindle of the given pitch.
    pub fn to_millimetres(self, steps: i32, pitch: Length) -> f64 {
        self.to_turns(steps) * pitch.nanometres as f64 / 1e6
    }
}

impl SpeedScale {
    /// Factory scale of 10/1, which transmits the speed in tenths of rpm.
    pub const FACTORY: SpeedScale = SpeedScale { numerator: 10, denominator: 1 };

    /// Creates a scale from parameters 162 and 164.
    ///
    /// # Errors
    /// Returns [`ScaleError::Zero`] if either parameter is 0.
    pub const fn new(numerator: u16, denominator: u16) -> Result<Self, ScaleError> {
        match (numerator, denominator) {
            (0, _) | (_, 0) => Err(ScaleError::Zero),
            _ => Ok(SpeedScale { numerator, denominator }),
        }
    }

    /// Converts a transmitted speed to rpm.
    pub fn rpm(self, speed: i16) -> f64 {
        f64::from(speed) * f64::from(self.denominator) / f64::from(self.numerator)
    }

    /// Converts rpm to the nearest speed that can be transmitted in 16 bits.
    pub fn speed(self, rpm: f64) -> i16 {
        // The float cast saturates at the limits of the type.
        (rpm * f64::from(self.numerator) / f64::from(self.denominator)).round() as i16
    }
}

impl Family {
    /// Returns the maximum number of turns in either direction.
    pub const fn max_turns(self) -> i32 {
        match self {
            Family::Short => 512,
            Family::Long => 16000,
            Family::Pse441 => 127,
        }
    }

    /// Returns the number of turns in either direction to which parameters 158 and 160 are set at the factory.
    pub const fn factory_turns(self) -> i32 {
        match self {
            Family::Short => 511,
            Family::Long => 16000,
            Family::Pse441 => 127,
        }
    }
}

/// Splits a position at 65536 steps per turn into whole turns and steps within the turn. Position −1 is in turn −1.
pub const fn to_turns_and_steps(position: i32) -> (i16, u16) {
    ((position >> 16) as i16, position as u16)
}

/// Rounds a position to a value that parameter 198 accepts: the nearest multiple of 64, away from 0 in a tie (`U`: not
/// documented). Returns `None` if the result exceeds 32 bits.
pub fn nearest_reference(position: i32) -> Option<i32> {
    const REFERENCE_GRID: i64 = 64;
    let position = i64::from(position);
    let rounded = (position.abs() + REFERENCE_GRID / 2) / REFERENCE_GRID * REFERENCE_GRID * position.signum();
    i32::try_from(rounded).ok()
}

/// Returns the torque that the drive applies: the percentage rounded up to a multiple of 25 %.
pub const fn effective_torque(percent: u8) -> u8 {
    percent.div_ceil(25).saturating_mul(25)
}

const fn gcd(mut one: u64, mut other: u64) -> u64 {
    while other != 0 {
        (one, other) = (other, one % other);
    }
    one
}
