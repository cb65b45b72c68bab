//! Reading all data of a device, without setting anything or opening a cyclic connection.

use encoder_studio::devices::hiperdrive::procedures::check::{CheckFinding, CheckStep, Verdict};
use encoder_studio::devices::hiperdrive::procedures::{Error, LateReplyError, PolledSample, Temperature};
use std::sync::{Arc, Mutex};

use encoder_studio::buses::ethernet_ip::protocol::{AddressSource, Service};
use encoder_studio::devices::hiperdrive::jobs::{HiperdriveJob, HiperdriveOutput, JobError, open};
use encoder_studio::devices::hiperdrive::protocol::{AddressSwitch, ErrorCode, State, Topology, Value, Variant};
use encoder_studio::link::{Clock, TraceEntry, write_entry, write_header};
use encoder_studio::store::Store;
use encoder_studio::worker::{Event, JobId, WatchReply};

use super::support::{Stand, drive, number};

#[test]
fn reading_writes_nothing() {
    let mut stand = Stand::new("hub=4&drives=1,0,1&requested=1&serial=99");
    let jobs = [
        HiperdriveJob::Hello,
        HiperdriveJob::Survey,
        HiperdriveJob::Identify,
        HiperdriveJob::Status,
        HiperdriveJob::Check,
        HiperdriveJob::Position(drive(3)),
        HiperdriveJob::Read(number(158)),
        HiperdriveJob::Network,
        HiperdriveJob::Save,
        HiperdriveJob::Watch(drive(3)),
    ];
    for job in jobs {
        stand.run(job).unwrap();
    }
    stand.session.take_sample().unwrap();
    let others: Vec<_> = stand.requests().into_iter().filter(|request| request.service != Service::GET).collect();
    assert!(others.is_empty(), "{others:?}");
    assert!(stand.requests().len() > 200);
    let now = stand.clock.now();
    assert!(!stand.target.with_station(|station| station.is_open(now)));
}

#[test]
fn surveys_hub_with_connected_drives() {
    let mut stand = Stand::new("hub=4&drives=1,0,1&variant=13&serial=99&switch=17&name=LINE 3");
    let survey = stand.survey();
    let identity = &survey.identity;
    assert_eq!((identity.topology, identity.category.as_str()), (Topology::Hub4, "HIPERDRIVE HUB-4"));
    assert_eq!((identity.serial_number.as_str(), identity.name.as_str()), ("99", "LINE 3"));
    let drives: Vec<_> = identity.drives.iter().map(|own| (own.number.get(), own.variant, own.requested)).collect();
    assert_eq!(
        drives,
        [(1, Variant::new(13), false), (3, Variant::new(13), false)],
        "152 of a hub is 0 from the factory"
    );
    let value = |own: u16| survey.values.get(&number(own));
    // The result has parameters of the device and of drives 1 and 3, but none of an empty slot.
    assert_eq!((value(166), value(366)), (Some(&Value::Number(350)), Some(&Value::Number(350))));
    // An HDA70 has a range of 16000 turns of 65536 steps in either direction.
    assert_eq!(value(360), Some(&Value::Number(1_048_576_000)));
    assert_eq!((value(258), value(199), value(299)), (None, None, None));
    assert_eq!(survey.network.address_switch(), AddressSwitch::parse(17));
    assert_eq!(survey.network.control.unwrap().source(), AddressSource::Dhcp);
}

#[test]
fn reads_plain_and_counted_strings() {
    for query in ["text=plain", "text=counted"] {
        let mut stand = Stand::new(query);
        let HiperdriveOutput::Value(own, value) = stand.run(HiperdriveJob::Read(number(13))).unwrap() else { panic!() };
        assert_eq!((own.get(), value), (13, Value::Text("HIPERDRIVE SINGLE".to_owned())), "{query}");
    }
}

