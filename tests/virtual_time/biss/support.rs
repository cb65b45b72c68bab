//! Test support: a kit encoder in virtual time, a link to it with configurable faults, and a record of the data.

use std::sync::{Arc, Mutex, MutexGuard};
use std::time::Duration;

use encoder_studio::buses::bridge::procedures::{StreamRequest, StreamTap as Stream, SupplyAfterSession};
use encoder_studio::buses::bridge::protocol::{Operation, Receiver};
use encoder_studio::buses::bridge::sim::Adapter;
use encoder_studio::devices::biss::jobs::{Biss, BissJob, BissOutput, JobError, JobStep};
pub(crate) use encoder_studio::devices::biss::procedures::Transport;
use encoder_studio::devices::biss::procedures::procedure::ProcedureProgress;
use encoder_studio::devices::biss::procedures::{Master, Station, Supply};
use encoder_studio::devices::biss::protocol::{Descriptions, RegisterAddress};
use encoder_studio::devices::biss::sim::{Config, Encoder, UbicomPort};
use encoder_studio::kinds::attachable_kinds;
use encoder_studio::link::{ByteLink, CancelToken, Clock, Ctx, Direction, Trace, TraceEntry, VirtualClock};
use encoder_studio::sim::ByteDevice;
use encoder_studio::sim::Motor;
use encoder_studio::store::Store;
use encoder_studio::units::{Moment, SupplyVoltage};
use encoder_studio::worker::{Event, JobId, Progress, Session};

use crate::faults::{FaultyLink, Schedule};
use crate::support::{MARGIN, Tap, TestLink, folder};

/// A simulated encoder at its configuration pin, including the host's end of the line.
pub(crate) type Pin = Rig<UbicomPort>;
/// A simulated encoder on an adapter, including the host's end of the line.
pub(crate) type Bus = Rig<Adapter>;

/// A virtual device and the host's end of its line.
pub(crate) struct Rig<D> {
    pub(crate) device: Arc<Mutex<D>>,
    pub(crate) clock: Arc<VirtualClock>,
    pub(crate) tap: Arc<Mutex<Tap>>,
    pub(crate) entries: Arc<Mutex<Vec<TraceEntry>>>,
    pub(crate) cancel: CancelToken,
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
    /// Creates an encoder of a known type from the query of a `sim:` link.
    pub(crate) fn new(query: &str) -> Self {
        Self::with(UbicomPort::new(&Config::from_pairs(&pairs(query)).unwrap()), Transport::ConfigPin)
    }
}

impl Bus {
    /// Creates an encoder of a known type behind an adapter from the query of a `sim:` link.
    pub(crate) fn new(query: &str) -> Self {
        Self::with(Adapter::from_pairs(&pairs(query), attachable_kinds()).unwrap(), Transport::Adapter)
    }

    /// Returns how many requests for an operation were sent.
    pub(crate) fn count(&self, operation: Operation) -> usize {
        let mut receiver = Receiver::default();
        self.tap().sent.iter().for_each(|bytes| receiver.push(bytes));
        let packets = std::iter::from_fn(|| receiver.next_packet());
        packets.filter(|packet| packet.op == operation.byte()).count()
    }
}

impl<D: ByteDevice + 'static> Rig<D> {
    pub(crate) fn with(device: D, way: Transport) -> Self {
        let device = Arc::new(Mutex::new(device));
        let clock = Arc::new(VirtualClock::default());
        let tap = Arc::<Mutex<Tap>>::default();
        let link = TestLink::new(device.clone(), clock.clone(), tap.clone());
        let mut trace = Trace::default();
        let entries = Arc::<Mutex<Vec<TraceEntry>>>::default();
        let watched = entries.clone();
        trace.add_watcher(move |entry| watched.lock().unwrap().push(entry.clone()));
        let mut station = Station::new(way, MARGIN);
        station.description = Descriptions::built_in().find_by_name("POSITAL IXARC kit encoder").cloned().map(Arc::new);
        Rig { device, clock, tap, entries, cancel: CancelToken::default(), station, link, trace }
    }

    pub(crate) fn master(&mut self) -> Master<'_> {
        let ctx = Ctx { wire: &mut self.link as _, clock: &*self.clock, cancel: &self.cancel, trace: &mut self.trace };
        Master::new(ctx, &mut self.station)
    }

    /// Sends bytes on the line as another sender would.
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

    /// Returns the frames on the line in hexadecimal.
    pub(crate) fn shown(&self, direction: Direction) -> Vec<String> {
        let entries = self.entries.lock().unwrap();
        entries.iter().filter(|entry| entry.direction == direction).map(|entry| entry.bytes.to_string()).collect()
    }
}

/// Access to the encoder of a test bench while a job runs.
pub(crate) struct Handle {
    end: End,
    clock: Arc<VirtualClock>,
}

