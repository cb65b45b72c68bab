//! The large display of a BiSS position and of the registers that are read with it.

use egui::{RichText, Ui};

use crate::app::{Action, Rgb};
use crate::devices::biss::procedures::PositionReading;
use crate::devices::biss::protocol::{Register, Role};
use crate::devices::biss::state::explain;
use crate::devices::biss::state::{BissAction as Biss, Encoder, TEXTS, ValidityMark};
use crate::devices::biss::views::translate;
use crate::ui::controls::{icon_menu, paragraph, row};
use crate::ui::panels::live::{LOW_PANEL_HEIGHT, raw_row, remark_ui as mark_ui, unknown_rows};
use crate::ui::{Theme, icons};

pub(crate) fn value_ui(ui: &mut Ui, theme: &Theme, encoder: &Encoder, ink: Rgb) {
    let reading = encoder.record.last();
    let raw = |own: &PositionReading| theme.format_word(own.position_word());
    let main = reading.map(|own| own.angle_degrees().map_or_else(|| raw(own), |angle| theme.format_number(angle, 3)));
    let main = main.unwrap_or_else(|| "–".to_owned());
    let is_angle = reading.is_none_or(|own| own.is_split_known);
    let palette = theme.palette;
    ui.horizontal(|ui| {
        ui.label(RichText::new(main).font(egui::FontId::monospace(theme.sizes.live)).color(ink));
        ui.label(theme.label(if is_angle { "°".to_owned() } else { theme.translate("live.raw") }));
        if let Some(mark) = encoder.position_mark() {
            let (word, ink) = match mark {
                ValidityMark::Invalid => ("live.invalid", palette.bad),
                ValidityMark::Warned => ("live.warning", palette.warn),
            };
            mark_ui(ui, theme, word, ink);
        }
    });
    let Some(reading) = reading else { return unknown_rows(ui, theme, &["live.turns", "live.step", "live.raw"]) };
    if !is_angle {
        row(ui, theme, &theme.translate("unit.steps"), theme.monospace(reading.position().to_string()));
    } else if ui.available_height() < LOW_PANEL_HEIGHT {
        // If the window is not high enough, the space is needed for the plot.
        let (turns, steps) = (theme.translate("live.turns"), theme.translate("live.step"));
        let words = format!("{turns} {} · {steps} {}", reading.turns, reading.steps);
        ui.add(egui::Label::new(theme.caption(words)).truncate().selectable(true));
    } else {
        row(ui, theme, &theme.translate("live.turns"), theme.monospace(reading.turns.to_string()));
        row(ui, theme, &theme.translate("live.step"), theme.monospace(reading.steps.to_string()));
        raw_row(ui, theme, theme.format_word(reading.position_word()));
    }
    if let Some(stream) = encoder.active_stream() {
        let id = if stream.is_limited { "live.streamed_all" } else { "live.streamed" };
        let text = TEXTS.text(id).with_number("count", stream.frame_rate_hz(), 0);
        let words = theme.format_text(&text.with_number("clock", f64::from(stream.clock_hz) / 1e6, 1));
        ui.add(egui::Label::new(theme.caption(words)).wrap()).on_hover_text(theme.translate("live.streamed_hint"));
    }
    let errors = encoder.record.crc_errors();
    if errors > 0 {
        let text = TEXTS.text("frame_card.crc_errors").with("count", errors);
        ui.label(RichText::new(theme.format_text(&text)).size(theme.sizes.caption).color(palette.warn));
    }
}

/// Draws the menu of registers to read with the position. It offers the common ones. All others can be selected in the
/// register table.
pub(crate) fn watch_menu(ui: &mut Ui, theme: &Theme, encoder: &Encoder, actions: &mut Vec<Action>) {
    let word = theme.translate("live.watch");
    let Some(description) = &encoder.description else { return };
    let watched = encoder.record.watched_registers();
    icon_menu(ui, icons::EYE, &word, |ui| {
        ui.set_max_width(260.0);
        ui.label(theme.heading(&word));
        paragraph(ui, theme.caption(translate(theme, "live.watch_registers")));
        let usual = [Role::Temperature, Role::Errors, Role::Warnings, Role::Mode];
        let usual: Vec<Register> =
            usual.iter().filter_map(|role| description.register_with_role(*role).cloned()).collect();
        let more = watched.iter().filter(|own| usual.iter().all(|other| other.address != own.address)).cloned();
        for register in usual.iter().cloned().chain(more) {
            let mut on = watched.iter().any(|own| own.address == register.address);
            let name = if register.name.is_empty() {
                register.address.to_string()
            } else {
                theme.format_text(&explain::name_text(&register.name))
            };
            if ui.checkbox(&mut on, name).changed() {
                actions.push(Action::device(encoder.session.id, Biss::Watch(Box::new(register), on)));
            }
        }
    });
}