#[test]
fn names_missing_ports_and_drives() {
    let mut stand = Stand::new("hub=4&drives=1,0,1");
    stand.run(HiperdriveJob::Hello).unwrap();
    let mut refused = |job| match stand.run(job) {
        Err(JobError::Device(error)) => error,
        other => panic!("{other:?}"),
    };
    assert_eq!(refused(HiperdriveJob::Read(number(258))), Error::NoDrive { drive: drive(2) });
    assert_eq!(refused(HiperdriveJob::Position(drive(2))), Error::NoDrive { drive: drive(2) });
    let no_place = Error::NoPlace { drive: drive(5), topology: Topology::Hub4 };
    assert_eq!(no_place.to_string(), "there is no drive 5: HIPERDRIVE HUB-4 has 4");
    assert_eq!(refused(HiperdriveJob::Read(number(558))), no_place);
}

#[test]
fn status_covers_all_drives() {
    let mut stand = Stand::new("hub=4&drives=1,1&requested=1&supply=23.4");
    let now = stand.clock.now();
    stand.target.with_station(|station| station.drive(drive(2)).unwrap().inject_error(now, ErrorCode::OVER_CURRENT));
    let HiperdriveOutput::Status(status) = stand.run(HiperdriveJob::Status).unwrap() else { panic!() };
    assert_eq!(status.supply_tenths, 234);
    let [first, second] = status.drives.as_slice() else { panic!("{status:?}") };
    assert_eq!((first.number, first.status.state(), first.buffer.len()), (drive(1), State::NotReady, 0));
    assert_eq!((second.number, second.buffer.as_slice()), (drive(2), &[ErrorCode::OVER_CURRENT][..]));
    assert!(first.requested && second.faults == 1);
}

