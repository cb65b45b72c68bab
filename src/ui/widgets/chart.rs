//! Small static charts of curves or bars, such as the position error over a period, its harmonics, or a spectrum. They
//! are drawn by egui_plot in the theme of the window.
//!
//! * **Size**: the available width, the given height.
//! * **Keyboard**: none; Tab skips it.
//! * **Pointer**: the value under it.
//! * **Accessible**: an image with the given label and value.
//! * **Painting**: a line or a group of bars per series, in the series' colour; one may be dashed, or its bars hollow.

use egui::accesskit::Role;
use egui::{Align2, Color32, Sense, Stroke, Ui, Vec2, WidgetInfo};
use egui_plot::{AxisHints, Bar, BarChart, GridMark, HoverPosition, Line, LineStyle, Plot, PlotPoint, PlotPoints};

use crate::ui::Theme;
use crate::ui::widgets::series_colour;

#[derive(Clone, Debug, Default)]
pub struct Chart<'a> {
    /// Series to draw, the main one first.
    pub traces: &'a [Trace],
    pub label: &'a str,
    pub value: &'a str,
    pub height: f32,
    pub x_unit: &'a str,
    pub y_unit: &'a str,
    /// Limits of the horizontal axis, or `None` to fit them to the data.
    pub x_range: Option<(f64, f64)>,
    /// Tick spacing of the horizontal axis, or `None` for automatic spacing.
    pub x_step: Option<f64>,
    /// Value that is always visible on the vertical axis.
    pub y_floor: Option<f64>,
    /// Labels at individual points such as peaks.
    pub marks: &'a [(f64, f64, String)],
    /// Whether to draw bars instead of lines. Bar positions are whole numbers.
    pub bars: bool,
}

#[derive(Clone, Debug, Default)]
pub struct Trace {
    pub name: String,
    pub points: Vec<(f64, f64)>,
    pub colour: usize,
    pub dashed: bool,
}

/// Total width of the bars at one position, as a fraction of the distance between positions.
const BAR_GROUP_FRACTION: f64 = 0.7;

/// Draws a chart. If there are several series, a legend is drawn above it.
pub fn chart(ui: &mut Ui, theme: &Theme, chart: &Chart<'_>) {
    legend_ui(ui, theme, chart.traces);
    let own = *theme;
    let (x_unit, y_unit) = (chart.x_unit.to_owned(), chart.y_unit.to_owned());
    let tooltip = move |hover: &HoverPosition<'_>| match hover {
        HoverPosition::NearDataPoint { plot_name, position, .. } => {
            let (x, y) = (format_value(&own, position.x), format_value(&own, position.y));
            Some(format!("{plot_name}\n{x} {x_unit}\n{y} {y_unit}"))
        }
        HoverPosition::Elsewhere { .. } => None,
    };
    theme.sunken_frame().show(ui, |ui| {
        // Use one colour for all ticks. By default, ticks fade as they get closer together.
        ui.visuals_mut().widgets.noninteractive.fg_stroke.color = theme.palette.muted.into();
        ui.visuals_mut().override_text_color = Some(theme.palette.muted.into());
        let mut plot = Plot::new(chart.label)
            .height(chart.height)
            .allow_scroll(false)
            .allow_drag(false)
            .allow_zoom(false)
            .allow_boxed_zoom(false)
            .allow_double_click_reset(false)
            .show_background(false)
            .grid_spacing(egui::Rangef::new(8.0, 24.0))
            .grid_color(theme.palette.line.into())
            .set_margin_fraction(Vec2::new(0.0, if chart.marks.is_empty() { 0.08 } else { 0.16 }))
            .label_formatter(tooltip)
            .custom_x_axes(vec![with_label_spacing(AxisHints::new_x(), own, 16.0)])
            .custom_y_axes(vec![with_label_spacing(AxisHints::new_y(), own, 12.0)])
            .auto_bounds(true);
        if let Some((least, most)) = chart.x_range {
            plot = plot.include_x(least).include_x(most);
        }
        let x_step = chart.x_step;
        plot = plot
            .x_grid_spacer(move |input| grid_marks(input.bounds, x_step.unwrap_or_else(|| round_step(input.bounds))))
            .y_grid_spacer(|input| grid_marks(input.bounds, round_step(input.bounds)));
        if let Some(floor) = chart.y_floor {
            plot = plot.include_y(floor);
        }
        let response = plot.show(ui, |plot| {
            if chart.bars {
                paint_bars(plot, theme, chart.traces);
            } else {
                paint_lines(plot, theme, chart.traces);
            }
            for (x, y, words) in chart.marks {
                let text = egui::RichText::new(words).size(theme.sizes.caption).color(theme.palette.text);
                let place = PlotPoint::new(*x, *y);
                plot.text(egui_plot::Text::new(words.clone(), place, text).anchor(label_side(chart.traces, *x)));
            }
        });
        response.response.widget_info(|| {
            let mut info = WidgetInfo::labeled(Role::Image, true, chart.label);
            info.current_text_value = Some(chart.value.to_owned());
            info
        });
    });
}

