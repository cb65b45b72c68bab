//! Painting of a field map.

use egui::{Align2, Color32, CornerRadius, FontId, Rect, Shape, Stroke, StrokeKind, Ui, Vec2};

use super::MapField;
use super::strip::{Strip, widest_run};
use crate::ui::widgets::{draw_hatching, focus_ring, series_colour};
use crate::ui::{Theme, icons};

#[derive(Clone, Copy, Debug, Default)]
pub(super) struct State {
    pub(super) selected: bool,
    pub(super) focused: bool,
    pub(super) hovered: bool,
}

/// Returns the outline of one line of a field, inset by half a gap. Corners are rounded at the ends of the field and
/// square where it continues on another line.
fn run_outline(theme: &Theme, runs: &[Rect], number: usize) -> (Rect, CornerRadius) {
    let Some(run) = runs.get(number) else { return (Rect::NOTHING, CornerRadius::ZERO) };
    let (begins, ends) = (number == 0, number + 1 == runs.len());
    let (mut rect, radius) = (*run, theme.radius.nw);
    if begins {
        rect.min.x += 1.0;
    }
    if ends {
        rect.max.x -= 1.0;
    }
    let at = |round: bool| if round { radius } else { 0 };
    (rect, CornerRadius { nw: at(begins), sw: at(begins), ne: at(ends), se: at(ends) })
}

pub(super) fn field(ui: &Ui, theme: &Theme, strip: &Strip, runs: &[Rect], field: &MapField, state: &State) {
    let colour = series_colour(theme, field.colour);
    let painter = ui.painter();
    for number in 0..runs.len() {
        let (rect, corners) = run_outline(theme, runs, number);
        painter.rect_filled(rect, corners, theme.palette.sunken);
        let strength = if state.hovered { 0.34 } else { 0.22 };
        painter.rect_filled(rect, corners, colour.gamma_multiply(strength));
        if field.unreadable {
            draw_hatching(painter, theme, rect, colour.gamma_multiply(0.3));
        }
        let run = runs.get(number).copied().unwrap_or(rect);
        let mut x = run.left() + strip.block.x;
        while x < run.right() - 1.0 {
            // The lines are only at the edges, because the texts of the field are in between.
            let (top, bottom) = (rect.top(), rect.bottom());
            let stroke = Stroke::new(1.0, colour.gamma_multiply(0.7));
            painter.vline(x - 0.5, top..=top + theme.space.inside, stroke);
            painter.vline(x - 0.5, bottom - theme.space.inside..=bottom, stroke);
            x += strip.block.x;
        }
        let (width, edge) = if state.selected { (2.0, theme.palette.accent.into()) } else { (1.0, colour) };
        painter.rect_stroke(rect, corners, Stroke::new(width, edge), StrokeKind::Inside);
        if state.focused {
            focus_ring(painter, theme, rect, corners);
        }
    }
    if let Some(run) = runs.get(widest_run(runs)) {
        draw_label(ui, theme, *run, field);
    }
}

/// Draws the number and icons of a field at the top and its caption below, if they fit. In a narrow field, icons
/// replace the caption.
fn draw_label(ui: &Ui, theme: &Theme, run: Rect, field: &MapField) {
    let palette = theme.palette;
    let inside = run.shrink2(Vec2::new(theme.space.between, theme.space.inside + 2.0));
    let painter = ui.painter();
    let flags = [
        (field.edited, icons::PENCIL_SIMPLE, palette.staged),
        (field.locked, icons::LOCK_SIMPLE, palette.text),
        (field.unreadable, icons::KEY, palette.text),
    ];
    let shown: Vec<_> = flags.into_iter().filter(|(shown, ..)| *shown).collect();
    let size = theme.sizes.body;
    let pitch = size + 1.0;
    let font = theme.bold_font(size);
    let number = painter.layout_no_wrap(field.number.to_string(), font, palette.text.into());
    let beside = number.size().x + theme.space.inside + shown.len() as f32 * pitch <= inside.width();
    let caption = fitting_caption(ui, theme, &field.caption, inside.width()).filter(|_| beside);
    let (top, bottom) = (inside.top() + size / 2.0, inside.bottom() - size / 2.0 + 1.0);
    let y = if caption.is_some() || !beside { top } else { inside.center().y };
    let narrow = run.width() < theme.space.inside * 7.0;
    let left = if narrow { run.center().x - number.size().x / 2.0 } else { inside.left() };
    if number.size().x <= run.width() - 2.0 {
        painter.galley(egui::pos2(left, y - number.size().y / 2.0), number, palette.text.into());
    }
    // Draw as many icons as fit. The tooltip contains all of them.
    let room = if beside { shown.len() } else { (((run.width() - 2.0) / pitch) as usize).max(1) };
    let count = shown.len().min(room);
    let width = count as f32 * pitch;
    let (first, y) = if beside { (inside.right() - width, y) } else { (run.center().x - width / 2.0, bottom) };
    for (place, (_, icon, colour)) in shown.iter().take(count).enumerate() {
        let center = egui::pos2(first + pitch * (place as f32 + 0.5), y);
        painter.text(center, Align2::CENTER_CENTER, icon, FontId::proportional(size), Color32::from(*colour));
    }
    if let Some(caption) = caption {
        let at = egui::pos2(inside.left(), bottom - caption.size().y / 2.0);
        painter.galley(at, caption, palette.text.into());
    }
}