/// The jobs also run on a recording, even if sessions and requests are numbered differently.
#[test]
fn replays_recorded_trace() {
    let mut stand = Stand::new("hub=4&drives=1,0,1&serial=4711");
    let entries = Arc::<Mutex<Vec<TraceEntry>>>::default();
    let told = entries.clone();
    stand.session.add_watcher(move |entry| told.lock().unwrap().push(entry.clone()));
    stand.run(HiperdriveJob::Identify).unwrap();
    let mut file = Vec::new();
    write_header(&mut file).unwrap();
    for entry in entries.lock().unwrap().iter() {
        write_entry(&mut file, entry).unwrap();
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("drives.trace");
    std::fs::write(&path, file).unwrap();
    let url = format!("replay:{}", path.display()).parse().unwrap();
    let mut session = open(&url, Store::at_root(folder.path())).unwrap();
    for _ in 0..2 {
        match session.run_inline(HiperdriveJob::Identify).unwrap() {
            HiperdriveOutput::Identity(identity) => {
                assert_eq!((identity.drives.len(), identity.serial_number.as_str()), (2, "4711"))
            }
            other => panic!("{other:?}"),
        }
    }
}

#[test]
fn reads_positions_of_watched_drive() {
    let mut stand = Stand::new("hub=4&drives=1,1&position=65536");
    let position = |stand: &mut Stand| match stand.session.take_sample().unwrap() {
        PolledSample::Position(reading) => reading,
        other => panic!("{other:?}"),
    };
    let reading = position(&mut stand);
    assert_eq!((reading.drive, reading.actual.position), (drive(1), 65536));
    stand.run(HiperdriveJob::Watch(drive(2))).unwrap();
    assert_eq!(position(&mut stand).drive, drive(2));
}

/// Parameters 11 and 119 (reference 4) take one request each. A missing drive has no temperature.
#[test]
fn watches_temperatures_by_single_requests() {
    let mut stand = Stand::new("hub=4&drives=1,1");
    stand.session.take_sample().unwrap();
    let before = stand.requests().len();
    for (what, celsius) in [(Temperature::Device, 31), (Temperature::Drive(drive(2)), 25)] {
        let WatchReply::Sample(PolledSample::Temperature(reading)) = stand.session.watch_value(&what).unwrap() else {
            panic!()
        };
        assert_eq!((reading.what, reading.celsius), (what, Some(celsius)));
    }
    assert_eq!(stand.requests().len() - before, 2);
    let empty = stand.session.watch_value(&Temperature::Drive(drive(4))).unwrap();
    assert!(
        matches!(empty, WatchReply::Refused(PolledSample::Temperature(reading)) if reading.celsius.is_none()),
        "an empty port is not asked again: {empty:?}"
    );
    assert!(stand.requests().iter().all(|request| request.service == Service::GET));
}

#[test]
fn check_has_line_per_fault() {
    let mut stand = Stand::new("hub=4&drives=1&requested=0&supply=18&switch=98&position=65536");
    stand.target.with_station(|station| {
        for (own, value) in [(186, 255), (158, 0)] {
            let now = encoder_studio::units::Moment::START;
            station.write(now, number(own), &Value::Number(value)).unwrap();
        }
    });
    let HiperdriveOutput::Check(lines) = stand.run(HiperdriveJob::Check).unwrap() else { panic!() };
    let of = |step: CheckStep| lines.iter().find(|line| line.step == step).unwrap();
    let verdicts = [
        (CheckStep::Messages, Verdict::Good),
        (CheckStep::Device, Verdict::Good),
        (CheckStep::Supply, Verdict::Attention),
        (CheckStep::Address, Verdict::Good),
        (CheckStep::Memory, Verdict::Good),
        (CheckStep::Request(drive(1)), Verdict::Attention),
        (CheckStep::Line(drive(1)), Verdict::Good),
        (CheckStep::Timeout(drive(1)), Verdict::Bad),
        (CheckStep::Errors(drive(1)), Verdict::Good),
        (CheckStep::Range(drive(1)), Verdict::Good),
    ];
    for (step, verdict) in verdicts {
        assert_eq!(of(step).verdict, verdict, "{step}: {:?}", of(step).findings);
    }
    assert_eq!(of(CheckStep::Timeout(drive(1))).findings, [CheckFinding::NoTimeout]);
    assert_eq!(of(CheckStep::Address).findings, [CheckFinding::Switch(AddressSwitch::Bootp)]);
    assert!(of(CheckStep::Range(drive(1))).findings.contains(&CheckFinding::Within(65536)));
}

/// With slow replies, reading the parameters one by one takes seconds, so each request counts as progress. Empty slots
/// count as done.
#[test]
fn reports_progress_per_request() {
    let mut stand = Stand::new("hub=4&drives=1,0,1");
    for (job, total, asked) in [(HiperdriveJob::Identify, 29, 1 + 29 - 2 * 5), (HiperdriveJob::Status, 66, 66 - 2 * 15)]
    {
        let (name, before) = (format!("{job:?}"), stand.requests().len());
        let mut told = Vec::new();
        let ended = stand.session.run(JobId::default(), job, &mut |event| {
            if let Event::Progress(_, progress) = event {
                told.push((progress.done, progress.total));
            }
        });
        assert!(matches!(ended, Event::Finished(..)), "{name}: {ended:?}");
        assert_eq!(stand.requests().len() - before, asked, "{name}");
        assert!(told.len() >= asked - 1 && told.is_sorted(), "{name}: {told:?}");
        assert_eq!((told[0], told.last()), ((0, total), Some(&(total - 1, total))), "{name}");
    }
}

#[test]
fn distinguishes_late_and_missing_replies() {
    let mut slow = Stand::new("fault=delay:300");
    let replies = slow.session.station().replies();
    slow.run(HiperdriveJob::Read(number(158))).unwrap();
    let usual = replies.average().unwrap();
    assert!((300..400).contains(&usual.as_millis()) && replies.longest_reply_time() >= usual, "{usual:?}");
    let mut late = Stand::new("fault=delay:1300");
    let error = late.run(HiperdriveJob::Read(number(158))).unwrap_err();
    let Some(Error::NoReply { late: Some(LateReplyError { took, waited }), .. }) = error.device() else {
        panic!("{error}")
    };
    assert!((1300..1400).contains(&took.as_millis()) && took > waited, "{took:?} of {waited:?}");
    let mut silent = Stand::new("fault=silent-after:0");
    let error = silent.run(HiperdriveJob::Read(number(158))).unwrap_err();
    assert!(matches!(error.device(), Some(Error::NoReply { late: None, .. })), "{error}");
}
