//! Virtual devices: the simulated side of a connection, byte by byte or as voltages, with injected faults.
//! Deterministic: the same seed and the same calls at the same moments yield the same bytes.
//!
//! This module uses no clock, thread, socket or port (time is an argument), and neither procedures nor `link/`; only
//! the tables of `protocol/` are shared with the host side.

#![warn(missing_docs)]

mod fault;
pub(crate) mod line;
mod motor;
pub mod setting;
pub mod sine_cosine;

pub use fault::{BytePassage, Carried, FAULTS, FaultError, Faults};
pub use motor::Motor;
pub use setting::{ConfigError, RPM, SEED, VirtualDevice};

use std::net::SocketAddrV4;

use crate::units::{CharacterFormat, Moment};

/// A virtual device on a serial line. Its owner (a link in this process, a pseudo-terminal, a TCP server) passes bytes
/// in and fetches bytes; moments never run backwards, an earlier one counts as the latest known.
pub trait ByteDevice: Send {
    /// Receives bytes that the host has passed to its UART at `now`. They are transmitted one character time each,
    /// after the bytes still in transmission.
    fn on_bytes(&mut self, now: Moment, bytes: &[u8]);

    /// Returns the bytes that have completely arrived at the host by `now` and have not been fetched yet.
    fn poll(&mut self, now: Moment) -> Vec<u8>;

    /// Returns when [`poll`](Self::poll) should be called next, or `None` if nothing is scheduled.
    fn poll_at(&self) -> Option<Moment>;

    /// Sets the character format of the host's UART. If it differs from the setting of the device, bytes arrive garbled
    /// in both directions, and no valid frame results. A device without a serial line has no such setting.
    fn set_host_format(&mut self, _now: Moment, _format: CharacterFormat) {}

    /// Opens or reopens the connection of the host: bytes that arrived before are discarded, and a device without power
    /// is powered again.
    fn connect(&mut self, now: Moment);
}

/// A virtual device that also receives datagrams. Moments behave as for a [`ByteDevice`].
pub trait DatagramDevice: Send {
    /// Handles a packet received at `now`.
    fn on_datagram(&mut self, now: Moment, from: SocketAddrV4, packet: &[u8]);

    /// Returns the packets sent by `now` and not fetched yet, with their targets.
    fn poll_datagrams(&mut self, now: Moment) -> Vec<(SocketAddrV4, Vec<u8>)>;

    /// Returns when [`poll_datagrams`](Self::poll_datagrams) should be called next, or `None` if nothing is scheduled.
    fn poll_datagrams_at(&self) -> Option<Moment>;
}
