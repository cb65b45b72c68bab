//! The jobs of a session with a BiSS encoder over both types of connection.

use std::fs;
use std::time::Duration;

use encoder_studio::devices::biss::jobs::{
    Biss, BissJob, BissOutput, DeviceMessage, JobError, JobStep, RegisterValues, device_key, open,
};
use encoder_studio::devices::biss::procedures::{
    self as device, EncoderStatus, Error, FrameSource, PolledSample, PositionReading, Survey,
};
use encoder_studio::devices::biss::profile::BissProfile;
use encoder_studio::devices::biss::protocol::{
    Descriptions, DeviceMode, ErrorRegister, Firmware, PositionFilter, WiegandResult,
};
use encoder_studio::link::{CancelToken, LinkUrl};
use encoder_studio::store::Store;
use encoder_studio::worker::{Event, JobId, OpenError, Session, WatchReply};

use super::support::{Bench, Pin, Transport, at};

fn survey(bench: &mut Bench) -> Survey {
    match bench.run(BissJob::Survey) {
        Ok(BissOutput::Surveyed(survey)) => *survey,
        other => panic!("{other:?}"),
    }
}

fn status(bench: &mut Bench) -> EncoderStatus {
    match bench.run(BissJob::Status) {
        Ok(BissOutput::Status(status)) => *status,
        other => panic!("{other:?}"),
    }
}

fn position(bench: &mut Bench) -> PositionReading {
    match bench.run(BissJob::Position) {
        Ok(BissOutput::Position(reading)) => reading,
        other => panic!("{other:?}"),
    }
}

fn save(bench: &mut Bench) -> Result<BissProfile, JobError> {
    match bench.run(BissJob::Save)? {
        BissOutput::Saved(profile) => Ok(*profile),
        other => panic!("{other:?}"),
    }
}

fn device_error(error: JobError) -> Error {
    match error {
        JobError::Device(error) => error,
        other => panic!("{other}"),
    }
}

const WAYS: [Transport; 2] = [Transport::ConfigPin, Transport::Adapter];

/// The expected values are from appendix 9.1 of the manual. The serial number is that of the virtual encoder.
#[test]
fn survey_is_complete_over_both_interfaces() {
    for way in WAYS {
        let mut bench = Bench::new(way, "serial=1234567&temperature=25&errors=0x12&filter=dynamic");
        let survey = survey(&mut bench);
        let identity = &survey.identity;
        assert_eq!(
            identity.kind.to_string(),
            "profile 0x6129, manufacturer 46 72, device ID 01 01 68 11 00 01",
            "{way:?}"
        );
        assert_eq!(
            (identity.serial_number.as_str(), &identity.serial_bytes),
            ("1234567", &vec![0x00, 0x12, 0xD6, 0x87])
        );
        assert_eq!(identity.firmware, Some(Firmware::new(1, 6, 0)));
        assert_eq!(identity.description.name(), "POSITAL IXARC kit encoder");
        assert_eq!((identity.mismatch.as_ref(), identity.source), (None, FrameSource::DataSheet));
        assert_eq!((identity.multiturn_bits(), identity.singleturn_bits()), (Some(16), Some(17)));
        let sheet = identity.data_sheet.as_ref().unwrap();
        assert_eq!((sheet.common.bank, sheet.common.bytes[0x3F]), (2, 0xF4));
        assert_eq!((sheet.encoder.bank, sheet.encoder.bytes[0x3F]), (3, 0x31));
        assert_eq!(
            identity.adapter.as_ref().map(|hello| hello.name.as_str()),
            (way == Transport::Adapter).then_some("virtual adapter")
        );
        let key = device_key(identity, true);
        assert_eq!((key.kind.as_str(), key.device_type.as_str()), ("biss", "4672-010168110001"));

        assert_eq!((survey.status.mode, survey.status.protection), (Some(DeviceMode::OPERATION), Some(0)));
        assert_eq!((survey.status.celsius, survey.status.filter), (Some(25.0), Some(PositionFilter::Dynamic)));
        let errors = survey.status.errors.unwrap();
        let names: Vec<_> = errors.set.iter().map(|(bit, name)| (*bit, name.as_ref().unwrap().english())).collect();
        let expected: Vec<_> = ErrorRegister::new(0x12).set_bits().collect();
        assert_eq!((errors.raw, names), (0x12, expected));
        assert_eq!(survey.status.warnings.map(|bits| bits.raw), Some(0));
        // The frame has an error bit, but the word over the configuration pin does not.
        assert_eq!(survey.status.position.unwrap().error, (way == Transport::Adapter).then_some(true));

        assert_eq!(survey.wiegand_last, Some(WiegandResult::parse([0; 4])));
        assert_eq!(survey.wiegand_production, Some(WiegandResult::parse([64, 60, 64, 59])));
        assert_eq!(survey.preset.map(|preset| preset.emit()), Some([0; 6]));
        assert_eq!(survey.registers.get(at("0x02:0x05")), Some(0x1C));
        assert_eq!(survey.missing, []);
        assert!(bench.now() < Duration::from_secs(2), "{way:?}: {:?}", bench.now());
    }
}

