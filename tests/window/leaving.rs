//! Tests of sessions that are closed, reopened or ended by a panic. The results of their work are reported, and closing
//! waits for them for a limited time.

use crate::tabs::Tabs as _;
use encoder_studio::app::DeviceCommand;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use encoder_studio::app::session::Phase;
use encoder_studio::app::{Action, JobState, Severity};
use encoder_studio::devices::hiperface::state::{HiperfaceAction as Hiperface, ReviewState};

use crate::support::{Desk, PORT, SLOW, is_review};

/// Closes a session while it writes two bytes. The cable is held before the first of them.
fn close_during_write(mut desk: Desk) -> Desk {
    desk.put(0, 0, b"X");
    desk.put(0, 2, b"Y");
    desk.command(DeviceCommand::Review);
    desk.until_planned();
    desk.wire().hold_at(0x4B, 1);
    desk.write_as_shown();
    desk.wire().wait_until_held();
    let id = desk.encoder().session.id;
    desk.act(Action::CloseSession(id));
    desk.act(Action::Confirm);
    assert!(desk.studio.devices().is_empty());
    desk
}

#[test]
fn awaits_write_of_closed_session() {
    let mut desk = close_during_write(Desk::connected_at_port(""));
    desk.act(Action::Close);
    desk.settle();
    assert!(!desk.studio.can_close(), "it still writes");
    assert_eq!(desk.studio.services.jobs().next_back().unwrap().end, JobState::Running);
    desk.wire().release();
    desk.until("it may close", |studio| studio.can_close());
    assert!(desk.notice_ids(Severity::Warning).contains(&"write.cancelled"));
    assert_eq!(desk.studio.services.jobs().next_back().unwrap().end, JobState::Cancelled);
    assert_eq!(desk.wire().field(0)[..3], *b"XMD");
}

#[test]
fn reopens_wire_after_write() {
    let mut desk = close_during_write(Desk::connected_at_port(""));
    let sent = desk.wire().sent();
    desk.open(&format!("serial:{PORT}"));
    desk.settle();
    assert_eq!((desk.phase(), desk.wire().sent()), (&Phase::Opening, sent));
    desk.wire().release();
    desk.until_read();
    assert!(desk.notice_ids(Severity::Warning).contains(&"write.cancelled"));
    assert_eq!(desk.encoder().staged.device_byte(0, 0), Some(b'X'));
}

/// Closing the window waits until a closed session's edit is on disk. The draft file is a named pipe, so the write
/// completes only when the test reads it.
#[cfg(unix)]
#[test]
fn awaits_draft_of_closed_session() {
    let mut desk = Desk::new_form("");
    let draft = desk.outside.path("data/drafts/hiperface-virtual/37-GB0450179.ron");
    std::fs::create_dir_all(draft.parent().unwrap()).unwrap();
    assert!(std::process::Command::new("mkfifo").arg(&draft).status().unwrap().success());
    desk.put(0, 0, b"X");
    let id = desk.encoder().session.id;
    desk.act(Action::CloseSession(id));
    desk.act(Action::Confirm);
    desk.act(Action::Close);
    desk.settle();
    assert!(desk.studio.devices().is_empty() && !desk.studio.can_close(), "the edit is not on disk");
    assert!(std::fs::read_to_string(&draft).unwrap().contains("88"));
    desk.until("it may close", |studio| studio.can_close());
}

/// A link must not be used if it opens only after a later attempt has connected.
#[test]
fn discards_link_from_earlier_attempt() {
    let mut desk = Desk::fresh("");
    desk.outside.patience.job = Duration::from_millis(50);
    desk.studio = desk.outside.studio();
    desk.open(SLOW);
    desk.settle();
    desk.open(&format!("{SLOW}?margin=21"));
    desk.until_read();
    let surveys = desk.wire().count(0x52);
    desk.outside.opens.store(true, Ordering::SeqCst);
    std::thread::sleep(Duration::from_millis(50));
    desk.settle();
    assert_eq!(desk.wire().count(0x52), surveys, "it is not read a second time");
    assert_eq!((desk.studio.devices().len(), desk.phase()), (1, &Phase::Connected));
    desk.act(Action::Close);
    desk.until("its thread has ended", |studio| studio.can_close());
}

#[test]
fn dead_thread_loses_session_and_job() {
    let mut desk = Desk::connected_at_port("");
    desk.put(0, 0, b"X");
    desk.wire().kill();
    let wakes = desk.outside.wakes.load(Ordering::SeqCst);
    desk.ask(Hiperface::ReadCounter);
    desk.until("it is lost", |studio| studio.hiperface().unwrap().session.live_session().is_none());
    assert!(matches!(desk.phase(), Phase::Lost(why) if why.id() == "session.ended"));
    assert!(desk.outside.wakes.load(Ordering::SeqCst) > wakes, "the window is told to look");
    assert!(matches!(desk.studio.services.jobs().next_back().unwrap().end, JobState::Failed(_)));
    assert_eq!(desk.edits(), [(0, 0, b'X')]);
    desk.command(DeviceCommand::Reconnect);
    desk.until_read();

    desk.command(DeviceCommand::Review);
    desk.until_planned();
    desk.wire().kill();
    desk.write_as_shown();
    desk.until("it has ended", |studio| {
        is_review(studio, |state| matches!(state, ReviewState::Failed { begun: true, .. }))
    });
}

#[test]
fn closing_waits_longer_for_write_than_job() {
    let mut desk = Desk::impatient("");
    desk.wire().hold_at(0x46, 1);
    desk.ask(Hiperface::ReadCounter);
    desk.wire().wait_until_held();
    let patience = desk.outside.patience;
    let began = Instant::now();
    desk.act(Action::Close);
    desk.act(Action::Confirm);
    desk.until("it may close", |studio| studio.can_close());
    assert!(began.elapsed() >= patience.job && began.elapsed() < patience.write);
    desk.wire().release();

    let mut desk = close_during_write(Desk::impatient(""));
    let began = Instant::now();
    desk.act(Action::Close);
    desk.until("it may close", |studio| studio.can_close());
    assert!(began.elapsed() >= patience.write);
    desk.wire().release();
}
