//! A timing diagram of a burst to scale: clock line, data line with its bits, and the times between them.
//!
//! * **Size**: the available width, and the height required by the labels.
//! * **Keyboard**: none. Tab skips the diagram.
//! * **Pointer**: shows the time under the pointer, with the clock and its content.
//! * **Accessible**: an image with the given label, whose value lists the times.
//! * **Painting**: moments are vertical lines below their labels. The clock is drawn as a waveform. Bits are drawn in
//!   the colours of their fields with the field name below. Each time is a dimension line in a lane. Where nothing
//!   happens, the axis is broken and the omitted time is stated.

mod axis;
mod label_layout;

use std::sync::Arc;

use crate::devices::ssi::state::TEXTS;

use egui::accesskit::Role;
use egui::{Color32, FontId, Galley, Painter, Rangef, Rect, Sense, Shape, Stroke, Ui, Vec2, WidgetInfo, pos2};

use super::bit_strip::field_ink;
use crate::app::Text;
use crate::devices::ssi::state::strip::{CellState, field_name, short_label};
use crate::devices::ssi::state::timing::{BurstDiagram, skipped_operations};
use crate::ui::Theme;

use axis::Axis;
use label_layout::{Bar, LabelExtent, LabelPlacement};

#[derive(Clone, Copy, Debug)]
pub(crate) struct TimingDiagram<'a> {
    pub(crate) label: &'a str,
    pub(crate) diagram: &'a BurstDiagram,
    /// Right-justified bits to display, if known.
    pub(crate) frame: Option<u64>,
}

/// Height of a signal row.
const ROW_HEIGHT: f32 = 24.0;
const TEXT_HEIGHT: f32 = 15.0;
const LANE_HEIGHT: f32 = 19.0;
/// Length of the lines before the first edge.
const LEAD_LENGTH: f32 = 12.0;
/// Minimum bit width at which a digit is drawn.
const MIN_DIGIT_WIDTH: f32 = 9.0;

struct Rows {
    flags: f32,
    clock: Rangef,
    data: Rangef,
    names: f32,
    lanes: f32,
    bottom: f32,
}

pub(crate) fn timing_diagram(ui: &mut Ui, theme: &Theme, model: &TimingDiagram<'_>) {
    theme.sunken_frame().show(ui, |ui| diagram_ui(ui, theme, model));
}

fn diagram_ui(ui: &mut Ui, theme: &Theme, model: &TimingDiagram<'_>) {
    let diagram = model.diagram;
    let caption = |text: &Text, colour: Color32| {
        ui.painter().layout_no_wrap(theme.format_text(text), FontId::proportional(theme.sizes.caption), colour)
    };
    let (text, muted) = (Color32::from(theme.palette.text), Color32::from(theme.palette.muted));
    let lines = ["ssi.timing_clock", "ssi.timing_data"].map(|id| caption(&TEXTS.text(id), muted));
    let width = ui.available_width();
    let gutter = lines.iter().map(|line| line.size().x).fold(0.0, f32::max) + theme.space.between;
    let room = Rangef::new(gutter + LEAD_LENGTH, (width - theme.space.inside).max(gutter + 2.0 * LEAD_LENGTH));
    let axis = Axis::new(diagram.sections(), room);

    let breaks = axis.break_ranges();
    let left_out = (0..breaks.len()).map(|piece| caption(&skipped_operations(diagram.gap_after_piece(piece)), muted));
    let moments = diagram.marks().iter().map(|mark| (axis.x(mark.at), caption(&mark.event.to_text(), text)));
    let mut flags: Vec<(f32, Arc<Galley>, bool)> = moments.map(|(x, galley)| (x, galley, true)).collect();
    flags.extend(breaks.iter().zip(left_out).map(|(gap, galley)| (gap.center(), galley, false)));
    flags.sort_by(|a, b| a.0.total_cmp(&b.0));
    let sizes: Vec<LabelExtent> =
        flags.iter().map(|(x, galley, _)| LabelExtent { x: *x, width: galley.size().x }).collect();
    let flags_put = label_layout::place_labels(&sizes, (0.0, width));

    let bars = diagram.spans().iter().map(|span| caption(&diagram.span_text(span), text));
    let bars: Vec<Arc<Galley>> = bars.collect();
    let ends = diagram.spans().iter().map(|span| (axis.x(span.from), axis.x(span.to)));
    let sizes = ends.zip(&bars).map(|(ends, galley)| Bar { ends, width: galley.size().x });
    let bars_put = label_layout::place_bars(&sizes.collect::<Vec<_>>(), (0.0, width));

    let count = |put: &[LabelPlacement]| put.iter().map(|put| put.level + 1).max().unwrap_or(0) as f32;
    let heights = [
        count(&flags_put) * TEXT_HEIGHT + 4.0,
        ROW_HEIGHT,
        8.0,
        ROW_HEIGHT,
        TEXT_HEIGHT + 4.0,
        count(&bars_put) * LANE_HEIGHT,
    ];
    let (outer, response) = ui.allocate_exact_size(Vec2::new(width, heights.iter().sum()), Sense::hover());
    let values: Vec<String> = diagram.spans().iter().map(|span| theme.format_text(&diagram.span_text(span))).collect();
    response.widget_info(|| {
        let mut info = WidgetInfo::labeled(Role::Image, true, model.label);
        info.current_text_value = Some(values.join(", "));
        info
    });
    if ui.is_rect_visible(outer) {
        let at = |rows: usize| outer.top() + heights.iter().take(rows).sum::<f32>();
        let row = |number: usize| Rangef::new(at(number) + 4.0, at(number + 1) - 4.0);
        let rows = Rows { flags: at(1) - 4.0, clock: row(1), data: row(3), names: at(4), lanes: at(5), bottom: at(6) };
        let painter = ui.painter().clone();
        let picture = Picture { painter: &painter, theme, model, axis: &axis, left: outer.left(), rows: &rows };
        for (galley, row) in lines.into_iter().zip([rows.clock, rows.data]) {
            painter.galley(pos2(outer.left(), row.center() - galley.size().y / 2.0), galley, muted);
        }
        picture.draw_guides(&flags, &flags_put);
        picture.clock(outer.left() + gutter);
        picture.data(outer.left() + gutter);
        picture.paint_names();
        picture.paint_breaks(&breaks);
        picture.paint_bars(&bars, &bars_put);
        if let Some(pos) = response.hover_pos().filter(|pos| axis.time_at(pos.x - outer.left()).is_some()) {
            let stroke = Stroke::new(1.0, theme.palette.accent);
            painter.vline(pos.x, rows.clock.min - 4.0..=rows.bottom, stroke);
        }
    }
    let under = response.hover_pos().and_then(|pos| axis.time_at(pos.x - outer.left()));
    if let Some(at) = under {
        response.on_hover_ui_at_pointer(|ui| {
            for (number, text) in diagram.describe_moment(at).iter().enumerate() {
                let words = theme.format_text(text);
                if number == 0 {
                    ui.label(theme.caption(words))
                } else {
                    ui.label(words)
                };
            }
        });
    }
}

