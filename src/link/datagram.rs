//! Packets in addition to a stream of bytes: cyclic data, which the next packet makes outdated, and which are not sent
//! again if lost.

use core::net::{Ipv4Addr, SocketAddrV4};

use super::LinkError;
use crate::units::Moment;

/// Packets to and from one target.
pub trait Datagrams: Send {
    /// Returns the port of ours to which the target has to send.
    fn port(&self) -> u16;

    /// Sends further packets to this port of the target.
    fn aim(&mut self, port: u16);

    /// Also receives the packets that the target sends to a multicast group. In this process there is only one receiver.
    ///
    /// # Errors
    /// Returns an error if the group cannot be joined.
    fn join(&mut self, _group: SocketAddrV4) -> Result<(), LinkError> {
        Ok(())
    }

    /// Sends one packet. Delivery is not confirmed.
    ///
    /// # Errors
    /// Returns an error if the target cannot be reached.
    fn send(&mut self, packet: &[u8]) -> Result<(), LinkError>;

    /// Waits for a packet of the target until `until`, and replaces the content of `into` with it. Returns false when the
    /// time is up. Packets of other senders are dropped.
    ///
    /// # Errors
    /// Returns an error if the target cannot be reached.
    fn receive(&mut self, until: Moment, into: &mut Vec<u8>) -> Result<bool, LinkError>;
}

/// Opens channels for packets to and from a target.
pub trait DatagramPort: Send {
    /// Opens a local port.
    ///
    /// # Errors
    /// Returns an error if there is none, or the target cannot be reached.
    fn open(&mut self) -> Result<Box<dyn Datagrams>, LinkError>;
}

/// A request to all devices of a network, with their answers.
pub trait Broadcast: Send {
    /// Asks all.
    ///
    /// # Errors
    /// Returns an error if no request can be sent at all.
    fn broadcast(&mut self, packet: &[u8]) -> Result<(), LinkError>;

    /// Waits for a packet until `until` and replaces the content of `into` with it. Returns the sender, or `None` when the
    /// time is up.
    ///
    /// # Errors
    /// Returns an error if the network is lost.
    fn receive(&mut self, until: Moment, into: &mut Vec<u8>) -> Result<Option<Ipv4Addr>, LinkError>;
}
