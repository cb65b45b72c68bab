//! Names of settings in the description of a family.

/// A setting of a family, as named in error messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SettingName {
    /// The frame is exactly as wide as the position.
    #[error("frame")]
    Frame,
    /// Positions shifted to the right.
    #[error("shifting to the right")]
    ShiftRight,
    /// Number of steps that is not a power of two.
    #[error("number of steps that is not a power of two")]
    AnySteps,
    /// Multiturn width that was set.
    #[error("mt")]
    Mt,
    /// Multiturn part.
    #[error("multiturn")]
    Multiturn,
    /// Multiturn width, with its limits.
    #[error("multiturn bits")]
    MultiturnBits,
    /// Singleturn width that was set.
    #[error("st")]
    St,
    /// Singleturn width, with its limits.
    #[error("singleturn bits")]
    SingleturnBits,
    /// Width of a linear position.
    #[error("bits")]
    Bits,
    /// Steps.
    #[error("steps")]
    Steps,
    /// Steps per turn.
    #[error("steps per turn")]
    StepsPerTurn,
    /// Total number of steps.
    #[error("total number of steps")]
    StepsAltogether,
    /// Number of steps on a round axis.
    #[error("steps over this number of revolutions")]
    StepsAround,
    /// Turns.
    #[error("turns")]
    Turns,
    /// Turns given without steps.
    #[error("number of turns without steps")]
    TurnsWithoutSteps,
    /// Number of revolutions of a round axis.
    #[error("revolutions")]
    Revolutions,
    /// Numerator of the revolutions.
    #[error("numerator of revolutions")]
    RevolutionsAbove,
    /// Denominator of the revolutions.
    #[error("denominator of revolutions")]
    RevolutionsBelow,
    /// Round axis.
    #[error("round axis")]
    RoundAxis,
    /// Step length as set.
    #[error("step")]
    Step,
    /// Step length.
    #[error("length of a step")]
    StepLength,
    /// The preset.
    #[error("preset")]
    Preset,
}
