//! A map of a memory as a strip of blocks, showing the data fields and the free space.
//!
//! * **Size**: the available width. The blocks are as large as possible on two lines; more blocks wrap to further
//!   lines.
//! * **Keyboard**: Tab and the left and right arrows move from field to field, Home and End move to the first and last
//!   field, and Enter or Space selects a field. The caller's buttons also offer resizing.
//! * **Pointer**: a click selects a field. Dragging the handle at the end of the last field changes its size in whole
//!   blocks, with a preview until the release. Escape cancels.
//! * **Accessible**: a button for each field and one for the free space, with the given labels.
//! * **Painting**: each field has the colour of its series. Locked, unreadable and edited fields have an icon,
//!   unreadable ones are also hatched, and the selected one is outlined in the accent colour.

mod paint;
mod strip;

use std::ops::RangeInclusive;

use egui::accesskit::Role;
use egui::{CursorIcon, EventFilter, Id, Key, Modifiers, Rect, Response, Sense, Ui, Vec2, WidgetInfo};

use crate::app::Text;
use crate::ui::Theme;

use strip::Strip;

#[derive(Clone, Debug, Default)]
pub struct MapField {
    pub number: u8,
    /// Number of blocks in the field. An empty field is drawn as one block.
    pub blocks: usize,
    pub label: String,
    /// Caption below the number, in parts separated by ` · `. As many parts are shown as fit.
    pub caption: String,
    /// Colour index, one of eight colours.
    pub colour: usize,
    pub locked: bool,
    /// Whether the field cannot be read because its access code is unknown.
    pub unreadable: bool,
    /// Whether the field has edits that have not been written.
    pub edited: bool,
    pub tooltip: String,
}

#[derive(Clone, Debug, Default)]
pub struct FieldMap<'a> {
    /// Fields in memory order.
    pub fields: &'a [MapField],
    /// Free blocks after the last field.
    pub free_blocks: usize,
    pub free_label: &'a str,
    pub free_tooltip: &'a str,
    pub selected: Option<u8>,
    pub block_bytes: usize,
    /// Sizes in blocks to which the last field can be dragged, or `None` to hide the handle.
    pub resize: Option<RangeInclusive<usize>>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MapEvent {
    Select(u8),
    SelectFree,
    /// The user resized the last field. The new size differs from the current one.
    ResizeLast {
        blocks: usize,
    },
}

/// Draws the map and returns the user's action. A `Ui` can contain only one map, unless each map has a separate id
/// (`push_id`).
pub fn field_map(ui: &mut Ui, theme: &Theme, map: &FieldMap<'_>) -> Option<MapEvent> {
    let sizes: Vec<usize> = map.fields.iter().map(|field| field.blocks.max(1)).collect();
    let taken: usize = sizes.iter().sum();
    let strip = Strip::new(theme, ui.available_width(), taken + map.free_blocks);
    let (outer, _) = ui.allocate_exact_size(strip.size, Sense::hover());
    let strip = strip.at_origin(outer.min);
    let base = ui.make_persistent_id("field_map");
    let ids: Vec<Id> = (0..=map.fields.len()).map(|place| base.with(place)).collect();
    handle_arrow_keys(ui, &ids, map.free_blocks > 0);

    let mut event = None;
    let mut first = 0;
    for ((field, size), id) in map.fields.iter().zip(&sizes).zip(&ids) {
        let runs = strip.range_rects(first, first + size);
        let selected = map.selected == Some(field.number);
        let part = announce_part(ui, &runs, *id, &field.label, Some(selected), &field.tooltip);
        paint::field(ui, theme, &strip, &runs, field, &paint::State { selected, ..part.state });
        if part.clicked {
            event = Some(MapEvent::Select(field.number));
        }
        first += size;
    }
    if map.free_blocks > 0 {
        let runs = strip.range_rects(taken, taken + map.free_blocks);
        let id = ids.last().copied().unwrap_or(base);
        let part = announce_part(ui, &runs, id, map.free_label, None, map.free_tooltip);
        paint::paint_free_space(ui, theme, &strip, &runs, &part.state);
        if part.clicked {
            event = Some(MapEvent::SelectFree);
        }
    }
    let last = sizes.last().copied().unwrap_or_default();
    paint_boundary_handle(ui, theme, &strip, base, map, taken.saturating_sub(last), last).or(event)
}

