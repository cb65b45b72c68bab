//! Tests of a stopped write, a lost cable and a replaced encoder: edits never go to another encoder.

use crate::tabs::Tabs as _;
use encoder_studio::app::DeviceCommand;
use std::fs;
use std::time::Duration;

use encoder_studio::app::review::Stage;
use encoder_studio::app::session::Phase;
use encoder_studio::app::{Action, JobState, Language, PendingEdits, RecorderOwner as Of, Severity, Studio, recorder};
use encoder_studio::devices::hiperface::jobs::Change;
use encoder_studio::devices::hiperface::protocol::AccessCodeNumber;
use encoder_studio::devices::hiperface::state::{HiperfaceAction as Hiperface, ReviewState};
use encoder_studio::store::read_text;
use encoder_studio::units::{Baud, CharacterFormat, Parity};

use crate::support::{Desk, PORT, is_review};

fn failed(studio: &Studio) -> bool {
    is_review(studio, |state| matches!(state, ReviewState::Failed { .. }))
}

pub(crate) fn lost(studio: &Studio) -> bool {
    studio.hiperface().is_some_and(|encoder| matches!(encoder.session.phase, Phase::Lost(_)))
}

/// Opens a profile that differs from the virtual encoder in four single bytes, and plans to write it.
fn plan_profile_write(desk: &mut Desk) {
    let encoder = desk.encoder().session.id;
    let path = desk.outside.path("mine.ron");
    desk.ask(Hiperface::Save(path.clone()));
    desk.until("it is saved", |_| path.exists());
    desk.until_ready();
    // EMD71K-4 3000rpm → eMd71K-4 3000RpM: bytes 0, 2, 13 and 15.
    let text = read_text(&path).unwrap();
    let old = "45 4D 44 37 31 4B 2D 34 20 33 30 30 30 72 70 6D";
    assert!(text.contains(old), "{text}");
    fs::write(&path, text.replace(old, "65 4D 64 37 31 4B 2D 34 20 33 30 30 30 52 70 4D")).unwrap();
    desk.act(Action::Open(path));
    desk.until("the profile is open", |studio| studio.hiperface().unwrap().session.phase == Phase::Offline);
    desk.command(DeviceCommand::WriteInto(encoder));
    desk.until_planned();
}

#[test]
fn can_complete_stopped_restore() {
    let mut desk = Desk::new_form("");
    plan_profile_write(&mut desk);
    let ReviewState::Ready(prepared) = &desk.review().state else { panic!() };
    assert_eq!(prepared.plan.ops.len(), 4);
    desk.wire().hold_at(0x4B, 2);
    desk.write_as_shown();
    desk.wire().wait_until_held();
    desk.until("it is writing", |studio| studio.hiperface().unwrap().session.is_writing());
    assert!(desk.studio.can_stop());
    desk.act(Action::Stop);
    assert!(desk.encoder().session.live_session().unwrap().running_job().unwrap().stopping);
    desk.wire().release();
    desk.until("it has ended", failed);
    let ReviewState::Failed { texts, begun: true, .. } = &desk.review().state else { panic!() };
    // The running exchange is completed, and no further one is started.
    assert_eq!(texts[0], crate::texts::text("write.cancelled").with("done", 2).with("planned", 4));
    assert_eq!(texts[1].id(), "write.backup");
    // The list of operations remains, with the completed ones (issue 22.14).
    let sheet = desk.studio.selected_device().unwrap().review_sheet().unwrap();
    assert!(matches!(sheet.stage, Stage::Failed { begun: true, done: 2, .. }), "{:?}", sheet.stage);
    assert_eq!(sheet.lines.len(), 4);
    let backups = fs::read_dir(desk.outside.path("data/backups/hiperface/GB0450179")).unwrap();
    let backup = backups.map(|entry| entry.unwrap().path()).next().unwrap();
    assert!(texts[1].to_string_in(Language::German).contains(&backup.display().to_string()));
    desk.until_ready();
    assert_eq!(desk.wire().field(0)[..16], *b"eMd71K-4 3000rpm");
    assert_eq!(desk.encoder().staged.device_byte(0, 2), Some(b'd'), "it is read again");
    assert!(!desk.encoder().staged.is_dirty(), "the profile's bytes are no edits of the encoder");
    let end = desk.studio.services.jobs().map(|job| job.end.clone()).find(|end| *end == JobState::Cancelled);
    assert!(end.is_some());

    desk.ask(Hiperface::CloseReview);
    let profile = desk.studio.devices().iter().find(|own| *own.phase() == Phase::Offline).unwrap().id();
    let encoder = desk.encoder().session.id;
    desk.act(Action::Select(profile));
    desk.command(DeviceCommand::WriteInto(encoder));
    desk.until_planned();
    let ReviewState::Ready(prepared) = &desk.review().state else { panic!() };
    assert_eq!(prepared.plan.ops.len(), 2, "what is left");
    desk.write_as_shown();
    desk.until_written();
    assert_eq!(desk.wire().field(0)[..16], *b"eMd71K-4 3000RpM");
}

