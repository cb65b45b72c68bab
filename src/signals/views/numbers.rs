//! Rows of quantities with name, value, value of the compared capture, limit and verdict.

use egui::{RichText, Ui, WidgetInfo};

use crate::analysis::quality::Verdict;
use crate::signals::state::{Quantity, QuantityLimit, Unit};
use crate::signals::views::translate;
use crate::ui::{Theme, controls};

/// Minimum width in points at which a value is also displayed in its second unit. In a narrower window, the tooltip
/// shows it.
const MIN_SECOND_UNIT_WIDTH: f32 = 390.0;
/// Minimum width in points for a column of limits. In a narrower window, each limit is next to its verdict icon,
/// without a unit because it has that of the value.
const MIN_LIMITS_WIDTH: f32 = 350.0;
const LIMITS_WIDTH: f32 = 110.0;

/// Draws the rows. A second list, if given, is drawn for comparison, with the differences.
pub(super) fn rows_ui(
    ui: &mut Ui,
    theme: &Theme,
    name: &'static str,
    quantities: &[Quantity],
    compared: Option<&[Quantity]>,
) {
    let room = ui.available_width();
    let bounded = quantities.iter().any(|quantity| quantity.bound.is_some());
    let wide = room >= if bounded { MIN_SECOND_UNIT_WIDTH } else { MIN_SECOND_UNIT_WIDTH - LIMITS_WIDTH }
        && compared.is_none();
    let limits = room >= MIN_LIMITS_WIDTH && compared.is_none();
    let short = !limits && compared.is_none();
    let between = if wide { theme.space.groups } else { theme.space.between };
    ui.scope(|ui| {
        ui.spacing_mut().interact_size.y = 20.0;
        egui::Grid::new(name).spacing([between, theme.space.inside]).show(ui, |ui| {
            if compared.is_some() {
                for id in ["", "compare.now", "compare.kept", "compare.difference"] {
                    ui.label(if id.is_empty() { RichText::new("") } else { theme.caption(translate(theme, id)) });
                }
                ui.end_row();
            }
            for quantity in quantities {
                ui.label(theme.label(translate(theme, quantity.word)));
                value(ui, theme, quantity, wide);
                if let Some(compared) = compared {
                    let other = compared.iter().find(|other| other.word == quantity.word);
                    comparison_ui(ui, theme, quantity, other);
                }
                let words = quantity.bound.map(|bound| limit_text(theme, bound, quantity.unit)).unwrap_or_default();
                if limits {
                    ui.label(theme.caption(&words));
                }
                if let Some(verdict) = quantity.verdict {
                    ui.horizontal(|ui| {
                        ui.spacing_mut().item_spacing.x = theme.space.inside;
                        verdict_icon_ui(ui, theme, verdict, &words);
                        if let Some(bound) = quantity.bound.filter(|_| short) {
                            ui.label(theme.caption(limit_numbers(theme, bound)));
                        }
                    });
                }
                ui.end_row();
            }
        });
    });
}

fn value(ui: &mut Ui, theme: &Theme, quantity: &Quantity, wide: bool) {
    ui.horizontal(|ui| {
        let value = with_unit(theme, quantity.value, quantity.decimals, quantity.unit);
        let response = ui.add(egui::Label::new(theme.monospace(value)).selectable(true));
        let also = quantity.also.map(|(value, decimals, unit)| with_unit(theme, value, decimals, unit));
        match also {
            Some(also) if wide => {
                ui.label(theme.monospace(also).size(theme.sizes.caption).color(theme.palette.muted));
            }
            Some(also) => drop(response.on_hover_text(also)),
            None => {}
        }
    });
}

fn comparison_ui(ui: &mut Ui, theme: &Theme, quantity: &Quantity, other: Option<&Quantity>) {
    let Some(other) = other else {
        ui.label("–");
        ui.label("");
        return;
    };
    let number = |value: f64| theme.monospace(theme.format_number(value, quantity.decimals));
    ui.label(number(other.value).color(theme.palette.muted));
    let difference = without_negative_zero(quantity.value - other.value, quantity.decimals);
    let sign = if difference > 0.0 { "+" } else { "" };
    ui.label(theme.monospace(format!("{sign}{}", theme.format_number(difference, quantity.decimals))));
}

pub(super) fn with_unit(theme: &Theme, value: f64, decimals: usize, unit: Unit) -> String {
    with_unit_symbol(theme.format_number(without_negative_zero(value, decimals), decimals), unit)
}

/// Returns positive zero for a value displayed as zero, which avoids a minus sign.
fn without_negative_zero(value: f64, decimals: usize) -> f64 {
    let scale = 10_f64.powi(decimals as i32);
    if (value * scale).abs() < 0.5 { 0.0 } else { value }
}

fn limit_text(theme: &Theme, bound: QuantityLimit, unit: Unit) -> String {
    with_unit_symbol(limit_numbers(theme, bound), unit)
}

fn limit_numbers(theme: &Theme, bound: QuantityLimit) -> String {
    bound.format(|value| theme.format_significant_digits((value * 1e6).round() / 1e6))
}

fn with_unit_symbol(words: String, unit: Unit) -> String {
    match unit.unit_symbol() {
        "" => words,
        sign @ ("°" | "″") => format!("{words}{sign}"),
        sign => format!("{words} {sign}"),
    }
}

/// Draws a verdict icon in its colour. It has a label for screen readers, and a tooltip with the limit.
fn verdict_icon_ui(ui: &mut Ui, theme: &Theme, verdict: Verdict, limit: &str) {
    let (icon, colour) = controls::verdict_badge(theme, verdict);
    let id = match verdict {
        Verdict::Ok => "quality.inside",
        Verdict::Warn => "quality.outside",
        Verdict::Fault => "quality.fault",
    };
    let word = translate(theme, id);
    let response = ui.label(RichText::new(icon).color(colour));
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Label, true, &word));
    response.on_hover_text(format!("{word}: {limit}"));
}
