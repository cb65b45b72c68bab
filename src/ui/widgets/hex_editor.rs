//! A byte editor with sixteen bytes per line, shown as hexadecimal digits and as text.
//!
//! * **Size**: the width of its columns and the height of its lines. It scrolls if there are more than
//!   [`HexModel::lines`] lines. A line below shows the cursor position, or the reason why an action was rejected.
//! * **Keyboard**: the arrows, Home, End, Page Up and Page Down move the cursor, with Ctrl to the ends, and with Shift
//!   extend the selection. Digits overwrite nibble by nibble, and characters overwrite bytes in the text column. Tab
//!   moves from the hex column to the text column and on. Delete writes 00, and Backspace restores the bytes of the
//!   device. Ctrl+A, C, V, Z, Shift+Z and Y work as usual.
//! * **Pointer**: a press sets the cursor, dragging or Shift selects, and a double click selects an aligned word of
//!   four bytes.
//! * **Accessible**: a text input with the given label, whose value is the address and the selected bytes, such as
//!   `0x0A: 3F`.
//! * **Painting**: changed bytes are underlined and have the colour of edits, the selection has the accent colour, and
//!   marks are brackets below their bytes.

mod addresses;
mod grid;
mod keys;
mod paint;
mod tooltip;
mod view;

use std::ops::Range;

use egui::accesskit::Role;
use egui::text::LayoutJob;
use egui::{Color32, EventFilter, FontId, Id, Response, ScrollArea, Sense, TextFormat, Ui, Vec2, WidgetInfo};

use super::focus_ring;
use crate::app::Text;
use crate::ui::{Theme, icons};

pub use addresses::HexAddresses;
use grid::Grid;
pub use view::HexView;

#[derive(Clone, Copy, Debug)]
pub struct HexModel<'a> {
    /// Bytes read from the device. If `wanted` is longer, the additional bytes count as changed.
    pub device: &'a [u8],
    /// Bytes shown, including the user's edits.
    pub wanted: &'a [u8],
    pub marks: &'a [HexAnnotation<'a>],
    /// Reason why the bytes cannot be edited, or `None` if they can.
    pub read_only: Option<&'a Text>,
    /// Maximum number of visible lines.
    pub lines: usize,
    pub addresses: HexAddresses,
}

#[derive(Clone, Debug)]
pub struct HexAnnotation<'a> {
    pub range: Range<usize>,
    pub words: &'a str,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum HexEdit {
    /// Writes bytes starting at an address. They never exceed the end.
    Put {
        address: usize,
        /// New bytes, at least one.
        bytes: Vec<u8>,
    },
    Undo,
    Redo,
    /// Restores the bytes of the device. At least one of the bytes differs from them.
    Revert {
        range: Range<usize>,
    },
}

impl<'a> HexModel<'a> {
    /// Creates a model of editable bytes without any marks.
    pub fn new(device: &'a [u8], wanted: &'a [u8]) -> Self {
        HexModel { device, wanted, marks: &[], read_only: None, lines: 16, addresses: HexAddresses::Counted }
    }

    fn address(&self, at: usize) -> String {
        self.addresses.text(at, self.wanted.len())
    }

    fn is_changed(&self, at: usize) -> bool {
        self.wanted.get(at) != self.device.get(at)
    }

    fn change_count(&self) -> usize {
        (0..self.wanted.len()).filter(|at| self.is_changed(*at)).count()
    }
}

/// Height of a line, in points.
const LINE_HEIGHT: f32 = 20.0;
/// Height in points of everything around the lines.
const SURROUNDING_HEIGHT: f32 = 60.0;
/// Height of the table of typed values below the editor, in points.
const TYPED_VIEW_WIDTH: f32 = 240.0;

