//! Comparison of a device or an open profile with a profile on disk: the differences, and the items of only one side.

use egui::{Grid, ScrollArea, Ui};

use crate::app::{Action, AnyDevice, DeviceCommand, ProfileComparison, Studio, Text};
use crate::profile::Comparison;
use crate::ui::controls::{labelled_button, modal, paragraph, primary_button, right_aligned};
use crate::ui::{Theme, icons};

/// Maximum height of the list in points. The buttons stay visible below a long list.
const MAX_LIST_HEIGHT: f32 = 340.0;
/// Maximum number of characters shown of a value, on one line. The tooltip shows the whole value.
const MAX_VALUE_CHARS: usize = 40;

pub(in crate::ui) fn comparison_ui(ctx: &egui::Context, theme: &Theme, studio: &Studio, actions: &mut Vec<Action>) {
    let Some(shown) = studio.comparison() else { return };
    let Some(device) = studio.device(shown.session()) else { return };
    modal(ctx, theme, "comparison", 760.0, |ui| {
        ui.label(theme.heading(theme.translate("comparison.title")));
        let text = Text::new("comparison.sides").with("device", device.name()).with("path", shown.path().display());
        paragraph(ui, theme.label(theme.format_text(&text)));
        ui.add_space(theme.space.between);
        let Comparison { differences, compared, only_left, only_right } = shown.comparison();
        let summary = match differences.len() {
            0 => Text::new("comparison.equal").with("compared", compared),
            1 => Text::new("comparison.one").with("compared", compared),
            count => Text::new("comparison.some").with("count", count).with("compared", compared),
        };
        paragraph(ui, theme.format_text(&summary));
        ui.add_space(theme.space.between);
        ScrollArea::both().max_height(MAX_LIST_HEIGHT).auto_shrink([false, true]).show(ui, |ui| {
            if !differences.is_empty() {
                table_ui(ui, theme, shown.comparison());
            }
            one_sided_items_ui(ui, theme, "comparison.only_left", only_left);
            one_sided_items_ui(ui, theme, "comparison.only_right", only_right);
        });
        theme.add_gap(ui);
        buttons_ui(ui, theme, device, shown, actions);
    });
}

fn table_ui(ui: &mut Ui, theme: &Theme, comparison: &Comparison) {
    Grid::new("differences").num_columns(3).striped(true).spacing([24.0, 6.0]).show(ui, |ui| {
        for word in ["comparison.item", "comparison.left", "comparison.right"] {
            ui.label(theme.caption(theme.translate(word)));
        }
        ui.end_row();
        for difference in &comparison.differences {
            for text in [&difference.item, &difference.left, &difference.right] {
                value_ui(ui, theme, text);
            }
            ui.end_row();
        }
    });
}

fn value_ui(ui: &mut Ui, theme: &Theme, text: &str) {
    if text.chars().count() <= MAX_VALUE_CHARS {
        ui.label(theme.monospace(text));
    } else {
        let beginning: String = text.chars().take(MAX_VALUE_CHARS).chain(['…']).collect();
        ui.label(theme.monospace(beginning)).on_hover_text(theme.monospace(text));
    }
}

fn one_sided_items_ui(ui: &mut Ui, theme: &Theme, word: &'static str, items: &[String]) {
    if !items.is_empty() {
        ui.add_space(theme.space.between);
        paragraph(ui, theme.caption(theme.format_text(&Text::new(word).with("items", items.join(", ")))));
    }
}

fn buttons_ui(ui: &mut Ui, theme: &Theme, device: &AnyDevice, shown: &ProfileComparison, actions: &mut Vec<Action>) {
    right_aligned(ui, |ui| {
        let differs = !shown.comparison().differences.is_empty();
        let can_restore = differs && device.is_ready() && device.has_memory();
        let word = theme.translate("comparison.restore");
        if primary_button(ui, theme, can_restore, icons::DOWNLOAD_SIMPLE, &word).clicked() {
            actions.push(Action::CloseComparison);
            actions.push(device.command(DeviceCommand::Restore(shown.path().to_owned())));
        }
        if labelled_button(ui, "", &theme.translate("about.close")).clicked() {
            actions.push(Action::CloseComparison);
        }
    });
}