/// Errors and warnings exist since firmware 1.6.0, the filter since 1.1.0, the preset since 1.2.0 (manual).
#[test]
fn older_firmware_lacks_features() {
    let mut bench = Bench::new(Transport::Adapter, "firmware=1.0.9&errors=0x10");
    let survey = survey(&mut bench);
    assert_eq!((&survey.status.errors, &survey.status.warnings, survey.status.filter), (&None, &None, None));
    assert_eq!(survey.preset, None);
    assert_eq!(survey.status.celsius, Some(30.0));
    assert_eq!(survey.status.position.unwrap().error, Some(true), "the frame tells all the same");
    let later = status(&mut bench);
    assert_eq!(EncoderStatus { position: survey.status.position, ..later }, survey.status);
}

#[test]
fn status_and_position_identify_encoder() {
    for way in WAYS {
        let mut bench = Bench::new(way, "temperature=130&position=0x20001");
        let status = status(&mut bench);
        let warnings = status.warnings.unwrap().set;
        let names: Vec<_> = warnings.iter().map(|(bit, name)| (*bit, name.as_ref().unwrap().english())).collect();
        assert_eq!(names, [(0, "temperature too high")]);
        assert_eq!(status.celsius, Some(130.0));
        let sent = bench.tap().sent.len();
        let reading = position(&mut bench);
        assert_eq!((reading.turns, reading.steps), (1, 1));
        // Over the configuration pin, the registers of errors and warnings are read as well.
        let asked = if way == Transport::Adapter { 1 } else { 3 };
        assert_eq!(bench.tap().sent.len(), sent + asked, "{way:?}: known by now");
        assert_eq!((reading.error, reading.warning), (Some(false), Some(true)), "{way:?}");
        let mut fresh = Bench::new(way, "position=0x20001");
        assert_eq!(position(&mut fresh).turns, 1);
    }
}

#[test]
fn reads_registers_and_banks() {
    for way in WAYS {
        let mut bench = Bench::new(way, "temperature=25");
        let mut read = |job| match bench.run(job) {
            Ok(BissOutput::Registers(registers)) => registers,
            other => panic!("{other:?}"),
        };
        let temperature = RegisterValues { start: at("0x66"), bytes: vec![75], unsaved: None };
        assert_eq!(read(BissJob::Read("0x66".parse().unwrap())), temperature);
        assert_eq!(read(BissJob::Read("0x03:0x2C+2".parse().unwrap())).bytes, [0x2E, 0xE0]);
        let direct = read(BissJob::ReadDirect);
        assert_eq!((direct.start, direct.bytes.len(), &direct.bytes[0x3E..]), (at("0x40"), 64, &b"Fr"[..]));
        let bank = read(BissJob::ReadBank(0x02));
        assert_eq!((bank.start, bank.bytes[0x3F]), (at("0x02:0x00"), 0xF4));
    }
}

/// Data must not be accessed while the motor runs (manual 6.5).
#[test]
fn does_not_read_data_while_turning() {
    for way in WAYS {
        let mut bench = Bench::new(way, "rpm=60");
        for job in [BissJob::Save, BissJob::ReadBank(0x24), BissJob::Read("0x04:0x00".parse().unwrap())] {
            let error = device_error(bench.run(job).unwrap_err());
            let Error::Moving { rpm: Some(rpm) } = error else { panic!("{error}") };
            assert!((rpm - 60.0).abs() < 1.0, "{rpm}");
        }
        assert!(bench.run(BissJob::ReadBank(0x02)).is_ok(), "the data sheet is no area of data");
        bench.motor().set_rpm(0.0);
        assert!(bench.run(BissJob::ReadBank(0x24)).is_ok());
    }
}

