//! Tests of the logbook page using the real widgets: entries with old and new values, the filter, backups and notes.

use egui_kittest::kittest::Queryable;
use encoder_studio::app::{Action, DeviceCommand, FileQuestion, LOGBOOK_TAB, Language, Studio, Tab, Text};
use encoder_studio::devices::hiperface::state::{HiperfaceAction, ReviewState};
use encoder_studio::store::{DeviceKey, Entry, EntryFilter, EntryKind, Logbook};

use crate::screen::Screen;
use crate::support::is_review;
use crate::tabs::Tabs as _;

const SIZE: [f32; 2] = [1024.0, 640.0];

fn entry_count(studio: &Studio) -> Option<usize> {
    if studio.logbook().needs_search() {
        return None;
    }
    studio.logbook().matches()?.as_ref().ok().map(|matches| matches.entries.len())
}

/// Returns a screen with the logbook after a write of X instead of E at address 0 of data field 0.
fn screen_after_write() -> Screen {
    let mut screen = Screen::new_form(SIZE);
    screen.ask(HiperfaceAction::Put { field: 0, address: 0, bytes: vec![0x58] });
    screen.command(DeviceCommand::Review);
    screen.until("the plan is ready", |studio| is_review(studio, |state| matches!(state, ReviewState::Ready(_))));
    screen.click("review.write");
    screen.until("it is written", |studio| {
        is_review(studio, |state| matches!(state, ReviewState::Done(..)))
            && studio.hiperface().unwrap().session.is_ready()
    });
    screen.click("review.close");
    screen.act(Action::ShowTab(LOGBOOK_TAB));
    // The entries are the connection and the write.
    screen.until("the logbook is read", |studio| entry_count(studio) == Some(2));
    screen
}

fn select_first_entry(screen: &mut Screen) {
    let time = first_entry_time(screen);
    screen.harness.get_all_by_label(&time).next().unwrap().click();
    screen.steps();
}

/// Returns the time in the first row.
fn first_entry_time(screen: &Screen) -> String {
    let matches = screen.studio().logbook().matches().unwrap().as_ref().unwrap();
    let at = matches.entries[0].at.to_zoned(jiff::tz::TimeZone::system());
    at.strftime("%Y-%m-%d %H:%M").to_string()
}

#[test]
fn shows_values_and_backup_of_write() {
    let mut screen = screen_after_write();
    assert!(!screen.has_button("backups_card.restore"), "no entry is selected");
    select_first_entry(&mut screen);
    assert!(screen.shows("45  →  58"));
    for language in [Language::German, Language::English] {
        screen.act(Action::SetLanguage(language));
        screen.check_language();
    }
    // Restoring opens the review of the device. Nothing is written before the review.
    screen.click("backups_card.restore");
    screen.until("the way back is planned", |studio| is_review(studio, |state| matches!(state, ReviewState::Ready(_))));
    assert!(screen.shows("58  →  45"));
    assert_ne!(screen.studio().settings.tab, LOGBOOK_TAB);
}

/// A write is undone as on the command line, but with a review on the device page (issue 30).
#[test]
fn undoes_write_after_review() {
    let mut screen = screen_after_write();
    select_first_entry(&mut screen);
    screen.click("undo.button");
    screen.until("the way back is planned", |studio| is_review(studio, |state| matches!(state, ReviewState::Ready(_))));
    assert_ne!(screen.studio().settings.tab, LOGBOOK_TAB);
    assert!(screen.shows("58  →  45"));
    assert!(!screen.shows(&screen.say("review.recreate")), "an undo has no permissions");
    screen.check_language();
    screen.click("review.write");
    screen.until("it is undone", |studio| is_review(studio, |state| matches!(state, ReviewState::Done(..))));
    let entries = recorded_entries(&screen);
    let undone = &entries[0];
    assert_eq!((undone.kind, undone.items[0].new.as_deref()), (EntryKind::Restore, Some("45")));
}

