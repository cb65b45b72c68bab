//! `sim:`: a virtual device in this process. With a virtual clock, no real time passes while a reply is awaited.

use std::collections::VecDeque;
use std::net::{Ipv4Addr, SocketAddrV4};
use std::sync::{Arc, Mutex, PoisonError};

use super::{ByteLink, Clock, DatagramChannel, DatagramPort, LinkError};
use crate::sim::{ByteDevice, DatagramDevice};
use crate::units::{CharacterFormat, Moment};

/// A connection to a virtual device. Tests and other links can share the device.
pub struct SimLink {
    device: Arc<Mutex<dyn ByteDevice>>,
    clock: Arc<dyn Clock>,
}

impl SimLink {
    /// Connects to a device.
    pub fn connect(device: Arc<Mutex<dyn ByteDevice>>, clock: Arc<dyn Clock>) -> Self {
        let link = SimLink { device, clock };
        let now = link.clock.now();
        link.with_device(|device| device.connect(now));
        link
    }

    fn with_device<T>(&self, work: impl FnOnce(&mut dyn ByteDevice) -> T) -> T {
        // After a panic in a test, the virtual device is still valid.
        let mut device = self.device.lock().unwrap_or_else(PoisonError::into_inner);
        work(&mut *device)
    }
}

impl ByteLink for SimLink {
    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        let now = self.clock.now();
        self.with_device(|device| device.on_bytes(now, bytes));
        Ok(())
    }

    fn receive(&mut self, until: Moment, into: &mut Vec<u8>) -> Result<(), LinkError> {
        loop {
            let now = self.clock.now();
            let (bytes, next) = self.with_device(|device| (device.poll(now), device.poll_at()));
            if !bytes.is_empty() {
                into.extend(bytes);
                return Ok(());
            }
            if now >= until {
                return Ok(());
            }
            self.clock.sleep_until(next.map_or(until, |next| next.min(until)));
        }
    }

    fn set_format(&mut self, format: CharacterFormat) -> Result<(), LinkError> {
        let now = self.clock.now();
        self.with_device(|device| device.set_host_format(now, format));
        Ok(())
    }

    fn check_connection(&mut self) -> Result<(), LinkError> {
        Ok(())
    }
}

/// A factory for datagram channels to a virtual device.
pub struct SimPort {
    device: Arc<Mutex<dyn DatagramDevice>>,
    clock: Arc<dyn Clock>,
    next: u16,
}

/// Port of the first channel, chosen arbitrarily.
const FIRST_PORT: u16 = 50_000;

impl SimPort {
    /// Creates a factory for datagram channels to a device.
    pub fn new(device: Arc<Mutex<dyn DatagramDevice>>, clock: Arc<dyn Clock>) -> Self {
        SimPort { device, clock, next: FIRST_PORT }
    }
}

impl DatagramPort for SimPort {
    fn open(&mut self) -> Result<Box<dyn DatagramChannel>, LinkError> {
        // Packets in transit to the previous port are dropped.
        let port = self.next;
        self.next = self.next.checked_add(1).unwrap_or(FIRST_PORT);
        let (device, clock) = (self.device.clone(), self.clock.clone());
        Ok(Box::new(SimDatagrams { device, clock, port, arrived: VecDeque::new() }))
    }
}

struct SimDatagrams {
    device: Arc<Mutex<dyn DatagramDevice>>,
    clock: Arc<dyn Clock>,
    port: u16,
    arrived: VecDeque<Vec<u8>>,
}

impl SimDatagrams {
    fn with_device<T>(&self, work: impl FnOnce(&mut dyn DatagramDevice) -> T) -> T {
        let mut device = self.device.lock().unwrap_or_else(PoisonError::into_inner);
        work(&mut *device)
    }
}

impl DatagramChannel for SimDatagrams {
    fn port(&self) -> u16 {
        self.port
    }

    fn set_target_port(&mut self, _port: u16) {
        // The virtual device is the only receiver.
    }

    fn send(&mut self, packet: &[u8]) -> Result<(), LinkError> {
        let (now, from) = (self.clock.now(), SocketAddrV4::new(Ipv4Addr::UNSPECIFIED, self.port));
        self.with_device(|device| device.on_datagram(now, from, packet));
        Ok(())
    }

    fn receive(&mut self, until: Moment, into: &mut Vec<u8>) -> Result<bool, LinkError> {
        loop {
            let now = self.clock.now();
            let (packets, next) = self.with_device(|device| (device.poll_datagrams(now), device.poll_datagrams_at()));
            let own = packets.into_iter().filter(|(to, _)| to.port() == self.port).map(|(_, packet)| packet);
            self.arrived.extend(own);
            if let Some(packet) = self.arrived.pop_front() {
                *into = packet;
                return Ok(true);
            }
            if now >= until {
                return Ok(false);
            }
            self.clock.sleep_until(next.map_or(until, |next| next.min(until)));
        }
    }
}
