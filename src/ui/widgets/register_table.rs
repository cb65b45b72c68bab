//! Registers as a table, grouped by bank: address, name, value, meaning, access and default. A variant for numeric
//! parameters has number, name, value, unit, range and factory setting. Thousands of rows scroll as easily as ten: a
//! register is requested only while it is visible.
//!
//! * **Size**: the available width and the given height. The least important columns are hidden if space is short, and
//!   their values are shown in the tooltip. [`RegisterView::problem`] contains the reason why a value was rejected,
//!   which the caller displays.
//! * **Keyboard**: the arrows, Page Up, Page Down, Home and End move from line to line, and the left and right arrows
//!   fold and unfold bit fields and groups. Enter, F2 or a character edits the value. Enter accepts it, as does an up
//!   or down arrow, which then moves to another line. Escape cancels the entry, Backspace restores the value of the
//!   device, and Ctrl+C copies.
//! * **Pointer**: a press selects a line, folds on a heading or caret, and edits in the box of a number. A double click
//!   edits.
//! * **Accessible**: a table with the given label, whose value is the selection, a row for each visible register with
//!   its value and state, and a button for each group.
//! * **Painting**: edited values are underlined and have the colour of edits. A dot marks a change since the last
//!   reading, a flash a write cost, and a disk non-volatile storage. Editable numbers are in boxes.

mod columns;
mod editor;
mod keys;
mod lines;
mod paint;
mod view;

use std::ops::Range;

use egui::accesskit::Role;
use egui::{Id, Rect, Response, ScrollArea, Sense, Ui, UiBuilder, Vec2, WidgetInfo, pos2};

use super::focus_ring;
use crate::app::Text;
use crate::ui::{Theme, controls};

use columns::Columns;
use lines::{LineKind, Lines};
pub use view::RegisterView;
use view::SelectedRow;

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct RegisterLocation {
    pub group: usize,
    pub row: usize,
}

#[derive(Clone, Copy)]
pub struct RegisterTable<'a> {
    pub label: &'a str,
    pub groups: &'a [RegisterGroup],
    /// Function that returns a register of a group. It is called only for visible or unfolded registers.
    pub row: &'a dyn Fn(RegisterLocation) -> RegisterRow,
    pub kind: RegisterKind,
}

/// The kind of values in a table, which determines its columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RegisterKind {
    /// Bytes, shown as hexadecimal digits and as numbers.
    Bytes {
        /// Number of bytes of the widest register. The value column fits all of them.
        widest: usize,
    },
    Numbers,
}

#[derive(Clone, Debug, Default)]
pub struct RegisterGroup {
    pub title: String,
    pub note: String,
    pub rows: usize,
}

#[derive(Clone, Debug, Default)]
pub struct RegisterRow {
    /// Register address such as `0x04:0x1F`, or a parameter number.
    pub address: String,
    pub name: String,
    /// Value as the user would type it: hexadecimal bytes or a number. Empty if the register has not been read.
    pub value: String,
    pub decimal: String,
    pub meaning: String,
    /// Access: `R`, `W` or `RW`.
    pub access: String,
    /// Factory setting in the same format as the value. Empty if unknown.
    pub default: String,
    pub range: String,
    pub differs: bool,
    pub changed: bool,
    /// Previous value. Empty if unknown.
    pub before: String,
    /// Whether the value has been edited but not written.
    pub edited: bool,
    /// Cost of writing the register, if any.
    pub cost: Option<String>,
    /// Details of the non-volatile storage, or `None` if the value is lost without power.
    pub kept: Option<String>,
    /// Reason why the value cannot be edited, or `None` if it can.
    pub read_only: Option<String>,
    pub fields: Vec<RegisterBits>,
}

#[derive(Clone, Debug, Default)]
pub struct RegisterBits {
    /// Bit range of the field, such as `b3…b0`.
    pub bits: String,
    pub name: String,
    pub value: String,
    pub meaning: String,
    pub lit: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RegisterEvent {
    Revert(RegisterLocation),
}

#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RegisterTableOutput {
    pub event: Option<RegisterEvent>,
    pub groups: Range<usize>,
    /// Whether columns are hidden or narrower than usual. Parts of a row may then be cut off.
    pub is_narrow: bool,
}

const LINE_HEIGHT: f32 = 16.0;
/// Margin in points between the edge of the table and its lines.
const MARGIN: i8 = 4;
/// Number of characters reserved for a number. The longest one, −2³¹, has eleven.
const NUMBER: usize = 11;

/// Returns the width of a value, including the gap to the next column.
fn value_width(theme: &Theme, kind: RegisterKind) -> f32 {
    let characters = match kind {
        RegisterKind::Bytes { widest } => widest * 3,
        RegisterKind::Numbers => NUMBER,
    };
    // In the monospaced font, the width of a character is 0.6 of its size.
    characters as f32 * 0.6 * theme.sizes.body + theme.space.between
}

