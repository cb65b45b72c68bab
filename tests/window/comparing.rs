//! Compares any two of a device, a profile, a file, a backup and a logbook entry, and copies values from left to right.

use std::fs;
use std::path::{Path, PathBuf};

use egui_kittest::kittest::Queryable;
use encoder_studio::app::review::Stage;
use encoder_studio::app::session::Phase;
use encoder_studio::app::{
    Action, ComparedRow, ComparedRows, ComparisonAction, ComparisonSource, DeviceCommand, FileQuestion, ItemValue,
    Language, ReviewAction, Side, Studio,
};
use encoder_studio::devices::hiperface::state::HiperfaceAction as Hiperface;

use crate::each_kind::{CASES, command, shown, write};
use crate::screen::Screen;
use crate::support::Desk;

/// The connected encoder and the path of a profile in which the byte at address 0 of field 0 is X instead of E.
fn encoder_and_changed_profile() -> (Desk, PathBuf) {
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

fn file(path: &Path) -> Option<ComparisonSource> {
    Some(ComparisonSource::File(path.to_owned()))
}

fn compare_with(path: &Path) -> DeviceCommand {
    DeviceCommand::Compare(Box::new(ComparisonSource::File(path.to_owned())))
}

fn rows(studio: &Studio) -> Option<&ComparedRows> {
    studio.comparison()?.rows()?.as_ref().ok()
}

fn is_compared(studio: &Studio) -> bool {
    rows(studio).is_some()
}

fn differing(studio: &Studio) -> Vec<&ComparedRow> {
    let all = rows(studio).into_iter().flat_map(|rows| &rows.groups).flat_map(|group| &group.rows);
    all.filter(|row| row.differs).collect()
}

fn close_review(desk: &mut Desk) {
    let id = shown(&desk.studio).unwrap().id();
    desk.act(Action::Review(id, ReviewAction::Close));
}

fn bytes(bytes: &[u8]) -> Option<ItemValue> {
    Some(ItemValue::Bytes(bytes.to_vec()))
}

#[test]
fn comparison_lists_differences_only() {
    let (mut desk, path) = encoder_and_changed_profile();
    let session = desk.studio.selected_device().unwrap().id();
    let requests = desk.wire().count(0x4A);
    desk.command(DeviceCommand::AskCompare);
    assert!(desk.studio.comparison().unwrap().rows().is_none(), "the other side is not chosen");
    assert!(desk.studio.comparison_choices().contains(&ComparisonSource::Session(session)));
    desk.act(Action::Comparison(ComparisonAction::AskFile(Side::Left)));
    let question = desk.studio.take_file_question().unwrap();
    assert_eq!(question, FileQuestion::Compare(Side::Left));
    desk.act(Action::Chosen(question, path.clone()));
    desk.until("it is compared", is_compared);
    let view = desk.studio.comparison().unwrap();
    assert_eq!((view.side(Side::Left).path(), view.side(Side::Right).session()), (Some(path.as_path()), Some(session)));
    let [row] = differing(&desk.studio).try_into().unwrap();
    assert_eq!((row.item.as_str(), &row.left, &row.right), ("field:0@0+1", &bytes(b"X"), &bytes(b"E")));
    assert_eq!(rows(&desk.studio).unwrap().different, 1);
    desk.act(Action::Comparison(ComparisonAction::Swap));
    let [row] = differing(&desk.studio).try_into().unwrap();
    assert_eq!((&row.left, &row.right), (&bytes(b"E"), &bytes(b"X")));
    assert_eq!(desk.wire().count(0x4A), requests, "nothing is read for it");
    desk.act(Action::Escape);
    assert!(desk.studio.comparison().is_none());
    desk.command(compare_with(&path));
    desk.until("it is compared again", is_compared);
    desk.act(Action::CloseSession(session));
    assert!(desk.studio.comparison().is_none(), "it ends with its session");
}

/// A side that is still being read moves with its source.
#[test]
fn sides_swap_during_reading() {
    let (mut desk, path) = encoder_and_changed_profile();
    desk.command(compare_with(&path));
    desk.act(Action::Comparison(ComparisonAction::Swap));
    desk.until("it is compared", is_compared);
    let [row] = differing(&desk.studio).try_into().unwrap();
    assert_eq!((&row.left, &row.right), (&bytes(b"E"), &bytes(b"X")));
}

#[test]
fn compares_files_offline() {
    let mut desk = Desk::fresh("");
    let profiles = Path::new(env!("CARGO_MANIFEST_DIR")).join("profiles/ssi");
    let (left, right) = (file(&profiles.join("ahm36.ron")), file(&profiles.join("afs60s.ron")));
    desk.act(Action::Comparison(ComparisonAction::Open { left, right }));
    desk.until("it is compared", is_compared);
    assert!(differing(&desk.studio).iter().any(|row| row.item == "family"));
    assert!(desk.studio.editable_device().is_none());
}

#[test]
fn compares_with_logbook_entry() {
    let (mut desk, _) = encoder_and_changed_profile();
    desk.put(0, 0, b"Y");
    desk.write();
    desk.command(DeviceCommand::AskCompare);
    let before = |studio: &Studio| {
        let mut choices = studio.comparison_choices().into_iter();
        choices.find(|own| matches!(own, ComparisonSource::Entry(entry) if !entry.items.is_empty()))
    };
    desk.until("the write is listed", |studio| before(studio).is_some());
    let backups = desk.studio.comparison_choices();
    assert!(!backups.iter().any(|own| matches!(own, ComparisonSource::Backup(_))), "the entry has the only backup");
    let moment = before(&desk.studio).unwrap();
    desk.act(Action::Comparison(ComparisonAction::Choose(Side::Left, moment)));
    desk.until("it is compared", is_compared);
    let [row] = differing(&desk.studio).try_into().unwrap();
    assert_eq!((&row.left, &row.right), (&bytes(b"E"), &bytes(b"Y")));
}

/// Single items are copied from the left side into the edits on the right, with the item names of `read` (issue 30).
#[test]
fn copies_values_into_edits() {
    for case in CASES {
        let mut desk = case.desk();
        case.read_all(&mut desk);
        let path = desk.outside.path("before.ron");
        case.save(&mut desk, &path);
        desk.settle();
        case.edit(&mut desk, &[0x5A, 0x5B]);
        write(&mut desk);
        close_review(&mut desk);
        command(&mut desk, compare_with(&path));
        desk.until("it is compared", is_compared);
        // The reference of a drive is set by a procedure.
        let is_accepted = |row: &&ComparedRow| shown(&desk.studio).unwrap().accepts_item(&row.item);
        let items: Vec<String> =
            differing(&desk.studio).into_iter().filter(is_accepted).map(|row| row.item.clone()).collect();
        let others = rows(&desk.studio).unwrap().different - items.len();
        assert!((1..=2).contains(&items.len()), "{:?}: {items:?}", case.tab);
        for item in &items {
            desk.act(Action::Comparison(ComparisonAction::Take(item.clone())));
            assert_eq!(desk.studio.comparison().unwrap().refusal(), None, "{item}");
        }
        assert_eq!(shown(&desk.studio).unwrap().edit_count(), 2, "{:?}", case.tab);
        let all = rows(&desk.studio).unwrap();
        let taken = all.groups.iter().flat_map(|group| &group.rows).filter(|row| row.is_taken);
        assert_eq!((all.different, taken.count()), (others, items.len()), "the rows stay");
        desk.act(Action::Comparison(ComparisonAction::Close));
        // The edits are written as any others, after which nothing differs.
        write(&mut desk);
        close_review(&mut desk);
        command(&mut desk, compare_with(&path));
        desk.until("it is compared again", is_compared);
        assert_eq!(rows(&desk.studio).unwrap().different, others, "{:?}", case.tab);
    }
}

/// Items have names that are more readable than their keywords, in both languages.
#[test]
fn items_have_names() {
    for case in CASES {
        let mut desk = case.desk();
        case.read_all(&mut desk);
        let path = desk.outside.path("saved.ron");
        case.save(&mut desk, &path);
        desk.settle();
        command(&mut desk, compare_with(&path));
        desk.until("it is compared", is_compared);
        let all = rows(&desk.studio).unwrap();
        assert!(all.compared > 0 && all.different == 0);
        if case.tab == crate::tabs::NOVEL {
            continue; // It has no names.
        }
        for group in &all.groups {
            assert!(group.title.is_some(), "{:?}", case.tab);
            for row in &group.rows {
                let names = [Language::English, Language::German].map(|language| row.name.to_string_in(language));
                assert!(names.iter().all(|name| *name != row.item), "{}", row.item);
            }
        }
    }
}

#[test]
fn explains_why_value_cannot_be_copied() {
    let (mut desk, path) = encoder_and_changed_profile();
    desk.command(compare_with(&path));
    desk.until("it is compared", is_compared);
    for item in ["status:0", "field:9@0+1", "field:0@0+4096", "steps"] {
        desk.act(Action::Comparison(ComparisonAction::Take(item.to_owned())));
        assert!(desk.studio.comparison().unwrap().refusal().is_some(), "{item}");
        assert_eq!(desk.edits(), [], "{item}");
    }
}

#[test]
fn restore_is_reviewed_first() {
    let (mut desk, path) = encoder_and_changed_profile();
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
fn incomparable_file_reports_reason() {
    let (mut desk, _) = encoder_and_changed_profile();
    let profiles = Path::new(env!("CARGO_MANIFEST_DIR")).join("profiles");
    desk.command(compare_with(&profiles.join("interbus/scaled-encoder.ron")));
    let problem = |studio: &Studio| match studio.comparison().and_then(|view| view.rows()) {
        Some(Err(why)) => Some(why.id()),
        _ => None,
    };
    desk.until("it is told", |studio| problem(studio) == Some("comparison.other_kind"));
    desk.command(compare_with(&desk.outside.path("missing.ron")));
    let left = |studio: &Studio| studio.comparison().unwrap().side(Side::Left).problem().first().map(|text| text.id());
    desk.until("it is told", |studio| left(studio) == Some("file.not_found"));
    assert!(desk.studio.comparison().unwrap().rows().is_none());
}

#[test]
fn comparison_leads_to_review() {
    let (desk, path) = encoder_and_changed_profile();
    let Desk { outside, studio, .. } = desk;
    let mut screen = Screen::of(outside, studio, [1024.0, 640.0]);
    screen.command(compare_with(&path));
    screen.until("it is compared", is_compared);
    for language in [Language::German, Language::English] {
        screen.act(Action::SetLanguage(language));
        screen.check_language();
    }
    assert!(screen.shows("Data field 0, byte 0x00") && !screen.shows("Status of data field 0"));
    screen.harness.get_by_label(&screen.say("comparison.only_differences")).click();
    screen.steps();
    assert!(screen.shows("Status of data field 0"));
    screen.harness.get_by_label("Copy to the right side as an edit: Data field 0, byte 0x00").click();
    screen.steps();
    assert_eq!(screen.encoder().staged.byte(0, 0), Some(b'X'));
    assert!(screen.shows("With 1 edit not yet written"));
    screen.act(Action::Comparison(ComparisonAction::Close));
    screen.command(DeviceCommand::RevertAll);
    screen.command(compare_with(&path));
    screen.until("it is compared", is_compared);
    screen.click("comparison.restore");
    screen.until("it is planned", is_planned);
    assert!(screen.studio().comparison().is_none());
}
