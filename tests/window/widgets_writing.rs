//! Tests of writing a byte with the real widgets: editing, review, write and read-back, with STOP and the questions.

use crate::tabs::Tabs as _;
use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;
use encoder_studio::app::DeviceCommand;
use encoder_studio::app::session::Phase;
use encoder_studio::app::{Action, Language, PendingEdits};
use encoder_studio::devices::hiperface::state::{HiperfaceAction as Hiperface, ReviewState};

use crate::screen::Screen;
use crate::support::{Outside, PORT, is_review};

const SIZE: [f32; 2] = [1280.0, 800.0];

/// Types digits into the hex editor of data field 0.
fn type_bytes(screen: &mut Screen, digits: &str) {
    screen.click("page.memory");
    let editor = screen.words(&crate::texts::text("memory.bytes").with("number", 0));
    screen.harness.get_by_label(&editor).focus();
    screen.steps();
    for digit in digits.chars() {
        screen.harness.get_by_label(&editor).type_text(&digit.to_string());
        screen.steps();
    }
}

#[test]
fn types_reviews_and_writes_byte() {
    let mut screen = Screen::new_form(SIZE);
    screen.click("page.memory");
    assert!(!screen.is_enabled("memory.review"), "nothing is edited");
    type_bytes(&mut screen, "58");
    assert_eq!(screen.encoder().staged.edited_bytes().collect::<Vec<_>>(), [(0, 0, 0x58)]);
    assert_eq!(screen.outside.wire(PORT).field(0)[0], b'E');

    screen.click("memory.review");
    screen.until("the plan is ready", |studio| is_review(studio, |state| matches!(state, ReviewState::Ready(_))));
    let byte = screen.words(&crate::texts::text("op.byte").with("field", 0).with("first", 0));
    for words in [byte.as_str(), "45  →  58"] {
        screen.harness.query_all_by_label(words).next().unwrap_or_else(|| panic!("{words} is not in the review"));
    }
    assert_eq!(screen.outside.wire(PORT).wear(), 0);
    for language in [Language::German, Language::English] {
        screen.act(Action::SetLanguage(language));
        screen.check_language();
    }
    screen.click("review.write");
    screen.until("it is written", |studio| {
        is_review(studio, |state| matches!(state, ReviewState::Done(..)))
            && studio.hiperface().unwrap().session.is_ready()
    });
    let verified = crate::texts::text("review.verified").with("verified", 1).with("cycles", 1);
    assert!(screen.shows(&screen.words(&verified)));
    assert_eq!(screen.outside.wire(PORT).field(0)[0], 0x58);
    screen.click("review.close");
    assert!(screen.encoder().session.review.is_none() && !screen.encoder().staged.is_dirty());
    let editor = screen.words(&crate::texts::text("memory.bytes").with("number", 0));
    // The cursor is after the typed byte.
    assert!(screen.harness.get_by_label(&editor).value().unwrap().starts_with("0x01: 4D"));
}

#[test]
fn escape_closes_review_without_writing() {
    let mut screen = Screen::new_form(SIZE);
    type_bytes(&mut screen, "58");
    screen.harness.key_press_modifiers(Modifiers::COMMAND, Key::Enter);
    screen.until("the plan is ready", |studio| {
        is_review(studio, |state| matches!(state, ReviewState::Ready(_)))
            && studio.hiperface().unwrap().session.is_ready()
    });
    screen.key(Key::Escape);
    assert!(screen.encoder().session.review.is_none());
    assert!(screen.encoder().staged.is_dirty());
    assert_eq!(screen.outside.wire(PORT).wear(), 0);
    screen.click("memory.undo");
    assert!(!screen.encoder().staged.is_dirty());
    screen.click("memory.redo");
    screen.click("memory.revert");
    assert!(!screen.encoder().staged.is_dirty());
}

/// Previously, Enter was ignored right after another key, even if that was Ctrl. Ctrl+Enter therefore did nothing in
/// the hex editor, which is not a text entry (issue 26).
#[test]
fn ctrl_enter_opens_review() {
    let mut screen = Screen::new_form(SIZE);
    type_bytes(&mut screen, "58");
    for _ in 0..8 {
        screen.harness.step();
    }
    let event =
        |key, pressed, modifiers| egui::Event::Key { key, physical_key: None, pressed, repeat: false, modifiers };
    screen.harness.event(event(Key::ControlLeft, true, Modifiers::NONE));
    screen.harness.event(event(Key::Enter, true, Modifiers::COMMAND));
    screen.harness.event(event(Key::Enter, false, Modifiers::COMMAND));
    screen.until("the plan is ready", |studio| is_review(studio, |state| matches!(state, ReviewState::Ready(_))));
    assert_eq!(screen.outside.wire(PORT).wear(), 0, "nothing is written yet");
}

/// A write that needs a permission cannot be started without it (issue 22.4).
#[test]
fn write_button_without_logbook_needs_permission() {
    let mut screen = Screen::new_form(SIZE);
    let logbook = screen.outside.store().logbook_path();
    // The logbook exists because the connection is already recorded.
    std::fs::remove_file(&logbook).unwrap();
    std::fs::create_dir_all(logbook).unwrap();
    type_bytes(&mut screen, "58");
    screen.harness.key_press_modifiers(Modifiers::COMMAND, Key::Enter);
    screen.until("the plan is ready", |studio| {
        is_review(studio, |state| matches!(state, ReviewState::Ready(_)))
            && studio.hiperface().unwrap().session.is_ready()
    });
    assert!(!screen.is_enabled("review.write"));
    screen.ask(Hiperface::ForceWear(true));
    assert!(screen.is_enabled("review.write"));
}