struct Picture<'a> {
    painter: &'a Painter,
    theme: &'a Theme,
    model: &'a TimingDiagram<'a>,
    axis: &'a Axis,
    left: f32,
    rows: &'a Rows,
}

impl Picture<'_> {
    fn x(&self, at: f64) -> f32 {
        self.left + self.axis.x(at)
    }

    fn line_colour(&self) -> Color32 {
        self.theme.palette.muted.into()
    }

    /// Draws the labels of events and breaks, and a vertical line through all rows for each event.
    fn draw_guides(&self, flags: &[(f32, Arc<Galley>, bool)], put: &[LabelPlacement]) {
        for ((x, galley, is_moment), put) in flags.iter().zip(put) {
            let top = self.rows.flags - (put.level + 1) as f32 * TEXT_HEIGHT;
            let at = pos2(self.left + put.left, top);
            if *is_moment {
                let (x, faint) = (self.left + x, Stroke::new(1.0, self.theme.palette.line));
                let below = (at.x..=at.x + galley.size().x).contains(&x);
                let ends = [pos2(x, if below { top + TEXT_HEIGHT } else { top + 2.0 }), pos2(x, self.rows.clock.max)];
                self.painter.extend(Shape::dashed_line(&ends, Stroke::new(1.0, self.line_colour()), 3.0, 3.0));
                self.painter.vline(x, self.rows.clock.max..=self.rows.bottom, faint);
            }
            self.painter.galley(at, galley.clone(), self.theme.palette.text.into());
        }
    }

    /// Draws the clock line, which idles high.
    fn clock(&self, from: f32) {
        let row = self.rows.clock;
        let mut points = vec![pos2(from, row.min)];
        let mut high = true;
        for edge in self.model.diagram.clock_edges() {
            let x = self.x(edge);
            points.push(pos2(x, if high { row.min } else { row.max }));
            high = !high;
            points.push(pos2(x, if high { row.min } else { row.max }));
        }
        points.push(pos2(self.x(self.model.diagram.end_time()), if high { row.min } else { row.max }));
        self.painter.add(Shape::line(points, Stroke::new(1.5, self.theme.palette.text)));
    }

    /// Draws the data line. It is high, carries the bits, stays low for tm, returns high, and carries the first bits of
    /// the next burst.
    fn data(&self, from: f32) {
        let diagram = self.model.diagram;
        let (row, stroke) = (self.rows.data, Stroke::new(1.5, self.theme.palette.text));
        let bits = diagram.bits();
        if let Some(first) = bits.first() {
            self.painter.hline(from..=self.x(first.from), row.min, stroke);
        }
        let shown: Vec<CellState> =
            self.model.frame.map(|frame| diagram.strip().cell_states(frame)).unwrap_or_default();
        for (number, bit) in bits.iter().enumerate() {
            let cell = diagram.strip().cells().get(number);
            let field = cell.and_then(|cell| diagram.strip().fields().get(cell.field));
            let ink = field.map_or_else(|| self.line_colour(), |field| field_ink(self.theme, field.kind));
            self.bit((self.x(bit.from), self.x(bit.to)), ink, shown.get(number).map(|cell| cell.bit));
        }
        let (low, least, most) = diagram.low_level_times();
        let next = self.x(diagram.next());
        let (low, least, most) = (self.x(low), self.x(least), self.x(most));
        self.painter.add(Shape::line(
            vec![pos2(low, row.max), pos2(least, row.max), pos2(most, row.min), pos2(next.max(most), row.min)],
            stroke,
        ));
        let end = self.x(diagram.end_time());
        if next < end {
            self.bit((next, end), self.line_colour(), None);
        }
    }

    fn bit(&self, (from, to): (f32, f32), ink: Color32, bit: Option<bool>) {
        let row = self.rows.data;
        let strength = if bit == Some(true) { 0.45 } else { 0.16 };
        if to - from < 3.0 {
            self.painter.rect_filled(Rect::from_x_y_ranges(from..=to, row), 0.0, ink.gamma_multiply(strength + 0.2));
            return;
        }
        let slant = ((to - from) / 4.0).min(2.5);
        let middle = row.center();
        let points = vec![
            pos2(from, middle),
            pos2(from + slant, row.min),
            pos2(to - slant, row.min),
            pos2(to, middle),
            pos2(to - slant, row.max),
            pos2(from + slant, row.max),
        ];
        self.painter.add(Shape::convex_polygon(points, ink.gamma_multiply(strength), Stroke::new(1.0, ink)));
        if let Some(bit) = bit.filter(|_| to - from >= MIN_DIGIT_WIDTH) {
            let font = FontId::monospace(self.theme.sizes.caption);
            let at = pos2(f32::midpoint(from, to), middle);
            let digit = if bit { "1" } else { "0" };
            self.painter.text(at, egui::Align2::CENTER_CENTER, digit, font, self.theme.palette.text.into());
        }
    }

    fn paint_names(&self) {
        let diagram = self.model.diagram;
        for field in diagram.strip().fields() {
            let (from, to) = diagram.field(field);
            let (from, to) = (self.x(from), self.x(to));
            let words =
                [self.theme.format_text(&short_label(diagram.strip(), field)), field_name(diagram.strip(), field)];
            let font = FontId::proportional(self.theme.sizes.caption);
            let ink = self.theme.palette.muted;
            let galley = |words: String| self.painter.layout_no_wrap(words, font.clone(), ink.into());
            if let Some(galley) = words.into_iter().map(galley).find(|own| own.size().x <= to - from) {
                let at = pos2(f32::midpoint(from, to) - galley.size().x / 2.0, self.rows.names);
                self.painter.galley(at, galley, ink.into());
            }
            let y = self.rows.names - 1.0;
            self.painter.hline(from + 0.5..=to - 0.5, y, Stroke::new(2.0, field_ink(self.theme, field.kind)));
        }
    }

    fn paint_breaks(&self, breaks: &[Rangef]) {
        for gap in breaks {
            let middle = self.left + gap.center();
            let (top, bottom) = (self.rows.clock.min - 4.0, self.rows.data.max + 4.0);
            let slant = 3.0;
            let points = vec![
                pos2(middle - 4.0 + slant, top),
                pos2(middle + 4.0 + slant, top),
                pos2(middle + 4.0 - slant, bottom),
                pos2(middle - 4.0 - slant, bottom),
            ];
            self.painter.add(Shape::convex_polygon(points, Color32::from(self.theme.palette.sunken), Stroke::NONE));
            for side in [-4.0, 4.0] {
                let ends = [pos2(middle + side + slant, top), pos2(middle + side - slant, bottom)];
                self.painter.line_segment(ends, Stroke::new(1.0, self.line_colour()));
            }
        }
    }

    /// Draws each time as a bar with end marks. The bar is dashed between its minimum and its maximum end.
    fn paint_bars(&self, words: &[Arc<Galley>], put: &[LabelPlacement]) {
        let palette = self.theme.palette;
        for ((span, galley), put) in self.model.diagram.spans().iter().zip(words).zip(put) {
            let y = self.rows.lanes + (put.level as f32 + 0.5) * LANE_HEIGHT;
            let (from, least, to) = (self.x(span.from), self.x(span.least), self.x(span.to));
            let stroke = Stroke::new(1.5, self.line_colour());
            self.painter.hline(from..=least, y, stroke);
            self.painter.extend(Shape::dashed_line(&[pos2(least, y), pos2(to, y)], stroke, 3.0, 2.0));
            for x in [from, least, to] {
                self.painter.vline(x, y - 4.0..=y + 4.0, stroke);
            }
            let size = galley.size();
            let at = pos2(self.left + put.left, y - size.y / 2.0);
            let behind = Rect::from_min_size(at, size).expand2(Vec2::new(4.0, 0.0));
            self.painter.rect_filled(behind, 0.0, palette.sunken);
            self.painter.galley(at, galley.clone(), palette.text.into());
        }
    }
}
