//! Tests of profiles that are saved from an encoder, opened next to one, or edited without one.

use crate::tabs::Tabs as _;
use encoder_studio::app::DeviceCommand;
use std::fs;

use encoder_studio::app::diverged::ConflictResolution;
use encoder_studio::app::review::{Permit, ReviewSheet, Stage};
use encoder_studio::app::session::Phase;
use encoder_studio::app::{Action, FileQuestion, Language, PendingEdits, Severity, Studio};
use encoder_studio::devices::hiperface::profile::HiperfaceProfile;
use encoder_studio::devices::hiperface::state::{HiperfaceAction as Hiperface, ReviewState};
use encoder_studio::kinds::program;
use encoder_studio::profile::ProfileDocument;
use encoder_studio::store::read_text;

use crate::support::{Desk, OTHER_PORT, is_review};

fn saved() -> (Desk, std::path::PathBuf) {
    let mut desk = Desk::new_form("");
    let path = desk.outside.path("mine.ron");
    desk.ask(Hiperface::Save(path.clone()));
    desk.until("it is saved", |studio| studio.services.log.notices().any(|own| own.texts[0].id() == "session.saved"));
    desk.until_ready();
    (desk, path)
}

fn open(desk: &mut Desk, path: &std::path::Path) {
    desk.act(Action::Open(path.to_owned()));
    desk.until("it is open", |studio| studio.hiperface().unwrap().session.phase == Phase::Offline);
    desk.settle();
}

#[test]
fn saved_profile_matches_encoder() {
    let (desk, path) = saved();
    let profile = ProfileDocument::parse(&read_text(&path).unwrap(), program().studio.formats)
        .unwrap()
        .body
        .into_profile::<HiperfaceProfile>()
        .unwrap();
    assert_eq!(profile.identity.serial_number, "GB0450179");
    assert_eq!(profile.fields, desk.encoder().staged.device());
    assert_eq!(profile.fields[0].bytes.as_ref().unwrap()[..], desk.wire().field(0));
    assert_eq!(profile.recorded.position, Some(0x000E_0531));
}

#[test]
fn locked_encoder_profile_lists_missing_values() {
    let mut desk = Desk::connected_at_port("codes=0:9D");
    let path = desk.outside.path("locked.ron");
    desk.ask(Hiperface::Save(path.clone()));
    let saved = |studio: &encoder_studio::app::Studio| studio.services.log.current().is_some();
    desk.until("it is saved", saved);
    let ids = |desk: &Desk| {
        let standing = desk.studio.services.log.current().unwrap();
        (standing.severity, standing.texts.iter().map(encoder_studio::app::Text::id).collect::<Vec<_>>())
    };
    assert_eq!(ids(&desk), (Severity::Warning, vec!["session.saved", "session.saved_locked"]));

    let mut desk = Desk::new_form("");
    desk.put(0, 0, b"XY");
    let path = desk.outside.path("mine.ron");
    desk.ask(Hiperface::Save(path.clone()));
    desk.until("it is saved", saved);
    assert_eq!(ids(&desk), (Severity::Warning, vec!["session.saved", "session.saved_without"]));
    let profile = ProfileDocument::parse(&read_text(&path).unwrap(), program().studio.formats)
        .unwrap()
        .body
        .into_profile::<HiperfaceProfile>()
        .unwrap();
    assert_eq!(profile.fields[0].bytes.as_ref().unwrap()[..2], *b"EM");
    let words =
        desk.studio.services.log.current().unwrap().texts[1].to_string_in(encoder_studio::app::Language::English);
    assert!(words.contains('2'), "{words}");
}

#[test]
fn suggests_file_named_after_encoder() {
    let mut desk = Desk::new_form("");
    desk.command(DeviceCommand::AskSave);
    let suggested = "SKM36-GB0450179.ron".into();
    let session = desk.studio.hiperface().unwrap().session.id;
    assert_eq!(desk.studio.take_file_question(), Some(FileQuestion::Save { session, suggested }));
    desk.act(Action::AskOpen);
    assert_eq!(desk.studio.take_file_question(), Some(FileQuestion::Open));
    assert_eq!(desk.studio.take_file_question(), None, "once");
    desk.act(Action::FileNotChosen);
    desk.act(Action::TypePath(FileQuestion::Open));
    assert_eq!(desk.studio.take_path_question(), Some(FileQuestion::Open));
}

