//! A button that counts while it is held: for motion that ends when a finger leaves it.
//!
//! * **Size**: as given, at least 56 points high, so that a gloved finger finds it.
//! * **Keyboard**: Space or Enter, held while it has the keyboard.
//! * **Pointer**: the first button, or a touch; leaving the button ends it, and coming back does not begin it again.
//! * **Accessible**: a button with its label; a click that a screen reader makes has no length and does nothing.
//! * **Painting**: the word, below it what it does; filled with the accent while it is held.

use egui::accesskit::Role;
use egui::{Align2, Event, FontId, Key, Response, Sense, Stroke, StrokeKind, Ui, Vec2, WidgetInfo, pos2};

use super::focus_ring;
use crate::ui::Skin;

/// What a finger did since the picture before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HoldEvent {
    /// It came down on the button.
    Press,
    /// It is still there: told with every picture.
    Hold,
    /// It is gone: lifted, slid off, or the window has lost the keyboard.
    Release,
}

/// What is drawn.
#[derive(Clone, Copy, Debug)]
pub struct HoldButton<'a> {
    /// What stands large.
    pub word: &'a str,
    /// What stands small, below it.
    pub caption: &'a str,
    /// Accessible name.
    pub label: &'a str,
    /// It may be pressed.
    pub enabled: bool,
}

/// What a button remembers from one picture to the next.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Finger {
    #[default]
    Off,
    /// Down on it.
    On,
    /// Down, and it has left the button: nothing begins until it was lifted.
    Slid,
}

/// What holds it as a finger does.
const KEYS: [Key; 2] = [Key::Space, Key::Enter];
/// The least height in points.
const LEAST: f32 = 56.0;

/// Draws it.
pub fn hold_button(ui: &mut Ui, skin: &Skin, button: &HoldButton<'_>, size: Vec2) -> Option<HoldEvent> {
    let size = Vec2::new(size.x.max(LEAST), size.y.max(LEAST));
    let sense = if button.enabled { Sense::click_and_drag() } else { Sense::hover() };
    let (_, response) = ui.allocate_exact_size(size, sense);
    response.widget_info(|| WidgetInfo::labeled(Role::Button, button.enabled, button.label));
    let before: Finger = ui.data(|data| data.get_temp(response.id)).unwrap_or_default();
    let now = finger(ui, &response, button.enabled, before);
    ui.data_mut(|data| data.insert_temp(response.id, now));
    paint(ui, skin, button, &response, now == Finger::On);
    match (before == Finger::On, now == Finger::On) {
        (false, true) => Some(HoldEvent::Press),
        (true, true) => Some(HoldEvent::Hold),
        (true, false) => Some(HoldEvent::Release),
        (false, false) => None,
    }
}

fn finger(ui: &Ui, response: &Response, enabled: bool, before: Finger) -> Finger {
    let (has_window, key, fresh, at) = ui.input(|input| {
        let plain = input.modifiers.is_none();
        let key = plain && KEYS.into_iter().any(|key| input.key_down(key));
        let begins = |event: &Event| {
            matches!(event, Event::Key { key, pressed: true, repeat: false, .. } if plain && KEYS.contains(key))
        };
        let fresh = input.events.iter().any(begins);
        (input.focused, key, fresh, input.pointer.interact_pos())
    });
    let down = response.is_pointer_button_down_on() && ui.input(|input| input.pointer.primary_down());
    let inside = at.is_some_and(|at| response.rect.contains(at));
    let by_key = response.has_focus() && key;
    let is_held = enabled && has_window && (down && inside || by_key);
    match before {
        // A key that was down before the button had the keyboard is not meant for it.
        Finger::Off if is_held && (down || fresh) => Finger::On,
        Finger::On if is_held => Finger::On,
        _ if down || by_key => Finger::Slid,
        _ => Finger::Off,
    }
}

fn paint(ui: &Ui, skin: &Skin, button: &HoldButton<'_>, response: &Response, held: bool) {
    let rect = response.rect;
    if !ui.is_rect_visible(rect) {
        return;
    }
    let palette = skin.palette;
    let (fill, ink, small) = match (held, button.enabled) {
        (true, _) => (palette.accent, palette.on_accent, palette.on_accent),
        (false, true) => (palette.raised, palette.text, palette.muted),
        (false, false) => (palette.raised, palette.muted, palette.muted),
    };
    let edge = match button.enabled {
        true if response.hovered() || held => palette.accent,
        true => palette.muted,
        false => palette.line,
    };
    let painter = ui.painter();
    painter.rect_filled(rect, skin.radius, fill);
    painter.rect_stroke(rect, skin.radius, Stroke::new(1.0, edge), StrokeKind::Inside);
    let middle = rect.center();
    let word = pos2(middle.x, middle.y - skin.space.between);
    painter.text(word, Align2::CENTER_CENTER, button.word, skin.strong(skin.sizes.value), ink.into());
    let below = pos2(middle.x, rect.bottom() - skin.space.groups);
    let font = FontId::proportional(skin.sizes.caption);
    painter.text(below, Align2::CENTER_CENTER, button.caption, font, small.into());
    if response.has_focus() {
        focus_ring(painter, skin, rect, skin.radius);
    }
}
