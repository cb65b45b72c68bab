//! Bar that shows the travel of a drive: limits, position and target.
//!
//! * **Size**: the available width and a constant height, so that nothing below moves when the drive leaves its limits.
//! * **Keyboard, pointer**: none. The bar cannot be used to move the drive.
//! * **Accessible**: an image whose value names position, limits and target.
//! * **Painting**: the range in the accent colour, the position as a bar across it, the target as an outlined diamond.
//!   If the drive is outside its limits, the position is red, an arrow points back to the limit, and the text above
//!   describes the way back.

use egui::accesskit::Role;
use egui::{
    Align2, Color32, FontId, Painter, Pos2, Rect, Sense, Shape, Stroke, StrokeKind, Ui, WidgetInfo, pos2, vec2,
};

use crate::app::Text;
use crate::devices::hiperdrive::procedures::dead_man::{LimitSide, LimitViolation};
use crate::devices::hiperdrive::protocol::State;
use crate::devices::hiperdrive::state::{HiperdriveDevice, TEXTS, forms};
use crate::devices::hiperdrive::views::translate;
use crate::ui::widgets::series_colour;
use crate::ui::{Theme, icons};

/// Height of the text above the bar, in points.
const LINE_HEIGHT: f32 = 20.0;
const BAR_HEIGHT: f32 = 14.0;
const LIMITS_HEIGHT: f32 = 16.0;
const GAP_HEIGHT: f32 = 6.0;
/// Margin at each end of the bar, so that a marker fits.
const END_MARGIN: f32 = 8.0;
/// Half the width of the diamond that marks the target.
const DIAMOND_RADIUS: f32 = 6.0;
/// Fraction of the bar that is added beyond a limit if the position is outside it.
const OVERSHOOT_FRACTION: f64 = 0.04;

/// Mapping from steps to pixels of the bar.
struct Scale {
    from: f64,
    to: f64,
    left: f32,
    right: f32,
}

impl Scale {
    /// Creates a scale that shows both limits and the position. A position outside the limits gets some margin.
    fn new((low, high): (i32, i32), position: Option<i32>, bar: Rect) -> Self {
        let (low, high) = (f64::from(low), f64::from(high));
        let position = position.map_or(low, f64::from);
        let (mut from, mut to) = (low.min(position), high.max(position));
        let room = (to - from) * OVERSHOOT_FRACTION;
        if from < low {
            from -= room;
        }
        if to > high {
            to += room;
        }
        Scale { from, to: to.max(from + 1.0), left: bar.left() + END_MARGIN, right: bar.right() - END_MARGIN }
    }

    fn x(&self, steps: i32) -> f32 {
        let share = ((f64::from(steps) - self.from) / (self.to - self.from)).clamp(0.0, 1.0);
        self.left + (self.right - self.left) * share as f32
    }
}

struct BarValues {
    limits: Option<(i32, i32)>,
    position: Option<i32>,
    target: Option<i32>,
    /// Limit that the drive has passed, or `None` if it is inside or at the end of its range.
    outside: Option<LimitViolation>,
    is_moving: bool,
}

/// Draws the travel of the displayed drive. `typed` is the target entered for the next move.
pub(super) fn travel_ui(ui: &mut Ui, theme: &Theme, unit: &HiperdriveDevice, typed: &str) {
    let drive = unit.drive();
    let typed = || forms::target(unit, typed, unit.measure).ok();
    let shown = BarValues {
        limits: unit.limits(drive),
        position: unit.actual_values(drive).map(|actual| actual.position),
        target: unit.moves.target(drive).or_else(typed),
        outside: unit.out_of_range_position(drive).filter(|own| own.is_far).map(|own| own.outside),
        is_moving: unit.state(drive) == Some(State::Moving),
    };
    let size = vec2(ui.available_width().max(120.0), LINE_HEIGHT + GAP_HEIGHT + BAR_HEIGHT + LIMITS_HEIGHT);
    let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
    let place = |steps: Option<i32>| {
        steps.map_or_else(|| "–".to_owned(), |steps| theme.format_text(&unit.position_text(drive, steps)))
    };
    let named = |id: &'static str, steps| theme.format_text(&TEXTS.text(id).with("place", place(steps)));
    let position = named("hd_travel.position", shown.position);
    let target = named("hd_travel.target", shown.target);
    let warning = shown.outside.map(|own| theme.format_text(&return_instructions(own)));
    let limits = shown.limits.map(|(low, high)| [place(Some(low)), place(Some(high))]);
    response.widget_info(|| {
        let mut info = WidgetInfo::labeled(Role::Image, true, translate(theme, "hd_travel.title"));
        let limits = limits.as_ref().map(|own| own.join(" … "));
        let told = [warning.clone(), Some(position.clone()), limits, Some(target.clone())];
        info.current_text_value = Some(told.into_iter().flatten().collect::<Vec<_>>().join(", "));
        info
    });
    if !ui.is_rect_visible(rect) {
        return;
    }
    let painter = ui.painter();
    let line = Rect::from_min_size(rect.min, vec2(rect.width(), LINE_HEIGHT));
    line_ui(painter, theme, line, &shown, (&position, &target, warning.as_deref()));
    let bar = Rect::from_min_size(pos2(rect.left(), line.bottom() + GAP_HEIGHT), vec2(rect.width(), BAR_HEIGHT));
    let below = Rect::from_min_size(bar.left_bottom(), vec2(rect.width(), LIMITS_HEIGHT));
    bar_ui(painter, theme, bar, &shown);
    match shown.limits.zip(limits) {
        Some(((low, high), names)) => {
            let scale = Scale::new((low, high), shown.position, bar);
            limits_ui(painter, theme, below, [scale.x(low), scale.x(high)], names);
        }
        None => {
            let (words, font) = (translate(theme, "hd_travel.unknown"), FontId::proportional(theme.sizes.caption));
            painter.text(below.left_bottom(), Align2::LEFT_BOTTOM, words, font, theme.palette.muted.into());
        }
    }
}

