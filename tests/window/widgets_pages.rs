//! Tests that every page is drawn at both sizes, in both themes and languages, with all next steps in reach.

use crate::tabs::Tabs as _;
use egui::{Key, Rect, Role, Vec2};
use egui_kittest::kittest::Queryable;
use encoder_studio::app::DeviceCommand;
use encoder_studio::app::connect::ConnectAction as Connect;
use encoder_studio::app::session::Phase;
use encoder_studio::app::{Action, ColorScheme, FileQuestion, Language, Studio};
use encoder_studio::devices::hiperface::state::HiperfaceAction as Hiperface;
use encoder_studio::devices::hiperface::state::LinkForm;
use encoder_studio::devices::interbus::state::InterbusAction as Interbus;
use encoder_studio::devices::ssi::state::{Edit, Field, FieldInput, SsiAction as Ssi};

use crate::screen::Screen;
use crate::support::{GATE, HANGING_LINK, KIT, Outside, PORT};

const LARGE: [f32; 2] = [1280.0, 800.0];
const SMALL: [f32; 2] = [1024.0, 640.0];
const PANELS: [&str; 4] = ["panel.live", "panel.trace", "panel.jobs", "panel.log"];
const ALWAYS: [&str; 5] = ["shell.stop", "shell.connect", "shell.open", "shell.help", "shell.language"];

/// Draws every page and panel in both themes and languages.
fn check_every_page(screen: &mut Screen, size: [f32; 2]) {
    let window = Rect::from_min_size(egui::Pos2::ZERO, Vec2::from(size));
    for language in [Language::English, Language::German] {
        for theme in [ColorScheme::Dark, ColorScheme::Light] {
            screen.act(Action::SetLanguage(language));
            screen.act(Action::SetTheme(theme));
            for page in encoder_studio::kinds::program().tabs.page_text_ids(screen.studio().settings.tab) {
                screen.click(page);
                screen.check_language();
                for id in ALWAYS {
                    let place = screen.button(id).rect();
                    assert!(window.contains_rect(place), "{id} at {place:?} on {page} in {language:?}");
                }
            }
            screen.act(Action::OpenLowerPanel(true));
            for panel in PANELS {
                let label = screen.say(panel);
                let tab = screen.harness.query_all_by_label(&label).next();
                tab.unwrap_or_else(|| panic!("there is no tab {label:?}")).click();
                screen.steps();
                screen.check_language();
            }
            screen.act(Action::OpenLowerPanel(false));
        }
    }
}

#[test]
fn draws_pages_with_virtual_encoder() {
    for size in [LARGE, SMALL] {
        check_every_page(&mut Screen::new_form(size), size);
    }
}

#[test]
fn draws_pages_with_virtual_biss_encoder() {
    for (link, size) in [("sim:?bridge=on", LARGE), ("sim:?errors=0x12&temperature=120", SMALL)] {
        let mut screen = Screen::open_in_tab(crate::tabs::BISS, link, size);
        screen.until("it is read", |studio| {
            studio.biss().is_some_and(|own| own.session.is_ready() && own.survey.is_some())
        });
        check_every_page(&mut screen, size);
    }
}