#[test]
fn cable_pulled_during_write_keeps_edits() {
    let mut desk = Desk::connected_at_port("");
    for (address, byte) in [(0, b'a'), (2, b'b'), (4, b'c')] {
        desk.put(0, address, &[byte]);
    }
    desk.command(DeviceCommand::Review);
    desk.until_planned();
    desk.wire().hold_at(0x4B, 2);
    desk.write_as_shown();
    desk.wire().wait_until_held();
    desk.wire().unplug();
    desk.wire().release();
    desk.until("it has ended", failed);
    let ReviewState::Failed { texts, begun: true, .. } = &desk.review().state else { panic!() };
    let words = texts[0].to_string_in(Language::English);
    assert!(texts[0].id() == "write.interrupted" && words.contains('1') && words.contains('3'), "{words}");
    assert!(lost(&desk.studio));
    desk.ask(Hiperface::CloseReview);
    desk.wire().plug();
    desk.command(DeviceCommand::Reconnect);
    desk.until_read();
    assert_eq!(desk.edits(), [(0, 2, b'b'), (0, 4, b'c')], "the first is in the encoder");
    desk.write();
    assert_eq!(desk.wire().field(0)[..5], *b"aMb7c");
}

#[test]
fn reports_cable_pulled_while_reading_once() {
    let mut desk = Desk::connected_at_port("");
    desk.wire().hold_at(0x46, 1);
    desk.ask(Hiperface::ReadCounter);
    desk.wire().wait_until_held();
    desk.wire().unplug();
    desk.wire().release();
    desk.until("it is lost", lost);
    desk.settle();
    assert_eq!(desk.notice_ids(Severity::Error), ["link.lost"]);
    let last = desk.studio.services.jobs().next_back().unwrap();
    assert!(matches!(&last.end, JobState::Failed(why) if why.id() == "link.lost") && last.until.is_some());
    let frames = desk.encoder().session.trace.lines();
    assert_eq!(frames.back().unwrap().bytes, "40 46 06", "what passed at last is shown");
}

/// Another encoder on the same cable does not receive the edits. They return with the encoder for which they were made.
#[test]
fn edits_return_with_their_encoder() {
    let mut desk = Desk::connected_at_port("");
    desk.put(0, 0, b"X");
    desk.until_kept();
    desk.wire().unplug();
    desk.until("it is lost", lost);
    desk.wire().exchange("serial=OTHER0001");
    desk.wire().plug();
    desk.command(DeviceCommand::Reconnect);
    desk.until("the other is read", |studio| serial(studio) == Some("OTHER0001"));
    desk.until_ready();
    desk.settle();
    assert!(desk.edits().is_empty());
    assert_eq!(desk.notice_count("session.other_encoder"), 1);
    desk.put(0, 1, b"Y");
    desk.until_kept();

    desk.wire().unplug();
    desk.until("it is lost", lost);
    desk.wire().exchange("");
    desk.wire().plug();
    desk.command(DeviceCommand::Reconnect);
    desk.until("the first is read", |studio| serial(studio) == Some("GB0450179"));
    desk.until("its edits are back", |studio| studio.hiperface().unwrap().staged.is_dirty());
    assert_eq!(desk.edits(), [(0, 0, b'X')]);
    assert_eq!(desk.notice_count("session.draft_back"), 1);
    desk.until_ready();
    desk.write();
    assert_eq!(desk.wire().field(0)[..2], *b"XM");
}

fn serial(studio: &Studio) -> Option<&str> {
    let identity = studio.hiperface().and_then(|encoder| encoder.identity.as_ref())?;
    Some(&identity.serial.serial_number)
}

