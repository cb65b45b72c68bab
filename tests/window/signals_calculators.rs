//! The calculators of the Signals tab as a person uses them: typed and read.

use egui::Key;
use egui_kittest::kittest::Queryable;
use encoder_studio::app::{Action, Language, Tab};

use crate::screen::Screen;
use crate::support::{HANGING, Outside};

/// So tall that a whole page is drawn.
const TALL: [f32; 2] = [1400.0, 1600.0];

impl Screen {
    fn calculator(page: &'static str) -> Self {
        let mut screen = Screen::opened(Outside::new(""), Some(HANGING), TALL);
        screen.act(Action::ShowTab(Tab::Signals));
        screen.click(page);
        screen
    }

    /// Replaces what stands in an entry.
    fn retype(&mut self, id: &'static str, text: &str) {
        let label = self.say(id);
        self.harness.query_all_by_role_and_label(egui::Role::TextInput, &label).last().unwrap().focus();
        self.steps();
        self.harness.key_press_modifiers(egui::Modifiers::COMMAND, Key::A);
        self.steps();
        self.harness.event(egui::Event::Text(text.to_owned()));
        self.steps();
    }
}

/// Section 1: 512 periods at 12 000/min are 102.4 kHz; behind 10 kΩ and 47 pF they lag by 16.825°.
#[test]
fn the_input_circuit_is_reckoned_while_it_is_typed() {
    let mut screen = Screen::calculator("page.input_circuit");
    screen.retype("input.periods", "512");
    screen.retype("input.speed", "12000");
    screen.retype("input.resistance", "10 kΩ");
    screen.retype("input.capacitance", "47p");
    for words in ["102.400 kHz", "17578.1 rpm", "16.825°", "1.496/32", "0.95719", "338.6 kHz"] {
        assert!(screen.shows(words), "{words}");
    }
    assert!(screen.shows("Within the bandwidth of 150 kHz"));
    screen.retype("input.speed", "18000");
    assert!(screen.shows("Beyond the bandwidth of 150 kHz"));
    screen.retype("input.capacitance", "47 pigs");
    assert!(screen.shows("\"47 pigs\" is none from 1 fF to 1 mF"));
    assert!(!screen.shows("338.6 kHz"), "nothing is shown that is not reckoned");
    screen.act(Action::SetLanguage(Language::German));
    screen.check_language();
    screen.retype("input.capacitance", "0,047n");
    assert!(screen.shows("338,6 kHz"));
}
