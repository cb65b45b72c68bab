//! Tests of the command palette: Ctrl+K, a few letters, and Enter.

use egui::{Event, Key, Modifiers};
use egui_kittest::kittest::Queryable;
use encoder_studio::app::session::Phase;
use encoder_studio::app::{Action, Language, Tab};

use crate::screen::Screen;
use crate::support::PORT;
use crate::tabs::{BISS, Tabs as _};

const SIZE: [f32; 2] = [1024.0, 640.0];

fn open(screen: &mut Screen) {
    screen.harness.key_press_modifiers(Modifiers::COMMAND, Key::K);
    screen.steps();
    assert!(is_open(screen));
}

fn is_open(screen: &Screen) -> bool {
    screen.harness.query_by_label(&screen.say("palette.hint")).is_some()
}

fn type_text(screen: &mut Screen, text: &str) {
    screen.harness.event(Event::Text(text.to_owned()));
    screen.steps();
}

fn find_and_choose(screen: &mut Screen, text: &str) {
    open(screen);
    type_text(screen, text);
    screen.key(Key::Enter);
    screen.steps();
}

#[test]
fn finds_pages_devices_and_settings() {
    let mut screen = Screen::new_form(SIZE);
    find_and_choose(&mut screen, "memo");
    assert!(!is_open(&screen));
    assert!(screen.has_button("memory.review"), "the page Memory is open");
    find_and_choose(&mut screen, "biss");
    assert_eq!(screen.studio().settings.tab, BISS);
    find_and_choose(&mut screen, "deutsch");
    assert_eq!(screen.studio().settings.language, Language::German);
    find_and_choose(&mut screen, "speicher skm");
    assert_eq!(screen.studio().settings.tab, Tab::named("Hiperface"));
    assert!(screen.has_button("memory.review"));
}

/// A page is found by its German name in an English window, and by its English name in a German window.
#[test]
fn finds_names_in_both_languages() {
    let mut screen = Screen::new_form(SIZE);
    find_and_choose(&mut screen, "kommutierung");
    assert!(screen.has_button("commutation.read_one"), "the page Commutation is open");
    screen.act(Action::SetLanguage(Language::German));
    find_and_choose(&mut screen, "set-up");
    assert!(screen.has_button("position_card.plan"), "the page Set-up is open");
}

#[test]
fn executes_actions_of_shown_device() {
    let mut screen = Screen::new_form(SIZE);
    let before = screen.outside.wire(PORT).count(0x56);
    find_and_choose(&mut screen, "read again");
    screen.until("it is read", |studio| studio.hiperface().unwrap().session.is_ready());
    assert_eq!(screen.outside.wire(PORT).count(0x56), before + 1);
    find_and_choose(&mut screen, "check the device");
    screen.until("it is checked", |studio| studio.hiperface().is_some_and(|own| own.check.is_some()));
    assert_eq!(*screen.studio().selected_device().unwrap().phase(), Phase::Connected);
}

#[test]
fn disabled_actions_and_no_match_do_nothing() {
    let mut screen = Screen::new_form(SIZE);
    for typed in ["discard edits", "xyzzy"] {
        find_and_choose(&mut screen, typed);
        assert!(is_open(&screen), "{typed}");
        screen.key(Key::Escape);
        assert!(!is_open(&screen), "{typed}");
    }
}

#[test]
fn arrows_select_and_escape_closes() {
    let mut screen = Screen::new_form(SIZE);
    open(&mut screen);
    // The commands for the languages and themes are listed one below the other.
    type_text(&mut screen, "theme");
    screen.key(Key::ArrowDown);
    screen.key(Key::ArrowUp);
    let theme = screen.studio().settings.theme;
    screen.key(Key::Enter);
    screen.steps();
    assert_ne!(screen.studio().settings.theme, theme);
    open(&mut screen);
    screen.key(Key::Escape);
    assert!(!is_open(&screen));
}

#[test]
fn dialog_keeps_palette_closed() {
    let mut screen = Screen::new_form(SIZE);
    screen.click("shell.connect");
    screen.harness.key_press_modifiers(Modifiers::COMMAND, Key::K);
    screen.steps();
    assert!(!is_open(&screen));
    screen.act(Action::Escape);
}
