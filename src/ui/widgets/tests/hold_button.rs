//! A button that counts while it is held, and the diagram of a drive's states.

use egui::{Event, Key, Modifiers, PointerButton, Pos2, Vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};

use super::{NONE, focus, press, skin, window};
use crate::protocol::hiperdrive::State;
use crate::ui::widgets::{HoldButton, HoldEvent, StateMachine, hold_button, state_machine};
use HoldEvent::{Hold, Press, Release};

#[derive(Default)]
struct Jog {
    locked: bool,
    hidden: bool,
    events: Vec<HoldEvent>,
}

fn jog() -> Harness<'static, Jog> {
    window(Jog::default(), |ui, jog: &mut Jog| {
        if jog.hidden {
            return;
        }
        let button = HoldButton { word: "+", caption: "hold", label: "Jog up", enabled: !jog.locked };
        jog.events.extend(hold_button(ui, &skin(), &button, Vec2::new(120.0, 64.0)));
    })
}

fn middle(harness: &Harness<'_, Jog>) -> Pos2 {
    harness.get_by_label("Jog up").rect().center()
}

fn button(at: Pos2, pressed: bool) -> Event {
    Event::PointerButton { pos: at, button: PointerButton::Primary, pressed, modifiers: Modifiers::NONE }
}

fn key(pressed: bool, repeat: bool) -> Event {
    Event::Key { key: Key::Space, physical_key: None, pressed, repeat, modifiers: Modifiers::NONE }
}

/// One picture after these events, and what was told in it.
fn step(harness: &mut Harness<'_, Jog>, events: impl IntoIterator<Item = Event>) -> Vec<HoldEvent> {
    harness.state_mut().events.clear();
    for event in events {
        harness.event(event);
    }
    harness.step();
    harness.state_mut().events.drain(..).collect()
}

#[test]
fn it_counts_while_a_finger_is_on_it() {
    let mut harness = jog();
    let at = middle(&harness);
    assert_eq!(step(&mut harness, [Event::PointerMoved(at)]), []);
    assert_eq!(step(&mut harness, [button(at, true)]), [Press]);
    for _ in 0..50 {
        assert_eq!(step(&mut harness, []), [Hold]);
    }
    assert_eq!(step(&mut harness, [Event::PointerMoved(at + Vec2::new(20.0, 10.0))]), [Hold]);
    assert_eq!(step(&mut harness, [button(at, false)]), [Release]);
    assert_eq!(step(&mut harness, []), []);
}

#[test]
fn a_finger_that_slides_off_ends_it_until_it_is_lifted() {
    let mut harness = jog();
    let at = middle(&harness);
    step(&mut harness, [Event::PointerMoved(at)]);
    assert_eq!(step(&mut harness, [button(at, true)]), [Press]);
    assert_eq!(step(&mut harness, [Event::PointerMoved(at + Vec2::new(0.0, 200.0))]), [Release]);
    assert_eq!(step(&mut harness, [Event::PointerMoved(at)]), []);
    assert_eq!(step(&mut harness, []), []);
    step(&mut harness, [button(at, false)]);
    assert_eq!(step(&mut harness, [button(at, true)]), [Press]);
}

#[test]
fn a_press_that_began_elsewhere_is_none() {
    let mut harness = jog();
    let at = middle(&harness);
    let beside = at + Vec2::new(0.0, 200.0);
    step(&mut harness, [Event::PointerMoved(beside), button(beside, true)]);
    assert_eq!(step(&mut harness, [Event::PointerMoved(at)]), []);
    assert_eq!(step(&mut harness, []), []);
}

#[test]
fn what_takes_the_button_away_ends_it() {
    // Locked by an error, and the window without the keyboard.
    for cause in [0, 1] {
        let mut harness = jog();
        let at = middle(&harness);
        step(&mut harness, [Event::PointerMoved(at)]);
        assert_eq!(step(&mut harness, [button(at, true)]), [Press]);
        match cause {
            0 => harness.state_mut().locked = true,
            _ => harness.input_mut().focused = false,
        }
        assert_eq!(step(&mut harness, []), [Release], "{cause}");
        assert_eq!(step(&mut harness, []), [], "{cause}");
        harness.state_mut().locked = false;
        harness.input_mut().focused = true;
        // The finger is still there, and has to be lifted first.
        assert_eq!(step(&mut harness, []), [], "{cause}");
    }
    // What is not drawn says nothing: whoever waits for it hears that.
    let mut harness = jog();
    let at = middle(&harness);
    step(&mut harness, [Event::PointerMoved(at)]);
    assert_eq!(step(&mut harness, [button(at, true)]), [Press]);
    harness.state_mut().hidden = true;
    assert_eq!(step(&mut harness, []), []);
    assert_eq!(step(&mut harness, []), []);
}

#[test]
fn a_key_holds_it_and_its_repetitions_are_nothing() {
    let mut harness = jog();
    focus(&mut harness, "Jog up");
    assert_eq!(step(&mut harness, [key(true, false)]), [Press]);
    assert_eq!(step(&mut harness, [key(true, true)]), [Hold]);
    assert_eq!(step(&mut harness, [key(false, false)]), [Release]);
    // Down before the button had the keyboard.
    focus(&mut harness, "before");
    step(&mut harness, [key(true, false)]);
    harness.get_by_label("Jog up").focus();
    assert_eq!(step(&mut harness, []), []);
    assert_eq!(step(&mut harness, [key(true, true)]), []);
    step(&mut harness, [key(false, false)]);
    assert_eq!(step(&mut harness, [key(true, false)]), [Press]);
}

fn states(present: Option<State>) -> Harness<'static, Vec<State>> {
    let names = State::ALL.map(|state| state.name().to_owned());
    let hints = State::ALL.map(|state| (state == State::Ready).then(|| "Control word 0x0400".to_owned()));
    let reachable: Vec<State> = match present {
        Some(State::Operational) => vec![State::NotReady, State::Ready, State::Enabled],
        _ => Vec::new(),
    };
    window(Vec::new(), move |ui, asked: &mut Vec<State>| {
        let machine = StateMachine { present, reachable: &reachable, names: &names, hints: &hints };
        asked.extend(state_machine(ui, &skin(), &machine));
    })
}

#[test]
fn only_a_state_that_can_be_gone_to_is_asked_for() {
    let mut harness = states(Some(State::Operational));
    for state in State::ALL {
        let node = harness.get_by_label(state.name());
        let reachable = matches!(state, State::NotReady | State::Ready | State::Enabled);
        assert_eq!(node.accesskit_node().is_disabled(), !reachable, "{state}");
        node.click();
        harness.run();
        let expected: &[State] = if reachable { &[state] } else { &[] };
        assert_eq!(std::mem::take(harness.state_mut()), expected, "{state}");
    }
    focus(&mut harness, "enabled");
    press(&mut harness, &[(NONE, Key::Enter)]);
    assert_eq!(*harness.state(), [State::Enabled]);
    assert!(states(None).get_by_label("moving").accesskit_node().is_disabled());
}