/// Handles the arrow keys before the parts of the map are announced. The focus thus moves in memory order rather than
/// to the nearest widget.
fn handle_arrow_keys(ui: &Ui, ids: &[Id], has_free: bool) {
    let ids = if has_free { ids } else { ids.split_last().map_or(ids, |(_, fields)| fields) };
    let focused = ui.memory(egui::Memory::focused);
    let Some(at) = ids.iter().position(|id| Some(*id) == focused) else { return };
    ui.memory_mut(|memory| {
        if let Some(id) = ids.get(at) {
            let filter = EventFilter { horizontal_arrows: true, ..EventFilter::default() };
            memory.set_focus_lock_filter(*id, filter);
        }
    });
    let pressed = |key| ui.input_mut(|input| input.consume_key(Modifiers::NONE, key));
    let last = ids.len().saturating_sub(1);
    let mut to = at;
    for (key, target) in [
        (Key::ArrowLeft, at.saturating_sub(1)),
        (Key::ArrowRight, (at + 1).min(last)),
        (Key::Home, 0),
        (Key::End, last),
    ] {
        if pressed(key) {
            to = target;
        }
    }
    if let Some(id) = ids.get(to).filter(|_| to != at) {
        ui.memory_mut(|memory| memory.request_focus(*id));
        ui.request_repaint();
    }
}

struct Part {
    clicked: bool,
    state: paint::State,
}

fn announce_part(ui: &Ui, runs: &[Rect], id: Id, label: &str, selected: Option<bool>, tooltip: &str) -> Part {
    let widest = strip::widest_run(runs);
    let mut part = Part { clicked: false, state: paint::State::default() };
    for (number, rect) in runs.iter().enumerate() {
        let response = if number == widest {
            let response = ui.interact(*rect, id, Sense::click());
            response.widget_info(|| {
                let mut info = WidgetInfo::labeled(Role::Button, ui.is_enabled(), label);
                info.selected = selected;
                info
            });
            part.state.focused = response.has_focus();
            if response.gained_focus() {
                // The map must receive the next arrow key too.
                ui.request_repaint();
            }
            response
        } else {
            // These ids must not be plain numbers, which egui uses for tooltips.
            ui.interact(*rect, id.with("line").with(number), Sense::CLICK)
        };
        part.clicked |= response.clicked();
        part.state.hovered |= response.hovered();
        if response.clicked() {
            // Arrow keys continue from the clicked field.
            ui.memory_mut(|memory| memory.request_focus(id));
        }
        show_tooltip(response, tooltip);
    }
    part
}

fn show_tooltip(response: Response, tooltip: &str) {
    if !tooltip.is_empty() {
        response.on_hover_ui(|ui| {
            ui.label(tooltip);
        });
    }
}

fn paint_boundary_handle(
    ui: &Ui,
    theme: &Theme,
    strip: &Strip,
    base: Id,
    map: &FieldMap<'_>,
    start: usize,
    blocks: usize,
) -> Option<MapEvent> {
    let sizes = map.resize.as_ref().filter(|_| blocks > 0)?;
    let end = strip.range_rects(start, start + blocks).last().copied()?;
    let width = theme.space.between;
    let rect = Rect::from_center_size(end.right_center(), Vec2::new(width + theme.space.inside, end.height()));
    let response = ui.interact(rect, base.with("handle"), Sense::DRAG);
    if response.hovered() || response.dragged() {
        ui.set_cursor_icon(CursorIcon::ResizeHorizontal);
    }
    paint::paint_handle(ui, theme, end, response.hovered() || response.dragged());
    let pos = response.interact_pointer_pos();
    let given_up = ui.input(|input| input.key_pressed(Key::Escape));
    let wanted = pos.map(|pos| {
        let room = blocks + map.free_blocks;
        let (least, most) = (*sizes.start(), (*sizes.end()).min(room));
        strip.nearest_boundary(pos).saturating_sub(start).max(least.max(1)).min(most.max(1))
    });
    if let Some(wanted) = wanted.filter(|_| response.dragged()) {
        let text = Text::new("widget.map_size").with("bytes", wanted * map.block_bytes);
        paint::draw_drag_ghost(ui, theme, strip, &strip.range_rects(start, start + wanted), &theme.format_text(&text));
    } else if !response.dragged() {
        let words = theme.translate("widget.map_resize");
        show_tooltip(response.clone(), &words);
    }
    let released = response.drag_stopped() && !given_up;
    wanted.filter(|wanted| released && *wanted != blocks).map(|blocks| MapEvent::ResizeLast { blocks })
}
