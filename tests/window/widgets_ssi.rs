//! Tests of the pages in the SSI tab, operated by keys and typing.

use crate::tabs::Tabs as _;
use egui::accesskit::Role;
use egui::{Key, Modifiers};
use egui_kittest::kittest::{NodeT, Queryable};
use encoder_studio::app::Action;
use encoder_studio::app::DeviceCommand;
use encoder_studio::devices::ssi::state::{Field, FieldInput, SearchState, SsiAction as Ssi, TrialInput};

use crate::screen::Screen;
use crate::support::Outside;

const SIZE: [f32; 2] = [1280.0, 800.0];

fn layout() -> Screen {
    let mut screen = Screen::opened(Outside::new(""), Some("serial:/dev/nothing"), SIZE);
    screen.act(Action::ShowTab(crate::tabs::SSI));
    screen
}

#[test]
fn key_undoes_moved_boundary() {
    let mut screen = layout();
    let dirty = |screen: &Screen| screen.studio().ssi().unwrap().is_dirty();
    let boundary = screen.say("ssi.strip_split");
    screen.harness.get_by_label(&boundary).focus();
    screen.steps();
    screen.key(Key::ArrowLeft);
    assert!(dirty(&screen));
    assert!(screen.harness.get_by_label(&boundary).is_focused());
    screen.harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    screen.steps();
    assert!(!dirty(&screen));
}

#[test]
fn incoming_words_do_not_overwrite_typed_text() {
    let mut screen = Screen::open_in_tab(crate::tabs::SSI, "sim:?ssi=afs60&rpm=6", SIZE);
    screen.until("a word is read", |studio| studio.ssi().is_some_and(|own| own.is_showing_live_frame()));
    let id = screen.studio().ssi().unwrap().session.id;
    let last = |screen: &Screen| screen.studio().ssi().unwrap().last().unwrap().decoded.as_ref().unwrap().frame;
    for id_of_entry in ["ssi_trial.position", "ssi_trial.bits_label"] {
        screen.act(Action::device(id, Ssi::Try(TrialInput::Live)));
        let label = screen.say(id_of_entry);
        screen.harness.get_by_role_and_label(Role::TextInput, &label).focus();
        screen.steps();
        let before = last(&screen);
        screen.act(Action::Command(id, DeviceCommand::ReadPosition));
        screen.until("the shaft has turned", move |studio| {
            studio.ssi().unwrap().last().unwrap().decoded.as_ref().unwrap().frame != before
        });
        // The entry is left without a change.
        let node = screen.harness.get_by_role_and_label(Role::TextInput, &label);
        assert!(node.accesskit_node().is_focused());
        screen.key(Key::Tab);
        assert!(screen.studio().ssi().unwrap().is_showing_live_frame(), "{id_of_entry}");
    }
}

/// A picture is drawn without showing its source, and text is shown as text.
#[test]
fn shows_exports_in_their_format() {
    let mut screen = layout();
    screen.click("page.export");
    assert!(screen.shows("Frame length"), "the settings sheet");
    for (word, told) in [("ssi_export.frame", "MT11 … MT0"), ("ssi_export.timing", "27 clocks, 67.50 µs")] {
        screen.click(word);
        let picture = screen.harness.get_by_role_and_label(Role::Image, "ahm36");
        let value = picture.accesskit_node().value().unwrap_or_default();
        assert!(value.contains(told), "{value}");
        assert!(!screen.shows("<svg") && !screen.shows("<rect"));
    }
    screen.click("ssi_export.scl");
    assert!(screen.shows("FUNCTION_BLOCK \"SSI_DECODE\""));
}

/// Frames from a file are listed and decoded with the layout, and a click loads a frame into the editor. They are
/// frames of an AHM36 in Gray code (reference, section 8).
#[test]
fn lists_and_tries_frames_from_file() {
    let mut screen = layout();
    let id = screen.studio().ssi().unwrap().session.id;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("frames.txt");
    std::fs::write(&path, "000110110010011111011101100\n".repeat(20)).unwrap();
    screen.act(Action::device(id, Ssi::Enter(Field::Code, FieldInput::Choice(1))));
    screen.act(Action::device(id, Ssi::FindIn(path)));
    screen.until("it is searched", |studio| matches!(studio.ssi().unwrap().search, SearchState::Found { .. }));
    screen.click("page.find");
    let row = "    2  0x0D93EEC    4778587         291     10843";
    assert!(screen.shows(row));
    screen.harness.get_by_label(row).click();
    screen.steps();
    assert_eq!(screen.studio().ssi().unwrap().trial.frame(), 0x0D9_3EEC);
}

/// The strip, the position and the bits are visible without scrolling at 1280 × 800.
#[test]
fn frame_page_fits_window() {
    let screen = layout();
    for (role, id) in [
        (Role::Slider, "ssi_layout.title"),
        (Role::TextInput, "ssi_trial.position"),
        (Role::TextInput, "ssi_trial.bits_label"),
    ] {
        let label = screen.say(id);
        let rect = screen.harness.get_by_role_and_label(role, &label).rect();
        assert!(rect.bottom() < 630.0, "{label}: {rect:?}");
    }
}
