//! A half-duplex line between the UART of the host and virtual devices. Characters are sent one after another, arrive
//! in order, and may be damaged. Each device defines which of them it receives and what they mean.

use std::collections::VecDeque;
use std::time::Duration;

use fastrand::Rng;

use super::{ByteDevice, SimulatedFaults};
use crate::units::{CharacterFormat, Moment};

/// Items in transit, sorted by time. Items with equal times stay in the order of insertion.
#[derive(Clone, Debug)]
pub(crate) struct TransitQueue<T>(VecDeque<(Moment, T)>);

impl<T> Default for TransitQueue<T> {
    fn default() -> Self {
        TransitQueue(VecDeque::new())
    }
}

impl<T> TransitQueue<T> {
    pub(crate) fn insert(&mut self, at: Moment, item: T) {
        let place = self.0.partition_point(|(other, _)| *other <= at);
        self.0.insert(place, (at, item));
    }

    pub(crate) fn len(&self) -> usize {
        self.0.len()
    }

    /// Returns the time at which the next item is due.
    pub(crate) fn next_due(&self) -> Option<Moment> {
        self.0.front().map(|(at, _)| *at)
    }

    pub(crate) fn pop(&mut self) -> Option<(Moment, T)> {
        self.0.pop_front()
    }

    pub(crate) fn pop_until(&mut self, until: Moment) -> Option<T> {
        self.0.pop_front_if(|(at, _)| *at <= until).map(|(_, item)| item)
    }

    pub(crate) fn retain(&mut self, mut wanted: impl FnMut(&T) -> bool) {
        self.0.retain(|(_, item)| wanted(item));
    }
}

/// A character on the line, from the start bit to the end of the stop bit.
#[derive(Clone, Copy)]
pub(crate) struct SerialCharacter {
    pub(crate) start: Moment,
    pub(crate) end: Moment,
    pub(crate) byte: u8,
    /// Whether one bit was inverted in transit, which makes the parity wrong.
    pub(crate) flipped: bool,
}

pub(crate) struct SentCharacters {
    pub(crate) heard: Vec<SerialCharacter>,
    /// Characters before line noise was added. A converter with an echo returns them.
    pub(crate) own: Vec<SerialCharacter>,
    pub(crate) end: Moment,
}

/// The state that all virtual lines have, created from the settings of a device.
#[derive(Clone)]
pub(crate) struct LineConditions {
    pub(crate) faults: SimulatedFaults,
    pub(crate) rng: Rng,
    pub(crate) host: CharacterFormat,
    pub(crate) now: Moment,
    host_done: Moment,
    /// Number of bytes in each pending transmission of the host's UART, with the time at which it will be complete.
    sending: VecDeque<(Moment, usize)>,
    pub(crate) inbox: Vec<u8>,
}

impl LineConditions {
    pub(crate) fn new(faults: &SimulatedFaults, seed: u64, host: CharacterFormat) -> Self {
        LineConditions {
            faults: faults.clone(),
            rng: Rng::with_seed(seed),
            host,
            now: Moment::START,
            host_done: Moment::START,
            sending: VecDeque::new(),
            inbox: Vec::new(),
        }
    }

    /// Buffer size of a UART in bytes, as in a device server. Further bytes are lost. Every request of the simulated
    /// protocols fits. At 9600 bit/s, sending 512 bytes takes half a second.
    const BUFFER: usize = 512;

    /// Returns how many more bytes the host's UART can accept.
    fn free_capacity(&mut self) -> usize {
        let now = self.now;
        while self.sending.pop_front_if(|(end, _)| *end <= now).is_some() {}
        Self::BUFFER.saturating_sub(self.sending.iter().map(|(_, count)| count).sum())
    }

    /// Sends bytes over the noisy line, starting at `start`. `character` is the duration of each byte.
    pub(crate) fn send(&mut self, start: Moment, character: Duration, bytes: &[u8]) -> SentCharacters {
        let mut sent = SentCharacters { heard: Vec::new(), own: Vec::new(), end: start };
        for byte in bytes {
            let passage = self.faults.transmit_byte(&mut self.rng, *byte);
            let next = |start: Moment, byte, flipped| SerialCharacter { start, end: start + character, byte, flipped };
            if let Some(extra) = passage.inserted {
                let extra = next(sent.end, extra, false);
                sent.heard.push(extra);
                sent.end = extra.end;
            }
            let own = next(sent.end, *byte, false);
            sent.own.push(own);
            sent.heard.extend(passage.carried.map(|carried| next(own.start, carried.byte, carried.flipped)));
            sent.end = own.end;
        }
        sent
    }
}

/// A line with its devices. Every implementation is also a [`ByteDevice`].
pub(crate) trait VirtualLine: Send {
    /// An event on the line. Simultaneous events are processed in ascending order.
    type Event;

    fn line_conditions(&self) -> &LineConditions;

    fn wires_mut(&mut self) -> &mut LineConditions;

    fn next_event(&self) -> Option<(Moment, Self::Event)>;

    fn schedule_event(&mut self, at: Moment, event: Self::Event);

    /// Sends bytes from the host, starting at `start`. Returns the time at which the last byte is complete.
    fn transmit_from_host(&mut self, start: Moment, bytes: &[u8]) -> Moment;

    /// Restores the power of every device that has lost it.
    fn supply_power(&mut self, now: Moment);

    /// Processes all events that are due up to and including `to`.
    fn advance_to(&mut self, to: Moment) {
        while let Some((at, event)) = self.next_event().filter(|(at, _)| *at <= to) {
            self.wires_mut().now = self.line_conditions().now.max(at);
            self.schedule_event(at, event);
        }
        self.wires_mut().now = self.line_conditions().now.max(to);
    }
}

impl<L: VirtualLine> ByteDevice for L {
    fn on_bytes(&mut self, now: Moment, bytes: &[u8]) {
        self.advance_to(now);
        let taken = bytes.get(..self.wires_mut().free_capacity()).unwrap_or(bytes);
        if !taken.is_empty() {
            let start = self.line_conditions().now.max(self.line_conditions().host_done);
            let end = self.transmit_from_host(start, taken);
            let wires = self.wires_mut();
            wires.host_done = end;
            wires.sending.push_back((end, taken.len()));
        }
    }

    fn poll(&mut self, now: Moment) -> Vec<u8> {
        self.advance_to(now);
        std::mem::take(&mut self.wires_mut().inbox)
    }

    fn poll_at(&self) -> Option<Moment> {
        let wires = self.line_conditions();
        if wires.inbox.is_empty() { self.next_event().map(|(at, _)| at) } else { Some(wires.now) }
    }

    fn set_host_format(&mut self, now: Moment, format: CharacterFormat) {
        self.advance_to(now);
        self.wires_mut().host = format;
    }

    fn connect(&mut self, now: Moment) {
        self.advance_to(now);
        self.wires_mut().inbox.clear();
        let now = self.line_conditions().now;
        self.supply_power(now);
    }
}
