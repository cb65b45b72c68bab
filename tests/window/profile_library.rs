//! The profile library: ready-made profiles, recent ones and those in the same folders, with a search and a preview.

use std::fs;
use std::path::{Path, PathBuf};

use egui::{Event, Key, Modifiers};
use egui_kittest::kittest::Queryable;
use encoder_studio::app::session::Phase;
use encoder_studio::app::{
    Action, FileQuestion, ItemValue, Language, LibraryAction, LibraryEntry, LibraryProblem, LibrarySection,
    ProfileLibrary, Settings, Side, Studio,
};
use encoder_studio::devices::hiperface::state::HiperfaceAction as Hiperface;

use crate::screen::Screen;
use crate::support::{Desk, Outside};
use crate::tabs::Tabs as _;

const SKM36: &str = "hiperface/multiturn-skm36.ron";
const AFM60: &str = "ssi/afm60.ron";
const SCALED: &str = "interbus/scaled-encoder.ron";
const SPINDLE: &str = "hiperdrive/spindle-2-mm-in-0.1-mm.ron";
const SERVO: &str = "biss/servo-motor-data.ron";

/// Copies a ready-made profile to a file of the environment.
fn copy(outside: &Outside, profile: &str, to: &str) -> PathBuf {
    let (from, to) = (Path::new(env!("CARGO_MANIFEST_DIR")).join("profiles").join(profile), outside.path(to));
    fs::create_dir_all(to.parent().unwrap()).unwrap();
    fs::copy(from, &to).unwrap();
    to
}

/// Delivers ready-made profiles with the program of the environment.
fn deliver(outside: &Outside, profiles: &[&str]) {
    for profile in profiles {
        copy(outside, profile, &format!("program/bin/profiles/{profile}"));
    }
}

fn library(studio: &Studio) -> &ProfileLibrary {
    studio.profile_library().expect("the library is open")
}

fn act(desk: &mut Desk, action: LibraryAction) {
    desk.act(Action::Library(action));
}

fn open_library(desk: &mut Desk) {
    act(desk, LibraryAction::Open);
    desk.until("the profiles are read", |studio| !library(studio).is_reading());
}

/// Opens a profile in a session, and waits until it is read.
fn open(desk: &mut Desk, path: &Path) {
    desk.act(Action::Open(path.to_owned()));
    desk.until("it is open", |studio| studio.files_being_opened().is_empty());
}

/// Returns the listed files with their sections.
fn listed(desk: &Desk) -> Vec<(LibrarySection, String)> {
    let of = |entry: &LibraryEntry| (entry.section(), entry.file_name());
    library(&desk.studio).entries().map(of).collect()
}

fn names(desk: &Desk) -> Vec<String> {
    listed(desk).into_iter().map(|(_, name)| name).collect()
}

fn selected(desk: &Desk) -> Option<String> {
    library(&desk.studio).selected().map(LibraryEntry::file_name)
}

#[test]
fn profiles_are_listed_once_by_section() {
    let mut desk = Desk::fresh("");
    deliver(&desk.outside, &[SKM36, AFM60]);
    let mine = copy(&desk.outside, SCALED, "plant/mine.ron");
    for (profile, name) in [(SERVO, "plant/other.ron"), (SPINDLE, "plant/axis/deep.ron")] {
        copy(&desk.outside, profile, name);
    }
    copy(&desk.outside, SERVO, "plant/.hidden/other.ron");
    fs::write(desk.outside.path("plant/table.csv"), "0,1,2").unwrap();
    open(&mut desk, &mine);
    open_library(&mut desk);
    let (recent, ready_made, same_folder) =
        (LibrarySection::Recent, LibrarySection::ReadyMade, LibrarySection::SameFolder);
    let expected = [
        (recent, "mine.ron"),
        (ready_made, "multiturn-skm36.ron"),
        (ready_made, "afm60.ron"),
        (same_folder, "deep.ron"),
        (same_folder, "other.ron"),
    ];
    assert_eq!(listed(&desk), expected.map(|(section, name)| (section, name.to_owned())));
    assert!(!library(&desk.studio).is_truncated());
    // A ready-made profile that was opened is a recent one, and its folder is not listed again.
    let ready_made = desk.outside.path("program/bin/profiles").join(AFM60);
    open(&mut desk, &ready_made);
    open_library(&mut desk);
    assert_eq!(names(&desk), ["afm60.ron", "mine.ron", "multiturn-skm36.ron", "deep.ron", "other.ron"]);
}

