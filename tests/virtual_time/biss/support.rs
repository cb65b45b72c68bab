//! A virtual kit encoder in virtual time, a link to it that can be told to misbehave, and all that went over it.

use std::sync::{Arc, Mutex, MutexGuard};
use std::time::Duration;

pub(crate) use encoder_studio::device::biss::Way;
use encoder_studio::device::biss::{Master, Station};
use encoder_studio::link::{ByteLink, Cancel, Clock, Ctx, Direction, Trace, TraceEntry, VirtualClock};
use encoder_studio::protocol::biss::{Descriptions, RegisterAddress};
use encoder_studio::protocol::bridge::{Operation, Receiver};
use encoder_studio::sim::ByteDevice;
use encoder_studio::sim::biss::{Config, Motor, Port};
use encoder_studio::sim::bridge::{self, Adapter};

use encoder_studio::store::Store;
use encoder_studio::worker::Session;
use encoder_studio::worker::biss::{Biss, BissJob, BissOutput, JobError};

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
    pub(crate) fn with(device: D, way: Way) -> Self {
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

/// A virtual encoder with a session to it.
pub(crate) struct Bench {
    pub(crate) clock: Arc<VirtualClock>,
    pub(crate) session: Session<Biss>,
    tap: Arc<Mutex<Tap>>,
    end: End,
    _folder: tempfile::TempDir,
}

/// The virtual device of a session.
enum End {
    Pin(Arc<Mutex<Port>>),
    Bus(Arc<Mutex<Adapter>>),
}

impl Bench {
    pub(crate) fn new(way: Way, query: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::at(folder.path());
        Self::made(way, query, store, folder)
    }

    /// With these folders.
    pub(crate) fn in_store(way: Way, query: &str, store: Store) -> Self {
        Self::made(way, query, store, tempfile::tempdir().unwrap())
    }

    fn made(way: Way, query: &str, store: Store, folder: tempfile::TempDir) -> Self {
        let clock = Arc::new(VirtualClock::default());
        let tap = Arc::<Mutex<Tap>>::default();
        let (end, link, motor) = match way {
            Way::ConfigPin => {
                let port = Port::new(&Config::from_pairs(&pairs(query)).unwrap());
                let motor = port.encoder().motor();
                let port = Arc::new(Mutex::new(port));
                (End::Pin(port.clone()), TestLink::new(port, clock.clone(), tap.clone()), motor)
            }
            Way::Adapter => {
                let adapter = Adapter::new(&bridge::Config::from_pairs(&pairs(query)).unwrap());
                let motor = adapter.encoder().motor();
                let adapter = Arc::new(Mutex::new(adapter));
                (End::Bus(adapter.clone()), TestLink::new(adapter, clock.clone(), tap.clone()), motor)
            }
        };
        let station = Station::new(way, MARGIN);
        let session = Session::over(Box::new(link), clock.clone(), station, store, Some(motor));
        Bench { clock, session, tap, end, _folder: folder }
    }

    pub(crate) fn run(&mut self, job: BissJob) -> Result<BissOutput, JobError> {
        self.session.run_inline(job)
    }

    pub(crate) fn tap(&self) -> MutexGuard<'_, Tap> {
        self.tap.lock().unwrap()
    }

    pub(crate) fn now(&self) -> Duration {
        self.clock.now().since_start()
    }

    pub(crate) fn motor(&self) -> Motor {
        self.session.motor().unwrap()
    }

    /// A register, looked at in the encoder.
    pub(crate) fn encoder_reads(&self, address: RegisterAddress) -> Option<u8> {
        let now = self.clock.now();
        match &self.end {
            End::Pin(port) => port.lock().unwrap().encoder_mut().read(now, address),
            End::Bus(adapter) => adapter.lock().unwrap().encoder_mut().read(now, address),
        }
    }

    /// How often the encoder's flash was written.
    pub(crate) fn flash_cycles(&self) -> u32 {
        match &self.end {
            End::Pin(port) => port.lock().unwrap().encoder().flash().cycles(),
            End::Bus(adapter) => adapter.lock().unwrap().encoder().flash().cycles(),
        }
    }
}
