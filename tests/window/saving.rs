//! Tests of saving to an open file. If others have changed it, the program asks. The user's comments between the
//! entries are kept.

use crate::tabs::Tabs as _;
use encoder_studio::app::DeviceCommand;
use std::fs;
use std::path::{Path, PathBuf};

use encoder_studio::app::diverged::{ConflictResolution, Side};
use encoder_studio::app::session::Phase;
use encoder_studio::app::{Action, AnyDevice, FileQuestion, PendingEdits, SessionId, Severity, Studio};
use encoder_studio::devices::hiperdrive::state::{Edit as HiperdriveEdit, HiperdriveAction as Hiperdrive};
use encoder_studio::devices::interbus::protocol::ProgramNumber;
use encoder_studio::devices::interbus::state::{Edit, InterbusAction as Interbus};
use encoder_studio::devices::ssi::protocol::{Code, Range};
use encoder_studio::devices::ssi::state::{Edit as SsiEdit, SsiAction as Ssi};
use encoder_studio::profile::ChangedSide;

use crate::support::Desk;

/// A profile that a user has formatted differently from the program.
const OWN: &str = "// bench 3\r\n(schema: 1, device: \"hiperface\",\r\n  note: \"as wired\", // ours\r\n  identity: (serial_number: \"A1\", encoder_type: 0x37),\r\n  interface: (settings: 0xE4, address: 0x40),\r\n  fields: [(number: 0, status: 0xC8, // the motor\r\n    bytes: [\"00 01 02 03 04 05 06 07 08 09 0A 0B 0C 0D 0E 0F\"])], // end\r\n)\r\n";

fn opened(text: &str) -> (Desk, PathBuf) {
    let mut desk = Desk::fresh("");
    let path = desk.outside.path("own.ron");
    fs::write(&path, text).unwrap();
    desk.studio.start_with(None, Some(path.clone()));
    desk.until("it is open", is_open);
    desk.settle();
    (desk, path)
}

/// Returns whether a profile from a file is selected.
fn is_open(studio: &Studio) -> bool {
    studio.selected_device().is_some_and(|own| *own.phase() == Phase::Offline)
}

fn file_text(path: &Path) -> String {
    fs::read_to_string(path).unwrap()
}

fn save(desk: &mut Desk) {
    let id = desk.studio.selected_device().map(AnyDevice::id).unwrap();
    desk.act(Action::Save(id));
}

/// Waits until the edits of the displayed document are on disk.
fn until_kept(desk: &mut Desk) {
    desk.until("the draft is kept", |studio| studio.selected_device().is_some_and(AnyDevice::is_draft_kept));
    desk.settle();
}

fn is_saved(studio: &Studio) -> bool {
    !studio.hiperface().unwrap().staged.is_dirty()
}

fn is_asked(studio: &Studio) -> bool {
    studio.diverged.is_some()
}

/// Saving writes the open file without asking. Saving to another file asks for its path (issue 22.25).
#[test]
fn save_writes_open_file() {
    let (mut desk, path) = opened(OWN);
    desk.put(0, 0, b"X");
    save(&mut desk);
    desk.until("it is saved", is_saved);
    assert!(desk.studio.question.is_none() && desk.studio.diverged.is_none());
    assert_eq!(desk.studio.take_file_question(), None);
    // One edited byte changes one place in the text (issue 22.26).
    assert_eq!(file_text(&path), OWN.replace("\"00 01", "\"58 01"));
    desk.command(DeviceCommand::AskSave);
    assert!(matches!(desk.studio.take_file_question(), Some(FileQuestion::Save { .. })));

    // An encoder has no file, so the window asks for a path.
    let mut desk = Desk::new_form("");
    save(&mut desk);
    assert!(matches!(desk.studio.take_file_question(), Some(FileQuestion::Save { .. })));
}

