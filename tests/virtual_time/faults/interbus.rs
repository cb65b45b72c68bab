//! INTERBUS faults: parameters, cams and masks, start-up mode and preset, over a gateway. Modbus/TCP neither damages
//! nor inserts bytes, so replies are lost or late, the link ends, and the encoder loses power.

use std::sync::{Arc, Mutex};
use std::time::Duration;

use encoder_studio::devices::interbus::jobs::{Change, Commit, Interbus, InterbusJob, InterbusOutput, JobError};
use encoder_studio::devices::interbus::procedures::Error;
use encoder_studio::devices::interbus::procedures::write::InterruptedWrite;
use encoder_studio::devices::interbus::profile::{Image, Item, ItemValue};
use encoder_studio::devices::interbus::protocol::{CamNumber, ProgramNumber, StartupMode};
use encoder_studio::devices::interbus::sim::{Gateway, Memory};
use encoder_studio::link::VirtualClock;
use encoder_studio::profile::Consent;
use encoder_studio::store::Store;
use encoder_studio::worker::Session;
use fastrand::Rng;

use super::{End, Fault, FaultyLink, Schedule, assert_one_of, campaign, random_faults};
use crate::interbus::support::{cam, gateway, program, station};
use crate::support::folder;

const QUERY: &str = "steps=3600&revolutions=1&serial=77&cams=demo&program=2&position=100";

/// The encoder's stored values, active values and start-up mode.
type State = (Memory, Memory, StartupMode);

struct Rig {
    gateway: Gateway,
    clock: Arc<VirtualClock>,
    schedule: Arc<Mutex<Schedule>>,
    folder: tempfile::TempDir,
    session: Session<Interbus>,
}

impl Rig {
    fn new() -> Self {
        let (gateway, clock, folder) = (gateway(QUERY), Arc::new(VirtualClock::default()), folder());
        let schedule = Arc::<Mutex<Schedule>>::default();
        let session = session(&gateway, &clock, &schedule, &folder);
        Rig { gateway, clock, schedule, folder, session }
    }

    /// Opens a new session over a link without faults, as a new run of the program would.
    fn reconnect(&mut self) {
        self.schedule = Arc::default();
        self.session = session(&self.gateway, &self.clock, &self.schedule, &self.folder);
    }

    fn set_faults(&self, schedule: Schedule) {
        *self.schedule.lock().unwrap() = schedule;
    }

    fn state(&self) -> State {
        state(&self.gateway)
    }

    fn commit_job(&mut self, change: Change) -> Result<InterbusJob, JobError> {
        match self.session.run_inline(InterbusJob::Prepare(change))? {
            InterbusOutput::Prepared(prepared) => {
                let consent = Consent::to(prepared.plan.id());
                let commit = Commit { prepared: *prepared, consent, force_wear: true, undoes: None };
                Ok(InterbusJob::Commit(Box::new(commit)))
            }
            other => panic!("{other:?}"),
        }
    }
}

fn state(gateway: &Gateway) -> State {
    gateway.with_encoder(|encoder| (encoder.stored().clone(), encoder.memory().clone(), encoder.startup_mode()))
}

fn session(
    gateway: &Gateway,
    clock: &Arc<VirtualClock>,
    schedule: &Arc<Mutex<Schedule>>,
    folder: &tempfile::TempDir,
) -> Session<Interbus> {
    let supplied = gateway.clone();
    let cut_power = move |now| {
        supplied.with_encoder(|encoder| {
            encoder.disconnect();
            encoder.connect(now);
        });
    };
    let device = Arc::new(Mutex::new(gateway.new_connection()));
    let link = FaultyLink::new(device, clock.clone(), schedule.clone(), cut_power);
    let store = Store::at_root(folder.path());
    Session::for_gateway(Box::new(link), clock.clone(), station(""), store, Some(gateway.shaft_motor()))
}

/// A change with the states it passes through and the number of requests.
struct Case {
    name: &'static str,
    change: Change,
    requests: usize,
    course: Vec<State>,
}

fn changes() -> Vec<(&'static str, Change)> {
    let mut rig = Rig::new();
    let survey = match rig.session.run_inline(InterbusJob::Survey).unwrap() {
        InterbusOutput::Surveyed(survey) => *survey,
        other => panic!("{other:?}"),
    };
    let own = match rig.session.run_inline(InterbusJob::Programs(vec![program(6)])).unwrap() {
        InterbusOutput::Programs(mut read, _) => read.remove(0).1,
        other => panic!("{other:?}"),
    };
    let mut wanted = Image::from_parameters(survey.parameters);
    *wanted.program_mut(program(6)).unwrap() = Some(own);
    (wanted.parameters.preset, wanted.parameters.zero_shift) = (17, 3);
    assert!(wanted.set_value(Item::CamMask(program(6)), ItemValue::Mask(!own.mask)));
    let third = Item::Cam(program(3), CamNumber::new(2).unwrap());
    vec![
        ("parameters and a mask", Change::Write(Box::new(wanted))),
        ("a cam", Change::Item(third, ItemValue::Cam(cam(100, 1700)))),
        ("zero shift", Change::Item(Item::ZeroShift, ItemValue::Number(30))),
        ("window shift", Change::Item(Item::Shift, ItemValue::Number(2))),
        ("preset", Change::Preset { value: 1234 }),
    ]
}