/// A save requested during another one is rejected. The first one still goes to its own file.
#[test]
fn concurrent_save_is_rejected() {
    let mut desk = Desk::new_form("");
    let (first, second) = (desk.outside.path("first.ron"), desk.outside.path("second.ron"));
    desk.wire().hold_at(0x4A, 1);
    desk.ask(Hiperface::Save(first.clone()));
    desk.wire().wait_until_held();
    desk.ask(Hiperface::Save(second.clone()));
    assert_eq!(desk.notice_count("session.busy"), 1);
    desk.wire().release();
    desk.until("it is saved", |_| first.exists());
    desk.settle();
    assert!(!second.exists());
}

#[test]
fn unreadable_profile_stays_unchanged() {
    let mut desk = Desk::new_form("");
    let path = desk.outside.path("broken.ron");
    for (content, id) in
        [("(schema: 1,, )", "profile.invalid"), ("(schema: 99, device: \"hiperface\")", "profile.schema")]
    {
        fs::write(&path, content).unwrap();
        let before = desk.notice_ids(Severity::Error).len();
        desk.act(Action::Open(path.clone()));
        desk.until("it is told", |studio| {
            studio.services.log.notices().filter(|own| own.severity == Severity::Error).count() > before
        });
        assert_eq!(*desk.notice_ids(Severity::Error).last().unwrap(), id);
        assert_eq!(fs::read_to_string(&path).unwrap(), content);
    }
    desk.act(Action::Open(desk.outside.path("none.ron")));
    desk.until("it is told", |studio| studio.services.log.notices().any(|own| own.texts[0].id() == "file.not_found"));
    assert_eq!(desk.studio.devices().len(), 1);
}

/// Saving would lose the parts of a newer schema that are unknown to this version (issue 22.17).
#[test]
fn newer_schema_is_read_only() {
    let (mut desk, path) = saved();
    let encoder = desk.encoder().session.id;
    let newer = read_text(&path).unwrap().replace("schema: 1", "schema: 9");
    fs::write(&path, &newer).unwrap();
    open(&mut desk, &path);
    assert_eq!(desk.notice_count("profile.newer"), 1);
    desk.put(0, 0, b"X");
    desk.ask(Hiperface::Save(path.clone()));
    assert_eq!(desk.notice_count("profile.newer"), 2);
    desk.command(DeviceCommand::WriteInto(encoder));
    assert_eq!((desk.notice_count("profile.newer"), desk.encoder().session.name().as_str()), (3, "mine.ron"));
    assert_eq!(fs::read_to_string(&path).unwrap(), newer);
    assert_eq!(desk.edits(), [(0, 0, b'X')]);
}

#[test]
fn reloaded_profile_keeps_edits() {
    let (mut desk, path) = saved();
    open(&mut desk, &path);
    assert_eq!(desk.encoder().session.name(), "mine.ron");
    assert!(desk.encoder().identity.is_some() && !desk.encoder().session.is_virtual());
    desk.put(0, 0, b"X");
    let text = read_text(&path).unwrap();
    fs::write(&path, text.replace("45 4D 44 37", "45 4E 44 37")).unwrap();
    desk.command(DeviceCommand::Read);
    desk.until("it is read again", |studio| studio.hiperface().unwrap().staged.device_byte(0, 1) == Some(0x4E));
    assert_eq!(desk.edits(), [(0, 0, b'X')]);

    // A file that is invalid by now does not change the open profile.
    fs::write(&path, "(").unwrap();
    desk.command(DeviceCommand::Read);
    desk.until("it is told", |studio| studio.services.log.notices().any(|own| own.texts[0].id() == "profile.invalid"));
    assert_eq!((desk.encoder().staged.device_byte(0, 1), desk.edits()), (Some(0x4E), vec![(0, 0, b'X')]));
    // The invalid file is not replaced without a question either.
    desk.ask(Hiperface::Save(path.clone()));
    desk.until("it is asked", |studio| studio.diverged.is_some());
    assert_eq!(fs::read_to_string(&path).unwrap(), "(");
    desk.act(Action::Resolve(ConflictResolution::KeepMine));
    desk.until("the edit is saved", |studio| !studio.hiperface().unwrap().staged.is_dirty());
    let profile = ProfileDocument::parse(&read_text(&path).unwrap(), program().studio.formats)
        .unwrap()
        .body
        .into_profile::<HiperfaceProfile>()
        .unwrap();
    assert_eq!(profile.fields[0].bytes.as_ref().unwrap()[..3], *b"XND");
}