/// Draws the series names, each beside a line in the colour of the series.
fn legend_ui(ui: &mut Ui, theme: &Theme, traces: &[Trace]) {
    if traces.len() < 2 {
        return;
    }
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().interact_size.y = theme.space.groups;
        for trace in traces {
            let (rect, _) = ui.allocate_exact_size(Vec2::new(18.0, 12.0), Sense::hover());
            let ends = [rect.left_center(), rect.right_center()];
            let stroke = Stroke::new(2.0, series_colour(theme, trace.colour));
            if trace.dashed {
                ui.painter().extend(egui::Shape::dashed_line(&ends, stroke, 5.0, 3.0));
            } else {
                ui.painter().line_segment(ends, stroke);
            }
            ui.label(theme.caption(&trace.name));
        }
    });
}

fn paint_lines(plot: &mut egui_plot::PlotUi<'_>, theme: &Theme, traces: &[Trace]) {
    for trace in traces {
        let points = trace.points.iter().map(|(x, y)| PlotPoint::new(*x, *y)).collect();
        let style = if trace.dashed { LineStyle::dashed_dense() } else { LineStyle::Solid };
        let line = Line::new(trace.name.clone(), PlotPoints::Owned(points));
        plot.line(line.color(series_colour(theme, trace.colour)).width(1.5).style(style));
    }
}

fn paint_bars(plot: &mut egui_plot::PlotUi<'_>, theme: &Theme, traces: &[Trace]) {
    let width = BAR_GROUP_FRACTION / traces.len().max(1) as f64;
    for (number, trace) in traces.iter().enumerate() {
        let colour = series_colour(theme, trace.colour);
        let fill = if trace.dashed { Color32::TRANSPARENT } else { colour };
        let off = (number as f64 + 0.5) * width - BAR_GROUP_FRACTION / 2.0;
        let bar = |(x, y): &(f64, f64)| {
            Bar::new(x + off, *y).width(width * 0.9).fill(fill).stroke(Stroke::new(1.0, colour)).name(&trace.name)
        };
        let (own, name) = (*theme, trace.name.clone());
        let tooltip = move |bar: &Bar, _: &BarChart| format!("{name}\n{}", format_value(&own, bar.value));
        let chart = BarChart::new(trace.name.clone(), trace.points.iter().map(bar).collect());
        plot.bar_chart(chart.color(colour).element_formatter(Box::new(tooltip)));
    }
}

/// Returns the alignment at which a label fits next to a point.
fn label_side(traces: &[Trace], x: f64) -> Align2 {
    let ends = traces.iter().flat_map(|trace| trace.points.first().into_iter().chain(trace.points.last()));
    let (least, most) = ends.fold((x, x), |(least, most), (end, _)| (least.min(*end), most.max(*end)));
    match (x - least) / (most - least).max(f64::MIN_POSITIVE) {
        share if share < 0.12 => Align2::LEFT_BOTTOM,
        share if share > 0.88 => Align2::RIGHT_BOTTOM,
        _ => Align2::CENTER_BOTTOM,
    }
}

/// Returns an axis whose ticks are all labelled if they are at least `least` points apart.
fn with_label_spacing(hints: AxisHints<'static>, theme: Theme, least: f32) -> AxisHints<'static> {
    hints.formatter(move |mark, _| tick_label(&theme, mark)).label_spacing(egui::Rangef::new(least / 2.0, least))
}

/// Returns a step of 1, 2 or 5 times a power of ten that divides the range into about five parts.
fn round_step((least, most): (f64, f64)) -> f64 {
    let rough = ((most - least).abs() / 5.0).clamp(1e-12, 1e12);
    let power = 10_f64.powf(rough.log10().floor());
    let times = [1.0, 2.0, 5.0].into_iter().find(|times| times * power >= rough).unwrap_or(10.0);
    times * power
}

/// Returns the ticks of a range at the given step. Their number is limited so that they can be distinguished.
fn grid_marks((least, most): (f64, f64), step: f64) -> Vec<GridMark> {
    const MAX_TICKS: usize = 64;
    let first = (least / step).ceil();
    let value = |at: usize| (first + at as f64) * step;
    (0..MAX_TICKS)
        .map(value)
        .take_while(|value| *value <= most)
        .map(|value| GridMark { value, step_size: step })
        .collect()
}

/// Formats a tick label with as many decimals as the step needs.
fn tick_label(theme: &Theme, mark: GridMark) -> String {
    let decimals = (-mark.step_size.log10().floor()).clamp(0.0, 9.0) as usize;
    theme.format_number(mark.value, decimals)
}

fn format_value(theme: &Theme, value: f64) -> String {
    let decimals = (3.0 - value.abs().max(1e-6).log10().floor()).clamp(0.0, 9.0) as usize;
    theme.format_number(value, decimals)
}
