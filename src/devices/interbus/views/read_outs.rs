//! The read-outs of an encoder, and the registers of its OPC chip.

use egui::Ui;

use crate::app::Action;
use crate::devices::interbus::protocol::{READ_OUTS, ReadOutNumber};
use crate::devices::interbus::state::{Encoder, InterbusAction as Interbus, TEXTS, explain, format};
use crate::devices::interbus::views::translate;
use crate::ui::controls::{card, folding_card, icon_button, paragraph};
use crate::ui::{Theme, icons};

/// Minimum and maximum width of the name column.
const NAMES: [f32; 2] = [120.0, 168.0];
/// Width of a cell with a chip register.
const REGISTER_WIDTH: f32 = 132.0;

pub(super) fn cards_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, actions: &mut Vec<Action>) {
    if encoder.profile().is_some() {
        return;
    }
    let ready = encoder.session.is_ready() && encoder.is_stopped();
    let id = encoder.session.id;
    card(ui, theme, TEXTS.text("ib_values.title"), |ui| {
        paragraph(ui, theme.label(translate(theme, "ib_values.words")));
        let wide = ui.available_width() > 640.0;
        let columns = if wide { 2 } else { 1 };
        let [least, most] = NAMES;
        let names = (ui.available_width() * 0.2).clamp(least, most);
        egui::Grid::new("read_outs").num_columns(columns * 3).spacing([12.0, 4.0]).show(ui, |ui| {
            for (at, row) in READ_OUTS.iter().enumerate() {
                let name = theme.format_text(&explain::read_out(row.read_out));
                if icon_button(ui, ready, icons::ARROW_CLOCKWISE, &name).clicked() {
                    actions.push(Action::device(id, Interbus::ReadOut(row.read_out)));
                }
                ui.horizontal(|ui| {
                    ui.set_min_width(names);
                    ui.label(theme.label(&name));
                });
                let value = encoder.read_out(row.read_out);
                let value = value.map(|value| theme.format_text(&format::read_value(row.read_out, value)));
                ui.add(egui::Label::new(theme.monospace(value.unwrap_or_else(|| "–".to_owned()))).selectable(true));
                if at % columns == columns - 1 {
                    ui.end_row();
                }
            }
        });
    });
    theme.add_gap(ui);
    folding_card(ui, theme, TEXTS.text("ib_values.chip"), |ui| {
        paragraph(ui, theme.caption(translate(theme, "ib_values.chip_words")));
        ui.horizontal_wrapped(|ui| {
            for what in (0..16).filter_map(ReadOutNumber::chip_register) {
                let name = theme.format_text(&explain::read_out(what));
                let number = what.register().unwrap_or_default();
                let value = encoder.read_out(what).map_or_else(|| "–".to_owned(), |own| format!("0x{:X}", own.get()));
                let button = egui::Button::new(theme.monospace(format!("{number:X}  {value}")))
                    .min_size([REGISTER_WIDTH, 28.0].into());
                if crate::ui::controls::name(ui.add_enabled(ready, button), ready, &name).clicked() {
                    actions.push(Action::device(id, Interbus::ReadOut(what)));
                }
            }
        });
    });
}