/// Explains how to return a drive inside its limits.
fn return_instructions(outside: LimitViolation) -> Text {
    TEXTS.text(match outside {
        LimitViolation::At(LimitSide::Above) => "hd_travel.back_down",
        LimitViolation::At(LimitSide::Below) => "hd_travel.back_up",
        LimitViolation::Unclear => "hd_travel.unclear",
    })
}

/// Draws position and target above the bar, or else how to get back inside the limits.
fn line_ui(
    painter: &Painter,
    theme: &Theme,
    line: Rect,
    shown: &BarValues,
    (position, target, warning): (&str, &str, Option<&str>),
) {
    let palette = theme.palette;
    let font = FontId::monospace(theme.sizes.body);
    let ink = position_colour(theme, shown);
    let Some(warning) = warning else {
        let at = paint_marker(painter, line.left_center() + vec2(3.0, 0.0), ink);
        painter.text(at, Align2::LEFT_CENTER, position, font.clone(), palette.text.into());
        let ink = if shown.target.is_some() { palette.text } else { palette.muted };
        let words = painter.text(line.right_center(), Align2::RIGHT_CENTER, target, font, ink.into());
        paint_diamond(painter, pos2(words.left() - DIAMOND_RADIUS - 6.0, line.center().y), target_colour(theme));
        return;
    };
    let words = format!("{}  {warning}", icons::WARNING);
    let strong = theme.bold_font(theme.sizes.section);
    let whole = painter.layout_no_wrap(words.clone(), strong, ink);
    let room = line.width() - painter.layout_no_wrap(position.to_owned(), font.clone(), ink).size().x - 16.0;
    // In a narrow window, a long text is drawn in a smaller size so that it is not cut.
    let galley = if whole.size().x <= room {
        whole
    } else {
        painter.layout_no_wrap(words, theme.bold_font(theme.sizes.caption), ink)
    };
    painter.galley(Align2::LEFT_CENTER.anchor_size(line.left_center(), galley.size()).min, galley, ink);
    painter.text(line.right_center(), Align2::RIGHT_CENTER, position, font, ink);
}

fn bar_ui(painter: &Painter, theme: &Theme, bar: Rect, shown: &BarValues) {
    let palette = theme.palette;
    let edge = if shown.outside.is_some() { palette.bad } else { palette.line };
    painter.rect_filled(bar, theme.radius, palette.sunken);
    if let Some((low, high)) = shown.limits {
        let scale = Scale::new((low, high), shown.position, bar);
        let range = Rect::from_x_y_ranges(scale.x(low)..=scale.x(high), bar.y_range());
        let inside = Color32::from(palette.accent).gamma_multiply(0.25);
        painter.rect_filled(range, 2.0, inside);
        for limit in [range.left(), range.right()] {
            painter.vline(limit, bar.y_range(), Stroke::new(2.0, palette.accent));
        }
        if let (Some(position), Some(LimitViolation::At(side))) = (shown.position, shown.outside) {
            let limit = if side == LimitSide::Above { range.right() } else { range.left() };
            paint_arrow(painter, pos2(scale.x(position), bar.center().y), limit, palette.bad.into());
        }
        if let Some(target) = shown.target {
            paint_diamond(painter, pos2(scale.x(target), bar.center().y), target_colour(theme));
        }
        if let Some(position) = shown.position {
            let at = Rect::from_center_size(pos2(scale.x(position), bar.center().y), vec2(4.0, BAR_HEIGHT + 8.0));
            painter.rect_filled(at, 2.0, position_colour(theme, shown));
        }
    }
    painter.rect_stroke(bar, theme.radius, Stroke::new(1.0, edge), StrokeKind::Inside);
}

