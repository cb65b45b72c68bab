//! What this program is and what it is made of; and what the open page is about, with the manual's section.

use egui::{ScrollArea, Ui};

use crate::ui::controls::{at_the_right, button, modal, paragraph, row};
use crate::ui::{Skin, icons};

/// Licences of what ships inside the program.
const FONT_LICENCES: &str = include_str!("../../../assets/fonts/LICENCES.txt");
const CRATES: &str = include_str!("../../../assets/crates.txt");

/// Draws the dialog. True: it is done with.
pub(in crate::ui) fn about_ui(ctx: &egui::Context, skin: &Skin) -> bool {
    let mut done = false;
    modal(ctx, skin, "about", 560.0, |ui| {
        ui.label(skin.value("encoder-studio"));
        let version = crate::app::Text::new("about.version").with("version", env!("CARGO_PKG_VERSION"));
        ui.label(skin.label(skin.words(&version)));
        ui.add_space(skin.space.between);
        for id in ["about.words", "about.trademark", "about.licence"] {
            paragraph(ui, skin.say(id));
        }
        ui.add_space(skin.space.between);
        ui.label(skin.heading(skin.say("about.made_of")));
        let height = (ctx.content_rect().height() - 360.0).clamp(120.0, 300.0);
        skin.sunken().show(ui, |ui| {
            ScrollArea::vertical().max_height(height).auto_shrink([false, true]).show(ui, |ui| {
                for text in [CRATES, FONT_LICENCES] {
                    paragraph(ui, skin.mono(text).size(skin.sizes.caption));
                }
            });
        });
        ui.add_space(skin.space.groups);
        at_the_right(ui, |ui| {
            done = button(ui, "", &skin.say("about.close")).clicked();
        });
    });
    done
}

/// Draws what the open page is about: its name and its help in the table of texts. True: it is done with.
pub(in crate::ui) fn help_ui(ctx: &egui::Context, skin: &Skin, (page, help): (&'static str, &'static str)) -> bool {
    let mut open = true;
    let title = format!("{}  {}", icons::BOOK_OPEN_TEXT, skin.say(page));
    egui::Window::new(title)
        .id(egui::Id::unique("help"))
        .open(&mut open)
        .collapsible(false)
        .resizable(false)
        .default_width(380.0)
        .anchor(egui::Align2::RIGHT_TOP, [-16.0, 64.0])
        .show(ctx, |ui: &mut Ui| {
            ui.set_width(380.0);
            paragraph(ui, skin.say(help));
            ui.add_space(skin.space.between);
            ui.label(skin.heading(skin.say("help.keys")));
            for line in skin.say("help.keys_words").lines() {
                let (key, words) = line.split_once('\t').unwrap_or((line, ""));
                row(ui, skin, key, words);
            }
        });
    !open
}
