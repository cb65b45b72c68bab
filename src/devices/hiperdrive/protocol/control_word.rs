//! The control word (STW, reference 3). A host says what it wants and gets the word for it: reserved bits and the bits of a
//! jog step, which a stop may not end, are in none of those.

use super::status_word::{StatusBit, StatusWord};

/// A control word in which no reserved bit is set.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct ControlWord(u16);

/// A bit of the control word that means something. Bits 1, 2, 11 and 13 to 15 have to be 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum ControlBit {
    /// On.
    On = 0,
    /// Operation is enabled.
    Enable = 3,
    /// Positioning: no stop. Speed mode: clockwise.
    NoStop = 4,
    /// Positioning: no pause. Speed mode: endless, past the end of the range.
    NoPause = 5,
    /// Positioning: a job begins where it differs from status bit 12. Speed mode: the drive runs while it is set.
    Start = 6,
    /// A fault is acknowledged when it falls.
    Acknowledge = 7,
    /// A step forward.
    JogOne = 8,
    /// A step back.
    JogTwo = 9,
    /// The control asks for the drive.
    Control = 10,
    /// Speed mode instead of positioning.
    SpeedMode = 12,
}

/// The drive's direction in speed mode.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Direction {
    /// Bit 4 is set.
    Clockwise,
    /// Bit 4 is clear.
    Counterclockwise,
}

/// Where a run in speed mode ends by itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum RunEnd {
    /// At the end of the range.
    RangeEnd,
    /// Nowhere: it ignores the limits. For experts, and only with factory limits and scaling.
    Endless,
}

/// Motion that begins with a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Begins {
    /// To the target.
    Job,
    /// In speed mode.
    Run,
    /// By the step of jog 1.
    JogOne,
    /// By the step of jog 2.
    JogTwo,
}

/// A word with reserved bits. It must not be sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("control word {word:04X} has reserved bits set ({}), which must be 0", bits(*word & RESERVED))]
pub struct Refused {
    /// As it was given.
    pub word: u16,
}

/// Bits 1, 2, 11, 13, 14 and 15. Unlike PROFIdrive, where 1 and 2 have to be set (reference 8.2).
const RESERVED: u16 = 0xE806;

fn bits(word: u16) -> String {
    let set: Vec<String> = (0..16).filter(|bit| word >> bit & 1 == 1).map(|bit| bit.to_string()).collect();
    set.join(", ")
}

impl ControlBit {
    /// All of them, the lowest first.
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

    /// Its number in the word.
    pub const fn number(self) -> u8 {
        self as u8
    }

    /// What it says when it is set. Bits 4 to 6 mean something else in speed mode.
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
    /// 0000h: the drive is left alone.
    pub const OFF: ControlWord = ControlWord(0);
    /// 0400h: ready. What speed mode is left through: below operational the drive forgets the job that clearing bit 12 would
    /// start.
    pub const READY: ControlWord = ControlWord::OFF.with(ControlBit::Control);
    /// 0401h: operational.
    pub const OPERATIONAL: ControlWord = ControlWord::READY.with(ControlBit::On);
    /// 0409h: enabled.
    pub const ENABLED: ControlWord = ControlWord::OPERATIONAL.with(ControlBit::Enable);
    /// 0481h: before an acknowledgement, which comes with [`OPERATIONAL`](Self::OPERATIONAL). Bit 0 stays, so that its
    /// falling edge is left for the switch-on lock.
    pub const ACKNOWLEDGE: ControlWord = ControlWord::OPERATIONAL.with(ControlBit::Acknowledge);

    /// A word as it came.
    ///
    /// # Errors
    /// [`Refused`] with reserved bits.
    pub const fn parse(word: u16) -> Result<Self, Refused> {
        if word & RESERVED == 0 { Ok(ControlWord(word)) } else { Err(Refused { word }) }
    }

    /// The word.
    pub const fn word(self) -> u16 {
        self.0
    }

    /// Ready for a job, and none begins: 0439h or 0479h, with bit 6 as the drive has acknowledged it.
    pub const fn holding(status: StatusWord) -> Self {
        ControlWord::positioning(status.has(StatusBit::SetpointAcknowledged))
    }

    /// A job begins: bit 6 is the opposite of what the drive has acknowledged.
    pub const fn starting(status: StatusWord) -> Self {
        ControlWord::positioning(!status.has(StatusBit::SetpointAcknowledged))
    }

