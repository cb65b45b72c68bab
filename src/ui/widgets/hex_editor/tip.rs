//! What a hex editor says about the byte under the pointer.

use egui::Ui;

use super::grid::Grid;
use super::{HexModel, address_text};
use crate::bits;
use crate::ui::{Skin, icons};

/// The byte in every reading, what the device has there, and what it belongs to.
pub(super) fn byte(ui: &mut Ui, skin: &Skin, grid: &Grid, model: &HexModel<'_>, at: usize) {
    let Some(byte) = model.wanted.get(at).copied() else { return };
    ui.spacing_mut().item_spacing = egui::vec2(skin.space.groups, skin.space.inside);
    let row = |ui: &mut Ui, name: String, value: egui::RichText| {
        ui.label(skin.caption(name));
        ui.label(value);
        ui.end_row();
    };
    egui::Grid::new("byte").num_columns(2).min_row_height(skin.space.groups).show(ui, |ui| {
        let address = format!("{} ({at})", address_text(at, grid.digits));
        row(ui, skin.say("widget.hex_tip_address"), skin.mono(address));
        row(ui, skin.say("widget.hex_tip_hex"), skin.mono(format!("{byte:02X}")));
        row(ui, skin.say("widget.hex_tip_decimal"), skin.mono(byte.to_string()));
        row(ui, skin.say("widget.hex_tip_binary"), skin.mono(bits::binary(byte)));
        if let Some(character) = bits::ascii(byte) {
            // In quotes: a blank is one too.
            row(ui, skin.say("widget.hex_tip_character"), skin.mono(format!("'{character}'")));
        }
        if let Some(own) = model.device.get(at).filter(|own| **own != byte) {
            let value = skin.mono(format!("{own:02X}")).color(skin.palette.staged);
            row(ui, skin.say("widget.hex_tip_as_read"), value);
        }
    });
    for mark in model.marks.iter().filter(|mark| mark.range.contains(&at)) {
        ui.label(skin.caption(format!("{} {}", icons::INFO, mark.words)).color(skin.palette.text));
    }
}
