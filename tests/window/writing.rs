//! Tests that an edit is reviewed, written and read back, and that nothing is written without a review.

use crate::tabs::Tabs as _;
use encoder_studio::app::DeviceCommand;
use encoder_studio::app::session::DeviceHistory;
use encoder_studio::app::{Action, BackupReadResult, Language, PendingEdits, Severity, TaskResult, Text};
use encoder_studio::devices::hiperface::jobs::Change;
use encoder_studio::devices::hiperface::profile::HiperfaceProfile;
use encoder_studio::devices::hiperface::profile::{FieldRange, Op};
use encoder_studio::devices::hiperface::protocol::{AccessCodeNumber, DataFieldStatus, FieldSize};
use encoder_studio::devices::hiperface::state::{HiperfaceAction as Hiperface, ReviewState, forms, rules};
use encoder_studio::kinds::program;
use encoder_studio::profile::ProfileDocument;
use encoder_studio::store::{DeviceKey, Outcome, read_text};

use crate::support::{Desk, is_review};
use crate::texts;

/// Address of the low byte of the rated current (01 22h at 18), which follows the speed on the name plate of the SKM36.
const RATED: usize = 19;

#[test]
fn edits_reviews_and_writes_byte() {
    let mut desk = Desk::new_form("");
    desk.put(0, RATED, &[0x23]);
    let staged = &desk.encoder().staged;
    assert_eq!((staged.device_byte(0, RATED), staged.byte(0, RATED)), (Some(0x22), Some(0x23)));
    assert_eq!(desk.wire().field(0)[RATED], 0x22);

    desk.command(DeviceCommand::Review);
    desk.until_planned();
    let ReviewState::Ready(prepared) = &desk.review().state else { panic!() };
    let status = DataFieldStatus::from_byte(0xC9);
    let store = Op::Store { field: 0, address: 19, status, old: Some(vec![0x22]), new: vec![0x23] };
    assert_eq!(prepared.plan.ops, [store]);
    let line = &desk.review().to_sheet(0).lines[0];
    let words: Vec<String> = line.texts().map(|text| text.to_string_in(Language::German)).collect();
    assert_eq!(words, ["Datenfeld 0, Byte 19", "22", "23"]);
    assert_eq!(desk.wire().wear(), 0, "looking is no writing");

    desk.write_as_shown();
    assert!(desk.encoder().session.is_writing());
    desk.until_written();
    let ReviewState::Done(_, committed) = &desk.review().state else { panic!() };
    assert_eq!((committed.written.ops, committed.written.write_cycles), (1, 1));
    assert_eq!(desk.wire().field(0)[RATED], 0x23);
    assert_eq!(desk.encoder().staged.device_byte(0, RATED), Some(0x23));
    assert!(!desk.encoder().staged.is_dirty());
    assert_eq!(desk.notice_count("session.written"), 1);
    desk.ask(Hiperface::CloseReview);
    assert!(desk.encoder().session.review.is_none());
}

#[test]
fn assigns_device_to_asset() {
    let mut desk = Desk::new_form("");
    assert_eq!(desk.encoder().session.asset, None);
    desk.command(DeviceCommand::Assign("Achse 7".parse().unwrap()));
    desk.until("the assignment is listed", |studio| {
        studio.hiperface().unwrap().session.asset.as_deref() == Some("Achse 7")
    });
    let writes = desk.encoder().session.writes.clone().unwrap().unwrap();
    assert_eq!(writes.len(), 0, "an assignment is not a write");
}

