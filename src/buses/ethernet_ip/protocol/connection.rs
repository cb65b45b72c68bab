//! The fields with which a connection is requested (reference 7; bits as by ODVA, `P`).

use std::time::Duration;

/// 16 bits that describe one direction. Unknown bits are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct NetworkParameters(u16);

/// Bits 14 and 13.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum NetworkType {
    /// 0: no data in this direction.
    Null,
    /// 1: to all listeners.
    Multicast,
    /// 2: to the other side only.
    PointToPoint,
    /// 3: reserved.
    Reserved,
}

/// Bits 11 and 10.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum NetworkPriority {
    /// 0.
    Low,
    /// 1.
    High,
    /// 2: used for cyclic data.
    Scheduled,
    /// 3.
    Urgent,
}

/// Byte that defines when data are sent, and by which side.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Transport(u8);

/// Bits 6 to 4 of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Trigger {
    /// 0: at an interval.
    Cyclic,
    /// 1: on a change.
    ChangeOfState,
    /// 2: on request of the application.
    Application,
    /// Another number.
    Unknown(u8),
}

/// Number of intervals without data after which a connection ends: 4 · 2ⁿ.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ConnectionTimeout(u8);

/// Time-out of a request: two bytes, priority with the length of a tick, and ticks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct RequestTimeout {
    /// Bits 3 to 0: a tick is 2ⁿ milliseconds; the others are kept.
    pub priority_and_tick: u8,
    /// Number of ticks.
    pub ticks: u8,
}

const OWNER: u16 = 1 << 15;
const VARIABLE: u16 = 1 << 9;
const SIZE: u16 = 0x01FF;

impl NetworkParameters {
    /// The most bytes that a connection may have.
    pub const MOST: u16 = SIZE;

    /// Creates the parameters of a connection of fixed size with one owner; `None` beyond 511 bytes. The size includes
    /// the sequence count and the run/idle header.
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

    /// Parses the word.
    pub const fn of_word(word: u16) -> Self {
        NetworkParameters(word)
    }

    /// Returns the word to send.
    pub const fn word(self) -> u16 {
        self.0
    }

    /// Returns the type of the connection: point-to-point, multicast or null.
    pub const fn kind(self) -> NetworkType {
        match self.0 >> 13 & 3 {
            0 => NetworkType::Null,
            1 => NetworkType::Multicast,
            2 => NetworkType::PointToPoint,
            _ => NetworkType::Reserved,
        }
    }

    /// Returns the priority.
    pub const fn priority(self) -> NetworkPriority {
        match self.0 >> 10 & 3 {
            0 => NetworkPriority::Low,
            1 => NetworkPriority::High,
            2 => NetworkPriority::Scheduled,
            _ => NetworkPriority::Urgent,
        }
    }

    /// Returns the number of bytes, with sequence count and run/idle header.
    pub const fn size(self) -> u16 {
        self.0 & SIZE
    }

    /// Returns whether less data than the size may be sent.
    pub const fn is_variable(self) -> bool {
        self.0 & VARIABLE != 0
    }

    /// Returns whether several masters may own the outputs.
    pub const fn redundant_owner(self) -> bool {
        self.0 & OWNER != 0
    }
}

impl Transport {
    /// Class 1, cyclic, as a client: used for cyclic data.
    pub const CYCLIC: Transport = Transport(0x01);

    /// Parses the byte.
    pub const fn of_byte(byte: u8) -> Self {
        Transport(byte)
    }

    /// Returns the byte to send.
    pub const fn byte(self) -> u8 {
        self.0
    }

    /// Returns 1: data with a count and without a reply; 3: messages.
    pub const fn class(self) -> u8 {
        self.0 & 0x0F
    }

    /// Returns when data are sent.
    pub const fn trigger(self) -> Trigger {
        match self.0 >> 4 & 7 {
            0 => Trigger::Cyclic,
            1 => Trigger::ChangeOfState,
            2 => Trigger::Application,
            other => Trigger::Unknown(other),
        }
    }

    /// The one that is asked is the server.
    pub const fn server(self) -> bool {
        self.0 & 0x80 != 0
    }
}

impl ConnectionTimeout {
    /// The largest number: 512 intervals.
    const MOST: u8 = 7;

    /// Returns the slot with this number; `None` beyond 7.
    pub const fn new(number: u8) -> Option<Self> {
        if number <= ConnectionTimeout::MOST { Some(ConnectionTimeout(number)) } else { None }
    }

    /// Returns the number to send.
    pub const fn number(self) -> u8 {
        self.0
    }

    /// Returns 4 to 512.
    pub const fn intervals(self) -> u32 {
        4 << self.0
    }

    /// Returns the time-out of a connection with this interval.
    pub const fn after(self, interval: Duration) -> Duration {
        interval.saturating_mul(self.intervals())
    }
}

impl RequestTimeout {
    /// 250 ticks of 8 ms: two seconds.
    pub const TWO_SECONDS: RequestTimeout = RequestTimeout { priority_and_tick: 3, ticks: 250 };

    /// Returns the duration.
    pub const fn duration(self) -> Duration {
        let tick_ms = 1u64 << (self.priority_and_tick & 0x0F);
        Duration::from_millis(tick_ms * self.ticks as u64)
    }
}