#[test]
fn library_is_empty_without_profiles() {
    let mut desk = Desk::fresh("");
    open_library(&mut desk);
    assert!(library(&desk.studio).is_empty() && library(&desk.studio).selected().is_none());
    act(&mut desk, LibraryAction::OpenSelected);
    act(&mut desk, LibraryAction::CompareSelected);
    act(&mut desk, LibraryAction::Step(1));
    assert!(desk.studio.devices().is_empty() && desk.studio.comparison().is_none());
    act(&mut desk, LibraryAction::AskFile);
    assert_eq!(desk.studio.take_file_question(), Some(FileQuestion::Open));
}

/// Opened and saved profiles come first, newest first, even after a restart. One that no longer exists stays listed.
#[test]
fn recent_profiles_are_remembered_newest_first() {
    let mut desk = Desk::new_form("");
    let (first, second) = (copy(&desk.outside, SCALED, "a/first.ron"), copy(&desk.outside, AFM60, "b/second.ron"));
    let saved = desk.outside.path("c/saved.ron");
    fs::create_dir_all(saved.parent().unwrap()).unwrap();
    desk.ask(Hiperface::Save(saved.clone()));
    desk.until("it is saved", |studio| studio.services.log.notices().any(|own| own.texts[0].id() == "session.saved"));
    for path in [&first, &second, &first] {
        open(&mut desk, path);
    }
    open_library(&mut desk);
    assert_eq!(names(&desk), ["first.ron", "second.ron", "saved.ron"]);
    fs::remove_file(&first).unwrap();
    let settings = desk.outside.store().settings_path();
    desk.until("the settings are kept", |studio| {
        let text = fs::read_to_string(&settings).unwrap_or_default();
        Settings::parse(&text).as_ref() == Ok(&studio.settings)
    });
    let mut desk = desk.crash();
    open_library(&mut desk);
    assert_eq!(names(&desk), ["first.ron", "second.ron", "saved.ron"]);
    let missing = library(&desk.studio).entries().next().unwrap();
    let Some(LibraryProblem::Missing(text)) = missing.problem() else { panic!("{missing:?}") };
    assert_eq!(text.to_string_in(Language::English), "first.ron does not exist. Check the name.");
    // The first profile that can be opened is selected.
    assert_eq!(selected(&desk).as_deref(), Some("second.ron"));
    act(&mut desk, LibraryAction::Select(first));
    act(&mut desk, LibraryAction::OpenSelected);
    assert!(desk.studio.files_being_opened().is_empty() && library(&desk.studio).preview().is_none());
}

/// Backups and other files of the program are neither remembered nor listed.
#[test]
fn library_omits_application_files() {
    let mut desk = Desk::fresh("");
    let backup = copy(&desk.outside, SCALED, "data/backups/interbus/1/backup.ron");
    let mine = copy(&desk.outside, SCALED, "mine.ron");
    open(&mut desk, &backup);
    open(&mut desk, &mine);
    let settings = desk.outside.store().settings_path();
    desk.until("the settings are kept", |_| settings.exists());
    open_library(&mut desk);
    assert_eq!(names(&desk), ["mine.ron"]);
}

#[test]
fn library_search_covers_profile_details() {
    let mut desk = Desk::fresh("");
    deliver(&desk.outside, &[SKM36, AFM60, SCALED, SPINDLE, SERVO]);
    open_library(&mut desk);
    let cases: [(&str, &[&str]); 10] = [
        ("hiperface", &["multiturn-skm36.ron"]),
        ("SKM36", &["multiturn-skm36.ron"]),
        ("gb0450179", &["multiturn-skm36.ron"]),
        ("POSITAL", &["servo-motor-data.ron"]),
        ("afm60 delivered", &["afm60.ron"]),
        ("spindle mm", &["spindle-2-mm-in-0.1-mm.ron", "scaled-encoder.ron"]),
        ("counterclockwise", &["scaled-encoder.ron"]),
        ("data motor", &["servo-motor-data.ron"]),
        ("k3", &["scaled-encoder.ron"]),
        ("no such profile", &[]),
    ];
    for (words, expected) in cases {
        act(&mut desk, LibraryAction::Search(words.to_owned()));
        assert_eq!(names(&desk), expected, "{words}");
        assert_eq!(selected(&desk).is_some(), !expected.is_empty(), "{words}");
    }
    act(&mut desk, LibraryAction::Search(String::new()));
    assert_eq!(names(&desk).len(), 5);
    act(&mut desk, LibraryAction::ShowKind(Some("ssi")));
    assert_eq!(names(&desk), ["afm60.ron"]);
    act(&mut desk, LibraryAction::Search("skm".to_owned()));
    assert!(names(&desk).is_empty());
    // The search remains when the library is opened again.
    act(&mut desk, LibraryAction::Close);
    open_library(&mut desk);
    assert!(names(&desk).is_empty() && !library(&desk.studio).is_empty());
    act(&mut desk, LibraryAction::ShowKind(None));
    assert_eq!(names(&desk), ["multiturn-skm36.ron"]);
}