#[test]
fn write_leaves_backup_and_logbook_entry() {
    let mut desk = Desk::new_form("");
    desk.put(0, RATED, &[0x23]);
    desk.write();
    let ReviewState::Done(_, committed) = &desk.review().state else { panic!() };
    let backup = committed.backup.clone().unwrap();
    let profile = ProfileDocument::parse(&read_text(&backup).unwrap(), program().studio.formats)
        .unwrap()
        .body
        .into_profile::<HiperfaceProfile>()
        .unwrap();
    assert_eq!(profile.identity.serial_number, "GB0450179");
    assert_eq!(profile.fields[0].bytes.as_ref().unwrap()[RATED], 0x22, "as it was before");

    desk.until(
        "the lists are read",
        |studio| matches!(&studio.hiperface().unwrap().session.writes, Some(Ok(own)) if own.len() == 1),
    );
    let backups = desk.encoder().session.backups.clone().unwrap().unwrap();
    assert_eq!(backups.iter().map(|own| &own.path).collect::<Vec<_>>(), [&backup]);
    let writes = desk.encoder().session.writes.clone().unwrap().unwrap();
    assert_eq!((writes[0].planned_cycles, writes[0].backup.as_ref()), (1, Some(&backup)));
    let conclusion = writes[0].conclusion.as_ref().unwrap();
    assert_eq!((&conclusion.outcome, conclusion.cycles_spent), (&Outcome::Done, 1));

    // The next plan includes the write cycles of the encoder, and the backup restores it.
    desk.command(DeviceCommand::Restore(backup));
    desk.until_planned();
    let ReviewState::Ready(prepared) = &desk.review().state else { panic!() };
    assert_eq!(prepared.cycles_seen, Some(encoder_studio::worker::commit::CycleCount::complete(1)));
    desk.write_as_shown();
    desk.until_written();
    assert_eq!(desk.wire().field(0)[RATED], 0x22);
}

#[test]
fn writes_nothing_without_consent() {
    let mut desk = Desk::new_form("");
    let before = desk.wire().field(0);
    desk.put(0, 0, b"X");
    desk.write_as_shown();
    assert!(!desk.encoder().session.is_busy(), "there is no plan");
    desk.command(DeviceCommand::Review);
    // Before the plan is shown, there is nothing to consent to.
    desk.write_as_shown();
    desk.until_planned();
    desk.ask(Hiperface::CloseReview);
    desk.write_as_shown();
    desk.settle();
    assert!(!desk.encoder().session.is_busy() && desk.encoder().session.review.is_none());
    assert_eq!((desk.wire().field(0), desk.wire().wear()), (before, 0));
    assert_eq!(desk.edits(), [(0, 0, b'X')], "the edit stays");
    assert!(!desk.outside.path("data/backups").exists());
}

#[test]
fn write_pressed_twice_writes_once() {
    let mut desk = Desk::new_form("");
    desk.put(0, 0, b"X");
    desk.command(DeviceCommand::Review);
    desk.until_planned();
    for _ in 0..3 {
        desk.write_as_shown();
    }
    desk.until_written();
    desk.write_as_shown();
    desk.settle();
    assert_eq!((desk.wire().count(0x4B), desk.wire().wear()), (1, 1));
    assert!(!desk.notice_ids(Severity::Note).contains(&"session.busy"));
}

#[test]
fn does_not_write_equal_bytes() {
    let mut desk = Desk::new_form("");
    desk.command(DeviceCommand::Review);
    assert_eq!(desk.notice_ids(Severity::Note).last(), Some(&"session.nothing_edited"));
    desk.put(0, 0, b"E");
    assert!(!desk.encoder().staged.is_dirty(), "E stands there");
    desk.ask(Hiperface::Plan(Change::Store(vec![(FieldRange::new(0, 0, 1), b"E".to_vec())])));
    desk.until_planned();
    desk.write_as_shown();
    desk.until_written();
    assert_eq!(desk.wire().wear(), 0);
}

#[test]
fn does_not_write_edits_after_planning() {
    let mut desk = Desk::new_form("");
    desk.put(0, 0, b"X");
    desk.command(DeviceCommand::Review);
    desk.until_planned();
    desk.put(0, 1, b"Y");
    desk.write_as_shown();
    desk.until_written();
    assert_eq!(desk.wire().field(0)[..2], *b"XM");
    assert_eq!(desk.edits(), [(0, 1, b'Y')]);
}

#[test]
fn exchanged_encoder_prevents_planned_write() {
    let mut desk = Desk::new_form("");
    desk.put(0, 0, b"X");
    desk.command(DeviceCommand::Review);
    desk.until_planned();
    desk.wire().exchange("model=skm36&serial=AA1");
    desk.write_as_shown();
    desk.until("it is refused", |studio| {
        is_review(studio, |state| matches!(state, ReviewState::Failed { begun: false, .. }))
    });
    assert_eq!(desk.wire().wear(), 0);
}

