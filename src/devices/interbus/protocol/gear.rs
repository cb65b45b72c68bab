//! The gear: a number of steps over a number of turns (reference 3).

use super::value::Value;

/// Steps of the shaft's disc in a turn, before the gear.
pub const STEPS_PER_TURN: u32 = 8192;
/// The most turns an encoder counts.
pub const TURNS: u32 = 4096;

/// Steps and turns, which are set separately and used together: `steps` of the position over `turns` of the shaft.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Gear {
    steps: u32,
    turns: u32,
}

/// The reason why two numbers are not a gear.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum GearError {
    /// More turns than the encoder counts.
    #[error("{turns} turns are not within 1 to {TURNS}")]
    Turns {
        /// The given turns.
        turns: u32,
    },
    /// More than the disc has over these turns, or more than 25 bits hold.
    #[error("{steps} steps are not within 1 to {most}, which is what {turns} turns have")]
    Steps {
        /// The given steps.
        steps: u32,
        /// The given turns.
        turns: u32,
        /// The limit.
        most: u32,
    },
}

impl Gear {
    /// # Errors
    /// [`GearError`] if a number is beyond its limit; turns are checked first.
    pub const fn new(steps: u32, turns: u32) -> Result<Self, GearError> {
        if turns == 0 || turns > TURNS {
            return Err(GearError::Turns { turns });
        }
        let most = Gear::most_steps(turns);
        if steps == 0 || steps > most {
            return Err(GearError::Steps { steps, turns, most });
        }
        Ok(Gear { steps, turns })
    }

    /// Returns the largest number of steps over this number of turns. All 4096 turns have one step more than 25 bits hold.
    pub(super) const fn most_steps(turns: u32) -> u32 {
        let all = STEPS_PER_TURN * turns;
        if all > Value::MAX.get() { Value::MAX.get() } else { all }
    }

    /// Returns steps of the position over all turns: the measuring range.
    pub const fn steps(self) -> u32 {
        self.steps
    }

    /// Returns the turns of the shaft until the position starts again.
    pub const fn turns(self) -> u32 {
        self.turns
    }

    /// Returns the steps of the disc until the position starts again.
    pub const fn range(self) -> u32 {
        STEPS_PER_TURN * self.turns
    }

    /// Converts steps of the disc to steps of the position: `raw · steps / (8192 · turns)`, rounded down (`U`: the manual
    /// only says that the two are one gear). The result is not wrapped: the complete range results in all steps.
    pub const fn scaled(self, raw: u32) -> u64 {
        raw as u64 * self.steps as u64 / self.range() as u64
    }

    /// Returns the position that the encoder sends for a position of the disc: [`scaled`](Self::scaled) within the range
    /// (`U`).
    pub const fn position(self, raw: u32) -> Value {
        // Less than `steps`, which has 25 bits.
        Value::of_word(self.scaled(raw % self.range()) as u32)
    }
}
