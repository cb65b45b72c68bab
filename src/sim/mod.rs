//! Virtual devices, which are the simulated side of a connection, at the level of bytes or voltages and with injected
//! faults. They are deterministic: the same seed and the same calls at the same times yield the same bytes.
//!
//! This module does not use clocks, threads, sockets or ports. Time is passed as an argument. The module uses neither
//! procedures nor `link/`, and shares only the tables of `protocol/` with the host side.

#![warn(missing_docs)]

mod fault;
pub(crate) mod line;
mod motor;
pub mod setting;
pub mod sine_cosine;

pub use fault::{ByteTransfer, FAULTS, FaultError, ReceivedByte, SimulatedFaults};
pub use motor::Motor;
pub use setting::{ConfigError, RPM, SEED, VirtualDevice};

use std::net::SocketAddrV4;

use crate::units::{CharacterFormat, Moment};

/// A virtual device on a serial line. Its owner drives it, for example a link in this process, a pseudo-terminal or a
/// TCP server. Time never runs backwards: a moment before the latest known one is replaced with the latest one.
pub trait ByteDevice: Send {
    /// Receives bytes that the host passed to its UART at `now`. They follow any bytes that are still being transmitted
    /// and take one character time each.
    fn on_bytes(&mut self, now: Moment, bytes: &[u8]);

    /// Returns the bytes that have completely arrived at the host by `now`. Each byte is returned once.
    fn poll(&mut self, now: Moment) -> Vec<u8>;

    /// Returns the time at which to call [`poll`](Self::poll) next, or `None` if nothing is scheduled.
    fn poll_at(&self) -> Option<Moment>;

    /// Sets the character format of the host's UART. If it differs from that of the device, bytes are garbled in both
    /// directions, and no frame is valid. A device without a serial line ignores the format.
    fn set_host_format(&mut self, _now: Moment, _format: CharacterFormat) {}

    /// Opens or reopens the connection of the host. Earlier bytes are discarded, and a device without power is powered
    /// on again.
    fn connect(&mut self, now: Moment);
}

/// A virtual device that also receives datagrams. Moments have the same meaning as for a [`ByteDevice`].
pub trait DatagramDevice: Send {
    /// Handles a packet received at `now`.
    fn on_datagram(&mut self, now: Moment, from: SocketAddrV4, packet: &[u8]);

    /// Returns the packets sent by `now`, with their destinations. Each packet is returned once.
    fn poll_datagrams(&mut self, now: Moment) -> Vec<(SocketAddrV4, Vec<u8>)>;

    /// Returns the time at which to call [`poll_datagrams`](Self::poll_datagrams) next, or `None` if nothing is
    /// scheduled.
    fn poll_datagrams_at(&self) -> Option<Moment>;
}
