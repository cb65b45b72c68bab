//! Tests of Escape, which stops a running job before it closes the dialog, and of closing with unsaved data, which asks
//! once.

use encoder_studio::app::DeviceCommand;
use encoder_studio::app::connect::ConnectAction as Connect;
use encoder_studio::app::{Action, JobState, PendingEdits};
use encoder_studio::devices::hiperface::state::HiperfaceAction as Hiperface;
use encoder_studio::store::{DeviceKey, Logbook, Outcome};

use crate::support::Desk;

#[test]
fn closes_window_without_losses() {
    let mut desk = Desk::new_form("");
    assert!(!desk.studio.can_close());
    desk.command(DeviceCommand::Poll(Some(std::time::Duration::from_millis(5))));
    desk.act(Action::Close);
    assert!(desk.studio.question.is_none());
    desk.until("it may close", |studio| studio.can_close());
}

#[test]
fn write_ends_safely_before_closing() {
    let mut desk = Desk::new_form("");
    desk.put(0, 0, b"X");
    desk.put(0, 2, b"Y");
    desk.command(DeviceCommand::Review);
    desk.until_planned();
    desk.wire().hold_at(0x4B, 1);
    desk.write_as_shown();
    desk.wire().wait_until_held();
    desk.act(Action::Close);
    assert_eq!(desk.studio.question.as_ref().unwrap().text.id(), "question.busy");
    desk.act(Action::Confirm);
    desk.settle();
    assert!(!desk.studio.can_close(), "it still writes");
    desk.wire().release();
    desk.until("it may close", |studio| studio.can_close());
    assert_eq!(desk.wire().field(0)[..3], *b"XMD");
    let logbook = Logbook::open(&desk.outside.store().logbook_path()).unwrap();
    let key = DeviceKey {
        kind: "hiperface".to_owned(),
        device_type: "37h".to_owned(),
        serial_number: "GB0450179".to_owned(),
        is_virtual: true,
    };
    let entries = logbook.history(&key, 10).unwrap();
    assert_eq!(entries[0].conclusion.as_ref().unwrap().outcome, Outcome::Cancelled);
}

#[test]
fn escape_stops_before_closing_dialog_and_review() {
    let mut desk = Desk::new_form("");
    desk.put(0, 0, b"X");
    desk.command(DeviceCommand::Review);
    desk.until_planned();
    desk.wire().hold_at(0x46, 1);
    desk.ask(Hiperface::ReadCounter);
    desk.connect(Connect::Open);
    desk.wire().wait_until_held();

    desk.act(Action::Escape);
    assert!(desk.encoder().session.live_session().unwrap().running_job().unwrap().stopping);
    assert!(desk.studio.connect.is_some() && desk.encoder().session.review.is_some());
    desk.wire().release();
    desk.until_ready();
    desk.act(Action::Escape);
    assert!(desk.studio.connect.is_none() && desk.encoder().session.review.is_some());
    desk.act(Action::Escape);
    assert!(desk.encoder().session.review.is_none());
    assert_eq!(desk.edits(), [(0, 0, b'X')]);
}

#[test]
fn closing_review_cancels_planning() {
    let mut desk = Desk::new_form("");
    desk.put(0, 0, b"X");
    desk.wire().hold_at(0x56, 1);
    desk.command(DeviceCommand::Review);
    desk.wire().wait_until_held();
    desk.ask(Hiperface::CloseReview);
    assert!(desk.encoder().session.review.is_none());
    desk.wire().release();
    desk.until_ready();
    assert!(desk.encoder().session.review.is_none());
    assert_eq!(desk.studio.services.jobs().next_back().unwrap().end, JobState::Cancelled);
}

#[test]
fn review_stays_open_while_writing() {
    let mut desk = Desk::new_form("");
    desk.put(0, 0, b"X");
    desk.command(DeviceCommand::Review);
    desk.until_planned();
    desk.wire().hold_at(0x4B, 1);
    desk.write_as_shown();
    desk.wire().wait_until_held();
    desk.ask(Hiperface::CloseReview);
    assert!(desk.review().is_writing());
    desk.put(0, 1, b"Y");
    assert_eq!(desk.notice_count("session.busy"), 1, "what is being written is not edited");
    desk.wire().release();
    desk.until_written();
    assert!(!desk.encoder().staged.is_dirty());
}

#[test]
fn closing_session_ends_read_job() {
    let mut desk = Desk::new_form("");
    desk.wire().hold_at(0x46, 1);
    desk.ask(Hiperface::ReadCounter);
    desk.wire().wait_until_held();
    let id = desk.encoder().session.id;
    desk.act(Action::CloseSession(id));
    assert_eq!(desk.studio.question.as_ref().unwrap().text.id(), "question.session_busy");
    desk.act(Action::Confirm);
    assert_eq!(desk.studio.services.jobs().next_back().unwrap().end, JobState::Cancelled);
    desk.wire().release();
    desk.act(Action::Close);
    desk.until("it may close", |studio| studio.can_close());
}