/// The entries of an undo and of the undone write contain links to each other (issue 30).
#[test]
fn links_undo_and_write() {
    let mut screen = screen_after_write();
    select_first_entry(&mut screen);
    let link = |id, entry: &Entry| {
        let at = entry.at.to_zoned(jiff::tz::TimeZone::system()).strftime("%Y-%m-%d %H:%M:%S").to_string();
        Text::new(id).with("time", at).to_string_in(Language::English)
    };
    screen.click("undo.button");
    screen.until("the way back is planned", |studio| is_review(studio, |state| matches!(state, ReviewState::Ready(_))));
    screen.click("review.write");
    screen.until("it is undone", |studio| {
        is_review(studio, |state| matches!(state, ReviewState::Done(..)))
            && studio.hiperface().unwrap().session.is_ready()
    });
    screen.click("review.close");
    let [undo, write, _] = recorded_entries(&screen).try_into().unwrap();
    // A filter hides the undone write.
    screen.act(Action::ShowTab(LOGBOOK_TAB));
    screen.act(Action::SearchLogbook(EntryFilter { what: Some(EntryKind::Restore), ..EntryFilter::default() }));
    screen.until("only the undo is shown", |studio| entry_count(studio) == Some(1));
    select_first_entry(&mut screen);
    let undoes = link("undo.undoes", &write);
    screen.harness.get_by_label(&undoes).click();
    screen.until("all entries of the device are shown", |studio| entry_count(studio) == Some(3));
    let undone_by = link("undo.undone_by", &undo);
    assert!(screen.shows("45  →  58"), "the write is selected");
    screen.harness.get_by_label(&undone_by).click();
    screen.steps();
    assert!(screen.shows("58  →  45"), "the undo is selected");
    for language in [Language::German, Language::English] {
        screen.act(Action::SetLanguage(language));
        screen.check_language();
    }
    // The review of a second undo states that the write was already undone.
    screen.command(DeviceCommand::UndoWrite(Box::new(write)));
    screen.until("there is nothing to do", |studio| is_review(studio, |state| matches!(state, ReviewState::Ready(_))));
    screen.act(Action::ShowTab(Tab::named("Hiperface")));
    let minutes = undo.at.to_zoned(jiff::tz::TimeZone::system()).strftime("%Y-%m-%d %H:%M").to_string();
    let already = Text::new("undo.already").with("time", minutes).to_string_in(Language::English);
    assert!(screen.shows(&already) && !screen.has_button("review.write"));
}

/// If values have changed since the write, the undo lists them and cannot be written (issue 30).
#[test]
fn undo_rejects_changed_value() {
    let mut screen = screen_after_write();
    let first = recorded_entries(&screen)[0].clone();
    screen.ask(HiperfaceAction::Put { field: 0, address: 0, bytes: vec![0x59] });
    screen.command(DeviceCommand::Review);
    screen.until("the plan is ready", |studio| is_review(studio, |state| matches!(state, ReviewState::Ready(_))));
    screen.act(Action::ShowTab(Tab::named("Hiperface")));
    screen.click("review.write");
    screen.until("it is written", |studio| {
        is_review(studio, |state| matches!(state, ReviewState::Done(..)))
            && studio.hiperface().unwrap().session.is_ready()
    });
    screen.click("review.close");
    screen.command(DeviceCommand::UndoWrite(Box::new(first)));
    screen.until("it is refused", |studio| is_review(studio, |state| matches!(state, ReviewState::Failed { .. })));
    for language in [Language::German, Language::English] {
        screen.act(Action::SetLanguage(language));
        assert!(screen.shows(&screen.say("undo.changed")));
        screen.check_language();
    }
    assert!(screen.shows("Data field 0, byte 0x00: expected 58, found 59."));
    assert!(!screen.has_button("review.write"));
}

/// An undo is not available without the device, or for an entry that wrote nothing (issue 30).
#[test]
fn undo_requires_device_and_write() {
    let mut screen = screen_after_write();
    let [write, connected] = recorded_entries(&screen).try_into().unwrap();
    let why = |screen: &Screen, entry: &Entry| {
        screen.studio().undo_target(entry).err().map(|text| text.to_string_in(Language::English))
    };
    let text = |id| Some(Text::new(id).to_string_in(Language::English));
    assert_eq!(why(&screen, &write), None);
    assert_eq!(why(&screen, &connected), text("undo.nothing_written"));
    let other = Entry { device: DeviceKey::new("hiperface", "37h", "other", true), ..write.clone() };
    assert_eq!(why(&screen, &other), text("undo.not_connected"));
    let old = Entry { items: Vec::new(), ..write };
    assert_eq!(why(&screen, &old), text("undo.no_items"));
    let session = screen.encoder().session.id;
    screen.act(Action::CloseSession(session));
    screen.act(Action::ShowTab(LOGBOOK_TAB));
    screen.until("the logbook is read", |studio| entry_count(studio) == Some(2));
    select_first_entry(&mut screen);
    assert!(!screen.is_enabled("undo.button"));
}

