//! Tests of the calculators in the Signals tab, operated by typing and reading as a user does.

use crate::tabs::Tabs as _;
use egui::Key;
use egui_kittest::kittest::{NodeT, Queryable};
use encoder_studio::app::{Action, Language};
use encoder_studio::devices::hiperface::state::HiperfaceAction as Hiperface;

use crate::screen::Screen;
use crate::support::{Desk, HANGING_LINK, Outside};

/// Window size that fits a complete page.
const TALL: [f32; 2] = [1400.0, 1600.0];

impl Screen {
    fn calculator(page: &'static str) -> Self {
        let mut screen = Screen::opened(Outside::new(""), Some(HANGING_LINK), TALL);
        screen.act(Action::ShowTab(crate::tabs::SIGNALS));
        screen.click(page);
        screen
    }

    /// Replaces the text of an entry.
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

/// According to section 1 of the reference, 512 periods at 12 000/min are 102.4 kHz, with a lag of 16.825° after 10 kΩ
/// and 47 pF.
#[test]
fn computes_input_circuit_while_typing() {
    let mut screen = Screen::calculator("page.input_circuit");
    screen.retype("input.periods", "512");
    screen.retype("input.speed", "12000");
    screen.retype("input.resistance", "10 kΩ");
    screen.retype("input.capacitance", "47p");
    for words in ["102.400 kHz", "17578.1 rpm", "16.825°", "1.496/32", "0.95719", "338.6 kHz"] {
        assert!(screen.shows(words), "{words}");
    }
    assert!(screen.shows("The signal frequency is within the bandwidth of 150 kHz."));
    screen.retype("input.speed", "18000");
    assert!(screen.shows("The signal frequency exceeds the bandwidth of 150 kHz"));
    screen.retype("input.capacitance", "47 pigs");
    assert!(screen.shows("\"47 pigs\" is not between 1 fF and 1 mF"));
    assert!(!screen.shows("338.6 kHz"), "nothing is shown that is not reckoned");
    screen.act(Action::SetLanguage(Language::German));
    screen.check_language();
    screen.retype("input.capacitance", "0,047n");
    assert!(screen.shows("338,6 kHz"));
}

/// Number entries use the decimal separator of the language, even after the language is changed (issue 26).
#[test]
fn entries_use_localized_decimal_sign() {
    let mut screen = Screen::calculator("page.synchronise");
    let phase = |screen: &Screen| {
        let label = screen.say("synchronise.phase");
        let entry = screen.harness.get_by_role_and_label(egui::Role::TextInput, &label);
        entry.accesskit_node().value().unwrap_or_default()
    };
    assert_eq!(phase(&screen), "0.02");
    screen.act(Action::SetLanguage(Language::German));
    assert_eq!(phase(&screen), "0,02");
    assert!(screen.shows("339,02000"));
    screen.retype("synchronise.phase", "0.25");
    assert_eq!(phase(&screen), "0,25");
}

/// According to section 4 of the reference, A = 2A5Fh and φ = 0.02 are 339.02 of 1024 periods. A fifth of a period
/// further, φ is half a period off.
#[test]
fn synchronises_positions_while_typing() {
    let mut screen = Screen::calculator("page.synchronise");
    let value = |screen: &Screen| {
        let label = screen.say("synchronise.ring");
        let images = screen.harness.query_all_by_role_and_label(egui::Role::Image, &label);
        images.last().and_then(|node| node.accesskit_node().value().map(|value| value.to_owned())).unwrap_or_default()
    };
    for words in ["339.02000", "30.36/32", "+1", "153051Eh", "119.186719°", "29.3 rpm"] {
        assert!(screen.shows(words), "{words}");
    }
    assert_eq!(value(&screen), "The positions agree to within -1.64/32 of a period.");
    screen.retype("synchronise.absolute", "10831");
    screen.retype("synchronise.phase", "0.47");
    assert!(screen.shows("338.47000"));
    screen.retype("synchronise.absolute", "10816");
    screen.retype("synchronise.phase", "0.5");
    assert!(value(&screen).starts_with("The positions differ by half a period"), "{}", value(&screen));
    screen.retype("synchronise.quarters", "44");
    screen.retype("synchronise.phase", "0.98");
    assert!(screen.shows("10.98000"));
    screen.retype("synchronise.absolute", "32768");
    assert!(screen.shows("\"32768\" is not a valid position. Enter a position from 0 to 32767"));
    screen.act(Action::SetLanguage(Language::German));
    screen.check_language();
    assert!(!screen.is_enabled("synchronise.read"), "no encoder is connected");
    screen.key(Key::F1);
    assert!(screen.shows(&screen.say("help.synchronise")));
}

/// The virtual SKM36 at step 24 has counts of 409 and 511, as in its own signals.
#[test]
fn reads_positions_from_selected_encoder() {
    let mut screen = Screen::opened(Outside::new("position=3224"), None, TALL);
    screen.until("the encoder is read", |studio| {
        studio.hiperface().is_some_and(|encoder| encoder.session.is_ready() && encoder.identity.is_some())
    });
    screen.act(Action::ShowTab(crate::tabs::SIGNALS));
    screen.click("page.synchronise");
    for count in [1, 2] {
        screen.click("synchronise.read");
        screen.until("it is read", |studio| studio.signals().synchronise().reading_count() == count);
    }
    let form = &screen.studio().signals().synchronise().form;
    assert_eq!((form.absolute.as_str(), form.periods.as_str(), form.turns.as_str()), ("0xC98", "128", "4096"));
    assert_eq!((form.sine_v.as_str(), form.cosine_v.as_str()), ("-0.5010", "-0.0024"));
    // 24 − 32 · 0.749 224 = 0.0248
    assert!(screen.shows("100.74924") && screen.shows("0.02/32"));
    screen.click("synchronise.use");
    assert_eq!(screen.studio().signals().synchronise().form.offset, "0.02");
    screen.click("synchronise.forget");
    assert_eq!(screen.studio().signals().synchronise().reading_count(), 0);
}

#[test]
fn turning_shaft_yields_no_reading() {
    let mut desk = Desk::new_form("rpm=60");
    desk.ask(Hiperface::ReadRest);
    desk.until("it is told", |studio| studio.signals().synchronise().problem.is_some());
    let state = desk.studio.signals().synchronise();
    assert_eq!((state.problem.as_ref().unwrap().id(), state.reading_count()), ("encoder.moving", 0));
    assert!(desk.encoder().commutation.problem.is_none(), "it was not asked there");
}
