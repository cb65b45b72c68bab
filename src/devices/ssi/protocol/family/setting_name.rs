//! The names of settings in a family's description.

/// A setting of a family, where it is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SettingName {
    /// A frame as wide as the position.
    #[error("frame")]
    Frame,
    /// Positions shifted to the right.
    #[error("shifting to the right")]
    ShiftRight,
    /// Steps that are no power of two.
    #[error("number of steps that is not a power of two")]
    AnySteps,
    /// Bits of the revolutions, as they are set.
    #[error("mt")]
    Mt,
    /// Revolutions.
    #[error("multiturn")]
    Multiturn,
    /// Bits of the revolutions, with their limits.
    #[error("multiturn bits")]
    MultiturnBits,
    /// Bits within a revolution, as they are set.
    #[error("st")]
    St,
    /// Bits within a revolution, with their limits.
    #[error("singleturn bits")]
    SingleturnBits,
    /// Bits of a length.
    #[error("bits")]
    Bits,
    /// Steps.
    #[error("steps")]
    Steps,
    /// Steps of a turn.
    #[error("steps per turn")]
    StepsPerTurn,
    /// Steps of all turns.
    #[error("total number of steps")]
    StepsAltogether,
    /// Steps of a round axis.
    #[error("steps over this number of revolutions")]
    StepsAround,
    /// Turns.
    #[error("turns")]
    Turns,
    /// Turns, and no steps for them.
    #[error("number of turns without steps")]
    TurnsWithoutSteps,
    /// Revolutions of a round axis.
    #[error("revolutions")]
    Revolutions,
    /// Their numerator.
    #[error("numerator of revolutions")]
    RevolutionsAbove,
    /// Their denominator.
    #[error("denominator of revolutions")]
    RevolutionsBelow,
    /// A round axis.
    #[error("round axis")]
    RoundAxis,
    /// The length of a step, as set.
    #[error("step")]
    Step,
    /// The length of a step.
    #[error("length of a step")]
    StepLength,
    /// The preset.
    #[error("preset")]
    Preset,
}
