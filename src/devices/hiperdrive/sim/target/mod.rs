//! The EtherNet/IP target of a virtual station (reference, section 7), with several TCP connections and their
//! datagrams.
//!
//! Assumptions (`U`: not documented):
//! - A session ends with its TCP connection. A cyclic connection ends only by its own time-out, since its packets show
//!   that the master is alive.
//! - Bytes that are not frames, and UnRegisterSession, end the TCP connection.
//! - A target that has lost its supply replies again once a new connection is opened.
//!
//! | file | content |
//! |---|---|
//! | `device` | state shared by all connections: time, sessions, faults |
//! | `frames` | frames and their replies |
//! | `objects` | the CIP objects for identity and parameters |
//! | `network` | the TCP/IP and Ethernet objects |
//! | `connections` | the connection manager |
//! | `cyclic` | the cyclic connection, packet by packet |

mod connections;
mod cyclic;
mod device;
mod frames;
mod network;
mod objects;
#[cfg(test)]
mod tests;

use std::net::{Ipv4Addr, SocketAddrV4};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use device::{Originator, TargetDevice};

use super::config::Config;
use super::station::Station;
use crate::buses::ethernet_ip::protocol::Receiver;
use crate::sim::line::TransitQueue;
use crate::sim::{ByteDevice, DatagramDevice, SimulatedFaults};
use crate::units::Moment;

/// A TCP connection from one originator to a virtual adapter or hub, together with the datagrams of all originators. It
/// is created from a [`Config`]. Further originators connect with [`connect_from`](Self::connect_from) or by cloning.
#[derive(Debug)]
pub struct Target {
    shared: Arc<Mutex<TargetDevice>>,
    originator: Originator,
    receiver: Receiver,
    to_host: TransitQueue<Vec<u8>>,
    ended: bool,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TrafficCounters {
    /// Number of complete frames received over TCP.
    pub frames: u64,
    /// Number of TCP streams that contained something other than frames.
    pub broken: u64,
    pub packets: u64,
    /// Number of packets that were repeated or older than an earlier packet of the connection.
    pub stale: u64,
    /// Number of datagrams with a wrong length, or that were neither a packet nor a frame.
    pub malformed: u64,
    /// Number of packets for connections that do not exist.
    pub foreign: u64,
}

impl Target {
    pub fn new(config: &Config) -> Self {
        Target::with_device(Arc::new(Mutex::new(TargetDevice::new(config))), Ipv4Addr::LOCALHOST)
    }

    /// Connects another originator, with this address, to the same device.
    pub fn connect_from(&self, peer: Ipv4Addr) -> Self {
        Target::with_device(self.shared.clone(), peer)
    }

    fn with_device(shared: Arc<Mutex<TargetDevice>>, peer: Ipv4Addr) -> Self {
        let originator = lock(&shared).add_originator(peer);
        Target { shared, originator, receiver: Receiver::default(), to_host: TransitQueue::default(), ended: false }
    }

    /// Calls `work` with the station, to read it or to change it in ways that are not possible over a bus.
    pub fn with_station<T>(&self, work: impl FnOnce(&mut Station) -> T) -> T {
        work(&mut self.lock().station)
    }

    /// Switches the supply off and on. Sessions, connections and unsaved values are lost.
    pub fn power_cycle(&self) {
        self.lock().power_cycle();
    }

    /// Sets the address and port that the device reports for TCP and UDP, and to which cyclic data must be sent.
    pub fn set_address(&self, at: SocketAddrV4) {
        let mut plant = self.lock();
        (plant.listens, plant.udp) = (at, at.port());
    }

    /// Replaces the injected faults, without resetting the counts of frames and saves.
    pub fn set_faults(&self, faults: &SimulatedFaults) {
        self.lock().set_faults(faults);
    }

    pub fn traffic_counters(&self) -> TrafficCounters {
        self.lock().figures
    }

    pub const fn has_ended(&self) -> bool {
        self.ended
    }

    fn lock(&self) -> MutexGuard<'_, TargetDevice> {
        lock(&self.shared)
    }
}

fn lock(shared: &Mutex<TargetDevice>) -> MutexGuard<'_, TargetDevice> {
    // The virtual device stays usable after a test has panicked.
    shared.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Clone for Target {
    fn clone(&self) -> Self {
        self.connect_from(self.originator.address)
    }
}

impl Drop for Target {
    fn drop(&mut self) {
        let originator = self.originator;
        self.lock().disconnect_originator(originator);
    }
}

impl ByteDevice for Target {
    fn on_bytes(&mut self, now: Moment, bytes: &[u8]) {
        self.receiver.push(bytes);
        while !self.ended {
            let mut plant = lock(&self.shared);
            match self.receiver.next_frame() {
                Ok(Some(frame)) => {
                    let reply = plant.handle_frame(now, self.originator, &frame);
                    self.ended = !plant.keeps_connection_open(&frame);
                    drop(plant);
                    reply.into_iter().for_each(|(at, bytes)| self.to_host.insert(at, bytes));
                }
                Ok(None) => break,
                Err(_) => {
                    plant.figures.broken += 1;
                    plant.disconnect_originator(self.originator);
                    self.ended = true;
                }
            }
        }
    }

    fn poll(&mut self, now: Moment) -> Vec<u8> {
        self.lock().advance_to(now);
        std::iter::from_fn(|| self.to_host.pop_until(now)).flatten().collect()
    }

    fn poll_at(&self) -> Option<Moment> {
        self.to_host.next_due()
    }

    fn connect(&mut self, now: Moment) {
        (self.receiver, self.to_host, self.ended) = (Receiver::default(), TransitQueue::default(), false);
        let originator = self.originator;
        let mut plant = self.lock();
        plant.disconnect_originator(originator);
        plant.update_supply(now);
    }
}

impl DatagramDevice for Target {
    fn on_datagram(&mut self, now: Moment, from: SocketAddrV4, packet: &[u8]) {
        self.lock().on_datagram(now, from, packet);
    }

    fn poll_datagrams(&mut self, now: Moment) -> Vec<(SocketAddrV4, Vec<u8>)> {
        self.lock().poll_datagrams(now)
    }

    fn poll_datagrams_at(&self) -> Option<Moment> {
        self.lock().poll_datagrams_at()
    }
}
