//! Virtual devices, which simulate the device end of a connection at the level of bytes or voltages, and can have
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

/// A virtual device on a serial line. It is driven by its owner, such as a link in this process, a pseudo-terminal or a
/// TCP server. Time never runs backwards. If a call passes an earlier time than before, the latest time is used.
pub trait ByteDevice: Send {
    /// Takes bytes that the host passed to its UART at `now`. They are transmitted after any earlier bytes, and take
    /// one character time each.
    fn on_bytes(&mut self, now: Moment, bytes: &[u8]);

    /// Returns the bytes that have completely arrived at the host by `now`. Each byte is returned once.
    fn poll(&mut self, now: Moment) -> Vec<u8>;

    /// Returns when to call [`poll`](Self::poll) next, or `None` if nothing is pending.
    fn poll_at(&self) -> Option<Moment>;

    /// Sets the character format of the host's UART. If the device has another format, bytes are garbled in both
    /// directions, and no frame is valid. A device without a serial line ignores the format.
    fn set_host_format(&mut self, _now: Moment, _format: CharacterFormat) {}

    /// Opens or reopens the connection of the host. Earlier bytes are discarded, and a device that lost power is
    /// powered on again.
    fn connect(&mut self, now: Moment);
}

/// A virtual device that also receives datagrams. Times have the same meaning as for a [`ByteDevice`].
pub trait DatagramDevice: Send {
    /// Handles a packet received at `now`.
    fn on_datagram(&mut self, now: Moment, from: SocketAddrV4, packet: &[u8]);

    /// Returns the packets sent by `now`, with their destinations. Each packet is returned once.
    fn poll_datagrams(&mut self, now: Moment) -> Vec<(SocketAddrV4, Vec<u8>)>;

    /// Returns when to call [`poll_datagrams`](Self::poll_datagrams) next, or `None` if nothing is pending.
    fn poll_datagrams_at(&self) -> Option<Moment>;
}
