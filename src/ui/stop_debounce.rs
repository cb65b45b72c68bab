//! Passes stop button presses from egui to the [`StopPressTracker`].

use egui::{Context, Event, Id, Key, Response, Ui};

use crate::app::StopPressTracker;

/// Returns whether a press in the frame at the given time is meant for a motion that is running or has just ended.
pub(crate) fn register_stop_press(ctx: &Context, moves: bool, pressed: f64) -> bool {
    let now = ctx.input(|input| input.time);
    with_stop_press_tracker(ctx, |presses| presses.register_stop_press(moves, pressed, now))
}

/// Returns whether a motion was stopped so recently that another press must also be meant as a stop.
pub(super) fn has_recently_stopped(ctx: &Context, pressed: f64) -> bool {
    with_stop_press_tracker(ctx, |presses| presses.has_recently_stopped(pressed))
}

fn with_stop_press_tracker<T>(ctx: &Context, act: impl FnOnce(&mut StopPressTracker) -> T) -> T {
    let id = Id::unique("presses of what stops");
    ctx.data_mut(|data| act(data.get_temp_mut_or_default(id)))
}

/// Returns whether the pointer is pressed on a stop button in this frame.
pub(crate) fn press_began(ui: &Ui, response: &Response) -> bool {
    let is_press = response.is_pointer_button_down_on() && ui.input(|input| input.pointer.primary_pressed());
    if is_press {
        let now = ui.input(|input| input.time);
        with_stop_press_tracker(ui.ctx(), |presses| presses.press_began(now));
    }
    is_press
}

/// Returns the time at which the stop button press that is handled in this frame began.
pub(crate) fn press_time(ui: &Ui, press_began: bool) -> f64 {
    let (now, released) = ui.input(|input| (input.time, input.pointer.any_released()));
    with_stop_press_tracker(ui.ctx(), |presses| presses.press_time(press_began || released, now))
}

/// Returns whether Escape was pressed in this frame. Repeats of a held key are ignored.
pub(super) fn is_escape_pressed(ctx: &Context) -> bool {
    let is_press = |event: &Event| matches!(event, Event::Key { key: Key::Escape, pressed: true, repeat: false, .. });
    ctx.input(|input| input.events.iter().any(is_press))
}