impl Handle {
    pub(crate) fn with<T>(&self, look: impl FnOnce(&mut Encoder, Moment) -> T) -> T {
        let now = self.clock.now();
        match &self.end {
            End::Pin(port) => look(port.lock().unwrap().encoder_mut(), now),
            End::Bus(adapter) => look(adapter.lock().unwrap().device_mut().unwrap(), now),
        }
    }
}

/// A virtual encoder with a session over either kind of connection.
pub(crate) struct Bench {
    pub(crate) clock: Arc<VirtualClock>,
    pub(crate) session: Session<Biss>,
    tap: Arc<Mutex<Tap>>,
    end: End,
    folder: Arc<tempfile::TempDir>,
}

/// The virtual device of a session.
#[derive(Clone)]
enum End {
    Pin(Arc<Mutex<UbicomPort>>),
    Bus(Arc<Mutex<Adapter>>),
}

impl Bench {
    pub(crate) fn new(way: Transport, query: &str) -> Self {
        let folder = folder();
        let store = Store::at_root(folder.path());
        Self::made(way, query, store, folder)
    }

    /// Creates a test bench whose session uses the given store.
    pub(crate) fn bench_in_store(way: Transport, query: &str, store: Store) -> Self {
        Self::made(way, query, store, folder())
    }

    fn made(way: Transport, query: &str, store: Store, folder: tempfile::TempDir) -> Self {
        let end = match way {
            Transport::ConfigPin => {
                End::Pin(Arc::new(Mutex::new(UbicomPort::new(&Config::from_pairs(&pairs(query)).unwrap()))))
            }
            Transport::Adapter => {
                End::Bus(Arc::new(Mutex::new(Adapter::from_pairs(&pairs(query), attachable_kinds()).unwrap())))
            }
        };
        Self::plugged(end, way, Arc::new(VirtualClock::default()), store, Arc::new(folder))
    }

    fn plugged(
        end: End,
        way: Transport,
        clock: Arc<VirtualClock>,
        store: Store,
        folder: Arc<tempfile::TempDir>,
    ) -> Self {
        Self::with_station(end, Station::new(way, MARGIN), clock, store, folder)
    }

    fn with_station(
        end: End,
        station: Station,
        clock: Arc<VirtualClock>,
        store: Store,
        folder: Arc<tempfile::TempDir>,
    ) -> Self {
        let tap = Arc::<Mutex<Tap>>::default();
        let (link, motor) = match &end {
            End::Pin(port) => {
                let motor = port.lock().unwrap().encoder().motor();
                (TestLink::new(port.clone(), clock.clone(), tap.clone()), motor)
            }
            End::Bus(adapter) => {
                let motor = adapter.lock().unwrap().motor();
                (TestLink::new(adapter.clone(), clock.clone(), tap.clone()), motor)
            }
        };
        let session = Session::from_connection(Box::new(link), clock.clone(), station, store, Some(motor));
        Bench { clock, session, tap, end, folder }
    }

    /// Returns the same device at the same time with a new session, as after a cable was reconnected.
    pub(crate) fn reconnected(&self) -> Bench {
        let (store, folder) = (Store::at_root(self.folder.path()), self.folder.clone());
        Self::plugged(self.end.clone(), self.session.station().transport, self.clock.clone(), store, folder)
    }

    /// Creates a test bench with an adapter that can switch the encoder's supply, which is initially off.
    pub(crate) fn supplied(after: SupplyAfterSession) -> Self {
        Self::with_switched_supply("", after)
    }

    /// Like [`supplied`](Self::supplied), but with additional adapter settings.
    pub(crate) fn with_switched_supply(query: &str, after: SupplyAfterSession) -> Self {
        let query = format!("supply=switched&{query}");
        let adapter = Adapter::from_pairs(&pairs(&query), attachable_kinds()).unwrap();
        let folder = Arc::new(folder());
        Self::with_supply(End::Bus(Arc::new(Mutex::new(adapter))), after, Arc::default(), folder)
    }

    /// Streams sine and cosine over the adapter, like the Signals tab. Returns whether the encoder had power meanwhile.
    pub(crate) fn stream_signals(&self, supply: Option<SupplyVoltage>) -> bool {
        let End::Bus(adapter) = &self.end else { panic!("no adapter") };
        let mut link = TestLink::new(adapter.clone(), self.clock.clone(), Arc::default());
        let (cancel, mut trace, mut tap) = (CancelToken::default(), Trace::default(), Stream::new(MARGIN));
        let clock = &*self.clock;
        let ctx = Ctx { wire: &mut link as _, clock, cancel: &cancel, trace: &mut trace };
        tap.start(ctx, StreamRequest::Analog { sample_hz: 10_000 }, supply).unwrap();
        let has_power = self.encoder(|encoder, _| encoder.has_power());
        let ctx = Ctx { wire: &mut link as _, clock, cancel: &cancel, trace: &mut trace };
        tap.stop(ctx).unwrap();
        has_power
    }