/// Executes a change without faults to record the states in which an interruption can leave the encoder. A loss of
/// power discards the values that are not stored.
fn case(name: &'static str, change: Change) -> Case {
    let mut rig = Rig::new();
    let job = rig.commit_job(change.clone()).unwrap();
    let course = Arc::new(Mutex::new(vec![rig.state()]));
    let (seen, gateway) = (course.clone(), rig.gateway.clone());
    let on_request = move || {
        let (stored, working, mode) = state(&gateway);
        for state in [(stored.clone(), working, mode), (stored.clone(), stored, mode)] {
            let mut seen = seen.lock().unwrap();
            if !seen.contains(&state) {
                seen.push(state);
            }
        }
    };
    rig.set_faults(Schedule::observed(on_request));
    rig.session.run_inline(job).unwrap_or_else(|error| panic!("{name}: {error}"));
    let requests = rig.schedule.lock().unwrap().sent;
    let after = rig.state();
    let mut course = course.lock().unwrap().clone();
    assert_ne!(course.first(), Some(&after), "{name}");
    course.retain(|state| *state != after);
    course.push(after);
    Case { name, change, requests, course }
}

/// Asserts that the encoder stored a state of the plan. After a loss of power, some values may be old and some new, and
/// the error must name one that differs from the plan.
fn assert_partly_stored(stored: &Memory, case: &Case, interrupted: &InterruptedWrite, context: &str) {
    if case.course.iter().any(|(state, ..)| state == stored) {
        return;
    }
    let [before, after] = [case.course.first(), case.course.last()].map(|state| values(&state.unwrap().0));
    for ((stored, before), after) in values(stored).into_iter().zip(before).zip(after) {
        assert!(stored == before || stored == after, "{context}: {stored} is neither {before} nor {after}");
    }
    assert!(matches!(interrupted.cause, Error::NotAccepted { .. }), "{context}: {stored:?} is not described");
}

/// Returns all values of a memory.
fn values(memory: &Memory) -> Vec<u32> {
    let (gear, shift) = (memory.gear(), u32::from(memory.shift().get()));
    let mut values =
        vec![gear.total_steps(), gear.turns(), memory.direction(), memory.preset(), memory.zero_shift(), shift];
    for number in ProgramNumber::all() {
        let program = memory.program(number);
        values.push(program.mask.into());
        values.extend(program.cams.iter().flatten().flat_map(|cam| [cam.start.get(), cam.stop.get()]));
    }
    values
}

fn run(cases: &[Case], rng: &mut Rng) -> End {
    let case = rng.choice(cases).unwrap();
    let mut rig = Rig::new();
    let job = rig.commit_job(case.change.clone()).unwrap();
    let faults = random_faults(rng, case.requests, Duration::from_millis(5), true);
    let loses_power = faults.values().any(|fault| matches!(fault, Fault::PowerLoss));
    let context = format!("{} with {faults:?}", case.name);
    rig.set_faults(Schedule::with(faults));
    let ended = rig.session.run_inline(job);
    let (before, after) = (case.course.first().unwrap(), case.course.last().unwrap());
    let state = rig.state();
    let end = match ended {
        Ok(_) => {
            assert_eq!(state, *after, "{context}");
            End::Done
        }
        Err(JobError::Interrupted { interrupted, backup, .. }) => {
            let context = format!("{context}: {interrupted}");
            if loses_power {
                assert_partly_stored(&state.0, case, &interrupted, &context);
            } else {
                assert_one_of(&state, &case.course, &context);
            }
            assert!(backup.exists(), "{context}");
            End::Interrupted
        }
        Err(error) => {
            // A write begins in another mode, which remains if the encoder cannot be reached.
            let is_left = error.to_string().contains("could not be returned to operation");
            assert_eq!((&state.0, &state.1), (&before.0, &before.1), "{context}: {error}");
            assert!(state.2 == before.2 || is_left, "{context}: {error}");
            End::NotStarted
        }
    };
    // The cable is plugged in again. The encoder is returned to operation, and the change is completed.
    rig.reconnect();
    rig.session.run_inline(InterbusJob::RestoreMode).unwrap_or_else(|error| panic!("{context}: {error}"));
    let job = rig.commit_job(case.change.clone()).unwrap_or_else(|error| panic!("{context}: a second plan: {error}"));
    rig.session.run_inline(job).unwrap_or_else(|error| panic!("{context}: a second run: {error}"));
    assert_eq!(rig.state(), *after, "{context}: after a second run");
    end
}

#[test]
fn interbus_changes_survive_faults() {
    let cases: Vec<Case> = changes().into_iter().map(|(name, change)| case(name, change)).collect();
    campaign("interbus", 45, |rng| run(&cases, rng));
}
