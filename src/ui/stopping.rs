//! What a press means that comes on the heels of a stop: whoever stops a machine presses twice, holds the key, and lets go of
//! the button when the machine stands already. None of that is meant for whatever else runs. It stops motion all the same:
//! something may have begun meanwhile.

use egui::{Context, Event, Id, Key, Response, Ui};

/// So soon after a stop, in seconds, another press means the same.
const FRIGHT: f64 = 0.5;

/// Whether what was pressed at this time, by the clock of the pictures, means what moves, or has moved until just now.
pub(crate) fn means_motion(ctx: &Context, moves: bool, pressed: f64) -> bool {
    let means = moves || has_just_stopped(ctx, pressed);
    if means {
        let now = ctx.input(|input| input.time);
        ctx.data_mut(|data| data.insert_temp(last_stop(), now));
    }
    means
}

/// Something was stopped by a press so shortly before this time that another press means the same.
pub(super) fn has_just_stopped(ctx: &Context, pressed: f64) -> bool {
    ctx.data(|data| data.get_temp::<f64>(last_stop())).is_some_and(|stopped| pressed - stopped <= FRIGHT)
}

fn last_stop() -> Id {
    Id::unique("the last stop of a motion")
}

/// The pointer goes down on a button that stops, in this picture.
pub(crate) fn goes_down(ui: &Ui, response: &Response) -> bool {
    let goes = response.is_pointer_button_down_on() && ui.input(|input| input.pointer.primary_pressed());
    if goes {
        let now = ui.input(|input| input.time);
        ui.data_mut(|data| data.insert_temp(last_press(), now));
    }
    goes
}

/// When what counts in this picture, on a button that stops, was pressed.
pub(crate) fn pressed_at(ui: &Ui, goes_down: bool) -> f64 {
    let now = ui.input(|input| input.time);
    // A click by the keyboard has no press of its own.
    let by_pointer = goes_down || ui.input(|input| input.pointer.any_released());
    ui.data(|data| data.get_temp(last_press())).filter(|_| by_pointer).unwrap_or(now)
}

fn last_press() -> Id {
    Id::unique("press of stop")
}

/// Esc goes down in this picture; a key that is held and repeats itself does not.
pub(super) fn escape_goes_down(ctx: &Context) -> bool {
    let goes = |event: &Event| matches!(event, Event::Key { key: Key::Escape, pressed: true, repeat: false, .. });
    ctx.input(|input| input.events.iter().any(goes))
}
