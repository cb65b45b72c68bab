//! Cuts the connection at every request. The report and the state of the encoder are checked, and every job ends within
//! the time limit.

use std::time::Duration;

use encoder_studio::devices::interbus::jobs::{Change, Commit, InterbusJob, InterbusOutput, JobError};
use encoder_studio::devices::interbus::procedures::Error;
use encoder_studio::devices::interbus::procedures::write::EndState;
use encoder_studio::devices::interbus::profile::{Item, ItemValue};
use encoder_studio::devices::interbus::protocol::StartupMode;
use encoder_studio::profile::Consent;

use super::support::{Stand, program};
use crate::support::Tap;

const QUERY: &str = "steps=3600&revolutions=1&serial=5&cams=demo&program=2";
/// Maximum time that a command waits for a gateway before it gives up.
const LIMIT: Duration = Duration::from_secs(12);

/// A fault of the connection at a request.
type Cut = fn(&mut Tap, usize);

const LOST: Cut = |tap, at| tap.lost_from = Some(at);
const MUTE: Cut = |tap, at| tap.mute_from = Some(at);
const DEAF: Cut = |tap, at| tap.deaf_from = Some(at);
const REQUEST: Cut = |tap, at| tap.swallow_request = Some(at);
const REPLY: Cut = |tap, at| tap.swallow_reply = Some(at);

/// Returns the number of requests in a job without faults.
fn requests(job: impl Fn(&mut Stand) -> InterbusJob) -> usize {
    let mut stand = Stand::new(QUERY);
    let job = job(&mut stand);
    stand.tap().sent.clear();
    stand.run(job).unwrap();
    let tap = stand.tap();
    tap.sent.len()
}

/// Returns a job that writes two parameters and a mask.
fn write(stand: &mut Stand) -> InterbusJob {
    let survey = match stand.run(InterbusJob::Survey).unwrap() {
        InterbusOutput::Surveyed(survey) => *survey,
        other => panic!("{other:?}"),
    };
    let mut wanted = encoder_studio::devices::interbus::profile::Image::from_parameters(survey.parameters);
    let (_, own) = stand.programs(&[6]).remove(0);
    *wanted.program_mut(program(6)).unwrap() = Some(own);
    (wanted.parameters.preset, wanted.parameters.zero_shift) = (17, 3);
    assert!(wanted.set_value(Item::CamMask(program(6)), ItemValue::Mask(!own.mask)));
    let prepared = stand.prepare(Change::Write(Box::new(wanted)));
    let consent = Consent::to(prepared.plan.id());
    InterbusJob::Commit(Box::new(Commit { prepared, consent, force_wear: false, undoes: None }))
}

#[test]
fn retries_single_loss_transparently() {
    for cut in [REQUEST, REPLY] {
        for at in (0..requests(|_| InterbusJob::Identify)).step_by(2) {
            let mut stand = Stand::new(QUERY);
            cut(&mut stand.tap(), at);
            match stand.run(InterbusJob::Identify).unwrap() {
                InterbusOutput::Identity(identity) => assert_eq!(identity.serial_number, "5", "{at}"),
                other => panic!("{other:?}"),
            }
            assert_eq!(stand.left(), (0, StartupMode::Cams(program(2))), "{at}");
        }
        for at in (0..requests(write)).step_by(29) {
            let mut stand = Stand::new(QUERY);
            let stores = stand.stores();
            let job = write(&mut stand);
            stand.tap().sent.clear();
            cut(&mut stand.tap(), at);
            let done = match stand.run(job).unwrap() {
                InterbusOutput::Committed(done) => *done,
                other => panic!("{other:?}"),
            };
            assert_eq!((done.written.verified, stand.stores() - stores), (3, 2), "{at}");
            assert_eq!(stand.left(), (0, StartupMode::Cams(program(2))), "{at}");
        }
    }
}

#[test]
fn interrupted_read_reports_out_word() {
    for (cut, hears) in [(LOST, false), (MUTE, true), (DEAF, false)] {
        for at in (0..requests(|_| InterbusJob::Identify)).step_by(2) {
            let mut stand = Stand::new(QUERY);
            cut(&mut stand.tap(), at);
            let error = stand.run(InterbusJob::Identify).unwrap_err();
            assert!(stand.elapsed() < LIMIT, "{at}: {:?}", stand.elapsed());
            let JobError::Device(error) = error else { panic!("{at}: {error}") };
            assert!(error.is_lost(), "{at}: {error}");
            let (out, mode) = stand.left();
            assert_eq!(mode, StartupMode::Cams(program(2)), "{at}");
            match error {
                // The last word has reached the encoder, unless that word was the lost one.
                Error::ModeNotRestored { standing, .. } => assert!(!hears || standing.out == out, "{at}: {standing}"),
                _ => assert_eq!(out, 0, "{at}"),
            }
        }
    }
}

