//! A plot of sine against cosine with a ring that marks the allowed amplitude.
//!
//! * **Size**: a square of the given width.
//! * **Keyboard**: none. Tab skips the figure.
//! * **Pointer**: shows the voltages, the length and the angle of the vector under the pointer.
//! * **Accessible**: an image with the given label and value.
//! * **Painting**: samples as a density that is brighter where there are more of them, the fitted ellipse as a line,
//!   the good range as a ring between two lines, and the fault limits as dashed lines. Zero is in the middle, and both
//!   axes have the same scale.

use egui::accesskit::Role;
use egui::epaint::{Mesh, PathStroke};
use egui::{
    Align2, Color32, ColorImage, FontId, Painter, Pos2, Rect, Sense, Shape, Stroke, TextureId, Ui, Vec2, WidgetInfo,
};

use crate::analysis::lissajous::{PlotSquare, SampleDensity};
use crate::app::Text;
use crate::ui::Theme;
use crate::ui::widgets::series_colour;

#[derive(Clone, Debug, Default)]
pub struct Lissajous<'a> {
    pub figures: &'a [LissajousFigure],
    /// Amplitude range of a good signal, in volts.
    pub ok_v: (f64, f64),
    /// Amplitude range in volts outside which the signal is faulty.
    pub fault_v: (f64, f64),
    pub label: &'a str,
    pub value: &'a str,
}

#[derive(Clone, Debug, Default)]
pub struct LissajousFigure {
    /// Texture of the samples, and the square that it covers.
    pub picture: Option<(TextureId, PlotSquare)>,
    /// Fitted closed curve as (cosine, sine) points, in volts.
    pub curve: Vec<(f64, f64)>,
    /// Colour index of the series.
    pub colour: usize,
    pub dashed: bool,
}

const CIRCLE: usize = 120;
/// Label steps of an axis in volts. The axis uses the finest step at which the labels fit.
const STEPS: [f64; 9] = [0.01, 0.05, 0.1, 0.25, 0.5, 1.0, 2.0, 5.0, 10.0];

/// The square in which the figure is drawn, and the voltage at its edge.
#[derive(Clone, Copy)]
struct PlotArea {
    rect: Rect,
    range_v: f64,
}

impl PlotArea {
    fn screen_position(&self, (x, y): (f64, f64)) -> Pos2 {
        let scale = |volts: f64| (volts / self.range_v).clamp(-4.0, 4.0) as f32 * self.rect.width() / 2.0;
        self.rect.center() + Vec2::new(scale(x), -scale(y))
    }

    fn volts(&self, pos: Pos2) -> (f64, f64) {
        let off = (pos - self.rect.center()) / (self.rect.width() / 2.0).max(1.0);
        (f64::from(off.x) * self.range_v, f64::from(-off.y) * self.range_v)
    }

    fn circle_points(&self, radius_v: f64) -> Vec<Pos2> {
        let angle = |at: usize| at as f64 / CIRCLE as f64 * std::f64::consts::TAU;
        (0..=CIRCLE).map(|at| self.screen_position((radius_v * angle(at).cos(), radius_v * angle(at).sin()))).collect()
    }
}

pub fn lissajous(ui: &mut Ui, theme: &Theme, figure: &Lissajous<'_>, side: f32) {
    let (rect, response) = ui.allocate_exact_size(Vec2::splat(side.max(40.0)), Sense::hover());
    response.widget_info(|| {
        let mut info = WidgetInfo::labeled(Role::Image, true, figure.label);
        info.current_text_value = Some(figure.value.to_owned());
        info
    });
    if !ui.is_rect_visible(rect) {
        return;
    }
    let painter = ui.painter().with_clip_rect(rect.intersect(ui.clip_rect()));
    painter.rect_filled(rect, theme.radius, theme.palette.sunken);
    let place = PlotArea { rect, range_v: voltage_range(figure) };
    paint_grid(&painter, theme, &place);
    paint_rings(&painter, theme, &place, figure);
    paint_labels(&painter, theme, &place);
    for own in figure.figures {
        paint_samples(&painter, &place, own);
    }
    for own in figure.figures {
        paint_curve(&painter, &place, own, series_colour(theme, own.colour));
    }
    if let Some(pos) = response.hover_pos() {
        paint_readout(&painter, theme, &place, pos);
    }
}

