//! Packets beside a stream of bytes: cyclic data that are old with the next ones, and are not sent again when one is lost.

use core::net::{Ipv4Addr, SocketAddrV4};

use super::LinkError;
use crate::units::Moment;

/// Packets to and from one target.
pub trait Datagrams: Send {
    /// The port of ours to which the target has to send.
    fn port(&self) -> u16;

    /// Sends further packets to this port of the target.
    fn aim(&mut self, port: u16);

    /// Packets of the target also go to all who listen there, and are taken from there as well. In this process there is only
    /// one who listens.
    ///
    /// # Errors
    /// When there is no way to listen.
    fn join(&mut self, _group: SocketAddrV4) -> Result<(), LinkError> {
        Ok(())
    }

    /// Sends one packet. Delivery is not confirmed.
    ///
    /// # Errors
    /// When there is no way to the target.
    fn send(&mut self, packet: &[u8]) -> Result<(), LinkError>;

    /// Waits until a packet of the target arrives, at most until `until`, and puts it into `into` instead of what was there.
    /// False: the time is up. What others send is dropped.
    ///
    /// # Errors
    /// When there is no way to the target.
    fn receive(&mut self, until: Moment, into: &mut Vec<u8>) -> Result<bool, LinkError>;
}

/// Opens channels for packets to and from a target.
pub trait DatagramPort: Send {
    /// Opens a local port.
    ///
    /// # Errors
    /// There is none, or no way to the target.
    fn open(&mut self) -> Result<Box<dyn Datagrams>, LinkError>;
}

/// A question to all who listen, and what any of them answers.
pub trait Broadcast: Send {
    /// Asks all.
    ///
    /// # Errors
    /// Returns an error if no request can be sent at all.
    fn broadcast(&mut self, packet: &[u8]) -> Result<(), LinkError>;

    /// Waits for a packet until `until` and puts it into `into`, replacing the content. Returns the sender, or `None`
    /// when the time is up.
    ///
    /// # Errors
    /// When the network is gone.
    fn receive(&mut self, until: Moment, into: &mut Vec<u8>) -> Result<Option<Ipv4Addr>, LinkError>;
}
