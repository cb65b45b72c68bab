//! IN words for display and plotting.

use crate::devices::interbus::protocol::{CamOutput, Gear, Reply, StartupMode, Value, WindowShift};
use crate::units::Moment;

/// An IN word, with what is known about the encoder when it is received.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WordReading {
    pub at: Moment,
    /// IN word as received.
    pub word: u32,
    /// Mode of the encoder, or `None` if it has not been read yet. The word of a running encoder is then interpreted as
    /// a position.
    pub mode: Option<StartupMode>,
    /// Gear of the encoder, or `None` if it has not been read yet.
    pub gear: Option<Gear>,
    /// Window shift in cam mode, or `None` if it has not been read yet.
    pub shift: Option<WindowShift>,
}

/// A position within the programmed turns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TurnPosition {
    /// Number of whole turns, counted from 0.
    pub turns: u32,
    /// Steps within the turn, counted from 0.
    pub steps: u32,
    /// Angle within the turn in degrees, at least 0 and below 360.
    pub degrees: f64,
}

impl WordReading {
    pub fn reply(&self) -> Reply {
        Reply::parse(self.word)
    }

    /// Returns whether the encoder is running, so that the word is a valid position, speed or cam output.
    pub fn is_valid(&self) -> bool {
        matches!(self.reply(), Reply::Run { .. })
    }

    /// Returns the position in steps, or `None` if the word does not contain it. In cam mode, all bits of the position
    /// must lie within the window.
    pub fn position(&self) -> Option<u32> {
        match (self.mode, self.reply()) {
            (Some(StartupMode::Velocity), _) => None,
            (Some(StartupMode::Cams(_)), Reply::Run { .. }) => {
                let (gear, shift) = (self.gear?, self.shift?);
                let bits = u32::BITS - (gear.total_steps() - 1).leading_zeros();
                let whole = shift.get() == 0 && bits <= 17;
                whole.then(|| self.cams().map(|cams| cams.position_bits(shift)))?
            }
            (_, Reply::Run { value, .. }) => Some(value.get()),
            _ => None,
        }
    }

    /// Returns the speed in revolutions per minute, if the encoder is in velocity mode. The value is interpreted as a
    /// signed 25-bit number (`U`: not documented). See reference 6.13.
    pub fn rpm(&self) -> Option<i32> {
        match (self.mode, self.reply()) {
            (Some(StartupMode::Velocity), Reply::Run { value, .. }) => {
                let above = u32::BITS - Value::BITS;
                Some((value.get() << above) as i32 >> above)
            }
            _ => None,
        }
    }

    pub fn cams(&self) -> Option<CamOutput> {
        match self.mode {
            Some(StartupMode::Cams(_)) => CamOutput::parse(self.word).ok(),
            _ => None,
        }
    }

    /// Returns the bits that should be 0 while the encoder is running but are set.
    pub fn unexpected_bits(&self) -> u8 {
        match self.reply() {
            Reply::Run { stray, .. } => stray,
            _ => 0,
        }
    }

    /// Returns the position as turns and steps, or `None` if it is beyond the measuring range or the gear is unknown.
    pub fn turn_position(&self) -> Option<TurnPosition> {
        let (position, gear) = (u64::from(self.position()?), self.gear?);
        let (all, turns) = (u64::from(gear.total_steps()), u64::from(gear.turns()));
        if position >= all {
            return None;
        }
        let turn = position * turns / all;
        let first = (turn * all).div_ceil(turns);
        let degrees = (position * turns % all) as f64 * 360.0 / all as f64;
        // The results are less than the turns and the steps of the gear, so they fit.
        Some(TurnPosition { turns: turn as u32, steps: (position - first) as u32, degrees })
    }
}

