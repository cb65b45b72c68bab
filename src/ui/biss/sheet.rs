//! The electronic data sheet: what its two banks say, each field with its unit, and whether their sums fit.

use egui::{RichText, Ui};

use crate::app::biss::{Encoder, words};
use crate::device::biss::Sheet;
use crate::ui::Skin;
use crate::ui::controls::{card, paragraph};
use crate::ui::icons;

pub(super) fn cards_ui(ui: &mut Ui, skin: &Skin, encoder: &Encoder) {
    let Some(sheet) = encoder.identity().and_then(|identity| identity.data_sheet.as_ref()) else { return };
    for (title, own) in [("sheet_card.common", &sheet.common), ("sheet_card.encoder", &sheet.encoder)] {
        card(ui, skin, title, |ui| sheet_ui(ui, skin, own));
        ui.add_space(skin.space.groups);
    }
}

fn sheet_ui(ui: &mut Ui, skin: &Skin, sheet: &Sheet) {
    let eds = match &sheet.eds {
        Ok(eds) => eds,
        Err(why) => {
            paragraph(ui, RichText::new(skin.words(&words::sheet(why))).color(skin.palette.bad));
            return;
        }
    };
    for (field, value) in eds.values() {
        ui.horizontal_top(|ui| {
            ui.spacing_mut().interact_size.y = 18.0;
            let at = ui.label(skin.mono(format!("{:02X}", field.offset)).color(skin.palette.muted));
            ui.add_space((OFFSET - at.rect.width()).max(0.0));
            let room = (ui.available_width() * 0.56).floor();
            ui.allocate_ui_with_layout(egui::vec2(room, 0.0), egui::Layout::top_down(egui::Align::Min), |ui| {
                ui.set_min_width(room);
                paragraph(ui, skin.label(field.name));
            });
            paragraph(ui, skin.mono(skin.words(&words::eds(value))));
        });
    }
    ui.horizontal(|ui| {
        ui.label(RichText::new(icons::CHECK_CIRCLE).color(skin.palette.good));
        ui.label(skin.caption(skin.say("sheet_card.sum")));
    });
}

/// Width of the column of offsets.
const OFFSET: f32 = 28.0;