/// A missing backup is listed with the name of the computer that made the write (issue 30).
#[test]
fn missing_backup_names_bench() {
    let mut screen = screen_after_write();
    let path = screen.outside.store().logbook_path();
    let moved = "UPDATE event SET bench = 'bench 7', backup = '/data/of bench 7/backup.ron' WHERE what = 'write'";
    rusqlite::Connection::open(path).unwrap().execute(moved, []).unwrap();
    screen.act(Action::SearchLogbook(EntryFilter::default()));
    screen.until("it is read again", |studio| entry_count(studio) == Some(2));
    select_first_entry(&mut screen);
    assert!(screen.shows("On bench 7: /data/of bench 7/backup.ron"));
    screen.click("undo.button");
    let text = Text::new("undo.other_bench").with("bench", "bench 7").with("path", "/data/of bench 7/backup.ron");
    for language in [Language::German, Language::English] {
        screen.act(Action::SetLanguage(language));
        let words = text.to_string_in(language);
        screen.until("it is refused", |studio| crate::support::log(studio).contains("bench 7"));
        assert!(screen.shows(&words), "{}", crate::support::log(screen.studio()));
        screen.check_language();
    }
}

/// The first reading is not delayed while another program uses the logbook for a long time (issue 30).
#[test]
fn busy_logbook_does_not_delay_reading() {
    let outside = crate::support::Outside::new("");
    let path = outside.store().logbook_path();
    drop(Logbook::open(&path).unwrap());
    let other = rusqlite::Connection::open(&path).unwrap();
    other.execute_batch("BEGIN IMMEDIATE").unwrap();
    let mut screen = Screen::opened(outside, None, SIZE);
    screen.until("the encoder is read", |studio| {
        studio.hiperface().is_some_and(|encoder| encoder.session.is_ready() && encoder.identity.is_some())
    });
    assert!(recorded_entries(&screen).is_empty(), "the logbook is still in use");
    other.execute_batch("ROLLBACK").unwrap();
    screen.until("the connection is recorded", |_| {
        let logbook = Logbook::open(&path).unwrap();
        logbook.entries(&EntryFilter::default(), 10).unwrap().iter().any(|entry| entry.kind == EntryKind::Connected)
    });
}

fn recorded_entries(screen: &Screen) -> Vec<Entry> {
    Logbook::open(&screen.outside.store().logbook_path()).unwrap().entries(&EntryFilter::default(), 10).unwrap()
}

#[test]
fn adds_note_to_device_of_entry() {
    let mut screen = screen_after_write();
    select_first_entry(&mut screen);
    assert!(!screen.is_enabled("logbook.add_note"), "the note is empty");
    let word = screen.say("logbook.note_text");
    screen.harness.get_by_label(&word).focus();
    screen.steps();
    screen.harness.get_by_label(&word).type_text("Kupplung ersetzt");
    screen.steps();
    screen.click("logbook.add_note");
    screen.until("the note is in the list", |studio| entry_count(studio) == Some(3));
    let logbook = Logbook::open(&screen.outside.store().logbook_path()).unwrap();
    let [note, write, connected] = logbook.entries(&EntryFilter::default(), 10).unwrap().try_into().unwrap();
    assert_eq!((note.kind, note.description.as_str()), (EntryKind::Note, "Kupplung ersetzt"));
    assert_eq!(connected.kind, EntryKind::Connected);
    assert_eq!((&note.device, &connected.device), (&write.device, &write.device));
    assert!(!screen.is_enabled("logbook.add_note"), "the entry is empty again");
}

/// A note is not lost if another entry is selected or if it cannot be saved.
#[test]
fn unsaved_note_is_kept() {
    let mut screen = screen_after_write();
    select_first_entry(&mut screen);
    let device = recorded_entries(&screen)[0].device.clone();
    let word = screen.say("logbook.note_text");
    screen.harness.get_by_label(&word).focus();
    screen.steps();
    screen.harness.get_by_label(&word).type_text("Kupplung ersetzt");
    screen.steps();
    screen.act(Action::EditNote(DeviceKey::new("biss", "6129", "7", false), "Lager".to_owned()));
    assert_eq!(screen.studio().logbook().note(&device), "Kupplung ersetzt");
    let other = rusqlite::Connection::open(screen.outside.store().logbook_path()).unwrap();
    other.execute_batch("BEGIN IMMEDIATE").unwrap();
    screen.click("logbook.add_note");
    screen.until("the note is refused", |studio| !studio.logbook().is_saving_note());
    other.execute_batch("ROLLBACK").unwrap();
    assert_eq!(screen.studio().logbook().note(&device), "Kupplung ersetzt");
    screen.click("logbook.add_note");
    screen.until("the note is in the list", |studio| entry_count(studio) == Some(3));
    assert_eq!(screen.studio().logbook().note(&device), "");
}

