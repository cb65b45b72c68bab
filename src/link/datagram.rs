//! Datagrams in addition to a byte stream, used for cyclic data, which the next packet supersedes and which are not
//! repeated if lost.

use core::net::{Ipv4Addr, SocketAddrV4};

use super::LinkError;
use crate::units::Moment;

/// Datagrams to and from a single target.
pub trait DatagramChannel: Send {
    /// Returns the local port to which the target must send.
    fn port(&self) -> u16;

    /// Sends subsequent packets to this port of the target.
    fn set_target_port(&mut self, port: u16);

    /// Also receives packets that the target sends to a multicast group. Virtual devices have a single receiver and
    /// ignore this call.
    ///
    /// # Errors
    /// The group cannot be joined.
    fn join(&mut self, _group: SocketAddrV4) -> Result<(), LinkError> {
        Ok(())
    }

    /// Sends a packet. Delivery is not confirmed.
    ///
    /// # Errors
    /// The target cannot be reached.
    fn send(&mut self, packet: &[u8]) -> Result<(), LinkError>;

    /// Waits until `until` for a packet from the target and stores it in `into`. Returns `false` on time-out. Packets
    /// from other senders are dropped.
    ///
    /// # Errors
    /// The target cannot be reached.
    fn receive(&mut self, until: Moment, into: &mut Vec<u8>) -> Result<bool, LinkError>;
}

/// A factory for datagram channels to a target.
pub trait DatagramPort: Send {
    /// Opens a channel on a local port.
    ///
    /// # Errors
    /// No port is available, or the target cannot be reached.
    fn open(&mut self) -> Result<Box<dyn DatagramChannel>, LinkError>;
}

/// A channel for requests to all devices in a network, and for their replies.
pub trait BroadcastChannel: Send {
    /// Sends a request to all devices.
    ///
    /// # Errors
    /// The request cannot be sent on any network.
    fn broadcast(&mut self, packet: &[u8]) -> Result<(), LinkError>;

    /// Waits until `until` for a packet and stores it in `into`. Returns the sender, or `None` on time-out.
    ///
    /// # Errors
    /// The network connection is lost.
    fn receive(&mut self, until: Moment, into: &mut Vec<u8>) -> Result<Option<Ipv4Addr>, LinkError>;
}
