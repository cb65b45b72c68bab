//! The job that reads all data of an encoder, and access codes that the user enters later.

use encoder_studio::analysis::check::Verdict;
use encoder_studio::devices::hiperface::jobs::{Change, HiperfaceJob, HiperfaceOutput};
use encoder_studio::devices::hiperface::procedures::check::{CheckFinding, CheckStep, HiperfaceStepResult};
use encoder_studio::devices::hiperface::procedures::{Error, PolledSample, Survey};
use encoder_studio::devices::hiperface::protocol::{
    AccessCode, AccessCodeNumber, Command, DataFieldStatus, StatusCode,
};
use encoder_studio::store::{DeviceKey, Logbook, Store};

use crate::support::Desk;

fn survey(desk: &mut Desk) -> Survey {
    match desk.run(HiperfaceJob::Survey).unwrap() {
        HiperfaceOutput::Surveyed(survey) => *survey,
        other => panic!("{other:?}"),
    }
}

#[test]
fn survey_reads_each_byte_once() {
    let mut desk = Desk::new("");
    let seen = survey(&mut desk);
    assert_eq!(seen.identity.serial.serial_number, "GB0450179");
    let memory: Vec<_> = seen.fields.iter().map(|field| (field.status.byte(), field.bytes.clone().unwrap())).collect();
    assert_eq!(memory, desk.memory());
    assert_eq!(seen.counter, Some(0));
    let Some(PolledSample::Position(reading)) = &seen.position else { panic!("{:?}", seen.position) };
    assert_eq!(reading.raw, 0x000E_0531);
    assert!(reading.position.is_some());
    assert_eq!(desk.tap().count(Command::ReadData), memory.len());
    assert_eq!(desk.wear(), 0);
    // The geometry is still known, so a sample has it.
    let sample = desk.session.take_sample().unwrap();
    assert!(matches!(&sample, PolledSample::Position(reading) if reading.position.is_some()), "{sample:?}");
    assert!(desk.session.station().codes_to_display.is_empty());
}

#[test]
fn temporarily_unavailable_value_is_no_error() {
    let mut desk = Desk::new("rpm=9000");
    let seen = survey(&mut desk);
    assert!(
        matches!(&seen.position, Some(PolledSample::NoPosition { codes, .. }) if codes.contains(&StatusCode::TOO_FAST))
    );
    assert!(!seen.fields.is_empty());
}

#[test]
fn noted_access_code_stays_secret() {
    let mut desk = Desk::new("codes=0:66");
    let number = AccessCodeNumber::ZERO;
    let locked = survey(&mut desk);
    let closed = locked.fields.iter().filter(|field| field.status.code() == number && field.bytes.is_none()).count();
    assert!(closed > 0, "{:?}", locked.fields);
    let sent = desk.tap().sent.len();
    let job = HiperfaceJob::UseCode { number, code: AccessCode::new(0x66) };
    crate::support::check_words(&format!("{job:?}"));
    assert!(matches!(desk.run(job), Ok(HiperfaceOutput::CodeNoted)));
    assert_eq!(desk.tap().sent.len(), sent, "nothing is sent");
    let open = survey(&mut desk);
    assert!(open.fields.iter().all(|field| field.bytes.is_some()), "{:?}", open.fields);
}

/// Returns an encoder with two data fields, one of which is the name plate.
fn two_fields() -> Desk {
    let mut desk = Desk::new("");
    desk.change(Change::CreateField { number: 1, status: DataFieldStatus::from_byte(0xC8) }).unwrap();
    desk
}

fn check(desk: &mut Desk) -> Vec<HiperfaceStepResult> {
    match desk.run(HiperfaceJob::Check { restart: false }).unwrap() {
        HiperfaceOutput::Check(lines) => lines,
        other => panic!("{other:?}"),
    }
}