/// The file has been changed in an editor. It is not replaced without a question, and each answer does what its label
/// says (issue 22.25).
#[test]
fn asks_before_overwriting_changed_file() {
    let theirs = OWN.replace("as wired", "as rewired").replace("01 02", "AA 02").replace("// end", "// theirs");
    let begun = || {
        let (mut desk, path) = opened(OWN);
        desk.put(0, 0, b"X");
        fs::write(&path, &theirs).unwrap();
        save(&mut desk);
        desk.until("it is asked", is_asked);
        assert_eq!(file_text(&path), theirs, "nothing was written");
        (desk, path)
    };
    let (mut desk, path) = begun();
    let rows = desk.studio.diverged.as_ref().unwrap().rows().to_vec();
    let told: Vec<(String, ChangedSide, Option<Side>)> =
        rows.iter().map(|row| (row.location(), row.changed, row.take)).collect();
    let expected = [
        ("note".to_owned(), ChangedSide::There, Some(Side::Theirs)),
        ("fields[number: 0].bytes[0]".to_owned(), ChangedSide::Both, None),
    ];
    assert_eq!(told, expected);
    assert!(rows[1].value(Side::Theirs).unwrap().starts_with("\"00 AA"));
    assert!(rows[1].value(Side::Mine).unwrap().starts_with("\"58 01"));
    assert!(!desk.studio.diverged.as_ref().unwrap().can_merge(), "who decides what both changed?");
    desk.act(Action::Resolve(ConflictResolution::Merge));
    assert!(desk.studio.diverged.is_some());
    desk.act(Action::Escape);
    assert!(desk.studio.diverged.is_none() && file_text(&path) == theirs && desk.encoder().staged.is_dirty());

    let (mut desk, path) = begun();
    desk.act(Action::Resolve(ConflictResolution::Reload));
    desk.settle();
    assert_eq!(file_text(&path), theirs);
    assert!(!desk.encoder().staged.is_dirty());
    assert_eq!(desk.encoder().staged.device_byte(0, 1), Some(0xAA));

    let (mut desk, path) = begun();
    desk.act(Action::Resolve(ConflictResolution::KeepMine));
    desk.until("it is saved", is_saved);
    assert_eq!(file_text(&path), OWN.replace("\"00 01", "\"58 01").replace("// end", "// theirs"));

    let (mut desk, path) = begun();
    desk.act(Action::Resolve(ConflictResolution::Take(1, Side::Mine)));
    desk.act(Action::Resolve(ConflictResolution::Merge));
    desk.until("it is saved", is_saved);
    assert_eq!(file_text(&path), theirs.replace("\"00 AA", "\"58 01"));
    // The saved content is now the open one, so the next save finds no difference.
    desk.put(0, 2, b"Z");
    save(&mut desk);
    desk.until("it is saved", is_saved);
    assert!(desk.studio.diverged.is_none() && file_text(&path).contains("58 01 5A"));

    let (mut desk, path) = begun();
    desk.act(Action::Resolve(ConflictResolution::Take(1, Side::Theirs)));
    desk.act(Action::Resolve(ConflictResolution::Merge));
    desk.until("the edit is gone", is_saved);
    assert_eq!(file_text(&path), theirs);
}

/// Changes to comments alone are not a difference, and are kept. A deleted file is written again, and an invalid one is
/// reported (issue 22.25).
#[test]
fn only_changed_values_differ() {
    let (mut desk, path) = opened(OWN);
    let commented = OWN.replace("// the motor", "// the motor of axis 2");
    fs::write(&path, &commented).unwrap();
    desk.put(0, 0, b"X");
    save(&mut desk);
    desk.until("it is saved", is_saved);
    assert_eq!(file_text(&path), commented.replace("\"00 01", "\"58 01"));

    fs::remove_file(&path).unwrap();
    desk.put(0, 1, b"Y");
    save(&mut desk);
    desk.until("it is saved", is_saved);
    assert_eq!(file_text(&path), commented.replace("\"00 01", "\"58 59"));

    fs::write(&path, "(schema: 1, ").unwrap();
    desk.put(0, 2, b"Z");
    save(&mut desk);
    desk.until("it is asked", is_asked);
    let diverged = desk.studio.diverged.as_ref().unwrap();
    assert_eq!(diverged.problem_text().unwrap().id(), "profile.invalid");
    assert!(!diverged.can_reload() && !diverged.can_merge() && diverged.can_overwrite_file());
    desk.act(Action::Resolve(ConflictResolution::KeepMine));
    desk.until("it is saved", is_saved);
    assert!(file_text(&path).contains("58 59 5A"));

    // A file from a newer version of the program is never replaced with an older form.
    let newer = file_text(&path).replace("schema: 1", "schema: 2");
    fs::write(&path, &newer).unwrap();
    desk.put(0, 3, b"W");
    save(&mut desk);
    desk.until("it is asked", is_asked);
    desk.act(Action::Resolve(ConflictResolution::KeepMine));
    desk.settle();
    assert!(desk.studio.diverged.as_ref().is_some_and(|own| !own.can_overwrite_file()));
    assert_eq!(file_text(&path), newer);
}

