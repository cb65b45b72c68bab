//! Tests the EtherNet/IP host with an independently written HIPERDRIVE target, which logs all sets and saves and can
//! simulate faults.

use std::net::SocketAddrV4;
use std::sync::Arc;
use std::time::Duration;

use encoder_studio::buses::ethernet_ip::protocol::AddressSource;
use encoder_studio::devices::hiperdrive::jobs::{
    Change, Commit, Committed, Hiperdrive, HiperdriveJob, HiperdriveOutput, JobError, open,
};
use encoder_studio::devices::hiperdrive::procedures::cyclic::ParameterResult;
use encoder_studio::devices::hiperdrive::procedures::{
    DiscoveredDevice, Error, PolledSample, RequestedItem, Temperature, discover,
};
use encoder_studio::devices::hiperdrive::profile::{Image, NetworkSettings, Service};
use encoder_studio::devices::hiperdrive::protocol::{DriveNumber, ParameterNumber, Topology, Value, Variant};
use encoder_studio::link::{CancelToken, RealClock, UdpBroadcast};
use encoder_studio::profile::Consent;
use encoder_studio::store::Store;
use encoder_studio::worker::{Session, WatchReply};

use super::support::{Bench, Foreign, Ran};

fn session(bench: &Bench, foreign: &Foreign, query: &str) -> Session<Hiperdrive> {
    let url = format!("{}{query}", foreign.url).parse().unwrap();
    open(&url, Store::at_root(&bench.path("store"))).unwrap()
}

fn image(values: &[(u16, i64)]) -> Box<Image> {
    let own = |number| ParameterNumber::new(number).unwrap();
    Box::new(Image { values: values.iter().map(|(number, value)| (own(*number), *value)).collect() })
}

fn change(session: &mut Session<Hiperdrive>, change: Change) -> Result<Committed, JobError> {
    let prepared = match session.run_inline(HiperdriveJob::Prepare(change))? {
        HiperdriveOutput::Prepared(prepared) => *prepared,
        other => panic!("{other:?}"),
    };
    let consent = Consent::to(prepared.plan.id());
    match session.run_inline(HiperdriveJob::Commit(Box::new(Commit {
        prepared,
        consent,
        force_wear: false,
        undoes: None,
    })))? {
        HiperdriveOutput::Committed(done) => Ok(*done),
        other => panic!("{other:?}"),
    }
}

#[test]
fn reads_and_writes_all_target_variants() {
    let cases: [(&[&str], &str); 6] = [
        (&[], ""),
        (&["--counted", "--pieces"], ""),
        (&["--stale", "--forget=7"], ""),
        (&["--cut=40", "--busy=300"], "?timeout=60"),
        (&["--late=90:50"], "?timeout=60"),
        (&["--lose-set=1", "--refuse=166:0x14"], "?timeout=60"),
    ];
    let bench = Bench::new();
    for (options, query) in cases {
        let Some(foreign) = bench.target(&[&["--topology=hub4", "--drives=1,3"], options].concat()) else { return };
        let mut session = session(&bench, &foreign, query);
        let survey = match session.run_inline(HiperdriveJob::Survey).unwrap_or_else(|why| panic!("{options:?}: {why}"))
        {
            HiperdriveOutput::Surveyed(survey) => *survey,
            other => panic!("{other:?}"),
        };
        let identity = &survey.identity;
        assert_eq!(
            (identity.topology, identity.category.as_str()),
            (Topology::Hub4, "HIPERDRIVE HUB-4"),
            "{options:?}"
        );
        assert_eq!((identity.serial_number.as_str(), identity.version.as_str()), ("4321", "2.10"), "{options:?}");
        let drives: Vec<_> = identity.drives.iter().map(|own| (own.number.get(), own.variant, own.requested)).collect();
        assert_eq!(drives, [(1, Variant::new(7), true), (3, Variant::new(7), true)], "{options:?}");
        assert_eq!(identity.drives[1].serial_number, "90817", "{options:?}");
        let value = |number| survey.values.get(&ParameterNumber::new(number).unwrap());
        assert_eq!(value(119), Some(&Value::Number(33)), "{options:?}");
        assert_eq!(value(360), Some(&Value::Number(33_488_896)), "{options:?}");
        assert_eq!(value(166).is_none(), options.contains(&"--refuse=166:0x14"), "{options:?}");
        assert_eq!(survey.network.mac, Some([0x00, 0x50, 0xC2, 0x11, 0x22, 0x33]), "{options:?}");
        assert_eq!(survey.network.interface.as_ref().unwrap().address.octets(), [192, 168, 1, 7], "{options:?}");
        assert!(foreign.requests().is_empty(), "reading changes nothing: {options:?}");
        let wanted = image(&[(24, 77), (188, 5), (358, -65536)]);
        let done = change(&mut session, Change::Write(wanted)).unwrap_or_else(|why| panic!("{options:?}: {why}"));
        assert_eq!((done.written.verified, done.written.write_cycles), (3, 1), "{options:?}");
        let mut log = foreign.requests();
        // The plan defines the order of independent parameters.
        let saved = log.split_off(log.len().saturating_sub(2));
        log.sort();
        assert_eq!(log, ["SET 188 5", "SET 24 77", "SET 358 -65536"], "{options:?}");
        assert_eq!(saved, ["SET 47 1", "STORE"], "{options:?}");
    }
}

