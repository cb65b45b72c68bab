//! Edits outlive a crash: they are on disk as they are made, and come back with their encoder or profile.

use crate::tabs::Tabs as _;
use encoder_studio::app::DeviceCommand;
use std::fs;

use encoder_studio::app::session::Phase;
use encoder_studio::app::{Action, PendingEdits, Severity};
use encoder_studio::devices::hiperface::state::Action as Hiperface;

use crate::support::Desk;

const DRAFT: &str = "data/drafts/hiperface-virtual/37-GB0450179.ron";

#[test]
fn edits_taken_back_are_no_draft() {
    let mut desk = Desk::begun("");
    let path = desk.outside.path(DRAFT);
    desk.put(0, 0, b"X");
    desk.until("the draft is kept", |_| path.exists());
    desk.command(DeviceCommand::RevertAll);
    desk.until("the draft is gone", |_| !path.exists());
    desk.command(DeviceCommand::Undo);
    desk.until("the draft is kept", |_| path.exists());
}

#[test]
fn a_draft_that_cannot_be_read_is_told() {
    let desk = Desk::begun("");
    let path = desk.outside.path(DRAFT);
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    fs::write(&path, "(no draft").unwrap();
    let mut desk = desk.crash();
    desk.studio.begin(None, None);
    desk.until_read();
    assert_eq!(desk.told(Severity::Warning), ["session.draft_broken"]);
    assert!(desk.edits().is_empty());
}

#[test]
fn a_draft_that_cannot_be_kept_is_told_once() {
    let mut desk = Desk::begun("");
    fs::create_dir_all(desk.outside.path("data")).unwrap();
    fs::write(desk.outside.path("data/drafts"), "a file in the way").unwrap();
    for byte in [1, 2, 3] {
        desk.put(0, 0, &[byte]);
        desk.until("it is told", |studio| studio.services.log.standing().is_some());
        desk.settle();
    }
    assert_eq!(desk.told(Severity::Warning), ["session.draft_not_kept"]);
    desk.write();
    assert_eq!(desk.wire().field(0)[0], 3);
}

/// The notice of edits that came back is over once they are written; the result stands in the review and in the log.
#[test]
fn a_write_ends_the_notice_of_edits_that_came_back() {
    let mut desk = Desk::begun("");
    desk.put(0, 0, b"X");
    desk.until_kept();
    let mut desk = desk.crash();
    desk.studio.begin(None, None);
    desk.until("it is told", |studio| studio.services.log.standing().is_some());
    assert_eq!(desk.told(Severity::Warning), ["session.draft_back"]);
    desk.until_read();
    desk.write();
    assert!(desk.studio.services.log.standing().is_none());
    assert_eq!(desk.times_told("session.written"), 1);
}

/// What was edited for a profile belongs to that file.
#[test]
fn the_draft_of_a_profile_ends_where_it_is_saved() {
    let mut desk = Desk::begun("");
    let path = desk.outside.path("mine.ron");
    desk.ask(Hiperface::Save(path.clone()));
    desk.until("it is saved", |_| path.exists());
    desk.act(Action::Open(path.clone()));
    desk.until("it is open", |studio| studio.hiperface().unwrap().session.phase == Phase::Offline);
    desk.settle();
    desk.put(0, 0, b"X");
    desk.until_kept();

    let mut desk = desk.crash();
    desk.studio.begin(None, Some(path.clone()));
    desk.until("the edit is back", |studio| studio.hiperface().is_some_and(|own| own.staged.is_dirty()));
    let other = desk.outside.path("other.ron");
    desk.ask(Hiperface::Save(other.clone()));
    desk.until("it is saved", |studio| !studio.hiperface().unwrap().staged.is_dirty());
    let drafts = desk.outside.path("data/drafts/hiperface-files");
    desk.until("there is no draft", |_| fs::read_dir(&drafts).unwrap().count() == 0);
    for (path, first) in [(path, b'E'), (other, b'X')] {
        desk = desk.crash();
        desk.studio.begin(None, Some(path));
        desk.until("it is open", |studio| studio.hiperface().is_some());
        desk.settle();
        assert_eq!(desk.encoder().staged.byte(0, 0), Some(first));
        assert!(desk.edits().is_empty());
    }
}