impl RegisterRow {
    fn value_text(&self, theme: &Theme) -> String {
        let mut parts = vec![self.value.clone(), self.decimal.clone(), self.meaning.clone()];
        parts.extend(self.differs.then(|| theme.translate("widget.register_differs")));
        parts.extend(self.changed.then(|| theme.translate("widget.register_changed")));
        parts.extend(self.edited.then(|| theme.translate("widget.register_edited")));
        parts.retain(|part| !part.is_empty());
        parts.join(", ")
    }

    fn label(&self) -> String {
        format!("{} {}", self.address, self.name)
    }
}

/// Draws the table at the given height and returns the user's actions. `take` receives the text typed for a register
/// and returns a reason if it is invalid.
pub fn register_table(
    ui: &mut Ui,
    theme: &Theme,
    table: &RegisterTable<'_>,
    height: f32,
    view: &mut RegisterView,
    take: &mut dyn FnMut(RegisterLocation, &str) -> Result<(), Text>,
) -> RegisterTableOutput {
    let id = ui.make_persistent_id(("register_table", table.label));
    let mut output = RegisterTableOutput::default();
    let mut lines = Lines::new(table, view);
    keys::restore_deferred_keys(ui, view, id);
    if ui.is_enabled() && ui.memory(|memory| memory.has_focus(id)) {
        output.event = keys::handle_keys(ui, table, &lines, view);
        lines = Lines::new(table, view);
    }
    ui.scope(|ui| {
        ui.spacing_mut().item_spacing = Vec2::ZERO;
        ui.spacing_mut().scroll.fade.strength = 0.0;
        let frame = theme.sunken_frame().inner_margin(MARGIN).show(ui, |ui| {
            controls::fill_width(ui);
            // The lines end at the scroll bar.
            let width = ui.available_width() - ui.spacing().scroll.allocated_width();
            let mut columns = Columns::new(table.kind, width, value_width(theme, table.kind));
            columns.has_small_names = view.small_names_at == Some(columns.width());
            output.is_narrow = columns.is_narrow();
            paint::header(ui, theme, table.kind, &columns);
            let room = (height - 2.0 * f32::from(MARGIN) - paint::HEADER_HEIGHT).max(LINE_HEIGHT * 3.0);
            body_ui(ui, theme, id, &columns, table, &lines, room, view, take, &mut output)
        });
        let response = frame.inner;
        if response.has_focus() {
            keys::reserve_keys(ui, id);
            focus_ring(ui.painter(), theme, frame.response.rect, theme.radius);
        }
        set_widget_info(&response, theme, table, view);
    });
    output
}

#[allow(clippy::too_many_arguments, reason = "drawing is told where, what and how")]
fn body_ui(
    ui: &mut Ui,
    theme: &Theme,
    id: Id,
    columns: &Columns,
    table: &RegisterTable<'_>,
    lines: &Lines,
    height: f32,
    view: &mut RegisterView,
    take: &mut dyn FnMut(RegisterLocation, &str) -> Result<(), Text>,
    output: &mut RegisterTableOutput,
) -> Response {
    view.page = ((height / LINE_HEIGHT) as usize).saturating_sub(1);
    let area = ScrollArea::vertical().id_salt(id.with("lines")).auto_shrink(false).max_height(height);
    let shown = area.min_scrolled_height(height).show_viewport(ui, |ui, viewport| {
        let size = Vec2::new(columns.width(), lines.total() as f32 * LINE_HEIGHT);
        let (whole, _) = ui.allocate_exact_size(size, Sense::hover());
        // The clip rectangle is larger than the table and includes its neighbours.
        let body = Rect::from_x_y_ranges(whole.x_range(), ui.clip_rect().y_range());
        let response = ui.interact(body, id, Sense::click());
        let at = |line: usize| {
            let top = whole.top() + line as f32 * LINE_HEIGHT;
            Rect::from_min_size(pos2(whole.left(), top), Vec2::new(columns.width(), LINE_HEIGHT))
        };
        if std::mem::take(&mut view.reveal)
            && let Some(line) = view.selected.and_then(|own| lines.line_index(own))
        {
            ui.scroll_to_rect_animation(at(line), None, egui::style::ScrollAnimation::none());
        }
        let first = (viewport.top() / LINE_HEIGHT).floor().max(0.0) as usize;
        let behind = ((viewport.bottom() / LINE_HEIGHT).ceil().max(0.0) as usize).min(lines.total());
        let groups = lines.group_at(first).zip(lines.group_at(behind.saturating_sub(1)));
        output.groups = groups.map_or(0..0, |(first, last)| first..last + 1);
        let was_refused = view.is_refused();
        for line in first..behind {
            let Some(kind) = lines.kind_of(line) else { continue };
            let rect = at(line);
            match kind {
                LineKind::Group(group) => paint_heading(ui, theme, id, rect, table, group, view),
                LineKind::Row(place) => row(ui, theme, id, rect, columns, table, place, view),
                LineKind::Bits(place, number) => {
                    if let Some(bits) = (table.row)(place).fields.get(number) {
                        paint::bits(ui, theme, rect, columns, bits);
                        let own = ui.interact(rect, id.with((place, number)), Sense::hover());
                        let words = format!("{} {}", bits.bits, bits.name);
                        let value = format!("{} {}", bits.value, bits.meaning);
                        own.widget_info(|| value_info(Role::Row, &words, &value));
                        own.on_hover_ui(|ui| paint::show_bits_tooltip(ui, theme, bits));
                    }
                }
            }
        }
        if let Some(edit) = &view.edit
            && let Some(line) = lines.line_index(SelectedRow::Row(edit.place))
            && let Some(range) = columns.column_range(columns::Column::Value)
        {
            let own = at(line);
            let cell = Rect::from_x_y_ranges(own.left() + range.min..=own.left() + range.max, own.y_range());
            let builder = UiBuilder::new().id_salt(id.with("edit")).max_rect(cell);
            editor::editor_ui(&mut ui.new_child(builder), theme, id, cell, table, view, take);
        }
        // A value that was just rejected stays visible until the next press discards it.
        let refused_now = view.is_refused() && !was_refused;
        if let Some(place) = view.wanted.take()
            && !refused_now
            && view.edit.as_ref().is_none_or(|edit| edit.place != place)
        {
            keys::begin_at(table, view, place, None);
        }
        response
    });
    shown.inner
}

