//! The status word (ZSW, reference 3).

use super::state::State;

/// What a drive says of itself. Any word is one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct StatusWord(u16);

/// A bit of the status word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum StatusBit {
    /// The control has asked for the drive.
    Ready = 0,
    /// It is on.
    Operational = 1,
    /// It may move.
    OperationEnabled = 2,
    /// A fault since it was operational.
    Fault = 3,
    /// The drive was found or asked for.
    NoOff2 = 4,
    /// As bit 4.
    NoOff3 = 5,
    /// Locked after a fault or a fall of control bit 0.
    SwitchOnLock = 6,
    /// A fault, whatever the state.
    Warning = 7,
    /// The manual says of it both that it is set by a following error and that it is cleared by one (reference 8.1): error
    /// 8203 and bit 3 tell that.
    NoFollowingError = 8,
    /// As bit 4.
    ControlRequested = 9,
    /// A move has arrived.
    TargetReached = 10,
    /// As bit 4.
    ReferenceSet = 11,
    /// Control bit 6 of the last job.
    SetpointAcknowledged = 12,
    /// Nothing moves.
    StandingStill = 13,
    /// The current was too high.
    OverCurrent = 14,
    /// Outside the range.
    PositionLimit = 15,
}

impl StatusBit {
    /// All of them, the lowest first.
    pub const ALL: [StatusBit; 16] = [
        StatusBit::Ready,
        StatusBit::Operational,
        StatusBit::OperationEnabled,
        StatusBit::Fault,
        StatusBit::NoOff2,
        StatusBit::NoOff3,
        StatusBit::SwitchOnLock,
        StatusBit::Warning,
        StatusBit::NoFollowingError,
        StatusBit::ControlRequested,
        StatusBit::TargetReached,
        StatusBit::ReferenceSet,
        StatusBit::SetpointAcknowledged,
        StatusBit::StandingStill,
        StatusBit::OverCurrent,
        StatusBit::PositionLimit,
    ];

    /// Its number in the word.
    pub const fn number(self) -> u8 {
        self as u8
    }

    /// What it says when it is set.
    pub const fn name(self) -> &'static str {
        match self {
            StatusBit::Ready => "ready to switch on",
            StatusBit::Operational => "operational",
            StatusBit::OperationEnabled => "operation enabled",
            StatusBit::Fault => "fault",
            StatusBit::NoOff2 => "no OFF2",
            StatusBit::NoOff3 => "no OFF3",
            StatusBit::SwitchOnLock => "switch-on lock",
            StatusBit::Warning => "warning",
            StatusBit::NoFollowingError => "no following error",
            StatusBit::ControlRequested => "control requested",
            StatusBit::TargetReached => "target reached",
            StatusBit::ReferenceSet => "reference set",
            StatusBit::SetpointAcknowledged => "set-point acknowledged",
            StatusBit::StandingStill => "standing still",
            StatusBit::OverCurrent => "over-current",
            StatusBit::PositionLimit => "position limit",
        }
    }
}

impl StatusWord {
    /// 0A30h: a drive that was found; it does not stand still.
    pub const FOUND: StatusWord = StatusWord(0x0A30);

    /// A word as it came.
    pub const fn new(word: u16) -> Self {
        StatusWord(word)
    }

    /// The word.
    pub const fn word(self) -> u16 {
        self.0
    }

    /// Whether a bit is set.
    pub const fn has(self, bit: StatusBit) -> bool {
        self.0 >> bit as u8 & 1 == 1
    }

    /// The same with a bit set or cleared.
    pub const fn with(self, bit: StatusBit, set: bool) -> Self {
        let mask = 1 << bit as u8;
        StatusWord(if set { self.0 | mask } else { self.0 & !mask })
    }

    /// The bits that are set, the lowest first.
    pub fn set(self) -> impl Iterator<Item = StatusBit> {
        StatusBit::ALL.into_iter().filter(move |bit| self.has(*bit))
    }

    /// The drive is there: it was found or asked for.
    pub const fn is_present(self) -> bool {
        self.has(StatusBit::NoOff2)
    }

    /// Bits 4, 5, 9 and 11 rise and fall together: a word with some of them alone is none of a drive.
    pub const fn is_plausible(self) -> bool {
        let found = self.0 & StatusWord::FOUND.0;
        found == 0 || found == StatusWord::FOUND.0
    }

    /// In which state the drive is. A fault goes before the lock, the lock before the rest (`D`; bits 0 to 2 of a fault `U`).
    pub const fn state(self) -> State {
        use StatusBit::{Fault, OperationEnabled, Operational, Ready, StandingStill, SwitchOnLock};
        if self.has(Fault) {
            State::Fault
        } else if self.has(SwitchOnLock) {
            State::Locked
        } else if self.has(OperationEnabled) {
            if self.has(StandingStill) { State::Enabled } else { State::Moving }
        } else if self.has(Operational) {
            State::Operational
        } else if self.has(Ready) {
            State::Ready
        } else {
            State::NotReady
        }
    }
}
