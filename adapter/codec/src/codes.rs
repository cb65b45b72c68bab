//! Codes and bit sets in messages of an adapter (`protocol/bridge.md`, section 2). Unknown codes and bits are
//! preserved.

/// The capabilities of an adapter, as a set of bits. Unknown bits are preserved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Capabilities(u32);

/// The status of a BiSS frame. Unknown values are preserved.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct BissStatus(u8);

/// The reason for a rejection, as a code. Unknown codes are preserved.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ErrorCode(u8);

/// The reason for the last start of an adapter. Unknown values are preserved.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct RestartReason(u8);

/// Faults of the encoder supply, as a set of bits. Unknown bits are preserved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SupplyFaults(u8);

impl Capabilities {
    /// The adapter reads SSI words.
    pub const SSI: Capabilities = Capabilities(1 << 0);
    /// The adapter reads BiSS frames.
    pub const BISS: Capabilities = Capabilities(1 << 1);
    /// The adapter reads and writes BiSS registers.
    pub const BISS_REGISTERS: Capabilities = Capabilities(1 << 2);
    /// The adapter samples analogue signals.
    pub const ANALOG: Capabilities = Capabilities(1 << 3);
    /// The adapter has an RS-485 line.
    pub const UART: Capabilities = Capabilities(1 << 4);
    /// The adapter can switch the encoder supply.
    pub const SUPPLY: Capabilities = Capabilities(1 << 5);
    /// The encoder supply is on. This bit is a state rather than a capability, and some adapters never set it.
    pub const SUPPLY_ON: Capabilities = Capabilities(1 << 6);
    /// The adapter samples the cosine after the sine and reports the delay.
    pub const ANALOG_SKEW: Capabilities = Capabilities(1 << 7);
    /// The adapter can report its status.
    pub const STATUS: Capabilities = Capabilities(1 << 8);

    /// Creates a set of capabilities from its bits. Every value is valid.
    pub const fn new(word: u32) -> Self {
        Capabilities(word)
    }

    /// Returns the capabilities as bits.
    pub const fn to_bits(self) -> u32 {
        self.0
    }

    /// Returns whether this set contains all of `others`.
    pub const fn contains(self, others: Capabilities) -> bool {
        self.0 & others.0 == others.0
    }

    /// Returns the union of two sets.
    #[must_use]
    pub const fn union(self, others: Capabilities) -> Self {
        Capabilities(self.0 | others.0)
    }
}

impl RestartReason {
    /// The reason is unknown.
    pub const UNKNOWN: RestartReason = RestartReason(0);
    /// The adapter was connected to power, or its supply voltage was temporarily too low.
    pub const POWER: RestartReason = RestartReason(1);
    /// The reset pin was activated.
    pub const RESET_PIN: RestartReason = RestartReason(2);
    /// The firmware stopped responding, and the watchdog restarted the adapter.
    pub const WATCHDOG: RestartReason = RestartReason(3);

    /// Creates a reason from a byte. Every value is valid.
    pub const fn new(byte: u8) -> Self {
        RestartReason(byte)
    }

    /// Returns the reason as a byte.
    pub const fn byte(self) -> u8 {
        self.0
    }
}

impl SupplyFaults {
    /// There is no fault.
    pub const NONE: SupplyFaults = SupplyFaults(0);
    /// The supply switch reported an overload, and the supply was switched off.
    pub const OVERLOAD: SupplyFaults = SupplyFaults(1);

    /// Creates a set of faults from its bits. Every value is valid.
    pub const fn new(bits: u8) -> Self {
        SupplyFaults(bits)
    }

    /// Returns the faults as bits.
    pub const fn bits(self) -> u8 {
        self.0
    }
}

impl BissStatus {
    /// The frame was read.
    pub const OK: BissStatus = BissStatus(0);
    /// The encoder did not acknowledge the frame.
    pub const NO_ACKNOWLEDGE: BissStatus = BissStatus(1);
    /// The data line is stuck at 0.
    pub const STUCK_LOW: BissStatus = BissStatus(2);
    /// The data line is stuck at 1.
    pub const STUCK_HIGH: BissStatus = BissStatus(3);

    /// Creates a status from a byte. Every value is valid.
    pub const fn new(byte: u8) -> Self {
        BissStatus(byte)
    }

    /// Returns the status as a byte.
    pub const fn byte(self) -> u8 {
        self.0
    }
}

impl ErrorCode {
    /// The adapter does not support the operation.
    pub const NOT_SUPPORTED: ErrorCode = ErrorCode(1);
    /// A value in the request is not acceptable to the adapter.
    pub const BAD_ARGUMENT: ErrorCode = ErrorCode(2);
    /// The adapter is busy with a stream.
    pub const BUSY: ErrorCode = ErrorCode(3);
    /// The encoder does not reply.
    pub const NO_REPLY: ErrorCode = ErrorCode(4);
    /// The control frame of the encoder has a CRC error.
    pub const INVALID_REPLY: ErrorCode = ErrorCode(5);
    /// The adapter was too slow to keep up.
    pub const OVERRUN: ErrorCode = ErrorCode(6);

    /// Creates an error code from a byte. Every value is valid.
    pub const fn new(byte: u8) -> Self {
        ErrorCode(byte)
    }

    /// Returns the error code as a byte.
    pub const fn byte(self) -> u8 {
        self.0
    }
}
