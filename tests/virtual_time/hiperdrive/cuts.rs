//! Cuts the connection at every request. The report and the written values are checked, and every job ends within the
//! time limit.

use std::collections::BTreeSet;
use std::time::Duration;

use encoder_studio::devices::hiperdrive::jobs::{Change, HiperdriveJob, JobError};
use encoder_studio::devices::hiperdrive::procedures::Error;
use encoder_studio::devices::hiperdrive::procedures::dead_man::MotionLock;
use encoder_studio::devices::hiperdrive::procedures::write::InterruptedWrite;
use encoder_studio::link::CancelToken;

use super::support::{Stand, drive, image};
use crate::support::Tap;

/// Maximum time that a command waits for a device before it gives up.
const LIMIT: Duration = Duration::from_secs(10);

/// A fault of the connection at a request.
type Cut = fn(&mut Tap, usize);

const LOST: Cut = |tap, at| tap.lost_from = Some(at);
const MUTE: Cut = |tap, at| tap.mute_from = Some(at);
const DEAF: Cut = |tap, at| tap.deaf_from = Some(at);
const REQUEST: Cut = |tap, at| tap.swallow_request = Some(at);
const REPLY: Cut = |tap, at| tap.swallow_reply = Some(at);

/// Returns a change that writes and saves three parameters.
fn write() -> Change {
    Change::Write(image(&[(24, 7), (166, 200), (186, 30)]))
}

/// Returns the number of requests in a write without faults.
fn requests() -> usize {
    let mut stand = Stand::new("");
    let prepared = stand.prepare(write()).unwrap();
    let before = stand.tap().sent.len();
    stand.commit(prepared).unwrap();
    let after = stand.tap().sent.len();
    after - before
}

#[test]
fn retries_single_loss_without_duplicate_write() {
    for (cut, most) in [(REQUEST, 2), (REPLY, 1)] {
        for at in 0..requests() {
            let mut stand = Stand::new("");
            let prepared = stand.prepare(write()).unwrap();
            let before = stand.tap().sent.len();
            cut(&mut stand.tap(), before + at);
            let ended = stand.commit(prepared);
            let sets = stand.sets();
            let times = |own: u16| sets.iter().filter(|(number, _)| *number == own).count();
            match ended {
                Ok(done) => {
                    assert_eq!((done.written.verified, done.written.write_cycles), (3, 1), "{at}");
                    assert_eq!((stand.value(24), stand.value(166), stand.value(186)), (7, 200, 30), "{at}");
                }
                // A save is never sent twice, so it is not known whether it was executed.
                Err(JobError::Interrupted { interrupted, backup, .. }) => {
                    assert_eq!(interrupted.uncertain_write().as_deref(), Some("47"), "{at}: {interrupted}");
                    assert!(backup.exists() && interrupted.done.write_cycles == 1, "{at}");
                    assert_eq!(times(47), 1, "{at}");
                }
                Err(error) => panic!("{at}: {error}"),
            }
            for own in [24, 166, 186] {
                // A value is set again only if reading back has shown that it was not accepted.
                assert!(times(own) <= most, "{at}: {sets:?}");
            }
        }
    }
}

#[test]
fn interrupted_write_reports_progress_in_time() {
    for (label, cut) in [("lost", LOST), ("mute", MUTE), ("deaf", DEAF)] {
        for at in 0..requests() {
            let mut stand = Stand::new("");
            let prepared = stand.prepare(write()).unwrap();
            let (begun, before) = (stand.elapsed(), stand.tap().sent.len());
            cut(&mut stand.tap(), before + at);
            let ended = stand.commit(prepared);
            assert!(stand.elapsed() - begun < LIMIT, "{label} {at}: {:?}", stand.elapsed() - begun);
            let locks = stand.session.motion().motion_permit(drive(1)).locks;
            // Whether the device still owes an answer depends on where the connection was cut.
            let not_known = locks.split_first().is_some_and(|(first, rest)| {
                *first == MotionLock::Unread && rest.iter().all(|own| *own == MotionLock::NoAnswer)
            });
            assert!(not_known, "{label} {at}: the limits of the drive are unknown: {locks:?}");
            match ended {
                Ok(done) => assert_eq!(done.written.verified, 3, "{label} {at}"),
                Err(JobError::Device(error)) => assert!(error.is_lost(), "{label} {at}: {error}"),
                Err(JobError::Interrupted { interrupted, backup, planned, .. }) => {
                    assert!(backup.exists() && interrupted.cause.is_lost(), "{label} {at}: {interrupted}");
                    assert!(interrupted.uncertain_write().is_some() && planned == 4, "{label} {at}");
                    let taken = [(24, 7), (166, 200), (186, 30)].iter().filter(|(own, new)| stand.value(*own) == *new);
                    let taken = taken.count();
                    let known = interrupted.done.verified as usize;
                    assert!((known..=known + 1).contains(&taken), "{label} {at}: {interrupted}");
                }
                Err(other) => panic!("{label} {at}: {other}"),
            }
        }
    }
}