#[test]
fn open_profile_ignores_own_write_protection() {
    let mut desk = Desk::fresh("");
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("profiles/hiperface");
    let path = desk.outside.path("ready-made.ron");
    fs::copy(folder.join("multiturn-skm36.ron"), &path).unwrap();
    desk.studio.start_with(None, Some(path.clone()));
    desk.until("it is open", |studio| studio.hiperface().is_some());
    assert_eq!(desk.encoder().mounting_ranges(1), [(0..16, "commutation offset".to_owned())]);
    desk.put(0, 0, b"X");
    assert_eq!(desk.edits(), [(0, 0, b'X')]);
}

#[test]
fn other_encoder_needs_permission() {
    let (mut desk, path) = saved();
    plan_rejected_by_other_encoder(&mut desk, &path, &[(0, b"X")]);
    let mut options = desk.review().options().unwrap();
    (options.allow_other_device, options.allow_other_type) = (true, true);
    options.copy.insert(0, true);
    desk.ask(Hiperface::PlanAgain(options));
    desk.until_planned();
    desk.write_as_shown();
    desk.until_written();
    assert_eq!(desk.outside.wire(OTHER_PORT).field(0)[0], b'X', "the edit of the profile is in it");
    assert_eq!(desk.wire().wear(), 0);
}

/// Returns the data of the displayed review.
fn sheet(desk: &Desk) -> ReviewSheet {
    desk.studio.selected_device().unwrap().review_sheet().unwrap()
}

/// Edits a profile and plans to write it to another encoder, which is rejected because the serial number differs.
fn plan_rejected_by_other_encoder(desk: &mut Desk, path: &std::path::Path, edits: &[(usize, &[u8])]) {
    desk.open(&format!("serial:{OTHER_PORT}"));
    desk.until_read();
    let other = desk.encoder().session.id;
    open(desk, path);
    for (address, bytes) in edits {
        desk.put(0, *address, bytes);
    }
    desk.command(DeviceCommand::WriteInto(other));
    wait_for_plan_rejection(desk);
    assert_eq!(desk.encoder().session.id, other);
}

fn wait_for_plan_rejection(desk: &mut Desk) {
    desk.until("it is refused", |studio| is_review(studio, |state| matches!(state, ReviewState::Failed { .. })));
    desk.until_ready();
}

/// Plans to write a commutation offset to another encoder, and permits its serial number and type.
fn plan_for_other_encoder(desk: &mut Desk, path: &std::path::Path) {
    plan_rejected_by_other_encoder(desk, path, &[(0, b"CO1"), (20, b"?")]);
    permit_other_encoder(desk);
    desk.until_planned();
}

/// Permits another serial number and then another type, because the other encoder is an SKS36.
fn permit_other_encoder(desk: &mut Desk) {
    desk.toggle(Permit::OtherDevice);
    wait_for_plan_rejection(desk);
    desk.toggle(Permit::TypeMismatch);
}

