//! A button that acts while it is held, for motion that must end when the finger leaves it.
//!
//! * **Size**: as given, at least 56 points high, for use with gloves.
//! * **Keyboard**: Space or Enter, held while the button has the keyboard focus. A key works only after its release on
//!   the button has been detected ([`HoldState`]); until then, the caption says so.
//! * **Pointer**: the primary button, or a touch. Leaving the button ends the hold, and returning does not start it
//!   again.
//! * **Accessible**: a button with its label. A click by a screen reader has no duration and does nothing.
//! * **Painting**: the label with its effect below. The button is filled with the accent colour while held, unless its
//!   action has already ended.

use egui::accesskit::Role;
use egui::{
    Align2, Context, Event, FontId, Id, Modifiers, PointerButton, Rect, Response, Sense, Stroke, StrokeKind,
    TouchPhase, Ui, Vec2, WidgetInfo, pos2,
};

use super::focus_ring;
use crate::app::{HoldContext, HoldEvent, HoldInput, HoldState};
use crate::ui::keys::press_key;
use crate::ui::{Theme, stop_debounce};

#[derive(Clone, Copy, Debug)]
pub struct HoldButton<'a> {
    pub word: &'a str,
    pub caption: &'a str,
    pub label: &'a str,
    pub enabled: bool,
    /// Whether the action has already ended although the button is still held. The button then looks released.
    pub has_ended: bool,
}

/// State shared by all hold buttons. The window sets it before they are drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(in crate::ui) struct HoldButtonContext {
    /// Whether the window is covered by a dialog, so no hold button can be pressed.
    pub(in crate::ui) covered: bool,
    pub(in crate::ui) moving: bool,
}

#[derive(Clone, Copy, Default)]
struct HoldButtonState {
    state: HoldState,
    /// Number of the egui pass in which the button was last drawn.
    pass: u64,
    modifiers: Modifiers,
}

/// The hold buttons that had the keyboard focus or were held by the pointer in the previous frame.
#[derive(Clone, Copy, Default)]
struct HoldButtonFrame {
    /// Button with the keyboard focus, and the last pass in which it had the focus.
    keyboard: Option<(Id, u64)>,
    pointer: Option<u64>,
}

const MIN_WIDTH: f32 = 56.0;

pub(in crate::ui) fn set_hold_button_context(ctx: &Context, surroundings: HoldButtonContext) {
    ctx.data_mut(|data| data.insert_temp(Id::unique("around hold buttons"), surroundings));
}

/// Returns whether a hold button had the keyboard focus in the previous frame and still has it. If so, the button
/// receives the keys.
pub(in crate::ui) fn has_hold_button_focus(ctx: &Context) -> bool {
    let drawn = hold_button_frame(ctx);
    let focused = ctx.memory(|memory| memory.focused());
    drawn.keyboard.is_some_and(|(id, pass)| focused == Some(id) && pass + 1 >= ctx.cumulative_pass_nr())
}

/// Returns whether the pointer held a hold button in the previous frame.
pub(in crate::ui) fn is_hold_button_held(ctx: &Context) -> bool {
    hold_button_frame(ctx).pointer.is_some_and(|pass| pass + 1 >= ctx.cumulative_pass_nr())
}

fn hold_button_frame(ctx: &Context) -> HoldButtonFrame {
    ctx.data(|data| data.get_temp(HoldButtonFrame::id())).unwrap_or_default()
}

impl HoldButtonFrame {
    fn id() -> Id {
        Id::unique("hold buttons")
    }
}

