//! Tests of *Report…*, which creates the same page as the command line.

use std::fs;
use std::path::Path;
use std::process::Command;

use egui::accesskit::Role;
use egui_kittest::kittest::Queryable;
use encoder_studio::app::{
    Action, CompanyAction, DeviceCommand, FileQuestion, Language, RecorderOwner, Severity, Studio,
};
use encoder_studio::devices::hiperface::state::HiperfaceAction as Hiperface;
use encoder_studio::devices::interbus::protocol::ProgramNumber;
use encoder_studio::devices::interbus::state::InterbusAction as Interbus;

use crate::each_kind::CASES;
use crate::screen::Screen;
use crate::support::Desk;
use crate::tabs::{self, Tabs as _};

fn is_told(studio: &Studio, id: &str) -> bool {
    studio.services.log.notices().any(|own| own.texts.iter().any(|text| text.id() == id))
}

/// Returns the page without its creation time.
fn without_time(page: &str) -> String {
    let (before, rest) = page.split_once("class=\"printed\">").unwrap();
    format!("{before}{}", rest.split_once('<').unwrap().1)
}

/// Requests a report for the selected device.
fn ask(desk: &mut Desk) -> FileQuestion {
    let id = desk.studio.selected_device().unwrap().id();
    desk.act(Action::Command(id, DeviceCommand::AskReport));
    desk.studio.take_file_question().unwrap()
}

/// Chooses a file for the selected device's report and waits until it is written.
fn report(desk: &mut Desk, path: &Path) {
    let question = ask(desk);
    assert!(matches!(question, FileQuestion::Report { .. }), "{question:?}");
    desk.act(Action::Chosen(question, path.to_owned()));
    let path = path.to_owned();
    desk.until("the report is written", move |_| path.exists());
}

#[test]
fn window_and_command_line_reports_match() {
    for (language, word) in [(Language::English, "en"), (Language::German, "de")] {
        let mut desk = Desk::new_form("");
        desk.act(Action::SetLanguage(language));
        let profiles = Path::new(env!("CARGO_MANIFEST_DIR")).join("profiles");
        for name in [
            "hiperface/multiturn-skm36.ron",
            "biss/servo-motor-data.ron",
            "ssi/afm60s.ron",
            "interbus/packaging-machine.ron",
            "hiperdrive/spindle-2-mm-in-0.1-mm.ron",
        ] {
            let profile = profiles.join(name);
            desk.act(Action::Open(profile.clone()));
            let file = profile.file_name().unwrap().to_str().unwrap().to_owned();
            desk.until("it is open", |studio| {
                studio.selected_device().is_some_and(|own| own.data_source().contains(&file))
            });
            let own = desk.outside.path(&format!("{word}-{file}.html"));
            report(&mut desk, &own);
            let own = fs::read_to_string(own).unwrap();
            let other = command_line_report(&desk, word, &profile);
            assert_eq!(without_time(&own), without_time(&other), "{name} {word}");
        }
    }
}

#[test]
fn device_report_shows_read_values() {
    let mut desk = Desk::new_form("");
    let requests = desk.wire().count(0x4A);
    let path = desk.outside.path("device.html");
    let read_at = desk.studio.selected_device().unwrap().last_read_time().unwrap();
    // The report is made later than the values were read.
    std::thread::sleep(std::time::Duration::from_millis(1_100));
    report(&mut desk, &path);
    let page = fs::read_to_string(path).unwrap();
    assert!(page.contains("GB0450179") && page.contains("45 4D 44 37 31 4B"));
    let shown = read_at.strftime("%Y-%m-%d %H:%M:%S UTC").to_string();
    assert!(page.contains(&shown), "{shown}");
    assert!(page.contains("No errors or warnings."));
    assert_eq!(desk.wire().count(0x4A), requests, "nothing is read for it");
    let path = desk.outside.path("device.pdf");
    report(&mut desk, &path);
    assert!(fs::read(path).unwrap().starts_with(b"%PDF"));
}

/// Returns the report created by the command line.
fn command_line_report(desk: &Desk, language: &str, subject: &Path) -> String {
    let (other, home) = (desk.outside.path("other.html"), desk.outside.path("home"));
    let ran = Command::new(env!("CARGO_BIN_EXE_encoder-studio"))
        .args(["report", "--language", language, "--force", "-o"])
        .args([other.as_path(), subject])
        .env("HOME", &home)
        .env("XDG_DATA_HOME", &home)
        .env("XDG_CONFIG_HOME", &home)
        .output()
        .unwrap();
    assert!(ran.status.success(), "{ran:?}");
    fs::read_to_string(other).unwrap()
}

#[test]
fn window_and_command_line_capture_reports_match() {
    let mut desk = Desk::fresh("");
    let owner = RecorderOwner::Tool(tabs::SIGNALS);
    let own = desk.outside.path("capture.html");
    let choose = |desk: &mut Desk| {
        desk.act(Action::AskReport(owner));
        let question = desk.studio.take_file_question().unwrap();
        desk.act(Action::Chosen(question, own.clone()));
    };
    assert!(!desk.studio.can_report(tabs::SIGNALS));
    choose(&mut desk);
    assert!(is_told(&desk.studio, "report.nothing_shown"));
    let capture = desk.outside.path("motor.csv");
    fs::write(&capture, crate::signals::circle(3)).unwrap();
    desk.act(Action::Open(capture.clone()));
    desk.wait_for_measurement();
    assert!(desk.studio.can_report(tabs::SIGNALS));
    for (language, word) in [(Language::English, "en"), (Language::German, "de")] {
        desk.act(Action::SetLanguage(language));
        choose(&mut desk);
        let path = own.clone();
        desk.until("the report is written", move |_| path.exists());
        let page = fs::read_to_string(&own).unwrap();
        assert!(page.contains("motor.csv"));
        assert_eq!(without_time(&page), without_time(&command_line_report(&desk, word, &capture)), "{word}");
        fs::remove_file(&own).unwrap();
    }
}