/// The review lists the values that depend on the mounting and must be set up again: before the write, at its end, and
/// after an interruption (issue 22.7).
#[test]
fn review_lists_mounting_dependent_values() {
    let (mut desk, path) = saved();
    plan_for_other_encoder(&mut desk, &path);
    let before = sheet(&desk);
    assert!(before.redo.is_none() && before.lines.is_empty(), "nothing of it is written yet");
    desk.toggle(Permit::Mounting);
    desk.until_planned();
    let with = sheet(&desk);
    let words = with.redo.clone().unwrap().to_string_in(Language::English);
    assert!(words.contains("commutation") && words.contains("field:0@0+3"), "{words}");
    assert!(matches!(with.stage, Stage::Ready(_)));
    desk.outside.wire(OTHER_PORT).hold_at(0x4B, 1);
    desk.write_as_shown();
    desk.outside.wire(OTHER_PORT).wait_until_held();
    assert_eq!(sheet(&desk).redo, with.redo);
    desk.outside.wire(OTHER_PORT).unplug();
    desk.outside.wire(OTHER_PORT).release();
    desk.until("it is cut off", |studio| {
        is_review(studio, |state| matches!(state, ReviewState::Failed { begun: true, .. }))
    });
    let cut = sheet(&desk);
    assert_eq!((cut.redo, cut.lines.len()), (with.redo, with.lines.len()));
    // The same write is completed without an interruption.
    let (mut desk, path) = saved();
    plan_for_other_encoder(&mut desk, &path);
    desk.toggle(Permit::Mounting);
    desk.until_planned();
    desk.write_as_shown();
    desk.until_written();
    assert!(matches!(sheet(&desk).stage, Stage::Done { .. }) && sheet(&desk).redo.is_some());
}

/// The review asks about bytes of unknown meaning and by default leaves them unchanged (issue 22.8).
#[test]
fn review_asks_about_unknown_bytes() {
    let (mut desk, path) = saved();
    plan_for_other_encoder(&mut desk, &path);
    let [question] = &sheet(&desk).questions[..] else { panic!() };
    assert_eq!((question.permit, question.is_on), (Permit::Copy(0), false));
    for text in [&question.title, &question.yes, &question.no] {
        crate::texts::check(text);
    }
    desk.toggle(Permit::Copy(0));
    desk.until_planned();
    let copied = sheet(&desk);
    assert!(copied.questions[0].is_on && !copied.lines.is_empty());
    let words = copied.redo.unwrap().to_string_in(Language::English);
    assert!(words.contains("commutation"), "{words}");
    desk.toggle(Permit::Copy(0));
    desk.until_planned();
    assert!(sheet(&desk).lines.is_empty() && sheet(&desk).redo.is_none());
}

/// The review names the other encoder type, which requires an explicit permission (issue 22.9).
#[test]
fn other_type_needs_permission() {
    let (mut desk, path) = saved();
    plan_rejected_by_other_encoder(&mut desk, &path, &[(0, b"X")]);
    desk.toggle(Permit::OtherDevice);
    wait_for_plan_rejection(&mut desk);
    let ReviewState::Failed { texts, .. } = &desk.review().state else { panic!() };
    assert_eq!(texts[0].id(), "plan.other_type");
    desk.toggle(Permit::TypeMismatch);
    desk.until_planned();
    assert!(sheet(&desk).warnings.iter().any(|text| text.id() == "review.other_type"));
}

/// The file states that the values are not current (issue 22.14).
#[test]
fn saves_values_after_line_loss() {
    let mut desk = Desk::connected_at_port("");
    let fields = desk.encoder().staged.device().to_vec();
    desk.put(0, 0, b"X");
    desk.wire().unplug();
    desk.until("it is lost", crate::losing::lost);
    assert!(desk.studio.selected_device().unwrap().is_savable());
    let path = desk.outside.path("lost.ron");
    desk.command(DeviceCommand::AskSave);
    assert!(matches!(desk.studio.take_file_question(), Some(FileQuestion::Save { .. })));
    desk.ask(Hiperface::Save(path.clone()));
    desk.until("it is saved", |_| path.exists());
    let document = ProfileDocument::parse(&read_text(&path).unwrap(), program().studio.formats).unwrap();
    assert!(document.note.as_ref().is_some_and(|note| note.contains("did not answer")), "{:?}", document.note);
    let profile = document.body.into_profile::<HiperfaceProfile>().unwrap();
    assert_eq!((profile.fields, &profile.identity.serial_number[..]), (fields, "GB0450179"), "without the edit");
    let told = |studio: &Studio| studio.services.log.notices().last().map(|own| own.texts.clone()).unwrap_or_default();
    desk.until("it is told", |studio| told(studio).iter().any(|text| text.id() == "session.saved_as_read"));
    assert!(told(&desk.studio).iter().any(|text| text.id() == "session.saved_without"));
    // If nothing has been read, there is nothing to save.
    let mut desk = Desk::fresh("");
    desk.open("serial:/dev/nothing");
    desk.until("it cannot be opened", crate::losing::lost);
    assert!(!desk.studio.selected_device().unwrap().is_savable());
}