/// Returns the word with swapped halves, if that is a valid position and the word as received has stray bits.
pub(super) fn swapped_position_word(word: u32) -> Option<u32> {
    let other = word.rotate_left(16);
    let strays = |word| matches!(Reply::parse(word), Reply::Run { stray, .. } if stray != 0);
    let runs = |word| matches!(Reply::parse(word), Reply::Run { stray: 0, .. });
    (strays(word) && runs(other)).then_some(other)
}

/// Returns the word with swapped halves, if only that is a valid position. Unlike [`swapped_position_word`], this also
/// examines words that are not positions, except error words without data.
pub(super) fn find_swapped_word(word: u32) -> Option<u32> {
    match Reply::parse(word) {
        Reply::Run { .. } => swapped_position_word(word),
        Reply::Error(error) if error.data.get() == 0 => None,
        _ => Some(word.rotate_left(16)).filter(|other| matches!(Reply::parse(*other), Reply::Run { stray: 0, .. })),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::devices::interbus::protocol::ProgramNumber;

    fn reading(word: u32, mode: StartupMode, gear: (u32, u32), shift: u8) -> WordReading {
        let gear = Gear::new(gear.0, gear.1).ok();
        WordReading { at: Moment::START, word, mode: Some(mode), gear, shift: WindowShift::new(shift) }
    }

    #[test]
    fn interprets_word_by_mode() {
        let cams = StartupMode::Cams(ProgramNumber::new(3).unwrap());
        let word = reading(0x0012_3456, StartupMode::K3, (8192 * 4096 - 1, 4096), 0);
        assert_eq!((word.position(), word.rpm(), word.cams()), (Some(1_193_046), None, None));
        let word = reading(0x01FF_FFC4, StartupMode::Velocity, (8192, 1), 0);
        assert_eq!((word.position(), word.rpm(), word.cams()), (None, Some(-60), None));
        // The window with shift 0 contains position 1000 (3E8h), and cams 0 and 2 are on.
        let word = reading(0x0003_E805, cams, (3600, 1), 0);
        assert_eq!((word.position(), word.cams().map(|own| own.outputs)), (Some(1000), Some(5)));
        // The position has more bits than the window, or is shifted out of it.
        assert_eq!(reading(0x0003_E805, cams, (1 << 18, 4096), 0).position(), None);
        assert_eq!(reading(0x0003_E805, cams, (3600, 1), 2).position(), None);
        for word in [0xC200_00FF, 0xA000_0FA0, 0x8000_0000] {
            let word = reading(word, StartupMode::K3, (8192, 1), 0);
            assert_eq!((word.position(), word.is_valid()), (None, false));
        }
    }

    /// With 1000 steps over 3 turns, turn 1 begins at step 333.3, so its first whole step is 334.
    #[test]
    fn splits_position_into_turns_and_steps() {
        let place = |word| reading(word, StartupMode::K3, (1000, 3), 0).turn_position();
        assert_eq!(place(333).map(|own| (own.turns, own.steps)), Some((0, 333)));
        assert_eq!(place(334).map(|own| (own.turns, own.steps)), Some((1, 0)));
        assert_eq!(place(999).map(|own| (own.turns, own.steps)), Some((2, 332)));
        assert!(place(334).is_some_and(|own| (own.degrees - 0.72).abs() < 1e-9), "1002 of 1000 parts");
        assert_eq!(place(1000), None);
    }

    #[test]
    fn detects_swapped_words() {
        assert_eq!(swapped_position_word(0x3456_0012), Some(0x0012_3456));
        assert_eq!(swapped_position_word(0x0012_3456), None);
        // Stray bits in both orders are not conclusive.
        assert_eq!(swapped_position_word(0x3456_3456), None);
        // The first word is 2DC6C0h with swapped halves. The second one is the error word for lost parameters, which is
        // not a position.
        assert_eq!((swapped_position_word(0xC6C0_002D), find_swapped_word(0xC6C0_002D)), (None, Some(0x002D_C6C0)));
        assert_eq!(find_swapped_word(0x8600_0000), None);
    }
}