/// Runs typical user commands.
#[test]
fn commands_work_with_independent_target() {
    let bench = Bench::new();
    let Some(foreign) = bench.target(&["--topology=hub8", "--drives=1,2", "--counted", "--serial=815"]) else { return };
    let link = ["--link", foreign.url.as_str()];
    let ask = |words: &[&str]| bench.run(&[words, &link[..]].concat());
    let told = ask(&["identify", "hiperdrive", "--json"]).json();
    assert_eq!((told["category"].as_str(), told["serial_number"].as_str()), (Some("HIPERDRIVE HUB-8"), Some("815")));
    assert_eq!(told["drives"].as_array().map(Vec::len), Some(2), "{told}");
    let (before, after) = (bench.file("before.ron"), bench.file("after.ron"));
    assert_eq!(ask(&["save", "hiperdrive", "-o", &before]).status, Some(0));
    assert!(foreign.requests().is_empty(), "reading changes nothing");
    let written = ask(&["write", "hiperdrive", "166", "120", "--drive", "2", "--yes"]);
    assert_eq!((written.status, foreign.requests().join(", ")), (Some(0), "SET 266 120, SET 47 1, STORE".to_owned()));
    assert_eq!(ask(&["save", "hiperdrive", "-o", &after]).status, Some(0));
    let found = bench.run(&["diff", &before, &after, "--json"]).json_with_status(3);
    assert_eq!(found["differences"].as_array().map(Vec::len), Some(1), "{found}");
    let restored = ask(&["restore", &before, "--yes", "--json"]).json();
    assert_eq!((restored["written"].as_u64(), restored["write_cycles"].as_u64()), (Some(1), Some(1)), "{restored}");
    assert_eq!(foreign.requests(), ["SET 266 350", "SET 47 1", "STORE"]);
    assert_eq!(ask(&["verify", &before]).status, Some(0));
}

#[test]
fn rejects_other_device() {
    let bench = Bench::new();
    let Some(foreign) = bench.target(&["--product=Valve island"]) else { return };
    let mut session = session(&bench, &foreign, "");
    let error = session.run_inline(HiperdriveJob::Hello).unwrap_err();
    let JobError::Device(error) = error else { panic!("{error}") };
    assert_eq!(error, Error::NotHiperdrive { product: "Valve island".to_owned() });
}

#[test]
fn finds_devices_by_broadcast() {
    let bench = Bench::new();
    let Some(foreign) = bench.target(&["--serial=77"]) else { return };
    let Some(other) = bench.target(&["--product=Valve island"]) else { return };
    let address = |foreign: &Foreign| foreign.place.parse::<SocketAddrV4>().unwrap();
    let clock = Arc::new(RealClock::start());
    let mut shout = UdpBroadcast::new(vec![address(&foreign), address(&other)], clock.clone()).unwrap();
    let found = discover(&mut shout, &*clock, &CancelToken::default()).unwrap();
    let of = |foreign: &Foreign| -> &DiscoveredDevice {
        found.iter().find(|found| found.port == address(foreign).port()).unwrap()
    };
    assert_eq!(found.len(), 2, "{found:?}");
    assert!(of(&foreign).is_hiperdrive() && !of(&other).is_hiperdrive());
    assert_eq!(of(&foreign).identity.identity.serial_number, 0x1_0000 + 77);
    assert_eq!(of(&foreign).identity.identity.product_name, "HIPERDRIVE EtherNet/IP");
}