/// The user types the path of an existing file.
#[test]
fn confirms_replacing_existing_file() {
    let mut desk = Desk::new_form("");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("kept.ron");
    std::fs::write(&path, "dear").unwrap();
    let session = desk.studio.hiperface().unwrap().session.id;
    let typed = |path: &std::path::Path| {
        Action::Typed(FileQuestion::Save { session, suggested: "x.ron".into() }, path.to_owned())
    };
    desk.act(typed(&path));
    desk.until("the question", |studio| studio.question.is_some());
    desk.act(Action::Escape);
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "dear");
    desk.act(typed(&path));
    desk.until("the question again", |studio| studio.question.is_some());
    desk.act(Action::Confirm);
    desk.until("it is saved", |_| std::fs::read_to_string(&path).unwrap() != "dear");
    // The file exists before the window knows that it has been written.
    desk.until("it is told", |studio| studio.services.log.notices().any(|own| own.texts[0].id() == "session.saved"));
    let new = folder.path().join("new.ron");
    desk.act(typed(&new));
    desk.until("a new file needs no question", |_| new.exists());
    assert!(desk.studio.question.is_none());
}

/// While the window is open, a relative path always refers to the same file, however it was entered (issue 22.24).
#[test]
fn relative_path_saves_to_same_file() {
    let (mut desk, path) = saved();
    let (work, home) = (desk.outside.path("work"), desk.outside.path("home"));
    for folder in [&work, &home] {
        fs::create_dir(folder).unwrap();
        fs::copy(&path, folder.join("rel.ron")).unwrap();
    }
    desk = desk.crash();
    desk.studio.start_with(None, Some("rel.ron".into()));
    desk.until("it is open", |studio| studio.hiperface().is_some());
    desk.settle();
    let rel = work.join("rel.ron");
    assert_eq!(desk.encoder().session.data_source(), rel.display().to_string());
    desk.command(DeviceCommand::AskSave);
    let question = desk.studio.take_file_question().unwrap();
    assert_eq!(question.suggested_path(), Some(rel.as_path()));
    desk.put(0, 0, b"X");
    desk.act(Action::Chosen(question, "rel.ron".into()));
    desk.until("it is saved", |studio| !studio.hiperface().unwrap().staged.is_dirty());
    assert_ne!(read_text(&rel).unwrap(), read_text(&path).unwrap());
    assert_eq!(read_text(&home.join("rel.ron")).unwrap(), read_text(&path).unwrap());

    // A dropped or typed path selects the existing session. The file in the home folder gets its own session.
    desk.act(Action::Open("./rel.ron".into()));
    desk.act(Action::Typed(FileQuestion::Open, "rel.ron".into()));
    desk.until("both were read", |studio| studio.files_being_opened().is_empty());
    assert_eq!(desk.studio.devices().len(), 1);
    desk.act(Action::Typed(FileQuestion::Open, "~/rel.ron".into()));
    desk.until("it is open", |studio| studio.devices().len() == 2);
    assert_eq!(desk.encoder().session.data_source(), home.join("rel.ron").display().to_string());
}

/// At the next start, the link refers to the same recording, whatever the current folder (issue 22.24).
#[test]
fn remembers_full_path_of_recording() {
    let mut desk = Desk::fresh("");
    desk.open("replay:monday.trace");
    let expected = format!("replay:{}", desk.outside.path("work").join("monday.trace").display());
    assert_eq!(desk.encoder().session.data_source(), expected);
}