/// The other fields are still read, and line errors are counted (issue 22.11).
#[test]
fn unreadable_field_leaves_others_usable() {
    // The reply to 4Ah on data field 0 is damaged or missing each time. In the third case it is the reply to 4Ch, so
    // that not even the field's status is known.
    let troubles: [(&str, bool, &[u8]); 3] =
        [("damaged", true, &[0x40, 0x4A, 0]), ("silent", false, &[0x40, 0x4A, 0]), ("status", false, &[0x40, 0x4C, 0])];
    for (label, is_broken, request) in troubles {
        let mut desk = two_fields();
        let before = desk.session.station().line.quality.clone();
        assert!(!before.has_errors() && before.requests > 0 && before.requests == before.replies, "{before:?}");
        let place = Some(request.to_vec());
        if is_broken {
            desk.tap().broken_to = place
        } else {
            desk.tap().mute_to = place
        }
        let seen = survey(&mut desk);
        let [unreadable] = &seen.unreadable[..] else { panic!("{label}: {:?}", seen.unreadable) };
        assert_eq!(unreadable.number, 0, "{label}");
        assert_eq!(matches!(unreadable.why, Error::Damaged { .. }), is_broken, "{label}");
        assert_eq!(seen.fields.last().unwrap().bytes, Some(vec![0xFF; 16]), "{label}: the other field is read");
        assert_eq!(seen.identity.serial.serial_number, "GB0450179");
        assert!(seen.position.is_some() && seen.counter == Some(0), "{label}");
        let quality = &seen.line;
        assert!(quality.has_errors() && quality.retries > 0, "{label}: {quality:?}");
        assert_eq!((quality.damaged > 0, quality.unanswered > 0), (is_broken, !is_broken), "{label}: {quality:?}");
        // The device check completes, and names the field and the quality of the line.
        let lines = check(&mut desk);
        let of = |step| lines.iter().find(|line| line.step == step).unwrap();
        assert_eq!(of(CheckStep::DataFields).verdict, Verdict::Bad, "{label}");
        let names = |own: &CheckFinding| matches!(own, CheckFinding::FieldUnreadable { number: 0, .. });
        assert!(of(CheckStep::DataFields).findings.iter().any(names), "{label}");
        assert_eq!(of(CheckStep::Line).verdict, Verdict::Attention, "{label}");
        // A save writes either a complete file or none.
        assert!(desk.save().is_err(), "{label}");
    }
}

/// An encoder that no longer answers must not be reported as a field that cannot be read.
#[test]
fn silent_encoder_ends_survey() {
    let mut desk = two_fields();
    let sent = desk.tap().sent.len();
    survey(&mut desk);
    let read_data = desk.tap().sent.iter().skip(sent).position(|frame| frame[1] == 0x4A).unwrap();
    let sent = desk.tap().sent.len();
    desk.tap().mute_from = Some(sent + read_data);
    assert!(desk.run(HiperfaceJob::Survey).is_err());
}

/// Returns the status codes that the logbook contains for the virtual encoder, latest reading first.
fn noted(desk: &Desk) -> Vec<String> {
    let path = Store::at_root(desk.folder.path()).logbook_path();
    let key = DeviceKey {
        kind: "hiperface".to_owned(),
        device_type: "37h".to_owned(),
        serial_number: "GB0450179".to_owned(),
        is_virtual: true,
    };
    match path.exists() {
        true => Logbook::open(&path)
            .unwrap()
            .status_entries(&key, 9)
            .unwrap()
            .into_iter()
            .map(|own| own.description)
            .collect(),
        false => Vec::new(),
    }
}

/// Request 50h removes a code from the encoder. The logbook must therefore contain it before it is shown, whichever
/// command reads it, and even if that job fails (issue 22.10).
#[test]
fn logs_read_status_codes() {
    let mut desk = Desk::new("");
    let report = |desk: &Desk, codes: &[StatusCode]| {
        codes.iter().for_each(|code| desk.bus().encoder_mut(0).unwrap().queue_code(*code))
    };
    report(&desk, &[StatusCode::TEMPERATURE, StatusCode::COUNTER_OVERFLOW]);
    assert!(matches!(desk.run(HiperfaceJob::Status), Ok(HiperfaceOutput::Status(codes)) if codes.len() == 2));
    let both = "1Eh critical encoder temperature, 08h counter overflow";
    assert_eq!(noted(&desk), [both], "who it is was asked for it");
    desk.run(HiperfaceJob::Status).unwrap();
    assert_eq!(noted(&desk).len(), 1, "nothing was read");
    // A survey that fails after it has read the queue.
    report(&desk, &[StatusCode::new(0x20)]);
    let sent = desk.tap().sent.len();
    desk.tap().mute_from = Some(sent + 1);
    assert!(desk.run(HiperfaceJob::Survey).is_err());
    assert_eq!(noted(&desk)[0], "20h singleturn position unreliable");
    assert_eq!(desk.session.station().codes_to_display, [StatusCode::new(0x20)], "it is told as well");
    // The sample reports the code. A code that remains is recorded once per minute, not with each sample.
    desk.tap().mute_from = None;
    for _ in 0..5 {
        report(&desk, &[StatusCode::TEMPERATURE]);
        desk.session.take_sample().unwrap();
    }
    assert_eq!(noted(&desk)[..2], ["1Eh critical encoder temperature", "20h singleturn position unreliable"]);
}
