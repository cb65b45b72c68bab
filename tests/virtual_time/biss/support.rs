//! A virtual kit encoder in virtual time, a link to it that can be told to misbehave, and all that went over it.

use std::sync::{Arc, Mutex, MutexGuard};
use std::time::Duration;

use encoder_studio::device::biss::{Master, Station, Way};
use encoder_studio::link::{ByteLink, Cancel, Clock, Ctx, Direction, Trace, TraceEntry, VirtualClock};
use encoder_studio::protocol::biss::{Descriptions, RegisterAddress};
use encoder_studio::sim::biss::{Config, Port};

use crate::support::{MARGIN, Tap, TestLink};

/// The configuration pin of an encoder, with the host's side of it.
pub(crate) struct Pin {
    pub(crate) port: Arc<Mutex<Port>>,
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
        let port = Arc::new(Mutex::new(Port::new(&Config::from_pairs(&pairs(query)).unwrap())));
        let clock = Arc::new(VirtualClock::default());
        let tap = Arc::<Mutex<Tap>>::default();
        let link = TestLink::new(port.clone(), clock.clone(), tap.clone());
        let mut trace = Trace::default();
        let entries = Arc::<Mutex<Vec<TraceEntry>>>::default();
        let watched = entries.clone();
        trace.watch(move |entry| watched.lock().unwrap().push(entry.clone()));
        let mut station = Station::new(Way::ConfigPin, MARGIN);
        station.description = Descriptions::built_in().named("POSITAL IXARC kit encoder").cloned().map(Arc::new);
        Pin { port, clock, tap, entries, cancel: Cancel::default(), station, link, trace }
    }

    pub(crate) fn master(&mut self) -> Master<'_> {
        let ctx = Ctx { wire: &mut self.link as _, clock: &*self.clock, cancel: &self.cancel, trace: &mut self.trace };
        Master::new(ctx, &mut self.station)
    }

    /// Bytes of somebody else on the line.
    pub(crate) fn link_send(&mut self, bytes: &[u8]) {
        self.link.send(bytes).unwrap();
    }

    pub(crate) fn port(&self) -> MutexGuard<'_, Port> {
        self.port.lock().unwrap()
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
