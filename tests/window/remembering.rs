//! Tests of settings that are remembered from one start to the next, and of an invalid settings file.

use std::fs;

use encoder_studio::app::{Action, ColorScheme, Language, ServerAction, Settings, Severity, Studio};
use encoder_studio::store::{ServerAddressError, ServerErrorKind, UserName};

use crate::support::{Desk, OTHER_PORT, PORT};

/// Waits until the file contains the studio's settings.
fn kept(desk: &mut Desk) {
    let path = desk.outside.store().settings_path();
    desk.until("the settings are kept", |studio| {
        let text = fs::read_to_string(&path).unwrap_or_default();
        Settings::parse(&text).as_ref() == Ok(&studio.settings)
    });
}

/// Restarts the program without changing any setting.
fn restarted(desk: Desk) -> Desk {
    let Desk { studio, outside } = desk;
    drop(studio);
    Desk { studio: outside.usual_studio(), outside }
}

#[test]
fn remembers_theme_language_layout_and_links() {
    let mut desk = Desk::new_form("");
    let first = (desk.studio.settings.theme, desk.studio.settings.language);
    assert_eq!(first, (ColorScheme::Dark, Language::English));
    desk.act(Action::SetTheme(ColorScheme::Light));
    desk.act(Action::SetLanguage(Language::German));
    desk.act(Action::KeepLayout("(a layout)".to_owned()));
    desk.act(Action::StoreWindowSize(1500, 900));
    for port in [PORT, OTHER_PORT] {
        desk.open(&format!("serial:{port}"));
        desk.until_read();
    }
    kept(&mut desk);
    let settings = desk.studio.settings.clone();
    let desk = desk.crash();
    assert_eq!(desk.studio.settings, settings);
    assert_eq!(
        settings.links_of(crate::tabs::HIPERFACE),
        [format!("serial:{OTHER_PORT}"), format!("serial:{PORT}"), "sim:".to_owned()]
    );
    assert_eq!(
        (settings.theme, settings.language, settings.size),
        (ColorScheme::Light, Language::German, Some((1500, 900)))
    );
    assert_eq!(settings.layout.as_deref(), Some("(a layout)"));
}

#[test]
fn does_not_remember_failed_link() {
    let mut desk = Desk::fresh("");
    desk.open("serial:/dev/nothing");
    desk.until("it is told", |studio| studio.services.log.notices().any(|own| own.severity == Severity::Error));
    assert_eq!(desk.notice_ids(Severity::Error), ["link.not_found"]);
    assert!(desk.studio.settings.links_of(crate::tabs::HIPERFACE).is_empty());
}

#[test]
fn keeps_broken_settings_until_change() {
    for broken in [b"(theme: Mauve, language: German)".as_slice(), b"\xFF\xFE", b""] {
        let desk = Desk::fresh("");
        let path = desk.outside.store().settings_path();
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(&path, broken).unwrap();
        let mut desk = restarted(desk);
        desk.settle();
        assert_eq!(desk.notice_ids(Severity::Warning), ["session.settings_broken"]);
        let aside = desk.outside.path("config/settings.ron.broken");
        let words = desk.studio.services.log.current().unwrap().texts[0].to_string_in(Language::English);
        assert!(words.contains(&path.display().to_string()) && words.contains(&aside.display().to_string()), "{words}");
        let language = if broken.starts_with(b"(") { Language::German } else { Language::English };
        let mut expected = Settings::initial(encoder_studio::kinds::program().studio);
        expected.language = language;
        // Unless the file says how the user is named in the logbook, the name is left out.
        expected.user_name = if broken.starts_with(b"(") { UserName::Full } else { UserName::Off };
        if !broken.starts_with(b"(") {
            expected.logbook = Settings::UNKNOWN_LOGBOOK.to_owned();
        }
        assert_eq!(desk.studio.settings, expected);
        assert_eq!(fs::read(&path).unwrap(), broken);
        desk.act(Action::SetTheme(ColorScheme::Light));
        kept(&mut desk);
        assert_eq!(fs::read(&aside).unwrap(), broken);
    }
}