#[test]
fn consent_covers_only_shown_plan() {
    let mut desk = Desk::new_form("");
    desk.put(0, 0, b"X");
    desk.command(DeviceCommand::Review);
    desk.until_planned();
    let drawn = desk.review().prepared_plan().unwrap().plan.id();
    desk.ask(Hiperface::CloseReview);
    desk.put(0, 1, b"Y");
    desk.command(DeviceCommand::Review);
    desk.until_planned();
    desk.ask(Hiperface::Write(drawn));
    desk.settle();
    assert!(!desk.encoder().session.is_busy() && matches!(desk.review().state, ReviewState::Ready(_)));
    assert_eq!(desk.wire().wear(), 0);
    desk.write_as_shown();
    desk.until_written();
    assert_eq!(desk.wire().field(0)[..2], *b"XY");
}

#[test]
fn forced_write_does_not_force_next_plan() {
    let mut desk = Desk::new_form("");
    desk.put(0, 0, b"X");
    desk.write();
    let ReviewState::Done(_, committed) = &desk.review().state else { panic!() };
    let backup = committed.backup.clone().unwrap();
    desk.command(DeviceCommand::Restore(backup));
    desk.until_planned();
    desk.ask(Hiperface::ForceWear(true));
    assert!(desk.review().force_wear);
    let options = desk.review().options().unwrap();
    desk.ask(Hiperface::PlanAgain(options));
    assert!(!desk.review().force_wear);
    desk.until_planned();
}

#[test]
fn rejects_changes_that_discard_edits() {
    let mut desk = Desk::new_form("");
    desk.put(0, 20, b"X");
    let (memory, first) = (desk.encoder().identity.as_ref().unwrap().memory.unwrap(), desk.encoder().field(0).unwrap());
    let offered = rules::delete(memory, first, &desk.encoder().staged);
    let small = FieldSize::from_bytes(16).unwrap();
    let why = crate::texts::text("rules.edits").with("field", 0).with("count", 1);
    assert_eq!(offered, Err(why.clone()));
    assert_eq!(rules::resize(memory, first, small, &desk.encoder().staged), Err(why.clone()));
    assert_eq!(refused(&mut desk, Change::DeleteField { number: 0 }), why);
    assert_eq!(refused(&mut desk, Change::ResizeField { number: 0, size: small }), why);
    desk.command(DeviceCommand::RevertAll);
    change(&mut desk, Change::ResizeField { number: 0, size: small });
    desk.put(0, 0, b"X");
    change(&mut desk, Change::LockField { number: 0, lock: true });
    assert_eq!(desk.edits(), [(0, 0, b'X')], "what keeps the bytes keeps the edits");
}

#[test]
fn field_with_unknown_code_stays_unchanged() {
    let mut desk = Desk::connected_at_port("codes=0:9D");
    let why = crate::texts::text("rules.code_unknown").with("field", 0).with("number", AccessCodeNumber::ZERO);
    let small = FieldSize::from_bytes(16).unwrap();
    let sent = desk.wire().sent();
    for change in [
        Change::LockField { number: 0, lock: true },
        Change::DeleteField { number: 0 },
        Change::ResizeField { number: 0, size: small },
        Change::ChangeCode { number: AccessCodeNumber::ZERO, new: forms::access_code("11").unwrap() },
    ] {
        assert_eq!(refused(&mut desk, change), why);
    }
    assert_eq!(desk.wire().sent(), sent, "nothing is sent");
    assert_eq!(rules::status(desk.encoder().field(0).unwrap()), Err(why));
}

#[test]
fn checks_and_hides_access_code() {
    let mut desk = Desk::connected_at_port("codes=0:9D");
    for (code, id) in [("1C", "session.code_wrong"), ("9D", "session.code_fits")] {
        let code = forms::access_code(code).unwrap();
        desk.ask(Hiperface::UseCode { number: AccessCodeNumber::ZERO, code });
        desk.until_ready();
        assert_eq!(*desk.notice_ids(Severity::Note).last().unwrap(), id);
    }
    let log = crate::support::log(&desk.studio);
    assert!(!log.contains("9D") && !log.contains("1C"), "{log}");
    desk.ask(Hiperface::UseCode { number: AccessCodeNumber::new(2).unwrap(), code: forms::access_code("11").unwrap() });
    desk.until_ready();
    assert_eq!(*desk.notice_ids(Severity::Note).last().unwrap(), "session.code_unused");
}

