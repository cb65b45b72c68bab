//! Recorded writes to a HIPERDRIVE adapter or hub.

use encoder_studio::devices::hiperdrive::jobs::{Change, HiperdriveJob, HiperdriveOutput, JobError};
use encoder_studio::devices::hiperdrive::procedures::Error;
use encoder_studio::devices::hiperdrive::profile::{RestoreOptions, Service};

use super::{Ready, compare, listen};
use crate::hiperdrive::support::{Stand, drive, image};

const HUB: &str = "hub=4&drives=1,0,1&requested=1&serial=42";

fn recorded(name: &str, query: &str, change: fn(&mut Stand) -> Change) {
    compare(&format!("hiperdrive/{name}"), None, &mut || {
        let mut stand = Stand::new(query);
        let change = change(&mut stand);
        let prepared = stand.prepare(change).unwrap();
        let (lines, cancel) = listen(&mut stand.session);
        let tap = stand.tap.clone();
        let carry_out = Box::new(move || match stand.commit(prepared) {
            Ok(done) => format!("done, {} verified, {} cycles", done.written.verified, done.written.write_cycles),
            Err(JobError::Interrupted { interrupted, .. }) => format!(
                "{} after {} operations, {} cycles, unclear {:?}",
                if interrupted.cause == Error::Cancelled { "cancelled" } else { "cut off" },
                interrupted.done.ops,
                interrupted.done.write_cycles,
                interrupted.uncertain_write(),
            ),
            Err(JobError::Device(Error::Cancelled)) => "cancelled, nothing written".to_owned(),
            Err(JobError::Device(error)) if error.is_lost() => "cut off, nothing written".to_owned(),
            Err(other) => panic!("{other:?}"),
        });
        Ready { tap, cancel, lines, carry_out }
    });
}

#[test]
fn parameter_writes_match_recording() {
    recorded("write", "", |_| Change::Write(image(&[(24, 7), (166, 200), (186, 30)])));
    recorded("try", "", |_| Change::Try(image(&[(166, 100), (170, 640)])));
    let scale = |_: &mut Stand| Change::Write(image(&[(154, 400), (156, 256), (158, -4_000), (160, 4_000)]));
    recorded("scale-and-limits", "", scale);
    recorded("write-of-a-hub", HUB, |_| Change::Write(image(&[(24, 99), (354, 400), (356, 256)])));
    let position = |_: &mut Stand| Change::SetPosition { drive: drive(1), position: 1000, save: true };
    recorded("set-position", "", position);
}

#[test]
fn services_match_recording() {
    recorded("save", "", |_| Change::Do(Service::Save));
    recorded("recall", "", |_| Change::Do(Service::Recall));
    recorded("factory", "", |_| Change::Do(Service::Factory));
    recorded("factory-all", "", |_| Change::Do(Service::FactoryAll));
    recorded("reset", HUB, |_| Change::Do(Service::Reset));
    recorded("acknowledge", HUB, |_| Change::Do(Service::Acknowledge(drive(3))));
}

#[test]
fn restore_matches_recording() {
    let restore = |stand: &mut Stand| {
        let mut profile = match stand.run(HiperdriveJob::Save).unwrap() {
            HiperdriveOutput::Saved(profile) => profile,
            other => panic!("{other:?}"),
        };
        for (own, value) in image(&[(24, 99), (154, 400), (366, 120)]).values {
            profile.image.values.insert(own, value);
        }
        Change::Restore { profile, options: RestoreOptions::default() }
    };
    recorded("restore", HUB, restore);
}