/// A setting that could not be read may name a server, so write cycles of other benches may be missing.
#[test]
fn broken_settings_count_as_unreachable_server() {
    for broken in [b"(\n    logbook: postgres,\n)".as_slice(), b"(logbook: \"postgres://db.plant/logs\"", b"\xFF\xFE"] {
        let desk = Desk::fresh("");
        let path = desk.outside.store().settings_path();
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(&path, broken).unwrap();
        let mut desk = restarted(desk);
        let is_unknown = |studio: &Studio| {
            let unread = ServerErrorKind::Address(ServerAddressError::SettingsUnreadable);
            let exchange = studio.server_exchange();
            exchange.and_then(|own| own.contact.problem.as_ref()).is_some_and(|own| own.problem == unread)
        };
        desk.until("the server is unknown", is_unknown);
        // The next start must not take the rewritten file for one without a server.
        desk.act(Action::SetTheme(ColorScheme::Light));
        kept(&mut desk);
        let mut desk = restarted(desk);
        desk.until("the server is still unknown", is_unknown);
        desk.act(Action::Server(ServerAction::Save { address: String::new(), password: None }));
        assert!(desk.studio.server_exchange().is_none(), "the user has decided");
        kept(&mut desk);
        assert!(restarted(desk).studio.server_exchange().is_none());
    }
}

#[test]
fn server_form_hides_password_from_settings() {
    let desk = Desk::fresh("");
    let path = desk.outside.store().settings_path();
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    fs::write(&path, "(logbook: \"postgres://bench:k3y@db.plant/logs\")").unwrap();
    let mut desk = restarted(desk);
    desk.act(Action::Server(ServerAction::Open));
    let form = desk.studio.server_form().unwrap();
    assert_eq!((form.address(), form.password().is_some()), ("postgres://bench@db.plant/logs", true));
}

#[test]
fn does_not_overwrite_unreadable_settings() {
    let desk = Desk::fresh("");
    let path = desk.outside.store().settings_path();
    fs::create_dir_all(&path).unwrap();
    let mut desk = restarted(desk);
    assert_eq!(desk.notice_ids(Severity::Warning), ["session.settings_unread"]);
    desk.act(Action::SetTheme(ColorScheme::Light));
    desk.settle();
    assert!(path.is_dir());
    assert!(desk.studio.server_exchange().is_some(), "the settings may name a server of the logbook");
    assert_eq!(desk.notice_ids(Severity::Warning).len(), 1);
}

/// Settings loaded late apply, except for those that the user has changed in the meantime.
#[cfg(unix)]
#[test]
fn applies_settings_loaded_late() {
    let desk = Desk::fresh("");
    let path = desk.outside.store().settings_path();
    let mut settings = Settings::initial(encoder_studio::kinds::program().studio);
    (settings.theme, settings.size) = (ColorScheme::Light, Some((1500, 900)));
    settings.use_link(crate::tabs::HIPERFACE, "tcp:host:1");
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    assert!(std::process::Command::new("mkfifo").arg(&path).status().unwrap().success());
    let mut desk = restarted(desk);
    assert_eq!(desk.notice_ids(Severity::Warning), ["session.settings_slow"]);
    assert!(desk.studio.server_exchange().is_some(), "the settings may name a server of the logbook");
    desk.act(Action::SetLanguage(Language::German));
    desk.settle();
    assert!(!path.is_file(), "nothing was written in its place");
    fs::write(&path, settings.emit()).unwrap();
    fs::remove_file(&path).unwrap();
    desk.until("they are read", |studio| studio.settings.theme == ColorScheme::Light);
    assert!(desk.studio.services.log.current().is_none(), "they are here");
    assert!(desk.studio.server_exchange().is_none(), "they name no server");
    settings.language = Language::German;
    assert_eq!(desk.studio.settings, settings);
    kept(&mut desk);
}

#[test]
fn does_not_remember_virtual_access_codes() {
    let mut desk = Desk::fresh("codes=0:9D");
    desk.open("sim:?codes=0:9D&margin=21");
    desk.until_read();
    assert_eq!(desk.studio.settings.links_of(crate::tabs::HIPERFACE), ["sim:?margin=21"]);
    kept(&mut desk);
    let log = crate::support::log(&desk.studio);
    assert!(!log.contains("9D"), "{log}");
}

#[test]
fn reports_unwritable_settings_once() {
    let mut desk = Desk::fresh("");
    fs::write(desk.outside.path("config"), "a file in the way").unwrap();
    for theme in [ColorScheme::Light, ColorScheme::Dark, ColorScheme::Light] {
        desk.act(Action::SetTheme(theme));
        desk.until("it is told", |studio| studio.services.log.current().is_some());
        desk.settle();
    }
    assert_eq!(desk.notice_ids(Severity::Warning), ["session.settings_not_kept"]);
    desk.act(Action::Close);
    desk.until("it may close", |studio| studio.can_close());
}