#[test]
fn disables_actions_disallowed_by_field() {
    let mut screen = Screen::new_form(SIZE);
    screen.click("page.memory");
    assert!(screen.is_enabled("memory.delete"), "it is the last");
    let size = encoder_studio::devices::hiperface::protocol::FieldSize::from_bytes(16).unwrap();
    let code = encoder_studio::devices::hiperface::protocol::AccessCodeNumber::ZERO;
    let status = encoder_studio::devices::hiperface::state::forms::new_field(size, code, true);
    let create = encoder_studio::devices::hiperface::jobs::Change::CreateField { number: 1, status };
    screen.ask(Hiperface::Plan(create));
    screen.until("the plan is ready", |studio| is_review(studio, |state| matches!(state, ReviewState::Ready(_))));
    screen.click("review.write");
    screen.until("it is written", |studio| studio.hiperface().unwrap().staged.device().len() == 2);
    screen.click("review.close");
    assert!(!screen.is_enabled("memory.delete") && !screen.is_enabled("memory.resize"), "another one is the last now");
    screen.click("memory.lock");
    screen.until("the plan is ready", |studio| is_review(studio, |state| matches!(state, ReviewState::Ready(_))));
    screen.click("review.write");
    screen.until("it is written", |studio| {
        is_review(studio, |state| matches!(state, ReviewState::Done(..)))
            && studio.hiperface().unwrap().session.is_ready()
    });
    screen.click("review.close");
    type_bytes(&mut screen, "58");
    assert!(!screen.encoder().staged.is_dirty());
    assert!(screen.shows(&screen.words(&crate::texts::text("plan.write_protected").with("field", 0))));
}

#[test]
fn enables_stop_only_during_job() {
    let mut screen = Screen::new_form(SIZE);
    assert!(!screen.is_enabled("shell.stop"));
    screen.outside.wire(PORT).hold_at(0x46, 1);
    screen.ask(Hiperface::ReadCounter);
    screen.outside.wire(PORT).wait_until_held();
    screen.steps();
    assert!(screen.is_enabled("shell.stop"));
    screen.click("shell.stop");
    assert!(screen.encoder().session.live_session().unwrap().running_job().unwrap().stopping);
    screen.outside.wire(PORT).release();
    screen.until("it has ended", |studio| studio.hiperface().unwrap().session.is_ready());
    assert!(!screen.is_enabled("shell.stop"));
    screen.click("live.start");
    assert!(screen.is_enabled("shell.stop") && screen.studio().is_live());
    screen.click("shell.stop");
    assert!(!screen.is_enabled("shell.stop") && !screen.studio().is_live());
}

#[test]
fn click_stops_restore() {
    let mut screen = Screen::new_form(SIZE);
    for address in [0, 2, 4] {
        let edit = Hiperface::Put { field: 0, address, bytes: vec![0] };
        screen.ask(edit);
    }
    screen.command(DeviceCommand::Review);
    screen.until("the plan is ready", |studio| {
        is_review(studio, |state| matches!(state, ReviewState::Ready(_)))
            && studio.hiperface().unwrap().session.is_ready()
    });
    screen.outside.wire(PORT).hold_at(0x4B, 2);
    screen.click("review.write");
    screen.outside.wire(PORT).wait_until_held();
    screen.steps();
    assert!(screen.shows(&screen.say("shell.writing")));
    screen.click("shell.cancel");
    screen.outside.wire(PORT).release();
    screen.until("it has ended", |studio| {
        is_review(studio, |state| matches!(state, ReviewState::Failed { begun: true, .. }))
            && studio.hiperface().unwrap().session.is_ready()
    });
    let words = crate::texts::text("write.cancelled").with("done", 2).with("planned", 3);
    assert!(screen.shows(&screen.words(&words)));
    screen.click("review.close");
    assert_eq!(screen.encoder().staged.edited_bytes().collect::<Vec<_>>(), [(0, 4, 0)]);
}

#[test]
fn pulled_cable_offers_reconnect() {
    let mut screen = Screen::opened(Outside::new(""), Some(&format!("serial:{PORT}")), SIZE);
    screen.until("it is read", |studio| {
        studio.hiperface().is_some_and(|own| own.session.is_ready() && own.identity.is_some())
    });
    type_bytes(&mut screen, "58");
    screen.outside.wire(PORT).unplug();
    screen.until("it is lost", |studio| matches!(studio.hiperface().unwrap().session.phase, Phase::Lost(_)));
    assert!(screen.shows(&screen.say("shell.edits_kept")) && screen.shows(&screen.say("shell.lost")));
    assert!(!screen.is_enabled("memory.review"));
    screen.outside.wire(PORT).plug();
    screen.click("shell.reconnect");
    screen.until("it is read", |studio| studio.hiperface().unwrap().session.is_ready());
    assert!(screen.is_enabled("memory.review"));
    assert_eq!(screen.encoder().staged.edited_bytes().collect::<Vec<_>>(), [(0, 0, 0x58)]);
}

#[test]
fn can_decline_closing_with_edits() {
    let mut screen = Screen::new_form(SIZE);
    type_bytes(&mut screen, "58");
    screen.act(Action::Close);
    assert!(screen.shows(&screen.words(&screen.studio().question.as_ref().unwrap().text)));
    screen.click("question.stay");
    assert!(screen.studio().question.is_none() && !screen.studio().can_close());
    screen.act(Action::Close);
    screen.click("question.close_window");
    screen.until("it may close", |studio| studio.can_close());
}

#[test]
fn notice_stays_until_dismissed() {
    let mut screen = Screen::new_form(SIZE);
    screen.act(Action::Open(screen.outside.path("none.ron")));
    screen.until("it is told", |studio| studio.services.log.current().is_some());
    screen.click("shell.dismiss");
    assert!(screen.studio().services.log.current().is_none() && !screen.has_button("shell.dismiss"));
}
