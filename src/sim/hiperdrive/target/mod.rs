//! An EtherNet/IP target in front of a station: TCP connections and the datagrams of all of them, with their faults.

use std::net::{Ipv4Addr, SocketAddrV4};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::config::Config;
use super::station::Station;
use crate::sim::{ByteDevice, DatagramDevice};
use crate::units::{CharacterFormat, Moment};

/// A TCP connection to a virtual adapter or hub, and all its datagrams. Made of a [`Config`];
/// [`connection`](Self::connection) gives another originator's, and so does a clone.
#[derive(Debug)]
pub struct Target {
    shared: Arc<Mutex<Plant>>,
    peer: Ipv4Addr,
}

/// What has come and gone so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Figures {
    /// Whole frames over TCP.
    pub frames: u64,
    /// Streams that were no frames.
    pub broken: u64,
    /// Packets of the cyclic connection that counted.
    pub packets: u64,
    /// Of it, but older than one that came before, or the same again.
    pub stale: u64,
    /// Datagrams that were neither a packet nor a frame, or of a wrong length.
    pub malformed: u64,
    /// Packets of a connection that there is not.
    pub foreign: u64,
}

/// What all connections have in common.
#[derive(Debug)]
struct Plant {
    station: Station,
    figures: Figures,
}

impl Target {
    /// The virtual device as `config` wants it.
    pub fn new(config: &Config) -> Self {
        let plant = Plant { station: Station::of(config), figures: Figures::default() };
        Target { shared: Arc::new(Mutex::new(plant)), peer: Ipv4Addr::LOCALHOST }
    }

    /// Another originator's connection to the same device.
    pub fn connection(&self, peer: Ipv4Addr) -> Self {
        Target { shared: self.shared.clone(), peer }
    }

    /// Looks at the station, or does something to it that no bus can.
    pub fn with<T>(&self, work: impl FnOnce(&mut Station) -> T) -> T {
        work(&mut self.lock().station)
    }

    /// What has come and gone so far.
    pub fn figures(&self) -> Figures {
        self.lock().figures
    }

    fn lock(&self) -> MutexGuard<'_, Plant> {
        // A virtual device left behind by a panicking test is still a device.
        self.shared.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Clone for Target {
    fn clone(&self) -> Self {
        self.connection(self.peer)
    }
}

impl ByteDevice for Target {
    fn on_bytes(&mut self, _now: Moment, _bytes: &[u8]) {}

    fn poll(&mut self, _now: Moment) -> Vec<u8> {
        Vec::new()
    }

    fn poll_at(&self) -> Option<Moment> {
        None
    }

    /// There is no serial line.
    fn set_host_format(&mut self, _now: Moment, _format: CharacterFormat) {}

    fn connect(&mut self, _now: Moment) {}
}

impl DatagramDevice for Target {
    fn on_datagram(&mut self, _now: Moment, _from: SocketAddrV4, _packet: &[u8]) {}

    fn poll_datagrams(&mut self, _now: Moment) -> Vec<(SocketAddrV4, Vec<u8>)> {
        Vec::new()
    }

    fn poll_datagrams_at(&self) -> Option<Moment> {
        None
    }
}