/// Returns the number of lines that fit in the given height. If the table of typed values is next to the editor, the
/// editor fills the height. Otherwise, it leaves space for the table below but has at least sixteen lines.
pub fn hex_lines(height: f32, beside: bool) -> usize {
    if beside {
        ((height - SURROUNDING_HEIGHT) / LINE_HEIGHT).clamp(4.0, 64.0) as usize
    } else {
        ((height - SURROUNDING_HEIGHT - TYPED_VIEW_WIDTH) / LINE_HEIGHT).clamp(16.0, 64.0) as usize
    }
}

/// Draws the editor and returns the user's actions in order. The caller applies them to the bytes.
pub fn hex_editor(ui: &mut Ui, theme: &Theme, label: &str, model: &HexModel<'_>, view: &mut HexView) -> Vec<HexEdit> {
    let id = ui.make_persistent_id(("hex_editor", label));
    view.adapt_to_len(model.wanted.len());
    view.move_cursor_to_change(model.wanted);
    let edits = match ui.is_enabled() && ui.memory(|memory| memory.has_focus(id)) {
        true => keys::handle_keys(ui, model, view),
        false => {
            view.pending = None;
            Vec::new()
        }
    };
    let grid = Grid::new(ui, theme, model);
    ui.scope(|ui| {
        ui.spacing_mut().item_spacing = Vec2::ZERO;
        // Do not fade the edges while scrolling, because a half-visible line of bytes must be readable.
        ui.spacing_mut().scroll.fade.strength = 0.0;
        let narrow = ui.available_width() < grid.width + Grid::surrounding_width(ui, theme);
        let frame = theme.sunken_frame().show(ui, |ui| {
            let area = ScrollArea::horizontal().id_salt(id.with("across")).scroll([narrow, false]);
            area.show(ui, |ui| body_ui(ui, theme, id, &grid, model, view)).inner
        });
        let response = frame.inner;
        if response.has_focus() {
            focus_ring(ui.painter(), theme, frame.response.rect, theme.radius);
        }
        set_widget_info(ui, &response, label, model, view);
        ui.add_space(theme.space.inside);
        status_ui(ui, theme, &grid, model, view);
    });
    edits
}

fn body_ui(ui: &mut Ui, theme: &Theme, id: Id, grid: &Grid, model: &HexModel<'_>, view: &mut HexView) -> Response {
    let (header, _) = ui.allocate_exact_size(Vec2::new(grid.width, grid.row + theme.space.inside), Sense::hover());
    paint::header(ui, theme, grid, header, model, view);
    let shown = grid.line_count().clamp(1, model.lines.max(1));
    let height = grid.lines_height(shown);
    let area = ScrollArea::vertical().id_salt(id.with("lines")).max_height(height).min_scrolled_height(height);
    let lines = area.show(ui, |ui| {
        let size = Vec2::new(grid.width, grid.lines_height(grid.line_count().max(1)));
        let (rect, _) = ui.allocate_exact_size(size, Sense::hover());
        let response = ui.interact(rect, id, Sense::click_and_drag());
        handle_pointer(ui, &response, grid, model, view);
        if std::mem::take(&mut view.reveal) && !model.wanted.is_empty() {
            let cell = grid.cell_rect(rect.min, view.column, view.cursor());
            ui.scroll_to_rect_animation(cell, None, egui::style::ScrollAnimation::none());
        }
        let hovered = response.hover_pos().and_then(|pos| grid.cell_under_pointer(rect.min, pos));
        paint::paint_lines(ui, theme, grid, rect.min, model, view, &response, hovered);
        if let Some((column, at)) = hovered {
            // The tooltip is beside the byte.
            let cell = grid.cell_rect(rect.min, column, at);
            Response { rect: cell, interact_rect: cell, ..response.clone() }
                .on_hover_ui(|ui| tooltip::byte(ui, theme, model, at));
        }
        response
    });
    view.page = shown;
    lines.inner
}