/// Before saving, the window lists the comments that would be lost (issue 22.26).
#[test]
fn asks_before_losing_comments() {
    let rows = "\"00 01 02 03 04 05 06 07\", // name plate\r\n\"08 09 0A 0B 0C 0D 0E 0F\"";
    let text = OWN.replace("\"00 01 02 03 04 05 06 07 08 09 0A 0B 0C 0D 0E 0F\"", rows);
    let (mut desk, path) = opened(&text);
    desk.put(0, 0, b"X");
    save(&mut desk);
    desk.until("it is asked", |studio| studio.question.is_some());
    let question = desk.studio.question.as_ref().unwrap();
    assert_eq!(question.text.id(), "question.comments");
    let words = question.text.to_string_in(encoder_studio::app::Language::English);
    assert!(words.contains("name plate") && !words.contains("the motor"), "{words}");
    assert_eq!(file_text(&path), text);
    desk.act(Action::Escape);
    assert!(desk.encoder().staged.is_dirty());
    save(&mut desk);
    desk.until("it is asked", |studio| studio.question.is_some());
    desk.act(Action::Confirm);
    desk.until("it is saved", is_saved);
    assert!(file_text(&path).starts_with("// bench 3\r\n") && file_text(&path).contains("// the motor\r\n"));
}

/// A byte order mark at the start of the file is kept (issue 22.26).
#[test]
fn keeps_byte_order_mark() {
    let (mut desk, path) = opened(&format!("\u{FEFF}{OWN}"));
    desk.put(0, 0, b"X");
    save(&mut desk);
    desk.until("it is saved", is_saved);
    assert_eq!(file_text(&path), format!("\u{FEFF}{}", OWN.replace("\"00 01", "\"58 01")));
}

/// A save dismisses earlier notices about its own document, but not about others (issue 22.28).
#[test]
fn save_dismisses_document_notices() {
    let (mut desk, path) = opened(OWN);
    desk.put(0, 0, b"X");
    desk.until_kept();
    let mut desk = desk.crash();
    desk.studio.start_with(None, Some(path.clone()));
    let stands = |studio: &Studio, id: &str| {
        studio.services.log.current().is_some_and(|own| own.texts.iter().any(|text| text.id() == id))
    };
    desk.until("the edits are back", |studio| stands(studio, "session.draft_back"));
    save(&mut desk);
    desk.until("it is saved", |studio| stands(studio, "session.saved"));

    desk.put(0, 1, b"Y");
    let session = desk.encoder().session.id;
    let suggested = "x.ron".into();
    let nowhere = desk.outside.path("no/where.ron");
    desk.act(Action::Chosen(FileQuestion::Save { session, suggested }, nowhere));
    desk.until("it is told", |studio| stands(studio, "session.not_saved"));
    assert_eq!(desk.studio.services.log.current().unwrap().severity, Severity::Error);
    assert_eq!(desk.studio.services.log.current().unwrap().texts[0].id(), "file.no_folder");
    save(&mut desk);
    desk.until("it is saved", |studio| stands(studio, "session.saved"));

    // The notice about another document remains.
    desk.act(Action::Open(desk.outside.path("none.ron")));
    desk.until("it is told", |studio| stands(studio, "file.not_found"));
    desk.put(0, 2, b"Z");
    save(&mut desk);
    desk.until("it is saved", is_saved);
    assert!(stands(&desk.studio, "file.not_found"));
    assert_eq!(*desk.phase(), Phase::Offline);
}

