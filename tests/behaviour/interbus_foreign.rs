//! Tests the host's side of the handshake with an independently written gateway and K3 encoder, which can simulate
//! faults. The encoder logs what it stores.

use encoder_studio::devices::interbus::jobs::{
    Change, Commit, Interbus, InterbusJob, InterbusOutput, JobError, Prepared, open,
};
use encoder_studio::devices::interbus::procedures::Error;
use encoder_studio::devices::interbus::profile::{Image, Item, ItemValue};
use encoder_studio::devices::interbus::protocol::{Cam, CamNumber, ProgramNumber, StartupMode, Value};
use encoder_studio::profile::Consent;
use encoder_studio::store::Store;
use encoder_studio::worker::Session;

use super::support::{Bench, Foreign};

const ENCODER: [&str; 6] =
    ["--steps=3600", "--serial-number=4001", "--mode=4", "--shift=2", "--preset=7", "--programs"];
/// Cam programs 2 and 5 of the encoder, as JSON. Some tests run program 5.
const PROGRAMS: &str = r#"{"2": {"mask": 129, "cams": {"0": [10, 20], "7": [3000, 100]}}, "5": {"mask": 8}}"#;

fn session(bench: &Bench, foreign: &Foreign, query: &str) -> Session<Interbus> {
    let url = format!("{}{query}", foreign.url).parse().unwrap();
    open(&url, Store::at_root(&bench.path("store"))).unwrap()
}

fn prepare(session: &mut Session<Interbus>) -> Result<Prepared, JobError> {
    let program = ProgramNumber::new(2).unwrap();
    let profile = match session.run_inline(InterbusJob::Save { programs: false })? {
        InterbusOutput::Saved(profile) => profile,
        other => panic!("{other:?}"),
    };
    let mut wanted = Image::from_parameters(profile.image.parameters);
    wanted.parameters.zero_shift = 99;
    assert!(wanted.set_value(Item::CamMask(program), ItemValue::Mask(0x41)));
    match session.run_inline(InterbusJob::Prepare(Change::Write(Box::new(wanted))))? {
        InterbusOutput::Prepared(prepared) => Ok(*prepared),
        other => panic!("{other:?}"),
    }
}

fn commit(session: &mut Session<Interbus>, prepared: Prepared) -> Result<u64, JobError> {
    let consent = Consent::to(prepared.plan.id());
    let job = InterbusJob::Commit(Box::new(Commit { prepared, consent, force_wear: false, undoes: None }));
    match session.run_inline(job)? {
        InterbusOutput::Committed(done) => Ok(done.written.verified),
        other => panic!("{other:?}"),
    }
}

/// Returns the log of the encoder: the words received and the values stored.
fn log(foreign: &Foreign) -> Vec<String> {
    foreign.requests().into_iter().filter(|line| line != "R").collect()
}

#[test]
fn works_with_any_gateway() {
    let cases: [(&[&str], &str); 5] = [
        (&[], "?cycle=1"),
        (&["--busy=40", "--stale=3", "--early"], "?cycle=1"),
        (&["--straight", "--stale=2", "--pieces", "--foreign-reply"], "?cycle=1"),
        (&["--manufacturer", "--complement=bit", "--narrow", "--cut=70", "--late=90:90"], "?cycle=1&timeout=60"),
        (
            &["--order=low-first", "--unit=9", "--input=40", "--output=80", "--exception=6:60"],
            "?cycle=1&order=low-first&unit=9&input=40&output=80",
        ),
    ];
    let bench = Bench::new();
    for (options, query) in cases {
        let Some(foreign) = bench.gateway(&[&ENCODER[..], &[PROGRAMS], options].concat()) else { return };
        let mut session = session(&bench, &foreign, query);
        let prepared = prepare(&mut session).unwrap_or_else(|error| panic!("{options:?}: {error}"));
        assert_eq!((prepared.identity.serial_number.as_str(), prepared.plan.ops.len()), ("4001", 2), "{options:?}");
        let cams = StartupMode::Cams(ProgramNumber::new(2).unwrap());
        assert_eq!(prepared.identity.mode, cams, "{options:?}");
        assert!(!log(&foreign).iter().any(|line| line.starts_with("STORE")), "{options:?}");
        let verified = commit(&mut session, prepared).unwrap_or_else(|error| panic!("{options:?}: {error}"));
        assert_eq!(verified, 2, "{options:?}");
        let log = log(&foreign);
        let stores: Vec<&String> = log.iter().filter(|line| line.starts_with("STORE")).collect();
        assert_eq!(stores, ["STORE parameters", "STORE program 2"], "{options:?}");
        assert_eq!(
            log.iter().rfind(|line| line.starts_with('W')).map(String::as_str),
            Some("W 00000000"),
            "{options:?}"
        );
        let reading = session.take_sample().unwrap();
        assert!(reading.mode == Some(cams) && reading.cams().is_some(), "{options:?}: {reading:?}");
    }
}

