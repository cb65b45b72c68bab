//! Writing: exactly the planned values are set and read back, followed by one save. Rejections state their reasons.

use encoder_studio::devices::hiperdrive::jobs::{Change, ChangeKind, HiperdriveJob, HiperdriveOutput, JobError};
use encoder_studio::devices::hiperdrive::procedures::dead_man::MotionLock;
use encoder_studio::devices::hiperdrive::procedures::{DisplayedLimits, Error, RequestedItem};
use encoder_studio::devices::hiperdrive::profile::{HiperdriveProfile, PlanError, RestoreOptions, Service};
use encoder_studio::devices::hiperdrive::protocol::{ErrorCode, ParameterRange, Value};
use encoder_studio::kinds::program;
use encoder_studio::link::Clock;
use encoder_studio::profile::ProfileDocument;
use encoder_studio::store::read_text;
use encoder_studio::worker::NotStarted;

use super::support::{Stand, drive, image, number};

fn device_error<T: std::fmt::Debug>(ended: Result<T, JobError>) -> Error {
    match ended {
        Err(JobError::Device(error)) => error,
        Err(JobError::Interrupted { interrupted, .. }) => interrupted.cause,
        other => panic!("{other:?}"),
    }
}

#[test]
fn writes_differences_and_saves_once() {
    let mut stand = Stand::new("serial=42");
    let done = stand.change(Change::Write(image(&[(24, 7), (166, 200), (188, 1)]))).unwrap();
    assert_eq!((done.written.ops, done.written.written, done.written.verified), (3, 2, 2));
    assert_eq!(done.written.write_cycles, 1);
    // Parameter 188 is already 1.
    let sets = stand.sets();
    assert_eq!(sets, [(24, vec![7, 0, 0, 0]), (166, vec![200, 0]), (47, vec![1, 0])]);
    assert_eq!((stand.value(24), stand.value(166), stand.value(47)), (7, 200, 0), "it waits until it is saved");
    let now = stand.clock.now();
    stand.target.with_station(|station| station.power_cycle(now));
    assert_eq!(stand.value(166), 200);
    let before = ProfileDocument::parse(&read_text(&done.backup.unwrap()).unwrap(), program().studio.formats).unwrap();
    assert_eq!(before.body.get::<HiperdriveProfile>().unwrap().image.get(number(166)), Some(350));
    let done = stand.change(Change::Write(image(&[(24, 7)]))).unwrap();
    assert!(done.backup.is_none() && stand.sets().len() == 3, "what is so already is not written");
    let prepared = stand.prepare(Change::Write(image(&[(24, 8)]))).unwrap();
    assert_eq!(
        (prepared.cycles_seen, prepared.wear_to_report()),
        (Some(encoder_studio::worker::commit::CycleCount::complete(1)), None),
        "saves are counted by the device's number"
    );
}

/// The number of saves has no known limit but is counted. If it cannot be counted, a write must be forced (issue 22.4).
#[test]
fn unreadable_save_count_needs_force() {
    let mut stand = Stand::new("serial=42");
    stand.block_logbook();
    let prepared = stand.prepare(Change::Write(image(&[(24, 7)]))).unwrap();
    let error = stand.commit(prepared.clone()).unwrap_err();
    assert!(matches!(error, JobError::NotStarted(NotStarted::WearUnknown { cost: 1 })), "{error}");
    assert!(stand.sets().is_empty());
    let done = stand.commit_with(prepared, true).unwrap();
    assert!(done.logbook_warning.is_some() && stand.value(24) == 7);
}

#[test]
fn does_not_save_trial_values() {
    let mut stand = Stand::new("");
    let done = stand.change(Change::Try(image(&[(166, 100), (170, 640)]))).unwrap();
    assert_eq!((done.written.write_cycles, stand.value(166), stand.value(170)), (0, 100, 640));
    // A recall applies to the adapter's own parameters (issue 21.6 d).
    stand.change(Change::Do(Service::Recall)).unwrap();
    assert_eq!(stand.value(166), 100);
    let now = stand.clock.now();
    stand.target.with_station(|station| station.power_cycle(now));
    assert_eq!((stand.value(166), stand.value(170)), (350, 4096));
}