/// Returns as much of a caption as fits. Parts separated by ` · ` are dropped from the end.
fn fitting_caption(ui: &Ui, theme: &Theme, caption: &str, room: f32) -> Option<std::sync::Arc<egui::Galley>> {
    let mut rest = caption;
    while !rest.is_empty() {
        let font = FontId::proportional(theme.sizes.caption);
        let galley = ui.painter().layout_no_wrap(rest.to_owned(), font, theme.palette.text.into());
        if galley.size().x <= room {
            return Some(galley);
        }
        rest = rest.rsplit_once(" · ").map_or("", |(head, _)| head);
    }
    None
}

/// Draws the free space as one outline per block.
pub(super) fn paint_free_space(ui: &Ui, theme: &Theme, strip: &Strip, runs: &[Rect], state: &State) {
    let painter = ui.painter();
    let edge = match state.hovered {
        true => theme.palette.accent.into(),
        false => Color32::from(theme.palette.muted).gamma_multiply(0.5),
    };
    for number in 0..runs.len() {
        let (rect, corners) = run_outline(theme, runs, number);
        let run = runs.get(number).copied().unwrap_or(rect);
        let mut x = run.left();
        while x < run.right() - 1.0 {
            let block = Rect::from_min_size(egui::pos2(x, run.top()), strip.block).shrink2(Vec2::new(2.0, 0.0));
            painter.rect_stroke(block, theme.space.inside, Stroke::new(1.0, edge), StrokeKind::Inside);
            x += strip.block.x;
        }
        if state.focused {
            focus_ring(painter, theme, rect, corners);
        }
    }
}

pub(super) fn paint_handle(ui: &Ui, theme: &Theme, run: Rect, active: bool) {
    let colour = if active { theme.palette.accent } else { theme.palette.text };
    let (x, y) = (run.right() - theme.space.between, run.center().y);
    let half = if active { theme.space.between + 2.0 } else { theme.space.between };
    for x in [x - 0.5, x + 2.5] {
        ui.painter().vline(x, y - half..=y + half, Stroke::new(1.0, colour));
    }
}

pub(super) fn draw_drag_ghost(ui: &Ui, theme: &Theme, strip: &Strip, runs: &[Rect], words: &str) {
    let accent = Color32::from(theme.palette.accent);
    let painter = ui.painter();
    for number in 0..runs.len() {
        let (rect, corners) = run_outline(theme, runs, number);
        painter.rect_filled(rect, corners, accent.gamma_multiply(0.16));
        let rect = rect.shrink(0.5);
        let path = [rect.left_top(), rect.right_top(), rect.right_bottom(), rect.left_bottom(), rect.left_top()];
        painter.extend(Shape::dashed_line(&path, Stroke::new(1.5, accent), theme.space.inside, theme.space.inside));
    }
    let Some(last) = runs.last() else { return };
    // The label is on the accent, at the end of the preview but always inside the map.
    let font = FontId::monospace(theme.sizes.caption);
    let galley = painter.layout_no_wrap(words.to_owned(), font, theme.palette.on_accent.into());
    let size = galley.size() + Vec2::new(theme.space.between, theme.space.inside);
    let right = last.right() - theme.space.between;
    let left = (right - size.x).max(strip.origin.x);
    let label = Rect::from_min_size(egui::pos2(left, last.center().y - size.y / 2.0), size);
    painter.rect_filled(label, theme.space.inside, accent);
    painter.galley(label.center() - galley.size() / 2.0, galley, theme.palette.on_accent.into());
}
