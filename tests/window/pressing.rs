//! Tests that a press and its release reach the same button and that the keyboard focus stays, whatever appears or
//! disappears elsewhere. Previously, clicks on a drive's button were lost while its limits were read (issue 21.7).

use std::collections::BTreeMap;

use egui::accesskit::Role;
use egui::{Event, Modifiers, PointerButton};
use egui_kittest::kittest::{NodeT, Queryable};
use encoder_studio::app::{Action, DeviceCommand, Tab};
use encoder_studio::devices::hiperface::state::{HiperfaceAction as Hiperface, ReviewState};
use encoder_studio::devices::interbus::state::InterbusAction as Interbus;

use crate::screen::Screen;
use crate::support::{DRIVE, GATE, KIT, Outside, PORT, is_review};

const SIZE: [f32; 2] = [1280.0, 900.0];

/// The tested kinds: the tab, the scheme and target of the link, and a command sent when the device is read.
const KINDS: [(Tab, &str, &str, u8); 4] = [
    (crate::tabs::HIPERFACE, "serial", PORT, 0x52),
    (crate::tabs::BISS, "serial", KIT, 0x01),
    // Function 4 reads a word.
    (crate::tabs::INTERBUS, "modbus", GATE, 4),
    // The service that reads an attribute.
    (crate::tabs::HIPERDRIVE, "enip", DRIVE, 0x0E),
];

/// Returns the IDs of the widgets that can be pressed or typed into, by name. Names that occur more than once are left
/// out.
fn widgets(screen: &Screen) -> BTreeMap<String, String> {
    let (mut found, mut several) = (BTreeMap::new(), Vec::new());
    for node in screen.harness.query_all_by(|node| {
        matches!(node.role(), Role::Button | Role::RadioButton | Role::CheckBox | Role::TextInput | Role::ComboBox)
    }) {
        let node = node.accesskit_node();
        let name = format!("{:?} {}", node.role(), node.label().unwrap_or_default());
        if found.insert(name.clone(), format!("{:?}", node.id())).is_some() {
            several.push(name);
        }
    }
    found.retain(|name, _| !several.contains(name));
    found
}

#[track_caller]
fn check(screen: &Screen, before: &BTreeMap<String, String>, what: &str) {
    let now = widgets(screen);
    let other: Vec<&String> =
        before.iter().filter(|(name, id)| now.get(*name).is_some_and(|own| own != *id)).map(|own| own.0).collect();
    assert!(other.is_empty(), "{what}: no longer the same: {other:?}");
    assert!(before.len() > 8, "{what}: {}", before.len());
}

fn ready(screen: &mut Screen) {
    screen.until("it is ready", |studio| {
        studio.selected_device().is_some_and(|own| own.is_readable()) && !studio.is_working()
    });
}

/// A notice or a running job appears or disappears (issue 21.7).
#[test]
fn notices_and_progress_do_not_move_buttons() {
    for (tab, scheme, port, reads) in KINDS {
        let mut screen = Screen::open_in_tab(tab, &format!("{scheme}:{port}"), SIZE);
        ready(&mut screen);
        let id = screen.studio().selected_device().unwrap().id();
        if tab == crate::tabs::INTERBUS {
            // The encoder is read only after the user has confirmed that the machine is stopped.
            screen.act(Action::device(id, Interbus::ConfirmStandstill(true)));
        }
        screen.act(Action::Dismiss);
        for page in encoder_studio::kinds::program().tabs.page_text_ids(tab) {
            screen.click(page);
            let before = widgets(&screen);
            screen.act(Action::NoThread("told".to_owned()));
            check(&screen, &before, &format!("{tab:?}, {page}, with a notice"));
            screen.act(Action::Dismiss);
            check(&screen, &before, &format!("{tab:?}, {page}, without it"));
            let wire = screen.outside.wire(port).clone();
            wire.hold_at(reads, 1);
            let read = screen.studio().selected_device().unwrap().command(DeviceCommand::Read);
            screen.act(read);
            wire.wait_until_held();
            screen.steps();
            assert!(screen.studio().selected_device().unwrap().running_job().is_some(), "{tab:?}");
            check(&screen, &before, &format!("{tab:?}, {page}, while it is read"));
            wire.release();
            ready(&mut screen);
            screen.act(Action::Dismiss);
            check(&screen, &before, &format!("{tab:?}, {page}, read"));
        }
    }
}

/// A notice appears or disappears between the press and the release (issue 21.7).
#[test]
fn click_survives_layout_changes() {
    for comes in [true, false] {
        let mut screen = Screen::new_form(SIZE);
        if !comes {
            screen.act(Action::NoThread("told".to_owned()));
        }
        let place = screen.button("page.memory").rect().center();
        let button = |pressed| Event::PointerButton {
            pos: place,
            button: PointerButton::Primary,
            pressed,
            modifiers: Modifiers::NONE,
        };
        screen.harness.hover_at(place);
        screen.harness.event(button(true));
        screen.harness.step();
        screen.studio().mailbox().send(if comes { Action::NoThread("told".to_owned()) } else { Action::Dismiss });
        screen.harness.step();
        screen.harness.event(button(false));
        screen.steps();
        assert!(screen.has_button("memory.review"), "{comes}");
    }
}

/// A button of the review has the keyboard focus while the plan is made. When the plan is complete, no button has it
/// (issue 22.29).
#[test]
fn ready_review_ignores_earlier_key() {
    let mut screen = Screen::opened(Outside::new(""), Some(&format!("serial:{PORT}")), SIZE);
    ready(&mut screen);
    screen.ask(Hiperface::Put { field: 0, address: 0, bytes: vec![0] });
    let wire = screen.outside.wire(PORT).clone();
    // The cable is held at the request for the status of the data field.
    wire.hold_at(0x4C, 1);
    screen.command(DeviceCommand::Review);
    wire.wait_until_held();
    screen.steps();
    screen.button("review.cancel").focus();
    screen.steps();
    assert!(screen.button("review.cancel").accesskit_node().is_focused());
    wire.release();
    screen.until("it is ready", |studio| is_review(studio, |state| matches!(state, ReviewState::Ready(_))));
    for id in ["review.write", "review.cancel"] {
        assert!(!screen.button(id).accesskit_node().is_focused(), "{id}");
    }
}
