//! HIPERFACE faults: changes to data fields, codes, settings, address, counter and position, and restores.

use std::fmt;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use encoder_studio::devices::hiperface::jobs::{
    Change, Commit, Hiperface, HiperfaceJob, HiperfaceOutput, JobError, Prepared, SavedProfile,
};
use encoder_studio::devices::hiperface::procedures::Station;
use encoder_studio::devices::hiperface::profile::{FieldRange, HiperfaceProfile};
use encoder_studio::devices::hiperface::protocol::{
    AccessCode, AccessCodeNumber, DataFieldStatus, DeviceAddress, EncoderTypes, FieldSize, LineSettings,
};
use encoder_studio::devices::hiperface::sim::{Bus, Memory};
use encoder_studio::link::{ByteLink as _, Clock, VirtualClock};
use encoder_studio::profile::Consent;
use encoder_studio::sim::ByteDevice as _;
use encoder_studio::store::Store;
use encoder_studio::worker::Session;
use fastrand::Rng;

use super::{End, FaultyLink, Schedule, assert_one_of, campaign, random_faults};
use crate::support::{Desk, bytes, folder, restore_of};

/// The stored values and position of an encoder.
#[derive(Clone, PartialEq)]
struct State {
    memory: Memory,
    address: DeviceAddress,
    settings: LineSettings,
    counter: u32,
    position: u32,
}

impl fmt::Debug for State {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let State { memory, address, settings, counter, position } = self;
        for number in 0..memory.free_memory().fields {
            let content = memory.field_bytes(number).map(<[u8]>::to_vec);
            write!(f, "{number}: {:?} {content:02X?}; ", memory.status(number))?;
        }
        let code = memory.code(AccessCodeNumber::new(1).unwrap()) == AccessCode::FACTORY;
        write!(f, "{address:?}, {settings:?}, counter {counter}, position {position}, factory code {code}")
    }
}

impl State {
    fn of(bus: &Bus, clock: &VirtualClock) -> Self {
        let encoder = &bus.encoders()[0];
        State {
            memory: encoder.memory().clone(),
            address: encoder.address(),
            settings: encoder.stored_settings(),
            counter: encoder.counter(),
            position: encoder.position(clock.now()),
        }
    }
}

/// A planned change to an encoder, with the states it passes through.
struct Case {
    name: &'static str,
    bus: Bus,
    clock: Arc<VirtualClock>,
    station: Station,
    change: Change,
    prepared: Prepared,
    requests: usize,
    course: Vec<State>,
}

/// A session over a link with faults.
struct Rig {
    bus: Arc<Mutex<Bus>>,
    clock: Arc<VirtualClock>,
    schedule: Arc<Mutex<Schedule>>,
    folder: Arc<tempfile::TempDir>,
    session: Session<Hiperface>,
}

impl Rig {
    fn new(bus: Bus, now: &VirtualClock, station: Station, schedule: Schedule) -> Self {
        let clock = Arc::new(VirtualClock::default());
        clock.sleep_until(now.now());
        Self::plugged(Arc::new(Mutex::new(bus)), clock, Arc::new(folder()), station, schedule)
    }

    fn plugged(
        bus: Arc<Mutex<Bus>>,
        clock: Arc<VirtualClock>,
        folder: Arc<tempfile::TempDir>,
        station: Station,
        schedule: Schedule,
    ) -> Self {
        let schedule = Arc::new(Mutex::new(schedule));
        let supplied = bus.clone();
        let cut_power = move |now| supplied.lock().unwrap().power_cycle(now);
        let mut link = FaultyLink::new(bus.clone(), clock.clone(), schedule.clone(), cut_power);
        link.set_format(station.format).unwrap();
        let (store, types) = (Store::at_root(folder.path()), EncoderTypes::built_in());
        let session = Session::new(Box::new(link), clock.clone(), station, store, types, true);
        Rig { bus, clock, schedule, folder, session }
    }

    /// Returns a new session over a link without faults.
    fn reconnected(&self, station: Station) -> Self {
        Self::plugged(self.bus.clone(), self.clock.clone(), self.folder.clone(), station, Schedule::default())
    }

    fn state(&self) -> State {
        State::of(&self.bus.lock().unwrap(), &self.clock)
    }

    /// Returns the state after the encoder has executed everything it received.
    fn settled_state(&self) -> State {
        self.clock.sleep_until(self.clock.now() + Duration::from_secs(2));
        self.bus.lock().unwrap().poll(self.clock.now());
        self.state()
    }

    fn prepare(&mut self, change: Change) -> Result<Prepared, JobError> {
        match self.session.run_inline(HiperfaceJob::Prepare(change))? {
            HiperfaceOutput::Prepared(prepared) => Ok(*prepared),
            other => panic!("{other:?}"),
        }
    }

    fn commit(&mut self, prepared: Prepared) -> Result<(), JobError> {
        let consent = Consent::to(prepared.plan.id());
        let commit = Commit { prepared, consent, force_wear: false, undoes: None };
        self.session.run_inline(HiperfaceJob::Commit(Box::new(commit))).map(|_| ())
    }
}

/// Returns an encoder with a plain field, a protected field, and an empty field at the end.
fn encoder() -> Desk {
    let mut desk = Desk::new("codes=2:66&position=123456");
    desk.remember_code(2, 0x66);
    let status = DataFieldStatus::from_byte;
    for (number, byte, count) in [(1, 0xE8, 16), (2, 0xC8, 16)] {
        desk.change(Change::CreateField { number, status: status(byte) }).unwrap();
        desk.change(Change::Store(vec![(FieldRange::new(number, 0, count), bytes(number, count))])).unwrap();
    }
    desk.change(Change::LockField { number: 1, lock: true }).unwrap();
    desk.bus().encoder_mut(0).unwrap().set_counter(1234);
    desk
}