/// Lists and backups requested before the encoder was replaced are dropped when they arrive.
#[test]
fn drops_late_results_for_another_encoder() {
    let mut desk = Desk::new_form("");
    desk.put(0, 0, b"X");
    desk.write();
    desk.ask(Hiperface::CloseReview);
    desk.until(
        "the list is read",
        |studio| matches!(&studio.hiperface().unwrap().session.backups, Some(Ok(own)) if own.len() == 1),
    );
    let id = desk.encoder().session.id;
    let other = DeviceKey {
        kind: "hiperface".to_owned(),
        device_type: "37h".to_owned(),
        serial_number: "OTHER0001".to_owned(),
        is_virtual: true,
    };
    let listed = Box::new(DeviceHistory {
        asset: None,
        backups: Ok(Vec::new()),
        writes: Ok(Vec::new()),
        cycles: Some(encoder_studio::worker::commit::CycleCount::complete(0)),
        statuses: Vec::new(),
    });
    desk.act(Action::Done(TaskResult::Listed(id, other.clone(), listed)));
    assert_eq!(desk.encoder().session.backups.as_ref().unwrap().as_ref().unwrap().len(), 1);
    let path = desk.encoder().session.backups.as_ref().unwrap().as_ref().unwrap()[0].path.clone();
    let document = Box::new(ProfileDocument::parse(&read_text(&path).unwrap(), program().studio.formats).unwrap());
    desk.act(Action::Done(TaskResult::Backup(
        id,
        Box::new(BackupReadResult { of: other, path, undone: None, result: Ok(document) }),
    )));
    assert!(desk.encoder().session.review.is_none() && !desk.encoder().session.is_busy());
}

/// Connects to an encoder that has a second data field, so the first field is not the last one.
fn with_two_fields() -> Desk {
    let mut desk = Desk::new_form("");
    let status = DataFieldStatus::new(FieldSize::from_bytes(16).unwrap(), AccessCodeNumber::ZERO, true);
    change(&mut desk, Change::CreateField { number: 1, status });
    assert_eq!(desk.encoder().staged.device().len(), 2);
    desk
}

fn change(desk: &mut Desk, change: Change) {
    desk.ask(Hiperface::Plan(change));
    desk.until_planned();
    desk.write_as_shown();
    desk.until_written();
    desk.ask(Hiperface::CloseReview);
}

/// Returns the reason why a change cannot be planned.
fn refused(desk: &mut Desk, change: Change) -> Text {
    let wear = desk.wire().wear();
    desk.ask(Hiperface::Plan(change));
    desk.until("it is refused", |studio| {
        is_review(studio, |state| matches!(state, ReviewState::Failed { begun: false, .. }))
    });
    let ReviewState::Failed { texts, .. } = &desk.review().state else { panic!() };
    let text = texts[0].clone();
    texts::check(&text);
    assert_eq!(desk.wire().wear(), wear);
    desk.ask(Hiperface::CloseReview);
    desk.until_ready();
    text
}

#[test]
fn rejects_changes_violating_field_rules() {
    let mut desk = with_two_fields();
    let memory = desk.encoder().identity.as_ref().unwrap().memory.unwrap();
    let first = desk.encoder().field(0).unwrap().clone();
    let larger = FieldSize::from_bytes(64).unwrap();

    let not_last = refused(&mut desk, Change::DeleteField { number: 0 });
    assert_eq!(
        rules::delete(memory, &first, &desk.encoder().staged),
        Err(not_last.clone()),
        "the button says the same"
    );
    assert_eq!(not_last, crate::texts::text("plan.not_last").with("field", 0).with("last", 1));
    assert_ne!(not_last.to_string_in(Language::English), not_last.to_string_in(Language::German));
    assert_eq!(refused(&mut desk, Change::ResizeField { number: 0, size: larger }), not_last);
    assert_eq!(rules::resize(memory, &first, larger, &desk.encoder().staged), Err(not_last));

    let status = DataFieldStatus::new(larger, AccessCodeNumber::ZERO, true);
    assert_eq!(refused(&mut desk, Change::CreateField { number: 5, status }).id(), "plan.not_next");
    assert_eq!(refused(&mut desk, Change::DeleteField { number: 7 }).id(), "encoder.no_field");
}

