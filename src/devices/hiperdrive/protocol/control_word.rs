//! The control word (STW) of a drive, built from the action that the host requests (reference, section 3). Words built
//! here never have reserved bits set. Jog bits are not set either, because a stop might not end a jog step.

use super::status_word::{StatusBit, StatusWord};

/// A control word without reserved bits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct ControlWord(u16);

/// A bit of the control word. Bits 1, 2, 11 and 13 to 15 are reserved and must be 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum ControlBit {
    /// Switch the drive on.
    On = 0,
    /// Enable operation.
    Enable = 3,
    /// Positioning: no stop. Speed mode: clockwise rotation.
    NoStop = 4,
    /// Positioning: no pause. Speed mode: an endless run past the end of the range.
    NoPause = 5,
    /// Positioning: start of a job, when this bit differs from status bit 12. Speed mode: a run for as long as this bit
    /// is set.
    Start = 6,
    /// Acknowledge a fault, on the falling edge.
    Acknowledge = 7,
    /// One jog step forward.
    JogOne = 8,
    /// One jog step backward.
    JogTwo = 9,
    /// Request control of the drive.
    Control = 10,
    /// Select speed mode instead of positioning.
    SpeedMode = 12,
}

/// Direction of rotation in speed mode.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Direction {
    /// Bit 4 is set.
    Clockwise,
    /// Bit 4 is clear.
    Counterclockwise,
}

/// Condition on which a run in speed mode ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum RunEnd {
    /// The run ends at the end of the range.
    RangeEnd,
    /// The run ignores the limits and ends only when stopped. It is for experts and requires factory limits and
    /// scaling.
    Endless,
}

/// Motion that a control word starts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum MotionStart {
    /// A positioning job to the target.
    Job,
    /// A run in speed mode.
    Run,
    /// A step of jog 1.
    JogOne,
    /// A step of jog 2.
    JogTwo,
}

/// Error for a control word with reserved bits set. Such a word must not be sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("control word {word:04X} has reserved bits set ({}), which must be 0", bits(*word & RESERVED))]
pub struct ReservedBitsError {
    /// The rejected word.
    pub word: u16,
}

/// Mask of the reserved bits 1, 2, 11, 13, 14 and 15. By contrast, PROFIdrive requires bits 1 and 2 to be set
/// (reference, section 8.2).
const RESERVED: u16 = 0xE806;

fn bits(word: u16) -> String {
    let set: Vec<String> = (0..16).filter(|bit| word >> bit & 1 == 1).map(|bit| bit.to_string()).collect();
    set.join(", ")
}

impl ControlBit {
    /// All bits, lowest first.
    pub const ALL: [ControlBit; 10] = [
        ControlBit::On,
        ControlBit::Enable,
        ControlBit::NoStop,
        ControlBit::NoPause,
        ControlBit::Start,
        ControlBit::Acknowledge,
        ControlBit::JogOne,
        ControlBit::JogTwo,
        ControlBit::Control,
        ControlBit::SpeedMode,
    ];

    /// Returns the number of the bit in the control word.
    pub const fn bit_number(self) -> u8 {
        self as u8
    }

    /// Returns the meaning of the bit when set. Bits 4 to 6 have another meaning in speed mode.
    pub const fn name(self, speed_mode: bool) -> &'static str {
        match (self, speed_mode) {
            (ControlBit::On, _) => "on",
            (ControlBit::Enable, _) => "enable operation",
            (ControlBit::NoStop, false) => "no stop",
            (ControlBit::NoStop, true) => "clockwise",
            (ControlBit::NoPause, false) => "no pause",
            (ControlBit::NoPause, true) => "endless",
            (ControlBit::Start, false) => "job toggle",
            (ControlBit::Start, true) => "run",
            (ControlBit::Acknowledge, _) => "acknowledge",
            (ControlBit::JogOne, _) => "jog 1",
            (ControlBit::JogTwo, _) => "jog 2",
            (ControlBit::Control, _) => "control by PLC",
            (ControlBit::SpeedMode, _) => "speed mode",
        }
    }

    const fn mask(self) -> u16 {
        1 << self as u8
    }
}

impl ControlWord {
    /// Control word 0000h, which does not request control.
    pub const OFF: ControlWord = ControlWord(0);
    /// Control word 0400h (ready), which must follow speed mode. It takes the drive out of the operational state, so
    /// that clearing bit 12 does not start a stale job.
    pub const READY: ControlWord = ControlWord::OFF.with_bit(ControlBit::Control);
    /// Control word 0401h (operational).
    pub const OPERATIONAL: ControlWord = ControlWord::READY.with_bit(ControlBit::On);
    /// Control word 0409h (enabled).
    pub const ENABLED: ControlWord = ControlWord::OPERATIONAL.with_bit(ControlBit::Enable);
    /// Control word 0481h, the first of two words that acknowledge a fault. [`OPERATIONAL`](Self::OPERATIONAL) is the
    /// second. Bit 0 stays set, so that its falling edge can still release the switch-on lock.
    pub const ACKNOWLEDGE: ControlWord = ControlWord::OPERATIONAL.with_bit(ControlBit::Acknowledge);

    /// Parses a received control word.
    ///
    /// # Errors
    /// Returns [`ReservedBitsError`] if a reserved bit is set.
    pub const fn parse(word: u16) -> Result<Self, ReservedBitsError> {
        if word & RESERVED == 0 { Ok(ControlWord(word)) } else { Err(ReservedBitsError { word }) }
    }

    /// Returns the raw word.
    pub const fn to_u16(self) -> u16 {
        self.0
    }

