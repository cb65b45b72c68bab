//! The trace panel, which lists the frames of the selected session: time, gap, direction, bytes and meaning. The newest
//! frame is at the bottom and stays visible until the user scrolls up or pauses the list. The details of a selected
//! frame are shown next to the list.

mod detail;

use egui::{Align, Id, Rangef, Rect, RichText, Sense, Ui, UiBuilder};
use egui_extras::{Column, TableBuilder, TableRow};

use crate::app::{Action, Rgb, SessionId, Studio, Text, TraceFault, TraceFilter, TraceLine, TraceLog, TraceMatches};
use crate::link::Direction;
use crate::ui::controls::{empty_placeholder, icon_button, name};
use crate::ui::entries::text_entry;
use crate::ui::row_selection::selection_step;
use crate::ui::{Theme, Views, icons};

const ROW_HEIGHT: f32 = 18.0;
const TIME: &str = "%H:%M:%S%.3f";
/// Width of the search entry in points.
const SEARCH_WIDTH: f32 = 200.0;
/// Widths of the time and gap columns, in points.
const TIMES: [f32; 2] = [96.0, 76.0];
/// Width of the direction arrow, in points.
const ARROW_WIDTH: f32 = 16.0;
/// Fraction of the remaining width for the bytes column.
const BYTES_SHARE: f32 = 0.48;
/// Width in points of the details next to the list.
const DETAIL_WIDTH: f32 = 290.0;

#[derive(Default)]
pub(in crate::ui) struct TraceView {
    session: Option<SessionId>,
    filter: TraceFilter,
    matches: TraceMatches,
    /// Number of the first frame that is hidden because the list is paused.
    paused_at: Option<u64>,
    /// Number of the selected frame.
    selected: Option<u64>,
    /// Number of rows that had been removed from the log when the list was last drawn with this filter.
    removed: Option<u64>,
    offset: f32,
    /// Whether the user has scrolled up.
    is_behind: bool,
}

impl TraceView {
    fn select(&mut self, session: SessionId, log: &TraceLog) {
        if self.session.replace(session) != Some(session) {
            let filter = std::mem::take(&mut self.filter);
            *self = TraceView { session: Some(session), filter, ..TraceView::default() };
        }
        // A new connection starts a new log, to which an earlier pause does not apply.
        self.paused_at = self.paused_at.filter(|end| *end <= log.next_number());
    }
}

pub(in crate::ui) fn trace_ui(
    ui: &mut Ui,
    theme: &Theme,
    studio: &Studio,
    views: &mut Views,
    actions: &mut Vec<Action>,
) {
    let shown = studio.selected_device().filter(|device| !device.trace().lines().is_empty());
    let Some((session, log)) = shown.map(|device| (device.id(), device.trace())) else {
        empty_placeholder(ui, theme, &theme.translate("trace.nothing"), None);
        return;
    };
    let view = &mut views.trace;
    view.select(session, log);
    let jumps_to_end = toolbar_ui(ui, theme, view, log, actions);
    let selected = view.selected.and_then(|number| log.line_by_number(number));
    view.selected = view.selected.filter(|_| selected.is_some());
    let room = ui.available_rect_before_wrap();
    let Some(line) = selected else {
        rows_ui(ui, theme, view, log, jumps_to_end);
        return;
    };
    let (list, detail) = room.split_left_right_at_x(room.right() - DETAIL_WIDTH);
    let list = Rect { max: list.max - egui::vec2(theme.space.groups, 0.0), ..list };
    ui.scope_builder(UiBuilder::new().max_rect(list), |ui| rows_ui(ui, theme, view, log, jumps_to_end));
    ui.scope_builder(UiBuilder::new().max_rect(detail), |ui| {
        if detail::frame_ui(ui, theme, log, line) {
            view.selected = None;
        }
    });
}