#[test]
fn rejects_field_exceeding_memory() {
    let mut desk = Desk::new_form("");
    // 112 blocks minus two for the name plate: 13 fields of 128 bytes leave six blocks.
    let size = FieldSize::from_bytes(128).unwrap();
    let status = DataFieldStatus::new(size, AccessCodeNumber::ZERO, false);
    for number in 1..=13 {
        change(&mut desk, Change::CreateField { number, status });
    }
    let memory = desk.encoder().identity.as_ref().unwrap().memory.unwrap();
    assert_eq!((memory.blocks, memory.fields), (6, 14));
    let why = refused(&mut desk, Change::CreateField { number: 14, status });
    assert_eq!(why.id(), "plan.no_memory");
    assert_eq!(rules::create(memory, size, AccessCodeNumber::ZERO, false), Err(why));
}

#[test]
fn write_protected_field_cannot_be_edited() {
    let mut desk = Desk::new_form("");
    change(&mut desk, Change::LockField { number: 0, lock: true });
    desk.put(0, 0, b"X");
    assert!(!desk.encoder().staged.is_dirty());
    assert_eq!(desk.notice_ids(Severity::Error), ["plan.write_protected"]);
    change(&mut desk, Change::LockField { number: 0, lock: false });
    desk.put(0, 0, b"X");
    assert!(desk.encoder().staged.is_dirty());
}

#[test]
fn rejects_edit_outside_field() {
    let mut desk = Desk::new_form("");
    desk.put(0, 31, &[1, 2]);
    desk.put(3, 0, &[1]);
    assert!(desk.edits().is_empty());
    let told = desk.notice_ids(Severity::Error);
    assert_eq!(told.len(), 2, "{told:?}");
    assert_ne!(told[0], told[1]);
}

#[test]
fn protected_field_opens_with_code() {
    let mut desk = Desk::connected_at_port("codes=0:9D");
    assert_eq!(desk.encoder().field(0).unwrap().bytes, None);
    desk.put(0, 0, b"X");
    assert_eq!(desk.notice_ids(Severity::Error), ["encoder.code_unknown"]);
    let code = encoder_studio::devices::hiperface::state::forms::access_code("9D").unwrap();
    desk.ask(Hiperface::UseCode { number: AccessCodeNumber::ZERO, code });
    desk.until("the field is readable", |studio| studio.hiperface().unwrap().field(0).unwrap().bytes.is_some());
    desk.until_ready();
    desk.put(0, 0, b"X");

    desk.wire().unplug();
    desk.until("it is lost", |studio| studio.hiperface().unwrap().session.live_session().is_none());
    desk.wire().plug();
    desk.command(DeviceCommand::Reconnect);
    desk.until_read();
    assert_eq!(desk.edits(), [(0, 0, b'X')], "the code is still known");
    desk.write();
    assert_eq!(desk.wire().field(0)[0], b'X');
    assert!(
        !desk
            .encoder()
            .session
            .trace
            .lines()
            .iter()
            .any(|line| line.bytes.contains("9D") || line.to_string_in(Language::English).contains("9D"))
    );

    // After a restart, the code is unknown, and the draft waits for it.
    desk.put(0, 1, b"Y");
    desk.until_kept();
    let mut desk = desk.crash();
    desk.open("serial:/dev/enc0");
    desk.until_read();
    assert_eq!(desk.encoder().field(0).unwrap().bytes, None);
    desk.ask(Hiperface::UseCode { number: AccessCodeNumber::ZERO, code });
    desk.until("the edit is back", |studio| studio.hiperface().unwrap().staged.byte(0, 1) == Some(b'Y'));
}
