//! The tooltip of a byte in a hex editor.

use egui::Ui;

use super::HexModel;
use crate::bits;
use crate::ui::{Theme, icons};

/// Draws the tooltip with every representation of a byte, its value on the device, and the mark that contains it.
pub(super) fn byte(ui: &mut Ui, theme: &Theme, model: &HexModel<'_>, at: usize) {
    let Some(byte) = model.wanted.get(at).copied() else { return };
    ui.spacing_mut().item_spacing = egui::vec2(theme.space.groups, theme.space.inside);
    let row = |ui: &mut Ui, name: String, value: egui::RichText| {
        ui.label(theme.caption(name));
        ui.label(value);
        ui.end_row();
    };
    egui::Grid::new("byte").num_columns(2).min_row_height(theme.space.groups).show(ui, |ui| {
        let address = format!("{} ({at})", model.address(at));
        row(ui, theme.translate("widget.hex_tip_address"), theme.monospace(address));
        row(ui, theme.translate("widget.hex_tip_hex"), theme.monospace(format!("{byte:02X}")));
        row(ui, theme.translate("widget.hex_tip_decimal"), theme.monospace(byte.to_string()));
        row(ui, theme.translate("widget.hex_tip_binary"), theme.monospace(bits::format_binary(byte)));
        if let Some(character) = bits::ascii(byte) {
            // The quotation marks make a space visible.
            row(ui, theme.translate("widget.hex_tip_character"), theme.monospace(format!("'{character}'")));
        }
        if let Some(own) = model.device.get(at).filter(|own| **own != byte) {
            let value = theme.monospace(format!("{own:02X}")).color(theme.palette.staged);
            row(ui, theme.translate("widget.hex_tip_as_read"), value);
        }
    });
    for mark in model.marks.iter().filter(|mark| mark.range.contains(&at)) {
        ui.label(theme.caption(format!("{} {}", icons::INFO, mark.words)).color(theme.palette.text));
    }
}