#[test]
fn reports_faults_and_other_master() {
    type Told = fn(&Error) -> bool;
    let cases: [(&[&str], Told); 6] = [
        (&["--error=1:82000000"], |error| matches!(error, Error::Refused { .. })),
        (&["--deaf-from=1"], |error| matches!(error, Error::TimeOut { .. })),
        (&["--other-data"], |error| matches!(error, Error::TimeOut { input: 0xCA00_0062, .. })),
        (&["--no-position"], |error| matches!(error, Error::Refused { .. } | Error::ModeNotRestored { .. })),
        (&["--unstored"], |error| matches!(error, Error::NotAccepted { .. })),
        (&["--error=1:98000004"], |error| matches!(error, Error::Refused { .. })),
    ];
    let bench = Bench::new();
    for (options, told) in cases {
        let Some(foreign) = bench.gateway(&[&["--steps=3600"][..], options].concat()) else { return };
        let mut session = session(&bench, &foreign, "?cycle=1&handshake=500");
        match prepare(&mut session).and_then(|prepared| commit(&mut session, prepared)) {
            Err(JobError::Interrupted { interrupted, .. }) => assert!(told(&interrupted.cause), "{interrupted}"),
            // Reading a program also ends with a position.
            Err(JobError::Device(error)) => assert!(told(&error) && options == ["--no-position"], "{error}"),
            other => panic!("{options:?}: {other:?}"),
        }
    }
    let Some(foreign) = bench.gateway(&["--second-master=00000000:1"]) else { return };
    let error = session(&bench, &foreign, "?handshake=300").run_inline(InterbusJob::Identify).unwrap_err();
    let expected = "another master is writing to the encoder: OUT is 00000000, but 20210009 was written";
    assert_eq!(error.to_string(), expected);
}

/// Prepares a write of all eight cams in the first `programs` cam programs.
fn other_cams(bench: &Bench, foreign: &Foreign, programs: usize) -> (Session<Interbus>, Prepared) {
    let mut session = session(bench, foreign, "?cycle=1");
    let parameters = match session.run_inline(InterbusJob::Survey).unwrap() {
        InterbusOutput::Surveyed(survey) => survey.parameters,
        other => panic!("{other:?}"),
    };
    let mut wanted = Image::from_parameters(parameters);
    let wanted_ones = ProgramNumber::all().take(programs);
    for (program, cam) in wanted_ones.flat_map(|program| CamNumber::all().map(move |cam| (program, cam))) {
        let (start, stop) = (u32::from(program.get()) * 10 + u32::from(cam.get()), 2000 + u32::from(cam.get()));
        let edges = Cam { start: Value::new(start).unwrap(), stop: Value::new(stop).unwrap() };
        assert!(wanted.set_value(Item::Cam(program, cam), ItemValue::Cam(edges)));
    }
    for program in ProgramNumber::all().take(programs) {
        assert!(wanted.set_value(Item::CamMask(program), ItemValue::Mask(0xFF)));
    }
    match session.run_inline(InterbusJob::Prepare(Change::Write(Box::new(wanted)))).unwrap() {
        InterbusOutput::Prepared(prepared) => (session, *prepared),
        other => panic!("{other:?}"),
    }
}

/// While it is busy, the gateway may return any data, from the current or the previous word. A word that is replaced
/// during processing is not accepted (issue 22.1).
#[test]
fn writes_cam_0_through_busy_gateway() {
    let bench = Bench::new();
    let cases =
        [("--busy=12", "sent", 8), ("--busy=12", "old", 1), ("--busy=40", "sent", 1), ("--busy=130", "sent", 2)];
    for (busy, with, programs) in cases {
        let options = ["--steps=3600", busy, "--busy-with", with, "--takes-late"];
        let Some(foreign) = bench.gateway(&options) else { return };
        let (mut session, prepared) = other_cams(&bench, &foreign, programs);
        let done = commit(&mut session, prepared);
        let log = log(&foreign);
        let stores: Vec<&String> = log.iter().filter(|line| line.starts_with("STORE")).collect();
        assert_eq!(done.unwrap_or_else(|error| panic!("{options:?}: {error}")), programs as u64 * 9, "{options:?}");
        assert_eq!(stores.len(), programs, "{options:?}: {stores:?}");
    }
}

/// An echo that is 0.4 to 0.8 s late, or that was never requested, must not interrupt a write. C2000100h is the example
/// in the manual (5.3, issue 22.2).
#[test]
fn skips_stale_echoes() {
    let bench = Bench::new();
    for echo in ["400:C2000100", "800:CA000000", "600:E2000100"] {
        let Some(foreign) = bench.gateway(&["--steps=3600", "--old-echo", echo]) else { return };
        let mut session = session(&bench, &foreign, "?cycle=1");
        let prepared = prepare(&mut session).unwrap_or_else(|error| panic!("{echo}: {error}"));
        let verified = commit(&mut session, prepared).unwrap_or_else(|error| panic!("{echo}: {error}"));
        assert_eq!(verified, 2, "{echo}");
    }
}

/// The gateway delays each change of OUT. Writing a parameter takes four changes: set, store, read back and leave
/// (issue 22.2).
#[test]
fn parameter_write_takes_four_gateway_delays() {
    let bench = Bench::new();
    let Some(foreign) = bench.gateway(&["--steps=3600", "--lag=250"]) else { return };
    let mut session = session(&bench, &foreign, "");
    let item = Change::Item(Item::ZeroShift, ItemValue::Number(99));
    let prepared = match session.run_inline(InterbusJob::Prepare(item)).unwrap() {
        InterbusOutput::Prepared(prepared) => *prepared,
        other => panic!("{other:?}"),
    };
    assert_eq!(commit(&mut session, prepared).unwrap(), 1);
    let words = log(&foreign);
    let set = words.iter().position(|line| line == "W 0A000063").unwrap();
    // The host does not wait for a reply to 00000000 after 80000000.
    let own: Vec<&str> = words[set..].iter().map(String::as_str).filter(|line| line.starts_with('W')).collect();
    assert_eq!(own, ["W 0A000063", "W 80000000", "W 00000000", "W 20210005", "W 00000000"]);
    // The identity and the base values are read for the plan, and again before the plan is executed.
    let questions = words[..set].iter().filter(|line| line.starts_with("W 2021")).count();
    assert_eq!(questions, (1 + 6 + 2) + (1 + 1 + 5));
}
