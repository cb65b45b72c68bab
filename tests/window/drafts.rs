//! Tests that edits survive a crash: they are saved to disk as they are made, and restored with their device or
//! profile. The test kind stands for all kinds. HIPERFACE is used for cases that need a type, or a device without a
//! serial number.

use std::fs;

use encoder_studio::app::session::Phase;
use encoder_studio::app::{Action, DeviceCommand, Severity};

use crate::each_kind::{NOVO, command, shown, until_ready, write};
use crate::novo::state::Encoder;
use crate::support::Desk;
use crate::tabs::Tabs as _;

const DRAFT: &str = "data/drafts/novo-virtual/N1-1001.ron";

/// Starts the application and reads the virtual encoder of the test kind.
fn connected() -> Desk {
    let mut desk = Desk::with_novo();
    connect(&mut desk);
    desk
}

/// Drops the application without closing it, as a crash would, and starts it again.
fn crash(desk: Desk) -> Desk {
    let mut desk = desk.crash();
    connect(&mut desk);
    desk
}

fn connect(desk: &mut Desk) {
    desk.act(Action::ShowTab(crate::tabs::NOVEL));
    desk.open("sim:");
    until_ready(desk);
}

fn edits(desk: &Desk) -> usize {
    shown(&desk.studio).unwrap().edit_count()
}

/// Returns the first value that [`NOVO`] edits.
fn value(desk: &Desk) -> u16 {
    shown(&desk.studio).unwrap().get::<Encoder>().unwrap().wanted().unwrap()[1]
}

fn until_kept(desk: &mut Desk) {
    let path = desk.outside.path(DRAFT);
    desk.until("the draft is kept", |_| path.exists());
}

#[test]
fn undone_edits_leave_no_draft() {
    let mut desk = connected();
    let path = desk.outside.path(DRAFT);
    NOVO.edit(&mut desk, &[7]);
    until_kept(&mut desk);
    command(&mut desk, DeviceCommand::RevertAll);
    desk.until("the draft is gone", |_| !path.exists());
    command(&mut desk, DeviceCommand::Undo);
    until_kept(&mut desk);
}

#[test]
fn reports_unreadable_draft() {
    let desk = connected();
    let path = desk.outside.path(DRAFT);
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    fs::write(&path, "(no draft").unwrap();
    let desk = crash(desk);
    assert_eq!(desk.notice_ids(Severity::Warning), ["session.draft_broken"]);
    assert_eq!(edits(&desk), 0);
}

#[test]
fn reports_unwritable_draft_once() {
    let mut desk = connected();
    fs::create_dir_all(desk.outside.path("data")).unwrap();
    fs::write(desk.outside.path("data/drafts"), "a file in the way").unwrap();
    for byte in [1, 2, 4] {
        NOVO.edit(&mut desk, &[byte]);
        desk.until("it is told", |studio| studio.services.log.current().is_some());
        desk.settle();
    }
    assert_eq!(desk.notice_ids(Severity::Warning), ["session.draft_not_kept"]);
    write(&mut desk);
    assert_eq!(value(&desk), 4);
}

/// The notice about restored edits disappears when they are written. The result is in the review and in the log.
#[test]
fn write_clears_restored_edits_notice() {
    let mut desk = connected();
    NOVO.edit(&mut desk, &[7]);
    until_kept(&mut desk);
    let mut desk = crash(desk);
    desk.until("it is told", |studio| studio.services.log.current().is_some());
    assert_eq!(desk.notice_ids(Severity::Warning), ["session.draft_back"]);
    write(&mut desk);
    assert!(desk.studio.services.log.current().is_none());
    assert_eq!(desk.notice_count("novo.written"), 1);
}

