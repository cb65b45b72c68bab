//! Pointer and keyboard input for the handles of a bit strip.

use egui::accesskit::Role;
use egui::{CursorIcon, Id, Key, Modifiers, Rect, Response, Sense, Ui, Vec2, WidgetInfo};

use super::rows::Rows;
use super::{Drag, StripContext, StripEvent, paint, reserve_arrow_keys};
use crate::devices::ssi::state::strip::{self, Handle, Strip};

/// Distance in points from a boundary to the sensitive area of its handle.
const GRIP_DISTANCE: f32 = 7.0;
const GRIP_WIDTH: f32 = 14.0;
/// Width in points of the last handle's sensitive area beyond the last clock.
const LAST_GRIP_WIDTH: f32 = 9.5;
/// Distance in points from a boundary to the visible tab of its handle.
const TAB_DISTANCE: f32 = 3.0;
const SECOND_TAB_DISTANCE: f32 = 8.0;
/// Fraction of a field at each end in which a drag does not move the whole field.
const END_FRACTION: f32 = 0.25;

pub(super) fn draw_handles(view: &StripContext<'_>, drag: Option<Drag>) -> Option<StripEvent> {
    let (ui, model) = (view.ui, view.model);
    let mut event = None;
    for handle in model.strip.strip_handles() {
        let Some((rect, at)) = grip_rect(view.rows, model.strip, *handle).zip(model.strip.clock(*handle)) else {
            continue;
        };
        let id = id(view.base, *handle);
        let turns = matches!(handle, Handle::Error(_) | Handle::Parity);
        let response = ui.interact(rect, id, if turns { Sense::click_and_drag() } else { Sense::drag() });
        response.widget_info(|| {
            let label = view.theme.format_text(&strip::handle_text(model.strip, *handle));
            let mut info = WidgetInfo::slider(ui.is_enabled(), f64::from(at), label);
            info.role = Role::Slider;
            info.current_text_value = Some(view.theme.format_text(&strip::value(model.strip, *handle)));
            info
        });
        if response.clicked() {
            let turns = model.toggles && model.frame.is_some();
            event = Some(if turns { StripEvent::Toggled(at) } else { StripEvent::Selected(at) });
        }
        if response.clicked() || response.drag_started() {
            response.request_focus();
        }
        event = apply_drag(view, &response, *handle, at, drag).or(handle_keys(view, &response, *handle, at)).or(event);
        let is_held = response.dragged();
        if is_held || response.hovered() {
            ui.set_cursor_icon(match (handle.is_on_clock(), is_held) {
                (true, true) => CursorIcon::Grabbing,
                (true, false) => CursorIcon::Grab,
                (false, _) => CursorIcon::ResizeHorizontal,
            });
        }
        let state = paint::GripState { active: is_held || response.hovered(), focused: response.has_focus() };
        paint::paint_grip(view, *handle, state, drag.filter(|_| is_held));
        if !is_held {
            show_tooltip(view, response, *handle);
        }
    }
    event
}

/// Returns the ID of a handle. It remains the same if zeros appear or disappear between turns and steps.
fn id(base: Id, handle: Handle) -> Id {
    let handle = if handle == Handle::TurnsEnd { Handle::Split } else { handle };
    base.with("handle").with(handle)
}

pub(super) fn is_dragged(ui: &Ui, base: Id, drag: Drag) -> bool {
    ui.ctx().is_being_dragged(id(base, drag.handle))
}

fn grip_rect(rows: &Rows, strip: &Strip, handle: Handle) -> Option<Rect> {
    let clock = strip.clock(handle)?;
    if matches!(handle, Handle::Error(_) | Handle::Parity) {
        let cell = rows.cell_rect(clock);
        return Some(cell.union(Rows::lane_rect(cell)));
    }
    if handle == Handle::Position {
        let (first, last) = strip.position()?;
        let runs = rows.range_rects(first, last);
        let widest = runs.into_iter().max_by(|a, b| a.width().total_cmp(&b.width()))?;
        // The ends of the field belong to its boundaries, so the position can only be dragged by its middle.
        let lane = Rows::lane_rect(widest);
        let ends = (lane.width() * END_FRACTION).max(GRIP_WIDTH).min(lane.width() / 3.0);
        return Some(lane.shrink2(Vec2::new(ends, 0.0)));
    }
    let edge = edge_rect(rows, strip, handle)?;
    let x =
        edge.center().x + field_side(handle) * if has_second_tab(strip, handle) { GRIP_WIDTH } else { GRIP_DISTANCE };
    let (top, bottom) = match handle {
        // Another boundary may be at the same edge.
        Handle::AreaEnd => (edge.top() - GRIP_DISTANCE * 3.0, edge.top()),
        _ => (edge.top(), edge.bottom()),
    };
    // The last handle ends with the strip.
    let right = if handle == Handle::FrameEnd { edge.center().x + LAST_GRIP_WIDTH } else { x + GRIP_WIDTH / 2.0 };
    Some(Rect::from_x_y_ranges(x - GRIP_WIDTH / 2.0..=right, top..=bottom))
}

