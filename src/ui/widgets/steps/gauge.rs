//! A gauge that shows a value on a scale with the allowed range.

use egui::accesskit::Role;
use egui::{Color32, FontId, Rect, RichText, Sense, Shape, Stroke, Ui, Vec2, WidgetInfo, pos2};

use super::Gauge;
use crate::ui::{Theme, icons};

/// Minimum width of the scale of a gauge, in points.
const MIN_SCALE_WIDTH: f32 = 96.0;
const ICON_WIDTH: f32 = 16.0;
const NAME_WIDTH: f32 = 112.0;
const VALUE_WIDTH: f32 = 96.0;
const ROW_HEIGHT: f32 = 20.0;

/// Draws each gauge on one line: name, value, scale and limits. Limits that do not fit are drawn below.
pub(super) fn gauges_ui(ui: &mut Ui, theme: &Theme, gauges: &[Gauge]) {
    let width = |gauge: &Gauge| {
        let font = FontId::proportional(theme.sizes.caption);
        ui.painter().layout_no_wrap(gauge.limits.clone(), font, theme.palette.muted.into()).size().x
    };
    // All scales have the same length.
    let limits = gauges.iter().map(width).fold(0.0, f32::max);
    let room = ui.available_width() - ICON_WIDTH - NAME_WIDTH - VALUE_WIDTH - theme.space.between * 3.0;
    let beside = room - limits - theme.space.between;
    let (scale, below) = if beside >= MIN_SCALE_WIDTH { (beside, false) } else { (room, true) };
    ui.scope(|ui| {
        // Displayed values are closer together than controls.
        ui.spacing_mut().interact_size.y = ROW_HEIGHT;
        for gauge in gauges {
            gauge_ui(ui, theme, gauge, scale.clamp(MIN_SCALE_WIDTH / 2.0, MIN_SCALE_WIDTH * 3.0), below);
        }
    });
}

fn gauge_ui(ui: &mut Ui, theme: &Theme, gauge: &Gauge, width: f32, limits_below: bool) {
    let palette = theme.palette;
    let (icon, ink) = match (gauge.is_in_range(), gauge.value) {
        (true, _) if !gauge.is_in_best_range() => (icons::INFO, palette.text),
        (true, _) => (icons::CHECK_CIRCLE, palette.good),
        (false, Some(_)) => (icons::WARNING, palette.warn),
        (false, None) => (icons::QUESTION, palette.muted),
    };
    ui.horizontal(|ui| {
        column_ui(ui, ICON_WIDTH, RichText::new(icon).color(ink));
        column_ui(ui, NAME_WIDTH, theme.label(&gauge.name));
        column_ui(ui, VALUE_WIDTH, theme.monospace(&gauge.shown).color(ink));
        scale_ui(ui, theme, gauge, width, ink.into());
        if !limits_below {
            ui.label(theme.caption(&gauge.limits));
        }
    });
    if limits_below {
        ui.horizontal(|ui| {
            ui.add_space(ICON_WIDTH + theme.space.between);
            ui.label(theme.caption(&gauge.limits));
        });
    }
}

fn column_ui(ui: &mut Ui, width: f32, words: RichText) {
    ui.allocate_ui_with_layout(Vec2::new(width, ROW_HEIGHT), egui::Layout::left_to_right(egui::Align::Center), |ui| {
        ui.set_min_width(width);
        ui.add(egui::Label::new(words).truncate());
    });
}

/// Draws the allowed range with a pointer at the value, or an arrow at the end of the scale if the value is beyond it.
fn scale_ui(ui: &mut Ui, theme: &Theme, gauge: &Gauge, width: f32, ink: Color32) {
    let (rect, response) = ui.allocate_exact_size(Vec2::new(width, ROW_HEIGHT), Sense::hover());
    response.widget_info(|| {
        let mut info = WidgetInfo::labeled(Role::Meter, true, &gauge.name);
        info.current_text_value = Some(format!("{} ({})", gauge.shown, gauge.limits));
        info
    });
    let (low, high) = (*gauge.scale.start(), *gauge.scale.end());
    let span = high - low;
    if !(span.is_finite() && span > 0.0) {
        return;
    }
    let share = |value: f64| ((value - low) / span) as f32;
    let x = |share: f32| rect.left() + rect.width() * share.clamp(0.0, 1.0);
    let painter = ui.painter();
    let track = Rect::from_center_size(rect.center(), Vec2::new(rect.width(), 6.0));
    painter.rect_filled(track, 3.0, theme.palette.sunken);
    painter.rect_stroke(track, 3.0, Stroke::new(1.0, theme.palette.line), egui::StrokeKind::Inside);
    let band = |range: &std::ops::RangeInclusive<f64>, strength: f32| {
        // Widen a narrow band to keep it visible.
        let (from, to) = (x(share(*range.start())), x(share(*range.end())));
        let half = ((to - from) / 2.0).max(1.5);
        let middle = (from + to) / 2.0;
        let place = Rect::from_min_max(pos2(middle - half, track.top()), pos2(middle + half, track.bottom()));
        painter.rect_filled(place, 2.0, Color32::from(theme.palette.good).gamma_multiply(strength));
    };
    match &gauge.best {
        Some(best) => {
            band(&gauge.allowed, 0.3);
            band(best, 1.0);
        }
        None => band(&gauge.allowed, 0.6),
    }
    let Some(value) = gauge.value.filter(|value| !value.is_nan()) else { return };
    let place = share(value);
    if (0.0..=1.0).contains(&place) {
        painter.vline(x(place), rect.top() + 2.0..=rect.bottom() - 2.0, Stroke::new(2.0, ink));
        return;
    }
    let (tip, side) = if place < 0.0 { (rect.left(), 1.0) } else { (rect.right(), -1.0) };
    let middle = rect.center().y;
    let points = vec![pos2(tip, middle), pos2(tip + side * 7.0, middle - 5.0), pos2(tip + side * 7.0, middle + 5.0)];
    painter.add(Shape::convex_polygon(points, ink, Stroke::NONE));
}