/// The report contains results from the session that are not part of any profile (issue 30).
#[test]
fn device_report_contains_session_results() {
    let mut desk = Desk::new_form("");
    desk.ask(Hiperface::Check { restart: false });
    desk.until("it is checked", |studio| studio.hiperface().unwrap().check.is_some());
    desk.until_ready();
    let path = desk.outside.path("checked.html");
    report(&mut desk, &path);
    let page = fs::read_to_string(path).unwrap();
    let checked = desk.encoder().check.clone().unwrap();
    assert!(page.contains(">Device check<"));
    assert_eq!(page.matches(">Good<").count() + page.matches(">Skipped<").count(), checked.len(), "{checked:?}");

    let case = CASES.into_iter().find(|case| case.tab == tabs::INTERBUS).unwrap();
    let mut desk = case.desk();
    let id = desk.studio.selected_device().unwrap().id();
    desk.act(Action::device(id, Interbus::ReadPrograms(ProgramNumber::all().collect())));
    crate::each_kind::until_ready(&mut desk);
    let path = desk.outside.path("interbus.html");
    report(&mut desk, &path);
    let page = fs::read_to_string(path).unwrap();
    assert!(page.contains("Status when read") && page.contains("No errors or warnings."));
    assert!(!page.contains(">Device check<"), "it was not checked");
}

/// The company shown in reports can also be set in the window (issue 30).
#[test]
fn form_sets_company() {
    let mut screen = Screen::new_form([1024.0, 640.0]);
    screen.act(Action::Company(CompanyAction::Open));
    for language in [Language::German, Language::English] {
        screen.act(Action::SetLanguage(language));
        screen.check_language();
    }
    screen.key(egui::Key::Escape);
    assert!(screen.studio().company_form().is_none());
    screen.act(Action::Company(CompanyAction::Open));
    let word = screen.say("company_form.name");
    screen.harness.get_by_role_and_label(Role::TextInput, &word).focus();
    screen.steps();
    screen.harness.get_by_role_and_label(Role::TextInput, &word).type_text("Miller GmbH");
    screen.steps();
    // Not a picture: nothing is saved.
    let broken = screen.outside.path("logo.png");
    fs::write(&broken, "no picture").unwrap();
    screen.act(Action::Chosen(FileQuestion::Logo, broken));
    screen.click("server_form.save");
    let logo_text = screen.say("report.logo");
    screen.until("the logo is refused", |studio| studio.company_form().is_some_and(|form| form.problem().is_some()));
    assert!(screen.shows(&logo_text));
    assert_eq!(screen.studio().settings.company, None);
    let logo = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/icon/64.png");
    screen.act(Action::Chosen(FileQuestion::Logo, logo.clone()));
    screen.click("server_form.save");
    screen.until("it is saved", |studio| studio.company_form().is_none());
    let settings = screen.outside.store().settings_path();
    let has_both = |text: &str| text.contains("Miller GmbH") && text.contains("64.png");
    screen.until("the settings are on disk", |_| fs::read_to_string(&settings).is_ok_and(|text| has_both(&text)));
    let path = screen.outside.path("own.html");
    let owner = RecorderOwner::Device(screen.encoder().session.id);
    screen.act(Action::Chosen(FileQuestion::Report { owner, suggested: "own.html".into() }, path.clone()));
    let written = path.clone();
    screen.until("the report is written", move |_| written.exists());
    let page = fs::read_to_string(path).unwrap();
    assert!(page.contains("Miller GmbH") && page.contains("data:image/png;base64,iVBOR"));
}

/// The result of a check that outlasted its form is not taken for one of the next form.
#[test]
fn company_form_ignores_earlier_check() {
    let mut desk = Desk::fresh("");
    let save = |name: &str| Action::Company(CompanyAction::Save { name: name.to_owned(), logo: String::new() });
    desk.act(Action::Company(CompanyAction::Open));
    desk.act(save("Old"));
    desk.act(Action::Company(CompanyAction::Close));
    desk.act(Action::Company(CompanyAction::Open));
    desk.settle();
    assert!(desk.studio.company_form().is_some_and(|form| !form.is_checking()));
    assert_eq!(desk.studio.settings.company, None);
    desk.act(save("New"));
    desk.until("it is saved", |studio| studio.company_form().is_none());
    assert_eq!(desk.studio.settings.company.as_deref(), Some("New"));
}

#[test]
fn failed_report_names_reason() {
    let mut desk = Desk::new_form("");
    let question = ask(&mut desk);
    desk.act(Action::Chosen(question, desk.outside.path("report.txt")));
    assert!(is_told(&desk.studio, "report.extension"));
    let profile = desk.outside.path("mine.ron");
    desk.ask(Hiperface::Save(profile.clone()));
    desk.until("it is saved", |studio| is_told(studio, "session.saved"));
    desk.act(Action::Open(profile));
    desk.until("it is open", |studio| {
        studio.selected_device().is_some_and(|own| own.data_source().contains("mine.ron"))
    });
    desk.ask(Hiperface::Put { field: 0, address: 0, bytes: vec![0x58] });
    let question = ask(&mut desk);
    desk.act(Action::Chosen(question, desk.outside.path("mine.html")));
    assert!(is_told(&desk.studio, "report.unsaved"));
    assert!(!desk.outside.path("mine.html").exists());
    let last = desk.studio.services.log.current().unwrap();
    assert_eq!(last.severity, Severity::Error);
}
