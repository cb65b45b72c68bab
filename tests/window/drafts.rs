//! Edits outlive a crash: they are on disk as they are made, and come back with their encoder or profile.

use std::fs;

use encoder_studio::app::hiperface::{Action as Hiperface, Phase};
use encoder_studio::app::{Action, Severity};

use crate::support::Desk;

const DRAFT: &str = "data/drafts/virtual/GB0450179.ron";

#[test]
fn edits_survive_a_crash_and_are_no_draft_once_they_are_written() {
    let mut desk = Desk::begun("");
    desk.put(0, 0, b"X");
    desk.put(0, 5, b"YZ");
    desk.until_kept();
    let mut desk = desk.crash();
    desk.studio.begin(None, None);
    desk.until("the edits are back", |studio| studio.encoder().unwrap().staged.is_dirty());
    desk.until_ready();
    assert_eq!(desk.edits(), [(0, 0, b'X'), (0, 5, b'Y'), (0, 6, b'Z')]);
    assert_eq!(desk.told(Severity::Warning), ["session.draft_back"]);
    let path = desk.outside.path(DRAFT);
    assert!(path.exists());
    desk.write();
    desk.until("the draft is gone", |_| !path.exists());
    let mut desk = desk.crash();
    desk.studio.begin(None, None);
    desk.until_read();
    assert!(desk.edits().is_empty() && desk.told(Severity::Warning).is_empty());
}

#[test]
fn edits_taken_back_are_no_draft() {
    let mut desk = Desk::begun("");
    let path = desk.outside.path(DRAFT);
    desk.put(0, 0, b"X");
    desk.until("the draft is kept", |_| path.exists());
    desk.ask(Hiperface::RevertAll);
    desk.until("the draft is gone", |_| !path.exists());
    desk.ask(Hiperface::Undo);
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

/// What was edited for a profile belongs to that file.
#[test]
fn the_draft_of_a_profile_ends_where_it_is_saved() {
    let mut desk = Desk::begun("");
    let path = desk.outside.path("mine.ron");
    desk.ask(Hiperface::Save(path.clone()));
    desk.until("it is saved", |_| path.exists());
    desk.act(Action::Open(path.clone()));
    desk.until("it is open", |studio| studio.encoder().unwrap().phase == Phase::Offline);
    desk.settle();
    desk.put(0, 0, b"X");
    desk.until_kept();

    let mut desk = desk.crash();
    desk.studio.begin(None, Some(path.clone()));
    desk.until("the edit is back", |studio| studio.encoder().is_some_and(|own| own.staged.is_dirty()));
    let other = desk.outside.path("other.ron");
    desk.ask(Hiperface::Save(other.clone()));
    desk.until("it is saved", |studio| !studio.encoder().unwrap().staged.is_dirty());
    let drafts = desk.outside.path("data/drafts/files");
    desk.until("there is no draft", |_| fs::read_dir(&drafts).unwrap().count() == 0);
    for (path, first) in [(path, b'E'), (other, b'X')] {
        desk = desk.crash();
        desk.studio.begin(None, Some(path));
        desk.until("it is open", |studio| studio.encoder().is_some());
        desk.settle();
        assert_eq!(desk.encoder().staged.byte(0, 0), Some(first));
        assert!(desk.edits().is_empty());
    }
}