pub fn hold_button(ui: &mut Ui, theme: &Theme, button: &HoldButton<'_>, size: Vec2) -> Option<HoldEvent> {
    let size = Vec2::new(size.x.max(MIN_WIDTH), size.y.max(MIN_WIDTH));
    let around: HoldButtonContext =
        ui.data(|data| data.get_temp(Id::unique("around hold buttons"))).unwrap_or_default();
    let enabled = button.enabled && !around.covered;
    let sense = if button.enabled { Sense::click_and_drag() } else { Sense::hover() };
    let (_, response) = ui.allocate_exact_size(size, sense);
    response.widget_info(|| WidgetInfo::labeled(Role::Button, button.enabled, button.label));
    let pass = ui.ctx().cumulative_pass_nr();
    let HoldButtonState { mut state, pass: last, mut modifiers } =
        ui.data(|data| data.get_temp(response.id)).unwrap_or_default();
    let now = ui.input(|input| input.time);
    let scene = HoldContext {
        enabled,
        window: ui.input(|input| input.focused),
        keyboard: response.has_focus(),
        moving: around.moving && !state.is_held() || stop_debounce::has_recently_stopped(ui.ctx(), now),
    };
    state.begin_frame(scene, last + 1 == pass);
    let place = response.interact_rect;
    let pressed_here = response.is_pointer_button_down_on();
    // All events count here, in order, even those that the window has hidden from the widgets.
    let (down, inside) = ui.input(|input| {
        for event in &input.raw.events {
            if let Event::ModifiersChanged(now) = event
                && std::mem::replace(&mut modifiers, *now) == *now
            {
                continue;
            }
            if let Some(what) = translate_event(event, place, pressed_here) {
                state.handle_input(now, what);
            }
        }
        modifiers = input.modifiers;
        let at = input.pointer.interact_pos();
        (input.pointer.any_down(), pressed_here && at.is_some_and(|at| place.contains(at)))
    });
    let event = state.end_frame(now, down, inside);
    if let Some(seconds) = state.repaint_delay() {
        ui.ctx().request_repaint_after_secs(seconds as f32);
    }
    if event == Some(HoldEvent::Stop) {
        stop_debounce::register_stop_press(ui.ctx(), true, now);
    }
    ui.data_mut(|data| {
        data.insert_temp(response.id, HoldButtonState { state, pass, modifiers });
        let drawn: &mut HoldButtonFrame = data.get_temp_mut_or_default(HoldButtonFrame::id());
        if scene.keyboard {
            drawn.keyboard = Some((response.id, pass));
        }
        if state.is_held_by_pointer() {
            drawn.pointer = Some(pass);
        }
    });
    let hint = theme.translate("hold.release_first");
    let ended = theme.translate("hold.ended");
    let is_held = state.is_held() && !button.has_ended;
    let caption = match state.is_waiting_for_release() {
        true => &hint,
        false if state.is_held() && button.has_ended => &ended,
        false => button.caption,
    };
    paint(ui, theme, &HoldButton { caption, enabled, ..*button }, &response, is_held);
    event
}

/// Translates an event for the button at `place`. `pressed_here` states whether the current pointer press began on it.
fn translate_event(event: &Event, place: Rect, pressed_here: bool) -> Option<HoldInput> {
    Some(match event {
        Event::WindowFocused(has) => HoldInput::WindowFocus(*has),
        Event::Key { key, pressed: false, .. } => HoldInput::Up(press_key(*key)?),
        Event::Key { key, pressed: true, modifiers, .. } => match press_key(*key) {
            Some(key) => HoldInput::Down { key, plain: modifiers.is_none() },
            None => HoldInput::OtherKey,
        },
        // The window received these keys as commands.
        Event::Copy | Event::Cut | Event::Paste(_) | Event::PasteImage(_) | Event::Ime(_) => HoldInput::OtherKey,
        Event::ModifiersChanged(_) => HoldInput::Modifiers,
        Event::PointerButton { pos, button, pressed: true, .. } => {
            HoldInput::PointerDown { on: *button == PointerButton::Primary && pressed_here && place.contains(*pos) }
        }
        Event::PointerButton { pressed: false, .. } => HoldInput::PointerUp,
        Event::PointerMoved(pos) => HoldInput::PointerMoved { inside: place.contains(*pos) },
        Event::PointerGone => HoldInput::PointerGone,
        Event::Touch { phase: TouchPhase::Start, .. } => HoldInput::Finger,
        _ => return None,
    })
}

fn paint(ui: &Ui, theme: &Theme, button: &HoldButton<'_>, response: &Response, held: bool) {
    let rect = response.rect;
    if !ui.is_rect_visible(rect) {
        return;
    }
    let palette = theme.palette;
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
    painter.rect_filled(rect, theme.radius, fill);
    painter.rect_stroke(rect, theme.radius, Stroke::new(1.0, edge), StrokeKind::Inside);
    let middle = rect.center();
    let word = pos2(middle.x, middle.y - theme.space.between);
    painter.text(word, Align2::CENTER_CENTER, button.word, theme.bold_font(theme.sizes.value), ink.into());
    let below = pos2(middle.x, rect.bottom() - theme.space.groups);
    let font = FontId::proportional(theme.sizes.caption);
    painter.text(below, Align2::CENTER_CENTER, button.caption, font, small.into());
    if response.has_focus() {
        focus_ring(painter, theme, rect, theme.radius);
    }
}
