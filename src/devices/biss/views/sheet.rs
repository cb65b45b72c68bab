//! The electronic data sheet: what its two banks say, each field with its unit, and whether their sums fit.

use egui::{RichText, Ui};

use crate::devices::biss::protocol::{Eds, EdsBank, EdsError};
use crate::devices::biss::state::{Encoder, TEXTS, words};
use crate::devices::biss::views::say;
use crate::ui::controls::{card, paragraph, two_columns};
use crate::ui::{Skin, icons};

pub(super) fn cards_ui(ui: &mut Ui, skin: &Skin, encoder: &Encoder) {
    let Some([common, encoder]) = encoder.data_sheet() else { return };
    two_columns(
        ui,
        skin,
        (),
        |ui, ()| card(ui, skin, TEXTS.text("sheet_card.common"), |ui| sheet_ui(ui, skin, EdsBank::Common, &common)),
        |ui, ()| card(ui, skin, TEXTS.text("sheet_card.encoder"), |ui| sheet_ui(ui, skin, EdsBank::Encoder, &encoder)),
    );
}

fn sheet_ui(ui: &mut Ui, skin: &Skin, bank: EdsBank, sheet: &Result<Eds, EdsError>) {
    let eds = match sheet {
        Ok(eds) => eds,
        Err(why) => {
            paragraph(ui, RichText::new(skin.words(&words::sheet(why))).color(skin.palette.bad));
            return;
        }
    };
    ui.spacing_mut().item_spacing.y = skin.space.inside;
    for (field, value) in eds.values() {
        ui.horizontal_top(|ui| {
            ui.spacing_mut().interact_size.y = 18.0;
            let at = ui.label(skin.mono(format!("0x{:02X}", field.offset)).color(skin.palette.muted));
            ui.add_space((OFFSET - at.rect.width()).max(0.0));
            let room = (ui.available_width() * 0.58).floor();
            ui.allocate_ui_with_layout(egui::vec2(room, 0.0), egui::Layout::top_down(egui::Align::Min), |ui| {
                ui.set_min_width(room);
                paragraph(ui, skin.label(skin.words(&words::eds_name(bank, field))));
            });
            paragraph(ui, skin.words(&words::eds(value)));
        });
    }
    ui.horizontal(|ui| {
        ui.label(RichText::new(icons::CHECK_CIRCLE).color(skin.palette.good));
        ui.label(skin.caption(say(skin, "sheet_card.sum")));
    });
}

/// Width of the column of offsets.
const OFFSET: f32 = 40.0;
