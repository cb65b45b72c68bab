//! The about dialog with the program version and its components, and the help for the open page.

use egui::{ScrollArea, Ui};

use crate::ui::controls::{labelled_button, modal, paragraph, right_aligned, row};
use crate::ui::{Theme, icons};

const FONT_LICENCES: &str = include_str!("../../../assets/fonts/LICENCES.txt");
const CRATES: &str = include_str!("../../../assets/crates.txt");

/// Draws the dialog. Returns `true` when the dialog is closed.
pub(in crate::ui) fn about_ui(ctx: &egui::Context, theme: &Theme) -> bool {
    let mut done = false;
    modal(ctx, theme, "about", 560.0, |ui| {
        ui.label(theme.value("encoder-studio"));
        let version = crate::app::Text::new("about.version").with("version", env!("CARGO_PKG_VERSION"));
        ui.label(theme.label(theme.format_text(&version)));
        ui.add_space(theme.space.between);
        for id in ["about.words", "about.trademark", "about.licence"] {
            paragraph(ui, theme.translate(id));
        }
        ui.add_space(theme.space.between);
        ui.label(theme.heading(theme.translate("about.made_of")));
        let height = (ctx.content_rect().height() - 360.0).clamp(120.0, 300.0);
        theme.sunken_frame().show(ui, |ui| {
            ScrollArea::vertical().max_height(height).auto_shrink([false, true]).show(ui, |ui| {
                for text in [CRATES, FONT_LICENCES] {
                    paragraph(ui, theme.monospace(text).size(theme.sizes.caption));
                }
            });
        });
        theme.add_gap(ui);
        right_aligned(ui, |ui| {
            done = labelled_button(ui, "", &theme.translate("about.close")).clicked();
        });
    });
    done
}

/// Draws the name and help of the open page. Returns `true` when the help is closed.
pub(in crate::ui) fn help_ui(ctx: &egui::Context, theme: &Theme, (page, help): (&'static str, &'static str)) -> bool {
    let mut open = true;
    let title = format!("{}  {}", icons::BOOK_OPEN_TEXT, theme.translate(page));
    egui::Window::new(title)
        .id(egui::Id::unique("help"))
        .open(&mut open)
        .collapsible(false)
        .resizable(false)
        .default_width(380.0)
        .anchor(egui::Align2::RIGHT_TOP, [-16.0, 64.0])
        .show(ctx, |ui: &mut Ui| {
            ui.set_width(380.0);
            paragraph(ui, theme.translate(help));
            ui.add_space(theme.space.between);
            ui.label(theme.heading(theme.translate("help.keys")));
            for line in theme.translate("help.keys_words").lines() {
                let (key, words) = line.split_once('\t').unwrap_or((line, ""));
                row(ui, theme, key, words);
            }
        });
    !open
}
