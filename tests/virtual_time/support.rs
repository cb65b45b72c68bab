//! Test support in virtual time: a session on a simulated line, a link between them with configurable faults, and a
//! record of the transmitted data.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard};
use std::time::Duration;

use encoder_studio::devices::hiperface::jobs::{
    Change, Commit, Committed, Hiperface, HiperfaceJob, HiperfaceOutput, JobError, Prepared, SavedProfile,
};
use encoder_studio::devices::hiperface::procedures::Station;
use encoder_studio::devices::hiperface::profile::{HiperfaceProfile, RestoreOptions};
use encoder_studio::devices::hiperface::protocol::{AccessCode, AccessCodeNumber, Command, EncoderTypes, MAX_TRANSFER};
use encoder_studio::devices::hiperface::sim::{Bus, Config};
use encoder_studio::kinds::program;
use encoder_studio::link::{
    ByteLink, CancelToken, Clock, Direction, LinkError, LinkErrorKind, SimLink, TraceEntry, VirtualClock,
};
use encoder_studio::profile::{Consent, ProfileDocument};
use encoder_studio::sim::ByteDevice;
use encoder_studio::store::{Store, read_text};
use encoder_studio::units::{CharacterFormat, Moment};
use encoder_studio::worker::Session;

/// The margin for late replies on `sim:` links.
pub(crate) const MARGIN: Duration = Duration::from_millis(20);

/// The faults of a link, and a record of its bytes.
#[derive(Default)]
pub(crate) struct Tap {
    /// Every frame sent over the link.
    pub(crate) sent: Vec<Vec<u8>>,
    /// Number of the frame, counted from 0, from which the link is lost.
    pub(crate) lost_from: Option<usize>,
    /// Number of the first frame that no longer reaches the encoder.
    pub(crate) deaf_from: Option<usize>,
    /// Number of the first frame that no longer receives a reply.
    pub(crate) mute_from: Option<usize>,
    /// Number of a single frame that does not reach the encoder.
    pub(crate) swallow_request: Option<usize>,
    /// Number of a single frame whose reply is lost.
    pub(crate) swallow_reply: Option<usize>,
    /// Start of the requests whose replies are damaged.
    pub(crate) broken_to: Option<Vec<u8>>,
    /// Start of the requests whose replies are lost.
    pub(crate) mute_to: Option<Vec<u8>>,
    /// Bytes from another sender on the line.
    pub(crate) foreign: VecDeque<u8>,
    /// Whether the link has a fixed speed, as with a device server.
    pub(crate) formatless: bool,
    /// Whether the next check of the link reports that it is lost.
    pub(crate) unplugged: bool,
    /// Number of the frame at which the job is cancelled, and its cancel token.
    pub(crate) cancel_at: Option<(usize, CancelToken)>,
}

impl Tap {
    fn is_lost(&self) -> bool {
        self.unplugged || self.lost_from.is_some_and(|from| self.sent.len() > from)
    }

    fn is_reply_lost(&self) -> bool {
        let Some(last) = self.sent.len().checked_sub(1) else { return false };
        self.mute_from.is_some_and(|from| last >= from)
            || self.swallow_reply == Some(last)
            || self.mute_to.as_ref().is_some_and(|own| self.last_request_starts_with(own))
    }

    fn last_request_starts_with(&self, request: &[u8]) -> bool {
        self.sent.last().is_some_and(|last| last.starts_with(request))
    }

    /// Returns how many times a command was sent.
    pub(crate) fn count(&self, command: Command) -> usize {
        self.sent.iter().filter(|frame| frame[1] == command.byte()).count()
    }
}

/// The link between a session and the virtual line.
pub(crate) struct TestLink {
    line: SimLink,
    clock: Arc<dyn Clock>,
    tap: Arc<Mutex<Tap>>,
}

impl TestLink {
    pub(crate) fn new(device: Arc<Mutex<dyn ByteDevice>>, clock: Arc<dyn Clock>, tap: Arc<Mutex<Tap>>) -> Self {
        TestLink { line: SimLink::connect(device, clock.clone()), clock, tap }
    }

