//! Tests of the cam page, operated by pointer, keys, typing and pasting. The chart and the table must agree.

use crate::tabs::Tabs as _;
use egui::accesskit::Role;
use egui::{Event, Key, Modifiers, Vec2};
use egui_kittest::Node;
use egui_kittest::kittest::{NodeT, Queryable};
use encoder_studio::app::{Action, Language, PendingEdits};
use encoder_studio::devices::interbus::protocol::{CamNumber, ProgramNumber};
use encoder_studio::devices::interbus::state::{Edit, InterbusAction as Interbus};

use crate::screen::Screen;

/// Window size that fits the complete chart and table.
const TALL: [f32; 2] = [1280.0, 1600.0];

fn program() -> ProgramNumber {
    ProgramNumber::new(1).unwrap()
}

fn cam(number: u8) -> CamNumber {
    CamNumber::new(number).unwrap()
}

/// Opens the cam page of an encoder with 3600 steps per turn and cams of 450 steps in program 1.
fn page() -> Screen {
    let mut screen = Screen::open_in_tab(crate::tabs::INTERBUS, "sim:?steps=3600&revolutions=1&cams=demo", TALL);
    screen.until("it is read", |studio| {
        studio.interbus().is_some_and(|own| own.known_program_count() == 8 && own.session.is_ready())
    });
    screen.click("page.cams");
    screen
}

impl Screen {
    fn cam(&self, number: u8) -> (u32, u32) {
        let wanted = self.studio().interbus().unwrap().staged.edited_values().unwrap();
        let own = wanted.cam(program(), cam(number)).unwrap();
        (own.start.get(), own.stop.get())
    }

    fn edit_cams(&mut self, edit: Edit) {
        let id = self.studio().interbus().unwrap().session.id;
        self.act(Action::device(id, Interbus::Edit(Box::new(edit))));
    }

    fn paste(&mut self, text: &str) {
        self.harness.event(Event::Paste(text.to_owned()));
        self.steps();
    }

    fn node_with_role<'a>(&'a self, role: Role, label: &'a str) -> Node<'a> {
        self.harness.get_by_role_and_label(role, label)
    }

    /// Returns the values of an edge in the chart and in the table.
    fn edge_values(&self, label: &str) -> (String, String) {
        let value = |role| self.node_with_role(role, label).accesskit_node().value().unwrap_or_default();
        (value(Role::Slider), value(Role::TextInput))
    }
}

#[test]
fn edits_edge_in_chart_and_table() {
    let mut screen = page();
    let (start, stop) = screen.cam(2);
    assert_eq!(screen.edge_values("Cam 2: start"), (start.to_string(), start.to_string()));
    screen.node_with_role(Role::Slider, "Cam 2: start").focus();
    screen.steps();
    screen.key(Key::ArrowRight);
    assert_eq!(screen.cam(2), (start + 1, stop));
    assert_eq!(screen.edge_values("Cam 2: start").1, (start + 1).to_string());
    screen.harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    screen.steps();
    assert_eq!(screen.cam(2), (start, stop));

    screen.node_with_role(Role::TextInput, "Cam 2: stop").focus();
    screen.steps();
    screen.harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
    screen.node_with_role(Role::TextInput, "Cam 2: stop").type_text("1234");
    screen.key(Key::Enter);
    assert_eq!((screen.cam(2), screen.edge_values("Cam 2: stop").0), ((start, 1234), "1234".to_owned()));
}

#[test]
fn drag_is_one_undo_step() {
    let mut screen = page();
    let before = screen.cam(0);
    let from = screen.node_with_role(Role::Slider, "Cam 0: stop").rect().center();
    screen.harness.drag_at(from);
    screen.steps();
    for part in [20.0, 40.0, 60.0, 80.0] {
        screen.harness.hover_at(from + Vec2::new(part, 0.0));
        screen.steps();
    }
    assert_eq!(screen.cam(0), before, "it is shown, and not yet so");
    screen.harness.drop_at(from + Vec2::new(80.0, 0.0));
    screen.steps();
    let after = screen.cam(0);
    assert!(after.0 == before.0 && after.1 > before.1 + 100, "{before:?} {after:?}");
    screen.harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    screen.steps();
    assert_eq!(screen.cam(0), before);
    assert!(!screen.studio().interbus().unwrap().staged.can_undo());
}

#[test]
fn previews_pasted_table() {
    let mut screen = page();
    let before = screen.cam(0);
    let text = "name;start;stop\nfeed;100;200\nglue;300;350\nglue;700;750\n";
    screen.paste(&format!("{text}late;3600;10\n"));
    assert!(screen.shows("Program 1: glue has 2 pulses, which use cams 1, 2."));
    assert!(screen.shows("Line 5, column 2: The value 3600 for start is outside the measuring range 0 to 3599."));
    assert_eq!(screen.cam(0), before);
    screen.check_language();
    screen.act(Action::SetLanguage(Language::German));
    screen.check_language();
    screen.act(Action::SetLanguage(Language::English));
    assert!(!screen.is_enabled("ib_table.take"), "the cam of the line that is wrong would be switched off");
    screen.paste(text);
    screen.click("ib_table.take");
    assert_eq!((screen.cam(0), screen.cam(1), screen.cam(2)), ((100, 200), (300, 350), (700, 750)));
    let own = screen.studio().interbus().unwrap();
    assert_eq!(own.staged.program(program()).unwrap().mask, 0b111);
    assert_eq!(own.staged.edited_values().unwrap().name(program(), cam(2)), Some("glue"));
}

#[test]
fn marks_conflicting_and_out_of_range_cams() {
    let mut screen = page();
    for number in [1, 2] {
        screen.edit_cams(Edit::Name { program: program(), cam: cam(number), name: "glue".to_owned() });
    }
    assert!(!screen.shows("their pulses overlap at"));
    let (start, _) = screen.cam(2);
    let (own, _) = screen.cam(1);
    screen.edit_cams(Edit::Cam { program: program(), cam: cam(1), start: own, stop: start, on: true });
    assert!(
        screen.shows(&format!("Program 1: cams 1 and 2 are on the same track, and their pulses overlap at {start}."))
    );
    screen.edit_cams(Edit::Steps(3200));
    assert!(screen.shows("Program 1: cam 7 is outside the measuring range, which ends at 3199."));
    // All cams of a program outside the range are reported in one line, so that the chart stays visible (issue 22.28).
    screen.edit_cams(Edit::Steps(3000));
    assert!(screen.shows("Program 1: cams 6, 7 are outside the measuring range, which ends at 2999."));
    assert!(!screen.shows("Program 1: cam 7"));
    screen.act(Action::SetLanguage(Language::German));
    assert!(screen.shows("Programm 1: Die Nocken 6, 7 liegen außerhalb des Messbereichs, der bei 2999 endet."));
    screen.check_language();
}

#[test]
fn ring_edits_same_cams() {
    let mut screen = page();
    screen.click("ib_cams.ring");
    let (start, stop) = screen.cam(3);
    screen.node_with_role(Role::Slider, "Cam 3: stop, on the ring").focus();
    screen.steps();
    screen.key(Key::ArrowLeft);
    assert_eq!(screen.cam(3), (start, stop - 1));
    screen.key(Key::Delete);
    let own = screen.studio().interbus().unwrap().staged.edited_values().unwrap();
    assert!(!own.is_on(program(), cam(3)));
    screen.check_language();
}