#[test]
fn writes_follow_plan() {
    let bench = Bench::new();
    let Some(foreign) = bench.target(&["--busy=200"]) else { return };
    let mut session = session(&bench, &foreign, "");
    let first = DriveNumber::FIRST;
    let done = change(&mut session, Change::SetPosition { drive: first, position: 1000, save: true }).unwrap();
    // 1024 is the nearest of the possible values 960 and 1024.
    assert_eq!((done.written.verified, foreign.requests().join(", ")), (1, "SET 198 1024, SET 47 1, STORE".to_owned()));
    change(&mut session, Change::Try(image(&[(170, 640), (166, 100)]))).unwrap();
    let log = foreign.requests();
    assert!(log.len() == 2 && !log.contains(&"STORE".to_owned()), "{log:?}");
    change(&mut session, Change::Do(Service::Reset)).unwrap();
    assert_eq!(foreign.requests(), ["SET 47 -4", "RESET"]);
    let mut interface = match session.run_inline(HiperdriveJob::Network).unwrap() {
        HiperdriveOutput::Network(network) => network.interface.unwrap(),
        other => panic!("{other:?}"),
    };
    interface.address = [192, 168, 1, 9].into();
    let settings = NetworkSettings { source: AddressSource::Stored, interface };
    let done = change(&mut session, Change::Network(settings.clone())).unwrap();
    assert_eq!(
        (done.written.write_cycles, foreign.requests()),
        (1, vec!["NETWORK 3".to_owned(), "NETWORK 5".to_owned()])
    );
    let done = change(&mut session, Change::Network(settings)).unwrap();
    assert!(done.backup.is_none() && foreign.requests().is_empty(), "what is so already is not set");
}

/// The program waits as long as the manual allows, after each value of parameter 47 and after parameter 152 changes
/// from 0 to 1. A hub may take 8000 ms, which is handled the same way (issue 21.8).
#[test]
fn slow_service_runs_once() {
    let bench = Bench::new();
    let slow = "--slow=47:-4:1700,47:-3:1400,47:-2:1400,47:-1:1400,47:1:190,152:1:1300";
    let Some(foreign) = bench.target(&["--topology=hub4", "--drives=1,3", slow]) else { return };
    let mut session = session(&bench, &foreign, "?timeout=60");
    change(&mut session, Change::Write(image(&[(152, 0)]))).unwrap();
    foreign.requests();
    let cases = [
        (Change::Write(image(&[(152, 1)])), "SET 152 1, SET 47 1, STORE"),
        (Change::Do(Service::Reset), "SET 47 -4, RESET"),
        (Change::Do(Service::FactoryAll), "SET 47 -3, STORE"),
        (Change::Do(Service::Recall), "SET 47 -2"),
        (Change::Do(Service::Factory), "SET 47 -1"),
        (Change::Do(Service::Save), "SET 47 1, STORE"),
    ];
    for (own, log) in cases {
        let said = format!("{own:?}");
        change(&mut session, own).unwrap_or_else(|why| panic!("{said}: {why}"));
        assert_eq!(foreign.requests().join(", "), log, "{said}");
    }
}

