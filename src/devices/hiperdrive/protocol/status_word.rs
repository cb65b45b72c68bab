//! The status word (ZSW, reference, section 3).

use super::state::State;

/// Status word of a drive. Every 16-bit value is valid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct StatusWord(u16);

/// Bit of the status word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum StatusBit {
    /// Control of the drive has been requested.
    Ready = 0,
    /// The drive is switched on.
    Operational = 1,
    /// The drive may move.
    OperationEnabled = 2,
    /// A fault has occurred in an operational drive.
    Fault = 3,
    /// The drive has been detected or is requested.
    NoOff2 = 4,
    /// Same as bit 4.
    NoOff3 = 5,
    /// The switch-on lock is active, after a fault or a falling edge of control bit 0.
    SwitchOnLock = 6,
    /// A fault is present, whatever the state.
    Warning = 7,
    /// Following error bit. According to the manual, a following error both sets and clears it (reference, section
    /// 8.1). Use error 8203 and bit 3 instead.
    NoFollowingError = 8,
    /// Same as bit 4.
    ControlRequested = 9,
    /// A move has reached its target.
    TargetReached = 10,
    /// Same as bit 4.
    ReferenceSet = 11,
    /// Value of control bit 6 for the last job.
    SetpointAcknowledged = 12,
    /// The drive is at standstill.
    Standstill = 13,
    /// The current is too high.
    OverCurrent = 14,
    /// The position is outside the range.
    PositionLimit = 15,
}

impl StatusBit {
    /// All bits, lowest first.
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
        StatusBit::Standstill,
        StatusBit::OverCurrent,
        StatusBit::PositionLimit,
    ];

    /// Returns the number of the bit in the status word.
    pub const fn bit_number(self) -> u8 {
        self as u8
    }

    /// Returns the meaning of the bit when set.
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
            StatusBit::Standstill => "standing still",
            StatusBit::OverCurrent => "over-current",
            StatusBit::PositionLimit => "position limit",
        }
    }
}

impl StatusWord {
    /// Status word 0A30h of a detected drive that is not at standstill.
    pub const DETECTED_DRIVE: StatusWord = StatusWord(0x0A30);

    /// Creates a status word from a received value.
    pub const fn new(word: u16) -> Self {
        StatusWord(word)
    }

    /// Returns the raw word.
    pub const fn to_u16(self) -> u16 {
        self.0
    }

    /// Returns whether a bit is set.
    pub const fn is_set(self, bit: StatusBit) -> bool {
        self.0 >> bit as u8 & 1 == 1
    }

    /// Returns this status word with a bit set or cleared.
    pub const fn with_bit(self, bit: StatusBit, set: bool) -> Self {
        let mask = 1 << bit as u8;
        StatusWord(if set { self.0 | mask } else { self.0 & !mask })
    }

    /// Returns the set bits, lowest first.
    pub fn set_bits(self) -> impl Iterator<Item = StatusBit> {
        StatusBit::ALL.into_iter().filter(move |bit| self.is_set(*bit))
    }

    /// Returns whether the drive is present, that is, it has been detected or is requested.
    pub const fn is_present(self) -> bool {
        self.is_set(StatusBit::NoOff2)
    }

    /// Returns whether a drive can send this status word. Bits 4, 5, 9 and 11 of a drive always have the same value.
    pub const fn is_plausible(self) -> bool {
        let found = self.0 & StatusWord::DETECTED_DRIVE.0;
        found == 0 || found == StatusWord::DETECTED_DRIVE.0
    }

    /// Returns the state of the drive. A fault takes precedence over the lock, and the lock over any other state (`D`).
    /// Bits 0 to 2 are not documented for a fault (`U`).
    pub const fn state(self) -> State {
        use StatusBit::{Fault, OperationEnabled, Operational, Ready, Standstill, SwitchOnLock};
        if self.is_set(Fault) {
            State::Fault
        } else if self.is_set(SwitchOnLock) {
            State::Locked
        } else if self.is_set(OperationEnabled) {
            if self.is_set(Standstill) { State::Enabled } else { State::Moving }
        } else if self.is_set(Operational) {
            State::Operational
        } else if self.is_set(Ready) {
            State::Ready
        } else {
            State::NotReady
        }
    }
}