/// The encoder behind a connected adapter is replaced, which does not break the link.
#[test]
fn detects_swapped_encoder_before_planning() {
    let mut desk = Desk::connected_at_port("");
    desk.put(0, 0, b"X");
    desk.until_kept();
    desk.wire().exchange("serial=OTHER0001");
    desk.command(DeviceCommand::Review);
    desk.until("the other is read", |studio| serial(studio) == Some("OTHER0001"));
    desk.until_ready();
    desk.settle();
    assert!(desk.encoder().session.review.is_none() && desk.edits().is_empty());
    assert_eq!(desk.notice_count("session.other_encoder"), 1);
    assert_eq!(desk.wire().wear(), 0);
}

/// Without edits, the notice reports only that the plan was discarded.
#[test]
fn swapped_encoder_discards_plan() {
    let mut desk = Desk::connected_at_port("");
    desk.wire().exchange("serial=OTHER0001");
    desk.ask(Hiperface::Plan(Change::ShiftPosition { steps: 12 }));
    desk.until("the other is read", |studio| serial(studio) == Some("OTHER0001"));
    desk.until_ready();
    assert!(desk.encoder().session.review.is_none());
    assert_eq!((desk.notice_count("session.plan_of_another"), desk.notice_count("session.other_encoder")), (1, 0));
}

/// If the reading after a reconnection is stopped, the encoder is not identified and does not receive the edits.
#[test]
fn stopped_reading_offers_no_edits() {
    let mut desk = Desk::connected_at_port("");
    desk.put(0, 0, b"X");
    desk.until_kept();
    desk.wire().unplug();
    desk.until("it is lost", lost);
    desk.wire().exchange("serial=OTHER0001");
    desk.wire().plug();
    desk.wire().hold_at(0x52, 1);
    desk.command(DeviceCommand::Reconnect);
    desk.until("it is held", |studio| studio.hiperface().is_some_and(|own| own.session.is_busy()));
    desk.wire().wait_until_held();
    desk.act(Action::Stop);
    desk.wire().release();
    desk.until_ready();
    assert_eq!(serial(&desk.studio), Some("GB0450179"), "nothing newer is known");
    desk.command(DeviceCommand::Review);
    desk.until("the other is read", |studio| serial(studio) == Some("OTHER0001"));
    desk.until_ready();
    assert_eq!(desk.wire().wear(), 0);
}

#[test]
fn new_address_persists_across_sessions() {
    let mut desk = Desk::connected_at_port("");
    let address = encoder_studio::devices::hiperface::state::forms::address("41").unwrap();
    desk.ask(Hiperface::Plan(Change::SetAddress(address)));
    desk.until_planned();
    desk.write_as_shown();
    desk.until_written();
    assert_eq!(desk.encoder().identity.as_ref().unwrap().address, 0x41);
    desk.ask(Hiperface::CloseReview);
    desk.wire().unplug();
    desk.until("it is lost", lost);
    desk.wire().plug();
    let errors = desk.notice_ids(Severity::Error).len();
    desk.command(DeviceCommand::Reconnect);
    desk.until_read();
    assert_eq!(desk.notice_ids(Severity::Error).len(), errors);
    let link = format!("serial:{PORT}?address=0x41");
    assert_eq!(desk.encoder().session.source, encoder_studio::app::session::Source::Link(link.parse().unwrap()));
}

/// The cable is disconnected after the address was changed and before it is read back. The new address is used.
#[test]
fn uses_address_set_by_interrupted_write() {
    let mut desk = Desk::connected_at_port("");
    let address = encoder_studio::devices::hiperface::state::forms::address("41").unwrap();
    desk.ask(Hiperface::Plan(Change::SetAddress(address)));
    desk.until_planned();
    desk.wire().hold_at(0x52, 2);
    desk.write_as_shown();
    desk.wire().wait_until_held();
    desk.wire().unplug();
    desk.wire().release();
    desk.until("it has ended", failed);
    assert!(lost(&desk.studio));
    desk.ask(Hiperface::CloseReview);
    desk.wire().plug();
    desk.command(DeviceCommand::Reconnect);
    desk.until("it is read", |studio| {
        studio
            .hiperface()
            .is_some_and(|own| own.session.is_ready() && own.identity.as_ref().is_some_and(|own| own.address == 0x41))
    });
}

