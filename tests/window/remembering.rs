//! What is remembered from one start to the next, and a file of it that is broken.

use std::fs;

use encoder_studio::app::{Action, Language, Settings, Severity, Theme};

use crate::support::{Desk, OTHER_PORT, PORT};

/// Waits until the file says what the studio has.
fn kept(desk: &mut Desk) {
    let path = desk.outside.store().settings_path();
    desk.until("the settings are kept", |studio| {
        let text = fs::read_to_string(&path).unwrap_or_default();
        Settings::parse(&text).as_ref() == Some(&studio.settings)
    });
}

#[test]
fn looks_language_layout_and_links_survive() {
    let mut desk = Desk::begun("");
    let first = (desk.studio.settings.theme, desk.studio.settings.language);
    assert_eq!(first, (Theme::Dark, Language::English));
    desk.act(Action::SetTheme(Theme::Light));
    desk.act(Action::SetLanguage(Language::German));
    desk.act(Action::KeepLayout("(a layout)".to_owned()));
    desk.act(Action::KeepSize(1500, 900));
    for port in [PORT, OTHER_PORT] {
        desk.open(&format!("serial:{port}"));
        desk.until_read();
    }
    kept(&mut desk);
    let settings = desk.studio.settings.clone();
    let desk = desk.crash();
    assert_eq!(desk.studio.settings, settings);
    assert_eq!(settings.links(), [format!("serial:{OTHER_PORT}"), format!("serial:{PORT}"), "sim:".to_owned()]);
    assert_eq!((settings.theme, settings.language, settings.size), (Theme::Light, Language::German, Some((1500, 900))));
    assert_eq!(settings.layout.as_deref(), Some("(a layout)"));
}

#[test]
fn a_link_that_did_not_open_is_not_remembered() {
    let mut desk = Desk::fresh("");
    desk.open("serial:/dev/nothing");
    desk.until("it is told", |studio| studio.services.log.notices().any(|own| own.severity == Severity::Error));
    assert_eq!(desk.told(Severity::Error), ["link.not_found"]);
    assert!(desk.studio.settings.links().is_empty());
}

#[test]
fn broken_settings_are_told_and_left_until_something_changes() {
    for broken in [b"(theme: Mauve)".as_slice(), b"\xFF\xFE", b""] {
        let desk = Desk::fresh("");
        let path = desk.outside.store().settings_path();
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(&path, broken).unwrap();
        let mut desk = desk.crash();
        desk.settle();
        assert_eq!(desk.told(Severity::Warning).len(), 1);
        assert_eq!(desk.studio.settings, Settings::default());
        assert_eq!(fs::read(&path).unwrap(), broken);
        desk.act(Action::SetTheme(Theme::Light));
        kept(&mut desk);
    }
}

#[test]
fn settings_that_cannot_be_kept_are_told_once() {
    let mut desk = Desk::fresh("");
    fs::write(desk.outside.path("config"), "a file in the way").unwrap();
    for theme in [Theme::Light, Theme::Dark, Theme::Light] {
        desk.act(Action::SetTheme(theme));
        desk.until("it is told", |studio| studio.services.log.standing().is_some());
        desk.settle();
    }
    assert_eq!(desk.told(Severity::Warning), ["session.settings_not_kept"]);
    desk.act(Action::Close);
    desk.until("it may close", |studio| studio.may_close());
}