/// A number whose length differs from the manual is never printed, saved or written. The message states both lengths
/// and a remedy (issue 21.9).
#[test]
fn hides_number_of_wrong_length() {
    let bench = Bench::new();
    let (file, other) = (bench.file("file.ron"), bench.file("other.ron"));
    {
        let Some(foreign) = bench.target(&[]) else { return };
        let link = ["--link", foreign.url.as_str()];
        assert_eq!(bench.run(&[&["save", "hiperdrive", "-o", &file], &link[..]].concat()).status, Some(0));
    }
    let cases: [(&str, &[&str], &[&str]); 9] = [
        ("107:2", &["read", "hiperdrive", "107"], &["107", "received: 2", "expected: 4"]),
        ("107:2", &["position", "hiperdrive"], &["107", "received: 2", "expected: 4"]),
        ("186:1", &["read", "hiperdrive", "186"], &["186", "received: 1", "expected: 2"]),
        ("119:2", &["status", "hiperdrive"], &["119", "received: 2", "expected: 1"]),
        ("158:2", &["save", "hiperdrive", "-o", &other], &["158", "received: 2", "expected: 4"]),
        ("158:2", &["diff", &file], &["158", "received: 2", "expected: 4"]),
        ("160:1", &["restore", &file, "--yes"], &["160", "received: 1", "expected: 4"]),
        ("186:4", &["do", "hiperdrive", "check"], &["186", "received: 4", "expected: 2"]),
        ("24:2", &["write", "hiperdrive", "24", "7", "--yes"], &["24", "received: 2", "expected: 4"]),
    ];
    for (lengths, words, said) in cases {
        let foreign = bench.target(&[&format!("--lengths={lengths}")]).unwrap();
        let ran = bench.run(&[words, &["--link", foreign.url.as_str()]].concat());
        ran.fails(1, said);
        assert!(ran.out.is_empty() && ran.err.contains("parameter 19"), "{words:?}: {ran:?}");
        assert!(foreign.requests().is_empty(), "{words:?}");
    }
    assert!(!std::path::Path::new(&other).exists(), "a save that fails leaves no file");
    // A command that reads all parameters skips and reports these parameters.
    let foreign = bench.target(&["--lengths=24:2,158:1"]).unwrap();
    let survey = match session(&bench, &foreign, "").run_inline(HiperdriveJob::Survey).unwrap() {
        HiperdriveOutput::Surveyed(survey) => *survey,
        other => panic!("{other:?}"),
    };
    let wrong: Vec<_> = survey.wrong_lengths.iter().map(|own| (own.number.get(), own.expected, own.got)).collect();
    assert_eq!(wrong, [(24, 4, 2), (158, 4, 1)]);
    assert!(wrong.iter().all(|(own, ..)| !survey.values.contains_key(&ParameterNumber::new(*own).unwrap())));
}

/// A limit beyond the turns of the drive is not sent. The message states both limits in scaled steps (issue 21.10).
#[test]
fn does_not_send_limits_beyond_drive_turns() {
    let bench = Bench::new();
    let Some(foreign) = bench.target(&[]) else { return };
    let ask = |words: &[&str]| bench.run(&[words, &["--link", foreign.url.as_str()]].concat());
    let file = bench.file("before.ron");
    assert_eq!(ask(&["save", "hiperdrive", "-o", &file]).status, Some(0));
    ask(&["write", "hiperdrive", "158", "-33554433", "--yes"]).fails(1, &["-33554432 to 33554432"]);
    let text = std::fs::read_to_string(&file).unwrap().replace("33488896", "33554433");
    std::fs::write(&file, text).unwrap();
    ask(&["restore", &file, "--yes"]).fails(1, &["158", "-33554432 to 33554432"]);
    assert!(foreign.requests().is_empty());
    assert_eq!(ask(&["write", "hiperdrive", "160", "33554432", "--yes"]).status, Some(0));
    // A scale of 400/1 is 102400 steps per turn, or 52428800 steps for 512 turns.
    assert_eq!(ask(&["write", "hiperdrive", "154", "400", "--yes"]).status, Some(0));
    ask(&["write", "hiperdrive", "160", "52428801", "--yes"]).fails(1, &["160", "-52428800 to 52428800"]);
    assert_eq!(ask(&["write", "hiperdrive", "160", "52428800", "--yes"]).status, Some(0));
    let log = foreign.requests();
    let sets: Vec<&String> = log.iter().filter(|line| line.starts_with("SET 1")).collect();
    assert_eq!(sets, ["SET 160 33554432", "SET 154 400", "SET 160 52428800"], "{log:?}");
}

