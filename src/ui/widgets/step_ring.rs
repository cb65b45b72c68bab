//! A sine period as a ring of 32 steps, with the absolute and the analogue position.
//!
//! * **Size**: a square of the given width.
//! * **Keyboard**: none. Tab skips the ring.
//! * **Pointer**: none.
//! * **Accessible**: an image with the given label and value.
//! * **Painting**: one segment per step, clockwise from zero at the top, with the segment of the absolute position
//!   filled. The analogue position is a hand, and an arc in the given colour shows its distance from the absolute
//!   position.

use egui::accesskit::Role;
use egui::epaint::PathStroke;
use egui::{Align2, Color32, FontId, Painter, Pos2, Sense, Shape, Stroke, Ui, Vec2, WidgetInfo};

use crate::ui::Theme;
use crate::ui::widgets::series_colour;

#[derive(Clone, Copy, Debug)]
pub struct StepRing<'a> {
    /// Step that contains the absolute position, 0 to 31.
    pub step: u64,
    /// Analogue position in periods, 0 to 1.
    pub phase: f64,
    /// Offset of the analogue position from the absolute one in periods, or `None` if its direction is ambiguous.
    pub apart: Option<f64>,
    pub colour: Color32,
    pub label: &'a str,
    pub value: &'a str,
}

const STEPS: u8 = 32;
/// Width of the ring, as a fraction of the radius.
const RING_WIDTH: f32 = 0.14;
/// Gap at each end of a segment, as a fraction of a step.
const GAP: f64 = 0.08;

/// A circle with its centre and radius.
#[derive(Clone, Copy)]
struct Dial {
    middle: Pos2,
    radius: f32,
}

impl Dial {
    fn point_at(self, periods: f64, radius: f32) -> Pos2 {
        let angle = (periods * std::f64::consts::TAU) as f32;
        self.middle + Vec2::new(angle.sin(), -angle.cos()) * radius * self.radius
    }

    fn arc_points(self, from: f64, to: f64, radius: f32) -> Vec<Pos2> {
        let points = (((to - from).abs() * 96.0).ceil() as usize).clamp(2, 128);
        let place = |at: usize| from + (to - from) * at as f64 / points as f64;
        (0..=points).map(|at| self.point_at(place(at), radius)).collect()
    }
}

pub fn step_ring(ui: &mut Ui, theme: &Theme, ring: &StepRing<'_>, side: f32) {
    let side = side.max(80.0);
    let (rect, response) = ui.allocate_exact_size(Vec2::splat(side), Sense::hover());
    response.widget_info(|| {
        let mut info = WidgetInfo::labeled(Role::Image, true, ring.label);
        info.current_text_value = Some(ring.value.to_owned());
        info
    });
    if !ui.is_rect_visible(rect) {
        return;
    }
    let dial = Dial { middle: rect.center(), radius: side / 2.0 - theme.space.groups };
    let painter = ui.painter();
    paint_segments(painter, theme, dial, ring.step);
    paint_quarters(painter, theme, dial);
    if let Some(apart) = ring.apart {
        let arc = dial.arc_points(ring.phase, ring.phase + apart, 1.0 - 1.7 * RING_WIDTH);
        painter.add(Shape::line(arc, PathStroke::new(3.0, ring.colour)));
    }
    let hand = Stroke::new(2.0, series_colour(theme, 1));
    painter.line_segment([dial.point_at(ring.phase, 0.18), dial.point_at(ring.phase, 1.0 - RING_WIDTH)], hand);
    painter.circle_filled(dial.point_at(ring.phase, 1.0 - RING_WIDTH), 3.5, hand.color);
}

fn paint_segments(painter: &Painter, theme: &Theme, dial: Dial, own: u64) {
    let width = RING_WIDTH * dial.radius;
    for step in 0..STEPS {
        let (from, to) = (f64::from(step) + GAP, f64::from(step) + 1.0 - GAP);
        let arc = dial.arc_points(from / f64::from(STEPS), to / f64::from(STEPS), 1.0 - RING_WIDTH / 2.0);
        let colour = if u64::from(step) == own { series_colour(theme, 0) } else { theme.palette.line.into() };
        painter.add(Shape::line(arc, PathStroke::new(width, colour)));
    }
}

/// Draws the number of every eighth step.
fn paint_quarters(painter: &Painter, theme: &Theme, dial: Dial) {
    let font = FontId::monospace(theme.sizes.caption);
    for (step, align) in
        [(0, Align2::CENTER_BOTTOM), (8, Align2::LEFT_CENTER), (16, Align2::CENTER_TOP), (24, Align2::RIGHT_CENTER)]
    {
        let place = dial.point_at(f64::from(step) / f64::from(STEPS), 1.02);
        painter.text(place, align, step.to_string(), font.clone(), theme.palette.muted.into());
    }
}
