//! Tests with random clicks, drags and keys in windows of every size. Nothing panics, the window keeps responding, and
//! nothing is written without consent. The same seeds give the same sequences.

use egui::{Event, Key, Modifiers, PointerButton, Pos2, Vec2};
use encoder_studio::app::{Action, ColorScheme, Language};
use encoder_studio::devices::hiperface::state::ReviewState;

use crate::screen::Screen;
use crate::support::Outside;

const KEYS: [Key; 16] = [
    Key::Tab,
    Key::Enter,
    Key::Escape,
    Key::Space,
    Key::Backspace,
    Key::Delete,
    Key::ArrowUp,
    Key::ArrowDown,
    Key::ArrowLeft,
    Key::ArrowRight,
    Key::Home,
    Key::End,
    Key::F1,
    Key::F5,
    Key::A,
    Key::Z,
];
const WORDS: [&str; 8] = ["4", "F", "0x", "-1", "°", "ä→", "99999999999", "\\x00"];

fn day(seed: u64, steps: usize) {
    let mut random = fastrand::Rng::with_seed(seed);
    let (language, theme) = (random.bool(), random.bool());
    let mut screen = Screen::opened(Outside::new("rpm=60"), None, [1024.0, 640.0]);
    screen.act(Action::SetLanguage(if language { Language::German } else { Language::English }));
    screen.act(Action::SetTheme(if theme { ColorScheme::Dark } else { ColorScheme::Light }));
    let mut size = Vec2::new(1024.0, 640.0);
    let mut pointer = Pos2::ZERO;
    for _ in 0..steps {
        match random.u8(0..20) {
            0 => {
                size = Vec2::new(random.f32() * 1200.0 + 300.0, random.f32() * 800.0 + 200.0);
                screen.harness.set_size(size);
            }
            1..=9 => {
                pointer = Pos2::new(random.f32() * size.x, random.f32() * size.y);
                screen.harness.event(Event::PointerMoved(pointer));
                screen.harness.step();
                button(&screen, pointer, true);
                screen.harness.step();
                button(&screen, pointer, false);
            }
            10 => {
                button(&screen, pointer, true);
                for _ in 0..4 {
                    pointer = Pos2::new(random.f32() * size.x, random.f32() * size.y);
                    screen.harness.event(Event::PointerMoved(pointer));
                    screen.harness.step();
                }
                button(&screen, pointer, false);
            }
            11..=14 => {
                let word = WORDS[random.usize(..WORDS.len())];
                screen.harness.event(Event::Text(word.to_owned()));
            }
            15..=18 => {
                let modifiers = [Modifiers::NONE, Modifiers::SHIFT, Modifiers::COMMAND][random.usize(..3)];
                screen.harness.key_press_modifiers(modifiers, KEYS[random.usize(..KEYS.len())]);
            }
            _ => screen.harness.event(Event::Paste("01 02 zz".to_owned())),
        }
        screen.harness.step();
    }
    // After all actions the window still draws and answers.
    screen.steps();
    let written = screen
        .studio()
        .devices()
        .iter()
        .filter_map(|own| own.get::<encoder_studio::devices::hiperface::state::Encoder>()?.session.review.as_ref());
    for review in written {
        assert!(!matches!(review.state, ReviewState::Failed { begun: true, .. }), "seed {seed}");
    }
}

fn button(screen: &Screen, pos: Pos2, pressed: bool) {
    let button = PointerButton::Primary;
    screen.harness.event(Event::PointerButton { pos, button, pressed, modifiers: Modifiers::NONE });
}

#[test]
fn random_clicks_drags_and_keys_do_not_panic() {
    for seed in 0..4 {
        day(seed, 300);
    }
}
