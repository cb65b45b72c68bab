//! The virtual devices: the other end of a wire, byte for byte or as voltages, with its faults. Deterministic: the same
//! seed and the same calls at the same moments give the same bytes.
//!
//! Never in here: a clock, a thread, a socket or a port (time is handed in), nor anything of procedures or `link/`; only
//! the tables of `protocol/` are shared with the host's side.

#![warn(missing_docs)]

mod fault;
pub(crate) mod line;
mod motor;
pub mod setting;
pub mod sine_cosine;

pub use fault::{Carried, FAULTS, FaultError, Faults, Passage};
pub use motor::Motor;
pub use setting::{ConfigError, RPM, SEED, VirtualDevice};

use std::net::SocketAddrV4;

use crate::units::{CharacterFormat, Moment};

/// A virtual device at the far end of a serial line. Its owner (a link in this process, a pseudo-terminal, a TCP
/// server) passes bytes in and requests bytes; moments never run backwards, an earlier one counts as the latest known.
pub trait ByteDevice: Send {
    /// The host has handed these bytes to its UART at `now`; they travel one character time each, after what is still
    /// travelling.
    fn on_bytes(&mut self, now: Moment, bytes: &[u8]);

    /// Bytes that have completely arrived at the host by `now` and were not fetched yet.
    fn poll(&mut self, now: Moment) -> Vec<u8>;

    /// Returns when [`poll`](Self::poll) should be called next; `None` if nothing will happen by itself.
    fn poll_at(&self) -> Option<Moment>;

    /// Sets the format of the host's UART. If it differs from the device's setting, bytes arrive garbled in both
    /// directions, and no valid frame results. A device without a serial line has no setting.
    fn set_host_format(&mut self, _now: Moment, _format: CharacterFormat) {}

    /// The host opened the link (again): what arrived before has no reader, and a device that lost its power gets it
    /// back now.
    fn connect(&mut self, now: Moment);
}

/// A virtual device that is also sent datagrams. Moments as for a [`ByteDevice`].
pub trait DatagramDevice: Send {
    /// A packet has come at `now`, from there.
    fn on_datagram(&mut self, now: Moment, from: SocketAddrV4, packet: &[u8]);

    /// Packets that have left by `now` and were not fetched yet, with where they go.
    fn poll_datagrams(&mut self, now: Moment) -> Vec<(SocketAddrV4, Vec<u8>)>;

    /// Returns when [`poll_datagrams`](Self::poll_datagrams) should be called next; `None` if nothing will happen by
    /// itself.
    fn poll_datagrams_at(&self) -> Option<Moment>;
}
