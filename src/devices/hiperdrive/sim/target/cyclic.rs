//! The cyclic class 1 connection, in which each packet is received and sent at its own time.
//!
//! Assumptions (`U`: not documented):
//! - The first packet is sent one interval after the connection was opened.
//! - Every packet in sequence is accepted, regardless of its data count.
//! - A packet that is old, has a wrong length or belongs to another connection is dropped and counted. It does not keep
//!   the connection alive.

use std::net::SocketAddrV4;
use std::time::Duration;

use super::device::TargetDevice;
use crate::buses::ethernet_ip::protocol::{
    ConnectionOwner, ForwardOpen, Frame, IoPacket, PacketTracker, PacketVerdict, RealTimeFormat, RunIdleHeader,
};
use crate::devices::hiperdrive::protocol::{Layout, OutputImage};
use crate::units::Moment;

#[derive(Debug)]
pub(super) struct Cyclic {
    pub(super) owner: ConnectionOwner,
    to_target_id: u32,
    to_originator_id: u32,
    layout: Layout,
    to: SocketAddrV4,
    interval: Duration,
    next: Moment,
    sequence: u32,
    arrivals: PacketTracker,
}

impl Cyclic {
    pub(super) fn new(open: &ForwardOpen, id: u32, layout: Layout, to: SocketAddrV4, now: Moment) -> Self {
        let interval = Duration::from_micros(open.to_originator_interval_us.into());
        Cyclic {
            owner: open.owner,
            to_target_id: id,
            to_originator_id: open.to_originator_id,
            layout,
            to,
            interval,
            next: now + interval,
            sequence: 0,
            arrivals: PacketTracker::default(),
        }
    }

    /// Returns the time at which the next packet is due.
    pub(super) const fn next_packet_time(&self) -> Moment {
        self.next
    }
}

impl TargetDevice {
    /// Sends all packets that are due, each with the drive states at its own time, and closes the connection if the
    /// master is lost.
    pub(super) fn send_due_packets(&mut self) {
        while let Some(cyclic) = self.connections.cyclic.as_mut() {
            let at = cyclic.next.min(self.now);
            if !self.station.is_open(at) {
                self.connections.cyclic = None;
                return;
            }
            if cyclic.next > self.now {
                return;
            }
            cyclic.next = at + cyclic.interval;
            cyclic.sequence = cyclic.sequence.wrapping_add(1);
            let packet = IoPacket {
                connection: cyclic.to_originator_id,
                sequence: cyclic.sequence,
                // The count is the lower half of the sequence number.
                count: cyclic.sequence as u16,
                header: None,
                data: self.station.image(at).emit(cyclic.layout),
            };
            let to = cyclic.to;
            if self.can_send() {
                self.send(at, to, packet.emit());
            }
        }
    }

    pub(super) fn on_datagram(&mut self, now: Moment, from: SocketAddrV4, packet: &[u8]) {
        self.advance_to(now);
        if !self.register_arrival() || !self.decide_delivery() {
            return;
        }
        match IoPacket::parse(packet, RealTimeFormat::Header) {
            Ok(packet) => self.receive_io_packet(&packet),
            Err(_) => {
                let asked = Frame::parse(packet).is_ok_and(|frame| self.answer_datagram(from, &frame));
                self.figures.malformed += u64::from(!asked);
            }
        }
    }

    fn receive_io_packet(&mut self, packet: &IoPacket) {
        let Some(cyclic) = self.connections.cyclic.as_mut().filter(|one| one.to_target_id == packet.connection) else {
            self.figures.foreign += 1;
            return;
        };
        let runs = packet.header.is_some_and(RunIdleHeader::is_running);
        let Ok(image) = OutputImage::parse(&packet.data, cyclic.layout) else {
            self.figures.malformed += 1;
            return;
        };
        match cyclic.arrivals.classify(packet.sequence) {
            PacketVerdict::New { .. } => {
                self.figures.packets += 1;
                self.station.handle_process_data(self.now, &image, runs);
            }
            PacketVerdict::Stale => self.figures.stale += 1,
        }
    }
}