    /// Returns the same as [`reconnected`](Self::reconnected), with the supply switched on again and the given setting
    /// for the end of the session.
    pub(crate) fn reconnected_with_supply(&self, after: SupplyAfterSession) -> Self {
        Self::with_supply(self.end.clone(), after, self.clock.clone(), self.folder.clone())
    }

    fn with_supply(
        end: End,
        after: SupplyAfterSession,
        clock: Arc<VirtualClock>,
        folder: Arc<tempfile::TempDir>,
    ) -> Self {
        let mut station = Station::new(Transport::Adapter, MARGIN);
        station.supply = Some(Supply { millivolt: 5_000, measured: None });
        station.adapter.set_supply_after_session(after);
        let store = Store::at_root(folder.path());
        Self::with_station(end, station, clock, store, folder)
    }

    /// Returns the same as [`reconnected`](Self::reconnected), in a session that already knows the identity.
    pub(crate) fn reconnected_with_known_encoder(&self) -> Bench {
        let known = self.session.station();
        let mut station = Station::new(known.transport, MARGIN);
        station.description.clone_from(&known.description);
        station.firmware = known.firmware;
        station.layout.clone_from(&known.layout);
        Self::with_station(self.end.clone(), station, self.clock.clone(), self.store(), self.folder.clone())
    }

    /// Returns a copy, including the device and its time but not the files on disk.
    pub(crate) fn copied(&self) -> Bench {
        let clock = Arc::new(VirtualClock::default());
        clock.sleep_until(self.clock.now());
        let folder = Arc::new(folder());
        let end = match &self.end {
            End::Pin(port) => End::Pin(Arc::new(Mutex::new(port.lock().unwrap().clone()))),
            End::Bus(adapter) => End::Bus(Arc::new(Mutex::new(adapter.lock().unwrap().clone()))),
        };
        Self::plugged(end, self.session.station().transport, clock, Store::at_root(folder.path()), folder)
    }

    /// Returns a copy whose link has faults.
    pub(crate) fn copied_with_faults(&self, schedule: Arc<Mutex<Schedule>>) -> Bench {
        let mut bench = self.copied();
        let (supplied, clock) = (bench.handle(), bench.clock.clone());
        let cut_power = move |_| supplied.with(|encoder, now| encoder.power_cycle(now));
        let link = match &bench.end {
            End::Pin(port) => FaultyLink::new(port.clone(), clock.clone(), schedule, cut_power),
            End::Bus(adapter) => FaultyLink::new(adapter.clone(), clock.clone(), schedule, cut_power),
        };
        let (station, motor) = (Station::new(self.session.station().transport, MARGIN), bench.motor());
        bench.session = Session::from_connection(Box::new(link), clock, station, bench.store(), Some(motor));
        bench
    }

    /// Calls a function with the encoder and the current time.
    pub(crate) fn encoder<T>(&self, look: impl FnOnce(&mut Encoder, Moment) -> T) -> T {
        self.handle().with(look)
    }

    /// Returns the tap of the link, so that its faults can be changed while a job runs.
    pub(crate) fn tap_handle(&self) -> Arc<Mutex<Tap>> {
        self.tap.clone()
    }

    /// Returns a function that counts the sent frames, even while a job runs.
    pub(crate) fn counter(&self) -> impl Fn() -> usize + use<> {
        let tap = self.tap.clone();
        move || tap.lock().unwrap().sent.len()
    }

    /// Returns access to the encoder while a job runs.
    pub(crate) fn handle(&self) -> Handle {
        Handle { end: self.end.clone(), clock: self.clock.clone() }
    }

    /// Advances the clock to the given time after the start.
    pub(crate) fn advance_clock_to(&self, elapsed: Duration) {
        self.clock.sleep_until(Moment::from_elapsed(elapsed));
    }

    /// Runs a job and returns the operations of its plan that were reported.
    pub(crate) fn run_watched(
        &mut self,
        job: BissJob,
        told: &mut dyn FnMut(&ProcedureProgress),
    ) -> Result<BissOutput, Box<JobError>> {
        let event = self.session.run(JobId::default(), job, &mut |event| {
            if let Event::Progress(_, Progress { step: JobStep::Operation { progress, .. }, .. }) = event {
                told(&progress);
            }
        });
        match event {
            Event::Finished(_, output) => Ok(*output),
            Event::Failed(_, error) | Event::Cancelled(_, error) => Err(error),
            other => panic!("{other:?}"),
        }
    }

    pub(crate) fn store(&self) -> Store {
        Store::at_root(self.folder.path())
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

    /// Returns the value of a register, read directly from the simulated encoder.
    pub(crate) fn encoder_reads(&self, address: RegisterAddress) -> Option<u8> {
        self.encoder(|encoder, now| encoder.read(now, address))
    }

    /// Returns the number of writes to the encoder's flash.
    pub(crate) fn flash_cycles(&self) -> u32 {
        self.encoder(|encoder, _| encoder.flash().write_cycles())
    }
}
