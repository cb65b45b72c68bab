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

pub use fault::{ByteTransfer, Carried, FAULTS, FaultError, SimulatedFaults};
pub use motor::Motor;
pub use setting::{ConfigError, RPM, SEED, VirtualDevice};

use std::net::SocketAddrV4;

use crate::units::{CharacterFormat, Moment};

/// A virtual device on a serial line, driven by its owner, such as a link in this process, a pseudo-terminal or a TCP
/// server. Moments never run backwards; an earlier moment counts as the latest known.
pub trait ByteDevice: Send {
    /// Receives bytes that the host has passed to its UART at `now`. They are transmitted at one character time each,
    /// after any bytes still in transmission.
    fn on_bytes(&mut self, now: Moment, bytes: &[u8]);

    /// Returns the bytes that have completely arrived at the host by `now` and have not been fetched yet.
    fn poll(&mut self, now: Moment) -> Vec<u8>;

    /// Returns the time at which to call [`poll`](Self::poll) next, or `None` if nothing is scheduled.
    fn poll_at(&self) -> Option<Moment>;

    /// Sets the character format of the host's UART. If the format differs from the setting of the device, bytes arrive
    /// garbled in both directions and no valid frame results. A device without a serial line has no such setting.
    fn set_host_format(&mut self, _now: Moment, _format: CharacterFormat) {}

    /// Opens or reopens the connection of the host. Bytes that arrived before are discarded, and a device that has lost
    /// power is powered again.
    fn connect(&mut self, now: Moment);
}

/// A virtual device that also receives datagrams. Moments behave as for a [`ByteDevice`].
pub trait DatagramDevice: Send {
    /// Handles a packet received at `now`.
    fn on_datagram(&mut self, now: Moment, from: SocketAddrV4, packet: &[u8]);

    /// Returns the packets sent by `now` that have not been fetched yet, with their destinations.
    fn poll_datagrams(&mut self, now: Moment) -> Vec<(SocketAddrV4, Vec<u8>)>;

    /// Returns the time at which to call [`poll_datagrams`](Self::poll_datagrams) next, or `None` if nothing is
    /// scheduled.
    fn poll_datagrams_at(&self) -> Option<Moment>;
}
