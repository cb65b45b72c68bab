//! Packets of a cyclic connection. They are numbered and timed on sending, and checked on reception (reference, section
//! 7).

use std::time::Duration;

use super::LinkStatistics;
use crate::buses::ethernet_ip::protocol::{IoPacket, PacketTracker, PacketVerdict, RealTimeFormat, RunIdleHeader};
use crate::devices::hiperdrive::procedures::OpenedConnection;
use crate::devices::hiperdrive::protocol::{InputImage, Layout, OutputImage};
use crate::units::Moment;

#[derive(Clone, Debug)]
pub struct Connection {
    to_target: u32,
    to_originator: u32,
    layout: Layout,
    send_interval: Duration,
    come_interval: Duration,
    next: Moment,
    sequence: u32,
    count: u16,
    arrivals: PacketTracker,
    last_received: Moment,
    awake: Moment,
    /// Time without packets after which the target ends the connection.
    timeout: Duration,
    began: bool,
    figures: LinkStatistics,
}

/// Number of intervals without a packet after which no motion may start. If a drive is already moving, the connection
/// is treated as lost.
const MAX_MISSED_PACKETS: u32 = 3;
/// Time allowed for the first packet to arrive.
const FIRST: Duration = Duration::from_secs(1);
/// Length in bytes of a header that a target may send before the data. The manual does not mention its length (`U`).
const HEADER: usize = 4;

impl Connection {
    /// Creates both ends of a connection that was opened at `now`. The first packet is due immediately.
    pub fn new(opened: &OpenedConnection, now: Moment) -> Self {
        // An interval of 0 would loop forever.
        let interval = |interval: Duration| interval.max(Duration::from_millis(1));
        let come_interval = interval(opened.to_originator_interval);
        Connection {
            to_target: opened.to_target_id,
            to_originator: opened.to_originator_id,
            layout: opened.layout,
            send_interval: interval(opened.to_target_interval),
            come_interval,
            next: now,
            sequence: 0,
            count: 0,
            arrivals: PacketTracker::default(),
            last_received: now,
            awake: now,
            timeout: opened.timeout,
            began: false,
            figures: LinkStatistics { interval: come_interval, ..LinkStatistics::default() },
        }
    }

    pub const fn statistics(&self) -> &LinkStatistics {
        &self.figures
    }

    pub const fn layout(&self) -> Layout {
        self.layout
    }

    /// Returns when the next packet is due.
    pub const fn poll_at(&self) -> Moment {
        self.next
    }

    /// Returns whether no packet has arrived for three intervals, so that the positions of the drives are unknown.
    pub fn has_timed_out(&self, now: Moment) -> bool {
        self.began && now.duration_since(self.last_received) > self.come_interval * MAX_MISSED_PACKETS
    }

    /// Returns the time since the last packet if it exceeds the limit.
    ///
    /// During motion, the limit is three intervals. Only time spent listening counts, because packets may still be
    /// queued after the computer was busy. At rest, the limit is the time for which the target itself waits for a
    /// packet. That time is also the upper limit during motion.
    pub fn excessive_silence(&mut self, now: Moment, moves: bool) -> Option<Duration> {
        if now.duration_since(self.next) > self.come_interval {
            self.awake = now;
        }
        let intervals = self.come_interval * MAX_MISSED_PACKETS;
        let silence = now.duration_since(self.last_received);
        let listened = now.duration_since(self.last_received.max(self.awake));
        let most = if self.began { self.timeout.max(intervals) } else { FIRST.max(self.timeout) };
        (moves && self.began && listened > intervals || silence > most).then_some(silence)
    }

    /// Handles a received packet and returns its data if the packet is valid and new.
    pub fn on_packet(&mut self, now: Moment, bytes: &[u8]) -> Option<InputImage> {
        let packet = IoPacket::parse(bytes, RealTimeFormat::Modeless).ok();
        let packet = packet.filter(|packet| packet.connection == self.to_originator);
        let image = packet.as_ref().and_then(|packet| self.image(&packet.data));
        let Some((packet, image)) = packet.zip(image) else {
            self.figures.malformed += 1;
            return None;
        };
        match self.arrivals.classify(packet.sequence) {
            PacketVerdict::Stale => {
                self.figures.stale += 1;
                None
            }
            PacketVerdict::New { missing } => {
                if self.began {
                    self.figures.missed += u64::from(missing);
                    self.figures.intervals.count(self.come_interval, now.duration_since(self.last_received));
                }
                self.figures.received += 1;
                (self.last_received, self.began) = (now, true);
                Some(image)
            }
        }
    }

    /// Returns the packet that is due. After a delay, a single packet is returned instead of all those missed.
    pub fn next_packet(&mut self, now: Moment, image: &OutputImage) -> Vec<u8> {
        self.next = self.next + self.send_interval;
        if self.next <= now {
            self.next = now + self.send_interval;
        }
        self.sequence = self.sequence.wrapping_add(1);
        self.count = self.count.wrapping_add(1);
        self.figures.sent += 1;
        let data = image.emit(self.layout);
        let header = Some(RunIdleHeader::RUN);
        IoPacket { connection: self.to_target, sequence: self.sequence, count: self.count, header, data }.emit()
    }

    fn image(&self, data: &[u8]) -> Option<InputImage> {
        let bare = data.len().checked_sub(HEADER).filter(|length| *length == self.layout.byte_length());
        let data = if bare.is_some() { data.get(HEADER..)? } else { data };
        InputImage::parse(data, self.layout).ok()
    }
}
