//! What a press means that comes on the heels of a stop: whoever stops a machine presses twice, holds the key, and lets go of
//! the button when the machine stands already. None of that is meant for whatever else runs.

use egui::{Context, Event, Key};

/// So soon after a stop, in seconds, another press means the same.
const FRIGHT: f64 = 0.5;

/// Whether what was pressed at this time, by the clock of the pictures, means what moves, or has moved until just now.
pub(super) fn means_motion(ctx: &Context, moves: bool, pressed: f64) -> bool {
    let id = egui::Id::unique("the last stop of a motion");
    let just_now = ctx.data(|data| data.get_temp::<f64>(id)).is_some_and(|stopped| pressed - stopped <= FRIGHT);
    let means = moves || just_now;
    if means {
        let now = ctx.input(|input| input.time);
        ctx.data_mut(|data| data.insert_temp(id, now));
    }
    means
}

/// Esc goes down in this picture; a key that is held and repeats itself does not.
pub(super) fn escape_goes_down(ctx: &Context) -> bool {
    let goes = |event: &Event| matches!(event, Event::Key { key: Key::Escape, pressed: true, repeat: false, .. });
    ctx.input(|input| input.events.iter().any(goes))
}
