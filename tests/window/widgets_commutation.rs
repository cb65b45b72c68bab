//! Tests of the commutation page, operated as a user does: by ticking, typing and clicking.

use crate::tabs::Tabs as _;
use egui_kittest::kittest::{NodeT, Queryable};
use encoder_studio::app::{Action, Language};
use encoder_studio::devices::hiperface::state::HiperfaceAction as Hiperface;
use encoder_studio::devices::hiperface::state::commutation::{CommutationAction as Assistant, VectorSlot};

use crate::screen::Screen;

/// Window size that fits the complete page.
const TALL: [f32; 2] = [1400.0, 1800.0];

impl Screen {
    fn tick(&mut self, id: &'static str) {
        let label = self.say(id);
        self.harness.get_by_label(&label).click();
        self.steps();
    }

    fn fill_in(&mut self, label: &str, text: &str) {
        // The label next to the entry has the same name.
        let is_entry = |node: &egui_kittest::Node<'_>| node.accesskit_node().role() == egui::Role::TextInput;
        self.harness.query_all_by_label(label).find(is_entry).unwrap().focus();
        self.steps();
        self.harness.query_all_by_label(label).find(is_entry).unwrap().type_text(text);
        self.steps();
    }

    fn fill(&mut self, id: &'static str, text: &str) {
        let label = self.say(id);
        self.fill_in(&label, text);
    }
}

#[test]
fn page_works_by_clicks_and_keys() {
    let mut screen = Screen::new_form(TALL);
    screen.click("page.commutation");
    assert!(!screen.is_enabled("commutation.read_one") && !screen.is_enabled("commutation.store"));
    for id in ["commutation.disabled", "commutation.uncoupled", "commutation.released"] {
        screen.tick(id);
    }
    screen.fill("commutation.current", "2.5");
    assert!(!screen.is_enabled("commutation.read_one"), "the time is not written down");
    screen.fill("commutation.time", "30");
    screen.fill("commutation.pole_pairs", "4");
    screen.click("commutation.read_one");
    let read = |slot| {
        move |studio: &encoder_studio::app::Studio| {
            let encoder = studio.hiperface().unwrap();
            encoder.session.is_ready() && encoder.commutation.reading_at(slot).is_some()
        }
    };
    screen.until("one side is read", read(VectorSlot::OneSide));
    assert!(!screen.is_enabled("commutation.store"), "one side is not enough");
    screen.click("commutation.read_other");
    screen.until("the other side is read", read(VectorSlot::OtherSide));
    let second = format!("{} · {}", screen.say("commutation.in_second"), screen.say("commutation.fine"));
    let there = screen.encoder().commutation.reading_at(VectorSlot::OneSide).unwrap().fine_periods + 8.0;
    screen.fill_in(&second, &format!("{there:.5}"));
    screen.click("commutation.use_second");
    assert!(screen.encoder().commutation.is_confirmed(screen.encoder().geometry()));
    screen.check_language();
    assert!(!screen.is_enabled("commutation.store") && screen.shows("Create a new data field under Memory"));
    screen.fill("commutation.address", "0");
    assert!(screen.shows("would overwrite their content, \"EMD71K-4 3000rpm\""), "before anything is put there");
    screen.click("commutation.store");
    assert!(screen.encoder().staged.is_edited(0, 0));
    assert!(screen.shows("would overwrite their content, \"EMD71K-4 3000rpm\""), "and until it is written");
    screen.click("commutation.review");
    assert!(screen.encoder().session.review.is_some(), "the usual review writes it");
    screen.act(Action::SetLanguage(Language::German));
    screen.check_language();
}

#[test]
fn shows_errors_next_to_entry() {
    let mut screen = Screen::new_form(TALL);
    screen.click("page.commutation");
    let numbers = [
        "is not a number from 0.001 to 1000",
        "is not a number from 0.1 to 600",
        "The encoder has 128 periods per turn",
    ];
    assert!(!numbers.iter().any(|words| screen.shows(words)), "an empty entry is not wrong yet");
    let mut form = screen.encoder().commutation.form.clone();
    (form.current_a, form.time_s, form.periods) = ("−5".to_owned(), "abc".to_owned(), "1024".to_owned());
    form.pole_pairs = "4".to_owned();
    form.typed[0] = "339.02".to_owned();
    screen.ask(Hiperface::Commutation(Assistant::Edit(Box::new(form))));
    for words in numbers {
        assert!(screen.shows(words), "{words}");
    }
    assert!(!screen.shows("from one side only"));
    screen.ask(Hiperface::Commutation(Assistant::Use(VectorSlot::OneSide)));
    assert!(screen.shows("from one side only"));
    screen.check_language();
}