#[test]
fn silent_or_lost_target_times_out() {
    let bench = Bench::new();
    let cases: [(&[&str], &str); 3] =
        [(&["--silent-after=9"], "?timeout=60"), (&["--vanish-after=9"], ""), (&["--garbage"], "?timeout=60")];
    for (options, query) in cases {
        let Some(foreign) = bench.target(options) else { return };
        let mut session = session(&bench, &foreign, query);
        let begun = std::time::Instant::now();
        let error = session.run_inline(HiperdriveJob::Survey).unwrap_err();
        assert!(begun.elapsed() < Duration::from_secs(10), "{options:?}");
        let JobError::Device(error) = error else { panic!("{error}") };
        let is_expected = match error {
            Error::NoReply { requested: RequestedItem::Parameter(_), .. } => options.contains(&"--silent-after=9"),
            Error::Link(_) => options.contains(&"--vanish-after=9"),
            Error::Damaged { .. } | Error::NeverSilent => options.contains(&"--garbage"),
            _ => false,
        };
        assert!(is_expected, "{options:?}: {error}");
    }
}

/// Waits up to ten seconds for a condition.
fn comes(what: &str, mut has_come: impl FnMut() -> bool) {
    let begun = std::time::Instant::now();
    while !has_come() {
        assert!(begun.elapsed() < Duration::from_secs(10), "{what} does not come");
        std::thread::sleep(Duration::from_millis(5));
    }
}

#[test]
fn opens_and_closes_cyclic_connection() {
    let bench = Bench::new();
    let cases: [(&[&str], &str); 4] = [
        (&[], "OPEN 16"),
        (&["--no-words"], "OPEN 8"),
        (&["--multicast-only"], "OPEN 16"),
        (&["--topology=hub4", "--drives=2,3"], "OPEN 40"),
    ];
    for (options, opened) in cases {
        let Some(foreign) = bench.target(&[&["--position=4711"], options].concat()) else { return };
        let mut session = session(&bench, &foreign, "");
        let motion = session.motion();
        session.run_inline(HiperdriveJob::Take).unwrap_or_else(|why| panic!("{options:?}: {why}"));
        comes("what the drives say", || motion.snapshot().link.received > 3);
        let view = motion.snapshot();
        assert!(view.open && view.lost.is_none(), "{options:?}: {view:?}");
        assert!(view.drives.iter().all(|own| own.actual.position == 4711), "{options:?}: {view:?}");
        let drives: Vec<u8> = view.drives.iter().map(|own| own.number.get()).collect();
        assert_eq!(drives, if options.contains(&"--drives=2,3") { vec![2, 3] } else { vec![1] }, "{options:?}");
        session.run_inline(HiperdriveJob::Watch(view.drives[0].number)).unwrap();
        let sample = session.take_sample().unwrap();
        assert!(
            matches!(sample, PolledSample::Position(reading) if reading.actual.position == 4711),
            "{options:?}: {sample:?}"
        );
        assert!(matches!(session.run_inline(HiperdriveJob::Take), Err(JobError::Device(Error::InControl))));
        session.run_inline(HiperdriveJob::Give).unwrap();
        assert!(!motion.is_open(), "{options:?}");
        // No motion is requested, so the control word stays 0 and no change is logged.
        assert_eq!(foreign.requests(), [opened, "CLOSE"], "{options:?}");
    }
}

/// The target reports 29 °C in parameter 11 and 33 °C in parameter 119 (reference 6).
#[test]
fn reads_temperatures_through_parameter_words() {
    let bench = Bench::new();
    let (device, drive) = (ParameterNumber::new(11).unwrap(), ParameterNumber::new(119).unwrap());
    let cases: [(&[&str], Option<ParameterResult>); 5] = [
        (&["--words=0"], Some(ParameterResult::Number(29))),
        (&["--words=300"], Some(ParameterResult::Number(29))),
        (&["--words=0", "--topology=hub4"], Some(ParameterResult::Number(29))),
        (&[], Some(ParameterResult::NoReply)),
        (&["--no-words"], None),
    ];
    for (options, expected) in cases {
        let Some(foreign) = bench.target(options) else { return };
        let mut session = session(&bench, &foreign, "");
        let motion = session.motion();
        session.run_inline(HiperdriveJob::Take).unwrap();
        comes("what the drive says", || motion.snapshot().link.received > 3);
        let mut watch = |what, celsius| {
            let WatchReply::Sample(PolledSample::Temperature(reading)) = session.watch_value(&what).unwrap() else {
                panic!()
            };
            assert_eq!(reading.celsius, Some(celsius), "{options:?}");
        };
        let readings = || motion.snapshot().parameters;
        comes("both readings", || {
            watch(Temperature::Device, 29);
            watch(Temperature::Drive(DriveNumber::FIRST), 33);
            expected.is_none() || readings().is_some_and(|readings| readings.len() == 2)
        });
        let result = |number| readings().and_then(|own| own.get(&number).map(|reading| reading.result));
        assert_eq!(result(device), expected, "{options:?}");
        let of_drive = expected.map(|result| match result {
            ParameterResult::Number(_) => ParameterResult::Number(33),
            other => other,
        });
        assert_eq!(result(drive), of_drive, "{options:?}");
        watch(Temperature::Device, 29);
        session.run_inline(HiperdriveJob::Give).unwrap();
        let mut requests = foreign.requests();
        requests.retain(|line| line.starts_with("WORDS") && !["WORDS 1 11", "WORDS 1 119"].contains(&line.as_str()));
        assert!(requests.is_empty(), "only these are read, and nothing is written: {requests:?}");
    }
}