    fn check_plug(&self) -> Result<(), LinkError> {
        match self.tap.lock().unwrap().is_lost() {
            true => Err(LinkError::new("test", LinkErrorKind::Lost)),
            false => Ok(()),
        }
    }
}

impl ByteLink for TestLink {
    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        let arrives = {
            let mut tap = self.tap.lock().unwrap();
            let number = tap.sent.len();
            tap.sent.push(bytes.to_vec());
            if let Some((_, cancel)) = tap.cancel_at.as_ref().filter(|(at, _)| *at == number) {
                cancel.request();
            }
            tap.deaf_from.is_none_or(|from| number < from) && tap.swallow_request != Some(number)
        };
        self.check_plug()?;
        if arrives { self.line.send(bytes) } else { Ok(()) }
    }

    fn receive(&mut self, until: Moment, into: &mut Vec<u8>) -> Result<(), LinkError> {
        loop {
            self.check_plug()?;
            if let Some(byte) = self.tap.lock().unwrap().foreign.pop_front() {
                into.push(byte);
                return Ok(());
            }
            let mut heard = Vec::new();
            self.line.receive(until, &mut heard)?;
            let tap = self.tap.lock().unwrap();
            if tap.broken_to.as_ref().is_some_and(|own| tap.last_request_starts_with(own))
                && let Some(byte) = heard.last_mut()
            {
                *byte ^= 0x10;
            }
            if heard.is_empty() || !tap.is_reply_lost() {
                into.append(&mut heard);
                return Ok(());
            }
            drop(tap);
            if self.clock.now() >= until {
                return Ok(());
            }
        }
    }

    fn set_format(&mut self, format: CharacterFormat) -> Result<(), LinkError> {
        if self.can_set_format() { self.line.set_format(format) } else { Ok(()) }
    }

    fn can_set_format(&self) -> bool {
        !self.tap.lock().unwrap().formatless
    }

    fn check_connection(&mut self) -> Result<(), LinkError> {
        self.check_plug()
    }
}

/// A session on a virtual line.
pub(crate) struct Desk {
    pub(crate) bus: Arc<Mutex<Bus>>,
    pub(crate) clock: Arc<VirtualClock>,
    pub(crate) tap: Arc<Mutex<Tap>>,
    pub(crate) trace: Arc<Mutex<Vec<TraceEntry>>>,
    pub(crate) folder: Arc<tempfile::TempDir>,
    pub(crate) session: Session<Hiperface>,
}

/// Returns a folder for backups and the logbook, in memory if possible, because tests create thousands.
pub(crate) fn folder() -> tempfile::TempDir {
    tempfile::tempdir_in("/dev/shm").or_else(|_| tempfile::tempdir()).unwrap()
}

/// Creates a virtual line from the query of a `sim:` link.
pub(crate) fn bus(query: &str) -> Bus {
    let pairs = query.split('&').filter_map(|item| item.split_once('='));
    let pairs: Vec<_> = pairs.map(|(key, value)| (key.to_owned(), value.to_owned())).collect();
    Bus::new(&Config::from_pairs(&pairs).unwrap())
}

impl Desk {
    pub(crate) fn new(query: &str) -> Self {
        Self::at(bus(query), &VirtualClock::default(), Station::new(MARGIN))
    }

    pub(crate) fn with_station(query: &str, station: Station) -> Self {
        Self::at(bus(query), &VirtualClock::default(), station)
    }

    /// Creates a test bench with the given line. Its time is that of `clock` or later.
    pub(crate) fn at(bus: Bus, clock: &VirtualClock, station: Station) -> Self {
        let own = Arc::new(VirtualClock::default());
        own.sleep_until(clock.now());
        let folder = Arc::new(folder());
        Self::plugged(Arc::new(Mutex::new(bus)), own, folder, station)
    }

