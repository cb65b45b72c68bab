//! The gear, which scales the position to a number of steps over a number of turns (reference 3).

use super::value::Value;

/// Resolution of the encoder disc in steps per turn, before the gear.
pub const STEPS_PER_TURN: u32 = 8192;
/// Maximum number of turns that an encoder counts.
pub const TURNS: u32 = 4096;

/// A gear, which divides a number of shaft turns into position steps. The encoder stores both numbers separately but
/// uses them together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Gear {
    steps: u32,
    turns: u32,
}

/// The reason why steps and turns do not form a gear.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum GearError {
    /// The number of turns exceeds what an encoder counts.
    #[error("the number of turns must be from 1 to {TURNS}, not {turns}")]
    Turns {
        /// Given number of turns.
        turns: u32,
    },
    /// The number of steps exceeds 25 bits, or the disc resolution over these turns.
    #[error("the number of steps over {turns} turns must be from 1 to {most}, not {steps}")]
    Steps {
        /// Given number of steps.
        steps: u32,
        /// Given number of turns.
        turns: u32,
        /// Largest valid number of steps.
        most: u32,
    },
}

impl Gear {
    /// Creates a gear.
    ///
    /// # Errors
    /// Returns a [`GearError`] if a number exceeds its limit. The turns are checked first.
    pub const fn new(steps: u32, turns: u32) -> Result<Self, GearError> {
        if turns == 0 || turns > TURNS {
            return Err(GearError::Turns { turns });
        }
        let most = Gear::max_steps(turns);
        if steps == 0 || steps > most {
            return Err(GearError::Steps { steps, turns, most });
        }
        Ok(Gear { steps, turns })
    }

    /// Returns the maximum number of steps over the given number of turns: all disc steps, but at most 25 bits.
    pub(super) const fn max_steps(turns: u32) -> u32 {
        let all = STEPS_PER_TURN * turns;
        if all > Value::MAX.get() { Value::MAX.get() } else { all }
    }

    /// Returns the measuring range, that is, the number of position steps over all turns.
    pub const fn total_steps(self) -> u32 {
        self.steps
    }

    /// Returns the number of shaft turns after which the position repeats.
    pub const fn turns(self) -> u32 {
        self.turns
    }

    /// Returns the number of disc steps after which the position repeats.
    pub const fn total_disc_steps(self) -> u32 {
        STEPS_PER_TURN * self.turns
    }

    /// Converts disc steps to position steps: `raw · steps / (8192 · turns)`, rounded down. The result does not wrap,
    /// so converting the complete range yields all steps. The manual does not state the formula (`U`).
    pub const fn scaled_value(self, raw: u32) -> u64 {
        raw as u64 * self.steps as u64 / self.total_disc_steps() as u64
    }

    /// Returns the position that the encoder sends for a disc position: the [`scaled_value`](Self::scaled_value),
    /// wrapped to the range (`U`: not documented).
    pub const fn position(self, raw: u32) -> Value {
        // The result is less than `steps`, which has 25 bits.
        Value::from_word(self.scaled_value(raw % self.total_disc_steps()) as u32)
    }
}