#[test]
fn reports_other_master_and_lost_target() {
    let bench = Bench::new();
    let Some(owned) = bench.target(&["--owned"]) else { return };
    let error = session(&bench, &owned, "").run_inline(HiperdriveJob::Take).unwrap_err();
    assert!(matches!(error, JobError::Device(Error::OtherMaster { extended: 0x0106 })), "{error}");
    let mut foreign = bench.target(&[]).unwrap();
    let mut first = session(&bench, &foreign, "");
    first.run_inline(HiperdriveJob::Take).unwrap();
    let error = session(&bench, &foreign, "").run_inline(HiperdriveJob::Take).unwrap_err();
    assert!(matches!(error, JobError::Device(Error::OtherMaster { extended: 0x0100 })), "{error}");
    let motion = first.motion();
    comes("what the drive says", || motion.snapshot().link.received > 3);
    foreign.kill();
    comes("the loss", || motion.snapshot().lost.is_some());
    assert!(first.take_sample().is_err() && !motion.is_open());
}

#[test]
fn dropped_session_stops_its_connection() {
    let bench = Bench::new();
    let Some(foreign) = bench.target(&[]) else { return };
    let mut session = session(&bench, &foreign, "");
    session.run_inline(HiperdriveJob::Take).unwrap();
    let motion = session.motion();
    comes("what the drive says", || motion.snapshot().link.received > 3);
    drop(session);
    comes("the end", || !motion.is_open());
    let mut log = foreign.requests();
    comes("the end at the target", || {
        log.extend(foreign.requests());
        log.last().is_some_and(|line| line == "LOST")
    });
}

/// An action without the intended effect is reported as a failure, such as a fault that remains after it was
/// acknowledged, or drives that the presence test does not find (issue 22.19).
#[test]
fn action_with_bad_result_fails() {
    let bench = Bench::new();
    let act = |target: &Foreign, action: &str| {
        bench.run(&["do", "hiperdrive", action, "--yes", "--link", &target.url, "--json"])
    };
    let fails = |ran: &Ran, words: &[&str]| {
        assert_eq!(ran.status, Some(1), "{ran:?}");
        ran.assert_stderr(words);
    };
    // Status word 2AB8h is a fault (reference 3). The drive is not under control, so the fault remains.
    let Some(faulty) = bench.target(&["--status=2AB8"]) else { return };
    fails(&act(&faulty, "acknowledge"), &["Drive 1 still has a fault"]);
    let Some(hub) = bench.target(&["--topology=hub4", "--drives=1,3", "--gone-after-reset=3"]) else { return };
    fails(&act(&hub, "presence-test"), &["no longer detects drive 3"]);
    let Some(alone) = bench.target(&["--gone-after-reset=1"]) else { return };
    fails(&act(&alone, "presence-test"), &["did not detect any drives"]);
    let Some(good) = bench.target(&["--topology=hub4", "--drives=1,3"]) else { return };
    let ran = bench.run(&["do", "hiperdrive", "presence-test", "--yes", "--link", &good.url]);
    assert!(ran.status == Some(0) && ran.out.contains("drive 1: ") && ran.out.contains("drive 3: "), "{ran:?}");
    act(&good, "acknowledge").json();
}
