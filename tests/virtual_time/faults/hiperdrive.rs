//! HIPERDRIVE faults over EtherNet/IP: parameters with and without a save, a scale with its limits, the position, and
//! services. TCP neither damages nor inserts bytes.

use std::sync::{Arc, Mutex};
use std::time::Duration;

use encoder_studio::devices::hiperdrive::jobs::{Change, JobError};
use encoder_studio::devices::hiperdrive::profile::Service;
use encoder_studio::devices::hiperdrive::protocol::Value;
use encoder_studio::devices::hiperdrive::sim::{Config, Target};
use encoder_studio::link::{Clock, VirtualClock};
use fastrand::Rng;

use super::{End, Fault, Schedule, campaign, random_faults};
use crate::hiperdrive::support::{Stand, drive, image, number};

/// Numbers of the parameters written by the tests.
const WRITTEN_PARAMETERS: [u16; 8] = [24, 154, 156, 158, 160, 166, 186, 198];

type State = Vec<Value>;

struct Case {
    name: &'static str,
    change: fn() -> Change,
    requests: usize,
    before: State,
    after: State,
}

fn device() -> (Target, Arc<VirtualClock>) {
    (Target::new(&Config::from_pairs(&[]).unwrap()), Arc::default())
}

fn state(stand: &Stand) -> State {
    let now = stand.clock.now();
    WRITTEN_PARAMETERS
        .iter()
        .map(|own| stand.target.with_station(|station| station.read(now, number(*own))).unwrap())
        .collect()
}

/// Returns a session over a link without faults, and the schedule for adding them.
fn session() -> (Stand, Arc<Mutex<Schedule>>) {
    let (target, clock) = device();
    let schedule = Arc::<Mutex<Schedule>>::default();
    (Stand::with_faults(target, clock, schedule.clone()), schedule)
}

fn case(name: &'static str, change: fn() -> Change) -> Case {
    let (mut stand, schedule) = session();
    let prepared = stand.prepare(change()).unwrap_or_else(|error| panic!("{name}: {error}"));
    let before = state(&stand);
    *schedule.lock().unwrap() = Schedule::default();
    stand.commit(prepared).unwrap_or_else(|error| panic!("{name}: {error}"));
    let requests = schedule.lock().unwrap().sent;
    let after = state(&stand);
    Case { name, change, requests, before, after }
}

fn run(cases: &[Case], rng: &mut Rng) -> End {
    let case = rng.choice(cases).unwrap();
    let (mut stand, schedule) = session();
    let prepared = stand.prepare((case.change)()).unwrap();
    let faults = random_faults(rng, case.requests, Duration::from_millis(5), true);
    let loses_power = faults.values().any(|fault| matches!(fault, Fault::PowerLoss));
    let context = format!("{} with {faults:?}", case.name);
    *schedule.lock().unwrap() = Schedule::with(faults);
    let ended = stand.commit(prepared);
    stand.clock.sleep_until(stand.clock.now() + Duration::from_secs(10));
    let left = state(&stand);
    let end = match ended {
        // After a loss of power, the device has only the values that were saved.
        Ok(_) => {
            assert!(left == case.after || loses_power, "{context}: {left:?}");
            End::Done
        }
        Err(JobError::Interrupted { interrupted, backup, .. }) => {
            let values = left.iter().zip(case.before.iter().zip(&case.after));
            let is_planned = values.into_iter().all(|(own, (old, new))| own == old || own == new);
            assert!(is_planned, "{context}: {interrupted}: {left:?}");
            assert!(backup.exists(), "{context}");
            End::Interrupted
        }
        Err(error) => {
            assert!(!error.to_string().is_empty());
            assert_eq!(left, case.before, "{context}: {error}");
            End::NotStarted
        }
    };
    // The cable is plugged in again, and a second run completes the change.
    let mut again = Stand::at(stand.target.clone(), stand.clock.clone());
    let prepared = again.prepare((case.change)()).unwrap_or_else(|error| panic!("{context}: a second plan: {error}"));
    again.commit(prepared).unwrap_or_else(|error| panic!("{context}: a second run: {error}"));
    assert_eq!(state(&again), case.after, "{context}: after a second run");
    end
}

#[test]
fn hiperdrive_changes_survive_faults() {
    let cases = [
        case("parameters", || Change::Write(image(&[(24, 7), (166, 200), (186, 30)]))),
        case("trial values", || Change::Try(image(&[(166, 200), (186, 30)]))),
        case("scale", || Change::Write(image(&[(154, 400), (156, 256), (158, -4_000), (160, 4_000)]))),
        case("position", || Change::SetPosition { drive: drive(1), position: 6_400, save: true }),
        case("factory settings", || Change::Do(Service::Factory)),
    ];
    campaign("hiperdrive", 80, |rng| run(&cases, rng));
}
