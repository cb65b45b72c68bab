//! Tests of the logbook server form, and of the line on the page that shows whether entries are shared.

use std::net::TcpListener;

use egui::accesskit::Role;
use egui_kittest::kittest::Queryable;
use encoder_studio::app::{Action, LOGBOOK_TAB, Language, ServerAction, Studio};

use crate::screen::Screen;
use crate::support::Desk;

const SIZE: [f32; 2] = [1024.0, 640.0];
/// A port on which no server listens. It is reserved for system services.
const CLOSED: &str = "postgres://bench@127.0.0.1:1/logs";

fn type_into(screen: &mut Screen, label: &'static str, text: &str) {
    let word = screen.say(label);
    screen.harness.get_by_role_and_label(Role::TextInput, &word).focus();
    screen.steps();
    screen.harness.get_by_role_and_label(Role::TextInput, &word).type_text(text);
    screen.steps();
}

fn is_server_unreachable(studio: &Studio) -> bool {
    studio.server_exchange().is_some_and(|exchange| exchange.contact.problem.is_some())
}

#[test]
fn enters_tests_and_saves_server() {
    let mut screen = Screen::new_form(SIZE);
    screen.act(Action::ShowTab(LOGBOOK_TAB));
    screen.until("the logbook is read", |studio| studio.logbook().matches().is_some());
    assert!(screen.shows(&screen.say("logbook.local")));
    screen.click("logbook.share");
    for language in [Language::German, Language::English] {
        screen.act(Action::SetLanguage(language));
        screen.check_language();
    }
    assert!(!screen.is_enabled("server_form.test"), "there is no address");
    type_into(&mut screen, "server_form.address", "db.plant");
    screen.click("server_form.test");
    let outcome = |studio: &Studio| studio.server_form().unwrap().outcome().cloned();
    assert!(matches!(outcome(screen.studio()), Some(Err(why)) if why.id() == "server.not_an_address"));
    screen.act(Action::Server(ServerAction::Test { address: CLOSED.to_owned(), password: None }));
    screen.until("the test has ended", |studio| outcome(studio).is_some());
    assert!(matches!(outcome(screen.studio()), Some(Err(why)) if why.id() == "server.unreachable"));
    // A part of this password could be taken for the host.
    let ambiguous = "postgres://bench:k3/y@127.0.0.1:1/logs".to_owned();
    screen.act(Action::Server(ServerAction::Save { address: ambiguous, password: None }));
    assert!(matches!(outcome(screen.studio()), Some(Err(why)) if why.id() == "server.ambiguous_address"));
    assert_eq!(screen.studio().settings.logbook, "", "nothing is saved yet");
    // The window continues without the server and shows a message.
    screen.act(Action::Server(ServerAction::Save { address: CLOSED.to_owned(), password: None }));
    assert!(screen.studio().server_form().is_none());
    screen.until("the server is away", is_server_unreachable);
    let exchange = screen.studio().server_exchange().unwrap();
    assert_eq!(exchange.waiting, 1, "the connection of the encoder");
    assert!(screen.harness.query_all_by_label_contains("127.0.0.1:1/logs").next().is_some());
    let settings = screen.outside.store().settings_path();
    screen
        .until("the setting is saved", |_| std::fs::read_to_string(&settings).is_ok_and(|text| text.contains(CLOSED)));
    // Without an address, the logbook is on this computer only.
    screen.act(Action::Server(ServerAction::Save { address: String::new(), password: None }));
    assert!(screen.studio().server_exchange().is_none());
}

/// The result of a test that outlasted its form is not taken for one of the next form.
#[test]
fn form_ignores_earlier_test() {
    let mut desk = Desk::fresh("");
    let silent = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = format!("postgres://bench@{}/logs", silent.local_addr().unwrap());
    let test = |address: &str| Action::Server(ServerAction::Test { address: address.to_owned(), password: None });
    desk.act(Action::Server(ServerAction::Open));
    desk.act(test(CLOSED));
    desk.act(Action::Server(ServerAction::Close));
    desk.act(Action::Server(ServerAction::Open));
    desk.act(test(&address));
    desk.settle();
    let form = desk.studio.server_form().unwrap();
    assert!(form.is_testing() && form.outcome().is_none());
}

#[test]
fn escape_closes_form() {
    let mut screen = Screen::new_form(SIZE);
    screen.act(Action::Server(ServerAction::Open));
    assert!(screen.has_button("server_form.save"));
    screen.key(egui::Key::Escape);
    assert!(!screen.has_button("server_form.save") && screen.studio().server_form().is_none());
}