/// Draws the frames that match the filter.
fn rows_ui(ui: &mut Ui, theme: &Theme, view: &mut TraceView, log: &TraceLog, jumps_to_end: bool) {
    let end = view.paused_at.unwrap_or(log.next_number());
    let (filters, language) = (!view.filter.is_empty(), theme.language);
    if filters {
        view.matches.update_matches(log, &view.filter, language, end);
    }
    let matches = filters.then_some(&view.matches);
    let (rows, removed) = match matches {
        Some(matches) => (matches.frame_numbers().len(), matches.removed_count()),
        None => (usize::try_from(end.saturating_sub(log.removed_count())).unwrap_or_default(), log.removed_count()),
    };
    let number_of = |row: usize| match matches {
        Some(matches) => matches.frame_numbers().get(row).copied(),
        None => (row < rows).then(|| log.removed_count() + row as u64),
    };
    let row_of = |number: u64| match matches {
        Some(matches) => matches.frame_numbers().binary_search(&number).ok(),
        None => number.checked_sub(log.removed_count()).and_then(|row| usize::try_from(row).ok()),
    };
    let gone = view.removed.replace(removed).map_or(0, |before| removed.saturating_sub(before));
    if rows == 0 {
        let words = match view.filter.search.trim() {
            "" => theme.format_text(&Text::new("trace.no_faults").with("count", log.lines().len())),
            _ => theme.translate("trace.no_match"),
        };
        empty_placeholder(ui, theme, &words, None);
        return;
    }
    // The identifier must not depend on whether a frame is shown beside the list.
    let keys = Id::unique("trace_keys");
    let moved = selection_step(ui, keys).and_then(|step| number_of(row_of(view.selected?)?.checked_add_signed(step)?));
    view.selected = moved.or(view.selected);
    ui.spacing_mut().item_spacing.y = theme.space.inside;
    let pitch = ROW_HEIGHT + ui.spacing().item_spacing.y;
    let layer = ui.layer_id();
    let pressed = ui.input(|input| input.pointer.primary_pressed().then(|| input.pointer.interact_pos()).flatten());
    let pressed = pressed.filter(|place| ui.ctx().layer_id_at(*place) == Some(layer));
    // The bytes and the meaning share the rest.
    let bytes = ((ui.available_width() - TIMES[0] - TIMES[1] - ARROW_WIDTH) * BYTES_SHARE).max(0.0).floor();
    let mut table = TableBuilder::new(ui)
        .id_salt("trace")
        .auto_shrink(false)
        .sense(Sense::click())
        // Otherwise, the last rows of a low panel would be cut off.
        .min_scrolled_height(0.0)
        .stick_to_bottom(true);
    if jumps_to_end {
        table = table.scroll_to_row(rows - 1, Some(Align::BOTTOM)).animate_scrolling(false);
    } else if let Some(row) = moved.and_then(row_of) {
        table = table.scroll_to_row(row, None).animate_scrolling(false);
    } else if view.is_behind && gone > 0 {
        table = table.vertical_scroll_offset((view.offset - gone as f32 * pitch).max(0.0));
    }
    let selected = view.selected;
    let mut clicked = None;
    let drawn = table
        .column(Column::exact(TIMES[0]))
        .column(Column::exact(TIMES[1]))
        .column(Column::exact(ARROW_WIDTH))
        .column(Column::exact(bytes).clip(true))
        .column(Column::remainder().clip(true))
        .body(|body| {
            body.rows(ROW_HEIGHT, rows, |mut row| {
                let number = number_of(row.index());
                let Some((number, line)) = number.and_then(|number| Some((number, log.line_by_number(number)?))) else {
                    return;
                };
                let before = number.checked_sub(1).and_then(|before| log.line_by_number(before));
                row.set_selected(selected == Some(number));
                let height = line_ui(&mut row, theme, log, line, before);
                // While frames arrive, a different row may be under the pointer when the button is released. A row that
                // has just appeared has no response yet.
                if pressed.is_some_and(|place| height.contains(place.y)) {
                    clicked = Some(number);
                }
            });
        });
    if let Some(number) = clicked.filter(|_| pressed.is_some_and(|place| drawn.inner_rect.contains(place))) {
        view.selected = Some(number);
    }
    // A click takes the focus from any widget when the button is released.
    let released = ui.input(|input| input.pointer.primary_released().then(|| input.pointer.interact_pos()).flatten());
    if view.selected.is_some() && released.is_some_and(|place| drawn.inner_rect.contains(place)) {
        ui.memory_mut(|memory| memory.request_focus(keys));
    }
    view.offset = drawn.state.clamped_offset().y;
    view.is_behind = view.offset + drawn.inner_rect.height() < drawn.content_size.y - pitch / 2.0;
}