#[test]
fn writes_limits_in_accepted_order() {
    // The limits move from ±511 turns to a range far above, and then back below, where the other limit must be written
    // first.
    let mut stand = Stand::new("position=655360");
    stand.change(Change::Write(image(&[(158, 600_000), (160, 700_000)]))).unwrap();
    assert_eq!((stand.value(158), stand.value(160)), (600_000, 700_000));
    let outside = stand.prepare(Change::Write(image(&[(158, 0), (160, 100_000)]))).unwrap_err();
    let JobError::Plan(PlanError::PositionOutside { position, lower, upper, .. }) = outside else {
        panic!("{outside}")
    };
    assert_eq!((position, lower, upper), (655_360, 0, 100_000));
    assert_eq!(stand.value(158), 600_000, "nothing is written");
}

#[test]
fn restores_profile_after_factory_reset() {
    let mut stand = Stand::new("hub=4&drives=1,0,1&requested=1&serial=42");
    stand.change(Change::Write(image(&[(24, 99), (154, 400), (156, 256), (358, -131_072), (360, 131_072)]))).unwrap();
    let profile: Box<HiperdriveProfile> = match stand.run(HiperdriveJob::Save).unwrap() {
        HiperdriveOutput::Saved(profile) => profile,
        other => panic!("{other:?}"),
    };
    assert_eq!(profile.image.get(number(258)), None, "an empty place keeps nothing");
    stand.change(Change::Do(Service::Factory)).unwrap();
    assert_eq!((stand.value(24), stand.value(154), stand.value(358)), (0, 400, -131_072), "the hub's own alone");
    stand.change(Change::Do(Service::FactoryAll)).unwrap();
    assert_eq!((stand.value(24), stand.value(154), stand.value(358)), (0, 256, -33_488_896));
    // In the factory settings, a hub requests no drive, so the request must be restored as well.
    let change = || Change::Restore { profile: profile.clone(), options: RestoreOptions::default() };
    let done = stand.change(change()).unwrap();
    assert_eq!(done.written.write_cycles, 1);
    assert_eq!((stand.value(24), stand.value(154), stand.value(156), stand.value(358)), (99, 400, 256, -131_072));
    let again = stand.prepare(change()).unwrap();
    assert!(again.plan.is_empty() && again.unchanged > 20, "{:?}", again.plan);
    assert!(!stand.sets().iter().any(|(own, _)| matches!(own % 100, 1..=4) && *own > 100), "nothing moves");
}

#[test]
fn changed_device_or_value_stops_write() {
    let mut stand = Stand::new("serial=42");
    let prepared = stand.prepare(Change::Write(image(&[(166, 100)]))).unwrap();
    let now = stand.clock.now();
    stand.target.with_station(|station| station.write(now, number(166), &Value::Number(300))).unwrap();
    let error = device_error(stand.commit(prepared.clone()));
    assert_eq!(error, Error::Changed { item: "166".to_owned() });
    let mut other = Stand::new("serial=43");
    let error = device_error(other.commit(prepared));
    assert_eq!(error, Error::Changed { item: "the device itself".to_owned() });
    assert!(stand.sets().is_empty() && other.sets().is_empty());
}

#[test]
fn range_error_names_host_and_device_limits() {
    let mut stand = Stand::new("position=65536");
    let refused = stand.prepare(Change::Write(image(&[(166, 400)]))).unwrap_err();
    assert_eq!(refused.to_string(), "parameter 166 (maximum speed) cannot be 400 (allowed: 5 to 350)");
    // The drive has turned since the plan was made, so the device rejects the request.
    let prepared = stand.prepare(Change::Write(image(&[(158, 60_000)]))).unwrap();
    let now = stand.clock.now();
    stand.target.with_station(|station| station.write(now, number(198), &Value::Number(640))).unwrap();
    let error = device_error(stand.commit(prepared));
    let Error::Refuses(out) = &error else { panic!("{error}") };
    // The limit is 512 turns of 65536 steps.
    assert_eq!(out.range, ParameterRange::Within(-33_554_432, 640), "no lower limit above the position");
    assert_eq!(error.to_string(), "parameter 158 (lower limit) cannot be 60000 (allowed: -33554432 to 640)");
}