/// Values written in mode 04 but never saved are reported above the registers and the data, with a button that returns
/// to operation (issue 22.15).
#[test]
fn unsaved_registers_name_remedy() {
    let outside = Outside::new("");
    outside.wire(KIT).enter(&[("0x6B", 0x2A), ("0x6A", 0x04), ("0x00:0x1A", 0x02), ("0x24:0x10", 0x5A)]);
    let mut studio = outside.studio();
    studio.settings.tab = crate::tabs::BISS;
    studio.start_with(Some(format!("serial:{KIT}").parse().unwrap()), None);
    let mut screen = Screen::of(outside, studio, SMALL);
    let is_read = |studio: &Studio| studio.biss().is_some_and(|own| own.session.is_ready() && own.survey.is_some());
    screen.until("the encoder is read", is_read);
    for page in ["page.registers", "page.data"] {
        screen.click(page);
        // The page may read the data that it shows.
        screen.until("nothing runs", is_read);
        assert!(screen.shows("The encoder is in device mode 0x04"), "{page}");
        assert!(screen.is_enabled("lead_back_card.button"), "{page}");
    }
    screen.act(Action::SetLanguage(Language::German));
    assert!(screen.shows("Der Geber ist im Gerätemodus 0x04"));
    screen.check_language();
    screen.click("lead_back_card.button");
    screen.until("it is back", |studio| is_read(studio) && studio.biss().unwrap().unsaved_warning().is_none());
    assert!(
        screen.shows("Der Geber war im Gerätemodus 0x04 Schreiben von OEM- und Motordaten. Er ist wieder im Betrieb")
    );
    assert!(!screen.shows("ist im Gerätemodus 0x04") && !screen.shows("im Gerätemodus 0x04, nicht"));
    assert!(!screen.has_button("lead_back_card.button"));
}

/// If an encoder rejects a position request, the Live panel shows a message and fits into a small window.
#[test]
fn rejected_position_keeps_panel_in_window() {
    let mut screen = Screen::opened(Outside::new("temperature=140&rpm=9000"), None, SMALL);
    screen
        .until("the encoder is read", |studio| studio.hiperface().is_some_and(|own| own.record.is_position_refused()));
    screen.act(Action::SetLanguage(Language::German));
    let large = screen.button("recorder.large").rect();
    let window = Rect::from_min_size(egui::Pos2::ZERO, Vec2::from(SMALL));
    assert!(window.contains_rect(large), "{large:?}");
}

#[test]
fn draws_pages_with_virtual_ssi_encoder() {
    for (link, size) in [("sim:?ssi=afm60,code=gray&rpm=6", LARGE), ("sim:?ssi=kh53&ssi-error=overspeed-or-gap", SMALL)]
    {
        let mut screen = Screen::open_in_tab(crate::tabs::SSI, link, size);
        screen.until("a word is read", |studio| studio.ssi().is_some_and(|own| own.last().is_some()));
        let id = screen.studio().ssi().unwrap().session.id;
        screen.act(Action::device(id, Ssi::Check));
        screen.until("it is checked", |studio| studio.ssi().unwrap().check.is_some());
        check_every_page(&mut screen, size);
    }
}

#[test]
fn draws_pages_with_virtual_interbus_encoder() {
    for (link, size) in [("sim:?steps=3600&revolutions=1&cams=demo&rpm=6", LARGE), ("sim:?program=3&cams=demo", SMALL)]
    {
        let mut screen = Screen::open_in_tab(crate::tabs::INTERBUS, link, size);
        screen.until("it is read", |studio| {
            studio.interbus().is_some_and(|own| own.known_program_count() == 8 && own.session.is_ready())
        });
        let id = screen.studio().interbus().unwrap().session.id;
        screen.act(Action::device(id, Interbus::Check));
        screen.until("it is checked", |studio| studio.interbus().unwrap().check.is_some());
        check_every_page(&mut screen, size);
    }
}

#[test]
fn draws_pages_before_standstill_confirmation() {
    let mut screen = Screen::open_in_tab(crate::tabs::INTERBUS, &format!("modbus:{GATE}"), SMALL);
    screen.until("a word is read", |studio| studio.interbus().is_some_and(|own| own.record.last().is_some()));
    check_every_page(&mut screen, SMALL);
}