pub(super) fn edge_rect(rows: &Rows, strip: &Strip, handle: Handle) -> Option<Rect> {
    let begins = matches!(handle, Handle::LeadEnd | Handle::BetweenEnd | Handle::GapEnd);
    let clocks = strip.layout().clock_count();
    // A boundary after bits that are shifted out would be located after the last clock.
    let clock = strip.clock(handle)?.min(clocks);
    Some(rows.edge_rect(clock, begins, clocks))
}

/// Returns the horizontal distance of a boundary's tab from its edge. Negative values are to the left.
pub(super) fn tab_offset(strip: &Strip, handle: Handle) -> f32 {
    field_side(handle) * if has_second_tab(strip, handle) { SECOND_TAB_DISTANCE } else { TAB_DISTANCE }
}

/// Returns whether the tab of a handle is the second one at its edge. The tab for the boundary between turns and steps
/// is closer to the edge than the one for zeros between them.
fn has_second_tab(strip: &Strip, handle: Handle) -> bool {
    handle == Handle::BetweenEnd && strip.strip_handles().contains(&Handle::Split)
}

/// Returns the side of the edge on which the field of a boundary is located: -1 before, 1 after, and 0 on both sides.
const fn field_side(handle: Handle) -> f32 {
    match handle {
        Handle::LeadEnd | Handle::BetweenEnd | Handle::GapEnd | Handle::FrameEnd => 1.0,
        Handle::TurnsEnd | Handle::StepsEnd => -1.0,
        _ => 0.0,
    }
}

/// Processes a pointer drag of a handle, including its end.
fn apply_drag(
    view: &StripContext<'_>,
    response: &Response,
    handle: Handle,
    at: u8,
    drag: Option<Drag>,
) -> Option<StripEvent> {
    let (ui, model) = (view.ui, view.model);
    let (held, released) = (response.dragged(), response.drag_stopped());
    if !held && !released {
        return None;
    }
    let clocks = model.strip.layout().clock_count();
    let own = drag.filter(|drag| drag.handle == handle);
    let pressed = || ui.input(|input| input.pointer.press_origin()).map(|pos| view.rows.clock(pos, clocks));
    let from = own.map_or_else(pressed, |drag| drag.from);
    let given_up = ui.input(|input| input.key_pressed(Key::Escape)) || own.is_some_and(|drag| drag.to.is_none());
    let to = response.interact_pointer_pos().filter(|_| !given_up).map(|pos| {
        let wanted = match handle {
            Handle::Error(_) | Handle::Parity => view.rows.clock(pos, clocks),
            Handle::Position => {
                let under = view.rows.clock(pos, clocks);
                let by = i16::from(under) - i16::from(from.unwrap_or(under));
                u8::try_from((i16::from(at) + by).max(0)).unwrap_or(u8::MAX)
            }
            _ => view.rows.nearest_boundary(pos, clocks),
        };
        model.strip.with_moved_part(handle, wanted, model.following).clock(handle).unwrap_or(at)
    });
    if released {
        ui.data_mut(|data| data.remove::<Drag>(view.base));
        return to.filter(|to| *to != at).map(|to| StripEvent::Moved(handle, to));
    }
    let now = Drag { handle, from, to };
    if drag != Some(now) {
        ui.data_mut(|data| data.insert_temp(view.base, now));
        ui.request_repaint();
    }
    to.map(|to| StripEvent::Preview(handle, to))
}

/// Handles the keys that move a handle by one clock or as far as possible.
fn handle_keys(view: &StripContext<'_>, response: &Response, handle: Handle, at: u8) -> Option<StripEvent> {
    if !response.has_focus() {
        return None;
    }
    let (ui, model) = (view.ui, view.model);
    reserve_arrow_keys(ui, response.id);
    let pressed = |key| ui.input_mut(|input| input.consume_key(Modifiers::NONE, key));
    let to = if pressed(Key::ArrowLeft) {
        at.saturating_sub(1)
    } else if pressed(Key::ArrowRight) {
        at.saturating_add(1)
    } else if pressed(Key::Home) {
        0
    } else if pressed(Key::End) {
        u8::MAX
    } else {
        return None;
    };
    let reached = model.strip.with_moved_part(handle, to, model.following).clock(handle)?;
    (reached != at).then_some(StripEvent::Moved(handle, reached))
}

fn show_tooltip(view: &StripContext<'_>, response: Response, handle: Handle) {
    response.on_hover_ui(|ui| {
        ui.set_max_width(280.0);
        ui.style_mut().wrap_mode = Some(egui::TextWrapMode::Wrap);
        let name = view.theme.format_text(&strip::handle_text(view.model.strip, handle));
        let value = view.theme.format_text(&strip::value(view.model.strip, handle));
        ui.label(format!("{name}: {value}"));
        ui.label(view.theme.caption(view.theme.format_text(&strip::handle_hint(handle))));
        let reach = strip::reach_text(view.model.strip, handle, view.model.following);
        ui.label(view.theme.caption(view.theme.format_text(&reach)));
    });
}