#[test]
fn rejects_read_only_and_motion_parameters_before_sending() {
    let mut stand = Stand::new("");
    for (own, why) in [
        (107, "parameter 107 (actual position) is read-only"),
        (101, "parameter 101 (control word) moves the drive and cannot be written as a value"),
        (104, "parameter 104 (target position) moves the drive and cannot be written as a value"),
    ] {
        let error = stand.prepare(Change::Write(image(&[(own, 1)]))).unwrap_err();
        assert_eq!(error.to_string(), why);
    }
    assert!(stand.sets().is_empty());
}

#[test]
fn sets_nearest_possible_position() {
    let mut stand = Stand::new("position=655360");
    let done = stand.change(Change::SetPosition { drive: drive(1), position: 1000, save: true }).unwrap();
    // 64 · 16 = 1024 is closer than 64 · 15 = 960.
    assert_eq!((done.written.verified, stand.value(198), stand.value(107)), (1, 1024, 1024));
    assert_eq!(stand.sets(), [(198, vec![0, 4, 0, 0]), (47, vec![1, 0])]);
}

#[test]
fn services_wait_for_completion() {
    let mut stand = Stand::new("hub=8");
    let begun = stand.elapsed();
    stand.change(Change::Do(Service::Reset)).unwrap();
    let (took, set) = (stand.elapsed() - begun, stand.sets());
    assert_eq!(set, [(47, vec![0xFC, 0xFF])]);
    assert_eq!(stand.value(47), 0);
    assert!(took < std::time::Duration::from_secs(9), "{took:?}");
    let prepared = stand.prepare(Change::Do(Service::FactoryAll)).unwrap();
    assert_eq!((prepared.kind, prepared.plan.write_cycles()), (ChangeKind::Service(Service::FactoryAll), 1));
}

/// A device may take 2 s with an adapter and 8 s with a hub to answer when parameter 47 is set to −4 (manual 6.2). The
/// program waits that long, sends the request once, and does not use this time to estimate the speed of the network
/// (issue 21.8).
#[test]
fn presence_test_may_take_documented_time() {
    for (query, ms) in [("reset=2000", 2000), ("hub=4&reset=8000", 8000), ("hub=8&reset=8000", 8000)] {
        let mut stand = Stand::new(query);
        let begun = stand.elapsed();
        stand.change(Change::Do(Service::Reset)).unwrap_or_else(|why| panic!("{query}: {why}"));
        let took = (stand.elapsed() - begun).as_millis();
        assert!((ms..ms + 1000).contains(&took), "{query}: {took} ms");
        assert_eq!(stand.sets(), [(47, vec![0xFC, 0xFF])], "{query}");
        let longest = stand.session.station().replies().longest_reply_time();
        assert!(longest.as_millis() < 100, "{query}: {longest:?} of a usual reply");
    }
}

/// If the reply takes longer than the manual allows or the connection falls silent, the job ends within 10 s (CLI.md).
/// The request is sent once, and the report states that the result is unknown (issue 21.8).
#[test]
fn unanswered_presence_test_times_out() {
    // The number of frames that are sent before the request.
    let mut whole = Stand::new("hub=8");
    whole.change(Change::Do(Service::Reset)).unwrap();
    let is_set = |frame: &Vec<u8>| frame.ends_with(&[0x10, 3, 0x20, 0x64, 0x24, 1, 0x30, 47, 0xFC, 0xFF]);
    let before = whole.tap().sent.iter().position(is_set).unwrap();
    let silent = format!("hub=8&fault=silent-after:{before}");
    for (query, within) in [("reset=8000", 2000..3000), (silent.as_str(), 8000..9500)] {
        let mut stand = Stand::new(query);
        let prepared = stand.prepare(Change::Do(Service::Reset)).unwrap();
        let begun = stand.elapsed();
        let ended = stand.commit(prepared);
        let took = (stand.elapsed() - begun).as_millis();
        let Err(JobError::Interrupted { interrupted, .. }) = ended else { panic!("{query}: {ended:?}") };
        assert_eq!(
            interrupted.cause,
            Error::NoReply { requested: RequestedItem::Set(number(47)), tries: 1, late: None },
            "{query}"
        );
        assert_eq!((interrupted.uncertain_write().as_deref(), interrupted.done.ops), (Some("47"), 0), "{query}");
        assert!(within.contains(&took), "{query}: {took} ms");
        assert_eq!(stand.sets(), [(47, vec![0xFC, 0xFF])], "{query}");
    }
}

