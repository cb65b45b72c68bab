//! Recorded writes to an INTERBUS encoder at a gateway.

use encoder_studio::devices::interbus::jobs::{Change, InterbusJob, InterbusOutput, JobError};
use encoder_studio::devices::interbus::procedures::Error;
use encoder_studio::devices::interbus::procedures::write::EndState;
use encoder_studio::devices::interbus::profile::{Image, Item, ItemValue, RestoreOptions};

use super::{Ready, compare, listen};
use crate::interbus::support::{Stand, cam, program};

const QUERY: &str = "steps=3600&revolutions=1&serial=5&cams=demo&program=2";

fn recorded(name: &str, change: fn(&mut Stand) -> Change, every: usize) {
    let ready = || {
        let mut stand = Stand::new(QUERY);
        let change = change(&mut stand);
        let prepared = stand.prepare(change);
        let (lines, cancel) = listen(&mut stand.session);
        let tap = stand.tap.clone();
        let carry_out = Box::new(move || match stand.commit(prepared) {
            Ok(done) => format!("done, {} verified, {} cycles", done.written.verified, done.written.write_cycles),
            Err(JobError::Interrupted { interrupted, .. }) => format!(
                "{} after {} operations, {} cycles, {}",
                if interrupted.cause == Error::Cancelled { "cancelled" } else { "cut off" },
                interrupted.done.ops,
                interrupted.done.write_cycles,
                if interrupted.end_state == EndState::AsFound { "as found" } else { "not led back" },
            ),
            Err(JobError::Device(Error::Cancelled)) => "cancelled, nothing written".to_owned(),
            Err(JobError::Device(error)) if error.is_lost() => "cut off, nothing written".to_owned(),
            Err(other) => panic!("{other:?}"),
        });
        Ready { tap, cancel, lines, carry_out }
    };
    let undisturbed = ready();
    let (tap, first) = (undisturbed.tap.clone(), undisturbed.tap.lock().unwrap().sent.len());
    undisturbed.run();
    let frames = tap.lock().unwrap().sent.len() - first;
    let points: Vec<usize> = (0..frames).step_by(every).collect();
    compare(&format!("interbus/{name}"), Some(&points), &mut { ready });
}

fn image(stand: &mut Stand) -> Image {
    let survey = match stand.run(InterbusJob::Survey).unwrap() {
        InterbusOutput::Surveyed(survey) => *survey,
        other => panic!("{other:?}"),
    };
    Image::from_parameters(survey.parameters)
}

#[test]
fn parameter_and_cam_writes_match_recording() {
    let parameters = |stand: &mut Stand| {
        let mut wanted = image(stand);
        (wanted.parameters.preset, wanted.parameters.zero_shift) = (17, 3);
        Change::Write(Box::new(wanted))
    };
    recorded("parameters", parameters, 3);
    let mask = |_: &mut Stand| Change::Item(Item::CamMask(program(6)), ItemValue::Mask(0x5A));
    recorded("mask", mask, 3);
    let cams = |stand: &mut Stand| {
        let mut wanted = image(stand);
        let (_, mut own) = stand.programs(&[6]).remove(0);
        (own.cams[0], own.cams[3]) = (Some(cam(10, 20)), Some(cam(3000, 3500)));
        *wanted.program_mut(program(6)).unwrap() = Some(own);
        Change::Write(Box::new(wanted))
    };
    recorded("cams", cams, 7);
}

#[test]
fn preset_and_default_match_recording() {
    recorded("preset", |_| Change::Preset { value: 1800 }, 3);
    recorded("default", |_| Change::Default, 3);
}

#[test]
fn restore_matches_recording() {
    let restore = |stand: &mut Stand| {
        let mut profile = match stand.run(InterbusJob::Save { programs: true }).unwrap() {
            InterbusOutput::Saved(profile) => *profile,
            other => panic!("{other:?}"),
        };
        profile.image.parameters.zero_shift = 9;
        assert!(profile.image.set_value(Item::CamMask(program(1)), ItemValue::Mask(0x33)));
        Change::Restore { profile: Box::new(profile), options: RestoreOptions::default() }
    };
    recorded("restore", restore, 17);
}