/// Draws the search, filter, pause and save controls. Returns whether to scroll to the newest frame.
fn toolbar_ui(ui: &mut Ui, theme: &Theme, view: &mut TraceView, log: &TraceLog, actions: &mut Vec<Action>) -> bool {
    let mut jumps_to_end = false;
    ui.horizontal(|ui| {
        let follows = !view.is_behind && view.paused_at.is_none();
        let word = theme.translate("trace.follow");
        let follow = egui::Button::selectable(follows, format!("{}  {word}", icons::FAST_FORWARD));
        let follow = name(ui.add(follow.frame_when_inactive(true)), true, &word);
        if follow.on_hover_text(theme.translate("trace.follow_hint")).clicked() {
            view.paused_at = follows.then(|| log.next_number());
            jumps_to_end = !follows;
        }
        let mut changed = false;
        let word = theme.translate("trace.faults");
        let faults = egui::Button::selectable(view.filter.faults_only, format!("{}  {word}", icons::WARNING));
        if name(ui.add(faults.frame_when_inactive(true)), true, &word).clicked() {
            view.filter.faults_only = !view.filter.faults_only;
            changed = true;
        }
        let word = theme.translate("trace.search");
        if text_entry(ui, &mut view.filter.search, SEARCH_WIDTH, &word, &word).changed() {
            changed = true;
        }
        if changed {
            view.removed = None;
            jumps_to_end = true;
        }
        if icon_button(ui, true, icons::FLOPPY_DISK, &theme.translate("trace.save")).clicked() {
            actions.extend(view.session.map(Action::AskTrace));
        }
        if let Some(end) = view.paused_at {
            let text = Text::new("trace.paused").with("count", log.next_number().saturating_sub(end));
            ui.label(theme.label(theme.format_text(&text)));
        } else if !view.filter.is_empty() {
            let shown = view.matches.frame_numbers().len();
            let text = Text::new("trace.matches").with("shown", shown).with("all", log.lines().len());
            ui.label(theme.label(theme.format_text(&text)));
        }
        if log.dropped_count() > 0 {
            let text = Text::new("trace.dropped").with("count", log.dropped_count());
            ui.add(egui::Label::new(RichText::new(theme.format_text(&text)).color(theme.palette.warn)).truncate());
        }
    });
    jumps_to_end
}

/// Draws a frame and returns the vertical range of its row.
fn line_ui(
    row: &mut TableRow<'_, '_>,
    theme: &Theme,
    log: &TraceLog,
    line: &TraceLine,
    before: Option<&TraceLine>,
) -> Rangef {
    let palette = theme.palette;
    let arrow = if line.direction == Direction::Sent { "→" } else { "←" };
    let colour = frame_colour(theme, line);
    row.col(|ui| {
        let time = log.line_time(line).map(|time| time.strftime(TIME).to_string()).unwrap_or_default();
        ui.label(theme.monospace(time).color(palette.muted));
    });
    row.col(|ui| {
        let Some(before) = before else { return };
        let seconds = line.at.duration_since(before.at).as_secs_f64();
        let gap = match seconds {
            10.0.. => format!("+{} s", theme.format_number(seconds, 1)),
            _ => format!("+{} ms", theme.format_number(seconds * 1e3, 1)),
        };
        ui.with_layout(egui::Layout::right_to_left(Align::Center), |ui| {
            ui.add_space(theme.space.inside);
            ui.label(theme.monospace(gap).color(palette.muted));
        });
    });
    row.col(|ui| {
        ui.label(theme.monospace(arrow).color(palette.accent));
    });
    row.col(|ui| {
        let bytes = if line.header > 0 { format!("… {}", line.message()) } else { line.bytes.clone() };
        ui.label(theme.monospace(bytes).color(colour));
    });
    let meaning = line.to_string_in(theme.language);
    let mut height = Rangef::NOTHING;
    row.col(|ui| {
        height = ui.max_rect().y_range();
        ui.label(RichText::new(&meaning).color(colour));
    });
    height
}

fn frame_colour(theme: &Theme, line: &TraceLine) -> Rgb {
    let palette = theme.palette;
    match (line.fault, line.direction) {
        (Some(TraceFault::Broken), _) => palette.bad,
        (Some(TraceFault::Reported), _) => palette.warn,
        (None, Direction::Sent) => palette.muted,
        (None, Direction::Received) => palette.text,
    }
}