#[test]
fn library_explains_invalid_files() {
    let mut desk = Desk::fresh("");
    let mine = copy(&desk.outside, SCALED, "plant/mine.ron");
    let cases = [
        ("empty.ron", "", "profile.invalid"),
        ("gearbox.ron", "(schema: 1, device: \"gearbox\")", "profile.device"),
        ("syntax.ron", "(schema: 1,, )", "profile.invalid"),
    ];
    for (name, content, _) in cases {
        fs::write(desk.outside.path("plant").join(name), content).unwrap();
    }
    open(&mut desk, &mine);
    open_library(&mut desk);
    assert_eq!(names(&desk), ["mine.ron", "empty.ron", "gearbox.ron", "syntax.ron"]);
    for (entry, (name, _, id)) in library(&desk.studio).entries().skip(1).zip(cases) {
        let Some(LibraryProblem::Invalid(text)) = entry.problem() else { panic!("{entry:?}") };
        assert_eq!(text.id(), id, "{name}");
        let words = text.to_string_in(Language::English);
        assert!(words.starts_with(name), "the folder is not repeated: {words}");
    }
    act(&mut desk, LibraryAction::Search("syntax".to_owned()));
    assert_eq!(selected(&desk).as_deref(), Some("syntax.ron"));
    let open_devices = desk.studio.devices().len();
    act(&mut desk, LibraryAction::OpenSelected);
    desk.settle();
    assert_eq!((desk.studio.devices().len(), library(&desk.studio).preview().is_none()), (open_devices, true));
}

/// The preview has the items of *Compare…*: all data fields of the profile, with their bytes.
#[test]
fn preview_shows_selected_profile() {
    let mut desk = Desk::fresh("");
    deliver(&desk.outside, &[SKM36, SCALED]);
    open_library(&mut desk);
    assert_eq!(selected(&desk).as_deref(), Some("multiturn-skm36.ron"));
    let profile = library(&desk.studio).selected().unwrap().profile().unwrap();
    assert_eq!((profile.bus(), profile.subject().device_type.as_str()), ("HIPERFACE", "SKM36"));
    assert_eq!(profile.subject().serial_number, "GB0450179");
    assert_eq!(profile.summary(), "SKM36 · GB0450179");
    let rows = library(&desk.studio).preview().unwrap().as_ref().unwrap();
    let titles: Vec<String> =
        rows.groups.iter().map(|group| group.title.as_ref().unwrap().to_string_in(Language::English)).collect();
    assert_eq!(titles, ["Data field 0", "Data field 1", "Data field 2"]);
    let mut first = rows.groups[0].rows.iter();
    let bytes = first.find_map(|row| match &row.left {
        Some(ItemValue::Bytes(bytes)) => Some(bytes),
        _ => None,
    });
    // The field has 32 bytes and begins with the name of the motor.
    assert_eq!(bytes.map(|bytes| (bytes.len(), &bytes[..8])), Some((32, &b"EMD71K-4"[..])));
    act(&mut desk, LibraryAction::Step(1));
    assert_eq!(selected(&desk).as_deref(), Some("scaled-encoder.ron"));
    let rows = library(&desk.studio).preview().unwrap().as_ref().unwrap();
    let steps = rows.groups.iter().flat_map(|group| &group.rows).find(|row| row.item == "steps").unwrap();
    let Some(ItemValue::Text(value)) = &steps.left else { panic!("{steps:?}") };
    assert!(value.to_string_in(Language::English).starts_with("250000"), "{value:?}");
    act(&mut desk, LibraryAction::Step(9));
    assert_eq!(selected(&desk).as_deref(), Some("scaled-encoder.ron"), "it is the last one");
    act(&mut desk, LibraryAction::Step(-9));
    assert_eq!(selected(&desk).as_deref(), Some("multiturn-skm36.ron"));
}