/// A second window with the same encoder neither takes nor overwrites what the first one keeps.
#[test]
fn a_draft_has_one_owner() {
    let mut desk = Desk::begun("");
    desk.put(0, 0, b"X");
    desk.until_kept();
    let first = std::mem::replace(&mut desk.studio, desk.outside.studio());
    desk.studio.begin(None, None);
    desk.until("it is told", |studio| {
        studio.services.log.notices().any(|own| own.texts[0].id() == "session.draft_elsewhere")
    });
    desk.until_ready();
    assert!(desk.edits().is_empty());
    let draft = fs::read_to_string(desk.outside.path(DRAFT)).unwrap();
    desk.put(0, 1, b"YZ");
    desk.settle();
    assert_eq!(fs::read_to_string(desk.outside.path(DRAFT)).unwrap(), draft);
    assert_eq!(desk.times_told("session.draft_elsewhere"), 1);
    desk.act(Action::Close);
    assert_eq!(desk.studio.question.as_ref().unwrap().text.id(), "question.session_lost", "they would not come back");
    desk.act(Action::Escape);
    drop(first);
    let mut desk = desk.crash();
    desk.studio.begin(None, None);
    desk.until("the edit is back", |studio| studio.hiperface().unwrap().staged.is_dirty());
    assert_eq!(desk.edits(), [(0, 0, b'X')]);
}

#[test]
fn an_encoder_of_another_type_with_the_same_number_is_another() {
    let mut desk = Desk::at_port("");
    desk.put(0, 0, b"X");
    desk.until_kept();
    desk.wire().unplug();
    desk.until("it is lost", |studio| studio.hiperface().unwrap().session.line().is_none());
    desk.wire().exchange("model=sks36&serial=GB0450179");
    desk.wire().plug();
    desk.command(DeviceCommand::Reconnect);
    desk.until("it is another", |studio| {
        studio.hiperface().unwrap().identity.as_ref().is_some_and(|own| own.name == "SKS36")
    });
    desk.until_ready();
    desk.settle();
    assert!(desk.edits().is_empty());
}

#[test]
fn without_a_serial_number_there_is_no_draft_which_is_said_once() {
    let mut desk = Desk::at_port("serial= ");
    assert_eq!(desk.encoder().identity.as_ref().unwrap().serial.serial_number, "");
    desk.put(0, 0, b"X");
    desk.put(0, 1, b"Y");
    desk.settle();
    assert_eq!(desk.times_told("session.draft_none"), 1);
    let id = desk.encoder().session.id;
    desk.act(Action::CloseSession(id));
    assert_eq!(desk.studio.question.as_ref().unwrap().text.id(), "question.session_lost");
    desk.act(Action::Escape);
    let replug = |desk: &mut Desk, query: Option<&str>| {
        desk.wire().unplug();
        desk.until("it is lost", |studio| studio.hiperface().unwrap().session.line().is_none());
        if let Some(query) = query {
            desk.wire().exchange(query);
        }
        desk.wire().plug();
        desk.command(DeviceCommand::Reconnect);
        desk.until_read();
    };
    replug(&mut desk, None);
    assert_eq!(desk.edits().len(), 2, "the same type with the same memory is as good as the same");
    desk.write();
    desk.put(0, 0, b"Z");
    assert_eq!(desk.edits().len(), 1, "its own writes make it no other");
    // Fresh from the factory: its memory is not the one that was written.
    replug(&mut desk, Some("serial= "));
    assert!(desk.edits().is_empty());
    assert_eq!(desk.times_told("session.edits_gone"), 1);
}

#[cfg(unix)]
#[test]
fn two_ways_to_a_file_lead_to_one_session() {
    let mut desk = Desk::begun("");
    let path = desk.outside.path("mine.ron");
    desk.ask(Hiperface::Save(path.clone()));
    desk.until("it is saved", |_| path.exists());
    let other = desk.outside.path("other.ron");
    std::os::unix::fs::symlink(&path, &other).unwrap();
    for path in [path, other] {
        desk.act(Action::Open(path.clone()));
        assert_eq!(desk.studio.opening_files(), [path]);
        desk.until("it is open", |studio| studio.opening_files().is_empty());
    }
    assert_eq!(desk.studio.devices().len(), 2);
}
