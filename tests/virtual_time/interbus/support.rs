//! Test support: an encoder and its gateway in virtual time, with a session and a record of the data.

use std::sync::{Arc, Mutex, MutexGuard};
use std::time::Duration;

use encoder_studio::devices::interbus::jobs::{
    Change, Commit, Committed, DeviceMessage, Interbus, InterbusJob, InterbusOutput, JobError, Prepared,
};
use encoder_studio::devices::interbus::procedures::{FrameWord, Handshake, Station, word_in_frame};
use encoder_studio::devices::interbus::protocol::{Cam, Program, ProgramNumber, StartupMode, Value, WordOrder};
use encoder_studio::devices::interbus::sim::{Config, Gateway};
use encoder_studio::link::{Direction, TraceEntry, VirtualClock};
use encoder_studio::profile::Consent;
use encoder_studio::store::{DeviceKey, Logbook, Store};
use encoder_studio::worker::{Event, JobId, Session};

use crate::support::{MARGIN, Tap, TestLink, folder};

/// A session with a virtual gateway.
pub(crate) struct Stand {
    pub(crate) gateway: Gateway,
    pub(crate) clock: Arc<VirtualClock>,
    pub(crate) tap: Arc<Mutex<Tap>>,
    pub(crate) trace: Arc<Mutex<Vec<TraceEntry>>>,
    pub(crate) folder: tempfile::TempDir,
    pub(crate) session: Session<Interbus>,
}

pub(crate) fn gateway(query: &str) -> Gateway {
    let pairs = query.split('&').filter_map(|item| item.split_once('='));
    let pairs: Vec<_> = pairs.map(|(key, value)| (key.to_owned(), value.to_owned())).collect();
    Gateway::new(&Config::from_pairs(&pairs).unwrap())
}

pub(crate) fn station(query: &str) -> Station {
    Station::from_query(&query.parse().unwrap(), MARGIN).unwrap()
}

impl Stand {
    /// Creates a gateway with an encoder from the query of a `sim:` link.
    pub(crate) fn new(query: &str) -> Self {
        Stand::with(gateway(query), station(""))
    }

    pub(crate) fn with(gateway: Gateway, station: Station) -> Self {
        let clock = Arc::new(VirtualClock::default());
        let tap = Arc::<Mutex<Tap>>::default();
        let link = TestLink::new(Arc::new(Mutex::new(gateway.new_connection())), clock.clone(), tap.clone());
        let folder = folder();
        let store = Store::at_root(folder.path());
        let motor = Some(gateway.shaft_motor());
        let mut session = Session::for_gateway(Box::new(link), clock.clone(), station, store, motor);
        let trace = Arc::<Mutex<Vec<TraceEntry>>>::default();
        let watched = trace.clone();
        session.add_watcher(move |entry| watched.lock().unwrap().push(entry.clone()));
        Stand { gateway, clock, tap, trace, folder, session }
    }

    /// Starts a new run of the program on the same gateway, with the files of the previous run.
    pub(crate) fn run_again(&mut self) {
        self.tap = Arc::default();
        let link =
            TestLink::new(Arc::new(Mutex::new(self.gateway.new_connection())), self.clock.clone(), self.tap.clone());
        let (store, motor) = (Store::at_root(self.folder.path()), Some(self.gateway.shaft_motor()));
        self.session = Session::for_gateway(Box::new(link), self.clock.clone(), station(""), store, motor);
    }

    /// Returns the number of stores that the logbook has recorded for encoder 77.
    pub(crate) fn counted(&self) -> u64 {
        let logbook = Logbook::open(&Store::at_root(self.folder.path()).logbook_path()).unwrap();
        let device = DeviceKey {
            kind: "interbus".to_owned(),
            device_type: "K3".to_owned(),
            serial_number: "77".to_owned(),
            is_virtual: true,
        };
        logbook.write_cycles(&device).unwrap()
    }

    pub(crate) fn tap(&self) -> MutexGuard<'_, Tap> {
        self.tap.lock().unwrap()
    }

    pub(crate) fn run(&mut self, job: InterbusJob) -> Result<InterbusOutput, JobError> {
        self.session.run_inline(job)
    }

    /// Runs a job. Returns its result and the steps of the handshake.
    pub(crate) fn follow(&mut self, job: InterbusJob) -> (Result<InterbusOutput, JobError>, Vec<Handshake>) {
        let mut steps = Vec::new();
        let ended = self.session.run(JobId::default(), job, &mut |event| {
            if let Event::DeviceMessage(DeviceMessage::Handshake(step)) = event {
                steps.push(step);
            }
        });
        let ended = match ended {
            Event::Finished(_, output) => Ok(*output),
            Event::Failed(_, error) | Event::Cancelled(_, error) => Err(*error),
            other => panic!("{other:?}"),
        };
        (ended, steps)
    }

    pub(crate) fn prepare(&mut self, change: Change) -> Prepared {
        match self.run(InterbusJob::Prepare(change)).unwrap() {
            InterbusOutput::Prepared(prepared) => *prepared,
            other => panic!("{other:?}"),
        }
    }

    pub(crate) fn commit(&mut self, prepared: Prepared) -> Result<Committed, JobError> {
        let consent = Consent::to(prepared.plan.id());
        let commit = Commit { prepared, consent, force_wear: false, undoes: None };
        match self.run(InterbusJob::Commit(Box::new(commit)))? {
            InterbusOutput::Committed(committed) => Ok(*committed),
            other => panic!("{other:?}"),
        }
    }

    pub(crate) fn programs(&mut self, wanted: &[u8]) -> Vec<(u8, Program)> {
        let wanted = wanted.iter().map(|number| program(*number)).collect();
        match self.run(InterbusJob::Programs(wanted)).unwrap() {
            InterbusOutput::Programs(read, _) => read.into_iter().map(|(number, own)| (number.get(), own)).collect(),
            other => panic!("{other:?}"),
        }
    }

    /// Returns the OUT words written, without repetitions.
    pub(crate) fn sent(&self) -> Vec<u32> {
        let entries = self.trace.lock().unwrap();
        let sent = entries.iter().filter(|entry| entry.direction == Direction::Sent);
        let words = sent.filter_map(|entry| word_in_frame(true, &entry.bytes.to_bytes()?, WordOrder::HighFirst));
        words
            .map(|word| match word {
                FrameWord::Out(word) => word,
                FrameWord::In(word) => panic!("{word:08X} was not sent"),
            })
            .collect()
    }

    /// Returns the OUT word last received by the encoder and the mode in which it would start.
    pub(crate) fn left(&self) -> (u32, StartupMode) {
        self.gateway.with_encoder(|encoder| (encoder.out_word(), encoder.startup_mode()))
    }

    pub(crate) fn stores(&self) -> u32 {
        self.gateway.with_encoder(|encoder| encoder.store_count())
    }

    pub(crate) fn elapsed(&self) -> Duration {
        use encoder_studio::link::Clock;
        self.clock.now().since_start()
    }
}

pub(crate) fn program(number: u8) -> ProgramNumber {
    ProgramNumber::new(number).unwrap()
}

pub(crate) fn cam(start: u32, stop: u32) -> Cam {
    Cam { start: Value::new(start).unwrap(), stop: Value::new(stop).unwrap() }
}
