//! *Restore a profile…* and *Compare with a profile…*, for the device that is shown.

use std::fs;

use encoder_studio::app::review::Stage;
use encoder_studio::app::session::Phase;
use encoder_studio::app::{Action, DeviceCommand, FileQuestion, Severity, Studio};
use encoder_studio::devices::hiperface::state::HiperfaceAction as Hiperface;

use crate::screen::Screen;
use crate::support::Desk;

/// The connected encoder, and a profile of it in which the byte at address 0 of field 0 differs: E became X.
fn with_changed_profile() -> (Desk, std::path::PathBuf) {
    let mut desk = Desk::new_form("");
    let path = desk.outside.path("mine.ron");
    desk.ask(Hiperface::Save(path.clone()));
    desk.until("it is saved", |studio| studio.services.log.notices().any(|own| own.texts[0].id() == "session.saved"));
    desk.until_ready();
    let text = fs::read_to_string(&path).unwrap();
    let changed = text.replacen("\"45 4D 44", "\"58 4D 44", 1);
    assert_ne!(changed, text);
    fs::write(&path, changed).unwrap();
    (desk, path)
}

fn is_planned(studio: &Studio) -> bool {
    studio
        .selected_device()
        .and_then(|own| own.review_sheet())
        .is_some_and(|sheet| matches!(sheet.stage, Stage::Ready(_)))
}

fn compared(studio: &Studio) -> bool {
    studio.comparison().is_some()
}

#[test]
fn a_comparison_lists_what_differs_and_writes_nothing() {
    let (mut desk, path) = with_changed_profile();
    let session = desk.studio.selected_device().unwrap().id();
    let requests = desk.wire().count(0x4A);
    desk.command(DeviceCommand::AskCompare);
    let question = desk.studio.take_file_question().unwrap();
    assert_eq!(question, FileQuestion::Compare(session));
    desk.act(Action::Chosen(question, path.clone()));
    desk.until("it is compared", compared);
    let shown = desk.studio.comparison().unwrap();
    assert_eq!((shown.session(), shown.path()), (session, path.as_path()));
    let comparison = shown.comparison();
    let [difference] = comparison.differences.as_slice() else { panic!("{comparison:?}") };
    assert_eq!(
        (difference.item.as_str(), difference.left.as_str(), difference.right.as_str()),
        ("field:0@0+1", "45", "58")
    );
    assert_eq!(desk.wire().count(0x4A), requests, "nothing is read for it");
    desk.act(Action::Escape);
    assert!(!compared(&desk.studio));
    desk.command(DeviceCommand::Compare(path));
    desk.until("it is compared again", compared);
    desk.act(Action::CloseSession(session));
    assert!(!compared(&desk.studio), "it ends with its session");
}

#[test]
fn a_profile_that_is_chosen_to_be_restored_is_reviewed_first() {
    let (mut desk, path) = with_changed_profile();
    let session = desk.studio.selected_device().unwrap().id();
    desk.command(DeviceCommand::AskRestore);
    let question = desk.studio.take_file_question().unwrap();
    assert_eq!(question, FileQuestion::Restore(session));
    desk.act(Action::Chosen(question, path));
    desk.until("the review is open", |studio| studio.selected_device().is_some_and(|own| own.is_reviewing()));
    desk.until("it is planned", is_planned);
    assert_eq!(desk.wire().field(0)[0], b'E');
    assert_eq!(*desk.studio.selected_device().unwrap().phase(), Phase::Connected);
}

#[test]
fn incomparable_captures_are_reported_with_a_reason() {
    let (mut desk, _) = with_changed_profile();
    let profiles = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("profiles");
    for (path, id) in [
        (profiles.join("interbus/scaled-encoder.ron"), "profile.other_kind"),
        (desk.outside.path("missing.ron"), "file.not_found"),
    ] {
        desk.command(DeviceCommand::Compare(path));
        desk.until("it is told", |studio| {
            studio.services.log.current().is_some_and(|own| own.severity == Severity::Error)
        });
        let told = desk.studio.services.log.current().unwrap();
        assert_eq!(told.texts[0].id(), id);
        assert!(!compared(&desk.studio));
        desk.act(Action::Dismiss);
    }
}

#[test]
fn the_comparison_is_drawn_with_its_way_to_the_review() {
    let (desk, path) = with_changed_profile();
    let Desk { outside, studio, .. } = desk;
    let mut screen = Screen::of(outside, studio, [1024.0, 640.0]);
    screen.command(DeviceCommand::Compare(path));
    screen.until("it is compared", compared);
    assert!(screen.shows("field:0@0+1"));
    screen.click("comparison.restore");
    screen.until("it is planned", is_planned);
    assert!(!compared(screen.studio()));
}