    /// Returns the control word that prepares a job without starting it: 0439h or 0479h. Bit 6 equals the level that
    /// the drive has acknowledged.
    pub const fn without_job_start(status: StatusWord) -> Self {
        ControlWord::position_mode(status.is_set(StatusBit::SetpointAcknowledged))
    }

    /// Returns the control word that starts a job. Bit 6 is the opposite of the level that the drive has acknowledged.
    pub const fn with_job_start(status: StatusWord) -> Self {
        ControlWord::position_mode(!status.is_set(StatusBit::SetpointAcknowledged))
    }

    /// Returns the control word that selects speed mode at standstill: 1409h or 1419h, or for an endless run 1429h or
    /// 1439h.
    pub const fn speed_mode(direction: Direction, end: RunEnd) -> Self {
        let word = ControlWord::ENABLED.with_bit(ControlBit::SpeedMode);
        let word = match direction {
            Direction::Clockwise => word.with_bit(ControlBit::NoStop),
            Direction::Counterclockwise => word,
        };
        match end {
            RunEnd::RangeEnd => word,
            RunEnd::Endless => word.with_bit(ControlBit::NoPause),
        }
    }

    /// Returns the control word that runs the drive in speed mode: 1449h or 1459h, or for an endless run 1469h or
    /// 1479h. [`speed_mode`](Self::speed_mode) must have been sent before.
    pub const fn speed_mode_running(direction: Direction, end: RunEnd) -> Self {
        ControlWord::speed_mode(direction, end).with_bit(ControlBit::Start)
    }

    /// Returns this control word, changed to stop the drive with torque still on. Speed mode clears bit 6. Positioning
    /// clears bit 4, which discards the job. Jog bits are cleared in both modes.
    pub const fn with_stop(self) -> Self {
        let word = self.without_bit(ControlBit::JogOne).without_bit(ControlBit::JogTwo);
        if self.is_set(ControlBit::SpeedMode) {
            word.without_bit(ControlBit::Start)
        } else {
            word.without_bit(ControlBit::NoStop)
        }
    }

    /// Returns this control word, changed to pause the job until [`without_pause`](Self::without_pause) resumes it. In
    /// speed mode, bit 5 has another meaning, so the word stays unchanged.
    pub const fn with_pause(self) -> Self {
        if self.is_set(ControlBit::SpeedMode) { self } else { self.without_bit(ControlBit::NoPause) }
    }

    /// Returns this control word, changed to resume a paused job. In speed mode, the word stays unchanged.
    pub const fn without_pause(self) -> Self {
        if self.is_set(ControlBit::SpeedMode) { self } else { self.with_bit(ControlBit::NoPause) }
    }

    /// Returns whether a bit is set.
    pub const fn is_set(self, bit: ControlBit) -> bool {
        self.0 & bit.mask() != 0
    }

    /// Returns the numbers and meanings of the set bits, lowest first.
    pub fn set_bits(self) -> impl Iterator<Item = (u8, &'static str)> {
        let speed_mode = self.is_set(ControlBit::SpeedMode);
        let set = ControlBit::ALL.into_iter().filter(move |bit| self.is_set(*bit));
        set.map(move |bit| (bit.bit_number(), bit.name(speed_mode)))
    }

    /// Returns the motion that this control word starts when it follows `before`. The drive must be operational and
    /// report `status`. A job starts on a level of bit 6 that differs from the acknowledged one, not on an edge
    /// (reference, section 8.10). Clearing bit 12 after a run therefore starts a job to a stale target.
    pub fn motion_start(self, before: ControlWord, status: StatusWord) -> Option<MotionStart> {
        let rises = |bit: ControlBit| self.is_set(bit) && !before.is_set(bit);
        let acknowledged = status.is_set(StatusBit::SetpointAcknowledged);
        let enabled =
            self.is_set(ControlBit::On) && self.is_set(ControlBit::Enable) && self.is_set(ControlBit::Control);
        if !enabled || !status.is_set(StatusBit::OperationEnabled) || status.is_set(StatusBit::Fault) {
            None
        } else if self.is_set(ControlBit::SpeedMode) {
            if rises(ControlBit::Start) { Some(MotionStart::Run) } else { None }
        } else if rises(ControlBit::JogOne) {
            Some(MotionStart::JogOne)
        } else if rises(ControlBit::JogTwo) {
            Some(MotionStart::JogTwo)
        } else if self.is_set(ControlBit::NoStop)
            && self.is_set(ControlBit::NoPause)
            && self.is_set(ControlBit::Start) != acknowledged
        {
            Some(MotionStart::Job)
        } else {
            None
        }
    }

    /// Returns whether this control word starts no motion and stops a moving drive, whatever status the drive reports,
    /// even late.
    pub const fn is_at_rest(self) -> bool {
        let jogs = self.is_set(ControlBit::JogOne) || self.is_set(ControlBit::JogTwo);
        let moves = if self.is_set(ControlBit::SpeedMode) {
            self.is_set(ControlBit::Start)
        } else {
            self.is_set(ControlBit::NoStop) && self.is_set(ControlBit::NoPause)
        };
        !self.is_set(ControlBit::Enable) || !(jogs || moves)
    }

    const fn position_mode(start: bool) -> Self {
        let word = ControlWord::ENABLED.with_bit(ControlBit::NoStop).with_bit(ControlBit::NoPause);
        if start { word.with_bit(ControlBit::Start) } else { word }
    }

    const fn with_bit(self, bit: ControlBit) -> Self {
        ControlWord(self.0 | bit.mask())
    }

    const fn without_bit(self, bit: ControlBit) -> Self {
        ControlWord(self.0 & !bit.mask())
    }
}
