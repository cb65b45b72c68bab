//! Test support: an adapter or hub in virtual time, with a session and a record of the data.

use std::net::Ipv4Addr;
use std::sync::{Arc, Mutex, MutexGuard};
use std::time::Duration;

use encoder_studio::buses::ethernet_ip::protocol::{Body, Command, Frame, Request};
use encoder_studio::devices::hiperdrive::jobs::{
    Change, Commit, Committed, DeviceConnection, Hiperdrive, HiperdriveJob, HiperdriveOutput, JobError, Prepared,
};
use encoder_studio::devices::hiperdrive::procedures::{Station, Survey};
use encoder_studio::devices::hiperdrive::profile::Image;
use encoder_studio::devices::hiperdrive::protocol::{DriveNumber, ParameterNumber, Value};
use encoder_studio::devices::hiperdrive::sim::{Config, Target};
use encoder_studio::link::{ByteLink, Clock, SimPort, VirtualClock};
use encoder_studio::profile::Consent;
use encoder_studio::store::Store;
use encoder_studio::worker::Session;

use crate::faults::{FaultyLink, Schedule};
use crate::support::{MARGIN, Tap, TestLink, folder};

/// A session with a virtual device.
pub(crate) struct Stand {
    pub(crate) target: Target,
    pub(crate) clock: Arc<VirtualClock>,
    pub(crate) tap: Arc<Mutex<Tap>>,
    /// Folder for backups and the logbook.
    folder: tempfile::TempDir,
    pub(crate) session: Session<Hiperdrive>,
}

pub(crate) fn number(own: u16) -> ParameterNumber {
    ParameterNumber::new(own).unwrap()
}

pub(crate) fn drive(own: u8) -> DriveNumber {
    DriveNumber::new(own).unwrap()
}

pub(crate) fn image(values: &[(u16, i64)]) -> Box<Image> {
    Box::new(Image { values: values.iter().map(|(own, value)| (number(*own), *value)).collect() })
}

impl Stand {
    /// Creates a device from the query of a `sim:` link.
    pub(crate) fn new(query: &str) -> Self {
        let pairs = query.split('&').filter_map(|item| item.split_once('='));
        let pairs: Vec<_> = pairs.map(|(key, value)| (key.to_owned(), value.to_owned())).collect();
        Stand::at(Target::new(&Config::from_pairs(&pairs).unwrap()), Arc::new(VirtualClock::default()))
    }

    /// Creates another session with the same device.
    pub(crate) fn at(target: Target, clock: Arc<VirtualClock>) -> Self {
        let tap = Arc::<Mutex<Tap>>::default();
        let connection = target.connect_from(Ipv4Addr::UNSPECIFIED);
        let wire = Box::new(TestLink::new(Arc::new(Mutex::new(connection)), clock.clone(), tap.clone()));
        Self::over(wire, tap, target, clock)
    }

    /// Creates another session with the same device, over a link with the given faults.
    pub(crate) fn with_faults(target: Target, clock: Arc<VirtualClock>, schedule: Arc<Mutex<Schedule>>) -> Self {
        let connection = Arc::new(Mutex::new(target.connect_from(Ipv4Addr::UNSPECIFIED)));
        let supplied = target.clone();
        let cut_power = move |now| supplied.with_station(|station| station.power_cycle(now));
        let wire = Box::new(FaultyLink::new(connection, clock.clone(), schedule, cut_power));
        Self::over(wire, Arc::default(), target, clock)
    }

    fn over(wire: Box<dyn ByteLink>, tap: Arc<Mutex<Tap>>, target: Target, clock: Arc<VirtualClock>) -> Self {
        let port = SimPort::new(Arc::new(Mutex::new(target.clone())), clock.clone());
        let folder = folder();
        let store = Store::at_root(folder.path());
        let station = Station::new(MARGIN);
        let way = DeviceConnection { wire, port: Some(Box::new(port)), station, target: Some(target.clone()) };
        let session = Session::for_target(way, clock.clone(), store);
        Stand { target, clock, tap, folder, session }
    }

    pub(crate) fn tap(&self) -> MutexGuard<'_, Tap> {
        self.tap.lock().unwrap()
    }

    pub(crate) fn run(&mut self, job: HiperdriveJob) -> Result<HiperdriveOutput, JobError> {
        self.session.run_inline(job)
    }

    pub(crate) fn survey(&mut self) -> Survey {
        match self.run(HiperdriveJob::Survey).unwrap() {
            HiperdriveOutput::Surveyed(survey) => *survey,
            other => panic!("{other:?}"),
        }
    }

    pub(crate) fn prepare(&mut self, change: Change) -> Result<Prepared, JobError> {
        match self.run(HiperdriveJob::Prepare(change))? {
            HiperdriveOutput::Prepared(prepared) => Ok(*prepared),
            other => panic!("{other:?}"),
        }
    }

    pub(crate) fn commit(&mut self, prepared: Prepared) -> Result<Committed, JobError> {
        self.commit_with(prepared, false)
    }

    pub(crate) fn commit_with(&mut self, prepared: Prepared, force_wear: bool) -> Result<Committed, JobError> {
        let consent = Consent::to(prepared.plan.id());
        match self.run(HiperdriveJob::Commit(Box::new(Commit { prepared, consent, force_wear, undoes: None })))? {
            HiperdriveOutput::Committed(committed) => Ok(*committed),
            other => panic!("{other:?}"),
        }
    }

    /// Plans and executes a change.
    pub(crate) fn change(&mut self, change: Change) -> Result<Committed, JobError> {
        let prepared = self.prepare(change)?;
        self.commit(prepared)
    }

    /// Makes the path of the logbook unusable.
    pub(crate) fn block_logbook(&self) {
        let path = Store::at_root(self.folder.path()).logbook_path();
        // The logbook may already exist because the connection was recorded.
        let _ = std::fs::remove_file(&path);
        std::fs::create_dir_all(path).unwrap();
    }

    /// Returns the value of a parameter, read directly from the simulated device.
    pub(crate) fn value(&self, own: u16) -> i64 {
        let now = self.clock.now();
        match self.target.with_station(|station| station.read(now, number(own))).unwrap() {
            Value::Number(value) => value,
            Value::Text(text) => panic!("{text}"),
        }
    }

    /// Returns the requests to objects in the order sent.
    pub(crate) fn requests(&self) -> Vec<Request> {
        let tap = self.tap();
        let frames = tap.sent.iter().map(|bytes| Frame::parse(bytes).unwrap());
        let data = frames.filter(|frame| frame.command == Command::SEND_RR_DATA);
        data.map(|frame| match frame.parse_body().unwrap() {
            Body::Data { items, .. } => Request::parse(items.unconnected_data().unwrap()).unwrap(),
            other => panic!("{other:?}"),
        })
        .collect()
    }

    /// Returns the values set, each as parameter number and data.
    pub(crate) fn sets(&self) -> Vec<(u16, Vec<u8>)> {
        use encoder_studio::buses::ethernet_ip::protocol::{LogicalKind, Service};
        let of_parameter = |request: &Request| {
            let class = request.path.first_value(LogicalKind::Class)?;
            ParameterNumber::from_attribute(class, request.path.first_value(LogicalKind::Attribute)?)
        };
        let requests = self.requests().into_iter().filter(|request| request.service != Service::GET);
        requests.filter_map(|request| Some((of_parameter(&request)?.get(), request.data))).collect()
    }

    pub(crate) fn elapsed(&self) -> Duration {
        self.clock.now().since_start()
    }
}