#[test]
fn saves_all_restorable_values() {
    for way in WAYS {
        let mut bench = Bench::new(way, "serial=77&filter=dynamic");
        let profile = save(&mut bench).unwrap();
        assert_eq!((profile.identity.serial_number.as_str(), profile.filter), ("77", Some(PositionFilter::Dynamic)));
        assert_eq!((profile.identity.multiturn_bits, profile.identity.singleturn_bits), (Some(16), Some(17)));
        let areas: Vec<_> = profile.data.iter().map(|image| (image.name.as_str(), image.first, image.last)).collect();
        assert_eq!(areas, [("EDS motor data", 0x04, 0x23), ("OEM data", 0x24, 0x43)]);
        assert_eq!(profile.banks().count(), 64);
        for bank in profile.banks() {
            for (address, value) in bank.registers() {
                assert_eq!(Some(value), bench.encoder_reads(address), "{way:?} {address}");
            }
        }
        let sheets: Vec<u8> = profile.recorded.eds.iter().map(|sheet| sheet.bank.number).collect();
        assert_eq!(sheets, [2, 3]);
        assert_eq!(profile.recorded.wiegand_production, Some(WiegandResult::parse([64, 60, 64, 59])));
        assert_eq!(profile.mounting.len(), 2, "preset and calibration");
        assert_eq!(bench.flash_cycles(), 3, "as at the start");
    }
}

/// In mode 04, the data registers contain values that were written but not saved (reference 5.3). They are reported,
/// marked and not compared. Reading must not return the encoder to operation, which would discard them (issue 22.15).
#[test]
fn unsaved_registers_are_not_compared() {
    for way in WAYS {
        let mut bench = Bench::new(way, "");
        let held = bench.encoder_reads(at("0x24:0x10")).unwrap();
        let entered = held ^ 0xFF;
        let entries = [("0x6B", 0x2A), ("0x6A", 0x04), ("0x00:0x1A", 0x02), ("0x24:0x10", entered)];
        bench.encoder(|encoder, now| entries.map(|(place, value)| assert!(encoder.write(now, at(place), value))));
        let mode = DeviceMode::DATA_WRITE;
        for job in [BissJob::ReadBank(0x24), BissJob::Read("0x24:0x10".parse().unwrap())] {
            let Ok(BissOutput::Registers(read)) = bench.run(job) else { panic!() };
            assert_eq!(read.unsaved, Some(mode), "{way:?}");
        }
        let profile = save(&mut bench).unwrap();
        assert_eq!(profile.bank(0x24).unwrap().bytes[0x10], entered, "as it was read");
        assert_eq!(profile.recorded.device_mode, Some(mode), "{way:?}");
        assert_eq!(device_error(bench.run(BissJob::SaveToCompare).unwrap_err()), Error::NotInOperation { mode });
        assert_eq!(bench.encoder_reads(at("0x24:0x10")), Some(entered), "{way:?}: still entered");
        assert_eq!(bench.return_to_operation().unwrap(), mode);
        let Ok(BissOutput::Saved(profile)) = bench.run(BissJob::SaveToCompare) else { panic!() };
        assert_eq!((profile.bank(0x24).unwrap().bytes[0x10], profile.recorded.device_mode), (held, None), "{way:?}");
        let Ok(BissOutput::Registers(read)) = bench.run(BissJob::ReadBank(0x24)) else { panic!() };
        assert_eq!(read.unsaved, None);
    }
}

#[test]
fn save_reports_progress_and_can_be_cancelled() {
    let mut bench = Bench::new(Transport::ConfigPin, "");
    let mut told = Vec::new();
    let end = bench.session.run(JobId::default(), BissJob::Save, &mut |event| {
        if let Event::Progress(_, progress) = event {
            told.push((progress.done, progress.total, progress.step));
        }
    });
    assert!(matches!(end, Event::Finished(..)));
    assert!(told.is_sorted_by_key(|(done, ..)| *done), "{told:?}");
    assert!(told.iter().all(|(done, total, _)| done < total && *total == told[0].1));
    assert_eq!(told.last().unwrap().2, JobStep::Bank(0x43));
    assert_eq!(told.iter().filter(|(.., what)| matches!(what, JobStep::Bank(_))).count(), 64);
    let mut stopped = Bench::new(Transport::ConfigPin, "");
    stopped.session.set_cancel(CancelToken::after_transactions(1000));
    assert_eq!(device_error(save(&mut stopped).unwrap_err()), Error::Cancelled);
    assert_eq!(stopped.tap().sent.len(), 1000);
}