#[test]
fn follows_changed_settings_after_restart() {
    let mut desk = Desk::connected_at_port("");
    let stored = desk.encoder().identity.as_ref().unwrap().label.settings;
    let format = CharacterFormat { baud: Baud::new(19_200).unwrap(), parity: Parity::Odd };
    let settings = encoder_studio::devices::hiperface::state::forms::settings(stored, format, true, true).unwrap();
    let link = |desk: &Desk| desk.encoder().session.source.clone();
    let (old, new) = (format!("serial:{PORT}"), format!("serial:{PORT}?baud=19200&parity=odd"));
    let at = |link: &str| encoder_studio::app::session::Source::Link(link.parse().unwrap());
    desk.ask(Hiperface::ConfigureForNow(settings));
    desk.until("both sides are there", |studio| {
        studio.services.log.notices().any(|own| own.texts[0].id() == "session.configured")
    });
    desk.until_ready();
    assert_eq!(link(&desk), at(&new), "until the restart");
    desk.ask(Hiperface::Reset);
    desk.until("it is restarted", |studio| {
        studio.services.log.notices().any(|own| own.texts[0].id() == "session.restarted")
    });
    desk.until_ready();
    assert_eq!(link(&desk), at(&format!("{old}?baud=9600&parity=even")));

    desk.ask(Hiperface::Plan(Change::Configure(settings)));
    desk.until_planned();
    desk.write_as_shown();
    desk.until_written();
    desk.ask(Hiperface::CloseReview);
    assert_eq!(link(&desk), at(&format!("{old}?baud=9600&parity=even")), "before the restart it talks as before");
    desk.ask(Hiperface::Check { restart: true });
    desk.until("the link follows", |studio| studio.hiperface().unwrap().session.source == at(&new));
    desk.until_ready();
    desk.wire().unplug();
    desk.until("it is lost", lost);
    desk.wire().plug();
    desk.command(DeviceCommand::Reconnect);
    desk.until_read();
    assert_eq!(*desk.phase(), Phase::Connected);
}

/// An open link without replies counts neither as connected nor as lost.
#[test]
fn silent_encoder_is_not_connected() {
    let mut desk = Desk::connected_at_port("");
    desk.put(0, 0, b"X");
    desk.wire().exchange("fault=silent-after:0");
    desk.ask(Hiperface::ReadCounter);
    let silent = |studio: &Studio| matches!(studio.hiperface().unwrap().session.phase, Phase::Silent(_));
    desk.until("it is silent", silent);
    let encoder = desk.encoder();
    assert!(matches!(&encoder.session.phase, Phase::Silent(why) if why.id() == "encoder.no_reply"));
    assert!(
        !encoder.session.is_ready()
            && !encoder.session.is_savable()
            && encoder.session.is_readable()
            && encoder.session.live_session().is_some()
    );
    desk.command(DeviceCommand::Read);
    desk.until("it was read in vain", |studio| studio.hiperface().unwrap().session.is_readable());
    assert!(silent(&desk.studio));
    desk.command(DeviceCommand::Review);
    assert!(desk.encoder().session.review.is_none());
    desk.wire().exchange("");
    desk.ask(Hiperface::ReadAnalogue(0x07));
    desk.until_ready();
    assert_eq!(*desk.phase(), Phase::Connected, "a refusal is an answer too");
    desk.command(DeviceCommand::Read);
    desk.until_ready();
    assert_eq!((desk.phase(), desk.edits()), (&Phase::Connected, vec![(0, 0, b'X')]));

    desk.command(DeviceCommand::Poll(Some(Duration::from_millis(2))));
    desk.until("samples come", |studio| studio.hiperface().unwrap().record.position_count() > 3);
    desk.wire().exchange("fault=silent-after:0");
    desk.until("it is silent", silent);
    assert!(!desk.studio.is_live());
}

#[test]
fn swapped_encoder_receives_no_access_codes() {
    let mut desk = Desk::connected_at_port("codes=0:9D");
    let code = encoder_studio::devices::hiperface::state::forms::access_code("9D").unwrap();
    desk.ask(Hiperface::UseCode { number: AccessCodeNumber::ZERO, code });
    desk.until_ready();
    assert!(desk.encoder().field(0).unwrap().bytes.is_some());
    desk.wire().unplug();
    desk.until("it is lost", lost);
    desk.wire().exchange("serial=OTHER0001&codes=0:9D");
    desk.wire().plug();
    desk.command(DeviceCommand::Reconnect);
    desk.until("the other is read", |studio| serial(studio) == Some("OTHER0001"));
    desk.until_ready();
    assert_eq!(desk.encoder().field(0).unwrap().bytes, None, "no access code was entered");
}

