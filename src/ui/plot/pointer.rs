//! Pointer and keyboard input on the chart.

use egui::{EventFilter, Key, Modifiers, PointerButton, Pos2, Rect, Response, Ui};

use super::Context;
use super::lanes::Layout;
use crate::analysis::SampleTime;
use crate::app::recorder::{Cursor, RecorderAction};

/// Distance in points within which the pointer grabs a cursor.
const GRAB_DISTANCE: f32 = 6.0;
/// Size of a dragged box, in points, below which the drag counts as a click.
const CLICK_SIZE: f32 = 5.0;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Drag {
    Cursor(Cursor),
    Box {
        from: Pos2,
        to: Pos2,
    },
    /// The chart is being dragged. Contains the time under the pointer at the start of the drag.
    Picture {
        under: SampleTime,
        window: (SampleTime, SampleTime),
    },
}

pub(super) fn handle_interaction(
    ui: &Ui,
    response: &Response,
    context: &mut Context<'_>,
    layout: &Layout,
    drag: &mut Option<Drag>,
) {
    let place = response.interact_pointer_pos();
    if response.drag_started()
        && let Some(place) = ui.input(|input| input.pointer.press_origin()).or(place)
    {
        *drag = Some(begin_drag(ui, response, context, layout, place));
        response.request_focus();
    }
    if response.clicked() {
        response.request_focus();
    }
    if let (Some(held), Some(place)) = (drag.as_mut(), place) {
        continue_drag(held, place, context, layout);
    }
    if response.drag_stopped()
        && let Some(Drag::Box { from, to }) = drag.take()
    {
        zoom_into(Rect::from_two_pos(from, to), context, layout);
    }
    if !response.dragged() {
        *drag = None;
    }
    if response.double_clicked() {
        context.push_action(RecorderAction::Fit);
    }
    handle_hover(ui, response, context, layout, drag.is_some());
    handle_keys(ui, response, context, layout);
}

fn begin_drag(ui: &Ui, response: &Response, context: &Context<'_>, layout: &Layout, place: Pos2) -> Drag {
    let shifted = ui.input(|input| input.modifiers.shift) || !response.dragged_by(PointerButton::Primary);
    match cursor_at(context, layout, place) {
        Some(cursor) if !shifted => Drag::Cursor(cursor),
        _ if shifted => Drag::Picture { under: layout.time.time(place.x), window: context.recorder.window_bounds() },
        _ => Drag::Box { from: place, to: place },
    }
}

fn cursor_at(context: &Context<'_>, layout: &Layout, place: Pos2) -> Option<Cursor> {
    let near = |cursor: &Cursor| {
        let time = context.recorder.cursor(*cursor);
        time.is_some_and(|time| (layout.time.x(time) - place.x).abs() <= GRAB_DISTANCE)
    };
    Cursor::BOTH.into_iter().find(near)
}

fn continue_drag(drag: &mut Drag, place: Pos2, context: &mut Context<'_>, layout: &Layout) {
    match drag {
        Drag::Cursor(cursor) => {
            let time = layout.time.time(place.x.clamp(layout.chart.left(), layout.chart.right()));
            context.push_action(RecorderAction::SetCursor(*cursor, Some(time)));
        }
        Drag::Box { to, .. } => *to = place,
        Drag::Picture { under, window: (from, to) } => {
            // The time is relative to the start of the visible span, because the layout moves with it.
            let here = from.saturating_add_ns((f64::from(place.x - layout.chart.left()) / layout.time.scale) as i64);
            let by = under.nanoseconds_since(here);
            context.push_action(RecorderAction::Look(from.saturating_add_ns(by), to.saturating_add_ns(by)));
        }
    }
}

/// Zooms into the dragged box. A wide box selects a time span, a tall box a value range, and a large box both.
fn zoom_into(chosen: Rect, context: &mut Context<'_>, layout: &Layout) {
    let chosen = chosen.intersect(layout.chart);
    if chosen.width() >= CLICK_SIZE {
        context.push_action(RecorderAction::Look(layout.time.time(chosen.left()), layout.time.time(chosen.right())));
    }
    let Some(lane) = layout.lanes.iter().find(|lane| lane.rect.contains(chosen.center())) else { return };
    let part = chosen.intersect(lane.rect).height();
    // A drag is never exactly horizontal. A flat box therefore selects only the time, as does one that covers the whole
    // lane.
    if part >= CLICK_SIZE * 3.0 && part < lane.rect.height() * 0.9 {
        let axis = lane.value_axis();
        let low = axis.value(chosen.bottom().min(lane.rect.bottom()));
        let high = axis.value(chosen.top().max(lane.rect.top()));
        for line in &lane.lines {
            context.push_action(RecorderAction::SetRange(*line, Some((low, high))));
        }
    }
}

fn handle_hover(ui: &Ui, response: &Response, context: &mut Context<'_>, layout: &Layout, dragging: bool) {
    let Some(place) = response.hover_pos().filter(|place| layout.chart.contains(*place)) else { return };
    if !dragging && cursor_at(context, layout, place).is_some() {
        ui.ctx().set_cursor_icon(egui::CursorIcon::ResizeHorizontal);
    }
    let zoom = ui.input(egui::InputState::zoom_delta);
    // Consume the wheel input. Otherwise, the page around the plot would scroll as well.
    let scroll = ui.input_mut(|input| std::mem::take(&mut input.smooth_scroll_delta));
    let factor = f64::from((-scroll.y * 0.005).exp() / zoom);
    if (factor - 1.0).abs() > 1e-4 {
        context.push_action(RecorderAction::Zoom(layout.time.time(place.x), factor));
    }
    if scroll.x != 0.0 {
        shift(context, -f64::from(scroll.x) / f64::from(layout.chart.width().max(1.0)));
    }
}

fn handle_keys(ui: &Ui, response: &Response, context: &mut Context<'_>, layout: &Layout) {
    if !response.has_focus() {
        return;
    }
    // Otherwise, the arrow keys would move the focus to the next widget.
    let filter = EventFilter { horizontal_arrows: true, ..EventFilter::default() };
    ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, filter));
    let pressed = |key| ui.input_mut(|input| input.consume_key(Modifiers::NONE, key));
    let middle = layout.time.time(layout.chart.center().x);
    let at = response.hover_pos().map_or(middle, |place| layout.time.time(place.x));
    for (key, action) in [
        (Key::Plus, RecorderAction::Zoom(middle, 0.5)),
        (Key::Equals, RecorderAction::Zoom(middle, 0.5)),
        (Key::Minus, RecorderAction::Zoom(middle, 2.0)),
        (Key::Home, RecorderAction::Fit),
        (Key::End, RecorderAction::Follow),
        (Key::A, RecorderAction::SetCursor(Cursor::A, Some(at))),
        (Key::B, RecorderAction::SetCursor(Cursor::B, Some(at))),
    ] {
        if pressed(key) {
            context.push_action(action);
        }
    }
    for (key, share) in [(Key::ArrowLeft, -0.1), (Key::ArrowRight, 0.1)] {
        if pressed(key) {
            shift(context, share);
        }
    }
}

/// Shifts the visible time span by the given fraction of its length.
fn shift(context: &mut Context<'_>, share: f64) {
    let (from, to) = context.recorder.window_bounds();
    let by = (context.recorder.window_length() as f64 * share) as i64;
    context.push_action(RecorderAction::Look(from.saturating_add_ns(by), to.saturating_add_ns(by)));
}
