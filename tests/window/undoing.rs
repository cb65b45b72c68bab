//! Tests of undoing a write from the logbook, for every kind of device with a memory. Before a write, the review states
//! whether it can be undone later.

use encoder_studio::app::review::{ReviewSheet, Stage};
use encoder_studio::app::{Action, DeviceCommand, Language, ReviewAction, Text};
use encoder_studio::devices::biss::jobs::Change as BissChange;
use encoder_studio::devices::biss::profile::{MotorSource, MountingSteps};
use encoder_studio::devices::biss::state::BissAction as Biss;
use encoder_studio::devices::hiperdrive::jobs::Change as HiperdriveChange;
use encoder_studio::devices::hiperdrive::protocol::DriveNumber;
use encoder_studio::devices::hiperdrive::state::HiperdriveAction as Hiperdrive;
use encoder_studio::devices::hiperface::jobs::Change as HiperfaceChange;
use encoder_studio::devices::hiperface::protocol::{AccessCode, AccessCodeNumber, DeviceAddress};
use encoder_studio::devices::hiperface::state::HiperfaceAction as Hiperface;
use encoder_studio::devices::interbus::jobs::Change as InterbusChange;
use encoder_studio::devices::interbus::state::InterbusAction as Interbus;
use encoder_studio::store::{Entry, EntryFilter, EntryKind, Logbook};

use crate::each_kind::{CASES, Case, command, review, shown, until_ready, until_stage, write};
use crate::support::Desk;
use crate::tabs;

fn newest_write(desk: &Desk) -> Entry {
    let logbook = Logbook::open(&desk.outside.store().logbook_path()).unwrap();
    let entries = logbook.entries(&EntryFilter::default(), 20).unwrap();
    entries.into_iter().find(|entry| entry.kind.has_result()).expect("a write is recorded")
}

fn sheet(desk: &Desk) -> ReviewSheet {
    shown(&desk.studio).unwrap().review_sheet().expect("a review is open")
}

fn undo_texts(desk: &Desk) -> Vec<String> {
    sheet(desk).undo.iter().map(|text| text.to_string_in(Language::English)).collect()
}

fn case_for_tab(tab: encoder_studio::app::Tab) -> Case {
    CASES.into_iter().find(|case| case.tab == tab).unwrap()
}

/// Plans a change with a device action and waits for the review.
#[track_caller]
fn plan(desk: &mut Desk, action: impl FnOnce(encoder_studio::app::SessionId) -> Action) {
    let id = shown(&desk.studio).unwrap().id();
    desk.act(action(id));
    until_stage(desk, |stage| matches!(stage, Stage::Ready(_)));
    until_ready(desk);
}

const EXACT_UNDO_TEXT: &str = "This write can be fully undone from the logbook.";

#[test]
fn undo_has_announced_effect() {
    for case in CASES.into_iter().filter(|case| case.tab != tabs::NOVEL) {
        let mut desk = case.desk();
        case.edit(&mut desk, &[0x5A]);
        write(&mut desk);
        let written = newest_write(&desk);
        assert_eq!(written.kind, EntryKind::Write);
        let (old, new) = (written.items[0].old.clone(), written.items[0].new.clone());
        assert_ne!(old, new, "{written:?}");
        command(&mut desk, DeviceCommand::UndoWrite(Box::new(written.clone())));
        until_stage(&mut desk, |stage| matches!(stage, Stage::Ready(_)));
        until_ready(&mut desk);
        let Stage::Ready(plan) = sheet(&desk).stage else { panic!("no plan") };
        assert_eq!(undo_texts(&desk), [EXACT_UNDO_TEXT]);
        review(&mut desk, ReviewAction::Write(plan));
        until_stage(&mut desk, |stage| matches!(stage, Stage::Done { .. }));
        until_ready(&mut desk);
        let undo = newest_write(&desk);
        assert_eq!((undo.kind, undo.undoes.map(|link| link.id)), (EntryKind::Restore, Some(written.id)));
        assert_eq!(undo.items[0].item, written.items[0].item);
        assert_eq!((&undo.items[0].old, &undo.items[0].new), (&new, &old));
    }
}

#[test]
fn review_announces_undo() {
    let mut desk = case_for_tab(tabs::HIPERFACE).desk();
    let hiperface = |change: HiperfaceChange| move |id| Action::device(id, Hiperface::Plan(change));
    case_for_tab(tabs::HIPERFACE).edit(&mut desk, &[0x5A]);
    command(&mut desk, DeviceCommand::Review);
    until_stage(&mut desk, |stage| matches!(stage, Stage::Ready(_)));
    until_ready(&mut desk);
    assert_eq!(undo_texts(&desk), [EXACT_UNDO_TEXT]);
    let code = HiperfaceChange::ChangeCode { number: AccessCodeNumber::new(2).unwrap(), new: AccessCode::new(0xA7) };
    let position = HiperfaceChange::SetPosition { wanted: 4096, exact: false, synchronise: false, kit: false };
    for (change, words) in [
        (code, "Change the access code again"),
        (position, "Set the position again."),
        (HiperfaceChange::IncrementCounter, "counter"),
    ] {
        plan(&mut desk, hiperface(change));
        let [text] = undo_texts(&desk).try_into().unwrap();
        assert!(text.starts_with("Cannot be undone: ") && text.contains(words), "{text}");
    }
    // The backup does not contain the device address 40h.
    plan(&mut desk, hiperface(HiperfaceChange::SetAddress(DeviceAddress::new(0x45).unwrap())));
    let [text] = undo_texts(&desk).try_into().unwrap();
    assert!(text.starts_with("To undo ") && text.contains("write 40 again (write cycles: 1)"), "{text}");
}

#[test]
fn procedure_review_lists_remaining_steps() {
    let mut desk = case_for_tab(tabs::BISS).desk();
    let run = MountingSteps { calibrate: true, ..MountingSteps::default() };
    let change = BissChange::Guided { run, motor: MotorSource::Other };
    plan(&mut desk, |id| Action::device(id, Biss::Plan(Box::new(change))));
    let [text] = undo_texts(&desk).try_into().unwrap();
    assert!(text.starts_with("Cannot be undone: ") && text.ends_with("Repeat the procedure."), "{text}");

    let mut desk = case_for_tab(tabs::INTERBUS).desk();
    plan(&mut desk, |id| Action::device(id, Interbus::Plan(Box::new(InterbusChange::Default))));
    let [text] = undo_texts(&desk).try_into().unwrap();
    assert!(text.starts_with("To undo ") && text.ends_with(", restore the backup."), "{text}");
    plan(&mut desk, |id| Action::device(id, Interbus::Plan(Box::new(InterbusChange::Preset { value: 7 }))));
    assert!(undo_texts(&desk).iter().any(|text| text.ends_with("Set the position again.")), "{:?}", undo_texts(&desk));

    let mut desk = case_for_tab(tabs::HIPERDRIVE).desk();
    let change = HiperdriveChange::SetPosition { drive: DriveNumber::FIRST, position: 6400, save: true };
    plan(&mut desk, |id| Action::device(id, Hiperdrive::Plan(Box::new(change))));
    let [text] = undo_texts(&desk).try_into().unwrap();
    assert!(text.starts_with("Cannot be undone: ") && text.ends_with("Set the position again."), "{text}");
    for language in [Language::German, Language::English] {
        assert!(sheet(&desk).undo.iter().all(|text: &Text| !text.to_string_in(language).contains('{')));
    }
}
