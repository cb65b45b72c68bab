//! BiSS faults: changing data, filter and preset, calibration and Wiegand test, over the configuration pin and over an
//! adapter, with a simulated user at the motor.

use std::sync::{Arc, Mutex};
use std::time::Duration;

use encoder_studio::devices::biss::jobs::{Change, JobError, Prepared};
use encoder_studio::devices::biss::protocol::{PositionFilter, PresetValue};
use encoder_studio::link::Clock;
use fastrand::Rng;

use super::{End, Schedule, assert_one_of, campaign, random_faults};
use crate::biss::hands::{
    OPERATION_MODE_STATE, TestOperator, assert_reported_state, calibration, data, filter, preset, wiegand_test,
};
use crate::biss::support::{Bench, Handle, Transport};

/// The stored values of the encoder: non-zero OEM data, preset, filter, and whether it is calibrated.
type State = (Vec<(usize, u8)>, PresetValue, PositionFilter, bool);

fn state(encoder: &Handle) -> State {
    encoder.with(|encoder, _| {
        let flash = encoder.flash();
        let set = flash.oem_data().iter().copied().enumerate().filter(|(_, byte)| *byte != 0);
        (set.collect(), flash.preset(), flash.filter(), flash.is_calibrated())
    })
}

/// A planned change to an encoder, with the states it passes through.
struct Case {
    name: String,
    change: fn() -> Change,
    bench: Mutex<Bench>,
    prepared: Prepared,
    requests: usize,
    course: Vec<State>,
    /// Whether an interruption of the change loses the calibration table.
    loses_table: bool,
}

fn hands(bench: &Bench) -> TestOperator {
    let mut hands = TestOperator::on(bench);
    // With this speed range, the test takes the fewest exchanges.
    hands.rpm = (500.0, 2000.0);
    hands
}

fn case(name: &str, way: Transport, change: fn() -> Change) -> Case {
    let mut bench = Bench::new(way, "");
    let prepared = bench.prepare(change()).unwrap();
    let schedule = Arc::<Mutex<Schedule>>::default();
    let mut followed = bench.copied_with_faults(schedule.clone());
    let course = Arc::new(Mutex::new(vec![state(&followed.handle())]));
    let (seen, encoder) = (course.clone(), followed.handle());
    *schedule.lock().unwrap() = Schedule::observed(move || {
        let (state, mut seen) = (state(&encoder), seen.lock().unwrap());
        if !seen.contains(&state) {
            seen.push(state);
        }
    });
    let mut user = hands(&followed);
    followed.commit(&prepared, &mut user).unwrap_or_else(|error| panic!("{name}: {error}"));
    let requests = schedule.lock().unwrap().sent;
    let after = state(&followed.handle());
    let mut course = course.lock().unwrap().clone();
    course.retain(|state| *state != after);
    course.push(after);
    let loses_table = name == "calibration";
    Case {
        loses_table,
        name: format!("{name} over {way:?}"),
        change,
        bench: Mutex::new(bench),
        prepared,
        requests,
        course,
    }
}

/// Returns whether each byte of a preset is from the old or the new preset.
fn has_only_old_or_new_bytes(preset: PresetValue, old: PresetValue, new: PresetValue) -> bool {
    let bytes = |own: PresetValue| [own.singleturn().to_le_bytes(), own.multiturn().to_le_bytes()].concat();
    bytes(preset).iter().zip(bytes(old).iter().zip(bytes(new))).all(|(own, (old, new))| own == old || *own == new)
}

fn run(cases: &[Case], rng: &mut Rng) -> End {
    let case = rng.choice(cases).unwrap();
    let faults = random_faults(rng, case.requests, Duration::from_millis(5), false);
    let context = format!("{} with {faults:?}", case.name);
    let mut bench = case.bench.lock().unwrap().copied_with_faults(Arc::new(Mutex::new(Schedule::with(faults))));
    let mut user = hands(&bench);
    let ended = bench.commit(&case.prepared, &mut user).map_err(|error| *error);
    let after = case.course.last().unwrap();
    bench.clock.sleep_until(bench.clock.now() + Duration::from_secs(2));
    let left = state(&bench.handle());
    let end = match ended {
        Ok(_) => {
            assert_eq!(left, *after, "{context}");
            End::Done
        }
        Err(JobError::Interrupted { interrupted, backup, .. }) => {
            let told = interrupted.to_string();
            let mut course = case.course.clone();
            if case.loses_table {
                // An interrupted calibration leaves no valid table.
                course.extend(
                    case.course.iter().map(|(data, preset, filter, _)| (data.clone(), *preset, *filter, false)),
                );
            }
            if told.contains(" was read back") {
                // One byte did not arrive, and the others were saved. The error names it.
                let mut mixed = left.clone();
                mixed.1 = after.1;
                assert!(has_only_old_or_new_bytes(left.1, case.course[0].1, after.1), "{context}: {told}: {left:?}");
                assert_one_of(&mixed, &course, &context);
            } else {
                assert_one_of(&left, &course, &format!("{context}: {told}"));
            }
            assert!(backup.exists(), "{context}");
            assert_reported_state(&interrupted.end_state, &bench, &format!("{context}: {told}"));
            End::Interrupted
        }
        Err(error) => {
            assert!(!error.to_string().is_empty());
            assert_eq!(left, case.course[0], "{context}: {error}");
            End::NotStarted
        }
    };
    // The line works again. The encoder is returned to operation, and the change is completed.
    let mut again = bench.reconnected();
    again.motor().set_rpm(0.0);
    again.return_to_operation().unwrap_or_else(|error| panic!("{context}: {error}"));
    assert_eq!(again.mode_and_password(), OPERATION_MODE_STATE, "{context}");
    let prepared = again.prepare((case.change)()).unwrap_or_else(|error| panic!("{context}: a second plan: {error}"));
    let mut user = hands(&again);
    again.commit(&prepared, &mut user).unwrap_or_else(|error| panic!("{context}: a second run: {error}"));
    assert_eq!(state(&again.handle()), *after, "{context}: after a second run");
    assert_eq!(again.mode_and_password(), OPERATION_MODE_STATE, "{context}");
    end
}

#[test]
fn biss_changes_survive_faults() {
    type Scene = (&'static str, fn() -> Change);
    let scenes: [Scene; 5] = [
        ("data", data),
        ("filter", filter),
        ("preset", || preset(0x18000, 2)),
        ("calibration", calibration),
        ("Wiegand test", || wiegand_test(true)),
    ];
    let ways = [Transport::ConfigPin, Transport::Adapter];
    let cases: Vec<Case> = ways.iter().flat_map(|way| scenes.map(|(name, change)| case(name, *way, change))).collect();
    campaign("biss", 15, |rng| run(&cases, rng));
}