/// A measuring range that ends below a cam is reported on every page, and again when the profile is saved (issue
/// 22.28).
#[test]
fn reports_cams_beyond_smaller_range() {
    let mut desk = Desk::fresh("");
    let path = desk.outside.path("cams.ron");
    let text = "(schema: 1, device: \"interbus\",\n\
        parameters: (steps: 3600, revolutions: 1, direction: \"cw\", preset: 0, zero_shift: 0),\n\
        programs: [(program: 1, mask: 1, cams: [(cam: 0, start: 3000, stop: 3500)])],\n)\n";
    fs::write(&path, text).unwrap();
    desk.studio.start_with(None, Some(path.clone()));
    desk.until("it is open", |studio| studio.interbus().is_some());
    desk.settle();
    let own = |desk: &Desk| desk.studio.interbus().unwrap().session.id;
    assert!(desk.studio.interbus().unwrap().visible_marks(None).is_empty());
    let steps = Interbus::Edit(Box::new(Edit::Steps(1800)));
    let id = own(&desk);
    desk.act(Action::device(id, steps));
    let told: Vec<_> = desk.studio.interbus().unwrap().visible_marks(None).iter().map(|text| text.id()).collect();
    assert_eq!(told, ["cams.mark_beyond"]);
    let shown = ProgramNumber::FIRST;
    assert_eq!(desk.studio.interbus().unwrap().visible_marks(Some(shown)).len(), 1, "once, wherever it is shown");
    save(&mut desk);
    desk.until("it is saved", |studio| !studio.selected_device().unwrap().is_dirty());
    let standing = desk.studio.services.log.current().unwrap();
    let ids: Vec<_> = standing.texts.iter().map(|text| text.id()).collect();
    assert_eq!((standing.severity, ids), (Severity::Warning, vec!["session.saved", "cams.mark_beyond"]));
    assert_eq!(file_text(&path), text.replace("steps: 3600", "steps: 1800"));
}

/// Changes that others make to a closed file are kept when the edits are restored, for layouts, parameters and cams
/// alike, and also when the open file is reloaded (issue 22.27).
#[test]
fn restored_edits_keep_external_changes() {
    let ssi = "(schema: 1, device: \"ssi\", frame: (clocks: 25, multiturn: 12, singleturn: 12), preset: 7)\n";
    let drive = "(schema: 1, device: \"hiperdrive\",\n  drives: [(number: 1, parameters: {\n    166: 50,\n    186: 5,\n  })],\n)\n";
    let cams = "(schema: 1, device: \"interbus\",\n\
        parameters: (steps: 3600, revolutions: 1, direction: \"cw\", preset: 0, zero_shift: 0),\n\
        programs: [(program: 1, mask: 1, cams: [(cam: 0, start: 3000, stop: 3500)])],\n)\n";
    let interbus = |desk: &mut Desk, id| desk.act(Action::device(id, Interbus::Edit(Box::new(Edit::Preset(9)))));
    let hiperdrive = |desk: &mut Desk, id| {
        let number = encoder_studio::devices::hiperdrive::protocol::ParameterNumber::new(166).unwrap();
        desk.act(Action::device(id, Hiperdrive::Edit(Box::new(HiperdriveEdit::Set(number, 40)))));
    };
    let layout = |desk: &mut Desk, id| desk.act(Action::device(id, Ssi::Edit(Box::new(SsiEdit::Preset(9)))));
    type Make<'m> = &'m dyn Fn(&mut Desk, SessionId);
    type Change = (&'static str, &'static str);
    let cases: [(&str, Make, Change, Change); 3] = [
        (ssi, &layout, ("preset: 7", "preset: 9"), ("singleturn: 12)", "singleturn: 12, code: \"gray\")")),
        (drive, &hiperdrive, ("166: 50", "166: 40"), ("186: 5", "186: 8")),
        (cams, &interbus, ("preset: 0", "preset: 9"), ("start: 3000", "start: 3100")),
    ];
    for (text, make, (from, to), (was, is)) in cases {
        for crashes in [true, false] {
            let (mut desk, path) = opened(text);
            let id = desk.studio.selected_device().unwrap().id();
            make(&mut desk, id);
            assert!(desk.studio.selected_device().unwrap().is_dirty(), "{text}");
            let theirs = text.replace(was, is);
            until_kept(&mut desk);
            if crashes {
                desk = desk.crash();
                fs::write(&path, &theirs).unwrap();
                desk.studio.start_with(None, Some(path.clone()));
            } else {
                fs::write(&path, &theirs).unwrap();
                desk.act(Action::Open(path.clone()));
            }
            desk.until("the edits are there", |studio| {
                is_open(studio)
                    && studio.files_being_opened().is_empty()
                    && studio.selected_device().unwrap().is_dirty()
            });
            desk.settle();
            save(&mut desk);
            desk.until("it is saved", |studio| !studio.selected_device().unwrap().is_dirty());
            assert!(desk.studio.diverged.is_none());
            assert_eq!(file_text(&path), theirs.replace(from, to), "{crashes}");
        }
    }
}

