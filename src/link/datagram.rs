//! Datagram channels for cyclic data, used in addition to a byte stream. A lost packet is not sent again, because the
//! next packet replaces it.

use core::net::{Ipv4Addr, SocketAddrV4};

use super::LinkError;
use crate::units::Moment;

/// A channel for datagrams to and from a single target.
pub trait DatagramChannel: Send {
    /// Returns the local port to which the target must send its packets.
    fn port(&self) -> u16;

    /// Sets the port of the target to which further packets are sent.
    fn set_target_port(&mut self, port: u16);

    /// Joins a multicast group to which the target sends packets. Virtual devices have a single receiver and ignore
    /// this call.
    ///
    /// # Errors
    /// Returns an error if the group cannot be joined.
    fn join(&mut self, _group: SocketAddrV4) -> Result<(), LinkError> {
        Ok(())
    }

    /// Sends a packet. Delivery is not confirmed.
    ///
    /// # Errors
    /// Returns an error if the target cannot be reached.
    fn send(&mut self, packet: &[u8]) -> Result<(), LinkError>;

    /// Waits for a packet from the target and stores it in `into`. Returns `false` if none arrives before `until`.
    /// Packets from other senders are dropped.
    ///
    /// # Errors
    /// Returns an error if the target cannot be reached.
    fn receive(&mut self, until: Moment, into: &mut Vec<u8>) -> Result<bool, LinkError>;
}

/// A factory for datagram channels to a target.
pub trait DatagramPort: Send {
    /// Opens a channel on a local port.
    ///
    /// # Errors
    /// Returns an error if no port is available or the target cannot be reached.
    fn open(&mut self) -> Result<Box<dyn DatagramChannel>, LinkError>;
}

/// A channel for broadcast requests and their replies.
pub trait BroadcastChannel: Send {
    /// Sends a request to all devices in the network.
    ///
    /// # Errors
    /// Returns an error if the request could not be sent on any network.
    fn broadcast(&mut self, packet: &[u8]) -> Result<(), LinkError>;

    /// Waits for a packet, stores it in `into` and returns its sender. Returns `None` if no packet arrives before
    /// `until`.
    ///
    /// # Errors
    /// Returns an error if the network connection was lost.
    fn receive(&mut self, until: Moment, into: &mut Vec<u8>) -> Result<Option<Ipv4Addr>, LinkError>;
}
