//! Test support: an SSI encoder on an adapter in virtual time, with a session.

use std::sync::{Arc, Mutex};
use std::time::Duration;

use encoder_studio::buses::bridge::protocol::{Operation, Packet, Receiver};
use encoder_studio::buses::bridge::sim::Adapter;
use encoder_studio::devices::ssi::jobs::{Ssi, SsiJob, SsiOutput};
use encoder_studio::devices::ssi::procedures::{ClockSettings, Station, Words};
use encoder_studio::kinds::attachable_kinds;
use encoder_studio::link::{Clock, VirtualClock};
use encoder_studio::sim::ByteDevice;
use encoder_studio::store::Store;
use encoder_studio::worker::Session;

use crate::biss::support::pairs;
use crate::support::{MARGIN, Tap, TestLink};

/// Settings for reading a word in less than 50 µs: 25 clocks in 16.67 µs and a pause of 30 µs.
pub(crate) const QUICK: ClockSettings = ClockSettings { clocks: 25, clock_hz: 1_500_000, pause_us: 30 };

pub(crate) struct Stand {
    pub(crate) clock: Arc<VirtualClock>,
    pub(crate) adapter: Arc<Mutex<Adapter>>,
    pub(crate) tap: Arc<Mutex<Tap>>,
    pub(crate) session: Session<Ssi>,
    _folder: tempfile::TempDir,
}

impl Stand {
    /// Creates a session from the settings of the link and those of the virtual adapter.
    pub(crate) fn new(link: &str, query: &str) -> Self {
        let adapter = Arc::new(Mutex::new(Adapter::from_pairs(&pairs(query), attachable_kinds()).unwrap()));
        Self::before(link, adapter)
    }

    /// Creates a session whose clock and pause allow 20 000 words per second.
    pub(crate) fn quick(query: &str) -> Self {
        Self::new("clock=1500000&pause=30", query)
    }

    fn before(link: &str, adapter: Arc<Mutex<Adapter>>) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let clock = Arc::new(VirtualClock::default());
        let tap = Arc::<Mutex<Tap>>::default();
        let wire = Box::new(TestLink::new(adapter.clone(), clock.clone(), tap.clone()));
        let station = Station::from_query(&link.parse().unwrap(), MARGIN).unwrap();
        let session = Session::for_adapter(wire, clock.clone(), station, Store::at_root(folder.path()), None);
        Stand { clock, adapter, tap, session, _folder: folder }
    }

    /// Requests a single word.
    pub(crate) fn read(&mut self) -> Words {
        match self.session.run_inline(SsiJob::Read).unwrap() {
            SsiOutput::Read(words) => words,
            other => panic!("{other:?}"),
        }
    }

    pub(crate) fn sample(&mut self) -> Words {
        self.session.take_sample().unwrap()
    }

    /// Returns all samples taken within the given time.
    pub(crate) fn samples(&mut self, time: Duration) -> Vec<Words> {
        let end = self.clock.now() + time;
        let mut samples = Vec::new();
        while self.clock.now() < end {
            samples.push(self.sample());
        }
        samples
    }

    /// Returns the number of bytes that the adapter sends in one second without a request.
    pub(crate) fn unsolicited_byte_count(&mut self) -> usize {
        let mut adapter = self.adapter.lock().unwrap();
        let mut bytes = |milliseconds| {
            self.clock.sleep_until(self.clock.now() + Duration::from_millis(milliseconds));
            adapter.poll(self.clock.now()).len()
        };
        bytes(10);
        (0..1000).map(|_| bytes(1)).sum()
    }

    /// Returns the requests sent for an operation.
    pub(crate) fn requests(&self, operation: Operation) -> Vec<Packet> {
        let mut receiver = Receiver::default();
        self.tap.lock().unwrap().sent.iter().for_each(|bytes| receiver.push(bytes));
        std::iter::from_fn(|| receiver.next_packet()).filter(|packet| packet.op == operation.byte()).collect()
    }

    pub(crate) fn count(&self, operation: Operation) -> usize {
        self.requests(operation).len()
    }
}
