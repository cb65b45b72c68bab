//! State shared by all connections to a target: time, sessions and injected faults.

use std::collections::BTreeMap;
use std::net::{Ipv4Addr, SocketAddrV4};
use std::time::Duration;

use fastrand::Rng;

use super::super::config::Config;
use super::super::station::Station;
use super::TrafficCounters;
use super::connections::Connections;
use super::network::Network;
use crate::buses::ethernet_ip::protocol::{Command, EXPLICIT_MESSAGE_PORT, Frame, IMPLICIT_MESSAGE_PORT};
use crate::devices::hiperdrive::protocol::ByteOrder;
use crate::sim::SimulatedFaults;
use crate::sim::line::TransitQueue;
use crate::units::Moment;

/// The virtual device, with the state of all connections to it.
#[derive(Debug)]
pub(super) struct TargetDevice {
    pub(super) station: Station,
    pub(super) network: Network,
    pub(super) connections: Connections,
    pub(super) order: ByteOrder,
    pub(super) counted_texts: bool,
    pub(super) listens: SocketAddrV4,
    pub(super) udp: u16,
    pub(super) figures: TrafficCounters,
    pub(super) now: Moment,
    pub(super) sessions: BTreeMap<u32, Originator>,
    pub(super) datagrams: TransitQueue<(SocketAddrV4, Vec<u8>)>,
    pub(super) rng: Rng,
    faults: SimulatedFaults,
    heard: u32,
    originators: u64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Originator {
    number: u64,
    pub(super) address: Ipv4Addr,
}

const REPLY: Duration = Duration::from_millis(1);

impl TargetDevice {
    pub(super) fn new(config: &Config) -> Self {
        TargetDevice {
            station: Station::from_config(config),
            network: Network::new(config.switch, config.serial_number),
            connections: Connections::default(),
            order: config.order,
            counted_texts: config.counted_texts,
            listens: SocketAddrV4::new(Ipv4Addr::UNSPECIFIED, EXPLICIT_MESSAGE_PORT),
            udp: IMPLICIT_MESSAGE_PORT,
            figures: TrafficCounters::default(),
            now: Moment::START,
            sessions: BTreeMap::new(),
            datagrams: TransitQueue::default(),
            rng: Rng::with_seed(config.seed),
            faults: config.faults.clone(),
            heard: 0,
            originators: 0,
        }
    }

    pub(super) const fn add_originator(&mut self, address: Ipv4Addr) -> Originator {
        self.originators += 1;
        Originator { number: self.originators, address }
    }

    pub(super) fn set_faults(&mut self, faults: &SimulatedFaults) {
        self.station.set_failing_save(faults.save_with_power_failure());
        self.faults = faults.clone();
    }

    pub(super) fn advance_to(&mut self, now: Moment) {
        self.now = self.now.max(now);
        self.send_due_packets();
        self.connections.remove_timed_out(self.now);
        if self.station.is_dead(self.now) {
            self.disconnect();
        }
    }

    /// Handles a frame received over TCP. Returns the reply and the time to send it, unless there is no reply or a
    /// fault drops it.
    pub(super) fn handle_frame(&mut self, now: Moment, from: Originator, frame: &Frame) -> Option<(Moment, Vec<u8>)> {
        self.advance_to(now);
        self.figures.frames += 1;
        if !self.register_arrival() {
            return None;
        }
        let reply = self.reply_to(from, frame)?;
        let leaves = self.station.delayed_reply_time().map_or(self.now, |at| at.max(self.now));
        let bytes = self.apply_faults(reply.emit()).filter(|_| !self.station.is_cut_off())?;
        Some((leaves + REPLY + self.faults.reply_delay(), bytes))
    }

    /// Returns whether the TCP connection stays open after this frame.
    pub(super) fn keeps_connection_open(&self, frame: &Frame) -> bool {
        frame.command != Command::UNREGISTER_SESSION
    }

    /// Ends the TCP connection of an originator, together with its session and its explicit connections.
    pub(super) fn disconnect_originator(&mut self, originator: Originator) {
        let own: Vec<u32> = self.sessions.iter().filter(|(_, owner)| **owner == originator).map(|(s, _)| *s).collect();
        own.into_iter().for_each(|session| self.end_session(session));
    }

    pub(super) fn end_session(&mut self, session: u32) {
        self.sessions.remove(&session);
        self.connections.end_session(session);
    }

    pub(super) fn update_supply(&mut self, now: Moment) {
        self.advance_to(now);
        if self.station.is_dead(self.now) {
            self.power_cycle();
        }
    }

    pub(super) fn power_cycle(&mut self) {
        self.station.power_cycle(self.now);
        self.network.power_up();
        self.disconnect();
    }

    fn disconnect(&mut self) {
        self.sessions.clear();
        self.connections = Connections::after_power_loss(&self.connections);
        self.datagrams = TransitQueue::default();
    }

    /// Counts a received frame or packet, and returns whether the target handles it.
    pub(super) fn register_arrival(&mut self) -> bool {
        let speaks = self.can_send();
        self.heard = self.heard.saturating_add(1);
        speaks && !self.station.is_dead(self.now)
    }

    pub(super) fn can_send(&self) -> bool {
        !self.station.is_cut_off() && self.faults.silent_after().is_none_or(|count| self.heard < count)
    }

    pub(super) fn decide_delivery(&mut self) -> bool {
        self.faults.transmit_byte(&mut self.rng, 0).carried.is_some()
    }

    /// Applies the injected faults to a packet. Ethernet delivers a packet completely or not at all, so a fault that
    /// would affect one byte on a serial line affects the whole packet here.
    pub(super) fn apply_faults(&mut self, mut bytes: Vec<u8>) -> Option<Vec<u8>> {
        let passage = self.faults.transmit_byte(&mut self.rng, 0);
        let carried = passage.carried?;
        if passage.inserted.is_some() {
            bytes.iter_mut().for_each(|byte| *byte = self.rng.u8(..));
        } else if carried.flipped
            && let Some(byte) = self.rng.choice(&mut bytes)
        {
            *byte ^= carried.byte;
        }
        Some(bytes)
    }

    /// Sends a datagram at the given time, unless an injected fault drops it.
    pub(super) fn send(&mut self, at: Moment, to: SocketAddrV4, bytes: Vec<u8>) {
        if let Some(bytes) = self.apply_faults(bytes) {
            self.datagrams.insert(at + self.faults.reply_delay(), (to, bytes));
        }
    }

    pub(super) fn poll_datagrams(&mut self, now: Moment) -> Vec<(SocketAddrV4, Vec<u8>)> {
        self.advance_to(now);
        std::iter::from_fn(|| self.datagrams.pop_until(self.now)).collect()
    }

    pub(super) fn poll_datagrams_at(&self) -> Option<Moment> {
        [self.datagrams.next_due(), self.connections.next_due()].into_iter().flatten().min()
    }
}