    /// Speed mode, standing: 1409h or 1419h, endless 1429h or 1439h.
    pub const fn speed_mode(direction: Direction, end: RunEnd) -> Self {
        let word = ControlWord::ENABLED.with(ControlBit::SpeedMode);
        let word = match direction {
            Direction::Clockwise => word.with(ControlBit::NoStop),
            Direction::Counterclockwise => word,
        };
        match end {
            RunEnd::RangeEnd => word,
            RunEnd::Endless => word.with(ControlBit::NoPause),
        }
    }

    /// Speed mode, running: 1449h or 1459h, endless 1469h or 1479h. The drive has to have seen
    /// [`speed_mode`](Self::speed_mode) before.
    pub const fn running(direction: Direction, end: RunEnd) -> Self {
        ControlWord::speed_mode(direction, end).with(ControlBit::Start)
    }

    /// The mode's stop: in speed mode bit 6 falls; positioning, bit 4 falls and the job is gone. Torque stays on. Bits of jog
    /// steps are taken away in both.
    pub const fn stopped(self) -> Self {
        let word = self.without(ControlBit::JogOne).without(ControlBit::JogTwo);
        if self.has(ControlBit::SpeedMode) { word.without(ControlBit::Start) } else { word.without(ControlBit::NoStop) }
    }

    /// Positioning: the job is kept and goes on with [`resumed`](Self::resumed). In speed mode, where bit 5 is another, the
    /// same word.
    pub const fn paused(self) -> Self {
        if self.has(ControlBit::SpeedMode) { self } else { self.without(ControlBit::NoPause) }
    }

    /// A paused job goes on. In speed mode the same word.
    pub const fn resumed(self) -> Self {
        if self.has(ControlBit::SpeedMode) { self } else { self.with(ControlBit::NoPause) }
    }

    /// Whether a bit is set.
    pub const fn has(self, bit: ControlBit) -> bool {
        self.0 & bit.mask() != 0
    }

    /// The bits that are set, with their numbers and what they say, the lowest first.
    pub fn set(self) -> impl Iterator<Item = (u8, &'static str)> {
        let speed_mode = self.has(ControlBit::SpeedMode);
        let set = ControlBit::ALL.into_iter().filter(move |bit| self.has(*bit));
        set.map(move |bit| (bit.number(), bit.name(speed_mode)))
    }

    /// What motion begins when this word follows `before` in a drive that says `status` and has operation enabled. The start
    /// of a job is a difference of levels, not an edge (reference 8.10): clearing bit 12 after a run begins one to a stale
    /// target.
    pub fn begins(self, before: ControlWord, status: StatusWord) -> Option<Begins> {
        let rises = |bit: ControlBit| self.has(bit) && !before.has(bit);
        let acknowledged = status.has(StatusBit::SetpointAcknowledged);
        let enabled = self.has(ControlBit::On) && self.has(ControlBit::Enable) && self.has(ControlBit::Control);
        if !enabled || !status.has(StatusBit::OperationEnabled) || status.has(StatusBit::Fault) {
            None
        } else if self.has(ControlBit::SpeedMode) {
            if rises(ControlBit::Start) { Some(Begins::Run) } else { None }
        } else if rises(ControlBit::JogOne) {
            Some(Begins::JogOne)
        } else if rises(ControlBit::JogTwo) {
            Some(Begins::JogTwo)
        } else if self.has(ControlBit::NoStop)
            && self.has(ControlBit::NoPause)
            && self.has(ControlBit::Start) != acknowledged
        {
            Some(Begins::Job)
        } else {
            None
        }
    }

    /// Whatever the drive says, also where it says it late: with this word nothing begins, and what moves comes to stand.
    pub const fn is_standing(self) -> bool {
        let jogs = self.has(ControlBit::JogOne) || self.has(ControlBit::JogTwo);
        let moves = if self.has(ControlBit::SpeedMode) {
            self.has(ControlBit::Start)
        } else {
            self.has(ControlBit::NoStop) && self.has(ControlBit::NoPause)
        };
        !self.has(ControlBit::Enable) || !(jogs || moves)
    }

    const fn positioning(start: bool) -> Self {
        let word = ControlWord::ENABLED.with(ControlBit::NoStop).with(ControlBit::NoPause);
        if start { word.with(ControlBit::Start) } else { word }
    }

    const fn with(self, bit: ControlBit) -> Self {
        ControlWord(self.0 | bit.mask())
    }

    const fn without(self, bit: ControlBit) -> Self {
        ControlWord(self.0 & !bit.mask())
    }
}
