//! Steps, turns, millimetres and rpm: how parameters 154 to 164 scale what is sent (reference 5).

/// Steps as they are sent ↔ turns: 256 · numerator / denominator steps a turn (the manual's formula 8.4 is garbled).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct PositionScale {
    numerator: u16,
    denominator: u16,
}

/// Speed as it is sent ↔ rpm: numerator / denominator for 1 rpm.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct SpeedScale {
    numerator: u16,
    denominator: u16,
}

/// A length, exact to the nanometre.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Length {
    /// How many.
    pub nanometres: u64,
}

/// How far a drive turns either way.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Family {
    /// HDA30, HDA45; HRA (`U`).
    Short,
    /// HDA70.
    Long,
    /// PSE441, for comparison.
    Pse441,
}

/// Why a scale cannot be.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ScaleError {
    /// A numerator or denominator is 0.
    #[error("a scale cannot have a 0 in it: numerator and denominator are 1 to 65535")]
    Zero,
    /// The pitch or the step is 0.
    #[error("a spindle has a pitch and a step above 0")]
    NoLength,
    /// Numerator or denominator would be too large.
    #[error(
        "the pitch is {steps} steps, which needs {numerator}/{denominator}; both may be up to 65535: choose another step"
    )]
    TooFine {
        /// Steps a turn, rounded.
        steps: u64,
        /// In lowest terms.
        numerator: u64,
        /// In lowest terms.
        denominator: u64,
    },
}

/// Steps a turn with a scale of 1/1.
const UNIT: i64 = 256;

impl PositionScale {
    /// 256/1: 65536 steps a turn.
    pub const FACTORY: PositionScale = PositionScale { numerator: 256, denominator: 1 };

    /// Of parameters 154 and 156.
    ///
    /// # Errors
    /// [`ScaleError::Zero`].
    pub const fn new(numerator: u16, denominator: u16) -> Result<Self, ScaleError> {
        match (numerator, denominator) {
            (0, _) | (_, 0) => Err(ScaleError::Zero),
            _ => Ok(PositionScale { numerator, denominator }),
        }
    }

    /// The scale with which a step is a certain length on a spindle of this pitch. Where a turn has whole steps, numerator is
    /// their number and denominator 256, if that is possible.
    ///
    /// # Errors
    /// [`ScaleError`] where either is 0, or no scale has exactly this step.
    pub fn for_spindle(pitch: Length, step: Length) -> Result<Self, ScaleError> {
        let (pitch, step) = (pitch.nanometres, step.nanometres);
        if pitch == 0 || step == 0 {
            return Err(ScaleError::NoLength);
        }
        let exact = |numerator: u64, denominator: u64| {
            Some(PositionScale { numerator: numerator.try_into().ok()?, denominator: denominator.try_into().ok()? })
        };
        let whole = pitch.is_multiple_of(step).then(|| exact(pitch / step, UNIT.unsigned_abs())).flatten();
        // Steps a turn are pitch / step, and the scale is a 256th of them.
        let divisor = gcd(pitch, step.saturating_mul(UNIT.unsigned_abs()));
        let (numerator, denominator) = (pitch / divisor, step.saturating_mul(UNIT.unsigned_abs()) / divisor);
        let steps = pitch.saturating_add(step / 2) / step;
        whole.or_else(|| exact(numerator, denominator)).ok_or(ScaleError::TooFine { steps, numerator, denominator })
    }

    /// Parameter 154.
    pub const fn numerator(self) -> u16 {
        self.numerator
    }

    /// Parameter 156.
    pub const fn denominator(self) -> u16 {
        self.denominator
    }

    /// Steps a turn; not always a whole number.
    pub fn steps_per_turn(self) -> f64 {
        256.0 * f64::from(self.numerator) / f64::from(self.denominator)
    }

    /// Steps of so many degrees, rounded up, at least 1.
    pub fn steps_of_degrees(self, degrees: f64) -> u32 {
        // A cast of a float saturates.
        (self.steps_per_turn() * degrees / 360.0).ceil().max(1.0) as u32
    }

    /// Steps of so many turns, rounded towards 0; `None` where they do not fit into 32 bits.
    pub fn steps_of_turns(self, turns: i32) -> Option<i32> {
        i32::try_from(self.whole_steps(turns)).ok()
    }

    /// Steps of so many turns, rounded towards 0, whether they fit into 32 bits or not.
    pub fn whole_steps(self, turns: i32) -> i64 {
        i64::from(turns) * UNIT * i64::from(self.numerator) / i64::from(self.denominator)
    }

    /// Turns of so many steps.
    pub fn turns(self, steps: i32) -> f64 {
        f64::from(steps) / self.steps_per_turn()
    }

    /// Millimetres of so many steps on a spindle of this pitch.
    pub fn millimetres(self, steps: i32, pitch: Length) -> f64 {
        self.turns(steps) * pitch.nanometres as f64 / 1e6
    }
}

impl SpeedScale {
    /// 10/1: tenths of rpm.
    pub const FACTORY: SpeedScale = SpeedScale { numerator: 10, denominator: 1 };

    /// Of parameters 162 and 164.
    ///
    /// # Errors
    /// [`ScaleError::Zero`].
    pub const fn new(numerator: u16, denominator: u16) -> Result<Self, ScaleError> {
        match (numerator, denominator) {
            (0, _) | (_, 0) => Err(ScaleError::Zero),
            _ => Ok(SpeedScale { numerator, denominator }),
        }
    }

    /// What a speed is in rpm.
    pub fn rpm(self, speed: i16) -> f64 {
        f64::from(speed) * f64::from(self.denominator) / f64::from(self.numerator)
    }

    /// As it is sent: the nearest number that fits into 16 bits.
    pub fn speed(self, rpm: f64) -> i16 {
        // A cast of a float saturates.
        (rpm * f64::from(self.numerator) / f64::from(self.denominator)).round() as i16
    }
}

impl Family {
    /// Turns either way, at most.
    pub const fn most_turns(self) -> i32 {
        match self {
            Family::Short => 512,
            Family::Long => 16000,
            Family::Pse441 => 127,
        }
    }

    /// Turns either way, as parameters 158 and 160 come from the factory.
    pub const fn factory_turns(self) -> i32 {
        match self {
            Family::Short => 511,
            Family::Long => 16000,
            Family::Pse441 => 127,
        }
    }
}

/// Whole turns and steps within the turn, of a position with 65536 steps a turn. −1 step is turn −1.
pub const fn turns(position: i32) -> (i16, u16) {
    ((position >> 16) as i16, position as u16)
}

/// What parameter 198 becomes: the nearest multiple of 64, the farther one from 0 of two (`U`); `None` beyond 32 bits.
pub fn nearest_reference(position: i32) -> Option<i32> {
    const GRAIN: i64 = 64;
    let position = i64::from(position);
    let rounded = (position.abs() + GRAIN / 2) / GRAIN * GRAIN * position.signum();
    i32::try_from(rounded).ok()
}

/// Percent of torque as the drive takes it: the next 25 % above.
pub const fn effective_torque(percent: u8) -> u8 {
    percent.div_ceil(25).saturating_mul(25)
}

const fn gcd(mut one: u64, mut other: u64) -> u64 {
    while other != 0 {
        (one, other) = (other, one % other);
    }
    one
}