#[test]
fn draws_pages_of_ssi_layout() {
    let mut screen = Screen::opened(Outside::new(""), Some("serial:/dev/nothing"), SMALL);
    screen.act(Action::ShowTab(crate::tabs::SSI));
    check_every_page(&mut screen, SMALL);
    // The frame belongs to no family and has all optional parts.
    let id = screen.studio().ssi().unwrap().session.id;
    screen.act(Action::device(id, Ssi::Edit(Box::new(Edit::Free))));
    for action in [
        Ssi::AddErrorBit,
        Ssi::AddErrorBit,
        Ssi::Enter(Field::Parity, FieldInput::Choice(1)),
        Ssi::Enter(Field::Repeat, FieldInput::Switch(true)),
        Ssi::Enter(Field::Singleturn, FieldInput::Number(99)),
    ] {
        screen.act(Action::device(id, action));
    }
    assert_eq!(screen.studio().ssi().unwrap().clock_count(), 61);
    check_every_page(&mut screen, SMALL);
}

#[test]
fn draws_pages_with_missing_biss_encoder() {
    let mut screen = Screen::open_in_tab(crate::tabs::BISS, "serial:/dev/nothing", SMALL);
    screen.until("it is told", |studio| studio.biss().is_some_and(|own| matches!(own.session.phase, Phase::Lost(_))));
    check_every_page(&mut screen, SMALL);
}

#[test]
fn draws_pages_without_device() {
    let mut screen = Screen::opened(Outside::new(""), Some("serial:/dev/nothing"), SMALL);
    screen.until("it is told", |studio| matches!(studio.hiperface().unwrap().session.phase, Phase::Lost(_)));
    check_every_page(&mut screen, SMALL);
    assert!(screen.has_button("shell.reconnect"));
    let id = screen.encoder().session.id;
    screen.act(Action::CloseSession(id));
    screen.act(Action::Dismiss);
    assert!(screen.studio().hiperface().is_none());
    assert!(screen.shows(&screen.say("shell.empty")));
}

#[test]
fn draws_pages_while_link_opens() {
    let mut screen = Screen::opened(Outside::new(""), Some(HANGING_LINK), SMALL);
    check_every_page(&mut screen, SMALL);
    assert!(screen.shows(&screen.say("shell.opening")));
}

#[test]
fn draws_pages_with_all_values() {
    let mut screen = Screen::opened(Outside::new("model=sel37&rpm=60"), None, LARGE);
    let ready = |studio: &encoder_studio::app::Studio| {
        studio.hiperface().is_some_and(|encoder| encoder.session.is_ready() && encoder.identity.is_some())
    };
    screen.until("it is read", ready);
    for action in [
        Hiperface::Check { restart: true },
        Hiperface::ReadAnalogue(0x48),
        Hiperface::ReadAnalogue(0x07),
        Hiperface::Put { field: 0, address: 3, bytes: vec![1, 2, 3] },
    ] {
        screen.ask(action);
        screen.until("it is done", ready);
    }
    screen.command(DeviceCommand::Poll(Some(std::time::Duration::from_millis(5))));
    check_every_page(&mut screen, LARGE);
    assert!(screen.encoder().record.position_count() > 2);
    screen.click("shell.stop");
    assert!(!screen.studio().is_live());
}

#[test]
fn draws_pages_of_profile() {
    let outside = Outside::new("");
    let mut screen = Screen::opened(outside, Some(&format!("serial:{PORT}")), SMALL);
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("profiles/hiperface");
    let path = screen.outside.path("mine.ron");
    std::fs::copy(folder.join("multiturn-skm36.ron"), &path).unwrap();
    screen.act(Action::Open(path));
    screen.until("it is open", |studio| studio.devices().len() == 2);
    check_every_page(&mut screen, SMALL);
    assert!(screen.shows(&screen.say("shell.offline")));
}

