//! A virtual kit encoder in virtual time, a link to it that can be told to misbehave, and all that went over it.

use std::sync::{Arc, Mutex, MutexGuard};
use std::time::Duration;

use encoder_studio::device::biss::{Master, Station, Way};
use encoder_studio::link::{ByteLink, Cancel, Clock, Ctx, Direction, Trace, TraceEntry, VirtualClock};
use encoder_studio::protocol::biss::{Descriptions, RegisterAddress};
use encoder_studio::protocol::bridge::{Operation, Receiver};
use encoder_studio::sim::ByteDevice;
use encoder_studio::sim::biss::{Config, Port};
use encoder_studio::sim::bridge::{self, Adapter};

use crate::support::{MARGIN, Tap, TestLink};

/// The configuration pin of an encoder, with the host's side of it.
pub(crate) type Pin = Rig<Port>;
/// An encoder behind an adapter, with the host's side of that.
pub(crate) type Bus = Rig<Adapter>;

/// A virtual device with the host's side of its line.
pub(crate) struct Rig<D> {
    pub(crate) device: Arc<Mutex<D>>,
    pub(crate) clock: Arc<VirtualClock>,
    pub(crate) tap: Arc<Mutex<Tap>>,
    pub(crate) entries: Arc<Mutex<Vec<TraceEntry>>>,
    pub(crate) cancel: Cancel,
    pub(crate) station: Station,
    link: TestLink,
    trace: Trace,
}

pub(crate) fn pairs(query: &str) -> Vec<(String, String)> {
    let pairs = query.split('&').filter_map(|item| item.split_once('='));
    pairs.map(|(key, value)| (key.to_owned(), value.to_owned())).collect()
}

pub(crate) fn at(text: &str) -> RegisterAddress {
    text.parse().unwrap()
}

impl Pin {
    /// An encoder as `sim:?…` describes it; its kind is known.
    pub(crate) fn new(query: &str) -> Self {
        Self::with(Port::new(&Config::from_pairs(&pairs(query)).unwrap()), Way::ConfigPin)
    }
}

impl Bus {
    /// An encoder as `sim:?bridge=on&…` describes it; its kind is known.
    pub(crate) fn new(query: &str) -> Self {
        Self::with(Adapter::new(&bridge::Config::from_pairs(&pairs(query)).unwrap()), Way::Adapter)
    }

    /// How many requests of an operation were sent.
    pub(crate) fn count(&self, operation: Operation) -> usize {
        let mut receiver = Receiver::default();
        self.tap().sent.iter().for_each(|bytes| receiver.push(bytes));
        let packets = std::iter::from_fn(|| receiver.next_packet());
        packets.filter(|packet| packet.op == operation.byte()).count()
    }
}

impl<D: ByteDevice + 'static> Rig<D> {
    fn with(device: D, way: Way) -> Self {
        let device = Arc::new(Mutex::new(device));
        let clock = Arc::new(VirtualClock::default());
        let tap = Arc::<Mutex<Tap>>::default();
        let link = TestLink::new(device.clone(), clock.clone(), tap.clone());
        let mut trace = Trace::default();
        let entries = Arc::<Mutex<Vec<TraceEntry>>>::default();
        let watched = entries.clone();
        trace.watch(move |entry| watched.lock().unwrap().push(entry.clone()));
        let mut station = Station::new(way, MARGIN);
        station.description = Descriptions::built_in().named("POSITAL IXARC kit encoder").cloned().map(Arc::new);
        Rig { device, clock, tap, entries, cancel: Cancel::default(), station, link, trace }
    }

    pub(crate) fn master(&mut self) -> Master<'_> {
        let ctx = Ctx { wire: &mut self.link as _, clock: &*self.clock, cancel: &self.cancel, trace: &mut self.trace };
        Master::new(ctx, &mut self.station)
    }

    /// Bytes of somebody else on the line.
    pub(crate) fn link_send(&mut self, bytes: &[u8]) {
        self.link.send(bytes).unwrap();
    }

    pub(crate) fn device(&self) -> MutexGuard<'_, D> {
        self.device.lock().unwrap()
    }

    pub(crate) fn tap(&self) -> MutexGuard<'_, Tap> {
        self.tap.lock().unwrap()
    }

    pub(crate) fn now(&self) -> Duration {
        self.clock.now().since_start()
    }

    /// What went over the line, as hexadecimal text.
    pub(crate) fn shown(&self, direction: Direction) -> Vec<String> {
        let entries = self.entries.lock().unwrap();
        entries.iter().filter(|entry| entry.direction == direction).map(|entry| entry.bytes.to_string()).collect()
    }
}