#[test]
fn interrupted_write_reports_possible_state() {
    let count = requests(write);
    for cut in [LOST, MUTE, DEAF] {
        for at in (0..count).step_by(31) {
            let mut stand = Stand::new(QUERY);
            let stores = stand.stores();
            let job = write(&mut stand);
            stand.tap().sent.clear();
            cut(&mut stand.tap(), at);
            let begun = stand.elapsed();
            let ended = stand.run(job);
            let spent = u64::from(stand.stores() - stores);
            let (out, mode) = stand.left();
            match ended {
                Err(JobError::Interrupted { interrupted, backup, .. }) => {
                    assert!(backup.exists() && interrupted.cause.is_lost(), "{at}: {interrupted}");
                    assert!(spent <= interrupted.done.write_cycles, "{at}: {interrupted}");
                    match interrupted.end_state {
                        EndState::Unknown(standing) => {
                            assert_eq!(standing.found, Some(StartupMode::Cams(program(2))), "{at}");
                            assert!(
                                interrupted.to_string().contains("could not be returned to operation"),
                                "{at}: {interrupted}"
                            );
                        }
                        // The last word that the encoder received was that of normal operation.
                        EndState::AsFound => assert_eq!((out, mode), (0, StartupMode::Cams(program(2))), "{at}"),
                    }
                }
                Err(JobError::Device(error)) => assert!(error.is_lost() && spent == 0, "{at}: {error}"),
                other => panic!("{at}: {other:?}"),
            }
            assert!(stand.elapsed() - begun < LIMIT + MAX_EXCHANGE_DURATION, "{at}: {:?}", stand.elapsed() - begun);
            // The cable is plugged in again, and the encoder can be returned to its mode.
            *stand.tap() = Tap::default();
            stand.run(InterbusJob::RestoreMode).unwrap();
            assert!(stand.session.take_sample().unwrap().is_valid(), "{at}");
            assert_eq!(stand.left().0, 0, "{at}");
        }
    }
}

/// Maximum time for the exchange before the cut.
const MAX_EXCHANGE_DURATION: Duration = Duration::from_secs(8);

/// The simulated faults of the gateway do not affect the results.
#[test]
fn tolerates_faulty_gateway() {
    for fault in ["drop:0.05", "garbage:0.03", "delay:40"] {
        for seed in 0..4 {
            let mut stand = Stand::new(&format!("{QUERY}&seed={seed}&fault={fault}"));
            match stand.run(InterbusJob::Identify) {
                Ok(InterbusOutput::Identity(identity)) => assert_eq!(identity.serial_number, "5", "{fault}"),
                other => panic!("{fault}: {other:?}"),
            }
        }
    }
    let mut stand = Stand::new(&format!("{QUERY}&exception=0.05&seed=3"));
    assert!(matches!(stand.run(InterbusJob::Survey), Ok(InterbusOutput::Surveyed(_))));
}

/// The connection is cut while a cam program is selected. The next run restores the mode from before the reading
/// instead of keeping this program (issue 22.6).
#[test]
fn next_run_restores_mode_after_interrupted_read() {
    let save = || InterbusJob::Save { programs: true };
    for (query, found) in [
        ("steps=3600&revolutions=1&serial=77&cams=demo", StartupMode::K3),
        ("steps=3600&revolutions=1&serial=77&cams=demo&program=7&selection=output", StartupMode::Cams(program(7))),
    ] {
        let mut whole = Stand::new(query);
        whole.run(save()).unwrap();
        let count = whole.tap().sent.len();
        let mut away = 0;
        for at in (0..count).step_by(41) {
            let mut stand = Stand::new(query);
            LOST(&mut stand.tap(), at);
            stand.run(save()).unwrap_err();
            away += usize::from(stand.left().1 != found);
            stand.run_again();
            match stand.run(InterbusJob::Identify) {
                // The encoder still shows the echo of a selection, so the user has to confirm that no other master uses
                // it.
                Err(JobError::Device(Error::NotRunning { .. })) => {
                    stand.run(InterbusJob::RestoreMode).unwrap();
                }
                ended => assert!(ended.is_ok(), "{at}: {ended:?}"),
            }
            assert_eq!(stand.left(), (0, found), "{at}");
            // The mode is restored only once: a program selected later is the choice of another master.
            let chosen = StartupMode::Cams(program(4));
            stand.run(InterbusJob::Select(chosen)).unwrap();
            stand.run_again();
            stand.run(InterbusJob::Identify).unwrap();
            assert_eq!(stand.left(), (0, chosen), "{at}");
        }
        assert!(away > 5, "{away}");
    }
}

/// A mode that this program has not set was chosen by another master and is kept (issue 22.6).
#[test]
fn keeps_mode_of_another_master() {
    let query = "steps=3600&revolutions=1&serial=77&cams=demo";
    let mut whole = Stand::new(query);
    whole.run(InterbusJob::Save { programs: false }).unwrap();
    let cut = whole.tap().sent.len() + 60;
    let mut stand = Stand::new(query);
    LOST(&mut stand.tap(), cut);
    stand.run(InterbusJob::Save { programs: true }).unwrap_err();
    assert!(matches!(stand.left().1, StartupMode::Cams(_)));
    let now = encoder_studio::link::Clock::now(&*stand.clock);
    stand.gateway.with_encoder(|encoder| [0x2080_0008, 0x8000_0000, 0].map(|word| encoder.write(now, word)));
    stand.run_again();
    stand.run(InterbusJob::Identify).unwrap();
    assert_eq!(stand.left(), (0, StartupMode::Cams(program(8))));
}