/// Whatever the fault of the line, a saved profile is correct or there is an error.
#[test]
fn save_over_noise_is_correct_or_fails() {
    let (mut saved, mut failed) = (0, 0);
    let truth = save(&mut Bench::new(Transport::ConfigPin, "")).unwrap();
    for noise in ["drop:0.002", "flip:0.002", "garbage:0.002", "flip:0.0003"] {
        for seed in 0..3 {
            let mut bench = Bench::new(Transport::ConfigPin, &format!("seed={seed}&fault={noise}"));
            match save(&mut bench) {
                Ok(profile) => {
                    saved += 1;
                    assert_eq!(profile, truth, "{noise}, seed {seed}");
                }
                Err(JobError::Device(Error::NoReply { .. } | Error::Damaged { .. })) => failed += 1,
                Err(other) => panic!("{noise}, seed {seed}: {other}"),
            }
        }
    }
    println!("{saved} saved, {failed} failed");
    assert!(saved > 9);
}

/// The device ID of another device by the same manufacturer is reported. The data common to all encoders are shown.
#[test]
fn reports_device_id_without_description() {
    let [(_, kit), (_, unknown)] = Descriptions::BUILT_IN;
    let other = kit.replace("device_id: (0x01, 0x01, 0x68, 0x11, 0x00, 0x01)", "device_id: (1, 1, 0x68, 0x11, 0, 2)");
    let (types, errors) = Descriptions::read([("other.ron", other.as_str()), ("unknown.ron", unknown)]);
    assert_eq!(errors, []);
    let mut pin = Pin::new("serial=1234567");
    let survey = device::read_all_registers(&mut pin.master(), &types, &mut |_, _, _| {}).unwrap();
    assert_eq!(
        survey.identity.mismatch.as_ref().unwrap().to_string(),
        "the encoder reports profile 0x6129, manufacturer 46 72, device ID 01 01 68 11 00 01, but the description \
         \"POSITAL IXARC kit encoder\" is for profile 0x6129, manufacturer 46 72, device ID 01 01 68 11 00 02"
    );
    assert_eq!(survey.identity.description.name(), "BiSS C encoder");
    assert_eq!((survey.status.mode, survey.status.celsius), (None, None));
    assert_eq!(survey.identity.serial_number, "1234567");
    assert_eq!(survey.identity.multiturn_bits(), Some(16), "the data sheet tells it");
    assert_eq!(
        device::save(&mut pin.master(), &types, device::UnsavedValues::Marked, &mut |_, _, _| {}).unwrap().data,
        []
    );
    let (none, _) = Descriptions::read([("other.ron", other.as_str())]);
    let error = device::identify(&mut pin.master(), &none).unwrap_err();
    assert!(matches!(error, Error::NoDescription(_)), "{error}");
}

#[test]
fn reads_samples_and_watched_registers_individually() {
    for way in WAYS {
        let mut bench = Bench::new(way, "temperature=25&rpm=60");
        let Ok(PolledSample::Position(first)) = bench.session.take_sample() else { panic!("no position") };
        let Ok(PolledSample::Position(second)) = bench.session.take_sample() else { panic!("no position") };
        assert!(first.at < second.at && first.position() < second.position(), "{way:?}");
        let watched = bench.session.watch_value(&"0x66".parse().unwrap()).unwrap();
        let WatchReply::Sample(PolledSample::Watched(reading)) = watched else { panic!("{watched:?}") };
        assert_eq!((reading.range.to_string().as_str(), reading.value), ("0x66", Ok(vec![75])));
        let refused = bench.session.watch_value(&"0x44:0x00".parse().unwrap()).unwrap();
        assert!(matches!(refused, WatchReply::Refused(PolledSample::Watched(_))), "{refused:?}");
        // Data must not be accessed while the shaft turns (manual 6.5).
        let sent = bench.tap().sent.len();
        let refused = bench.session.watch_value(&"0x24:0x10".parse().unwrap()).unwrap();
        let WatchReply::Refused(PolledSample::Watched(reading)) = refused else { panic!("{refused:?}") };
        assert_eq!(
            (reading.value, bench.tap().sent.len()),
            (Err(Error::NotWatched { address: at("0x24:0x10") }), sent)
        );
        assert!(matches!(bench.session.take_sample(), Ok(PolledSample::Position(_))));
    }
}