#[test]
fn opens_or_compares_selected_profile() {
    let mut desk = Desk::new_form("");
    deliver(&desk.outside, &[SKM36, SCALED]);
    let session = desk.encoder().session.id;
    open_library(&mut desk);
    act(&mut desk, LibraryAction::CompareSelected);
    assert!(desk.studio.profile_library().is_none());
    let path = desk.outside.path("program/bin/profiles").join(SKM36);
    let view = desk.studio.comparison().unwrap();
    assert_eq!((view.side(Side::Left).path(), view.side(Side::Right).session()), (Some(path.as_path()), Some(session)));
    desk.until("it is compared", |studio| studio.comparison().is_some_and(|view| matches!(view.rows(), Some(Ok(_)))));
    desk.act(Action::Escape);
    // A profile of another kind has nothing to be compared with yet.
    open_library(&mut desk);
    act(&mut desk, LibraryAction::Step(1));
    act(&mut desk, LibraryAction::CompareSelected);
    assert!(desk.studio.comparison().unwrap().side(Side::Right).source().is_none());
    desk.act(Action::Escape);
    open_library(&mut desk);
    act(&mut desk, LibraryAction::Select(path));
    act(&mut desk, LibraryAction::OpenSelected);
    assert!(desk.studio.profile_library().is_none());
    desk.until("it is open", |studio| studio.hiperface().unwrap().session.phase == Phase::Offline);
    assert_eq!(desk.studio.devices().len(), 2);
    // Escape stops a running job first, and then closes the library.
    open_library(&mut desk);
    desk.act(Action::Escape);
    assert!(desk.studio.profile_library().is_none());
}

fn type_text(screen: &mut Screen, text: &str) {
    screen.harness.event(Event::Text(text.to_owned()));
    screen.steps();
}

fn wait_for_profile_list(screen: &mut Screen) {
    screen
        .until("the profiles are read", |studio| studio.profile_library().is_some_and(|library| !library.is_reading()));
}

fn shown_selection(screen: &Screen) -> Option<String> {
    library(screen.studio()).selected().map(LibraryEntry::file_name)
}

/// The whole way in the window, by keyboard and by mouse, in both languages.
#[test]
fn library_supports_keyboard_and_mouse() {
    let outside = Outside::new("");
    deliver(&outside, &[SKM36, AFM60, SCALED, SPINDLE, SERVO]);
    fs::write(outside.path("program/bin/profiles/broken.ron"), "(schema: 1,, )").unwrap();
    let mut screen = Screen::opened(outside, None, [1024.0, 640.0]);
    screen.until("the encoder is read", |studio| studio.hiperface().is_some_and(|own| own.session.is_ready()));
    screen.harness.key_press_modifiers(Modifiers::COMMAND, Key::K);
    screen.steps();
    type_text(&mut screen, "profile library…");
    screen.key(Key::Enter);
    wait_for_profile_list(&mut screen);
    for language in [Language::German, Language::English] {
        screen.act(Action::SetLanguage(language));
        screen.check_language();
        assert!(screen.shows(&screen.say("library.ready_made")));
    }
    assert!(screen.shows("broken.ron: broken.ron is not a valid profile"));
    // The search has the keyboard, and the arrow keys move the selection beside it.
    type_text(&mut screen, "spindle");
    assert_eq!(library(screen.studio()).entries().count(), 2);
    assert_eq!(shown_selection(&screen).as_deref(), Some("spindle-2-mm-in-0.1-mm.ron"));
    screen.key(Key::ArrowDown);
    assert_eq!(shown_selection(&screen).as_deref(), Some("scaled-encoder.ron"));
    screen.key(Key::ArrowUp);
    screen.key(Key::Enter);
    screen.until("it is open", |studio| studio.devices().len() == 2);
    assert!(screen.studio().profile_library().is_none());
    // The button in the header, a click on a row, and the comparison.
    screen.click("shell.profiles");
    wait_for_profile_list(&mut screen);
    screen.act(Action::Library(LibraryAction::Search(String::new())));
    screen.harness.get_by_label("multiturn-skm36.ron: SKM36 · GB0450179").click();
    screen.steps();
    assert_eq!(shown_selection(&screen).as_deref(), Some("multiturn-skm36.ron"));
    for language in [Language::German, Language::English] {
        screen.act(Action::SetLanguage(language));
        screen.check_language();
    }
    assert!(screen.shows("Data field 0: 2"));
    screen.click("shell.compare");
    assert!(screen.studio().comparison().is_some() && screen.studio().profile_library().is_none());
    screen.act(Action::Escape);
    screen.click("shell.profiles");
    screen.key(Key::Escape);
    assert!(screen.studio().profile_library().is_none());
}
