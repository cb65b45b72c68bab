//! An SSI frame as a row of cells, one for each clock, with movable boundaries and single bits.
//!
//! * **Size**: the available width. Cells shrink to a minimum width. Below it, the strip wraps into as few lines of
//!   whole bytes as possible.
//! * **Keyboard**: Tab moves to the cells and from handle to handle. On the cells, the left and right arrow keys, Home
//!   and End select a cell, and Space inverts its bit if this is allowed. On a handle, the arrow keys move it by one
//!   clock, and Home and End move it as far as possible.
//! * **Pointer**: a click on a cell selects it and inverts its bit. A click on its number only selects it. A handle can
//!   be dragged. The resulting frame is shown during the drag, and Escape cancels the drag. The name and use of a
//!   handle are shown below it.
//! * **Accessible**: the cells are a slider with the given label, whose value is the selected cell. Each handle is a
//!   slider with its location. A field is a group with its bits.
//! * **Painting**: a cell has the colour of its field, with the clock number above it. It contains the bit or, if there
//!   is no frame, the number of the bit. There is a bracket with the name below each field and a tab at each movable
//!   end. A bit with a meaning is filled with the colour of its verdict, and so is its name, which has an icon.

mod grips;
mod names;
mod paint;
mod rows;

use egui::accesskit::Role;
use egui::{EventFilter, Id, Key, Modifiers, Rect, Sense, Ui, WidgetInfo};

use crate::devices::ssi::protocol::{BitMeaning, Role as Carries};
use crate::devices::ssi::state::strip::{self, CellState, Handle, Strip};
use crate::ui::Theme;

pub(super) use paint::display_colour as field_ink;

use names::NameTag;
use rows::Rows;

#[derive(Clone, Copy, Debug)]
pub(crate) struct BitStrip<'a> {
    pub(crate) label: &'a str,
    pub(crate) strip: &'a Strip,
    /// Right-justified bits to display, if known.
    pub(crate) frame: Option<u64>,
    pub(crate) selected: Option<u8>,
    /// Whether bits can be inverted.
    pub(crate) toggles: bool,
    /// Whether boundaries and single bits can be moved.
    pub(crate) movable: bool,
    /// Whether error and parity bits after the position move with its end.
    pub(crate) following: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum StripEvent {
    /// A part is dragged to this clock. The event is sent in every UI frame of the drag.
    Preview(Handle, u8),
    /// A part was moved to this clock, which differs from the old one.
    Moved(Handle, u8),
    Selected(u8),
    /// The user wants to invert the bit at this clock.
    Toggled(u8),
}

/// A drag in progress, which is kept between UI frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Drag {
    handle: Handle,
    /// Clock at which the drag started.
    from: Option<u8>,
    /// Clock to which the part is dragged, or `None` if the drag was cancelled.
    to: Option<u8>,
}

/// Draws the strip and returns the action of the user. If a `Ui` contains two strips, each needs an ID from `push_id`.
pub(crate) fn bit_strip(ui: &mut Ui, theme: &Theme, model: &BitStrip<'_>) -> Option<StripEvent> {
    let base = ui.make_persistent_id("bit_strip");
    let drag: Option<Drag> = ui.data(|data| data.get_temp(base));
    let held = drag.filter(|drag| model.movable && grips::is_dragged(ui, base, *drag));
    // The cells show the frame after the drag, whereas the handles remain at their current positions.
    let preview = held.and_then(|drag| Some(model.strip.with_moved_part(drag.handle, drag.to?, model.following)));
    let shown = preview.as_ref().unwrap_or(model.strip);
    let cells =
        model.frame.filter(|_| preview.is_none()).map(|frame| model.strip.cell_states(frame)).unwrap_or_default();
    let room = ui.available_width();
    let rows = Rows::new(room, model.strip.layout().clock_count());
    let meaning_of =
        |field: &strip::Field| common_meaning(&cells, field.first..=field.last).filter(|_| field.is_single_bit());
    let (tags, levels) = names::name_tags(ui, theme, shown, &rows, meaning_of);
    let clocks = shown.layout().clock_count();
    let sized = rows.clone().at_origin(egui::Pos2::ZERO, &levels);
    let (outer, _) = ui.allocate_exact_size(sized.size(clocks), Sense::hover());
    let rows = rows.at_origin(outer.min, &levels);
    let view = StripContext { ui, theme, model, shown, cells: &cells, rows: &rows, base };

    let chosen = view.handle_selection();
    view.fields(&tags);
    let pressed = view.handle_press(&tags);
    view.paint(&tags);
    let moved = if model.movable { grips::draw_handles(&view, drag) } else { None };
    moved.or(pressed).or(chosen)
}

struct StripContext<'a> {
    ui: &'a Ui,
    theme: &'a Theme,
    model: &'a BitStrip<'a>,
    shown: &'a Strip,
    /// States of the cells, or empty if no frame is known.
    cells: &'a [CellState],
    rows: &'a Rows,
    base: Id,
}

