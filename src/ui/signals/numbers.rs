//! Numbers in rows: what each is, its value, its limit, and a mark whether it is inside.

use egui::{RichText, Ui, WidgetInfo};

use crate::app::signals::{Bound, Quantity, Unit};
use crate::signal::quality::Verdict;
use crate::ui::{Skin, icons};

/// Width from which a value also stands in its second unit; else that is its tooltip.
const WIDE: f32 = 390.0;

/// Draws the rows.
pub(super) fn rows_ui(ui: &mut Ui, skin: &Skin, name: &str, quantities: &[Quantity]) {
    let wide = ui.available_width() >= WIDE;
    let between = if wide { skin.space.groups } else { skin.space.between };
    ui.scope(|ui| {
        ui.spacing_mut().interact_size.y = 20.0;
        egui::Grid::new(name).num_columns(4).spacing([between, skin.space.inside]).show(ui, |ui| {
            for quantity in quantities {
                row(ui, skin, quantity, wide);
                ui.end_row();
            }
        });
    });
}

fn row(ui: &mut Ui, skin: &Skin, quantity: &Quantity, wide: bool) {
    ui.label(skin.label(skin.say(quantity.word)));
    ui.horizontal(|ui| {
        let value = with_unit(skin, quantity.value, quantity.decimals, quantity.unit);
        let response = ui.add(egui::Label::new(skin.mono(value)).selectable(true));
        let also = quantity.also.map(|(value, decimals, unit)| with_unit(skin, value, decimals, unit));
        match also {
            Some(also) if wide => {
                ui.label(skin.mono(also).size(skin.sizes.caption).color(skin.palette.muted));
            }
            Some(also) => drop(response.on_hover_text(also)),
            None => {}
        }
    });
    match quantity.bound {
        Some(bound) => ui.label(skin.caption(bound_words(skin, bound, quantity.unit))),
        None => ui.label(""),
    };
    if let Some(verdict) = quantity.verdict {
        mark(ui, skin, verdict);
    }
}

/// A number with its unit.
pub(super) fn with_unit(skin: &Skin, value: f64, decimals: usize, unit: Unit) -> String {
    let number = skin.number(value, decimals);
    match unit.sign() {
        "" => number,
        sign @ ("°" | "″") => format!("{number}{sign}"),
        sign => format!("{number} {sign}"),
    }
}

/// Where a number should be.
fn bound_words(skin: &Skin, bound: Bound, unit: Unit) -> String {
    let plain = |value: f64| skin.plain((value * 1e6).round() / 1e6);
    let words = match bound {
        Bound::Between(least, most) => format!("{} … {}", plain(least), plain(most)),
        Bound::Within(most) => format!("± {}", plain(most)),
        Bound::AtMost(most) => format!("≤ {}", plain(most)),
        Bound::AtLeast(least) => format!("≥ {}", plain(least)),
    };
    match unit.sign() {
        "" => words,
        sign @ ("°" | "″") => format!("{words}{sign}"),
        sign => format!("{words} {sign}"),
    }
}

/// An icon in its colour, which says its word to a screen reader and under the pointer.
pub(super) fn mark(ui: &mut Ui, skin: &Skin, verdict: Verdict) {
    let palette = skin.palette;
    let (icon, colour, id) = match verdict {
        Verdict::Ok => (icons::CHECK_CIRCLE, palette.good, "quality.inside"),
        Verdict::Warn => (icons::WARNING, palette.warn, "quality.outside"),
        Verdict::Fault => (icons::X_CIRCLE, palette.bad, "quality.fault"),
    };
    let word = skin.say(id);
    let response = ui.label(RichText::new(icon).color(colour));
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Label, true, &word));
    response.on_hover_text(word);
}