/// Cancels a change at each of its requests in turn and passes each result to `look`.
fn cancel_at_each_request(change: fn() -> Change, mut look: impl FnMut(&Stand, &str, &InterruptedWrite)) {
    for at in 0.. {
        let mut stand = Stand::new("");
        let prepared = stand.prepare(change()).unwrap();
        let cancel = CancelToken::default();
        stand.session.set_cancel(cancel.clone());
        let number = stand.tap().sent.len() + at;
        stand.tap().cancel_at = Some((number, cancel));
        match stand.commit(prepared) {
            Err(JobError::Device(Error::Cancelled)) => assert!(stand.sets().is_empty(), "{at}"),
            Err(JobError::Interrupted { interrupted, .. }) => {
                assert_eq!((&interrupted.cause, interrupted.uncertain_write()), (&Error::Cancelled, None), "{at}");
                look(&stand, &format!("request {at}"), &interrupted);
            }
            // After the last operation, nothing is left to cancel.
            Ok(done) => {
                assert_eq!(stand.value(47), 0, "{at}");
                if stand.tap().sent.len() <= number {
                    return assert!(at > 0 && done.written.write_cycles == 1);
                }
            }
            Err(error) => panic!("{at}: {error}"),
        }
    }
}

#[test]
fn cancels_between_operations() {
    let mut seen = BTreeSet::new();
    cancel_at_each_request(write, |stand, label, interrupted| {
        let taken = [(24, 7), (166, 200), (186, 30)].iter().filter(|(own, new)| stand.value(*own) == *new).count();
        assert_eq!(interrupted.done.ops, taken, "{label}");
        seen.insert(taken);
    });
    // Before the first operation, nothing has begun. After the third, only the save remains.
    assert_eq!(seen.into_iter().collect::<Vec<_>>(), [1, 2, 3]);
}

/// The change sets 400 steps per turn instead of 65536 (reference 5) and limits of ten turns. Writing only the scale or
/// only the limits would move the limits. The maximum speed is written between them.
#[test]
fn cancelling_keeps_scale_and_limits_together() {
    const SCALE_AND_LIMITS: [(u16, i64); 4] = [(154, 400), (156, 256), (158, -4_000), (160, 4_000)];
    let change = || Change::Write(image(&[&[(24, 7), (166, 200)], &SCALE_AND_LIMITS[..], &[(186, 30)]].concat()));
    let mut seen = BTreeSet::new();
    cancel_at_each_request(change, |stand, label, _| {
        let taken = SCALE_AND_LIMITS.iter().filter(|(number, value)| stand.value(*number) == *value).count();
        assert!(taken == 0 || taken == SCALE_AND_LIMITS.len(), "{taken} of scale and limits, {label}");
        seen.insert(taken);
    });
    assert!(seen.contains(&SCALE_AND_LIMITS.len()), "behind them it can be ended: {seen:?}");
}

#[test]
fn lost_device_times_out() {
    let mut stand = Stand::new("");
    stand.tap().deaf_from = Some(0);
    let begun = stand.elapsed();
    let error = stand.run(HiperdriveJob::Hello).unwrap_err();
    assert!(stand.elapsed() - begun < LIMIT);
    assert!(matches!(error, JobError::Device(Error::NoReply { tries: 5, .. })), "{error}");
}