#[test]
fn escape_closes_connect_dialog() {
    for size in [LARGE, SMALL] {
        let mut screen = Screen::new_form(size);
        screen.click("shell.connect");
        assert!(screen.studio().connect.is_some());
        assert!(screen.shows(&screen.say("connect.title")));
        for kind in ["connect.serial", "connect.tcp", "connect.replay", "connect.virtual"] {
            screen.click(kind);
            if kind != "connect.replay" {
                screen.click("connect.more");
            }
            screen.check_language();
        }
        screen.act(Action::SetLanguage(Language::German));
        screen.check_language();
        assert!(screen.shows(&screen.say("connect.title")));
        screen.click("connect.serial");
        assert!(!screen.is_enabled("connect.connect"), "there is no port in it");
        assert!(screen.shows(&screen.say("form.port_missing")));
        screen.harness.get_by_role_and_label(Role::TextInput, &screen.say("connect.link")).focus();
        screen.steps();
        screen
            .harness
            .get_by_role_and_label(Role::TextInput, &screen.say("connect.link"))
            .type_text("serial:/dev/enc7");
        screen.steps();
        assert!(screen.is_enabled("connect.connect"));
        assert_eq!(screen.studio().connect.as_ref().unwrap().form_as::<LinkForm>().unwrap().port, "/dev/enc7");
        screen.key(Key::Escape);
        assert!(screen.studio().connect.is_none());
        assert!(!screen.shows(&screen.say("connect.title")));
    }
}

#[test]
fn clicks_start_search_and_choose_result() {
    let mut screen = Screen::opened(Outside::new("address=0x44"), None, LARGE);
    screen.act(Action::Connect(Connect::Open));
    screen.act(Action::Connect(Connect::Use(format!("serial:{PORT}"))));
    screen.click("find.start");
    screen.until("it is over", |studio| {
        let search = studio.connect.as_ref().and_then(|dialog| crate::tabs::search(dialog));
        search.is_some_and(|search| !search.is_running())
    });
    let choose = screen.words(&crate::texts::text("find.choose").with("address", "44h"));
    screen.harness.get_by_label(&choose).click();
    screen.until("it is read", |studio| {
        studio.hiperface().and_then(|encoder| encoder.identity.as_ref()).is_some_and(|own| own.address == 0x44)
    });
}

#[test]
fn f1_opens_and_escape_closes_help() {
    let mut screen = Screen::new_form(SMALL);
    for (page, help) in encoder_studio::kinds::program().tabs.page_text_ids(crate::tabs::HIPERFACE).into_iter().zip([
        "help.encoder",
        "help.memory",
        "help.values",
        "help.setup",
        "help.commutation",
        "help.backups",
    ]) {
        screen.click(page);
        screen.key(Key::F1);
        assert!(screen.shows(&screen.say(help)), "{page}");
        screen.key(Key::Escape);
        assert!(!screen.shows(&screen.say(help)), "{page}");
    }
    screen.click("shell.about");
    assert!(screen.shows(env!("CARGO_PKG_VERSION")));
    screen.key(Key::Escape);
    assert!(!screen.has_button("about.close"));
}

#[test]
fn one_click_changes_language_and_theme() {
    let mut screen = Screen::new_form(LARGE);
    let pages = encoder_studio::kinds::program().tabs.page_text_ids(crate::tabs::HIPERFACE);
    let english: Vec<String> = pages.iter().map(|page| screen.say(page)).collect();
    screen.click("shell.language");
    assert_eq!(screen.studio().settings.language, Language::German);
    for (page, english) in pages.into_iter().zip(english) {
        assert!(screen.has_button(page));
        assert_ne!(screen.say(page), english);
    }
    screen.click("shell.language");
    assert_eq!(screen.studio().settings.language, Language::English);
    screen.click("shell.light");
    assert_eq!(screen.studio().settings.theme, ColorScheme::Light);
    screen.click("shell.dark");
    assert_eq!(screen.studio().settings.theme, ColorScheme::Dark);
}

/// The system has no file dialogs.
#[test]
fn accepts_typed_path_without_file_dialog() {
    let mut screen = Screen::new_form(SMALL);
    let session = screen.encoder().session.id;
    for question in [FileQuestion::Open, FileQuestion::Save { session, suggested: "x.ron".into() }] {
        screen.act(Action::TypePath(question));
        assert!(screen.has_button("file.cancel"));
        screen.key(Key::Escape);
        assert!(!screen.has_button("file.cancel"));
    }
}
