//! Recorded writes to a BiSS encoder over its configuration pin and over an adapter.

use encoder_studio::devices::biss::jobs::{Change, JobError};
use encoder_studio::devices::biss::procedures::Error;
use encoder_studio::devices::biss::procedures::procedure::Failure;
use encoder_studio::devices::biss::profile::{Bank, MotorSource, MountingSteps, PresetParts};
use encoder_studio::devices::biss::protocol::PresetValue;

use super::{Ready, compare, listen};
use crate::biss::hands::{TestOperator, calibration, data, exchanges, filter, preset, restore_of, wiegand_test};
use crate::biss::support::{Bench, Transport};

/// Speed range in rpm at which the runs need the fewest exchanges.
const RPM: (f64, f64) = (500.0, 2000.0);

fn recorded(name: &str, change: fn(&mut Bench) -> Change, every: usize) {
    for (label, way) in [("pin", Transport::ConfigPin), ("adapter", Transport::Adapter)] {
        let mut original = Bench::new(way, "");
        let change = change(&mut original);
        let prepared = original.prepare(change).unwrap();
        let points: Vec<usize> = exchanges(&original, &prepared).into_iter().step_by(every).collect();
        compare(&format!("biss/{name}-{label}"), Some(&points), &mut || {
            let (mut bench, prepared) = (original.copied(), prepared.clone());
            let (lines, cancel) = listen(&mut bench.session);
            let tap = bench.tap_handle();
            let carry_out = Box::new(move || {
                let mut hands = TestOperator::on(&bench);
                hands.rpm = RPM;
                match bench.commit(&prepared, &mut hands).map_err(|error| *error) {
                    Ok(done) => format!("done, {} operations, {} cycles", done.written.ops, done.written.write_cycles),
                    Err(JobError::Interrupted { interrupted, .. }) => format!(
                        "{} after {} operations, {} cycles, {}",
                        if interrupted.cause == Failure::Device(Error::Cancelled) { "cancelled" } else { "cut off" },
                        interrupted.done.ops,
                        interrupted.done.write_cycles,
                        if interrupted.end_state.standing.is_none() { "in operation" } else { "not led back" },
                    ),
                    Err(JobError::Device(Error::Cancelled)) => "cancelled, nothing written".to_owned(),
                    Err(JobError::Device(error)) if error.is_lost() => "cut off, nothing written".to_owned(),
                    Err(other) => panic!("{other}"),
                }
            });
            Ready { tap, cancel, lines, carry_out }
        });
    }
}

#[test]
fn register_writes_match_recording() {
    recorded("data", |_| data(), 2);
    recorded("filter", |_| filter(), 2);
    recorded("preset", |_| preset(0x18000, 2), 2);
    let value_alone = |_: &mut Bench| Change::Preset { value: PresetValue::new(5, 1), parts: None };
    recorded("preset-value", value_alone, 2);
}

#[test]
fn restore_matches_recording() {
    let restore = |bench: &mut Bench| {
        let mut profile = bench.save();
        for area in &mut profile.data {
            area.empty = None;
        }
        profile.data[0].listed = vec![Bank { number: 0x04, bytes: [3; 64] }.into()];
        profile.data[1].listed = vec![Bank { number: 0x24, bytes: [7; 64] }.into()];
        restore_of(&profile)
    };
    recorded("restore", restore, 7);
}

#[test]
fn guided_procedures_match_recording() {
    recorded("calibration", |_| calibration(), 7);
    recorded("wiegand-test", |_| wiegand_test(false), 7);
    recorded("wiegand-test-saved", |_| wiegand_test(true), 7);
    let mounting = |_: &mut Bench| {
        let preset = PresetValue::new(0x18000, 2).map(|value| (value, PresetParts::Both));
        let run = MountingSteps { calibrate: true, wiegand: Some(true), preset, data: None };
        Change::Guided { run, motor: MotorSource::Other }
    };
    recorded("mounting", mounting, 23);
}