/// Once a profile has been saved, its file contains the edits, so its draft is removed.
#[test]
fn saving_profile_removes_draft() {
    let mut desk = connected();
    let path = desk.outside.path("mine.ron");
    NOVO.save(&mut desk, &path);
    desk.act(Action::Open(path.clone()));
    desk.until("it is open", |studio| *shown(studio).unwrap().phase() == Phase::Offline);
    desk.settle();
    NOVO.edit(&mut desk, &[7]);
    let drafts = desk.outside.path("data/drafts/novo-files");
    let kept = |folder: &std::path::Path| {
        let files = fs::read_dir(folder).into_iter().flatten().map(|file| file.unwrap().path());
        files.filter(|path| path.extension().is_some_and(|own| own == "ron")).count()
    };
    desk.until("the edit is kept", |_| kept(&drafts) == 1);

    let mut desk = desk.crash();
    desk.studio.start_with(None, Some(path.clone()));
    desk.until("the edit is back", |studio| shown(studio).is_some_and(|own| own.edit_count() == 1));
    let other = desk.outside.path("other.ron");
    NOVO.save(&mut desk, &other);
    desk.until("it is saved", |studio| shown(studio).unwrap().edit_count() == 0);
    desk.until("there is no draft", |_| fs::read_dir(&drafts).unwrap().count() == 0);
    for (path, expected) in [(path, 3), (other, 7)] {
        desk = desk.crash();
        desk.studio.start_with(None, Some(path));
        desk.until("it is open", |studio| shown(studio).is_some());
        desk.settle();
        assert_eq!((value(&desk), edits(&desk)), (expected, 0));
    }
}

/// A second window with the same encoder neither adopts nor overwrites the first one's draft.
#[test]
fn draft_has_one_owner() {
    let mut desk = connected();
    NOVO.edit(&mut desk, &[7]);
    until_kept(&mut desk);
    let first = std::mem::replace(&mut desk.studio, desk.outside.studio());
    connect(&mut desk);
    desk.until("it is told", |studio| {
        studio.services.log.notices().any(|own| own.texts[0].id() == "session.draft_elsewhere")
    });
    assert_eq!(edits(&desk), 0);
    let draft = fs::read_to_string(desk.outside.path(DRAFT)).unwrap();
    NOVO.edit(&mut desk, &[8, 9]);
    desk.settle();
    assert_eq!(fs::read_to_string(desk.outside.path(DRAFT)).unwrap(), draft);
    assert_eq!(desk.notice_count("session.draft_elsewhere"), 1);
    desk.act(Action::Close);
    assert_eq!(desk.studio.question.as_ref().unwrap().text.id(), "question.session_lost", "they would not come back");
    desk.act(Action::Escape);
    drop(first);
    let desk = crash(desk);
    assert_eq!((value(&desk), edits(&desk)), (7, 1));
}

#[cfg(unix)]
#[test]
fn two_paths_open_one_session() {
    let mut desk = connected();
    let path = desk.outside.path("mine.ron");
    NOVO.save(&mut desk, &path);
    let other = desk.outside.path("other.ron");
    std::os::unix::fs::symlink(&path, &other).unwrap();
    for path in [path, other] {
        desk.act(Action::Open(path.clone()));
        assert_eq!(desk.studio.files_being_opened(), [path]);
        desk.until("it is open", |studio| studio.files_being_opened().is_empty());
    }
    assert_eq!(desk.studio.devices().len(), 2);
}

#[test]
fn drafts_differ_by_type() {
    let mut desk = Desk::connected_at_port("");
    desk.put(0, 0, b"X");
    desk.until_kept();
    desk.wire().unplug();
    desk.until("it is lost", |studio| studio.hiperface().unwrap().session.live_session().is_none());
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
fn missing_serial_number_prevents_drafts() {
    let mut desk = Desk::connected_at_port("serial= ");
    assert_eq!(desk.encoder().identity.as_ref().unwrap().serial.serial_number, "");
    desk.put(0, 0, b"X");
    desk.put(0, 1, b"Y");
    desk.settle();
    assert_eq!(desk.notice_count("session.draft_none"), 1);
    let id = desk.encoder().session.id;
    desk.act(Action::CloseSession(id));
    assert_eq!(desk.studio.question.as_ref().unwrap().text.id(), "question.session_lost");
    desk.act(Action::Escape);
    let replug = |desk: &mut Desk, query: Option<&str>| {
        desk.wire().unplug();
        desk.until("it is lost", |studio| studio.hiperface().unwrap().session.live_session().is_none());
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
    // The exchanged encoder has factory settings, so its memory is not the one that was edited.
    replug(&mut desk, Some("serial= "));
    assert!(desk.edits().is_empty());
    assert_eq!(desk.notice_count("session.edits_gone"), 1);
}