fn handle_pointer(ui: &Ui, response: &Response, grid: &Grid, model: &HexModel<'_>, view: &mut HexView) {
    if response.gained_focus() {
        // The editor must receive the next arrow key, which moves the cursor and not the focus.
        ui.request_repaint();
    }
    if response.has_focus() {
        let filter =
            EventFilter { tab: true, horizontal_arrows: true, vertical_arrows: true, escape: view.pending.is_some() };
        ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, filter));
    }
    if response.hovered() {
        ui.set_cursor_icon(egui::CursorIcon::Text);
    }
    if response.clicked() {
        response.request_focus();
    }
    let (pressed, down, shift) =
        ui.input(|input| (input.pointer.primary_pressed(), input.pointer.primary_down(), input.modifiers.shift));
    let Some(pos) = response.interact_pointer_pos() else { return };
    // Outside the lines, the editor scrolls one line at a time.
    let pos = response.interact_rect.expand(grid.row).clamp(pos);
    if model.wanted.is_empty() {
        return;
    }
    let (column, at) = grid.nearest_byte(response.rect.min, pos, view.column, pressed);
    if pressed {
        response.request_focus();
        view.column = column;
        view.problem = None;
        view.move_cursor(at, shift);
    } else if down && at != view.cursor() {
        view.move_cursor(at, true);
    }
    if response.double_clicked() {
        let word = at - at % 4;
        view.select(word..(word + 4).min(model.wanted.len()));
    }
}

/// Sets the accessible name and value, which are used by screen readers and tests.
fn set_widget_info(ui: &Ui, response: &Response, label: &str, model: &HexModel<'_>, view: &HexView) {
    let selected = view.selection();
    let value = model.wanted.get(selected.clone()).filter(|bytes| !bytes.is_empty()).map(|bytes| {
        let first = model.address(selected.start);
        format!("{first}: {}", crate::bits::hex(bytes))
    });
    let read_only = model.read_only.is_some();
    response.widget_info(|| {
        let mut info = WidgetInfo::labeled(Role::MultilineTextInput, ui.is_enabled(), label);
        info.current_text_value = Some(value.clone().unwrap_or_default());
        info
    });
    ui.accesskit_node_builder(response.id, |node| {
        if read_only {
            node.set_read_only();
        }
    });
}

/// Draws the cursor address, or the reason why an action was rejected.
fn status_ui(ui: &mut Ui, theme: &Theme, grid: &Grid, model: &HexModel<'_>, view: &HexView) {
    ui.horizontal(|ui| {
        ui.set_min_height(grid.row);
        ui.spacing_mut().item_spacing.x = theme.space.groups;
        if let Some(problem) = &view.problem {
            let words = format!("{} {}", icons::WARNING_CIRCLE, theme.format_text(problem));
            ui.add(egui::Label::new(caption_layout(theme, &words, theme.palette.bad.into())).wrap());
            return;
        }
        let selected = view.selection();
        let first = model.address(selected.start);
        let place = match selected.len() {
            0 => Text::new("widget.hex_empty"),
            1 => Text::new("widget.hex_at").with("address", first).with("decimal", selected.start),
            count => Text::new("widget.hex_selected")
                .with("first", first)
                .with("last", model.address(selected.end.saturating_sub(1)))
                .with("count", count),
        };
        ui.label(caption_layout(theme, &theme.format_text(&place), theme.palette.muted.into()));
        let changes = model.change_count();
        if changes > 0 {
            let words = theme.format_text(&Text::new("widget.hex_changed").with("count", changes));
            ui.label(theme.caption(format!("{} {words}", icons::PENCIL_SIMPLE)).color(theme.palette.staged));
        }
    });
}

/// Returns a caption with its addresses in the monospaced font. The text font would display the `x` of `0x` as a
/// multiplication sign.
fn caption_layout(theme: &Theme, words: &str, colour: Color32) -> LayoutJob {
    let mut job = LayoutJob::default();
    for word in words.split_inclusive(' ') {
        let size = theme.sizes.caption;
        let font = if word.starts_with("0x") { FontId::monospace(size) } else { FontId::proportional(size) };
        job.append(word, 0.0, TextFormat { valign: egui::Align::Center, ..TextFormat::simple(font, colour) });
    }
    job
}