    fn plugged(
        bus: Arc<Mutex<Bus>>,
        clock: Arc<VirtualClock>,
        folder: Arc<tempfile::TempDir>,
        station: Station,
    ) -> Self {
        let tap = Arc::<Mutex<Tap>>::default();
        let trace = Arc::<Mutex<Vec<TraceEntry>>>::default();
        let mut link = TestLink::new(bus.clone(), clock.clone(), tap.clone());
        link.set_format(station.format).unwrap();
        let (store, types) = (Store::at_root(folder.path()), EncoderTypes::built_in());
        let mut session = Session::new(Box::new(link), clock.clone(), station, store, types, true);
        let (entries, raw) = (trace.clone(), tap.clone());
        session.add_watcher(move |entry| {
            check_secrets(entry, raw.lock().unwrap().sent.last());
            entries.lock().unwrap().push(entry.clone());
        });
        Desk { bus, clock, tap, trace, folder, session }
    }

    /// Returns the same line at the same time with a new session, as after a cable was reconnected.
    pub(crate) fn reconnected(&self) -> Desk {
        let mut desk =
            Self::plugged(self.bus.clone(), self.clock.clone(), self.folder.clone(), self.session.station().clone());
        *desk.session.access_codes_mut() = self.session.station().codes;
        desk
    }

    /// Returns a copy that includes the line and the time but not the files on disk.
    pub(crate) fn copied(&self) -> Desk {
        let bus = self.bus.lock().unwrap().clone();
        Self::at(bus, &self.clock, self.session.station().clone())
    }

    pub(crate) fn bus(&self) -> MutexGuard<'_, Bus> {
        self.bus.lock().unwrap()
    }

    pub(crate) fn tap(&self) -> MutexGuard<'_, Tap> {
        self.tap.lock().unwrap()
    }

    pub(crate) fn remember_code(&mut self, number: u8, code: u8) {
        self.session.access_codes_mut().set_code(AccessCodeNumber::new(number).unwrap(), AccessCode::new(code));
    }

    pub(crate) fn run(&mut self, job: HiperfaceJob) -> Result<HiperfaceOutput, JobError> {
        self.session.run_inline(job).inspect_err(|error| check_words(&error.to_string()))
    }

    pub(crate) fn prepare(&mut self, change: Change) -> Result<Prepared, JobError> {
        match self.run(HiperfaceJob::Prepare(change))? {
            HiperfaceOutput::Prepared(prepared) => Ok(*prepared),
            other => panic!("{other:?}"),
        }
    }

    pub(crate) fn commit(&mut self, prepared: &Prepared) -> Result<Committed, JobError> {
        self.commit_with(prepared, false)
    }

    pub(crate) fn commit_with_force(&mut self, prepared: &Prepared) -> Result<Committed, JobError> {
        self.commit_with(prepared, true)
    }

    fn commit_with(&mut self, prepared: &Prepared, force_wear: bool) -> Result<Committed, JobError> {
        let (prepared, consent) = (prepared.clone(), Consent::to(prepared.plan.id()));
        match self.run(HiperfaceJob::Commit(Box::new(Commit { prepared, consent, force_wear, undoes: None })))? {
            HiperfaceOutput::Committed(committed) => Ok(committed),
            other => panic!("{other:?}"),
        }
    }

    pub(crate) fn change(&mut self, change: Change) -> Result<Committed, JobError> {
        let prepared = self.prepare(change)?;
        self.commit(&prepared)
    }

    pub(crate) fn restore(&mut self, profile: &HiperfaceProfile) -> Result<Committed, JobError> {
        self.change(restore_of(profile))
    }

    pub(crate) fn save(&mut self) -> Result<HiperfaceProfile, JobError> {
        match self.run(HiperfaceJob::Save(Default::default()))? {
            HiperfaceOutput::Saved(saved) => {
                let SavedProfile { profile, .. } = *saved;
                Ok(profile)
            }
            other => panic!("{other:?}"),
        }
    }

    /// Returns the status byte and content of every data field, read directly from the simulated encoder.
    pub(crate) fn memory(&self) -> Fields {
        let bus = self.bus();
        let memory = bus.encoders()[0].memory();
        let field = |number| (memory.status(number).unwrap().byte(), memory.field_bytes(number).unwrap().to_vec());
        (0..memory.free_memory().fields).map(field).collect()
    }

    /// Returns the number of writes to the encoder's EEPROM.
    pub(crate) fn wear(&self) -> u64 {
        self.bus().encoders()[0].wear().total().into()
    }
}