#[test]
fn rejects_reconnecting_during_write() {
    let mut desk = Desk::connected_at_port("");
    desk.put(0, 0, b"X");
    desk.command(DeviceCommand::Review);
    desk.until_planned();
    desk.wire().hold_at(0x4B, 1);
    desk.write_as_shown();
    desk.wire().wait_until_held();
    desk.open(&format!("serial:{PORT}?address=0x40"));
    desk.command(DeviceCommand::Reconnect);
    assert_eq!(desk.notice_count("session.busy"), 1);
    assert!(desk.encoder().session.is_writing());
    desk.wire().release();
    desk.until_written();
}

#[test]
fn reconnecting_ends_read_job() {
    let mut desk = Desk::connected_at_port("");
    desk.wire().hold_at(0x46, 1);
    desk.ask(Hiperface::ReadCounter);
    desk.wire().wait_until_held();
    desk.open(&format!("serial:{PORT}"));
    assert_eq!(desk.studio.services.jobs().next_back().unwrap().end, JobState::Cancelled);
    desk.wire().release();
    desk.until_read();
    assert!(desk.notice_ids(Severity::Error).is_empty());
}

#[test]
fn live_values_resume_after_job() {
    let mut desk = Desk::connected_at_port("rpm=60");
    desk.command(DeviceCommand::Poll(Some(Duration::from_millis(2))));
    assert!(desk.studio.is_live() && desk.studio.can_stop());
    desk.until("samples come", |studio| studio.hiperface().unwrap().record.position_count() > 10);
    let position = desk.encoder().record.last().unwrap();
    assert!(position.valid && position.position.is_some());
    desk.put(0, 0, b"X");
    desk.write();
    let points = desk.encoder().record.position_count();
    desk.until("samples go on", |studio| studio.hiperface().unwrap().record.position_count() > points + 10);
    assert_eq!(desk.bad_positions(), 0);
    assert!(desk.notice_ids(Severity::Warning).is_empty());

    desk.wire().unplug();
    desk.until("it is lost", lost);
    assert!(!desk.studio.is_live() && !desk.studio.can_stop());
    // The test waits longer than the interval between two checks of the connection.
    for _ in 0..70 {
        desk.studio.poll();
        std::thread::sleep(Duration::from_millis(10));
    }
    assert_eq!(desk.notice_ids(Severity::Error), ["link.lost"], "once");
}

/// A late failure belongs to the earlier polling and does not end the new one.
#[test]
fn late_failure_keeps_newer_live_values() {
    let mut desk = Desk::connected_at_port("");
    desk.command(DeviceCommand::Poll(Some(Duration::from_millis(2))));
    desk.until("samples come", |studio| studio.hiperface().unwrap().record.position_count() > 3);
    desk.wire().exchange("fault=silent-after:0");
    let began = std::time::Instant::now();
    while desk.encoder().session.live_session().unwrap().polling_interval().is_some() {
        assert!(began.elapsed() < crate::support::LONG, "what is shown is what the worker does");
        std::thread::sleep(Duration::from_millis(2));
    }
    // The event about the failure arrives within this time.
    std::thread::sleep(Duration::from_millis(50));
    desk.wire().exchange("");
    desk.command(DeviceCommand::Poll(Some(Duration::from_millis(2))));
    let points = desk.encoder().record.position_count();
    desk.until("samples go on", |studio| studio.hiperface().unwrap().record.position_count() > points + 3);
    assert!(desk.studio.is_live());
    assert_eq!(desk.notice_count("session.poll_failed"), 0);
}

#[test]
fn stop_and_escape_end_live_values() {
    for stop in [|| Action::Stop, || Action::Escape] {
        let mut desk = Desk::new_form("");
        desk.command(DeviceCommand::Poll(Some(Duration::from_millis(2))));
        desk.until("samples come", |studio| studio.hiperface().unwrap().record.position_count() > 3);
        desk.act(stop());
        assert!(!desk.studio.is_live());
        desk.settle();
        let sent = desk.wire().sent();
        desk.settle();
        assert_eq!(desk.wire().sent(), sent);
        let id = desk.encoder().session.id;
        desk.act(Action::Recorder(Of::Device(id), recorder::RecorderAction::Clear));
        assert!(desk.encoder().record.position_count() == 0 && desk.encoder().record.last().is_some());
    }
}