#[test]
fn filter_survives_tab_change() {
    let mut screen = screen_after_write();
    let other = DeviceKey::new("biss", "6129", "7", false);
    let mut logbook = Logbook::open(&screen.outside.store().logbook_path()).unwrap();
    logbook.add_note(jiff::Timestamp::now(), &other, "spare part").unwrap();
    // Another program has added an entry, so the list is read again when the tab is opened.
    screen.act(Action::ShowTab(Tab::named("Hiperface")));
    screen.act(Action::ShowTab(LOGBOOK_TAB));
    screen.until("all entries are shown", |studio| entry_count(studio) == Some(3));
    let word = screen.say("logbook.search");
    screen.harness.get_by_label(&word).focus();
    screen.steps();
    screen.harness.get_by_label(&word).type_text("SPARE");
    screen.until("only the note is shown", |studio| entry_count(studio) == Some(1));
    assert!(screen.harness.query_by_label_contains("spare part").is_some());
    screen.act(Action::ShowTab(Tab::named("Hiperface")));
    screen.act(Action::ShowTab(LOGBOOK_TAB));
    screen.until("it is read again", |studio| entry_count(studio) == Some(1));
    screen.act(Action::SearchLogbook(EntryFilter { search: "nothing like this".into(), ..EntryFilter::default() }));
    screen.until("no entry is left", |studio| entry_count(studio) == Some(0));
    assert!(screen.shows(&screen.say("logbook.no_match")));
}

/// A profile saved in the window is recorded like one saved by a command, and its entry can be found by the asset
/// (issue 26).
#[test]
fn finds_saved_profile_by_asset() {
    let mut screen = screen_after_write();
    assert!(!screen.shows(&screen.say("logbook.all_assets")), "there is no asset to choose");
    screen.command(DeviceCommand::Assign("Achse 7".parse().unwrap()));
    let (session, suggested) = (screen.encoder().session.id, "x.ron".into());
    let path = screen.outside.path("own.ron");
    screen.act(Action::Chosen(FileQuestion::Save { session, suggested }, path.clone()));
    let is_written = path.clone();
    screen
        .until("the profile is saved", |studio| is_written.exists() && studio.hiperface().unwrap().session.is_ready());
    let at = screen.outside.store().logbook_path();
    let recorded = || Logbook::open(&at).unwrap().entries(&EntryFilter::default(), 10).unwrap();
    screen.until("it is recorded", |_| recorded().len() == 4);
    let [saved, assigned, write, _] = recorded().try_into().unwrap();
    assert_eq!((saved.kind, saved.backup, saved.asset.as_deref()), (EntryKind::Backup, Some(path), Some("Achse 7")));
    assert_eq!((assigned.kind, &saved.device), (EntryKind::Assigned, &write.device));

    screen.act(Action::ShowTab(Tab::named("Hiperface")));
    screen.act(Action::ShowTab(LOGBOOK_TAB));
    screen.until("all entries are shown", |studio| entry_count(studio) == Some(4));
    let choice = screen.say("asset_card.name");
    screen.harness.get_by_role_and_label(egui::Role::ComboBox, &choice).click();
    screen.steps();
    screen.harness.get_by_role_and_label(egui::Role::Button, "Achse 7").click();
    screen.until("those of the asset are shown", |studio| entry_count(studio) == Some(2));
    for language in [Language::German, Language::English] {
        screen.act(Action::SetLanguage(language));
        screen.check_language();
    }
    screen.act(Action::SearchLogbook(EntryFilter { search: "achse 7".into(), ..EntryFilter::default() }));
    screen.until("the search finds the asset", |studio| entry_count(studio) == Some(2));
}

#[test]
fn corrupt_logbook_is_kept_and_replaced() {
    let outside = crate::support::Outside::new("");
    let path = outside.store().logbook_path();
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    std::fs::write(&path, "this is not a database").unwrap();
    let mut screen = Screen::opened(outside, None, SIZE);
    screen.act(Action::ShowTab(LOGBOOK_TAB));
    screen.until("a new one is begun", |studio| matches!(studio.logbook().matches(), Some(Ok(_))));
    let matches = screen.studio().logbook().matches().unwrap().as_ref().unwrap();
    let kept = matches.damaged.clone().unwrap();
    assert_eq!(std::fs::read(&kept).unwrap(), b"this is not a database");
    let text = Text::new("logbook.lacks_damaged").with("kept", kept.display()).to_string_in(Language::English);
    assert!(screen.shows(&text));
}