/// The status byte and content of every data field.
pub(crate) type Fields = Vec<(u8, Vec<u8>)>;

pub(crate) fn restore_of(profile: &HiperfaceProfile) -> Change {
    Change::Restore { profile: Box::new(profile.clone()), options: RestoreOptions::default() }
}

/// Returns the profile in a backup file.
pub(crate) fn backup(path: &std::path::Path) -> HiperfaceProfile {
    ProfileDocument::parse(&read_text(path).unwrap(), program().studio.formats).unwrap().body.into_profile().unwrap()
}

/// Returns pseudo-random bytes for a seed.
pub(crate) fn bytes(seed: u8, count: usize) -> Vec<u8> {
    assert!(count <= MAX_TRANSFER);
    (0..count).map(|at| (at as u8).wrapping_mul(37).wrapping_add(seed.wrapping_mul(101)) ^ (at >> 3) as u8).collect()
}

pub(crate) fn xor(bytes: &[u8]) -> u8 {
    bytes.iter().fold(0, |sum, byte| sum ^ byte)
}

/// Returns the positions of access codes in a request according to the reference, not counting the two head bytes.
fn access_code_offsets(command: u8) -> &'static [usize] {
    match command {
        0x43 | 0x63 => &[6],
        0x49 => &[2],
        0x4A | 0x4B => &[5],
        0x4D => &[4],
        0x4F => &[3, 4],
        0x55 | 0x57 => &[3],
        _ => &[],
    }
}

/// Checks that the trace masks the code and the checksum of a request with an access code and shows the rest. It must
/// not show the request itself as a reply.
fn check_secrets(entry: &TraceEntry, sent: Option<&Vec<u8>>) {
    let shown = entry.bytes.to_string();
    let words: Vec<&str> = shown.split(' ').collect();
    match entry.direction {
        Direction::Sent => {
            let command = u8::from_str_radix(words[1], 16).unwrap();
            let mut secret = access_code_offsets(command).to_vec();
            if !secret.is_empty() {
                secret.push(words.len() - 1);
            }
            for (at, word) in words.iter().enumerate() {
                assert_eq!(*word == "**", secret.contains(&at), "{shown}");
            }
        }
        Direction::Received => {
            // A byte that was read may have the same value as the code without revealing it.
            let can_leak =
                |sent: &&Vec<u8>| !(access_code_offsets(sent[1]).is_empty() || sent[1] == 0x4A && sent[4] == 1);
            let Some(sent) = sent.filter(can_leak) else { return };
            let hex: Vec<String> = sent.iter().map(|byte| format!("{byte:02X}")).collect();
            assert!(!shown.contains(&hex.join(" ")), "{shown}");
        }
    }
}

/// Checks that a user-visible text does not contain any of the codes used in these tests.
pub(crate) fn check_words(text: &str) {
    // A damaged reply may have any checksum.
    if text.contains("checksum") {
        return;
    }
    let upper = text.to_uppercase();
    for code in ["66", "C3", "9D"] {
        let alone = |word: &str| word == code || word == format!("{code}H") || word == format!("0X{code}");
        assert!(!upper.split(|c: char| !c.is_ascii_alphanumeric()).any(alone), "{text}");
    }
}

/// Returns the requests in a trace, each with the replies that follow it.
pub(crate) fn exchanges(trace: &[TraceEntry]) -> Vec<(String, Vec<Vec<u8>>)> {
    let mut exchanges: Vec<(String, Vec<Vec<u8>>)> = Vec::new();
    for entry in trace {
        match entry.direction {
            Direction::Sent => exchanges.push((entry.bytes.to_string(), Vec::new())),
            Direction::Received => {
                if let (Some(bytes), Some(last)) = (entry.bytes.to_bytes(), exchanges.last_mut()) {
                    last.1.push(bytes);
                }
            }
        }
    }
    exchanges
}
