//! Tests of the program start: the virtual encoder is connected and read, polling is off, and nothing is sent unasked.

use encoder_studio::app::DeviceCommand;
use std::time::Duration;

use encoder_studio::app::session::{Phase, Source};
use encoder_studio::app::{Action, JobState, Severity};
use encoder_studio::devices::hiperface::protocol::FreeMemory;
use encoder_studio::devices::hiperface::state::HiperfaceAction as Hiperface;
use encoder_studio::link::{Direction, LinkUrl};

use crate::support::{Desk, OTHER_PORT};

#[test]
fn starts_with_virtual_encoder_without_polling() {
    let desk = Desk::new_form("");
    let encoder = desk.encoder();
    assert_eq!(encoder.session.phase, Phase::Connected);
    assert_eq!(encoder.session.source, Source::Link(LinkUrl::simulated()));
    assert!(encoder.session.is_virtual());
    let identity = encoder.identity.as_ref().unwrap();
    assert_eq!(identity.name, "SKM36");
    assert_eq!(identity.serial.serial_number, "GB0450179");
    // The name plate takes two of 112 blocks.
    assert_eq!(identity.memory, Some(FreeMemory { blocks: 110, fields: 1 }));
    assert_eq!(encoder.field(0).unwrap().bytes.as_ref().unwrap()[..6], *b"EMD71K");
    assert_eq!(encoder.counter, Some(0));
    assert_eq!(encoder.session.live_session().unwrap().polling_interval(), None);
    assert!(!desk.studio.can_stop() && !desk.studio.is_live());
    assert!(desk.notice_ids(Severity::Warning).is_empty());
    assert_eq!(desk.studio.settings.links_of(crate::tabs::HIPERFACE), ["sim:"]);
}

#[test]
fn sends_nothing_without_request() {
    let mut desk = Desk::new_form("");
    let (sent, frames) = (desk.wire().sent(), desk.encoder().session.trace.lines().len());
    assert_eq!(
        desk.encoder().session.trace.lines().iter().filter(|line| line.direction == Direction::Sent).count(),
        sent
    );
    // The test waits longer than the interval between two checks of the connection.
    for _ in 0..60 {
        desk.studio.poll();
        std::thread::sleep(Duration::from_millis(10));
    }
    assert_eq!(desk.wire().sent(), sent);
    assert_eq!(desk.encoder().session.trace.lines().len(), frames);
}

#[test]
fn shows_meaning_of_every_frame() {
    let desk = Desk::new_form("");
    let lines = desk.encoder().session.trace.lines();
    assert!(lines.iter().all(|line| !line.bytes.is_empty() && !line.meaning.is_empty()), "{lines:?}");
}

#[test]
fn each_read_succeeds() {
    let mut desk = Desk::new_form("");
    let jobs = desk.studio.services.jobs().len();
    let id = desk.encoder().session.id;
    for action in [
        Action::device(id, Hiperface::ReadStatus),
        Action::Command(id, DeviceCommand::ReadPosition),
        Action::device(id, Hiperface::ReadCounter),
        Action::device(id, Hiperface::ReadAnalogue(0x48)),
        Action::device(id, Hiperface::Check { restart: true }),
        Action::Command(id, DeviceCommand::Read),
    ] {
        desk.act(action);
        assert!(desk.encoder().session.is_busy());
        desk.until_ready();
    }
    let ends: Vec<JobState> = desk.studio.services.jobs().skip(jobs).map(|job| job.end.clone()).collect();
    assert_eq!(ends, vec![JobState::Done; 6]);
    assert_eq!(desk.encoder().codes, Some(vec![]));
    assert!(matches!(desk.encoder().analogue[&0x48], Ok((42, _))), "{:?}", desk.encoder().analogue);
    assert!(!desk.encoder().check.as_ref().unwrap().is_empty());
}

#[test]
fn missing_value_triggers_no_warning() {
    let mut desk = Desk::new_form("");
    desk.ask(Hiperface::ReadAnalogue(0x07));
    desk.until_ready();
    assert!(desk.encoder().analogue[&0x07].is_err());
    assert!(desk.notice_ids(Severity::Warning).is_empty(), "it stands where it was asked for");
}

#[test]
fn restart_triggers_fresh_reading() {
    let mut desk = Desk::new_form("");
    let surveys = desk.wire().count(0x52);
    desk.ask(Hiperface::Reset);
    desk.until("the restart is told", |studio| {
        studio.services.log.notices().any(|notice| notice.texts[0].id() == "session.restarted")
    });
    desk.until_ready();
    assert!(desk.wire().count(0x52) > surveys);
}

#[test]
fn rejects_second_job() {
    let mut desk = Desk::new_form("");
    desk.wire().hold_at(0x50, 1);
    desk.ask(Hiperface::ReadStatus);
    desk.wire().wait_until_held();
    desk.ask(Hiperface::ReadCounter);
    assert_eq!(desk.notice_ids(Severity::Warning), ["session.busy"]);
    desk.wire().release();
    desk.until_ready();
}

#[test]
fn shows_one_encoder_at_a_time() {
    let mut desk = Desk::new_form("");
    let first = desk.encoder().session.id;
    desk.open(&format!("serial:{OTHER_PORT}"));
    desk.until_read();
    let second = desk.encoder().session.id;
    assert_eq!(desk.encoder().identity.as_ref().unwrap().name, "SKS36");
    assert_eq!(desk.studio.devices().len(), 2);
    desk.act(Action::Select(first));
    assert_eq!(desk.encoder().session.id, first);
    desk.act(Action::CloseSession(first));
    assert_eq!((desk.encoder().session.id, desk.studio.devices().len()), (second, 1));
    // Opening the same connection again selects the existing session.
    desk.open(&format!("serial:{OTHER_PORT}?address=0x40"));
    desk.until_read();
    assert_eq!((desk.encoder().session.id, desk.studio.devices().len()), (second, 1));
}