fn changes(desk: &mut Desk) -> Vec<(&'static str, Change)> {
    let mut wanted = desk.save().unwrap();
    for (field, places) in [(0, vec![2, 3, 9]), (1, vec![0, 7]), (2, vec![5])] {
        for place in places {
            wanted.fields[field].bytes.as_mut().unwrap()[place] ^= 0x3C;
        }
    }
    let status = DataFieldStatus::from_byte;
    let code = AccessCodeNumber::new(1).unwrap();
    vec![
        ("restore", restore_of(&wanted)),
        ("store", Change::Store(vec![(FieldRange::new(2, 3, 9), bytes(7, 9))])),
        ("create", Change::CreateField { number: 3, status: status(0xC8) }),
        ("lock", Change::LockField { number: 2, lock: true }),
        ("resize", Change::ResizeField { number: 2, size: FieldSize::from_blocks(2).unwrap() }),
        ("delete", Change::DeleteField { number: 2 }),
        ("code", Change::ChangeCode { number: code, new: AccessCode::new(0x9D) }),
        ("position", Change::SetPosition { wanted: 4_000, exact: false, synchronise: false, kit: false }),
        ("address", Change::SetAddress(DeviceAddress::new(0x43).unwrap())),
        ("settings", Change::Configure(LineSettings::from_byte(0xE6))),
        ("clear", Change::ClearCounter),
    ]
}

/// Plans a change and executes it without faults to record the states.
fn case(desk: &mut Desk, name: &'static str, change: Change) -> Case {
    let prepared = desk.prepare(change.clone()).unwrap();
    let (bus, station) = (desk.bus().clone(), desk.session.station().clone());
    let mut rig = Rig::new(bus.clone(), &desk.clock, station.clone(), Schedule::default());
    let mut course = vec![rig.state()];
    rig.commit(prepared.clone()).unwrap_or_else(|error| panic!("{name}: {error}"));
    let requests = rig.schedule.lock().unwrap().sent;
    let after = rig.state();
    // Losing the link from each request on gives the states in between.
    for at in 0..requests {
        let faults = [(at, super::Fault::Lost)].into();
        let mut cut = Rig::new(bus.clone(), &desk.clock, station.clone(), Schedule::with(faults));
        cut.commit(prepared.clone()).unwrap_err();
        let state = cut.settled_state();
        if !course.contains(&state) {
            course.push(state);
        }
    }
    assert_ne!(course.first(), Some(&after), "{name}");
    course.retain(|state| *state != after);
    course.push(after);
    Case { name, bus, clock: desk.clock.clone(), station, change, prepared, requests, course }
}

/// Saves a profile of the encoder and checks that it matches the encoder.
fn save(case: &Case, truth: &HiperfaceProfile, rng: &mut Rng) -> End {
    let faults = random_faults(rng, 60, Duration::from_millis(20), false);
    let context = format!("save with {faults:?}");
    let mut rig = Rig::new(case.bus.clone(), &case.clock, case.station.clone(), Schedule::with(faults));
    match rig.session.run_inline(HiperfaceJob::Save(Default::default())) {
        Ok(HiperfaceOutput::Saved(saved)) => {
            let SavedProfile { profile, .. } = *saved;
            assert_eq!(
                (&profile.identity, &profile.interface, &profile.fields, &profile.recorded.counter),
                (&truth.identity, &truth.interface, &truth.fields, &truth.recorded.counter),
                "{context}"
            );
            End::Done
        }
        Ok(other) => panic!("{other:?}"),
        Err(error) => {
            assert!(!error.to_string().is_empty(), "{context}");
            End::NotStarted
        }
    }
}

fn run(cases: &[Case], truth: &HiperfaceProfile, rng: &mut Rng) -> End {
    let case = rng.choice(cases).unwrap();
    if rng.u8(..5) == 0 {
        return save(case, truth, rng);
    }
    let faults = random_faults(rng, case.requests, Duration::from_millis(20), false);
    let context = format!("{} with {faults:?}", case.name);
    let mut rig = Rig::new(case.bus.clone(), &case.clock, case.station.clone(), Schedule::with(faults));
    let ended = rig.commit(case.prepared.clone());
    let (before, after) = (case.course.first().unwrap(), case.course.last().unwrap());
    let state = rig.settled_state();
    let end = match ended {
        Ok(()) => {
            assert_eq!(state, *after, "{context}");
            End::Done
        }
        Err(JobError::Interrupted { interrupted, backup, .. }) => {
            assert_one_of(&state, &case.course, &format!("{context}: {interrupted}"));
            assert!(backup.exists(), "{context}");
            End::Interrupted
        }
        Err(error) => {
            assert!(!error.to_string().is_empty());
            assert_eq!(state, *before, "{context}: {error}");
            End::NotStarted
        }
    };
    // The line works again. The same session or a new one completes the change or reports why it cannot.
    let mut again = rig.reconnected(case.station.clone());
    match again.prepare(case.change.clone()) {
        Ok(prepared) => {
            // A code that has been changed is no longer the one that the user entered.
            if let Err(error) = again.commit(prepared) {
                assert_eq!(state, *after, "{context}: a second run: {error}");
            }
            assert_eq!(again.state(), *after, "{context}: after a second run");
        }
        Err(why) => assert!(state == *after || state == *before, "{context}: no second run: {why}\n{state:?}"),
    }
    end
}

#[test]
fn hiperface_changes_survive_faults() {
    let mut desk = encoder();
    let truth = desk.save().unwrap();
    let changes = changes(&mut desk);
    let cases: Vec<Case> = changes.into_iter().map(|(name, change)| case(&mut desk, name, change)).collect();
    campaign("hiperface", 860, |rng| run(&cases, &truth, rng));
}