impl StripContext<'_> {
    fn handle_selection(&self) -> Option<StripEvent> {
        let (ui, model) = (self.ui, self.model);
        let clocks = model.strip.layout().clock_count();
        let id = self.base.with("cells");
        let area = self.rows.range_rects(1, clocks).into_iter().reduce(Rect::union).unwrap_or(Rect::NOTHING);
        let response = ui.interact(area, id, Sense::focusable_noninteractive());
        let selected = model.selected.filter(|clock| (1..=clocks).contains(clock));
        response.widget_info(|| {
            let mut info = WidgetInfo::labeled(Role::Slider, ui.is_enabled(), model.label);
            info.value = selected.map(f64::from);
            info.current_text_value = selected.map(|clock| self.cell_label(clock));
            info
        });
        if !response.has_focus() {
            return None;
        }
        reserve_arrow_keys(ui, id);
        let pressed = |key| ui.input_mut(|input| input.consume_key(Modifiers::NONE, key));
        let at = selected.unwrap_or(0);
        let mut to = at;
        for (key, target) in [
            (Key::ArrowLeft, at.saturating_sub(1).max(1)),
            (Key::ArrowRight, at.saturating_add(1).min(clocks)),
            (Key::Home, 1),
            (Key::End, clocks),
        ] {
            if pressed(key) {
                to = target;
            }
        }
        if to != at {
            return Some(StripEvent::Selected(to));
        }
        let turns = pressed(Key::Space) || pressed(Key::Enter);
        selected.filter(|_| turns && model.toggles).map(StripEvent::Toggled)
    }

    /// Returns the accessible label of a cell with its bit.
    fn cell_label(&self, clock: u8) -> String {
        let words = self.theme.format_text(&strip::cell_text(self.shown, clock));
        match self.cell_state_at(clock) {
            Some(cell) => format!("{words} = {}", u8::from(cell.bit)),
            None => words,
        }
    }

    fn cell_state_at(&self, clock: u8) -> Option<CellState> {
        self.cells.get(usize::from(clock.checked_sub(1)?)).copied()
    }

    /// Returns the number of the bit at a clock. The lowest bit has the number 0.
    fn bit_number(&self, clock: u8) -> Option<u8> {
        let cell = self.shown.cells().get(usize::from(clock.checked_sub(1)?))?;
        match cell.role {
            Carries::Multiturn(bit) | Carries::Singleturn(bit) | Carries::Position(bit) => Some(bit),
            _ => None,
        }
    }

    fn handle_press(&self, tags: &[NameTag]) -> Option<StripEvent> {
        let (ui, model) = (self.ui, self.model);
        let mut event = None;
        for tag in tags {
            let Some(field) = self.shown.fields().get(tag.field) else { continue };
            for clock in field.first..=field.last {
                let cell = self.rows.cell_rect(clock);
                let rect =
                    Rect::from_min_max(egui::pos2(cell.left(), self.rows.number_position(clock).y - 7.0), cell.max);
                let response = ui.interact(rect, self.base.with("cell").with(clock), Sense::CLICK);
                if response.clicked() {
                    // The arrow keys then move the selection from this cell.
                    ui.memory_mut(|memory| memory.request_focus(self.base.with("cells")));
                    let is_bit = response.interact_pointer_pos().is_some_and(|pos| cell.contains(pos));
                    let turns = is_bit && model.toggles && model.frame.is_some();
                    event = Some(if turns { StripEvent::Toggled(clock) } else { StripEvent::Selected(clock) });
                }
                response.on_hover_ui(|ui| {
                    ui.label(self.cell_label(clock));
                });
            }
        }
        event
    }

    /// Registers the field labels for screen readers.
    fn fields(&self, tags: &[NameTag]) {
        for tag in tags {
            let Some(field) = self.shown.fields().get(tag.field) else { continue };
            let (run, _) = names::widest_run(self.rows, field);
            let rect = tag.tag_rect(self.rows, Rows::lane_rect(run)).union(Rows::lane_rect(run));
            let response = self.ui.interact(rect, self.base.with("field").with(tag.field), Sense::hover());
            let name = self.theme.format_text(&strip::field(self.shown, field));
            let place = self.theme.format_text(&strip::clocks_text(field));
            response.widget_info(|| {
                let mut info = WidgetInfo::labeled(Role::Group, true, format!("{name}, {place}"));
                let bits = (field.first..=field.last).filter_map(|clock| self.cell_state_at(clock));
                let bits: String = bits.map(|cell| if cell.bit { '1' } else { '0' }).collect();
                info.current_text_value = Some(bits).filter(|bits| !bits.is_empty());
                info
            });
            response.on_hover_ui(|ui| {
                ui.label(format!("{name}\n{place}"));
            });
        }
    }
}

fn common_meaning(cells: &[CellState], clocks: std::ops::RangeInclusive<u8>) -> Option<BitMeaning> {
    let own = clocks.filter_map(|clock| cells.get(usize::from(clock.checked_sub(1)?))?.meaning);
    own.min_by_key(|meaning| *meaning == BitMeaning::Warning)
}

/// Reserves the left and right arrow keys for a widget, so that they do not move the focus.
fn reserve_arrow_keys(ui: &Ui, id: Id) {
    let filter = EventFilter { horizontal_arrows: true, ..EventFilter::default() };
    ui.memory_mut(|memory| memory.set_focus_lock_filter(id, filter));
}