/// Edits that are invalid together with the changes made by others are dropped with a notice (issue 22.27).
#[test]
fn drops_obsolete_restored_edits() {
    let text = "(schema: 1, device: \"ssi\", frame: (clocks: 25, multiturn: 12, singleturn: 12), preset: 7)\n";
    let theirs = text.replace("multiturn: 12, singleturn: 12", "steps: 3600");
    let mut desk = Desk::fresh("");
    let path = desk.outside.path("own.ron");
    fs::write(&path, text).unwrap();
    let is_open = |studio: &Studio| studio.selected_device().is_some_and(|own| *own.phase() == Phase::Offline);
    desk.studio.start_with(None, Some(path.clone()));
    desk.until("it is open", is_open);
    desk.settle();
    let id = desk.studio.selected_device().unwrap().id();
    let range = Range::Bits { multiturn: 12, singleturn: 11 };
    desk.act(Action::device(id, Ssi::Edit(Box::new(SsiEdit::Position(range, Code::Binary)))));
    assert!(desk.studio.selected_device().unwrap().is_dirty());
    until_kept(&mut desk);
    let mut desk = desk.crash();
    fs::write(&path, &theirs).unwrap();
    desk.studio.start_with(None, Some(path.clone()));
    let problem = |studio: &Studio| studio.ssi().and_then(|own| own.designer.problem()).map(|own| own.id());
    desk.until("it is told", |studio| problem(studio) == Some("ssi.draft_unfit"));
    assert!(is_open(&desk.studio) && !desk.studio.selected_device().unwrap().is_dirty());
    assert_eq!(file_text(&path), theirs);
}

/// A draft of an earlier version contains the complete layout (issue 22.27).
#[test]
fn complete_layout_draft_still_opens() {
    let text = "(schema: 1, device: \"ssi\", frame: (clocks: 25, multiturn: 12, singleturn: 12), preset: 7)\n";
    let (mut desk, path) = opened(text);
    let id = desk.studio.selected_device().unwrap().id();
    desk.act(Action::device(id, Ssi::Edit(Box::new(SsiEdit::Preset(9)))));
    until_kept(&mut desk);
    let folder = desk.outside.path("data/drafts/ssi-files");
    let draft = fs::read_dir(folder).unwrap().next().unwrap().unwrap().path();
    let desk = desk.crash();
    // This is the form that version 1 wrote.
    let whole = text.replace("preset: 7", "preset: 11").replace('"', "\\\"").replace('\n', "");
    fs::write(draft, format!("[\"{whole}\"]")).unwrap();
    let mut desk = desk;
    desk.studio.start_with(None, Some(path));
    desk.until("the edit is back", |studio| studio.selected_device().is_some_and(AnyDevice::is_dirty));
    assert_eq!(desk.studio.ssi().unwrap().design().profile.preset, 11);
}