fn paint_heading(
    ui: &Ui,
    theme: &Theme,
    id: Id,
    rect: Rect,
    table: &RegisterTable<'_>,
    group: usize,
    view: &mut RegisterView,
) {
    let Some(own) = table.groups.get(group) else { return };
    let response = ui.interact(rect, id.with("group").with(group), Sense::CLICK);
    let selected = view.selected == Some(SelectedRow::Group(group));
    response.widget_info(|| {
        let mut info = value_info(Role::Button, &own.title, &own.note);
        info.selected = Some(selected);
        info
    });
    if response.clicked() {
        let folded = view.is_folded(group);
        view.set_folded(group, !folded);
        view.selected = Some(SelectedRow::Group(group));
        view.refused = None;
        ui.memory_mut(|memory| memory.request_focus(id));
    }
    let state = paint::State::from_response(selected, &response);
    if !paint::paint_heading(ui, theme, rect, own, view.is_folded(group), state) {
        response.on_hover_text(&own.note);
    }
}

#[allow(clippy::too_many_arguments, reason = "drawing is told where, what and how")]
fn row(
    ui: &Ui,
    theme: &Theme,
    id: Id,
    rect: Rect,
    columns: &Columns,
    table: &RegisterTable<'_>,
    place: RegisterLocation,
    view: &mut RegisterView,
) {
    let row = (table.row)(place);
    let response = ui.interact(rect, id.with(place), Sense::CLICK);
    let selected = view.selected == Some(SelectedRow::Row(place));
    response.widget_info(|| value_info(Role::Row, &row.label(), &row.value_text(theme)));
    ui.accesskit_node_builder(response.id, |node| node.set_selected(selected));
    let open = view.open.contains(&place);
    if response.clicked() {
        let marks = columns.column_range(columns::Column::Marks);
        let on_caret = response.interact_pointer_pos().zip(marks).is_some_and(|(pos, marks)| {
            pos.x - rect.left() < marks.min + paint::CARET_OFFSET && !row.fields.is_empty()
        });
        if on_caret {
            view.set_expanded(place, !open);
        }
        view.selected = Some(SelectedRow::Row(place));
        view.refused = None;
        ui.memory_mut(|memory| memory.request_focus(id));
    }
    let boxed = (table.kind == RegisterKind::Numbers && row.read_only.is_none())
        .then(|| columns.column_range(columns::Column::Value).map(|value| paint::value_edit_rect(theme, rect, value)))
        .flatten();
    let in_box = response.clicked()
        && response.interact_pointer_pos().zip(boxed).is_some_and(|(pos, boxed)| boxed.contains(pos));
    if in_box || response.double_clicked() {
        // An open editor in another row is handled before this request.
        view.wanted = Some(place);
    }
    let typing = view.edit.as_ref().is_some_and(|edit| edit.place == place);
    let state = paint::State::from_response(selected, &response);
    if !paint::row(ui, theme, rect, (table.kind, columns), &row, (open, typing), state) && !columns.has_small_names {
        view.small_names_at = Some(columns.width());
        ui.ctx().request_repaint();
    }
    if response.hovered() && !typing {
        response.on_hover_ui(|ui| paint::show_tooltip(ui, theme, (table.kind, columns), &row));
    }
}

fn value_info(role: Role, label: &str, value: &str) -> WidgetInfo {
    let mut info = WidgetInfo::labeled(role, true, label);
    info.current_text_value = Some(value.to_owned());
    info
}

/// Sets the accessible description of the table for screen readers.
fn set_widget_info(response: &Response, theme: &Theme, table: &RegisterTable<'_>, view: &RegisterView) {
    let value = match view.selected {
        Some(SelectedRow::Row(place)) => {
            let row = (table.row)(place);
            format!("{}: {}", row.label(), row.value_text(theme))
        }
        Some(SelectedRow::Group(group)) => table.groups.get(group).map(|own| own.title.clone()).unwrap_or_default(),
        None => String::new(),
    };
    response.widget_info(|| value_info(Role::Table, table.label, &value));
}
