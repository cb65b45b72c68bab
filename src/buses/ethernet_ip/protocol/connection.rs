//! Fields of the requests that open a connection. See reference 7 (bit layout by ODVA, `P`).

use std::time::Duration;

/// The 16-bit network parameters of one direction of a connection. Unknown bits are preserved.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct NetworkParameters(u16);

/// Type of connection, bits 14 and 13.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum NetworkType {
    /// No data in this direction, encoded as 0.
    Null,
    /// Packets to all listeners, encoded as 1.
    Multicast,
    /// Packets to a single node, encoded as 2.
    PointToPoint,
    /// Reserved, encoded as 3.
    Reserved,
}

/// Priority, bits 11 and 10.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum NetworkPriority {
    /// Low priority, encoded as 0.
    Low,
    /// High priority, encoded as 1.
    High,
    /// Scheduled priority, encoded as 2 and used for cyclic data.
    Scheduled,
    /// Urgent priority, encoded as 3.
    Urgent,
}

/// The transport class and trigger of a connection. They determine when data are produced, and by which node.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Transport(u8);

/// Trigger, bits 6 to 4 of [`Transport`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Trigger {
    /// Cyclic production, encoded as 0.
    Cyclic,
    /// Production triggered by a change of state, encoded as 1.
    ChangeOfState,
    /// Production triggered by the application, encoded as 2.
    Application,
    /// A reserved value.
    Unknown(u8),
}

/// Connection time-out multiplier. The connection ends after 4 · 2ⁿ intervals without data.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ConnectionTimeout(u8);

/// The time-out of a request. Its first byte holds priority and tick length, and the second the number of ticks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct RequestTimeout {
    /// Priority and tick length. Bits 3 to 0 hold the exponent n of the tick length, which is 2ⁿ milliseconds. Other
    /// bits are preserved.
    pub priority_and_tick: u8,
    /// Number of ticks.
    pub ticks: u8,
}

const OWNER: u16 = 1 << 15;
const VARIABLE: u16 = 1 << 9;
const SIZE: u16 = 0x01FF;

impl NetworkParameters {
    /// Maximum connection size in bytes.
    pub const MAX_SIZE: u16 = SIZE;

    /// Creates the parameters of an exclusive-owner connection with a fixed size. The size includes the sequence count
    /// and the run/idle header. Returns `None` for a size above 511 bytes.
    pub const fn new(kind: NetworkType, priority: NetworkPriority, size: u16) -> Option<Self> {
        let kind = match kind {
            NetworkType::Null => 0,
            NetworkType::Multicast => 1,
            NetworkType::PointToPoint => 2,
            NetworkType::Reserved => 3,
        };
        let priority = match priority {
            NetworkPriority::Low => 0,
            NetworkPriority::High => 1,
            NetworkPriority::Scheduled => 2,
            NetworkPriority::Urgent => 3,
        };
        if size <= SIZE { Some(NetworkParameters(kind << 13 | priority << 10 | size)) } else { None }
    }

    /// Creates the parameters from a received word.
    pub const fn from_word(word: u16) -> Self {
        NetworkParameters(word)
    }

    /// Returns the encoded word.
    pub const fn to_bits(self) -> u16 {
        self.0
    }

    /// Returns the connection type.
    pub const fn kind(self) -> NetworkType {
        match self.0 >> 13 & 3 {
            0 => NetworkType::Null,
            1 => NetworkType::Multicast,
            2 => NetworkType::PointToPoint,
            _ => NetworkType::Reserved,
        }
    }

    /// Returns the priority of the connection.
    pub const fn priority(self) -> NetworkPriority {
        match self.0 >> 10 & 3 {
            0 => NetworkPriority::Low,
            1 => NetworkPriority::High,
            2 => NetworkPriority::Scheduled,
            _ => NetworkPriority::Urgent,
        }
    }

    /// Returns the connection size in bytes, including the sequence count and the run/idle header.
    pub const fn size(self) -> u16 {
        self.0 & SIZE
    }

    /// Returns whether packets may be shorter than the connection size.
    pub const fn is_variable(self) -> bool {
        self.0 & VARIABLE != 0
    }

    /// Returns whether several masters may own the outputs.
    pub const fn has_redundant_owner(self) -> bool {
        self.0 & OWNER != 0
    }
}

impl Transport {
    /// Transport of cyclic data: class 1, cyclic trigger, target as the client.
    pub const CYCLIC: Transport = Transport(0x01);

    /// Creates the transport from a received byte.
    pub const fn from_byte(byte: u8) -> Self {
        Transport(byte)
    }

    /// Returns the encoded byte.
    pub const fn byte(self) -> u8 {
        self.0
    }

    /// Returns the transport class. Class 1 carries data with a sequence count and without a reply. Class 3 carries
    /// messages.
    pub const fn transport_class(self) -> u8 {
        self.0 & 0x0F
    }

    /// Returns the trigger that makes the node produce data.
    pub const fn trigger(self) -> Trigger {
        match self.0 >> 4 & 7 {
            0 => Trigger::Cyclic,
            1 => Trigger::ChangeOfState,
            2 => Trigger::Application,
            other => Trigger::Unknown(other),
        }
    }

    /// Returns whether the target is the server.
    pub const fn is_server(self) -> bool {
        self.0 & 0x80 != 0
    }
}

impl ConnectionTimeout {
    /// Largest exponent, which means 512 intervals.
    const MAX_EXPONENT: u8 = 7;

    /// Creates the multiplier with the given exponent. Returns `None` for an exponent above 7.
    pub const fn new(number: u8) -> Option<Self> {
        if number <= ConnectionTimeout::MAX_EXPONENT { Some(ConnectionTimeout(number)) } else { None }
    }

    /// Returns the exponent.
    pub const fn exponent(self) -> u8 {
        self.0
    }

    /// Returns the time-out multiplier, which is 4 to 512 intervals.
    pub const fn interval_multiplier(self) -> u32 {
        4 << self.0
    }

    /// Returns the time-out of a connection with the given interval.
    pub const fn for_interval(self, interval: Duration) -> Duration {
        interval.saturating_mul(self.interval_multiplier())
    }
}

impl RequestTimeout {
    /// A time-out of two seconds: 250 ticks of 8 ms.
    pub const TWO_SECOND_TIMEOUT: RequestTimeout = RequestTimeout { priority_and_tick: 3, ticks: 250 };

    /// Returns the time-out as a duration.
    pub const fn duration(self) -> Duration {
        let tick_ms = 1u64 << (self.priority_and_tick & 0x0F);
        Duration::from_millis(tick_ms * self.ticks as u64)
    }
}