fn limits_ui(painter: &Painter, theme: &Theme, below: Rect, [low, high]: [f32; 2], names: [String; 2]) {
    let ink = Color32::from(theme.palette.muted);
    let galley = |name| painter.layout_no_wrap(name, FontId::monospace(theme.sizes.caption), ink);
    let [first, last] = names.map(galley);
    let between = 12.0;
    let end = below.right() - last.size().x;
    let left = (low - first.size().x / 2.0).clamp(below.left(), (end - between - first.size().x).max(below.left()));
    let right = (high - last.size().x / 2.0).clamp((left + first.size().x + between).min(end), end);
    for (x, own) in [(left, first), (right, last)] {
        painter.galley(pos2(x, below.bottom() - own.size().y), own, ink);
    }
}

fn position_colour(theme: &Theme, shown: &BarValues) -> Color32 {
    match shown {
        BarValues { outside: Some(_), .. } => theme.palette.bad.into(),
        BarValues { is_moving: true, .. } => theme.palette.good.into(),
        _ => theme.palette.text.into(),
    }
}

fn target_colour(theme: &Theme) -> Color32 {
    series_colour(theme, 0)
}

/// Draws the position marker in the legend, and returns where its label begins.
fn paint_marker(painter: &Painter, at: Pos2, ink: Color32) -> Pos2 {
    painter.rect_filled(Rect::from_center_size(at, vec2(4.0, BAR_HEIGHT)), 2.0, ink);
    at + vec2(9.0, 0.0)
}

fn paint_diamond(painter: &Painter, at: Pos2, ink: Color32) {
    let corners =
        [vec2(0.0, -DIAMOND_RADIUS), vec2(DIAMOND_RADIUS, 0.0), vec2(0.0, DIAMOND_RADIUS), vec2(-DIAMOND_RADIUS, 0.0)];
    painter.add(Shape::closed_line(corners.map(|corner| at + corner).to_vec(), Stroke::new(2.0, ink)));
}

/// Draws an arrow from the position back to the limit, if there is room.
fn paint_arrow(painter: &Painter, from: Pos2, limit: f32, ink: Color32) {
    const ARROWHEAD: f32 = 6.0;
    let way = limit - from.x;
    if way.abs() < 3.0 * ARROWHEAD {
        return;
    }
    let (tip, back) = (pos2(limit, from.y), vec2(-ARROWHEAD * way.signum(), 0.0));
    painter.line_segment([from, tip], Stroke::new(2.0, ink));
    let across = vec2(0.0, ARROWHEAD * 0.7);
    painter.add(Shape::convex_polygon(vec![tip, tip + back + across, tip + back - across], ink, Stroke::NONE));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bar() -> Rect {
        Rect::from_min_size(Pos2::ZERO, vec2(116.0, BAR_HEIGHT))
    }

    #[test]
    fn bar_spans_limits() {
        let scale = Scale::new((-50, 50), Some(0), bar());
        assert_eq!([-50, 0, 50].map(|steps| scale.x(steps)), [8.0, 58.0, 108.0]);
        let unknown = Scale::new((-50, 50), None, bar());
        assert_eq!(unknown.x(50), 108.0);
    }

    #[test]
    fn bar_extends_beyond_outside_position() {
        for (position, is_above) in [(150, true), (-150, false)] {
            let scale = Scale::new((-50, 50), Some(position), bar());
            let [low, high, at] = [-50, 50, position].map(|steps| scale.x(steps));
            assert!(low < high && (8.0..=108.0).contains(&at));
            if is_above {
                assert!(at > high && at < 108.0 && low == 8.0, "{low} {high} {at}");
            } else {
                assert!(at < low && at > 8.0 && high == 108.0, "{low} {high} {at}");
            }
        }
    }

    #[test]
    fn widest_range_fits() {
        let scale = Scale::new((i32::MIN, i32::MAX), Some(0), bar());
        assert!((scale.x(0) - 58.0).abs() < 0.01);
        assert_eq!((scale.x(i32::MIN), scale.x(i32::MAX)), (8.0, 108.0));
    }
}
