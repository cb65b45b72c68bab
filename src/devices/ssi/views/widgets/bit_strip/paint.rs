//! Paints a bit strip.

use egui::{Align2, Color32, CornerRadius, FontId, Rect, Stroke, StrokeKind, Vec2, pos2};

use super::grips::{edge_rect, tab_offset};
use super::names::{NameTag, meaning_verdict, widest_run};
use super::rows::Rows;
use super::{Drag, StripContext, common_meaning};
use crate::devices::ssi::protocol::BitMeaning;
use crate::devices::ssi::state::strip::{self, Field, Handle, Kind};
use crate::ui::widgets::{BitCell, focus_ring, series_colour};
use crate::ui::{Theme, controls};

/// Returns the colour of a field. Zeros have a muted colour.
pub(crate) fn display_colour(theme: &Theme, kind: Kind) -> Color32 {
    match kind {
        Kind::Before | Kind::Between | Kind::Behind | Kind::Gap | Kind::After => theme.palette.muted.into(),
        Kind::Turns => series_colour(theme, 0),
        Kind::Steps | Kind::Position => series_colour(theme, 1),
        Kind::Error(_) => series_colour(theme, 5),
        Kind::Parity => series_colour(theme, 6),
        Kind::Again => series_colour(theme, 7),
    }
}

fn meaning_colour(theme: &Theme, meaning: BitMeaning) -> Color32 {
    controls::verdict_badge(theme, meaning_verdict(meaning)).1.into()
}

impl StripContext<'_> {
    pub(super) fn paint(&self, tags: &[NameTag]) {
        let painter = self.ui.painter();
        for tag in tags {
            let Some(field) = self.shown.fields().get(tag.field) else { continue };
            for clock in field.first..=field.last {
                self.paint_cell(field, clock);
            }
            for run in self.rows.range_rects(field.first, field.last) {
                self.paint_bracket(field, Rows::lane_rect(run));
            }
            let (run, _) = widest_run(self.rows, field);
            let worst = common_meaning(self.cells, field.first..=field.last).filter(|_| field.is_single_bit());
            let colour = worst.map_or(self.theme.palette.muted.into(), |meaning| meaning_colour(self.theme, meaning));
            tag.paint(painter, self.theme, (self.rows, Rows::lane_rect(run)), colour);
        }
        let is_focused = self.ui.memory(|memory| memory.has_focus(self.base.with("cells")));
        let selected = self.model.selected.filter(|clock| *clock <= self.shown.layout().clock_count());
        if let Some(clock) = selected {
            let cell = self.rows.cell_rect(clock);
            let stroke = Stroke::new(2.0, self.theme.palette.accent);
            painter.rect_stroke(cell, CornerRadius::same(2), stroke, StrokeKind::Inside);
        }
        if is_focused {
            focus_ring(painter, self.theme, self.rows.cell_rect(selected.unwrap_or(1)), CornerRadius::same(2));
        }
    }

    fn paint_cell(&self, field: &Field, clock: u8) {
        let (theme, painter) = (self.theme, self.ui.painter());
        let cell = self.rows.cell_rect(clock);
        let shown = self.cell_state_at(clock);
        let cell_meaning = shown.and_then(|cell| cell.meaning);
        let blank = self.bit_number(clock).map_or_else(String::new, |bit| bit.to_string());
        let ink =
            cell_meaning.map_or_else(|| display_colour(theme, field.kind), |meaning| meaning_colour(theme, meaning));
        let bit = shown.map(|cell| cell.bit);
        BitCell { ink, bit, blank: &blank, alarm: cell_meaning.is_some() }.paint(painter, theme, cell);
        let is_selected = self.model.selected == Some(clock);
        let colour = if is_selected { theme.palette.text } else { theme.palette.muted };
        let font = FontId::monospace(theme.sizes.caption);
        painter.text(self.rows.number_position(clock), Align2::CENTER_CENTER, clock.to_string(), font, colour.into());
    }

    /// Draws the bracket below the cells of a field. It is thick if the field can be moved as a whole.
    fn paint_bracket(&self, field: &Field, lane: Rect) {
        let ink = display_colour(self.theme, field.kind);
        let is_moved = self.model.movable
            && (field.is_single_bit() || matches!(field.kind, Kind::Turns | Kind::Steps | Kind::Position));
        let stroke = Stroke::new(if is_moved { 3.0 } else { 1.0 }, ink);
        let (left, right, y) = (lane.left() + 1.0, lane.right() - 1.0, lane.center().y);
        let painter = self.ui.painter();
        painter.hline(left..=right, y, stroke);
        for x in [left + 0.5, right - 0.5] {
            painter.vline(x, y - 4.0..=y, Stroke::new(1.0, ink));
        }
    }
}

