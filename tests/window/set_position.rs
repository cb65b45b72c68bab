//! Tests of setting the position of a HIPERFACE encoder: the units of the entry, the review, and whether a restore
//! includes the position.

use egui::Role;
use egui_kittest::Node;
use egui_kittest::kittest::{NodeT, Queryable};
use encoder_studio::app::{Action, Language};
use encoder_studio::devices::hiperface::state::ReviewState;

use crate::screen::Screen;
use crate::support::is_review;

fn setup() -> Screen {
    let mut screen = Screen::new_form([1280.0, 900.0]);
    screen.click("page.setup");
    screen
}

fn field<'s>(screen: &'s Screen, id: &'static str) -> Node<'s> {
    let label = screen.say(id);
    let is_it = move |node: &egui_kittest::kittest::AccessKitNode<'_>| {
        node.role() == Role::TextInput && node.label().as_ref() == Some(&label)
    };
    screen.harness.query_all_by(is_it).next().unwrap()
}

fn value(screen: &Screen, id: &'static str) -> String {
    field(screen, id).accesskit_node().value().unwrap_or_default()
}

fn type_into(screen: &mut Screen, id: &'static str, text: &str) {
    field(screen, id).focus();
    screen.steps();
    field(screen, id).type_text(text);
    screen.steps();
}

fn choose(screen: &mut Screen, unit: &'static str) {
    let label = format!("{}: {}", screen.say("position_card.unit"), screen.say(unit));
    screen.harness.get_by_role_and_label(Role::RadioButton, &label).click();
    screen.steps();
}

/// The virtual SKM36 has 4096 steps per turn: 10,240 steps are two turns and 180°, or 900°.
#[test]
fn accepts_position_in_every_unit() {
    let mut screen = setup();
    type_into(&mut screen, "position_card.wanted", "10240");
    assert!(screen.shows("10240 steps\nturn 2, 180.000°"));
    choose(&mut screen, "position_unit.turns_degrees");
    assert_eq!(value(&screen, "position_card.turns"), "2");
    assert_eq!(value(&screen, "position_card.degrees"), "180.000");
    choose(&mut screen, "position_unit.degrees");
    assert_eq!(value(&screen, "position_card.wanted"), "900.000");
    choose(&mut screen, "position_unit.steps");
    assert_eq!(value(&screen, "position_card.wanted"), "10240");
    screen.act(Action::SetLanguage(Language::German));
    choose(&mut screen, "position_unit.degrees");
    assert_eq!(value(&screen, "position_card.wanted"), "900,000");
}

/// The review states the position in turns and degrees, and the access code. The card states that a restore does not
/// include the position.
#[test]
fn position_review_names_turns_and_code() {
    let mut screen = setup();
    assert!(screen.shows(&screen.say("position_card.not_restored")));
    type_into(&mut screen, "position_card.wanted", "10240");
    let label = screen.say("position_card.plan");
    // Other cards have a button with the same label. This one is below the entry.
    let below = field(&screen, "position_card.wanted").rect();
    let plans =
        screen.harness.query_all_by(move |node| node.role() == Role::Button && node.label().as_ref() == Some(&label));
    let own = plans.filter(|node| node.rect().top() > below.top()).find(|node| node.rect().left() < below.left());
    own.unwrap().click();
    screen.until("the plan is ready", |studio| is_review(studio, |state| matches!(state, ReviewState::Ready(_))));
    assert!(screen.shows("turn 2, 18"), "the nearest position in phase");
    assert!(screen.shows("access code 0"));
}
