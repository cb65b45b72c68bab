//! Everything there is to see of an encoder, in one job; and access codes that the user names later.

use encoder_studio::device::hiperface::{Sample, Survey};
use encoder_studio::protocol::hiperface::{AccessCode, CodeNumber, Command, StatusCode};
use encoder_studio::worker::hiperface::{HiperfaceJob, HiperfaceOutput};

use crate::support::Desk;

fn survey(desk: &mut Desk) -> Survey {
    match desk.run(HiperfaceJob::Survey).unwrap() {
        HiperfaceOutput::Surveyed(survey) => *survey,
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_survey_shows_what_is_there_and_reads_each_byte_once() {
    let mut desk = Desk::new("");
    let seen = survey(&mut desk);
    assert_eq!(seen.identity.serial.serial_number, "GB0450179");
    let memory: Vec<_> = seen.fields.iter().map(|field| (field.status.byte(), field.bytes.clone().unwrap())).collect();
    assert_eq!(memory, desk.memory());
    assert_eq!(seen.counter, Some(0));
    let Some(Sample::Position(reading)) = &seen.position else { panic!("{:?}", seen.position) };
    assert_eq!(reading.raw, 0x000E_0531);
    assert!(reading.position.is_some());
    assert_eq!(desk.tap().count(Command::ReadData), memory.len());
    assert_eq!(desk.wear(), 0);
    // The geometry stays known: a sample has it.
    let sample = desk.session.sample().unwrap();
    assert!(matches!(&sample, Sample::Position(reading) if reading.position.is_some()), "{sample:?}");
    assert!(desk.session.station().codes_met.is_empty());
}

#[test]
fn what_an_encoder_cannot_tell_at_the_moment_is_no_error() {
    let mut desk = Desk::new("rpm=9000");
    let seen = survey(&mut desk);
    assert!(matches!(&seen.position, Some(Sample::NoPosition { codes, .. }) if codes.contains(&StatusCode::TOO_FAST)));
    assert!(!seen.fields.is_empty());
}

#[test]
fn a_code_is_noted_without_a_byte_on_the_line_or_in_words() {
    let mut desk = Desk::new("codes=0:66");
    let number = CodeNumber::ZERO;
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