#[derive(Clone, Copy, Debug)]
pub(super) struct GripState {
    pub(super) active: bool,
    pub(super) focused: bool,
}

pub(super) fn paint_grip(view: &StripContext<'_>, handle: Handle, state: GripState, drag: Option<Drag>) {
    let (theme, painter) = (view.theme, view.ui.painter());
    let accent = Color32::from(theme.palette.accent);
    let lit = state.active || state.focused;
    if handle.is_on_clock() {
        let runs = match (handle, view.shown.clock(handle)) {
            (Handle::Position, _) => {
                view.shown.position().map(|(first, last)| view.rows.range_rects(first, last)).unwrap_or_default()
            }
            (_, Some(clock)) => vec![view.rows.cell_rect(clock)],
            (_, None) => Vec::new(),
        };
        for run in runs {
            let lane = Rows::lane_rect(run);
            if lit {
                painter.hline(lane.x_range(), lane.center().y, Stroke::new(3.0, accent));
            }
            let around = if handle == Handle::Position { lane.shrink2(Vec2::new(0.0, 3.0)) } else { run };
            if state.focused {
                focus_ring(painter, theme, around, CornerRadius::same(2));
            }
            if drag.is_some() {
                painter.rect_stroke(run, CornerRadius::same(2), Stroke::new(2.0, accent), StrokeKind::Inside);
            }
        }
    } else if let Some(edge) = edge_rect(view.rows, view.shown, handle) {
        let x = edge.center().x + tab_offset(view.shown, handle);
        let lane = edge.bottom() - 8.0;
        let y = if handle == Handle::AreaEnd { edge.top() - 7.0 } else { lane };
        let size = if lit { Vec2::new(5.0, 13.0) } else { Vec2::new(4.0, 11.0) };
        let tab = Rect::from_center_size(pos2(x, y), size);
        if lit {
            painter.vline(edge.center().x, edge.top()..=edge.bottom(), Stroke::new(1.5, accent));
        }
        painter.rect_filled(tab.expand(1.0), CornerRadius::same(2), theme.palette.raised);
        painter.rect_filled(tab, CornerRadius::same(2), if lit { accent } else { theme.palette.text.into() });
        if state.focused {
            focus_ring(painter, theme, tab, CornerRadius::same(2));
        }
    }
    if drag.is_some() {
        draw_drag_ghost(view, handle);
    }
}

fn draw_drag_ghost(view: &StripContext<'_>, handle: Handle) {
    let (theme, painter) = (view.theme, view.ui.painter());
    let Some(clock) = view.shown.clock(handle) else { return };
    let middle = match edge_rect(view.rows, view.shown, handle).filter(|_| !handle.is_on_clock()) {
        Some(edge) => pos2(edge.center().x, edge.top() - 8.0),
        None => view.rows.number_position(clock),
    };
    let words = theme.format_text(&strip::value(view.shown, handle));
    let font = FontId::proportional(theme.sizes.caption);
    let galley = painter.layout_no_wrap(words, font, theme.palette.on_accent.into());
    let size = galley.size() + Vec2::new(theme.space.between, 2.0);
    let room = view.ui.clip_rect();
    let left = (middle.x - size.x / 2.0).min(room.right() - size.x).max(room.left());
    let label = Rect::from_min_size(pos2(left, middle.y - size.y / 2.0), size);
    painter.rect_filled(label, theme.space.inside, theme.palette.accent);
    painter.galley(label.center() - galley.size() / 2.0, galley, theme.palette.on_accent.into());
}