/// A word from the configuration pin has no error and warning bits, so each of their registers is read once per second
/// (UBICOM reference 4). A frame contains both bits. Every position includes them.
#[test]
fn polling_error_marks_positions() {
    for way in WAYS {
        let mut bench = Bench::new(way, "");
        let sample = |bench: &mut Bench| match bench.session.take_sample() {
            Ok(PolledSample::Position(reading)) => (reading.error, reading.warning),
            other => panic!("{other:?}"),
        };
        assert_eq!(sample(&mut bench), (Some(false), Some(false)), "{way:?}");
        let (mut sent, mut samples) = (bench.tap().sent.len(), 0);
        let until = bench.now() + Duration::from_secs(10);
        while bench.now() < until {
            assert_eq!(sample(&mut bench), (Some(false), Some(false)));
            samples += 1;
        }
        sent = bench.tap().sent.len() - sent;
        let expected = if way == Transport::Adapter { 0 } else { 20 };
        assert!((sent - samples).abs_diff(expected) <= 1, "{way:?}: {sent} requests, {samples} positions");
        bench.encoder(|encoder, _| encoder.set_errors(ErrorRegister::new(0x10)));
        let until = bench.now() + Duration::from_millis(1_100);
        let mut last = (None, None);
        while bench.now() < until {
            last = sample(&mut bench);
        }
        assert_eq!(last, (Some(true), Some(false)), "{way:?}");
        // A single request reports the change at once.
        bench.encoder(|encoder, _| encoder.set_errors(ErrorRegister::default()));
        let BissOutput::Position(reading) = bench.run(BissJob::Position).unwrap() else { panic!() };
        assert_eq!((reading.error, reading.warning), (Some(false), Some(false)), "{way:?}");
    }
}

/// Some frames are valid. Damaged frames are counted in the sample of the next valid one or form their own sample.
#[test]
fn polling_survives_corrupt_frames() {
    let mut bench = Bench::new(Transport::Adapter, "noise=0.6&seed=2");
    let (mut right, mut wrong) = (0, 0);
    for _ in 0..100 {
        match bench.session.take_sample() {
            Ok(PolledSample::Position(reading)) => {
                right += 1;
                wrong += reading.crc_errors;
            }
            Ok(PolledSample::Missed { crc_errors, .. }) => wrong += crc_errors,
            other => panic!("{other:?}"),
        }
    }
    assert!(right > 80 && wrong > 80, "{right}, {wrong}");
}

#[test]
fn link_opens_named_interface() {
    let root = tempfile::tempdir().unwrap();
    let open = |text: &str| open(&text.parse::<LinkUrl>().unwrap(), Store::at_root(root.path()));
    for (text, line) in
        [("sim:?rpm=5", "UBICOM at 115200 8N1"), ("sim:?bridge=on&noise=0&clock=2000000", "BiSS at 2000000 Hz")]
    {
        let session: Session<Biss> = open(text).unwrap();
        assert_eq!(session.station().to_string(), line);
        assert!(session.is_virtual());
    }
    assert_eq!(open("sim:?rpm=5").unwrap().motor().unwrap().rpm(), 5.0);
    let cases = [
        ("sim:?bridge=yes", "bridge=yes is not valid (allowed: on or off)"),
        (
            "serial:/dev/null?clock=1",
            "clock is not a parameter of serial: links; valid parameters are baud, parity, order, echo, timeout, margin, mt, st, crc",
        ),
        (
            "bridge:/dev/null?echo=on",
            "echo is not a parameter of bridge: links; valid parameters are margin, clock, voltage, leave-supply, mt, st, crc, pin",
        ),
        ("bridge:/dev/null?clock=1", "clock=1 is not valid (allowed: a frequency in hertz from 80000 to 10000000)"),
    ];
    for (text, sentence) in cases {
        match open(text) {
            Err(OpenError::Url(error)) => assert_eq!(error.to_string(), sentence),
            other => panic!("{text}: {:?}", other.err()),
        }
    }
    let error = open("sim:?line=low").err().map(|error| error.to_string()).unwrap_or_default();
    assert!(error.contains("line"), "the adapter's settings need the adapter: {error}");
}

#[test]
fn reports_broken_descriptions_once() {
    let root = tempfile::tempdir().unwrap();
    let store = Store::at_root(root.path());
    fs::create_dir_all(store.device_folder("biss")).unwrap();
    fs::write(store.device_folder("biss").join("mine.ron"), "(name: 7)").unwrap();
    let mut bench = Bench::bench_in_store(Transport::ConfigPin, "", store);
    for expected in [1, 0] {
        let mut remarks = Vec::new();
        bench.session.run(JobId::default(), BissJob::Identify, &mut |event| {
            if let Event::DeviceMessage(remark) = event {
                remarks.push(remark);
            }
        });
        assert_eq!(remarks.len(), expected);
        if let Some(DeviceMessage::Descriptions(errors)) = remarks.first() {
            assert!(errors[0].to_string().contains("mine.ron, line 1, column"), "{}", errors[0]);
        }
    }
}