#[test]
fn acknowledges_fault_with_reset_if_needed() {
    for (codes, reset) in [
        (&[ErrorCode::RS485][..], false),
        (&[ErrorCode::OVER_CURRENT, ErrorCode::RS485], true),
        (&[ErrorCode::RS485, ErrorCode::FOLLOWING_ERROR], true),
    ] {
        let mut stand = Stand::new("hub=4&drives=0,1&requested=1");
        for code in codes {
            let now = stand.clock.now();
            stand.target.with_station(|station| station.drive(drive(2)).unwrap().inject_error(now, *code));
        }
        assert_eq!(stand.value(297), codes.len() as i64);
        let done = stand.change(Change::Do(Service::Acknowledge(drive(2)))).unwrap();
        let sets: Vec<u16> = stand.sets().into_iter().map(|(own, _)| own).collect();
        assert_eq!(sets, if reset { vec![47, 297] } else { vec![297] }, "{codes:?}");
        assert_eq!((stand.value(297), done.written.write_cycles), (0, 0), "{codes:?}");
    }
}

#[test]
fn acknowledges_nothing_without_fault() {
    for query in ["", "hub=4&drives=1,1&requested=1", "requested=0"] {
        let mut stand = Stand::new(query);
        let prepared = stand.prepare(Change::Do(Service::Acknowledge(drive(1)))).unwrap();
        assert!(prepared.plan.is_empty(), "{query}");
        let done = stand.commit(prepared).unwrap();
        assert!(done.backup.is_none() && stand.sets().is_empty(), "{query}");
    }
}

#[test]
fn knows_motion_limits_after_every_write() {
    let mut stand = Stand::new("requested=1");
    stand.survey();
    let motion = stand.session.motion();
    let permit = motion.motion_permit(drive(1));
    assert_eq!((permit.locks.as_slice(), permit.limits), (&[][..], Some((-33_488_896, 33_488_896))));
    stand.change(Change::Write(image(&[(186, 255)]))).unwrap();
    assert_eq!(motion.motion_permit(drive(1)).locks, [MotionLock::NoTimeout]);
    let before = motion.limits(drive(1)).displayed_limits().unwrap();
    stand.change(Change::Write(image(&[(186, 20), (154, 100)]))).unwrap();
    assert_eq!(motion.motion_permit(drive(1)).locks, [MotionLock::LimitsUnconfirmed]);
    stand.survey();
    assert_eq!(motion.motion_permit(drive(1)).locks, [MotionLock::LimitsUnconfirmed], "reading confirms nothing");
    assert!(!motion.confirm_limits(drive(1), before), "they were shown under the scale of before");
    assert_eq!(motion.motion_permit(drive(1)).locks, [MotionLock::LimitsUnconfirmed]);
    let shown = DisplayedLimits { scale: (100, 1), ..before };
    assert!(motion.confirm_limits(drive(1), shown));
    assert!(motion.motion_permit(drive(1)).locks.is_empty());
    stand.change(Change::Do(Service::Recall)).unwrap();
    assert!(motion.motion_permit(drive(1)).locks.is_empty(), "the scale is as it was saved");
    stand.change(Change::Do(Service::FactoryAll)).unwrap();
    assert_eq!(motion.motion_permit(drive(1)).locks, [MotionLock::LimitsUnconfirmed], "the scale is another one");
    stand.change(Change::Write(image(&[(152, 0)]))).unwrap();
    assert!(motion.motion_permit(drive(1)).locks.contains(&MotionLock::NotRequested));
}
