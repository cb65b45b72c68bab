//! The electronic data sheet: the fields of both banks with their units, and the state of the checksums.

use egui::{RichText, Ui};

use crate::devices::biss::protocol::{Eds, EdsBank, EdsError};
use crate::devices::biss::state::{Encoder, TEXTS, format};
use crate::devices::biss::views::translate;
use crate::ui::controls::{folding_card, paragraph, two_columns};
use crate::ui::{Theme, icons};

pub(super) fn cards_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder) {
    let Some([common, encoder]) = encoder.data_sheet() else { return };
    two_columns(
        ui,
        theme,
        (),
        |ui, ()| {
            folding_card(ui, theme, TEXTS.text("sheet_card.common"), |ui| {
                data_sheet_bank_ui(ui, theme, EdsBank::Common, &common)
            })
        },
        |ui, ()| {
            folding_card(ui, theme, TEXTS.text("sheet_card.encoder"), |ui| {
                data_sheet_bank_ui(ui, theme, EdsBank::Encoder, &encoder)
            })
        },
    );
}

fn data_sheet_bank_ui(ui: &mut Ui, theme: &Theme, bank: EdsBank, sheet: &Result<Eds, EdsError>) {
    let eds = match sheet {
        Ok(eds) => eds,
        Err(why) => {
            paragraph(
                ui,
                RichText::new(theme.format_text(&format::data_sheet_error_text(why))).color(theme.palette.bad),
            );
            return;
        }
    };
    ui.spacing_mut().item_spacing.y = theme.space.inside;
    for (field, value) in eds.values() {
        ui.horizontal_top(|ui| {
            ui.spacing_mut().interact_size.y = 18.0;
            let at = ui.label(theme.monospace(format!("0x{:02X}", field.offset)).color(theme.palette.muted));
            ui.add_space((OFFSET_WIDTH - at.rect.width()).max(0.0));
            let room = (ui.available_width() * 0.58).floor();
            ui.allocate_ui_with_layout(egui::vec2(room, 0.0), egui::Layout::top_down(egui::Align::Min), |ui| {
                ui.set_min_width(room);
                paragraph(ui, theme.label(theme.format_text(&format::eds_field_name(bank, field))));
            });
            paragraph(ui, theme.format_text(&format::eds_value_text(value)));
        });
    }
    ui.horizontal(|ui| {
        ui.label(RichText::new(icons::CHECK_CIRCLE).color(theme.palette.good));
        ui.label(theme.caption(translate(theme, "sheet_card.sum")));
    });
}

const OFFSET_WIDTH: f32 = 40.0;
