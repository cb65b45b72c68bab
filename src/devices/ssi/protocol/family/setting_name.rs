//! Names of a family's settings in error messages.

/// The name of a family's setting, as it appears in error messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SettingName {
    /// Frame that has exactly the width of the position.
    #[error("frame")]
    Frame,
    /// Delay of the position by one clock.
    #[error("right shift")]
    ShiftRight,
    /// Number of steps that is not a power of two.
    #[error("number of steps that is not a power of two")]
    AnySteps,
    /// Multiturn width as named on the command line.
    #[error("mt")]
    Mt,
    /// Multiturn part of the position.
    #[error("multiturn")]
    Multiturn,
    /// Multiturn width that is outside its limits.
    #[error("multiturn bits")]
    MultiturnBits,
    /// Singleturn width as named on the command line.
    #[error("st")]
    St,
    /// Singleturn width that is outside its limits.
    #[error("singleturn bits")]
    SingleturnBits,
    /// Width of a linear position.
    #[error("bits")]
    Bits,
    /// Number of steps.
    #[error("steps")]
    Steps,
    /// Steps per turn.
    #[error("steps per turn")]
    StepsPerTurn,
    /// Total number of steps.
    #[error("total number of steps")]
    StepsAltogether,
    /// Number of steps on all turns of a round axis.
    #[error("steps over this number of revolutions")]
    StepsAround,
    /// Number of turns.
    #[error("turns")]
    Turns,
    /// Number of turns without a number of steps.
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
    /// Round axis, whose positions wrap after a fractional number of turns.
    #[error("round axis")]
    RoundAxis,
    /// Step length as named on the command line.
    #[error("step")]
    Step,
    /// Step length.
    #[error("step length")]
    StepLength,
    /// Position at the zero point of the shaft.
    #[error("preset")]
    Preset,
}