/// Returns a density of samples as an image of one colour. Denser areas are brighter, and even a single sample is
/// visible.
pub fn density_image(density: &SampleDensity, colour: Color32) -> ColorImage {
    /// Brightness of a single sample, as a fraction of full brightness.
    const MIN_BRIGHTNESS: f32 = 0.4;
    let side = density.cells_per_side();
    let scale = f64::from(density.max_count()).ln_1p().max(f64::MIN_POSITIVE);
    let brightness = |count: u32| match count {
        0 => 0.0,
        count => MIN_BRIGHTNESS + (1.0 - MIN_BRIGHTNESS) * (f64::from(count).ln_1p() / scale) as f32,
    };
    // Pictures start at the top, densities at the bottom.
    let rows = density.cell_counts().chunks(side).rev();
    let pixels = rows.flatten().map(|count| colour.gamma_multiply(brightness(*count))).collect();
    ColorImage::new([side, side], pixels)
}

/// Returns the voltage at the edge of the square. It is large enough for all samples and curves, and for the ring.
fn voltage_range(figure: &Lissajous<'_>) -> f64 {
    let curves = figure.figures.iter().flat_map(|own| &own.curve).map(|(x, y)| x.abs().max(y.abs()));
    let pictures = figure.figures.iter().filter_map(|own| Some(own.picture?.1.half_v));
    let curves = curves.filter(|volts| volts.is_finite()).map(|volts| volts * 1.05);
    curves.chain(pictures).fold(figure.ok_v.1 * 1.12, f64::max)
}

fn scale_step(place: &PlotArea) -> f64 {
    STEPS.into_iter().find(|step| place.range_v / step < 3.0).unwrap_or(place.range_v / 2.0)
}

fn scale_marks(place: &PlotArea) -> impl Iterator<Item = (i32, f64)> {
    let step = scale_step(place);
    let count = (place.range_v / step).floor().min(4.0) as i32;
    (-count..=count).map(move |number| (number, f64::from(number) * step))
}

fn paint_grid(painter: &Painter, theme: &Theme, place: &PlotArea) {
    let line = Stroke::new(1.0, theme.palette.line);
    for (_, volts) in scale_marks(place) {
        painter.vline(place.screen_position((volts, 0.0)).x, place.rect.y_range(), line);
        painter.hline(place.rect.x_range(), place.screen_position((0.0, volts)).y, line);
    }
}

fn paint_labels(painter: &Painter, theme: &Theme, place: &PlotArea) {
    let step = scale_step(place);
    let font = FontId::proportional(theme.sizes.caption);
    let muted = Color32::from(theme.palette.muted);
    let (rect, inside) = (place.rect, theme.space.inside);
    let text = |pos: Pos2, align: Align2, words: String| {
        let galley = painter.layout_no_wrap(words, font.clone(), muted);
        let own = align.anchor_size(pos, galley.size());
        painter.rect_filled(own.expand(1.0), 2.0, Color32::from(theme.palette.sunken).gamma_multiply(0.85));
        painter.galley(own.min, galley, muted);
    };
    for (_, volts) in scale_marks(place).filter(|(number, _)| *number != 0) {
        let (x, y) = (place.screen_position((volts, 0.0)).x, place.screen_position((0.0, volts)).y);
        let decimals = if step < 0.1 { 2 } else { usize::from(step < 1.0) + usize::from(step == 0.25) };
        let words = theme.format_number(volts, decimals);
        text(Pos2::new(x + 2.0, rect.bottom() - inside), Align2::LEFT_BOTTOM, words.clone());
        text(Pos2::new(rect.left() + inside, y - 2.0), Align2::LEFT_BOTTOM, words);
    }
    let sine = format!("{} / V", theme.translate("signals.sine"));
    let cosine = format!("{} / V", theme.translate("signals.cosine"));
    // Each label is at the end of its axis.
    let (top, right) = (Pos2::new(rect.center().x + inside, rect.top() + inside), rect.right_center());
    text(top, Align2::LEFT_TOP, sine);
    text(right - Vec2::splat(inside), Align2::RIGHT_BOTTOM, cosine);
}

fn paint_rings(painter: &Painter, theme: &Theme, place: &PlotArea, figure: &Lissajous<'_>) {
    let good = Color32::from(theme.palette.good);
    let (inner, outer) = (place.circle_points(figure.ok_v.0), place.circle_points(figure.ok_v.1));
    let mut band = Mesh::default();
    for (at, (inner, outer)) in (0_u32..).zip(inner.iter().zip(&outer)) {
        band.colored_vertex(*inner, good.gamma_multiply(0.10));
        band.colored_vertex(*outer, good.gamma_multiply(0.10));
        if at > 0 {
            band.add_triangle(2 * at - 2, 2 * at - 1, 2 * at);
            band.add_triangle(2 * at - 1, 2 * at, 2 * at + 1);
        }
    }
    painter.add(Shape::mesh(band));
    for ring in [inner, outer] {
        painter.add(Shape::line(ring, PathStroke::new(1.0, good.gamma_multiply(0.7))));
    }
    let bad = Stroke::new(1.0, Color32::from(theme.palette.bad).gamma_multiply(0.8));
    for radius in [figure.fault_v.0, figure.fault_v.1] {
        painter.extend(Shape::dashed_line(&place.circle_points(radius), bad, 4.0, 4.0));
    }
}

fn paint_samples(painter: &Painter, place: &PlotArea, figure: &LissajousFigure) {
    let Some((texture, square)) = figure.picture else { return };
    let PlotSquare { cosine_v, sine_v, half_v } = square;
    let corners = [(cosine_v - half_v, sine_v + half_v), (cosine_v + half_v, sine_v - half_v)];
    let rect = Rect::from_two_pos(place.screen_position(corners[0]), place.screen_position(corners[1]));
    let whole = Rect::from_min_max(Pos2::ZERO, Pos2::new(1.0, 1.0));
    painter.image(texture, rect, whole, Color32::WHITE);
}

fn paint_curve(painter: &Painter, place: &PlotArea, figure: &LissajousFigure, colour: Color32) {
    let points: Vec<Pos2> = figure.curve.iter().map(|point| place.screen_position(*point)).collect();
    if figure.dashed {
        painter.extend(Shape::dashed_line(&points, Stroke::new(1.5, colour), 7.0, 4.0));
    } else {
        painter.add(Shape::line(points, PathStroke::new(1.5, colour)));
    }
}

/// Draws the values under the pointer: both voltages, and the length and angle of the vector.
fn paint_readout(painter: &Painter, theme: &Theme, place: &PlotArea, pos: Pos2) {
    let (x, y) = place.volts(pos);
    let muted = Stroke::new(1.0, Color32::from(theme.palette.muted).gamma_multiply(0.6));
    painter.line_segment([place.rect.center(), pos], muted);
    let text = Text::new("signals.lissajous_place")
        .with_number("sine", y, 3)
        .with_number("cosine", x, 3)
        .with_number("length", x.hypot(y), 3)
        .with_number("angle", y.atan2(x).to_degrees().rem_euclid(360.0), 1);
    let font = FontId::monospace(theme.sizes.caption);
    let words = painter.layout(theme.format_text(&text), font, theme.palette.text.into(), f32::INFINITY);
    let inside = theme.space.inside;
    let at = Pos2::new(place.rect.right() - words.size().x - inside, place.rect.top() + inside);
    painter.rect_filled(Rect::from_min_size(at, words.size()).expand(2.0), 2.0, theme.palette.raised);
    painter.galley(at, words, theme.palette.text.into());
}
